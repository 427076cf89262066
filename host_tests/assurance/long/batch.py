"""Lanes of made-up vehicles beside the same vehicles alone: bits, refusals and steps not taken, in every width of
registers, every method and both scalar types."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from assurance.common import Clock
from laconic.batch import Batch
from laconic.core import Vehicle, load
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene.methods import EXPLICIT
from laconic.tools.verify.exact.trials import INPUTS, KINDS, Trial, made_up, plant_of

LANES, RUNS, MOST_STEPS = 48, 4, 60
FAST, LOST = 0.1, 0.02  # shares of lanes that start too fast for most steps, and that have an input of NaN


def run_batch(clock: Clock, seed: int) -> list[str]:
    """Populations until the time is over, one at least."""
    random, counted, wrong = np.random.default_rng(seed), Counter[str](), list[str]()
    while not counted or clock:
        wrong += population(random, counted)
    print("  " + ", ".join(f"{count} {what}" for what, count in sorted(counted.items())))
    return wrong


def population(random: np.random.Generator, counted: Counter[str]) -> list[str]:
    """Some vehicles in all widths; the lanes that differ."""
    core = load(str(random.choice(["double", "single"])))
    method, step_s = str(random.choice(core.method_names)), float(10 ** random.uniform(-3, -0.5))
    alone = [each for each in (drawn(random, core, method, step_s) for _ in range(LANES)) if each is not None]
    if not alone:
        return []
    vehicles = [Vehicle(trial.table, core.real) for trial, _ in alone]
    widths = [width for width in (1, 16, 32, 64) if core.lib.laconic_batch_width(width) == width]
    batches = [Batch(vehicles, None, method, step_s, width_bytes=width) for width in widths]
    for batch in batches:
        for lane, (trial, plant) in enumerate(alone):
            batch.load(lane, plant.save())
            set_inputs(batch, lane, trial)
    missed, found = np.zeros(len(alone), dtype=np.uint64), list[str]()
    for _ in range(RUNS):
        steps = int(random.integers(1, MOST_STEPS))
        statuses = [taken(plant, trial, steps) for trial, plant in alone]
        missed += np.array([left for _, left in statuses], dtype=np.uint64)
        counted["refused"] += sum(status != 0 for status, _ in statuses)
        for width, batch in zip(widths, batches, strict=True):
            batch.run(steps)
            for lane, ((trial, plant), (status, _)) in enumerate(zip(alone, statuses, strict=True)):
                counted[f"lane steps in {width} bytes"] += steps
                if not is_alike(batch, lane, plant, status, int(missed[lane])):
                    found.append(f"lane {lane} in {width} bytes, {core.real}, {method}, {step_s} s: {trial}")
    return found


def drawn(random: np.random.Generator, core: Any, method: str, step_s: float) -> tuple[Trial, Plant] | None:
    """A vehicle at its start; None where the method refuses it."""
    made = made_up(random, str(random.choice(KINDS)), str(random.choice([EXPLICIT, method])))
    nu = [value * 1e3 for value in made.nu] if random.random() < FAST else made.nu
    held = dict(made.held) | ({"body_moment_Nm": [float("nan")]} if random.random() < LOST else {})
    trial = Trial(made.kind, method, made.table, step_s, nu, made.heading_rad, held)
    try:
        return trial, plant_of(core, trial)
    except Refused:
        return None


def set_inputs(batch: Batch, lane: int, trial: Trial) -> None:
    for name in INPUTS:
        row, values = getattr(batch, name), trial.held[name]
        if row.ndim == 1:
            row[lane] = values[0]
        else:
            row[:len(values), lane] = values


def taken(plant: Plant, trial: Trial, steps: int) -> tuple[int, int]:
    """Takes the steps that can be taken; the status of the next one, and how many were not taken."""
    core, c = plant.core, plant.c
    at = [core.ffi.addressof(c, name) for name in ("model", "integrator", "state")]
    held, status = core.ffi.new("laconic_input *"), core.ffi.new("laconic_status *")
    for name in INPUTS:
        values = trial.held[name]
        if name == "body_moment_Nm":
            held.body_moment_Nm = values[0]
        else:
            getattr(held, name)[0:len(values)] = values
    done = core.lib.laconic_run(*at, held, steps, status)
    return int(status[0]), steps - int(done)


def is_alike(batch: Batch, lane: int, plant: Plant, status: int, missed: int) -> bool:
    """Whether the lane has the state, the status and the missed steps of its vehicle alone."""
    ffi = batch.core.ffi
    state = bytes(ffi.buffer(batch.state(lane)))
    expected = bytes(ffi.buffer(ffi.addressof(plant.c, "state")))
    return state == expected and int(batch.status[lane]) == status and int(batch.missed[lane]) == missed
