"""The last row of a run shows the inputs of its own instant; what inputs cannot do on the grid of steps is refused."""

from __future__ import annotations

import csv
import json
import math
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from laconic import RunRefused, build_scene, read_scene, simulate
from laconic.cli.main import run
from laconic.core.grip import newtons
from laconic.scene.table import read_toml
from laconic.simulation.csv_text import ROWS_AT_ONCE, csv_text
from scene_text import wheel

ROBOT = """
[vehicle]
mass_kg = 6.0
yaw_inertia_kgm2 = 0.08
wheel_radius_m = 0.04
wheel_inertia_kgm2 = 0.0005
motor_gain_Nm_per_V = 0.2
motor_damping_Nms = 0.05
""" + wheel("fixed", 0, 0.1, axle_deg=-90) + wheel("fixed", 0, -0.1, axle_deg=-90) + """
[[input]]
signal = "voltage_V[1]"
"""
INPUTS = {
    "table": ('kind = "table"\nt_s = [0.0, 1.0]\nvalue = [0.0, 10.0]\n', 10.0),
    "sine": ('kind = "sine"\namplitude = 10.0\nfrequency_Hz = 0.25\n', 10.0),
    "steps": ('kind = "steps"\nt_s = [0.0, 1.0]\nvalue = [3.0, 10.0]\n', 10.0),
}
RUN = '[run]\nduration_s = 1.0\nstep_s = 0.1\n[outputs]\nsignals = ["wheel_torque_Nm[1]", "wheel_speed_rad_per_s[1]"]\n'


def scene_file(tmp_path: Path, given: str, tail: str = RUN) -> Path:
    """Two driven wheels with one input."""
    path = tmp_path / "scene.toml"
    path.write_text(ROBOT + given + tail)
    return path


@pytest.mark.parametrize("kind", INPUTS)
def test_the_last_row_has_the_inputs_of_its_own_instant(tmp_path, kind):
    given, volts = INPUTS[kind]
    out = tmp_path / "run.csv"
    assert run(["simulate", str(scene_file(tmp_path, given)), "--inputs", "--out", str(out)]) == 0
    with out.open() as file:
        last = {name: float(text) for name, text in list(csv.DictReader(file))[-1].items()}
    assert last["voltage_V[1]"] == pytest.approx(volts)
    assert last["wheel_torque_Nm[1]"] == pytest.approx(0.2 * volts - 0.05 * last["wheel_speed_rad_per_s[1]"])


@pytest.mark.parametrize("kind", INPUTS)
def test_a_run_with_its_inputs_is_replayed_to_the_last_row(tmp_path, capsys, kind):
    path, out = scene_file(tmp_path, INPUTS[kind][0]), tmp_path / "run.csv"
    assert run(["simulate", str(path), "--inputs", "--out", str(out)]) == 0
    assert run(["replay", str(out), str(path), "--json"]) == 0
    text = capsys.readouterr().out
    found = json.loads(text[text.index("{"):])
    torque = next(each for each in found["compared"] if each["signal"] == "wheel_torque_Nm[1]")
    assert torque["largest_difference"] < (1e-2 if kind == "sine" else 1e-12)  # a sine is replayed linear between rows


def refusal(path: Path, capsys) -> str:
    """The line that a scene is refused with."""
    assert run(["simulate", str(path)]) == 2
    return capsys.readouterr().err


def test_a_sine_that_the_steps_cannot_follow_is_refused_with_the_largest_step_that_can(tmp_path, capsys):
    given = 'kind = "sine"\namplitude = 1.0\nfrequency_Hz = 30.0\n'
    line = refusal(scene_file(tmp_path, given, RUN.replace("0.1", "0.01")), capsys)
    assert "input[1].frequency_Hz: 30 Hz" in line and "steps of 0.01 s" in line
    assert "a step of 0.008333333333333333 s would do" in line
    assert run(["simulate", str(tmp_path / "scene.toml"), "--step", repr(1 / 120)]) == 0


def test_the_step_that_is_proposed_fits_rows_and_run_too(tmp_path, capsys):
    given = 'kind = "steps"\nt_s = [0.025]\nvalue = [1.0]\n'
    line = refusal(scene_file(tmp_path, given, RUN + "every_s = 0.1\n"), capsys)
    assert "a step of 0.025 s would do" in line
    assert run(["simulate", str(tmp_path / "scene.toml"), "--step", "0.025"]) == 0


def test_the_step_that_a_replay_proposes_fits_the_scene_too(tmp_path, capsys):
    path, log = scene_file(tmp_path, INPUTS["table"][0]), tmp_path / "log.csv"
    log.write_text("time_s,wheel_torque_Nm[1]\n0,0\n0.13,0\n0.26,0\n")
    assert run(["replay", str(log), str(path)]) == 2
    advised = re.search(r"a step of (\S+) s would do", capsys.readouterr().err)
    assert advised is not None
    path.write_text(path.read_text().replace("step_s = 0.1", f"step_s = {advised[1]}"))
    assert run(["replay", str(log), str(path)]) == 0


