"""`step_s = "auto"`: the largest step of a fixed grid whose run errs by no more than `tolerance`, found before the run.

A pilot runs the scene with its own inputs by steps of 5, 2 and 1 times a power of ten, the largest first, each watched
by the core's error estimate. What is found is a number like one in the file: runs, FMUs and firmware get it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from laconic.base.progress import progress_bar
from laconic.core.estimate import NAMES, Errors
from laconic.errors import BadInput, Refused

if TYPE_CHECKING:
    from laconic.scene.scene import Scene
    from laconic.simulation.articulated import HingeErrors

AUTO = "auto"
LARGEST_TOLERANCE = 1.0
LONGEST_S = 1.0
CHUNK = 1 << 18         # steps between two checks for Ctrl-C
IMPROVES = 0.7          # a finer step errs by less than this share of the best
ROWS = 100              # of the errors of a pilot with hinges
ROUNDING = 1e-11        # in such a run
MOST_WITH_HINGES = 100_000  # steps
MOST_STEPS = 2_000_000  # of a pilot: some seconds
DIGITS = ("5", "2", "1")
UNITS = dict(zip(NAMES, ("rad/s of ν", "m of the place", "rad of the heading", "rad of a wheel"), strict=True))
UNITS |= {"velocity_m_per_s": "m/s of the velocity", "yaw_rate_rad_per_s": "rad/s of the yaw rate",
          "hinge_rate_rad_per_s": "rad/s of a hinge", "hinge_angle_rad": "rad of a hinge"}


@dataclass(frozen=True)
class Pilot:
    """One run of a pilot: the largest estimated error of each kind, and where it ended."""

    step_s: float
    errors: Errors | HingeErrors
    end: np.ndarray

    def worst(self) -> tuple[float, str]:
        """The largest of the errors, and what it is of."""
        return max((error, UNITS[name]) for name, error in asdict(self.errors.largest).items())

    def apart(self, other: Pilot) -> float:
        """How far the ends of two are from each other."""
        return float(np.max(np.abs(self.end - other.end)))


def candidates(duration_s: float, most_steps: int = MOST_STEPS) -> Iterator[float]:
    """The grid, from the largest step down."""
    for exponent in range(0, -9, -1):
        for digit in DIGITS:
            step_s = float(f"{digit}e{exponent}")
            if step_s <= min(LONGEST_S, duration_s) and duration_s / step_s <= most_steps:
                yield step_s


@lru_cache(maxsize=64)
def _found(key: tuple[object, ...], scene: _Shown, tolerance: float) -> float:
    return largest_step_s(scene.scene, tolerance)


class _Shown:
    """A scene that counts as equal to any other: the key beside it tells them apart."""

    def __init__(self, scene: Scene):
        self.scene = scene

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Shown)

    def __hash__(self) -> int:
        return 0


def chosen_step_s(scene: Scene, tolerance: float) -> float:
    """The step for a scene, found once for each content."""
    key = (repr(scene.vehicle), scene.initial, scene.inputs, scene.run.duration_s, scene.run.method, scene.run.real,
           scene.outputs.every_s, repr(scene.sensors))
    return _found(key, _Shown(scene), tolerance)


def largest_step_s(scene: Scene, tolerance: float) -> float:
    """The largest step of the grid that keeps the tolerance; BadInput where none does, with the least error found."""
    best: Pilot | None = None
    last: BadInput | None = None
    steps = list(candidates(scene.run.duration_s, MOST_WITH_HINGES if scene.has_hinges else MOST_STEPS))
    with progress_bar(f"{scene.name}: a step for the tolerance {tolerance:g}", len(steps)) as moved:
        for step_s in steps:
            moved(1)
            try:
                pilot = run_pilot(scene, step_s)
            except BadInput as refused:  # also what the core refuses, as an explicit method a long step
                last = refused
                continue
            error = pilot.worst()[0]
            if error <= tolerance and is_confirmed(scene, pilot, tolerance):
                return step_s
            if best is not None and error > IMPROVES * best.worst()[0] and rounding_of(pilot) > tolerance:
                break  # finer steps round as much
            best = pilot if best is None or error < best.worst()[0] else best
    raise without_step(scene, tolerance, best, last)


def rounding_of(pilot: Pilot) -> float:
    """What of the errors no step makes smaller; a guess where it is not known apart from the rest."""
    if not isinstance(pilot.errors, Errors):
        return ROUNDING
    return max(getattr(pilot.errors.rounding, name) for name in NAMES)


def without_step(scene: Scene, tolerance: float, best: Pilot | None, last: BadInput | None) -> BadInput:
    """Why there is none, and what would do."""
    if best is None:
        return BadInput(f"{scene.path}: run.step_s: no step of 1, 2 or 5 times a power of ten fits this run; give a "
                        f"number ({str(last).removeprefix(f'{scene.path}: ')})")
    error, unit = best.worst()
    return BadInput(f"{scene.path}: run.tolerance: {tolerance:g} is kept by no step of 1, 2 or 5 times a power of ten; "
                    f"the least error found is {error:.1e} {unit}, at {best.step_s:g} s: give {1.1 * error:.1e} or "
                    "more")


def run_pilot(scene: Scene, step_s: float) -> Pilot:
    """The scene's run in one step size; BadInput where it does not fit, or a step is refused."""
    run = scene.with_step(step_s)
    if scene.has_hinges:
        return run_hinged_pilot(run)
    plant, inputs, steps = run.plant(run.core()), run.inputs_on_grid(), run.steps()
    run.delay_steps(plant.core)
    for interval_s in filter(None, [run.outputs.every_s]):
        run.steps_in("outputs.every_s", interval_s)
    estimate = plant.estimate()
    try:
        while plant.steps < steps:
            schedule, end = inputs.schedule(plant.core, plant.steps)
            estimate.follow(schedule, min(steps, end, plant.steps + CHUNK))
    except Refused as refused:
        raise run.refusal_in_file(refused, f"at t = {plant.steps * step_s:g} s") from None
    errors = estimate.read()
    if errors.unknown:
        raise BadInput(f"{scene.path}: run.step_s: half a step of {step_s:g} s is refused in {errors.unknown} windows")
    pose = plant.pose
    return Pilot(step_s, errors, np.array([*plant.nu, pose.x_m, pose.y_m, pose.heading_rad, *plant.wheel_angles()]))


