"""Whether the first run of an imported robot does what its line says: it is simulated before it is written."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from laconic.errors import BadInput, Refused
from laconic.robot.importer.placement import Array
from laconic.robot.importer.wheels import FoundWheel, Ground
from laconic.scene import Scene
from laconic.scene.axle_lines import WITHIN_RAD
from laconic.scene.inputs import Input

if TYPE_CHECKING:
    from laconic.robot.importer.imported_scene import Imported
    from laconic.simulation import Trajectory

NUDGE_RAD_PER_S, NUDGE_S = 1e-4, 0.1  # a yaw rate so small that what it becomes is in proportion to it
GRID_S = 0.01           # of the runs that the import writes
YIELDS = 0.02           # of that yaw rate, that a robot reaches which is free to turn
GROWS = 4.0             # a nudge that becomes so much larger spoils the run; less is for the user to see and steer
SLOWS_S = (0.5, 0.2, 0.1, 0.05)  # times in which gearmotors take a robot's speed
OFF = 0.05              # of a promised speed or way that a run may miss
SIGNALS = ("velocity_body_m_per_s", "yaw_rate_rad_per_s", "x_m", "y_m", "heading_rad")


@dataclass(frozen=True, eq=False)
class Promise:
    """What a line says of a run: it goes along `way` without turning until `turns_at_s`, and then turns to the left.

    `way` is a unit vector of the body; None: the robot turns from the start on."""

    way: Array | None
    turns_at_s: float = math.inf
    settles_s: float = 0.0  # how long the turn takes to begin
    fast_at_s: float = 0.0  # when it has its speed


@dataclass(frozen=True)
class Damping:
    """What is assumed of the driven wheels, so that a run is stable: the time in which they take its speed, and why."""

    slows_s: float
    why: str

    def words(self, damping_Nms: float) -> str:
        """As a comment of the scene has it."""
        return (f"assumption: {damping_Nms:g} N·m·s, that of gearmotors which take the robot's speed in "
                f"{self.slows_s:g} s; without it {self.why}")


def run_of(scene: Scene) -> Trajectory | None:
    """The run with what is judged of it; None where it is refused. Whoever writes the scene shortens such a run, or
    reports the refusal."""
    from laconic.simulation import simulate

    try:
        return simulate(scene, SIGNALS, watched=False)
    except (Refused, BadInput):
        return None


def growth_of(scene: Scene, straight: Trajectory, nudge_at_s: float) -> float:
    """By how much a small yaw rate, given by a moment on the body, grows until the run ends; 0 where wheels resist.

    `straight` is the run without that moment."""
    from laconic.simulation import simulate

    begin = round(math.floor(nudge_at_s / GRID_S) * GRID_S, 6)
    moment = float(scene.vehicle["yaw_inertia_kgm2"]) * NUDGE_RAD_PER_S / NUDGE_S
    nudge = Input("body_moment_Nm", "steps", "nudge", (begin, round(begin + NUDGE_S, 6)), (moment, 0.0))
    try:
        nudged = simulate(replace(scene, inputs=(*scene.inputs, nudge)), ("yaw_rate_rad_per_s",), watched=False)
    except (Refused, BadInput):
        return 0.0
    count = min(len(straight.time_s), len(nudged.time_s))
    rates = [run.columns["yaw_rate_rad_per_s"][:count] for run in (straight, nudged)]
    off, after = np.abs(rates[1] - rates[0]), straight.time_s[:count] >= begin + NUDGE_S
    given = float(off[after][0]) if after.any() else 0.0
    return float(off[after].max()) / given if given > YIELDS * NUDGE_RAD_PER_S else 0.0


def fault_of(run: Trajectory, promise: Promise) -> str:
    """What a run does instead of what is promised; empty where it keeps to it."""
    columns, time_s = run.columns, run.time_s
    if promise.way is not None:
        before = time_s <= min(promise.turns_at_s, time_s[-1])
        fault = _strays(promise.way, {name: column[before] for name, column in columns.items()}, time_s[before])
        if fault:
            return fault
    after = time_s >= promise.turns_at_s + promise.settles_s
    backward = after & (columns["yaw_rate_rad_per_s"] <= 0.0)
    return f"it turns to the right at t = {time_s[backward][0]:.3g} s" if backward.any() else ""


def _strays(way: Array, columns: dict[str, Array], time_s: Array) -> str:
    """How a run that goes straight leaves its way."""
    moved = np.column_stack([columns["x_m"] - columns["x_m"][0], columns["y_m"] - columns["y_m"][0]])
    ahead, aside = moved @ way, moved @ np.array([-way[1], way[0]])
    off = np.abs(columns["heading_rad"] - columns["heading_rad"][0])
    gone = max(float(ahead.max(initial=0.0)), 1e-9)
    strayed = (np.abs(aside) > OFF * gone) | (off > OFF)
    if strayed.any():
        return f"it leaves its straight way at t = {time_s[np.argmax(strayed)]:.3g} s"
    return "" if ahead[-1] > 0.0 else "it does not move ahead"


def unrest_of(scene: Scene, run: Trajectory, promise: Promise, wheels: Sequence[FoundWheel], com_m: Array) -> str:
    """What is wrong with a first run, in words; empty where it is stable and does what is promised."""
    growth, fault = growth_of(scene, run, promise.fast_at_s), fault_of(run, promise)
    if growth <= GROWS:
        return fault and f"the first run does not do what its line says: {fault}"
    way = promise.way if promise.way is not None else np.array([1.0, 0.0])
    return f"the first run is unstable: {_instability(growth, wheels, com_m, way)}"


def _instability(growth: float, wheels: Sequence[FoundWheel], com_m: Array, way: Array) -> str:
    """Why a motion is unstable, in words."""
    grows = f"a small turn grows {growth:.3g}-fold by the end of the run"
    ways = [np.array([-math.sin(each.axle_rad), math.cos(each.axle_rad)]) for each in wheels if not each.rollers]
    if not ways or any(abs(each @ np.array([-way[1], way[0]])) > WITHIN_RAD for each in ways):
        return grows
    middle = np.mean([each.hub_m[:2] for each in wheels if not each.rollers], axis=0)
    behind_m = float((middle - com_m[:2]) @ way)
    if behind_m <= 0.0:
        return grows
    return f"{grows}, as the centre of mass lies {1e3 * behind_m:.3g} mm behind the axle in the direction of travel"


def damped(ground: Ground, mass_kg: float, driven: Collection[str], slows_s: float) -> Ground:
    """The same robot whose driven wheels have the damping of gearmotors that take its speed in this time."""
    def of_wheel(wheel: FoundWheel) -> FoundWheel:
        if wheel.name not in driven:
            return wheel
        own = float(f"{mass_kg * wheel.radius_m**2 / (len(driven) * slows_s):.2g}")
        return replace(wheel, joint=replace(wheel.joint, damping_Nms=max(own, wheel.joint.damping_Nms)))

    return replace(ground, wheels=tuple(map(of_wheel, ground.wheels)), casters=tuple(map(of_wheel, ground.casters)))


class Written(Protocol):
    """What a writer of scenes knows of its first run: its fault, and the wheels whose motors could mend it."""

    fault: str

    def imported(self) -> Imported: ...

    def motors(self) -> list[str]: ...


def steadied(make: Callable[[Ground, Damping | None], Written], ground: Ground, mass_kg: float) -> Imported:
    """The scene with the weakest damping that makes its first run do what its line says. Where none does, the scene
    without damping has a remark."""
    first = make(ground, None)
    found = first.imported()
    if first.fault and (motors := first.motors()):
        for slows_s in SLOWS_S:
            writer = make(damped(ground, mass_kg, motors, slows_s), Damping(slows_s, first.fault))
            tried = writer.imported()
            if not writer.fault:
                return tried
    return found
