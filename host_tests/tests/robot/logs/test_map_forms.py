"""Maps that say what logs are: instants in two columns or as dates, quaternions, speeds on the ground, trackers beside
the middle, lines with keywords, several sensors for one quantity; and `laconic logs`, which guesses them."""

from __future__ import annotations

import json
import math
from datetime import datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.robot.logs import gather_logs
from log_support import HEAD, RADIUS_M, SCENE, TEXT_MAP, csv, mapped, motion, path_error, refused_log, replayed
from recorded_data import recorded

FIRST_NS = 1_700_000_000_123_456_789
EXACT = 1e-7
MOCAP = recorded("mecanum_mocap")


def text_map(**changes: str) -> str:
    """The usual map, with other lines for some of its tables."""
    found = TEXT_MAP
    for name, lines in changes.items():
        head, _, rest = found.partition(f"[{name}]\n")
        old = rest.partition("[")[0] if "[" not in rest.split("\n")[0] else rest
        old = rest.split("\n", 1)[0] + "\n"
        found = f"{head}[{name}]\n{lines}\n{rest.removeprefix(old)}"
    return found


def rows_with(instants: list[list[object]], rows: np.ndarray | None = None) -> list[list[object]]:
    rows = motion() if rows is None else rows
    return [[*instant, *row[1:]] for instant, row in zip(instants, rows.tolist(), strict=True)]


def stamps() -> list[int]:
    return [FIRST_NS + round(1e9 * time) for time in motion()[:, 0]]


