"""The project's own goals for speed, size and accuracy: each computed from the rows of one report, pass or miss."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from laconic.core import load
from laconic.scene import METHODS
from laconic.scene.methods import EXACT, EXACT_4, EXPLICIT, STIFF, STIFF_4
from laconic.tools.report.speed import WANTED_ERROR, cheapest

Row = dict[str, Any]
Results = dict[str, list[Row]]
COARSE_S, FINE_S = 0.1, 0.05
ROUNDING = 1e-12  # of errors: below it no order shows


@dataclass(frozen=True)
class Target:
    """One goal: what is measured, what was found, what was wanted. `met` is None where it could not be measured."""

    group: str
    what: str
    found: float | None
    bound: str  # ≤ or ≥
    wanted: float
    met: bool | None

    def row(self) -> Row:
        """For tables."""
        verdict = {True: "met", False: "missed", None: "not measured"}[self.met]
        return {"group": self.group, "goal": self.what, "found": self.found, "bound": self.bound, "wanted": self.wanted,
                "verdict": verdict}


def at_most(group: str, what: str, found: float | None, wanted: float) -> Target:
    """found <= wanted."""
    met = None if found is None or math.isnan(found) else found <= wanted
    return Target(group, what, found, "≤", wanted, met)


def at_least(group: str, what: str, found: float | None, wanted: float) -> Target:
    """found >= wanted."""
    met = None if found is None or math.isnan(found) else found >= wanted
    return Target(group, what, found, "≥", wanted, met)


def select(rows: Iterable[Row], **wanted: Any) -> list[Row]:
    """Rows whose fields have these values."""
    return [row for row in rows if all(row.get(key) == value for key, value in wanted.items())]


def worst(rows: Iterable[Row], field: str) -> float | None:
    """Largest value of a field, over the rows that have one."""
    return max((row[field] for row in rows if row.get(field) is not None), default=None)


def one(rows: Iterable[Row], field: str, **wanted: Any) -> float | None:
    """The field of the only row that fits."""
    return next((row.get(field) for row in select(rows, **wanted)), None)


def orders() -> dict[str, int]:
    """The order of every method but auto, whose steps are those of others."""
    core = load("double")
    return {name: int(core.method(name).order) for name in METHODS[1:]}


def slope_of(coarse: float | None, fine: float | None) -> float | None:
    """How often the error halves with the step; None where it is not known, or no more than rounding."""
    return math.log2(coarse / fine) if coarse and fine and coarse > ROUNDING else None


def order_targets(results: Results) -> list[Target]:
    """Slope of the error of ν on S1, from 100 to 50 ms."""
    found = []
    for method, order in orders().items():
        rows = select(results["accuracy"], scene="s1", real="double", method=method, status="ok")
        coarse, fine = one(rows, "error_nu", step_s=COARSE_S), one(rows, "error_nu", step_s=FINE_S)
        found.append(at_least("order", f"{method}: slope of the error on S1", slope_of(coarse, fine), order - 0.3))
    return found


def structure_targets(results: Results) -> list[Target]:
    """What is conserved, and what never grows."""
    found = []
    for real, limit in (("double", 1e-13), ("single", 1e-4)):
        rows = select(results["drift"], real=real, method=EXACT)
        length = f"{worst(rows, 'steps') or 0:,} steps"
        for what in ("energy", "K"):
            found.append(at_most("structure", f"{EXACT}, {real}: drift of {what} over {length}", worst(rows, what),
                                 limit))
        grown = one(results["norm"], "worst_growth_ulp", real=real, method=EXACT)
        what = f"{EXACT}, {real}: growth of the A-norm in one step, U = 0 [ulp]"
        found.append(at_most("structure", what, grown, 4))
    tables = results["prototype"]
    found.append(at_least("structure", "prototype's table: cases reproduced or beaten, of " + str(len(tables)),
                          float(sum(row["as_good"] for row in tables)) if tables else None, len(tables)))
    return found


def reference_targets(results: Results) -> list[Target]:
    """auto on the reference trajectories; stiff vehicles."""
    auto = select(results["verified"], method="auto")
    fine = select(auto, step_s=1e-3)
    every = ("error_nu", "error_pose", "error_wheel")
    found = [at_most("references", "auto, h = 1 ms: ν", worst(fine, "error_nu"), 1e-12),
             at_most("references", "auto, h = 1 ms: pose, wheel angles", _worst_of(fine, every[1:]), 1e-11),
             at_most("references", "auto, h = 10 ms: ν, pose, wheel angles",
                     _worst_of(select(auto, step_s=1e-2), every), 1e-8)]
    strange = [row for row in results["verified"] if row["status"] == "ok"
               and not all(row[f] is None or math.isfinite(row[f]) for f in every)]
    found.append(at_most("references", "runs of any method that end in NaN or infinity",
                         float(len(strange)) if results["verified"] else None, 0))
    refused = [row for row in results["stiff"] if row["status"] != "ok"]
    group = "stiff ×10³, ×10⁶"
    return [*found, at_most(group, "auto: refused runs", float(len(refused)), 0),
            at_most(group, "auto: relative error of ν at the end", worst(results["stiff"], "error_nu"), 1e-3),
            at_most(group, "auto: error of the path", worst(results["stiff"], "error_path"), 5e-3)]


def _worst_of(rows: list[Row], fields: Iterable[str]) -> float | None:
    found = [value for field in fields if (value := worst(rows, field)) is not None]
    return max(found, default=None)


def single_targets(results: Results) -> list[Target]:
    """Single precision."""
    found = []
    for step_s in (0.01, 0.001):
        errors = select(results["single"], step_s=step_s, method="auto")
        found.append(at_most("single precision", f"S1, auto, h = {step_s:g} s: error of ν at 10 s [rad/s]",
                             worst(errors, "error_nu"), 2e-6))
    keeps = one(results["long"], "found", what="heading")
    found.append(at_least("single precision", "heading 10⁹ turns on advances by the same bits (1: yes)", keeps, 1))
    found.append(at_most("single precision", "x after 10⁷ steps: relative error",
                         one(results["long"], "found", what="x"), 1e-6))
    wrong = [row for row in results["extremes"] if row["outcome"] in ("wrong", "not finite")]
    found.append(at_most("extremes", "cases with neither a right number nor a refusal", float(len(wrong)), 0))
    return found


def speed_targets(results: Results) -> list[Target]:
    """Against CasADi's RK4, CVODE and DOP853."""
    steps, found = results["steps"], []
    limits = {EXPLICIT: 0.45, STIFF: 0.55, STIFF_4: 0.95, EXACT: 0.7, EXACT_4: 1.5}
    for method, limit in limits.items():
        ratio = one(steps, "ratio", who=method, real="double", build="whole")
        found.append(at_most("speed", f"{method}, double: time of a step over CasADi's RK4", ratio, limit))
    found.append(at_most("speed", f"{EXPLICIT}, single: time of a step over CasADi's RK4",
                         one(steps, "ratio", who=EXPLICIT, real="single", build="whole"), 0.6))
    for real in ("double", "single"):
        found.append(at_most("speed", f"{EXPLICIT}, {real}: instructions a step on the host",
                             one(steps, "instructions", who=EXPLICIT, real=real, build="whole"), 580))
    found.append(at_most("speed", f"{EXPLICIT}, double, trimmed: time of a step over CasADi's RK4",
                         one(steps, "ratio", who=EXPLICIT, real="double", build="trimmed"), 0.5))
    rows = results["precision"]
    ours = cheapest(rows, lambda who: who in METHODS)
    for name, limit in (("CVODE", 25.0), ("DOP853 compiled", 6.0)):
        theirs = cheapest([row for row in rows if row["who"].startswith(name)], lambda _: True)
        ratio = theirs["ms"] / ours["ms"] if ours and theirs else None
        found.append(at_least("speed", f"S1 at error {WANTED_ERROR:g}: {name}'s time over ours", ratio, limit))
    return found


