"""Vehicles with hinges against peers: accelerations at random states against maximal coordinates with multipliers,
kinematics against WPILib's swerve and CommonRoad's car and trailer.

The last two are optional: `pip install robotpy-wpimath commonroad-vehicle-models`.

Articulated vehicles against reference trajectories that were computed to 25 digits.
"""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from articulated_runner import Case, input_words, run, start_words, trajectory, vehicle_words
from hinge_scenes import held, scene_with, two_wheels
from maximal_coordinates import Maximal, left_of, turned
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import laconic
from laconic.base.paths import build_dir

STATES, ALL_STATES = 150, 1000
CASES = json.loads((Path(__file__).parents[1] / "data" / "articulated_reference.json").read_text())["cases"]
VEHICLES = {case["name"]: case["vehicle"] for case in CASES if case["vehicle"]["bodies"][-1]["mass"] > 0}


def body(parent: int, hinge: list[float], mass: float, inertia: float, com: list[float], kind: str) -> Case:
    return {"parent": parent, "hinge": hinge, "mass": mass, "inertia": inertia, "com": com,
            "joint": {"kind": kind, "damping": 0.3, "stiffness": 0.4, "rest": 0.1, "gain": 0.5}}


def wheel(number: int, x: float, y: float, axle: float = -math.pi / 2) -> Case:
    return {"body": number, "kind": "fixed", "at": [x, y], "axle": axle, "radius": 0.1, "inertia": 0.01, "gain": 0.3,
            "damping": 0.2}


def branching_tree() -> Case:
    omni = VEHICLES["omni-trailer-free"]
    bodies = [omni["bodies"][0], body(0, [-0.25, 0.03], 10, 0.4, [-0.3, 0.02], "free"),
              body(1, [-0.5, 0.05], 4, 0.1, [-0.2, 0.03], "free"), body(1, [-0.2, 0.3], 3, 0.05, [0.1, 0.1], "motor"),
              body(2, [-0.3, 0.0], 2, 0.02, [-0.1, 0.0], "prescribed")]
    return {"bodies": bodies, "wheels": [*omni["wheels"][:4], wheel(3, 0.0, 0.02), wheel(2, -0.3, 0.1)]}


def train() -> Case:
    """A car, a trailer, a trailer with two axles that cannot yaw, and a caster on it."""
    car = VEHICLES["ackermann-one-trailer-off-axle"]
    bodies = [*car["bodies"], body(3, [-2.4, 0.1], 90, 40, [-0.9, 0.0], "free"),
              body(4, [-1.5, 0.3], 3, 0.2, [-0.1, 0.0], "free")]
    return {"bodies": bodies, "wheels": [*car["wheels"], wheel(4, -1.2, 0.4), wheel(5, -0.2, 0.0)]}


VEHICLES |= {"branching tree": branching_tree(), "train": train()}


def commanded_angles(vehicle: Case, twist: list[list[float]]) -> dict[int, tuple[float, float, float]]:
    """ψ, ψ' and ψ'' of coordinated hinges at T + T't."""
    found = {}
    for number, hung in enumerate(vehicle["bodies"]):
        if hung.get("joint", {}).get("kind") != "coordinated":
            continue
        lever = 1j * complex(*hung["hinge"])
        w, rate = (complex(twist[0][k], twist[1][k]) + lever * twist[2][k] for k in (0, 1))
        ratio = rate / w
        found[number] = (math.atan2(w.imag, w.real), ratio.imag, (-ratio * ratio).imag)
    return found


