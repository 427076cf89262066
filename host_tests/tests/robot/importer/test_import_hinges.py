"""Steered wheels, swivel casters and trailers of a robot file become what they are: bodies on hinges. Their first run
goes where the real robot would."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.scene import Scene
from laconic.simulation import simulate
from made_up_robots import BOX, MJCF, SDF, imported, inertial, joint, link, robot, wheel

LIMIT = '<limit lower="{0}" upper="{1}" effort="1" velocity="{2}"/>'


def control(position: tuple[str, ...] = (), velocity: tuple[str, ...] = ()) -> str:
    each = [f'<joint name="{name}"><command_interface name="{kind}"/></joint>'
            for kind, names in (("position", position), ("velocity", velocity)) for name in names]
    return f'<ros2_control name="c" type="system">{"".join(each)}</ros2_control>'


def base(com_x: float = 0.0) -> str:
    return link("base", inertial(10.0, (0.2, 0.2, 0.4), f"{com_x} 0 0.05"), BOX)


def turning(name: str, xyz: str, parent: str = "base", kind: str = "continuous", axis: str = "0 0 1", more: str = ""
            ) -> str:
    """A fork of 0.2 kg on an upright joint."""
    return (link(f"{name}_fork", inertial(0.2, (1e-4,) * 3))
            + joint(f"{name}_turn", kind, parent, f"{name}_fork", xyz, axis=axis, more=more))


def swivel(name: str, x: float, y: float, trail: float = 0.0, scrub: float = 0.0, **more: str) -> str:
    """A wheel of 0.5 kg below such a fork."""
    return turning(name, f"{x} {y} 0", **more) + wheel(name, f"{name}_fork", f"{-trail} {scrub} -0.05")


REAR = wheel("left", "base", "0 0.2 -0.05") + wheel("right", "base", "0 -0.2 -0.05")
ROLL = ("left", "right")


def end_of(scene: Scene) -> dict[str, float]:
    run = simulate(scene)
    assert run.refused is None
    return {name: float(values[-1]) for name, values in run.columns.items()}


def radius_at_origin(end: dict[str, float]) -> float:
    """Of the circle that the body frame's origin runs through, which lies on the carriage's axle."""
    return end["velocity_body_m_per_s[1]"] / end["yaw_rate_rad_per_s"]


def test_a_tricycle_steers_and_drives_by_its_front_wheel(tmp_path: Path) -> None:
    found, scene = imported(tmp_path, robot(base(0.2), REAR, swivel("front", 0.5, 0.0), control(("front_turn",),
                                                                                                ("front",))))
    vehicle = scene.vehicle
    assert vehicle["mass_kg"] == pytest.approx(11.0)  # base 10, wheels 0.5 each; not the front wheel with its fork
    assert vehicle["com_x_m"] == pytest.approx(10.0 * 0.2 / 11.0)
    assert vehicle["yaw_inertia_kgm2"] == pytest.approx(
        0.4 + 2.0 * (4e-4 + 0.5 * 0.2**2) + 10.0 * 0.2**2 - 11.0 * (2.0 / 11.0) ** 2)
    (body,) = vehicle["body"]
    assert (body["hinge"], body["hinge_x_m"], body["mass_kg"]) == ("prescribed", 0.5, 0.7)
    assert body["yaw_inertia_kgm2"] == pytest.approx(1e-4 + 4e-4)
    assert [each["driven"] for each in vehicle["wheel"]] == [False, False, True]
    assert [each.signal for each in scene.inputs] == ["axle_torque_Nm[3]", "steering_angle_rad[front_turn]"]
    assert "zero trail, commanded by position interface of ros2_control" in found.hinges[0]
    assert any("rate_limit_rad_per_s: assumption: the file has no speed limit" in each for each in found.assumptions)
    end = end_of(scene)
    angle = end["hinge_angle_rad[front_turn]"]
    assert angle == pytest.approx(0.3, rel=0.01)
    assert radius_at_origin(end) == pytest.approx(0.5 / math.tan(angle), rel=1e-6)
    assert end["heading_rad"] > 5.5  # nearly the whole circle is seen


def test_an_ackermann_pair_is_coordinated_within_its_stops(tmp_path: Path) -> None:
    limit = LIMIT.format(-0.4, 0.4, 2.0)
    front = "".join(swivel(name, 0.5, y, scrub=scrub, kind="revolute", more=limit)
                    for name, y, scrub in (("fl", 0.18, 0.02), ("fr", -0.18, -0.02)))
    found, scene = imported(tmp_path, robot(base(0.25), REAR, front, control(("fl_turn", "fr_turn"), ROLL)))
    assert [body["hinge"] for body in scene.vehicle["body"]] == ["coordinated"] * 2
    assert [(each.low_rad, each.high_rad, each.rate_limit_rad_per_s) for each in scene.hinges] == [
        (pytest.approx(-0.4), pytest.approx(0.4), 2.0)] * 2
    assert [each["y_m"] for each in scene.vehicle["wheel"][2:]] == [0.02, -0.02]
    assert all("they would contradict each other else" in each for each in found.hinges)
    end = end_of(scene)
    radius = radius_at_origin(end)
    for name, y in (("fl_turn", 0.18), ("fr_turn", -0.18)):
        assert math.tan(end[f"hinge_angle_rad[{name}]"]) == pytest.approx(0.5 / (radius - y), rel=1e-6)
    assert end["hinge_angle_rad[fl_turn]"] <= 0.7 * 0.4


def test_casters_keep_what_they_weigh_and_turn_round(tmp_path: Path) -> None:
    damped = '<dynamics damping="0.003"/>'
    text = robot(base(0.1), REAR, swivel("a", 0.3, 0.1, trail=0.04, more=damped), swivel("b", 0.3, -0.1, trail=-0.04),
                 control((), ROLL))
    _, scene = imported(tmp_path, text)
    one, other = scene.vehicle["body"]
    assert (one["hinge"], one["mass_kg"], one["damping_Nms"]) == ("free", 0.7, 0.003)
    assert one["com_x_m"] == pytest.approx(-0.04 * 0.5 / 0.7)
    assert one["yaw_inertia_kgm2"] == pytest.approx(5e-4 + 0.5 * 0.2 / 0.7 * 0.04**2)
    assert (other["hinge_x_m"], other["hinge_y_m"]) == (0.3, -0.1)
    assert [each["x_m"] for each in scene.vehicle["wheel"][2:]] == pytest.approx([-0.04, -0.04])
    assert [each.start_angle_rad for each in scene.hinges] == pytest.approx([0.0, math.pi])  # as the file places it
    assert scene.vehicle["support"] == []
    end = end_of(scene)
    assert abs(end["hinge_angle_rad[b_turn]"] - end["hinge_angle_rad[a_turn]"]) < 0.3  # turned round, as the first
    radius = radius_at_origin(end)
    assert math.tan(end["hinge_angle_rad[a_turn]"] + math.asin(0.04 / math.hypot(0.3, radius - 0.1))) == pytest.approx(
        0.3 / (radius - 0.1), rel=0.1)  # as a caster trails in a circle


def test_four_swerve_modules_are_coordinated_and_driven(tmp_path: Path) -> None:
    names = ("fl", "fr", "rl", "rr")
    modules = "".join(swivel(name, 0.3 if name[0] == "f" else -0.3, 0.3 if name[1] == "l" else -0.3) for name in names)
    _, scene = imported(tmp_path, robot(base(), modules, control(tuple(f"{name}_turn" for name in names), names)))
    assert [body["hinge"] for body in scene.vehicle["body"]] == ["coordinated"] * 4
    assert scene.vehicle["mass_kg"] == 10.0
    assert {each.signal.partition("[")[0] for each in scene.inputs} == {"axle_torque_Nm", "steering_curvature_per_m"}
    end = end_of(scene)
    assert math.tan(end["hinge_angle_rad[fl_turn]"]) == pytest.approx(0.3 / (radius_at_origin(end) - 0.3), rel=1e-6)
    assert end["hinge_angle_rad[rl_turn]"] == pytest.approx(-end["hinge_angle_rad[fl_turn]"])


def cart(name: str, parent: str, hitch_x: float) -> str:
    return (link(name, inertial(4.0, (0.1, 0.1, 0.2), "-0.5 0 0"))
            + joint(f"{name}_hitch", "continuous", parent, name, f"{hitch_x} 0 0", axis="0 0 1")
            + wheel(f"{name}_left", name, "-0.6 0.15 -0.05") + wheel(f"{name}_right", name, "-0.6 -0.15 -0.05"))


def test_trailers_hang_behind_one_another(tmp_path: Path) -> None:
    text = robot(base(0.1), REAR, swivel("front", 0.5, 0.0), cart("first", "base", -0.2), cart("second", "first", -0.8),
                 control(("front_turn",), ROLL))
    found, scene = imported(tmp_path, text)
    assert "[[vehicle.trailer]]" in found.text
    first, second = (each for each in scene.vehicle["body"] if each["name"].endswith("hitch"))
    assert (first["parent"], first["hinge_x_m"], first["mass_kg"]) == ("carriage", -0.2, 5.0)
    assert (second["parent"], second["hinge_x_m"]) == ("first_hitch", -0.8)
    assert first["com_x_m"] == pytest.approx((4.0 * -0.5 + 2.0 * 0.5 * -0.6) / 5.0)
    assert [each["y_m"] for each in scene.vehicle["wheel"][3:]] == [0.15, -0.15] * 2
    end = end_of(scene.with_run(duration_s=40.0))
    radius = radius_at_origin(end)
    axle = math.sqrt(radius**2 + 0.2**2 - 0.6**2)  # of the first trailer, on its steady circle
    assert end["hinge_angle_rad[first_hitch]"] == pytest.approx(
        -(math.atan(0.2 / radius) + math.atan(0.6 / axle)), abs=0.01)


def test_a_kingpin_with_a_little_trail_and_limits_steers_without_a_command(tmp_path: Path) -> None:
    front = "".join(swivel(name, 0.5, y, trail=0.009, kind="revolute", more=LIMIT.format(-0.5, 0.5, 2.0))
                    for name, y in (("fl", 0.2), ("fr", -0.2)))
    found, scene = imported(tmp_path, robot(base(0.2), REAR, front, control((), ROLL)))
    assert [body["hinge"] for body in scene.vehicle["body"]] == ["coordinated"] * 2
    assert "trail 9 mm, as a kingpin has within limits of 57°" in found.hinges[0]
    assert "the trail of fl_turn, 9 mm, counts as 0" in found.remarks
    assert end_of(scene)["heading_rad"] > 5.0


def test_a_joint_whose_limits_hold_it_is_no_hinge(tmp_path: Path) -> None:
    _, scene = imported(tmp_path, robot(base(0.1), REAR, swivel("front", 0.0, 0.0, kind="revolute",
                                                                more=LIMIT.format(0.0, 0.0, 1.0)).replace(
        'xyz="0.0 0.0 0"', 'xyz="0 0.4 0"'), control((), ROLL)))
    assert not scene.has_hinges and len(scene.vehicle["wheel"]) == 3


def caster_within(stop_rad: float) -> str:
    return robot(base(0.1), REAR, swivel("front", 0.3, 0.0, trail=0.04, kind="revolute",
                                         more=LIMIT.format(-stop_rad, stop_rad, 1)), control((), ROLL))


def test_a_run_ends_before_a_caster_comes_to_its_stop(tmp_path: Path) -> None:
    found, scene = imported(tmp_path, caster_within(0.36))
    assert any(each.startswith("the run ends before this: at t = ") and "comes to its stop" in each
               for each in found.remarks)
    assert 3.0 < scene.run.duration_s < 12.0
    assert end_of(scene)["yaw_rate_rad_per_s"] > 0.1


def test_a_turn_that_a_stop_prevents_is_left_out_with_a_word(tmp_path: Path) -> None:
    found, scene = imported(tmp_path, caster_within(0.1))
    assert any(each.startswith("a turn is refused, as where a caster comes to its stop") for each in found.remarks)
    assert end_of(scene)["velocity_body_m_per_s[1]"] == pytest.approx(0.3, rel=0.01)


def test_tandem_axles_turn_about_their_middle(tmp_path: Path) -> None:
    second = wheel("t_left_2", "t", "-0.8 0.15 -0.05") + wheel("t_right_2", "t", "-0.8 -0.15 -0.05")
    rear = wheel("left_2", "base", "-0.1 0.2 -0.05") + wheel("right_2", "base", "-0.1 -0.2 -0.05")
    text = robot(base(0.1), REAR, rear, swivel("front", 0.5, 0.0), cart("t", "base", -0.3), second,
                 control(("front_turn",), ROLL))
    found, scene = imported(tmp_path, text)
    assert sum("2 parallel axles of" in each for each in found.remarks) == 2
    assert [each["x_m"] for each in scene.vehicle["wheel"]] == pytest.approx([-0.05] * 4 + [0.0] + [-0.7] * 4)
    assert end_of(scene)["heading_rad"] > 3.0


def test_a_caster_without_inertia_is_one_of_mass_0(tmp_path: Path) -> None:
    shape = ('<collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.05" length="0.02"/></geometry>'
             "</collision>")
    caster = (link("fork") + joint("turn", "continuous", "base", "fork", "0.3 0 0", axis="0 0 1") + link("roll", shape)
              + joint("caster", "continuous", "fork", "roll", "-0.03 0 -0.05"))
    _, scene = imported(tmp_path, robot(base(0.1), REAR, caster, control((), ROLL)))
    assert scene.vehicle["body"][0]["mass_kg"] == 0.0
    assert end_of(scene)["heading_rad"] > 3.0


def test_a_caster_whose_wheel_has_no_friction_slides_whatever_its_fork_does(tmp_path: Path) -> None:
    slippery = '<gazebo reference="front_link"><mu1>0</mu1><mu2>0</mu2></gazebo>'
    found, scene = imported(tmp_path, robot(base(0.1), REAR, swivel("front", 0.3, 0.0, trail=0.04), slippery,
                                            control((), ROLL)))
    assert not scene.has_hinges and len(scene.vehicle["support"]) == 1
    assert any("front slides without drag, as its friction is 0 in the file" in each for each in found.assumptions)


def test_a_ball_as_hitch_and_wheels_beyond_it_are_a_trailer(tmp_path: Path) -> None:
    sides = (("l", 0.15), ("r", -0.15))
    more = """<body name="cart" pos="-0.2 0 0"><joint name="hitch" type="ball"/><geom type="box" size=".1 .1 .02"
      pos="-0.5 0 0" mass="4"/>""" + "".join(
        f"""<body name="cart_{side}" pos="-0.6 {y} -0.05"><joint name="cart_{side}" axis="0 1 0"/>
        <geom type="cylinder" size="0.05 0.01" euler="90 0 0" mass=".5"/></body>""" for side, y in sides
    ) + "</body></body></worldbody>"
    found, scene = imported(tmp_path, MJCF.replace("</body></worldbody>", more), "robot.xml")
    assert "trailer, swivels freely, at (-0.2, 0) m" in found.hinges[0]
    assert scene.vehicle["body"][0]["mass_kg"] == pytest.approx(5.0)
    assert end_of(scene)["heading_rad"] > 1.0


def test_two_wheels_below_one_swivel_are_twins(tmp_path: Path) -> None:
    twins = turning("fork", "0.3 0 0") + wheel("l", "fork_fork", "-0.03 0.05 -0.05") + wheel("r", "fork_fork",
                                                                                            "-0.03 -0.03 -0.05")
    found, scene = imported(tmp_path, robot(base(0.1), REAR, twins, control((), ROLL)))
    assert "swivel caster with two wheels" in found.hinges[0]
    assert "twin_m = 0.08" in found.text and "offset_m = 0.01" in found.text
    assert scene.vehicle["body"][0]["mass_kg"] == pytest.approx(1.2)
    assert any("the centre of mass of fork_turn lies 8.33 mm beside the swivel axis" in each for each in found.remarks)
    assert end_of(scene)["heading_rad"] > 3.0


@pytest.mark.parametrize(("axis", "stops"), [("0 0 1", (-1.3, 0.8)), ("0 0 -1", (-0.8, 1.3))])
def test_a_forklift_steers_its_rear_wheel_to_the_right_to_turn_left(tmp_path: Path, axis: str,
                                                                     stops: tuple[float, float]) -> None:
    back = swivel("back", -0.6, 0.0, kind="revolute", axis=axis, more=LIMIT.format(-1.3, 0.8, 1.5))
    found, scene = imported(tmp_path, robot(base(-0.2), REAR, back, control(("back_turn",), ("back",))))
    (hinge,) = scene.hinges
    assert (hinge.low_rad, hinge.high_rad) == pytest.approx(stops)
    assert hinge.rate_limit_rad_per_s == 1.5
    assert any("their signs differ" in each for each in found.remarks) == (axis == "0 0 -1")
    end = end_of(scene)
    assert end["hinge_angle_rad[back_turn]"] == pytest.approx(-0.3, rel=0.01)
    assert radius_at_origin(end) == pytest.approx(0.6 / math.tan(0.3), rel=0.01)


def test_a_frame_with_its_own_axle_on_a_commanded_hinge_is_a_body(tmp_path: Path) -> None:
    rear = (link("rear", inertial(8.0, (0.2, 0.2, 0.3), "-0.3 0.02 0"))
            + joint("middle", "revolute", "base", "rear", "-0.4 0 0", axis="0 0 1", more=LIMIT.format(-0.7, 0.7, 0.5))
            + wheel("b_left", "rear", "-0.4 0.2 -0.05") + wheel("b_right", "rear", "-0.4 -0.2 -0.05"))
    _, scene = imported(tmp_path, robot(base(), REAR, rear, control(("middle",), (*ROLL, "b_left", "b_right"))))
    (body,) = scene.vehicle["body"]
    assert (body["hinge"], body["hinge_x_m"], body["mass_kg"]) == ("prescribed", -0.4, 9.0)
    assert (body["com_x_m"], body["com_y_m"]) == pytest.approx(((8 * -0.3 - 0.4) / 9.0, 8 * 0.02 / 9.0))
    end = end_of(scene)
    assert end["hinge_angle_rad[middle]"] < -0.2  # its front goes to the left
    half = -end["hinge_angle_rad[middle]"] / 2.0
    assert radius_at_origin(end) == pytest.approx(0.4 / math.tan(half), rel=1e-4)


def test_a_commanded_wheel_with_trail_keeps_its_trail(tmp_path: Path) -> None:
    _, scene = imported(tmp_path, robot(base(0.2), REAR, swivel("front", 0.5, 0.0, trail=0.04),
                                        control(("front_turn",), ("front",))))
    assert scene.vehicle["wheel"][2]["x_m"] == pytest.approx(-0.04)
    assert scene.vehicle["body"][0]["hinge"] == "prescribed"
    assert end_of(scene)["heading_rad"] > 3.0


@pytest.mark.parametrize("trail", [0.0, 0.03])
def test_robots_along_y_go_along_y(tmp_path: Path, trail: float) -> None:
    wheels = "".join(wheel(name, "base", f"{x} 0 -0.05", axis="1 0 0") for name, x in (("left", -0.2), ("right", 0.2)))
    front = turning("front", "0 0.5 0") + wheel("front", "front_fork", f"0 {-trail} -0.05", axis="1 0 0")
    commands = control(("front_turn",), ("front",)) if not trail else control((), ROLL)
    _, scene = imported(tmp_path, robot(base(), wheels, front, commands))
    run = simulate(scene).columns
    at = int(2.0 / 0.01)
    assert abs(run["x_m"][at]) < 0.01 < 0.2 < run["y_m"][at]
    assert run["heading_rad"][-1] > 2.0


def test_an_ackermann_car_along_y_turns_about_its_own_axle_line(tmp_path: Path) -> None:
    wheels = "".join(wheel(name, "base", f"{x} 0 -0.05", axis="1 0 0") for name, x in (("left", -0.2), ("right", 0.2)))
    front = "".join(turning(name, f"{x} 0.5 0") + wheel(name, f"{name}_fork", "0 0 -0.05", axis="1 0 0")
                    for name, x in (("fl", -0.2), ("fr", 0.2)))
    _, scene = imported(tmp_path, robot(base(), wheels, front, control(("fl_turn", "fr_turn"), ROLL)))
    end = end_of(scene)
    radius = end["velocity_body_m_per_s[2]"] / end["yaw_rate_rad_per_s"]
    assert math.tan(end["hinge_angle_rad[fl_turn]"] - math.pi / 2.0) == pytest.approx(0.5 / (radius - 0.2), rel=1e-6)


def test_a_module_whose_zero_points_aside_starts_straight_and_says_so(tmp_path: Path) -> None:
    front = turning("front", "0.5 0 0") + wheel("front", "front_fork", "0 0 -0.05", rpy="0 0 1.2")
    found, scene = imported(tmp_path, robot(base(0.2), REAR, front, control(("front_turn",), ("front",))))
    assert any("starts so; joint front_turn is 0 at 68.8°" in each for each in found.remarks)
    assert end_of(scene)["heading_rad"] > 3.0


def test_no_hinges_leaves_supports_and_named_wheels_are_held(tmp_path: Path, capsys: pytest.CaptureFixture[str]
                                                              ) -> None:
    text = robot(base(0.1), REAR, swivel("front", 0.3, 0.0, trail=0.04), control((), ROLL))
    _, scene = imported(tmp_path, text, hinges=False)
    assert not scene.has_hinges and len(scene.vehicle["support"]) == 1
    _, held = imported(tmp_path, text, wheels=(*ROLL, "front"), rollers={"": "none"}, friction_coefficient=0.8)
    assert not held.has_hinges and len(held.vehicle["wheel"]) == 3
    _, both = imported(tmp_path, text, wheels=(*ROLL, "front"), hinges=True)
    assert both.has_hinges
    for options, kind in ((["--no-hinges"], "[[vehicle.support]]"), ([], "[[vehicle.caster]]")):
        assert run(["import", str(tmp_path / "robot.urdf"), "-o", "-", *options]) == 0
        assert kind in capsys.readouterr().out


def test_friction_with_hinges_judges_the_margin_and_says_so(tmp_path: Path) -> None:
    text = robot(base(0.1), REAR, swivel("front", 0.3, 0.0, trail=0.04), control((), ROLL))
    found, scene = imported(tmp_path, text, friction_coefficient=0.8)
    assert "ground" not in scene.vehicle and scene.vehicle["friction_coefficient"] == 0.8
    assert any(each.startswith("--friction: wheels on hinges do not slip") for each in found.remarks)
    assert any(each.startswith("the ground is ideal, as wheels on hinges do not slip; --no-hinges") for each in
               found.remarks)


def test_loads_at_rest_count_wheels_on_hinges(tmp_path: Path) -> None:
    found, _ = imported(tmp_path, robot(base(0.1), REAR, swivel("front", 0.3, 0.0, trail=0.0),
                                        control(("front_turn",), ROLL)))
    assert not found.standing.tips
    whole, moment = 10.0 + 2 * 0.5 + 0.7, 10.0 * 0.1 + 0.7 * 0.3
    assert found.standing.wheel_N[2] == pytest.approx(9.80665 * moment / 0.3)
    assert sum(found.standing.wheel_N) == pytest.approx(9.80665 * whole)


def test_damping_of_axles_is_overcome(tmp_path: Path) -> None:
    text = robot(base(0.2), REAR, swivel("front", 0.5, 0.0), control(("front_turn",), ("front",))).replace(
        '<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><dynamics damping="0.01"/>')
    _, scene = imported(tmp_path, text)
    run = simulate(scene).columns
    assert run["velocity_body_m_per_s[1]"][190] == pytest.approx(0.3, rel=0.02)
    assert run["velocity_body_m_per_s[1]"][-1] == pytest.approx(0.3, rel=0.1)


def test_sdf_links_without_inertial_have_the_formats_own(tmp_path: Path) -> None:
    text = SDF.replace("</model>", """<link name="plate"><pose relative_to="base">0 0 0.1 0 0 0</pose></link>
      <joint name="plate_joint" type="fixed"><parent>base</parent><child>plate</child></joint></model>""")
    found, scene = imported(tmp_path, text, "robot.sdf")
    assert scene.vehicle["mass_kg"] == pytest.approx(5.0 + 2 * 0.5 + 1.0)
    plain = imported(tmp_path, SDF, "robot.sdf")[1].vehicle
    off = np.array([plain["com_x_m"], plain["com_y_m"]])
    assert scene.vehicle["yaw_inertia_kgm2"] == pytest.approx(
        plain["yaw_inertia_kgm2"] + 1.0 + 6.0 * 1.0 / 7.0 * float(off @ off))
    assert any("links without <inertial> have the mass and inertia that SDF gives them, 1 kg and 1 kg·m²: plate" in each
               for each in found.remarks)
    automatic = SDF.replace("<inertial>", '<inertial auto="true">', 1)
    assert any('<inertial auto="true"> is not computed of shapes' in each and "count for base" in each
               for each in imported(tmp_path, automatic, "robot.sdf")[0].remarks)


@pytest.mark.parametrize("axis, hinges", [("0 0 1", ("front_turn",)), ("0 0 -1", ())])
def test_joints_keep_their_names_for_ros_where_they_turn_alike(axis: str, hinges: tuple[str, ...], tmp_path: Path
                                                               ) -> None:
    _, scene = imported(tmp_path, robot(base(0.2), REAR, swivel("front", 0.5, 0.0, axis=axis),
                                        control(("front_turn",), ("front",))))
    assert scene.base is not None and scene.base.joint_names == ("left", "right", "front", *hinges)
