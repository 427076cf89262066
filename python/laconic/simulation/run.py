"""Runs a scene through the core and keeps its outputs."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field

import numpy as np

from laconic.base.progress import Advance, progress_bar
from laconic.core.estimate import ErrorRows, Errors, Estimate
from laconic.core.given import flag, shown
from laconic.core.grip import Grip
from laconic.core.plant import Plant
from laconic.core.recording import Recorder, needs_sensors
from laconic.core.slipping import SlippingPlant
from laconic.errors import BadInput, Refused, nearest_of
from laconic.scene import Scene, check_scene
from laconic.scene.ground import slips
from laconic.scene.hinge_signals import input_signals as input_signals_of
from laconic.scene.hinge_signals import output_signals_of
from laconic.scene.inputs import InputsOnGrid
from laconic.scene.reader import read_signals
from laconic.scene.sensors import OF_ENCODERS, OF_IMU, missing_sensors
from laconic.scene.signals import (
    LENGTHS,
    OUTPUT_LENGTHS,
    OUTPUTS_PER_WHEEL,
    PER_WHEEL,
    missing_outputs,
    output_signals,
    signal_names,
)
from laconic.scene.table import Table
from laconic.simulation.articulated import (
    HingedRun,
    HingeErrors,
    Rows,
    input_signals_with_hinges,
    kept_signals_with_hinges,
    run_with_hinges,
    usual_signals_with_hinges,
)
from laconic.simulation.kept_rows import Folded
from laconic.simulation.slipping import SlippingRun, run_slipping
from laconic.simulation.steering import Limited

USUAL = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "velocity_body_m_per_s", "yaw_rate_rad_per_s",
         "wheel_speed_rad_per_s", "wheel_angle_rad", "energy_J")
MOST_ROWS = 10**7  # of outputs that are kept: some gigabytes
CHUNK = 1 << 18    # steps between updates of the progress bar and checks for Ctrl-C: 0.1 s, or 0.3 s with grip


@dataclass(repr=False)
class Trajectory:
    """Outputs over time; `columns` by signal name in the order to write them."""

    scene: Scene
    method: str
    steps: int
    seconds: float
    time_s: np.ndarray
    columns: dict[str, np.ndarray]
    grip: Grip | None = None  # None: the scene has no data of the ground
    refused: Refused | None = None  # what ended it before its time
    errors: Errors | HingeErrors | None = None  # at its end; None: the estimate was not asked for
    error_columns: dict[str, np.ndarray] = field(default_factory=dict)  # the same over time, by estimated_error_…
    limited: tuple[Limited, ...] = ()  # with hinges: the limits that held commands back
    folded: tuple[Folded, ...] = ()  # with hinges: trailers that turned by more than a right angle
    lifted: tuple[int, float] | None = None  # with hinges: the first wheel that carried nothing, and when in s
    least_margin: tuple[float, float, int] | None = None  # with hinges and friction known: N, when in s, which wheel
    slipping_wheels: tuple[int, ...] = ()  # with hinges: those that slipped, or would slip, in some row
    slip_loss_J: float | None = None  # with hinges where wheels may slip: what slip and scrub took

    def __repr__(self) -> str:
        """In one line: its arrays have thousands of numbers."""
        names = ", ".join(dict.fromkeys(name.partition("[")[0] for name in self.columns))
        return (f"<run of {self.scene.name}: {self.steps} steps by {self.method}, {len(self.time_s)} rows to "
                f"{self.time_s[-1]:g} s of {names}>")

    def columns_of(self, name: str) -> np.ndarray:
        """All columns of one signal, side by side; BadInput for one that is not among them."""
        if not isinstance(name, str):
            raise BadInput(f"name: {shown(name)} is no name of a signal; give one as text")
        found = [column for signal, column in self.columns.items() if name in (signal, signal.partition("[")[0])]
        if found:
            return np.column_stack(found)
        if self.scene.has_hinges:
            known = [*output_signals_of(self.scene.vehicle, self.scene.hinges),
                     *input_signals_of(self.scene.vehicle, self.scene.hinges)]
        else:
            lengths, per_wheel = output_signals(self.scene.vehicle)
            known = [*lengths, *per_wheel, *LENGTHS, *PER_WHEEL]
        if name.partition("[")[0] in known:
            raise BadInput(f"{name}: this run did not keep it; give simulate its name in signals")
        raise BadInput(f"{name}: there is no such signal; {nearest_of(name, known)}")


class RunRefused(Refused):
    """A step was refused on the way: `run` is the motion up to it. The result is there and fails."""

    exit_status = 1

    def __init__(self, refused: Refused, run: Trajectory):
        super().__init__(refused.status, refused.field, refused.item, refused.message, value=refused.value,
                         limit=refused.limit)
        self.run = run


def wanted_signals(scene: Scene) -> tuple[str, ...]:
    """The scene's output signals, or the default ones."""
    return scene.outputs.signals or usual_signals(scene)


