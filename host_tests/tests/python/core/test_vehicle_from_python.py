"""laconic.Vehicle: rates, matrices and linearisation agree with the steps of the core."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest

import laconic
from laconic.base.paths import SCENE_DIR
from laconic.scene import rigid_scene_names
from laconic.scene.methods import EXPLICIT

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

CARRIAGE = {
    "mass_kg": 10.3, "yaw_inertia_kgm2": 0.231, "com_x_m": 0.013, "com_y_m": 0.021, "wheel_radius_m": 0.051,
    "wheel_inertia_kgm2": 0.0087, "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.02,
    "wheel": [{"kind": "omni", "x_m": 0.13 * np.cos(angle), "y_m": 0.13 * np.sin(angle), "axle_rad": angle}
              for angle in (0.3, 2.4, 4.5)]}
NU, HEADING = (1.2, -0.4, 0.7), 0.6
INPUTS = {"voltage_V": [2.0, -1.0, 0.5], "world_force_N": [0.4, -0.2]}


@pytest.fixture(scope="module")
def robot() -> laconic.Vehicle:
    return laconic.Vehicle(CARRIAGE)


def rates(robot, nu, heading, inputs):
    found = robot.derivative(nu, heading, inputs)
    return np.array([*found.nu_rad_per_s2, *found.velocity_m_per_s, found.yaw_rate_rad_per_s])


def test_the_derivative_is_the_slope_of_a_step(robot):
    step_s = 1e-6
    plant = robot.plant(EXPLICIT, step_s, nu_rad_per_s=NU, heading_rad=HEADING)
    plant.run(INPUTS)
    slope = (np.array([*plant.nu, plant.pose.x_m, plant.pose.y_m, plant.pose.heading_rad])
             - [*NU, 0.0, 0.0, HEADING]) / step_s
    assert rates(robot, NU, HEADING, INPUTS) == pytest.approx(slope, rel=1e-4, abs=1e-5)
    assert robot.derivative(NU, HEADING, INPUTS).wheel_speed_rad_per_s == pytest.approx(
        robot.matrices().wheel_rows @ NU, rel=1e-12)


def test_the_linearisation_is_the_change_of_the_derivative(robot):
    found = robot.linearise(NU, HEADING, INPUTS)
    step = 1e-6
    for k in range(3):
        ahead, behind = ([v + sign * step * (i == k) for i, v in enumerate(NU)] for sign in (1, -1))
        change = (rates(robot, ahead, HEADING, INPUTS) - rates(robot, behind, HEADING, INPUTS)) / (2 * step)
        assert found.state_matrix[:, k] == pytest.approx(change, rel=1e-6, abs=1e-7)
    change = (rates(robot, NU, HEADING + step, INPUTS) - rates(robot, NU, HEADING - step, INPUTS)) / (2 * step)
    assert found.state_matrix[:, 5] == pytest.approx(change, rel=1e-6, abs=1e-7)
    assert not found.state_matrix[:, 3:5].any()
    more = {**INPUTS, "voltage_V": [2.0, 0.0, 0.5]}
    assert found.voltage_matrix[:, 1] == pytest.approx(
        rates(robot, NU, HEADING, more) - rates(robot, NU, HEADING, INPUTS), rel=1e-9, abs=1e-12)
    assert found.voltage_matrix.shape == (6, 3)


def test_the_energy_is_that_of_the_inertia_matrix(robot):
    matrices, plant = robot.matrices(), robot.plant(nu_rad_per_s=NU)
    scale = CARRIAGE["mass_kg"] * CARRIAGE["wheel_radius_m"] ** 2
    assert plant.energy_J() == pytest.approx(0.5 * scale * np.array(NU) @ matrices.inertia @ NU, rel=1e-12)
    assert matrices.inertia @ matrices.inverse_inertia == pytest.approx(np.eye(3), abs=1e-12)


def test_an_input_by_names_has_the_bits_of_one_that_the_core_made(robot):
    named, made = robot.plant(), robot.plant()
    named.run(INPUTS, steps=50)
    made.run(robot.core.input(INPUTS, 3), steps=50)
    assert named.row().tobytes() == made.row().tobytes()
    assert named.wheel_torques(INPUTS).tobytes() == made.wheel_torques(made.core.input(INPUTS, 3)).tobytes()
    assert robot.plant().wheel_torques() == pytest.approx(0.0)


MOTOR = {"resistance_ohm": 1.0, "torque_constant_Nm_per_A": 0.02, "back_emf_Vs_per_rad": 0.02,
         "viscous_friction_Nms": 1e-5, "rotor_inertia_kgm2": 1e-6}


@pytest.mark.parametrize("limits", [{}, {"drive": {"supply_V": 12.0, "current_limit_A": 1.0}}], ids=["free", "limited"])
def test_a_gear_that_reverses_turns_the_wheel_back_by_the_same_voltage(limits):
    bare = {key: value for key, value in CARRIAGE.items() if not key.startswith("motor_")} | limits
    motors = [{"motor": MOTOR | {"gear_ratio": ratio}} for ratio in (12.0, -12.0)]
    plants = [laconic.Vehicle(bare | motor).plant(step_s=0.001) for motor in motors]
    for plant, sign in zip(plants, (1.0, -1.0), strict=True):
        plant.run({"voltage_V": [6.0 * sign, -3.0 * sign, 2.0 * sign]}, 200)
    assert plants[0].row().tolist() == plants[1].row().tolist()
    assert np.abs(plants[0].wheel_speeds()).min() > 0.1


def test_a_vehicle_without_wheels_has_no_columns_of_voltages():
    body = laconic.Vehicle({"mass_kg": 1.0, "yaw_inertia_kgm2": 0.1, "wheel_radius_m": 0.1})
    assert body.linearise().voltage_matrix.shape == (6, 0)


def test_single_precision_gives_arrays_of_single_precision():
    robot = laconic.Vehicle(CARRIAGE, real="single")
    assert robot.linearise(NU).state_matrix.dtype == robot.derivative(NU).nu_rad_per_s2.dtype == np.float32


def test_the_vehicle_of_a_scene_is_the_scenes():
    scene = laconic.read_scene("robotino2")
    assert laconic.Vehicle.of(scene).matrices().lambda_yaw == scene.core().matrices(
        scene.c_vehicle(scene.core())).lambda_yaw


def test_rates_of_wheels_that_slip_are_refused():
    robot = laconic.Vehicle.of(laconic.read_scene("skid_steer"))
    for ask in (robot.derivative, robot.linearise):
        with pytest.raises(laconic.BadInput, match="have states of their own .*; step it with plant"):
            ask()


@pytest.mark.parametrize("table, message", [
    ({**CARRIAGE, "mass": 1.0}, "vehicle.mass: unknown key; did you mean mass_kg"),
    ({**CARRIAGE, "mass_kg": -1.0}, "mass_kg"),
    ({**CARRIAGE, "wheel": [{"kind": "round"}]}, r"vehicle.wheel\[1\].kind: there is no 'round'"),
    ("robotino2", "is no table")])
def test_what_makes_no_vehicle_is_refused_by_its_name(table, message):
    with pytest.raises(laconic.BadInput, match=message):
        laconic.Vehicle(table)


def bits(vehicle: laconic.Vehicle) -> bytes:
    """All numbers of a vehicle."""
    return bytes(vehicle.core.ffi.buffer(vehicle.c))


@pytest.mark.parametrize("name", rigid_scene_names())
def test_a_vehicle_takes_the_table_of_every_scenes_file_as_it_is(name: str) -> None:
    tables = tomllib.loads((SCENE_DIR / f"{name}.toml").read_text(encoding="utf-8"))
    ground = {"ground": tables["ground"]} if "ground" in tables else {}
    real = tables["run"].get("real", "double")
    assert bits(laconic.Vehicle(tables["vehicle"] | ground, real)) == bits(laconic.Vehicle.of(laconic.read_scene(name)))


ROBOT: dict[str, Any] = {"mass_kg": 1.0, "yaw_inertia_kgm2": 0.1, "wheel_radius_m": 0.05, "motor_gain_Nm_per_V": 0.5,
                         "motor_damping_Nms": 0.02}
WHEEL: dict[str, Any] = {"kind": "mecanum", "x_m": 0.2, "y_m": 0.1, "axle_rad": -np.pi / 2, "roller_rad": np.pi / 4}


def test_every_spelling_of_a_scene_has_the_bits_of_the_plain_one() -> None:
    plain = laconic.Vehicle(ROBOT | {"ground": {"friction_coefficient": 0.5, "slope_rad": np.radians(3.0),
                                                "slope_heading_rad": np.radians(40.0)},
                                     "wheel_inertia_kgm2": 0.01,
                                     "wheel": [WHEEL | {"motor_circuit": 2}, WHEEL | {"y_m": 0.0}]})
    polar = {"distance_m": np.float64(0.2), "bearing_deg": 0}
    spelled = laconic.Vehicle(ROBOT | {
        "wheel_inertia_kgm2": 0.01,
        "ground": {"friction_coefficient": 0.5, "slope_deg": 3.0, "slope_heading_deg": np.float64(40.0)},
        "wheel": [{"kind": "mecanum", "x_m": 0.2, "y_m": 0.1, "axle_deg": -90, "roller_deg": 45.0,
                   "motor_circuit": "shorted"},
                  {"kind": "mecanum", **polar, "axle_deg": -90.0, "roller_rad": np.pi / 4}]})
    assert bits(spelled) == bits(plain)
    polar["bearing_deg"] = 130
    by_bearing = laconic.Vehicle(ROBOT | {"wheel_inertia_kgm2": 0.01, "wheel": [{"kind": "omni", **polar}]})
    in_file = laconic.build_scene({"vehicle": ROBOT | {"wheel_inertia_kgm2": 0.01,
                                                       "wheel": [{"kind": "omni", **polar, "axle_deg": 0}]},
                                   "run": {"duration_s": 1.0, "step_s": 0.1}}).vehicle["wheel"][0]
    assert (by_bearing.c.wheel[0].x_m, by_bearing.c.wheel[0].y_m) == (in_file["x_m"], in_file["y_m"])


def test_an_imu_is_turned_by_degrees_too() -> None:
    plant = laconic.Vehicle(ROBOT).plant()
    in_degrees, in_radians = (plant.sensors({"imu": imu}) for imu in ({"heading_deg": 90}, {"heading_rad": np.pi / 2}))
    assert in_degrees.c.settings.imu.heading_rad == in_radians.c.settings.imu.heading_rad != 0.0


@pytest.mark.parametrize("change, message", [
    ({"axle_deg": -90}, "vehicle.wheel[1].axle_deg: is given besides axle_rad; keep one of them"),
    ({"distance_m": 0.2}, "vehicle.wheel[1].distance_m: is given besides x_m; give x_m and y_m, or distance_m and be"),
    ({"axle_deg": "x"}, "vehicle.wheel[1].axle_deg: is given besides axle_rad"),
    ({"roler_deg": 45}, "vehicle.wheel[1].roler_deg: unknown key; did you mean"),
    ({"motor_circuit": "opne"}, "vehicle.wheel[1].motor_circuit: there is no 'opne'; did you mean open?")])
def test_what_is_spelled_twice_or_wrongly_is_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(laconic.BadInput) as refused:
        laconic.Vehicle(ROBOT | {"wheel": [WHEEL | change]})
    assert message in str(refused.value)


@pytest.mark.parametrize("place, message", [
    ({"distance_m": 0.2}, "vehicle.wheel[1].bearing_rad: is missing; give a number"),
    ({"bearing_deg": 20}, "vehicle.wheel[1].distance_m: is missing; give a number"),
    ({"distance_m": -0.2, "bearing_deg": 20}, "vehicle.wheel[1].distance_m: is -0.2; give 0 or more, and the dir"),
    ({"distance_m": 0.2, "bearing_deg": "north"}, "vehicle.wheel[1].bearing_deg: 'north' is no number; give one"),
    ({"distance_m": 0.2, "bearing_deg": 0, "bearing_rad": 0}, "bearing_deg: is given besides bearing_rad; keep one")])
def test_half_a_place_is_named(place: dict[str, Any], message: str) -> None:
    with pytest.raises(laconic.BadInput) as refused:
        laconic.Vehicle(ROBOT | {"wheel": [{"kind": "omni", **place}]})
    assert message in str(refused.value)
