"""Vehicle-steps a second, beside other programs in turn."""

from __future__ import annotations

import json
from typing import Any

import click
from rich.console import Console
from rich.table import Table

from laconic.cli.options import json_flag
from laconic.errors import LaconicError
from laconic.scene.methods import EXPLICIT

COLUMNS = {"who": "", "real": "scalar", "environments": "environments", "thousand_actions_per_s": "thousand actions/s",
           "million_steps_per_s": "million steps/s", "ns_per_step": "ns a step", "times_batch": "over the batch",
           "times_alone": "over one by one", "nJ_per_step": "nJ a step", "prediction": "prediction",
           "encoders": "encoders", "gyro": "gyro", "cycle": "whole cycle", "stack": "stack B", "flash": "flash B",
           "whole": "flash B, all methods", "ram": "filter B", "soft_double": "soft_double.c", "libgcc": "libgcc",
           "over_whole": "over the whole core", "over_hand": "over by hand", "same_bits": "host's bits",
           "instructions": "instructions", "other_key": "with another key"}
TITLES = {"step": f"A step of {EXPLICIT} on one core", "batch": "Vehicle-steps on one core",
          "learn": "Environments under random actions, on one core",
          "filter": "Instructions of a Kalman filter on a Cortex-M4F, in single",
          "soft-double": "Double precision on a Cortex-M4F, in instructions and bytes",
          "codes": "Codes that only a key's holder can make, on a Cortex-M4F"}


@click.command("benchmark")
@click.argument("what", metavar="WHAT", type=click.Choice([*TITLES]))
@click.option("--lanes", type=click.IntRange(1, 10**7), default=1000, show_default=True, help="Vehicles side by side.")
@click.option("--rounds", type=click.IntRange(1, 1000), default=15, show_default=True,
              help="How often all run in turn; the least time of each counts.")
@json_flag()
def command(what: str, lanes: int, rounds: int, json_wanted: bool) -> None:
    """Times vehicles that step side by side, or counts instructions: WHAT is step, batch, learn, filter, soft-double
    or codes.

    step: scene s1 in explicit steps of fourth order, by the full build, by the core trimmed to the scene, and by a
    kernel written by hand for this one vehicle. The kernel has the core's refusals or none. All have the same bits.

    batch: Robotino 2, Runge-Kutta steps of 1 ms with pose and wheel angles, 100 in a run, on one core. It compares the
    core's batch, the core one vehicle after the other, the same step in numba and JAX, and MuJoCo, if installed. All
    that compute the same are compared with the core before they are timed.

    learn: the environment laconic/DriveToPose-v0 under random actions, in one batch, with vehicles that differ, and as
    Gymnasium's vector of single ones.

    filter: the Kalman filter with recorded readings on an emulated Cortex-M4F, prediction and readings apart, with its
    stack, its flash and RAM, and whether it has this machine's bits.

    soft-double: additions in double precision by soft_double.c and by libgcc on an emulated Cortex-M4F, and a step of
    scene s1 with either.

    codes: a key and the code of a frame (AES-128 CMAC, docs/rig-ports.md) on an emulated Cortex-M4F, with two keys.
    """
    from laconic.tools.report.many.race import stay_on_one_core

    stay_on_one_core()
    rows, notes = {"step": _step, "batch": _batch, "learn": _learn, "filter": _filter,
                   "soft-double": _soft_double, "codes": _codes}[what](lanes, rounds)
    if json_wanted:
        click.echo(json.dumps({"lanes": lanes, "rows": rows, "notes": notes}, indent=1))
        return
    Console(width=None if Console().is_terminal else 120).print(table_of(TITLES[what], rows))
    for note in notes:
        click.echo(note)


Found = tuple[list[dict[str, Any]], list[str]]


def _step(lanes: int, rounds: int) -> Found:
    from laconic.tools.report import step_cost

    return step_cost.rows(rounds), []


def _batch(lanes: int, rounds: int) -> Found:
    from laconic.tools.report.many import race

    try:
        rows = race.rows(lanes, rounds)
    except race.Disagreement as error:
        raise LaconicError(f"{error}; nothing was timed") from None
    notes = [f"not installed, so not compared: {name} (docs/performance.md tells how)" for name in race.missing_peers()]
    return rows, notes if rows[0]["nJ_per_step"] is not None else [*notes, race.UNREADABLE]


def _learn(lanes: int, rounds: int) -> Found:
    from laconic.tools.learn import rate

    return rate.rows(lanes, rounds), []


def _soft_double(lanes: int, rounds: int) -> Found:
    from laconic.tools.report import board_cost

    return board_cost.soft_double_rows(), []


def _codes(lanes: int, rounds: int) -> Found:
    from laconic.tools.report import board_cost

    return board_cost.code_rows(), []


def _filter(lanes: int, rounds: int) -> Found:
    from laconic.tools.report import filter_cost

    return filter_cost.rows(), ["Flash has the steps and derivatives of the method (laconic_filter_predict_by), or of "
                                "all methods (laconic_filter_predict)."]


def table_of(title: str, rows: list[dict[str, Any]]) -> Table:
    """For people; a column that nobody could measure is left out."""
    table = Table(title=title, title_justify="left")
    fields = [name for name in COLUMNS if rows[0].get(name) is not None]
    for name in fields:
        table.add_column(COLUMNS[name], justify="left" if name in ("who", "real") else "right")
    for row in rows:
        table.add_row(*(f"{row[name]:.4g}" if isinstance(row[name], float) else str(row[name]) for name in fields))
    return table
