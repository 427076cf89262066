"""A sweep on workers gives the bytes that one process gives, whichever worker dies, and through an address."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import cloudpickle
import pytest

from laconic.errors import BadInput, ResultFails
from laconic.scene.scene_tables import scene_tables
from laconic.tools.sweep import effort, sweep, workers
from laconic.tools.sweep.plan import make_plan

RUNS = 40


def mortal_work(grave: str, victim: float, *task):
    """Kills its own worker the first time that it gets the run with a mass of `victim`."""
    if victim in task[2]["vehicle.mass_kg"] and not Path(grave).exists():
        Path(grave).touch()
        os._exit(9)
    return workers.work(*task)


def faulty_work(victim: float, *task):
    """Fails for the run with a mass of `victim`."""
    if victim in task[2]["vehicle.mass_kg"]:
        raise ZeroDivisionError("a fault of ours")
    return workers.work(*task)


class Client:
    """A Dask client that sends other work."""

    def __init__(self, client, work, *first):
        self._client, self._work, self._first = client, work, first

    def submit(self, _, *task, **more):
        return self._client.submit(self._work, *self._first, *task, **more)

    def nthreads(self):
        return self._client.nthreads()


@pytest.fixture(scope="module")
def client():
    cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers do not find the tests
    with workers.local_client(2) as made:
        yield made


def begun(folder: Path):
    plan = make_plan(scene_tables("paper_three_wheel_driven"), (f"vehicle.mass_kg=1:8:{RUNS}",), ())
    return sweep.begin(plan, folder)


def values_of(store):
    return lambda number: store.plan.values(*store.range_of(number))


@pytest.fixture
def expected(tmp_path, monkeypatch):
    """The bytes that one process gives."""
    monkeypatch.setattr(sweep, "MOST_RUNS_OF_CHUNK", 5)
    store = begun(tmp_path / "alone")
    sweep.carry_on(store, workers=0)
    return (tmp_path / "alone/results.parquet").read_bytes()


def test_what_ends_a_sweep_while_its_workers_begin_leaves_the_first_chunks(expected, tmp_path, monkeypatch):
    def interrupted(_):
        raise KeyboardInterrupt

    store = begun(tmp_path / "ended")
    monkeypatch.setattr(sweep, "local_client", interrupted)
    with pytest.raises(KeyboardInterrupt):
        sweep.carry_on(store, workers=2)
    assert (sweep.runs_there(store), store.missing()) == (10, [2, 3, 4, 5, 6, 7])
    sweep.carry_on(store, workers=0)
    assert (tmp_path / "ended/results.parquet").read_bytes() == expected


def test_chunks_that_take_long_are_left_to_the_workers(expected, tmp_path, monkeypatch):
    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(effort, "step_seconds", lambda _: 1.0)
    monkeypatch.setattr(sweep, "local_client", interrupted)
    store = begun(tmp_path / "long")
    with pytest.raises(KeyboardInterrupt):
        sweep.carry_on(store, workers=2)
    assert sweep.runs_there(store) == 0


@pytest.mark.parametrize(("each_s", "words"), [
    (50.0, "laconic: 40 runs, the longest of 1.25e+04 steps, take about 2 minutes; Ctrl-C ends it and keeps what is "
           "done"),
    (0.01, "")])
def test_a_machine_that_is_busy_shows_with_the_second_chunk(expected, tmp_path, monkeypatch, capsys, each_s, words):
    now = iter(each_s * count for count in (0, 100, 100, 101))  # the first makes ready, too
    monkeypatch.setattr(effort, "step_seconds", lambda _: 1e-12)
    monkeypatch.setattr(sweep, "perf_counter", lambda: next(now))
    monkeypatch.setattr(sweep, "local_client", lambda _: pytest.fail("told"))
    store = begun(tmp_path / "busy")
    with pytest.raises(pytest.fail.Exception, match="told"):
        sweep.carry_on(store, workers=2)
    assert capsys.readouterr().err.strip() == words


def kept(store):
    return lambda number, rows: store.keep(number, values_of(store)(number), rows)


@pytest.mark.nightly
def test_a_scheduler_at_an_address_gives_the_same_bytes(client, expected, tmp_path):
    store = begun(tmp_path / "there")
    sweep.carry_on(store, scheduler=client.scheduler.address)
    assert (tmp_path / "there/results.parquet").read_bytes() == expected


def test_a_worker_that_dies_costs_nothing_but_time(client, expected, tmp_path):
    store = begun(tmp_path / "mortal")
    grave, victim = tmp_path / "grave", store.plan.values(17, 1)["vehicle.mass_kg"][0]
    workers.run_on(Client(client, mortal_work, str(grave), victim), store.plan, values_of(store), store.missing(),
                   kept(store))
    assert grave.exists(), "no worker has died"
    assert store.finish().read_bytes() == expected


class Lost:
    """A future whose worker dies with the result: what is asked first of all is lost, and done again."""

    def __init__(self, key, rows):
        self.key, self._rows, self._states = key, rows, iter(("lost", "pending"))

    @property
    def status(self):
        return next(self._states, "finished")

    def result(self):
        return self._rows


class Queue(list):
    """What Dask's as_completed does for futures that are there at once."""

    def __iter__(self):
        while self:
            yield self.pop(0)

    add = list.append


def test_a_result_that_its_worker_takes_along_is_waited_for_again(expected, tmp_path, monkeypatch):
    class Here:
        def __init__(self):
            self.sent = 0

        def submit(self, work, *task, pure):
            self.sent += 1
            return Lost(self.sent, work(*task))

        def nthreads(self):
            return {"one": 1}

    monkeypatch.setattr("distributed.as_completed", Queue)
    store = begun(tmp_path / "lost")
    workers.run_on(Here(), store.plan, values_of(store), store.missing(), kept(store))
    assert store.finish().read_bytes() == expected


def test_a_fault_of_one_chunk_is_told_in_one_line_and_the_others_are_kept(client, expected, tmp_path):
    store = begun(tmp_path / "faulty")
    victim = store.plan.values(17, 1)["vehicle.mass_kg"][0]
    with pytest.raises(ResultFails, match="1 of 8 chunks failed, the first is chunk 3: an unexpected fault of the"):
        workers.run_on(Client(client, faulty_work, victim), store.plan, values_of(store), store.missing(), kept(store))
    assert store.missing() == [3]
    sweep.carry_on(store, workers=0)
    assert (tmp_path / "faulty/results.parquet").read_bytes() == expected


def test_a_worker_of_other_versions_is_refused():
    with pytest.raises(BadInput, match="install the same on both"):
        workers.work("", "", {}, workers.versions() | {"laconic": "0.0.0"})


@pytest.mark.nightly
def test_an_address_without_a_scheduler_is_refused_in_one_line(tmp_path, expected, monkeypatch):
    monkeypatch.setattr(workers, "CONNECT_S", 1)
    store = begun(tmp_path / "nowhere")
    with pytest.raises(BadInput, match="--scheduler tcp://127.0.0.1:1: cannot be reached"):
        sweep.carry_on(store, scheduler="tcp://127.0.0.1:1")
    fresh = tmp_path / "not" / "made"
    with pytest.raises(BadInput, match="--scheduler tcp://127.0.0.1:1: cannot be reached"):
        sweep.begin(store.plan, fresh, "tcp://127.0.0.1:1")
    assert not fresh.parent.exists()
