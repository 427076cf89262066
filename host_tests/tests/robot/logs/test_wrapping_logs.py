"""Counters and angles that begin again: the map's `wrap` makes them continuous, without it a jump is one line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.robot.logs import gather_logs
from log_support import (
    CAN_MAP,
    SCENE,
    TEXT_MAP,
    asc,
    asc_lines,
    csv,
    frames,
    mapped,
    motion,
    refused,
    refused_log,
    replayed,
)

TICKS = 4096


def wrapped(values: np.ndarray, wrap: float, least: float = 0.0) -> np.ndarray:
    return np.remainder(values - least, wrap) + least


def counted(gear: float, least: int, wrap: int, count: int = 400) -> np.ndarray:
    """The run with the wheels' angles as counts of an encoder of 4096 behind a gear."""
    rows = motion(count)
    counts = np.floor(rows[:, 1:3] * gear * TICKS / (2.0 * np.pi))
    return np.column_stack([rows[:, 0], wrapped(counts, wrap, least), rows[:, 3:]])


COUNTERS = {"12 bits": (1, 0, 4096), "16 bits": (20, 0, 65536), "16 bits with sign": (20, -32768, 65536),
            "8 bits of a slow wheel": (0.05, 0, 256), "a decade": (10, 0, 10000), "24 bits": (4000, 0, 1 << 24),
            "32 bits with sign": (1e6, -(1 << 31), 1 << 32), "32 bits": (1e6, 0, 1 << 32)}


