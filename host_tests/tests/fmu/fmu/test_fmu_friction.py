"""FMUs of vehicles with ground friction, limits of a drive or a slope: bits, saved states, changes in Co-Simulation."""

from __future__ import annotations

import re
import shutil
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import pytest
from fmu_friction_scenes import PARTS, friction_scene
from fmu_importer import DISCARD, ERROR, OK, Importer, generic
from test_fmu_bits import NAMES, VARIANTS, outputs_of, random_inputs, signal_name
from test_fmu_state import SUFFIX, deserialize, save, serialize

from laconic.base.paths import build_dir
from laconic.core import Core, load
from laconic.fmu import make_fmu
from laconic_fmu.friction import OUTPUTS

VERSIONS = pytest.mark.parametrize("version", [2, 3])
STEPS, EVERY = 1000, 100
STEP_S = 0.002
VOLTAGE_V = [11.0, -3.0, 14.0, 2.0]


def fmu_of(name: str, folder: Path, version: int = 3, scalar: bool = False, **keys: Any) -> Path:
    """The FMU of one of the test scenes."""
    return make_fmu(friction_scene(name, folder, **keys), folder / f"{name}.fmu", version=version, scalar=scalar)


def friction_outputs(plant: Any, held: Any) -> list[float]:
    """The core's outputs of friction and drive, in the order of OUTPUTS."""
    found = plant.outputs(held).friction
    values = [getattr(found, name) for name in OUTPUTS]
    return [x for value in values for x in ([value] if isinstance(value, float) else list(value)[: plant.wheel_count])]


def everything(importer: Importer) -> list[float]:
    """All outputs of an FMU with friction."""
    return [value for name in (*NAMES, *OUTPUTS) for value in importer.get(name)]


def drive(importer: Importer, first: int, last: int) -> None:
    """Some steps with voltages that change."""
    for k in range(first, last):
        assert importer.set("voltage_V", *(VOLTAGE_V[i] + k % 5 for i in range(importer.wheels))) == OK
        assert importer.step(k * STEP_S, STEP_S) == OK, importer.log


