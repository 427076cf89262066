"""A sweep on workers gives the bytes that one process gives, whichever worker dies, and through an address."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import cloudpickle
import pytest

from laconic.errors import BadInput, ResultFails
from laconic.scene.scene_tables import scene_tables
from laconic.sweep import sweep, workers
from laconic.sweep.plan import make_plan

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


def kept(store):
    return lambda number, rows: store.keep(number, values_of(store)(number), rows)


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


def test_a_fault_of_one_chunk_is_told_in_one_line_and_the_others_are_kept(client, expected, tmp_path):
    store = begun(tmp_path / "faulty")
    victim = store.plan.values(17, 1)["vehicle.mass_kg"][0]
    with pytest.raises(ResultFails, match="1 of 8 chunks failed, the first is chunk 3: unexpected ZeroDivisionError"):
        workers.run_on(Client(client, faulty_work, victim), store.plan, values_of(store), store.missing(), kept(store))
    assert store.missing() == [3]
    sweep.carry_on(store, workers=0)
    assert (tmp_path / "faulty/results.parquet").read_bytes() == expected


def test_a_worker_of_other_versions_is_refused():
    with pytest.raises(BadInput, match="install the same on both"):
        workers.work("", "", {}, workers.versions() | {"laconic": "0.0.0"})


def test_an_address_without_a_scheduler_is_refused_in_one_line(tmp_path, expected, monkeypatch):
    monkeypatch.setattr(workers, "CONNECT_S", 1)
    store = begun(tmp_path / "nowhere")
    with pytest.raises(BadInput, match="--scheduler tcp://127.0.0.1:1: cannot be reached"):
        sweep.carry_on(store, scheduler="tcp://127.0.0.1:1")
    fresh = tmp_path / "not" / "made"
    with pytest.raises(BadInput, match="--scheduler tcp://127.0.0.1:1: cannot be reached"):
        sweep.begin(store.plan, fresh, "tcp://127.0.0.1:1")
    assert not fresh.parent.exists()
