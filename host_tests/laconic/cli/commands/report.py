"""Error against run time, sizes, stability: an HTML page."""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path
from typing import Any

import click
from rich.console import Console, JustifyMethod
from rich.markup import escape
from rich.table import Table

from laconic.benchmark.page import TEXT, TITLES, shown
from laconic.cli.options import OutputFolder, SceneName, json_flag
from laconic.errors import BadInput, reason_of
from laconic.paths import results_dir, scene_names
from laconic.scene import read_scene


@click.command("report")
@click.option("--scene", "scenes", type=SceneName(), multiple=True, metavar="SCENE",
              help="About this robot, instead of the project; may be given several times.")
@click.option("--out", type=OutputFolder(), metavar="DIR", help="Folder; else report/ of the build tree.")
@click.option("--quick", is_flag=True, help="Fewer repetitions and one board: rough figures, much sooner.")
@json_flag("Print what is shown as JSON.")
def command(scenes: tuple[str, ...], out: Path | None, quick: bool, json_wanted: bool) -> None:
    """Measures what accuracy costs: error against run time, stability, sizes; of robots, or of the project itself.

    With --scene the page is about that robot. Without, it is about the project, and measures drift, extremes and other
    integrators besides; the project's goals are a page of their own, goals.html. Writes index.html (one file, opens
    offline), report.json and a CSV for each table; the folder work beside them keeps the programs that were measured.
    A measurement whose tools are not installed is left out and named.
    """
    from laconic.benchmark.collect import collect
    from laconic.benchmark.robot import collect_robots
    from laconic.benchmark.writing import write

    folder = out or results_dir("report")
    read = [read_scene(name) for name in scenes or scene_names()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        report = (collect_robots if scenes else collect)(read, folder / "work", quick)
        page = write(report, folder, version("laconic"))
    except OSError as error:
        raise BadInput(f"{error.filename or folder}: {reason_of(error)}; choose another folder with --out") from None
    if json_wanted:
        found = {"goals": report.results["targets"], "robots": report.results["robots"], "take": report.results["take"]}
        click.echo(json.dumps({"page": str(page), "notes": report.notes, **found}, indent=1, default=float))
        return
    console = Console(width=None if Console().is_terminal else 150)
    for table in robot_tables(report.results) if scenes else [goal_table(report.results["targets"])]:
        console.print(table)
    for note in report.notes:
        click.echo(note)
    click.echo(f"{page}")


def robot_tables(results: dict[str, list[dict[str, Any]]]) -> list[Table]:
    """For people: what to take, and what a step costs on a microcontroller."""
    take = _table("What to take: the quickest that reaches an error of ν, pose and wheel angles (relative)",
                  ("scene", "wanted_error", "real", "method", "step_s", "error", "us_per_second"), results["take"])
    board = _table("On a Cortex-M4F", ("scene", "chosen", "real", "build", "instructions", "step_code", "flash",
                                       "worst_stack", "same_bits"), results["scenes"])
    return [take, board] if results["scenes"] else [take]


def _table(title: str, fields: tuple[str, ...], rows: list[dict[str, Any]]) -> Table:
    table = Table(title=title, title_justify="left")
    for name in fields:
        table.add_column(escape(TITLES.get(name, name)), justify="left" if name in TEXT else "right", overflow="fold")
    for row in rows:
        table.add_row(*(escape(shown(name, row.get(name))) for name in fields))
    return table


def goal_table(goals: list[dict[str, Any]]) -> Table:
    """The table for people."""
    table = Table(title="Goals", title_justify="left")
    headings: tuple[tuple[str, JustifyMethod], ...] = (
        ("", "left"), ("goal", "left"), ("found", "right"), ("", "left"), ("wanted", "right"), ("", "left"))
    for heading, justify in headings:
        table.add_column(heading, justify=justify, overflow="fold")
    colours = {"met": "green", "missed": "red", "not measured": "yellow"}
    for row in goals:
        numbers = [shown(name, row[name]) for name in ("found", "wanted")]
        table.add_row(row["group"], escape(row["goal"]), numbers[0], row["bound"], numbers[1],
                      f"[{colours[row['verdict']]}]{row['verdict']}[/]")
    return table
