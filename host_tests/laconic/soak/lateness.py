"""`laconic play` with four C620 drives at 1 kHz and a controller in another process on its port: how late are periods?

No period may be left out; how late they begin is the machine's, and printed."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from laconic.errors import BadInput, nearest_of
from laconic.play.options import PlayOptions
from laconic.play.session import play
from laconic.rig.boards import free_port
from laconic.rig.errors import CannotReach
from laconic.scene import read_scene
from laconic.soak._controllers.by_c620 import SCENE

BOARDS = ("virtual", "process")
OPTIONS = ("board", "seconds")
CLIENT = "laconic.soak._controllers.c620_process"
MISSING_SHARE = 0.02  # of the periods: the loop ends between two of them, and the node begins after it
END_S = 5.0


def soak(minutes: float, seed: int, advance: Callable[[float], None], board: str | None = None,
         seconds: float = 10.0) -> dict[str, Any]:
    """So many seconds on each board, or on one; neither minutes nor seed has an effect."""
    found: dict[str, Any] = {"passed": True}
    for name in chosen(board):
        found[name] = said = measure(name, seconds, advance)
        found["passed"] &= said.startswith("passed")
    return found


def length(board: str | None = None, seconds: float = 10.0) -> float:
    """Seconds on all boards."""
    if not 0.0 < seconds < float("inf"):
        raise BadInput(f"--seconds {seconds:g}: is not usable; give a finite number above zero")
    return seconds * len(chosen(board))


def chosen(board: str | None) -> tuple[str, ...]:
    """The boards; BadInput for one whose clock is not this machine's."""
    if board is not None and board not in BOARDS:
        raise BadInput(f"--board {board}: its lateness is not measured here; {nearest_of(board, BOARDS)}")
    return BOARDS if board is None else (board,)


def measure(board: str, seconds: float, advance: Callable[[float], None]) -> str:
    """Plays so long on one board; the figures in a line."""
    scene = read_scene(SCENE)
    port, began = free_port(), time.monotonic()
    options = PlayOptions(listen=port, board=board, drives="robomaster", duration_s=seconds)
    with client(port, scene.run.step_s):
        figures = play(scene, options).figures
    advance(time.monotonic() - began)
    wanted = seconds / scene.run.step_s
    keeps_up = figures["periods"] >= (1.0 - MISSING_SHARE) * wanted and figures["frames_in"] > 0
    return (f"{'passed' if keeps_up else 'failed'}: {figures['periods']} periods of {1000.0 * scene.run.step_s:g} ms "
            f"in {seconds:g} s, {figures['late_periods']} late by a period or more, by "
            f"{figures['worst_lateness_ms']:.1f} ms at most; {figures['frames_in']} commands heard, "
            f"{figures['frames_out']} frames sent")


@contextmanager
def client(port: int, step_s: float) -> Iterator[None]:
    """The controller in its own process, ready for the port; it ends when the port is closed."""
    command = [sys.executable, "-m", CLIENT, str(port), str(step_s)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        try:
            if process.stdout is None or process.stdout.readline().strip() != "ready":
                raise CannotReach("the controller's process did not start")
            yield
            with suppress(subprocess.TimeoutExpired):
                process.wait(END_S)
        finally:
            process.kill()
