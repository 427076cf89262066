"""FMUs of scenes with an IMU and encoders: bits, saved states, what is refused, and what an FMU without them keeps."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_importer import DISCARD, ERROR, OK, Importer, generic
from lxml import etree
from test_fmu_bits import VARIANTS
from test_fmu_state import SUFFIX, deserialize, save, serialize

from laconic.core import load
from laconic.core.plant import Plant
from laconic.core.sensors import Sensors
from laconic.fmu import make_fmu
from laconic.scene import Scene, read_scene
from laconic_fmu.archive import read_parts
from scene_text import BODY, ENCODERS, IMU, RUN, WHEELS, sensed_scene

VERSIONS = pytest.mark.parametrize("version", [2, 3])
SENSED = ("acceleration_body_m_per_s2", "imu_acceleration_m_per_s2", "imu_yaw_rate_rad_per_s", "encoder_count")
STEP_S, EVERY = 0.002, 4
GROUND = "[ground]\nfriction_coefficient = 0.5\n"
ON_GROUND = BODY + "com_z_m = 0.1\n" + WHEELS


def fmu_of(folder: Path, version: int, *tables: str, **more: Any) -> Path:
    """The FMU of the test's vehicle with these tables."""
    return make_fmu(sensed_scene(folder, *(tables or (IMU, ENCODERS)), RUN), folder / "x.fmu", version=version, **more)


def volts(k: int) -> list[float]:
    """Voltages of one communication step."""
    return [6.0 - k % 3, -4.0 + k % 5, 5.0]


def drive(importer: Importer, first: int, last: int) -> list[list[float]]:
    """Communication steps of some internal steps each; all outputs of sensors after each."""
    rows = []
    for k in range(first, last):
        assert importer.set("voltage_V", *volts(k)) == OK
        assert importer.step(k * EVERY * STEP_S, EVERY * STEP_S) == OK, importer.log
        rows.append(shown(importer))
    return rows


def shown(importer: Importer) -> list[float]:
    """All outputs of sensors."""
    return [value for name in SENSED for value in importer.get(name)]


def shown_by_core(sensors: Sensors, held: Any) -> list[float]:
    """The same of the core."""
    found = sensors.read(held)
    return [*found.acceleration_body_m_per_s2, *found.imu_acceleration_m_per_s2, found.imu_yaw_rate_rad_per_s,
            *found.encoder_count]


def core_of(scene: Scene) -> tuple[Plant, Sensors]:
    """Plant and sensors of the core at the scene's start."""
    plant = scene.plant(load("double"))
    return plant, scene.sensors_of(plant)


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("ground", ["", GROUND], ids=["ideal", "friction"])
def test_sensors_of_an_fmu_show_the_cores_bits(ground: str, variant: str, tmp_path: Path) -> None:
    version, scalar = VARIANTS[variant]
    scene = sensed_scene(tmp_path, ground, IMU, ENCODERS, RUN, head=ON_GROUND)
    plant, sensors = core_of(scene)
    with Importer(make_fmu(scene, tmp_path / "x.fmu", version=version, scalar=scalar)) as importer:
        importer.initialize()
        assert shown(importer) == shown_by_core(sensors, None)
        for k in range(250):
            held = plant.input_of({"voltage_V": volts(k)})
            sensors.run(held, EVERY)
            assert drive(importer, k, k + 1)[0] == shown_by_core(sensors, held), f"after {(k + 1) * EVERY} steps"
        assert plant.steps == 1000


@VERSIONS
def test_an_fmu_on_ground_with_friction_shows_its_acceleration_without_sensors(version: int, tmp_path: Path) -> None:
    scene = sensed_scene(tmp_path, GROUND, RUN, head=ON_GROUND)
    plant, sensors = core_of(scene)
    with Importer(make_fmu(scene, tmp_path / "x.fmu", version=version)) as importer:
        importer.initialize()
        assert "imu_yaw_rate_rad_per_s" not in importer.variables
        for k in range(50):
            assert importer.set("voltage_V", *volts(k)) == OK
            assert importer.step(k * STEP_S, STEP_S) == OK
            held = plant.input_of({"voltage_V": volts(k)})
            sensors.run(held)
            found = importer.get("acceleration_body_m_per_s2")
            assert found == sensors.read(held).acceleration_body_m_per_s2.tolist()
        assert max(map(abs, found)) > 0.1


