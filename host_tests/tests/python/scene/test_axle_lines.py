"""Plain wheels just off one line are another robot to the core: the command and the core's refusals name the wheel and
by how much, and the numbers that the command gives make one line of them."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from laconic.cli.main import run
from laconic.errors import Refused
from laconic.scene import Scene, read_scene
from laconic.scene.axle_lines import Line, common_line, grouped, line_of, nearly_one_line
from scene_text import table, wheel

HEAD = table("[vehicle]", mass_kg=10.0, yaw_inertia_kgm2=0.4, wheel_radius_m=0.1, wheel_inertia_kgm2=0.01)
RUN = table("[run]", duration_s=0.1, step_s=0.01)
LEFT = wheel("fixed", 0.0, 0.25, axle_deg=90.0)


def written(folder: Path, *wheels: str, more: str = "") -> Path:
    (folder / "robot.toml").write_text(HEAD + "".join(wheels) + more + RUN, encoding="utf-8")
    return folder / "robot.toml"


def read(folder: Path, *wheels: str, more: str = "") -> Scene:
    return read_scene(written(folder, *wheels, more=more))


def dof(scene: Scene) -> int:
    return int(scene.model(scene.core()).dof)


@pytest.mark.parametrize(("right", "words"), [
    (wheel("fixed", 0.0, -0.25, axle_rad=1.5708), "0.00021° and 0 mm off that of wheel 1"),
    (wheel("fixed", 0.0, -0.25, axle_rad=-1.5708), "0.00021° and 0 mm off that of wheel 1"),
    (wheel("fixed", 0.0, -0.25, axle_rad=-1.57), "0.0456° and 0 mm off that of wheel 1"),
    (wheel("fixed", 1e-6, -0.25, axle_rad=-1.5708), "0.00021° and 0.001 mm off that of wheel 1")])
def test_a_wheel_just_off_the_line_of_another_is_told_with_numbers_that_put_it_there(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], right: str, words: str) -> None:
    path = written(tmp_path, LEFT, right)
    assert dof(read_scene(path)) == 1
    assert run(["simulate", str(path)]) == 0
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert f"vehicle.wheel[2]: its axle lies {words}, which makes another robot than one line; give x_m = 0, " in told
    degrees = told.rpartition("axle_deg = ")[2].strip()
    assert dof(read(tmp_path, LEFT, wheel("fixed", 0.0, -0.25, axle_deg=float(degrees)))) == 2


@pytest.mark.parametrize("right", [
    wheel("fixed", 0.0, -0.25, axle_deg=-90.0), wheel("fixed", 0.0, -0.25, axle_deg=89.0),
    wheel("omni", 0.001, -0.25, axle_deg=90.0)])
def test_a_wheel_on_the_line_or_clearly_off_it_or_with_rollers_is_told_nothing(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], right: str) -> None:
    assert run(["simulate", str(written(tmp_path, LEFT, right))]) == 0
    assert capsys.readouterr().err == ""


def test_on_ground_with_friction_it_does_not_matter(tmp_path: Path) -> None:
    right = wheel("fixed", 1e-6, -0.25, axle_deg=90.0)
    assert nearly_one_line(read(tmp_path, LEFT, right))
    assert not nearly_one_line(read(tmp_path, LEFT, right, more=table("[ground]", friction_coefficient=0.8)))


@pytest.mark.parametrize(("off_m", "shown"), [(1e-6, "1e-6"), (0.3, "0.3")])
def test_a_refusal_of_parallel_lines_names_wheel_and_distance(tmp_path: Path, off_m: float, shown: str) -> None:
    scene = read(tmp_path, LEFT, wheel("fixed", off_m, -0.25, axle_deg=90.0))
    with pytest.raises(Refused, match=rf"vehicle\.wheel\[2\]\.kind: fixed wheels on parallel axle lines only drive "
                                      rf"straight, .* lies {shown} m off the first one's"):
        scene.model(scene.core())


def test_a_refusal_of_every_motion_names_wheel_and_slide(tmp_path: Path) -> None:
    scene = read(tmp_path, LEFT, wheel("fixed", 0.0, -0.25, axle_deg=90.0), wheel("fixed", 0.5, 0.0, axle_deg=0.0),
                 wheel("fixed", -0.5, 0.0, axle_deg=1e-4))
    with pytest.raises(Refused, match=r"vehicle\.wheel\[4\]\.kind: .* would slide by 1\.74533e-6 of its way"):
        scene.model(scene.core())


def test_axles_group_by_line_and_lines_by_direction() -> None:
    axles = [line_of(0.0, 0.2, math.pi / 2.0), line_of(0.0005, -0.2, 1.57), line_of(-0.3, 0.2, -math.pi / 2.0),
             line_of(-0.3, -0.2, 1.573), line_of(0.2, 0.0, 0.5)]
    found = grouped(axles)
    assert [group for group, _ in found] == [[0, 1], [2, 3], [4]]
    assert found[0][1].angle_to(found[1][1]) == 0.0


def test_two_axles_that_differ_by_more_than_the_tolerance_have_no_line_between_them() -> None:
    one, other = line_of(0.0, 0.2, math.pi / 2.0), line_of(0.0, -0.2, math.pi / 2.0 + math.radians(0.3))
    assert common_line([one, other]) is None
    line = common_line([one, line_of(0.0, -0.2, math.pi / 2.0 + math.radians(0.19))])
    assert isinstance(line, Line) and line.angle_to(one) < 1e-15
