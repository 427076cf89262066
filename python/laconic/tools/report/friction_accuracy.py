"""The friction step's own error, its observed order, and how it fares with extreme grounds.

No closed solution is known where wheels stick and slip, so the truth is the same step much finer: the step is of first
order, and its limit does not depend on how the contact problem of a step is solved (the tests compare that problem's
solutions with an independent solver).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from laconic.core import load
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene import Scene, read_scene
from laconic.scene.inputs import Input
from laconic.scene.scene import Initial
from laconic.tools.report.friction_cost import DRIVE, GROUND, restless

Row = dict[str, Any]

ORDER_STEPS_S = (0.02, 0.01, 0.005, 0.0025, 0.00125)
FINER = 64  # the reference's steps in the finest of these
END_S = 0.4
EXTREMES = {  # of the ground, times the usual values; and the step
    "almost no friction": ({"friction_coefficient": 1e-6}, 1.0), "glue": ({"friction_coefficient": 1e6}, 1.0),
    "free rollers": ({"roller_drag": 0.0, "axle_friction_Nm": 0.0}, 1.0),
    "rollers that never turn": ({"roller_drag": 1.0}, 1.0), "stuck axles": ({"axle_friction_Nm": 1e3}, 1.0),
    "step of 1 µs": ({}, 5e-4), "step of 0.2 s": ({}, 100.0)}
EXTREME_STEPS = 1000


def order_scenes() -> dict[str, Scene]:
    """What the order is observed on; the drive's current limit is entered and left within the run."""
    robot = read_scene("robotino2")
    ideal = robot.vehicle | {"friction_coefficient": 0.0}
    slips = ideal | {"ground": {"friction_coefficient": 0.05, "roller_drag": 0.5}}
    thrown = replace(robot.initial, nu_rad_per_s=(40.0, 15.0, 8.0))
    return {"smooth slip": made(robot, "slip", slips, ((12.0, 3.6), (-12.0, -3.6), (12.0, 3.6)),
                                thrown),
            "current limit entered and left": made(robot, "limit", ideal | {"drive": {"current_limit_A": 0.5}},
                                                   ((2.0, 7.0), (-0.8, -5.5), (-1.2, -6.0)), robot.initial)}


def made(robot: Scene, name: str, vehicle: Row, volts: Sequence[tuple[float, float]], initial: Initial) -> Scene:
    """The robot with other ground or drive, with two voltages for each wheel, one after the other."""
    inputs = tuple(Input(f"voltage_V[{i}]", "steps", f"input[{i}]", (0.0, END_S / 2), volt)
                   for i, volt in enumerate(volts, start=1))
    return replace(robot, path=robot.path.with_name(f"{name}.toml"), vehicle=vehicle, inputs=inputs,
                   initial=initial).with_run(duration_s=END_S, method="auto")


def order_rows() -> list[Row]:
    """Error of ν at the end for each step, and the slope from the step before."""
    rows: list[Row] = []
    for name, scene in order_scenes().items():
        expected = end_of(scene, ORDER_STEPS_S[-1] / FINER)
        before: float | None = None
        for step_s in ORDER_STEPS_S:
            error = float(np.max(np.abs(end_of(scene, step_s) - expected)))
            order = math.log2(before / error) if before and error else None
            rows.append({"what": name, "step_s": step_s, "error_nu": error, "order": order})
            before = error
    return rows


def end_of(scene: Scene, step_s: float) -> np.ndarray:
    """ν at the end, in double."""
    scene = scene.with_run(step_s=step_s)
    plant, inputs = scene.plant(load("double")), scene.inputs_on_grid()
    for segment in inputs.segments():
        plant.run(plant.core.input(segment.values), segment.steps)
    return plant.nu


def limits_met(scene: Scene, step_s: float) -> Iterator[tuple[int, ...]]:
    """After each step what limit each motor has reached."""
    scene = scene.with_run(step_s=step_s)
    plant, inputs = scene.plant(load("double")), scene.inputs_on_grid()
    for segment in inputs.segments():
        held = plant.core.input(segment.values)
        for _ in range(segment.steps):
            plant.run(held)
            yield tuple(plant.c.slip.limit[i] for i in range(plant.wheel_count))


def extreme_rows(reals: Sequence[str] = ("double", "single")) -> list[Row]:
    """Restless runs on extreme grounds: how many steps are refused, and whether a number is lost."""
    rows = []
    for name, (changed, factor) in EXTREMES.items():
        scene = restless(read_scene("robotino2"))
        vehicle = scene.vehicle | {"ground": GROUND | changed, "drive": DRIVE}
        scene = replace(scene, vehicle=vehicle).with_run(step_s=scene.run.step_s * factor)
        for real in reals:
            refused, plant = stepped(scene, real)
            finite = bool(np.isfinite(plant.row()).all())
            rows.append({"case": name, "real": real, "steps_taken": EXTREME_STEPS, "refused": refused,
                         "finite": finite, "speed": float(np.max(np.abs(plant.nu)))})
    return rows


def stepped(scene: Scene, real: str) -> tuple[int, Plant]:
    """The scene's voltages, each for as many steps as usual; a refused step is left out and counted."""
    plant, source, refused = scene.plant(load(real)), np.random.default_rng(11), 0
    for step in range(EXTREME_STEPS):
        if step % 10 == 0:
            volts = source.uniform(-12.0, 12.0, scene.wheel_count)
            held = plant.core.input({f"voltage_V[{i}]": float(volt) for i, volt in enumerate(volts, start=1)})
        try:
            plant.run(held)
        except Refused:
            refused += 1
    return refused, plant
