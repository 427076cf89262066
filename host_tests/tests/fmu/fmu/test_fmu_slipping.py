"""FMUs of vehicles with hinges on ground with friction: the bits of a run, saved states, changes, refusals."""

from __future__ import annotations

import copy
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_importer import DISCARD, ERROR, OK, Importer
from fmu_saved_states import SUFFIX, deserialize, save, serialize
from test_fmu_articulated import in_ecos, in_libcosim

from laconic import build_scene, simulate
from laconic.base.paths import built
from laconic.cli.main import run
from laconic.core import load
from laconic.errors import BadInput
from laconic.fmu import make_fmu
from laconic.fmu.hinges import left_out
from laconic.scene import Scene
from laconic.scene.hinge_signals import output_signals_of
from laconic.scene.scene_tables import scene_tables
from laconic.simulation.slipping import SlippingCommands

VARIANTS = {"fmi2": (2, False), "fmi3": (3, False), "fmi3-scalar": (3, True)}
EVERY_VARIANT = pytest.mark.parametrize("variant", VARIANTS)
ONE_IN_ORDINARY_RUNS = pytest.mark.parametrize("variant", [
    "fmi3", *(pytest.param(each, marks=pytest.mark.nightly) for each in ("fmi2", "fmi3-scalar"))])
BOTH = pytest.mark.parametrize("version", [2, 3])
OF_WHEELS, PLAIN = ("voltage_V", "axle_torque_Nm", "body_force_N"), ("body_moment_Nm",)
OF_HINGES = ("hinge_voltage_V", "hinge_torque_Nm", "steering_rate_rad_per_s", "steering_angle_rad")
ROUNDED = ("origin_x_m", "origin_y_m", "heading_wrapped_rad")
"""Outputs that Python computes for a run, not the core."""
MOTOR = {"resistance_ohm": 0.5, "torque_constant_Nm_per_A": 0.02, "back_emf_Vs_per_rad": 0.02, "gear_ratio": 15.0}
WHEEL = {"kind": "fixed", "axle_deg": -90.0}
STEPS = 60


def generic(version: int) -> Path:
    """The FMU of the build: two driven wheels and two casters."""
    return built(f"fmu/LaconicSlipping_fmi{version}.fmu")


def on_friction(name: str) -> Scene:
    """A robot of the project on ground with friction, with every output at every step of a short run."""
    tables = copy.deepcopy(scene_tables(name).entries)
    friction = tables["vehicle"].pop("friction_coefficient", 0.8)
    return short(tables | {"ground": {"friction_coefficient": friction}})


def rich() -> Scene:
    """A carriage with all that acts on slipping trees: servo, motor with a loop, stop, spring, supply, scrub, creep."""
    wheels = [{**WHEEL, "x_m": 0.0, "y_m": y, "creep": 0.05, "friction_coefficient": mu}
              for y, mu in ((0.2, 0.9), (-0.2, 0.1))]
    wheels.append({**WHEEL, "x_m": 0.5, "y_m": 0.1, "steered": "servo", "name": "front", "driven": False,
                   "mass_kg": 1.0, "yaw_inertia_kgm2": 0.01, "scrub_radius_m": 0.02, "scrub_fade_m": 0.1,
                   "servo_gain_Nm_per_rad": 60.0, "servo_damping_Nms": 1.5, "servo_limit_Nm": 3.0,
                   "dry_friction_Nm": 0.2, "start_angle_rad": 0.05})
    wheels.append({**WHEEL, "x_m": 0.5, "y_m": -0.1, "steered": "motor", "name": "motor", "driven": False,
                   "mass_kg": 1.0, "yaw_inertia_kgm2": 0.01, "steering_motor": MOTOR,
                   "loop_V_per_rad": 40.0, "loop_Vs_per_rad": 2.0, "control_period_s": 0.01})
    caster = {"x_m": -0.2, "y_m": 0.0, "trail_m": 0.05, "radius_m": 0.04, "wheel_inertia_kgm2": 5e-5, "mass_kg": 0.4,
              "yaw_inertia_kgm2": 4e-4, "name": "rear", "stop_low_rad": -0.021, "stop_high_rad": 0.021}
    vehicle = {"mass_kg": 20.0, "yaw_inertia_kgm2": 0.8, "com_x_m": 0.15, "com_z_m": 0.1, "wheel_radius_m": 0.08,
               "wheel_inertia_kgm2": 0.01, "wheel": wheels, "caster": [caster],
               "support": [{"x_m": -0.3, "y_m": 0.0}], "motor": MOTOR,
               "drive": {"supply_V": 6.0, "supply_resistance_ohm": 0.05}}
    given = {"voltage_V[1]": 9.0, "voltage_V[2]": 5.0, "steering_angle_rad[front]": 0.3, "axle_torque_Nm[1]": 0.2,
             "steering_angle_rad[motor]": -0.2, "body_force_N[2]": 30.0}
    inputs = [{"signal": name, "kind": "steps", "t_s": [0.0, 0.05], "value": [value, -value]}
              for name, value in given.items()]
    return short({"vehicle": vehicle, "ground": {"friction_coefficient": 0.7, "slope_rad": 0.05}, "input": inputs,
                  "initial": {"velocity_body_m_per_s": [0.4, 0.1], "wheel_speed_rad_per_s": [1.0, 0.0, 4.0, 4.0, 0.0]}})


