"""Topics that were joined by their times have blank cells: what flows is interpolated, what is held is held, and the
report states it."""

from __future__ import annotations

import json

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.robot.logs import gather_logs
from log_support import SCENE, TEXT_MAP, csv, mapped, motion, refused_log, replayed

HEAD = ("t", "left", "right", "x", "y", "yaw")


def joined(rows: np.ndarray, of_wheels: slice | list[int], of_pose: slice | list[int]) -> list[list[float | None]]:
    """The cells of wheels and pose at these rows alone, None elsewhere."""
    wheels, pose = np.zeros(len(rows), bool), np.zeros(len(rows), bool)
    wheels[of_wheels], pose[of_pose] = True, True
    return [[row[0], *(row[1:3] if wheels[k] else (None, None)), *(row[3:] if pose[k] else (None,) * 3)]
            for k, row in enumerate(rows.tolist())]


def one(log, mapping):
    (found,), _ = gather_logs([log], mapping)
    return found


def test_two_topics_on_lines_of_their_own_are_one_log_and_reported(tmp_path, capsys):
    log = csv(tmp_path / "run.csv", joined(motion(161, 0.025), slice(0, None, 2), slice(1, None, 2)), HEAD)
    mapping = mapped(tmp_path, TEXT_MAP)
    found = replayed(capsys, log, mapping)
    assert found["runs"][0]["path_error"] < 1e-4 and found["runs"][0]["heading_error_rad"] < 1e-4
    assert found["remarks"] == [
        "run: wheel_angle is blank on 80 lines of 161 and is interpolated there, over 0.05 s at most",
        "run: pose is blank on 81 lines of 161 and is interpolated there, over 0.05 s at most",
        "run: lines 2 and 162 are left out: not every quantity has begun, or one has ended"]
    read = one(log, mapping)
    assert len(read.time_s) == 159 and read.seen.tolist() == list(range(0, 159, 2))
    assert run(["identify", str(log), "--scene", SCENE, "--map", str(mapping), "--json"]) == 0
    assert "is interpolated there" in " ".join(json.loads(capsys.readouterr().out)["words"])


@pytest.mark.parametrize("blank", ["", " ", "NaN", "nan"])
def test_every_way_to_leave_a_cell_empty_is_the_same(blank, tmp_path, capsys):
    cells = joined(motion(81), slice(None), slice(0, None, 5))
    log = csv(tmp_path / "run.csv", [[blank if cell is None else cell for cell in row] for row in cells], HEAD)
    found = replayed(capsys, log, mapped(tmp_path, TEXT_MAP))
    assert found["runs"][0]["path_error"] < 1e-6
    assert one(log, tmp_path / "map.toml").seen.tolist() == list(range(0, 81, 5))


def test_a_sparse_pose_is_compared_where_it_was_recorded_alone(tmp_path, capsys):
    """On a small circle the chord between two poses a turn of 2 rad apart is far from the path."""
    time = 0.02 * np.arange(501)
    left, right = 2.0 * time, 8.0 * time
    yaw = 0.033 * (right - left) / 0.16
    radius = 0.033 * 5.0 / (0.033 * 6.0 / 0.16)
    rows = np.column_stack([time, left, right, radius * np.sin(yaw), radius * (1.0 - np.cos(yaw)), yaw])
    log = csv(tmp_path / "run.csv", joined(rows, slice(None), slice(0, None, 50)), HEAD)
    assert replayed(capsys, log, mapped(tmp_path, TEXT_MAP))["runs"][0]["path_error"] < 1e-6


def test_columns_of_one_quantity_may_come_on_different_lines(tmp_path, capsys):
    rows = [[row[0], row[1] if k % 2 else None, None if k % 2 else row[2], *row[3:]]
            for k, row in enumerate(motion(121, 0.02).tolist())]
    log = csv(tmp_path / "run.csv", rows, HEAD)
    assert replayed(capsys, log, mapped(tmp_path, TEXT_MAP))["runs"][0]["path_error"] < 1e-5


