"""The FMU of a scene shows that scene: icon, page, default experiment; and speaks to importers without enumerations."""

from __future__ import annotations

import json
import struct
import xml.etree.ElementTree as ET
import zipfile
import zlib
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu
from fmu_importer import ERROR, OK, Importer, generic

from laconic.cli.main import run
from laconic.fmu import make_fmu, start_values
from laconic.scene import read_scene, rigid_scene_names
from laconic.scene.methods import METHODS
from laconic_fmu.archive import MOST_ROWS, output_step, read_parts
from laconic_fmu.icon import BLUE, ORANGE, RED, SIZE, icon_png, icon_svg

BOTH = pytest.mark.parametrize("version", [2, 3])


def pixels_of(png: bytes) -> np.ndarray:
    """A PNG of ours as rows of pixels."""
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    at, data = 8, b""
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at:at + 8])
        body = png[at + 8:at + 8 + size]
        assert struct.unpack(">I", png[at + 8 + size:at + 12 + size])[0] == zlib.crc32(kind + body)
        data += body if kind == b"IDAT" else b""
        at += 12 + size
    rows = np.frombuffer(zlib.decompress(data), np.uint8).reshape(SIZE, 1 + 3 * SIZE)
    assert not rows[:, 0].any()  # no filter
    return rows[:, 1:].reshape(SIZE, SIZE, 3)


def share(picture: np.ndarray, colour: tuple[int, int, int]) -> float:
    """How much of the picture has exactly that colour."""
    return float((picture == colour).all(axis=2).mean())


@pytest.mark.parametrize("name", rigid_scene_names())
def test_the_icon_shows_the_wheels_where_they_are(name: str) -> None:
    values = start_values(read_scene(name))
    root = ET.fromstring(icon_svg(values, "a <b> & c"))
    space = "{http://www.w3.org/2000/svg}"
    assert root.findtext(f"{space}title") == "a <b> & c"
    drawn = [shape for shape in root.findall(f"{space}polygon") if shape.get("fill") == f"#{bytes(BLUE).hex()}"][2:]
    places = np.array([np.mean([[float(c) for c in point.split(",")] for point in shape.get("points").split()], axis=0)
                       for shape in drawn])
    assert len(places) == len(values["wheel_x_m"])
    forward, left = np.array(values["wheel_x_m"]), np.array(values["wheel_y_m"])
    shown = np.stack([-left, -forward], axis=1)  # the first axis up, the second to the left; the picture's y is down
    if len(places) > 1:
        scale = np.linalg.norm(places[0] - places[1]) / np.linalg.norm(shown[0] - shown[1])
        np.testing.assert_allclose(places - places[0], scale * (shown - shown[0]), atol=0.02)
    picture = pixels_of(icon_png(values))
    x, y = np.round(places[0]).astype(int)
    assert (picture == BLUE).all(axis=2)[max(0, y - 12):y + 12, max(0, x - 12):x + 12].any()
    assert share(picture, ORANGE) > 0.001  # which way is forward
    assert share(picture, RED) == 0.0


def test_a_locked_wheel_is_red_and_a_mecanum_base_is_not_an_omni_base() -> None:
    values = start_values(read_scene("kuka_youbot"))
    values["wheel_locked"][2] = 1.0
    assert share(pixels_of(icon_png(values)), RED) > 0.002
    omni = dict(values, roller_rad=[np.pi / 2] * 4)
    assert icon_svg(values, "") != icon_svg(omni, "")


@BOTH
def test_an_fmu_carries_its_scenes_icon_and_page(version: int, tmp_path: Path) -> None:
    seen = {}
    for name in ("turtlebot3_burger", "kuka_youbot"):
        scene = read_scene(name)
        parts = read_parts(make_fmu(scene, tmp_path / f"{name}.fmu", version=version))
        page = parts["documentation/index.html"].decode("utf-8")
        picture = parts["model.png" if version == 2 else "terminalsAndIcons/icon.png"]
        assert picture == icon_png(start_values(scene))
        assert f"<title>{scene.name}</title>" in page
        assert f"<h1>{scene.name}</h1>" in page
        assert scene.source in page
        assert f"{scene.vehicle['mass_kg']:.6g} kg" in page
        assert page.count("<tr><th>") - page.split("Its wheels")[0].count("<tr><th>") >= scene.wheel_count
        assert "<svg" in page
        if version == 3:
            assert parts["terminalsAndIcons/icon.svg"].decode("utf-8").strip() in page
        seen[name] = picture
    assert len(set(seen.values())) == 2


def test_the_page_promises_the_wheels_that_there_can_be() -> None:
    page = read_parts(generic(3))["documentation/index.html"].decode("utf-8")
    assert "up to 16 omni, mecanum or fixed wheels" in page
    assert "any number" not in page
    assert "no swivel casters" in page


