"""How the end of a run changes with the free numbers: exact, by the core's derivatives of every step.

A change of a number is carried through the run by laconic_step_tangent, step after step, as a change of the state. Only
how the vehicle's own numbers, its start and its inputs follow from those of the file is differentiated by differences:
they are sums, products and angles, which differences of second order give to ten digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.core.plant import Plant
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.ground import has_friction
from laconic.scene.inputs import Segment
from laconic.scene.key_path import key_path
from laconic.tools.measures.measure import Measure
from laconic.tools.measures.prepared import records
from laconic.tools.optimise.candidates import Candidates

PLACE = {"end_x_m": 0, "end_y_m": 1, "end_heading_rad": 2}  # rows of an end's gradient
OF_PLACE = "end_distance_m"
EXACT = (*PLACE, OF_PLACE)
STEP = 1e-5   # of a range, for what follows from the file


def knows(measure: Measure, scene: Scene) -> bool:
    """Whether a measure's gradient is had exactly: of an end, on ideal ground, with inputs held over each step."""
    return (measure.name in EXACT and scene.run.real == "double" and not has_friction(scene.vehicle)
            and scene.inputs_on_grid().is_held)


class RunGradient:
    """Gradients of measures by the free numbers."""

    def __init__(self, candidates: Candidates, measures: Sequence[Measure]):
        self.candidates, self.measures = candidates, measures
        self.carried = [number for number, each in enumerate(candidates.free) if all(map(_is_carried, each.keys))]
        self.known = [bool(self.carried) and knows(measure, candidates.base) for measure in measures]

    def jacobian(self, choice: np.ndarray) -> np.ndarray:
        """(M, p) at a choice (p,); NaN where it is not known exactly, also where the run is refused."""
        found = np.full((len(self.measures), len(choice)), np.nan)
        if not any(self.known):
            return found
        try:
            end_m, by_choice = self._end(choice)
        except BadInput:
            return found
        for row, (measure, is_known) in enumerate(zip(self.measures, self.known, strict=True)):
            if is_known and measure.name in PLACE:
                found[row, self.carried] = by_choice[PLACE[measure.name]]
            elif is_known:
                away = end_m - _place_of(measure)
                size = float(np.hypot(*away))
                found[row, self.carried] = away @ by_choice[:2] / size if size > 0.0 else np.nan
        return found

    def _end(self, choice: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Place (x, y) at the end, and the derivatives of place and heading there by what is carried, (3, …)."""
        scene = self.candidates.scene(choice)
        plant = scene.plant(scene.core())
        variations = [_variation(self.candidates, plant, choice, number) for number in self.carried]
        for number, segment in enumerate(scene.inputs_on_grid().segments()):
            held = plant.core.input(segment.values, plant.wheel_count)
            for variation in variations:
                variation.hold(number)
            for _ in range(segment.steps):
                for variation in variations:
                    variation.carry(plant, held)
                plant.run(held)
        ends = [each.state for each in variations]
        by_choice = np.array([[end.x_m, end.y_m, end.heading_rad] for end in ends]).T
        return np.array([plant.pose.x_m, plant.pose.y_m]), by_choice


def _is_carried(key: str) -> bool:
    """Whether a number acts by vehicle, start or level of an input alone, not by the steps or instants of inputs."""
    found = key_path(key)
    if found.table == "input[#]":
        return found.name == "value"
    return found.table == "ground" or found.table.split(".")[0] in ("vehicle", "initial")


def _place_of(measure: Measure) -> np.ndarray:
    """(x, y) that the measure has as arguments."""
    given = measure.of.keywords if isinstance(measure.of, partial) else {}
    return np.array([given.get("x_m", 0.0), given.get("y_m", 0.0)])


@dataclass
class Variation:
    """What a free number changes: the model, the inputs of each segment, and the state up to now."""

    core: Core
    model: Any         # laconic_model_change
    inputs: list[Any]  # laconic_input of each segment
    state: Any         # laconic_state_change
    held: Any = None

    def hold(self, segment: int) -> None:
        """The change of the inputs from here on."""
        self.held = self.inputs[segment]

    def carry(self, plant: Plant, held: Any) -> None:
        """Through the step that the plant takes next."""
        at, after = self.core.ffi.addressof, self.core.ffi.new("laconic_state_change *")
        c = plant.c
        status = self.core.lib.laconic_step_tangent(after, at(c, "model"), at(c, "integrator"), at(c, "state"), held,
                                                    self.state, self.held, self.model)
        if status != self.core.lib.LACONIC_OK:
            raise BadInput("the step is refused")
        self.state = after


def _variation(candidates: Candidates, plant: Plant, choice: np.ndarray, number: int) -> Variation:
    """How everything follows from one free number, by differences of second order around the choice."""
    core, free = plant.core, candidates.free[number]
    step = STEP * (free.high - free.low)
    scenes = []
    for sign in (-1.0, 1.0):
        beside = choice.copy()
        beside[number] += sign * step
        scenes.append(candidates.scene(beside))
    vehicles = [scene.c_vehicle(core) for scene in scenes]
    by_vehicle, model = core.ffi.new("laconic_vehicle *"), core.ffi.new("laconic_model_change *")
    change = _difference(records(core, "laconic_vehicle", core.ffi.new("laconic_vehicle[2]", [v[0] for v in vehicles])),
                         2.0 * step)
    core.ffi.memmove(by_vehicle, change.tobytes(), core.ffi.sizeof("laconic_vehicle"))
    at = core.ffi.addressof
    core.lib.laconic_model_tangent(model, at(plant.c, "model"), at(plant.c, "vehicle"), by_vehicle)
    segments = [list(scene.inputs_on_grid().segments()) for scene in scenes]
    inputs = [_input_change(core, plant.wheel_count, low, high, 2.0 * step)
              for low, high in zip(*segments, strict=True)]
    starts = [_start(scene.plant(core)) for scene in scenes]
    state = core.ffi.new("laconic_state_change *")
    row = ((starts[1] - starts[0]) / (2.0 * step)).tolist()
    state.nu_rad_per_s, state.x_m, state.y_m, state.heading_rad = row[:3], row[3], row[4], row[5]
    return Variation(core, model, inputs, state)


def _start(plant: Plant) -> np.ndarray:
    """ν, x, y and heading."""
    return np.array([*plant.nu, plant.pose.x_m, plant.pose.y_m, plant.pose.heading_rad])


def _input_change(core: Core, wheels: int, low: Segment, high: Segment, width: float) -> Any:
    rows = [core.input_row(segment.values, wheels) for segment in (low, high)]
    return core.input((rows[1] - rows[0]) / width)


def _difference(pair: np.ndarray, width: float) -> np.ndarray:
    """One record of the floats' differences of two over `width`; what is no float stays 0."""
    found = np.zeros(1, pair.dtype)
    _fill(found, pair, width)
    return found


def _fill(found: np.ndarray, pair: np.ndarray, width: float) -> None:
    """Members and members of members, each (1, …) from (2, …)."""
    for name in pair.dtype.names or ():
        if pair[name].dtype.names:
            _fill(found[name], pair[name], width)
        elif pair[name].dtype.kind == "f":
            found[name] = (pair[name][1:2] - pair[name][0:1]) / width
