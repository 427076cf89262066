"""Every log and map that cannot be used is one line that names the file and the remedy, with exit status 2."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.robot.logs import gather_logs
from laconic.robot.logs.column_map import MAPS, project_maps, read_map

METADATA = "type,diff\nngear,43.7\nencRes,64\nDi,0.084,0.084\n"
ROWS = [f"{0.05 * k:.2f},{0.01 * k:.3f},0,{0.002 * k:.4f},{5 + k % 2},{6 - k % 2}" for k in range(20)]


def written(folder: Path, rows=ROWS, metadata: str | None = METADATA, name: str = "run-01.csv") -> Path:
    """A run as optiodom's are."""
    folder.mkdir(parents=True, exist_ok=True)
    if metadata is not None:
        (folder / "metadata.csv").write_text(metadata)
    path = folder / name
    path.write_text("\n".join(rows) + "\n")
    return path


def replaced(index: int, row: str) -> list[str]:
    return [*ROWS[:index], row, *ROWS[index + 1:]]


def said(capsys, *arguments: object) -> str:
    """The one line of a command that refuses its input."""
    assert run([str(each) for each in arguments]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1, err
    return err


LOGS = {
    "a word for a number": (replaced(3, "0.15,0.03,zero,0.006,5,6"), "line 4: no number for pose ('zero')"),
    "a short line": (replaced(5, "0.25,0.05"), "line 6: has 2 columns, the first line 6"),
    "a long line": (replaced(5, ROWS[5] + ",1"), "line 6: has 7 columns, the first line 6"),
    "NaN in the pose": (replaced(7, "0.35,nan,0,0.01,5,6"), "line 8: pose is not finite"),
    "NaN in a wheel": (replaced(7, "0.35,0.07,0,0.01,nan,6"), "line 8: wheel_angle is not finite"),
    "an infinite tick": (replaced(7, "0.35,0.07,0,0.01,5,inf"), "line 8: wheel_angle is not finite"),
    "no time": (replaced(2, ",0.02,0,0.004,5,6"), "line 3: no number for time ('')"),
    "time that stands": (replaced(4, ROWS[3]), "line 5: time does not grow"),
    "time that goes back": (replaced(9, "0.01,0.09,0,0.018,5,6"), "line 10: time does not grow"),
    "NaN in time": (replaced(9, "nan,0.09,0,0.018,5,6"), "line 10: time is not finite"),
    "too few rows": (ROWS[:5], "needs at least 10 samples with increasing time, has 5"),
    "an empty file": ([], "has no samples"),
    "blank lines": (["", " ", ""], "has no samples"),
    "no wheels": ([row.rsplit(",", 2)[0] for row in ROWS], "line 1: has 4 columns, none from 5 on for wheel_angle"),
    "a wheel too many": ([row + ",3" for row in ROWS], "has 3 wheels, the scene 2"),
    "another separator": ([row.replace(",", ";") for row in ROWS], "line 1: no number for time ('0.00;"),
}


@pytest.mark.parametrize(("rows", "words"), LOGS.values(), ids=LOGS)
def test_log_that_cannot_be_used_is_one_line_with_its_file_and_line(rows, words, tmp_path, capsys):
    path = written(tmp_path, rows)
    err = said(capsys, "replay", path, "optiodom_diff")
    assert words in err and str(path) in err


METADATAS = {
    "no gear": ("encRes,64\n", "has no row 'ngear'"),
    "a gear of zero": ("ngear,0\nencRes,64\n", "ngear: is '0'; give a number above zero"),
    "a gear in words": ("ngear,many\nencRes,64\n", "ngear: is 'many'"),
    "an empty row": ("ngear\nencRes,64\n", "ngear: is ''"),
    "an empty file": ("", "has no row 'encRes'"),
}


@pytest.mark.parametrize(("text", "words"), METADATAS.values(), ids=METADATAS)
def test_metadata_that_cannot_be_used_is_one_line(text, words, tmp_path, capsys):
    err = said(capsys, "replay", written(tmp_path, metadata=text), "optiodom_diff")
    assert words in err and "metadata.csv" in err


FILES = {
    "not there": (None, "cannot be read"),
    "packed, then cut off": (gzip.compress("\n".join(ROWS).encode())[:-9], "is packed by gzip but broken"),
    "packed garbage": (b"\x1f\x8b" + bytes(range(200)), "is packed by gzip but broken"),
    "no text": (b"\x80\x81\xff" * 99, "is no CSV text"),
    "a zero byte": (b"0,0,0\x000,0,0\n" * 20, "CSV text"),
    "one endless field": (b'"' + b"1," * 99999, "CSV text"),
}


@pytest.mark.parametrize(("data", "words"), FILES.values(), ids=FILES)
def test_file_that_is_no_log_is_one_line(data, words, tmp_path, capsys):
    path = written(tmp_path)
    path.unlink() if data is None else path.write_bytes(data)
    err = said(capsys, "replay", path, "optiodom_diff")
    assert words in err and str(path) in err


def test_folders_without_logs_and_logs_that_no_map_knows_are_one_line(tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    assert "holds no CSV file" in said(capsys, "replay", tmp_path / "empty", "optiodom_diff")
    path = written(tmp_path / "alone", metadata=None)
    known = "no map recognises it (known are laconic, optiodom, rig, Robotino)"
    assert known in said(capsys, "replay", path, "optiodom_diff")
    assert "holds no log that a map recognises" in said(capsys, "replay", path.parent, "optiodom_diff")
    log = tmp_path / "cut.blf"
    log.write_bytes(b"LOGG" + bytes(300))
    assert "cut.blf" in said(capsys, "replay", log, "optiodom_diff")


MAPPED = {
    "an unknown unit": ('unit = "tick"', 'unit = "furlong"', "wheel_angle.unit: there is no unit 'furlong'"),
    "a unit of another kind": ("column = 1", 'column = 1\nunit = "mm"', "time.unit: there is no unit 'mm'"),
    "ticks without a turn": ('ticks_per_turn = "encRes"\n', "", "wheel_angle.ticks_per_turn: is missing"),
    "a gear below zero": ('"ngear"', "-2", "wheel_angle.gear_ratio: is -2; give a number above zero"),
    "a key that is none": ("header_lines = 0", "header_lines = 0\nscene = 'x'", "scene: is no known key here"),
    "a quantity that is none": ("[wheel_angle]", "[wheel_angles]", "wheel_angles: is no known key here"),
    "a column twice": ("columns = [2, 3, 4]", "columns = [2, 3, 3]", "pose.columns: names 3 twice"),
    "a column 0": ("column = 1", "column = 0", "time.column: holds 0"),
    "a column beyond": ("columns = [2, 3, 4]", "columns = [2, 3, 44]", "line 1: has 6 columns, no column 44"),
    "four columns of a pose": ("columns = [2, 3, 4]", "columns = [2, 3, 4, 5]", "pose.columns: has 4 entries; give 3"),
    "names without a line of names": ("column = 1", 'column = "t"', "the log has no line of names"),
    "a kind that is none": ('"increments"', '"differences"', "wheel_angle.kind: there is no 'differences'"),
    "a sign that is none": ('unit = "tick"', 'unit = "tick"\nsign = 2', "sign: holds a number that is neither"),
    "a separator of two": ("header_lines = 0", 'header_lines = 0\nseparator = ",,"', "separator: is ',,'"),
    "no metadata": ('[metadata]\nfile = "metadata.csv"', "", "takes 'encRes' from a metadata file"),
    "metadata that is not there": ('file = "metadata.csv"', 'file = "meta.csv"', "meta.csv: cannot be read"),
    "a wheel twice": ('unit = "tick"', 'unit = "tick"\nwheels = [1, 1]', "wheel_angle.wheels: is [1, 1]"),
    "no TOML": ("[time]", "[time", "is no valid TOML"),
    "columns for CAN": ("header_lines = 0", 'format = "can"\ndbc = "x.dbc"', "time: has a meaning only with format"),
    "a DBC without CAN": ("header_lines = 0", 'header_lines = 0\ndbc = "x.dbc"', "dbc: has a meaning only with format"),
    "a scale of 0": ('unit = "tick"', 'unit = "tick"\nscale = 0', "wheel_angle.scale: is 0"),
    "time by a scale of 0": ("column = 1", "column = 1\nscale = 0", "time.scale: is 0; give a factor above 0"),
    "a decimal that separates": ("header_lines = 0", 'header_lines = 0\ndecimal = ","', "decimal: is ',', which"),
    "half a wheel": ('unit = "tick"', 'unit = "tick"\nwheels = [1, 2.5]', "wheel_angle.wheels: is [1, 2.5]"),
}


@pytest.mark.parametrize(("old", "new", "words"), MAPPED.values(), ids=MAPPED)
def test_map_that_cannot_be_used_is_one_line(old, new, words, tmp_path, capsys):
    log, mapped = written(tmp_path), tmp_path / "map.toml"
    mapped.write_text((MAPS / "optiodom.toml").read_text().replace(old, new))
    assert words in said(capsys, "replay", log, "optiodom_diff", "--map", mapped)


def test_every_map_of_the_project_can_be_read_and_names_itself():
    assert [each.name for each in project_maps()] == ["laconic", "optiodom", "rig", "Robotino"]
    with pytest.raises(BadInput, match="cannot be read"):
        read_map(MAPS / "nothing.toml")


def test_inputs_that_a_log_does_not_have_are_refused_by_name(tmp_path, capsys):
    log = written(tmp_path)
    for inputs in ("currents", "voltages", "set-speeds"):
        assert f"--inputs {inputs}" in said(capsys, "replay", log, "optiodom_diff", "--inputs", inputs)


def test_ticks_gear_signs_and_order_bring_a_log_to_the_scenes_wheels(tmp_path):
    path = written(tmp_path)
    (log,), _ = gather_logs([path])
    assert log.wheel_angle_rad[-1] == pytest.approx(np.array([104.0, 104.0]) * np.pi * 2 / 64 / 43.7, rel=0.02)
    mapped = tmp_path / "map.toml"
    mapped.write_text((MAPS / "optiodom.toml").read_text().replace('"ngear"', "43.7\nwheels = [2, 1]\nsigns = [1, -1]"))
    (turned,), _ = gather_logs([path], mapped)
    assert np.array_equal(turned.wheel_angle_rad[:, 0], -log.wheel_angle_rad[:, 1])
    assert np.array_equal(turned.wheel_angle_rad[:, 1], log.wheel_angle_rad[:, 0])


def test_a_log_packed_by_gzip_is_the_log(tmp_path):
    plain, packed = written(tmp_path), tmp_path / "run-02.csv.gz"
    packed.write_bytes(gzip.compress(plain.read_bytes()))
    (one, other), _ = gather_logs([tmp_path])
    assert np.array_equal(one.wheel_angle_rad, other.wheel_angle_rad) and np.array_equal(one.pose, other.pose)