def short(tables: dict[str, Any]) -> Scene:
    """The first steps of a scene, without what lies beyond their end."""
    step_s, inputs = tables.get("run", {}).get("step_s", 0.002), list[dict[str, Any]]()
    for each in tables["input"]:
        count = sum(t <= STEPS * step_s for t in each.get("t_s", [0.0]))
        kept = count + (each["kind"] == "table")
        cut = {key: value[:kept] if key in ("t_s", "value") else value for key, value in each.items()}
        inputs += [cut] if count else []
    tables = tables | {"input": inputs, "run": {"duration_s": STEPS * step_s, "step_s": step_s},
                       "outputs": {"every_s": step_s}}
    scene = build_scene(tables)
    every = [signal for signals in output_signals_of(scene.vehicle, scene.hinges).values() for signal in signals]
    return build_scene(tables | {"outputs": {"every_s": step_s, "signals": every}})


def made(scene: Scene, variant: str, folder: Path) -> Path:
    version, scalar = VARIANTS[variant]
    return make_fmu(scene, folder / "scene.fmu", version=version, scalar=scalar)


def set_row(importer: Importer, scene: Scene, vehicle: Any, row: np.ndarray) -> None:
    """The inputs of one step, as a run of the scene holds them."""
    names = [hinge.name for hinge in scene.hinges]
    for name in OF_WHEELS + PLAIN + OF_HINGES:
        items: Sequence[Any] = names if name in OF_HINGES else range(1, importer.size(name) + 1)
        signals = [name] if name in PLAIN else [f"{name}[{item}]" for item in items]
        assert importer.set(name, *(float(row[vehicle.slot(signal)]) for signal in signals)) == OK


def variable_of(name: str) -> str:
    return "hinge_rad" if name == "hinge_angle_rad" else name


@pytest.mark.parametrize(("name", "variant"), [("rich", "fmi2"), ("rich", "fmi3"), ("frc_swerve_mk4i", "fmi3-scalar"),
                                               ("tugger_train", "fmi3")])
def test_a_run_in_an_importer_has_the_bits_of_simulate(name: str, variant: str, tmp_path: Path) -> None:
    same_bits(name, variant, tmp_path)


@pytest.mark.nightly
@EVERY_VARIANT
@pytest.mark.parametrize("name", ["rich", "f1tenth", "frc_swerve_mk4i", "tricycle_agv", "mir_like", "pr2_base",
                                  "tugger_train", "wheel_loader", "wheelchair"])
def test_runs_of_the_other_robots_have_the_bits_of_simulate(name: str, variant: str, tmp_path: Path) -> None:
    same_bits(name, variant, tmp_path)


def same_bits(name: str, variant: str, folder: Path) -> None:
    scene = rich() if name == "rich" else on_friction(name)
    h, ran = scene.run.step_s, simulate(scene)
    vehicle = scene.slipping_vehicle(load("double"))
    commands = SlippingCommands(scene, vehicle, scene.inputs_on_grid())
    commands.start_angles()
    rows = commands.held_rows(0, STEPS)
    outputs = output_signals_of(scene.vehicle, scene.hinges)
    with Importer(made(scene, variant, folder)) as importer:
        importer.initialize()
        for k in range(STEPS + 1):
            for signal, items in outputs.items():
                expected = [float(ran.columns[item][k]) for item in items]
                found = importer.get(variable_of(signal))[: len(items)]
                assert found == (pytest.approx(expected, rel=1e-12, abs=1e-12) if signal in ROUNDED else expected), \
                    (signal, k)
            if k < STEPS:
                set_row(importer, scene, vehicle, rows[k])
                assert importer.step(k * h, h) == OK, importer.log
        assert max(map(abs, importer.get("wheel_angle_rad"))) > 1e-3


