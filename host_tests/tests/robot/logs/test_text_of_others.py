"""Text files as other programs and other accidents leave them: encodings, zero bytes, names that appear twice."""

from __future__ import annotations

import gzip
import sys

import numpy as np
import pytest

from laconic.base.text_file import NotText, decoded, text_of_file
from laconic.errors import BadInput
from laconic.robot.logs import gather_logs
from laconic.robot.logs.guess import guess_table, toml_text
from log_support import (
    CAN_MAP,
    DBC,
    TEXT_MAP,
    asc,
    asc_lines,
    csv,
    frames,
    mapped,
    motion,
    path_error,
    refused_log,
    replayed,
)

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ENCODINGS = {"UTF-8": lambda text: text.encode(), "UTF-8 with a mark": lambda text: text.encode("utf-8-sig"),
             "UTF-16 with a mark": lambda text: text.encode("utf-16"),
             "UTF-16, big end first": lambda text: b"\xfe\xff" + text.encode("utf-16-be"),
             "UTF-16 without a mark": lambda text: text.encode("utf-16-le"),
             "UTF-16 without a mark, big end first": lambda text: text.encode("utf-16-be"),
             "Western Windows": lambda text: text.encode("cp1252")}


@pytest.mark.parametrize("encoding", ENCODINGS.values(), ids=ENCODINGS)
def test_logs_maps_and_dbc_files_are_read_in_the_same_encodings(encoding, tmp_path, capsys):
    text_log = csv(tmp_path / "run.csv", motion(), ("t", "left", "right", "x", "y", "Höhe °"))
    text_map = mapped(tmp_path, TEXT_MAP.replace('"yaw"', '"Höhe °"'))
    for path in (text_log, text_map):
        path.write_bytes(encoding(path.read_text(encoding="utf-8")))
    assert path_error(capsys, text_log, text_map) < 1e-6
    can_log, can_map = asc(tmp_path / "run.asc", asc_lines(frames())), mapped(tmp_path, CAN_MAP + "# Höhe °\n")
    (tmp_path / "robot.dbc").write_text(DBC.replace('"rad"', '"°"'), encoding="utf-8")
    for path in (can_log, can_map, tmp_path / "robot.dbc"):
        path.write_bytes(encoding(path.read_text(encoding="utf-8")))
    assert path_error(capsys, can_log, can_map) < 1e-5


def test_a_dbc_with_comments_in_another_alphabet_is_read(tmp_path, capsys):
    mapping = mapped(tmp_path)
    (tmp_path / "robot.dbc").write_bytes(DBC.encode() + b'CM_ BO_ 257 "' + "轮子角度".encode("gbk") + b'";\n')
    assert path_error(capsys, asc(tmp_path / "run.asc", asc_lines(frames())), mapping) < 1e-5


# ---------------------------------------------------------------------------------------- zero bytes


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("lost", [0, 9])
def test_zero_bytes_after_a_loss_of_power_are_left_out_and_reported(lost, encoding, tmp_path, capsys):
    log = csv(tmp_path / "run.csv", motion())
    text = log.read_text()
    log.write_bytes(text[:len(text) - lost].encode(encoding) + bytes(4096))
    found = replayed(capsys, log, mapped(tmp_path, TEXT_MAP))
    assert found["runs"][0]["path_error"] < 1e-6
    cut = " and line 81, which they cut, are" if lost else " are"
    assert found["remarks"] == [f"run: ends in 4096 zero bytes, as after a loss of power; they{cut} left out"]
    (read,), _ = gather_logs([log], tmp_path / "map.toml")
    assert len(read.time_s) == 80 - bool(lost)


PLACES = {"in the first line": (3, "line 1 "), "in the middle": (400, "line "), "a whole block": (600, "line ")}


