"""`laconic sweep` from the command line to its results, in this process."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from laconic.cli.commands import sweep as command
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.pictures import sweep_panels
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT, STIFF_4
from laconic.scene.scene_tables import scene_tables
from laconic.simulation import simulate
from laconic.tools.measures import measures_of
from laconic.tools.sweep import chunk, page, sweep, workers
from laconic.tools.sweep.chunk import nominal_course, run_chunk
from laconic.tools.sweep.plan import make_plan
from laconic.tools.sweep.store import Store

VARY = ("vehicle.mass_kg=-1:8:4", "vehicle.com_x_m~normal(0,0.01)")
ARGUMENTS = ["sweep", "paper_three_wheel_driven", "--vary", VARY[0], "--vary", VARY[1], "--samples", "6",
             "--workers", "0"]
RUNS = 24


@pytest.fixture(autouse=True)
def _small_chunks(monkeypatch):
    monkeypatch.setattr(sweep, "MOST_RUNS_OF_CHUNK", 5)
    monkeypatch.setattr(sweep, "MOST_RUNS_ALONE", 5)


def bytes_of(folder: Path) -> bytes:
    return (folder / "results.parquet").read_bytes()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Results of a sweep that nothing disturbed."""
    folder = tmp_path_factory.mktemp("sweep") / "whole"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep, "MOST_RUNS_OF_CHUNK", 5)
        patch.setattr(sweep, "MOST_RUNS_ALONE", 5)
        assert run([*ARGUMENTS, "-o", str(folder)]) == 0
    return folder


@pytest.fixture
def without_page(monkeypatch):
    """The page is made in one test."""
    monkeypatch.setattr(page, "write_page", lambda _: [])


def test_results_are_one_file_with_a_row_for_each_run_and_nulls_with_a_reason(whole, capsys):
    table = pq.read_table(whole / "results.parquet")
    assert table.column_names == ["run", "vehicle.mass_kg", "vehicle.com_x_m", "end_x_m", "end_y_m", "end_heading_rad",
                                  "refused", "refused_at_s"]
    assert table["run"].to_pylist() == list(range(RUNS))
    assert table["refused"].to_pylist()[:6] == ["vehicle.mass_kg: -1 is not positive; give a value above 0"] * 6
    assert table["end_x_m"].null_count == 6
    assert table["refused"].null_count == RUNS - 6
    assert sorted(path.name for path in whole.iterdir()) == ["results.parquet", "summary.html", "sweep.json"]
    told = json.loads(table.schema.metadata[b"laconic.tools.sweep"])
    assert told == json.loads((whole / "sweep.json").read_text(encoding="utf-8"))
    assert told["command"].startswith("laconic sweep paper_three_wheel_driven --vary")


def test_a_run_of_the_results_is_repeated_by_its_index(whole, tmp_path):
    scene = tmp_path / "run.toml"
    assert run(["sweep", "-o", str(whole), "--repeat", "13", "--scene-out", str(scene)]) == 0
    found = simulate(read_scene(scene), ("x_m",)).columns["x_m"][-1]
    assert pq.read_table(whole / "results.parquet")["end_x_m"][13].as_py() == found


@pytest.mark.usefixtures("without_page")
def test_an_interrupted_sweep_keeps_what_is_done_and_goes_on_to_the_same_bytes(whole, tmp_path, monkeypatch, capsys):
    keep, folder = Store.keep, tmp_path / "again"

    def until_the_third(store, number, values, rows):
        if number >= 3:
            raise KeyboardInterrupt
        keep(store, number, values, rows)

    with monkeypatch.context() as patch:
        patch.setattr(Store, "keep", until_the_third)
        assert run([*ARGUMENTS, "-o", str(folder)]) == 130
    assert "15 of 24 runs are kept" in capsys.readouterr().err
    (folder / "parts/000001.parquet").write_bytes(b"half of a file")  # as a machine that lost its power leaves it
    assert run([*ARGUMENTS, "-o", str(folder)]) == 0
    assert "10 of 24 runs are in" in capsys.readouterr().out
    assert bytes_of(folder) == bytes_of(whole)


@pytest.mark.parametrize(("arguments", "words"), [
    ([*ARGUMENTS, "--seed", "9"], "has another sweep: laconic sweep paper_three_wheel_driven"),
    (["sweep", "--repeat", "24"], "there is no such run"), (["sweep", "--repeat", "0", "--seed", "3"], "--seed")])
