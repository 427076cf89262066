"""Kinematics of vehicles with hinges against packages of others: WPILib's swerve, CommonRoad's car and trailer.

Each package is optional: `pip install robotpy-wpimath commonroad-vehicle-models`."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hinge_scenes import held, scene_with, two_wheels
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import laconic

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
    assert max(map(abs, run.columns["heading_rad"])) > 0.3
