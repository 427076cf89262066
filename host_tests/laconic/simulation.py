"""Runs a scene through the core and keeps what it puts out."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from laconic.core import Core
from laconic.drive import Drive
from laconic.errors import BadInput, Refused
from laconic.plant import Plant
from laconic.progress import Advance, progress_bar
from laconic.scene import Scene
from laconic.scene_reader import OUTPUT_LENGTHS, OUTPUTS_PER_WHEEL, signal_names

USUAL = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "velocity_body_m_per_s", "yaw_rate_rad_per_s",
         "wheel_speed_rad_per_s", "wheel_angle_rad", "energy_J")
CHUNK = 4096          # sampled steps made ready at once
MOST_ROWS = 10**7     # of outputs that are kept: some gigabytes
HELD_CHUNK = 1 << 20  # held steps between two looks at the progress bar: about half a second

Row = dict[str, float]


@dataclass
class Trajectory:
    """Outputs over time; `columns` by signal name in the order to write them."""

    scene: Scene
    method: str
    steps: int
    seconds: float
    time_s: np.ndarray
    columns: dict[str, np.ndarray]

    def columns_of(self, name: str) -> np.ndarray:
        """All columns of one signal, side by side."""
        return np.column_stack([v for k, v in self.columns.items() if k.partition("[")[0] == name])


def pose_outputs(plant: Plant, held: object) -> Row:
    """Both poses and the two headings."""
    pose = plant.pose
    names = ("x_m", "y_m", "origin_x_m", "origin_y_m", "heading_rad", "heading_wrapped_rad")
    return {name: getattr(pose, name) for name in names}


def velocity_outputs(plant: Plant, held: object) -> Row:
    """Velocity of the centre of mass in body axes, and yaw rate."""
    (forward, sideways), yaw_rate = plant.body_velocity()
    return {"velocity_body_m_per_s[1]": forward, "velocity_body_m_per_s[2]": sideways, "yaw_rate_rad_per_s": yaw_rate}


def reaction_outputs(plant: Plant, held: object) -> Row:
    """What the ground delivers."""
    found = plant.reactions(held)
    count = plant.wheel_count
    return (indexed("wheel_reaction_N", list(found.along_N)[:count])
            | indexed("wheel_lateral_N", list(found.lateral_N)[:count]) | {"no_slip_margin_N": found.no_slip_margin_N})


def indexed(name: str, values: object) -> Row:
    """name[1], name[2] …"""
    return {f"{name}[{i}]": value for i, value in enumerate(values, start=1)}


SOURCES: tuple[tuple[tuple[str, ...], Callable[[Plant, object], Row]], ...] = (
    (("nu_rad_per_s",), lambda p, held: indexed("nu_rad_per_s", p.nu)),
    (("x_m", "y_m", "origin_x_m", "origin_y_m", "heading_rad", "heading_wrapped_rad"), pose_outputs),
    (("velocity_body_m_per_s", "yaw_rate_rad_per_s"), velocity_outputs),
    (("wheel_speed_rad_per_s",), lambda p, held: indexed("wheel_speed_rad_per_s", p.wheel_speeds())),
    (("wheel_angle_rad",), lambda p, held: indexed("wheel_angle_rad", p.wheel_angles())),
    (("wheel_torque_Nm",), lambda p, held: indexed("wheel_torque_Nm", p.wheel_torques(held))),
    (("wheel_reaction_N", "wheel_lateral_N", "no_slip_margin_N"), reaction_outputs),
    (("energy_J",), lambda p, held: {"energy_J": p.energy_J()}),
)


def wanted_signals(scene: Scene) -> tuple[str, ...]:
    """The scene's output signals, or the usual ones."""
    return scene.outputs.signals or usual_signals(scene)


def usual_signals(scene: Scene) -> tuple[str, ...]:
    """Velocities, pose, wheels and energy."""
    every = signal_names(OUTPUT_LENGTHS, OUTPUTS_PER_WHEEL, scene.wheel_count)
    by_name = {name: [] for name in USUAL}
    for signal in every:
        by_name.get(signal.partition("[")[0], []).append(signal)
    return tuple(signal for name in USUAL for signal in by_name[name])


