"""Error against run time: every scene, method and scalar type at a ladder of steps, against the numpy reference.

What single precision must still deliver: S1's digits, a heading after 10⁹ turns, x and y after 10⁷ steps.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laconic.core import load
from laconic.core.estimate import Errors
from laconic.core.plant import Plant
from laconic.errors import BadInput, Refused
from laconic.scene import METHODS, Scene
from laconic.scene.ground import has_friction
from laconic.scene.methods import EXACT
from laconic.simulation import Watch, advance_plant
from laconic.tools.report.estimated import columns_of
from laconic.tools.verify.reference import reference_states

STEPS_S = (0.001, 0.002, 0.0025, 0.005, 0.01, 0.0125, 0.02, 0.025, 0.05, 0.1)
CHECKPOINTS = 20
GRID_S = 0.1  # every step of the ladder divides it
OWN_FACTORS = (0.1, 0.2, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0)  # of a step that does not divide it
LONGEST_S = 10.0
FINE_STEPS = 4000  # in the grid's spacing: forty times finer than the finest of the ladder
FINER = (1, 2, 3)  # times that, where such a step is refused
KINDS = {"error_nu": slice(0, 3), "error_pose": slice(3, 6), "error_wheel": slice(6, None)}
TIMED_STEPS, TIMED_REPETITIONS = 4000, 5


@dataclass(frozen=True)
class Truth:
    """The states of a scene at some instants."""

    at_s: np.ndarray
    states: np.ndarray
    error: dict[str, float] | None = None  # of each kind, where the reference is no better than its step


def shortened(scene: Scene, grid_s: float = GRID_S) -> Scene:
    """The scene's first ten seconds, as far as the last checkpoint."""
    return scene.with_run(duration_s=float(checkpoints(min(scene.run.duration_s, LONGEST_S), grid_s)[-1]))


def truth_of(scene: Scene, grid_s: float = GRID_S) -> Truth:
    """Reference states at evenly spaced instants."""
    at_s = checkpoints(scene.run.duration_s, grid_s)
    return fine_truth(scene, at_s, grid_s) if has_friction(scene.vehicle) else Truth(
        at_s, reference_states(scene, at_s))


def fine_truth(scene: Scene, at_s: np.ndarray, grid_s: float) -> Truth:
    """With friction no closed solution and no other routine is known: the same step, much finer.

    As that step is of first order, it is off by what it differs from a run of twice the step (Richardson). Refused
    where no such step is taken.
    """
    for finer in FINER:
        try:
            fine, coarser = (follow(scene.with_run(step_s=grid_s / (FINE_STEPS * finer) * factor), "double", at_s)
                             for factor in (1, 2))
        except Refused as refused:
            last = refused
            continue
        return Truth(at_s, fine, {kind: relative(coarser[:, part], fine[:, part]) for kind, part in KINDS.items()})
    raise last.at(scene.path)


def methods_of(scene: Scene, methods: tuple[str, ...]) -> tuple[str, ...]:
    """Those that can step the scene at all: with friction there is one."""
    return ("auto",) if has_friction(scene.vehicle) else methods


