"""`laconic replay`: column maps, rolling, friction fits on made-up runs with known friction, the real robot's runs."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from bag_support import pose_at, scene_of, wheels_at
from laconic.cli import main as cli
from laconic.errors import BadInput
from laconic.robot.replay import report
from laconic.robot.replay.compare import block_mean, compare, predicted_speeds, rolled
from laconic.robot.replay.friction import MODELS, Friction, fit, parameter_names, torque_per_ampere
from laconic.robot.replay.log import DEFAULT_MAP, read_log, read_map
from laconic.robot.replay.runs import compare_all, gather
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.analyse.from_core import subject_of
from recorded_data import recorded

RECORDED = recorded("robotino")
needs_records = pytest.mark.skipif(not (RECORDED / "gray_exp00.csv").exists(),
                                   reason=f"no recorded Robotino runs at {RECORDED}: they are not part of the project")
TICKS_PER_RAD = 1.0 / 1.989e-4
TRUE = {"damping": 0.04, "torque": np.array([0.5, 0.3, 0.4]), "drag": 12.0}
HEAD = ["t", "xsetspeed", "ysetspeed", "setvel", "m1setvel", "m2setvel", "m3setvel", "m1pos", "m2pos", "m3pos",
        "m1vel", "m2vel", "m3vel", "m1cur", "m2cur", "m3cur", "xcur", "ycur", "rotcur", "xpos", "ypos", "ang",
        "dx", "dy", "dang"]


@pytest.fixture(scope="module")
def robot():
    return subject_of(read_scene("robotino2"))


def made_up_run(robot, path: Path, direction_deg: float, speed: float, drag: float, slip: float = 1.0) -> Path:
    """A robot with known friction under a speed controller, written as the real one's logs are."""
    core, angle = robot.core, np.radians(direction_deg)
    vehicle = core.ffi.new("laconic_vehicle *", robot.vehicle[0])
    vehicle.motor_gain_Nm_per_V, vehicle.motor_damping_Nms = 0.0, TRUE["damping"]
    plant, rows = core.plant(vehicle, EXPLICIT, 0.001), robot.matrices.wheel_rows
    wanted = rows @ np.array([np.cos(angle), np.sin(angle), 0.0]) * speed / 0.04
    share, per_ampere, step, lines, last = np.linalg.inv(rows), torque_per_ampere(robot), 0.001, [], np.zeros(2)
    held = core.input()
    torques = np.frombuffer(core.ffi.buffer(held.axle_torque_Nm), core.dtype)[: len(rows)]
    for k in range(5000):
        wheel = plant.wheel_speeds()
        torque = np.clip(3.0 * (wanted - wheel), -2.5, 2.5)
        torque = np.where(np.abs(wanted) > 1e-9, torque, 0.0)
        if k % 25 == 0:
            pose, now = plant.pose, np.array([plant.pose.x_m, plant.pose.y_m])
            moved = (now - last) / slip
            last = now
            lines.append([k * step * 1e3, speed * np.cos(angle), speed * np.sin(angle), 0.0, *(16 * wanted),
                          *(plant.wheel_angles() * TICKS_PER_RAD), *(16 * wheel), *np.abs(torque / per_ampere),
                          0, 0, 0, 0, 0, 0, *(1e3 * _into_body(moved, pose.heading_rad)), 0.0])
        travel = 0.04 * share[:2] @ wheel
        size = np.hypot(*travel)
        friction = TRUE["torque"] * np.tanh(wheel / 0.3)
        friction = friction + share[:2].T @ (0.04 * drag * travel / max(size, 1e-12) * np.tanh(size / 0.01))
        torques[:] = torque - friction
        plant.run(held)
    with path.open("w", newline="") as file:
        writer = csv.writer(file, delimiter=";")
        writer.writerows([HEAD, HEAD, HEAD, *lines])
    return path


def _into_body(moved, heading):
    return np.array([np.cos(heading) * moved[0] + np.sin(heading) * moved[1],
                     -np.sin(heading) * moved[0] + np.cos(heading) * moved[1]])


@pytest.fixture(scope="module")
def folder(robot, tmp_path_factory):
    place = tmp_path_factory.mktemp("runs")
    runs = [(20, 0.1), (75, 0.2), (130, 0.3), (200, 0.15), (255, 0.25), (310, 0.1)]
    for number, (direction, speed) in enumerate(runs):
        made_up_run(robot, place / f"run{number}.csv", direction, speed, TRUE["drag"])
    return place