@pytest.mark.parametrize(("at", "words"), PLACES.values(), ids=PLACES)
def test_zero_bytes_within_a_log_are_named_by_their_line(at, words, tmp_path, capsys):
    log = csv(tmp_path / "run.csv", motion())
    data = log.read_bytes()
    log.write_bytes(data[:at] + bytes(64 if at == 600 else 1) + data[at:])
    error = refused_log(capsys, log, mapped(tmp_path, TEXT_MAP))
    line = data[:at].count(b"\n") + 1
    assert f"line {line} holds a zero byte" in error and words in error


def test_bytes_that_are_not_text_are_named_by_their_line(tmp_path, capsys):
    log = csv(tmp_path / "run.csv", motion())
    lines = log.read_bytes().split(b"\n")
    log.write_bytes(b"\n".join([*lines[:7], b"\x80\x81\x02" + lines[7], *lines[8:]]))
    assert "line 8 holds bytes that are not text" in refused_log(capsys, log, mapped(tmp_path, TEXT_MAP))
    mapping = mapped(tmp_path, TEXT_MAP)
    mapping.write_bytes(b"\n".join([b"name = 'x'", b"\x80\x81\x02"]))
    assert "map.toml: line 2 holds bytes that are not text; give a map" in refused_log(capsys, log, mapping)


def test_decoding_states_what_it_leaves_out():
    assert decoded(b"a\nb").text == "a\nb" and decoded(b"").text == ""
    assert decoded(b"a\n\0\0").zero_bytes == 2 and not decoded(b"a\n\0\0").is_cut and decoded(b"a\0").is_cut
    assert decoded("é\n".encode("utf-16") + b"\0").zero_bytes == 1
    assert decoded(bytes(100)).text == "" and decoded(bytes(100)).zero_bytes == 100
    with pytest.raises(NotText, match="line 2 holds a zero byte"):
        decoded(b"a\nb\0c")
    assert decoded(b"\x81\x02", is_lenient=True).text


def test_a_packed_file_of_several_parts_is_whole_and_a_broken_one_is_one_line(tmp_path):
    path = tmp_path / "run.csv.gz"
    path.write_bytes(gzip.compress(b"a\n") + gzip.compress(b"b\n") + bytes(10))
    assert text_of_file(path, "a log").lines == ["a", "b"]
    whole = gzip.compress(b"a\n" * 999)
    for data, words in ((whole[:-3], "its end is missing"), (whole + b"xyz", "other bytes follow"),
                        (whole[:10] + b"\xff" * 30, "is packed by gzip but broken"), (b"\x1f\x8b", "its end")):
        path.write_bytes(data)
        with pytest.raises(BadInput, match=words):
            text_of_file(path, "a log")


# ------------------------------------------------------------------------------------ names twice


def test_a_name_that_is_on_two_columns_is_refused_where_it_is_used_and_a_number_takes_one(tmp_path, capsys):
    rows = np.column_stack([motion(), np.zeros((80, 2))])
    log = csv(tmp_path / "run.csv", rows, ("t", "left", "right", "x", "y", "yaw", "left", "note"))
    error = refused_log(capsys, log, mapped(tmp_path, TEXT_MAP))
    assert "has the name 'left' (for wheel_angle) on the columns 2 and 7; give the number of the right one" in error
    assert path_error(capsys, log, mapped(tmp_path, TEXT_MAP.replace('["left",', "[2,"))) < 1e-6
    unused = csv(tmp_path / "run.csv", rows, ("t", "left", "right", "x", "y", "yaw", "note", "note"))
    assert path_error(capsys, unused, mapped(tmp_path, TEXT_MAP)) < 1e-6


