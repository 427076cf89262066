"""Steering is not swivelling: a joint that is commanded or has no trail steers, one with trail and no command is that
of a caster, and one that carries all wheels is held. The words say which and why. Here without hinges: a support takes
the place of each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import made_up_robots
from laconic.errors import BadInput
from laconic.robot.importer import Imported
from laconic.scene import Scene
from laconic.simulation import simulate
from made_up_robots import BOX, MJCF, SDF, TWO_WHEELS, inertial, joint, link, robot, wheel

POSITION = '<joint name="{0}"><command_interface name="position"/></joint>'
VELOCITY = '<joint name="{0}"><command_interface name="velocity"/></joint>'
STATE = '<joint name="{0}"><state_interface name="position"/></joint>'
FORK = link("fork", inertial(0.1, (1e-4,) * 3))
LIMIT = '<limit lower="{0}" upper="{1}" effort="1" velocity="1"/>'


def control(*joints: str) -> str:
    return f'<ros2_control name="c" type="system">{"".join(joints)}</ros2_control>'


def swivelling(trail: float, kind: str = "continuous", more: str = "", *parts: str) -> str:
    """Two wheels and a third on a fork ahead of them, which trails by so much."""
    return robot(TWO_WHEELS, FORK, joint("turn", kind, "base", "fork", "0.3 0 0", axis="0 0 1", more=more),
                 wheel("front", "fork", f"{-trail} 0 -0.05"), *parts)


def imported(folder: Path, text: str, name: str = "robot.urdf", **answers: Any) -> tuple[Imported, Scene]:
    return made_up_robots.imported(folder, text, name, **{"hinges": False} | answers)


def support_words(found: Imported) -> str:
    (words,) = (each for each in found.assumptions if each.startswith("vehicle.support[1]"))
    return words


STEERS = "front is steered by turn, which is not modelled; it carries a load and slides without drag (steered: "
TRANSMISSION = '<transmission name="t"><joint name="turn"/><actuator name="m"/></transmission>'
PLUGIN = ('<gazebo><plugin name="ackermann" filename="libackermann.so"><front_steering>turn</front_steering></plugin>'
          "</gazebo>")
WATCHER = ('<gazebo><plugin name="joint_state_publisher" filename="libx.so"><joint_name>turn</joint_name></plugin>'
           "</gazebo>")


@pytest.mark.parametrize(("trail", "kind", "more", "part", "words"), [
    (0.0, "continuous", "", "", STEERS + "zero trail)"),
    (0.001, "continuous", "", "", STEERS + "zero trail)"),
    (0.0, "continuous", "", control(POSITION.format("turn")),
     STEERS + "zero trail, commanded by position interface of ros2_control)"),
    (0.04, "continuous", "", control(VELOCITY.format("turn")),
     STEERS + "trail 40 mm, commanded by velocity interface of ros2_control)"),
    (0.04, "continuous", "", TRANSMISSION, STEERS + "trail 40 mm, commanded by transmission t)"),
    (0.04, "continuous", "", PLUGIN, STEERS + "trail 40 mm, commanded by plugin ackermann)"),
    (0.0, "revolute", LIMIT.format(-0.5, 0.5), "", STEERS + "zero trail)"),
    (0.02, "revolute", LIMIT.format(-0.5, 0.5), "",
     "caster front swivels freely about turn, without drag (trail 20 mm, no command, turns within limits of 57°)"),
    (0.02, "revolute", LIMIT.format(-0.5, 0.5), control(POSITION.format("turn")),
     STEERS + "trail 20 mm, commanded by position interface of ros2_control)"),
    (0.04, "continuous", "", control(STATE.format("turn")),
     "caster front swivels freely about turn, without drag (trail 40 mm, no command)"),
    (0.04, "continuous", "", WATCHER, "caster front swivels freely about turn, without drag (trail 40 mm, no command)"),
    (0.04, "continuous", "", "", "caster front swivels freely about turn, without drag (trail 40 mm, no command)"),
    (0.04, "revolute", LIMIT.format(-3.14, 3.14), "", "caster front swivels freely about turn")])
def test_the_words_say_whether_a_wheel_is_steered_or_swivels_and_why(
        tmp_path: Path, trail: float, kind: str, more: str, part: str, words: str) -> None:
    found, scene = imported(tmp_path, swivelling(trail, kind, more, part))
    assert words in support_words(found)
    (support,) = scene.vehicle["support"]
    is_steered = words.startswith(STEERS)
    assert support["x_m"] == pytest.approx(0.3 - trail if is_steered else 0.3)  # a caster is on average at its swivel


def test_a_steered_wheel_that_drives_is_named_as_both_and_those_that_only_roll_are_not_driven(tmp_path: Path) -> None:
    text = swivelling(0.0, "continuous", "", control(POSITION.format("turn"), VELOCITY.format("front")))
    found, scene = imported(tmp_path, text)
    assert "commanded by position interface of ros2_control; driven: commanded by velocity" in support_words(found)
    assert [each.get("driven") for each in scene.vehicle["wheel"]] == [False, False]
    assert ("front drives the robot and is not modelled as a wheel, as it is steered or slides: a support carries its "
            "load, its steering is held straight, and a force on the body takes the place of its drive; left, right "
            "only roll") in found.remarks
    assert {each.signal for each in scene.inputs} == {"body_force_N[1]", "body_moment_Nm"}
    assert any("this force takes the place of front and pushes ahead with about 0.3" in each
               for each in found.assumptions)
    assert simulate(scene.with_run(duration_s=1.0)).columns["velocity_body_m_per_s[1]"][-1] == pytest.approx(0.3, 0.02)


def test_wheels_that_a_file_commands_are_driven_and_the_others_are_not(tmp_path: Path) -> None:
    text = robot(TWO_WHEELS.replace("0.02 0.01 0.03", "0.02 0 0.03"), wheel("rear_left", "base", "-0.2 0.2 -0.05"),
                 wheel("rear_right", "base", "-0.2 -0.2 -0.05"), control(VELOCITY.format("left"),
                                                                         VELOCITY.format("right")))
    found, scene = imported(tmp_path, text, rollers={"": "none"}, friction_coefficient=0.8)
    assert [each.get("driven", True) for each in scene.vehicle["wheel"]] == [True, True, False, False]
    assert [each.signal for each in scene.inputs] == ["axle_torque_Nm[1]", "axle_torque_Nm[2]"]
    assert 'driven = false  # the file commands other joints, and not this one' in found.text
    assert simulate(scene.with_run(duration_s=1.0)).columns["velocity_body_m_per_s[1]"][-1] == pytest.approx(0.3, 0.02)


def test_a_file_that_commands_nothing_leaves_all_wheels_driven(tmp_path: Path) -> None:
    _, scene = imported(tmp_path, robot(TWO_WHEELS))
    assert all(each.get("driven", True) for each in scene.vehicle["wheel"])


def test_a_joint_that_mimics_a_commanded_one_is_commanded(tmp_path: Path) -> None:
    more = '<mimic joint="mast"/>'
    mast = link("top") + joint("mast", "continuous", "base", "top", axis="0 0 1")
    found, _ = imported(tmp_path, swivelling(0.04, "continuous", more, mast, control(POSITION.format("mast"))))
    assert STEERS + "trail 40 mm, commanded by joint mast, which it mimics)" in support_words(found)


def test_a_wheel_that_is_named_and_steered_is_held_and_says_why(tmp_path: Path) -> None:
    found, scene = imported(tmp_path, swivelling(0.0), wheels=("left", "right", "front"), rollers={"": "none"},
                            friction_coefficient=0.8)
    assert len(scene.vehicle["wheel"]) == 3
    assert "front is steered by turn (zero trail), which is held in its zero position" in found.remarks


def test_robots_of_steered_wheels_alone_are_refused_with_the_reason(tmp_path: Path) -> None:
    forks = "".join(link(f"{side}_fork") + joint(f"{side}_turn", "continuous", "base", f"{side}_fork", f"0 {y} 0",
                                                 axis="0 0 1") + wheel(side, f"{side}_fork", "0 0 -0.05")
                    for side, y in (("left", 0.2), ("right", -0.2)))
    text = robot(link("base", inertial(5.0, (0.1, 0.1, 0.08)), BOX), forks, control(POSITION.format("left_turn")))
    with pytest.raises(BadInput, match=r"all wheels swivel \(left, right\): left is steered by left_turn \(zero trail, "
                                       r"commanded by position interface of ros2_control\), right is steered by"):
        imported(tmp_path, text)


def test_a_turntable_that_carries_all_wheels_is_held(tmp_path: Path) -> None:
    table = link("body", inertial(2.0, (0.05, 0.05, 0.05))) + joint("table", "continuous", "body", "base", "0 0 0.1",
                                                                    axis="0 0 1")
    found, scene = imported(tmp_path, robot(TWO_WHEELS, table, control(POSITION.format("table"))))
    assert len(scene.vehicle["wheel"]) == 2
    assert "joint table carries all wheels; it is held in its zero position" in found.remarks


def test_a_caster_below_a_turntable_is_one(tmp_path: Path) -> None:
    table = link("body", inertial(2.0, (0.05, 0.05, 0.05))) + joint("table", "continuous", "body", "base", axis="0 0 1")
    found, scene = imported(tmp_path, swivelling(0.04, "continuous", "", table))
    assert len(scene.vehicle["wheel"]) == 2
    assert "caster front swivels freely about turn" in support_words(found)


def test_an_actuator_steers(tmp_path: Path) -> None:
    front = """<body name="fork" pos="0.3 0 0"><joint name="turn" axis="0 0 1"/><geom type="box" size=".01 .01 .01"
      mass=".1"/><body name="wheel" pos="-0.04 0 -0.05"><joint name="front" axis="0 1 0"/>
      <geom type="cylinder" size="0.05 0.01" euler="90 0 0" mass=".5"/></body></body></body></worldbody>"""
    text = MJCF.replace("</body></worldbody>", front)
    assert "caster front swivels freely" in support_words(imported(tmp_path, text, "robot.xml")[0])
    commanded = text.replace("</mujoco>", '<actuator><position name="servo" joint="turn"/></actuator></mujoco>')
    assert STEERS + "trail 40 mm, commanded by actuator servo)" in support_words(
        imported(tmp_path, commanded, "robot.xml")[0])
    tendon = text.replace("</mujoco>", '<tendon><fixed name="t"><joint joint="turn" coef="1"/></fixed></tendon>'
                          '<actuator><motor name="pull" tendon="t"/></actuator></mujoco>')
    assert STEERS + "trail 40 mm, commanded by actuator pull)" in support_words(
        imported(tmp_path, tendon, "robot.xml")[0])


def test_a_joint_of_two_axes_is_that_of_a_steered_wheel(tmp_path: Path) -> None:
    front = """<link name="front_link"><pose relative_to="base">0.3 0 -0.05 0 0 0</pose><inertial><mass>0.5</mass>
      <inertia><ixx>4e-4</ixx><iyy>7e-4</iyy><izz>4e-4</izz></inertia></inertial><collision name="c">
      <pose degrees="true">0 0 0 90 0 0</pose><geometry><cylinder><radius>0.05</radius><length>0.02</length></cylinder>
      </geometry></collision></link><joint name="front" type="universal"><parent>base</parent><child>front_link</child>
      <axis><xyz>0 0 1</xyz><limit><lower>-0.5</lower><upper>0.5</upper></limit></axis><axis2><xyz>0 1 0</xyz></axis2>
      </joint></model>"""
    found, scene = imported(tmp_path, SDF.replace("</model>", front), "robot.sdf")
    assert len(scene.vehicle["wheel"]) == 2
    assert "front (axis2) is steered by front, which is not modelled" in support_words(found)


def test_a_kingpin_that_is_inclined_steers(tmp_path: Path) -> None:
    inclined = swivelling(0.0, "revolute", LIMIT.format(-0.5, 0.5)).replace('axis xyz="0 0 1"', 'axis xyz="0 0.25 1"')
    assert "front is steered by turn" in support_words(imported(tmp_path, inclined)[0])


def test_wheels_without_mass_that_are_only_seen_stand_for_others(tmp_path: Path) -> None:
    """As in the model of a car by one front and one rear wheel, which alone are commanded."""
    seen = ('<visual><origin rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.05" length="0.01"/></geometry>'
            "</visual>")
    virtual = link("virtual", seen) + joint("virtual_joint", "continuous", "base", "virtual", "0 0 -0.05")
    found, scene = imported(tmp_path, robot(TWO_WHEELS, virtual, control(VELOCITY.format("virtual_joint"))))
    assert len(scene.vehicle["wheel"]) == 2
    assert [each.signal for each in scene.inputs] == ["axle_torque_Nm[1]", "axle_torque_Nm[2]"]
    assert any("wheels without mass that are only seen stand for others and are left out: virtual_joint" in each
               for each in found.remarks)
    solid = virtual.replace("visual", "collision")
    with pytest.raises(BadInput, match="wheel virtual_joint has no inertia about its axle; give its link an <inertia>"):
        imported(tmp_path, robot(TWO_WHEELS, solid), rollers={"": "none"})