@pytest.fixture(scope="module")
def runs(folder):
    return [read_log(path, read_map(DEFAULT_MAP)) for path in sorted(folder.glob("*.csv"))]


def test_column_map_brings_everything_to_the_wheel_and_to_si(robot, runs):
    run = runs[0]
    assert run.time_s[-1] == pytest.approx(4.975)
    assert run.smooth_speed_rad_per_s[-20:] == pytest.approx(run.wheel_speed_rad_per_s[-20:], abs=0.02)
    assert np.hypot(*run.camera[-1, :2]) == pytest.approx(rolled(robot, run).rolled_m, rel=1e-3)
    assert 0.3 < rolled(robot, run).rolled_m < 0.5


def test_sign_of_a_current_is_that_of_the_set_speed(runs):
    for run in runs:
        assert (np.sign(run.current_A[50:]) == np.sign(run.set_speed_rad_per_s[50:])).all()


def test_fit_finds_the_friction_that_was_put_in(robot, runs):
    found = fit(robot, runs, "dry and drag")
    assert found.part("damping_Nms") == pytest.approx(TRUE["damping"], abs=0.01)
    assert [found.part(f"dry_torque_Nm[{i}]") for i in (1, 2, 3)] == pytest.approx(TRUE["torque"], abs=0.03)
    assert found.part("drag_N") == pytest.approx(TRUE["drag"], abs=1.0)


def test_each_explanation_that_holds_another_fits_no_worse(robot, runs):
    residuals = [fit(robot, runs, model).residual_Nm for model in MODELS]
    assert residuals[0] > 2.0 * residuals[1]
    assert residuals[1] > 1.1 * residuals[2]


def test_confidence_interval_covers_the_truth_and_one_run_gives_none(robot, runs):
    found = fit(robot, runs, "dry and drag")
    truth = np.array([TRUE["damping"], *TRUE["torque"], TRUE["drag"]])
    assert (np.abs(found.values - truth) < found.half_widths + 0.03 * truth).all()
    assert np.isinf(fit(robot, runs[:1], "dry").half_widths).all()


def test_prediction_with_the_true_friction_follows_the_run(robot, runs):
    true = Friction("dry and drag", parameter_names(3, "dry and drag"),
                    np.array([TRUE["damping"], *TRUE["torque"], TRUE["drag"]]), np.zeros(5), 0.0)
    right = predicted_speeds(robot, runs[2], true, until_s=1.0)
    ideal = predicted_speeds(robot, runs[2], fit(robot, runs, "ideal"), until_s=1.0)
    window = runs[2].time_s < 1.0
    measured = runs[2].wheel_speed_rad_per_s
    errors = [np.sqrt(((speed - measured)[window] ** 2).mean()) for speed in (right, ideal)]
    assert errors[0] < 0.5
    assert errors[1] > 2.0 * errors[0]


def test_steady_currents_are_predicted_by_the_right_explanation_and_not_by_the_ideal_one(robot, runs):
    models = [fit(robot, runs[::2], model) for model in MODELS]
    judged = [compare(robot, run, models) for run in runs[1::2]]
    errors = np.array([[p.steady_error_A for p in c.predictions] for c in judged]).mean(axis=0)
    assert errors[2] < 0.05
    assert errors[0] > 4.0 * errors[2]


def test_rolled_over_camera_is_one_without_slip_and_the_slip_with_it(robot, tmp_path):
    for slip in (1.0, 1.5):
        path = made_up_run(robot, tmp_path / f"slip{slip}.csv", 40.0, 0.2, 0.0, slip)
        found = rolled(robot, read_log(path, read_map(DEFAULT_MAP)))
        assert found.ratio.value == pytest.approx(slip, rel=5e-3)
        assert found.direction_deg == pytest.approx(40.0, abs=0.1)
        assert found.speed_m_per_s == pytest.approx(0.2, rel=1e-3)


def test_block_mean_has_the_interval_of_students_t():
    time = np.arange(400) * 0.01
    values = np.repeat([1.0, 2.0, 3.0, 2.0], 100)
    found = block_mean(time, values)
    assert found.value == pytest.approx(2.0)
    assert found.half_width == pytest.approx(3.182446305284263 * np.std([1, 2, 3, 2], ddof=1) / 2.0)


