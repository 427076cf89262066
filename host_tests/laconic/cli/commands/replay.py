"""Compare a recorded run with the model."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import click

from laconic.cli.options import InputPath, OutputFolder, SceneName, json_flag
from laconic.errors import BadInput
from laconic.outputs import write_text


@click.command("replay")
@click.argument("log", type=InputPath())
@click.argument("scene", type=SceneName())
@click.option("--fit", "fit_on", type=InputPath(), multiple=True, metavar="RUN.csv",
              help="Fit friction on this run; may be given several times. By default every other run of a folder.")
@click.option("--map", "map_path", type=InputPath(), metavar="MAP.toml",
              help="Which column is what; the default is that of the Robotino's runs; a file "
              "whose columns have names of signals needs none.")
@click.option("--out", type=OutputFolder(), metavar="DIR",
              help="Write report.md, report.json and pictures there.")
@json_flag("Machine-readable result on stdout.")
def command(log: Path, scene: str, fit_on: tuple[Path, ...], map_path: Path | None, out: Path | None,
            json_wanted: bool) -> None:
    """Compares LOG, a recorded run as CSV or a folder of them, with the model of SCENE.

    A file whose first column is time_s and whose others have names of signals, as `simulate --out F.csv --inputs`
    writes it, needs no map: its inputs drive the core, and every other signal in it is compared. Otherwise the map says
    what the columns are: the path that the measured wheel speeds give is compared with the camera's; friction is fitted
    by least squares; and the core, driven by the measured currents as torques, predicts the wheel speeds.
    """
    from laconic.recorded_runs.signals import is_signal_log

    if map_path is None and is_signal_log(log):
        if fit_on:
            raise BadInput("--fit: needs measured currents; leave it out for a file whose columns are signals, or give "
                           "its --map")
        text, numbers, draw = _by_signals(log, scene)
    else:
        text, numbers, draw = _by_map(log, scene, fit_on, map_path)
    if out is not None:
        images = "".join(f"![{path.stem}]({path.name})\n" for path in draw(out))
        write_text(out / "report.md", f"{text}\n## Pictures\n\n{images}")
        write_text(out / "report.json", json.dumps(numbers, indent=1) + "\n")
    click.echo(json.dumps(numbers, indent=1) if json_wanted else text)


Found = tuple[str, dict[str, Any], Callable[[Path], list[Path]]]
"""Text, numbers, and what draws the pictures into a folder."""


def _by_signals(log: Path, scene: str) -> Found:
    from laconic.recorded_runs import signals_report as report
    from laconic.recorded_runs.signals import read_signal_log, replay_signals
    from laconic.scene import read_scene

    found = replay_signals(read_scene(scene), read_signal_log(log))
    return report.as_text(found), report.as_numbers(found), partial(report.draw, found)


def _by_map(log: Path, scene: str, fit_on: tuple[Path, ...], map_path: Path | None) -> Found:
    from laconic.analysis.from_core import subject_of
    from laconic.progress import progress_bar
    from laconic.recorded_runs import report
    from laconic.recorded_runs.log import DEFAULT_MAP, read_map
    from laconic.recorded_runs.runs import compare_all, gather
    from laconic.scene import read_scene

    subject = subject_of(read_scene(scene))
    try:
        runs, names, skipped = gather(log, fit_on, read_map(map_path or DEFAULT_MAP))
    except BadInput as error:
        if map_path is not None or not log.is_file():
            raise
        raise BadInput(f"{error}; or, for a file without a map, call its first column time_s, the others as signals, "
                       "with commas between them") from None
    with progress_bar("replaying", len(runs) + 1) as advance:
        found = compare_all(subject, runs, names, skipped, advance)
    return report.as_text(found), report.as_numbers(found), partial(report.draw, found)
