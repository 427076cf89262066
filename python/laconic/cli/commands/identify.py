"""Find parameters of a robot from recorded runs."""

from __future__ import annotations

import json
from pathlib import Path

import click

from laconic.base.outputs import is_stdout, write_text
from laconic.cli.options import PICTURES, InputPath, OutputFile, SceneName, json_flag
from laconic.cli.options_of_logs import SeveralAfter, map_option
from laconic.errors import BadInput, ResultFails, shown

LEFT_OUT = ("session", "run")


@click.command("identify", cls=SeveralAfter)
@click.argument("logs", type=InputPath(), nargs=-1, required=True, metavar="LOG...")
@click.option("--scene", type=SceneName(hinges=True), required=True, help="The robot with its nominal values.")
@click.option("-o", "--out", type=OutputFile(".toml", stdout=True), metavar="FITTED.toml",
              help="Write the scene with the identified values; - for stdout.")
@click.option("--map-out", type=OutputFile(".toml", stdout=False), metavar="FITTED_MAP.toml",
              help="Write the map with its identified values: steering, lags, place of the tracker. Needs --map.")
@click.option("--free", metavar="NAMES",
              help="Parameters that may change [default: radius,distance, also with casters or trailers; with "
              "steered wheels radius,wheelbase,steering-gain,steering-offset, and distance for wheelbase where "
              "all steer]. Geometry: radius (of each wheel), distance (of all wheels, one factor), "
              "centre-of-mass, place and heading (of the robot against the recorded pose), clock-lag (of the pose), "
              "axle, roller (angles of each wheel), common-radius (one of all wheels). Steered: wheelbase, track, "
              "trail, steering-gain, steering-offset, steering-curve, steering-lag, steering-rate, speed-gain, "
              "speed-offset, speed-lag; place and heading are the tracker's. On ground with friction: drag (of "
              "rollers), friction, creep, scrub, scrub-fade, axle-friction, wheel-friction (of each, as a share), "
              "viscous (of motors), controller (of the wheels' speeds). From voltages or currents: mass, yaw-inertia, "
              "wheel-inertia, motor-gain, motor-damping, resistance, torque-constant.")
@click.option("--prior", "prior_percent", type=float, default=10.0, show_default=True, metavar="PERCENT",
              help="Expected deviation of radii and distances from nominal (standard deviation).")
@map_option
@click.option("--judge", type=InputPath(), multiple=True, metavar="LOG...",
              help="Other runs, replayed with the identified values: all names up to the next option.")
@click.option("--leave-out", type=click.Choice(LEFT_OUT),
              help="Judge each session (folder) or run by a fit on the others.")
@click.option("--plot", type=OutputFile(*PICTURES), metavar="F.png",
              help="Draw recorded, nominal and identified paths of the first run of each session.")
@json_flag("Machine-readable result on stdout.")
def command(logs: tuple[Path, ...], scene: str, out: Path | None, map_out: Path | None, free: str | None,
            prior_percent: float,
            map_path: Path | None, judge: tuple[Path, ...], leave_out: str | None, plot: Path | None,
            json_wanted: bool) -> None:
    """Finds parameters of a scene from LOG..., recorded runs or folders of them.

    Robust nonlinear least squares minimizes the distance between computed and recorded path, or the error of the
    gyro's turn if no pose is recorded. On ground with friction the core computes the path, with its wheels held at the
    recorded speeds, and steady currents also count. Masses and motors are found from the wheel speeds that recorded
    voltages or currents give. Each value has a 95 % interval. Parameters that the runs do not determine stay nominal,
    and the report states which run
    would determine them. FITTED.toml is a complete scene, with sources and intervals in comments. The exit status is 1
    if the fitted values are worse than the nominal ones on runs to judge or left out. With -o - the report is on
    stderr.
    """
    from laconic.base.progress import progress_bar
    from laconic.robot.identify import geometry, report, steered
    from laconic.robot.identify.fitted_map import fitted_map_text
    from laconic.robot.identify.fitted_toml import fitted_text
    from laconic.robot.identify.geometry import geometry_of
    from laconic.robot.identify.picture import draw
    from laconic.robot.identify.study import identify, parts
    from laconic.robot.identify.words import failures
    from laconic.robot.logs import gather_logs
    from laconic.robot.logs.column_map import named_map
    from laconic.robot.replay.missed_wraps import rolled_alone
    from laconic.scene import read_scene

    if map_out is not None and map_path is None:
        raise BadInput("--map-out: needs --map, the map that it corrects")
    if not 0.0 < prior_percent <= 100.0:
        raise BadInput(f"--prior: {prior_percent:g} % is not usable; give a number above 0, at most 100")
    given = read_scene(scene)
    names = names_in(free) if free is not None else ()
    modelled = [name for name in names if name != "controller"]
    if modelled and not given.has_hinges:
        geometry_of(given, modelled)  # refuses a wrong name before logs are read
    runs, _ = gather_logs(logs, map_path)
    others = gather_logs(judge, map_path)[0] if judge else []
    if all(name in geometry.ROLLED for name in names):
        given, [runs, others] = rolled_alone(given, runs, others)
    names = names or geometry.usual(given)
    parameters = geometry_of(given, [name for name in names if name != "controller"], prior_percent / 100.0)
    left_out = len(parts(runs, leave_out)) if leave_out else 0
    both = given.has_hinges and any(name in steered.SLIPPING for name in names)  # without slip, too
    with progress_bar("identifying", 1 + left_out * (1 + both)) as advance:
        study = identify(given, runs, parameters, judge=others, leave_out=leave_out,
                         with_controller="controller" in names, advance=advance)
    if out is not None:
        write_text(out, fitted_text(study))
    if plot is not None:
        draw(study, plot)
    if json_wanted:
        click.echo(json.dumps(report.as_numbers(study), indent=1))
    else:
        click.echo(report.as_text(study), err=out is not None and is_stdout(out))
    if map_out is not None and map_path is not None:  # last, as it may refuse: the rest is written by then
        write_text(map_out, fitted_map_text(study, named_map(map_path)))
    if worse := failures(study):
        raise ResultFails(worse[0])


def names_in(free: str) -> tuple[str, ...]:
    """The names of --free; BadInput for none or one twice."""
    names = tuple(name.strip() for name in free.split(","))
    if not all(names) or len(set(names)) != len(names):
        raise BadInput(f"--free {shown(free)}: give names with commas between them, each once")
    return names
