"""The first run of an imported robot does what its line says, or one line states why it does not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from laconic.scene import Scene
from laconic.simulation import simulate
from made_up_robots import BOX, imported, inertial, joint, link, robot, wheel

PAIR = wheel("left", "base", "0 0.2 -0.05") + wheel("right", "base", "0 -0.2 -0.05")
FOUR = "".join(wheel(f"wheel_{x}_{y}", "base", f"{x} {y} -0.05") for x in (0.2, -0.2) for y in (0.2, -0.2))
THREE = "".join(wheel(f"wheel_{k}", "base", f"{0.2 * np.cos(a)} {0.2 * np.sin(a)} -0.05", f"0 0 {a - np.pi / 2}")
                for k, a in enumerate(np.radians((60, 180, 300))))
LIMIT = '<limit lower="-1" upper="1" velocity="2" effort="5"/>'
FRONT = (link("fork", inertial(0.1, (1e-4,) * 3)) + wheel("front", "fork", "0 0 0")
         + joint("steer", "revolute", "base", "fork", "0.3 0 -0.05", axis="0 0 1", more=LIMIT))
DAMPED = "that of gearmotors which take the robot's speed in "


def base(x_m: float, y_m: float = 0.0) -> str:
    return link("base", inertial(10.0, (0.1, 0.1, 0.08), f"{x_m} {y_m} 0.03"), BOX)


def ball(x_m: float) -> str:
    shape = '<collision><geometry><sphere radius="0.02"/></geometry></collision>'
    return link("ball", inertial(0.01, (1e-6,) * 3), shape) + joint("ball_joint", "fixed", "base", "ball",
                                                                    f"{x_m} 0 -0.08")


def caster(x_m: float) -> str:
    return (link("fork", inertial(0.1, (1e-4,) * 3, "-0.01 0 -0.02"))
            + joint("swivel", "continuous", "base", "fork", f"{x_m} 0 0", axis="0 0 1")
            + wheel("caster", "fork", "-0.03 0 -0.07", radius=0.03))


def goes(scene: Scene) -> dict[str, np.ndarray]:
    """The run, with a small yaw as no real start is without one."""
    return simulate(replace(scene, initial=replace(scene.initial, heading_rad=1e-3))).columns


@pytest.mark.parametrize(("behind_m", "beside_m"), [
    (0.1, 0.0), (0.15, 0.03), *(pytest.param(*each, marks=pytest.mark.nightly)
                                for each in ((0.1, 0.004), (0.1, 0.03), (0.15, 0.0), (0.15, 0.004)))])
def test_a_robot_with_a_rear_caster_is_damped_so_that_it_turns_left_as_its_line_says(
        tmp_path: Path, behind_m: float, beside_m: float) -> None:
    found, scene = imported(tmp_path, robot(base(-behind_m, beside_m), PAIR, caster(-0.2)))
    assert any("and then turn it to the left" in each for each in found.assumptions)
    damping = next(each for each in found.assumptions if DAMPED in each)
    assert f"{scene.vehicle['motor_damping_Nms']:g} N·m·s" in damping
    assert "mm behind the axle in the direction of travel" in damping and "-fold by the end of the run" in damping
    columns = goes(scene)
    half = len(columns["yaw_rate_rad_per_s"]) // 2
    assert (columns["yaw_rate_rad_per_s"][half:] > 0.4).all()
    assert (columns["velocity_body_m_per_s[1]"][half:] > 0.25).all()


@pytest.mark.parametrize("answers", [{}, {"friction_coefficient": 0.8}])
def test_a_robot_with_a_rear_ball_is_damped_so_that_it_goes_straight(tmp_path: Path, answers: dict[str, Any]) -> None:
    found, scene = imported(tmp_path, robot(base(-0.1), PAIR, ball(-0.2)), **answers)
    assert any(DAMPED in each for each in found.assumptions)
    nudged = replace(scene.inputs[0], value=tuple(1.01 * each for each in scene.inputs[0].value))
    columns = simulate(replace(scene, inputs=(nudged, *scene.inputs[1:]))).columns
    assert abs(columns["heading_rad"][-1]) < 0.05


@pytest.mark.parametrize("carrier", [ball, caster])
@pytest.mark.parametrize("beside_m", [0.0, 0.03])
def test_a_robot_whose_mass_lies_ahead_of_its_axle_needs_no_damping(tmp_path: Path, carrier: Any, beside_m: float
                                                                    ) -> None:
    found, scene = imported(tmp_path, robot(base(0.05, beside_m), PAIR, carrier(0.2)))
    assert "motor_damping_Nms" not in found.text
    assert goes(scene)["velocity_body_m_per_s[1]"][-1] > 0.25


@pytest.mark.parametrize("com_m", [(-0.1, 0.0), (0.1, 0.0), (0.0, 0.03), (-0.1, 0.03)])
@pytest.mark.parametrize(("wheels", "rollers"), [(FOUR, "mecanum"), (THREE, "omni"), (PAIR + FRONT, None)])
def test_other_robots_do_what_their_line_says_wherever_their_mass_lies(
        tmp_path: Path, wheels: str, rollers: str | None, com_m: tuple[float, float]) -> None:
    found, scene = imported(tmp_path, robot(base(*com_m), wheels), rollers={"": rollers} if rollers else {})
    assert not any("first run" in each for each in found.remarks)
    columns = goes(scene)
    assert columns["velocity_body_m_per_s[1]"][-1] > 0.25
    turned = columns["heading_rad"][-1] - columns["heading_rad"][0]
    assert turned > 5.0 if rollers is None else abs(turned) < 1e-6


def test_a_robot_that_no_motor_of_its_wheels_holds_is_called_unstable_in_one_line(tmp_path: Path) -> None:
    drive = ('<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="front">'
             "<hardwareInterface>VelocityJointInterface</hardwareInterface></joint></transmission>")
    text = robot(base(-0.1), PAIR, FRONT.replace("0.3 0 -0.05", "-0.3 0 -0.05"), drive)
    found, _ = imported(tmp_path, text, hinges=False)
    assert any("this force takes the place of front" in each for each in found.assumptions)
    unstable = [each for each in found.remarks if "the first run is unstable: a small turn grows" in each]
    assert len(unstable) == 1 and "mm behind the axle in the direction of travel" in unstable[0]
    assert unstable[0] in found.text
