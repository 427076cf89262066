"""Made-up vehicles, states and inputs for derivatives of a step, and the core's answers beside 50-digit differences.

All kinds of vehicle: rollers, fixed wheels on one axle line, a single fixed wheel, a locked wheel, no wheels, wheels of
their own, without motors; with slow and stiff damping, a payload, a slope, forces fixed in the world.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import mp, mpf

from laconic.core.binding import Core
from laconic.core.derivatives import StepDerivatives
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene.methods import ROWS
from laconic.tools.verify.exact.exact_gauss import panels_of
from laconic.tools.verify.exact.exact_model import Numbers, Vector, exact_model, numbers_of
from laconic.tools.verify.exact.exact_steps import REIMPLEMENTED, exact_step

METHODS = REIMPLEMENTED
FOR_SLOW_DAMPING = {row.name for row in ROWS if row.takes == "SLOW_DAMPING"}
KINDS = ("omni", "mecanum", "drive", "single", "locked", "bare", "own", "mixed")
DIGITS = 50
INCREMENT = mpf("1e-18")
GROUPS = {"nu": slice(0, 3), "position": slice(3, 5), "heading": slice(5, 6), "wheels": slice(6, None)}
INPUTS = ("voltage_V", "axle_torque_Nm", "body_force_N", "body_moment_Nm", "world_force_N", "world_force_point_m")


@dataclass(frozen=True)
class Trial:
    """One step of one vehicle."""

    kind: str
    method: str
    table: dict[str, Any]
    step_s: float
    nu: list[float]
    heading_rad: float
    held: dict[str, list[float]]


def _wheel(random: np.random.Generator, kind: str, **values: float) -> dict[str, Any]:
    return {"kind": kind, "x_m": float(random.uniform(-0.4, 0.4)), "y_m": float(random.uniform(-0.4, 0.4)),
            "axle_rad": float(random.uniform(-3, 3)), "roller_rad": float(random.uniform(0.5, 2.6)), **values}


def _wheels(random: np.random.Generator, kind: str) -> list[dict[str, Any]]:
    rollers = {"omni": 3, "mecanum": 4, "locked": 3, "bare": 0, "own": 4, "mixed": 2}.get(kind, 0)
    wheels = [_wheel(random, "roller") for _ in range(rollers)]
    if kind in ("drive", "mixed"):
        line, track = float(random.uniform(-0.2, 0.2)), float(random.uniform(0.2, 0.5))
        for side in ((track, -track / 2) if kind == "drive" else (track,)):
            wheels.append({"kind": "fixed", "x_m": line, "y_m": side, "axle_rad": -np.pi / 2})
    if kind == "single":
        wheels.append(_wheel(random, "fixed"))
        wheels[-1].pop("roller_rad")
    if kind == "locked":
        wheels[0]["locked"] = True
    for wheel in wheels if kind in ("own", "drive") and random.random() < 0.7 else ():
        wheel |= {"radius_m": float(random.uniform(0.04, 0.08)), "inertia_kgm2": float(random.uniform(0.001, 0.01)),
                  "motor_gain_Nm_per_V": float(random.uniform(0.1, 0.9)),
                  "motor_damping_Nms": float(10 ** random.uniform(-3, -1))}
    if kind == "own":
        wheels[1]["driven"] = False
    return wheels


def _table(random: np.random.Generator, kind: str, stiff: float) -> dict[str, Any]:
    radius = float(random.uniform(0.03, 0.1))
    table: dict[str, Any] = {
        "mass_kg": float(random.uniform(2, 30)), "yaw_inertia_kgm2": float(random.uniform(0.05, 1.0)),
        "com_x_m": float(random.uniform(-0.1, 0.1)), "com_y_m": float(random.uniform(-0.1, 0.1)),
        "wheel_radius_m": radius, "wheel_inertia_kgm2": float(10 ** random.uniform(-4, -2)),
        "motor_gain_Nm_per_V": float(random.uniform(0.1, 1.0)), "motor_damping_Nms": stiff,
        "wheel": _wheels(random, kind)}
    if random.random() < 0.4:
        table["payload"] = {"mass_kg": float(random.uniform(0.1, 5)), "x_m": float(random.uniform(-0.2, 0.2)),
                            "y_m": float(random.uniform(-0.2, 0.2)), "yaw_inertia_kgm2": float(random.uniform(0, 0.1))}
    if random.random() < 0.25:
        table["ground"] = {"slope_rad": float(random.uniform(0.05, 0.3)),
                           "slope_heading_rad": float(random.uniform(-3, 3))}
    return table


def held_inputs(random: np.random.Generator, wheels: int, world: bool) -> dict[str, list[float]]:
    """Random inputs of so many wheels, with a force fixed in the world or without."""
    held = {"voltage_V": random.normal(0, 6, wheels), "axle_torque_Nm": random.normal(0, 0.2, wheels),
            "body_force_N": random.normal(0, 4, 2), "body_moment_Nm": random.normal(0, 1, 1),
            "world_force_N": random.normal(0, 5, 2) * world, "world_force_point_m": random.normal(0, 0.2, 2)}
    return {name: values.tolist() for name, values in held.items()}


def made_up(random: np.random.Generator, kind: str, method: str) -> Trial:
    """A trial of this kind; explicit methods get damping that they can take."""
    slowest, fastest = (-3.0, -1.5) if method in FOR_SLOW_DAMPING else (-3.0, 1.0)
    table = _table(random, kind, float(10 ** random.uniform(slowest, fastest)))
    speed = float(10 ** random.uniform(0, 1.5))
    return Trial(kind, method, table, float(10 ** random.uniform(-3, -0.3)),
                 random.normal(0, speed, 3).tolist(), float(random.uniform(-3, 3)),
                 held_inputs(random, len(table["wheel"]), bool(random.random() < 0.4)))


def plant_of(core: Core, trial: Trial) -> Plant:
    """The core's plant, its velocity projected onto what the constraints allow."""
    vehicle = core.vehicle(trial.table)
    plant = core.plant(vehicle, trial.method, trial.step_s, heading_rad=trial.heading_rad)
    start = core.ffi.new("laconic_start *", {"nu_rad_per_s": trial.nu, "heading_rad": trial.heading_rad})
    why = core.why()
    model, state = core.ffi.addressof(plant.c, "model"), core.ffi.addressof(plant.c, "state")
    core.check(core.lib.laconic_state_project(state, model, start, why), why)
    return plant


