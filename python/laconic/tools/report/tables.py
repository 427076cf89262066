"""What the command line shows of a report."""

from __future__ import annotations

from typing import Any

from rich.console import JustifyMethod
from rich.markup import escape
from rich.table import Table

from laconic.tools.report.page import TEXT, TITLES, shown


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
