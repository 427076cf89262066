"""Runs of one template side by side in a batch, with the bits that each has alone.

Inputs that are held, of many runs whose values differ: the numbers of each signal from a step on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from laconic.batch import Batch
from laconic.batch.population import Kinds, contacts_of, outputs_of, start_lanes, zeros
from laconic.core import Core
from laconic.core.recording import GROUND, MEMBERS
from laconic.scene import Scene
from laconic.scene.ground import has_friction
from laconic.scene.inputs import InputsOnGrid
from laconic.scene.key_path import EVERY, key_path
from laconic.scene.scene_tables import SceneTables
from laconic.scene.sensors import NO_SENSORS
from laconic.simulation.run import MOST_ROWS
from laconic.tools.measures import Course, Measure
from laconic.tools.measures.measure import Winding
from laconic.tools.sweep.alone import driven_wheels
from laconic.tools.sweep.numbers import Numbers, has_own_zero, numbers_of, starts_of

Given = Mapping[tuple[str, int], np.ndarray]
"""By the location of an input and the place of a value in its list, from 0: that value in each run."""


class HeldInputs:
    """What `InputsOnGrid` has of one scene, with some values that differ from run to run; the same sums, bit by bit."""

    def __init__(self, grid: InputsOnGrid, given: Given):
        self._grid, self._given = grid, given

    def changes(self) -> tuple[int, ...]:
        """The steps at whose start some input changes, the first step among them."""
        return self._grid.changes

    def at(self, tick: int) -> dict[str, np.ndarray]:
        """By signal: one number for all runs, or one for each."""
        found = {signal: np.zeros(()) for signal in self._grid.signals}
        for each in self._grid.given:
            place = int(np.searchsorted(self._grid.ticks_of(each), tick, side="right"))
            own = self._given.get((each.location, place - 1))
            level = np.asarray(self._grid.levels_of(each)[place]) if own is None else own
            found[each.signal] = found[each.signal] + level
        return found

    def set_into(self, batch: Batch, tick: int) -> None:
        """Gives the batch what acts from the start of a step on."""
        for signal, values in self.at(tick).items():
            name, _, item = signal.partition("[")
            row = getattr(batch, name)
            with np.errstate(over="ignore"):  # the core names a number that is too large for its scalar type
                row[int(item[:-1]) - 1 if item else ...] = values


MOST_LANES = 1024       # at once: what they are made of stays in a cache of the second level
MOST_NUMBERS = 1 << 22  # of signals that are kept at once


@dataclass(frozen=True)
class Template:
    """A scene of which runs differ only in numbers of its structs."""

    tables: SceneTables
    scene: Scene

    def fits(self, measures: Sequence[Measure]) -> bool:
        """Whether a batch steps it: ideal ground, motors without limits, inputs held over each step."""
        core = self.scene.core()
        if self.scene.sensors != NO_SENSORS:
            self.scene.sensors_of(self.scene.plant(core))  # raises as `simulate` for what does not fit the step
        known = zeros(core, "laconic_outputs", 1).dtype.names or ()
        if not all(measure.is_of_end for measure in measures) and self.scene.steps() / self._every() > MOST_ROWS:
            return False  # alone it is refused
        return not has_friction(self.scene.vehicle) and self.scene.inputs_on_grid().is_held and all(
            signal in MEMBERS or signal in core.input_fields or signal in known
            for measure in measures for signal in measure.signals) and not has_own_zero(self.scene, core)

    def _every(self) -> int:
        """Steps between rows."""
        every_s = self.scene.outputs.every_s
        return 1 if every_s is None else self.scene.steps_in("outputs.every_s", every_s)

    def instants(self, measures: Sequence[Measure]) -> np.ndarray:
        """The steps at which the measures look at a run: those of `laconic simulate --out`, or its two ends."""
        steps = self.scene.steps()
        every = steps if all(measure.is_of_end for measure in measures) else self._every()
        return np.append(np.arange(0, steps, every), steps)


def measures_in_lanes(template: Template, values: Mapping[str, np.ndarray], measures: Sequence[Measure],
                      nominal: Course | None) -> tuple[np.ndarray, np.ndarray]:
    """(measures, runs), and which runs a batch has taken to their end; the others must go alone.

    values: of each varied key that is a number of a struct, (runs,).
    """
    core, count = template.scene.core(), len(next(iter(values.values())))
    found, taken = np.full((len(measures), count), np.nan), np.zeros(count, bool)
    numbers = numbers_of(core, template.tables, template.scene, _one_by_one(template, values), count)
    ticks = template.instants(measures)
    numbers_of_lane = len(ticks) * sum(_items(template.scene, signal) for each in measures for signal in each.signals)
    most = max(1, min(MOST_LANES, MOST_NUMBERS // max(1, numbers_of_lane)))
    for first in range(0, count, most):
        lanes = slice(first, min(first + most, count))
        taken[lanes], course = _course(core, template, numbers.part(lanes), measures, ticks, nominal)
        if course is not None:
            for row, measure in enumerate(measures):
                found[row, lanes][taken[lanes]] = measure.of(course)
    return found, taken


def _one_by_one(template: Template, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """`[*]` of inputs and of their values as single keys, in the order of --vary."""
    found: dict[str, np.ndarray] = {}
    for text, column in values.items():
        key = key_path(text)
        if key.table != "input[#]":
            found[text] = column
            continue
        given = template.scene.inputs
        inputs = range(1, len(given) + 1) if key.tables[0][1] == EVERY else [key.tables[0][1] or 1]
        for number in inputs:
            items = range(1, len(given[number - 1].value) + 1) if key.item == EVERY else [key.item]
            found |= {f"input[{number}].value[{item}]": column for item in items}
    return found


def _items(scene: Scene, signal: str) -> int:
    return max(1, scene.wheel_count) if "wheel" in signal or signal == "voltage_V" else 3


def _course(core: Core, template: Template, numbers: Numbers, measures: Sequence[Measure], ticks: np.ndarray,
            nominal: Course | None) -> tuple[np.ndarray, Course | None]:
    """Which lanes came to the end, and the course of those; None where none did."""
    scene = template.scene
    kinds = Kinds.of(core, numbers.vehicles, scene.run.method, scene.run.step_s, numbers.motors)
    good = kinds.status == 0
    wanted = {signal for measure in measures for signal in measure.signals}
    contacts = None
    if wanted & set(GROUND):
        contacts, status = contacts_of(core, numbers.vehicles, numbers.motors)
        good &= status == 0
    if not good.any():
        return good, None
    numbers = numbers.part(good)
    batch = Batch.of_kinds(Kinds(core, kinds.kinds[good], kinds.status[good], kinds.wheel_count, kinds.step_s))
    refused = start_lanes(batch, starts_of(core, scene, numbers.starts, kinds.kinds[good]["model"])) != 0
    watch = Watch(core, batch, tuple(wanted), None if contacts is None else contacts[good], scene.wheel_count)
    refused |= _step(batch, HeldInputs(scene.inputs_on_grid(), numbers.inputs), ticks, watch)
    good[good] = ~refused
    if refused.all():
        return good, None
    signals = {name: np.stack(rows)[..., ~refused] for name, rows in watch.rows.items()}
    winding = _winding(scene, numbers.part(~refused))
    return good, Course(ticks * scene.run.step_s, signals, nominal, winding)


def _winding(scene: Scene, numbers: Numbers) -> Winding | None:
    if numbers.motors is None:
        return None
    return Winding(numbers.motors["resistance_ohm"].astype(float),
                   (numbers.motors["back_emf_Vs_per_rad"] * numbers.motors["gear_ratio"]).astype(float),
                   driven_wheels(scene))


def _step(batch: Batch, inputs: HeldInputs, ticks: np.ndarray, watch: Watch) -> np.ndarray:
    """Takes all steps up to the last tick, looking at each; returns which lanes were refused on the way."""
    refused, changes, last = np.zeros(batch.lane_count, bool), set(inputs.changes()), int(ticks[-1])
    looks = {int(tick) for tick in ticks}
    stops = sorted(looks | {tick for tick in changes if tick < last})
    for stop, until in zip(stops, [*stops[1:], last], strict=True):
        if stop in changes or stop == last:
            inputs.set_into(batch, stop)
        if stop in looks:
            watch.look()
        if until > stop and batch.run(until - stop):
            refused |= batch.status != 0
    return refused


class Watch:
    """Keeps some signals of all lanes at each instant."""

    def __init__(self, core: Core, batch: Batch, signals: Sequence[str], contacts: np.ndarray | None, wheels: int):
        self._batch, self._contacts, self._signals, self._wheels = batch, contacts, signals, wheels
        self._outputs = zeros(core, "laconic_outputs", batch.lane_count)
        self._inputs = core.input_fields
        self.rows: dict[str, list[np.ndarray]] = {signal: [] for signal in signals}

    def look(self) -> None:
        """Takes one row of each signal, as numbers of double precision."""
        outputs_of(self._batch, self._outputs, self._contacts)
        for signal in self._signals:
            member = self._outputs
            for name in ("input", signal) if signal in self._inputs else MEMBERS.get(signal, (signal,)):
                member = member[name]
            wide = member.ndim > 1 and member.shape[1] > 3  # one item for each wheel
            self.rows[signal].append(np.asarray(member.T[:self._wheels] if wide else member.T, float, copy=True))