def test_inputs_with_slopes_are_seen_by_the_sensors_step_by_step(tmp_path: Path) -> None:
    scene = sensed_scene(tmp_path, IMU, ENCODERS, RUN)
    plant, sensors = core_of(scene)
    with Importer(make_fmu(scene, tmp_path / "x.fmu", version=2)) as importer:
        importer.initialize()
        reference = importer.references("voltage_V[1]")
        importer.must("SetRealInputDerivatives", reference, 1, importer.ffi.new("int[]", [1]),
                      importer.ffi.new("double[]", [100.0]))
        assert importer.step(0.0, 3 * STEP_S) == OK
        rows = np.zeros((3, 3, plant.core.input_length))
        for n in range(3):
            rows[n, :, plant.core.input_offset("voltage_V[1]")] = [100.0 * ((n + 0.5 * k) * STEP_S) for k in range(3)]
        sensors.run_sampled(rows)
        assert shown(importer) == shown_by_core(sensors, plant.core.input({"voltage_V[1]": 0.0 + 100.0 * (3 * STEP_S)}))


@VERSIONS
def test_a_saved_state_holds_the_samples_on_their_way_the_noise_and_the_counts(version: int, tmp_path: Path) -> None:
    fmu = fmu_of(tmp_path, version)
    with Importer(fmu) as first, Importer(fmu) as second:
        first.initialize()
        drive(first, 0, 20)
        state, data = save(first), serialize(first)
        once = drive(first, 20, 40)
        first.must(f"Set{SUFFIX[version]}", state[0])
        assert drive(first, 20, 40) == once
        first.must(f"Free{SUFFIX[version]}", state)
        second.initialize()
        assert deserialize(second, data) == OK
        assert drive(second, 20, 40) == once


@VERSIONS
def test_reset_begins_the_noise_and_the_counts_anew(version: int, tmp_path: Path) -> None:
    with Importer(fmu_of(tmp_path, version)) as importer:
        importer.initialize()
        once = drive(importer, 0, 20)
        importer.must("Reset")
        importer.initialize()
        assert drive(importer, 0, 20) == once


@VERSIONS
def test_settings_of_sensors_are_parameters_before_initialization_ends(version: int, tmp_path: Path) -> None:
    changed = sensed_scene(tmp_path, IMU.replace("seed = 11", "seed = -4").replace("x_m = 0.15", "x_m = -0.3"),
                           ENCODERS.replace("4096", "100"), RUN, name="changed")
    _, sensors = core_of(changed)
    with Importer(fmu_of(tmp_path, version)) as importer:
        counts = (100, 0, 360)
        for name, values in (("imu_seed", (-4,)), ("imu_x_m", (-0.3,)), ("encoder_counts_per_turn", counts)):
            assert importer.set(name, *values) == OK
        importer.initialize()
        for k in range(20):
            held = sensors.plant.input_of({"voltage_V": volts(k)})
            sensors.run(held, EVERY)
            assert drive(importer, k, k + 1)[0] == shown_by_core(sensors, held)
        assert importer.set("imu_seed", 1) == ERROR
        assert "it is fixed once initialization has ended" in importer.log[-1][2]


@VERSIONS
@pytest.mark.parametrize("tables", [(IMU,), (IMU, ENCODERS)], ids=["alone", "beside encoders"])
def test_an_imu_that_a_parameter_takes_away_shows_0(tables: tuple[str, ...], version: int, tmp_path: Path) -> None:
    with Importer(fmu_of(tmp_path, version, *tables)) as importer:
        assert importer.set("has_imu", 0) == OK
        importer.initialize()
        for k in range(20):
            assert importer.set("voltage_V", *volts(k)) == OK
            assert importer.step(k * EVERY * STEP_S, EVERY * STEP_S) == OK, importer.log
            assert [*importer.get("imu_acceleration_m_per_s2"), *importer.get("imu_yaw_rate_rad_per_s")] == [0.0] * 3
        assert importer.get("velocity_body_m_per_s") != [0.0, 0.0]
        assert ENCODERS not in tables or any(importer.get("encoder_count"))


