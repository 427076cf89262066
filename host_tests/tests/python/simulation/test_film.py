"""`laconic simulate --film`: a moving picture in one SVG that shows the run, and the same one each time."""

from __future__ import annotations

import math
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.cli.main import run
from laconic.pictures.film.moving_picture import FILMED, film
from laconic.pictures.film.timing import LONGEST_S, timing_of
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT
from laconic.simulation import Trajectory, simulate, usual_signals
from scene_text import constant, table, wheel

SVG = "{http://www.w3.org/2000/svg}"
MOST_BYTES = 300_000
VEHICLE = {"mass_kg": 20.0, "yaw_inertia_kgm2": 1.0, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 0.004}


def filmed(scene: Scene) -> Trajectory:
    return simulate(scene, (*usual_signals(scene), *FILMED))


def keyframes(text: str, name: str) -> list[tuple[float, str]]:
    """(percent, declarations) of one rule."""
    rule = re.search(rf"@keyframes {name} \{{ (.*?) \}}\n", text)
    assert rule is not None
    return [(float(share), what) for share, what in re.findall(r"([\d.]+)% \{ (.*?) \}", rule[1])]


def test_the_readmes_picture_is_what_its_command_makes(tmp_path: Path) -> None:
    readme = (SOURCE_DIR / "README.md").read_text(encoding="utf-8")
    picture, = re.findall(r"!\[[^\]]*\]\((docs/\S+\.svg)\)", readme)
    command, = re.findall(rf"laconic (simulate \S+ --film) {picture}", readme)
    made = tmp_path / "film.svg"
    assert run([*command.split(), str(made)]) == 0
    assert made.read_bytes() == (SOURCE_DIR / picture).read_bytes()
    assert made.stat().st_size < MOST_BYTES


def test_the_robot_is_where_the_run_has_it_at_each_keyframe() -> None:
    trajectory = filmed(read_scene("robotino2"))
    text, time_s = film(trajectory), trajectory.time_s
    timing = timing_of(time_s)
    frames = keyframes(text, "body")
    assert [share for share, _ in frames] == sorted(share for share, _ in frames)
    assert frames[0][0] == 0.0 and frames[-1][0] == 100.0 and len(frames) == len(timing.rows) + 1
    for (share, what), row in zip(frames[:-1], timing.rows, strict=True):
        x, y, turned = map(float, re.findall(r"-?[\d.]+", what))
        assert time_s[row] == pytest.approx(share / 100.0 * timing.length_s, abs=5e-3)  # real time
        expected = (trajectory.columns["origin_x_m"][row], trajectory.columns["origin_y_m"][row])
        assert (x, y) == pytest.approx(expected, abs=6e-5)
        assert math.radians(turned) == pytest.approx(trajectory.columns["heading_rad"][row], abs=1e-4)


def test_a_tread_moves_as_far_as_its_wheel_rolls_and_the_path_is_drawn_as_far_as_it_was_driven() -> None:
    trajectory = filmed(read_scene("example_two_wheel_sizes"))
    text = film(trajectory)
    for number, given in enumerate(trajectory.scene.vehicle["wheel"], start=1):
        radius = given.get("radius_m", trajectory.scene.vehicle["wheel_radius_m"])
        last = float(re.findall(r"-?[\d.]+", keyframes(text, f"w{number}")[-1][1])[0])
        assert -last == pytest.approx(radius * trajectory.columns[f"wheel_angle_rad[{number}]"][-1], abs=6e-5)
    shares = [float(re.findall(r"-?[\d.]+", what)[0]) for _, what in keyframes(text, "path")]
    assert shares[0] == 1.0 and shares[-1] == 0.0 and shares == sorted(shares, reverse=True)


@pytest.mark.parametrize("duration_s, speed", [(0.01, 1), (20.0, 1), (20.5, 2), (90.0, 5), (600.0, 50), (1e5, 5000)])
def test_a_long_run_is_shown_faster(duration_s: float, speed: int) -> None:
    timing = timing_of(np.linspace(0.0, duration_s, 2001))
    assert timing.speed == speed and timing.rows[0] == 0 and timing.rows[-1] == 2000
    assert timing.length_s < LONGEST_S + 2.0 and len(timing.rows) < 300
    assert ("real time" in timing.in_words()) == (speed == 1)


def made_up(wheels: str, **run_of: object) -> str:
    return table("[vehicle]", **VEHICLE) + wheels + table("[run]", **{"duration_s": 1.0, "step_s": 0.01, **run_of})


@pytest.mark.parametrize("text", [
    pytest.param(made_up(""), id="puck at rest"),
    pytest.param(made_up("".join(wheel("omni", 0.2 * math.cos(i), 0.2 * math.sin(i), axle_rad=i) for i in range(16)) +
                         constant("axle_torque_Nm[3]", 0.2)), id="sixteen wheels"),
    pytest.param(made_up(wheel("fixed", 0.0, 0.2, axle_deg=-90.0) + wheel("fixed", 0.0, -0.2, axle_deg=-90.0),
                         duration_s=0.01), id="one step of a differential drive"),
    pytest.param('name = "<b> & \\"quotes\\" "\n' + made_up("") + table("[outputs]", signals=["x_m"], every_s=0.5),
                 id="name with markup, few outputs")])
def test_any_robot_gives_a_whole_picture_without_a_script(text: str, tmp_path: Path) -> None:
    path, picture = tmp_path / "my.toml", tmp_path / "film.svg"
    path.write_text(text, encoding="utf-8")
    assert run(["simulate", str(path), "--film", str(picture), "--out", str(tmp_path / "run.csv")]) == 0
    root = ElementTree.parse(picture).getroot()
    assert {each.tag.removeprefix(SVG) for each in root.iter()} <= {
        "svg", "title", "style", "rect", "text", "path", "polyline", "polygon", "circle", "clipPath", "g", "use"}
    assert not re.search(r"\bnan\b|\binf\b", picture.read_text(encoding="utf-8"))
    columns = (tmp_path / "run.csv").read_text(encoding="utf-8").partition("\n")[0]
    assert ("origin_x_m" in columns) is False  # what the film needs is not written


def test_a_run_that_is_refused_on_the_way_is_filmed_up_to_there(tmp_path: Path,
                                                               capsys: pytest.CaptureFixture[str]) -> None:
    path, picture = tmp_path / "my.toml", tmp_path / "film.svg"
    wheels = "".join(wheel("omni", 0.2 * math.cos(i), 0.2 * math.sin(i), axle_rad=i) for i in range(3))
    late = table("[[input]]", signal="body_moment_Nm", kind="steps", t_s=[0.5], value=[1e3])
    path.write_text(made_up(wheels + late, method=EXPLICIT, step_s=0.1), encoding="utf-8")
    assert run(["simulate", str(path), "--film", str(picture)]) == 1
    assert str(picture) in capsys.readouterr().err and "s in real time" in picture.read_text(encoding="utf-8")


def test_a_film_is_an_svg(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["simulate", "s1", "--film", str(tmp_path / "film.gif")]) == 2
    assert ".svg" in capsys.readouterr().err
