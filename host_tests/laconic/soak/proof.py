"""Frama-C's analyser over every public function of core and node with any input in the stated boxes; an hour."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from laconic.soak import StoppedEarly
from laconic.static_checks.frama_c import PROGRAMS, Alarm, prove


def length() -> float:
    """One for each entry."""
    return float(sum(len(program.entries()) for program in PROGRAMS))


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Each entry once, whatever `minutes` and `seed`: passed when an argument discharges every alarm."""
    found: list[Alarm] = []
    told: dict[str, Any] = {}
    try:
        for program in PROGRAMS:
            for entry in program.entries():
                alarms = prove(program, entry)
                found += alarms
                told[f"{program.name} {entry.removeprefix('prove_')}"] = _told(alarms)
                advance(1.0)
    except KeyboardInterrupt as stopped:
        raise StoppedEarly(_result(found, told)) from stopped
    return _result(found, told)


def _told(alarms: list[Alarm]) -> str:
    open_ones = sum(not alarm.discharged for alarm in alarms)
    return f"{len(alarms)} alarms, {len(alarms) - open_ones} discharged" + (f", {open_ones} open" if open_ones else "")


def _result(found: list[Alarm], told: dict[str, Any]) -> dict[str, Any]:
    still_open = sorted({str(alarm) for alarm in found if not alarm.discharged})
    places = {(alarm.file, alarm.code, alarm.what) for alarm in found}
    return {"passed": not still_open, **told, "places of alarms": len(places),
            **{f"open {k}": line for k, line in enumerate(still_open, 1)}}