def held_voltages(core: Core, volts: list[float]) -> Any:
    """The core's input of these voltages."""
    return core.input({f"voltage_V[{i + 1}]": value for i, value in enumerate(volts)})


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", PARTS)
def test_a_thousand_steps_with_friction_limits_and_slopes_give_the_cores_bits(
        name: str, variant: str, tmp_path: Path) -> None:
    version, scalar = VARIANTS[variant]
    scene, core = friction_scene(name, tmp_path), load("double")
    plant, with_friction = scene.plant(core), name != "omni_on_a_slope"
    with Importer(fmu_of(name, tmp_path, version, scalar)) as importer:
        importer.initialize()
        for k, inputs in enumerate(random_inputs(STEPS // EVERY, scene.wheel_count)):
            given = {each: [5.0 * x for x in values] for each, values in inputs.items()}
            for each, values in given.items():
                assert importer.set(each, *values) == OK
            held = core.input({signal_name(each, values, i): value for each, values in given.items()
                               for i, value in enumerate(values)})
            for tick in range(k * EVERY, (k + 1) * EVERY):
                assert importer.step(tick * STEP_S, STEP_S) == OK, importer.log
            plant.run(held, EVERY)
            expected = outputs_of(plant, held) + (friction_outputs(plant, held) if with_friction else [])
            names = (*NAMES, *OUTPUTS) if with_friction else NAMES
            assert [x for each in names for x in importer.get(each)] == expected, f"after {(k + 1) * EVERY} steps"


def test_all_states_of_contacts_and_limits_are_reached(tmp_path: Path) -> None:
    contact, limit = set(), set()
    with Importer(fmu_of("skid_steering", tmp_path, com_z_m=0.4)) as importer:
        importer.initialize()
        for k in range(500):
            volts = VOLTAGE_V if k < 300 else [0.0] * 4
            assert importer.set("voltage_V", *volts) == OK
            assert importer.step(k * STEP_S, STEP_S) == OK
            contact |= set(importer.get("contact_state"))
            limit |= set(importer.get("drive_limit"))
        assert contact == {0.0, 1.0, 2.0}
        assert limit == {0.0, 1.0, 2.0}
        lifted = [text for _, _, text in importer.log if "lifts" in text]
        assert len(lifted) == 1
        assert "it carries nothing" in lifted[0]


@VERSIONS
def test_energy_drawn_and_work_done_are_what_moves_and_what_is_lost(version: int, tmp_path: Path) -> None:
    with Importer(fmu_of("skid_steering", tmp_path, version)) as importer:
        importer.initialize()
        drive(importer, 0, 500)
        energy = {name: importer.get(name)[0] for name in (*OUTPUTS, "energy_J") if name.endswith("_J")}
        came = energy.pop("supply_energy_J") + energy.pop("outer_work_J")
        assert came > 10.0
        assert sum(energy.values()) == pytest.approx(came, rel=1e-12)


@VERSIONS
def test_a_saved_state_of_wheels_that_slip_continues_with_the_same_bits(version: int, tmp_path: Path) -> None:
    fmu = fmu_of("skid_steering", tmp_path, version)
    with Importer(fmu) as first, Importer(fmu) as second:
        first.initialize()
        drive(first, 0, 50)
        state, data = save(first), serialize(first)
        drive(first, 50, 90)
        once = everything(first)
        first.must(f"Set{SUFFIX[version]}", state[0])
        drive(first, 50, 90)
        assert everything(first) == once
        first.must(f"Free{SUFFIX[version]}", state)
        second.initialize()
        assert deserialize(second, data) == OK
        drive(second, 50, 90)
        assert everything(second) == once
        first.must("Reset")
        first.initialize()
        drive(first, 0, 90)
        assert everything(first) == once


def change_with_event(importer: Importer, name: str, values: list[Any]) -> None:
    """Sets a tunable parameter in event mode."""
    importer.must("EnterEventMode")
    assert importer.set(name, *values) == OK
    flags, time = importer.ffi.new("bool[5]"), importer.ffi.new("double *")
    importer.must("UpdateDiscreteStates", flags, flags + 1, flags + 2, flags + 3, flags + 4, time)
    importer.must("EnterStepMode")


@pytest.mark.parametrize(("version", "event_mode"), [(2, False), (3, False), (3, True)])
def test_payload_motor_circuit_and_ground_change_during_a_run_as_in_the_core(version: int, event_mode: bool,
                                                                      tmp_path: Path) -> None:
    scene, core = friction_scene("skid_steering", tmp_path), load("double")
    plant, held = scene.plant(core), held_voltages(core, VOLTAGE_V)
    changes = {100: ("payload_mass_kg", [6.0]), 200: ("motor_circuit", [0, 1, 2, 0]), 300: ("supply_V", [9.0]),
               320: ("ground_friction_coefficient", [0.2]), 340: ("slope_rad", [0.2]),
               350: ("own_motor_damping_Nms", [0.0, 3.0, 0.0, 0.0])}
    vehicle = core.ffi.new("laconic_vehicle *", plant.c.vehicle)
    with Importer(fmu_of("skid_steering", tmp_path, version), event_mode=event_mode) as importer:
        importer.initialize()
        if event_mode:
            importer.must("EnterStepMode")
        assert importer.set("voltage_V", *VOLTAGE_V) == OK
        for tick in range(400):
            if tick in changes:
                name, values = changes[tick]
                if event_mode:
                    change_with_event(importer, name, values)
                else:
                    assert importer.set(name, *values) == OK
                vehicle.payload.mass_kg = 6.0
                vehicle.wheel[1].motor_circuit, vehicle.wheel[2].motor_circuit = (1, 2) if tick >= 200 else (0, 0)
                vehicle.drive.supply_V = 9.0 if tick >= 300 else 12.0
                vehicle.ground.friction_coefficient = 0.2 if tick >= 320 else 0.6
                vehicle.ground.slope_rad = 0.2 if tick >= 340 else 0.1
                vehicle.wheel[1].own_motor_damping_Nms = 3.0 if tick >= 350 else 0.0
                plant.change(vehicle)
            assert importer.step(tick * STEP_S, STEP_S) == OK, importer.log
            plant.run(held, 1)
        assert everything(importer) == outputs_of(plant, held) + friction_outputs(plant, held)
        assert importer.get("motor_current_A")[1] == 0.0


def test_a_refused_communication_step_leaves_wheels_that_slip_as_they_were(tmp_path: Path) -> None:
    with Importer(fmu_of("omni_on_friction", tmp_path, 2)) as importer:
        importer.initialize()
        drive(importer, 0, 20)
        before = everything(importer)
        names, _ = importer.elements("voltage_V")
        slopes, orders = importer.ffi.new("double[]", [1e307]), importer.ffi.new("int[]", [1])
        importer.must("SetRealInputDerivatives", importer.references(names[0]), 1, orders, slopes)
        assert importer.step(20 * STEP_S, 10 * STEP_S) == DISCARD
        assert everything(importer) == before


@VERSIONS
def test_partial_derivatives_of_a_vehicle_with_friction_are_neither_offered_nor_given(version: int,
                                                                                      tmp_path: Path) -> None:
    fmu = fmu_of("skid_steering", tmp_path, version)
    with Importer(fmu) as importer:
        interface = importer.description.coSimulation
        assert not getattr(interface, "providesDirectionalDerivative", False)
        assert not getattr(interface, "providesDirectionalDerivatives", False)
        importer.initialize()
        speeds, _ = importer.elements("nu_rad_per_s")
        volts, _ = importer.elements("voltage_V")
        seed = importer.ffi.new("double[]", [1.0] * 4)
        result = importer.ffi.new("double[4]")
        unknowns, knowns = importer.references(speeds[0]), importer.references(volts[0])
        counts = (4, result, 3) if version == 3 else (result,)
        assert importer.call("GetDirectionalDerivative", unknowns, 1, knowns, 1, seed, *counts) == ERROR
        assert "no partial derivatives" in importer.log[-1][2]


REFUSED = {
    "ground_roller_drag": ([1.5], "outside its range: 0 to 1"),
    "ground_friction_coefficient": ([-0.1], "outside its range: at least 0"),
    "supply_resistance_ohm": ([-1.0], "outside its range: at least 0"),
    "motor_circuit": ([0, 3, 0, 0], "outside its range: 0 to 2"),
}


@VERSIONS
@pytest.mark.parametrize("name", REFUSED)
def test_a_value_outside_its_range_is_refused_in_one_line(version: int, name: str, tmp_path: Path) -> None:
    values, text = REFUSED[name]
    with Importer(fmu_of("skid_steering", tmp_path, version)) as importer:
        assert importer.set(name, *values) == ERROR
        assert len(importer.log) == 1
        assert name in importer.log[0][2]
        assert text in importer.log[0][2]


CANNOT_START = {
    "friction_coefficient": ([0.5], "0.5 is given besides ground.friction_coefficient"),
    "ground_friction_coefficient": ([0.0], "axle_friction_Nm"),
    "winding_resistance_ohm": ([0.0], "0 is not positive; give a value above 0"),
    "method": ([1], "use auto"),
}


@VERSIONS
@pytest.mark.parametrize("name", CANNOT_START)
def test_what_contradicts_friction_is_refused_in_one_line_when_the_run_starts(version: int, name: str,
                                                                             tmp_path: Path) -> None:
    values, text = CANNOT_START[name]
    with Importer(fmu_of("skid_steering", tmp_path, version)) as importer:
        assert importer.set(name, *values) == OK
        times = (0.0, 0, 0.0)
        if version == 2:
            importer.must("SetupExperiment", 0, 0.0, *times)
            importer.must("EnterInitializationMode")
        else:
            importer.must("EnterInitializationMode", False, 0.0, *times)
        assert importer.call("ExitInitializationMode") == ERROR
        assert len(importer.log) == 1
        assert text in importer.log[0][2]
        assert "\n" not in importer.log[0][2]


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
def test_the_sources_of_a_scenes_fmu_compile_with_the_options_that_it_names(tmp_path: Path) -> None:
    fmu = make_fmu(friction_scene("omni_on_a_slope", tmp_path), tmp_path / "slope.fmu", version=3)
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path)
    listed = (tmp_path / "sources/buildDescription.xml").read_text(encoding="utf-8")
    names = sorted(re.findall(r'<SourceFile name="([^"]+)"', listed))
    assert {"model.c", "variable_table.c", "core/step.c"} <= set(names)
    command = ["gcc", "-std=c99", "-fsyntax-only", "-Wall", "-Werror", "-I.", f"-I{build_dir() / 'parts' / 'fmi'}"]
    subprocess.run([*command, *names], cwd=tmp_path / "sources", check=True)


def test_the_fmu_of_ideal_ground_has_no_variable_of_friction() -> None:
    with Importer(generic(3)) as importer:
        assert not {"slip_along_m_per_s", "supply_V", "ground_friction_coefficient",
                    "der(wheel_speed_rad_per_s)"} & set(importer.variables)
        assert "slope_rad" in importer.variables
