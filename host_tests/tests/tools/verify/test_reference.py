"""The independent reference is right, and the core agrees with it wherever inputs, loads and frames are involved.

Sensors against independent computations: SymPy differentiates the path of a place, mpmath draws the noise again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import sympy
from mpmath import mp

from assurance.population import Made, made
from laconic.core import load
from laconic.scene import read_scene
from laconic.simulation import simulate, usual_signals
from laconic.tools.verify.reference import Reference, reference_states
from laconic.tools.verify.trajectories import error_of, expected_states, read_reference, vehicle_of
from scene_text import ideal_scene_names

CASES = {case.text("name"): case for case in read_reference(Path(__file__).parents[2] / "data" / "trajectories.json")}

EVERYTHING = """
[vehicle]
mass_kg = 20.0
yaw_inertia_kgm2 = 1.2
com_x_m = -0.02
com_y_m = 0.03
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.004
[vehicle.motor]
resistance_ohm = 1.5
torque_constant_Nm_per_A = 0.04
back_emf_Vs_per_rad = 0.05
gear_ratio = 12.0
viscous_friction_Nms = 1e-5
rotor_inertia_kgm2 = 2e-5
[vehicle.payload]
mass_kg = 7.0
x_m = 0.1
y_m = -0.05
yaw_inertia_kgm2 = 0.1
[[vehicle.wheel]]
kind = "mecanum"
x_m = 0.25
y_m = 0.15
axle_deg = -90
roller_deg = 45
[[vehicle.wheel]]
kind = "roller"
x_m = 0.2
y_m = -0.15
axle_rad = -1.4
roller_rad = -0.9
[[vehicle.wheel]]
kind = "omni"
distance_m = 0.3
bearing_deg = 200
axle_deg = 190
[initial]
velocity_body_m_per_s = [0.3, -0.1]
yaw_rate_rad_per_s = 0.7
x_m = 1.0
y_m = -2.0
heading_deg = 30
[run]
duration_s = 3.0
step_s = 0.001
[outputs]
every_s = 0.1
"""
INPUTS = {
    "none": "",
    "steps": '[[input]]\nsignal = "voltage_V[2]"\nkind = "steps"\nt_s = [0.5, 1.5]\nvalue = [6.0, -2.0]\n',
    "sine": '[[input]]\nsignal = "voltage_V[1]"\nkind = "sine"\namplitude = 8.0\nfrequency_Hz = 0.7\nphase_deg = 40\n',
    "sum of two": '[[input]]\nsignal = "voltage_V[1]"\nkind = "sine"\namplitude = 8.0\nfrequency_Hz = 0.7\n'
                  '[[input]]\nsignal = "voltage_V[1]"\nkind = "steps"\nt_s = [1.0]\nvalue = [3.0]\n',
    "table": '[[input]]\nsignal = "axle_torque_Nm[3]"\nkind = "table"\nt_s = [0.2, 1.0, 2.0]\nvalue = [0.0, 1.5, -1]\n',
    "body wrench": '[[input]]\nsignal = "body_force_N[2]"\nkind = "sine"\namplitude = 5.0\nfrequency_Hz = 0.5\n'
                   '[[input]]\nsignal = "body_moment_Nm"\nkind = "steps"\nt_s = [0.0]\nvalue = [0.8]\n',
    "world force": '[[input]]\nsignal = "world_force_N[1]"\nkind = "steps"\nt_s = [0.0, 1.0]\nvalue = [9.0, -4.0]\n'
                   '[[input]]\nsignal = "world_force_N[2]"\nkind = "steps"\nt_s = [0.0]\nvalue = [3.0]\n'
                   '[[input]]\nsignal = "world_force_point_m[1]"\nkind = "steps"\nt_s = [0.0]\nvalue = [0.2]\n'
                   '[[input]]\nsignal = "world_force_point_m[2]"\nkind = "steps"\nt_s = [0.0]\nvalue = [-0.1]\n',
}


def values_of(segment) -> dict[str, float]:
    """A reference segment's inputs by signal name."""
    found = {}
    if segment.has("U"):
        found |= {f"voltage_V[{i}]": u for i, u in enumerate(segment.numbers("U"), start=1)}
    if segment.has("body_wrench"):
        names = ("body_force_N[1]", "body_force_N[2]", "body_moment_Nm")
        found |= dict(zip(names, segment.numbers("body_wrench"), strict=True))
    for key, name in (("world_force", "world_force_N"), ("point", "world_force_point_m")):
        if segment.has(key):
            found |= {f"{name}[{i}]": v for i, v in enumerate(segment.numbers(key), start=1)}
    return found


@pytest.mark.parametrize("name", CASES)
def test_reference_follows_the_25_digit_trajectories(name):
    case = CASES[name]
    reference = Reference(vehicle_of(case))
    initial = case.table("initial")
    state = np.array([*initial.numbers("nu"), *initial.numbers("pose"), *[0.0] * len(reference.wheels)])
    found, time_s = [], 0.0
    for segment in case.tables("segments"):
        end_s = time_s + segment.number("duration")
        state = reference.solve(state, time_s, np.array([end_s]), values_of(segment), 1e-12, 1e-13)[-1]
        found.append(state)
        time_s = end_s
    found, expected = np.array(found), expected_states(case)
    for part in (slice(0, 3), slice(3, 6), slice(6, None)):
        assert error_of(found[:, part], expected[:, part]) < 2e-11