def test_a_folder_of_another_sweep_is_refused_in_one_line(whole, capsys, arguments, words):
    capsys.readouterr()
    assert run([*arguments, "-o", str(whole)]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


def test_a_folder_with_other_files_and_versions_that_changed_are_refused(whole, tmp_path, monkeypatch, capsys):
    (tmp_path / "full").mkdir()
    (tmp_path / "full/letter.txt").write_text("dear", encoding="utf-8")
    assert run([*ARGUMENTS, "-o", str(tmp_path / "full")]) == 2
    assert "has other files" in capsys.readouterr().err
    monkeypatch.setattr(sweep, "versions", lambda: workers.versions() | {"numpy": "0.1"})
    assert run([*ARGUMENTS, "-o", str(whole)]) == 2
    assert "was begun with numpy" in capsys.readouterr().err


@pytest.mark.usefixtures("without_page")
def test_a_fault_of_a_chunk_is_told_in_one_line_and_nothing_is_lost(tmp_path, monkeypatch, capsys):
    with monkeypatch.context() as patch:
        patch.setattr(workers, "run_chunk", lambda *_: 1 / 0)
        assert run([*ARGUMENTS, "-o", str(tmp_path / "broken")]) == 2
    assert "unexpected fault of the program" in capsys.readouterr().err
    assert run([*ARGUMENTS, "-o", str(tmp_path / "broken")]) == 0


@pytest.mark.nightly
def test_the_page_has_a_picture_for_each_key_and_the_indices_by_name(tmp_path):
    folder = tmp_path / "page"
    assert run(["sweep", "paper_three_wheel_driven", "--vary", "vehicle.mass_kg~uniform(6,8)", "--vary",
                "vehicle.com_x_m~uniform(-0.01,0.01)", "--samples", "32", "--sensitivity", "--workers", "0",
                "--measure", "end_heading_rad", "-o", str(folder)]) == 0
    text = (folder / "summary.html").read_text(encoding="utf-8")
    assert text.count("<img") == 4
    assert "Sobol' indices from Saltelli" in text.replace("&#x27;", "'")
    assert "{{" not in text


@pytest.mark.parametrize("module", ["distributed", "pyarrow", "SALib"])
def test_a_part_of_the_extra_that_is_not_there_is_named_before_any_work(module, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "find_spec", lambda name: None if name == module else object())
    assert run([*ARGUMENTS, "-o", str(tmp_path / "none")]) == 2
    assert f'this needs {module}, which is not installed; pip install "laconic[sweep]"' in capsys.readouterr().err
    assert not (tmp_path / "none").exists()
    assert run(["sweep", "--help"]) == 0


def test_all_measures_are_listed_with_their_words(capsys):
    assert run(["sweep", "--measures"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) >= 15
    assert any(line.startswith("electrical_energy_J ") and "[vehicle.motor]" not in line for line in lines)


@pytest.mark.parametrize(("values", "told"), [
    ([3.954842569391214, 3.9548425693912144], "in all runs"), ([0.0, 0.0], ""), ([-1e308, 1e300], "beyond"),
    ([1.0, 2.0], "")])
def test_values_that_no_axis_can_show_have_words_instead_of_a_picture(values, told):
    numbers = np.array(values * 20)
    words = sweep_panels._without_picture(numbers)
    assert told in words
    assert bool(words) == (values != [1.0, 2.0])
    assert "<svg" in sweep_panels.histogram("end_heading_rad", numbers)
    assert "<svg" in sweep_panels.effect("vehicle.mass_kg", np.linspace(1, 2, 40), "end_heading_rad", numbers)


# ---- A run of a sweep has the bits of `laconic simulate` with the numbers set by hand; what no lane takes goes
# alone.

SHORT = {"run.duration_s": 3.0, "run.step_s": 0.01}
ENDS = ("end_x_m", "end_y_m", "end_heading_rad")
IN_LANES = [
    ("robotino2", ("vehicle.mass_kg=6:10:3", "vehicle.wheel[1].distance_m~normal(0.125,0.001)",
                   "vehicle.wheel[2].bearing_deg~normal(180,1)")),
    ("robotino2", ("vehicle.motor.resistance_ohm=5,7", "vehicle.motor.rotor_inertia_kgm2=1e-5:2e-5:2",
                   "vehicle.wheel[1].inertia_kgm2=0.001,0.002")),
    ("robotino2", ("vehicle.wheel[2].x_m=-0.13:-0.11:4", f"run.method=auto,{EXPLICIT},{STIFF_4}",
                   "run.real=double,single", "ground.slope_deg=0,3")),
    ("robotino2", ("initial.velocity_body_m_per_s[1]=0:1:2", "initial.yaw_rate_rad_per_s=0,1",
                   "initial.heading_deg=0,30")),
    ("robotino2", ("input[1].value[2]=1:3:3", "input[*].value[1]=-1,1", "vehicle.wheel[*].axle_deg=0,1")),
    ("turtlebot3_burger", ("vehicle.mass_kg=0.5,1.5", "vehicle.wheel[1].radius_m=0.03:0.034:2",
                           "vehicle.com_x_m=-0.02,0.02")),
    ("kuka_youbot", ("vehicle.mass_kg=20:30:4", "vehicle.wheel[*].roller_deg=40,45"))]


def of(scene, vary, measures=ENDS, samples=3):
    tables = scene_tables("robotino2" if scene == "sensors" else scene)
    if scene == "sensors":
        tables.entries["sensors"] = {"imu": {"delay_s": 0.03}}
        scene = "robotino2"
    is_random = any("~" in each for each in vary)
    plan = make_plan(shortened(tables) if scene == "robotino2" else tables, vary, measures,
                     samples=samples if is_random else None)
    return plan, plan.values(0, plan.runs)


def shortened(tables):
    """Three seconds, with the first change of the voltages alone."""
    entries = tables.with_values(SHORT).entries
    for each in entries["input"]:
        each["t_s"], each["value"] = each["t_s"][:2], each["value"][:2]
    entries["outputs"]["every_s"] = 0.1
    return type(tables)(tables.path, entries)


@pytest.mark.parametrize(("scene", "vary"), IN_LANES)
def test_runs_side_by_side_have_the_bits_of_simulate(monkeypatch, scene, vary):
    plan, values = of(scene, vary)
    monkeypatch.setattr(chunk, "run_alone", lambda *_: pytest.fail("this run must go in a lane"))
    rows = run_chunk(plan, None, values)
    for place in range(0, plan.runs, max(1, plan.runs // 5)):
        run = simulate(plan.tables.with_values(plan.of_run(place)).scene(), ("x_m", "y_m", "heading_rad"))
        end = [run.columns[name][-1] for name in ("x_m", "y_m", "heading_rad")]
        assert rows.measures[:, place].tolist() == end


def test_every_measure_has_the_same_bits_in_a_lane_and_alone(monkeypatch):
    names = tuple(name for name, measure in measures_of("run").items() if measure.needs != "supply")
    plan, values = of("robotino2", ("vehicle.mass_kg=6:10:3", "vehicle.motor.resistance_ohm=5,7"), names)
    nominal = nominal_course(plan)
    in_lanes = run_chunk(plan, nominal, values)
    monkeypatch.setattr(chunk, "FEWEST_LANES", 10**9)
    alone = run_chunk(plan, nominal, values)
    assert in_lanes.measures.tobytes() == alone.measures.tobytes()
    assert np.isfinite(in_lanes.measures[:, 0]).sum() >= len(names) - 1


def why_not(plan, place) -> str:
    """The words in which `laconic simulate` refuses a run; empty where it takes it."""
    try:
        simulate(plan.tables.with_values(plan.of_run(place)).scene(), ("x_m",))
    except BadInput as refused:
        return str(refused)
    return ""


@pytest.mark.parametrize(("scene", "vary"), [
    ("paper_caster", ("vehicle.mass_kg=-1,0,2,3,4,5",)),                          # refused by the core
    ("robotino2", ("vehicle.wheel[1].radius_m=-0.01,0,0.03,0.035,0.04,0.045",)),  # refused by the reader
    ("robotino2", ("run.step_s=0.01,0.03", "vehicle.mass_kg=6,7,8,9")),           # too long for the changes of inputs
    ("robotino2", ("vehicle.motor.gear_ratio=0,8,9,10,12",)),
    ("sensors", ("vehicle.mass_kg=6,7,8,9", "run.step_s=0.01,0.02"))])  # of which the IMU's delay is no whole number
def test_a_run_that_is_refused_says_why_as_simulate_does_and_the_others_go_on(scene, vary):
    plan, values = of(scene, vary)
    rows = run_chunk(plan, None, values)
    for place in range(plan.runs):
        why = why_not(plan, place)
        assert np.isnan(rows.measures[:, place]).tolist() == [bool(why)] * 3
        assert rows.reasons[place].reason in why if why else place not in rows.reasons
    assert 0 < len(rows.reasons) < plan.runs


def test_a_step_that_is_refused_on_the_way_says_when():
    tables = scene_tables("paper_caster").with_values({"run.method": EXPLICIT})
    plan = make_plan(tables, ("initial.velocity_body_m_per_s[1]=1e155,1e200,1,2,3,1e306",), ())
    rows = run_chunk(plan, None, plan.values(0, plan.runs))
    late = [reason for reason in rows.reasons.values() if reason.at_s is not None]
    assert rows.reasons
    assert all("at t = " in reason.reason for reason in late)
    assert np.isfinite(rows.measures[:, 2:5]).all()


def test_ground_friction_and_sampled_inputs_go_alone_with_the_same_results(monkeypatch):
    tables = shortened(scene_tables("robotino2"))
    del tables.entries["vehicle"]["friction_coefficient"]
    plan = make_plan(tables, ("ground.friction_coefficient=0.02:0.4:3", "vehicle.mass_kg=6,8"), ENDS)
    rows = run_chunk(plan, None, plan.values(0, plan.runs))
    run = simulate(plan.tables.with_values(plan.of_run(3)).scene(), ("x_m",))
    assert rows.measures[0, 3] == run.columns["x_m"][-1]
    assert np.isfinite(rows.measures).all()
    tables.entries["input"].append({"signal": "body_moment_Nm", "kind": "sine", "amplitude": 0.1, "frequency_Hz": 1.0})
    plan = make_plan(tables, ("vehicle.mass_kg=6:8:4", "input[4].amplitude=0,0.2"), ENDS)
    rows = run_chunk(plan, None, plan.values(0, plan.runs))
    run = simulate(plan.tables.with_values(plan.of_run(5)).scene(), ("y_m",))
    assert rows.measures[1, 5] == run.columns["y_m"][-1]
