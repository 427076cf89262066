"""A vehicle with its wheel-speed controller: two FMUs of one glue in one process, by hand and as SSP."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.validation import validate_fmu
from fmu_importer import OK, Importer

from laconic.fmu import make_fmu
from laconic.scene import Scene, read_scene
from laconic.ssp import make_controller, make_ssp

SETPOINT = (12.0, 10.0, 12.0, 10.0)
STEP_S, STEPS = 0.01, 400


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A youBot."""
    return read_scene("kuka_youbot").with_run(method="auto", step_s=STEP_S)


@pytest.mark.parametrize(("version", "scalar"), [(2, False), (3, False), (3, True)])
def test_the_controller_is_a_valid_fmu_too(scene: Scene, version: int, scalar: bool, tmp_path: Path) -> None:
    assert validate_fmu(str(make_controller(scene, tmp_path / "c.fmu", version=version, scalar=scalar))) == []


@pytest.mark.parametrize("version", [2, 3])
def test_the_wheels_reach_their_set_points(scene: Scene, version: int, tmp_path: Path) -> None:
    vehicle_fmu = make_fmu(scene, tmp_path / "v.fmu", version=version)
    controller_fmu = make_controller(scene, tmp_path / "c.fmu", version=version)
    with Importer(vehicle_fmu) as vehicle, Importer(controller_fmu) as controller:
        vehicle.initialize()
        controller.initialize()
        assert controller.set("setpoint_rad_per_s", *SETPOINT) == OK
        for k in range(STEPS):
            assert controller.set("wheel_speed_rad_per_s", *vehicle.get("wheel_speed_rad_per_s")) == OK
            assert controller.step(k * STEP_S, STEP_S) == OK
            assert vehicle.set("voltage_V", *controller.get("voltage_V")) == OK
            assert vehicle.step(k * STEP_S, STEP_S) == OK
        speeds = np.array(vehicle.get("wheel_speed_rad_per_s"))
        assert np.abs(controller.get("voltage_V")).max() <= 24.0
    np.testing.assert_allclose(speeds, SETPOINT, atol=0.2)


def test_voltage_is_limited_and_the_integral_does_not_wind_up(scene: Scene, tmp_path: Path) -> None:
    with Importer(make_controller(scene, tmp_path / "c.fmu", version=3)) as controller:
        controller.initialize()
        assert controller.set("setpoint_rad_per_s", 1000.0, -1000.0, 0.0, 0.0) == OK
        for k in range(100):
            assert controller.step(k * STEP_S, STEP_S) == OK
        assert controller.get("voltage_V") == [24.0, -24.0, 0.0, 0.0]
        assert controller.get("angle_error_rad") == [0.0] * 4


def test_the_ssp_runs_in_fmpy_and_the_wheels_reach_their_set_points(scene: Scene, tmp_path: Path) -> None:
    ssp = make_ssp(scene, tmp_path / "vehicle.ssp")
    wanted = {f"setpoint_rad_per_s[{i + 1}]": lambda _, value=value: value for i, value in enumerate(SETPOINT)}
    result = simulate_ssp(str(ssp), stop_time=STEPS * STEP_S, step_size=STEP_S, input=wanted)
    ends = [result[name][-1] for i in range(4) for name in result.dtype.names
            if name.endswith(f"vehicle.wheel_speed_rad_per_s[{i + 1}]")]
    np.testing.assert_allclose(ends, SETPOINT, atol=0.2)
