"""A sweep from its plan to its results, whatever interrupts it on the way."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np

from laconic.base.progress import progress_bar
from laconic.errors import BadInput, Refused
from laconic.scene import Scene
from laconic.tools.measures.measure import lacks
from laconic.tools.sweep.chunk import Rows, nominal_course
from laconic.tools.sweep.effort import foretell, foretell_by, steps_at, steps_of_runs, tried_seconds
from laconic.tools.sweep.lanes import Template
from laconic.tools.sweep.numbers import is_number_of_struct
from laconic.tools.sweep.plan import Plan
from laconic.tools.sweep.store import Store, open_store
from laconic.tools.sweep.workers import (
    check_scheduler,
    cluster_client,
    local_client,
    run_here,
    run_on,
    usual_workers,
    versions,
)

STEPS_OF_LANES = 1e7  # of a chunk: a second or so
STEPS_ALONE = 5e5
MOST_RUNS_OF_CHUNK = 65536
MOST_RUNS_ALONE = 500   # each is read from its tables, which takes a millisecond
CHUNKS_HERE = 2         # before other processes begin: the first also makes ready, the second shows how long one takes
LONGEST_HERE_S = 3.0    # of both, about
OF_TIME = ("run.duration_s", "run.step_s")


def check_plan(plan: Plan) -> Scene:
    """The nominal scene; BadInput for keys or measures that make no sense for it."""
    scene = plan.tables.scene()
    for measure in plan.measures:
        if missing := lacks(measure, scene):
            raise BadInput(f"--measure {measure.text}: needs {missing}, which {plan.tables.path} does not give")
        for key in OF_TIME:
            if measure.is_beside_nominal and not measure.is_of_end and key in [each.key.text for each in plan.varied]:
                raise BadInput(f"--measure {measure.text}: compares the same instants, and --vary changes {key}; leave "
                               "one of them out")
    tries = [_first_refusal(plan, index) for index in {0, plan.runs // 2, plan.runs - 1}]
    if all(isinstance(each, BadInput) and not isinstance(each, Refused) for each in tries) and tries[0]:
        raise tries[0]
    return scene


def _first_refusal(plan: Plan, index: int) -> BadInput | None:
    try:
        plan.tables.with_values(plan.of_run(index)).scene()
    except BadInput as refused:
        return refused
    return None


def chunk_of(plan: Plan, scene: Scene) -> int:
    """Runs of one chunk: about a second of work."""
    steps = max(1.0, float(steps_of_runs(plan, scene).mean()))
    if goes_in_lanes(plan, scene):
        return int(np.clip(STEPS_OF_LANES / steps, 1, MOST_RUNS_OF_CHUNK))
    return int(np.clip(STEPS_ALONE / steps, 1, MOST_RUNS_ALONE))


def goes_in_lanes(plan: Plan, scene: Scene) -> bool:
    """Whether runs go side by side."""
    keys = [each.key for each in plan.varied]
    return Template(plan.tables, scene).fits(plan.measures) and any(is_number_of_struct(key, keys) for key in keys)


def command_of(plan: Plan) -> str:
    """The command line that makes the same results; where to and by whom is left out."""
    words = ["laconic", "sweep", plan.scene]
    for each in plan.varied:
        words += ["--vary", each.text]
    if plan.drawn:
        words += ["--samples", str(plan.samples), "--seed", str(plan.seed)]
        words += ["--sensitivity"] if plan.is_saltelli else ["--sampling", plan.sampling]
    for measure in plan.measures:
        words += ["--measure", measure.text]
    return shlex.join(words)


def begin(plan: Plan, folder: Path, scheduler: str | None = None) -> Store:
    """The folder of results, fresh or with what is done already; nothing is made where the scheduler is not there."""
    scene = check_plan(plan)
    nominal_course(plan)  # refuses a scene that does not run itself
    if scheduler and not folder.is_dir():
        check_scheduler(scheduler)
    return open_store(folder, plan, chunk_of(plan, scene), versions(), command_of(plan))


def carry_on(store: Store, scheduler: str | None = None, workers: int | None = None) -> None:
    """Does what is missing, and makes one file of all; raises whatever ends it before, with all chunks kept."""
    if store.is_whole:
        return
    chunks = store.missing()
    done_before = runs_there(store)
    is_told = _foretell(store, scheduler, workers)
    with progress_bar(store.plan.tables.path.stem, store.plan.runs) as moved:
        moved(done_before)

        def values_of(number: int) -> dict[str, np.ndarray]:
            return store.plan.values(*store.range_of(number))

        def done(number: int, rows: Rows) -> None:
            store.keep(number, values_of(number), rows)
            moved(store.range_of(number)[1])

        if scheduler:
            with cluster_client(scheduler) as client:
                run_on(client, store.plan, values_of, chunks, done)
        elif len(chunks) <= 1 or workers == 0:
            run_here(store.plan, values_of, chunks, done)
        else:
            chunks = chunks[_some_here(store, chunks, values_of, done, 0 if is_told else workers or usual_workers()):]
            with local_client(min(workers or usual_workers(), len(chunks))) as client:
                run_on(client, store.plan, values_of, chunks, done)
    store.finish()


def _foretell(store: Store, scheduler: str | None, workers: int | None) -> bool:
    """Tells how long the rest takes, if that is long, and whether it did."""
    scene = store.plan.tables.scene()
    at_once = 0 if scheduler else max(1, usual_workers() if workers is None else workers)
    return foretell(store.plan, scene, _share_left(store), goes_in_lanes(store.plan, scene), at_once)


def _share_left(store: Store) -> float:
    return 1.0 - runs_there(store) / store.plan.runs


def _some_here(store: Store, chunks: list[int], values_of: Callable[[int], dict[str, np.ndarray]],
               done: Callable[[int, Rows], None], workers: int) -> int:
    """Does the first chunks, if they are short, while no other process is there yet: whatever ends the program then
    keeps them. By the last of them tells how long the rest takes on so many workers; 0: that is told. How many."""
    scene, here = store.plan.tables.scene(), chunks[:min(CHUNKS_HERE, len(chunks) - 1)]
    steps = [float(steps_at(store.plan, scene, np.arange(first, first + count)).sum())
             for first, count in map(store.range_of, here)]
    if sum(steps) * tried_seconds(store.plan, scene, goes_in_lanes(store.plan, scene)) > LONGEST_HERE_S:
        return 0
    for number in here:
        began = perf_counter()
        run_here(store.plan, values_of, [number], done)
        each_s = (perf_counter() - began) / max(steps.pop(0), 1.0)
    if workers and len(here) == CHUNKS_HERE:
        foretell_by(each_s, store.plan, scene, _share_left(store), workers)
    return len(here)


def runs_there(store: Store) -> int:
    """How many runs of a sweep are done."""
    return store.plan.runs - sum(store.range_of(number)[1] for number in store.missing())