def agreement(scene) -> list[float]:
    """Errors of ν, pose and wheel angles of the core against the reference."""
    run = simulate(scene, usual_signals(scene))
    states = reference_states(scene, run.time_s)
    pose = np.column_stack([run.columns[name] for name in ("x_m", "y_m", "heading_rad")])
    kinds = [(run.columns_of("nu_rad_per_s"), slice(0, 3)), (pose, slice(3, 6))]
    if scene.wheel_count:
        kinds.append((run.columns_of("wheel_angle_rad"), slice(6, None)))
    return [error_of(found, states[:, part]) for found, part in kinds]


@pytest.mark.parametrize(("change", "inputs"), [
    pytest.param(change, name, marks=[] if change == "as it is" or name in ("sum of two", "world force")
                 else pytest.mark.nightly)
    for change in ("as it is", "fixed wheel", "locked wheel") for name in INPUTS])
def test_core_agrees_with_motor_payload_and_every_kind_of_input(inputs, change, tmp_path):
    text = EVERYTHING + INPUTS[inputs]
    at_rest = text.replace("[0.3, -0.1]", "[0.0, 0.0]").replace("rad_per_s = 0.7", "rad_per_s = 0.0")
    if change == "fixed wheel":
        text = at_rest.replace('kind = "omni"', 'kind = "fixed"')
    elif change == "locked wheel":
        text = at_rest.replace('kind = "omni"', 'kind = "omni"\nlocked = true')
    path = tmp_path / "scene.toml"
    path.write_text(text)
    assert max(agreement(read_scene(path))) < 3e-9


@pytest.mark.parametrize("steps", [1000, pytest.param(4000, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("name", ideal_scene_names())
def test_core_agrees_with_the_reference_on_every_scene_on_ideal_ground(name, steps):
    scene = read_scene(name)
    short = scene.with_run(duration_s=min(scene.run.duration_s, steps * scene.run.step_s))
    assert max(agreement(short)) < 2e-9


def test_agreement_would_notice_a_wrong_motor_constant(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(EVERYTHING + INPUTS["steps"])
    scene = read_scene(path)
    run = simulate(scene, usual_signals(scene))
    scene.vehicle["motor"]["gear_ratio"] *= 1.000001
    states = reference_states(scene, run.time_s)
    assert error_of(run.columns_of("nu_rad_per_s"), states[:, :3]) > 1e-7


# ---- How the error of `auto` falls when its step is halved, on made-up vehicles with h·r up to 1.

SEED, VEHICLES = 5, 2000
STEPS = 8             # compared with as many times FINER, which err 2^48 times less
FINER = 64
ROUNDING = 1e-13      # above it an error is of the method
WHOLE_DECAY = 0.125   # up to it a step is one panel
CORE = load("double")


def end_of(vehicle: Made, step_s: float, steps: int) -> np.ndarray:
    plant = vehicle.plant(CORE, "auto", step_s)
    plant.run(vehicle.helds[0], steps)
    pose = plant.pose
    return np.array([*plant.nu, pose.x_m, pose.y_m, pose.heading_rad])


def errors_where(is_meant: Callable[[float], bool], longest_s: float, most_yaw_rad: float) -> Iterator[list[float]]:
    """Of a step and of half of it, for vehicles and steps by chance; `is_meant` takes h·r, a step's yaw is bounded."""
    for number in range(VEHICLES):
        vehicle = made(SEED, number, VEHICLES)
        start = vehicle.plant(CORE, "auto", 0.001)
        decay_per_s = max(start.c.model.decay_per_s[k] for k in range(3))
        h_r = float(10 ** np.random.default_rng([SEED, number]).uniform(-1.3, 0))
        step_s = h_r / decay_per_s
        if not (is_meant(h_r) and step_s < longest_s and step_s * abs(start.nu[2]) < most_yaw_rad):
            continue
        true = end_of(vehicle, step_s / FINER, STEPS * FINER)
        size = max(1.0, np.abs(true).max())
        yield [float(np.abs(end_of(vehicle, step_s / k, STEPS * k) - true).max() / size) for k in (1, 2)]


@pytest.mark.nightly
def test_half_a_step_errs_at_least_200_times_less_where_both_have_as_many_panels():
    pairs = list(errors_where(lambda h_r: not WHOLE_DECAY < h_r <= 2 * WHOLE_DECAY, 0.1, 1.5))
    slopes = [np.log2(whole / half) for whole, half in pairs if half > ROUNDING]
    assert len(pairs) > 700
    assert len(slopes) >= 5
    assert min(slopes) >= 7.7


@pytest.mark.nightly
def test_where_half_a_step_loses_its_panels_nothing_but_rounding_is_seen():
    pairs = list(errors_where(lambda h_r: WHOLE_DECAY < h_r <= 2 * WHOLE_DECAY, 0.03, 0.3))
    assert len(pairs) > 200
    assert max(map(max, pairs)) <= ROUNDING


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
