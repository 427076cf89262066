"""Steady motions, stability, free motion, traction; of vehicles with hinges turns and growth rates."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from laconic.base.outputs import write_text
from laconic.cli.options import OutputFolder, SceneName, goes_with, json_flag
from laconic.errors import BadInput, ResultFails
from laconic.tools.analyse import PARTS

if TYPE_CHECKING:
    from laconic.base.progress import Advance
    from laconic.scene import Scene
    from laconic.tools.analyse.findings import Study

HINGED = "a scene with hinges"

@click.command("analyse")
@click.argument("scene", type=SceneName(hinges=True))
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR",
              help="Write report.md, report.json and pictures there.")
@click.option("--only", type=click.Choice(PARTS), multiple=True, help="Only this part; may be given several times.")
@click.option("--at", "at_s", type=float, default=0.0, metavar="T", help="Hold the inputs of this instant [s].")
@click.option("--straight", type=(float, float), metavar="NU1 NU2",
              help="Constant voltages for this straight motion, in rad/s, instead of the scene's inputs.")
@click.option("--start", type=(float, float, float), metavar="NU1 NU2 NU3",
              help="Start of the free motion in rad/s, instead of the scene's start.")
@click.option("--parameter", metavar="NAME", help="Parameter of the bifurcation diagram: nu1, nu2, input_scale, or a "
              "number of [vehicle] such as com_y_m.")
@click.option("--from", "low", type=float, metavar="A", help="Beginning of the bifurcation diagram.")
@click.option("--to", "high", type=float, metavar="B", help="End of the diagram.")
@click.option("--speed", "speeds", type=float, multiple=True, metavar="V",
              help="With hinges: straight motion at this speed [m/s]; may be given several times. 1 and -1 if not "
              "given.")
@click.option("--curvature", "curvatures", type=float, multiple=True, metavar="K",
              help="With hinges: a steady turn of this curvature to the left [1/m], inf on the spot; may be "
              "given several times.")
@click.option("--steering", type=(str, float), multiple=True, metavar="NAME RAD",
              help="With hinges: the steady turn in which a steered hinge of the carriage has this angle [rad]; may be "
              "given several times.")
@json_flag("Machine-readable result on stdout.")
def command(scene: str, out: Path | None, only: tuple[str, ...], at_s: float, straight: tuple[float, float] | None,
            start: tuple[float, float, float] | None, parameter: str | None, low: float | None,
            high: float | None, speeds: tuple[float, ...], curvatures: tuple[float, ...],
            steering: tuple[tuple[str, float], ...], json_wanted: bool) -> None:
    """Analyses SCENE: geometry, free motion, steady motions and their stability, bifurcations, traction.

    Of a scene with hinges: the tightest turns, steady turns, and how small angles of casters and trailers grow or decay
    in straight motion, ahead and in reverse.

    Exit status 1 when a simulation with the core does not confirm a result of the analysis.
    """
    from laconic.base.progress import progress_bar
    from laconic.scene import read_scene
    from laconic.tools.analyse.analyse import chosen_subject, study
    from laconic.tools.analyse.findings import StudyOptions
    from laconic.tools.analyse.report import as_numbers, as_text, pictures_of_older_page

    given = read_scene(scene)
    if not given.has_hinges and (speeds or curvatures or steering):
        raise BadInput(f"{given.path}: --speed, --curvature and --steering are for vehicles with hinges, and this one "
                       "has none; leave them out")
    if given.has_hinges:
        goes_with(HINGED, "--out", "--speed", "--curvature", "--steering", "--json")
        _with_hinges(given, out, speeds, curvatures, steering, json_wanted)
        return
    _check(low, high, straight, start)
    options = StudyOptions(tuple(p for p in PARTS if not only or p in only), parameter, low, high, straight, start)
    subject = chosen_subject(given, options.parts, at_s)
    with progress_bar("analysing", 100) as advance:
        found = study(subject, options, lambda share, part: advance(90 * share, what=part))
        pictures = _draw(found, out, advance)
    numbers = as_numbers(found, pictures)
    if out is not None:
        older = pictures_of_older_page(out, pictures)
        write_text(out / "report.md", as_text(found, pictures))
        write_text(out / "report.json", json.dumps(numbers, indent=1) + "\n")
        _remove(older)
    click.echo(json.dumps(numbers, indent=1) if json_wanted else as_text(found, []))
    if found.failures:
        raise ResultFails("not confirmed: " + "; ".join(found.failures))


def _with_hinges(scene: Scene, out: Path | None, speeds: tuple[float, ...], curvatures: tuple[float, ...],
                 steering: tuple[tuple[str, float], ...], json_wanted: bool) -> None:
    from laconic.tools.analyse.hinged import SPEEDS_M_PER_S, hinged_numbers, hinged_text, study_hinges
    from laconic.tools.analyse.report import plain

    found = study_hinges(scene, speeds_m_per_s=speeds or SPEEDS_M_PER_S, curvatures_per_m=curvatures, steering=steering)
    numbers = json.dumps(plain(hinged_numbers(found)), indent=1)
    if out is not None:
        write_text(out / "report.md", hinged_text(found))
        write_text(out / "report.json", numbers + "\n")
    click.echo(numbers if json_wanted else hinged_text(found))
    if found.failures:
        raise ResultFails("not confirmed: " + "; ".join(found.failures))


def _check(low: float | None, high: float | None, straight: tuple[float, ...] | None,
           start: tuple[float, ...] | None) -> None:
    given = [("--from", low), ("--to", high)]
    given += [("--straight", v) for v in straight or ()] + [("--start", v) for v in start or ()]
    for name, value in given:
        if value is not None and not abs(value) < 1e12:
            raise BadInput(f"{name}: {value:g} is not usable; give a finite number below 1e12")
    if low is not None and high is not None and not low < high:
        raise BadInput(f"--from {low:g} --to {high:g}: the range is empty; give the smaller number first")


def _remove(older: list[Path]) -> None:
    for path in older:
        path.unlink(missing_ok=True)
    if older:
        click.echo(f"laconic: removed {', '.join(path.name for path in older)}, of an older page in this folder",
                   err=True)


def _draw(found: Study, out: Path | None, advance: Advance) -> list[Path]:
    if out is None:
        return []
    from laconic.tools.analyse.pictures import draw

    advance(0, what="drawing")
    pictures = draw(found, out)
    advance(10, what="drawing")
    return pictures
