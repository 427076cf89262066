"""Error against run time, sizes, stability: an HTML page."""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path

import click
from rich.console import Console

from laconic.base.outputs import make_folder
from laconic.base.paths import results_dir
from laconic.cli.options import OutputFolder, SceneName, json_flag
from laconic.errors import BadInput, reason_of
from laconic.scene import read_scene, rigid_scene_names


@click.command("report")
@click.option("--scene", "scenes", type=SceneName(), multiple=True, metavar="SCENE",
              help="About this robot, instead of the project; may be given several times.")
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR",
              help="Folder; else report/ of the build tree, or laconic-report/ here where there is none.")
@click.option("--quick", is_flag=True, help="Fewer repetitions and one board: rough figures, much sooner.")
@json_flag("Print what is shown as JSON.")
def command(scenes: tuple[str, ...], out: Path | None, quick: bool, json_wanted: bool) -> None:
    """Measures what accuracy costs: error against run time, stability, sizes; of robots, or of the project itself.

    With --scene the page is about that robot. Without, it is about the project, and also measures drift, extremes and
    other integrators. The project's goals are on their own page, goals.html. Writes index.html (one file, opens
    offline), report.json and a CSV for each table; the folder work next to them keeps the programs that were measured.
    A measurement whose tools are not installed is left out and named.
    """
    from laconic.tools.report.collect import collect
    from laconic.tools.report.robot import collect_robots
    from laconic.tools.report.writing import goal_table, robot_tables, write

    folder = out or results_dir("report")
    read = [read_scene(name) for name in scenes or rigid_scene_names()]
    try:
        make_folder(folder)
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
