"""URDF and xacro become scenes: sums equal to MuJoCo's, wheels wherever they hang, marks where the file is silent."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from laconic.cli.main import run
from laconic.robot.importer import Answers, import_robot
from laconic.scene import read_scene
from laconic.scene.table import read_toml
from made_up_robots import BOX, FOUR_WHEELS, TWO_WHEELS, inertial, joint, link, robot, sums_by_mujoco, wheel

NOTHING_SAID = Answers()


def imported(tmp_path: Path, text: str, answers: Answers = NOTHING_SAID, name: str = "robot.urdf") -> dict[str, Any]:
    (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "scene.toml").write_text(import_robot(tmp_path / name, answers).text, encoding="utf-8")
    scene = read_scene(tmp_path / "scene.toml")
    scene.plant(scene.core())
    return read_toml(tmp_path / "scene.toml").plain()


NESTED = robot(
    link("footprint"), link("base", inertial(5.0, (0.1, 0.12, 0.08), "0.02 0.01 0.03", "0.1 0.2 0.3", 0.01), BOX),
    joint("up", "fixed", "footprint", "base", "0.01 0 0.1", "0 0 0.2"),
    link("bogie", inertial(0.7, (2e-3, 3e-3, 4e-3), "0.05 0 0", "0.4 0 0")),
    joint("rocker", "revolute", "base", "bogie", "-0.1 0 -0.02", "0 0 -0.2", "0 1 0",
          '<limit lower="-0.3" upper="0.3" effort="1" velocity="1"/>'),
    link("arm", inertial(0.3, (1e-3, 1e-3, 1e-4), "0 0 0.2")),
    joint("shoulder", "continuous", "base", "arm", "0.1 0 0.1", "0 0 0", "0 0 1"),
    wheel("left", "bogie", "0.1 0.2 -0.03"), wheel("right", "bogie", "0.1 -0.2 -0.03"))


def test_masses_centre_and_yaw_inertia_are_the_sums_of_another_library(tmp_path: Path) -> None:
    vehicle = imported(tmp_path, NESTED)["vehicle"]
    mass, com, yaw = sums_by_mujoco(tmp_path / "robot.urdf")
    assert vehicle["mass_kg"] == pytest.approx(mass, rel=1e-8)
    assert (vehicle["com_x_m"], vehicle["com_y_m"]) == pytest.approx(tuple(com[:2]), abs=1e-8)
    assert vehicle["yaw_inertia_kgm2"] == pytest.approx(yaw, rel=1e-8)
    assert vehicle["com_z_m"] == pytest.approx(com[2] - (0.1 - 0.02 - 0.03 - 0.05), abs=1e-8)


def test_wheels_that_hang_on_other_links_are_where_they_are_in_the_base(tmp_path: Path) -> None:
    wheels = imported(tmp_path, NESTED)["vehicle"]["wheel"]
    assert [each["kind"] for each in wheels] == ["fixed", "fixed"]
    middle = [sum(each[key] for each in wheels) / 2.0 for key in ("x_m", "y_m")]
    # base turned by 0.2 at (0.01, 0), bogie turned back at (-0.1, 0) in it, wheels 0.1 ahead in the bogie
    assert middle == pytest.approx([0.01 - 0.1 * math.cos(0.2) + 0.1, -0.1 * math.sin(0.2)], abs=1e-8)
    assert [each["axle_deg"] for each in wheels] == pytest.approx([-90.0, -90.0], abs=1e-6)


@pytest.mark.parametrize(("rpy", "axis", "axle_deg"), [
    ("0 0 0", "0 1 0", -90.0), ("0 0 0", "0 -1 0", 90.0), ("-1.5707963267948966 0 0", "0 0 1", -90.0),
    ("1.5707963267948966 0 0", "0 0 1", 90.0), ("0 0 1.5707963267948966", "1 0 0", -90.0)])
def test_a_wheel_keeps_the_sense_in_which_its_joint_turns(tmp_path: Path, rpy: str, axis: str, axle_deg: float) -> None:
    text = robot(link("base", inertial(5.0, (0.1, 0.1, 0.08)), BOX), wheel("left", "base", "0 0.2 -0.05", rpy, axis),
                 wheel("right", "base", "0 -0.2 -0.05"))
    found = imported(tmp_path, text)
    assert found["vehicle"]["wheel"][0]["axle_deg"] == pytest.approx(axle_deg, abs=1e-6)
    assert found["vehicle"]["wheel_inertia_kgm2"] == pytest.approx(7e-4)
    torque = {each["signal"]: each["value"][0] for each in found["input"]}
    assert torque["axle_torque_Nm[1]"] * -axle_deg > 0.0  # both push ahead


def test_torques_of_the_scene_push_the_robot_ahead(tmp_path: Path) -> None:
    imported(tmp_path, robot(TWO_WHEELS))
    assert run(["simulate", str(tmp_path / "scene.toml"), "--out", str(tmp_path / "run.csv")]) == 0
    head, *_, last = (tmp_path / "run.csv").read_text(encoding="utf-8").splitlines()
    ahead = float(last.split(",")[head.split(",").index("x_m")])
    assert 0.5 < ahead < 0.9  # 0.3 m/s² for 1 s, then rolling for 2 s: 0.75 m, less what turns the wheels


def test_casters_and_shapes_on_the_ground_become_supports(tmp_path: Path) -> None:
    text = robot(TWO_WHEELS, link("fork", inertial(0.1, (1e-4, 1e-4, 1e-4))),
                 joint("swivel", "continuous", "base", "fork", "-0.2 0 0", "0 0 0", "0 0 1"),
                 wheel("caster", "fork", "-0.03 0 -0.07", radius=0.03),
                 link("ball", '<collision><geometry><sphere radius="0.02"/></geometry></collision>'),
                 joint("b", "fixed", "base", "ball", "0.15 0.1 -0.08"))
    vehicle = imported(tmp_path, text, Answers(hinges=False))["vehicle"]
    assert len(vehicle["wheel"]) == 2
    assert [(each["x_m"], each["y_m"]) for each in vehicle["support"]] == [(-0.2, 0.0), (0.15, 0.1)]
    comments = (tmp_path / "scene.toml").read_text(encoding="utf-8")
    assert "x_m = -0.2  # assumption: caster caster swivels freely about swivel" in comments
    assert "x_m = 0.15  # assumption: ball, on the ground" in comments


def test_four_wheels_across_are_asked_for_and_mecanum_rolls_ahead_and_sideways(tmp_path: Path) -> None:
    wheels = imported(tmp_path, robot(FOUR_WHEELS), Answers(rollers={"": "mecanum"}))["vehicle"]["wheel"]
    assert [each["roller_deg"] for each in wheels] == [45.0, -45.0, -45.0, 45.0]
    skid = imported(tmp_path, robot(FOUR_WHEELS), Answers(rollers={"": "none"}, friction_coefficient=0.6))
    assert [each["kind"] for each in skid["vehicle"]["wheel"]] == ["fixed"] * 4
    assert skid["ground"]["friction_coefficient"] == 0.6


def test_rollers_of_the_file_tell_the_kind_and_the_angle(tmp_path: Path) -> None:
    def with_rollers(name: str, xyz: str, sense: float) -> str:
        parts = wheel(name, "base", xyz, radius=0.03)
        for k in range(6):
            turn = 2.0 * math.pi * k / 6.0
            place = f"{0.045 * math.sin(turn)} 0 {-0.045 * math.cos(turn)}"
            parts += link(f"{name}{k}", inertial(0.01, (1e-6, 1e-6, 1e-6)),
                          '<collision><geometry><sphere radius="0.005"/></geometry></collision>')
            parts += joint(f"{name}_roller_{k}", "continuous", f"{name}_link", f"{name}{k}", place, f"0 {-turn} 0",
                           f"{sense} 1 0")
        return parts

    text = robot(link("base", inertial(9.0, (0.2, 0.2, 0.3)), BOX),
                 with_rollers("front_left", "0.2 0.2 -0.05", -1.0), with_rollers("front_right", "0.2 -0.2 -0.05", 1.0),
                 with_rollers("rear_left", "-0.2 0.2 -0.05", 1.0), with_rollers("rear_right", "-0.2 -0.2 -0.05", -1.0))
    vehicle = imported(tmp_path, text)["vehicle"]
    assert [each["roller_deg"] for each in vehicle["wheel"]] == pytest.approx([45.0, -45.0, -45.0, 45.0], abs=1e-6)
    assert vehicle["wheel_radius_m"] == pytest.approx(0.05)
    assert vehicle["wheel_inertia_kgm2"] == pytest.approx(7e-4 + 6 * (0.01 * 0.045 ** 2 + 1e-6), rel=1e-6)
    remarks = import_robot(tmp_path / "robot.urdf", Answers()).remarks
    assert not any("roller" in each for each in remarks)  # they are parts of wheels, on whatever axle they turn


def test_a_mesh_tells_the_radius_of_a_wheel(tmp_path: Path) -> None:
    (tmp_path / "kit" / "meshes").mkdir(parents=True)
    rim = "".join(f"v {50 * math.cos(k / 8)} {y} {50 * math.sin(k / 8)}\n" for k in range(51) for y in (-10, 10))
    faces = "".join(f"f {k} {k + 1} {k + 2}\n" for k in range(1, 100))
    (tmp_path / "kit" / "meshes" / "wheel.obj").write_text(rim + faces, encoding="utf-8")
    mesh = '<mesh filename="package://kit/meshes/wheel.obj" scale="0.001 0.001 0.001"/>'
    text = robot(TWO_WHEELS).replace('<cylinder radius="0.05" length="0.02"/>', mesh).replace(
        '<origin rpy="1.5707963267948966 0 0"/>', "")
    assert imported(tmp_path, text)["vehicle"]["wheel_radius_m"] == pytest.approx(0.05)


XACRO = f"""<robot name="made_up" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="half" default="0.2"/><xacro:property name="half" value="$(arg half)"/>
<xacro:include filename="$(find kit)/wheel.xacro"/>
{link("base", inertial(5.0, (0.1, 0.1, 0.08), "0.02 0.01 0.03"), BOX)}
<xacro:round side="left" y="${{half}}"/><xacro:round side="right" y="${{-half}}"/></robot>"""
MACRO = f"""<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="round" params="side y">
{wheel("${side}", "base", "0 ${y} -0.05")}</xacro:macro></robot>"""


def test_xacro_with_macros_arguments_and_packages_gives_the_robot_of_the_urdf(tmp_path: Path) -> None:
    expected = imported(tmp_path, robot(TWO_WHEELS))
    (tmp_path / "kit").mkdir()
    (tmp_path / "kit" / "wheel.xacro").write_text(MACRO, encoding="utf-8")
    found = imported(tmp_path, XACRO, name="robot.urdf.xacro")
    assert found["vehicle"] == expected["vehicle"]
    wide = imported(tmp_path, XACRO, Answers(xacro_arguments={"half": "0.3"}), "robot.urdf.xacro")
    assert [each["y_m"] for each in wide["vehicle"]["wheel"]] == [0.3, -0.3]


def test_a_package_may_be_given_relative_to_the_working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "src" / "parts").mkdir(parents=True)
    (tmp_path / "robots").mkdir()
    (tmp_path / "src" / "parts" / "wheel.xacro").write_text(MACRO, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    found = imported(tmp_path / "robots", XACRO, Answers(packages={"kit": Path("src/parts")}), "robot.urdf.xacro")
    assert len(found["vehicle"]["wheel"]) == 2


def test_what_is_said_takes_the_place_of_what_is_found(tmp_path: Path) -> None:
    said = Answers(radius_m={"left": 0.06, "": 0.055}, inertia_kgm2={"": 1e-3}, wheels=("right", "left"))
    vehicle = imported(tmp_path, robot(TWO_WHEELS), said)["vehicle"]
    assert [each["y_m"] for each in vehicle["wheel"]] == [-0.2, 0.2]
    assert vehicle["wheel_inertia_kgm2"] == 1e-3
    radii = [each.get("radius_m", vehicle["wheel_radius_m"]) for each in vehicle["wheel"]]
    assert radii == [0.055, 0.06]


def test_the_command_tells_wheels_and_assumptions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "robot.urdf").write_text(robot(TWO_WHEELS), encoding="utf-8")
    assert run(["import", str(tmp_path / "robot.urdf"), "-o", str(tmp_path / "robot.toml")]) == 0
    told = capsys.readouterr().out
    assert "wheel 1: left, fixed, radius 0.05 m at (0, 0.2) m; assumption: a plain wheel" in told
    assert "input[1].signal: assumption: these torques push ahead" in told
    assert run(["simulate", str(tmp_path / "robot.toml")]) == 0
