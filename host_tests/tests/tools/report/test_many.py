"""The race of many vehicles: who computes something else is not timed, and what is printed is what was measured."""

from __future__ import annotations

import importlib.util
import json
import re
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.tools.report.many import energy, jax_lanes, mujoco_base, numba_loop, race
from laconic.tools.report.many.task import AGREEMENT, core_batch, core_states, difference, equations_of

LANES = 3
PAGE = (Path(__file__).parents[4] / "docs/batch.md").read_text(encoding="utf-8")
PLAIN_NUMBA = SimpleNamespace(njit=lambda function=None, **_: function or (lambda plain: plain))


@pytest.fixture
def without_peers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(race, "missing_peers", lambda: list(race.PEERS))
    monkeypatch.setattr(race, "stay_on_one_core", lambda: None)


def cores(task) -> np.ndarray:
    batch = core_batch(task, "double")
    batch.run(task.steps)
    return core_states(task, batch)


def test_numbas_loops_compute_what_the_core_does(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "numba", PLAIN_NUMBA)  # type: ignore[arg-type]  # as Python, uncompiled
    task = race.task_of(LANES, race.CHECK_STEP_S)
    wanted, runs = cores(task), numba_loop.numba_runs(task, "double")
    assert len(runs) == 3
    for one_run, states in runs.values():
        one_run()
        assert difference(states(), wanted) < AGREEMENT["double"]


def test_with_the_cores_formula_of_the_pose_they_agree_at_a_step_ten_times_as_long(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "numba", PLAIN_NUMBA)  # type: ignore[arg-type]
    task = race.task_of(LANES)
    runs = numba_loop.numba_runs(task, "double")
    for one_run, _ in runs.values():
        one_run()
    wanted = cores(task)
    assert difference(runs["numba, core's formula"][1](), wanted) < AGREEMENT["double"]
    assert difference(runs["numba, by vehicle"][1](), wanted) > AGREEMENT["double"]


def test_the_step_for_jax_computes_what_the_core_does():
    task = race.task_of(LANES, race.CHECK_STEP_S)
    equations = equations_of(task, np.float64)
    step, b = jax_lanes._step_of(np, equations), tuple(equations.forcing @ task.voltages_V)
    state = tuple(np.zeros((9, LANES)))
    state = (*state[:5], task.headings_rad, *state[6:])
    for _ in range(task.steps):
        state = step(state, b)
    found = np.vstack([state[:6], equations.wheels @ np.array(state[6:])])
    assert difference(found, cores(task)) < AGREEMENT["double"]


def test_mujocos_carriage_drives_as_the_core_does():
    race.check_mujoco(runs=2)


def test_a_carriage_that_drives_otherwise_is_not_timed(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(mujoco_base, "ACROSS_AXLE", 1e-5)
    with pytest.raises(race.Disagreement, match="MuJoCo"):
        race.check_mujoco(runs=2)


@pytest.mark.parametrize("name", race.PEERS)
def test_a_peer_that_is_not_installed_is_named(name: str, monkeypatch: pytest.MonkeyPatch):
    there = {each: each != name for each in race.PEERS}
    monkeypatch.setattr(importlib.util, "find_spec", lambda module: there[module] or None)
    assert race.missing_peers() == [name]


def test_a_peer_that_differs_stops_the_race(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    def wrong(task, real):
        return {"numba, wrong": (lambda: None, lambda: np.zeros((6 + task.scene.wheel_count, task.lanes)))}

    monkeypatch.setattr(race, "missing_peers", lambda: ["jax", "mujoco"])
    monkeypatch.setattr(race, "numba_runs", wrong)
    monkeypatch.setattr(race, "stay_on_one_core", lambda: None)
    assert run(["benchmark", "batch", "--lanes", "4", "--rounds", "1"]) == 1
    assert "numba, wrong, double: differs from the core by" in capsys.readouterr().err


def test_the_pages_command_prints_the_cores_rates_and_what_is_missing(without_peers,
                                                                      capsys: pytest.CaptureFixture[str]):
    words = re.findall(r"^    laconic (benchmark .*)$", PAGE, re.MULTILINE)[0].split()
    assert run([*words, "--lanes", "40", "--rounds", "1", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [(row["who"], row["real"]) for row in found["rows"]] == [
        (who, real) for real in race.REALS for who in (race.BATCH, race.ALONE)]
    for row in found["rows"]:
        assert row["million_steps_per_s"] * row["ns_per_step"] == pytest.approx(1e3)
    assert found["rows"][0]["times_batch"] == found["rows"][1]["times_alone"] == 1.0
    assert any("not compared: mujoco" in note for note in found["notes"])


def test_energy_is_read_across_a_wrap_of_its_counter(tmp_path):
    package, core = tmp_path / "intel-rapl:0", tmp_path / "intel-rapl:0:0"
    for folder, value in ((package, 900), (core, 1)):
        folder.mkdir()
        (folder / "energy_uj").write_text(f"{value}\n")
        (folder / "max_energy_range_uj").write_text("999\n")
    counter = energy.EnergyCounter(tmp_path)
    before = counter.reading()
    (package / "energy_uj").write_text("100\n")
    assert counter.is_readable
    assert counter.joules(before, counter.reading()) == pytest.approx(200e-6)


def test_where_no_counter_can_be_read_there_is_no_energy(tmp_path):
    (tmp_path / "intel-rapl:0").mkdir()
    assert not energy.EnergyCounter(tmp_path).is_readable
