"""The result of every participant: one row of numbers after each exchange, in the same order for all.

A row is ν(3), x, y, heading, wheel speeds (N), wheel angles (N), in the core's scalar type.

A scene through the firmware node over CAN, in lockstep with raw frames.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from laconic.can.rig.buses import process_node
from laconic.can.rig.lockstep import run_lockstep
from laconic.scene import Scene
from laconic.scene.inputs import InputsOnGrid
from laconic.simulation import advance_plant


@dataclass(frozen=True)
class Rows:
    """Rows of one participant, and the steps that were taken before each."""

    who: str
    ticks: np.ndarray
    rows: np.ndarray
    seconds: float = 0.0
    log: tuple[str, ...] = ()  # the participant's log


def row_names(wheel_count: int) -> list[str]:
    """Names of the numbers of a row."""
    wheels = range(1, wheel_count + 1)
    return ["nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]", "x_m", "y_m", "heading_rad",
            *(f"wheel_speed_rad_per_s[{i}]" for i in wheels), *(f"wheel_angle_rad[{i}]" for i in wheels)]


def exchanges(inputs: InputsOnGrid, steps: int, every: int) -> Iterator[tuple[int, int]]:
    """(first step, how many): at most `every` at once, and never across a change of the inputs."""
    edges = sorted({*range(0, steps, every), *(c for c in inputs.changes if c < steps), steps})
    for begin, end in zip(edges, edges[1:], strict=False):
        yield begin, end - begin


def core_rows(scene: Scene, steps: int, every: int = 1, hold: bool = False) -> Rows:
    """The rows of the core, with which the others are compared.

    `hold`: every input is held over the step at its value at the start, as in an FMU.
    """
    plant, inputs = scene.plant(scene.core()), scene.inputs_on_grid()
    ticks, rows = [], []
    for first, count in exchanges(inputs, steps, 1 if hold else every):
        if hold:
            plant.run(plant.core.input(inputs.held_at(first)), count)
        else:
            advance_plant(plant, inputs, first, count)
        ticks.append(first + count)
        rows.append(plant.row())
    return Rows("core", np.array(ticks), np.array(rows))


def difference(found: Rows, expected: Rows, wheel_count: int) -> str:
    """"" where all bits are the same at every exchange of `found`; else the first difference in words."""
    at = np.searchsorted(expected.ticks, found.ticks)
    if np.any(at >= len(expected.ticks)) or np.any(expected.ticks[at] != found.ticks):
        return f"{found.who} stops at steps where {expected.who} does not"
    want, have = expected.rows[at], found.rows
    if have.shape != want.shape or have.dtype != want.dtype:
        return f"{found.who} gives {have.shape} {have.dtype}, {expected.who} {want.shape} {want.dtype}"
    bits = f"u{have.dtype.itemsize}"
    unequal = np.argwhere(have.view(bits) != want.view(bits))
    if not len(unequal):
        return ""
    row, column = unequal[0]
    return (f"{found.who} differs from {expected.who} in {len(unequal)} of {have.size} numbers, first in "
            f"{row_names(wheel_count)[column]} after step {found.ticks[row]}: {float(have[row, column])!r}, not "
            f"{float(want[row, column])!r}")


def node_rows(scene: Scene, steps: int, every: int = 1, moved: Callable[[int], None] = lambda _: None) -> Rows:
    """Rows of the node that runs as a process of its own, over SLCAN on a TCP socket."""
    with process_node(scene.run.real) as node:
        run = run_lockstep(node, scene, steps, every=every, moved=moved)
    return Rows("node", run.ticks, run.states, run.seconds)