def test_voltages_and_set_speeds_are_held_and_increments_are_lost_nowhere(tmp_path):
    rows = motion(60)
    steps = np.diff(rows[:, 1:3], axis=0, prepend=rows[:1, 1:3])
    cells = [[row[0], *(steps[k] if k % 3 == 0 else (None, None)), *row[3:], float(k // 10) if k % 10 == 0 else None]
             for k, row in enumerate(rows.tolist())]
    for k in range(3, 60, 3):
        cells[k][1:3] = (rows[k, 1:3] - rows[k - 3, 1:3]).tolist()
    log = csv(tmp_path / "run.csv", cells, (*HEAD, "u"))
    text = TEXT_MAP.replace("[wheel_angle]", '[voltage]\ncolumns = ["u", "t"]\n[wheel_angle]\nkind = "increments"')
    found = one(log, mapped(tmp_path, text))
    assert found.voltage_V[:, 0] == pytest.approx(np.arange(58) // 10)
    assert found.wheel_angle_rad == pytest.approx(rows[:58, 1:3] - rows[0, 1:3])
    assert "voltage is blank on 54 lines of 60 and is held from the line before there" in " ".join(found.remarks)


def test_a_single_blank_cell_is_filled_in_and_reported(tmp_path, capsys):
    cells = [list(row) for row in motion(40).tolist()]
    cells[20][1] = None
    found = replayed(capsys, csv(tmp_path / "run.csv", cells, HEAD), mapped(tmp_path, TEXT_MAP))
    assert found["runs"][0]["path_error"] < 1e-6
    assert found["remarks"] == [
        "run: wheel_angle is blank on 1 line of 40 and is interpolated there, over 0.1 s at most"]


def test_a_counter_that_wraps_is_made_continuous_before_it_is_filled_in(tmp_path, capsys):
    rows = motion(161, 0.025)
    rows[:, 1:3] = np.floor(np.remainder(rows[:, 1:3] * 20 * 4096 / (2 * np.pi), 65536))
    log = csv(tmp_path / "run.csv", joined(rows, slice(0, None, 2), slice(1, None, 2)), HEAD)
    unit = '[wheel_angle]\nunit = "tick"\nticks_per_turn = 4096\ngear_ratio = 20\nwrap = 65536'
    found = replayed(capsys, log, mapped(tmp_path, TEXT_MAP, change=[("[wheel_angle]", unit)]))
    assert found["runs"][0]["path_error"] < 1e-3


def test_a_quantity_that_may_be_absent_and_is_hardly_there_is_left_out(tmp_path, capsys):
    cells = [[*row, 1.0 if k < 5 else None] for k, row in enumerate(motion(60).tolist())]
    log = csv(tmp_path / "run.csv", cells, (*HEAD, "g"))
    text = TEXT_MAP + '[yaw_rate]\ncolumn = "g"\n'
    found = one(log, mapped(tmp_path, text + "optional = true\n"))
    assert found.yaw_rate_rad_per_s is None and len(found.time_s) == 60
    assert found.remarks == ("yaw_rate is left out: it is known at 5 of 60 rows",)
    needed = refused_log(capsys, log, mapped(tmp_path, text))
    assert "needs at least 10 samples" in needed and "has 5" in needed


def test_a_column_that_is_blank_everywhere_is_named(tmp_path, capsys):
    cells = [[*row[:5], None] for row in motion(40).tolist()]
    log = csv(tmp_path / "run.csv", cells, HEAD)
    assert "pose: 'yaw' is blank on all lines; record it" in refused_log(capsys, log, mapped(tmp_path, TEXT_MAP))
    optional = mapped(tmp_path, TEXT_MAP + "optional = true\n")
    assert "has no true pose to compare with" in refused_log(capsys, log, optional)


WRONG = {
    "NaN in one column of a quantity": ((20, 3, "nan"), "line 22: pose is not finite; remove the line or repair it, or "
                                                        "leave its cell blank"),
    "an infinite number": ((20, 1, "inf"), "line 22: wheel_angle is not finite"),
    "a word": ((20, 1, "none"), "line 22: no number for wheel_angle ('none')"),
    "no time": ((20, 0, ""), "line 22: no number for time ('')"),
    "NaN as time": ((20, 0, "nan"), "line 22: time is not finite"),
}


@pytest.mark.parametrize(("cell", "words"), WRONG.values(), ids=WRONG)
def test_what_is_neither_a_number_nor_blank_is_named_by_its_line(cell, words, tmp_path, capsys):
    cells = [list(row) for row in motion(40).tolist()]
    cells[cell[0]][cell[1]] = cell[2]
    log = csv(tmp_path / "run.csv", cells, HEAD)
    assert words in refused_log(capsys, log, mapped(tmp_path, TEXT_MAP))


def test_a_log_of_signals_is_compared_where_it_has_values(tmp_path, capsys):
    log = tmp_path / "run.csv"
    assert run(["simulate", SCENE, "--out", str(log), "--inputs"]) == 0
    head, *lines = log.read_text().splitlines()
    names = head.split(",")
    x, voltage = names.index("x_m"), names.index("voltage_V[1]")
    for k, line in enumerate(lines):
        cells = line.split(",")
        cells[x] = "" if k % 2 else cells[x]
        cells[voltage] = "" if k == 7 else cells[voltage]
        lines[k] = ",".join([*cells, "free text", "1"])
    log.write_text("\n".join([head + ",note,note", *lines]) + "\n")
    capsys.readouterr()
    assert run(["replay", str(log), SCENE, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert max(each["largest_difference"] for each in found["compared"]) < 1e-6 and found["left_out"] == ["note"]
    assert any(remark.startswith("x_m is blank on") and "not compared" in remark for remark in found["remarks"])
    log.write_text(log.read_text().replace("x_m", "y_m", 1))
    assert run(["replay", str(log), SCENE]) == 2
    assert "has two columns 'y_m'; keep one of them" in capsys.readouterr().err


@pytest.mark.parametrize("rest_unit", ["us", "ns", "ms"])
@pytest.mark.parametrize("told_unit", ["us", "ns", "ms"])
def test_a_rest_of_seconds_in_another_unit_than_the_map_says_is_told(told_unit, rest_unit, tmp_path, capsys):
    rows, size = motion(161, 0.025), {"ms": 1e3, "us": 1e6, "ns": 1e9}[rest_unit]
    cells = [[int(row[0]), round((row[0] % 1.0) * size), *row[1:]] for row in (rows + 1e-12).tolist()]
    log = csv(tmp_path / "run.csv", cells, ("sec", "rest", *HEAD[1:]))
    mapping = mapped(tmp_path, TEXT_MAP, change=[('column = "t"',
                                                  f'columns = ["sec", "rest"]\nunits = ["s", "{told_unit}"]')])
    status = run(["replay", str(log), str(SCENE), "--map", str(mapping), "--json"])
    found = capsys.readouterr()
    words = f"'rest' is given in {told_unit}, but begins again with each second before {size:.0f}, as {rest_unit} do"
    assert (words in found.out + found.err) == (told_unit != rest_unit)
    assert status in (0, 2) and (status == 0 or found.err.count("\n") == 1)


def test_microseconds_beside_seconds_are_guessed(tmp_path, capsys):
    rows = motion(161, 0.025)
    cells = [[int(row[0]), round((row[0] % 1.0) * 1e6), *row[1:]] for row in (rows + 1e-12).tolist()]
    log = csv(tmp_path / "run.csv", cells, ("stamp.sec", "stamp.nsec", *HEAD[1:]))
    assert run(["logs", str(log)]) == 0
    shown = capsys.readouterr().out
    assert 'units = ["s", "us"]' in shown and "stamp.nsec is always less than 10^6, so it is taken for us" in shown


@pytest.mark.parametrize(("blank", "words"), [(8, ""), (30, "whole ranges may be missing")])
def test_a_counter_that_begins_again_on_blank_lines_is_told(blank, words, tmp_path, capsys):
    rows = motion(161, 0.025)
    counter = np.mod(np.round(rows[:, 1:3] * 40.0), 256)
    wrap = int(np.argmax(np.diff(counter[:, 0]) < -128)) + 1
    cells: list[list[float | None]] = [[row[0], *pair, *row[3:]] for row, pair in zip(
        rows.tolist(), counter.tolist(), strict=True)]
    for line in range(max(wrap - blank // 2, 1), wrap + blank // 2):
        cells[line][1] = cells[line][2] = None
    log = csv(tmp_path / "run.csv", cells, HEAD)
    keys = 'columns = ["left", "right"]\nunit = "tick"\nticks_per_turn = 251.327412287\nwrap = 256'
    mapping = mapped(tmp_path, TEXT_MAP, change=[('columns = ["left", "right"]', keys)])
    remarks = [each for each in replayed(capsys, log, mapping)["remarks"] if "where nothing is recorded" in each]
    assert remarks and "begins again (wrap = 256)" in remarks[0] and words in remarks[0]
    assert ("whole ranges" in remarks[0]) == bool(words)
