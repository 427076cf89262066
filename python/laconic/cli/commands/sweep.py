"""Run one scene many times, with some of its numbers varied."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click

from laconic.base.outputs import is_stdout, opened
from laconic.cli.options import OutputFile, OutputFolder, SceneName, goes_with, only_one
from laconic.errors import BadInput
from laconic.tools.measures import measures_of
from laconic.tools.measures.arguments import ArguedMeasure

if TYPE_CHECKING:
    from laconic.tools.sweep.plan import Plan

SAMPLINGS = ("sobol", "latin", "random")


@click.command("sweep")
@click.argument("scene", type=SceneName(), required=False)
@click.option("--vary", multiple=True, metavar="KEY=a:b:n|KEY=a,b|KEY~normal(m,s)",
              help="A key by its path, such as vehicle.wheel[2].x_m, and its values: n from a to b, a list, or a "
                   "distribution (normal, uniform, lognormal, triangular). Repeatable: grids make a product.")
@click.option("--samples", type=click.IntRange(1), metavar="N", help="Samples of the distributions.")
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=0, show_default=True, help="Seed of the samples.")
@click.option("--sampling", type=click.Choice(SAMPLINGS), default="sobol", show_default=True,
              help="Quasi-random, Latin hypercube, or pseudo-random.")
@click.option("--sensitivity", is_flag=True,
              help="Sample for Sobol' indices: N times (number of keys + 2) runs; N best a power of 2.")
@click.option("--measure", "measures", multiple=True, metavar="NAME",
              help="A measure of each run, by name; the end of the run without it. Repeatable.")
@click.option("--measures", "list_wanted", is_flag=True, help="List the measures, and nothing else.")
@click.option("--workers", type=click.IntRange(0, 4096), metavar="N",
              help="Processes on this machine, one for each core without it; 0: this process alone.")
@click.option("--scheduler", metavar="ADDRESS", help="A Dask scheduler, such as tcp://127.0.0.1:8786, for its workers.")
@click.option("-o", "--out", "--output", "folder", type=OutputFolder(), metavar="DIR",
              help="Folder for the results; a sweep that has begun there continues.")
@click.option("--repeat", "index", type=click.IntRange(0), metavar="INDEX",
              help="Write the scene of one run of the results in -o, for laconic simulate.")
@click.option("--scene-out", type=OutputFile(".toml", stdout=True), default=None, metavar="F.toml",
              help="File for the scene of --repeat; stdout without it.")
def command(scene: str | None, vary: tuple[str, ...], samples: int | None, seed: int, sampling: str, sensitivity: bool,
            measures: tuple[str, ...], list_wanted: bool, workers: int | None, scheduler: str | None,
            folder: Path | None, index: int | None, scene_out: Path | None) -> None:
    """Runs SCENE once for each point of a grid, or for samples of distributions, and writes measures of each run.

    DIR gets results.parquet, one row for each run, sweep.json with all that is needed to repeat them, and a page with
    pictures, summary.html. If the command is interrupted, completed runs are kept, and the same command continues.
    """
    if scene and (list_wanted or index is not None):
        flag = "--measures" if list_wanted else "--repeat"
        raise BadInput(f"SCENE {scene}: has no meaning beside {flag}; leave it out")
    if list_wanted:
        goes_with("--measures")
        print_measures()
        return
    if folder is None:
        raise BadInput("-o: is missing; give a folder for the results")
    if index is not None:
        check_extra()
        goes_with("--repeat", "--output", "--scene-out")
        repeat(folder, index, scene_out)
        return
    if scene_out:
        raise BadInput("--scene-out: has a meaning with --repeat alone; leave it out")
    check_extra()
    if scene is None:
        raise BadInput("SCENE: is missing; give a scene file, or the name of one that comes with the project")
    only_one({"--scheduler": scheduler is not None, "--workers": workers is not None})
    plan = planned(scene, vary, samples, seed, "saltelli" if sensitivity else sampling, measures)
    run(plan, folder, scheduler, workers)


def check_extra() -> None:
    """Names what the extra brings and is not there, before any work is done."""
    for name in ("distributed", "pyarrow", "SALib", "scipy"):
        if find_spec(name) is None:
            raise ModuleNotFoundError(f"no {name}", name=name)


def print_measures() -> None:
    """Names with units and words."""
    for name, measure in measures_of("run").items():
        usage = measure.usage if isinstance(measure, ArguedMeasure) else name
        click.echo(f"{usage:30} {measure.words}{f' (needs {measure.needs})' if measure.needs else ''}")


def planned(scene: str, vary: tuple[str, ...], samples: int | None, seed: int, sampling: str,
            measures: tuple[str, ...]) -> Plan:
    """The plan of the command line."""
    from laconic.scene.scene_tables import SceneTables, scene_tables
    from laconic.tools.sweep.plan import make_plan

    tables = scene_tables(scene)
    tables.scene()  # a scene that cannot be read is told before its keys
    tables = SceneTables(Path(scene), tables.entries)  # results name the scene as it was given
    return make_plan(tables, vary, measures, samples=samples, seed=seed, sampling=sampling, scene=scene)


def run(plan: Plan, folder: Path, scheduler: str | None, workers: int | None) -> None:
    """All that is missing, and the page."""
    from laconic.tools.sweep.page import check_any_run, write_page
    from laconic.tools.sweep.sweep import begin, carry_on, runs_there

    store = begin(plan, folder, scheduler)
    if there := runs_there(store):
        click.echo(f"{there} of {plan.runs} runs are in {folder}" + (", which goes on" if there < plan.runs else ""))
    try:
        carry_on(store, scheduler, workers)
    except KeyboardInterrupt:
        click.echo(f"laconic: {runs_there(store)} of {plan.runs} runs are kept in {folder}; the same command goes on",
                   err=True)
        raise
    for line in write_page(store):
        click.echo(line)
    check_any_run(store)


def repeat(folder: Path, index: int, file: Path | None) -> None:
    """The scene of one run as TOML."""
    from laconic.base.outputs import STDOUT
    from laconic.tools.sweep.store import plan_in

    plan, about = plan_in(folder)
    if index >= plan.runs:
        raise BadInput(f"--repeat {index}: there is no such run; {folder} has 0 to {plan.runs - 1}")
    values = plan.of_run(index)
    tables = plan.tables.with_values(values)
    with opened(file or STDOUT) as text:
        text.write(f"# Run {index} of: {about['command']}\n")
        text.writelines(f"# {key} = {value!r}\n" for key, value in values.items())
        text.write("\n" + tables.toml())
    if file and not is_stdout(file):
        click.echo(f"wrote {file}; laconic simulate {file} runs it")
