"""Drive a node over CAN and judge it."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any

import click

from laconic.base.outputs import write_text
from laconic.can.rig.choices import KINDS, LOGS
from laconic.cli.options import (
    InputPath,
    OutputFile,
    SceneName,
    belongs_to,
    goes_with,
    json_flag,
    one_of,
    only_one,
    recorded_options,
)
from laconic.core import REALS
from laconic.errors import BadInput
from laconic.scene import METHODS, Scene, read_scene

if TYPE_CHECKING:
    from laconic.can.rig.options import Options

CONNECTION = ("--interface", "--channel", "--bitrate", "--bus-option", "--id-base", "--key")


@click.command("rig")
@click.argument("scene_name", type=SceneName(hinges=True), metavar="[SCENE]", required=False)
@click.option("--interface", help="python-can's name of the interface: slcan, socketcan, pcan, kvaser, faulty …")
@click.option("--channel", help="Channel of the interface: socket://127.0.0.1:PORT, /dev/ttyACM0, can0 …")
@click.option("--bitrate", type=int, help="Bits per second, where the interface sets it.")
@click.option("--bus-option", "bus_options", multiple=True, metavar="NAME=VALUE",
              help="Further setting of the interface, such as under=slcan or loss=0.01 for faulty.")
@click.option("--id-base", help="The node's first CAN identifier, a multiple of 32.  [default: the scene's, or 0x680]")
@one_of("--board", KINDS, "Start a node for this run, here, as process, or emulated")
@click.option("--lockstep", is_flag=True, help="One step to one command (default).")
@click.option("--same-bits", is_flag=True, help="Lockstep with raw frames; every bit must agree.")
@click.option("--free-run", is_flag=True, help="The node steps by its own clock.")
@click.option("--steps", type=click.IntRange(1), help="How many steps; the scene's duration otherwise.")
@click.option("--every", type=click.IntRange(1), default=1, show_default=True, help="Steps to one SYNC (same-bits).")
@click.option("--fd", is_flag=True, help="Raw frames as CAN FD (same-bits).")
@click.option("--rate", type=click.IntRange(1, 1000),
              help="Periods a second in free run, of whole steps.  [default: one step each]")
@click.option("--watchdog", type=click.IntRange(0, 65535), default=100, show_default=True, metavar="MS",
              help="Longest time between commands in free run; 0: none.")
@one_of("--method", METHODS, "Method instead of the scene's")
@click.option("--real", type=click.Choice(REALS), help="Scalar type instead of the scene's; that of the node.")
@click.option("--tolerance", "tolerances", multiple=True, metavar="SIGNAL=VALUE",
              help="Allowed difference; half the resolution of the signal's frame where none is given.")
@click.option("--log", "logs", multiple=True, type=OutputFile(*LOGS), help="Log all frames: .blf, .asc, .mf4.")
@click.option("--replay", type=InputPath(), help="Judge a log of a scaled lockstep run, without a node.")
@click.option("--key", type=InputPath(), help="File with the key of a node that takes commands with codes alone.")
@recorded_options
@click.option("--live", is_flag=True, help="Show the signals while it runs.")
@click.option("--stop", is_flag=True, help="Stop the node, whatever it does, and nothing else; no SCENE needed.")
@click.option("--reset", is_flag=True, help="Stop the node and put its vehicle back to its start; no SCENE needed.")
@click.option("--a2l", type=OutputFile(".a2l"), metavar="FILE",
              help="Write the A2L file of the node's XCP for calibration tools, and drive nothing.")
@click.option("--junit", type=OutputFile(".xml"), help="Results for CI.")
@json_flag()
def command(scene_name: str | None, lockstep: bool, same_bits: bool, free_run: bool, stop: bool, reset: bool,
            a2l: Any, **given: Any) -> int:
    """Drives a node over CAN with the inputs of SCENE, runs the core as a reference, and judges every signal.

    Without --interface and --board a node in this process answers, in virtual time. The node is at rest when the
    command ends, also when it is interrupted. Exit status: 1 if a verdict fails or the bus or node dies in the run; 2
    if no node can be reached; 130 or 143 if SIGINT (Ctrl-C) or SIGTERM ended the run.
    """
    from laconic.can.rig.a2l import a2l_text
    from laconic.can.rig.options import Options, read_id_base

    mode = only_one({"--lockstep": lockstep, "--same-bits": same_bits, "--free-run": free_run}) or "--lockstep"
    only_one({"--same-bits": same_bits, "--tolerance": bool(given["tolerances"])})
    only_one({"--same-bits": same_bits, "--free-run": free_run, "--replay": given["replay"] is not None})
    belongs_to("--same-bits", same_bits, "--every", "--fd")
    belongs_to("--free-run", free_run, "--rate", "--watchdog")
    options = Options(mode=mode.removeprefix("--"), **given)
    if ending := only_one({"--stop": stop, "--reset": reset}):
        goes_with(ending, *CONNECTION, "--json")
        return rest(scene_name, options, reset)
    if scene_name is None:
        raise BadInput("SCENE: is missing; name the scene to drive, or give --stop or --reset")
    scene = read_scene(scene_name).with_run(method=options.method, real=options.real)
    if a2l:
        goes_with("--a2l", "--id-base")
        write_text(a2l, a2l_text(scene, read_id_base(options.id_base, scene)))
        click.echo(f"wrote {a2l}")
        return 0
    return drive(scene, options)


def drive(scene: Scene, options: Options) -> int:
    """A run or a replay, and its results in every form that the options choose."""
    from laconic.can.rig.bagged import check_rigid
    from laconic.can.rig.errors import Interrupted
    from laconic.can.rig.options import read_id_base
    from laconic.can.rig.replay import judge_log
    from laconic.can.rig.results import as_json, show, write_junit
    from laconic.can.rig.run import run
    from laconic.can.rig.scaled import read_tolerances

    check_rigid(scene, options.recorded)
    began = time.perf_counter()
    if options.replay is not None:
        goes_with("--replay", "--lockstep", "--channel", "--id-base", "--method", "--real", "--tolerance", "--junit",
                  "--json")
        judgement = judge_log(options.replay, scene, read_id_base(options.id_base, scene),
                              read_tolerances(options.tolerances, scene), options.channel)
    else:
        judgement = run(scene, options)
    unwritten = None
    try:
        if options.junit:
            write_junit(judgement, options.junit, time.perf_counter() - began)
    except BadInput as error:  # after the verdicts, which are there all the same
        unwritten = error
    if options.json_wanted:
        click.echo(as_json(judgement))
    else:
        show(judgement)
    if isinstance(judgement.ending, Interrupted):
        click.echo(f"laconic: {judgement.verdicts[0].detail}; {'; '.join(judgement.notes)}", err=True)
    if unwritten is not None:
        raise unwritten
    return judgement.exit_status


def rest(scene_name: str | None, options: Options, with_reset: bool) -> int:
    """--stop and --reset: no run, a node at rest."""
    from laconic.can.rig.client import stop_and_reset
    from laconic.can.rig.options import in_hex, node_for, read_id_base

    if options.interface is None:
        raise BadInput(f"{'--reset' if with_reset else '--stop'}: give the --interface and --channel of the node")
    scene = read_scene(scene_name) if scene_name is not None else None
    base = read_id_base(options.id_base, scene)
    with node_for(options, "double", base) as node:
        states = stop_and_reset(node, with_reset)
    if options.json_wanted:
        click.echo(json.dumps({"id_base": base, **states}))
    else:
        click.echo(f"node at ID base {in_hex(base)}: found in state {states['found']}, now {states['state']}")
    return 0