def test_a_file_that_is_no_log_is_refused_with_what_its_first_column_must_be(tmp_path, capsys):
    log = tmp_path / "log.csv"
    log.write_text("t;x\n0;0\n1;0\n")
    assert run(["replay", str(log), str(scene_file(tmp_path, INPUTS["table"][0]))]) == 2
    line = capsys.readouterr().err
    assert "first column time_s" in line and "commas" in line


REFUSED = {
    "voltage without a motor": (("motor_gain_Nm_per_V = 0.2\nmotor_damping_Nms = 0.05\n", ""),
                                ("input[1].signal: voltage_V[1] would do nothing", "[vehicle.motor]")),
    "rotor hides a negative wheel": (
        ("wheel_inertia_kgm2 = 0.0005\nmotor_gain_Nm_per_V = 0.2\nmotor_damping_Nms = 0.05\n",
         "wheel_inertia_kgm2 = -0.02\nmotor = {resistance_ohm = 1, torque_constant_Nm_per_A = 1, gear_ratio = 10, "
         "back_emf_Vs_per_rad = 1, rotor_inertia_kgm2 = 0.01}\n"), ("vehicle.wheel_inertia_kgm2: -0.02", "negative")),
    "friction hides a negative back-EMF": (
        ("motor_gain_Nm_per_V = 0.2\nmotor_damping_Nms = 0.05\n",
         "motor = {resistance_ohm = 1, torque_constant_Nm_per_A = 1, gear_ratio = 10, "
         "back_emf_Vs_per_rad = -0.1, viscous_friction_Nms = 1}\n"), ("motor.back_emf_Vs_per_rad: -0.1", "negative")),
    "payload hides a mass": (
        ("mass_kg = 6.0\n", "mass_kg = 1e-320\npayload = {mass_kg = 1, x_m = 0, y_m = 0, yaw_inertia_kgm2 = 1}\n"),
        ("vehicle.mass_kg: ", "range")),
    "radius beyond all range": (("wheel_radius_m = 0.04", "wheel_radius_m = 1e300"), ("wheel_radius_m: a result",)),
    "numbers beyond all range together": (("wheel_radius_m = 0.04", "wheel_radius_m = 1e100"),
                                          ("vehicle: a result leaves",)),
    "axle lines that do not meet": (
        ("x_m = 0\ny_m = -0.1\naxle_deg = -90", "x_m = 0.3\ny_m = -0.1\naxle_deg = -80\n[[vehicle.wheel]]\n"
         "kind = \"fixed\"\nx_m = 1\ny_m = 1\naxle_deg = -90"), ("fixed wheels must meet in one point",)),
    "rounding of a start": (("[run]", "[initial]\nvelocity_body_m_per_s = [0.2, 0.1]\n[run]"), ("allow is 0\n",)),
    "missing roller angle": (('"fixed"', '"mecanum"'), ("wheel[1].roller_rad: is missing", "roller_deg")),
    "key twice": (("mass_kg = 6.0", "mass_kg = 6.0\nmass_kg = 7.0"), ("vehicle.mass_kg: is given twice", "keep one")),
    "empty name": (("[vehicle]", 'name = " "\n[vehicle]'), ("name: is empty",)),
    "rows further apart than the run is long": (("[outputs]", "[outputs]\nevery_s = 2.0"), ("every_s: 2 s is longer",)),
    "no signals": (('["wheel_torque_Nm[1]", "wheel_speed_rad_per_s[1]"]', "[]"), ("outputs.signals: is empty",)),
}


@pytest.mark.parametrize("what", REFUSED)
def test_refused_with_field_and_remedy(tmp_path, capsys, what):
    (old, new), words = REFUSED[what]
    path = scene_file(tmp_path, INPUTS["table"][0])
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    line = refusal(path, capsys)
    assert [word for word in words if word not in line] == []
    assert not line.rstrip().endswith(":")


# ---- Outputs beyond the range of numbers end a run, as a refused step does: no row, file or word holds NaN.

SIGNALS = ("no_slip_margin_N", "wheel_reaction_N", "wheel_torque_Nm", "x_m", "voltage_V[1]")
HUGE = 1.7e308


def tables(at_s: float, every_s: float | None) -> dict[str, object]:
    """Robotino 2 with voltages that no torque can be of, from an instant on."""
    found = read_toml(read_scene("robotino2").path).plain()
    found["run"] = {"duration_s": 1.0, "step_s": 0.01}
    found["outputs"] = {} if every_s is None else {"every_s": every_s}
    found["input"] = [{"signal": f"voltage_V[{i}]", "kind": "steps", "t_s": [0.0, at_s], "value": [3.0, HUGE]}
                      for i in (1, 2, 3)]
    return found


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("every_s", [None, 0.1, 0.3])
@pytest.mark.parametrize(("at_s", "words"), [(1.0, "at t = 1 s: outputs: a result leaves the range of double"),
                                             (0.5, "at t = 0.5 s: run.step_s: a result leaves the range of double")])
