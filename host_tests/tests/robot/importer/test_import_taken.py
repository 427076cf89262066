"""Nothing of a wheel is dropped without a word: armature, gears, limits, friction, impossible inertias, shapes off
their axle. A push reaches what its line says."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from laconic.robot.importer import Answers, Imported, import_robot
from laconic.scene import Scene, read_scene
from laconic.simulation import simulate
from made_up_robots import BOX, FOUR_WHEELS, MJCF, SDF, THREE_AROUND, TWO_WHEELS, inertial, joint, link, robot, wheel


def imported(folder: Path, text: str, name: str = "robot.urdf", **answers: Any) -> tuple[Imported, Scene]:
    (folder / name).write_text(text, encoding="utf-8")
    found = import_robot(folder / name, Answers(**answers))
    (folder / "robot.toml").write_text(found.text, encoding="utf-8")
    return found, read_scene(folder / "robot.toml")


def has(found: Imported, words: str) -> bool:
    return any(words in each for each in found.remarks)


def test_armature_of_a_joint_is_inertia_of_its_wheel_and_not_of_the_robot(tmp_path: Path) -> None:
    armed = MJCF.replace('axis="0 1 0"', 'axis="0 1 0" armature="0.02"')
    found, scene = imported(tmp_path, armed, "robot.xml")
    _, plain = imported(tmp_path, MJCF, "robot.xml")
    assert scene.vehicle["wheel_inertia_kgm2"] == pytest.approx(0.02 + 7e-4)
    assert scene.vehicle["yaw_inertia_kgm2"] == plain.vehicle["yaw_inertia_kgm2"]
    assert has(found, "armature of joints counts as inertia of the wheels: left 0.02 kg·m², right 0.02 kg·m²")
    assert not has(found, "more than m r²")  # a rotor behind a gear may have any


@pytest.mark.parametrize(("inertia", "is_possible"), [(0.00124, True), (0.00126, False), (0.14, False)])
def test_an_inertia_that_no_wheel_has_is_told_with_what_is_possible(tmp_path: Path, inertia: float, is_possible: bool
                                                                    ) -> None:
    text = robot(TWO_WHEELS).replace('iyy="0.0007"', f'iyy="{inertia}"')
    found, scene = imported(tmp_path, text)  # of 0.5 kg within 0.05 m: 0.00125 at most
    assert has(found, "wheel left has an inertia of") != is_possible
    assert is_possible or has(found, "more than m r² = 0.00125 kg·m² of 0.5 kg within a radius of 0.05 m")
    assert scene.vehicle["wheel_inertia_kgm2"] == inertia
    said, _ = imported(tmp_path, text, inertia_kgm2={"": 7e-4})
    assert not has(said, "wheel left has an inertia of")


@pytest.mark.parametrize("shape", ['<cylinder radius="0.05" length="0.02"/>', '<sphere radius="0.05"/>'])
def test_a_shape_off_its_axle_keeps_its_own_radius_and_is_told(tmp_path: Path, shape: str) -> None:
    text = robot(TWO_WHEELS).replace('<cylinder radius="0.05" length="0.02"/>', shape).replace(
        '<origin rpy="1.5707963267948966 0 0"/>', '<origin xyz="0.0095 0 0" rpy="1.5707963267948966 0 0"/>')
    found, scene = imported(tmp_path, text)
    assert scene.vehicle["wheel_radius_m"] == pytest.approx(0.05)
    assert [each["x_m"] for each in scene.vehicle["wheel"]] == [0.0, 0.0]
    assert has(found, "the shapes of wheel left lie 9.5 mm off its axle; its radius is taken as theirs, 0.05 m")


def test_a_mesh_off_its_axle_keeps_its_own_radius(tmp_path: Path) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    points = "".join(f"v {0.05 * np.cos(a) + 0.01} {y} {0.05 * np.sin(a)}\n" for a in turn for y in (-0.01, 0.01))
    faces = "".join(f"f {k} {k + 1} {k + 2}\n" for k in range(1, 118))
    (tmp_path / "wheel.obj").write_text(points + faces, encoding="utf-8")
    text = robot(TWO_WHEELS).replace('<cylinder radius="0.05" length="0.02"/>', '<mesh filename="wheel.obj"/>').replace(
        '<origin rpy="1.5707963267948966 0 0"/>', "")
    found, scene = imported(tmp_path, text)
    assert scene.vehicle["wheel_radius_m"] == pytest.approx(0.05)
    assert has(found, "the shapes of wheel right lie 10 mm off its axle")


def test_an_arm_that_reaches_the_ground_is_no_wheel(tmp_path: Path) -> None:
    arm = link("arm", inertial(0.1, (1e-4,) * 3),
               '<collision><origin xyz="0.1 0 0"/><geometry><box size="0.2 0.02 0.02"/></geometry></collision>')
    found, scene = imported(tmp_path, robot(TWO_WHEELS, arm, joint("lift", "continuous", "base", "arm", "0 0 0.05")))
    assert len(scene.vehicle["wheel"]) == 2
    assert has(found, "joint lift turns on a level axle, and its shapes lie off it, so it is no wheel")


def test_a_cylinder_square_to_its_axle_is_no_wheel(tmp_path: Path) -> None:
    found, _ = imported(tmp_path, robot(TWO_WHEELS, wheel("third", "base", "-0.2 0 -0.05").replace(
        'axis xyz="0 1 0"', 'axis xyz="1 0 0"')))
    assert has(found, "joint third turns on a level axle, and its cylinder lies 90.0° from it, so it is no wheel")


NEW = ('<transmission name="{0}_drive"><type>transmission_interface/SimpleTransmission</type><joint name="{0}">'
       "<hardwareInterface>hardware_interface/VelocityJointInterface</hardwareInterface></joint><actuator name=\"m\">"
       "<mechanicalReduction>30</mechanicalReduction></actuator></transmission>")
OLD = ('<transmission type="pr2_mechanism_model/SimpleTransmission" name="{0}_drive"><actuator name="m"/>'
       '<joint name="{0}"/><mechanicalReduction>30</mechanicalReduction></transmission>')


@pytest.mark.parametrize("form", [NEW, OLD], ids=["new", "old"])
def test_gear_ratios_of_transmissions_are_named(tmp_path: Path, form: str) -> None:
    found, _ = imported(tmp_path, robot(TWO_WHEELS, form.format("left"), form.format("right")))
    assert has(found, "gear ratios are left out: left 30 (transmission left_drive")
    assert re.search(r"#   gear_ratio = …      # 30 \(transmission left_drive", found.text)


def test_gears_of_actuators_and_springs_are_named(tmp_path: Path) -> None:
    text = MJCF.replace('axis="0 1 0"', 'axis="0 1 0" stiffness="2"', 1).replace(
        "</mujoco>", '<actuator><motor name="m" joint="left" gear="12"/><motor name="n" joint="right"/></actuator>'
        "</mujoco>")
    found, _ = imported(tmp_path, text, "robot.xml")
    assert has(found, "gear ratios are left out: left 12 (actuator m)")
    assert has(found, "left out of joints: spring of 2 N·m/rad (left)")


def test_a_gearbox_is_named_with_its_ratio(tmp_path: Path) -> None:
    box = ('<joint name="g" type="gearbox"><parent>left_link</parent><child>right_link</child>'
           "<gearbox_ratio>4</gearbox_ratio><gearbox_reference_body>base</gearbox_reference_body></joint></model>")
    found, scene = imported(tmp_path, SDF.replace("</model>", box), "robot.sdf")
    assert has(found, "joint g is a gearbox of ratio 4, which is left out")
    assert len(scene.vehicle["wheel"]) == 2


def test_limits_of_effort_and_speed_are_named_once(tmp_path: Path) -> None:
    found, _ = imported(tmp_path, robot(TWO_WHEELS).replace("</joint>", '<limit effort="10" velocity="5"/></joint>'))
    assert has(found, "left out of joints: effort limit 10 N·m and speed limit 5 rad/s (left, right)")


def test_friction_of_surfaces_is_named_where_it_is_left_out(tmp_path: Path) -> None:
    surfaces = "".join(f'<gazebo reference="{side}_link"><mu1>0.9</mu1><mu2>0.9</mu2></gazebo>'
                       for side in ("left", "right"))
    found, _ = imported(tmp_path, robot(TWO_WHEELS, surfaces))
    assert has(found, "friction of surfaces is left out: 0.9 (left, right); --friction MU takes one for the ground")
    assert not has(imported(tmp_path, robot(TWO_WHEELS, surfaces), friction_coefficient=0.9)[0], "friction of surfaces")


def end_of_push(scene: Scene) -> tuple[float, float, float]:
    """Velocity ahead and aside, and the way turned, at the end of the push."""
    found = simulate(scene.with_run(duration_s=1.0)).columns
    return tuple(found[each][-1] for each in  # type: ignore[return-value]
                 ("velocity_body_m_per_s[1]", "velocity_body_m_per_s[2]", "heading_rad"))


HEAVY = robot(TWO_WHEELS.replace('iyy="0.0007"', 'iyy="0.14"'))
ROBOTS: dict[str, tuple[str, dict[str, Any]]] = {
    "two wheels": (robot(TWO_WHEELS), {}), "heavy wheels": (HEAVY, {}),
    "heavy wheels with friction": (HEAVY, {"friction_coefficient": 0.8}),
    "three omni wheels": (robot(THREE_AROUND), {"rollers": {"": "omni"}}),
    "three omni wheels, off centre": (robot(THREE_AROUND).replace(
        '<origin xyz="0 0 0" rpy="0 0 0"/><mass value="3.0"/>', '<origin xyz="0.01 0.03 0" rpy="0 0 0"/>'
        '<mass value="3.0"/>'), {"rollers": {"": "omni"}}),
    "three omni wheels with friction": (robot(THREE_AROUND), {"rollers": {"": "omni"}, "friction_coefficient": 0.8}),
    "four mecanum wheels": (robot(FOUR_WHEELS), {"rollers": {"": "mecanum"}}),
    "four that skid": (robot(FOUR_WHEELS), {"rollers": {"": "none"}, "friction_coefficient": 0.8}),
    "damped": (robot(TWO_WHEELS).replace("</joint>", '<dynamics damping="0.02"/></joint>'), {}),
    "off centre": (robot(TWO_WHEELS.replace("0.02 0.01 0.03", "-0.05 0.06 0.03")), {})}


@pytest.mark.parametrize("name", ROBOTS)
def test_a_push_reaches_what_its_line_says(tmp_path: Path, name: str) -> None:
    text, answers = ROBOTS[name]
    found, scene = imported(tmp_path, text, **answers)
    assert any("these torques push ahead with about 0.3 m/s² for 1 s" in each for each in found.assumptions)
    ahead, aside, turned = end_of_push(scene)
    assert ahead == pytest.approx(0.3, rel=0.02)
    assert abs(aside) < 0.005 and abs(turned) < 0.01


def test_a_push_that_the_ground_cannot_give_says_what_it_reaches(tmp_path: Path) -> None:
    found, scene = imported(tmp_path, robot(TWO_WHEELS), friction_coefficient=0.01)
    words = next(each for each in found.assumptions if "these torques push ahead" in each)
    reached = float(re.search(r"for 1 s and reach ([\d.]+) m/s, as wheels slip", words)[1])  # type: ignore[index]
    assert reached < 0.25
    assert end_of_push(scene)[0] == pytest.approx(reached, rel=0.1)


SIDE = link("base", inertial(5.0, (0.1, 0.1, 0.08), "0.02 0.01 0.03"), BOX)
BALL = '<collision><geometry><sphere radius="0.02"/></geometry></collision>'
BALLS = "".join(link(f"{side}_ball", inertial(0.1, (1e-5,) * 3), BALL)
                + joint(f"{side}_fix", "fixed", "base", f"{side}_ball", f"0 {y} -0.08")
                for side, y in (("left", 0.2), ("right", -0.2)))


@pytest.mark.parametrize("more", [{}, {"friction_coefficient": 0.8}])
@pytest.mark.parametrize(("turn", "words"), [(math.pi / 2, "push to the left"), (-math.pi / 2, "push to the left"),
                                             (math.pi / 6, "push along 30° from ahead")])
def test_a_robot_that_rolls_across_is_pushed_that_way(tmp_path: Path, turn: float, words: str, more: dict[str, Any]
                                                      ) -> None:
    """Its axles lie on a line that is not across."""
    axle = np.array([-math.sin(turn), math.cos(turn)]) * 0.2
    text = robot(SIDE, wheel("one", "base", f"{axle[0]} {axle[1]} -0.05", f"0 0 {turn}"),
                 wheel("two", "base", f"{-axle[0]} {-axle[1]} -0.05", f"0 0 {turn}"), BALLS)
    found, scene = imported(tmp_path, text, **more)
    assert any(f"these torques {words} with about 0.3 m/s² for 1 s" in each for each in found.assumptions)
    off = math.degrees(math.asin(abs(math.sin(turn))))
    assert has(found, f"let the robot roll straight ahead (the axle of wheel 1 (one) is {off:.3g}° from across); "
                      f"the inputs {words} instead")
    ahead, aside, turned = end_of_push(scene)
    assert (ahead, aside) == pytest.approx((0.3 * math.cos(turn), 0.3 * abs(math.sin(turn))), abs=0.006)
    assert abs(turned) < 0.01


def test_a_robot_that_can_only_turn_is_turned_about_the_point_that_its_line_says(tmp_path: Path) -> None:
    angle = math.atan2(0.3, 0.5)  # both axles meet 0.5 m to the left of the middle
    text = robot(SIDE, wheel("front", "base", "0.3 0 -0.05", f"0 0 {angle}"),
                 wheel("rear", "base", "-0.3 0 -0.05", f"0 0 {-angle}"), BALLS)
    found, scene = imported(tmp_path, text)
    assert any("these torques turn the robot about (0, 0.5) m, its fastest wheel with about 0.3 m/s² for 1 s" in each
               for each in found.assumptions)
    columns = simulate(scene.with_run(duration_s=1.0)).columns
    assert columns["yaw_rate_rad_per_s"][-1] == pytest.approx(0.3 / math.hypot(0.3, 0.5), rel=0.02)
    assert columns["wheel_speed_rad_per_s[1]"][-1] == pytest.approx(0.3 / 0.05, rel=0.02)


def test_torques_of_damped_axles_grow_with_the_speed_so_that_the_start_is_no_jolt(tmp_path: Path) -> None:
    """Steady torques against such damping would lift the wheels at the start and reach the speed at once."""
    damped = robot(TWO_WHEELS).replace("</joint>", '<dynamics damping="5"/></joint>')
    found, scene = imported(tmp_path, damped)
    assert found.text.count('kind = "table"') == 2
    assert any("these torques push ahead with about 0.3 m/s² for 1 s" in each for each in found.assumptions)
    columns = simulate(scene).columns
    speed = columns["velocity_body_m_per_s[1]"]
    at = [round(time / scene.run.step_s) for time in (0.25, 0.5, 1.0, 1.5)]
    assert [float(speed[k]) for k in at] == pytest.approx([0.075, 0.15, 0.3, 0.0], abs=0.006)
