"""What the ground cannot provide is logged once in a run; where no warning can be logged, nothing is computed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from fmu_importer import DISCARD, OK, WARNING, Importer, generic

from laconic.core import load
from laconic.fmu import make_fmu
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.demo.fmu_rows import fmu_rows

BOTH = pytest.mark.parametrize("version", [2, 3])
KICK_V = (60.0, 80.0, 70.0, 60.0)


def warnings(importer: Importer) -> list[str]:
    """The warnings in the log."""
    assert {status for status, category, _ in importer.log if category == "logStatusWarning"} <= {WARNING}
    return [text for _, category, text in importer.log if category == "logStatusWarning"]


def drive(importer: Importer, steps: int, size: int = 1, first: int = 0) -> None:
    """Communication steps of so many internal steps of 10 ms."""
    for k in range(first, first + steps, size):
        assert importer.step(k * 0.01, size * 0.01) == OK


@BOTH
@pytest.mark.parametrize("size", [1, 10])
def test_a_run_that_needs_more_grip_reports_when_which_wheel_and_how_much_once(version: int, size: int) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("step_s", 0.01) == OK
        assert importer.set("com_z_m", 0.0) == OK  # no wheel lifts
        importer.initialize()
        drive(importer, 20, size)
        assert warnings(importer) == []
        assert importer.set("voltage_V", *KICK_V) == OK
        margin = importer.get("no_slip_margin_N")[0]
        forces = importer.get("wheel_reaction_N")
        assert margin < -100.0
        drive(importer, 20, size, 20)
        assert len(warnings(importer)) == 1
        assert warnings(importer)[0].startswith(f"at 0.2 s wheel {1 + forces.index(max(forces, key=abs))} needs ")
        assert f"(friction_coefficient = 0.6): {-margin:.4g} N are missing" in warnings(importer)[0]


def test_the_first_instant_is_an_internal_step_within_the_communication_step() -> None:
    with Importer(generic(3)) as fine, Importer(generic(3)) as coarse:
        for importer, size in ((fine, 1), (coarse, 100)):
            assert importer.set("step_s", 0.01) == OK
            assert importer.set("body_moment_Nm", 60.0) == OK  # turns ever faster, until no wheel holds
            importer.initialize()
            drive(importer, 500, size)
        assert len(warnings(fine)) == 1
        assert warnings(fine) == warnings(coarse)
        assert not warnings(fine)[0].startswith("at 0 s")


@BOTH
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_wheel_that_lifts_is_named_with_the_force_that_is_missing(version: int, kind: str) -> None:
    with Importer(generic(version), kind) as importer:
        assert importer.set("com_z_m", 1.5) == OK
        assert importer.set("friction_coefficient", 50.0) == OK
        assert importer.set("voltage_V", *(25.0,) * 4) == OK
        importer.initialize()
        judge(importer, kind)
        judge(importer, kind)
        slips, lifts = warnings(importer)  # a wheel that carries nothing has no grip either
        assert lifts.startswith(("at 0 s wheel 1 lifts: ", "at 0 s wheel 2 lifts: "))  # the front, when it speeds up
        assert "its normal load would be -" in lifts
        assert "N of grip and has 0 N" in slips


def judge(importer: Importer, kind: str) -> None:
    """A step is taken where the importer is."""
    if kind == "CoSimulation":
        assert importer.step(importer.time(), 1e-4) == OK
        return
    if not importer.log:
        importer.must("EnterContinuousTimeMode")
    flags = importer.ffi.new("int[2]" if importer.version == 2 else "bool[2]")
    importer.must("CompletedIntegratorStep", True, flags, flags + 1)


@BOTH
def test_no_warning_comes_without_a_friction_coefficient_or_when_warnings_are_off(version: int) -> None:
    for given, off in ((0.0, False), (0.6, True)):
        with Importer(generic(version)) as importer:
            assert importer.set("friction_coefficient", given) == OK
            assert importer.set("voltage_V", *KICK_V) == OK
            if off:
                importer.must("SetDebugLogging", 0, 0, importer.ffi.NULL)
            importer.initialize()
            drive(importer, 3)
            assert importer.get("no_slip_margin_N")[0] < 0.0
            assert warnings(importer) == []


@BOTH
def test_the_warning_comes_again_after_a_reset_and_not_after_a_rollback(version: int) -> None:
    with Importer(generic(version)) as importer:
        suffix = "FMUstate" if version == 2 else "FMUState"
        state = importer.ffi.new("void **")
        for _ in range(2):
            assert importer.set("voltage_V", *KICK_V) == OK
            importer.initialize()
            importer.must(f"Get{suffix}", state)
            drive(importer, 3)
            importer.must(f"Set{suffix}", state[0])
            drive(importer, 3)
            importer.must("Reset")
        importer.must(f"Free{suffix}", state)
        assert len(warnings(importer)) == 4  # slip and lift, twice
        assert warnings(importer)[:2] == warnings(importer)[2:]


def test_judging_changes_no_bit(tmp_path: Path) -> None:
    scene = read_scene("kuka_youbot").with_run(real="double")
    core = load("double")
    with Importer(make_fmu(scene, tmp_path / "x.fmu", version=3)) as importer:
        assert importer.set("friction_coefficient", 1e-3) == OK
        assert importer.set("voltage_V", 9.0, -2.0, 4.0, 8.0) == OK
        importer.initialize()
        drive_s = scene.run.step_s
        assert importer.step(0.0, 50 * drive_s) == OK
        plant = scene.plant(core)
        plant.run(core.input({f"voltage_V[{i + 1}]": value for i, value in enumerate((9.0, -2.0, 4.0, 8.0))}), 50)
        assert importer.get("nu_rad_per_s") == list(plant.nu)
        assert warnings(importer)


def test_slopes_within_a_step_are_judged_too() -> None:
    with Importer(generic(2)) as importer:
        assert importer.set("step_s", 0.01) == OK
        assert importer.set("com_z_m", 0.0) == OK
        importer.initialize()
        names = importer.elements("voltage_V")[0]
        orders, slopes = importer.ffi.new("int[]", [1] * 4), importer.ffi.new("double[]", [100.0] * 4)
        importer.must("SetRealInputDerivatives", importer.references(*names), 4, orders, slopes)
        assert importer.step(0.0, 1.0) == OK
        (line,) = warnings(importer)
        assert "of grip" in line
        assert 0.0 < float(line.split()[1]) < 1.0


def test_the_fmu_reports_what_simulate_reports(tmp_path: Path) -> None:
    scene = read_scene("robotino2").with_run(method=EXPLICIT, step_s=0.01)
    plant, core = scene.plant(load("double")), load("double")
    voltage = (6.0, -4.0, 3.0)
    reactions = plant.reactions(core.input({f"voltage_V[{i + 1}]": value for i, value in enumerate(voltage)}))
    with Importer(make_fmu(scene, tmp_path / "x.fmu", version=2)) as importer:
        assert importer.set("voltage_V", *voltage) == OK
        importer.initialize()
        assert importer.step(0.0, 0.01) == OK
        (line,) = warnings(importer)
    assert f"{-reactions.no_slip_margin_N:.4g} N are missing" in line


@BOTH
def test_the_demos_own_importer_prints_nothing_where_a_robot_slips(version: int, tmp_path: Path, capfd) -> None:
    scene = read_scene("robotino2")
    slippery = replace(scene, vehicle={**scene.vehicle, "friction_coefficient": 1e-3})
    rows = fmu_rows(slippery, make_fmu(slippery, tmp_path / "x.fmu", version=version), 50)
    assert len(rows.rows) == 50
    assert capfd.readouterr().out == ""


@BOTH
@pytest.mark.parametrize("size", [1, 10])
def test_a_step_that_is_refused_reports_nothing_of_grip_and_the_one_that_is_taken_does(version: int, size: int) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("step_s", 0.01) == OK
        importer.initialize()
        drive(importer, 20, size)
        assert importer.set("voltage_V", *(1e100,) * 4) == OK
        assert importer.step(0.2, 0.01 * size) == DISCARD
        assert warnings(importer) == []
        assert importer.set("voltage_V", *KICK_V) == OK
        drive(importer, 10, size, 20)
        assert [text.split(" wheel")[0] for text in warnings(importer)][0] == "at 0.2 s"
        drive(importer, 10, size, 30)
        assert len(warnings(importer)) in (1, 2)
        assert any("of grip" in text for text in warnings(importer))


@BOTH
def test_a_vehicle_that_tips_over_at_rest_lifts_and_does_not_slip(version: int) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("com_x_m", 2.0) == OK
        importer.initialize()
        assert importer.step(0.0, 0.01) == OK
        (line,) = warnings(importer)
        assert "lifts: its normal load would be -" in line


@BOTH
def test_forces_beyond_all_numbers_are_reported_in_words(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        assert importer.set("voltage_V", *(1e160,) * 4) == OK
        assert importer.step(0.0, 1e-120) == OK
        assert warnings(importer) == ["at 0 s the forces on the ground leave the range of double precision; check the "
                                      "inputs (logged once)"]
        assert importer.step(1e-120, 1e-120) == OK
        assert len(warnings(importer)) == 1