def test_a_run_ends_before_a_row_that_is_out_of_range(at_s: float, words: str, every_s: float | None) -> None:
    with pytest.raises(RunRefused) as refused:
        simulate(build_scene(tables(at_s, every_s)), SIGNALS, estimated=True)
    assert words in str(refused.value)
    found = refused.value.run
    rows = len(found.time_s)
    assert rows > 1 and found.steps == round(100 * at_s) and found.time_s[-1] < at_s
    assert all(len(column) == rows and np.isfinite(column).all() for column in found.columns.values())
    assert all(len(column) == rows for column in found.error_columns.values())
    assert not found.columns["voltage_V[1]"].max() > 3.0


def test_a_run_whose_kept_signals_are_in_range_goes_to_its_end() -> None:
    found = simulate(build_scene(tables(1.0, None)), ("x_m", "voltage_V[1]"))
    assert (found.time_s[-1], found.columns["voltage_V[1]"][-1]) == (1.0, HUGE)


def test_what_the_command_prints_and_writes_holds_no_nan(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = tmp_path / "s.toml", tmp_path / "run.csv"
    text = read_scene("robotino2").path.read_text(encoding="utf-8").split("[[input]]")[0]
    path.write_text(text + f"""
[[input]]
signal = "voltage_V[1]"
kind = "steps"
t_s = [0.0, 1.0]
value = [3.0, {HUGE}]
[run]
duration_s = 1.0
step_s = 0.01
[outputs]
signals = ["no_slip_margin_N", "x_m"]
""", encoding="utf-8")
    assert run(["simulate", str(path), "--out", str(out), "--errors", "--json"]) == 1
    told = capsys.readouterr()
    assert "nan" not in (told.out + told.err + out.read_text()).lower()
    assert math.isfinite(json.loads(told.out)["final"]["no_slip_margin_N"])


def test_a_force_that_is_no_number_is_told_in_words() -> None:
    assert newtons(math.nan) == newtons(-math.inf) == "beyond all numbers"


# ---- CSV text reads back as the same numbers, every bit.

def read_back(table: np.ndarray) -> np.ndarray:
    lines = "".join(csv_text(table)).splitlines()
    return np.array([[float(cell) for cell in line.split(",")] for line in lines])


def assert_same_bits(table: np.ndarray) -> None:
    assert read_back(table).view(np.uint64).tolist() == table.view(np.uint64).tolist()


def test_random_bits_read_back_as_they_were():
    bits = np.random.default_rng(1).integers(0, 2**64, (ROWS_AT_ONCE + 5, 4), dtype=np.uint64)
    numbers = bits.view(np.float64)
    assert_same_bits(np.where(np.isfinite(numbers), numbers, 1.0))


@pytest.mark.parametrize("numbers", [
    [0.0, -0.0, 5e-324, -1e-323, 2.2250738585072014e-308, 1.7976931348623157e308, 1e22, 1e23, 0.1, 1 / 3],
    [10.0**k for k in range(-323, 309)], [2.0**k for k in range(-1074, 1024)], [k * 1e-3 for k in range(2000)]],
    ids=["special", "tens", "twos", "times"])
def test_numbers_at_every_border_read_back_as_they_were(numbers):
    assert_same_bits(np.array(numbers)[:, None])


def test_no_number_has_more_digits_than_it_needs():
    assert "".join(csv_text(np.array([[0.1, 2.5, 1.0 / 3.0, -3.0]]))) == "0.1,2.5,0.3333333333333333,-3.0\n"


def test_what_is_no_finite_number_is_written_as_python_writes_it():
    assert "".join(csv_text(np.array([[math.nan, 1.5], [-math.inf, math.inf]]))) == "nan,1.5\n-inf,inf\n"


def test_rows_have_commas_between_and_line_ends_after():
    assert "".join(csv_text(np.array([[1.0, 2.5], [0.25, -3.0]]))) == "1.0,2.5\n0.25,-3.0\n"
    assert not list(csv_text(np.zeros((0, 3))))


def test_a_number_more_is_no_python_call_more():
    def calls(rows: int) -> int:
        count = 0

        def note(*_: object) -> None:
            nonlocal count
            count += 1

        table = np.full((rows, 10), 0.1)
        sys.setprofile(note)
        try:
            list(csv_text(table))
        finally:
            sys.setprofile(None)
        return count

    calls(1)
    assert calls(4000) == calls(10)
