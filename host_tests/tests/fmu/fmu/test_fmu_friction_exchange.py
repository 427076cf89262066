"""FMUs of vehicles on ground with friction in Model Exchange: wheel speeds are states, forces follow a smooth law."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_friction_scenes import friction_scene
from fmu_importer import ERROR, OK, Importer, generic
from test_fmu_bits import VARIANTS
from test_fmu_friction import VERSIONS, VOLTAGE_V, everything, fmu_of, held_voltages
from test_fmu_state import deserialize, serialize

from laconic.core import load

CREEP_M_PER_S = 1e-3  # LACONIC_SMOOTH_SLIP_M_PER_S


def exchange(fmu: Path) -> Importer:
    """A Model Exchange instance in continuous-time mode, with voltages."""
    importer = Importer(fmu, "ModelExchange")
    importer.initialize()
    importer.must("EnterContinuousTimeMode")
    assert importer.set("voltage_V", *VOLTAGE_V[: importer.wheels]) == OK
    return importer


def put(importer: Importer, states: list[float]) -> None:
    """Sets the continuous states."""
    importer.must("SetContinuousStates", importer.ffi.new("double[]", states), len(states))


def some_states(wheels: int) -> list[float]:
    """ν, pose, wheel angles and speeds that differ."""
    return [3.0, -1.0, 0.5, 0.2, -0.3, 0.7, *(0.1 * i for i in range(wheels)), *(2.0 + i for i in range(wheels))]


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "variant"), [*(("skid_steering", each) for each in VARIANTS),
                                               ("omni_with_limits", "fmi2"), ("omni_with_limits", "fmi3")])
def test_fmpy_validates_every_description_with_friction(name: str, variant: str, tmp_path: Path) -> None:
    version, scalar = VARIANTS[variant]
    assert validate_fmu(str(fmu_of(name, tmp_path, version, scalar))) == []


@VERSIONS
def test_wheel_speeds_are_states_and_the_rates_are_the_cores(version: int, tmp_path: Path) -> None:
    scene, core = friction_scene("skid_steering", tmp_path), load("double")
    plant, held = scene.plant(core), held_voltages(core, VOLTAGE_V)
    with exchange(fmu_of("skid_steering", tmp_path, version)) as importer:
        assert importer.state_count == 14
        states = some_states(4)
        put(importer, states)
        assert importer.states() == states
        rates, wheels = core.ffi.new("laconic_rates *"), core.ffi.new("double[16]")
        core.lib.laconic_friction_derivative(rates, wheels, core.ffi.addressof(plant.c, "friction"),
                                             core.ffi.addressof(plant.c, "model"), states[:3], states[5], states[10:],
                                             held)
        pose = [rates.x_m_per_s, rates.y_m_per_s, rates.yaw_rate_rad_per_s]
        assert importer.rates() == [*rates.nu_rad_per_s2, *pose, *states[10:], *list(wheels)[:4]]
        assert importer.get("wheel_speed_rad_per_s") == states[10:]


@VERSIONS
def test_the_forces_shown_are_those_that_accelerate_body_and_wheels(version: int, tmp_path: Path) -> None:
    with exchange(fmu_of("omni_on_friction", tmp_path, version)) as importer:
        put(importer, some_states(3))
        radius_m, mass_kg, inertia_kgm2 = 0.08, 20.0, 0.004 + 20.0**2 * 1e-6
        along, lateral = importer.get("wheel_reaction_N"), importer.get("wheel_lateral_N")
        bearings = np.radians([60.0, 180.0, 300.0])
        torque, rates = importer.get("wheel_torque_Nm"), importer.rates()
        speed = np.array(importer.get("wheel_speed_rad_per_s"))
        friction_Nm = 0.05 * speed / np.hypot(speed, CREEP_M_PER_S / radius_m)
        assert rates[9:] == pytest.approx((np.array(torque) - friction_Nm - radius_m * np.array(along)) / inertia_kgm2)
        force_N = [sum(a * -np.sin(b) + n * np.cos(b) for a, n, b in zip(along, lateral, bearings, strict=True)),
                   sum(a * np.cos(b) + n * np.sin(b) for a, n, b in zip(along, lateral, bearings, strict=True))]
        nu, yaw_rate = importer.states()[:3], rates[5]
        acceleration = [rates[0] - yaw_rate * nu[1], rates[1] + yaw_rate * nu[0]]
        assert np.array(acceleration) * radius_m * mass_kg == pytest.approx(np.array(force_N))


@VERSIONS
def test_model_exchange_with_friction_is_saved_and_its_states_are_set_one_by_one(version: int, tmp_path: Path) -> None:
    fmu = fmu_of("skid_steering", tmp_path, version)
    with exchange(fmu) as importer, exchange(fmu) as other:
        put(importer, some_states(4))
        data, rates, row = serialize(importer), importer.rates(), everything(importer)
        assert importer.set("wheel_speed_rad_per_s", 1.0, 1.0, 1.0, 1.0) == OK
        assert importer.states() == [*some_states(4)[:10], 1.0, 1.0, 1.0, 1.0]
        assert importer.rates() != rates
        for each in (importer, other):
            assert deserialize(each, data) == OK
            assert each.rates() == rates
            assert everything(each) == row


def test_only_model_exchange_with_friction_sets_wheel_speeds(tmp_path: Path) -> None:
    for fmu, kind in ((generic(3), "ModelExchange"), (fmu_of("skid_steering", tmp_path), "CoSimulation")):
        with Importer(fmu, kind) as importer:
            importer.initialize()
            assert importer.set("wheel_speed_rad_per_s", 1.0, 1.0, 1.0, 1.0) == ERROR


@VERSIONS
def test_a_payload_keeps_the_velocity_of_body_and_wheels_in_model_exchange(version: int, tmp_path: Path) -> None:
    with exchange(fmu_of("skid_steering", tmp_path, version)) as importer:
        put(importer, some_states(4))
        importer.must("EnterEventMode")
        assert importer.set("payload_mass_kg", 5.0) == OK
        assert importer.get("wheel_speed_rad_per_s") == [2.0, 3.0, 4.0, 5.0]
        assert importer.get("yaw_rate_rad_per_s")[0] == pytest.approx(0.5 / (np.sqrt(0.8 / 20.0) / 0.08))


@VERSIONS
def test_model_exchange_without_friction_in_an_fmu_with_its_states_is_refused(version: int, tmp_path: Path) -> None:
    fmu = fmu_of("omni_on_friction", tmp_path, version)
    with Importer(fmu, "ModelExchange") as importer:
        for name in ("ground_friction_coefficient", "ground_roller_drag", "ground_axle_friction_Nm"):
            assert importer.set(name, 0.0) == OK
        importer.enter_initialization()
        assert importer.call("ExitInitializationMode") == ERROR
        assert "states for wheels that slip" in importer.log[-1][2]


def cvode(fmu: Path, start: dict[str, Any], stop_s: float) -> np.ndarray:
    """x, y, heading at the end, by FMPy's CVODE."""
    wanted = ["x_m", "y_m", "heading_rad"]
    found = fmpy.simulate_fmu(str(fmu), fmi_type="ModelExchange", solver="CVode", stop_time=stop_s,
                              output_interval=stop_s / 64, relative_tolerance=1e-10, start_values=start, output=wanted)
    return np.array([found[name][-1] for name in wanted])


