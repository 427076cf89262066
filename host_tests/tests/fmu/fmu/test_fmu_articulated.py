"""FMUs of vehicles with hinges: the core's bits, Model Exchange, commands that jump, saved states, refusals."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_importer import DISCARD, ERROR, OK, Importer

from laconic.base.paths import built
from laconic.cli.main import run
from laconic.core import load
from laconic.core.articulated import ArticulatedPlant
from laconic.errors import BadInput
from laconic.fmu import make_fmu
from laconic.scene import Scene, read_scene
from laconic.simulation.loads import Loads

VARIANTS = {"fmi2": (2, False), "fmi3": (3, False), "fmi3-scalar": (3, True)}
EVERY_VARIANT = pytest.mark.parametrize("variant", VARIANTS)
BOTH = pytest.mark.parametrize("version", [2, 3])
OF_MOTION = ("x_m", "y_m", "heading_rad", "velocity_body_m_per_s", "yaw_rate_rad_per_s", "hinge_rad",
             "hinge_rate_rad_per_s", "body_x_m", "body_y_m", "body_heading_rad", "wheel_speed_rad_per_s",
             "wheel_angle_rad", "energy_J")
OF_GROUND = ("wheel_torque_Nm", "wheel_reaction_N", "wheel_lateral_N", "hinge_reaction_Nm", "hinge_force_along_N",
             "hinge_force_across_N")
BLOCKS, STEPS = 12, 10


def generic(version: int) -> Path:
    """The FMU of the build: two driven wheels and two casters."""
    return built(f"fmu/LaconicArticulated_fmi{version}.fmu")


@contextmanager
def started(scene: Scene, variant: str, folder: Path, **options: Any) -> Iterator[Importer]:
    version, scalar = VARIANTS[variant]
    with Importer(make_fmu(scene, folder / "scene.fmu", version=version, scalar=scalar), **options) as importer:
        yield importer.initialize()


def plant_of(scene: Scene, importer: Importer) -> ArticulatedPlant:
    """The core's vehicle at the start of an FMU of its scene."""
    vehicle = scene.articulated_vehicle(load("double"))
    row = vehicle.input_row()
    at = vehicle.slot("steering_twist")
    row[at : at + 3] = importer.get("steering_twist")
    return vehicle.plant(scene.run.method, scene.run.step_s, x_m=scene.initial.x_m, y_m=scene.initial.y_m,
                         heading_rad=scene.initial.heading_rad, inputs=row,
                         hinge_angle_rad=[hinge.start_angle_rad for hinge in scene.hinges])


def values_of(importer: Importer, names: tuple[str, ...]) -> list[float]:
    return [value for name in names for value in importer.get(name)]


def motion_of(plant: ArticulatedPlant) -> list[float]:
    m = plant.motion()
    return [m.x_m, m.y_m, m.heading_rad, *m.velocity_m_per_s, m.yaw_rate_rad_per_s, *m.hinge_angle_rad,
            *m.hinge_rate_rad_per_s, *m.body_x_m, *m.body_y_m, *m.body_heading_rad, *m.wheel_speed_rad_per_s,
            *m.wheel_angle_rad, m.energy_J]


def ground_of(plant: ArticulatedPlant, row: np.ndarray) -> list[float]:
    r = plant.reactions(row)
    return [*r.wheel_torque_Nm, *r.along_N, *r.lateral_N, *r.hinge_torque_Nm, *r.hinge_force_N[:, 0],
            *r.hinge_force_N[:, 1]]