REFUSED = {"imu_heading_rad": (1e300, "imu_heading_rad: "), "encoder_counts_per_turn": (-1, "outside its range"),
           "encoder_wrap": (1, "a counter of 1 value shows nothing"),
           "imu_delay_steps": (65, "outside its range"), "imu_yaw_rate_range_rad_per_s": (-1.0, "outside its range")}


@VERSIONS
@pytest.mark.parametrize("name", REFUSED)
def test_a_setting_that_no_sensor_has_is_refused_by_its_name(name: str, version: int, tmp_path: Path) -> None:
    value, text = REFUSED[name]
    with Importer(fmu_of(tmp_path, version)) as importer:
        many = [value] * (3 if name == "encoder_counts_per_turn" else 1)
        if importer.set(name, *many) == OK:
            importer.enter_initialization()
            assert importer.call("ExitInitializationMode") == ERROR
        assert len(importer.log) == 1
        assert name in importer.log[0][2] and text in importer.log[0][2], importer.log


@VERSIONS
def test_a_step_in_which_a_sensor_leaves_its_range_is_taken_back(version: int, tmp_path: Path) -> None:
    with Importer(fmu_of(tmp_path, version), logging=True) as importer:
        assert importer.set("encoder_gear_ratio", 1e9, 0.0, 1.0) == OK
        importer.initialize()
        before, counts = importer.get("x_m"), importer.get("encoder_count")
        assert importer.set("voltage_V", 0.0, 0.0, 0.0) == OK
        assert importer.step(0.0, STEP_S) == OK  # at rest nothing turns
        assert importer.set("axle_torque_Nm", 100.0, 100.0, 100.0) == OK
        for steps in (1, 3):
            assert importer.step(STEP_S, steps * STEP_S) == DISCARD
            assert "encoder_counts_per_turn[1]" in importer.log[-1][2]
            assert (importer.get("x_m"), importer.get("encoder_count")) == (before, counts)
        assert importer.set("axle_torque_Nm", 0.0, 0.0, 0.0) == OK
        assert importer.step(STEP_S, STEP_S) == OK


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_fmu_of_a_scene_with_sensors_is_one_for_co_simulation_alone_and_valid(variant: str, tmp_path: Path) -> None:
    version, scalar = VARIANTS[variant]
    fmu = fmu_of(tmp_path, version, scalar=scalar)
    assert validate_fmu(str(fmu)) == []
    description = fmpy.read_model_description(str(fmu), validate=False)
    assert description.modelExchange is None
    assert description.coSimulation is not None
    with Importer(fmu, "ModelExchange") as importer:  # in spite of that
        for name in ("SetupExperiment", "EnterInitializationMode")[version - 2:]:
            importer.must(name, *((0, 0.0, 0.0, 0, 0.0) if name[0] == "S" else ()
                                  if version == 2 else (False, 0.0, 0.0, False, 0.0)))
        assert importer.call("ExitInitializationMode") == ERROR
        assert "use Co-Simulation" in importer.log[-1][2]


@pytest.mark.nightly  # a process of its own; that of hinges on ground with friction is checked in every run
def test_the_manipulation_toolbox_has_no_finding_about_sensors(tmp_path: Path) -> None:
    tool = Path(sys.executable).parent / "fmutool"
    done = subprocess.run([str(tool), "-input", str(fmu_of(tmp_path, 2)), "-check"], capture_output=True, text=True,
                          check=True)
    lines = (done.stdout + done.stderr).splitlines()
    assert any("compliant with FMI" in line for line in lines), lines
    assert not [line for line in lines if line.startswith(("WARNING", "ERROR", "CRITICAL"))]


