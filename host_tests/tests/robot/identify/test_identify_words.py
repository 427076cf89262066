"""What `laconic identify` says beside its numbers: advice, errors that repeat, poor fits, judgements that fail."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_runs import exact_run, found_from, simulated

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.robot.identify.fitted_toml import fitted_text
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.study import identify
from laconic.robot.identify.words import MOTIONS
from laconic.scene import read_scene
from synthetic import made_up

STEADY = {"ahead": (0.3, 0.0, 0.0), "left": (0.3, 0.0, 0.4), "right": (0.3, 0.0, -0.4)}


def noisy(log, random, size=1e-3):
    """The true pose as a camera that wanders sees it."""
    return replace(log, pose=log.pose + np.cumsum(size * random.standard_normal(log.pose.shape), axis=0))


def uncertainty(found, name):
    """Half width of a parameter; that of the prior where the runs do not tell it."""
    names = [p.name for p in found.parameters.each]
    assert found.asked is not None
    prior = {p.name: 2.0 * np.hypot(p.prior_sd, p.shared_sd) for p in found.asked.each}[name]
    return found.half_widths[names.index(name)] if name in names else prior


@pytest.mark.nightly
@pytest.mark.parametrize(("robot", "first"), [("optiodom_diff", "straight ahead"), ("kuka_youbot", "straight ahead")])
def test_no_other_motion_tells_more_than_the_one_that_is_advised(robot, first):
    scene, random = read_scene(robot), np.random.default_rng(8)

    def runs(name, number):
        return [noisy(exact_run(scene, scene.vehicle, MOTIONS[name], f"{name}{k}"), random) for k in range(number)]

    given = runs(first, 3)
    study = identify(scene, given, geometry_of(scene, ("radius", "distance")))
    (word,) = [each for each in study.words if each.startswith("distance of the wheels")]
    advised = word.partition("one more run, ")[2].partition(",")[0]
    possible = [name for name, velocity in MOTIONS.items() if robot != "optiodom_diff" or velocity[1] == 0.0]
    left = {name: uncertainty(found_from(scene, [*given, *runs(name, 1)], ("radius", "distance")),
                              "distance of the wheels") for name in possible if "spot" not in name}
    assert left[advised] < 1.3 * min(left.values())


def test_a_straight_run_of_an_omni_robot_is_completed_by_one_across_it():
    scene, random = read_scene("optiodom_omni3"), np.random.default_rng(5)
    ahead = [noisy(exact_run(scene, scene.vehicle, (0.3, 0.0, 0.0), str(i)), random) for i in range(3)]
    words = identify(scene, ahead, geometry_of(scene, ("radius",))).words
    assert any("radius of wheel 3" in word and "one more run, straight sideways" in word for word in words)


def with_slip_of_its_own(scene, path, random):
    """Wheels that slip a little in all of a run, more or less than in the others."""
    log = made_up(scene.core(), scene.vehicle, path, random)
    assert log.wheel_angle_rad is not None
    turned = np.diff(log.wheel_angle_rad, axis=0) * (1.0 + 0.01 * random.standard_normal(log.wheel_angle_rad.shape[1]))
    return replace(log, wheel_angle_rad=np.vstack([np.zeros(turned.shape[1]), np.cumsum(turned, axis=0)]))


@pytest.mark.parametrize("seeds", [4, pytest.param(8, marks=pytest.mark.nightly)])
def test_errors_that_repeat_are_named_and_widen_the_intervals_until_they_hold_the_truth(seeds):
    scene, held, plain, found = read_scene("optiodom_omni3"), [], [], []
    for seed in range(seeds):
        random = np.random.default_rng([seed, 3])
        logs = [with_slip_of_its_own(scene, Path(f"/made-up/{i}/run.csv"), random) for i in range(7)]
        fitted = found_from(scene, logs, ("radius", "distance"))
        off = np.abs(fitted.values - fitted.parameters.nominal)
        found.append(fitted.structure)
        held += list(off <= fitted.half_widths)
        plain += list(off <= 2.0 * np.sqrt(np.diag(fitted.covariance)))
    assert np.mean([each.is_found for each in found]) > 0.8
    assert np.mean(held) >= 0.9 > np.mean(plain)
    words = identify(scene, logs, geometry_of(scene, ("radius", "distance"))).words
    assert any("Neighbouring stretches of a run err alike" in word and "longer blocks" in word for word in words)


def test_errors_of_chance_are_not_called_repeated():
    scene, random = read_scene("optiodom_diff"), np.random.default_rng(11)
    logs = [made_up(scene.core(), scene.vehicle, Path(f"/made-up/{i}/run.csv"), random) for i in range(5)]
    found = found_from(scene, logs, ("radius", "distance"))
    assert not found.structure.is_found and found.structure.widening == 1.0


def test_a_poor_fit_and_a_session_that_spoils_the_others_are_named():
    scene, random = read_scene("optiodom_diff"), np.random.default_rng(6)
    logs = [made_up(scene.core(), scene.vehicle, Path(f"/made-up/day{i}/run.csv"), random) for i in range(4)]
    bent = replace(logs[0], pose=logs[0].pose * np.array([1.06, 0.94, 1.0]))
    words = identify(scene, [bent, *logs[1:]], geometry_of(scene, ("radius", "distance"))).words
    assert any(word.startswith("Session day0 fits far worse than the others") for word in words)
    mirrored = [replace(log, pose=log.pose * np.array([1.0, -1.0, -1.0])) for log in logs]
    words = identify(scene, mirrored, geometry_of(scene, ("radius", "distance"))).words
    assert any(word.startswith("The fit is poor: of") and "signs" in word for word in words)
    wrong = [replace(log, pose=log.pose * np.array([1000.0, 1000.0, 1.0])) for log in logs]  # mm taken for metres
    words = identify(scene, wrong, geometry_of(scene, ("radius", "distance"))).words
    assert words[0].startswith("The fit is poor: of") and "`laconic replay` with this map" in words[0]
    assert not any("poor" in word or "Session" in word for word in identify(
        scene, logs, geometry_of(scene, ("radius", "distance"))).words)


def test_values_that_are_worse_on_the_judged_runs_are_one_line_and_exit_status_1(tmp_path, capsys):
    fitted_to, other = simulated(tmp_path, "one", 0.0345), simulated(tmp_path, "other", 0.033)
    out = tmp_path / "fitted.toml"
    capsys.readouterr()
    assert run(["identify", str(fitted_to), "--scene", "turtlebot3_burger", "-o", str(out), "--judge", str(other)]) == 1
    printed = capsys.readouterr()
    assert "worse than the nominal ones: path error" in printed.err and printed.err.count("\n") == 1
    assert out.exists() and "worse than the nominal ones" in out.read_text()


def test_the_runs_of_the_fit_judge_nothing_and_it_is_said(tmp_path, capsys):
    one = simulated(tmp_path, "one", 0.0345)
    capsys.readouterr()
    assert run(["identify", str(one), "--scene", "turtlebot3_burger", "--judge", str(one)]) == 0
    assert "1 of the 1 runs to judge are runs of the fit (run.csv): that judges nothing" in capsys.readouterr().out


def test_a_scene_on_stdout_keeps_its_figures_as_comments_and_the_report_on_stderr(tmp_path, capsys):
    one, other = simulated(tmp_path, "one", 0.0345), simulated(tmp_path, "other", 0.0345)
    capsys.readouterr()
    assert run(["identify", str(one), "--scene", "turtlebot3_burger", "-o", "-", "--judge", str(other)]) == 0
    printed = capsys.readouterr()
    assert "#   fitted, on the runs to judge: 0.0" in printed.out and "wheel_radius_m" in printed.out
    assert "| fitted, on the runs to judge | 0.0" in printed.err


def test_a_value_at_its_bound_is_called_so():
    scene = read_scene("optiodom_diff")
    tiny = geometry_of(scene, ("radius",)).vehicle(scene.vehicle, np.array([0.0005, 0.0005]))
    logs = [exact_run(scene, tiny, velocity, name) for name, velocity in STEADY.items()]
    study = identify(scene, logs, geometry_of(scene, ("radius",), 1.0))
    assert study.found.values == pytest.approx([0.0021, 0.0021])
    assert any(word.startswith("radius of wheel 1: lies at the bound") for word in study.words)


LADEN = """
[vehicle.payload]
mass_kg = 1.0
x_m = 0.02
y_m = 0.01
yaw_inertia_kgm2 = 0.001
"""


def test_place_and_heading_move_the_whole_robot_so_that_it_moves_as_before(tmp_path):
    text = scene_path("optiodom_diff").read_text().replace("[[vehicle.support]]", f"{LADEN}\n[[vehicle.support]]", 1)
    (tmp_path / "laden.toml").write_text(text.replace("com_z_m", "com_x_m = 0.01\ncom_z_m"))
    scene = read_scene(tmp_path / "laden.toml")
    parameters = geometry_of(scene, ("place", "heading"))
    moved = parameters.vehicle(scene.vehicle, np.array([0.03, -0.02, 0.5]))
    before, after = (scene.core().matrices(scene.core().vehicle(v)) for v in (scene.vehicle, moved))
    for name in ("inertia", "wheel_rows"):  # about the centre of mass; turned with the body's axes
        assert np.linalg.norm(getattr(after, name)) == pytest.approx(np.linalg.norm(getattr(before, name)), rel=1e-12)
    arms = [np.hypot(w["x_m"] - v["com_x_m"], w["y_m"] - v["com_y_m"]) for v in (scene.vehicle, moved)
            for w in (*v["wheel"], *v["support"], v["payload"])]
    assert arms[:5] == pytest.approx(arms[5:], abs=1e-15)


def test_a_place_that_was_found_is_written_for_all_parts_of_the_robot(tmp_path):
    scene = read_scene("optiodom_diff")
    free = geometry_of(scene, ("place",))
    truth = free.vehicle(scene.vehicle, np.array([0.02, 0.01]))
    logs = [exact_run(scene, truth, velocity, name) for name, velocity in
            {"one": (0.2, 0.0, 0.5), "two": (0.2, 0.0, -0.5)}.items()]
    (tmp_path / "fitted.toml").write_text(fitted_text(identify(scene, logs, free)))
    found = read_scene(tmp_path / "fitted.toml").vehicle
    assert found["com_x_m"] == pytest.approx(0.02, abs=1e-6) and found["com_y_m"] == pytest.approx(0.01, abs=1e-6)
    assert [each["x_m"] for each in found["support"]] == pytest.approx([-0.08, 0.12], abs=1e-6)
    assert [each["y_m"] for each in found["support"]] == pytest.approx([0.01, 0.01], abs=1e-6)


def test_a_log_of_the_centre_of_mass_tells_where_it_is_and_not_the_place_of_the_robot(tmp_path):
    scene = read_scene("optiodom_omni3")
    free = geometry_of(scene, ("place", "centre-of-mass"))
    truth = free.vehicle(scene.vehicle, np.array([0.02, -0.01, 0.0, 0.0]))
    logs = [exact_run(scene, truth, velocity, str(k), point="centre_of_mass") for k, velocity in
            enumerate([(0.2, 0.0, 0.5), (0.0, 0.2, -0.5)])]
    study = identify(scene, logs, free)
    assert study.found.untold == ("place of the robot, x", "place of the robot, y")
    assert study.found.values == pytest.approx([0.02, -0.01], abs=1e-6)


def test_true_nominal_and_identified_paths_are_drawn(tmp_path, capsys):
    one = simulated(tmp_path, "one", 0.0345)
    picture = tmp_path / "paths.png"
    assert run(["identify", str(one), "--scene", "turtlebot3_burger", "--plot", str(picture)]) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_poor_fit_is_not_said_to_tell_every_parameter(monkeypatch):
    scene, random = read_scene("optiodom_diff"), np.random.default_rng(6)
    logs = [made_up(scene.core(), scene.vehicle, Path(f"/made-up/day{i}/run.csv"), random) for i in range(3)]

    def words():
        return identify(scene, logs, geometry_of(scene, ("radius", "distance"))).words

    assert any(word.startswith("The runs tell every parameter") for word in words())
    monkeypatch.setattr("laconic.robot.identify.study.of_errors", lambda *_: ["The fit is poor."])
    assert words()[0] == "The fit is poor." and not any("every parameter better" in word for word in words())
