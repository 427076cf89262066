"""Make a scene of a robot's URDF, xacro, MJCF or SDF file."""

from __future__ import annotations

import json
from pathlib import Path

import click

from laconic.base.outputs import is_stdout, write_text
from laconic.cli.options import InputPath, OutputFile, json_flag
from laconic.errors import BadInput


@click.command("import")
@click.argument("robot", type=InputPath(), metavar="ROBOT")
@click.option("-o", "--out", type=OutputFile(".toml", stdout=True), required=True, metavar="ROBOT.toml",
              help="The scene; - for stdout.")
@click.option("--wheel", "wheels", multiple=True, metavar="JOINT",
              help="These joints are the wheels, instead of those that are found; once for each.")
@click.option("--rollers", multiple=True, metavar="[JOINT=]KIND",
              help="none (plain wheel), omni, mecanum (four at the corners), or the angle in degrees from the axle to "
                   "the "
              "roller that touches the ground; of all wheels or of one.")
@click.option("--radius", multiple=True, metavar="[JOINT=]METRES", help="Radius of all wheels or of one.")
@click.option("--wheel-inertia", "inertias", multiple=True, metavar="[JOINT=]KGM2",
              help="Moment of inertia about the axle, of all wheels or of one.")
@click.option("--friction", type=float, metavar="MU", help="Ground with this friction coefficient: wheels may slip.")
@click.option("--hinges/--no-hinges", "hinges", default=None,
              help="Steered wheels, casters and trailers turn on hinges; or steered wheels and casters are supports. "
                   "The usual is --hinges, and --no-hinges with --wheel.")
@click.option("--model", metavar="NAME", help="Name of one of several models in the file (SDF, MJCF).")
@click.option("--set", "arguments", multiple=True, metavar="NAME:=VALUE", help="An argument of the xacro file.")
@click.option("--package", "packages", multiple=True, metavar="NAME=FOLDER",
              help="Folder of a ROS package or Gazebo model that is not next to or above the file.")
@json_flag("Parts, assumptions and omissions as JSON on stdout.")
def command(robot: Path, out: Path, wheels: tuple[str, ...], rollers: tuple[str, ...], radius: tuple[str, ...],
            inertias: tuple[str, ...], friction: float | None, hinges: bool | None, model: str | None,
            arguments: tuple[str, ...], packages: tuple[str, ...], json_wanted: bool) -> None:
    """Makes a scene of ROBOT: masses, inertias, centre of mass, and places, axles, radii and rollers of the wheels.

    Wheels are the joints that turn round on a level axle and whose shapes reach the ground, on any link. Steered
    wheels, casters and trailers turn on hinges. Other shapes on the ground become supports. Information that is not in
    the file (rollers that it does not draw, the radius of a wheel without shape, motors) is requested, or marked as an
    assumption in a comment of ROBOT.toml.
    """
    from laconic.robot.importer import Answers, import_robot
    from laconic.robot.importer.answers import by_joint, positive
    from laconic.robot.importer.answers import rollers as read_rollers

    if friction is not None:
        friction = positive(f"--friction {friction:g}", str(friction))
    found = import_robot(robot, Answers(
        wheels, by_joint("--rollers", rollers, read_rollers), by_joint("--radius", radius, positive),
        by_joint("--wheel-inertia", inertias, positive), friction, model,
        pairs("--set", arguments, ":="),
        {name: Path(folder) for name, folder in pairs("--package", packages, "=").items()}, hinges))
    write_text(out, found.text)
    if json_wanted:
        click.echo(json.dumps({"name": found.name, "wheels": found.wheels, "hinges": found.hinges,
                               "supports": found.supports,
                               "assumptions": found.assumptions, "remarks": found.remarks,
                               "standing": found.standing.as_json()}, indent=1, ensure_ascii=False))
        return
    for line in (*found.wheels, *found.hinges, *found.supports, found.standing.in_words(), *found.assumptions,
                 *found.remarks):
        click.echo(line, err=is_stdout(out))


def pairs(option: str, texts: tuple[str, ...], between: str) -> dict[str, str]:
    """NAME and VALUE of each."""
    found: dict[str, str] = {}
    for text in texts:
        name, found_it, value = text.partition(between)
        if not found_it or not name:
            raise BadInput(f"{option} {text}: give NAME{between}VALUE")
        found[name] = value
    return found