def usual_signals(scene: Scene) -> tuple[str, ...]:
    """Velocities, pose, wheels and energy; then what the scene's sensors show."""
    if scene.has_hinges:
        return usual_signals_with_hinges(scene)
    every = signal_names(OUTPUT_LENGTHS, OUTPUTS_PER_WHEEL, scene.wheel_count)
    by_name: dict[str, list[str]] = {name: [] for name in USUAL}
    for signal in every:
        by_name.get(signal.partition("[")[0], []).append(signal)
    return (*(signal for name in USUAL for signal in by_name[name]), *sensor_signals(scene))


def sensor_signals(scene: Scene) -> tuple[str, ...]:
    """What the scene's sensors show; empty without [sensors]."""
    missing = missing_sensors(scene.sensors, scene.wheel_count)
    of_imu, counts = signal_names(OF_IMU, (), 0), signal_names({}, OF_ENCODERS, scene.wheel_count)
    return tuple(signal for signal in (*of_imu, *counts) if signal not in missing)


def input_signals(scene: Scene) -> tuple[str, ...]:
    """Every element of the inputs that the scene uses; the voltages where it uses none."""
    if scene.has_hinges:
        return input_signals_with_hinges(scene)
    used = dict.fromkeys(each.signal.partition("[")[0] for each in scene.inputs) or {"voltage_V": None}
    every = signal_names(LENGTHS, PER_WHEEL, scene.wheel_count)
    return tuple(signal for signal in every if signal.partition("[")[0] in used)


def is_watched(scene: Scene) -> bool:
    """Whether the ground is checked: the scene gives its friction, or the height of the centre of mass."""
    vehicle = scene.vehicle
    if scene.has_hinges:
        return False
    return bool(scene.wheel_count and (vehicle["friction_coefficient"] or vehicle["com_z_m"] or slips(vehicle)))


@dataclass
class Watch:
    """What watches a run beside its recorder: an error estimate, and its rows."""

    estimate: Estimate
    rows: ErrorRows | None = None


def advance_plant(plant: Plant, inputs: InputsOnGrid, first: int, count: int, recorder: Recorder | None = None,
                  watch: Watch | None = None) -> None:
    """Steps `first` … `first + count − 1` of a run with these inputs."""
    origin, last = plant.steps - first, first + count
    while first < last:
        schedule, end = inputs.schedule(plant.core, first)
        first = min(last, end)
        along = schedule.from_origin(origin)
        if watch:
            watch.estimate.follow(along, origin + first, recorder, watch.rows)
        else:
            plant.follow(along, origin + first, recorder)


def kept_signals(scene: Scene, given: Sequence[str]) -> tuple[str, ...]:
    """Those of a run: the given outputs and inputs, a signal without its index standing for all of them."""
    table = Table(scene.path, "", {"signals": given})
    lengths, per_wheel = output_signals(scene.vehicle)
    missing = missing_outputs(scene.vehicle, scene.sensors)
    kept = read_signals(table, lengths | LENGTHS, (*per_wheel, *PER_WHEEL), scene.wheel_count, missing)
    return kept or wanted_signals(scene)


def simulate(scene: Scene, signals: Sequence[str] = (), progress: bool = False, watched: bool = True,
             estimated: bool = False) -> Trajectory:
    """Runs a scene from its start to its end.

    Keeps the given signals (outputs, or inputs), else the scene's outputs, else the default ones. `progress`: says on
    stderr how far it is; `watched`: watches the ground where the scene has data of it, which costs more than the steps;
    `estimated`: estimates the run's error (docs/accuracy.md), with friction at three times the cost, with hinges at
    four times.
    Refused names file and time when the first step is refused or an input is no number; RunRefused, when a later step
    is refused or the outputs at the end leave the range of numbers, has the motion up to there.
    """
    if check_scene(scene).has_hinges:
        if flag("estimated", estimated) and scene.slips_on_hinges:
            raise BadInput(f"{scene.path}: the error of hinges on ground with friction is not estimated yet; leave "
                           "estimated out")
        return simulate_with_hinges(scene, signals, flag("progress", progress), estimated)
    kept = kept_signals(scene, signals)
    progress, watched, estimated = flag("progress", progress), flag("watched", watched), flag("estimated", estimated)
    core, steps, every = scene.core(), scene.steps(), interval_of(scene)
    plant, inputs = scene.plant(core), scene.inputs_on_grid()
    ticks = np.append(np.arange(0, steps, every), steps)  # the last row is the end of the run, on the grid or not
    sensors = scene.sensors_of(plant)  # refuses, by its field, what the core refuses
    recorder = Recorder(plant, kept, every, len(ticks), watched=watched and is_watched(scene),
                        sensors=sensors if any(needs_sensors(core, signal) for signal in kept) else None)
    watch = Watch(plant.estimate(), ErrorRows(plant, every, len(ticks))) if estimated else None
    began = time.perf_counter()
    refused = None
    try:
        with progress_bar(scene.name, steps, forecasts=True) if progress else nullcontext(_silently) as moved:
            run_window(scene, plant, inputs, 0, steps, moved, recorder, watch)
        recorder.take_last(core.input(inputs.held_at(steps)))
        if recorder.drop_unfinite():
            raise scene.refusal_in_file(core.out_of_range("outputs"), f"at t = {steps * scene.run.step_s:g} s")
    except Refused as why:
        if not plant.steps or why.status == "not finite":  # an input that the file should not have
            raise
        refused, ticks = why, take_end(plant, inputs, recorder, every)
    run = Trajectory(scene, plant.chosen_method, plant.steps, time.perf_counter() - began, ticks * scene.run.step_s,
                     recorder.columns(), recorder.grip(scene.run.step_s), refused)
    if watch:
        run.errors, run.error_columns = watch.estimate.read(), error_columns(watch, len(ticks))
    if refused:
        raise RunRefused(refused, run) from None
    return run


