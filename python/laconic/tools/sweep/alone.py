"""One run by itself, exactly as `laconic simulate` takes it: what lanes cannot take, and what they refuse."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from laconic.errors import BadInput
from laconic.scene import Outputs, Scene
from laconic.scene.ground import has_friction
from laconic.scene.scene_tables import SceneTables, Value
from laconic.simulation import RunRefused, Trajectory, simulate
from laconic.tools.measures import Course, Measure
from laconic.tools.measures.measure import Winding


@dataclass(frozen=True)
class Refusal:
    """Why a run has no measures; `at_s`: of a step that was refused, None where it did not begin."""

    reason: str
    at_s: float | None = None


def signals_of(measures: Sequence[Measure], scene: Scene) -> tuple[str, ...]:
    """What must be known of a run; with drives that have limits the core's own currents, too."""
    found = list(dict.fromkeys(signal for measure in measures for signal in measure.signals))
    if any(measure.needs == "motor" for measure in measures) and has_friction(scene.vehicle):
        found.append("motor_current_A")
    return tuple(found)


def course_alone(scene: Scene, measures: Sequence[Measure], nominal: Course | None = None) -> Course:
    """The run of a scene; raises as `simulate`."""
    every_s = scene.outputs.every_s
    if all(each.is_of_end for each in measures):
        if every_s is not None and scene.steps():
            scene.steps_in("outputs.every_s", every_s)  # is refused as by `laconic simulate`
        every_s = scene.run.duration_s
    signals = signals_of(measures, scene)
    run = simulate(replace(scene, outputs=Outputs(every_s=every_s)), signals, watched=False)
    return Course(run.time_s, {name: _column(run, name) for name in signals}, nominal, winding_of(scene))


def _column(run: Trajectory, name: str) -> np.ndarray:
    """(T, 1) of one number, (T, items, 1) of a list."""
    found = run.columns_of(name)[:, :, None]
    return found[:, 0] if name in run.columns else found


def winding_of(scene: Scene) -> Winding | None:
    """That of all motors; None without [vehicle.motor]."""
    motor = scene.vehicle.get("motor")
    if not motor:
        return None
    return Winding(np.array([motor["resistance_ohm"]]),
                   np.array([motor["back_emf_Vs_per_rad"] * motor["gear_ratio"]]), driven_wheels(scene))


def driven_wheels(scene: Scene) -> np.ndarray:
    """(wheels, 1): 1 where the motor's controller sets its voltage."""
    return np.array([[float(wheel["driven"] and not wheel["motor_circuit"])] for wheel in scene.vehicle["wheel"]])


def run_alone(tables: SceneTables, values: Mapping[str, Value], measures: Sequence[Measure],
              nominal: Course | None) -> list[float] | Refusal:
    """The measures of one run, or why it has none."""
    try:
        scene = tables.with_values(values).scene()
        course = course_alone(scene, measures, nominal)
    except RunRefused as refused:
        return Refusal(_without_path(refused, tables), float(refused.run.time_s[-1]))
    except BadInput as refused:
        return Refusal(_without_path(refused, tables))
    return [float(measure.of(course)[0]) for measure in measures]


def _without_path(refused: BadInput, tables: SceneTables) -> str:
    return str(refused).removeprefix(f"{tables.path}: ")