def random_moment(vehicle: Case, rng: np.random.Generator) -> tuple[Case, Case]:
    """A segment and a start."""
    hinges, wheels = range(1, len(vehicle["bodies"])), len(vehicle["wheels"])
    segment: Case = {"U": list(rng.normal(size=wheels) * 5), "axle_torque": list(rng.normal(size=wheels)),
                     "body_wrench": list(rng.normal(size=3) * 5), "world_force": list(rng.normal(size=2)),
                     "point": list(rng.normal(size=2) * 0.2), "hinge_U": {}, "hinge_torque": {}, "hinge_rate": {}}
    for b in hinges:
        kind = vehicle["bodies"][b]["joint"]["kind"]
        if kind == "prescribed":
            segment["hinge_rate"][str(b)] = list(rng.normal(size=2))
        if kind in ("free", "motor"):
            segment["hinge_torque"][str(b)], segment["hinge_U"][str(b)] = rng.normal(), rng.normal()
    has_axle = any(w["body"] == 0 and w["kind"] == "fixed" for w in vehicle["wheels"])
    turn, sideways = list(rng.uniform(-0.3, 0.3, 2)), [0.0, 0.0] if has_axle else list(rng.normal(size=2))
    segment["twist"] = [[1.0, 0.0 if has_axle else rng.normal()], sideways, turn]
    psi = list(rng.uniform(-1.3, 1.3, len(hinges)))
    for b, (angle, _, _) in commanded_angles(vehicle, segment["twist"]).items():
        psi[b - 1] = angle
    start = {"velocity": list(rng.normal(size=3)), "pose": [0.0, 0.0, rng.uniform(-3, 3)], "psi": psi,
             "hinge_rate": list(rng.normal(size=len(hinges)))}
    return segment, start


def from_core(vehicle: Case, start: Case, row: list[float]) -> tuple[list[Any], ...]:
    """Headings, velocities and accelerations of the centres of mass, from the core's twists X and X'."""
    count = len(vehicle["bodies"])
    numbers = np.array(row).reshape(2, count, 3)
    heading = [start["pose"][2]]
    for number, hung in enumerate(vehicle["bodies"][1:]):
        heading.append(heading[hung["parent"]] + start["psi"][number])
    velocity, acceleration = [], []
    for number, hung in enumerate(vehicle["bodies"]):
        (x, y, w), (ax, ay, aw) = numbers[0, number], numbers[1, number]
        arm = np.array(hung["com"]) if number else np.zeros(2)
        own = np.array([ax, ay]) + w * left_of(np.array([x, y])) + aw * left_of(arm) - w * w * arm
        velocity.append(turned(heading[number], np.array([x, y]) + w * left_of(arm)))
        acceleration.append([*turned(heading[number], own), aw])
    return heading, velocity, list(numbers[0, :, 2]), acceleration


def outer_forces(vehicle: Case, segment: Case, heading: list[float], yaw_rate: list[float],
                 spin: list[float]) -> np.ndarray:
    bodies, wheels = vehicle["bodies"], vehicle["wheels"]
    force = np.zeros(3 * len(bodies) + len(wheels))
    force[:2] = turned(heading[0], np.array(segment["body_wrench"][:2])) + np.array(segment["world_force"])
    arm = turned(heading[0], np.array(segment["point"]))
    force[2] = segment["body_wrench"][2] + left_of(arm) @ np.array(segment["world_force"])
    for b in range(1, len(bodies)):
        joint, parent = bodies[b]["joint"], bodies[b]["parent"]
        if joint["kind"] not in ("free", "motor"):
            continue
        angle, rate = heading[b] - heading[parent], yaw_rate[b] - yaw_rate[parent]
        torque = segment["hinge_torque"][str(b)] - joint.get("damping", 0) * rate
        torque -= joint.get("stiffness", 0) * (angle - joint.get("rest", 0))
        if joint["kind"] == "motor":
            torque += joint["gain"] * segment["hinge_U"][str(b)]
        force[3 * b + 2] += torque
        force[3 * parent + 2] -= torque
    for number, given in enumerate(wheels):
        force[3 * len(bodies) + number] = (given["gain"] * segment["U"][number] + segment["axle_torque"][number]
                                           - given["damping"] * spin[number])
    return force


def spins(vehicle: Case, heading: list[float], velocity: list[Any], yaw_rate: list[float]) -> list[float]:
    """Wheel speeds by which the contacts hold."""
    found = []
    for given in vehicle["wheels"]:
        b = given["body"]
        arm = turned(heading[b], np.array(given["at"]) - np.array(vehicle["bodies"][b]["com"]))
        hub = velocity[b] + yaw_rate[b] * left_of(arm)
        roller = given.get("roller", math.pi / 2)
        along = turned(heading[b] + given["axle"] + roller, np.array([1.0, 0.0]))
        found.append(float(along @ hub) / (given["radius"] * math.sin(roller)))
    return found


