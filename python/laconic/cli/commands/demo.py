"""The main job: real robots through core, FMUs and node."""

from __future__ import annotations

import json
import time
from pathlib import Path

import click

from laconic.base.outputs import claim_file
from laconic.base.paths import results_dir
from laconic.base.progress import progress_bar
from laconic.cli.options import OutputFolder, SceneName, json_flag
from laconic.scene import read_scene

SCENES = ("turtlebot3_burger", "robotino2", "kuka_youbot", "paper_caster", "paper_three_wheel_free",
          "paper_three_wheel_driven", "paper_differential_drive", "s1")


@click.command("demo")
@click.argument("scenes", type=SceneName(), nargs=-1, metavar="[SCENE]...")
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR",
              help="Folder for pictures and figures; demo/ of the build tree if not given.")
@json_flag()
def command(scenes: tuple[str, ...], out: Path | None, json_wanted: bool) -> int:
    """Runs each SCENE (by default three real robots and the paper's examples) through the core, its FMU (FMI 2 and FMI
    3, by FMPy) and the firmware node over CAN in lockstep. Compares all of them bit for bit.

    The core is compared with an independent reference (SciPy, tight tolerance) for every method and several steps. The
    error against run time is a table, a CSV file and one picture a scene. Exit status 1 when any bit differs.
    """
    from laconic.tools.demo.main_job import STAGES, run_scene
    from laconic.tools.demo.showing import show, write_figures

    out = out or results_dir("demo")
    given = [read_scene(scene) for scene in scenes or SCENES]
    for scene in given:
        claim_file("demo:", out / f"{scene.path.stem}.png")
    began = time.perf_counter()
    with progress_bar("demo", STAGES * len(given)) as moved:
        results = [run_scene(scene, out, moved) for scene in given]
    seconds = time.perf_counter() - began
    write_figures(results, out)
    if json_wanted:
        click.echo(json.dumps({"seconds": seconds, "scenes": [each.as_json() for each in results]}, indent=1))
    else:
        show(results, out, seconds)
    return 0 if all(each.passed for each in results) else 1