def run_hinged_pilot(run: Scene) -> Pilot:
    """The same for a vehicle with hinges, with a row of errors a hundred times in the run."""
    from laconic.simulation.articulated import run_with_hinges  # which reads scenes

    steps, step_s = run.steps(), run.run.step_s
    for interval_s in filter(None, [run.outputs.every_s]):
        run.steps_in("outputs.every_s", interval_s)
    try:
        found = run_with_hinges(run, ("x_m",), max(1, steps // ROWS), lambda amount: None, estimated=True)
    except Refused as refused:
        raise run.refusal_in_file(refused, "") from None
    if found.refused or found.parts is None:
        raise BadInput(str(found.refused))
    errors, motion = found.parts.read(), found.plant.motion()
    if errors.unknown:
        raise BadInput(f"{run.path}: run.step_s: a third of a step of {step_s:g} s is refused")
    return Pilot(step_s, errors, np.array([
        *motion.velocity_m_per_s, motion.yaw_rate_rad_per_s, motion.x_m, motion.y_m, motion.heading_rad,
        *motion.hinge_angle_rad, *motion.hinge_rate_rad_per_s, *motion.wheel_angle_rad]))


def is_confirmed(scene: Scene, pilot: Pilot, tolerance: float) -> bool:
    """Inputs that vary between samples make errors that half steps do not see: there a finer step is compared."""
    if all(each.kind == "steps" for each in scene.inputs):
        return True
    for step_s in candidates(scene.run.duration_s):
        if step_s < pilot.step_s:
            try:
                return pilot.apart(run_pilot(scene, step_s)) <= tolerance
            except BadInput:
                continue
    return False
