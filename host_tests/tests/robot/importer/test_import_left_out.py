"""What a file has and a scene has not is named and counts for nothing: joints on wheels, equalities, actuators."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.errors import BadInput
from laconic.robot.importer import Answers, Imported, import_robot
from laconic.scene import read_scene
from made_up_robots import MJCF, SDF, TWO_WHEELS, inertial, joint, link, robot, wheel

OUTER = TWO_WHEELS + wheel("outer", "left_link", "0 0.03 0")
ALL_THREE = Answers(wheels=("left", "right", "outer"))


def imported(folder: Path, text: str, answers: Answers | None = None, name: str = "robot.urdf") -> Imported:
    (folder / name).write_text(text, encoding="utf-8")
    return import_robot(folder / name, answers or Answers())


def wheels_of(folder: Path, found: Imported) -> list[tuple[float, float]]:
    """Where each lies across, and its inertia."""
    (folder / "robot.toml").write_text(found.text, encoding="utf-8")
    vehicle = read_scene(folder / "robot.toml").vehicle
    return [(each["y_m"], each.get("inertia_kgm2", vehicle["wheel_inertia_kgm2"])) for each in vehicle["wheel"]]


def test_a_wheel_on_the_axle_of_a_wheel_is_no_part_of_it_and_is_named(tmp_path: Path) -> None:
    found = imported(tmp_path, robot(OUTER))
    assert wheels_of(tmp_path, found) == [(0.2, 7e-4), (-0.2, 7e-4)]
    assert [each for each in found.remarks if each.startswith("joint outer turns about the axle of left, on which")]


def test_a_wheel_on_a_wheel_counts_once_where_both_are_named(tmp_path: Path) -> None:
    found = imported(tmp_path, robot(OUTER), ALL_THREE)
    assert wheels_of(tmp_path, found) == [(0.2, 7e-4), (-0.2, 7e-4), (0.23, 7e-4)]
    assert not [each for each in found.remarks if "is held" in each]
    assert "wheel outer hangs on wheel left; each turns on its own, from the base" in found.remarks


def test_a_wheel_that_another_wheel_carries_round_is_refused(tmp_path: Path) -> None:
    aside = TWO_WHEELS + wheel("outer", "left_link", "0.1 0.03 0")
    with pytest.raises(BadInput, match="--wheel outer: hangs on wheel left, which carries it round; name one"):
        imported(tmp_path, robot(aside), ALL_THREE)


def test_a_joint_on_a_wheel_that_is_held_turns_with_it_and_leaves_its_shape(tmp_path: Path) -> None:
    ball = '<visual><geometry><sphere radius="0.3"/></geometry></visual>'
    weight = link("w", inertial(0.1, (1e-5, 1e-5, 1e-5)), ball)
    found = imported(tmp_path, robot(TWO_WHEELS, weight, joint("slide", "prismatic", "left_link", "w", "0 0.5 0.02",
                                                               more='<limit effort="1" velocity="1"/>')))
    assert wheels_of(tmp_path, found)[0] == (0.2, pytest.approx(7e-4 + 1e-5 + 0.1 * 0.02**2))
    assert [each for each in found.remarks if each.startswith("joint slide on wheel left is held in its zero position")]


@pytest.mark.parametrize("more, words", [
    ('<equality><joint joint1="left" joint2="right"/></equality>',
     "joint left mimics right, which is not taken over: each wheel turns on its own"),
    ('<equality><joint joint1="left"/></equality>', "joint left is held by an <equality>, which is not taken over"),
    ('<equality><weld body1="left_link" body2="right_link"/></equality>', "<equality> is not taken over: 1 weld"),
    ('<actuator><motor name="m" joint="left"/></actuator>', "actuators are not taken over: m; the inputs are torques"),
    ('<tendon><fixed name="t"><joint joint="left" coef="1"/></fixed></tendon>', "tendons are not taken over: t"),
    ('<option gravity="9.81 0 0"/>', "gravity (9.81 0 0) m/s² is not along -z, which is not taken over"),
    ('<option gravity="0 0 -1.62"/>', "gravity (0 0 -1.62) m/s² is not taken over: wheels bear their loads at 9.80665"),
])
def test_what_a_scene_has_not_of_mjcf_is_named(tmp_path: Path, more: str, words: str) -> None:
    remarks = imported(tmp_path, MJCF.replace("</mujoco>", more + "</mujoco>"), name="robot.xml").remarks
    assert [each for each in remarks if each.startswith(words)]


def test_a_body_without_weight_is_named(tmp_path: Path) -> None:
    text = MJCF.replace('<body name="right_link"', '<body name="right_link" gravcomp="1"')
    assert [each for each in imported(tmp_path, text, name="robot.xml").remarks
            if each == "what has no weight in the file has its weight in a scene: right_link"]


IN_WORLD = '<world name="w">{}<model'


@pytest.mark.parametrize("world, words", [
    ("<gravity>0 1 -9.8</gravity>", "gravity (0 1 -9.8) m/s² is not along -z, which is not taken over; a slope is"),
    ("<physics><gravity>0 0 9.8</gravity></physics>", "gravity (0 0 9.8) m/s² is not along -z"),
    ("<gravity>0 0 -3.7</gravity>", "gravity (0 0 -3.7) m/s² is not taken over: wheels bear their loads at 9.80665")])
def test_gravity_of_a_world_that_a_scene_has_not_is_named(tmp_path: Path, world: str, words: str) -> None:
    found = imported(tmp_path, SDF.replace('<world name="w"><model', IN_WORLD.format(world)), name="robot.sdf")
    assert [each for each in found.remarks if each.startswith(words)]


def test_usual_gravity_of_a_world_and_that_of_another_are_nothing_to_tell(tmp_path: Path) -> None:
    other = '<world name="v"><gravity>1 0 0</gravity></world>'
    for text in (SDF, SDF.replace('<world name="w"><model', IN_WORLD.format("<gravity>0 0 -9.81</gravity>")),
                 SDF.replace('<world name="w">', other + '<world name="w">')):
        assert not [each for each in imported(tmp_path, text, name="robot.sdf").remarks if "gravity" in each]


def test_a_link_without_weight_and_a_gravity_that_is_none_are_named(tmp_path: Path) -> None:
    floating = SDF.replace('<link name="base">', '<link name="base"><gravity>false</gravity>')
    assert "what has no weight in the file has its weight in a scene: base" in imported(
        tmp_path, floating, name="robot.sdf").remarks
    with pytest.raises(BadInput, match=r"<gravity>: has 2 numbers; give 3"):
        imported(tmp_path, SDF.replace('<world name="w"><model', IN_WORLD.format("<gravity>0 -9.8</gravity>")),
                 name="robot.sdf")


@pytest.mark.parametrize("gravity", ["0 0 0", "0 0 -9.81"])
def test_gravity_along_the_vertical_is_nothing_to_tell(tmp_path: Path, gravity: str) -> None:
    text = MJCF.replace("<worldbody>", f'<option gravity="{gravity}"/><worldbody>')
    assert imported(tmp_path, text, name="robot.xml").remarks == imported(tmp_path, MJCF, name="robot.xml").remarks


@pytest.mark.parametrize(("kind", "more", "why"), [
    ("planar", "", "shifts and does not turn"), ("floating", "", "turns about every axis"),
    ("revolute", '<limit lower="-1" upper="1" effort="1" velocity="1"/>', "turns within limits"), ("fixed", "", "")])
def test_what_stands_on_the_ground_and_is_no_wheel_says_why(tmp_path: Path, kind: str, more: str, why: str) -> None:
    third = wheel("third", "base", "-0.2 0 -0.05").replace("</joint>", f"{more}</joint>").replace("continuous", kind)
    found = imported(tmp_path, robot(TWO_WHEELS + third))
    told = [each for each in found.assumptions if "third_link, on the ground, slides without drag" in each]
    assert len(told) == 1 and told[0].endswith(f"; its joint third {why}, so it is no wheel" if why else "drag")
    assert told[0].partition("third_link, ")[2] in found.text
