"""What stands on the ground beside the wheels, what share each carries, and whether the robot tips."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from laconic.cli.main import run
from laconic.robot.importer import Answers, Imported, import_robot
from laconic.scene import Scene, read_scene
from laconic.simulation import simulate
from made_up_robots import BOX, FOUR_WHEELS, TWO_WHEELS, inertial, joint, link, robot, wheel

ROUND = ('<collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.05" length="0.02"/></geometry>'
         "</collision>")
LIMIT = '<limit lower="-0.5" upper="0.5" effort="1" velocity="1"/>'
BALL = link("ball", '<collision><geometry><sphere radius="0.02"/></geometry></collision>') + joint(
    "b", "fixed", "base", "ball", "-0.15 0 -0.08")


def imported(folder: Path, text: str, **answers: Any) -> tuple[Imported, Scene]:
    (folder / "robot.urdf").write_text(text, encoding="utf-8")
    found = import_robot(folder / "robot.urdf", Answers(**answers))
    (folder / "robot.toml").write_text(found.text, encoding="utf-8")
    return found, read_scene(folder / "robot.toml")


def on_ground(name: str, shape: str, kg: float = 0.1, xyz: str = "-0.15 0 -0.09", tag: str = "collision") -> str:
    parts = [inertial(kg, (1e-5,) * 3)] if kg else []
    return link(name, *parts, f"<{tag}><geometry>{shape}</geometry></{tag}>") + joint(
        f"{name}_joint", "fixed", "base", name, xyz)


def steered_car(*, steer_has_shape: bool) -> str:
    """Four wheels; the links that steer the front ones may have the wheels' shapes."""
    front = "".join(
        link(f"{side}_steer", inertial(0.1, (1e-4,) * 3), ROUND if steer_has_shape else "")
        + joint(f"{side}_steer_joint", "revolute", "base", f"{side}_steer", f"0.2 {y} -0.05", axis="0 0 1", more=LIMIT)
        + wheel(f"{side}_front", f"{side}_steer", "0 0 0") for side, y in (("left", 0.2), ("right", -0.2)))
    return robot(link("base", inertial(9.0, (0.2, 0.2, 0.3)), BOX), front, wheel("rear_left", "base", "-0.2 0.2 -0.05"),
                 wheel("rear_right", "base", "-0.2 -0.2 -0.05"))


def test_a_steering_link_with_the_wheels_shape_takes_no_load_from_held_wheels(tmp_path: Path) -> None:
    named = ("left_front", "right_front", "rear_left", "rear_right")
    answers: dict[str, Any] = {"wheels": named, "rollers": {"": "none"}, "friction_coefficient": 0.7}
    (tmp_path / "plain").mkdir()
    _, plain = imported(tmp_path / "plain", steered_car(steer_has_shape=False), **answers)
    found, shaped = imported(tmp_path, steered_car(steer_has_shape=True), **answers)
    assert shaped.vehicle["support"] == [] == plain.vehicle["support"]
    assert any("left_steer touches the ground and is no support: it lies within the footprint of wheel left_front"
               in each for each in found.remarks)
    locked = [simulate(each.with_run(duration_s=0.1)).columns["wheel_load_N[1]"][0] for each in (plain, shaped)]
    assert locked[0] == pytest.approx(locked[1])


def test_a_steering_link_with_the_wheels_shape_is_one_support_with_its_wheel(tmp_path: Path) -> None:
    _, scene = imported(tmp_path, steered_car(steer_has_shape=True), hinges=False)
    assert [(each["x_m"], each["y_m"]) for each in scene.vehicle["support"]] == [(0.2, 0.2), (0.2, -0.2)]


SMALL = '<box size="0.03 0.03 0.02"/>'


