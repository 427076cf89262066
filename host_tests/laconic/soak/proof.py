"""Frama-C over core and node: its analyser with any input in the stated boxes, and WP for the contracts; an hour."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from laconic.errors import BadInput, nearest_of
from laconic.soak import StoppedEarly
from laconic.static_checks.contracts import ROOMS, prove_contracts
from laconic.static_checks.frama_c import PROGRAMS, prove
from laconic.static_checks.proof_page import write_page
from laconic.static_checks.proved import (
    Row,
    keep,
    read_kept,
    row_of_analysis,
    row_of_failure,
    row_of_goals,
    wanted,
)

OPTIONS = ("only",)
LIMIT_S = 900.0


def length(only: str | None = None) -> float:
    """One for each proof whose sources have changed."""
    return float(len(chosen(only)))


def chosen(only: str | None) -> list[str]:
    """Keys of the proofs to run: those that are named, else all that hold for no sources as they are."""
    if only is not None:
        found = [key for key in wanted() if only in (key, key.split(": ")[1])]
        if not found:
            names = sorted({key.split(": ")[1] for key in wanted()})
            raise BadInput(f"--only {only}: there is no such proof; {nearest_of(only, names)}")
        return found
    kept = read_kept()
    return [key for key in wanted() if key not in kept or not kept[key].is_of_these_sources()]


def soak(minutes: float, seed: int, advance: Callable[[float], None], only: str | None = None) -> dict[str, Any]:
    """Each proof once, whatever `minutes` and `seed`, but those whose last run was of the same sources; passed when an
    argument discharges every alarm and every goal is proved."""
    try:
        for key in chosen(only):
            keep(run_one(key))
            write_page()
            advance(1.0)
    except KeyboardInterrupt as stopped:
        raise StoppedEarly(_result()) from stopped
    return _result()


def run_one(key: str) -> Row:
    """What comes out; a proof that does not end well is a row, too."""
    began = time.monotonic()
    tool, rest = key.split(" ", 1)
    part, name = rest.split(": ")
    try:
        if tool == "wp":
            room = next(room for room in ROOMS if room.name == name)
            goals = prove_contracts(room, LIMIT_S)
            return row_of_goals(room, time.monotonic() - began, goals)
        program = next(program for program in PROGRAMS if program.name == part)
        found = prove(program, f"prove_{name}", LIMIT_S)
        return row_of_analysis(program, f"prove_{name}", time.monotonic() - began, found)
    except BadInput as why:
        if "there is no" in str(why):
            raise
        return row_of_failure(key, time.monotonic() - began, str(why))


def _result() -> dict[str, Any]:
    kept = read_kept()
    told = {key: _told(kept.get(key)) for key in wanted()}
    still_open = sorted({line for row in kept.values() for line in (row.open or ([row.failed] if row.failed else []))})
    return {"passed": not still_open and not any("not run" in text for text in told.values()), **told,
            **{f"open {k}": line for k, line in enumerate(still_open, 1)}}


def _told(row: Row | None) -> str:
    if row is None:
        return "not run"
    count = len(row.alarms)
    what = f"{row.goals} goals" if row.tool == "wp" else f"{count} alarms, {count - len(row.open)} discharged"
    state = row.failed or (f"{what}, {len(row.open)} open" if row.open else what)
    return state + ("" if row.is_of_these_sources() else "; older than its sources")
