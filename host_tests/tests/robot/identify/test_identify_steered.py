"""`laconic identify` of robots with steered wheels: known values are found, gaps left out, broken logs refused."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.robot.identify import steered_evidence
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.steered_evidence import made_up
from laconic.robot.identify.study import identify
from laconic.robot.logs import Log
from laconic.robot.logs.log import Following
from laconic.robot.replay.missed_wraps import fitting
from laconic.robot.replay.rolling import path_of, rotations_of
from laconic.robot.replay.steered_rolling import SteeredRolling
from laconic.robot.replay.steered_signals import OfLog, driven, followed
from laconic.robot.replay.steered_slip import SteeredSlip
from laconic.scene import read_scene
from synthetic import steered_trials

PERIOD_S, LINES = 0.05, 400
TICKS, TRACTION_TICKS = 8192, 4096
TRICYCLE, CAR = "tricycle_agv", "f1tenth"
TRICYCLE_FREE = ("radius", "wheelbase", "steering-gain", "steering-offset", "place", "heading", "clock-lag")
MAP = """[time]
column = "t"
[wheel_angle]
columns = ["traction"]
unit = "tick"
ticks_per_turn = 4096
wrap = 65536
[steering_angle]
columns = ["steering"]
unit = "tick"
ticks_per_turn = 8192
wrap = 8192
[pose]
columns = ["x", "y", "yaw"]
"""
COMMANDS = """[time]
column = "t"
[speed]
column = "speed"
[steering_angle]
columns = ["steering"]
kind = "command"
[pose]
columns = ["x", "y", "yaw"]
"""


def made(name: str, free: tuple[str, ...], truth: dict[str, float], number: int = 0, lines: int = LINES) -> Log:
    """An exact run of a robot with other values than its scene: by encoders, or by commands."""
    scene, by_encoders = read_scene(name), name == TRICYCLE
    parameters = geometry_of(scene, free)
    values = np.array([truth.get(p.name, p.nominal) for p in parameters.each])
    time = PERIOD_S * np.arange(lines + 1)
    random = np.random.default_rng([7, number])
    steering = np.repeat(random.uniform(-0.4, 0.4, lines // 30 + 2), 30)[:len(time)]
    if by_encoders:
        steering = np.convolve(np.pad(steering, 10, mode="edge"), np.ones(21) / 21.0, mode="valid")
    like = Log(Path("x.csv"), "made up", time, steering_angle_rad=steering[:, None],
               following=Following(is_command=not by_encoders))
    log = made_up(scene, parameters.vehicle(scene.vehicle, values), like, time, steering, np.full(len(time), 0.8),
                  [0] if by_encoders else ())
    return replace(log, path=Path(f"/made-up/{number}/run.csv"))


def written(folder: Path, log: Log) -> Path:
    """The log as the file of a robot with counters, and its map."""
    assert log.pose is not None and log.steering_angle_rad is not None
    if log.wheel_angle_rad is None:
        assert log.speed_m_per_s is not None
        columns, text = [log.time_s, log.speed_m_per_s, log.steering_angle_rad[:, 0]], COMMANDS
        head = "t,speed,steering,x,y,yaw"
    else:
        traction = np.mod(np.round(log.wheel_angle_rad[:, 0] * TRACTION_TICKS / math.tau) + 65000.0, 65536.0)
        columns = [log.time_s, traction, np.mod(np.round(log.steering_angle_rad[:, 0] * TICKS / math.tau), TICKS)]
        text, head = MAP, "t,traction,steering,x,y,yaw"
    (folder / "map.toml").write_text(text)
    yaw = np.mod(log.pose[:, 2] + math.pi, math.tau) - math.pi
    rows = np.column_stack([*columns, log.pose[:, :2], yaw])
    lines = [head, *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    (folder / "run.csv").write_text("\n".join(lines) + "\n")
    return folder / "run.csv"


TRUTH = {"radius of wheel 1": 0.12, "wheelbase": 1.5, "gain of the steering": 0.9, "offset of the steering": -0.06,
         "place of the tracker, x": 1.2, "place of the tracker, y": 0.1, "heading of the tracker": 0.05,
         "lag of the tracker": 0.07}


def test_a_tricycle_with_counters_that_wrap_and_a_late_tracker_is_found_and_replayed_from_what_is_written(
        tmp_path, capsys):
    log = written(tmp_path, made(TRICYCLE, TRICYCLE_FREE, TRUTH))
    scene, again = tmp_path / "fitted.toml", tmp_path / "fitted_map.toml"
    assert run(["identify", str(log), "--scene", TRICYCLE, "--map", str(tmp_path / "map.toml"), "--free",
                ",".join(TRICYCLE_FREE), "-o", str(scene), "--map-out", str(again), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    values = {each["name"]: each["value"] for each in found["parameters"]}
    assert values == pytest.approx(TRUTH, rel=5e-3, abs=2e-3)
    assert "wheelbase: 1.5" in scene.read_text() and "gain of the steering: 0.9" in again.read_text()
    assert run(["replay", str(log), str(scene), "--map", str(again), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-3


CAR_TRUTH = {"gain of the steering": 0.7, "offset of the steering": 0.02, "lag of the steering": 0.12,
             "gain of the speed": 0.95, "place of the tracker, x": 0.15, "lag of the tracker": 0.04}


def test_a_car_by_commands_is_found_with_its_lags():
    free = ("steering-gain", "steering-offset", "steering-lag", "speed-gain", "place", "clock-lag")
    scene = read_scene(CAR)
    study = identify(scene, [made(CAR, free, CAR_TRUTH, number) for number in range(2)], geometry_of(scene, free))
    values = dict(zip((p.name for p in study.found.parameters.each), study.found.values, strict=True))
    assert {name: values[name] for name in CAR_TRUTH} == pytest.approx(CAR_TRUTH, rel=0.05, abs=5e-3)
    assert all(each.path_error is not None and each.path_error < 5e-3 for each in study.fitted)


def test_what_a_straight_run_cannot_tell_is_named_with_a_run_that_would():
    scene, free = read_scene(TRICYCLE), ("radius", "wheelbase")
    log = made(TRICYCLE, free, {})
    straight = np.zeros_like(log.steering_angle_rad)
    pose = np.column_stack([log.wheel_angle_rad[:, 0] * 0.12, *np.zeros((2, len(log.time_s)))])
    study = identify(scene, [replace(log, steering_angle_rad=straight, pose=pose)], geometry_of(scene, free))
    assert study.found.untold == ("wheelbase",)
    assert any(word.startswith("wheelbase: the runs do not tell it") and "one more run" in word for word in study.words)


def test_nothing_is_integrated_over_a_gap_and_a_remark_says_so():
    log = made(TRICYCLE, (), {})
    keep = np.r_[0:150, 220:len(log.time_s)]
    arrays = {key: getattr(log, key)[keep] for key in ("time_s", "wheel_angle_rad", "steering_angle_rad", "pose")}
    arrays["pose"][150:] += np.array([5.0, -3.0, 6.0 * math.pi])  # nobody saw what happened
    scene, free = read_scene(TRICYCLE), ("wheelbase",)
    study = identify(scene, [replace(log, **arrays), made(TRICYCLE, (), {}, 1)], geometry_of(scene, free),
                     leave_out="run")
    assert len(study.left_out) == 3 and all(each.path_error < 1e-3 for each in study.left_out)
    assert [each.run.rpartition("run")[2] for each in study.fitted] == [" part 1", " part 2", ""]
    assert all(each.path_error < 1e-3 for each in study.fitted)
    assert any("1 gap in it, the longest 3.55 s" in word for word in study.words)


def test_creep_of_tyres_explains_on_the_core_what_rolling_does_not():
    """Made with creep by the core, fitted from none: front and rear differ, so the car understeers with speed."""
    free = ("steering-gain", "creep")
    scene = read_scene(CAR)
    parameters = geometry_of(scene, free)
    vehicle = dict(scene.vehicle, ground={"friction_coefficient": scene.vehicle["friction_coefficient"]})
    del vehicle["friction_coefficient"]
    truth = np.array([0.8 if p.group == "steering-gain" else 0.15 if "steered" in p.name else 0.05
                      for p in parameters.each])
    true = replace(scene, vehicle=parameters.vehicle(vehicle, truth))
    logs = []
    for number, speed in enumerate((0.6, 1.8)):
        log = made(CAR, ("steering-gain",), {}, number, 160)
        log = replace(log, speed_m_per_s=np.full(len(log.time_s), speed), pose=np.zeros_like(log.pose))
        logs.append(replace(log, pose=SteeredSlip(true).path(log)))
    study = identify(scene, logs, parameters)
    without = study.without_slip
    assert without is not None
    assert study.found.values == pytest.approx(truth, rel=0.1)
    worst = [max(each.path_error for each in errors) for errors in (study.fitted, without.fitted)]
    assert worst[0] < 0.2 * worst[1]


def test_what_follows_a_held_command_does_so_as_small_steps_say():
    time = np.linspace(0.0, 1.0, 51)
    wanted = np.where(time < 0.3, 0.2, -0.5)
    for lag, limit in ((0.1, math.inf), (0.1, 2.0), (0.0, 2.0), (0.004, math.inf)):
        values, means = followed(time, wanted, 0.0, lag, limit)
        value, parts = 0.0, 4000
        for index in range(50):
            mean = 0.0
            for _ in range(parts):
                off = wanted[index] - value
                most = limit * 0.02 / parts if limit < math.inf else math.inf
                move = off * (1.0 - math.exp(-0.02 / parts / lag)) if lag else off
                value += min(max(move, -most), most)
                mean += value / parts
            assert values[index + 1] == pytest.approx(value, abs=2e-4)
            assert means[index] == pytest.approx(mean, abs=2e-4)


def test_steering_of_a_limited_rate_begins_where_the_wheels_are_whether_it_lags_a_little_or_not():
    log, first_rad = made(CAR, (), {}), -0.3
    assert log.steering_angle_rad is not None and log.steering_angle_rad[0, 0] > 0.0
    own = OfLog(rate_limit_rad_per_s=1.5)
    at_once, soon = (driven(log, replace(own, lag_s=lag_s), 4, first_rad).steering_rad[:, 0] for lag_s in (0.0, 1e-9))
    assert at_once[0] == first_rad
    assert at_once == pytest.approx(soon, abs=1e-6)


def test_the_search_for_lags_begins_inside_their_bound(monkeypatch):
    begun, solve = [], steered_evidence.least_squares
    monkeypatch.setattr(steered_evidence, "least_squares",
                        lambda residual, start, **more: begun.append(start) or solve(residual, start, **more))
    scene, free = read_scene(CAR), ("steering-lag", "speed-lag", "clock-lag")
    parameters = geometry_of(scene, free)
    identify(scene, [made(CAR, free, {}, lines=60)], parameters)
    lags = dict(zip((p.group for p in parameters.each), begun[0], strict=True))
    assert lags["steering-lag"] > 0.0 and lags["speed-lag"] > 0.0 and lags["clock-lag"] == 0.0


def test_95_percent_intervals_hold_the_truth_of_two_made_up_steered_robots():
    held = [each for trial in steered_trials(2, seed=2) for each in trial.held()]
    assert len(held) >= 15 and np.mean(held) > 0.8


@pytest.mark.nightly
def test_95_percent_intervals_hold_the_truth_in_93_to_97_percent_of_500_made_up_steered_robots():
    held = [each for trial in steered_trials(500, seed=1) for each in trial.held()]
    assert 0.93 <= np.mean(held) <= 0.97


def test_the_lag_of_a_tracker_is_found_for_robots_without_hinges():
    scene, late = read_scene("optiodom_diff"), 3
    swing = np.sin(0.1 * np.arange(300))
    moved = np.column_stack([0.02 * swing, np.zeros(300), 0.03 * np.roll(swing, 40)])
    moved[:late] = 0.0
    angle = np.vstack([np.zeros(2), np.cumsum(rotations_of(scene.core(), scene.vehicle, moved), axis=0)])
    path = path_of(moved, np.zeros(3))
    pose = np.vstack([path[:1]] * late + [path[:-late]])
    log = Log(Path("/made-up/run.csv"), "made up", PERIOD_S * np.arange(301), wheel_angle_rad=angle, pose=pose)
    study = identify(scene, [log], geometry_of(scene, ("radius", "clock-lag")))
    assert study.found.values[-1] == pytest.approx(late * PERIOD_S, abs=0.01)
    assert study.fitted[0].path_error < 1e-3


def test_parts_are_those_of_the_log_and_stay_parts():
    log = made(TRICYCLE, (), {})
    keep = np.r_[0:150, 220:300, 303:305, 330:len(log.time_s)]
    arrays = {key: getattr(log, key)[keep] for key in ("time_s", "wheel_angle_rad", "steering_angle_rad", "pose")}
    scene = read_scene(TRICYCLE)
    parts = fitting(scene, [replace(log, **arrays)])
    assert [len(part.time_s) for part in parts] == [150, 82, 71]
    assert len(fitting(scene, parts)) == 3


LOG = "run.csv"
BROKEN = {
    "no steering": (("map.toml", '[steering_angle]\ncolumns = ["steering"]\nunit = "tick"\nticks_per_turn = 8192\n'
                     'wrap = 8192\n', ""), "has no steering_angle_rad"),
    "no pose": (("map.toml", '[pose]\ncolumns = ["x", "y", "yaw"]\n', ""), "has no pose"),
    "no wheels": (("map.toml", '[wheel_angle]\ncolumns = ["traction"]\nunit = "tick"\nticks_per_turn = 4096\n'
                   'wrap = 65536\n', ""), "wheels"),
    "unknown column": (("map.toml", '"steering"]', '"steer"]'), "steer"),
    "unknown hinge": (("map.toml", "wrap = 8192", 'wrap = 8192\nhinges = ["rear"]'), "has no hinge rear"),
    "wrong unit": (("map.toml", 'columns = ["steering"]\nunit = "tick"', 'columns = ["steering"]\nunit = "volt"'),
                   "volt"),
    "wrap too small": (("map.toml", "wrap = 8192", "wrap = 512"), "more than wrap"),
    "wrap left out": (("map.toml", "wrap = 8192\n", ""), "jumps"),
    "ticks left out": (("map.toml", "ticks_per_turn = 8192\n", ""), "ticks_per_turn"),
    "negative lag": (("map.toml", "wrap = 8192", "wrap = 8192\nlag_s = -1"), "lag_s"),
    "no rate": (("map.toml", "wrap = 8192", "wrap = 8192\nrate_limit_rad_per_s = 0"), "rate_limit_rad_per_s"),
    "curve of one point": (("map.toml", "wrap = 8192", "wrap = 8192\ncurve = [[0.0, 0.0]]"), "curve"),
    "curve that turns back": (("map.toml", "wrap = 8192", "wrap = 8192\ncurve = [[0, 0], [1, 1], [0.5, 2]]"), "curve"),
    "curve of words": (("map.toml", "wrap = 8192", 'wrap = 8192\ncurve = [["a", 0], [1, 1]]'), "curve"),
    "unknown kind": (("map.toml", "wrap = 8192", 'wrap = 8192\nkind = "wish"'), "kind"),
    "unknown key": (("map.toml", "wrap = 8192", "wrap = 8192\ndelay = 1"), "delay"),
    "speed without a column": (("map.toml", "[pose]", '[speed]\nunit = "m/s"\n[pose]'), "speed.column"),
    "speed in an angle's unit": (("map.toml", "[pose]", '[speed]\ncolumn = "traction"\nunit = "rad"\n[pose]'), "rad"),
    "speed lag below zero": (("map.toml", "[pose]", '[speed]\ncolumn = "x"\nlag_s = -0.1\n[pose]'), "lag_s"),
    "speed scale of zero": (("map.toml", "[pose]", '[speed]\ncolumn = "x"\nscale = 0\n[pose]'), "scale"),
    "mount of a word": (("map.toml", '"yaw"]', '"yaw"]\nmount = { x_m = "a" }'), "x_m"),
    "time runs back": ((LOG, "\n0.2,", "\n0.02,"), "time does not grow"),
    "a word in a cell": ((LOG, "\n0.2,", "\n0.2x,"), "0.2x"),
    "an endless cell": ((LOG, "\n0.2,", "\n1e400,"), "line 6"),
    "too short": ((LOG, None, 6), "at least 10 samples"),
    "empty": ((LOG, None, 0), "run.csv"),
    "one line": ((LOG, None, 2), "at least 10 samples"),
    "all gaps": ((LOG, "gaps", 0), "between its"),
    "stands": ((LOG, "stands", 0), "no length"),
    "blank steering": ((LOG, "blank", 0), "is blank on all lines")}


@pytest.fixture(scope="module")
def tricycle_run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    written(folder, made(TRICYCLE, (), {}, lines=200))
    return folder


def broken(text: str, old: str | None, new: str | int) -> str:
    lines = text.splitlines()
    if old == "gaps":
        return "\n".join([lines[0], *(f"{i // 3 * 3.0 + 0.05 * (i % 3):.3f},{line.split(',', 1)[1]}"
                                      for i, line in enumerate(lines[1:]))]) + "\n"
    if old == "stands":
        first = lines[1].split(",", 1)[1]
        return "\n".join([lines[0], *(f"{0.05 * i:.3f},{first}" for i in range(60))]) + "\n"
    if old == "blank":
        return "\n".join([lines[0], *(",".join([*(cells := line.split(","))[:2], "", *cells[3:]])
                                      for line in lines[1:])]) + "\n"
    if old is None:
        return "\n".join(lines[:int(new)]) + "\n" * bool(new)
    assert old in text
    return text.replace(old, str(new), 1)


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_log_or_map_of_a_steered_robot_is_one_line(kind, tricycle_run, tmp_path, capsys):
    (name, old, new), words = BROKEN[kind]
    for each in (LOG, "map.toml"):
        text = (tricycle_run / each).read_text()
        (tmp_path / each).write_text(broken(text, old, new) if each == name else text)
    assert run(["identify", str(tmp_path / LOG), "--scene", TRICYCLE, "--map", str(tmp_path / "map.toml")]) == 2
    why = capsys.readouterr().err
    assert words in why and why.count("\n") == 1 and "Error" not in why


@pytest.mark.parametrize(("more", "words"), [
    (["--free", "distance"], "is not found for vehicles with hinges"),
    (["--free", "steering-curve,steering-gain"], "take one of them"),
    (["--free", "trail"], "leave it out"), (["--free", "wheelbas"], "wheelbase")])
def test_parameters_that_the_robot_has_not_are_refused_in_one_line(more, words, tricycle_run, capsys):
    assert run(["identify", str(tricycle_run / LOG), "--scene", TRICYCLE, "--map", str(tricycle_run / "map.toml"),
                *more]) == 2
    why = capsys.readouterr().err
    assert words in why and why.count("\n") == 1


@pytest.mark.parametrize(("free", "remedy"), [
    ("wheelbase", "take distance"), ("track", "take distance"), ("trail", "leave it out"), ("creep", "leave it out")])
def test_steered_parameters_are_refused_for_a_robot_without_hinges_with_the_one_to_take(free, remedy, tricycle_run,
                                                                                       capsys):
    assert run(["identify", str(tricycle_run / LOG), "--scene", str(scene_path("turtlebot3_burger")), "--map",
                str(tricycle_run / "map.toml"), "--free", free]) == 2
    assert f"has none; {remedy}" in capsys.readouterr().err


def test_ticks_and_uneven_lines_make_no_wheel_slip_on_the_core():
    """Held to each tick the driven wheel would slip at every line and stay behind by some per cent."""
    scene, log = read_scene(TRICYCLE), made(TRICYCLE, (), {})
    tick = math.tau / 150.0
    rough = replace(log, wheel_angle_rad=tick * np.round(log.wheel_angle_rad / tick))
    vehicle = {**scene.vehicle, "ground": {"friction_coefficient": 0.6}}
    del vehicle["friction_coefficient"]
    slid = SteeredSlip(replace(scene, vehicle=vehicle)).path(rough)
    off, rolled = slid - SteeredRolling(scene).path(rough), 0.8 * log.time_s[-1]
    assert np.hypot(off[:, 0], off[:, 1]).max() < 0.01 * rolled
