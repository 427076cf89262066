"""What an optimisation found, as text and as numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from laconic.tools.optimise.measuring import Measuring
from laconic.tools.optimise.study import Result


def as_text(result: Result, name: str, measuring: Measuring) -> str:
    """A report in Markdown."""
    problem = result.problem
    lines = [f"# {name}, optimised", "", "| free | before | found | range |", "| --- " * 4 + "|"]
    for each, old, new in zip(problem.free, result.before.choice, result.best.choice, strict=True):
        lines.append(f"| {each.key} | {old:.6g} | {new:.6g} | {each.low:g} to {each.high:g} |")
    lines += ["", "| measure | before | found |", "| --- " * 3 + "|"]
    units = [f" [{measure.unit}]" if measure.unit else "" for measure in measuring.measures]
    for text, unit, old, new in zip(_rows(result), units, result.before.values, result.best.values, strict=True):
        lines.append(f"| {text}{unit} | {old:.6g} | {new:.6g} |")
    lines += ["", *words(result, measuring.exact)]
    if result.front:
        lines += ["", *_front(result)]
    return "\n".join(lines)


def _rows(result: Result) -> list[str]:
    """Each measure with what is asked of it."""
    problem, found = result.problem, []
    for name in problem.measures:
        asked = [goal.text for goal in problem.goals if goal.measure == name]
        found.append(", ".join([*asked, *(each.text for each in problem.constraints if each.measure == name)]))
    return found


def words(result: Result, exact: Sequence[str]) -> list[str]:
    """What to know beside the numbers, in sentences."""
    found = [f"{result.measured} vehicles were measured."]
    if exact:
        found.append(f"The descent had exact gradients of {', '.join(exact)}, through every step of the run.")
    if result.stopped is not None:
        found.append("The search was stopped: this is the best of what it had found.")
    if not result.keeps:
        return [*found, "No choice within the ranges keeps all constraints; this one comes nearest. Widen a range or "
                        "loosen a constraint."]
    if active := result.active_constraints:
        found.append(f"Active: {', '.join(active)}. A looser bound may give a better goal.")
    if ends := result.at_ends:
        found.append(f"{'; '.join(ends)}: a wider range may give a better goal.")
    if _was_better(result):
        found.append("The scene as it is is better: its own numbers lie outside the ranges.")
    for goal in result.problem.goals:
        if math.isinf(result.best.values[result.problem.column(goal.measure)]):
            found.append(f"{goal.text} is infinite there, and perhaps in many other places: take it as --subject-to "
                         "with a bound, and another goal.")
    return found


def _was_better(result: Result) -> bool:
    """Whether the scene keeps the constraints and is better in all goals than what was found."""
    problem, before = result.problem, result.before.values
    return bool((problem.excesses(before) <= 0.0).all()
                and (problem.losses(before) < problem.losses(result.best.values)).all())


def _front(result: Result) -> list[str]:
    """The points of the front, numbered as --pick takes them."""
    problem = result.problem
    names = [*(goal.text for goal in problem.goals), *(each.key for each in problem.free)]
    lines = [f"{len(result.front)} choices of which none is better in all goals:", "",
             "| " + " | ".join(["pick", *names]) + " |", "| --- " * (1 + len(names)) + "|"]
    columns = [problem.column(goal.measure) for goal in problem.goals]
    for number, point in enumerate(result.front, start=1):
        numbers = [f"{value:.6g}" for value in (*point.values[columns], *point.choice)]
        mark = " (found)" if point is result.best else ""
        lines.append("| " + " | ".join([f"{number}{mark}", *numbers]) + " |")
    return lines


def as_numbers(result: Result, measuring: Measuring, seed: int) -> dict[str, Any]:
    """Machine-readable; a measure without a finite value is null."""
    problem = result.problem
    units = {name: measure.unit for name, measure in zip(problem.measures, measuring.measures, strict=True)}
    return {
        "free": [{"key": each.key, "low": each.low, "high": each.high, "before": float(old), "found": float(new)}
                 for each, old, new in zip(problem.free, result.before.choice, result.best.choice, strict=True)],
        "measures": [{"measure": name, "unit": units[name], "asked": asked, "before": _finite(old),
                      "found": _finite(new)} for name, asked, old, new in zip(
                          problem.measures, _rows(result), result.before.values, result.best.values, strict=True)],
        "keeps_constraints": result.keeps, "active": result.active_constraints, "at_ends": result.at_ends,
        "front": [{"free": [float(value) for value in point.choice],
                   "measures": [_finite(value) for value in point.values]} for point in result.front],
        "measured": result.measured,
        "exact_gradients": measuring.exact, "seed": seed, "stopped": result.stopped is not None}


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