def test_the_carriage_with_everything_slips_stops_and_reaches_its_limits() -> None:
    """So that the bits above are those of all that its FMU has."""
    ran = simulate(rich()).columns
    assert {state for i in range(1, 6) for state in ran[f"contact_state[{i}]"]} >= {0.0, 1.0}
    for name in ("drive_limit[1]", "hinge_stop_Nm[rear]", "hinge_friction_Nm[front]", "scrub_torque_Nm[3]",
                 "hinge_current_A[motor]", "motor_current_A[1]", "supply_loss_J", "stop_loss_J", "servo_work_J"):
        assert np.abs(ran[name]).max() > 0.0, name


@ONE_IN_ORDINARY_RUNS
def test_fmpy_validates_it_without_a_message_and_it_offers_co_simulation_alone(variant: str, tmp_path: Path) -> None:
    fmu = made(rich(), variant, tmp_path)
    assert validate_fmu(str(fmu)) == []
    description = fmpy.read_model_description(str(fmu))
    assert description.modelExchange is None and description.coSimulation.modelIdentifier == "LaconicSlipping"
    names = {variable.name.partition("[")[0] for variable in description.modelVariables}
    assert {"contact_state", "slip_across_m_per_s", "wheel_load_N", "servo_gain_Nm_per_rad", "slip_loss_J"} <= names
    assert names.isdisjoint({"steering_twist", "no_slip_margin_N", "carriage_zeta"})


@ONE_IN_ORDINARY_RUNS
def test_the_manipulation_toolbox_has_no_finding_and_terminals_name_variables(variant: str, tmp_path: Path) -> None:
    fmu = made(rich(), variant, tmp_path)
    done = subprocess.run([str(Path(sys.executable).parent / "fmutool"), "-input", str(fmu), "-check"],
                          capture_output=True, text=True, check=True)
    lines = (done.stdout + done.stderr).splitlines()
    assert any("compliant with FMI" in line for line in lines), lines
    assert not [line for line in lines if line.startswith(("WARNING", "ERROR", "CRITICAL"))]
    with zipfile.ZipFile(fmu) as archive:
        if "model.png" in archive.namelist():
            return
        terminals = ET.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    variables = {v.name for v in fmpy.read_model_description(str(fmu)).modelVariables}
    members = {member.get("variableName") for member in terminals.iter("TerminalMemberVariable")}
    assert members and members <= variables


@BOTH
def test_the_fmu_of_ideal_ground_has_nothing_of_it(version: int) -> None:
    with zipfile.ZipFile(built(f"fmu/LaconicArticulated_fmi{version}.fmu")) as archive:
        assert [name for name in archive.namelist() if "tree_" in name or "slipping" in name] == []
        library = next(name for name in archive.namelist() if name.endswith("linux/LaconicArticulated.so") or
                       name.endswith("linux64/LaconicArticulated.so"))
        for part in (library, "modelDescription.xml"):
            for word in (b"slip_along_m_per_s", b"scrub_loss_J", b"LoopGain"):
                assert word not in archive.read(part), (part, word)


@BOTH
def test_fmpy_runs_it_as_the_scene_runs(version: int) -> None:
    given = {"voltage_V[1]": 6.0, "voltage_V[2]": -6.0} if version == 2 else {"voltage_V": [6.0, -6.0, 0.0, 0.0]}
    found = fmpy.simulate_fmu(str(generic(version)), stop_time=1.0, output_interval=0.01, step_size=0.01,
                              start_values={"ground_friction_coefficient": 0.2, **given})
    assert abs(found["yaw_rate_rad_per_s"][-1]) > 0.5 and found["slip_loss_J"][-1] > 0.0
    came = sum(found[name] for name in ("supply_energy_J", "outer_work_J", "servo_work_J"))
    gone = sum(found[name] for name in found.dtype.names if name.endswith("_loss_J"))
    assert np.ptp(found["energy_J"] + found["spring_energy_J"] - came + gone) < 1e-9 * came[-1]


def everything(importer: Importer) -> list[float]:
    names = {name.partition("[")[0] for name, each in importer.variables.items() if each.causality == "output"}
    return [value for name in sorted(names) for value in importer.get(name)]


