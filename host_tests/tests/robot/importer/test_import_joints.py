"""Damping and friction of wheels' joints, and which plain wheels can drive."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.robot.importer import Answers, import_robot
from laconic.scene import Scene, read_scene
from laconic.simulation import simulate
from made_up_robots import BOX, THREE_AROUND, TWO_WHEELS, inertial, link, robot, wheel

JOINT = '<axis xyz="0 1 0"/></joint>'
RUBBING = robot(TWO_WHEELS).replace(JOINT, '<axis xyz="0 1 0"/><dynamics damping="0.02" friction="0.3"/></joint>')
MJCF = """<mujoco><worldbody><body name="base"><geom type="box" size=".2 .15 .05" mass="5"/>
  <body name="l" pos="0 .2 -.05"><joint name="left" axis="0 1 0" damping=".02" frictionloss=".3"/>
    <geom type="cylinder" size=".05 .01" euler="90 0 0" mass=".5"/></body>
  <body name="r" pos="0 -.2 -.05"><joint name="right" axis="0 1 0" damping=".02" frictionloss=".4"/>
    <geom type="cylinder" size=".05 .01" euler="90 0 0" mass=".5"/></body></body></worldbody></mujoco>"""
MOTOR = """[vehicle.motor]
resistance_ohm = 1.9
torque_constant_Nm_per_A = 0.031
back_emf_Vs_per_rad = 0.031
gear_ratio = 10.0
viscous_friction_Nms = 2e-4

"""


def imported(folder: Path, text: str, *options: str, name: str = "robot.urdf") -> Scene:
    (folder / name).write_text(text, encoding="utf-8")
    assert run(["import", str(folder / name), "-o", str(folder / "robot.toml"), *options]) == 0
    return read_scene(folder / "robot.toml")


def test_friction_of_joints_is_named_where_it_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_text(RUBBING, encoding="utf-8")
    found = import_robot(tmp_path / "robot.urdf", Answers())
    assert [remark for remark in found.remarks if "left (0.3 N·m), right (0.3 N·m); --friction MU" in remark]
    assert found.remarks[-1] in found.text


@pytest.mark.parametrize("name, text, own", [("robot.urdf", RUBBING, {}), ("robot.xml", MJCF, {1: 0.4})])
def test_friction_of_joints_becomes_that_of_the_axles_on_ground_with_friction(
        tmp_path: Path, name: str, text: str, own: dict[int, float]) -> None:
    vehicle = imported(tmp_path, text, "--friction", "0.8", name=name).vehicle
    assert vehicle["ground"]["axle_friction_Nm"] == 0.3
    assert {i: w["axle_friction_Nm"] for i, w in enumerate(vehicle["wheel"]) if "axle_friction_Nm" in w} == own


def test_the_torques_that_push_an_imported_robot_overcome_its_axles_friction(tmp_path: Path) -> None:
    plain = TWO_WHEELS.replace("0.02 0.01 0.03", "0 0 0.03")
    run_of = simulate(imported(tmp_path, RUBBING.replace(TWO_WHEELS, plain), "--friction", "0.8"))
    assert 0.15 < run_of.columns["x_m"][-1] < 0.25  # ahead for a second, then the axles stop it
    assert not run_of.columns["nu_rad_per_s[1]"][-1]


@pytest.mark.parametrize("damping", ["0.02", "0.5"])
def test_the_torques_that_push_an_imported_robot_make_up_for_the_damping_of_its_joints(
        tmp_path: Path, damping: str) -> None:
    damped = JOINT.replace("/></joint>", f'/><dynamics damping="{damping}"/></joint>')
    ends = [simulate(imported(tmp_path, robot(TWO_WHEELS).replace(JOINT, joint)).with_run(duration_s=1.0))
            for joint in (JOINT, damped)]
    free, held = (float(np.hypot(end.columns["x_m"][-1] - end.columns["x_m"][-2],
                                 end.columns["y_m"][-1] - end.columns["y_m"][-2])) for end in ends)
    assert held == pytest.approx(free, rel=0.1)


def test_the_head_tells_what_to_take_out_for_motors_and_where_the_damping_goes(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    damped = imported(tmp_path, RUBBING)
    path = tmp_path / "robot.toml"
    text = path.read_text(encoding="utf-8")
    head = text[: text.index("name =")]
    assert "viscous_friction_Nms = …      # the motor_damping_Nms below, divided by gear_ratio²" in head
    assert "takes the place of every motor_gain_Nm_per_V and motor_damping_Nms: take these lines out" in head
    path.write_text(text.replace("[[vehicle.wheel]]", MOTOR + "[[vehicle.wheel]]", 1), encoding="utf-8")
    capsys.readouterr()
    assert run(["simulate", str(path)]) == 2
    told = capsys.readouterr().err
    assert "motor_gain_Nm_per_V: is given besides [vehicle.motor], and so is motor_damping_Nms; keep one" in told
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("motor_")]
    path.write_text("\n".join(lines), encoding="utf-8")
    moved = read_scene(path)
    assert damped.vehicle["motor_damping_Nms"] == 0.02
    assert moved.vehicle["motor"]["viscous_friction_Nms"] * moved.vehicle["motor"]["gear_ratio"] ** 2 == 0.02


def test_a_robot_without_damping_is_told_nothing_of_it(tmp_path: Path) -> None:
    imported(tmp_path, robot(TWO_WHEELS))
    assert "viscous_friction_Nms" not in (tmp_path / "robot.toml").read_text(encoding="utf-8")


def test_wheels_on_all_sides_of_their_axles_point_are_taken_as_plain_only_if_it_is_said(tmp_path: Path) -> None:
    kinds = [wheel["kind"] for wheel in imported(tmp_path, robot(THREE_AROUND), "--rollers", "none").vehicle["wheel"]]
    assert kinds == ["fixed"] * 3
    driven = imported(tmp_path, robot(THREE_AROUND), "--rollers", "omni")
    assert simulate(driven).columns["x_m"][-1] > 0.1


def test_plain_wheels_whose_axles_meet_beside_them_are_taken_as_they_are(tmp_path: Path) -> None:
    ahead = -np.arctan2(0.5, 1.0)  # its axle meets that of the two behind 1 m to the left
    text = (link("base", inertial(3.0, (0.02, 0.02, 0.03)), BOX) + wheel("left", "base", "0 0.2 -0.05")
            + wheel("right", "base", "0 -0.2 -0.05") + wheel("front", "base", "0.5 0 -0.05", f"0 0 {-ahead}"))
    wheels = imported(tmp_path, robot(text)).vehicle["wheel"]
    assert [each["kind"] for each in wheels] == ["fixed"] * 3


def test_mecanum_rollers_on_the_ground_lie_as_a_diamond_around_the_middle(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from made_up_robots import FOUR_WHEELS

    wheels = imported(tmp_path, robot(FOUR_WHEELS), "--rollers", "mecanum").vehicle["wheel"]
    assert "an X seen from above" in capsys.readouterr().out
    for each in wheels:
        angle = each["axle_rad"] + each["roller_rad"]
        outward = np.array([each["x_m"], each["y_m"]]) / np.hypot(each["x_m"], each["y_m"])
        assert abs(outward @ [np.cos(angle), np.sin(angle)]) < 1e-9  # across the line from the middle


@pytest.mark.parametrize("length", ["1e200", "1e308", "1e-8", "1e-300"])
def test_the_length_of_an_axis_does_not_matter(tmp_path: Path, length: str) -> None:
    longer = imported(tmp_path, RUBBING.replace("0 1 0", f"0 {length} 0")).vehicle
    assert longer == imported(tmp_path, RUBBING).vehicle
