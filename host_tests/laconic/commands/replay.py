"""laconic replay: a recorded robot run against the model."""

from __future__ import annotations

import json
from pathlib import Path

import click

from laconic.options import InputPath, OutputFolder, SceneName, json_flag
from laconic.outputs import write_text


@click.command("replay", short_help="Compare a recorded run with the model.")
@click.argument("log", type=InputPath())
@click.argument("scene", type=SceneName())
@click.option("--fit", "fit_on", type=InputPath(), multiple=True, metavar="RUN.csv",
              help="Fit friction on this run; may be given several times. Nothing said: every other run of a folder.")
@click.option("--map", "map_path", type=InputPath(), metavar="MAP.toml",
              help="Which column is what; the default is that of the Robotino's runs.")
@click.option("--out", type=OutputFolder(), metavar="DIR",
              help="Write report.md, report.json and pictures there.")
@json_flag("Machine-readable result on stdout.")
def command(log: Path, scene: str, fit_on: tuple[Path, ...], map_path: Path | None, out: Path | None,
            json_wanted: bool) -> None:
    """Compares LOG, a recorded run as CSV or a folder of them, with the model of SCENE.

    The measured wheel speeds are rolled and set beside the camera; friction is fitted by least squares; and the core,
    driven by the measured currents as torques, predicts the wheel speeds.
    """
    from laconic.analysis.from_core import subject_of
    from laconic.progress import progress_bar
    from laconic.replay import report
    from laconic.replay.log import DEFAULT_MAP, read_map
    from laconic.replay.runs import compare_all, gather
    from laconic.scene import read_scene

    subject = subject_of(read_scene(scene))
    runs, names, skipped = gather(log, fit_on, read_map(map_path or DEFAULT_MAP))
    with progress_bar("replaying", len(runs) + 1) as advance:
        found = compare_all(subject, runs, names, skipped, advance)
    numbers = report.as_numbers(found)
    if out is not None:
        pictures = report.draw(found, out)
        images = "".join(f"![{path.stem}]({path.name})\n" for path in pictures)
        write_text(out / "report.md", report.as_text(found) + "\n## Pictures\n\n" + images)
        write_text(out / "report.json", json.dumps(numbers, indent=1) + "\n")
    click.echo(json.dumps(numbers, indent=1) if json_wanted else report.as_text(found))
