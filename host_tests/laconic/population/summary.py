"""What is told of a population: errors' quantiles and refusals for each method and step, and where the worst was.

A column `estimate_…` beside an `error_…` is judged against it, so that a method's own estimates need nothing more here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from laconic.population.measure import Row
from laconic.population.truth import KINDS

SHARES = {"median": 0.5, "95 %": 0.95, "99 %": 0.99, "worst": 1.0}
ROUNDING = {"double": 1e-14, "single": 5e-6}  # errors below it are no method's
FACTOR, MOST_OUTSIDE, LEAST = 10.0, 0.05, 0.01
"""Of estimates of errors above rounding all but this share lie within the factor; none is below this part of its
error."""
FEW = 20  # of fewer no share is asked: one of them would be more than it


def worst_of(row: Row) -> float:
    """The largest of a row's errors; infinite for a refusal, as for what is not finite."""
    errors = [row[f"error_{kind}"] for kind in KINDS] if row["status"] == "ok" else [math.inf]
    return max(errors) if all(math.isfinite(error) for error in errors) else math.inf


def quantile(numbers: Sequence[float], share: float) -> float:
    """The least that this share of the numbers does not exceed."""
    ranked = sorted(numbers)
    return ranked[max(0, math.ceil(share * len(ranked)) - 1)]


def summary_of(rows: Sequence[Row]) -> dict[str, Any]:
    """Of rows of one method and step."""
    fine = [row for row in rows if row["status"] == "ok"]
    told: dict[str, Any] = {"vehicles": len(rows), "refused": len(rows) - len(fine)}
    for kind in KINDS if fine else ():
        errors = [row[f"error_{kind}"] for row in fine]
        told[f"error_{kind}"] = {name: quantile(errors, share) for name, share in SHARES.items()}
        told |= ratios_of(fine, kind)
    if rows:
        told["worst vehicle"] = max(rows, key=worst_of)["number"]
    return told


def ratios_of(rows: Sequence[Row], kind: str) -> dict[str, Any]:
    """Estimate over error where the error is above rounding, three times what the estimate has of it: quantiles, and
    the share within a factor of 10."""
    found = np.array([row[f"estimate_{kind}"] / row[f"error_{kind}"] for row in rows
                      if row.get(f"estimate_{kind}") is not None
                      and row[f"error_{kind}"] > max(ROUNDING[row.get("real", "double")],
                                                     3.0 * row.get(f"rounding_{kind}", 0.0))])
    if not found.size:
        return {}
    within = float(np.mean((found >= 1.0 / FACTOR) & (found <= FACTOR)))
    return {f"estimate over error_{kind}": {"runs": int(found.size), "least": float(found.min()),
                                            "median": float(np.median(found)), "largest": float(found.max()),
                                            "within a factor of 10": within}}


def wrong_estimates(told: dict[str, Any]) -> list[str]:
    """What estimates must not be, in words, of what summary_of() found."""
    wrong = []
    for kind in KINDS:
        ratio = told.get(f"estimate over error_{kind}")
        if ratio is None:
            continue
        if not ratio["least"] >= LEAST:
            wrong.append(f"an estimate of {kind} is {ratio['least']:.1e} of its error, less than {LEAST:g}")
        if ratio["runs"] >= FEW and not ratio["within a factor of 10"] >= 1.0 - MOST_OUTSIDE:
            wrong.append(f"{ratio['within a factor of 10']:.1%} of {ratio['runs']} estimates of {kind} are within a "
                         f"factor of {FACTOR:g} of their errors, fewer than {1.0 - MOST_OUTSIDE:.0%}")
    return wrong


def by_truth(rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """The same of the rows beside enclosures, and of those with more damping, beside 50 digits alone."""
    return {truth: summary_of([row for row in rows if row["truth"] == truth])
            for truth in dict.fromkeys(row["truth"] for row in rows)}


def groups_of(rows: Sequence[Row]) -> dict[tuple[str, float], list[Row]]:
    """By method and step."""
    found: dict[tuple[str, float], list[Row]] = {}
    for row in rows:
        found.setdefault((row["method"], row["step_s"]), []).append(row)
    return found


def name_of(method: str, step_s: float) -> str:
    return f"{method}, {step_s * 1e3:g} ms"


def text_of(told: dict[str, Any]) -> str:
    """A summary in one line."""
    parts = [f"refused {told['refused']} of {told['vehicles']}"]
    for kind in KINDS:
        if f"error_{kind}" in told:
            each = ", ".join(f"{share} {error:.1e}" for share, error in told[f"error_{kind}"].items())
            parts.append(f"{kind}: {each}")
        if ratio := told.get(f"estimate over error_{kind}"):
            parts.append(f"estimate over error of {ratio['runs']}: {ratio['least']:.1e} to {ratio['largest']:.1e}, "
                         f"{ratio['within a factor of 10']:.1%} within a factor of 10")
    return "; ".join([*parts, f"worst: vehicle {told['worst vehicle']}"])