class Recorder:
    """Collects the wanted outputs row by row, asking the core for no more than that."""

    def __init__(self, signals: tuple[str, ...]):
        self.signals, self.rows = signals, []
        names = {signal.partition("[")[0] for signal in signals}
        self._sources = [source for provides, source in SOURCES if names & set(provides)]

    def take(self, plant: Plant, held: object) -> None:
        """One row of the present state and input."""
        values: Row = {}
        for source in self._sources:
            values |= source(plant, held)
        self.rows.append([values[signal] for signal in self.signals])

    def columns(self) -> dict[str, np.ndarray]:
        """By signal name."""
        table = np.array(self.rows, dtype=float).reshape(-1, len(self.signals))
        return dict(zip(self.signals, table.T, strict=True))


def advance_plant(plant: Plant, drive: Drive, first: int, count: int) -> None:
    """Steps `first` … `first + count − 1` of a drive."""
    core = plant.core
    if drive.is_held:
        for begin, steps in held_stretches(drive, first, count):
            plant.run(core.input(drive.held_at(begin)), steps)
        return
    for begin in range(first, first + count, CHUNK):
        plant.run_sampled(sampled_rows(core, drive, begin, min(CHUNK, first + count - begin)))


@np.errstate(over="ignore")
def sampled_rows(core: Core, drive: Drive, first: int, count: int) -> np.ndarray:
    """Rows of input numbers at the start, middle and end of some steps."""
    samples = drive.samples(first, count)
    rows = np.zeros((count, 3, core.input_length), core.dtype)
    for column, signal in enumerate(drive.signals):
        rows[:, :, core.input_place(signal)] = samples[:, :, column]
    return rows


def held_stretches(drive: Drive, first: int, count: int) -> Iterator[tuple[int, int]]:
    """(first step, steps) between changes of the inputs, cut to a window."""
    edges = [first, *(c for c in drive.changes if first < c < first + count), first + count]
    for begin, end in pairwise(edges):
        yield begin, end - begin


def simulate(scene: Scene, signals: tuple[str, ...] = (), progress: bool = False) -> Trajectory:
    """Runs a scene from its start to its end; Refused names file and time when a step is refused.

    Keeps the given signals, else the scene's, else the usual ones.
    """
    core, steps = scene.core(), scene.steps()
    every = 1 if scene.outputs.every_s is None else scene.steps_in("outputs.every_s", scene.outputs.every_s)
    if steps / every > MOST_ROWS:
        raise BadInput(f"{scene.path}: outputs.every_s: {steps // every} rows are too many to keep; make it longer, "
                       f"for {MOST_ROWS} or fewer")
    plant, drive, recorder = scene.plant(core), scene.drive(), Recorder(signals or wanted_signals(scene))
    ticks = [*range(0, steps, every), steps]  # the last row is the end of the run, wherever it falls
    began = time.perf_counter()
    with progress_bar(scene.name, steps if progress else 0) as moved:
        recorder.take(plant, input_now(core, drive, 0))
        for tick, following in pairwise(ticks):
            run_window(scene, plant, drive, tick, following - tick, moved)
            recorder.take(plant, input_now(core, drive, following))
    seconds = time.perf_counter() - began
    instants = np.array(ticks, dtype=float) * scene.run.step_s
    return Trajectory(scene, plant.chosen_method, steps, seconds, instants, recorder.columns())


def run_window(scene: Scene, plant: Plant, drive: Drive, first: int, count: int,
               moved: Advance = lambda _: None) -> None:
    """Some steps; a refusal is told with file and time."""
    try:
        for begin in range(first, first + count, HELD_CHUNK):
            steps = min(HELD_CHUNK, first + count - begin)
            advance_plant(plant, drive, begin, steps)
            moved(steps)
    except Refused as refused:
        raise scene.told(refused, f"at t = {plant.steps * scene.run.step_s:g} s") from None


def input_now(core: Core, drive: Drive, tick: int) -> object:
    """What acts at the start of a step (after the last: what acted in it)."""
    return core.input(drive.held_at(min(tick, drive.steps - 1)))