@pytest.mark.parametrize(("part", "why"), [
    (on_ground("base_footprint_marker", SMALL), "by its name it marks a place"),
    (on_ground("plate", '<box size="0.03 0.03 0.001"/>', xyz="-0.15 0 -0.0995"), "its shape is 1 mm thin"),
    (on_ground("disc", '<cylinder radius="0.03" length="0.0005"/>', xyz="-0.15 0 -0.0997"), "its shape is 0.5 mm thin"),
    (on_ground("point", '<box size="0.001 0.001 0.001"/>', kg=0.0, xyz="-0.15 0 -0.0995"), "its shape is 1 mm thin"),
    (on_ground("box", SMALL, kg=0.0), "it has no mass; give it an <inertial> if it carries a load"),
    (on_ground("drawn", SMALL, tag="visual"), "its shape is only seen; give it a <collision> if it carries a load"),
    (on_ground("cover", SMALL, xyz="0.03 0.2 -0.09"), "it lies within the footprint of wheel left, which carries"),
    (on_ground("pan", '<box size="0.3 0.2 0.02"/>'), "it lies flat on the ground over 0.2 m and more, as a body does")])
def test_a_shape_that_only_marks_or_hides_a_place_is_no_support_and_says_why(tmp_path: Path, part: str, why: str
                                                                             ) -> None:
    found, scene = imported(tmp_path, robot(TWO_WHEELS, part))
    assert scene.vehicle["support"] == []
    assert any("touches the ground and is no support: " in each and why in each for each in found.remarks)


@pytest.mark.parametrize("part", [
    on_ground("skid", SMALL), on_ground("glide", '<cylinder radius="0.015" length="0.02"/>'),
    on_ground("caster", SMALL, kg=0.0), on_ground("knob", '<sphere radius="0.01"/>', kg=0.0)])
def test_a_shape_that_carries_is_a_support(tmp_path: Path, part: str) -> None:
    found, scene = imported(tmp_path, robot(TWO_WHEELS, part))
    assert [(each["x_m"], each["y_m"]) for each in scene.vehicle["support"]] == [(-0.15, 0.0)]
    assert len(found.supports) == 1


def test_each_ball_of_one_link_is_a_support(tmp_path: Path) -> None:
    balls = "".join(f'<collision><origin xyz="{x} 0 -0.08"/><geometry><sphere radius="0.02"/></geometry></collision>'
                    for x in (-0.15, 0.15))
    _, scene = imported(tmp_path, robot(TWO_WHEELS).replace(BOX, BOX + balls))
    assert [each["x_m"] for each in scene.vehicle["support"]] == [-0.15, 0.15]


def test_a_caster_of_two_wheels_is_one_support(tmp_path: Path) -> None:
    fork = link("fork", inertial(0.1, (1e-4,) * 3)) + joint("swivel", "continuous", "base", "fork", "-0.2 0 0",
                                                            axis="0 0 1")
    twins = wheel("one", "fork", "-0.03 0.02 -0.07", radius=0.03) + wheel("two", "fork", "-0.03 -0.02 -0.07",
                                                                          radius=0.03)
    _, scene = imported(tmp_path, robot(TWO_WHEELS, fork, twins), hinges=False)
    assert [(each["x_m"], each["y_m"]) for each in scene.vehicle["support"]] == [(-0.2, 0.0)]


def test_a_wheel_without_friction_is_a_support(tmp_path: Path) -> None:
    third = wheel("third", "base", "-0.2 0 -0.07", radius=0.03)
    slippery = '<gazebo reference="third_link"><mu1>0</mu1><mu2>0</mu2></gazebo>'
    found, scene = imported(tmp_path, robot(TWO_WHEELS, third, slippery))
    assert len(scene.vehicle["wheel"]) == 2
    assert [each["x_m"] for each in scene.vehicle["support"]] == [-0.2]
    assert any("third slides without drag, as its friction is 0 in the file" in each for each in found.assumptions)


