"""An FRC robot behind WPILib's simulation, and its scene from what a team knows."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from laconic.base.outputs import is_stdout, write_text
from laconic.cli.options import OutputFile, SceneName, check_step, goes_with, json_flag
from laconic.errors import BadInput
from laconic.frc.new import KINDS, MODULES, MOTORS, Robot, box, length, mass, new_scene, quantity
from laconic.frc.websocket import MODES, URL, Bridge, figures_of

OF_NEW = ("--out", "--mass", "--bumpers", "--track", "--wheelbase", "--motor", "--motors", "--gearing",
          "--wheel-radius", "--module", "--steering-motor", "--steering-gearing", "--wheels", "--friction", "--ideal",
          "--current-limit", "--name")
OF_RUN = ("--url", "--enable", "--duration", "--step", "--log")


@click.command("frc")
@click.argument("scene_name", type=SceneName(hinges=True), metavar="[SCENE]", required=False)
@click.option("--url", default=URL, show_default=True, help="WebSocket server of the robot program.")
@click.option("--enable", "mode", type=click.Choice(MODES), help="Enable the robot in this mode, as a driver station "
                                                                 "does.  [default: leave that to others]")
@click.option("--duration", "duration_s", type=float, metavar="SECONDS", help="How long.  [default: until Ctrl-C]")
@click.option("--step", "step_s", type=float, metavar="H", help="Step in seconds instead of the scene's.")
@click.option("--log", "log", type=OutputFile(".csv"), metavar="F.csv", help="Write pose, battery and current of each "
                                                                            "cycle.")
@click.option("--new", "kind", type=click.Choice(KINDS), help="Make a scene instead.")
@click.option("-o", "--out", type=OutputFile(".toml", stdout=True), metavar="ROBOT.toml",
              help="With --new: the scene; - for stdout.")
@click.option("--mass", metavar="KG", help="Of the robot with bumpers and battery: 52, or 115lb.")
@click.option("--bumpers", metavar="LxW", help="Outer length and width: 0.85x0.8 in m, or 33inx32in.")
@click.option("--track", metavar="M", help="Between left and right wheels: 0.52, or 20.5in.")
@click.option("--wheelbase", metavar="M", help="Between front and rear wheels.  [default: the track]")
@click.option("--motor", default="krakenX60", show_default=True, help=f"One of {', '.join(MOTORS)}.")
@click.option("--motors", type=int, default=1, show_default=True, help="Number on a gearbox: of a module, of a "
              "mecanum wheel, of a side of a differential drive.")
@click.option("--gearing", type=float, help="Turns of the motor for one of the wheel.")
@click.option("--wheel-radius", metavar="M", help="0.0762, or 3in.")
@click.option("--module", metavar="NAME", help=f"Swerve, instead of these: one of {', '.join(MODULES)} with its "
              "variant, such as mk4i-l2.")
@click.option("--steering-motor", metavar="MOTOR", help="Swerve.  [default: as --motor]")
@click.option("--steering-gearing", type=float, help="Swerve: turns of the motor for one of the module.")
@click.option("--wheels", type=int, default=2, show_default=True, help="Differential: 2, 4 or 6.")
@click.option("--friction", type=float, metavar="MU", help="Wheels may slip on ground with this friction.  [default: "
                                                           "swerve 1.1, others none]")
@click.option("--ideal", "is_ideal", is_flag=True, help="Swerve on ideal ground, without slip.")
@click.option("--current-limit", metavar="CURRENT", help="Largest current of one driving motor, as 60 or 60A.")
@click.option("--name", help="Of the robot.")
@json_flag("Machine-readable summary.")
def command(scene_name: str | None, kind: str | None, out: Path | None, json_wanted: bool, **given: Any) -> None:
    """Plays the robot of SCENE for a robot program that runs with WPILib's WebSocket server, in Java, C++ or Python.

    [frc] of the scene names the program's devices. A program in Python takes laconic.frc.engine instead, in its
    physics.py, which is in lock-step (docs/frc.md).

    With --new it makes a scene from what a team knows. The yaw inertia is that of an even block as large as the
    bumpers.
    """
    if kind is not None:
        goes_with("--new", "--json", *OF_NEW)
        if scene_name is not None:
            raise BadInput(f"{scene_name}: has no meaning beside --new; give the new scene as -o robot.toml, and a "
                           "unit without a space, as 115lb")
        make(kind, out, json_wanted, given)
        return
    if scene_name is None:
        raise BadInput("SCENE: is missing; give a scene, or make one with --new")
    goes_with("a SCENE", "--json", *OF_RUN)
    play(scene_name, json_wanted, given)


def make(kind: str, out: Path | None, json_wanted: bool, given: dict[str, Any]) -> None:
    """Writes a scene."""
    for option, example in (("mass", "52 or 115lb"), ("bumpers", "0.85x0.8 or 33inx32in"), ("track", "0.52 or 20.5in")):
        if given[option] is None:
            raise BadInput(f"--{option}: is missing; give it as {example}")
    if out is None:
        raise BadInput("--out: is missing; give the name of the new scene, such as -o robot.toml")

    def optional(name: str) -> float | None:
        return None if given[name] is None else length(f"--{name.replace('_', '-')}", given[name])

    limit = given["current_limit"]
    current = None if limit is None else quantity("--current-limit", limit, {"": 1.0, "a": 1.0}, "60 or 60A")
    found = new_scene(Robot(
        kind, mass("--mass", given["mass"]), box("--bumpers", given["bumpers"]), length("--track", given["track"]),
        optional("wheelbase"), given["motor"], given["motors"], given["gearing"], optional("wheel_radius"),
        given["module"], given["steering_motor"], given["steering_gearing"], given["wheels"], given["friction"],
        given["is_ideal"], current, given["name"]))
    write_text(out, found.text)
    if json_wanted:
        click.echo(json.dumps({"assumptions": found.assumed}, indent=1, ensure_ascii=False))
        return
    for line in found.assumed:
        click.echo(f"assumed: {line}", err=is_stdout(out))


def play(scene_name: str, json_wanted: bool, given: dict[str, Any]) -> None:
    """Runs the bridge."""
    import asyncio

    from laconic.frc.drivetrain import Drivetrain
    from laconic.scene import read_scene

    check_step(given["step_s"])
    duration_s = given["duration_s"]
    if duration_s is not None and not 0.0 < duration_s < float("inf"):
        raise BadInput(f"--duration: {duration_s:g} s is not usable; give a number above 0")

    def say(text: str) -> None:
        click.echo(text, err=json_wanted)

    robot = Drivetrain(read_scene(scene_name).with_run(step_s=given["step_s"]))
    bridge = Bridge(robot, given["url"], given["mode"], say)
    rows = ["t_s,x_m,y_m,heading_rad,battery_V,current_A"]
    if given["log"]:
        bridge.watch = lambda time_s, motion: rows.append(
            f"{time_s:.2f},{motion.x_m!r},{motion.y_m!r},{motion.heading_rad!r},{robot.battery_V!r},"
            f"{robot.battery.current_A!r}")
    say(f"{robot.scene.name}: plays for the robot program at {bridge.url}; stop with Ctrl-C")
    try:
        asyncio.run(bridge.run(float("inf") if duration_s is None else duration_s))
    except KeyboardInterrupt:
        say("stopped by the user")
    if given["log"]:
        write_text(given["log"], "\n".join([*rows, ""]))
    figures = figures_of(bridge)
    if json_wanted:
        click.echo(json.dumps(figures, indent=1))
        return
    end = figures["final"]
    say(f"{figures['cycles']} cycles of 20 ms, {figures['late_cycles']} late, {figures['cycle_median_ms']:.2g} ms "
        f"each; {figures['heard']} messages heard, {figures['sent']} sent")
    say(f"at x = {end['x_m']:.4f} m, y = {end['y_m']:.4f} m, heading {end['heading_rad']:.4f} rad")
    for event, count in figures["events"].items():
        say(f"{'once' if count == 1 else f'{count} times'} {event}")