def test_the_time_on_two_columns_and_numbered_names_on_two_columns_are_refused(tmp_path, capsys):
    rows = np.column_stack([motion(), np.zeros(80)])
    log = csv(tmp_path / "run.csv", rows, ("t", "left", "right", "x", "y", "yaw", "t"))
    mapping = mapped(tmp_path, TEXT_MAP)
    assert "has the name 't' (for time) on the columns 1 and 7" in refused_log(capsys, log, mapping)
    log = csv(tmp_path / "run.csv", rows, ("t", "w1", "w2", "x", "y", "yaw", "w2"))
    numbered = mapped(tmp_path, TEXT_MAP.replace('["left", "right"]', '"w#"'))
    assert "has the name 'w2' (for wheel_angle) on the columns 3 and 7" in refused_log(capsys, log, numbered)


def test_one_column_by_its_name_and_its_number_is_refused(tmp_path, capsys):
    log = csv(tmp_path / "run.csv", motion())
    error = refused_log(capsys, log, mapped(tmp_path, TEXT_MAP.replace('["left", "right"]', '["left", 2]')))
    assert "wheel_angle takes column 2 by its name and by its number" in error


def test_a_row_of_metadata_that_appears_twice_is_refused(tmp_path, capsys):
    (tmp_path / "meta.csv").write_text("gear,2\ngear,3\nother,1\nother,2\n")
    log = csv(tmp_path / "run.csv", motion())
    text = TEXT_MAP + '[metadata]\nfile = "meta.csv"\n'
    mapping = mapped(tmp_path, text.replace("[wheel_angle]", '[wheel_angle]\ngear_ratio = "gear"'))
    assert "meta.csv: has 2 rows 'gear'; keep one of them" in refused_log(capsys, log, mapping)


MAPS = {
    "scales and signs of two lengths": ("[wheel_angle]", "[wheel_angle]\nscales = [1, 1]\nsigns = [1, 1, 1]", "signs"),
    "an infinite gear": ("[wheel_angle]", "[wheel_angle]\ngear_ratio = inf", "wheel_angle.gear_ratio: is inf"),
    "a wheel beyond all": ("[wheel_angle]", "[wheel_angle]\nwheels = [1, 1000000000]", "wheel_angle.wheels: is"),
    "a quotation mark": ('name = "two wheels"', "separator = '\"'", "separator: is"),
    "a channel of text": ("[wheel_angle]", "[wheel_angle]\nchannel = 1", "wheel_angle.channel: has a meaning only"),
    "a number of thousands of digits": ('name = "two wheels"', f"header_lines = {'9' * 5000}", "thousands of digits"),
    "a scale beyond all numbers": ("[wheel_angle]", "[wheel_angle]\nscale = 1e308", "line 3: wheel_angle is too large"),
}


@pytest.mark.parametrize(("old", "new", "words"), MAPS.values(), ids=MAPS)
def test_a_map_with_numbers_that_cannot_be_is_one_line(old, new, words, tmp_path, capsys):
    log = csv(tmp_path / "run.csv", 100.0 * motion())
    assert words in refused_log(capsys, log, mapped(tmp_path, TEXT_MAP, change=[(old, new)]))


def test_scales_for_another_number_of_columns_than_the_log_has_are_named(tmp_path, capsys):
    log = csv(tmp_path / "run.csv", motion(), ("t", "w1", "w2", "x", "y", "yaw"))
    text = TEXT_MAP.replace('["left", "right"]', '"w#"\nscales = [1, 1, 1]')
    assert "wheel_angle.scales: has 3 entries for 2 columns; give one for each" in refused_log(
        capsys, log, mapped(tmp_path, text))


def test_a_guessed_map_has_the_columns_of_the_log_whatever_signs_their_names_have():
    t = np.arange(20.0)
    names = ['left "wheel" pos', "right \\wheel pos", "mocap\U000e0001 x", "mocap\U000e0001 y"]
    guess = guess_table({"time": 0.1 * t, **{name: t * t + k for k, name in enumerate(names)}}, {})
    found = tomllib.loads(toml_text(guess, 'the "log"'))
    assert found == {"name": 'the "log"', **guess.entries}
    assert found["pose"]["columns"] == names[2:] and found["wheel_angle"]["columns"] == names[:2]