def test_every_wheel_and_support_is_listed_with_its_share_of_the_weight(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = robot(TWO_WHEELS.replace("0.02 0.01 0.03", "-0.06 0 0.03"), BALL)
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    assert run(["import", str(tmp_path / "robot.urdf"), "-o", str(tmp_path / "robot.toml")]) == 0
    told = capsys.readouterr().out
    # 5 kg at −0.06 m and two wheels at 0: the ball at −0.15 m bears 5·0.06/0.15 of 6 kg
    assert "support 1: ball at (-0.15, 0) m; carries 33.3 % of the weight (19.6 N)" in told
    assert "wheel 1 19.6 N (33.3 %), wheel 2 19.6 N (33.3 %), support 1 19.6 N (33.3 %)" in told
    assert "slides without drag; carries 33.3 % of the weight (19.6 N)" in (tmp_path / "robot.toml").read_text()
    assert run(["import", str(tmp_path / "robot.urdf"), "-o", str(tmp_path / "robot.toml"), "--json"]) == 0
    standing = json.loads(capsys.readouterr().out)["standing"]
    assert standing["stands"] and standing["support_load_N"] == pytest.approx([6.0 * 9.80665 / 3.0])


TIPS = [(robot(TWO_WHEELS.replace("0.02 0.01 0.03", "0.06 0 0.03")),
         "nothing keeps it from tipping: it stands in one line (wheel 1 and wheel 2), and its centre of mass is 50 mm"),
        (robot(TWO_WHEELS.replace("0.02 0.01 0.03", "0 0 0.03")),
         "nothing keeps it from tipping: it stands in one line (wheel 1 and wheel 2), and its centre of mass is above "
         "it; give what else it stands on"),
        (robot(TWO_WHEELS.replace("0.02 0.01 0.03", "0.06 0 0.03"), BALL),
         "it tips: its centre of mass lies 50 mm outside what it stands on, beyond the line from")]


@pytest.mark.parametrize("options", [[], ["--friction", "0.7"]])
@pytest.mark.parametrize(("text", "words"), TIPS)
def test_what_tips_is_one_line_at_import_in_the_scene_at_simulate_and_in_the_outputs(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, words: str, options: list[str]) -> None:
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    scene = str(tmp_path / "robot.toml")
    assert run(["import", str(tmp_path / "robot.urdf"), "-o", scene, *options]) == 0
    assert capsys.readouterr().out.count(words) == 1
    assert (tmp_path / "robot.toml").read_text(encoding="utf-8").count(words) == 1
    assert run(["simulate", scene]) == 0
    printed = capsys.readouterr()
    assert printed.err.count(f"warning: {scene}: the robot: {words}") == 1
    assert printed.out.count(words) == 1
    assert run(["simulate", scene, "--json"]) == 0
    assert words in json.loads(capsys.readouterr().out)["standing"]["tips"]


def test_a_robot_that_stands_is_told_nothing_of_tipping(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found, _ = imported(tmp_path, robot(TWO_WHEELS.replace("0.02 0.01 0.03", "-0.02 0 0.03"), BALL))
    assert not found.standing.tips
    assert run(["simulate", str(tmp_path / "robot.toml")]) == 0
    assert "tip" not in capsys.readouterr().err


def test_loads_are_outputs_of_an_imported_robot_on_ground_with_friction(tmp_path: Path) -> None:
    text = robot(TWO_WHEELS.replace("0.02 0.01 0.03", "-0.06 0 0.03"), BALL)
    _, scene = imported(tmp_path, text, friction_coefficient=0.8)
    loads = simulate(scene).columns
    assert loads["wheel_load_N[1]"][0] == pytest.approx(2.0 * 9.80665)
    assert loads["support_load_N[1]"][0] == pytest.approx(2.0 * 9.80665)
    # pushed ahead at 0.3 m/s² at com_z: m a h / 0.15 m more on the ball, once the push is on
    shift = 6.0 * 0.3 * scene.vehicle["com_z_m"] / 0.15
    assert loads["support_load_N[1]"][50] == pytest.approx(2.0 * 9.80665 + shift, rel=0.02)
    assert sum(each[50] for name, each in loads.items() if "_load_N" in name) == pytest.approx(6.0 * 9.80665)


def test_loads_of_a_robot_without_supports_have_no_column_of_them(tmp_path: Path) -> None:
    _, scene = imported(tmp_path, robot(FOUR_WHEELS), rollers={"": "none"}, friction_coefficient=0.8)
    assert "support_load_N" not in (tmp_path / "robot.toml").read_text(encoding="utf-8")
    assert simulate(scene.with_run(duration_s=0.1)).columns_of("wheel_load_N").shape[1] == 4
