"""Options of a sweep and of an optimiser that say two things of one number, what is measured, and how long it takes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pyarrow.parquet as pq
import pytest

from laconic.batch import lanes as batch_lanes
from laconic.cli.main import run
from laconic.errors import BadInput, ResultFails
from laconic.scene.methods import EXPLICIT
from laconic.scene.scene_tables import scene_tables
from laconic.tools.sweep import effort, page, sweep
from laconic.tools.sweep.alone import run_alone
from laconic.tools.sweep.effort import foretell, step_seconds, steps_of_runs
from laconic.tools.sweep.lanes import Template, Watch
from laconic.tools.sweep.plan import make_plan, plan_from

MASS, WHEEL = "vehicle.mass_kg", "vehicle.wheel"
TWICE = [
    (f"{MASS}=6,7", f"{MASS}=8,9"), (f"{WHEEL}[1].axle_deg=0,1", f"{WHEEL}[1].axle_rad=0,1"),
    (f"{WHEEL}[*].x_m=0,1", f"{WHEEL}[2].x_m=0,1"), (f"{WHEEL}[2].x_m=0,1", f"{WHEEL}[*].x_m=0,1"),
    (f"{WHEEL}[*].axle_deg=0,1", f"{WHEEL}[3].axle_rad=0,1"),
    ("initial.nu_rad_per_s[*]=0,1", "initial.nu_rad_per_s[3]=0,1"), ("input[*].value[1]=0,1", "input[2].value[*]=0,1")]
PLACES = [(f"{WHEEL}[1].x_m=0.1,0.2", f"{WHEEL}[1].distance_m=0.1,0.2"),
          (f"{WHEEL}[*].bearing_deg=1,2", f"{WHEEL}[2].y_m=0.1,0.2")]


def plan(*vary: str, scene: str = "robotino2", measures: tuple[str, ...] = (), **more):
    return make_plan(scene_tables(scene), vary, measures, **more)


def key_of(vary: str) -> str:
    return vary.partition("=")[0]


@pytest.mark.parametrize(("vary", "words"), [*((pair, "names a number that") for pair in TWICE),
                                             *((pair, "places a wheel that") for pair in PLACES)])
def test_one_number_under_two_keys_is_refused_with_both_keys(vary, words):
    with pytest.raises(BadInput) as refused:
        plan(*vary)
    assert str(refused.value).startswith(f"--vary {key_of(vary[1])}: {words} --vary {key_of(vary[0])} ")


def test_numbers_of_other_wheels_and_both_coordinates_of_a_place_may_vary_together():
    assert plan(f"{WHEEL}[1].x_m=0,1", f"{WHEEL}[2].x_m=0,1", f"{WHEEL}[1].y_m=0,1", f"{WHEEL}[3].distance_m=0.1,0.2",
                f"{WHEEL}[3].bearing_deg=1,2", "initial.nu_rad_per_s[1]=0,1", "initial.nu_rad_per_s[2]=0,1").runs == 128


@pytest.mark.parametrize("pair", [TWICE[1], TWICE[2], PLACES[0]])
def test_an_optimiser_may_not_free_one_number_under_two_keys(pair, capsys):
    free = [word for key in map(key_of, pair) for word in ("--free", f"{key}=0.1:0.2")]
    single = ["paper_three_wheel_driven"]  # each wheel has a distance
    if pair == TWICE[2]:  # wheels that begin with one value
        free = ["--free", f"{WHEEL}[*].roller_deg=80:90", "--free", f"{WHEEL}[2].roller_rad=1.4:1.5"]
    assert run(["optimise", *single, *free, "--goal", "min:condition"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "keep" in error and error.count("--free vehicle.wheel") == 2


def test_a_place_that_cannot_be_written_is_refused_before_the_search(capsys, monkeypatch):
    from laconic.tools.optimise import study
    monkeypatch.setattr(study, "optimise", lambda *given: pytest.fail("it searched"))
    arguments = ["optimise", "robotino2", "--free", "vehicle.com_x_m=0:0.1", "--goal", "min:condition", "-o"]
    assert run([*arguments, "/proc/best.toml"]) == 2
    assert capsys.readouterr().err.startswith("laconic: --out /proc/best.toml: cannot be written (/proc")


# ---- measures


def test_a_measure_takes_arguments_and_is_a_column_by_them():
    given = plan(f"{MASS}=6,7", measures=("end_distance_m(x_m=1)", "end_distance_m( x_m = 1.0 )",
                                          "end_distance_m(y_m=0.25,x_m=-1)", "end_distance_m"))
    names = ["end_distance_m(x_m=1)", "end_distance_m(x_m=-1,y_m=0.25)", "end_distance_m"]
    assert [each.text for each in given.measures] == names
    again = plan_from(given.as_json())
    assert again.digest == given.digest
    found = run_alone(again.tables, {MASS: 6.0}, again.measures, None)
    x, y = run_alone(given.tables, {MASS: 6.0}, plan(f"{MASS}=6", measures=("end_x_m", "end_y_m")).measures, None)
    assert found == pytest.approx([np.hypot(x - 1, y), np.hypot(x + 1, y - 0.25), np.hypot(x, y)], rel=1e-12)


@pytest.mark.parametrize(("measure", "words"), [
    ("end_distance_m(z_m=1)", "--measure end_distance_m: there is no argument z_m"),
    ("end_x_m(x_m=1)", "--measure end_x_m: there is no argument x_m; it takes none"),
    ("end_distance_m(x_m=far)", "--measure end_distance_m(x_m=far): x_m: far is no finite number"),
    ("condition", "--measure condition: there is no such measure"), ("end x", "--measure end x: is no measure")])
def test_a_measure_that_is_none_is_refused_by_the_option(measure, words):
    with pytest.raises(BadInput) as refused:
        plan(f"{MASS}=6,7", measures=(measure,))
    assert str(refused.value).startswith(words)


def test_the_listed_measures_show_their_arguments(capsys):
    assert run(["sweep", "--measures"]) == 0
    assert "end_distance_m(x_m=…, y_m=…) " in capsys.readouterr().out


def test_a_given_measure_is_measured_alone_and_alone_paid(tmp_path, monkeypatch):
    looks = []
    monkeypatch.setattr(Watch, "look", lambda watch, look=Watch.look: (looks.append(set(watch.rows)), look(watch))[1])
    monkeypatch.setattr(page, "write_page", lambda _: [])
    arguments = ["sweep", "robotino2", "--vary", f"{MASS}=6:8:5", "--workers", "0", "-o", str(tmp_path)]
    assert run([*arguments, "--measure", "end_yaw_rate_rad_per_s"]) == 0
    table = pq.read_table(tmp_path / "results.parquet")
    assert table.column_names == ["run", MASS, "end_yaw_rate_rad_per_s", "refused", "refused_at_s"]
    assert looks == [{"yaw_rate_rad_per_s"}] * 2  # start and end


def test_a_run_alone_does_not_pay_for_a_watch_of_the_ground(monkeypatch):
    from laconic.tools.sweep import alone
    seen = []
    monkeypatch.setattr(alone, "simulate", lambda *given, ours=alone.simulate, **more: (
        seen.append(ours(*given, **more)), seen[-1])[1])
    run_alone(scene_tables("skid_steer"), {}, plan(f"{MASS}=6", measures=("end_x_m",)).measures, None)
    assert seen[0].grip is None


# ---- refused runs


def test_a_sweep_whose_runs_are_all_refused_fails_in_one_line_and_keeps_its_results(tmp_path, capsys):
    arguments = ["sweep", "robotino2", "--vary", f"{MASS}=-1,-2", "--workers", "0", "-o", str(tmp_path / "all")]
    for _ in range(2):  # the results that are there, too
        assert run(arguments) == 1
        error = capsys.readouterr().err.splitlines()[-1]
        assert error.startswith("laconic: every run was refused, the first because vehicle.mass_kg: -1 is not positive")
    assert pq.read_table(tmp_path / "all/results.parquet").num_rows == 2
    assert (tmp_path / "all/summary.html").exists()
    some = dataclasses.replace(sweep.begin(plan(f"{MASS}=-1,6"), tmp_path / "some"))
    sweep.carry_on(some, workers=0)
    page.check_any_run(some)
    none = sweep.begin(plan(f"{MASS}=-1"), tmp_path / "none")
    sweep.carry_on(none, workers=0)
    with pytest.raises(ResultFails):
        page.check_any_run(none)


# ---- how long


def test_the_steps_of_runs_are_known_beforehand():
    assert steps_of_runs(plan("run.step_s=1e-9,1e-3"), scene_tables("robotino2").scene()).tolist() == [1e10, 1e4]
    assert steps_of_runs(plan("run.duration_s=-1,0.5"), scene_tables("robotino2").scene()).tolist() == [0, 500]
    many = steps_of_runs(plan(f"{MASS}=6:8:100000", "run.step_s=1e-3,1e-4"), scene_tables("robotino2").scene())
    assert len(many) == effort.MOST_LOOKED_AT


def test_a_sweep_that_takes_long_says_so_before_it_begins(capsys, monkeypatch):
    scene = scene_tables("robotino2").scene()
    monkeypatch.setattr(effort, "step_seconds", lambda scene: 1e-7)
    many, few = f"{MASS}=6:8:800000", f"{MASS}=6:8:10"
    for vary, workers, words in (("run.step_s=1e-9", 2, "1 runs, the longest of 1e+10 steps, take about 17 minutes;"),
                                 (many, 2, "800000 runs, the longest of 1e+04 steps, take about 100 seconds;"),
                                 (many, 0, "take about 3 minutes on one core; Ctrl-C ends it"), (few, 2, "")):
        foretell(plan(vary), scene, 1.0, MASS in vary, workers)
        error = capsys.readouterr().err
        assert words in error and error.count("\n") == bool(words)
    foretell(plan(f"{MASS}=6:8:800000"), scene, 0.01, True, 2)  # nearly all is there
    assert capsys.readouterr().err == ""


def test_the_time_of_a_step_is_tried_by_steps_of_the_scene():
    now = iter(np.cumsum([0.0, 5.0] + [0.0, 0.03] * 10))  # the first call is slow: memory is touched
    assert 0 < step_seconds(scene_tables("robotino2").scene(), lambda: next(now)) < 1e-4


def test_chunks_of_long_runs_are_short():
    scene = scene_tables("robotino2").scene()
    assert sweep.chunk_of(plan("run.step_s=1e-8,1e-3"), scene) == 1
    assert sweep.chunk_of(plan(f"{MASS}=6:8:100"), scene) == 1000


def test_rows_that_no_memory_holds_are_not_even_tried_side_by_side():
    scene = scene_tables("paper_three_wheel_driven").with_values({"run.step_s": 1e-9})
    measures = plan(f"{MASS}=6,7", measures=("distance_m",)).measures
    entries = {**scene.entries, "outputs": {}}
    whole = dataclasses.replace(scene, entries=entries)
    assert not Template(whole, whole.scene()).fits(measures)
    assert "rows are too many" in run_alone(whole, {}, measures, None).reason


def test_a_batch_that_steps_long_lets_ctrl_c_through_and_keeps_its_bits(monkeypatch):
    import laconic
    robot = laconic.Vehicle.of(laconic.read_scene("robotino2"))
    whole = laconic.Batch(robot, 3, EXPLICIT, 1e-3)
    monkeypatch.setattr(batch_lanes, "MOST_AT_ONCE", 21)
    monkeypatch.setattr(batch_lanes, "FEWEST_AT_ONCE", 1)
    parts = laconic.Batch(robot, 3, EXPLICIT, 1e-3)
    for batch in (whole, parts):
        batch.voltage_V[:] = [[1.0, 2.0, 3.0]]
        batch.voltage_V[0, 1] = np.nan
    assert (whole.run(100), parts.run(100)) == (1, 1)
    assert parts.heading_rad.tobytes() == whole.heading_rad.tobytes()
    assert parts.missed.tolist() == whole.missed.tolist() == [0, 100, 0]
    calls = []
    monkeypatch.setattr(parts, "_pool", None)
    monkeypatch.setattr(type(parts), "_in_parts", lambda batch, work, threads: (calls.append(work), _stop(calls))[1])
    with pytest.raises(KeyboardInterrupt):
        parts.run(10**15)
    assert len(calls) == 3


def _stop(calls):
    if len(calls) == 3:
        raise KeyboardInterrupt
    return 0