def board_targets(results: Results) -> list[Target]:
    """Cortex-M4F, single, three wheels."""
    rows = select(results["boards"], processor="Cortex-M4F", real="single")
    fast = select(rows, optimisation="-O2", build="whole")
    small = select(rows, method=EXPLICIT, optimisation="-Os", build="trimmed")
    group = "Cortex-M4F, single"
    found = [at_most(group, f"{EXPLICIT}: instructions a step", one(fast, "instructions", method=EXPLICIT), 460),
             at_most(group, f"{STIFF_4}: instructions a step",
                     one(fast, "instructions", method=STIFF_4), 850),
             at_most(group, f"{EXPLICIT} with pose, -O2: bytes of step code",
                     one(fast, "step_code", method=EXPLICIT), 2.2 * 1024),
             at_most(group, f"{EXPLICIT} with pose, trimmed, -Os: bytes of step code", one(small, "step_code"),
                     1.5 * 1024),
             at_most(group, "free motion, ν only, trimmed, -Os: bytes of step code",
                     one(results["smallest"], "step_code"), 1024),
             at_most(group, "worst stack of any method, -O2 [bytes]", worst(fast, "worst_stack"), 320),
             at_most(group, "double-precision helpers linked", worst(rows, "double_helpers"), 0),
             at_most(group, "heap functions linked", worst(rows, "heap"), 0)]
    boards = [row for row in results["boards"] + results["scenes"] if row["status"] == "ok"]
    differ = float(sum(not row["same_bits"] for row in boards)) if boards else None
    return [*found, at_most("same bits", "board images whose state differs from the host's", differ, 0)]


def friction_targets(results: Results) -> list[Target]:
    """What a friction step costs, in ideal RK4 steps; nothing is refused or lost on extreme grounds."""
    found = []
    for wheels, limit in ((3, 10.0), (4, 14.0)):
        for row in select(results["friction_cost"], wheels=wheels):
            what = f"{wheels} wheels, {row['run']}, {row['processor']}, {row['real']}"
            if row["processor"] == "host" or row["real"] == "single":
                found.append(at_most("friction", f"{what}: median of a step [ideal steps]", row["median_ideal"], limit))
                found.append(at_most("friction", f"{what}: worst step [ideal steps]", row["worst_ideal"], 45.0))
    extremes = results["friction_extremes"]
    lost = float(sum(not row["finite"] for row in extremes)) if extremes else None
    tried = sum(row["steps_taken"] for row in extremes)
    refused = sum(row["refused"] for row in extremes) / tried if tried else None
    return [*found, at_most("friction", "extreme grounds: runs that end in NaN or infinity", lost, 0.0),
            at_most("friction", "extreme grounds: share of steps that are refused", refused, 1e-3)]


GROUPS: tuple[Callable[[Results], list[Target]], ...] = (
    order_targets, structure_targets, reference_targets, single_targets, speed_targets, board_targets,
    friction_targets)


def targets(results: Results) -> list[Row]:
    """All of them."""
    return [target.row() for group in GROUPS for target in group(results)]