def test_an_fmu_has_the_variables_of_the_sensors_that_its_scene_has(tmp_path: Path) -> None:
    def names(*tables: str) -> set[str]:
        fmu = make_fmu(sensed_scene(tmp_path, *tables, RUN), tmp_path / "x.fmu", version=3, scalar=True)
        found = {v.name.partition("[")[0] for v in fmpy.read_model_description(str(fmu)).modelVariables}
        return {name for name in found if name.startswith(("imu_", "encoder_", "has_imu", "acceleration_body"))}
    of_sensors = {field.name for field in load().sensor_fields}
    of_imu = {"has_imu", "imu_acceleration_m_per_s2", "imu_yaw_rate_rad_per_s"} | {
        name for name in of_sensors if name.startswith("imu_")}
    of_encoders = {"encoder_count"} | {name for name in of_sensors if name.startswith("encoder_")}
    assert names() == {"acceleration_body_m_per_s2"}
    assert names(IMU) == {"acceleration_body_m_per_s2"} | of_imu
    assert names(ENCODERS) == {"acceleration_body_m_per_s2"} | of_encoders
    assert names(IMU, ENCODERS) == {"acceleration_body_m_per_s2"} | of_imu | of_encoders


def test_units_of_sensors_are_those_of_their_names(tmp_path: Path) -> None:
    root = etree.fromstring(read_parts(fmu_of(tmp_path, 3))["modelDescription.xml"])
    units = {kind.get("name"): kind.get("unit") for kind in root.iter("Float64Type")}
    found = {v.get("name"): units[v.get("declaredType")] for v in root.iter("Float64")}
    ends = {"_m_per_s2": "m/s2", "_rad_per_s": "rad/s", "_m_per_s2_per_sqrt_Hz": "m/s2/sqrt(Hz)", "_x_m": "m",
            "_rad_per_s_per_sqrt_Hz": "rad/s/sqrt(Hz)", "_heading_rad": "rad"}
    for end, unit in ends.items():
        named = [name for name in found if name.endswith(end) and name.startswith(("imu_", "acceleration_"))]
        assert named
        assert {found[name] for name in named} == {unit}


@VERSIONS
def test_model_exchange_shows_the_acceleration_of_co_simulation(version: int, tmp_path: Path) -> None:
    fmu = make_fmu(read_scene("robotino2"), tmp_path / "x.fmu", version=version)
    with Importer(fmu) as steps, Importer(fmu, "ModelExchange") as exchange:
        for importer in (steps, exchange):
            importer.initialize()
            assert importer.set("voltage_V", 3.0, -2.0, 1.0) == OK
            if importer is exchange:
                if version == 2:
                    info = importer.ffi.new("fmi2EventInfo *")
                    importer.must("NewDiscreteStates", info)
                importer.must("EnterContinuousTimeMode")
            assert importer.get("acceleration_body_m_per_s2") != [0.0, 0.0]
        for k in range(100):
            assert steps.step(k * 0.001, 0.001) == OK
        states = [*steps.get("nu_rad_per_s"), *steps.get("x_m"), *steps.get("y_m"), *steps.get("heading_rad"),
                  *steps.get("wheel_angle_rad")]
        exchange.must("SetContinuousStates", exchange.ffi.new("double[]", states), len(states))
        assert exchange.get("acceleration_body_m_per_s2") == pytest.approx(steps.get("acceleration_body_m_per_s2"),
                                                                           rel=1e-12)


def test_fewer_wheels_than_the_scene_has_leave_their_encoders_out(tmp_path: Path) -> None:
    with Importer(fmu_of(tmp_path, 3)) as importer:
        importer.must("EnterConfigurationMode")
        assert importer.set("wheel_count", 2) == OK
        importer.must("ExitConfigurationMode")
        importer.wheels = 2
        importer.initialize()
        assert len(importer.get("encoder_count")) == 2


def test_the_generic_fmu_has_no_sensors() -> None:
    for version in (2, 3):
        with Importer(generic(version)) as importer:
            assert not [name for name in importer.variables if name.startswith(("imu_", "encoder_", "has_imu"))]
