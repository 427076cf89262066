"""Run one scene through the core."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import click
import numpy as np

from laconic.base.outputs import is_stdout, opened
from laconic.cli.options import (
    PICTURES,
    OutputFile,
    SceneName,
    all_methods,
    belongs_to,
    check_step,
    json_flag,
    one_of,
    recorded_options,
)
from laconic.cli.streams import warn
from laconic.core import REALS
from laconic.core.estimate import Errors, ErrorSizes
from laconic.core.grip import REMEDY_OF_SLIP, wheels_text
from laconic.errors import BadInput, Refused, ResultFails
from laconic.pictures.film.moving_picture import FILMED, write_film
from laconic.pictures.views.recorded import Recorded, signals_of, write_run
from laconic.scene import Scene, read_scene
from laconic.scene.axle_lines import nearly_one_line
from laconic.scene.standing import Standing, standing_of
from laconic.simulation import RunRefused, Trajectory, input_signals, simulate, usual_signals, wanted_signals
from laconic.simulation.articulated import HingeErrors, HingeErrorSizes
from laconic.simulation.csv_text import csv_text
from laconic.simulation.loads import Loads
from laconic.simulation.run import is_watched

NO_HEIGHT = "com_z_m is 0 or not given: accelerations shift no load"
FRICTION_STEP_S = 1e-3  # where the path matters: docs/scenes.md, "Ground with friction, drives with limits"
ROLLED = 1e-5                # J for 1 kg on wheels of 1 m: a millionth of the radius, slid with all of its weight


@click.command("simulate")
@click.argument("scene", type=SceneName(hinges=True))
@one_of("--method", all_methods(),
        "Method instead of the scene's; circle and moebius-4 are for vehicles with hinges")
@click.option("--step", "step_s", type=float, metavar="H", help="Step in seconds instead of the scene's.")
@click.option("--real", type=click.Choice(REALS), help="Scalar type instead of the scene's.")
@click.option("-o", "--out", type=OutputFile(".csv", stdout=True), metavar="F.csv",
              help="Write the outputs; - for stdout.")
@click.option("--plot", type=OutputFile(*PICTURES), metavar="F.png",
              help="Draw path, velocities, wheel speeds; .png, .svg or .pdf.")
@click.option("--film", type=OutputFile(".svg"), metavar="F.svg",
              help="Draw a moving picture: the robot on its path, which a browser plays.")
@recorded_options
@click.option("--inputs", "inputs_wanted", is_flag=True,
              help="Write the inputs as further columns of --out: what acts from each row on.")
@click.option("--errors", "errors_wanted", is_flag=True,
              help="Write the estimated error of each row as further columns of --out.")
@click.option("--enclose", "enclose_wanted", is_flag=True,
              help="Enclose the exact solution and prove how far the core is from it; --out gets columns of both.")
@json_flag("Machine-readable summary.")
def command(scene: str, method: str | None, step_s: float | None, real: str | None, out: Path | None,
            plot: Path | None, film: Path | None, inputs_wanted: bool, errors_wanted: bool,
            enclose_wanted: bool, json_wanted: bool, recorded: Recorded) -> None:
    """Runs SCENE, a TOML file or the name of a scene that comes with the project.

    Inputs of kind "steps" are held over each step; a step that one of them changes within is refused. With a friction
    coefficient or the height of the centre of mass in the scene, the ground is watched. The first wheel that would slip
    or lift is named on stderr. If a step is refused, everything before it is written, and the exit status is 1. The
    estimated error of the steps and of rounding is printed at the end; with hinges, --errors asks for it, at four times
    the cost. --enclose proves intervals that contain the
    exact motion of the file's numbers. See docs/accuracy.md.
    """
    check_step(step_s)
    belongs_to("--out", bool(out), "--inputs", "--errors")
    given = read_scene(scene).with_run(method=method, step_s=step_s, real=real)
    if given.has_hinges:
        not_with_hinges(given, enclose_wanted)
    if given.slips_on_hinges and errors_wanted:
        raise BadInput(f"{given.path}: --errors does not take hinges on ground with friction yet; leave it out")
    written = (*wanted_signals(given), *(input_signals(given) if inputs_wanted else ()))
    signals = dict.fromkeys((*written, *(usual_signals(given) if plot or film else ()), *(FILMED if film else ()),
                             *(drawn_with_hinges(given) if plot or film else ()),
                             *(signals_to_enclose(given) if enclose_wanted else ()),
                             *signals_of(recorded, given)))
    run = as_far_as_it_goes(given, tuple(signals), estimated=errors_wanted or not given.has_hinges)
    enclosure = enclosed(run) if enclose_wanted else None
    if out:
        further = run.error_columns if errors_wanted else {}
        write_csv(run, (*written, *(enclosure.columns if enclosure else ())), out, further)
    if plot:
        from laconic.pictures.plotting import simulation_picture
        simulation_picture(run, plot)
    if film:
        write_film(run, film)
    for line in write_run(run, recorded) if recorded else ():
        warn(line)
    files = (out, plot, film, *recorded.files)
    if json_wanted:
        click.echo(json.dumps(summary(run, *files) | (enclosure.json if enclosure else {}), indent=1))
    elif not (out and is_stdout(out)):
        print_summary(run, *files, lines=enclosure.lines if enclosure else ())
    for each in run.limited:
        warn(f"{given.path}: {each.in_words(given.run.step_s)}")
    for fold in run.folded:
        warn(f"{given.path}: {fold.in_words()}")
    if run.least_margin and run.least_margin[0] < 0.0:
        margin, time_s, wheel = run.least_margin
        several = f"{wheels_text(run.slipping_wheels)} would slip, " if run.slipping_wheels[1:] else ""
        warn(f"{given.path}: the ground cannot give what this run needs: {several}worst at {time_s:g} s, where wheel "
             f"{wheel} would slip, by {-margin:.3g} N; {REMEDY_OF_SLIP}")
    if run.lifted:
        wheel, time_s = run.lifted
        warn(f"{given.path}: at {time_s:g} s wheel {wheel} lifts from the ground; the run holds the vehicle level")
    for line in () if given.has_hinges else nearly_one_line(given):
        warn(f"{given.path}: {line}")
    if (standing := resting(run)) and standing.tips:
        warn(f"{given.path}: the robot: {standing.tips}")
    if run.grip and not run.grip.holds:
        warn(f"{given.path}: the ground cannot give what this run needs: {run.grip.warning()}; {run.grip.remedy()}")
    if run.refused:
        raise ResultFails(f"{run.refused}{kept_in(*files)}")


def not_with_hinges(scene: Scene, enclose_wanted: bool) -> None:
    """BadInput for what a run of a vehicle with hinges does not have yet."""
    if enclose_wanted:
        raise BadInput(f"{scene.path}: --enclose does not take vehicles with hinges yet; use --errors for an estimate")


def drawn_with_hinges(scene: Scene) -> tuple[str, ...]:
    """What a picture of bodies on hinges needs besides the usual signals."""
    if not scene.has_hinges:
        return ()
    from laconic.pictures.outlines import DRAWN
    from laconic.scene.hinge_signals import output_signals_of

    known = output_signals_of(scene.vehicle, scene.hinges)
    return tuple(signal for name in DRAWN for signal in known[name])


def as_far_as_it_goes(scene: Scene, signals: tuple[str, ...], estimated: bool) -> Trajectory:
    """The run, to its end or to the step that is refused."""
    try:
        return simulate(scene, signals, progress=True, estimated=estimated)
    except RunRefused as cut_short:
        return cut_short.run


@dataclass(frozen=True)
class Enclosure:
    """What an enclosure adds to the outputs of its run."""

    columns: tuple[str, ...]
    lines: list[str]
    json: dict[str, Any]


def signals_to_enclose(scene: Scene) -> tuple[str, ...]:
    """The states of a scene that can be enclosed."""
    from laconic.tools.enclosure.readings import check_enclosable
    from laconic.tools.enclosure.study import state_signals

    check_enclosable(scene)
    return state_signals(scene.wheel_count)


def enclosed(run: Trajectory) -> Enclosure:
    """Encloses the motion of a run, and gives the run its columns."""
    from laconic.tools.enclosure.study import as_json, columns_of, lines_of, study_of

    study = study_of(run)
    columns = columns_of(study)
    run.columns.update(columns)
    return Enclosure(tuple(columns), lines_of(study), {"enclosure": as_json(study)})


def resting(run: Trajectory) -> Standing | None:
    """How the robot stands where the scene has data of the ground."""
    scene = run.scene
    if scene.has_hinges:
        vehicle = scene.vehicle
        has_ground = vehicle["friction_coefficient"] or vehicle["com_z_m"] or scene.slips_on_hinges
        return Loads(scene).standing([hinge.start_angle_rad for hinge in scene.hinges]) if has_ground else None
    return standing_of(scene) if is_watched(scene) else None


def words_of_standing(run: Trajectory) -> list[str]:
    """The loads, and whether they hold the robot."""
    standing = resting(run)
    if standing is None:
        return []
    return [standing.in_words(), *assumed_height(run.scene),
            *([f"the robot: {standing.tips}"] if standing.tips else [])]


def assumed_height(scene: Scene) -> list[str]:
    """What is assumed where loads are judged and the scene does not state the height of the centre of mass."""
    return [] if scene.vehicle["com_z_m"] else [NO_HEIGHT]


def kept_in(*paths: Path | None) -> str:
    """Where the motion up to a refused step is."""
    files = [str(path) for path in paths if path and not is_stdout(path)]
    return f" (the run up to there is in {' and '.join(files)})" if files else ""


def write_csv(run: Trajectory, signals: tuple[str, ...], path: Path, further: Mapping[str, np.ndarray]) -> None:
    """A header line; then time_s, the signals and further columns, with all digits."""
    columns = [run.time_s, *(run.columns[name] for name in signals), *further.values()]
    whole = [number for number, column in enumerate(columns) if column.dtype.kind == "i"]
    with opened(path) as file:
        file.write(",".join(("time_s", *signals, *further)) + "\n")
        for lines in csv_text(np.column_stack(columns), whole):
            file.write(lines)


def summary(run: Trajectory, *files: Path | None) -> dict[str, Any]:
    """What was run and where it ended."""
    standing = resting(run)
    return {
        "scene": str(run.scene.path), "name": run.scene.name, "method": run.scene.run.method, "chosen": run.method,
        "step_s": run.scene.run.step_s, "tolerance": run.scene.run.tolerance, "real": run.scene.run.real,
        "steps": run.steps, "seconds": run.seconds,
        "final": {"time_s": run.time_s[-1], **{name: values[-1].item() for name, values in run.columns.items()}},
        "estimated_error": asdict(run.errors) if run.errors else None,
        "no_slip": run.grip.as_json() if run.grip else margin_json(run),
        "limited": [asdict(each) for each in run.limited], "folded": [asdict(each) for each in run.folded],
        "lifted": {"wheel": run.lifted[0], "time_s": run.lifted[1]} if run.lifted else None,
        "standing": standing.as_json() | {"assumed": assumed_height(run.scene)} if standing else None,
        "refused": in_words(run.refused, run) if run.refused else None,
        "files": [str(path) for path in files if path]}


def margin_json(run: Trajectory) -> dict[str, Any] | None:
    """The least distance from slip of a run with hinges, judged by loads at rest; None where no friction is known."""
    if run.least_margin is None:
        return None
    margin, time_s, wheel = run.least_margin
    return {"holds": margin >= 0.0, "least_margin_N": margin, "time_s": time_s, "wheel": wheel,
            "slipping_wheels": list(run.slipping_wheels)}


def in_words(refused: Refused, run: Trajectory) -> dict[str, Any]:
    """Why a run ended before its time, and where."""
    return {"time_s": run.steps * run.scene.run.step_s, "step": run.steps, "status": refused.status,
            "message": str(refused)}


def words_of_slip(run: Trajectory) -> list[str]:
    """What slip took on ground with friction, and whether the step is longer than its first order deserves."""
    slip_loss_J = run.grip.slip_loss_J if run.grip else run.slip_loss_J
    if slip_loss_J is None:
        return []
    loss_J, step_s, vehicle = slip_loss_J, run.scene.run.step_s, run.scene.vehicle
    rounding_J = ROLLED * vehicle["mass_kg"] * vehicle["wheel_radius_m"]
    what = "slip and scrub" if run.scene.has_hinges else "slip and dragging rollers"
    named = f", {wheels_text(run.slipping_wheels)} slipped" if run.slipping_wheels else ""
    told = [f"energy lost by {what}: {loss_J:.3g} J{named} ({'when' if named else 'which wheels'}: contact_state, "
            "slip_along_m_per_s in [outputs])" if loss_J > rounding_J else "no wheel slipped"]
    if step_s > FRICTION_STEP_S:
        told.append("ground with friction is stepped to first order, and losses are the first to be off: compare "
                    f"path and losses with --step {FRICTION_STEP_S:g}")
    return told


def words_of_errors(errors: Errors | HingeErrors | None, wheel_count: int) -> list[str]:
    """How far the end is off, and the worst on the way."""
    if errors is None:
        return []
    if isinstance(errors, HingeErrors):
        lines = [f"estimated error: {hinge_sizes_text(errors.now)}",
                 f"  largest of the rows: {hinge_sizes_text(errors.largest)}"]
        return lines + ([f"  steps that no finer run could take: {errors.unknown}"] if errors.unknown else [])
    lines = [f"estimated error: {sizes_text(errors.now, wheel_count)}",
             f"  largest of the run: {sizes_text(errors.largest, wheel_count)}"]
    if errors.unknown:
        lines.append(f"  steps of which no half is taken: {errors.unknown}; all that they change counts as error")
    return lines


def sizes_text(sizes: ErrorSizes, wheel_count: int) -> str:
    """The sizes with their units; that of wheel angles where there are wheels."""
    angles = f", wheel angles {sizes.wheel_angle_rad:.1e} rad" if wheel_count else ""
    return (f"nu {sizes.nu_rad_per_s:.1e} rad/s, place {sizes.place_m:.1e} m, heading {sizes.heading_rad:.1e} rad"
            f"{angles}")


def hinge_sizes_text(sizes: HingeErrorSizes) -> str:
    """The sizes with their units, as in the names of the columns."""
    return (f"velocity {sizes.velocity_m_per_s:.1e} m/s, yaw rate {sizes.yaw_rate_rad_per_s:.1e} rad/s, hinge rates "
            f"{sizes.hinge_rate_rad_per_s:.1e} rad/s, place {sizes.place_m:.1e} m, heading {sizes.heading_rad:.1e} "
            f"rad, hinge angles {sizes.hinge_angle_rad:.1e} rad, wheel angles {sizes.wheel_angle_rad:.1e} rad")


def print_summary(run: Trajectory, *files: Path | None, lines: Sequence[str] = ()) -> None:
    """The same for people, with further lines."""
    given, picked = run.scene.run.method, run.method
    method = given if given == picked else f"{given} (picked {picked})"
    taken = f"{run.steps} of {run.scene.steps()}" if run.refused else f"{run.steps}"
    tolerance = run.scene.run.tolerance
    found = "" if tolerance is None else f" (found for the tolerance {tolerance:g})"
    click.echo(f"{run.scene.name}: {taken} steps of {run.scene.run.step_s:g} s{found} by {method}, "
               f"{run.scene.run.real}, in {run.seconds:.2f} s")
    click.echo(f"at {run.time_s[-1]:g} s:")
    for name, values in run.columns.items():
        click.echo(f"  {name:28} {values[-1]: .12g}")
    for line in (*words_of_errors(run.errors, run.scene.wheel_count), *words_of_slip(run),
                 *words_of_standing(run), *lines):
        click.echo(line)
    for path in files:
        if path:
            click.echo(f"wrote {path}")
