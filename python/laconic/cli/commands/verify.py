"""Compare the core with reference trajectories."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path

import click
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from laconic.base.progress import progress_bar
from laconic.cli.options import ReferenceOrScene, all_methods, is_scene, json_flag, one_of
from laconic.core import REALS, Core, load
from laconic.core.articulated import method_names
from laconic.errors import BadInput
from laconic.scene import METHODS, read_scene
from laconic.scene.table import Table as Case
from laconic.tools.verify.articulated import ArticulatedResult, verify_articulated_case
from laconic.tools.verify.slipping import SlippingResult, is_slipping, verify_slipping_case
from laconic.tools.verify.trajectories import (
    CaseResult,
    EnclosedResult,
    as_json,
    bound_text,
    is_articulated,
    read_reference,
    verify_case,
)

Result = CaseResult | ArticulatedResult | SlippingResult
METHOD, STEP_S, REAL = "auto", 1e-3, "double"  # where neither the command line nor a scene gives them


@click.command("verify")
@click.argument("reference", type=ReferenceOrScene())
@one_of("--method", all_methods(),
        f"Method, {METHOD} where nothing is given; a scene's own; circle and moebius-4 are for vehicles with hinges")
@click.option("--step", "step_s", type=float, metavar="H", help=f"Step in seconds, {STEP_S:g}; a scene's own.")
@click.option("--real", type=click.Choice(REALS), help=f"Scalar type of the core, {REAL}; a scene's own.")
@click.option("--tolerance", type=float, metavar="T", help="Largest error that passes; without it any does.")
@click.option("--enclose", "enclose_wanted", is_flag=True,
              help="Compare with the proved enclosure of the motion instead; REFERENCE may then be a scene.")
@json_flag()
def command(reference: str, method: str | None, step_s: float | None, real: str | None, tolerance: float | None,
            enclose_wanted: bool, json_wanted: bool) -> int:
    """Compares the core with the trajectories of REFERENCE, a JSON file.

    Errors are the largest over states and components, divided by max(1, largest reference value of that kind in the
    case). A step that does not divide a segment is shortened to the next that does. Exit status 1 when a case is
    refused or over the tolerance.

    With --enclose the errors are proved bounds, and REFERENCE may be a scene, by path or name: see docs/accuracy.md. A
    file's own states must also lie inside the enclosure, or the exit status is 1.

    In a file of vehicles with hinges on ground with friction the errors are those at the end, in their own units, and a
    single step has the size that the file gives it.
    """
    check_positive(step_s, tolerance)
    if enclose_wanted and is_scene(reference):
        return verify_scene(reference, method, step_s, real, tolerance, json_wanted)
    used = (method or METHOD, step_s or STEP_S, real or REAL)
    cases, core = read_reference(Path(reference)), load(used[2])
    articulated = [case for case in cases if is_articulated(case)]
    slipping = any(map(is_slipping, cases))
    check_method(used[0], (METHOD,) if slipping else method_names() if articulated else METHODS)
    if (articulated or slipping) and enclose_wanted:
        cases[0].fail("vehicle", "has hinges, which --enclose does not take yet; leave it out")
    check = verify_enclosed if enclose_wanted else verify_one
    with progress_bar("verify", sum(segments_of(case) for case in cases)) as advance:
        results = [check(core, case, *used[:2], advance) for case in cases]
    return told(results, tolerance, used, json_wanted)


def segments_of(case: Case) -> int:
    """How many segments a case has; one of single steps has none."""
    return len(list(case.tables("segments"))) if case.has("segments") else 0


def check_method(method: str, known: Sequence[str]) -> None:
    """BadInput for a method that does not step the vehicles of a file."""
    if method not in known:
        raise BadInput(f"--method: {method} does not step these vehicles; use {', '.join(known)}")


def verify_one(core: Core, case: Case, method: str, step_s: float, advance: Callable[[], None]) -> Result:
    """One case of a rigid vehicle or of one with hinges, on ideal ground or on ground with friction."""
    if is_slipping(case):
        return verify_slipping_case(core, case, method, step_s, advance)
    check = verify_articulated_case if is_articulated(case) else verify_case
    return check(core, case, method, step_s, advance)


def told(results: list[Result], tolerance: float | None, used: tuple[str, float, str], json_wanted: bool) -> int:
    """Prints the results; the exit status."""
    if json_wanted:
        click.echo(json.dumps(as_json(results, *used), indent=1))
    else:
        method, step_s, real = used
        show(results, tolerance, f"{method}, step {step_s:g} s, {real}")
    return 0 if all(passes(each, tolerance) for each in results) else 1


def verify_enclosed(core: Core, case: Case, method: str, step_s: float, advance: Callable[[], None]) -> CaseResult:
    """One case of a reference file."""
    from laconic.tools.enclosure.references import verify_enclosed_case

    return verify_enclosed_case(core, case, method, step_s, advance)


def verify_scene(name: str, method: str | None, step_s: float | None, real: str | None, tolerance: float | None,
                 json_wanted: bool) -> int:
    """A scene's run against its enclosure; the exit status."""
    from laconic.tools.enclosure.study import verify_scene_enclosed

    scene = read_scene(name).with_run(method=method, step_s=step_s, real=real)
    return told([verify_scene_enclosed(scene)], tolerance, (scene.run.method, scene.run.step_s, scene.run.real),
                json_wanted)


def check_positive(step_s: float | None, tolerance: float | None) -> None:
    """Steps and tolerances are above zero and finite."""
    for name, value in (("--step", step_s), ("--tolerance", tolerance)):
        if value is not None and not 0.0 < value < float("inf"):
            raise BadInput(f"{name}: {value:g} is not usable; give a finite number above zero")


def passes(result: Result, tolerance: float | None) -> bool:
    """Whether a case ran, within the tolerance where there is one."""
    return result.status == "ok" and (tolerance is None or result.worst <= tolerance)


def show(results: list[Result], tolerance: float | None, title: str) -> None:
    """The table for people."""
    table = Table(title=title, title_justify="left")
    table.add_column("case")
    enclosed = any(isinstance(each, EnclosedResult) for each in results)
    slipping = any(isinstance(each, SlippingResult) for each in results)
    hinged = any(isinstance(each, ArticulatedResult) for each in results)
    headings = ("error ν ≤", "error pose ≤", "error wheels ≤", "width ≤") if enclosed else (
        "error velocities", "error pose", "error wheel speeds", "energy norm", "error hinge rate") if slipping else (
        "error velocity", "error hinge rate", "error hinge angle", "error pose", "error wheels") if hinged else (
        "error ν", "error pose", "error wheels")
    for heading in (*headings, "ms"):
        table.add_column(heading, justify="right")
    table.add_column("status")
    for each in results:
        numbers = each.errors if isinstance(each, ArticulatedResult | SlippingResult) else [
            each.error_nu, each.error_pose, each.error_wheel]
        texts = ["–" if e is None else bound_text(e) if enclosed else f"{e:.1e}" for e in numbers]
        texts += [bound_text(each.width)] if isinstance(each, EnclosedResult) else ["–"] if enclosed else []
        status = each.status if each.status != "ok" or passes(each, tolerance) else "over the tolerance"
        table.add_row(escape(each.name), *texts, f"{1e3 * each.seconds:.1f}", escape(status))
    Console(width=None if Console().is_terminal else 160).print(table)