def interval_of(scene: Scene) -> int:
    """Steps between two rows of outputs; BadInput for more rows than can be kept."""
    steps = scene.steps()
    every = 1 if scene.outputs.every_s is None else scene.steps_in("outputs.every_s", scene.outputs.every_s)
    if steps / every > MOST_ROWS:
        raise BadInput(f"{scene.path}: outputs.every_s: {steps // every} rows are too many to keep; make it longer, "
                       f"for {MOST_ROWS} or fewer")
    return every


def simulate_with_hinges(scene: Scene, signals: Sequence[str], progress: bool, estimated: bool) -> Trajectory:
    """The run of a scene whose vehicle has bodies on hinges. On ground with friction its error is not estimated yet."""
    kept, steps, every = kept_signals_with_hinges(scene, signals), scene.steps(), interval_of(scene)
    found: HingedRun | SlippingRun
    with progress_bar(scene.name, steps, forecasts=True) if progress else nullcontext(_silently) as moved:
        if scene.slips_on_hinges:
            found = run_slipping(scene, kept, every, moved)
        else:
            found = run_with_hinges(scene, kept, every, moved, estimated)
    rows, plant = found.rows, found.plant
    ticks = np.append(np.arange(0, steps, every), steps)[: len(rows)]
    if found.refused and len(rows):
        ticks[-1] = plant.steps
    run = Trajectory(scene, plant.method, plant.steps, found.seconds, ticks * scene.run.step_s, rows.columns(),
                     refused=found.refused, limited=tuple(found.commands.limited.values()), folded=rows.folded,
                     lifted=rows.lifted)
    if isinstance(rows, Rows):
        run.least_margin = rows.least_margin
    run.slipping_wheels = tuple(sorted(rows.slipping))
    if isinstance(plant, SlippingPlant):
        run.slip_loss_J = slip_loss_of(plant)
    if isinstance(found, HingedRun) and found.parts and len(rows):
        run.errors, run.error_columns = found.parts.read(), found.parts.columns()
    if found.refused:
        raise RunRefused(found.refused, run) from None
    return run


def slip_loss_of(plant: SlippingPlant) -> float:
    """What slip and scrub took since the start."""
    found = plant.outputs()
    return found.slip_loss_J + found.scrub_loss_J


def _silently(amount: float = 1, what: str | None = None) -> None:
    """Progress that nobody asked for."""


def error_columns(watch: Watch, rows: int) -> dict[str, np.ndarray]:
    """The estimate's rows; the last one is that of the run's end."""
    assert watch.rows is not None
    if len(watch.rows) < rows:
        watch.rows.take(watch.estimate)
    return {name: column[:rows] for name, column in watch.rows.columns().items()}


def take_end(plant: Plant, inputs: InputsOnGrid, recorder: Recorder, every: int) -> np.ndarray:
    """Ends the rows where a step was refused; returns the steps that they belong to. The last is one whose outputs are
    in the range of numbers."""
    recorder.take_refused(plant.core.input(inputs.held_at(plant.steps)))
    whole = np.append(np.arange(recorder.row_count - 1) * every, plant.steps)
    return whole[:-1] if recorder.drop_unfinite() else whole


def run_window(scene: Scene, plant: Plant, inputs: InputsOnGrid, first: int, count: int,
               moved: Advance = lambda _: None, recorder: Recorder | None = None, watch: Watch | None = None) -> None:
    """Takes `count` steps from step `first` on; a refusal names file and time."""
    try:
        for begin in range(first, first + count, CHUNK):
            steps = min(CHUNK, first + count - begin)
            advance_plant(plant, inputs, begin, steps, recorder, watch)
            moved(steps)
    except Refused as refused:
        raise scene.refusal_in_file(refused, f"at t = {plant.steps * scene.run.step_s:g} s") from None
