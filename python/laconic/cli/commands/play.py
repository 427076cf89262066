"""Play the vehicle on a CAN bus for a controller that someone else wrote."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import click

from laconic.base.outputs import write_text
from laconic.can.play.protocols import KINDS as FAULTS
from laconic.can.rig.choices import KINDS, LOGS, ON_BUS
from laconic.cli.options import (
    InputPath,
    OutputFile,
    SceneName,
    check_step,
    goes_with,
    json_flag,
    one_of,
    recorded_options,
)
from laconic.core import REALS
from laconic.errors import BadInput
from laconic.scene import METHODS, read_scene
from laconic.scene.drives import DRIVE_PROTOCOLS

if TYPE_CHECKING:
    from laconic.can.rig.verdict import Judgement
    from laconic.scene import Scene


@click.command("play")
@click.argument("scene_name", type=SceneName(hinges=True), metavar="SCENE")
@click.option("--interface", help="python-can's name of the controller's bus: socketcan, slcan, pcan, faulty …")
@click.option("--channel", help="Channel of the interface: can0, /dev/ttyACM0, socket://127.0.0.1:PORT …")
@click.option("--bitrate", type=int, help="Bits per second, where the interface sets it.")
@click.option("--bus-option", "bus_options", multiple=True, metavar="NAME=VALUE",
              help="Further setting of the interface, such as under=slcan or loss=0.01 for faulty.")
@click.option("--can-fd", is_flag=True, help="The interface opens its channel for CAN FD, as moteus needs it.")
@click.option("--listen", type=int, metavar="PORT",
              help="Instead of an interface: SLCAN on a TCP port of this machine; 0: any free one, printed.")
@click.option("--drives", type=click.Choice(DRIVE_PROTOCOLS), help="Protocol instead of the scene's [rig.drives].")
@one_of("--board", (*KINDS, ON_BUS), "Where the vehicle runs, here (virtual, without this option), as process, "
        "emulated, or as a node that is on the bus")
@click.option("--id-base", help="The node's first CAN identifier, a multiple of 32.  [default: the scene's, or 0x680]")
@click.option("--dbc", type=InputPath(), help="The messages of the controller; with --map.")
@click.option("--map", "map_path", type=InputPath(), metavar="MAP.toml",
              help="Which signal of the DBC is which input or output of the model.")
@click.option("--duration", "duration_s", type=float, metavar="SECONDS", help="How long.  [default: until Ctrl-C]")
@click.option("--fault", "faults", multiple=True, metavar="KIND:WHEEL@SECONDS[+SECONDS]",
              help=f"A drive that fails: {', '.join(FAULTS)}; or random, by --seed.")
@click.option("--bus-fault", "bus_faults", multiple=True, metavar="NAME=VALUE",
              help="A fault of the controller's bus, such as loss=0.01: those of the interface faulty.")
@click.option("--seed", type=int, help="Seed of random faults.  [default: 1]")
@click.option("--stop-within", "stop_within_s", type=float, metavar="SECONDS",
              help="The vehicle must stand so soon after the first fault, or else the controller's last frame.")
@click.option("--stop-distance", "stop_distance_m", type=float, metavar="METRES", help="... and so near.")
@one_of("--method", METHODS, "Method instead of the scene's")
@click.option("--real", type=click.Choice(REALS), help="Scalar type instead of the scene's.")
@click.option("--step", "step_s", type=float, metavar="SECONDS", help="Step and period instead of the scene's.")
@click.option("--log", "logs", multiple=True, type=OutputFile(*LOGS), help="Log all frames: .blf, .asc, .mf4.")
@recorded_options
@click.option("--live", is_flag=True, help="Show the frames while it plays.")
@click.option("--ardupilot", "is_ardupilot", is_flag=True,
              help="Instead of a bus: ArduPilot's JSON interface, UDP port 9002 or that of --listen, in lockstep. "
              "Protocol tested, autopilot not.")
@click.option("--eds", type=OutputFile(".eds"), metavar="FILE",
              help="Write the EDS file of the CANopen drives, for the controller's configuration, and play nothing.")
@click.option("--junit", type=OutputFile(".xml"), help="Results for CI.")
@json_flag()
def command(scene_name: str, method: str | None, real: str | None, step_s: float | None, junit: Any,
            eds: Any, is_ardupilot: bool, json_wanted: bool, **given: Any) -> int:
    """Plays the vehicle of SCENE on a CAN bus in real time, for a controller that someone else wrote.

    --drives speaks the protocol of its motor drives, or --dbc and --map say what its frames mean. Without an interface
    of your own, --listen 0 prints a port at which python-can's slcan connects. Lateness is printed at the end. Exit
    status: 0 if the user or --duration ended it; 1 if the bus died, a step was refused or a watchdog fired; 2 for bad
    input. --ardupilot plays it for an autopilot instead.
    """
    from laconic.can.play.canopen_eds import eds_of_scene
    from laconic.can.play.options import PlayOptions
    from laconic.can.play.session import play

    check_step(step_s)
    scene = read_scene(scene_name).with_run(method=method, step_s=step_s, real=real)
    if eds:
        goes_with("--eds", "--drives", "--real", "--step")
        write_text(eds, eds_of_scene(scene, given["drives"]))
        click.echo(f"wrote {eds}")
        return 0
    began = time.perf_counter()
    if is_ardupilot:
        goes_with("--ardupilot", "--listen", "--duration", "--method", "--real", "--step", "--junit", "--json")
        judgement = for_autopilot(scene, given["listen"], given["duration_s"], json_wanted)
        present(judgement, junit, time.perf_counter() - began, json_wanted=json_wanted)
        return judgement.exit_status
    judgement = play(scene, PlayOptions(**given), say=lambda text: click.echo(text, err=json_wanted))
    present(judgement, junit, time.perf_counter() - began, json_wanted=json_wanted)
    return judgement.exit_status


def for_autopilot(scene: Scene, port: int | None, duration_s: float | None, json_wanted: bool) -> Judgement:
    """Plays the vehicle behind ArduPilot's JSON interface."""
    from laconic.robot.ardupilot.server import USUAL_PORT, play_ardupilot

    return play_ardupilot(scene, port=USUAL_PORT if port is None else port, duration_s=duration_s,
                          say=lambda text: click.echo(text, err=json_wanted))


def present(judgement: Judgement, junit: Any, seconds: float, *, json_wanted: bool) -> None:
    """The results in all forms; then BadInput for files that could not be written: the run does not come again."""
    from laconic.can.rig.results import as_json, show, write_junit

    if junit:
        try:
            write_junit(judgement, junit, seconds, "play")
        except BadInput as error:
            judgement.unwritten.append(error)
    if json_wanted:
        click.echo(as_json(judgement))
    else:
        show(judgement)
    if judgement.unwritten:
        raise BadInput("; ".join(map(str, judgement.unwritten)))