@pytest.mark.parametrize("name", VEHICLES)
def test_accelerations_are_those_of_maximal_coordinates(name: str) -> None:
    assert_accelerations(name, STATES, 7)


@pytest.mark.nightly
@pytest.mark.parametrize("name", VEHICLES)
def test_a_thousand_accelerations_are_those_of_maximal_coordinates(name: str) -> None:
    assert_accelerations(name, ALL_STATES, 8)


def assert_accelerations(name: str, states: int, seed: int) -> None:
    vehicle, rng = VEHICLES[name], np.random.default_rng(seed)
    moments = [random_moment(vehicle, rng) for _ in range(states)]
    words = vehicle_words(vehicle)
    for segment, start in moments:
        words += [*input_words(vehicle, segment), *start_words(start), "rates reactions"]
    rows = run(words)
    for (segment, start), row, reactions in zip(moments, rows[::2], rows[1::2], strict=True):
        heading, velocity, yaw_rate, acceleration = from_core(vehicle, start, row)
        spin = spins(vehicle, heading, velocity, yaw_rate)
        force = outer_forces(vehicle, segment, heading, yaw_rate, spin)
        commanded: dict[int, float | None] = dict.fromkeys(range(1, len(heading)))
        commanded |= {b: angles[2] for b, angles in commanded_angles(vehicle, segment["twist"]).items()}
        commanded |= {int(b): rate[1] for b, rate in segment["hinge_rate"].items()}
        maximal = Maximal(vehicle, np.array(heading), np.array(velocity), np.array(yaw_rate), np.array(spin))
        expected = maximal.accelerations(force, commanded)[:3 * len(heading)]
        off = np.abs(expected - np.concatenate(acceleration)).max() / max(1, np.abs(expected).max())
        assert off < 1e-11
        assert reactions[-1] < 1e-13  # what is left of the forces at body 0


@pytest.mark.nightly
@pytest.mark.timeout(900)
@pytest.mark.parametrize("real", ["double", "single"])
def test_a_million_steps_of_random_trees_end_and_never_become_nan(real: str) -> None:
    program = build_dir() / "core_c" / "tests" / f"test_articulated_random_{real}"
    if not program.is_file():
        pytest.skip(f"{program.name} is not built")
    found = subprocess.run([str(program), "1000000"], capture_output=True, text=True, timeout=880, check=False)
    assert found.returncode == 0, found.stdout


# ------------------------------------------------------------------------------------------- swerve


@pytest.fixture(scope="module")
def wpi() -> Any:
    kinematics, geometry = pytest.importorskip("wpimath.kinematics"), pytest.importorskip("wpimath.geometry")
    scene = laconic.read_scene("frc_swerve_mk4i")
    modules = [geometry.Translation2d(body["hinge_x_m"], body["hinge_y_m"]) for body in scene.vehicle["body"]]
    return scene, kinematics, kinematics.SwerveDrive4Kinematics(*modules)


def apart(a: float, b: float) -> float:
    """Of two angles."""
    return abs(math.remainder(a - b, 2.0 * math.pi))


def test_swerve_modules_point_and_roll_as_wpilib_says_for_a_thousand_twists(wpi: Any) -> None:
    scene, kinematics, peer = wpi
    vehicle, rng = laconic.ArticulatedVehicle.of(scene), np.random.default_rng(8)
    centre = complex(scene.vehicle["com_x_m"], scene.vehicle["com_y_m"])
    radius = scene.vehicle["wheel_radius_m"]
    for _ in range(1000):
        ahead, left, turn = rng.normal(size=3)
        at_centre = complex(ahead, left) + 1j * turn * centre
        plant = vehicle.plant(velocity_m_per_s=(at_centre.real, at_centre.imag), yaw_rate_rad_per_s=turn,
                              inputs={"steering_twist": [ahead, left, turn]})
        motion = plant.motion()
        assert plant.changed_m_per_s < 1e-12
        states = peer.toSwerveModuleStates(kinematics.ChassisSpeeds(ahead, left, turn))
        for state, angle, spin in zip(states, motion.hinge_angle_rad, motion.wheel_speed_rad_per_s, strict=True):
            assert apart(state.angle.radians(), angle) < 1e-12
            assert spin * radius == pytest.approx(state.speed, rel=1e-12, abs=1e-12)


