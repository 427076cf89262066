"""laconic rig: drive a node over CAN and judge it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from laconic.core import REALS
from laconic.errors import BadInput
from laconic.progress import progress_bar
from laconic.rig.boards import KINDS, own_node
from laconic.rig.buses import connected
from laconic.rig.client import NodeClient
from laconic.rig.free_run import judge_free_run
from laconic.rig.judge import judge_same_bits, judge_scaled
from laconic.rig.logs import logged
from laconic.rig.results import as_json, show, write_junit
from laconic.rig.verdict import Judgement, read_tolerances
from laconic.scene import METHODS, Scene, read_scene


@click.command(name="rig")
@click.argument("scene_name", metavar="SCENE")
@click.option("--interface", help="python-can's name of the interface: slcan, socketcan, pcan, kvaser, faulty …")
@click.option("--channel", help="Which one: socket://127.0.0.1:PORT, /dev/ttyACM0, can0 …")
@click.option("--bitrate", type=int, help="Bits per second, where the interface sets it.")
@click.option("--id-base", type=str, help="First CAN identifier of the node, a multiple of 32.  [default: scene's or 0x200]")
@click.option("--lockstep", "mode", flag_value="lockstep", default=True, help="One step to one SYNC (default).")
@click.option("--same-bits", "mode", flag_value="same-bits", help="Lockstep with raw frames; every bit must agree.")
@click.option("--free-run", "mode", flag_value="free-run", help="The node steps by its own clock.")
@click.option("--rate", type=click.IntRange(1, 1000), default=None, help="Steps a second in free run.  [default: the scene's]")
@click.option("--watchdog", type=click.IntRange(0, 65535), default=100, show_default=True, metavar="MS",
              help="Longest time between commands in free run; 0: none.")
@click.option("--board", type=click.Choice(KINDS), help="Start a node for this run: here, as process, or emulated.")
@click.option("--steps", type=click.IntRange(1), help="How many steps; the scene's duration otherwise.")
@click.option("--every", type=click.IntRange(1), default=1, show_default=True, help="Steps to one SYNC (same-bits).")
@click.option("--fd", is_flag=True, help="Raw frames as CAN FD (same-bits).")
@click.option("--method", type=click.Choice(METHODS), help="Instead of the scene's.")
@click.option("--real", type=click.Choice(REALS), help="Instead of the scene's: what the node computes in.")
@click.option("--tolerance", "tolerances", multiple=True, metavar="SIGNAL=VALUE",
              help="Allowed difference; half a last place otherwise.")
@click.option("--log", "logs", multiple=True, type=click.Path(path_type=Path), help="Log all frames: .blf, .asc.")
@click.option("--junit", type=click.Path(path_type=Path), help="Results for CI.")
@click.option("--json", "json_wanted", is_flag=True, help="Machine-readable output.")
def command(scene_name: str, interface: str | None, channel: str | None, bitrate: int | None, id_base: str | None,
            mode: str, rate: int | None, watchdog: int, board: str | None, steps: int | None, every: int, fd: bool, method: str | None, real: str | None,
            tolerances: tuple[str, ...], logs: tuple[Path, ...], junit: Path | None, json_wanted: bool) -> int:
    """Drives a node over CAN with the inputs of SCENE, runs the core beside it as twin, and judges every signal.

    Without --interface and --board a node in this process answers on python-can's virtual bus, in virtual time. Exit status 1 when
    a verdict fails or the bus or node dies in the run, 2 when no node can be reached.
    """
    scene = read_scene(scene_name).with_run(method=method, real=real)
    limits, base, began = read_tolerances(tolerances), read_id_base(id_base, scene), time.perf_counter()
    with node_for(scene, board, interface, channel, base, bitrate) as node, logged(node.link, logs):
        with progress_bar(scene.name, steps or scene.steps()) as moved:
            judgement = judge(node, scene, mode, steps, every, fd, limits, rate or 0, watchdog, moved)
    if junit:
        write_junit(judgement, junit, time.perf_counter() - began)
    click.echo(as_json(judgement)) if json_wanted else show(judgement)
    return 0 if judgement.passed else 1


def judge(node: NodeClient, scene: Scene, mode: str, steps: int | None, every: int, fd: bool,
          limits: dict[str, float], rate: int, watchdog: int, moved: Callable[[float], None]) -> Judgement:
    """One run in the chosen mode."""
    if mode == "free-run":
        duration_s = steps * scene.run.step_s if steps else scene.run.duration_s
        return judge_free_run(node, scene, duration_s, rate, watchdog, limits,
                              moved=lambda seconds: moved(seconds / scene.run.step_s))
    if mode == "same-bits":
        return judge_same_bits(node, scene, steps, every=every, fd=fd, moved=moved)
    return judge_scaled(node, scene, steps, limits, moved)


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


@contextmanager
def node_for(scene: Scene, board: str | None, interface: str | None, channel: str | None, id_base: int,
             bitrate: int | None) -> Iterator[NodeClient]:
    """A client on the chosen bus, or a node of our own."""
    if interface is None:
        if channel is not None:
            raise BadInput(f"--channel {channel}: say which --interface it belongs to, such as slcan")
        with own_node(board or "virtual", scene.run.real, id_base) as node:
            yield node
        return
    if board is not None:
        raise BadInput(f"--board {board}: starts a node of its own; leave --interface out")
    with connected(interface, channel, id_base, bitrate=bitrate) as node:
        yield node
