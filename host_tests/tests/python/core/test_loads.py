"""Normal loads of wheels and supports: they carry the weight, balance the ground's forces, and every way shows them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import laconic
from laconic.scene.signals import SUPPORT_LOAD, WHEEL_LOAD

GRAVITY_M_PER_S2 = 9.81
STEPS = 30
SUPPORTED, SLIPPING, ROLLING = "canopen_agv", "skid_steer", "kuka_youbot"


def driven(name: str, real: str = "double") -> tuple[laconic.Scene, laconic.Plant, dict[str, Any]]:
    """A robot that speeds up straight ahead, and its input."""
    scene = laconic.read_scene(name).with_run(real=real)
    plant = laconic.Vehicle.of(scene).plant("auto", scene.run.step_s)
    turns = np.sign(plant.core.matrices(laconic.Vehicle.of(scene)).wheel_rows[:, 0])
    return scene, plant, {"axle_torque_Nm": (0.5 * turns).tolist()}


def places_of(plant: laconic.Plant) -> np.ndarray:
    """Of wheels and then supports in the body frame, (points, 2)."""
    vehicle = plant.c.vehicle
    return np.array([(each.x_m, each.y_m) for each in (*list(vehicle.wheel)[: vehicle.wheel_count],
                                                       *list(vehicle.support)[: vehicle.support_count])])


@pytest.mark.parametrize("name", [SUPPORTED, ROLLING])
def test_the_loads_carry_the_weight_and_balance_the_force_that_speeds_the_robot_up(name: str) -> None:
    scene, plant, held = driven(name)
    loads = np.concatenate([plant.wheel_loads(held), plant.support_loads(held)])
    mass_kg, com_z_m = scene.vehicle["mass_kg"], scene.vehicle["com_z_m"]
    assert len(loads) == scene.wheel_count + len(scene.vehicle["support"]) and com_z_m > 0
    assert loads.sum() == pytest.approx(mass_kg * GRAVITY_M_PER_S2, rel=1e-3)
    force_N = mass_kg * plant.body_acceleration(held)
    lever = places_of(plant) - (scene.vehicle["com_x_m"], scene.vehicle["com_y_m"])
    assert abs(force_N[0]) > 1.0
    assert loads @ lever == pytest.approx(-com_z_m * force_N, abs=1e-9)


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("name", [SUPPORTED, SLIPPING, ROLLING])
def test_a_runs_columns_are_the_loads_of_the_plant(name: str, real: str) -> None:
    scene = laconic.read_scene(name).with_run(real=real)
    scene = scene.with_run(duration_s=STEPS * scene.run.step_s)
    scene = replace(scene, outputs=replace(scene.outputs, every_s=None))
    signals = [WHEEL_LOAD, *([SUPPORT_LOAD] if scene.vehicle["support"] else [])]
    run = laconic.simulate(scene, signals)
    plant, inputs = scene.plant(scene.core()), scene.inputs_on_grid()
    for step in range(STEPS + 1):
        held = plant.core.input(inputs.held_at(step))
        expected = [*plant.wheel_loads(held), *plant.support_loads(held)]
        assert [run.columns[each][step] for each in run.columns] == expected
        if step < STEPS:
            samples = plant.core.input_row(inputs.held_at(step), plant.wheel_count)
            plant.run(plant.core.input(samples))


def test_on_ground_with_friction_they_carry_the_weight() -> None:
    scene = laconic.read_scene(SLIPPING).with_run(duration_s=1.0)
    run = laconic.simulate(scene, [WHEEL_LOAD])
    weight_N = scene.vehicle["mass_kg"] * GRAVITY_M_PER_S2
    assert run.columns_of(WHEEL_LOAD).sum(axis=1) == pytest.approx(weight_N, rel=1e-3)


def test_a_robot_that_stops_hard_lifts_a_wheel_and_the_load_says_so() -> None:
    tables = {"mass_kg": 10.0, "yaw_inertia_kgm2": 1.0, "com_z_m": 0.5, "wheel_radius_m": 0.05,
              "wheel_inertia_kgm2": 0.01, "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.02,
              "wheel": [{"kind": "mecanum", "x_m": x, "y_m": y, "axle_deg": -90, "roller_deg": 45 * np.sign(x * y)}
                        for x in (0.2, -0.2) for y in (0.2, -0.2)]}
    plant = laconic.Vehicle(tables).plant(step_s=0.01)
    ahead, behind = plant.wheel_loads({"voltage_V": [12.0] * 4}).reshape(2, 2)
    assert (ahead < 0).all() and (behind > 0).all()
    assert plant.support_loads().shape == (0,)


@pytest.mark.parametrize("change, signal, message", [
    ({"com_z_m": 0.0, "friction_coefficient": 0.0, "support": []}, SUPPORT_LOAD,
     "support_load_N is a support's, and the scene has none; give [[vehicle.support]]"),
    ({"com_z_m": 0.0, "friction_coefficient": 0.0}, WHEEL_LOAD,
     "wheel_load_N depends on the height of the centre of mass, which the scene does not give; give vehicle.com_z_m"),
    ({"com_z_m": 0.0, "friction_coefficient": 0.0}, f"{SUPPORT_LOAD}[2]", "support_load_N[2] depends on the height of"),
    ({"wheel": [], "friction_coefficient": 0.0}, WHEEL_LOAD, "wheel_load_N is of a vehicle on wheels, and the scene"),
    ({}, f"{SUPPORT_LOAD}[3]", "there is no signal 'support_load_N[3]'; did you mean support_load_N[")])
def test_a_scene_that_has_no_such_loads_is_told_what_to_give(change: dict[str, Any], signal: str, message: str,
                                                             ) -> None:
    scene = laconic.read_scene(SUPPORTED)
    scene = replace(scene, vehicle=scene.vehicle | change, inputs=())
    with pytest.raises(laconic.BadInput) as refused:
        laconic.simulate(scene, [signal])
    assert message in str(refused.value)


@pytest.mark.parametrize("change", [{"com_z_m": 0.0}, {"friction_coefficient": 0.0}])
def test_the_height_or_the_friction_is_enough(change: dict[str, Any]) -> None:
    scene = laconic.read_scene(SUPPORTED).with_run(duration_s=0.1)
    run = laconic.simulate(replace(scene, vehicle=scene.vehicle | change), [WHEEL_LOAD, SUPPORT_LOAD])
    assert [*run.columns] == [f"{WHEEL_LOAD}[1]", f"{WHEEL_LOAD}[2]", f"{SUPPORT_LOAD}[1]", f"{SUPPORT_LOAD}[2]"]


def test_the_loads_are_written_with_the_other_columns(tmp_path: Path) -> None:
    from laconic.cli.main import run

    scene = tmp_path / "agv.toml"
    text = laconic.read_scene(SUPPORTED).path.read_text(encoding="utf-8")
    scene.write_text(f'{text.partition("[outputs]")[0]}[outputs]\nsignals = ["wheel_load_N", "support_load_N[2]"]\n'
                     "every_s = 0.5\n", encoding="utf-8")
    assert run(["simulate", str(scene), "--out", str(tmp_path / "run.csv")]) == 0
    heading, _ = (tmp_path / "run.csv").read_text().split("\n", 1)
    assert heading == "time_s,wheel_load_N[1],wheel_load_N[2],support_load_N[2]"
