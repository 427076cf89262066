"""Power that is lost between any two frames, and clocks that run wrong: the programs' figures as they are."""

from __future__ import annotations

from laconic.soak._campaigns.memory import REALS, told


def figures(what: str) -> tuple[dict[str, str], bool]:
    """By name, for both scalar types; whether all are as they must be."""
    found: dict[str, str] = {}
    good = True
    for real in REALS:
        rows, status = told(real, what)
        good &= status == 0 and bool(rows)
        for *names, value in rows:
            name = ", ".join((what, *names))
            found[name] = f"{found[name]} and {value}" if name in found else value
    return {name: f"{value} (double and single)" for name, value in found.items()}, good
