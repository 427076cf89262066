"""Choose numbers of a scene by stated goals: geometry, masses, motors."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from laconic.base.outputs import is_stdout, write_text
from laconic.cli.options import PICTURES, OutputFile, SceneName, json_flag
from laconic.errors import BadInput, ResultFails

if TYPE_CHECKING:
    from collections.abc import Sequence

    from laconic.scene.scene_tables import SceneTables
    from laconic.tools.measures.measure import Measure
    from laconic.tools.optimise.study import Result

MOST_POINTS = 200
MOST_GENERATIONS = 100_000


def _list_goals(context: click.Context, _: click.Parameter, is_on: bool) -> None:
    """Prints the measures and ends."""
    if is_on:
        from laconic.tools.optimise.measuring import listing

        click.echo(listing())
        context.exit()


@click.command("optimise")
@click.argument("scene", type=SceneName())
@click.option("--free", multiple=True, metavar="KEY=a:b", help="A number of the scene and the range it may have, in "
              "the unit of its name: vehicle.wheel[3].distance_m=0.05:0.2; keys with commas between them have one "
              "value. May be given several times.")
@click.option("--goal", "goals", multiple=True, metavar="min:MEASURE|max:MEASURE",
              help="The measure to make small or large. "
              "With several goals the choices are found of which none is better in all of them.")
@click.option("--subject-to", "constraints", multiple=True, metavar="'MEASURE<=v'",
              help="A bound to keep, <= or >=. May be given several times.")
@click.option("--goals", "listed", is_flag=True, is_eager=True, expose_value=False, callback=_list_goals,
              help="List the measures and exit.")
@click.option("-o", "--out", type=OutputFile(".toml", stdout=True), metavar="BEST.toml",
              help="Write the scene with the numbers found; - for stdout.")
@click.option("--plot", type=OutputFile(*PICTURES), metavar="F.png", help="Draw the vehicle before and after.")
@click.option("--front", "front_path", type=OutputFile(*PICTURES), metavar="F.png",
              help="Draw the front between several goals.")
@click.option("--points", type=click.IntRange(2, MOST_POINTS), default=15, show_default=True,
              help="Points of the front between the goals' own optima, about.")
@click.option("--pick", type=click.IntRange(1), metavar="N",
              help="Which point of the front to write and draw, as numbered in the table; otherwise the one whose "
              "worst goal loses least.")
@click.option("--generations", type=click.IntRange(1, MOST_GENERATIONS), default=300, show_default=True,
              help="Generations of the search at most.")
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True,
              help="Seed of the search: the same one gives the same result.")
@json_flag("Machine-readable result on stdout.")
def command(scene: str, free: tuple[str, ...], goals: tuple[str, ...], constraints: tuple[str, ...], out: Path | None,
            plot: Path | None, front_path: Path | None, points: int, pick: int | None, generations: int, seed: int,
            json_wanted: bool) -> None:
    """Chooses the --free numbers of SCENE so that measures become as small or as large as they can, within bounds.

    A search over the whole ranges (SciPy's differential evolution), then a descent from its best (SLSQP). Ctrl-C keeps
    the best so far. Exit status 1 where no choice keeps the bounds: then no file is written. With -o - the report goes
    to stderr.
    """
    from laconic.base.progress import progress_bar
    from laconic.scene.scene_tables import scene_tables
    from laconic.tools.optimise.measuring import problem_of
    from laconic.tools.optimise.problem import read_constraint, read_free, read_goal
    from laconic.tools.optimise.report import as_numbers, as_text
    from laconic.tools.optimise.search import Effort
    from laconic.tools.optimise.study import generations as most_generations
    from laconic.tools.optimise.study import optimise

    _check_several(goals, front_path, pick)
    tables = scene_tables(scene)
    problem, own, measuring = problem_of(
        tables, [read_free(each) for each in free], [read_goal(each) for each in goals],
        [read_constraint(each) for each in constraints])
    effort = Effort(generations)
    with progress_bar("generations", most_generations(problem, effort, points)) as advance:
        result = optimise(problem, own, effort, seed, points, pick, advance)
    if result.keeps:
        _write(tables, result, measuring.measures, out, plot, front_path)
    text = json.dumps(as_numbers(result, measuring, seed), indent=1) if json_wanted else as_text(
        result, tables.scene().name, measuring)
    click.echo(text, err=out is not None and is_stdout(out) and not json_wanted)
    if result.stopped is not None:
        raise result.stopped
    if not result.keeps:
        raise ResultFails("no choice within the ranges keeps all constraints; widen a range or loosen a constraint")


def _check_several(goals: Sequence[str], front_path: Path | None, pick: int | None) -> None:
    for option, given in (("--front", front_path), ("--pick", pick)):
        if given is not None and len(goals) < 2:
            raise BadInput(f"{option}: has a meaning with several goals alone; leave it out, or give another --goal")


def _write(tables: SceneTables, result: Result, measures: Sequence[Measure], out: Path | None, plot: Path | None,
           front_path: Path | None) -> None:
    """What the options ask for."""
    from laconic.tools.optimise.best_toml import best_text
    from laconic.tools.optimise.candidates import values_of

    if out is not None:
        write_text(out, best_text(tables, result))
    if plot is not None:
        from laconic.tools.optimise.pictures import draw_vehicles

        chosen = tables.with_values(values_of(result.problem.free, result.best.choice))
        draw_vehicles(tables.scene(), chosen.scene(), result, plot)
    if front_path is not None and result.front:
        from laconic.tools.optimise.pictures import draw_front

        draw_front(result, measures, tables.scene().name, front_path)
