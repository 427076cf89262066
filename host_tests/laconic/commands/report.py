"""laconic report: what accuracy costs, measured."""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path

import click
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from laconic.errors import BadInput, reason_of
from laconic.options import OutputFolder, SceneName, json_flag
from laconic.paths import build_dir, scene_names
from laconic.report.collect import collect
from laconic.report.page import shown, write
from laconic.scene import read_scene


@click.command(name="report", short_help="Error against run time, sizes, stability: an HTML page.")
@click.option("--scene", "scenes", type=SceneName(), multiple=True, metavar="SCENE",
              help="Instead of all; may be given several times.")
@click.option("--out", type=OutputFolder(), metavar="DIR", help="Folder; build/report where none is given.")
@click.option("--quick", is_flag=True, help="Fewer repetitions and one board: rough figures, some minutes.")
@json_flag("Print the goals as JSON.")
def command(scenes: tuple[str, ...], out: Path | None, quick: bool, json_wanted: bool) -> None:
    """Measures error against run time, stability, drift, extremes, sizes and other integrators.

    Writes index.html (one file, opens offline), report.json and a CSV for each table, and prints the project's goals
    with what was found. What is not installed is left out and named.
    """
    folder = out or build_dir() / "report"
    read = [read_scene(name) for name in scenes or scene_names()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        report = collect(read, folder / "work", quick)
        page = write(report, folder, version("laconic"))
    except OSError as error:
        raise BadInput(f"{error.filename or folder}: {reason_of(error)}; choose another folder with --out") from None
    if json_wanted:
        goals = report.results["targets"]
        click.echo(json.dumps({"page": str(page), "notes": report.notes, "goals": goals}, indent=1, default=float))
        return
    show(report.results["targets"])
    for note in report.notes:
        click.echo(note)
    click.echo(f"{page}")


def show(goals: list[dict]) -> None:
    """The table for people."""
    table = Table(title="Goals", title_justify="left")
    for heading, justify in (("", "left"), ("goal", "left"), ("found", "right"), ("", "left"), ("wanted", "right"),
                             ("", "left")):
        table.add_column(heading, justify=justify, overflow="fold")
    colours = {"met": "green", "missed": "red", "not measured": "yellow"}
    for row in goals:
        numbers = [shown(name, row[name]) for name in ("found", "wanted")]
        table.add_row(row["group"], escape(row["goal"]), numbers[0], row["bound"], numbers[1],
                      f"[{colours[row['verdict']]}]{row['verdict']}[/]")
    Console(width=None if Console().is_terminal else 150).print(table)
