"""`laconic simulate`: what it writes is what the core computed, with all digits."""

from __future__ import annotations

import csv
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.cli.main import run
from laconic.core import load
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT, STIFF_8
from laconic.simulation import RunRefused, simulate, usual_signals

PNG = b"\x89PNG\r\n\x1a\n"


def rows_of(path: Path) -> tuple[list[str], np.ndarray]:
    """Header and numbers of a CSV file."""
    with path.open() as file:
        header, *rows = list(csv.reader(file))
    return header, np.array(rows, dtype=float)


def scene_file(tmp_path: Path, tail: str, run_table: str = "duration_s = 1.0\nstep_s = 0.01\n") -> Path:
    """A torque-driven puck without wheels and friction: v' = F/M is known on paper."""
    path = tmp_path / "puck.toml"
    vehicle = "[vehicle]\nmass_kg = 2.0\nyaw_inertia_kgm2 = 0.1\nwheel_radius_m = 0.5\n"
    path.write_text(f"{vehicle}{tail}\n[run]\n{run_table}")
    return path


def force(kind: str, rest: str) -> str:
    return f'[[input]]\nsignal = "body_force_N[1]"\nkind = "{kind}"\n{rest}\n'


def speed_after(path: Path) -> float:
    scene = read_scene(path)
    return float(simulate(scene).columns["velocity_body_m_per_s[1]"][-1])


def test_csv_holds_every_bit_of_the_cores_outputs(tmp_path, capsys):
    out = tmp_path / "run.csv"
    assert run(["simulate", "s1", "--out", str(out)]) == 0
    assert "wrote" in capsys.readouterr().out
    header, numbers = rows_of(out)
    scene = read_scene("s1")
    assert header == ["time_s", *usual_signals(scene)]
    plant, inputs = scene.plant(scene.core()), scene.inputs_on_grid()
    for row in range(0, len(numbers) - 1, 97):
        while plant.steps < 10 * row:
            plant.run(plant.core.input(plant.core.input_row(inputs.held_at(plant.steps))), 1)
        assert numbers[row, 1:4].tolist() == plant.nu.tolist()
        assert numbers[row, 4:6].tolist() == [plant.pose.x_m, plant.pose.y_m]
    assert numbers[:, 0].tolist() == [0.001 * tick for tick in range(0, 10_001, 10)]


def test_outputs_of_the_scene_are_written_in_its_order(tmp_path):
    text = read_scene("turtlebot3_burger").path.read_text()
    path, out = tmp_path / "scene.toml", tmp_path / "run.csv"
    signals = '["energy_J", "wheel_torque_Nm", "wheel_lateral_N[2]", "no_slip_margin_N", "origin_x_m"]'
    path.write_text(text.replace("[outputs]", f"[outputs]\nsignals = {signals}"))
    assert run(["simulate", str(path), "--out", str(out)]) == 0
    header, numbers = rows_of(out)
    assert header == ["time_s", "energy_J", "wheel_torque_Nm[1]", "wheel_torque_Nm[2]", "wheel_lateral_N[2]",
                      "no_slip_margin_N", "origin_x_m"]
    assert np.all(np.isfinite(numbers))
    assert numbers[0, 2] == pytest.approx(-0.5 * 0.125)  # at rest the motor gives c1 U