def drive(scene: Scene, importer: Importer, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Sets random inputs; the core's row of them, and how fast it changes."""
    vehicle = scene.articulated_vehicle(load("double"))
    row, rate = vehicle.input_row(), vehicle.input_row()
    plain = {"voltage_V": 6.0, "axle_torque_Nm": 0.05, "body_force_N": 0.3, "body_moment_Nm": 0.02,
             "hinge_voltage_V": 2.0, "hinge_torque_Nm": 0.02, "steering_rate_rad_per_s": 0.4}
    for name, size in plain.items():
        values = (size * random.uniform(-1, 1, importer.size(name))).tolist()
        assert importer.set(name, *values) == OK
        items = [hinge.name for hinge in scene.hinges] if name.startswith(("hinge", "steering")) else \
            range(1, len(values) + 1)
        signals = [name] if name.endswith("moment_Nm") else [f"{name}[{item}]" for item in items]
        for signal, value in zip(signals, values, strict=True):
            row[vehicle.slot(signal)] = value
    at = vehicle.slot("steering_twist")
    row[at : at + 3] = importer.get("steering_twist")
    if vehicle.is_coordinated:
        changes = [0.0, 0.0, 1.5 * random.uniform(-1, 1)]
        assert importer.set("steering_twist_rate", *changes) == OK
        rate[at : at + 3] = changes
    return row, rate


def rows_of(scene: Scene, row: np.ndarray, rate: np.ndarray, steps: int) -> np.ndarray:
    """Inputs at start and end of each step, with the derivative of the twist."""
    vehicle, h = scene.articulated_vehicle(load("double")), scene.run.step_s
    rows = np.array([[row + (k * h) * rate, row + ((k + 1) * h) * rate] for k in range(steps)])
    at = vehicle.slot("steering_twist")
    rows[:, :, at + 3 : at + 6] = rate[at : at + 3]
    return rows


@EVERY_VARIANT
@pytest.mark.parametrize("scene_name", ["mir_like", "f1tenth", "frc_swerve_mk4i", "tugger_train"])
def test_steps_give_the_same_bits_as_the_core(scene_name: str, variant: str, tmp_path: Path) -> None:
    same_bits(scene_name, variant, tmp_path)


@pytest.mark.nightly
@EVERY_VARIANT
@pytest.mark.parametrize("scene_name", ["tricycle_agv", "wheel_loader", "wheelchair", "pr2_base"])
def test_steps_of_the_other_robots_give_the_same_bits_as_the_core(scene_name: str, variant: str,
                                                                  tmp_path: Path) -> None:
    same_bits(scene_name, variant, tmp_path)


def same_bits(scene_name: str, variant: str, folder: Path) -> None:
    scene = read_scene(scene_name).with_run(real="double")
    random, h = np.random.default_rng(5), scene.run.step_s
    with started(scene, variant, folder) as importer:
        plant = plant_of(scene, importer)
        assert values_of(importer, OF_MOTION) == motion_of(plant)
        for block in range(BLOCKS):
            row, rate = drive(scene, importer, random)
            assert importer.step(block * STEPS * h, STEPS * h) == OK
            plant.follow(rows_of(scene, row, rate, STEPS), ramped=False)
            assert values_of(importer, OF_MOTION) == motion_of(plant)
            end = row + (STEPS * h) * rate
            assert values_of(importer, OF_GROUND) == ground_of(plant, rows_of(scene, end, rate, 1)[0, 0])
            acceleration = plant.acceleration(rows_of(scene, end, rate, 1)[0, 0])
            assert importer.get("wheel_load_N") == pytest.approx(list(Loads(scene).of(plant.motion(), acceleration)),
                                                                 rel=1e-9, abs=1e-9)
        assert max(map(abs, importer.get("wheel_angle_rad"))) > 1e-3


@BOTH
def test_model_exchange_agrees_with_co_simulation(version: int) -> None:
    given = {"voltage_V[1]": 6.0, "voltage_V[2]": 3.0} if version == 2 else {"voltage_V": [6.0, 3.0, 0.0, 0.0]}
    runs = [fmpy.simulate_fmu(str(generic(version)), fmi_type=kind, stop_time=1.0, output_interval=0.01,
                              relative_tolerance=1e-9, start_values=given)
            for kind in ("CoSimulation", "ModelExchange")]
    ends = [np.concatenate([np.atleast_1d(run[-1][name]).ravel() for name in run.dtype.names]) for run in runs]
    assert np.abs(ends[0] - ends[1]).max() < 1e-5 * np.abs(ends[0]).max()


@EVERY_VARIANT
def test_fmpy_validates_the_fmu_of_a_scene_without_a_message(variant: str, tmp_path: Path) -> None:
    version, scalar = VARIANTS[variant]
    fmu = make_fmu(read_scene("frc_swerve_mk4i"), tmp_path / "scene.fmu", version=version, scalar=scalar)
    assert validate_fmu(str(fmu)) == []
    description = fmpy.read_model_description(str(fmu))
    names = {variable.name for variable in description.modelVariables}
    some = "hinge_rad" if variant == "fmi3" else "hinge_rad[4]"
    assert {some, some.replace("hinge_rad", "hinge_rate_rad_per_s"), some.replace("hinge_rad", "body_x_m")} <= names
    assert "hinge_rad[5]" not in names


@BOTH
def test_a_command_that_jumps_in_event_mode_keeps_the_momenta(version: int, tmp_path: Path) -> None:
    scene = read_scene("wheel_loader").with_run(real="double")
    fmu = make_fmu(scene, tmp_path / "scene.fmu", version=version)
    with Importer(fmu, "ModelExchange") as importer:
        importer.initialize()
        plant, core = plant_of(scene, importer), load("double")
        assert importer.set("steering_rate_rad_per_s", 0.8) == OK
        update(importer)
        row = plant.vehicle.input_row({f"steering_rate_rad_per_s[{scene.hinges[0].name}]": 0.8})
        why = core.why()
        core.check(core.lib.laconic_articulated_jump(plant.vehicle.model, plant.c, plant._input(row), why), why)
        assert importer.get("hinge_rate_rad_per_s")[0] == 0.8
        assert max(map(abs, importer.get("wheel_speed_rad_per_s"))) > 1e-4
        assert values_of(importer, OF_MOTION) == pytest.approx(motion_of(plant), rel=1e-12, abs=1e-15)


@BOTH
def test_a_rate_at_the_start_moves_a_loader_that_stood(version: int, tmp_path: Path) -> None:
    scene = read_scene("wheel_loader").with_run(real="double")
    with Importer(make_fmu(scene, tmp_path / "scene.fmu", version=version)) as importer:
        importer.enter_initialization()
        assert importer.set("steering_rate_rad_per_s", 0.2) == OK
        importer.must("ExitInitializationMode")
        plant = plant_of(scene, importer)
        row = plant.vehicle.input_row({f"steering_rate_rad_per_s[{scene.hinges[0].name}]": 0.2})
        assert importer.step(0.0, scene.run.step_s) == OK
        plant.run(row)
        assert abs(importer.get("yaw_rate_rad_per_s")[0]) > 0.01
        assert values_of(importer, OF_MOTION) == pytest.approx(motion_of(plant), rel=1e-12, abs=1e-15)


@BOTH
def test_an_input_that_has_no_effect_is_logged_once(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        for value in (0.5, 0.6):
            assert importer.set("steering_rate_rad_per_s", 0.0, value) == OK
        assert importer.set("hinge_voltage_V", 3.0, 0.0) == OK
        assert importer.set("voltage_V", 3.0, 3.0, 3.0, 0.0) == OK
        assert [line for _, _, line in importer.log] == [
            "steering_rate_rad_per_s[2]: 0.5 rad/s has no effect: this hinge is not prescribed (body_hinge); give 0 "
            "(logged once)",
            "hinge_voltage_V[1]: 3 V has no effect: this hinge has no motor (body_hinge, hinge_gain_Nm_per_V); give 0 "
            "(logged once)",
            "voltage_V[3]: 3 V has no effect: this wheel has no motor (wheel_undriven, or a motor gain of 0); give 0 "
            "(logged once)"]


def update(importer: Importer) -> None:
    """An event iteration; the continuous states have changed."""
    ffi = importer.ffi
    if importer.version == 2:
        info = ffi.new("fmi2EventInfo *")
        importer.must("NewDiscreteStates", info)
        assert info.valuesOfContinuousStatesChanged
        return
    flags, time = ffi.new("bool[5]"), ffi.new("double *")
    importer.must("UpdateDiscreteStates", flags, flags + 1, flags + 2, flags + 3, flags + 4, time)
    assert flags[3]


@BOTH
def test_a_saved_state_continues_with_the_same_bits_in_another_instance(version: int, tmp_path: Path) -> None:
    scene = read_scene("mir_like").with_run(real="double")
    h = scene.run.step_s
    fmu = make_fmu(scene, tmp_path / "scene.fmu", version=version)
    with Importer(fmu) as one, Importer(fmu) as other:
        for each in (one, other):
            each.initialize()
        assert one.set("voltage_V", *[4.0 + i for i in range(one.size("voltage_V"))]) == OK
        assert one.step(0.0, 20 * h) == OK
        ffi, state, size = one.ffi, one.ffi.new("void **"), one.ffi.new("size_t *")
        upper = "FMUstate" if version == 2 else "FMUState"
        one.must(f"Get{upper}", state)
        one.must(f"Serialized{upper}Size", state[0], size)
        raw = ffi.new("char[]" if version == 2 else "uint8_t[]", size[0])
        one.must(f"Serialize{upper}", state[0], raw, size[0])
        copy = ffi.new("void **")
        other.must("DeSerializeFMUstate" if version == 2 else "DeserializeFMUState", raw, size[0], copy)
        other.must(f"Set{upper}", copy[0])
        for each, kept in ((one, state), (other, copy)):
            assert each.step(20 * h, 20 * h) == OK
            each.must(f"Free{upper}", kept)
        assert values_of(one, OF_MOTION + OF_GROUND) == values_of(other, OF_MOTION + OF_GROUND)


@BOTH
def test_a_payload_during_the_run_keeps_the_bodys_motion(version: int) -> None:
    names = ("origin_x_m", "origin_y_m", "heading_rad", "yaw_rate_rad_per_s", "hinge_rad", "wheel_angle_rad")
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.set("voltage_V", 6.0, 3.0, 0.0, 0.0) == OK
        for k in range(20):
            assert importer.step(k * 0.01, 0.01) == OK
        before, energy = values_of(importer, names), importer.get("energy_J")[0]
        for name, value in (("payload_mass_kg", 10.0), ("payload_x_m", 0.2), ("payload_y_m", 0.1)):
            assert importer.set(name, value) == OK
        assert values_of(importer, names) == pytest.approx(before, rel=1e-12, abs=1e-13)
        assert importer.get("energy_J")[0] > energy
        assert importer.step(0.2, 0.01) == OK


def test_an_input_with_a_slope_varies_linearly_over_the_communication_step(tmp_path: Path) -> None:
    scene = read_scene("tricycle_agv").with_run(real="double")
    h, steps = scene.run.step_s, 10
    with started(scene, "fmi2", tmp_path) as importer:
        plant = plant_of(scene, importer)
        names = [f"voltage_V[{i + 1}]" for i in range(scene.wheel_count)]
        names += [f"steering_rate_rad_per_s[{b + 1}]" for b in range(len(scene.hinges))]
        signals = names[: scene.wheel_count] + [f"steering_rate_rad_per_s[{hinge.name}]" for hinge in scene.hinges]
        slopes = [3.0] * scene.wheel_count + [0.5] * len(scene.hinges)
        importer.must("SetRealInputDerivatives", importer.references(*names), len(names), [1] * len(names), slopes)
        assert importer.step(0.0, steps * h) == OK
        rows = np.zeros((steps, 2, len(plant.vehicle.input_row())))
        for signal, slope in zip(signals, slopes, strict=True):
            rows[:, 0, plant.vehicle.slot(signal)] = np.arange(steps) * h * slope
            rows[:, 1, plant.vehicle.slot(signal)] = np.arange(1, steps + 1) * h * slope
        at = plant.vehicle.slot("steering_twist")
        rows[:, :, at : at + 3] = importer.get("steering_twist")
        plant.follow(rows)
        assert values_of(importer, OF_MOTION) == pytest.approx(motion_of(plant), rel=1e-12, abs=1e-14)
        assert importer.get("voltage_V")[0] == pytest.approx(3.0 * steps * h)


@BOTH
@pytest.mark.parametrize(("name", "values", "line"), [
    ("body_hinge", (1, 0), "body_hinge[2]: "),
    ("body_parent", (1, 0), "body_parent[1]: "),
    ("wheel_body", (0, 0, 1, 3), "wheel_body[4]: "),
    ("body_mass_kg", (0.6, -1.0), "body_mass_kg[2]: "),
    ("start_velocity_m_per_s", (0.0, 1.0), "start_velocity_m_per_s: this start makes a fixed wheel slide")])
def test_a_vehicle_that_cannot_start_is_refused_by_one_line(version: int, name: str, values: tuple[float, ...],
                                                            line: str) -> None:
    with Importer(generic(version)) as importer:
        status = importer.set(name, *values)
        if status == OK:
            importer.enter_initialization()
            assert importer.call("ExitInitializationMode") == ERROR
        assert line in importer.log[-1][2]
        assert "\n" not in importer.log[-1][2]
        assert len(importer.log) == 1


def test_a_body_beyond_those_of_the_start_values_must_be_set() -> None:
    with Importer(generic(3)) as importer:
        importer.must("EnterConfigurationMode")
        assert importer.set("body_count", 3) == OK
        importer.must("ExitConfigurationMode")
        importer.must("EnterInitializationMode", False, 0.0, 0.0, False, 0.0)
        assert importer.call("ExitInitializationMode") == ERROR
        assert "body_hinge[3]" in importer.log[-1][2]


@BOTH
def test_a_twist_against_the_wheels_is_discarded_and_nothing_moves(version: int, tmp_path: Path) -> None:
    scene = read_scene("f1tenth")
    with started(scene, f"fmi{version}", tmp_path, logging=True) as importer:
        before = values_of(importer, OF_MOTION)
        assert importer.set("steering_twist", 0.0, 1.0, 0.0) == OK
        assert importer.step(0.0, scene.run.step_s) == DISCARD
        assert "steering_twist" in importer.log[-1][2]
        assert values_of(importer, OF_MOTION) == before


@BOTH
def test_partial_derivatives_are_refused_by_one_line(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        values = importer.ffi.new("double[]", 4)
        count = (4, values, 1) if version == 3 else (values,)
        name = ("x_m", "voltage_V") if version == 3 else ("x_m", "voltage_V[1]")
        status = importer.call("GetDirectionalDerivative", importer.references(name[0]), 1,
                               importer.references(name[1]), 1, values, *count)
        assert status == ERROR
        assert "x_m" in importer.log[-1][2] or "has no derivatives" in importer.log[-1][2]


def test_the_command_writes_it_and_states_what_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "tugger.fmu"
    assert run(["fmu", "tugger_train", "--fmi", "2", "-o", str(out)]) == 0
    assert "the FMU does not limit angle and rate of front" in capsys.readouterr().err
    description = fmpy.read_model_description(str(out))
    starts = {variable.name: variable.start for variable in description.modelVariables}
    assert description.coSimulation.modelIdentifier == "LaconicArticulated"
    assert [starts[f"hinge_is_ball[{b}]"] for b in (1, 2, 3, 4)] == ["false", "true", "true", "true"]
    assert float(starts["body_mass_kg[2]"]) == 400.0


@pytest.mark.parametrize("option", ["derivatives", "estimate"])
def test_what_such_an_fmu_lacks_is_refused_by_one_line(option: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=rf"^--{option}: the FMU of a vehicle with hinges \(.*\) has no such variant"):
        make_fmu(read_scene("mir_like"), tmp_path / "x.fmu", version=2, **{option: True})


def test_an_ssp_archive_is_refused_by_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["fmu", "f1tenth", "--fmi", "2", "--ssp", "-o", str(tmp_path / "x.ssp")]) == 2
    assert "ssp: the FMU of a vehicle with hinges" in capsys.readouterr().err
    assert not (tmp_path / "x.ssp").exists()


def in_ecos(fmu: Path, given: dict[str, float], names: list[str], steps: int, step_s: float) -> list[float]:
    import ecospy

    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("vehicle", str(fmu))
        structure.add_parameter_set("drive", {f"vehicle::{name}": value for name, value in given.items()})
        with ecospy.EcosSimulation(structure=structure, step_size=step_s) as simulation:
            simulation.init(parameter_set="drive")
            simulation.step(steps)
            ends = [simulation.get_real(f"vehicle::{name}") for name in names]
            simulation.terminate()
    return ends


def in_libcosim(fmu: Path, given: dict[str, float], names: list[str], steps: int, step_s: float) -> list[float]:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(step_size=int(step_s * 1e9))
    slave = execution.add_local_slave(CosimLocalSlave(fmu_path=str(fmu), instance_name="vehicle"))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    reference = {each.name.decode(): each.reference for each in execution.slave_variables(slave)}
    for name, value in given.items():
        assert execution.real_initial_value(slave, reference[name], value)
    execution.step(steps)
    return list(observer.last_real_values(slave, [reference[name] for name in names]))


@pytest.mark.nightly
@pytest.mark.parametrize("scene_name", ["f1tenth", "frc_swerve_mk4i"])
@pytest.mark.parametrize(("package", "run_in"), [("ecospy", in_ecos), ("libcosimpy", in_libcosim)])
def test_a_car_and_a_swerve_run_in_other_importers(scene_name: str, package: str, run_in: Any, tmp_path: Path) -> None:
    pytest.importorskip(package)
    scene = read_scene(scene_name).with_run(real="double", step_s=0.01)
    fmu = make_fmu(scene, tmp_path / "scene.fmu", version=2, enumerations=False)
    given = {f"voltage_V[{i + 1}]": 3.0 for i in range(scene.wheel_count)} | {"steering_twist_rate[3]": 0.2}
    with Importer(fmu) as importer:
        names = ["x_m", "y_m", "heading_rad", *importer.elements("hinge_rad")[0]]
        names += importer.elements("wheel_angle_rad")[0]
        importer.enter_initialization()
        importer.must("SetReal", importer.references(*given), len(given), list(given.values()))
        importer.must("ExitInitializationMode")
        for k in range(50):
            assert importer.step(k * 0.01, 0.01) == OK
        expected = [importer.get(name)[0] for name in names]
    assert max(map(abs, expected)) > 0.1
    assert run_in(fmu, given, names, 50, 0.01) == pytest.approx(expected, rel=1e-6, abs=1e-9)
