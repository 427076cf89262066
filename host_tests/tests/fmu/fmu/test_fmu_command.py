"""laconic fmu: what it writes to, what it prints, and which warnings come before the work.

The licences inside FMUs: of everything that others wrote and that is compiled in, from what is installed.
"""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import pytest
from fmu_importer import generic

from laconic.base.paths import SOURCE_DIR, built, scene_path
from laconic.cli.main import run
from laconic.core.grip import percent
from laconic.fmu import make_fmu
from laconic.scene import read_scene
from laconic_fmu.licences import COMPILER_TEXTS, FOLDER, licence_of, licence_parts


@pytest.mark.parametrize("options", ["--fmi 3", "--fmi 2", "--fmi 2 --ssp"])
@pytest.mark.parametrize("as_json", [False, True])
def test_a_device_takes_the_archive_as_it_is(options: str, as_json: bool, capsys) -> None:
    assert run(["fmu", "robotino2", *options.split(), "-o", "/dev/null", *(["--json"] if as_json else [])]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    if as_json:
        assert json.loads(printed.out)["bytes"] is None
    else:
        assert printed.out == "wrote /dev/null: Festo Robotino 2, 3 wheels\n"


@pytest.mark.parametrize(("given", "ending"), [("--fmi 3 -o x.zip", ".fmu"), ("--fmi 3 -o x.ssp", ".fmu"),
                                               ("--fmi 2 --ssp -o x.zip", ".ssp"), ("--fmi 2 --ssp -o x.fmu", ".ssp")])
def test_the_ending_that_is_offered_is_the_one_that_is_taken(
        given: str, ending: str, tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["fmu", "robotino2", *given.split()]) == 2
    assert capsys.readouterr().err.endswith(f"choose a name that ends in {ending}\n")
    assert list(tmp_path.iterdir()) == []


def test_a_scene_in_single_precision_gets_the_warning_that_fmus_compute_in_double(tmp_path: Path, capsys) -> None:
    path = tmp_path / "small.toml"
    path.write_text(scene_path("robotino2").read_text().replace("[run]", '[run]\nreal = "single"'))
    assert run(["fmu", str(path), "--fmi", "3", "-o", str(tmp_path / "x.fmu"), "--json"]) == 0
    printed = capsys.readouterr()
    assert printed.err == f'laconic: warning: {path}: run.real: is "single", but FMUs compute in double precision\n'
    found = json.loads(printed.out)
    assert (found["real"], found["scene_real"]) == ("double", "single")
    assert run(["fmu", "robotino2", "--fmi", "3", "-o", str(tmp_path / "x.fmu")]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(("count", "of", "shown"), [
    (100, 100, "100 %"), (1, 3, "33.3 %"), (9999, 10000, "over 99.9 %"), (1, 1000, "0.1 %"), (99, 100, "99 %")])
def test_a_share_is_shown_as_people_write_it(count: int, of: int, shown: str) -> None:
    assert percent(count, of) == shown


@pytest.mark.parametrize("key", ["axle_rad", "roller_rad"])
def test_an_angle_too_large_to_have_a_direction_is_refused_by_its_name(key: str, tmp_path: Path, capsys) -> None:
    wheel = {"axle_rad": "0.1", "roller_rad": "1.5"} | {key: "1e308"}
    text = scene_path("robotino2").read_text()
    path = tmp_path / "x.toml"
    first = text.index("[[vehicle.wheel]]")
    after = text.index("[", first + len("[[vehicle.wheel]]"))
    lines = "\n".join(f"{name} = {value}" for name, value in wheel.items())
    path.write_text(f'{text[:first]}[[vehicle.wheel]]\nkind = "omni"\nx_m = 0.1\ny_m = 0.0\n{lines}\n\n{text[after:]}')
    assert run(["simulate", str(path)]) == 2
    assert f"vehicle.wheel[1].{key}: a result leaves the range" in capsys.readouterr().err


HEADER = built("parts") / "fmi/fmi3FunctionTypes.h"


def licences_in(fmu: Path) -> dict[str, str]:
    with zipfile.ZipFile(fmu) as archive:
        return {name.removeprefix(FOLDER): archive.read(name).decode("utf-8")
                for name in archive.namelist() if name.startswith(FOLDER)}


def test_an_fmu_has_the_licence_of_the_fmi_headers_beside_ours_with_and_without_sources(tmp_path):
    small = make_fmu(read_scene("robotino2"), tmp_path / "x.fmu", version=3, sources=False)
    for fmu in (generic(2), generic(3), small):
        texts = licences_in(fmu)
        assert set(texts) == {"license.txt", "fmi-headers.txt"}
        assert texts["license.txt"].startswith((SOURCE_DIR / "LICENSE").read_text(encoding="utf-8"))
        assert "fmi-headers.txt" in texts["license.txt"]
        assert "Redistributions in binary form must reproduce" in texts["fmi-headers.txt"]


def test_the_nodes_fmu_has_the_licence_of_its_generated_code_too():
    texts = licences_in(built("fmu") / "LaconicNode_fmi3.fmu")
    assert set(texts) == {"license.txt", "fmi-headers.txt", "cantools.txt"}
    assert "Erik Moqvist" in texts["cantools.txt"]


@pytest.mark.parametrize(("platforms", "parts"), [
    (["x86_64-linux", "aarch64-linux"], {"zig", "glibc"}), (["x86_64-windows"], {"zig", "mingw-w64", "musl"}),
    (["aarch64-darwin"], {"zig"})])
def test_binaries_of_the_compiler_for_other_platforms_bring_the_licences_of_what_it_adds(tmp_path, platforms, parts):
    for key, name in COMPILER_TEXTS.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"licence of {key}", encoding="utf-8")
    made = licence_parts(b"ours\n", HEADER, {}, platforms, tmp_path)
    assert set(made) == {f"{FOLDER}{key}.txt" for key in {"license", "fmi-headers", *parts}}
    assert all(made[f"{FOLDER}{key}.txt"] == f"licence of {key}".encode() for key in parts)


def test_a_source_that_begins_without_its_licence_is_refused_by_its_path(tmp_path):
    (tmp_path / "bare.h").write_text("/* What it is for. */\n", encoding="utf-8")
    with pytest.raises(SystemExit, match=r"bare\.h: begins without its licence"):
        licence_of(tmp_path / "bare.h")
