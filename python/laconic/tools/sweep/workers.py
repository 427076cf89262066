"""Chunks of a sweep on workers: processes of this machine, or those of a Dask cluster."""

from __future__ import annotations

import json
import logging
import os
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import version
from multiprocessing import resource_tracker
from typing import Any

import numpy as np

from laconic.errors import BadInput, LaconicError, ResultFails, words_of
from laconic.tools.sweep.chunk import Rows, plan_of, run_chunk
from laconic.tools.sweep.plan import Plan

AHEAD = 2              # chunks that wait for each worker
MOST_DEATHS = 20       # of workers under one chunk, before it is given up
ENDED = ("finished", "error", "cancelled")  # what a future of Dask can be at last
CONNECT_S = 10
LOOPBACK = "127.0.0.1"
LIBRARIES = ("laconic", "numpy", "scipy", "SALib", "pyarrow")

Done = Callable[[int, Rows], None]


def versions() -> dict[str, str]:
    """What decides the bytes of the results."""
    return {name: version(name) for name in LIBRARIES}


def work(digest: str, told: str, values: Mapping[str, np.ndarray], expected: Mapping[str, str]) -> Rows:
    """What a worker is sent; BadInput where it is not of the versions of the one who sends."""
    here = versions()
    for name in ("laconic", "numpy"):
        if here[name] != expected[name]:
            raise BadInput(f"--scheduler: a worker has {name} {here[name]}, this machine {expected[name]}; install the "
                           "same on both")
    return run_chunk(*plan_of(digest, told), values)


def run_here(plan: Plan, values_of: Callable[[int], Mapping[str, np.ndarray]], chunks: list[int], done: Done) -> None:
    """All chunks in this process."""
    known = plan_of(plan.digest, json.dumps(plan.as_json()))
    for number in chunks:
        done(number, run_chunk(*known, values_of(number)))


def run_on(client: Any, plan: Plan, values_of: Callable[[int], Mapping[str, np.ndarray]], chunks: list[int],
           done: Done) -> None:
    """All chunks on the workers of a Dask client; a worker that dies costs its chunk's time.

    ResultFails when chunks fail for another reason: after all others are done.
    """
    from distributed import as_completed

    told, expected, failed = json.dumps(plan.as_json()), versions(), {}
    waiting, number_of = iter(chunks), {}

    def next_ones(count: int) -> Iterator[Any]:
        for _, number in zip(range(count), waiting, strict=False):
            future = client.submit(work, plan.digest, told, values_of(number), expected, pure=False)
            number_of[future.key] = number
            yield future

    running = as_completed(list(next_ones(_ahead(client))))
    for future in running:
        if future.status not in ENDED:  # its worker died with the result: the scheduler has it done again
            running.add(future)
            continue
        number = number_of.pop(future.key)
        if future.status == "finished":
            done(number, future.result())
        else:
            failed[number] = _reason_of(future)
        for fresh in next_ones(max(0, _ahead(client) - len(number_of))):
            running.add(fresh)
    if failed:
        number, error = next(iter(failed.items()))
        raise error if isinstance(error, BadInput) else ResultFails(
            f"{len(failed)} of {len(chunks)} chunks failed, the first is chunk {number}: {error}; what is done is "
            "kept, and the same command tries the rest again")


def _ahead(client: Any) -> int:
    """How many chunks may be under way; workers of a cluster come and go."""
    return AHEAD * max(1, sum(client.nthreads().values())) + 1


def _reason_of(future: Any) -> LaconicError:
    from distributed import KilledWorker
    if future.status == "cancelled":
        return ResultFails("the scheduler has gone, or somebody cancelled it")
    error = future.exception()
    if isinstance(error, LaconicError):
        return error
    if isinstance(error, KilledWorker):
        return ResultFails(f"{MOST_DEATHS} workers died under it, perhaps for lack of memory")
    return ResultFails("an unexpected fault of the program on a worker; LACONIC_TRACEBACK=1 with --workers 0 shows it, "
                       "for a report")


@contextmanager
def local_client(workers: int) -> Iterator[Any]:
    """So many processes of this machine; they end with this one, whatever ends it."""
    import dask
    from distributed import Client, LocalCluster

    _quiet()
    with dask.config.set({"distributed.scheduler.allowed-failures": MOST_DEATHS,
                          "distributed.comm.timeouts.connect": f"{CONNECT_S}s"}):
        with _without_ctrl_c():
            cluster = LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, host=LOOPBACK,
                                   dashboard_address=f"{LOOPBACK}:0", worker_dashboard_address=None,
                                   silence_logs=logging.CRITICAL, memory_limit=0)
        with cluster, Client(cluster) as client:
            yield client


@contextmanager
def _without_ctrl_c() -> Iterator[None]:
    """Threads and processes that begin here never see Ctrl-C: it ends this process, which then ends its workers."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # begun later, by multiprocessing, it would let Ctrl-C through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def check_scheduler(address: str) -> None:
    """BadInput where there is none."""
    with cluster_client(address, is_told=False):
        pass


@contextmanager
def cluster_client(address: str, is_told: bool = True) -> Iterator[Any]:
    """The cluster of a scheduler; BadInput where there is none. `is_told`: that it has no workers yet."""
    from distributed import Client

    _quiet()
    try:
        client = Client(address, timeout=CONNECT_S, name="laconic-sweep")
    except (OSError, ValueError, TimeoutError) as error:
        raise BadInput(f"--scheduler {address}: cannot be reached ({words_of(error, 'it does not answer')}); start "
                       "`dask scheduler` and give its address, such as tcp://127.0.0.1:8786") from None
    with client:
        if is_told and not client.nthreads():
            print(f"laconic: {address} has no workers yet; waits for them, Ctrl-C ends", file=sys.stderr, flush=True)
        yield client


def _quiet() -> None:
    """Dask tells of workers that come and go; what matters is told by this room."""
    for name in ("distributed", "distributed.nanny", "distributed.worker", "distributed.scheduler",
                 "distributed.core", "distributed.client", "tornado.application"):
        logging.getLogger(name).setLevel(logging.CRITICAL)


def usual_workers() -> int:
    """One for each core that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