def checkpoints(duration_s: float, grid_s: float = GRID_S) -> np.ndarray:
    """At most twenty instants on a grid that every step of the ladder divides."""
    ticks = max(1, int(duration_s / grid_s + 1e-6))
    every = -(-ticks // CHECKPOINTS)
    return grid_s * every * np.arange(1, ticks // every + 1)


def ladder_of(scene: Scene) -> tuple[tuple[float, ...], float]:
    """Steps for a scene, its own among them, and the grid they divide: in milliseconds, else in parts of its own."""
    own, duration_s = scene.run.step_s, min(scene.run.duration_s, LONGEST_S)
    ticks = GRID_S / own
    if duration_s >= GRID_S and ticks >= 1.0 - 1e-9 and abs(ticks - round(ticks)) < 1e-6:
        return tuple(sorted({*STEPS_S, own})), GRID_S
    return tuple(own * factor for factor in OWN_FACTORS), own * min(10, max(1, int(duration_s / own + 1e-6)))


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest error over max(1, largest expected value); 0 for no components."""
    if not expected.size:
        return 0.0
    return float(np.max(np.abs(found - expected)) / max(1.0, float(np.max(np.abs(expected)))))


def state_row(plant: Plant) -> np.ndarray:
    """ν, x, y, θ, χ as the reference orders them, in double."""
    pose = plant.pose
    return np.concatenate([plant.nu, [pose.x_m, pose.y_m, pose.heading_rad], plant.wheel_angles()]).astype(float)


def follow(scene: Scene, real: str, at_s: np.ndarray, seen: list[Errors] | None = None) -> np.ndarray:
    """The core's states at some instants, one row each; with `seen` an estimate watches, which goes there."""
    plant, inputs, rows, done = scene.plant(load(real)), scene.inputs_on_grid(), [], 0
    watch = None if seen is None else Watch(plant.estimate())
    for tick in np.rint(at_s / scene.run.step_s).astype(int):
        advance_plant(plant, inputs, done, int(tick) - done, watch=watch)
        done = int(tick)
        rows.append(state_row(plant))
        if watch and seen is not None:
            seen.append(watch.estimate.read())
    return np.array(rows)


def fits(scene: Scene, truth: Truth) -> bool:
    """Whether the step divides the checkpoints and the inputs' changes."""
    ticks = truth.at_s / scene.run.step_s
    if np.max(np.abs(ticks - np.rint(ticks))) > 1e-6:
        return False
    try:
        scene.inputs_on_grid()
    except BadInput:
        return False
    return True


def seconds_per_step(scene: Scene, real: str) -> float:
    """Thread CPU time of one step with its inputs held, the least of some runs."""
    core, best = load(real), float("inf")
    held = core.input(scene.inputs_on_grid().held_at(0))
    for _ in range(TIMED_REPETITIONS):
        plant = scene.plant(core)
        start = time.thread_time_ns()
        plant.run(held, TIMED_STEPS)
        best = min(best, (time.thread_time_ns() - start) * 1e-9 / TIMED_STEPS)
    return best


def cost_per_step(scene: Scene, real: str, method: str) -> float:
    """The same, from the first step of the ladder that is not refused; nan where none is taken."""
    for step_s in STEPS_S:
        try:
            return seconds_per_step(scene.with_run(method=method, step_s=step_s), real)
        except (Refused, BadInput):
            continue
    return float("nan")


def one_run(scene: Scene, real: str, truth: Truth) -> dict[str, Any]:
    """Errors of one run, or the refusal."""
    row: dict[str, Any] = {"scene": scene.path.stem, "real": real, "method": scene.run.method,
                           "step_s": scene.run.step_s}
    seen: list[Errors] = []
    try:
        states = follow(scene, real, truth.at_s, seen)
    except Refused as refused:
        return row | {"status": refused.status}
    errors: dict[str, Any] = {name: relative(states[:, part], truth.states[:, part]) for name, part in KINDS.items()}
    if truth.error:
        errors["reference_error_nu"] = truth.error["error_nu"]
    return row | {"status": "ok"} | errors | columns_of(seen, truth.states)


def rows_of(scene: Scene, reals: tuple[str, ...], methods: tuple[str, ...] = METHODS,
            advance: Any = lambda: None, ladder: tuple[float, ...] = STEPS_S,
            grid_s: float = GRID_S) -> list[dict[str, Any]]:
    """The whole ladder of one scene."""
    short, rows = shortened(scene, grid_s), []
    try:
        truth = truth_of(short, grid_s)
    except Refused as refused:
        advance(len(reals) * len(methods_of(scene, methods)))
        return [{"scene": scene.path.stem, "real": real, "method": method, "step_s": scene.run.step_s,
                 "status": "no reference", "why": str(refused)} for real in reals
                for method in methods_of(scene, methods)]
    steps = [h for h in ladder if fits(replace(short, run=replace(short.run, step_s=h)), truth)]
    for real in reals:
        for method in methods_of(scene, methods):
            cost = cost_per_step(short, real, method)
            for step_s in steps:
                row = one_run(short.with_run(method=method, step_s=step_s), real, truth)
                rows.append(row | {"ns_per_step": cost * 1e9, "us_per_second": cost * 1e6 / step_s})
            advance()
    return rows


TURNS, LONG_STEPS, LONG_STEP_S = 10**9, 10_000_000, 1e-3


def s1_rows(scene: Scene, methods: tuple[str, ...]) -> list[dict[str, Any]]:
    """Absolute error of ν in single precision: at S1's end, and the largest at its half seconds."""
    ends = np.linspace(0.0, scene.run.duration_s, 21)[1:]
    rows = []
    for step_s in (0.01, 0.001):
        fixed = scene.with_run(step_s=step_s)
        truth = reference_states(fixed, ends)
        for method in methods:
            found = follow(fixed.with_run(method=method), "single", ends)
            error = np.max(np.abs(found[:, :3] - truth[:, :3]), axis=1)
            rows.append({"method": method, "step_s": step_s, "error_nu": float(error[-1]), "error_anywhere":
                         float(np.max(error)), "largest_nu": float(np.max(np.abs(truth[:, :3])))})
    return rows


def heading_after_many_turns(scene: Scene, steps: int = 1000) -> bool:
    """Whether a heading a billion turns on advances by the same bits as one that starts at zero."""
    core = load("single")
    near, far = (scene.with_run(step_s=0.01).plant(core) for _ in range(2))
    far.c.state.heading.turns = TURNS
    held = core.input(scene.with_run(step_s=0.01).inputs_on_grid().held_at(0))
    for plant in (near, far):
        plant.run(held, steps)
    a, b = near.c.state.heading, far.c.state.heading
    return a.fraction == b.fraction and a.rest == b.rest and b.turns - a.turns == TURNS


def straight_run(scene: Scene, speed: float = 0.7) -> dict[str, float]:
    """Ten million steps straight ahead in single precision: relative error of x."""
    core = load("single")
    free = {**scene.vehicle, "motor_gain_Nm_per_V": 0.0, "motor_damping_Nms": 0.0}
    plant = core.plant(core.vehicle(free), EXACT, LONG_STEP_S, nu_rad_per_s=(speed, 0.0, 0.0), x_m=100.0)
    plant.run(core.input(), LONG_STEPS)
    travelled = float(np.float32(LONG_STEP_S)) * LONG_STEPS * float(np.float32(speed)) * scene.vehicle["wheel_radius_m"]
    expected = 100.0 + travelled
    return {"expected_m": expected, "found_m": float(plant.pose.x_m), "error": abs(plant.pose.x_m / expected - 1.0)}