def trials(core: Core, methods: tuple[str, ...] = METHODS, seed: int = 1) -> Iterator[tuple[Trial, Plant]]:
    """Trials without end whose steps the core takes: kinds and methods in turn."""
    random, count = np.random.default_rng(seed), 0
    while True:
        trial = made_up(random, KINDS[count % len(KINDS)], methods[count // len(KINDS) % len(methods)])
        try:
            plant = plant_of(core, trial)
            StepDerivatives(plant, trial.held).jacobian()
        except Refused:
            continue
        count += 1
        yield trial, plant


# --------------------------------------------------------------------------- differences of the map


def _state(trial: Trial, plant: Plant) -> Vector:
    return [*(mpf(float(x)) for x in plant.nu), mpf(0), mpf(0), mpf(trial.heading_rad),
            *([mpf(0)] * plant.wheel_count)]


def _moved(values: Numbers, along: dict[str, float], by: Any) -> Numbers:
    return values | {name: values.get(name, mpf(0)) + by * mpf(change) for name, change in along.items()}


@dataclass(frozen=True)
class Direction:
    """What changes: state, inputs and numbers of the vehicle."""

    state: list[float]
    held: dict[str, list[float]]
    vehicle: dict[str, float]


def difference(trial: Trial, plant: Plant, along: Direction) -> np.ndarray:
    """The change of the state after the step along a direction, from two exact steps."""
    with mp.workdps(DIGITS):
        numbers, state = numbers_of(trial.table), _state(trial, plant)
        stiff, panels, found = bool(plant.c.integrator.stiff), panels_of(plant.c.integrator), []
        same = exact_model(numbers) if not along.vehicle else None
        for by in (INCREMENT, -INCREMENT):
            model = same or exact_model(_moved(numbers, along.vehicle, by))
            held = {name: [mpf(x) + by * mpf(d) for x, d in zip(trial.held[name], along.held[name], strict=True)]
                    for name in INPUTS}
            at = [x + by * mpf(d) for x, d in zip(state, along.state, strict=True)]
            found.append(exact_step(model, plant.chosen_method, mpf(plant.step_s), at, held, stiff, panels))
        return np.array([float((a - b) / (2 * INCREMENT)) for a, b in zip(*found, strict=True)])


# ------------------------------------------------------------------------------------- directions


def _shared(name: str, kind: str) -> bool:
    """Numbers that wheels on one axle line share: varied alone they would prevent all motion."""
    return kind == "drive" and name.startswith("wheel[") and name.rpartition(".")[2] in ("x_m", "axle_rad")


def directions(random: np.random.Generator, trial: Trial, plant: Plant) -> dict[str, Direction]:
    """One direction of the state, one of the inputs and one of the vehicle, of all of their numbers."""
    wheels = plant.wheel_count
    still_held = {name: [0.0] * len(trial.held[name]) for name in INPUTS}
    still = [0.0] * (6 + wheels)
    numbers = [name for name, value in numbers_of(trial.table).items()
               if isinstance(value, mpf) and not _shared(name, trial.kind) and not
               (name.endswith("motor_gain_Nm_per_V") or name.endswith("damping_Nms")) * ("wheel[" in name)
               * (trial.kind == "own" and name.startswith("wheel[2]"))]
    values = numbers_of(trial.table)
    scaled = {name: float(values[name]) * float(random.normal()) for name in numbers}
    return {"state": Direction(random.normal(size=6 + wheels).tolist(), still_held, {}),
            "input": Direction(still, {k: random.normal(size=len(v)).tolist() for k, v in still_held.items()}, {}),
            "vehicle": Direction(still, still_held, scaled)}


def tangent(trial: Trial, plant: Plant, along: Direction) -> np.ndarray:
    """The core's answer."""
    step = StepDerivatives(plant, trial.held)
    return step.tangent(along.state, along.held, along.vehicle or None)


def by_each(trial: Trial, plant: Plant, along: Direction) -> np.ndarray:
    """The sum of magnitudes of what each number of the vehicle does by itself, along a direction that varies them all.

    Their effects may cancel in a kind that is one number, as the heading is; a result whose error is small beside this
    is exact for effects of each that are changed by as little.
    """
    parts = [Direction(along.state, along.held, {name: change}) for name, change in along.vehicle.items()]
    return sum((np.abs(tangent(trial, plant, part)) for part in parts), np.zeros(len(along.state)))


def error(found: np.ndarray, expected: np.ndarray, along: Direction, each: np.ndarray | None = None) -> float:
    """The largest error of velocity, position, heading and wheel angles, each relative to the largest change of its
    kind before and after the step; for a direction of the vehicle also in `each`, what by_each() gives."""
    worst = 0.0
    before = np.abs(np.array(along.state))
    sizes = np.maximum(before, np.abs(expected) if each is None else np.maximum(each, np.abs(expected)))
    for rows in GROUPS.values():
        if len(expected[rows]):
            size = sizes[rows].max()
            worst = max(worst, float(np.abs(found[rows] - expected[rows]).max() / size) if size else 0.0)
    return worst
