"""Compare recorded runs with the model."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import click

from laconic.base.outputs import write_text
from laconic.cli.options import InputPath, OutputFolder, SceneName, json_flag
from laconic.cli.options_of_logs import map_option
from laconic.errors import BadInput

INPUTS = ("wheel-speeds", "currents", "voltages", "set-speeds")


@click.command("replay")
@click.argument("logs", type=InputPath(), nargs=-1, required=True, metavar="LOG...")
@click.argument("scene", type=SceneName(hinges=True))
@click.option("--inputs", type=click.Choice(INPUTS),
              help="The columns of the log that drive the model. Default: voltages if its columns are signals and the "
              "robot has no casters or trailers; currents if the log has them and the ground has no friction; "
              "otherwise the wheels' speeds.")
@click.option("--fit", "fit_on", type=InputPath(), multiple=True, metavar="RUN.csv",
              help="Fit friction on this run; may be given several times. Default: every other run of a folder.")
@map_option
@click.option("-o", "--out", type=OutputFolder(), metavar="DIR",
              help="Write report.md, report.json and pictures there.")
@json_flag("Machine-readable result on stdout.")
def command(logs: tuple[Path, ...], scene: str, inputs: str | None, fit_on: tuple[Path, ...], map_path: Path | None,
            out: Path | None, json_wanted: bool) -> None:
    """Compares LOG..., recorded runs or folders of them, with the model of SCENE, which comes last.

    \b
    wheel-speeds  the path that the recorded rotation of the wheels gives without slip
                  is compared with the recorded path; with friction in [ground] the
                  core computes the path, with its wheels held at these speeds
    currents      the core, driven by the measured currents as torques, predicts wheel
                  speeds and steady currents; without friction in [ground], friction is
                  fitted by least squares before
    set-speeds    the same; the scene's [speed_controller] computes the currents from
                  the set speeds
    voltages      the same with the motors' voltages. LOG may also be a file whose first
                  column is time_s and whose others have names of signals, as `simulate
                  --out F.csv --inputs` writes it: its inputs drive the core, and every
                  other signal in it is compared. With several such files, or a folder,
                  the voltages drive the core, and the paths are compared

    Maps that come with the project recognise their logs; --map names the map of others (docs/logs.md).
    """
    text, numbers, draw = _replayed(logs, scene, inputs, fit_on, map_path)
    if out is not None:
        images = "".join(f"![{path.stem}]({path.name})\n" for path in draw(out))
        write_text(out / "report.md", f"{text}\n## Pictures\n\n{images}")
        write_text(out / "report.json", json.dumps(numbers, indent=1) + "\n")
    click.echo(json.dumps(numbers, indent=1) if json_wanted else text)


Found = tuple[str, dict[str, Any], Callable[[Path], list[Path]]]
"""Text, numbers, and what draws the pictures into a folder."""


def _replayed(logs: tuple[Path, ...], scene: str, inputs: str | None, fit_on: tuple[Path, ...],
              map_path: Path | None) -> Found:
    from laconic.robot.logs.for_vehicle import is_free
    from laconic.robot.replay.signals import is_signal_log
    from laconic.scene import read_scene

    if (first := next((log for log in logs if log.suffix == ".toml"), None)) and not scene.endswith(".toml"):
        raise BadInput(f"{first}: is a scene, which comes last: laconic replay LOG... SCENE")
    if fit_on and inputs not in (None, "currents"):
        raise BadInput(f"--fit: needs measured currents; leave it out with --inputs {inputs}")
    is_of_signals = len(logs) == 1 and map_path is None and is_signal_log(logs[0])
    if is_of_signals and fit_on and inputs is None:
        raise BadInput("--fit: needs measured currents; leave it out for a file whose columns are signals, or give "
                       "its --map")
    given = read_scene(scene)
    if is_of_signals and inputs is None and is_free(given):
        inputs = "wheel-speeds"  # the recorded wheels alone give the path
    if is_of_signals and inputs in (None, "voltages"):
        return _by_signals(logs[0], given)
    return _by_map(logs, given, inputs, fit_on, map_path)


def _by_signals(log: Path, given: Any) -> Found:
    from laconic.robot.logs.for_vehicle import is_free
    from laconic.robot.replay import signals

    if given.has_hinges:
        remedy = "give --inputs wheel-speeds" if is_free(given) else \
            "give a --map with [steering_angle] and [wheel_angle]"
        raise BadInput(f"{given.path}: a file of signals does not drive vehicles with hinges yet; {remedy}")
    found = signals.replay_signals(given, signals.read_signal_log(log))
    return signals.as_text(found), signals.as_numbers(found), partial(signals.draw, found)


def _by_map(paths: tuple[Path, ...], given: Any, inputs: str | None, fit_on: tuple[Path, ...],
            map_path: Path | None) -> Found:
    from laconic.robot.replay.runs import gather
    from laconic.scene.ground import slips

    logs, names, skipped = gather(paths, fit_on, map_path)
    if inputs is None and not fit_on and _are_signals_with_voltages(logs):
        inputs = "voltages"
    _check_inputs(logs, inputs)
    if given.has_hinges and (fit_on or inputs not in (None, "wheel-speeds")):
        raise BadInput(f"{given.path}: a vehicle with hinges is rolled by its steering angles; leave "
                       f"{'--fit' if fit_on else f'--inputs {inputs}'} out")
    has_currents = logs[0].current_A is not None
    if fit_on and slips(given.vehicle):
        raise BadInput(f"--fit: {given.path} has a [ground] with friction already; leave --fit out, or let "
                       "`laconic identify` find its numbers")
    is_rolled = slips(given.vehicle) or given.has_hinges
    if not is_rolled and (inputs == "currents" or fit_on or (inputs is None and has_currents)):
        return _by_currents(given, logs, names, skipped)
    from laconic.robot.replay import rolled_paths

    found = rolled_paths.roll(given, logs, [Path(name) for name in skipped], inputs or "wheel-speeds")
    return rolled_paths.as_text(found), rolled_paths.as_numbers(found), partial(rolled_paths.draw, found)


def _are_signals_with_voltages(logs: list[Any]) -> bool:
    """Whether the inputs stand in the logs, so that a folder is driven by them as each of its files alone is."""
    from laconic.robot.logs.recognise import OF_SIGNALS

    return all(log.map_name == OF_SIGNALS and log.voltage_V is not None for log in logs)


def _check_inputs(logs: list[Any], inputs: str | None) -> None:
    """BadInput where the first log has not what drives the model."""
    member = {"currents": "current_A", "voltages": "voltage_V", "set-speeds": "set_speed_rad_per_s"}.get(inputs or "")
    if member and getattr(logs[0], member) is None:
        raise BadInput(f"--inputs {inputs}: {logs[0].path} has none; name their columns in the map, or take "
                       "--inputs wheel-speeds")


def _by_currents(scene: Any, logs: list[Any], names: list[str], skipped: list[str]) -> Found:
    from laconic.base.progress import progress_bar
    from laconic.robot.replay import report
    from laconic.robot.replay.runs import compare_all
    from laconic.tools.analyse.from_core import subject_of

    subject = subject_of(scene)
    with progress_bar("replaying", len(logs) + 1) as advance:
        found = compare_all(subject, logs, names, skipped, advance)
    return report.as_text(found), report.as_numbers(found), partial(report.draw, found)