def test_wpilib_finds_the_motion_of_a_swerve_run_from_its_wheels(wpi: Any) -> None:
    scene, kinematics, peer = wpi
    run = laconic.simulate(scene, ["velocity_body_m_per_s", "yaw_rate_rad_per_s", "hinge_angle_rad",
                                   "wheel_speed_rad_per_s"])
    centre = np.array([scene.vehicle["com_x_m"], scene.vehicle["com_y_m"]])
    radius, fastest = scene.vehicle["wheel_radius_m"], 0.0
    geometry = pytest.importorskip("wpimath.geometry")
    for angles, spins, velocity, turn in zip(run.columns_of("hinge_angle_rad"), run.columns_of("wheel_speed_rad_per_s"),
                                             run.columns_of("velocity_body_m_per_s"),
                                             run.columns["yaw_rate_rad_per_s"], strict=True):
        found = peer.toChassisSpeeds(tuple(kinematics.SwerveModuleState(spin * radius, geometry.Rotation2d(angle))
                                           for angle, spin in zip(angles, spins, strict=True)))
        expected = [*(velocity - turn * np.array([-centre[1], centre[0]])), turn]
        assert [found.vx, found.vy, found.omega] == pytest.approx(expected, abs=1e-11)
        fastest = max(fastest, float(np.hypot(*velocity)))
    assert fastest > 0.5


# ------------------------------------------------------------------------- single track and trailer

WHEELBASE_M, TRAILER_M = 2.5, 3.0


@pytest.fixture(scope="module")
def tractor() -> Any:
    """A run of a single-track vehicle with a trailer on its rear axle, and CommonRoad's parameters of it."""
    models = pytest.importorskip("vehiclemodels.vehicle_dynamics_kst")
    parameters = pytest.importorskip("vehiclemodels.parameters_vehicle4").parameters_vehicle4()
    parameters.a, parameters.b, parameters.trailer.l_wb = 1.0, WHEELBASE_M - 1.0, TRAILER_M
    tables = two_wheels(trailer=[{"name": "cart", "hitch_x_m": 0.0, "length_m": TRAILER_M, "track_m": 1.0,
                                  "radius_m": 0.2, "mass_kg": 150.0, "yaw_inertia_kgm2": 60.0,
                                  "start_angle_deg": 20.0}])
    tables["vehicle"] |= {"motor_gain_Nm_per_V": 2.0, "motor_damping_Nms": 1.0, "com_x_m": 0.8, "mass_kg": 400.0}
    tables["vehicle"]["wheel"].append({"kind": "fixed", "axle_deg": -90.0, "x_m": WHEELBASE_M, "y_m": 0.0,
                                       "steered": "prescribed", "name": "front", "driven": False,
                                       "rate_limit_rad_per_s": 0.5, "mass_kg": 10.0, "yaw_inertia_kgm2": 0.1})
    steering = {"signal": "steering_angle_rad[front]", "kind": "table", "t_s": [0.0, 2.0, 4.0, 8.0],
                "value": [0.0, 0.45, -0.3, 0.2]}
    tables["input"] = [*held(voltage_V__1=6.0, voltage_V__2=6.0), steering]
    tables["run"] = {"duration_s": 8.0, "step_s": 0.01}
    kept = ["origin_x_m", "origin_y_m", "heading_rad", "velocity_body_m_per_s", "yaw_rate_rad_per_s",
            "hinge_angle_rad", "hinge_rate_rad_per_s"]
    return laconic.simulate(scene_with(tables, initial={"velocity_body_m_per_s": [0.0, 0.0]}), kept), \
        models.vehicle_dynamics_kst, parameters


