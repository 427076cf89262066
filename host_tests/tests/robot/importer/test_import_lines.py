"""Rounding in a file does not decide what robot it is: axles just off one line are brought onto it, and told."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from laconic.errors import BadInput
from laconic.robot.importer import Answers, Imported, import_robot
from laconic.scene import Scene, read_scene
from made_up_robots import BOX, FOUR_WHEELS, inertial, link, robot, wheel

BODY = link("base", inertial(5.0, (0.1, 0.1, 0.08)), BOX)
TOLD = "are brought onto it: "


def imported(folder: Path, text: str, **answers: Any) -> tuple[Imported, Scene]:
    (folder / "robot.urdf").write_text(text, encoding="utf-8")
    found = import_robot(folder / "robot.urdf", Answers(**answers))
    (folder / "robot.toml").write_text(found.text, encoding="utf-8")
    return found, read_scene(folder / "robot.toml")


def two(right_xyz: str = "0 -0.2 -0.05", right_rpy: str = "0 0 0", axis: str = "0 1 0") -> str:
    return robot(BODY, wheel("left", "base", "0 0.2 -0.05"), wheel("right", "base", right_xyz, right_rpy, axis))


def told_of(found: Imported) -> str:
    return next((each.partition(TOLD)[2] for each in found.remarks if TOLD in each), "")


def degrees_of_freedom(scene: Scene) -> int:
    return int(scene.model(scene.core()).dof)


@pytest.mark.parametrize(("xyz", "rpy", "words"), [
    ("0.000001 -0.2 -0.05", "0 0 0", "right by 0° and 0.001 mm"),
    ("0.000000001 -0.2 -0.05", "0 0 0", "right by 0° and 1e-06 mm"),
    ("0.0009 -0.2 -0.05", "0 0 0", "right by 0° and 0.9 mm"),
    ("0.0019 -0.2 -0.05", "0 0 0", "right by 0° and 1.9 mm"),  # 0.5 % of a track of 0.4 m are 2 mm
    ("0 -0.2 -0.05", "0 0 3.14", "right by 0.0913° and 0 mm"),
    ("0 -0.2 -0.05", "0 0 0.000007", "right by 0.000401° and 0 mm"),
    ("0 -0.2 -0.05", "0 0 0.0034", "right by 0.195° and 0 mm"),
    ("0.0008 -0.2 -0.05", "0 0 0.003", "right by 0.172° and 0.8 mm")])
def test_axles_just_off_one_line_are_brought_onto_it_and_both_numbers_are_told(
        tmp_path: Path, xyz: str, rpy: str, words: str) -> None:
    found, scene = imported(tmp_path, two(xyz, rpy))
    assert told_of(found) == words
    assert degrees_of_freedom(scene) == 2
    left, right = scene.vehicle["wheel"]
    assert left["x_m"] == right["x_m"] == 0.0
    assert abs(math.cos(left["axle_rad"])) < 1e-15 and abs(math.cos(right["axle_rad"])) < 1e-15


def test_axles_that_are_one_line_are_told_nothing(tmp_path: Path) -> None:
    assert not told_of(imported(tmp_path, two())[0])
    assert not told_of(imported(tmp_path, two("0 -0.2 -0.05", "0 0 3.141592653589793"))[0])


@pytest.mark.parametrize("yaw", [0.0036, 0.02])
def test_toe_beyond_rounding_is_kept_and_the_one_motion_that_it_leaves_is_told(tmp_path: Path, yaw: float) -> None:
    found, scene = imported(tmp_path, two(right_rpy=f"0 0 {yaw}"))
    assert not told_of(found)
    assert scene.vehicle["wheel"][1]["axle_rad"] - scene.vehicle["wheel"][0]["axle_rad"] == pytest.approx(yaw)
    words = next(each for each in found.remarks if "leave the robot one motion alone" in each)
    assert f"the axle of right is {math.degrees(yaw):.3g}° from that of left" in words


def test_wheels_farther_off_one_line_are_refused_with_joint_and_amount(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"do not meet in one point \(that of right lies 0\.003 m beside that of left, "
                                       r"parallel to it\)"):
        imported(tmp_path, two("0.003 -0.2 -0.05"))
    with pytest.raises(BadInput, match=r"only drive straight.*\(the axle of right lies 0\.003 m beside that of left\)"):
        imported(tmp_path, two("0.003 -0.2 -0.05"), rollers={"": "none"})


def test_a_line_at_any_angle_is_kept_and_its_wheels_are_brought_onto_it(tmp_path: Path) -> None:
    at, ahead = np.radians(30.0), np.array([math.sin(np.radians(30.0)), -math.cos(np.radians(30.0))])
    place = 0.2 * ahead + 3e-4
    text = robot(BODY, wheel("left", "base", f"{-0.2 * ahead[0]} {-0.2 * ahead[1]} -0.05", f"0 0 {at}"),
                 wheel("right", "base", f"{place[0]} {place[1]} -0.05", f"0 0 {at + 1e-3}"))
    found, scene = imported(tmp_path, text)
    assert told_of(found)
    assert degrees_of_freedom(scene) == 2


def test_two_lines_of_wheels_that_skid_are_parallel(tmp_path: Path) -> None:
    askew = FOUR_WHEELS.replace('xyz="-0.2 0.2 -0.05" rpy="0 0 0"', 'xyz="-0.2 0.2 -0.05" rpy="0 0 3.14"').replace(
        "-0.2 -0.2 -0.05", "-0.2004 -0.2 -0.05")
    found, scene = imported(tmp_path, robot(askew), rollers={"": "none"}, friction_coefficient=0.7)
    assert told_of(found) == "rear_left by 0.0913° and 0 mm, rear_right by 0° and 0.4 mm"
    assert len({abs(math.cos(each["axle_rad"])) < 1e-15 for each in scene.vehicle["wheel"]}) == 1
    assert len(found.text.split("axle_torque_Nm")) == 5  # it is pushed ahead


def test_axles_that_nearly_meet_in_one_point_are_turned_to_meet_there(tmp_path: Path) -> None:
    turn = math.atan2(0.5, 1.0)  # the axles of these two meet that of the two between them 1 m to the left
    text = robot(BODY, wheel("left", "base", "0 0.2 -0.05"), wheel("right", "base", "0 -0.2 -0.05"),
                 wheel("front", "base", "0.5 0 -0.05", f"0 0 {turn + 5e-4}"),
                 wheel("rear", "base", "-0.5 0 -0.05", f"0 0 {-turn}"))
    found, scene = imported(tmp_path, text)
    (words,) = (each for each in found.remarks if "are brought to meet in it: " in each)
    assert "front by 0.0" in words
    assert degrees_of_freedom(scene) == 1
    with pytest.raises(BadInput, match=r"do not meet in one point \(that of .* passes the nearest such point at"):
        imported(tmp_path, text.replace(f"{turn + 5e-4}", f"{turn + 0.05}"))


def test_an_axle_across_the_way_ahead_is_named_with_its_angle(tmp_path: Path) -> None:
    text = robot(BODY, wheel("left", "base", "0.2 0 -0.05", "0 0 0.3"), wheel("right", "base", "-0.2 0 -0.05", "0 0 1"))
    found, _ = imported(tmp_path, text, rollers={"": "none"})
    assert any("roll straight ahead (the axle of wheel 2 (right) is 57.3° from across)" in each
               for each in found.remarks)


@pytest.mark.parametrize("roll", ["1.57", "1.5707963", "1.5708"])
def test_a_cylinder_that_is_turned_by_a_rounded_right_angle_keeps_its_radius(tmp_path: Path, roll: str) -> None:
    _, scene = imported(tmp_path, two().replace("1.5707963267948966", roll))
    assert scene.vehicle["wheel_radius_m"] == 0.05


def test_a_caster_that_is_turned_by_a_rounded_right_angle_stands_in_its_middle(tmp_path: Path) -> None:
    pad = ('<collision><origin xyz="0 0.001 0" rpy="-1.57 0 0"/><geometry><box size="0.03 0.02 0.009"/></geometry>'
           "</collision>")
    text = two().replace("</robot>", link("caster", inertial(0.01, (1e-6,) * 3), pad)
                         + '<joint name="c" type="fixed"><parent link="base"/><child link="caster"/>'
                           '<origin xyz="-0.2 0.05 -0.09"/></joint></robot>')
    _, scene = imported(tmp_path, text)
    (support,) = scene.vehicle["support"]
    assert (support["x_m"], support["y_m"]) == pytest.approx((-0.2, 0.051), abs=1e-4)
