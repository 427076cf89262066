"""How long a sweep takes, told before it begins: its steps are known, the time of one is tried.

On a machine that is busy a few steps may be quick and all of them slow: `foretell_by` tells by chunks that are done.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable

import numpy as np

from laconic.base.progress import LONG_S, duration_text
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.simulation import advance_plant
from laconic.tools.sweep.plan import Plan

TRIED_STEPS, FEWEST_TRIED, TRIED_S = 32, 1024, 0.02
SHORT_STEPS = 1e6      # of a whole sweep: not worth a word
MOST_LOOKED_AT = 4096  # runs, evenly over the plan
LANES_GAIN, MANY = 4, 100  # how much less a step costs beside many others, about
DURATION, STEP = "run.duration_s", "run.step_s"


def steps_of_runs(plan: Plan, scene: Scene) -> np.ndarray:
    """Steps of the runs of a plan, or of so many evenly over it; 0 for what has no time or step."""
    count = min(plan.runs, MOST_LOOKED_AT)
    return steps_at(plan, scene, np.arange(count) * plan.runs // count)


def steps_at(plan: Plan, scene: Scene, index: np.ndarray) -> np.ndarray:
    """The same of these runs."""
    values, count = plan.values_at(index), len(index)
    usual = {DURATION: scene.run.duration_s, STEP: scene.run.step_s}
    duration, step = (np.broadcast_to(np.asarray(values.get(key, value), float), count) for key, value in usual.items())
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return np.where((duration > 0) & (step > 0), duration / step, 0.0)


def step_seconds(scene: Scene, clock: Callable[[], float] = time.perf_counter) -> float:
    """Seconds of one step of the scene's vehicle alone, about; 0 where it takes none."""
    plant, inputs, last = scene.plant(scene.core()), scene.inputs_on_grid(), scene.steps()
    taken, tried, best, spent = 0, TRIED_STEPS, math.inf, 0.0
    try:
        while taken < last and (spent < TRIED_S or tried < FEWEST_TRIED):  # ever more at once: the call counts less
            tried, began = min(2 * tried, last - taken), clock()
            advance_plant(plant, inputs, taken, tried)
            spent = clock() - began
            taken, best = taken + tried, min(best, spent / tried)
    except BadInput:  # a step that is refused: the sweep says so
        pass
    return 0.0 if math.isinf(best) else best


def foretell(plan: Plan, scene: Scene, share: float, in_lanes: bool, workers: int) -> bool:
    """One line on stderr where the `share` of a plan that is left takes long, and whether there was one; `workers`: 0,
    not known."""
    if float(steps_of_runs(plan, scene).mean()) * plan.runs * share < SHORT_STEPS:
        return False
    return foretell_by(tried_seconds(plan, scene, in_lanes), plan, scene, share, workers)


def tried_seconds(plan: Plan, scene: Scene, in_lanes: bool) -> float:
    """Seconds of one step of a sweep, about, by some that are tried."""
    return step_seconds(scene) / (LANES_GAIN if in_lanes and plan.runs >= MANY else 1)


def foretell_by(each_s: float, plan: Plan, scene: Scene, share: float, workers: int) -> bool:
    """The same by what a step takes."""
    steps = steps_of_runs(plan, scene)
    all_steps = float(steps.mean()) * plan.runs * share
    whole_s = max(all_steps * each_s / max(1, workers), float(steps.max()) * each_s)  # a run is one worker's
    if whole_s <= LONG_S:
        return False
    alone = "" if workers else " on one core"
    print(f"laconic: {plan.runs} runs, the longest of {steps.max():.3g} steps, take about "
          f"{duration_text(whole_s)}{alone}; Ctrl-C ends it and keeps what is done", file=sys.stderr, flush=True)
    return True