def test_yaw_rate_and_hitch_rate_are_those_of_commonroads_single_track_with_trailer(tractor: Any) -> None:
    run, rates_of, parameters = tractor
    at = {name: [hinge.name for hinge in run.scene.hinges].index(name) for name in ("front", "cart")}
    assert run.columns["velocity_body_m_per_s[1]"][-1] > 0.8
    for k in range(0, len(run.time_s), 5):
        angles, speed = run.columns_of("hinge_angle_rad")[k], run.columns["velocity_body_m_per_s[1]"][k]
        state = [0.0, 0.0, angles[at["front"]], speed, run.columns["heading_rad"][k], angles[at["cart"]]]
        found = rates_of(state, [0.0, 0.0], parameters)
        assert run.columns["yaw_rate_rad_per_s"][k] == pytest.approx(found[4], abs=1e-11)
        assert run.columns_of("hinge_rate_rad_per_s")[k][at["cart"]] == pytest.approx(found[5], abs=1e-11)


def test_the_path_and_the_trailer_are_those_that_commonroads_model_integrates(tractor: Any) -> None:
    run, rates_of, parameters = tractor
    speed = CubicSpline(run.time_s, run.columns["velocity_body_m_per_s[1]"])
    knots, levels = (0.0, 2.0, 4.0, 8.0), (0.0, 0.45, -0.3, 0.2)

    def rates(t: float, x: np.ndarray) -> list[float]:
        state = [x[0], x[1], float(np.interp(t, knots, levels)), float(speed(t)), x[2], x[3]]
        found = rates_of(state, [0.0, 0.0], parameters)
        return [found[0], found[1], found[4], found[5]]

    x = np.array([run.columns["origin_x_m"][0], 0.0, 0.0, math.radians(20.0)])
    for first, last in zip(knots, knots[1:], strict=False):
        x = solve_ivp(rates, (first, last), x, rtol=1e-10, atol=1e-10).y[:, -1]
    expected = [run.columns[name][-1] for name in ("origin_x_m", "origin_y_m", "heading_rad", "hinge_angle_rad[cart]")]
    assert x == pytest.approx(expected, abs=1e-6)
    assert max(map(abs, run.columns["heading_rad"])) > 0.15


NAMES = [case["name"] for case in CASES]


def errors(case: Case, rows: list[list[float]]) -> dict[str, float]:
    """The largest error of each kind over the states, over the largest number of that kind (at least 1)."""
    hinges, wheels = len(case["vehicle"]["bodies"]) - 1, len(case["vehicle"]["wheels"])
    kinds = {"velocity": 3, "pose": 3, "psi": hinges, "hinge_rate": hinges, "wheel_speed": wheels, "chi": wheels}
    worst, size = dict.fromkeys(kinds, 0.0), dict.fromkeys(kinds, 1.0)
    assert len(rows) == len(case["states"])
    for row, state in zip(rows, case["states"], strict=True):
        at = 1
        for kind, count in kinds.items():
            for got, text in zip(row[at:at + count], state[kind], strict=True):
                worst[kind] = max(worst[kind], abs(got - float(text)))
                size[kind] = max(size[kind], abs(float(text)))
            at += count
    return {kind: worst[kind] / size[kind] for kind in kinds}


def assert_errors(case: Case, method: str, step_s: float, limit: float, real: str = "double") -> None:
    found = errors(case, trajectory(case, method, step_s, real))
    assert max(found.values()) <= limit, {kind: f"{error:.1e}" for kind, error in found.items()}


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_auto_meets_the_reference_at_1_ms(case: Case) -> None:
    assert_errors(case, "auto", 1e-3, 1e-9)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_auto_meets_the_reference_at_10_ms(case: Case) -> None:
    assert_errors(case, "auto", 1e-2, 1e-5)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
@pytest.mark.parametrize("method", ["rk4", "circle", "moebius-4"])
def test_every_method_meets_the_reference(case: Case, method: str) -> None:
    assert_errors(case, method, 1e-3, 5e-9)
    assert_errors(case, method, 1e-2, 1e-5)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_single_precision_meets_the_reference(case: Case) -> None:
    assert_errors(case, "auto", 1e-2, 1e-4, "single")
