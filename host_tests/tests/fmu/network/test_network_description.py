"""What validators and schemas say of network FMUs, and what `laconic fmu --bus` refuses."""

from __future__ import annotations

import shutil
import subprocess
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from fmu_manipulation_toolbox.checker import get_checkers
from fmu_manipulation_toolbox.operations import FMU
from lxml import etree

from laconic.base.paths import built, scene_path
from laconic.cli.main import run
from laconic.fmu.network import make_network_fmu
from laconic.scene import read_scene

SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
FMI_LS = "{http://fmi-standard.org/fmi-ls-manifest}"
SCENES = {"rig": ("robotino2", {}),
          "countdown": ("canopen_agv", {"drives": "canopen", "tx_clock": "countdown"})}


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Those of the build, and some of scenes."""
    folder = tmp_path_factory.mktemp("fmus")
    made = [make_network_fmu(read_scene(scene), folder / f"{name}.fmu", **options)
            for name, (scene, options) in SCENES.items()]
    return made + [built(f"fmu/Laconic{name}_fmi3.fmu") for name in ("CanBus", "CanController")]


def part(fmu: Path, name: str) -> bytes:
    """A file in an archive."""
    with zipfile.ZipFile(fmu) as archive:
        return archive.read(name)


def test_fmpy_validates_network_fmus_without_a_message(fmus: list[Path]) -> None:
    assert {fmu.name: validate_fmu(str(fmu)) for fmu in fmus} == {fmu.name: [] for fmu in fmus}


def test_the_manipulation_toolbox_has_no_finding_in_network_fmus(
        fmus: list[Path], caplog: pytest.LogCaptureFixture) -> None:
    for fmu in fmus[::2]:
        with FMU(str(fmu)) as opened:
            for checker in get_checkers():
                opened.apply_operation(checker())
    assert [record.message for record in caplog.records if record.levelname in ("WARNING", "ERROR")] == []


def test_terminals_and_manifest_are_those_of_the_standard(fmus: list[Path]) -> None:
    schema = etree.XMLSchema(etree.parse(str(SCHEMAS / "fmi3TerminalsAndIcons.xsd")))
    for fmu in fmus:
        text = part(fmu, "terminalsAndIcons/terminalsAndIcons.xml")
        schema.assertValid(etree.fromstring(text))
        listed = ET.fromstring(part(fmu, "modelDescription.xml")).find("ModelVariables")
        assert listed is not None
        variables = {each.get("name"): each for each in listed}
        for terminal in ET.fromstring(text).find("Terminals") or []:
            assert terminal.get("terminalKind") == "org.fmi-ls-bus.network-terminal"
            assert terminal.get("matchingRule") == "org.fmi-ls-bus.transceiver"
            members = {each.get("memberName"): variables[each.get("variableName", "")]
                       for each in terminal.iter("TerminalMemberVariable")}
            assert set(members) == {"Rx_Clock", "Rx_Data", "Tx_Clock", "Tx_Data", "BusNotifications"}
            for way in ("Rx", "Tx"):
                data = members[f"{way}_Data"]
                assert data.get("mimeType") == 'application/org.fmi-standard.fmi-ls-bus.can; version="1.0.0"'
                assert data.get("clocks") == members[f"{way}_Clock"].get("valueReference")
        manifest = ET.fromstring(part(fmu, "extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml"))
        assert manifest.tag == "fmiLayeredStandardManifest"
        assert manifest.attrib == {
            f"{FMI_LS}fmi-ls-name": "org.fmi-standard.fmi-ls-bus", f"{FMI_LS}fmi-ls-version": "1.0.0",
            f"{FMI_LS}fmi-ls-description": "Layered Standard for the simulation of bus communication on a Physical "
                                           "Signal Abstraction or Network Abstraction based level.",
            "isBusSimulationFMU": "true" if "Bus" in fmu.name else "false"}


def test_a_countdown_is_an_input_and_a_triggered_clock_an_output(fmus: list[Path]) -> None:
    for fmu in fmus[:2]:
        clock = next(each for each in fmpy.read_model_description(str(fmu)).modelVariables
                     if each.name == "CAN.Tx_Clock")
        expected = ("input", "countdown") if fmu.stem == "countdown" else ("output", "triggered")
        assert (clock.causality, clock.intervalVariability) == expected


def test_the_sources_inside_are_all_listed_and_left_out_on_request(fmus: list[Path], tmp_path: Path) -> None:
    names = zipfile.ZipFile(fmus[0]).namelist()
    build = ET.fromstring(part(fmus[0], "sources/buildDescription.xml"))
    listed = {each.get("name") for each in build.iter("SourceFile")}
    assert listed == {name.removeprefix("sources/") for name in names if name.endswith(".c")}
    bare = make_network_fmu(read_scene("robotino2"), tmp_path / "bare.fmu", sources=False)
    assert not [name for name in zipfile.ZipFile(bare).namelist() if name.startswith("sources/")]


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")
@pytest.mark.parametrize("name", ["CanBus", "CanController", pytest.param("Node", marks=pytest.mark.nightly)])
def test_the_sources_inside_compile_with_the_headers_of_fmi_alone(name: str, tmp_path: Path) -> None:
    fmu = built(f"fmu/Laconic{name}_fmi3.fmu")
    zipfile.ZipFile(fmu).extractall(tmp_path)
    build = ET.fromstring(part(fmu, "sources/buildDescription.xml"))
    files = [each.get("name", "") for each in build.iter("SourceFile")]
    done = subprocess.run(["gcc", "-std=c99", "-fsyntax-only", "-I.", f"-I{built('parts/fmi')}", *files],
                          cwd=tmp_path / "sources", capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(("options", "named"), [
    ("robotino2 --fmi 2 --bus can", "--bus can: FMI 2.0 has neither clocks nor binary variables; use --fmi 3"),
    ("robotino2 --fmi 3 --drives canopen", "--drives canopen: is for a network FMU; give --bus can, or leave it out"),
    ("robotino2 --fmi 3 --tx-clock countdown", "--tx-clock countdown: is for a network FMU; give --bus can"),
    ("robotino2 --fmi 3 --bus can --scalar", "--scalar: a network FMU has no such variant; leave it out"),
    ("robotino2 --fmi 3 --bus can --drives vesc", "'--drives': 'vesc' is not one of 'canopen'"),
    ("robotino2 --fmi 3 --bus lin", "'--bus': 'lin' is not 'can'"),
    ("ackermann --fmi 3 --bus can", "ackermann"),
])
def test_options_that_make_no_network_fmu_get_one_line(options: str, named: str, tmp_path: Path,
                                                       monkeypatch: pytest.MonkeyPatch,
                                                       capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["fmu", *options.split()]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert len(printed.err.splitlines()) == 1
    assert named in printed.err
    assert list(tmp_path.iterdir()) == []


def test_drives_that_share_an_identifier_with_the_node_are_refused_in_one_line(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "clash.toml"
    path.write_text(scene_path("robomaster_mecanum").read_text() + "\n[rig]\nid_base = 512\n")
    assert run(["fmu", str(path), "--fmi", "3", "--bus", "can", "--drives", "robomaster", "-o",
                str(tmp_path / "x.fmu")]) == 2
    line, = capsys.readouterr().err.splitlines()
    assert "rig.drives.node_ids: drive 1 of robomaster uses" in line
    assert [each.name for each in tmp_path.iterdir()] == ["clash.toml"]


def test_the_file_that_no_name_is_given_for_tells_the_bus(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                          capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["fmu", "robotino2", "--fmi", "3", "--bus", "can"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["robotino2_fmi3_can.fmu"]
    assert capsys.readouterr().out.startswith("wrote robotino2_fmi3_can.fmu (")
