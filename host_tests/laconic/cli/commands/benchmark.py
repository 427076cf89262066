"""Vehicle-steps a second, beside other programs in turn."""

from __future__ import annotations

import json
from typing import Any

import click
from rich.console import Console
from rich.table import Table

from laconic.cli.options import json_flag
from laconic.errors import LaconicError

COLUMNS = {"who": "", "real": "scalar", "million_steps_per_s": "million steps/s", "ns_per_step": "ns a step",
           "times_batch": "over the batch", "times_alone": "over one by one", "nJ_per_step": "nJ a step"}


@click.command("benchmark")
@click.argument("what", metavar="WHAT", type=click.Choice(["batch"]))
@click.option("--lanes", type=click.IntRange(1, 10**6), default=1000, show_default=True, help="Vehicles side by side.")
@click.option("--rounds", type=click.IntRange(1, 1000), default=15, show_default=True,
              help="How often all run in turn; the least time of each counts.")
@json_flag()
def command(what: str, lanes: int, rounds: int, json_wanted: bool) -> None:
    """Times vehicles that step side by side.

    batch: Robotino 2, Runge-Kutta steps of 1 ms with pose and wheel angles, 100 in a run, on one core: the core's
    batch, the core one vehicle after the other, and the same step in numba and JAX, and MuJoCo, where they are
    installed. All that compute the same are compared with the core before they are timed.
    """
    from laconic.benchmark.many import energy, race

    race.stay_on_one_core()
    try:
        rows = race.rows(lanes, rounds)
    except race.Disagreement as error:
        raise LaconicError(f"{error}; nothing was timed") from None
    notes = [f"not installed, so not compared: {name} (docs/performance.md tells how)" for name in race.missing_peers()]
    if rows[0]["nJ_per_step"] is None:
        notes.append(energy.UNREADABLE)
    if json_wanted:
        click.echo(json.dumps({"lanes": lanes, "rows": rows, "notes": notes}, indent=1))
        return
    Console(width=None if Console().is_terminal else 120).print(table_of(rows))
    for note in notes:
        click.echo(note)


def table_of(rows: list[dict[str, Any]]) -> Table:
    """For people; a column that nobody could measure is left out."""
    table = Table(title="Vehicle-steps on one core", title_justify="left")
    fields = [name for name in COLUMNS if rows[0][name] is not None]
    for name in fields:
        table.add_column(COLUMNS[name], justify="left" if name in ("who", "real") else "right")
    for row in rows:
        table.add_row(*(row[name] if isinstance(row[name], str) else f"{row[name]:.4g}" for name in fields))
    return table
