"""Sensors against independent computations: SymPy differentiates the path of a place, mpmath draws the noise again."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy
from mpmath import mp

from laconic.core import load
from laconic.scene import read_scene
from laconic.tools.verify.reference import Reference
from scene_text import ideal_scene_names

PLACE_M, AXIS_RAD = (0.23, -0.11), 0.7
BITS = 2**64 - 1
GOLDEN = 0x9E3779B97F4A7C15


def acceleration_by_sympy():
    """(ax, ay) of a place d from S, in body axes, from v, ω and their derivatives: two derivatives of its path."""
    t, dx, dy = sympy.symbols("t dx dy")
    heading, along, across = (sympy.Function(name)(t) for name in ("heading", "along", "across"))
    turn = sympy.Matrix([[sympy.cos(heading), -sympy.sin(heading)], [sympy.sin(heading), sympy.cos(heading)]])
    velocity = turn * sympy.Matrix([along, across]) + (turn * sympy.Matrix([dx, dy])).diff(t)
    acceleration = turn.T * velocity.diff(t)
    names = sympy.symbols("alpha omega along_rate across_rate theta v_along v_across")
    given = dict(zip((heading.diff(t, 2), heading.diff(t), along.diff(t), across.diff(t), heading, along, across),
                     names, strict=True))
    return sympy.lambdify((*names, dx, dy), acceleration.subs(given), "numpy")


BY_SYMPY = acceleration_by_sympy()


@pytest.mark.parametrize("name", ideal_scene_names())
def test_accelerations_are_the_second_derivative_of_the_path_of_a_place(name: str) -> None:
    scene, core = read_scene(name), load("double")
    reference, plant = Reference(scene.vehicle), scene.plant(core)
    imu = {"x_m": PLACE_M[0], "y_m": PLACE_M[1], "heading_rad": AXIS_RAD}
    sensors = plant.sensors({"imu": imu})
    wheels = range(1, scene.wheel_count + 1)
    values = {f"voltage_V[{i}]": 1.5 - 0.4 * i for i in wheels} | {f"axle_torque_Nm[{i}]": 0.02 * i for i in wheels}
    values |= {"body_force_N[1]": 0.4, "body_force_N[2]": -0.3, "body_moment_Nm": 0.02, "world_force_N[1]": 0.5,
               "world_force_N[2]": 0.2, "world_force_point_m[1]": 0.05}
    held = core.input(values)
    sensors.run(held, 5)
    state = np.concatenate([plant.nu, [0.0, 0.0, plant.pose.heading_rad], np.zeros(scene.wheel_count)])
    rate, totals = reference.rates(state, reference.forcing_terms(values)), reference.totals
    radius, yaw = totals.wheel_radius_m, reference.yaw_scale
    motion = (rate[2] / yaw, state[2] / yaw, radius * rate[0], radius * rate[1], state[5], radius * state[0],
              radius * state[1])
    scale = 1e-11 * (1.0 + np.abs(rate[:3]).max() * (radius + 0.3 / yaw))
    origin = BY_SYMPY(*motion, *(-totals.com_m)).ravel()
    place = BY_SYMPY(*motion, *(np.array(PLACE_M) - totals.com_m)).ravel()
    cosine, sine = math.cos(AXIS_RAD), math.sin(AXIS_RAD)
    shown = sensors.read(held)
    assert shown.acceleration_body_m_per_s2 == pytest.approx(origin, rel=1e-9, abs=scale)
    assert shown.imu_acceleration_m_per_s2 == pytest.approx(
        [cosine * place[0] + sine * place[1], cosine * place[1] - sine * place[0]], rel=1e-9, abs=scale)
    assert shown.imu_yaw_rate_rad_per_s == pytest.approx(state[2] / yaw, rel=1e-12, abs=1e-15)
    assert np.abs(place - origin).max() > 0.0 or np.abs(rate[:3]).max() < 1e-12


def scrambled(z: int) -> int:
    """SplitMix64's output function."""
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & BITS
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & BITS
    return z ^ (z >> 31)


def normal_pair(seed: int, stream: int, index: int) -> tuple[float, float]:
    """Two normal deviates in 40 digits, by Box and Muller."""
    with mp.workdps(40):
        start = scrambled((scrambled((seed + GOLDEN) & BITS) + stream) & BITS) + 2 * index * GOLDEN
        first, second = (scrambled((start + k * GOLDEN) & BITS) for k in (1, 2))
        radius, angle = mp.sqrt(-2 * mp.log(mp.mpf(first | 1) / 2**64)), 2 * mp.pi * mp.mpf(second) / 2**64
        return float(radius * mp.cos(angle)), float(radius * mp.sin(angle))


@pytest.mark.parametrize("real, tolerance", [("double", 1e-14), ("single", 2e-6)])
def test_the_noise_is_what_another_computation_of_its_definition_gives(real: str, tolerance: float) -> None:
    scene, core = read_scene("turtlebot3_burger").with_run(real=real), load(real)
    seed, density, gyro = -5, 0.03, 0.004
    noisy, ideal = scene.plant(core), scene.plant(core)
    step_s = noisy.step_s
    given = {"acceleration_noise_m_per_s2_per_sqrt_Hz": density, "yaw_rate_noise_rad_per_s_per_sqrt_Hz": gyro}
    with_noise, without = noisy.sensors({"imu": {**given, "seed": seed}}), ideal.sensors()
    held = core.input({"voltage_V": [2.0, 3.0]}, 2)
    for number in range(1, 60):
        with_noise.run(held)
        without.run(held)
        found, truth = with_noise.read(held), without.read(held)
        pair, yaw = (np.array(normal_pair(seed % 2**32, stream, number)) for stream in (0, 1))
        sigma = math.sqrt(0.5 / step_s)
        expected = truth.imu_acceleration_m_per_s2 + density * sigma * pair
        assert found.imu_acceleration_m_per_s2 == pytest.approx(expected, abs=tolerance * (1 + abs(expected).max()))
        assert found.imu_yaw_rate_rad_per_s == pytest.approx(
            truth.imu_yaw_rate_rad_per_s + gyro * sigma * yaw[0], abs=tolerance)
