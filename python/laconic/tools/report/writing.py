"""Writes a report: its pages, report.json and a CSV for each table.

What the command line shows of a report.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import JustifyMethod
from rich.markup import escape
from rich.table import Table

from laconic.base.outputs import opened, write_text
from laconic.tools.report.collect import Report
from laconic.tools.report.page import TEXT, TITLES, Document, Row, render, shown
from laconic.tools.report.robot import robot_sections
from laconic.tools.report.sections import goal_sections, project_sections

GOALS_PAGE = "goals.html"


def write(report: Report, folder: Path, version: str) -> Path:
    """index.html, for the project's report goals.html too, report.json and the CSV files; gives index.html."""
    for name, rows in report.results.items():
        if rows:
            _write_csv(folder / f"{name}.csv", rows)
    write_text(folder / "report.json", json.dumps({"version": version, "notes": report.notes, **report.results},
                                                  indent=1, default=float))
    if report.robots:
        main = _about_robots(report)
    else:
        main = _about_the_project(report)
        write_text(folder / GOALS_PAGE, render(_about_goals(report), version))
    page = folder / "index.html"
    write_text(page, render(main, version))
    return page


def _about_robots(report: Report) -> Document:
    names = [scene.name for scene in report.robots]
    return Document(names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}",
                    "What accuracy costs on this robot." if len(names) == 1 else "What accuracy costs on these robots.",
                    robot_sections(report.robots, report.results), report.notes)


def _about_the_project(report: Report) -> Document:
    return Document("Laconic: what accuracy costs", "Measured on the scenes that come with the project; "
                    "laconic report --scene FILE makes the page of one robot.",
                    project_sections(report.results), report.notes, {"The project's goals": GOALS_PAGE})


def _about_goals(report: Report) -> Document:
    goals = report.results["targets"]
    count = {verdict: sum(row["verdict"] == verdict for row in goals) for verdict in ("met", "missed", "not measured")}
    summary = (f"Of {len(goals)} goals {count['met']} are met, {count['missed']} missed, "
               f"{count['not measured']} not measured.")
    return Document("Laconic: the project's goals", summary, goal_sections(report.results), report.notes,
                    {"What accuracy costs": "index.html"})


def _write_csv(path: Path, rows: Sequence[Row]) -> None:
    fields = list(dict.fromkeys(key for row in rows for key in row))
    with opened(path) as file:
        writer = csv.DictWriter(file, fields)
        writer.writeheader()
        writer.writerows(rows)


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