def test_a_name_with_markup_stays_text(tmp_path: Path) -> None:
    text = (scene := read_scene("robotino2")).path.read_text(encoding="utf-8")
    (tmp_path / "odd.toml").write_text(text.replace(scene.name, "<b>A & B</b>"), encoding="utf-8")
    parts = read_parts(make_fmu(read_scene(str(tmp_path / "odd.toml")), tmp_path / "x.fmu", version=3))
    page = parts["documentation/index.html"].decode("utf-8")
    assert "<h1>&lt;b&gt;A &amp; B&lt;/b&gt;</h1>" in page
    ET.fromstring(parts["terminalsAndIcons/icon.svg"])


@pytest.mark.parametrize(("duration_s", "step_s", "wanted_s"), [
    (11.0, 0.001, 0.02), (10.0, 0.01, 0.01), (1.0, 0.001, 0.001), (7.007, 0.001, 0.011), (100.0, 1e-4, 0.1),
    (5.0, 5.0, 5.0), (1.25, 1e-3, 0.002)])
def test_the_default_experiments_step_is_a_round_number_of_internal_steps(
        duration_s: float, step_s: float, wanted_s: float) -> None:
    assert output_step(duration_s, step_s) == pytest.approx(wanted_s, rel=1e-12)
    assert duration_s / output_step(duration_s, step_s) <= MOST_ROWS * (1 + 1e-9)


@pytest.mark.parametrize(("steps", "rows"), [
    (10007, 10007), (1009, 1009), (997, 997), (101 * 103, 103), (7000, 700), (7007, 637), (10**9 + 7, 10**9 + 7)])
def test_the_default_experiments_step_divides_the_run_whatever_the_number_of_steps(steps: int, rows: int) -> None:
    step_s = output_step(steps * 0.001, 0.001)
    assert steps * 0.001 / step_s == pytest.approx(rows, rel=1e-9)
    assert steps % round(step_s / 0.001) == 0


@pytest.mark.parametrize("name, version", [
    pytest.param(name, version, marks=pytest.mark.nightly if (number + version) % 2 else [])
    for number, name in enumerate(rigid_scene_names()) for version in (2, 3)])  # at night each in both versions
def test_an_importer_that_takes_the_default_experiment_writes_no_more_than_a_thousand_rows(
        version: int, name: str, tmp_path: Path) -> None:
    fmu = make_fmu(read_scene(name), tmp_path / "x.fmu", version=version, sources=False)
    experiment = fmpy.read_model_description(str(fmu)).defaultExperiment
    step_s, stop_s = float(experiment.stepSize), float(experiment.stopTime)
    assert stop_s / step_s <= MOST_ROWS * (1 + 1e-9)
    if name == "kuka_youbot":
        assert len(simulate_fmu(str(fmu), fmi_type="CoSimulation", output_interval=step_s)) == 551


@pytest.mark.parametrize(("version", "scalar"), [(2, False), (3, False), (3, True)])
def test_without_enumerations_the_numbers_are_whole_numbers_with_their_meaning(
        version: int, scalar: bool, tmp_path: Path) -> None:
    options = {"version": version, "scalar": scalar}
    fmu = make_fmu(read_scene("turtlebot3_burger"), tmp_path / "x.fmu", enumerations=False, **options)
    usual = make_fmu(read_scene("turtlebot3_burger"), tmp_path / "y.fmu", **options)
    assert validate_fmu(str(fmu)) == []
    with zipfile.ZipFile(fmu) as archive:
        assert b"Enumeration" not in archive.read("modelDescription.xml")
    with Importer(fmu) as importer, Importer(usual) as other:
        kinds = {variable.type for variable in importer.variables.values()}
        assert kinds <= {"Real", "Integer", "Boolean", "Float64", "Int64", "Int32", "UInt64"}
        meaning = ", ".join(f"{number} {name}" for number, name in enumerate(METHODS))
        assert importer.variables["method"].description.endswith(f": {meaning}")
        assert (int(importer.variables["method"].min), int(importer.variables["method"].max)) == (0, len(METHODS) - 1)
        first = importer.elements("wheel_kind")[0][0]
        assert importer.variables[first].start.split() == ["2"] * (1 if scalar or version == 2 else 2)
        assert importer.set("method", len(METHODS)) == ERROR
        for each in (importer, other):
            assert each.set("method", 1) == OK
            each.initialize()
            assert each.get("wheel_kind") == [2, 2]
            assert each.set("voltage_V", 3.0, 4.0) == OK
            assert each.step(0.0, 0.01) == OK
        assert importer.get("nu_rad_per_s") == other.get("nu_rad_per_s")


def test_the_command_reports_what_it_made(tmp_path: Path, capsys) -> None:
    assert run(["fmu", "robotino2", "--fmi", "2", "--no-enumerations", "--json", "-o", str(tmp_path / "x.fmu")]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["enumerations"] is False
    assert run(["fmu", "robotino2", "--fmi", "2", "-o", str(tmp_path / "x.txt")]) == 2
    assert not (tmp_path / "x.txt").exists()
