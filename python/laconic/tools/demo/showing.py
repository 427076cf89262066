"""What the main job found: figures in files, tables for people."""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, fields
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from laconic.base.outputs import opened, write_text
from laconic.scene.methods import EXPLICIT
from laconic.tools.demo.main_job import PARTICIPANTS, SceneResult
from laconic.tools.demo.work import Point

SHOWN_METHODS = ("auto", EXPLICIT)
SHOWN_FACTORS = (1, 10, 50)


GROUND = {True: "hold", False: "[yellow]exceeded", None: "wheels slip"}  # of the no-slip model; None: another model


def write_figures(results: list[SceneResult], out: Path) -> None:
    """demo.json with everything, errors.csv with one row a run."""
    write_text(out / "demo.json", json.dumps([each.as_json() for each in results], indent=1) + "\n")
    with opened(out / "errors.csv") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["scene", *(each.name for each in fields(Point))])
        for each in results:
            writer.writerows([Path(each.file).stem, *asdict(point).values()] for point in each.points)


def show(results: list[SceneResult], out: Path, seconds: float) -> None:
    """Both tables and where the pictures are."""
    console = Console()
    console = console if console.is_terminal else Console(width=150)
    console.print(bits_table(results))
    console.print(work_table(results))
    for each in results:
        for difference in filter(None, each.same_bits.values()):
            console.print(f"[red]{escape(f'{each.name}: {difference}')}")
    for each in results:
        if each.ground:
            console.print(f"{each.name}: the ground cannot give what this run needs: {each.ground}", markup=False,
                          highlight=False)
    console.print(f"Pictures, demo.json and errors.csv (all methods and steps): {escape(str(out))}   ({seconds:.0f} s)")


def bits_table(results: list[SceneResult]) -> Table:
    """Who gave the core's bits."""
    table = Table(title="Same bits as the core", title_justify="left")
    table.add_column("scene")
    table.add_column("steps", justify="right")
    for who in PARTICIPANTS:
        table.add_column(who + (" over CAN" if who == "node" else ""), justify="center")
    table.add_column("grip and loads", justify="center")
    for each in results:
        words = ["yes" if not each.same_bits[who] else "[red]NO" for who in PARTICIPANTS]
        shown = [f"{word} ({each.compared[who]:,} exchanges)" for word, who in zip(words, PARTICIPANTS, strict=True)]
        ground = "not watched" if each.no_slip is None else GROUND[each.no_slip["holds"]]
        table.add_row(escape(each.name), f"{each.steps:,}", *shown, ground)
    return table


def work_table(results: list[SceneResult]) -> Table:
    """Error against run time for some steps of some methods; the rest is in errors.csv."""
    table = Table(title="Largest relative error (ν, pose, wheel angles) against an independent reference @ run time "
                        "per step", title_justify="left", caption="h: the scene's step; floor: the error of the "
                        "reference itself", caption_justify="left")
    for heading in ("scene", "method"):
        table.add_column(heading)
    for heading in ("h", *(f"{factor} h" if factor > 1 else "h" for factor in SHOWN_FACTORS), "floor"):
        table.add_column(heading if heading != "h" or len(table.columns) > 2 else "h [s]", justify="right")
    for each in results:
        smallest = min(point.step_s for point in each.points)
        for method in SHOWN_METHODS:
            cells = [cell(each.points, method, factor * smallest) for factor in SHOWN_FACTORS]
            first = method == SHOWN_METHODS[0]
            table.add_row(escape(each.name) if first else "", method, f"{smallest:g}" if first else "", *cells,
                          f"{each.floor:.0e}" if first else "", end_section=method == SHOWN_METHODS[-1])
    return table


def cell(points: list[Point], method: str, step_s: float) -> str:
    """Error @ nanoseconds of one run."""
    for point in points:
        if point.method == method and abs(point.step_s - step_s) < 1e-9 * step_s:
            return point.refusal or f"{point.error:.1e} @ {point.ns_per_step:.0f} ns"
    return "–"