def drive(importer: Importer, first: int, last: int) -> None:
    for k in range(first, last):
        assert importer.set("voltage_V", *(6.0 - 2.0 * i + k % 5 for i in range(importer.size("voltage_V")))) == OK
        assert importer.set("steering_angle_rad", 0.0, 0.2 + 0.01 * (k % 7), 0.1) == OK
        assert importer.step(k * 0.002, 0.002) == OK, importer.log


@ONE_IN_ORDINARY_RUNS
def test_a_saved_state_and_its_bytes_continue_with_the_same_bits(variant: str, tmp_path: Path) -> None:
    fmu = made(rich(), variant, tmp_path)
    with Importer(fmu) as one, Importer(fmu) as other:
        one.initialize()
        drive(one, 0, 33)  # between two looks of the loop
        state, data = save(one), serialize(one)
        drive(one, 33, 60)
        expected = everything(one)
        one.must(f"Set{SUFFIX[one.version]}", state[0])
        drive(one, 33, 60)
        assert everything(one) == expected
        one.must(f"Free{SUFFIX[one.version]}", state)
        assert deserialize(other, data) == OK
        drive(other, 33, 60)
        assert everything(other) == expected
        assert deserialize(other, data[:-9] + bytes(9)) == ERROR


@BOTH
def test_a_payload_and_another_ground_during_the_run_keep_the_bodys_motion(version: int) -> None:
    names = ("origin_x_m", "origin_y_m", "heading_rad", "yaw_rate_rad_per_s", "hinge_rad", "wheel_angle_rad",
             "wheel_speed_rad_per_s")
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.set("voltage_V", 6.0, 3.0, 0.0, 0.0) == OK
        for k in range(20):
            assert importer.step(k * 0.01, 0.01) == OK
        before = [value for name in names for value in importer.get(name)]
        across = importer.get("slip_across_m_per_s")
        for name, value in (("payload_mass_kg", 10.0), ("payload_x_m", 0.2), ("payload_y_m", 0.1),
                            ("ground_friction_coefficient", 0.01)):
            assert importer.set(name, value) == OK
        assert [value for name in names for value in importer.get(name)] == pytest.approx(before, rel=1e-12, abs=1e-13)
        assert importer.get("slip_across_m_per_s") == pytest.approx(across, rel=1e-9, abs=1e-12)
        for k in range(20, 60):
            assert importer.step(k * 0.01, 0.01) == OK
        assert importer.get("contact_state")[0] == 1.0
        assert sum(importer.get("wheel_load_N")) == pytest.approx(9.80665 * (30.0 + 1.2 + 10.0), rel=1e-6)


def test_a_slope_of_an_input_acts_by_its_value_in_the_middle_of_each_step() -> None:
    with Importer(generic(2)) as sloped, Importer(generic(2)) as held:
        for each in (sloped, held):
            each.enter_initialization()
            assert each.set("step_s", 0.01) == OK
            each.must("ExitInitializationMode")
        sloped.must("SetRealInputDerivatives", sloped.references("voltage_V[1]"), 1, [1], [30.0])
        assert sloped.step(0.0, 0.1) == OK
        for k in range(10):
            assert held.set("voltage_V", (k + 0.5) * 0.01 * 30.0, 0.0, 0.0, 0.0) == OK
            assert held.step(k * 0.01, 0.01) == OK
        assert sloped.get("x_m") == pytest.approx(held.get("x_m"), rel=1e-12)
        assert sloped.get("voltage_V")[0] == pytest.approx(3.0)


@BOTH
@pytest.mark.parametrize(("name", "values", "line"), [
    ("ground_friction_coefficient", (0.0,), "ground_friction_coefficient: "),
    ("body_hinge", (1, 4), "body_hinge[2]: "),
    ("servo_gain_Nm_per_rad", (5.0, -1.0), "servo_gain_Nm_per_rad[2]: "),
    ("given_load_N", (50.0, 50.0, 0.0, 50.0), "given_load_N[3]: "),
    ("current_limit_A", (5.0,), "winding_resistance_ohm: "),
    ("start_hinge_rad", (0.0, 0.4), "start_hinge_rad[2]: ")])
def test_a_vehicle_that_cannot_start_is_refused_by_one_line(version: int, name: str, values: tuple[float, ...],
                                                            line: str) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("hinge_stop_high_rad", 0.0, 0.3) == OK
        status = importer.set(name, *values)
        if status == OK:
            importer.enter_initialization()
            assert importer.call("ExitInitializationMode") == ERROR
        assert line.rstrip(": ") in importer.log[-1][2]
        assert "\n" not in importer.log[-1][2] and len(importer.log) == 1


