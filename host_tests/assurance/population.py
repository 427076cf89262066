"""Made-up vehicles, six kinds of wheels, damping from usual to a million times that, and their true motion: errors of
`auto` and of a method of fourth order at 1 ms and 10 ms, and their error estimates beside the errors.

    population [--vehicles N] [--seed S] [--real double|single] [--method A,B]

The true motion is found in 50 digits; where damping is at most a thousand times the usual it is enclosed as well, and
the 50 digits must lie inside."""

from __future__ import annotations

import argparse
import math
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb

from laconic.core import Core, load
from laconic.core.estimate import Errors, ErrorSizes
from laconic.core.plant import Plant
from laconic.errors import Refused, ResultFails
from laconic.scene.methods import STIFF_4
from laconic.tools.enclosure.balls import Vector, ball, precision, times
from laconic.tools.enclosure.equation import Stretch, equation_of
from laconic.tools.enclosure.motion import Motion
from laconic.tools.enclosure.state import Beginning
from laconic.tools.report.collocation import exact_start, true_states
from laconic.tools.verify.exact.trials import INPUTS, Trial, held_inputs, made_up, plant_of

Held = dict[str, list[float]]
Row = dict[str, Any]

WHEELS = ("omni", "mecanum", "drive", "own", "locked", "mixed")
DECADES = 6                       # of damping
TICK_S = {"double": Fraction(0.01), "single": Fraction(5368710, 2**29)}
"""Ten milliseconds: in both scalar types a number, as is the tenth of it, to the last bit."""
INSTANTS = ((1, 5), (6, 10))      # in ticks, when states are compared; the inputs change after the fifth
MOST_ENCLOSED = 1e3               # times the usual damping
GOAL_BITS, GUARD_BITS = 100, 48
AGREE = 1e-20                     # of 50 digits with an enclosure, beyond its radius, relative to the largest number
KINDS = {"nu": slice(0, 3), "pose": slice(3, 6), "wheel": slice(6, None)}
STEPS_S = (0.001, 0.01)
AUTO, BESIDE = "auto", STIFF_4
LARGEST = {"double": {(AUTO, 0.001): 1e-12, (AUTO, 0.01): 1e-8},
           "single": {(AUTO, 0.001): 1e-3, (AUTO, 0.01): 1e-3}}
NEVER_WORSE = {"double": 1e-12, "single": 1e-3}  # than BESIDE's error, but for this
ROUNDING = {"double": 1e-14, "single": 5e-6}     # errors below it are no method's
FACTOR, MOST_OUTSIDE, LEAST, FEW = 10.0, 0.05, 0.01, 20
"""Of estimates of errors above rounding all but this share lie within the factor, unless they are few; none is below
this part of its error."""
SHARES = {"median": 0.5, "95 %": 0.95, "worst": 1.0}


@dataclass(frozen=True)
class Made:
    """One of a population: its trial with the first inputs, the second inputs, and how many times damping is usual."""

    number: int
    factor: float
    trial: Trial
    later: Held
    real: str = "double"

    @property
    def helds(self) -> tuple[Held, Held]:
        """The inputs of each stretch."""
        return self.trial.held, self.later

    def plant(self, core: Core, method: str, step_s: float) -> Plant:
        """At its start."""
        trial = self.trial
        return plant_of(core, Trial(trial.kind, method, trial.table, step_s, trial.nu, trial.heading_rad, trial.held))


def cuts_s(real: str) -> list[list[Fraction]]:
    """The instants of each stretch, exactly as steps reach them."""
    return [[tick * TICK_S[real] for tick in ticks] for ticks in INSTANTS]


def as_single(given: Any) -> Any:
    """The same with each number rounded to single precision, so that the true motion is of what the core was given."""
    if isinstance(given, dict):
        return {name: as_single(each) for name, each in given.items()}
    if isinstance(given, list):
        return [as_single(each) for each in given]
    return float(np.float32(given)) if isinstance(given, float) else given


def table_in_single(table: dict[str, Any]) -> dict[str, Any]:
    """A vehicle's table in single precision. Fixed wheels share an axle line along y, whose direction no single number
    has: it is turned to x, or their true constraints would forbid all turning."""
    turned = [{**wheel, "x_m": -wheel["y_m"], "y_m": wheel["x_m"], "axle_rad": 0.0}
              if wheel["axle_rad"] == -np.pi / 2 else wheel for wheel in table["wheel"]]
    rounded: dict[str, Any] = as_single({**table, "wheel": turned})
    return rounded


def made(seed: int, number: int, of: int, real: str = "double") -> Made:
    """The vehicle of this number: damping grows with the number, kinds take turns."""
    if real == "single":
        double = made(seed, number, of)
        trial = double.trial
        return replace(double, real=real, later=as_single(double.later), trial=replace(
            trial, table=table_in_single(trial.table), nu=as_single(trial.nu), heading_rad=as_single(trial.heading_rad),
            held=as_single(trial.held)))
    random = np.random.default_rng([seed, number])
    trial = made_up(random, WHEELS[number % len(WHEELS)], "auto")
    factor = float(10 ** (DECADES * (number + random.random()) / of))
    trial.table["motor_damping_Nms"] = float(10 ** random.uniform(-2.5, -1.5) * factor)
    for wheel in trial.table["wheel"]:
        if "motor_damping_Nms" in wheel:
            wheel["motor_damping_Nms"] *= factor
    trial.nu[:] = random.normal(0, 10 ** random.uniform(0, 1.3), 3).tolist()
    return Made(number, factor, trial, held_inputs(random, len(trial.table["wheel"]), any(trial.held["world_force_N"])))


