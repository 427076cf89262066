"""Compare the core with reference trajectories."""

from __future__ import annotations

import json
from pathlib import Path

import click
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from laconic.cli.options import InputPath, json_flag, one_of
from laconic.core import REALS, load
from laconic.errors import BadInput
from laconic.progress import progress_bar
from laconic.scene import METHODS
from laconic.verification.trajectories import CaseResult, as_json, read_reference, verify_case


@click.command("verify")
@click.argument("reference", type=InputPath())
@one_of("--method", METHODS, "Method", default="auto", show_default=True)
@click.option("--step", "step_s", type=float, default=1e-3, show_default=True, metavar="H", help="Step in seconds.")
@click.option("--real", type=click.Choice(REALS), default="double", show_default=True, help="Scalar type of the core.")
@click.option("--tolerance", type=float, metavar="T", help="Largest error that passes; without it any does.")
@json_flag()
def command(reference: Path, method: str, step_s: float, real: str, tolerance: float | None, json_wanted: bool) -> int:
    """Compares the core with the trajectories of REFERENCE, a JSON file.

    Errors are the largest over states and components, divided by max(1, largest reference value of that kind in the
    case). A step that does not divide a segment is shortened to the next that does. Exit status 1 when a case is
    refused or over the tolerance.
    """
    check_positive(step_s, tolerance)
    cases, core = read_reference(reference), load(real)
    with progress_bar("verify", sum(len(list(case.tables("segments"))) for case in cases)) as advance:
        results = [verify_case(core, case, method, step_s, advance) for case in cases]
    if json_wanted:
        click.echo(json.dumps(as_json(results, method, step_s, real), indent=1))
    else:
        show(results, tolerance, f"{method}, step {step_s:g} s, {real}")
    return 0 if all(passes(each, tolerance) for each in results) else 1


def check_positive(step_s: float, tolerance: float | None) -> None:
    """Steps and tolerances are above zero and finite."""
    for name, value in (("--step", step_s), ("--tolerance", tolerance)):
        if value is not None and not 0.0 < value < float("inf"):
            raise BadInput(f"{name}: {value:g} is not usable; give a finite number above zero")


def passes(result: CaseResult, tolerance: float | None) -> bool:
    """Whether a case ran, within the tolerance where there is one."""
    return result.status == "ok" and (tolerance is None or result.worst <= tolerance)


def show(results: list[CaseResult], tolerance: float | None, title: str) -> None:
    """The table for people."""
    table = Table(title=title, title_justify="left")
    table.add_column("case")
    for heading in ("error ν", "error pose", "error wheels", "ms"):
        table.add_column(heading, justify="right")
    table.add_column("status")
    for each in results:
        errors = ["–" if e is None else f"{e:.1e}" for e in (each.error_nu, each.error_pose, each.error_wheel)]
        status = each.status if each.status != "ok" or passes(each, tolerance) else "over the tolerance"
        table.add_row(escape(each.name), *errors, f"{1e3 * each.seconds:.1f}", escape(status))
    Console(width=None if Console().is_terminal else 160).print(table)