def test_command_writes_report_and_pictures(folder, tmp_path, capsys):
    status = cli.run(["replay", str(folder), "robotino2", "--out", str(tmp_path / "out"), "--json"])
    found = json.loads(capsys.readouterr().out)
    assert status == 0
    assert found["fitted_on"] == ["run0", "run2", "run4"]
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"report.md", "report.json", "replay.png", "rolled.png", "currents.png"}
    assert "rolled / camera" in (tmp_path / "out" / "report.md").read_text()


def test_single_run_is_reported_as_fitted_and_judged_on_itself(folder, capsys):
    assert cli.run(["replay", str(folder / "run0.csv"), "robotino2"]) == 0
    assert "a fit, no prediction" in capsys.readouterr().out


@pytest.mark.parametrize(("spoil", "words"), [
    (lambda text: text.replace("m2pos", "elsewhere"), "has no column 'm2pos'"),
    (lambda text: "\n".join([*text.splitlines()[:9], text.splitlines()[9].replace("0", "zero")]), "line 10: no number"),
    (lambda text: text[:300], "has no samples"),
    (lambda text: "\n".join(text.splitlines()[:6]), "at least 10 samples"),
])
def test_log_that_cannot_be_used_is_one_clear_line(folder, tmp_path, capsys, spoil, words):
    path = tmp_path / "bad.csv"
    path.write_text(spoil((folder / "run0.csv").read_text()))
    status = cli.run(["replay", str(path), "robotino2"])
    err = [line for line in capsys.readouterr().err.splitlines() if line.startswith("laconic: ")]
    assert status == 2
    assert len(err) == 1
    assert "bad.csv" in err[0]
    assert words in err[0]


@pytest.mark.parametrize(("arguments", "words"), [
    (("nothing.csv", "robotino2"), "cannot be read"),
    (("RUN", "paper_three_wheel_driven"), "vehicle.motor"),
    (("RUN", "turtlebot3_burger"), "has 2 wheels"),
    (("RUN", "kuka_youbot"), "has 4 wheels"),
    (("RUN", "robotino2", "--map", "nothing.toml"), "cannot be read"),
    (("EMPTY", "robotino2"), "holds no CSV file"),
])
def test_bad_arguments_are_one_clear_line(folder, tmp_path, capsys, arguments, words):
    places = {"RUN": str(folder / "run0.csv"), "EMPTY": str(tmp_path)}
    status = cli.run(["replay", *(places.get(a, a) for a in arguments)])
    err = [line for line in capsys.readouterr().err.splitlines() if line.startswith("laconic: ")]
    assert status == 2
    assert len(err) == 1
    assert words in err[0]


@pytest.mark.parametrize(("old", "new", "words"), [
    ('separator = ";"', 'separator = ";;"', "separator: is ';;'; give one character"),
    ('columns = ["m1vel", "m2vel", "m3vel"]', "columns = []", "wheel_speed.columns: has 0 entries; give 3"),
    ('columns = ["m1setvel", "m2setvel", "m3setvel"]', "columns = []", "set_speed.columns: has 0 entries; give one"),
    ('columns = ["m1cur", "m2cur", "m3cur"]', 'columns = ["m1cur"]', "current.columns: has 1 entries; give 3"),
    ('columns = ["dx", "dy", "dang"]', 'columns = ["dx", "dy"]', "pose.columns: has 2 entries; give 3")])
def test_map_that_cannot_be_is_named_by_its_key(tmp_path, old, new, words):
    path = tmp_path / "map.toml"
    path.write_text(DEFAULT_MAP.read_text().replace(old, new))
    with pytest.raises(BadInput) as caught:
        read_map(path)
    assert f"{path}: {words}" in str(caught.value)


def test_map_with_an_unknown_key_names_it(tmp_path):
    path = tmp_path / "map.toml"
    path.write_text(DEFAULT_MAP.read_text().replace("names_line = 3", "names_line = 3\ncolour = 1"))
    with pytest.raises(BadInput, match="colour"):
        read_map(path)


# ---- the real robot