@dataclass(frozen=True)
class Truth:
    """States at the instants, and how they were found."""

    by: str                # "enclosure", "50 digits"
    states: list[Vector]   # as balls; those of 50 digits are thin
    width: float           # the largest radius beside the largest number of its kind, or 1

    def errors(self, found: np.ndarray) -> dict[str, float]:
        """Upper bounds of the core's errors, by kind: beside the largest true number, or 1 where that is less."""
        return {name: max((upper(ball(float(x)) - y) for each, row in zip(found, self.states, strict=True)
                           for x, y in zip(each[part], row[part], strict=True)), default=0.0) / self.size(part)
                for name, part in KINDS.items()}

    def size(self, part: slice) -> float:
        """The largest number of a kind, or 1 where that is less."""
        return size_of(self.states, part)


def upper(number: arb) -> float:
    return float(number.abs_upper())


def size_of(states: list[Vector], part: slice) -> float:
    return max(1.0, *(upper(x) for row in states for x in row[part]), 1.0)


def truth_of(vehicle: Made, nu: np.ndarray) -> Truth:
    """The true motion from the core's start."""
    model, start = exact_start(vehicle.trial.table, nu.tolist())
    digits = true_states(model, start, vehicle.trial.heading_rad, vehicle.helds, cuts_s(vehicle.real))
    if vehicle.factor > MOST_ENCLOSED:
        return Truth("50 digits", digits, 0.0)
    states = enclosed(vehicle, start)
    check_inside(states, digits)
    width = max(upper(x.rad()) / size_of(states, part) for part in KINDS.values() for row in states for x in row[part])
    return Truth("enclosure", states, width)


def check_inside(enclosure: list[Vector], digits: list[Vector]) -> None:
    """ResultFails where the two differ: then one of them is wrong."""
    for part in KINDS.values():
        slack = AGREE * size_of(enclosure, part)
        off = max((upper(x - y) - upper(x.rad()) for one, other in zip(enclosure, digits, strict=True)
                   for x, y in zip(one[part], other[part], strict=True)), default=0.0)
        if not off <= slack:
            raise ResultFails(f"the motion in 50 digits is {off:.1e} outside of its enclosure")


def enclosed(vehicle: Made, start_nu: Vector) -> list[Vector]:
    """By laconic.tools.enclosure, each number of the vehicle the double that it is."""
    cuts = cuts_s(vehicle.real)
    edges = [cuts[0][0] * 0, *(each[-1] for each in cuts)]
    stretches = [Stretch(begin, end, named(held))
                 for (begin, end), held in zip(pairwise(edges), vehicle.helds, strict=True)]
    with precision(GOAL_BITS + GUARD_BITS):
        table = vehicle.trial.table
        equation = equation_of(table, table.get("ground"))
        zeta = times(equation.zeta_of_nu, start_nu)
        motion = Motion(equation, Beginning(zeta, [arb(0), arb(0)], ball(vehicle.trial.heading_rad)), GOAL_BITS)
        return [sample.row() for sample in motion.samples(stretches, [t for each in cuts for t in each])]


def named(held: dict[str, list[float]]) -> dict[str, float]:
    """Inputs by the names of a scene's signals."""
    found = {}
    for name in INPUTS:
        if name == "body_moment_Nm":
            found[name] = held[name][0]
        else:
            found |= {f"{name}[{i}]": value for i, value in enumerate(held[name], start=1)}
    return found


ESTIMATED: dict[str, Callable[[ErrorSizes], float]] = {
    "nu": lambda sizes: sizes.nu_rad_per_s, "pose": lambda sizes: max(sizes.place_m, sizes.heading_rad),
    "wheel": lambda sizes: sizes.wheel_angle_rad}
"""What an estimate has of each kind of a truth."""


def rows_of(vehicle: Made, methods: Sequence[str]) -> list[Row]:
    """The vehicle's rows; a refusal has the status, and no errors."""
    core = load(vehicle.real)
    truth = truth_of(vehicle, vehicle.plant(core, "auto", STEPS_S[0]).nu)
    known = {"number": vehicle.number, "kind": vehicle.trial.kind, "real": vehicle.real, "factor": vehicle.factor,
             "truth": truth.by, "width": truth.width}
    return [known | {"method": method, "step_s": step_s} | measured(vehicle, truth, method, step_s)
            for method in methods for step_s in STEPS_S]


