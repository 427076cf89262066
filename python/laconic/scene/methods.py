"""The methods of integration, as the core lists them (core_c/include/laconic/methods.h).

    METHODS                                        # the names, in the order of their numbers
    ROWS[3].order, ROWS[3].title                   # what else the list states of each
    method_with(order=4, takes="SLOW_DAMPING")     # the first with these traits, besides auto

Whoever needs a method for its traits asks for these, or takes one of the names below; so the list alone names methods.
"""

from __future__ import annotations

from pathlib import Path

from laconic.base.paths import SOURCE_DIR, built
from laconic_fmu.field_list import Method, methods_in


def _header() -> Path:
    """Among the project's files; an installation that has a build tree alone has a copy there."""
    header = SOURCE_DIR / "core_c" / "include" / "laconic" / "methods.h"
    return header if header.is_file() else built("lib/laconic_methods.h")


ROWS: tuple[Method, ...] = methods_in(_header().read_text(encoding="utf-8"))
METHODS: tuple[str, ...] = tuple(row.name for row in ROWS)


def method_with(order: int, takes: str = "", keeps: str = "") -> str:
    """The name of the first method of that order, besides auto, with these traits; "" stands for any."""
    return next(row.name for row in ROWS[1:]
                if row.order == order and takes in ("", row.takes) and keeps in ("", row.keeps))


EXPLICIT = method_with(order=4, takes="SLOW_DAMPING")
"""The shortest, for slow damping; it refuses steps beyond its stability limit."""
EXPLICIT_8 = method_with(order=8, takes="SLOW_DAMPING")
STIFF = method_with(order=2, takes="ANY_DAMPING")
STIFF_4 = method_with(order=4, takes="ANY_DAMPING")
STIFF_8 = method_with(order=8, takes="ANY_DAMPING")
"""Takes any damping; auto steps by it."""
EXACT = method_with(order=2, keeps="EXACTLY")
"""Exact for free motion; takes every step."""
EXACT_4 = method_with(order=4, keeps="EXACTLY")