@pytest.fixture(scope="module")
def real_runs(robot):
    found, names, skipped = gather([RECORDED], ())
    return compare_all(robot, found, names, skipped, lambda *_, **__: None)


@needs_records
def test_robotino_wheels_roll_1_2_to_1_9_times_the_cameras_distance_in_every_run(real_runs):
    ratios = {c.recording.name: c.rolled.ratio for c in real_runs.comparisons}
    assert len(ratios) == 12
    assert all(1.2 < ratio.value < 1.9 and ratio.value - ratio.half_width > 1.0 for ratio in ratios.values())
    assert ratios["gray_exp72"].value > ratios["gray_exp90"].value + 0.3   # along x the wheels slip more than along y


@needs_records
def test_robotino_steady_currents_hardly_depend_on_speed(real_runs):
    along_y = {c.rolled.speed_m_per_s: c.steady_current_A[1].value for c in real_runs.comparisons
               if c.rolled.direction_deg == pytest.approx(90.0, abs=1.0)}
    assert len(along_y) == 3
    assert np.ptp(list(along_y.values())) < 0.1
    assert np.mean(list(along_y.values())) == pytest.approx(-1.08, abs=0.05)


@needs_records
def test_robotino_fitted_on_some_runs_dry_friction_predicts_the_others_currents_better(real_runs):
    assert set(real_runs.fitted_on).isdisjoint(c.recording.name for c in real_runs.judged())
    errors = np.array([[p.steady_error_A for p in c.predictions] for c in real_runs.judged()]).mean(axis=0)
    assert errors[1] < 0.7 * errors[0]
    assert errors[2] < 0.3 * errors[0]


@needs_records
def test_robotino_damping_does_not_differ_from_zero_once_dry_friction_is_allowed(real_runs):
    dry = real_runs.models[1]
    assert abs(dry.values[0]) < dry.half_widths[0]


@needs_records
def test_robotino_currents_alone_do_not_give_the_wheel_speeds_and_the_report_states_it(real_runs):
    shares = np.array([[p.transient_error_share for p in c.predictions] for c in real_runs.judged()]).mean(axis=0)
    assert shares.min() > 0.25
    assert any("small difference of large numbers" in sentence for sentence in report.in_words(real_runs))


@needs_records
def test_robotino_files_that_are_no_runs_are_named(real_runs):
    assert real_runs.skipped == ["motor_identification.csv"]


BAD_MAPS = {
    "signs": ("sign = -1\n", "with the signs of all wheels reversed it would be"),
    "one sign": ("signs = [1, -1]\n", "with the sign of wheel 2 reversed it would be"),
    "order": ("wheels = [2, 1]\n", "with wheels 1 and 2 exchanged it would be"),
    "ticks": ('unit = "tick"\nticks_per_turn = 12.566370614\n', "with wheels that turn 2 times as far (ticks_per_turn"),
    "nothing": ("scales = [3, -0.2]\noffset = 1\n", "check the scene, or in the map the order and signs")}


@pytest.mark.parametrize(("keys", "words"), BAD_MAPS.values(), ids=BAD_MAPS)
def test_a_poor_fit_is_called_poor_with_what_would_mend_it(keys, words, tmp_path, capsys):
    rows = [(0.02 * k, *wheels_at(0.02 * k), *pose_at(0.02 * k)) for k in range(200)]
    log, mapping = tmp_path / "run.csv", tmp_path / "map.toml"
    log.write_text("\n".join(["t,left,right,x,y,yaw", *(",".join(map(repr, row)) for row in rows)]) + "\n")
    text = '[time]\ncolumn = "t"\n[wheel_angle]\ncolumns = ["left", "right"]\n{}[pose]\ncolumns = ["x", "y", "yaw"]\n'
    for given, is_poor in (("", False), (keys, True)):
        mapping.write_text(text.format(given))
        assert cli.run(["replay", str(log), str(scene_of(tmp_path)), "--map", str(mapping), "--json"]) == 0
        remarks = json.loads(capsys.readouterr().out)["remarks"]
        assert sum("the fit is poor" in each for each in remarks) == is_poor
    assert words in remarks[0]
    assert cli.run(["replay", str(log), str(scene_of(tmp_path)), "--map", str(mapping)]) == 0
    assert f"**{remarks[0]}**" in capsys.readouterr().out