def stepped(scene: Any, volts: list[float], stop_s: float, step_s: float) -> np.ndarray:
    """The same by the core's friction step."""
    core = load("double")
    plant = scene.with_run(step_s=step_s).plant(core)
    plant.run(held_voltages(core, volts), round(stop_s / step_s))
    return plant.row()[3:6]


@VERSIONS
def test_cvode_agrees_with_the_friction_step_to_first_order_while_wheels_slip(version: int, tmp_path: Path) -> None:
    start = "[initial]\nnu_rad_per_s = [20.0, 10.0, 8.0]\nwheel_speed_rad_per_s = [-60.0, 60.0, 60.0]\n"
    scene = friction_scene("omni_on_friction", tmp_path, last=start)
    volts = [-30.0, 60.0, 60.0]
    given = {"voltage_V": volts} if version == 3 else {f"voltage_V[{i + 1}]": u for i, u in enumerate(volts)}
    exact = cvode(fmu_of("omni_on_friction", tmp_path, version, last=start), given, 0.064)
    error = [np.abs(stepped(scene, volts, 0.064, h) - exact).max() for h in (0.004, 0.001, 0.00025)]
    assert error[0] < 1e-3
    assert error[0] / error[1] == pytest.approx(4.0, abs=0.4)
    assert error[1] / error[2] == pytest.approx(4.0, abs=0.2)


