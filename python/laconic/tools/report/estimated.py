"""The core's error estimate beside the true error, in the runs of the accuracy ladder."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from laconic.core.estimate import Errors
from laconic.tools.report.page import Row, Table

KINDS = ("nu", "pose", "wheel")
JUDGED_FROM = 1e-9  # errors: the reference has some 1e-11 of its own
FACTOR = 10.0
FIELDS = ("method", "real", "compared", "within_10", "least", "median", "largest")


def columns_of(seen: Sequence[Errors], expected: np.ndarray) -> dict[str, float]:
    """What the estimates at the checkpoints say of each kind, over max(1, largest expected value) as errors are."""
    largest = {"nu": max(each.now.nu_rad_per_s for each in seen),
               "pose": max(max(each.now.place_m, each.now.heading_rad) for each in seen),
               "wheel": max(each.now.wheel_angle_rad for each in seen)}
    parts = {"nu": slice(0, 3), "pose": slice(3, 6), "wheel": slice(6, None)}
    scales = {kind: max(1.0, float(np.max(np.abs(expected[:, parts[kind]]), initial=0.0))) for kind in KINDS}
    return {f"estimate_{kind}": size / scales[kind] for kind, size in largest.items()}


def table_of(rows: Sequence[Row]) -> Table:
    """How near they are, for each method and scalar type."""
    return Table(rows_of(rows), FIELDS, "Estimated over true error, of ν, pose and wheel angles")


def rows_of(rows: Sequence[Row]) -> list[Row]:
    """Of the runs whose error the reference can tell."""
    found: dict[tuple[str, str], list[float]] = {}
    for row in rows:
        for kind in KINDS:
            error, estimate = row.get(f"error_{kind}"), row.get(f"estimate_{kind}")
            if error is not None and estimate is not None and error > floor_of(row):
                found.setdefault((row["method"], row["real"]), []).append(estimate / error)
    return [row_of(method, real, np.array(ratios)) for (method, real), ratios in found.items()]


def floor_of(row: Row) -> float:
    """Below it an error may be the reference's own, or in single that of rounding."""
    return max(JUDGED_FROM, 10.0 * row.get("reference_error_nu", 0.0), 1e-5 if row["real"] == "single" else 0.0)


def row_of(method: str, real: str, ratios: np.ndarray) -> dict[str, Any]:
    """One line of the table."""
    within = float(np.mean((ratios >= 1.0 / FACTOR) & (ratios <= FACTOR)))
    return {"method": method, "real": real, "compared": len(ratios), "within_10": within, "least": float(ratios.min()),
            "median": float(np.median(ratios)), "largest": float(ratios.max())}