def measured(vehicle: Made, truth: Truth, method: str, step_s: float) -> Row:
    """Errors at all instants of one run."""
    try:
        plant = vehicle.plant(load(vehicle.real), method, float(TICK_S[vehicle.real] / per_tick(step_s)))
        estimate, estimated = plant.estimate(), list[Errors]()
        found = states_of(plant, vehicle, step_s, estimate.run, lambda: estimated.append(estimate.read()))
    except Refused as refused:
        return {"status": refused.status}
    return {"status": "ok", "taken": plant.chosen_method,
            **{f"error_{name}": error for name, error in truth.errors(found).items()},
            **{f"estimate_{name}": max(size(errors.now) for errors in estimated) / truth.size(KINDS[name])
               for name, size in ESTIMATED.items()},
            **{f"rounding_{name}": max(size(errors.rounding) for errors in estimated) / truth.size(KINDS[name])
               for name, size in ESTIMATED.items()}}


def per_tick(step_s: float) -> int:
    """Steps of about this length in a tick."""
    return round(float(TICK_S["double"]) / step_s)


def states_of(plant: Plant, vehicle: Made, step_s: float, run: Callable[..., None] | None = None,
              seen: Callable[[], None] = lambda: None) -> np.ndarray:
    """The core's states at the instants, one row each; `run` steps the plant, `seen` is called at each instant."""
    rows, done, steps = [], 0, per_tick(step_s)
    for held, ticks in zip(vehicle.helds, INSTANTS, strict=True):
        for tick in ticks:
            (run or plant.run)(held, tick * steps - done)
            seen()
            done = tick * steps
            pose = plant.pose
            rows.append([*plant.nu, pose.x_m, pose.y_m, pose.heading_rad, *plant.wheel_angles()])
    return np.array(rows)


def worst_of(row: Row) -> float:
    """The largest of a row's errors; infinite for a refusal, as for what is not finite."""
    errors = [row[f"error_{kind}"] for kind in KINDS] if row["status"] == "ok" else [math.inf]
    return max(errors) if all(math.isfinite(error) for error in errors) else math.inf


def ratios_of(rows: Sequence[Row], kind: str) -> list[float]:
    """Estimate over error, where the error is above rounding and three times what the estimate has of it."""
    return [row[f"estimate_{kind}"] / row[f"error_{kind}"] for row in rows if row["status"] == "ok"
            and row[f"error_{kind}"] > max(ROUNDING[row["real"]], 3.0 * row[f"rounding_{kind}"])]


def summary(rows: Sequence[Row], name: str) -> list[str]:
    """Prints quantiles of a method and step; what its estimates must not be."""
    errors, wrong = sorted(map(worst_of, rows)), []
    quantiles = ", ".join(f"{label} {errors[max(0, math.ceil(share * len(errors)) - 1)]:.1e}"
                          for label, share in SHARES.items())
    refused = sum(row["status"] != "ok" for row in rows)
    print(f"{name}: {refused} of {len(rows)} refused; errors: {quantiles}", flush=True)
    for kind in KINDS:
        ratios = ratios_of(rows, kind)
        within = sum(1.0 / FACTOR <= ratio <= FACTOR for ratio in ratios)
        if ratios:
            print(f"  {kind}: {within} of {len(ratios)} estimates within a factor of {FACTOR:g} of their errors")
        if ratios and not min(ratios) >= LEAST:
            wrong.append(f"{name}: an estimate of {kind} is {min(ratios):.1e} of its error")
        if len(ratios) >= FEW and within < (1.0 - MOST_OUTSIDE) * len(ratios):
            wrong.append(f"{name}: {within} of {len(ratios)} estimates of {kind} are near their errors")
    return wrong


def wrong_of(groups: dict[tuple[str, float], list[Row]], real: str) -> list[str]:
    """What errors must not be, in words."""
    found = [f"vehicle {row['number']}, {name}, {step_s:g} s: {row['status']}, {worst_of(row):.1e}"
             for (name, step_s), rows in groups.items() for row in rows
             if not worst_of(row) <= LARGEST[real].get((name, step_s), math.inf)]
    for step_s in STEPS_S:
        for ours, others in zip(groups[AUTO, step_s], groups[BESIDE, step_s], strict=True):
            if not worst_of(ours) <= max(worst_of(others), NEVER_WORSE[real]):
                found.append(f"vehicle {ours['number']}, {AUTO}, {step_s:g} s: worse than {BESIDE}")
    return found


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--vehicles", type=int, default=200, metavar="N", help="200 by default")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--real", choices=("double", "single"), default="double")
    parser.add_argument("--method", default="", metavar="A,B", help="further methods")


def run(options: argparse.Namespace) -> bool:
    """All vehicles; whether nothing is refused by `auto`, no error is too large, and estimates are near them."""
    methods = tuple(dict.fromkeys((AUTO, *filter(None, options.method.split(",")), BESIDE)))
    groups = defaultdict[tuple[str, float], list[Row]](list)
    for number in range(options.vehicles):
        for row in rows_of(made(options.seed, number, options.vehicles, options.real), methods):
            groups[row["method"], row["step_s"]].append(row)
    wrong = [line for (name, step_s), rows in groups.items() for line in summary(rows, f"{name}, {step_s * 1e3:g} ms")]
    wrong += wrong_of(groups, options.real)
    print(*(f"WRONG: {line}" for line in wrong[:20]), sep="\n")
    return not wrong