@VERSIONS
def test_cvode_agrees_with_the_step_of_a_drive_with_limits_on_ideal_ground(version: int, tmp_path: Path) -> None:
    scene, volts = friction_scene("omni_with_limits", tmp_path), [-9.0, 5.0, 14.0]
    given = {"voltage_V": volts} if version == 3 else {f"voltage_V[{i + 1}]": u for i, u in enumerate(volts)}
    exact = cvode(fmu_of("omni_with_limits", tmp_path, version), given, 1.024)
    error = [np.abs(stepped(scene, volts, 1.024, h) - exact).max() for h in (0.004, 0.001, 0.00025)]
    assert error[0] < 2e-2
    assert error[0] / error[1] == pytest.approx(4.0, abs=0.4)
    assert error[1] / error[2] == pytest.approx(4.0, abs=0.2)


LIMITS = {"supply_V": 100.0, "supply_resistance_ohm": 0.0, "current_limit_A": 0.0}
SHOWN = ("der(nu_rad_per_s)", "wheel_speed_rad_per_s", "wheel_torque_Nm", "wheel_reaction_N", "wheel_lateral_N",
         "no_slip_margin_N", "energy_J")


@VERSIONS
def test_limits_that_are_not_reached_leave_the_ideal_model(version: int, tmp_path: Path) -> None:
    with exchange(fmu_of("omni_with_limits", tmp_path, version)) as wide, \
            exchange(fmu_of("omni_on_a_slope", tmp_path, version)) as ideal:
        wide.must("EnterEventMode")
        ideal.must("EnterEventMode")
        assert [wide.set(name, value) for name, value in LIMITS.items()] == [OK] * 3
        assert ideal.set("slope_rad", 0.0) == OK
        for importer in (wide, ideal):
            assert importer.state_count == 9
            assert importer.set("nu_rad_per_s", 3.0, -1.0, 0.5) == OK
            assert importer.set("heading_rad", 0.7) == OK
            assert importer.set("world_force_N", 5.0, 2.0) == OK
        for name in SHOWN:
            assert wide.get(name) == pytest.approx(ideal.get(name), rel=1e-12, abs=1e-12), name
        assert wide.get("drive_limit") == [0.0, 0.0, 0.0]
        assert wide.set("current_limit_A", 5.0) == OK
        assert wide.get("motor_current_A")[2] == 5.0
        assert wide.get("der(nu_rad_per_s)") != pytest.approx(ideal.get("der(nu_rad_per_s)"), rel=1e-3)


def test_cvode_stays_within_the_creep_of_the_smooth_law_where_wheels_stick(tmp_path: Path) -> None:
    scene, volts = friction_scene("skid_steering", tmp_path), [6.0, 4.0, 6.0, 4.0]
    found = cvode(fmu_of("skid_steering", tmp_path), {"voltage_V": volts}, 1.0)
    step = stepped(scene, volts, 1.0, 0.001)
    first_order = np.abs(stepped(scene, volts, 1.0, 0.002) - step).max()
    assert np.abs(found - step).max() < 2.0 * first_order + 2.0 * CREEP_M_PER_S * 1.0