@pytest.mark.parametrize(("gear", "least", "wrap"), COUNTERS.values(), ids=COUNTERS)
def test_a_counter_that_wraps_is_continuous_by_the_map_and_refused_without(gear, least, wrap, tmp_path, capsys):
    log = csv(tmp_path / "run.csv", counted(gear, least, wrap))
    unit = f'[wheel_angle]\nunit = "tick"\nticks_per_turn = {TICKS}\ngear_ratio = {gear}'
    error = refused_log(capsys, log, mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", unit)]))
    assert "wheel_angle 'left' jumps from" in error or "wheel_angle 'right' jumps from" in error
    assert "half of its range or more; give wrap" in error and "line " in error
    assert (f"wrap = {wrap:.9g} under" in error) == (wrap != 10000)
    error = refused(capsys, "identify", log, "--scene", SCENE, "--map", tmp_path / "map.toml")
    assert "jumps from" in error
    right = mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", f"{unit}\nwrap = {wrap}")])
    assert replayed(capsys, log, right)["runs"][0]["path_error"] < 1e-3


ANGLES = {"0 to 360": ("deg", 360.0, 0.0), "-180 to 180": ("deg", 360.0, -180.0), "±π": ("rad", 2 * np.pi, -np.pi),
          "0 to 2π": ("rad", 2 * np.pi, 0.0), "turns": ("turn", 1.0, 0.0)}


@pytest.mark.parametrize(("unit", "turn", "least"), ANGLES.values(), ids=ANGLES)
@pytest.mark.parametrize("gear", [1.0, 3.0])
def test_an_angle_within_one_turn_is_continuous_by_the_map_and_refused_without(unit, turn, least, gear, tmp_path,
                                                                               capsys):
    rows = motion()
    angles = np.round(wrapped(rows[:, 1:3] * gear / (2.0 * np.pi) * turn, turn, least), 3)
    log = csv(tmp_path / "run.csv", np.column_stack([rows[:, 0], angles, rows[:, 3:]]))
    given = f'[wheel_angle]\nunit = "{unit}"\ngear_ratio = {gear}'
    assert "jumps from" in refused_log(capsys, log, mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", given)]))
    for wrap in ("true", f"{turn:.9f}"):
        right = mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", f"{given}\nwrap = {wrap}")])
        assert replayed(capsys, log, right)["runs"][0]["path_error"] < 3e-3


def test_a_wheel_that_turns_back_a_wheel_that_stands_and_one_that_trembles_are_taken_as_they_are(tmp_path):
    time = 0.05 * np.arange(60)
    there_and_back = 10.0 * np.sin(time)
    for column in (there_and_back, 0.0 * time, np.arange(60) % 2, np.where(time > 2.0, 1.0, 0.0),
                   np.concatenate([np.zeros(59), [7.0]])):
        log = csv(tmp_path / "run.csv", np.column_stack([time, there_and_back, column, motion(60)[:, 3:]]))
        (found,), _ = gather_logs([log], mapped(tmp_path, TEXT_MAP))
        assert found.wheel_angle_rad[:, 1] == pytest.approx(column)


def test_wrap_false_takes_a_jump_as_it_is_and_wrap_too_small_is_refused(tmp_path, capsys):
    log = csv(tmp_path / "run.csv", counted(20, 0, 65536))
    unit = f'[wheel_angle]\nunit = "tick"\nticks_per_turn = {TICKS}\ngear_ratio = 20'
    taken = mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", f"{unit}\nwrap = false")])
    assert replayed(capsys, log, taken)["runs"][0]["path_error"] > 0.1
    small = mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", f"{unit}\nwrap = 32768")])
    error = refused_log(capsys, log, small)
    assert "wheel_angle 'left' goes from" in error and "more than wrap = 32768 lets it" in error
    for text, words in (("0", "is 0"), ("-4", "is -4"), ("nan", "is nan; give a finite"), ('"x"', "is the text")):
        wrong = mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", f"{unit}\nwrap = {text}")])
        assert f"wheel_angle.wrap: {words}" in refused_log(capsys, log, wrong)


def test_differences_of_a_counter_that_wraps_are_mended_too(tmp_path, capsys):
    rows = counted(20, 0, 65536)
    rows[1:, 1:3] = np.diff(rows[:, 1:3], axis=0)
    rows[0, 1:3] = 0.0
    log = csv(tmp_path / "run.csv", rows)
    unit = f'[wheel_angle]\nkind = "increments"\nunit = "tick"\nticks_per_turn = {TICKS}\ngear_ratio = 20'
    assert "jumps from" in refused_log(capsys, log, mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", unit)]))
    right = mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", f"{unit}\nwrap = 65536")])
    assert replayed(capsys, log, right)["runs"][0]["path_error"] < 1e-3


def test_a_sampling_too_slow_for_the_counter_is_reported(tmp_path, capsys):
    rows = motion(60)
    counts = np.floor(wrapped(np.column_stack([np.arange(60) * 1950.0] * 2), 4096))
    log = csv(tmp_path / "run.csv", np.column_stack([rows[:, 0], counts, rows[:, 3:]]))
    unit = "[wheel_angle]\nunit = \"tick\"\nticks_per_turn = 4096\nwrap = true"
    found = replayed(capsys, log, mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", unit)]))
    assert "wheel_angle 'left' changes by 48 % of wrap = 4096 until line 3, so its direction is uncertain" in " ".join(
        found["remarks"])


def test_signals_of_a_bus_that_wrap_are_mended_and_named(tmp_path, capsys):
    rows = motion()
    rows[:, 1:3] = np.floor(wrapped(rows[:, 1:3] * 20 * TICKS / (2 * np.pi), 65536))
    log = asc(tmp_path / "run.asc", asc_lines(frames(rows)))
    unit = f'[wheel_angle]\nunit = "tick"\nticks_per_turn = {TICKS}\ngear_ratio = 20'
    error = refused_log(capsys, log, mapped(tmp_path, CAN_MAP, change=[("[wheel_angle]", unit)]))
    assert "line " in error and "wheel_angle WHEELS." in error and "give wrap = 65536" in error
    right = mapped(tmp_path, CAN_MAP, change=[("[wheel_angle]", f"{unit}\nwrap = 65536")])
    assert replayed(capsys, log, right)["runs"][0]["path_error"] < 1e-3


def test_a_true_heading_within_one_turn_is_continuous_by_itself(tmp_path, capsys):
    rows = motion(800)
    rows[:, 5] = wrapped(np.degrees(rows[:, 5]), 360.0)
    units = ("[pose]", '[pose]\nunits = ["m", "m", "deg"]')
    log = csv(tmp_path / "run.csv", rows)
    assert replayed(capsys, log, mapped(tmp_path, TEXT_MAP, change=[units]))["runs"][0]["heading_error_rad"] < 1e-3
    steps = np.diff(rows[:, 3:], axis=0, prepend=rows[:1, 3:])
    differences = csv(tmp_path / "run.csv", np.column_stack([rows[:, :3], steps]))
    kind = (units[0], units[1] + '\nkind = "increments"')
    found = replayed(capsys, differences, mapped(tmp_path, TEXT_MAP, change=[kind]))
    assert found["runs"][0]["heading_error_rad"] < 1e-3
    assert "pose turns by more than half a turn at 1 samples" in found["remarks"][0]


def test_a_clock_that_begins_again_is_continuous_by_the_map_and_its_line_is_named_without(tmp_path, capsys):
    rows = motion()
    rows[:, 0] = wrapped(1000.0 * rows[:, 0] + 63000.0, 65536.0)
    log = csv(tmp_path / "run.csv", rows)
    clock = ('column = "t"', 'column = "t"\nunit = "ms"')
    error = refused_log(capsys, log, mapped(tmp_path, TEXT_MAP, change=[clock]))
    assert "line 53: time does not grow" in error and "needs wrap under [time]" in error
    right = mapped(tmp_path, TEXT_MAP, change=[(clock[0], clock[1] + "\nwrap = 65536")])
    assert replayed(capsys, log, right)["runs"][0]["path_error"] < 1e-6


SCENE_WITH_ENCODERS = """name = "cart"
[vehicle]
mass_kg = 5.0
yaw_inertia_kgm2 = 0.1
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.0005
motor_gain_Nm_per_V = 0.1
motor_damping_Nms = 0.1
[[vehicle.wheel]]
kind = "fixed"
x_m = 0.0
y_m = 0.15
axle_deg = -90
[[vehicle.wheel]]
kind = "fixed"
x_m = 0.0
y_m = -0.15
axle_deg = -90
[[input]]
signal = "voltage_V[1]"
kind = "steps"
t_s = [0.0, 1.0]
value = [-6.0, 6.6]
[[input]]
signal = "voltage_V[2]"
kind = "steps"
t_s = [0.0, 1.0]
value = [-6.0, 6.0]
[run]
duration_s = 4.0
step_s = 0.01
[outputs]
signals = ["encoder_count", "x_m", "y_m", "heading_rad"]
every_s = 0.02
[sensors.encoder]
counts_per_turn = 4096
gear_ratio = {gear}
wrap = {wrap}
"""
OF_ENCODERS = """[time]
column = "time_s"
[wheel_angle]
columns = ["encoder_count[1]", "encoder_count[2]"]
unit = "tick"
ticks_per_turn = 4096
gear_ratio = {gear}
wrap = {wrap}
[pose]
columns = ["x_m", "y_m", "heading_rad"]
"""


@pytest.mark.parametrize(("gear", "wrap"), [(20, 65536), (1, 4096), (1, 1 << 32)])
def test_the_counts_of_a_scene_come_back_through_a_map(gear, wrap, tmp_path, capsys):
    scene, log, mapping = tmp_path / "cart.toml", tmp_path / "run.csv", tmp_path / "map.toml"
    scene.write_text(SCENE_WITH_ENCODERS.format(gear=gear, wrap=wrap))
    mapping.write_text(OF_ENCODERS.format(gear=gear, wrap=wrap))
    assert run(["simulate", str(scene), "--out", str(log)]) == 0
    counts = np.loadtxt(log, delimiter=",", skiprows=1)[:, 1:3]
    assert counts.min() >= 0 and counts.max() < wrap and np.ptp(counts) > 0.9 * wrap
    capsys.readouterr()
    assert run(["replay", str(log), str(scene), "--map", str(mapping), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 2e-3