INSTANTS = {
    "seconds and nanoseconds": (["sec", "nsec"], 'columns = ["sec", "nsec"]',
                                lambda ns: [ns // 10**9, ns % 10**9]),
    "seconds and microseconds": (["sec", "usec"], 'columns = ["sec", "usec"]\nunits = ["s", "us"]',
                                 lambda ns: [ns // 10**9, f"{ns % 10**9 / 1e3:.3f}"]),
    "nanoseconds since 1970": (["stamp"], 'column = "stamp"\nunit = "ns"', lambda ns: [ns]),
    "a date with an offset": (["when"], 'column = "when"\nunit = "iso"', lambda ns: [
        (datetime(2024, 5, 31, 23, 59, 58, tzinfo=timezone(timedelta(hours=2)))
         + timedelta(microseconds=(ns - FIRST_NS) / 1e3)).isoformat()]),
    "date and time of day": (["date", "clock"], 'columns = ["date", "clock"]\nunit = "iso"', lambda ns: [
        "2024-02-28", f"23:59:{(ns - FIRST_NS) / 1e9:09.6f}"]),
}


@pytest.mark.parametrize("form", INSTANTS)
def test_instants_of_every_form_keep_all_digits(form, tmp_path, capsys):
    names, lines, cells = INSTANTS[form]
    log = csv(tmp_path / "run.csv", rows_with([cells(ns) for ns in stamps()]), [*names, *HEAD[1:]])
    mapping = mapped(tmp_path, text_map(time=lines))
    assert path_error(capsys, log, mapping) < EXACT
    (read,), _ = gather_logs([log], mapping)
    assert np.abs(read.time_s - motion()[:, 0]).max() < 1e-6


@pytest.mark.parametrize("form", ["seconds and nanoseconds", "a date with an offset"])
def test_an_instant_that_is_none_is_named_by_its_line(form, tmp_path, capsys):
    names, lines, cells = INSTANTS[form]
    instants = [cells(ns) for ns in stamps()]
    instants[7][-1] = "soon"
    log = csv(tmp_path / "run.csv", rows_with(instants), [*names, "left", "right", "x", "y", "yaw"])
    assert "line 9: no " in refused_log(capsys, log, mapped(tmp_path, text_map(time=lines)))


def quaternions(order: str) -> tuple[list[str], list[list[float]]]:
    rows = motion()
    none, half = np.zeros(len(rows)), rows[:, 5] / 2
    parts = {"x": none, "y": none, "z": np.sin(half), "w": np.cos(half)}
    return [f"q{part}" for part in order], np.column_stack([rows[:, :5], *(parts[part] for part in order)]).tolist()


@pytest.mark.parametrize("order,lines", [("xyzw", ""), ("wxyz", 'quaternion = "wxyz"'), ("zw", 'quaternion = "zw"')])
def test_a_quaternion_is_a_heading(order, lines, tmp_path, capsys):
    names, rows = quaternions(order)
    log = csv(tmp_path / "run.csv", rows, ["t", "left", "right", "x", "y", *names])
    columns = ", ".join(f'"{name}"' for name in ("x", "y", *names))
    found = replayed(capsys, log, mapped(tmp_path, text_map(pose=f"columns = [{columns}]\n{lines}")))
    assert found["runs"][0]["path_error"] < EXACT and found["runs"][0]["heading_error_rad"] < EXACT


def test_a_quaternion_with_seconds_and_nanoseconds_is_guessed_and_replays(tmp_path, capsys):
    names, rows = quaternions("xyzw")
    cells = [[ns // 10**9, ns % 10**9, *row[1:]] for ns, row in zip(stamps(), rows, strict=True)]
    head = ["header.stamp.sec", "header.stamp.nanosec", "left_wheel_rad", "right_wheel_rad", "pose.position.x",
            "pose.position.y", *(f"pose.orientation.{name[1]}" for name in names)]
    log = csv(tmp_path / "run.csv", cells, head)
    mapping = tmp_path / "guessed.toml"
    assert run(["logs", str(log), "--scene", SCENE, "-o", str(mapping)]) == 0
    assert "missing" not in capsys.readouterr().out
    assert path_error(capsys, log, mapping) < EXACT


def test_a_quaternion_of_no_length_or_of_a_robot_on_its_side_is_told(tmp_path, capsys):
    names, rows = quaternions("xyzw")
    head, pose = ["t", "left", "right", "x", "y", *names], text_map(pose='columns = ["x", "y", "qx", "qy", "qz", "qw"]')
    lying = [[*row[:5], 0.7 * row[8], 0.0, row[7], 0.7 * row[8]] for row in rows]
    found = replayed(capsys, csv(tmp_path / "run.csv", lying, head), mapped(tmp_path, pose))
    assert any("pose leans by up to 90°" in each for each in found["remarks"])
    rows[5][5:] = [0, 0, 0, 0]
    log = csv(tmp_path / "run.csv", rows, head)
    assert "line 7: the quaternion of pose is 0 in all parts" in refused_log(capsys, log, mapped(tmp_path, pose))


def speeds(factor: float) -> np.ndarray:
    """The same motion by speeds of the wheels, which are constant."""
    rows = motion()
    wheels = [np.full(len(rows), factor * column[-1] / rows[-1, 0]) for column in rows.T[1:3]]
    return np.column_stack([rows[:, 0], *wheels, rows[:, 3:]])


SPEEDS = {"m/s": RADIUS_M, "mm/s": 1e3 * RADIUS_M, "km/h": 3.6 * RADIUS_M, "rad/min": 60.0, "rpm": 60.0 / math.tau,
          "tick/s": 2048 / math.tau}


@pytest.mark.parametrize("unit", SPEEDS)
def test_speeds_of_wheels_in_every_unit_are_angles_a_second(unit, tmp_path, capsys):
    log = csv(tmp_path / "run.csv", speeds(SPEEDS[unit]))
    more = "\nticks_per_turn = 2048" if unit == "tick/s" else ""
    text = TEXT_MAP.replace("[wheel_angle]\n", f'[wheel_speed]\nunit = "{unit}"{more}\n')
    found = replayed(capsys, log, mapped(tmp_path, text))
    assert found["runs"][0]["path_error"] < 1e-6
    assert any("scene's radius of 0.033 m" in each for each in found["remarks"]) == (unit in ("m/s", "mm/s", "km/h"))


def test_the_radius_of_the_robots_own_software_makes_angles_of_metres(tmp_path, capsys):
    rows = motion()
    rows[:, 1:3] *= 0.03
    text = TEXT_MAP.replace("[wheel_angle]\n", '[wheel_angle]\nunit = "m"\nradius_m = 0.03\n')
    assert path_error(capsys, csv(tmp_path / "run.csv", rows), mapped(tmp_path, text)) < EXACT
    wrong = text.replace('unit = "m"\n', "")
    refusal = refused_log(capsys, tmp_path / "run.csv", mapped(tmp_path, wrong))
    assert "radius_m: has a meaning for lengths alone" in refusal


@pytest.mark.parametrize("has_heading", [True, False])
def test_a_tracker_beside_the_middle_is_brought_to_the_robot(has_heading, tmp_path, capsys):
    rows, (x, y, turn) = motion(), (0.2, -0.1, math.radians(30.0))
    cos, sin = np.cos(rows[:, 5]), np.sin(rows[:, 5])
    rows[:, 3:] += np.column_stack([cos * x - sin * y, sin * x + cos * y, np.full(len(rows), turn)])
    mount = f"mount = {{ x_m = 0.2, y_m = -0.1{', heading_deg = 30' if has_heading else ''} }}"
    columns = '["x", "y", "yaw"]' if has_heading else '["x", "y"]'
    log = csv(tmp_path / "run.csv", rows)
    assert path_error(capsys, log, mapped(tmp_path, text_map(pose=f"columns = {columns}\n{mount}"))) < EXACT
    assert path_error(capsys, log, mapped(tmp_path, text_map(pose=f"columns = {columns}"))) > 1e-3


def test_a_late_tracker_is_brought_to_its_instants(tmp_path, capsys):
    time = 0.02 * np.arange(300)
    angle = 3.0 * (1.0 - np.cos(time))
    late = 3.0 * (1.0 - np.cos(np.maximum(time - 0.14, 0.0)))
    rows = np.column_stack([time, angle, angle, RADIUS_M * late, 0.0 * time, 0.0 * time])
    log = csv(tmp_path / "run.csv", rows)
    pose = 'columns = ["x", "y", "yaw"]'
    assert path_error(capsys, log, mapped(tmp_path, text_map(pose=f"{pose}\nlag_s = 0.14"))) < 1e-4
    assert path_error(capsys, log, mapped(tmp_path, text_map(pose=pose))) > 1e-3


def test_lines_with_keywords_are_logs_of_several_sensors(tmp_path, capsys):
    lines = ["# a robot", "INFO,started"]
    for time, left, right, x, y, yaw in motion().tolist():
        lines += [f"ENC,{time:.4f},{left:.9f},{right:.9f}", f"POSE,{time + 0.01:.4f},0,0,{x:.9f},{y:.9f},{yaw:.9f}"]
    log = tmp_path / "run.csv"
    log.write_text("\n".join(lines) + "\n")
    text = ("header_lines = 0\nkeyword_column = 1\n[time]\ncolumn = 2\n[wheel_angle]\nrows = \"ENC\"\ncolumns = [3, "
            "4]\n[pose]\nrows = \"POSE\"\ncolumns = [5, 6, 7]\n")
    assert path_error(capsys, log, mapped(tmp_path, text)) < 1e-6  # 10 ms late on a circle is another first pose
    assert "no line has 'ENK' in column 1; correct rows in the map (the lines have" in refused_log(
        capsys, log, mapped(tmp_path, text.replace('"ENC"', '"ENK"')))
    assert run(["logs", str(log)]) == 0
    assert "keyword_column = 1" in capsys.readouterr().out


def test_several_sensors_of_one_quantity_are_averaged_and_compared(tmp_path, capsys):
    rows = motion()
    noise = 0.01 * np.sin(37.0 * rows[:, 0])
    table = np.column_stack([rows[:, 0], rows[:, 1] + noise, rows[:, 1] - noise + 5.0, rows[:, 2:]])
    log = csv(tmp_path / "run.csv", table, ("t", "left a", "left b", "right", "x", "y", "yaw"))
    text = text_map(wheel_angle='columns = [["left a", "left b"], "right"]')
    found = replayed(capsys, log, mapped(tmp_path, text))
    assert found["runs"][0]["path_error"] < 1e-5
    assert any("the mean of 2 sensors, which differ by at most 0.02" in each for each in found["remarks"])


def test_latitude_and_longitude_are_positions(tmp_path, capsys):
    rows, earth_m = motion(), 6378137.0
    size = 1.0 - 6.69437999014e-3 * math.sin(math.radians(-33.0)) ** 2
    north = np.degrees(rows[:, 4] / (earth_m * (1.0 - 6.69437999014e-3) / size**1.5))
    east = np.degrees(rows[:, 3] / (earth_m / math.sqrt(size) * math.cos(math.radians(-33.0))))
    log = csv(tmp_path / "run.csv", np.column_stack([rows[:, :3], -33.0 + north, 151.0 + east]),
              ("t", "left", "right", "lat", "lon"))
    text = text_map(pose='columns = ["lat", "lon"]\nunits = ["latitude", "longitude"]')
    assert path_error(capsys, log, mapped(tmp_path, text)) < 1e-5
    assert run(["logs", str(log)]) == 0
    assert 'units = ["latitude", "longitude"]' in capsys.readouterr().out


@pytest.mark.parametrize("lines,words", [
    ('columns = ["x", "y", "yaw", "t"]', "has 4 entries"),
    ('columns = ["x", "y"]\nquaternion = "zw"', "quaternion: is zw, which needs 4 columns"),
    ('columns = ["x", "y", "yaw"]\nmount = { x = 1 }', "x: is no known key here"),
    ('columns = ["x", "y", "yaw"]\nkind = "increments"\nlag_s = 0.1', "lag_s: has a meaning for absolute poses"),
    ('columns = ["x", "y", "yaw"]\nrows = "A"', "needs keyword_column"),
    ('columns = [["x", "y"], "yaw"]\nunits = ["latitude", "m"]', "there is no unit"),
])
def test_a_map_that_contradicts_itself_is_one_line(lines, words, tmp_path, capsys):
    log = csv(tmp_path / "run.csv", motion())
    assert words in refused_log(capsys, log, mapped(tmp_path, text_map(pose=lines)))


GUESSED = [
    (("time_s", "enc_fl", "enc_fr", "enc_rl", "enc_rr"), "wheel_angle", "tick"),
    (("t [ms]", "v_left", "v_right"), None, None),
    (("timestamp", "motor_speed_left_rpm", "motor_speed_right_rpm"), "wheel_speed", "rpm"),
    (("t", "wheel_speed_left_m_per_s", "wheel_speed_right_m_per_s"), "wheel_speed", "m/s"),
    (("t", "joint[0].pos_rad", "joint[1].pos_rad"), "wheel_angle", "rad"),
    (("t", "cmd_speed_l", "cmd_speed_r"), "set_speed", "rad/s"),
    (("t", "current_left_A", "current_right_A"), "current", "A"),
]


@pytest.mark.parametrize("names,quantity,unit", [each for each in GUESSED if each[1]])
def test_columns_of_wheels_are_known_by_their_names(names, quantity, unit, tmp_path, capsys):
    count = np.arange(50.0)
    columns = [0.02 * count, *(np.round(7 * count) + k for k in range(len(names) - 1))]
    log = csv(tmp_path / "run.csv", np.column_stack(columns), names)
    assert run(["logs", str(log), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["map"]
    assert found[quantity]["columns"] == list(names[1:]) and found[quantity]["unit"] == unit
    assert found["time"]["column"] == names[0]


@pytest.mark.parametrize(("bits", "ticks_per_row"), [(8, 12.75), (8, 20.4), (8, 25.0), (9, 17.0), (11, 68.0),
                                                     (16, 900.0)])
@pytest.mark.parametrize("least", [0, -1], ids=["from 0", "signed"])
def test_a_fast_counter_is_guessed_with_its_size(bits: int, ticks_per_row: float, least: int, tmp_path, capsys):
    size = 1 << bits
    counts = [int(ticks_per_row * row) % size for row in range(400)]
    if least:
        counts = [count - size if count >= size // 2 else count for count in counts]
    rows = [f"{0.05 * row:.2f},{count},{count},{0.01 * row},0,0" for row, count in enumerate(counts)]
    log = tmp_path / "counts.csv"
    log.write_text("t,left,right,x,y,heading\n" + "\n".join(rows) + "\n", encoding="utf-8")
    assert run(["logs", str(log)]) == 0
    assert f"wrap = {size}\n" in capsys.readouterr().out


@pytest.mark.parametrize("scene", ["turtlebot3_burger", "mir_like", "robotino2"])
def test_a_log_of_simulate_is_recognised_and_its_written_map_replays(scene, tmp_path, capsys):
    log, mapping = tmp_path / "run.csv", tmp_path / "map.toml"
    assert run(["simulate", scene, "--out", str(log), "--inputs"]) == 0
    capsys.readouterr()
    assert run(["logs", str(log), "-o", str(mapping)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "note: the columns are signals of laconic simulate: no map needed by replay, identify and audit" in lines
    taken = {line.split()[0]: line for line in lines if "_rad_per_s[" in line or "velocity" in line or "hinge" in line}
    assert {name.partition("[")[0] for name, line in taken.items() if line.endswith("]") and " wheel_speed [" in line
            } == {"wheel_speed_rad_per_s"}
    assert run(["replay", str(log), scene, "--map", str(mapping), "--inputs", "wheel-speeds", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-4


def test_a_log_of_simulate_without_its_pose_has_no_wrong_wheels(tmp_path, capsys):
    names = ["time_s", "nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]", "velocity_body_m_per_s[1]",
             "velocity_body_m_per_s[2]", "hinge_angle_rad[left]", "hinge_angle_rad[right]",
             "wheel_speed_rad_per_s[1]", "wheel_speed_rad_per_s[2]"]
    log = csv(tmp_path / "part.csv", [[0.1 * row, *([0.2 * row] * 9)] for row in range(30)], names)
    assert run(["logs", str(log), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["map"]
    assert found["wheel_speed"]["columns"] == ["wheel_speed_rad_per_s[1]", "wheel_speed_rad_per_s[2]"]
    assert "wheel_angle" not in found


def test_a_log_of_a_map_of_the_project_is_read_by_that_map(tmp_path, capsys):
    names = ["t", *(f"m{wheel}{what}" for what in ("setvel", "pos", "vel", "cur") for wheel in (1, 2, 3)), "dx", "dy",
             "dang"]
    head = [";".join(names), ";".join(["ms"] + ["-"] * 15), ";".join(names)]
    rows = [";".join(map(str, [30 * row, *[row] * 15])) for row in range(30)]
    log, mapping = tmp_path / "gray.csv", tmp_path / "map.toml"
    log.write_text("\n".join([*head, *rows]) + "\n")
    assert run(["logs", str(log), "-o", str(mapping)]) == 0
    assert "note: the project's map robotino recognises this log: no map needed" in capsys.readouterr().out
    own, copy = gather_logs([log])[0][0], gather_logs([log], mapping)[0][0]
    assert np.array_equal(own.pose, copy.pose) and np.array_equal(own.wheel_angle_rad, copy.wheel_angle_rad)


def test_an_encoder_log_of_our_own_is_guessed_with_its_wrap(tmp_path, capsys):
    """Of 16 bits, as simulate writes it for a scene with such encoders."""
    rows = motion(400)
    ticks = np.round(rows[:, 1:3] * 20 * 4096 / math.tau)
    log = csv(tmp_path / "run.csv", np.column_stack([rows[:, 0], np.mod(ticks + 32768, 65536) - 32768, rows[:, 3:]]),
              ("time_s", "encoder_count[1]", "encoder_count[2]", "x_m", "y_m", "heading_rad"))
    mapping = tmp_path / "map.toml"
    assert run(["logs", str(log), "-o", str(mapping)]) == 0
    assert "missing: wheel_angle.ticks_per_turn" in capsys.readouterr().out
    text = mapping.read_text()
    assert "wrap = 65536" in text
    assert "ticks_per_turn: is missing" in refused_log(capsys, log, mapping)
    mapping.write_text(text.replace("wrap =", "ticks_per_turn = 4096\ngear_ratio = 20\nwrap ="))
    assert path_error(capsys, log, mapping) < 1e-4


@pytest.mark.skipif(not MOCAP.is_dir(), reason="recorded runs are not here")
def test_a_recorded_mecanum_base_is_guessed_up_to_its_ticks(tmp_path, capsys):
    mapping = tmp_path / "map.toml"
    assert run(["logs", str(MOCAP / "run1.csv"), "-o", str(mapping)]) == 0
    text = mapping.read_text()
    assert 'columns = ["ticks_front_left", "ticks_front_right", "ticks_rear_left", "ticks_rear_right"]' in text
    assert 'columns = ["x_m", "y_m", "yaw_rad"]' in text and "wheel_angle.ticks_per_turn" in capsys.readouterr().out
    assert Path(mapping).is_file()
