"""`laconic simulate` warns once where the ground cannot give the reactions that the no-slip model needs."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.core.grip import Grip, GripEvent
from laconic.fmu import make_fmu
from laconic.scene import build_scene, read_scene, rigid_scene_names
from laconic.scene.scene_tables import scene_tables
from laconic.simulation import simulate
from laconic.tools.demo.fmu_rows import fmu_rows

BODY = "mass_kg = 130.0\nyaw_inertia_kgm2 = 12.0\nwheel_radius_m = 0.0759\nwheel_inertia_kgm2 = 0.02\n"
MOTOR = "motor_gain_Nm_per_V = 2.0\nmotor_damping_Nms = 3.0\n"
CORNERS = ((0.319, 0.275, 45), (0.319, -0.275, -45), (-0.319, 0.275, -45), (-0.319, -0.275, 45))


def mecanum(tmp_path: Path, ground: str = "friction_coefficient = 0.6\ncom_z_m = 0.3", volts: float = 60.0,
            kind: str = "steps") -> str:
    """Four mecanum wheels that get a gentle voltage at first and `volts` from 0.5 s on."""
    wheels = "".join(f'[[vehicle.wheel]]\nkind = "mecanum"\nx_m = {x}\ny_m = {y}\naxle_deg = -90\n'
                     f'roller_deg = {roller}\n' for x, y, roller in CORNERS)
    t_s = "[0.0, 0.5]" if kind == "steps" else "[0.4999, 0.5]"
    inputs = "".join(f'[[input]]\nsignal = "voltage_V[{i}]"\nkind = "{kind}"\nt_s = {t_s}\nvalue = [1.0, {volts}]\n'
                     for i in (1, 2, 3, 4))
    path = tmp_path / "mecanum.toml"
    path.write_text(f"[vehicle]\n{BODY}{MOTOR}{ground}\n{wheels}{inputs}[run]\nduration_s = 1.0\nstep_s = 0.001\n"
                    "[outputs]\nevery_s = 0.25\n")
    return str(path)


def test_a_margin_that_counts_a_load_below_zero_says_so():
    event = GripEvent(0.5, 500, "wheel 2", 32.7, 0.0, -0.3, -32.9)
    told = Grip(0.6, 1000, 1, 0, event, event, None, None).warning()
    assert "needs 32.7 N of grip, has 0 N under a load of -0.3 N: margin -32.9 N" in told


def test_a_run_without_enough_grip_is_warned_of_once_with_instant_wheel_and_newtons(tmp_path, capsys):
    scene = mecanum(tmp_path, ground="friction_coefficient = 0.6")
    assert run(["simulate", scene]) == 0
    printed = capsys.readouterr().err
    assert len(printed.splitlines()) == 1
    assert "wheels 1, 2, 3 and 4 slip, and first wheel " in printed and " slips at 0.5 s (needs " in printed
    assert " N of grip, has 191 N" in printed and "lifts" not in printed
    assert printed.endswith("; ramp the inputs (kind = \"table\") or ask for less, or let wheels slip: give [ground] "
                            "friction_coefficient in place of vehicle.friction_coefficient\n")


def test_the_wheels_that_slip_are_listed_for_programs_and_the_remedy_works(tmp_path, capsys):
    scene = Path(mecanum(tmp_path, ground="friction_coefficient = 0.6"))
    assert run(["simulate", str(scene), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["no_slip"]["slipping_wheels"] == [1, 2, 3, 4]
    scene.write_text(scene.read_text().replace("friction_coefficient = 0.6", "").replace(
        "[run]", "[ground]\nfriction_coefficient = 0.6\n[run]"))
    assert run(["simulate", str(scene)]) == 0
    printed = capsys.readouterr()
    assert printed.err == "" and "energy lost by slip and dragging rollers: " in printed.out


def test_a_wheel_that_lifts_is_reported_with_its_normal_load(tmp_path, capsys):
    assert run(["simulate", mecanum(tmp_path, ground="com_z_m = 0.6"), "--json"]) == 0
    printed = capsys.readouterr()
    assert len(printed.err.splitlines()) == 1 and "slips" not in printed.err
    assert "lifts at 0.5 s (normal load -" in printed.err
    found = json.loads(printed.out)["no_slip"]
    assert found["first_lift"]["normal_N"] < 0 and found["first_lift"]["where"] in ("wheel 1", "wheel 2")
    assert found["friction_coefficient"] is None and found["slipping"] == 0


def test_json_has_first_and_worst_instant_between_the_recorded_rows_too(tmp_path, capsys):
    assert run(["simulate", mecanum(tmp_path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["no_slip"]
    scene = read_scene(tmp_path / "mecanum.toml")
    plant, inputs = scene.plant(scene.core()), scene.inputs_on_grid()
    margins = []
    for tick in range(scene.steps()):
        held = plant.core.input(inputs.held_at(tick))
        margins.append(plant.reactions(held).no_slip_margin_N)
        plant.run(held)
    margins.append(plant.reactions(held).no_slip_margin_N)
    assert found["holds"] is False and found["instants"] == 1001
    assert found["slipping"] == sum(margin < 0.0 for margin in margins)
    assert found["first_slip"]["step"] == next(k for k, margin in enumerate(margins) if margin < 0.0)
    assert found["worst_slip"]["margin_N"] == min(margins)
    assert found["first_slip"]["time_s"] == 0.5
    assert found["first_slip"]["available_N"] == pytest.approx(max(0.0, 0.6 * found["first_slip"]["normal_N"]))


@pytest.mark.parametrize("kind", ["steps", "table"])
def test_a_gentle_run_prints_no_warning(tmp_path, capsys, kind):
    assert run(["simulate", mecanum(tmp_path, volts=2.0, kind=kind), "--json"]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    assert json.loads(printed.out)["no_slip"]["holds"] is True


def test_a_scene_without_data_of_the_ground_is_not_watched(tmp_path, capsys):
    assert run(["simulate", mecanum(tmp_path, ground=""), "--json"]) == 0
    printed = capsys.readouterr()
    assert printed.err == "" and json.loads(printed.out)["no_slip"] is None


def test_single_precision_watches_as_well(tmp_path):
    scene = read_scene(mecanum(tmp_path))
    double, single = (simulate(scene.with_run(real=real)).grip for real in ("double", "single"))
    assert single.first_slip.time_s == double.first_slip.time_s == 0.5
    assert single.worst_slip.margin_N == pytest.approx(double.worst_slip.margin_N, rel=1e-3)


@pytest.mark.parametrize("kind", ["steps", "table"])
def test_inputs_are_written_as_the_columns_they_are_called(tmp_path, kind):
    out = tmp_path / "run.csv"
    scene = mecanum(tmp_path, kind=kind)
    assert run(["simulate", scene, "--out", str(out), "--inputs"]) == 0
    with out.open() as file:
        header, *rows = list(csv.reader(file))
    assert header[-4:] == [f"voltage_V[{i}]" for i in (1, 2, 3, 4)]
    assert np.array(rows, float)[:, -1].tolist() == [1.0, 1.0, 60.0, 60.0, 60.0]


def test_inputs_need_a_file_to_be_written_to(tmp_path, capsys):
    assert run(["simulate", mecanum(tmp_path), "--inputs"]) == 2
    assert "--out" in capsys.readouterr().err


def test_a_slip_and_a_lift_of_one_instant_are_told_apart(tmp_path, capsys):
    assert run(["simulate", mecanum(tmp_path, ground="friction_coefficient = 0.2\ncom_z_m = 0.9", volts=80.0)]) == 0
    slip, _, lift = capsys.readouterr().err.partition(") and ")
    assert "slips at 0.5 s (needs " in slip and "normal load" not in slip
    assert "lifts at 0.5 s (normal load -" in lift


@pytest.mark.parametrize("version", [2, 3])
def test_what_an_fmu_reports_in_the_demo_is_kept_and_does_not_run_into_the_results(tmp_path, capfd, version):
    scene = read_scene(mecanum(tmp_path)).with_run(duration_s=0.6)
    fmu = make_fmu(scene, tmp_path / f"m{version}.fmu", version=version)
    rows = fmu_rows(scene, fmu, scene.steps(), every=100)
    assert any("grip" in line for line in rows.log)
    assert capfd.readouterr().out == ""


def test_a_run_whose_wheels_slip_is_not_said_to_hold_the_ground(tmp_path, capsys):
    assert run(["simulate", "skid_steer", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["no_slip"]
    assert found["holds"] is None and found["slipping"] is None
    assert found["friction_coefficient"] == 0.6
    assert found["slip_loss_J"] > 10.0


@pytest.mark.parametrize("volts, told", [(0.0, "no wheel slipped\n"), (60.0, "energy lost by slip and dragging ")])
def test_a_run_on_ground_with_friction_ends_with_what_slip_took(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], volts: float, told: str) -> None:
    scene = Path(mecanum(tmp_path, ground="com_z_m = 0.3", volts=volts))
    text = scene.read_text(encoding="utf-8").replace("value = [1.0,", "value = [0.0,")
    scene.write_text(text + "[ground]\nfriction_coefficient = 0.2\n", encoding="utf-8")
    assert run(["simulate", str(scene)]) == 0
    printed = capsys.readouterr().out
    assert told in printed and "first order" not in printed
    assert run(["simulate", str(scene), "--step", "0.01"]) == 0
    assert "compare path and losses with --step 0.001" in capsys.readouterr().out
    assert run(["simulate", mecanum(tmp_path)]) == 0
    assert "slip and dragging" not in capsys.readouterr().out


def test_wheels_that_roll_on_ground_with_friction_have_not_slipped(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wheels = "".join(f'[[vehicle.wheel]]\nkind = "fixed"\nx_m = 0.0\ny_m = {y}\naxle_deg = -90\n' for y in (0.2, -0.2))
    inputs = "".join(f'[[input]]\nsignal = "voltage_V[{i}]"\nkind = "steps"\nt_s = [0.0]\nvalue = [{i}.0]\n'
                     for i in (1, 2))
    scene = tmp_path / "rolling.toml"
    scene.write_text(f"[vehicle]\n{BODY}{MOTOR}com_x_m = -0.05\n{wheels}[[vehicle.support]]\nx_m = -0.2\ny_m = 0.0\n"
                     f"[ground]\nfriction_coefficient = 0.8\n{inputs}[run]\nduration_s = 1.0\nstep_s = 0.001\n")
    assert run(["simulate", str(scene), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["final"]["x_m"] > 0.01 and found["no_slip"]["slip_loss_J"] != 0.0  # rounding
    assert run(["simulate", str(scene)]) == 0
    assert "no wheel slipped\n" in capsys.readouterr().out


ON_PURPOSE = "example_two_wheel_sizes"


@pytest.mark.parametrize("name", [name for name in rigid_scene_names() if name != ON_PURPOSE])
def test_the_ground_gives_what_a_scene_of_the_project_needs(name: str) -> None:
    found = simulate(read_scene(name))
    assert found.grip is None or found.grip.warning() == ""


def test_one_scene_keeps_the_warning_on_purpose_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    scene = read_scene(ON_PURPOSE)
    assert "On purpose" in scene.path.read_text(encoding="utf-8")
    assert run(["simulate", ON_PURPOSE]) == 0
    told = "the ground cannot give what this run needs: wheels 1 and 2 slip, and first wheel 2 slips at 0 s"
    assert told in capsys.readouterr().err


def test_a_motor_of_gain_and_damping_has_a_supply_if_it_is_given_as_one_of_1_ohm() -> None:
    """As docs/scenes.md describes it."""
    tables = scene_tables("turtlebot3_burger").entries
    vehicle = {key: value for key, value in tables["vehicle"].items() if not key.startswith("motor_")}
    gain, damping = tables["vehicle"]["motor_gain_Nm_per_V"], tables["vehicle"]["motor_damping_Nms"]
    vehicle["motor"] = {"resistance_ohm": 1.0, "torque_constant_Nm_per_A": gain, "back_emf_Vs_per_rad": damping / gain,
                        "gear_ratio": 1.0}
    end, same = (simulate(build_scene(each)).columns["x_m"][-1] for each in (tables, tables | {"vehicle": vehicle}))
    assert same == pytest.approx(end, rel=1e-12)
    weak = simulate(build_scene(tables | {"vehicle": vehicle | {"drive": {"supply_V": 6.0}}}))
    assert weak.columns["x_m"][-1] != pytest.approx(end, rel=0.1)
