"""laconic.Vehicle: rates, matrices and linearisation agree with the steps of the core."""

from __future__ import annotations

import numpy as np
import pytest

import laconic
from laconic.scene.methods import EXPLICIT

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