def test_csv_to_stdout_is_nothing_but_csv(capsys):
    assert run(["simulate", "s1", "--out", "-"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("time_s,nu_rad_per_s[1]")
    assert len(lines) == 1002


def test_json_reports_what_was_run_and_where_it_ended(capsys):
    assert run(["simulate", "turtlebot3_burger", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["method"], answer["chosen"], answer["steps"]) == ("auto", STIFF_8, 12_000)
    assert answer["final"]["time_s"] == 12.0
    assert math.hypot(answer["final"]["x_m"], answer["final"]["y_m"]) == pytest.approx(1.27, abs=0.01)


@pytest.mark.parametrize("name", ["s1", "turtlebot3_burger"])
def test_people_are_shown_which_method_auto_picked(name, capsys):
    assert run(["simulate", name]) == 0
    assert f"auto (picked {STIFF_8})" in capsys.readouterr().out


def test_method_step_and_scalar_type_can_be_given(capsys):
    assert run(["simulate", "s1", "--method", EXPLICIT, "--step", "0.01", "--real", "single", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["chosen"], answer["steps"], answer["real"]) == (EXPLICIT, 1000, "single")
    nu = answer["final"]["nu_rad_per_s[1]"]
    assert nu == float(np.float32(nu))


def test_plot_is_a_picture(tmp_path):
    picture = tmp_path / "new" / "run.png"
    assert run(["simulate", "robotino2", "--plot", str(picture)]) == 0
    assert picture.read_bytes().startswith(PNG)


@pytest.mark.filterwarnings("error")
def test_plot_of_a_vehicle_that_stands_still(tmp_path):
    picture = tmp_path / "run.png"
    assert run(["simulate", str(scene_file(tmp_path, "")), "--plot", str(picture)]) == 0
    assert picture.read_bytes().startswith(PNG)


def test_plot_of_a_format_that_there_is_not(tmp_path, capsys):
    assert run(["simulate", "s1", "--plot", str(tmp_path / "run.xyz")]) == 2
    assert "run.xyz" in capsys.readouterr().err


def test_plot_of_a_vehicle_without_wheels(tmp_path):
    picture = tmp_path / "run.png"
    assert run(["simulate", str(scene_file(tmp_path, force("steps", "t_s=[0.0]\nvalue=[1.0]"))), "--plot",
                str(picture)]) == 0
    assert picture.read_bytes().startswith(PNG)


def test_steps_are_zero_before_their_first_instant_and_hold_after_it(tmp_path):
    assert speed_after(scene_file(tmp_path, force("steps", "t_s=[0.3, 0.5]\nvalue=[4.0, 1.0]"))) == pytest.approx(
        (0.2 * 4.0 + 0.5 * 1.0) / 2.0, abs=1e-14)


def test_a_table_is_linear_between_instants_and_constant_outside(tmp_path):
    path = scene_file(tmp_path, force("table", "t_s=[0.2, 0.6]\nvalue=[1.0, 5.0]"))
    assert speed_after(path) == pytest.approx((0.2 * 1.0 + 0.4 * 3.0 + 0.4 * 5.0) / 2.0, abs=1e-13)


def test_a_sine_is_amplitude_times_sine(tmp_path):
    path = scene_file(tmp_path, force("sine", "amplitude=3.0\nfrequency_Hz=0.5\nphase_deg=30"))
    assert speed_after(path) == pytest.approx(3.0 / math.pi * math.cos(math.pi / 6), abs=2e-9)


def test_inputs_of_one_signal_add_up(tmp_path):
    both = force("steps", "t_s=[0.3]\nvalue=[4.0]") + force("table", "t_s=[0.0, 1.0]\nvalue=[0.0, 2.0]")
    assert speed_after(scene_file(tmp_path, both)) == pytest.approx((0.7 * 4.0 + 1.0) / 2.0, abs=1e-13)


def test_a_change_within_a_step_of_a_sampled_scene_is_refused_too(tmp_path, capsys):
    both = force("steps", "t_s=[0.305]\nvalue=[4.0]") + force("table", "t_s=[0.0, 1.0]\nvalue=[0.0, 2.0]")
    assert run(["simulate", str(scene_file(tmp_path, both))]) == 2
    assert "0.305 s falls inside a step of 0.01 s; a step of 0.005 s would do" in capsys.readouterr().err


def test_the_run_ends_at_its_end_even_between_two_outputs(tmp_path):
    path = scene_file(tmp_path, force("steps", "t_s=[0.0]\nvalue=[1.0]") + "[outputs]\nevery_s = 0.3")
    assert simulate(read_scene(path)).time_s.tolist() == pytest.approx([0.0, 0.3, 0.6, 0.9, 1.0])


def spun_up(tmp_path: Path, outputs: str = "") -> Path:
    """A moment spins the puck up until an explicit method refuses its step."""
    spinning = force("steps", "t_s=[0.0]\nvalue=[20.0]").replace("body_force_N[1]", "body_moment_Nm")
    return scene_file(tmp_path, spinning + outputs, f'duration_s = 10.0\nstep_s = 0.1\nmethod = "{EXPLICIT}"\n')


def test_a_step_that_is_refused_on_the_way_reports_when(tmp_path, capsys):
    path = spun_up(tmp_path)
    assert run(["simulate", str(path)]) == 1
    line = capsys.readouterr().err
    assert "at t = " in line
    assert str(path) in line
    assert line.count("\n") == 1
    assert run(["simulate", str(path), "--method", "auto"]) == 0


@pytest.mark.parametrize("every", [1, 2, 4])
def test_what_was_simulated_before_a_refused_step_is_written(every, tmp_path, capsys):
    path, out, picture = spun_up(tmp_path, f"[outputs]\nevery_s = 0.{every}"), tmp_path / "a.csv", tmp_path / "a.png"
    assert run(["simulate", str(path), "--out", str(out), "--plot", str(picture), "--json"]) == 1
    printed = capsys.readouterr()
    answer = json.loads(printed.out)
    steps = answer["refused"]["step"]
    assert 0 < steps == answer["steps"] < 100
    assert answer["refused"]["time_s"] == answer["final"]["time_s"] == pytest.approx(0.1 * steps)
    assert answer["refused"]["message"] in printed.err and str(out) in printed.err
    header, numbers = rows_of(out)
    as_far = simulate(read_scene(path).with_run(duration_s=0.1 * steps))
    assert header[1:] == list(as_far.columns)
    assert numbers[:, 0].tolist() == as_far.time_s.tolist()
    assert numbers[:, 1:].tolist() == np.column_stack(list(as_far.columns.values())).tolist()
    assert picture.read_bytes().startswith(PNG)


def test_a_program_gets_the_motion_up_to_a_refused_step(tmp_path):
    with pytest.raises(RunRefused) as refused:
        simulate(read_scene(spun_up(tmp_path)))
    assert refused.value.status == "step beyond gyroscopic limit"
    assert len(refused.value.run.time_s) == refused.value.run.steps + 1


def test_a_run_whose_first_step_is_refused_has_no_result(tmp_path, capsys):
    out = tmp_path / "run.csv"
    path = scene_file(tmp_path, "[initial]\nyaw_rate_rad_per_s = 1e3", "duration_s = 1.0\nstep_s = 0.1\n")
    assert run(["simulate", str(path), "--method", EXPLICIT, "--out", str(out)]) == 2
    assert "at t = 0 s: " in capsys.readouterr().err
    assert not out.exists()


def test_velocity_and_yaw_rate_start_the_motion_they_name():
    scene = read_scene("paper_caster")
    first = {name: values[0] for name, values in simulate(scene.with_run(duration_s=0.1)).columns.items()}
    assert first["velocity_body_m_per_s[1]"] == pytest.approx(0.1, rel=1e-15)
    assert first["yaw_rate_rad_per_s"] == pytest.approx(0.05, rel=1e-15)
    assert first["heading_rad"] == pytest.approx(0.1, rel=1e-15)


def test_free_motion_keeps_its_energy():
    energy = simulate(read_scene("paper_three_wheel_free")).columns["energy_J"]
    assert np.ptp(energy) < 1e-13 * energy[0]


def test_held_and_sampled_steps_of_a_constant_input_agree():
    scene = read_scene("s1").with_run(method=EXPLICIT)
    held, sampled = scene.plant(scene.core()), scene.plant(scene.core())
    row = held.core.input_row({"voltage_V": [2.0, -2.0, 1.0]}, 3)
    held.run(held.core.input(row), 500)
    sampled.run_sampled(np.broadcast_to(row, (500, 3, len(row))))
    assert sampled.steps == 500
    np.testing.assert_allclose(sampled.row(), held.row(), rtol=1e-13, atol=1e-15)


def test_a_saved_state_can_be_returned_to():
    scene = read_scene("s1")
    plant = scene.plant(load("double"))
    held = plant.core.input({"voltage_V[2]": 3.0})
    plant.run(held, 10)
    state, steps, before = plant.save(), plant.steps, plant.row()
    plant.run(held, 10)
    assert not np.array_equal(plant.row(), before)
    plant.restore(state, steps)
    assert plant.steps == 10
    assert plant.row().tobytes() == before.tobytes()


def test_the_scene_in_the_documentation_runs(tmp_path, capsys):
    text = (SOURCE_DIR / "docs" / "scenes.md").read_text()
    path = tmp_path / "documented.toml"
    path.write_text(re.search(r"```toml\n(.*?)```", text, re.DOTALL)[1])
    assert run(["simulate", str(path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["steps"] == 100
    assert {"wheel_torque_Nm[2]", "no_slip_margin_N"} <= set(answer["final"])
