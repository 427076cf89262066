"""MISRA C:2012 by cppcheck's addon and clang-tidy's bugprone and cert over core, node and FMU: minutes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from laconic.static_checks.misra import all_findings, counted, places, unexplained
from laconic.static_checks.misra_page import differences
from laconic.static_checks.parts import PARTS
from laconic.static_checks.tidy import tidy_findings


def length() -> float:
    """Each file twice."""
    return float(2 * sum(len(part.files()) for part in PARTS))


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Everything once, whatever `minutes` and `seed`; passed when nothing is found that no deviation explains."""
    found = all_findings(advance)
    counts = counted(found)
    lines = unexplained(counts)
    tidy = tidy_findings(advance)
    old = differences(counts)
    told = {f"unexplained {k}": line for k, line in enumerate([*lines, *places(found, lines)], 1)}
    told |= {f"clang-tidy {k}": line for k, line in enumerate(tidy, 1)}
    return {"passed": not lines and not tidy, "places": len(found), "rules deviated from": len(counts),
            "unexplained": len(lines), "clang-tidy": len(tidy), **told, **({"docs/misra.md": old} if old else {})}
