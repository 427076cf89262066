"""Signals: the page lists all of them and says what they are; what a scene lacks is refused with what it needs."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from friction_scenes import DRIVE, GROUND, slipping, with_tables
from laconic.base.paths import SOURCE_DIR
from laconic.core import Vehicle
from laconic.core.recording import MEMBERS
from laconic.errors import BadInput
from laconic.scene import Scene, read_scene
from laconic.scene.signals import NEEDED
from laconic.simulation import simulate
from laconic_build.site.signals_page import page

PAGE = (SOURCE_DIR / "docs" / "signals.md").read_text(encoding="utf-8")
WITHOUT_SUPPLY = "[vehicle.drive]\ncurrent_limit_A = 0.9\n"


def test_the_page_is_made_of_what_the_program_knows_and_has_every_output() -> None:
    assert page() == PAGE, "run build/venv/bin/python -m laconic_build.site.signals_page"
    outputs = PAGE.split("## Outputs")[1]
    assert all(f"| `{name}` |" in outputs for name in (*MEMBERS, *NEEDED))
    assert "0 without" not in outputs


@pytest.mark.parametrize("signal, needs", [
    ("supply_current_A", "vehicle.drive.supply_V"), ("supply_voltage_V", "vehicle.drive.supply_V")])
def test_what_a_supply_shows_is_refused_without_its_voltage(signal: str, needs: str, tmp_path: Path) -> None:
    without = with_tables("robotino2", WITHOUT_SUPPLY, tmp_path)
    with pytest.raises(BadInput, match=f"signals: {signal} is the supply's, .* give {re.escape(needs)}"):
        simulate(without, [signal])
    given = simulate(with_tables("robotino2", DRIVE, tmp_path).with_run(duration_s=0.1), [signal])
    assert given.columns[signal].any()


def test_a_motors_current_is_refused_where_its_winding_is_not_known(tmp_path: Path) -> None:
    geared = with_tables("s1", GROUND, tmp_path)
    with pytest.raises(BadInput, match=r"motor_current_A is a motor's, .* give \[vehicle.motor\]"):
        simulate(geared, ["motor_current_A"])


@pytest.mark.parametrize("signal", ["slip_along_m_per_s", "slip_across_m_per_s[2]", "contact_state", "slip_loss_J"])
def test_slip_on_ideal_ground_is_refused_with_what_it_needs(signal: str) -> None:
    with pytest.raises(BadInput, match=f"{re.escape(signal)} is of slip .* give ground.friction_coefficient or"):
        simulate(read_scene("robotino2"), [signal])


def forces(scene: Scene, along: np.ndarray, lateral: np.ndarray) -> np.ndarray:
    """The sum of the ground's reactions on the wheels, in body axes, by the directions that the page gives."""
    total = np.zeros(2)
    for wheel, one, other in zip(scene.vehicle["wheel"], along, lateral, strict=True):
        angle = wheel["axle_rad"] + wheel.get("roller_rad", math.pi / 2)
        total += one * np.array([math.cos(angle), math.sin(angle)])
        total += other * np.array([math.sin(angle), -math.cos(angle)])
    return total


@pytest.mark.parametrize("name", ["robotino2", "kuka_youbot", "turtlebot3_burger", "example_two_wheel_sizes"])
def test_reactions_have_the_directions_of_the_page_on_ideal_ground(name: str) -> None:
    scene = read_scene(name)
    robot = Vehicle.of(scene)
    held = {f"voltage_V[{i + 1}]": 2.0 + i for i, wheel in enumerate(scene.vehicle["wheel"]) if wheel["driven"]}
    nu_rates = robot.derivative(inputs=held).nu_rad_per_s2
    seen = robot.plant().reactions(held)
    along, lateral = (robot.core.numbers(each)[: robot.wheel_count] for each in (seen.along_N, seen.lateral_N))
    expected = scene.vehicle["mass_kg"] * scene.vehicle["wheel_radius_m"] * nu_rates[:2]
    assert np.abs(forces(scene, along, lateral) - expected).max() < 1e-9 * np.abs(along).max()
    assert np.abs(expected).max() > 1e-3


def test_reactions_have_the_directions_of_the_page_on_ground_with_friction(tmp_path: Path) -> None:
    scene = slipping(tmp_path)
    plant = Vehicle.of(scene).plant(step_s=1e-3)
    held = {"voltage_V": [9.0, -2.0, 4.0], "body_force_N": [3.0, -1.0]}
    before = plant.body_velocity()[0]
    plant.run(held)
    seen = plant.reactions(held)
    along, lateral = (plant.core.numbers(each)[:3] for each in (seen.along_N, seen.lateral_N))
    vehicle, ground = scene.vehicle, scene.vehicle["ground"]
    downhill = -vehicle["mass_kg"] * 9.80665 * math.sin(ground["slope_rad"])
    slope = downhill * np.array([math.cos(ground["slope_heading_rad"]), math.sin(ground["slope_heading_rad"])])
    velocity, yaw_rate = plant.body_velocity()
    change = vehicle["mass_kg"] * (velocity - before) / 1e-3
    assert forces(scene, along, lateral) + slope + np.array([3.0, -1.0]) == pytest.approx(change, rel=2e-2)
    assert np.abs(lateral).max() > 0.1 and yaw_rate
