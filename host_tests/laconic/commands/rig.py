"""laconic rig: drive a node over CAN and judge it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from laconic.core import REALS
from laconic.errors import BadInput
from laconic.options import InputPath, OutputFile, SceneName, belongs_to, json_flag, only_one
from laconic.progress import progress_bar
from laconic.rig.boards import KINDS, own_node
from laconic.rig.buses import connected
from laconic.rig.client import NodeClient
from laconic.rig.errors import BusDied, NodeRefused, NodeSilent
from laconic.rig.free_run import judge_free_run
from laconic.rig.judge import judge_same_bits, judge_scaled
from laconic.rig.live import live_view
from laconic.rig.logs import LOGS, logged
from laconic.rig.replay import judge_log
from laconic.rig.results import as_json, show, write_junit
from laconic.rig.scaled import read_tolerances
from laconic.rig.verdict import Judgement, Verdict
from laconic.scene import METHODS, Scene, read_scene


@dataclass(frozen=True)
class Options:
    """What the command line says."""

    interface: str | None
    channel: str | None
    bitrate: int | None
    id_base: str | None
    board: str | None
    mode: str
    steps: int | None
    every: int
    fd: bool
    rate: int | None
    watchdog: int
    method: str | None
    real: str | None
    tolerances: tuple[str, ...]
    bus_options: tuple[str, ...]
    logs: tuple[Path, ...]
    replay: Path | None
    live: bool
    junit: Path | None
    json_wanted: bool


@click.command(name="rig", short_help="Drive a node over CAN and judge it.")
@click.argument("scene_name", type=SceneName(), metavar="SCENE")
@click.option("--interface", help="python-can's name of the interface: slcan, socketcan, pcan, kvaser, faulty …")
@click.option("--channel", help="Which one: socket://127.0.0.1:PORT, /dev/ttyACM0, can0 …")
@click.option("--bitrate", type=int, help="Bits per second, where the interface sets it.")
@click.option("--bus-option", "bus_options", multiple=True, metavar="NAME=VALUE",
              help="More for the interface, such as under=slcan or loss=0.01 for faulty.")
@click.option("--id-base", help="The node's first CAN identifier, a multiple of 32.  [default: the scene's, or 0x200]")
@click.option("--board", type=click.Choice(KINDS), help="Start a node for this run: here, as process, or emulated.")
@click.option("--lockstep", is_flag=True, help="One step to one command (default).")
@click.option("--same-bits", is_flag=True, help="Lockstep with raw frames; every bit must agree.")
@click.option("--free-run", is_flag=True, help="The node steps by its own clock.")
@click.option("--steps", type=click.IntRange(1), help="How many steps; the scene's duration otherwise.")
@click.option("--every", type=click.IntRange(1), default=1, show_default=True, help="Steps to one SYNC (same-bits).")
@click.option("--fd", is_flag=True, help="Raw frames as CAN FD (same-bits).")
@click.option("--rate", type=click.IntRange(1, 1000), help="Steps a second in free run.  [default: the scene's]")
@click.option("--watchdog", type=click.IntRange(0, 65535), default=100, show_default=True, metavar="MS",
              help="Longest time between commands in free run; 0: none.")
@click.option("--method", type=click.Choice(METHODS), help="Instead of the scene's.")
@click.option("--real", type=click.Choice(REALS), help="Instead of the scene's: what the node computes in.")
@click.option("--tolerance", "tolerances", multiple=True, metavar="SIGNAL=VALUE",
              help="Allowed difference; half a last place otherwise.")
@click.option("--log", "logs", multiple=True, type=OutputFile(*LOGS), help="Log all frames: .blf, .asc.")
@click.option("--replay", type=InputPath(), help="Judge a log of a scaled lockstep run, without a node.")
@click.option("--live", is_flag=True, help="Show the signals while it runs.")
@click.option("--junit", type=OutputFile(".xml"), help="Results for CI.")
@json_flag()
def command(scene_name: str, lockstep: bool, same_bits: bool, free_run: bool, **given: Any) -> int:
    """Drives a node over CAN with the inputs of SCENE, runs the core beside it as twin, and judges every signal.

    Without --interface and --board a node in this process answers on python-can's virtual bus, in virtual time. Exit
    status 1 when a verdict fails or the bus or node dies in the run, 2 when no node can be reached.
    """
    mode = only_one({"--lockstep": lockstep, "--same-bits": same_bits, "--free-run": free_run}) or "--lockstep"
    only_one({"--same-bits": same_bits, "--tolerance": bool(given["tolerances"])})
    only_one({"--same-bits": same_bits, "--free-run": free_run, "--replay": given["replay"] is not None})
    belongs_to("--same-bits", same_bits, "--every", "--fd")
    belongs_to("--free-run", free_run, "--rate", "--watchdog")
    options = Options(mode=mode.removeprefix("--"), **given)
    scene = read_scene(scene_name).with_run(method=options.method, real=options.real)
    began = time.perf_counter()
    judgement = judge_log(options.replay, scene, read_id_base(options.id_base, scene),
                          read_tolerances(options.tolerances, scene)) if options.replay else run(scene, options)
    if options.junit:
        write_junit(judgement, options.junit, time.perf_counter() - began)
    if options.json_wanted:
        click.echo(as_json(judgement))
    else:
        show(judgement)
    return 0 if judgement.passed else 1


def run(scene: Scene, options: Options) -> Judgement:
    """One run against a node; a node or bus that dies in it is a verdict too, with the log complete."""
    limits, base = read_tolerances(options.tolerances, scene), read_id_base(options.id_base, scene)
    with (node_for(scene, options, base) as node, logged(node.link, options.logs),
          live_view(node.link) if options.live else nullcontext(),
          progress_bar(scene.name, 0 if options.live else options.steps or scene.steps()) as moved):
        try:
            return judge(node, scene, options, limits, moved)
        except (BusDied, NodeSilent, NodeRefused) as died:
            verdict = Verdict("run", False, str(died))
            faults = dict(node.link.faults) or "none"
            return Judgement(scene.name, options.mode, [verdict], notes=[f"faulty frames: {faults}"])


def judge(node: NodeClient, scene: Scene, options: Options, limits: dict[str, float],
          moved: Callable[[float], None]) -> Judgement:
    """One run in the chosen mode."""
    if options.mode == "free-run":
        duration_s = options.steps * scene.run.step_s if options.steps else scene.run.duration_s
        return judge_free_run(node, scene, duration_s, options.rate or 0, options.watchdog, limits,
                              moved=lambda seconds: moved(seconds / scene.run.step_s))
    if options.mode == "same-bits":
        return judge_same_bits(node, scene, options.steps, every=options.every, fd=options.fd, moved=moved)
    return judge_scaled(node, scene, options.steps, limits, moved)


def read_id_base(given: str | None, scene: Scene) -> int:
    """--id-base, the scene's, or the contract's own."""
    try:
        base = int(given, 0) if given is not None else scene.rig.id_base if scene.rig.id_base is not None else 512
    except ValueError:
        raise BadInput(f"--id-base {given}: no number; give one such as 0x220") from None
    if base % 32 or not 0 <= base <= 0x7E0:
        place = "--id-base" if given is not None else f"{scene.path}: rig.id_base:"
        raise BadInput(f"{place} {base}: a node uses 32 identifiers; give a multiple of 32 from 0 to 0x7E0")
    return base


def read_bus_options(given: tuple[str, ...]) -> dict[str, str]:
    """{"loss": "0.1"} from ["loss=0.1"]."""
    pairs = [text.partition("=") for text in given]
    for name, equals, _ in pairs:
        if not name or not equals:
            raise BadInput(f"--bus-option {name}: give NAME=VALUE, such as under=slcan")
    return {name: value for name, _, value in pairs}


@contextmanager
def node_for(scene: Scene, options: Options, id_base: int) -> Iterator[NodeClient]:
    """A client on the chosen bus, or a node of our own."""
    if options.interface is None:
        if options.channel is not None:
            raise BadInput(f"--channel {options.channel}: say which --interface it belongs to, such as slcan")
        if options.bus_options:
            raise BadInput(f"--bus-option {options.bus_options[0]}: say which --interface it is for, such as faulty "
                           "(NAME=VALUE)")
        with own_node(options.board or "virtual", scene.run.real, id_base) as node:
            yield node
        return
    if options.board is not None:
        raise BadInput(f"--board {options.board}: starts a node of its own; leave --interface out")
    more = read_bus_options(options.bus_options)
    with connected(options.interface, options.channel, id_base, bitrate=options.bitrate, **more) as node:
        yield node
