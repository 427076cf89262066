"""Confirms by simulating with the core what the analysis finds about steady motions and limit cycles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from laconic.core.inputs import FOR_EVER, Schedule
from laconic.core.plant import Plant
from laconic.core.recording import Recorder
from laconic.tools.analyse.cycle import LimitCycle
from laconic.tools.analyse.field import Field
from laconic.tools.analyse.from_core import Inputs, Subject
from laconic.tools.analyse.steady import SteadyMotion

STEPS_PER_FASTEST = 60  # steps per 1/|fastest eigenvalue|
MOST_STEPS = 2_000_000  # of a steady motion's simulation: beyond, rounding and the method's error hide the motion
MOST_PERIODS = 4000     # of a cycle's
SAMPLES = 24            # of a cycle's period, where the distance from the steady motion is measured
CLEAR_GROWTH = 4.0      # growth times periods after which a motion has clearly left a cycle, or returned
NU = tuple(f"nu_rad_per_s[{k}]" for k in (1, 2, 3))


@dataclass(frozen=True)
class Confirmation:
    """The outcome of a simulation with the core."""

    holds: bool
    words: str
    simulated: bool = True  # False: a simulation cannot confirm or refute it


def plant_at(subject: Subject, nu: np.ndarray, step_s: float) -> Plant:
    """The vehicle in the core, at a ν that its constraints allow."""
    return subject.core.plant(subject.vehicle, "auto", step_s, nu_rad_per_s=[float(v) for v in nu])


def step_for(field: Field, zeta: np.ndarray) -> float:
    """A step that resolves the fastest rate around a state."""
    fastest = float(np.abs(np.linalg.eigvals(field.jacobian(zeta))).max())
    return 1.0 / (STEPS_PER_FASTEST * max(fastest, 1e-3))


def steady_motion(subject: Subject, inputs: Inputs, field: Field, motion: SteadyMotion) -> Confirmation:
    """A small push along the slowest (or the growing) eigenvector becomes exp(J t) times itself, as linearised."""
    if motion.stability == "neutral":
        return Confirmation(True, "neutral: not simulated", simulated=False)
    jacobian = field.jacobian(motion.zeta)
    values, vectors = np.linalg.eig(jacobian)
    k = int(np.argmax(values.real))
    duration = 1.0 / abs(float(values[k].real))
    steps = max(int(np.ceil(duration / step_for(field, motion.zeta))), 1)
    if steps > MOST_STEPS:
        return Confirmation(True, f"a push takes {duration:.3g} s to change: too long to confirm by simulating", False)
    push = 1e-6 * max(1.0, float(np.abs(motion.zeta).max())) * (vectors[:, k].real / np.linalg.norm(vectors[:, k].real))
    plant = plant_at(subject, field.nu(motion.zeta + push), duration / steps)
    plant.run(subject.core.input(inputs), steps)
    after, expected = field.zeta(plant.nu) - motion.zeta, expm(jacobian * duration) @ push
    holds = bool(np.linalg.norm(after - expected) < 0.02 * np.linalg.norm(expected))
    size = np.linalg.norm(push)
    words = (f"core: a small push times {np.linalg.norm(after) / size:.4g} in {duration:.3g} s, linearised: "
             f"{np.linalg.norm(expected) / size:.4g}")
    return Confirmation(holds, words)


def limit_cycle(subject: Subject, inputs: Inputs, field: Field, cycle: LimitCycle, centre: np.ndarray) -> Confirmation:
    """One period leads back; from inside the motion returns to the steady one, from outside it leaves."""
    step_s = cycle.period_s / max(400, int(np.ceil(cycle.period_s / step_for(field, centre))))
    steps = int(round(cycle.period_s / step_s))
    start = field.nu(cycle.start_zeta)
    plant = plant_at(subject, start, step_s)
    held = subject.core.input(inputs)
    plant.run(held, steps)
    gap = float(np.abs(plant.nu - start).max()) / cycle.size
    if growth_per_period(cycle) * MOST_PERIODS < CLEAR_GROWTH:
        return Confirmation(bool(gap < 1e-5), f"core: one period closes to {gap:.1e} of the cycle's size; motions "
                                              "beside it change too slowly to confirm by simulating")
    inside, outside = (distance_after(subject, inputs, field, cycle, centre, share, step_s) for share in (0.9, 1.1))
    leaves = inside < 0.5 < 1.5 < outside
    holds = bool(gap < 1e-5 and (cycle.stable or leaves))
    words = (f"core: one period closes to {gap:.1e} of the cycle's size; started at 0.9 of it the distance goes to "
             f"{inside:.2g},"
             f" at 1.1 to {outside:.2g} of the cycle's size")
    return Confirmation(holds, words)


def growth_per_period(cycle: LimitCycle) -> float:
    """How fast motions beside a cycle leave it, or returned: |ln| of the largest multiplier but the one along it."""
    along = int(np.argmin(np.abs(cycle.multipliers - 1.0)))
    return abs(float(np.log(np.abs(np.delete(cycle.multipliers, along)).max(initial=1e-300))))


def distance_after(subject: Subject, inputs: Inputs, field: Field, cycle: LimitCycle, centre: np.ndarray, share: float,
                   step_s: float) -> float:
    """Distance from the steady motion, over the cycle's size, after a start at `share` of the cycle's way from it.

    Runs until the distance has fallen below 0.3 or risen above 2 at its largest over a period, or long enough.
    """
    plant = plant_at(subject, field.nu(centre + share * (cycle.start_zeta - centre)), step_s)
    row = subject.core.input_row(inputs, plant.wheel_count)
    held = Schedule(subject.core, range(len(row)), row[None], [FOR_EVER])
    middle, steps = field.nu(centre), max(1, int(round(cycle.period_s / step_s / SAMPLES)))
    periods = int(min(MOST_PERIODS, 40.0 / max(growth_per_period(cycle), 1e-3)))
    largest = 0.0
    for _ in range(periods):
        largest = float(np.abs(sampled_nu(plant, held, steps) - middle).max()) / cycle.size
        if not 0.3 < largest < 2.0:
            break
    return largest


def sampled_nu(plant: Plant, held: Schedule, steps: int) -> np.ndarray:
    """ν after each of SAMPLES runs of so many steps, one row each."""
    recorder = Recorder(plant, NU, steps, SAMPLES + 1)  # it begins with the row at the start
    plant.follow(held, plant.steps + SAMPLES * steps, recorder)
    recorder.take_last(plant.input_of(None))
    return np.column_stack(list(recorder.columns().values()))[1:]
