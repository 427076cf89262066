"""Lanes of made-up vehicles beside the same vehicles alone: bits, refusals and steps not taken, in every width of
registers, every method and both scalar types."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

from laconic.batch import Batch
from laconic.core import Vehicle, load
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.verification.derivatives.trials import INPUTS, KINDS, Trial, made_up, plant_of

LANES = 48
RUNS, MOST_STEPS = 4, 60   # of one population
FAST, LOST = 0.1, 0.02     # shares of lanes that start too fast for most steps, and that have an input of NaN
MOST_WRONG = 20            # told


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Populations until the time is over; passed when every lane has the bits of its vehicle alone."""
    random = np.random.default_rng(seed)
    counted: Counter[str] = Counter()
    wrong: list[str] = []
    begin = last = time.monotonic()
    while last - begin < 60.0 * minutes:
        wrong += _population(random, counted)
        now = time.monotonic()
        advance(now - last)
        last = now
    return {"passed": not wrong, **dict(sorted(counted.items())), "wrong": wrong[:MOST_WRONG]}


def _population(random: np.random.Generator, counted: Counter[str]) -> list[str]:
    core = load(str(random.choice(["double", "single"])))
    method, step_s = str(random.choice(core.method_names)), float(10 ** random.uniform(-3, -0.5))
    drawn = [_drawn(random, core, method, step_s) for _ in range(LANES)]
    alone = [each for each in drawn if each is not None]
    if not alone:
        return []
    vehicles = [Vehicle(trial.table, core.real) for trial, _ in alone]
    widths = [width for width in (1, 16, 32, 64) if core.lib.laconic_batch_width(width) == width]
    batches = [Batch(vehicles, None, method, step_s, width_bytes=width) for width in widths]
    for batch in batches:
        for lane, (trial, plant) in enumerate(alone):
            batch.load(lane, plant.save())
            _set_inputs(batch, lane, trial)
    missed, found = np.zeros(len(alone), dtype=np.uint64), []
    for _ in range(RUNS):
        steps = int(random.integers(1, MOST_STEPS))
        statuses = [_run(plant, trial, steps) for trial, plant in alone]
        missed += np.array([left for _, left in statuses], dtype=np.uint64)
        counted["steps"] += steps * len(alone)
        counted["refused"] += sum(status != 0 for status, _ in statuses)
        for width, batch in zip(widths, batches, strict=True):
            batch.run(steps)
            for lane, ((trial, plant), (status, _)) in enumerate(zip(alone, statuses, strict=True)):
                counted[f"lane steps in {width} bytes"] += steps
                if not _alike(batch, lane, plant, status, int(missed[lane])):
                    found.append(f"lane {lane} in {width} bytes, {core.real}, {method}, {step_s} s: {trial}")
    return found


def _drawn(random: np.random.Generator, core: Any, method: str, step_s: float) -> tuple[Trial, Plant] | None:
    """A vehicle that stands at its start; None where the method refuses it."""
    drawn = made_up(random, str(random.choice(KINDS)), str(random.choice(["rk4", method])))
    nu = [value * 1e3 for value in drawn.nu] if random.random() < FAST else drawn.nu
    held = dict(drawn.held)
    if random.random() < LOST:
        held["body_moment_Nm"] = [float("nan")]
    trial = Trial(drawn.kind, method, drawn.table, step_s, nu, drawn.heading_rad, held)
    try:
        return trial, plant_of(core, trial)
    except Refused:
        return None


def _set_inputs(batch: Batch, lane: int, trial: Trial) -> None:
    for name in INPUTS:
        row, values = getattr(batch, name), trial.held[name]
        if row.ndim == 1:
            row[lane] = values[0]
        else:
            row[:len(values), lane] = values


def _run(plant: Plant, trial: Trial, steps: int) -> tuple[int, int]:
    """Takes the steps that can be taken; why not the next, and how many were not."""
    core, c = plant.core, plant.c
    at = [core.ffi.addressof(c, name) for name in ("model", "integrator", "state")]
    held, status = core.ffi.new("laconic_input *"), core.ffi.new("laconic_status *")
    for name in INPUTS:
        values = trial.held[name]
        if name == "body_moment_Nm":
            held.body_moment_Nm = values[0]
        else:
            getattr(held, name)[0:len(values)] = values
    taken = core.lib.laconic_run(*at, held, steps, status)
    return int(status[0]), steps - int(taken)


def _alike(batch: Batch, lane: int, plant: Plant, status: int, missed: int) -> bool:
    ffi = batch.core.ffi
    state = bytes(ffi.buffer(batch.state(lane)))
    expected = bytes(ffi.buffer(ffi.addressof(plant.c, "state")))
    return state == expected and int(batch.status[lane]) == status and int(batch.missed[lane]) == missed