@BOTH
def test_a_step_that_the_control_period_does_not_fit_is_discarded_and_nothing_moves(version: int,
                                                                                    tmp_path: Path) -> None:
    with Importer(made(rich(), f"fmi{version}", tmp_path), logging=True) as importer:
        importer.enter_initialization()
        assert importer.set("step_s", 0.003) == OK
        importer.must("ExitInitializationMode")
        before = everything(importer)
        assert importer.step(0.0, 0.003) == DISCARD
        assert "control_period_s[" in importer.log[-1][2]
        assert everything(importer) == before


@BOTH
def test_model_exchange_and_derivatives_are_refused_by_one_line_each(version: int) -> None:
    with Importer(generic(version), "ModelExchange") as importer:
        assert not importer.instance
        assert [line for _, _, line in importer.log] == ["this FMU offers no Model Exchange; use Co-Simulation"]
    with Importer(generic(version)) as importer:
        importer.initialize()
        values = importer.ffi.new("double[]", 4)
        count = (4, values, 1) if version == 3 else (values,)
        known = "voltage_V" if version == 3 else "voltage_V[1]"
        assert importer.call("GetDirectionalDerivative", importer.references("x_m"), 1, importer.references(known), 1,
                             values, *count) == ERROR


@BOTH
def test_an_input_that_has_no_effect_is_logged_once(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        for value in (0.5, 0.6):
            assert importer.set("steering_angle_rad", 0.0, value) == OK
        assert importer.set("steering_rate_rad_per_s", 0.1, 0.0) == OK
        assert importer.set("voltage_V", 3.0, 3.0, 3.0, 0.0) == OK
        lines = [line.partition(" has no effect")[0] for _, _, line in importer.log]
        assert lines == ["steering_angle_rad[2]: 0.5 rad", "steering_rate_rad_per_s[1]: 0.1 rad/s", "voltage_V[3]: 3 V"]


def test_the_command_writes_it_and_states_what_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, out = tmp_path / "swerve.toml", tmp_path / "swerve.fmu"
    text = scene_tables("frc_swerve_mk4i").path.read_text(encoding="utf-8")
    scene.write_text(text.replace("\nfriction_coefficient", "\n# friction_coefficient") +
                     "\n[ground]\nfriction_coefficient = 0.9\n", encoding="utf-8")
    assert run(["fmu", str(scene), "--fmi", "3", "-o", str(out)]) == 0
    printed = capsys.readouterr().err
    assert "in place of steering_twist[1], steering_twist[2], steering_twist[3] give " in printed
    assert "steering_rate_rad_per_s of prescribed hinges" in printed
    assert fmpy.read_model_description(str(out)).coSimulation.modelIdentifier == "LaconicSlipping"


@pytest.mark.nightly
@pytest.mark.parametrize(("package", "run_in"), [("ecospy", in_ecos), ("libcosimpy", in_libcosim)])
def test_it_runs_in_other_importers(package: str, run_in: Any, tmp_path: Path) -> None:
    pytest.importorskip(package)
    fmu = make_fmu(rich(), tmp_path / "scene.fmu", version=2, enumerations=False)
    given = {"voltage_V[1]": 6.0, "voltage_V[2]": 2.0, "steering_angle_rad[2]": 0.3}
    names = ["x_m", "y_m", "heading_rad", "hinge_rad[2]", "slip_loss_J", "wheel_load_N[1]"]
    with Importer(fmu) as importer:
        importer.enter_initialization()
        importer.must("SetReal", importer.references(*given), len(given), list(given.values()))
        importer.must("ExitInitializationMode")
        for k in range(50):
            assert importer.step(k * 0.01, 0.01) == OK
        expected = [importer.get(name)[0] for name in names]
    assert run_in(fmu, given, names, 50, 0.01) == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_only_limits_that_the_fmu_lacks_are_stated() -> None:
    assert left_out(on_friction("tricycle_agv")) == ""  # its motor's stops are parameters
    prescribed = left_out(on_friction("tugger_train"))
    assert "does not limit angle and rate of front" in prescribed
    assert left_out(rich()) == ""


@pytest.mark.parametrize("option", ["derivatives", "estimate"])
def test_what_such_an_fmu_lacks_is_refused_by_one_line(option: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=rf"^--{option}: the FMU of a vehicle with hinges \(.*\) has no such variant"):
        make_fmu(rich(), tmp_path / "x.fmu", version=2, **{option: True})
