"""Counters and angles that begin again: the map's `wrap` makes them continuous, without it a jump is one line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.robot.logs import Log, gather_logs
from laconic.robot.logs.log import Counter
from laconic.robot.logs.wraps import folded
from laconic.robot.replay.missed_wraps import fitting
from laconic.robot.replay.rolling import rotations_of
from laconic.scene import read_scene
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
    assert ("wheel_angle 'left' changes by 48 % of wrap = true (4096) until line 3, so its direction is uncertain"
            ) in " ".join(found["remarks"])


def seldom(share: float, wrap: int = 4096, count: int = 60) -> tuple[np.ndarray, float]:
    """Counts whose faster wheel turns by this share of the wrap in each row, and the gear that makes it so."""
    rows = motion(count)
    gear = share * wrap / TICKS * 2.0 * np.pi / float(rows[1, 2])
    rows[:, 1:3] = np.floor(wrapped(rows[:, 1:3] * gear * TICKS / (2.0 * np.pi), wrap))
    return rows, gear


@pytest.mark.parametrize("share", [0.56, 0.72, 0.95, 1.3])
@pytest.mark.parametrize("kind", ["absolute", "increments"])
@pytest.mark.parametrize("evidence", ["pose", "positions", "speed", "centre_of_mass"])
def test_a_row_in_which_a_counter_passes_half_its_range_is_named_by_what_contradicts_it(
        tmp_path, capsys, share, kind, evidence):
    rows, gear = seldom(share)
    speeds = np.gradient(motion(60)[:, 1:3], 0.05, axis=0)
    if kind == "increments":
        rows[1:, 1:3] = np.diff(rows[:, 1:3], axis=0)
    unit = (f'[wheel_angle]\nkind = "{kind}"\nunit = "tick"\nticks_per_turn = {TICKS}\ngear_ratio = {gear!r}\n'
            "wrap = 4096")
    changes = [("[wheel_angle]", unit), *([('"x", "y", "yaw"', '"x", "y"')] if evidence == "positions" else []),
               *([("[pose]", '[pose]\npoint = "centre_of_mass"')] if evidence == "centre_of_mass" else [])]
    log = csv(tmp_path / "run.csv", rows)
    if evidence == "speed":
        log = tmp_path / "run.csv"
        np.savetxt(log, np.column_stack([rows, speeds]), delimiter=",", comments="", header="t,left,right,x,y,yaw,l,r")
        changes.append(("[pose]", '[wheel_speed]\ncolumns = ["l", "r"]\n[pose]'))
    remarks = " ".join(replayed(capsys, log, mapped(tmp_path, TEXT_MAP, change=changes))["remarks"])
    assert "line 3: wheel " in remarks or "line 2: wheel " in remarks
    assert "% of wrap = 4096 in one row, but by " in remarks
    assert "record more often, or count with a larger wrap" in remarks


@pytest.mark.parametrize("noise_m", [0.0, 2e-4, 3e-3])
def test_a_counter_that_is_sampled_often_enough_has_no_remark_whatever_the_noise_of_the_pose(
        tmp_path, capsys, noise_m):
    rows, gear = seldom(0.4, count=400)
    noise = np.random.default_rng(1)
    rows[:, 3:5] += noise_m * noise.standard_normal((400, 2))
    rows[:, 5] += noise_m * noise.standard_normal(400)
    unit = f'[wheel_angle]\nunit = "tick"\nticks_per_turn = {TICKS}\ngear_ratio = {gear!r}\nwrap = true'
    log = csv(tmp_path / "run.csv", rows)
    assert not replayed(capsys, log, mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", unit)]))["remarks"]


def test_one_row_that_was_lost_at_speed_is_named(tmp_path, capsys):
    rows, gear = seldom(0.3, count=200)
    rows = np.delete(rows, [100], axis=0)
    unit = f'[wheel_angle]\nunit = "tick"\nticks_per_turn = {TICKS}\ngear_ratio = {gear!r}\nwrap = true'
    log = csv(tmp_path / "run.csv", rows)
    remarks = replayed(capsys, log, mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", unit)]))["remarks"]
    assert ("wheel_angle 'right' changes by 30 % of wrap = true (4096) until line 101 and by -40 % until line 102, "
            "which may be 60 %, so its direction is uncertain") in " ".join(remarks)


def test_a_gap_in_which_a_counter_passes_half_its_range_is_named(tmp_path, capsys):
    rows, gear = seldom(0.2, count=200)
    rows = np.delete(rows, [100, 101, 102], axis=0)
    unit = f'[wheel_angle]\nunit = "tick"\nticks_per_turn = {TICKS}\ngear_ratio = {gear!r}\nwrap = true'
    log = csv(tmp_path / "run.csv", rows)
    remarks = " ".join(replayed(capsys, log, mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", unit)]))["remarks"])
    assert "line 102: wheel " in remarks and "in one row, but by the pose by " in remarks
    assert " of 196 rows" not in remarks  # that row alone


@pytest.mark.parametrize("fast", [
    (0.03, 0.02, 0.05), (-0.03, 0.01, 0.04), (0.02, -0.03, -0.06), (0.02, -0.01, -0.06)])
def test_a_wheel_that_contradicts_the_others_by_a_part_of_its_range_is_named(tmp_path, fast):
    scene = read_scene("kuka_youbot")
    steps = rotations_of(scene.core(), scene.vehicle, np.tile(fast, (39, 1)))
    wrap = float(np.abs(steps).max()) / 0.6
    steps[:19] *= 0.5
    steps[20:] *= 0.5
    assert (np.abs(steps[19]) > 0.5 * wrap).sum() == 1

    def told(steps: np.ndarray) -> str:
        angle = np.vstack([np.zeros(4), np.cumsum(folded(steps, wrap), axis=0)])
        counter = Counter("wrap = 9", np.full((1, 4), wrap), lambda row: f"line {row + 2}")
        log = Log(tmp_path / "run.csv", "map", 0.1 * np.arange(40), wheel_angle_rad=angle, counter=counter)
        return " ".join(fitting(scene, [log])[0].remarks)

    assert "line 22: wheel " in told(steps) and "but by the other wheels by" in told(steps)
    assert not told(0.5 * steps)


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
