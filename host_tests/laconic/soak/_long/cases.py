"""The vehicles of the long run: each with its inputs, its start and its motion in closed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import mp, mpf

from laconic.benchmark.drift import free
from laconic.benchmark.stability import strengthened
from laconic.scene import Scene, read_scene
from laconic.soak._long.closed_form import Held, Motion, periodic_motion, steady_motion
from laconic.verification.derivatives.exact_model import ExactModel, exact_model, numbers_of
from laconic.verification.derivatives.trials import INPUTS

PLACE, HEADING_RAD = complex(100.0, -50.0), 2.0  # of the start


@dataclass(frozen=True)
class Case:
    """A named motion: of a scene's vehicle with its motors or without; `nu`: about what it holds, in rad/s."""

    name: str
    scene: str
    nu: tuple[float, float, float]
    driven: bool = True
    steady: bool = True
    strength: float = 1.0  # of the motors: damping and gain times this


CASES = (  # the free line is that of a vehicle whose centre of mass is in its middle: else it is unstable one way
    Case("rest", "s1", (0.0, 0.0, 0.0)),
    Case("straight line, free", "kuka_youbot", (5.0, -20.0, 0.0), driven=False),
    Case("straight line, driven", "kuka_youbot", (8.0, 3.0, 0.0)),
    Case("spin, free", "s1", (0.0, 0.0, 2.0), driven=False),
    Case("circle, three wheels", "s1", (3.0, 1.0, 1.5)),
    Case("circle, four wheels", "kuka_youbot", (6.0, -2.0, 3.0)),
    Case("circle, damping × 1000", "kuka_youbot", (6.0, -2.0, 3.0), strength=1e3),
    Case("free motion with petals", "paper_three_wheel_free", (0.0, 6.0, 1.0), driven=False, steady=False))


@dataclass(frozen=True)
class Prepared:
    """A case with numbers as the core takes them: doubles, or singles."""

    case: Case
    table: dict[str, Any]
    held: Held
    nu: list[float]
    motion: Motion


def prepared(case: Case, number: Callable[[float], float]) -> Prepared:
    """`number` rounds to the core's scalar type."""
    scene = read_scene(case.scene)
    scene = strengthened(scene, case.strength, (), scene.run.duration_s) if case.driven else free(scene)
    table = rounded({key: value for key, value in scene.vehicle.items() if key != "support"}, number)
    model = exact_model(numbers_of(table))
    held = {name: [0.0] * (len(table["wheel"]) if name in ("voltage_V", "axle_torque_Nm") else 2) for name in INPUTS}
    held["body_moment_Nm"] = [0.0]
    near = allowed(model, case)
    if case.driven:
        held["voltage_V"] = [number(x) for x in voltages(model, scene, near)]
    place, heading = complex(number(PLACE.real), number(PLACE.imag)), number(HEADING_RAD)
    if not case.steady:
        nu = [number(float(x)) for x in near]
        return Prepared(case, table, held, nu, periodic_motion(model, held, nu, place, heading))
    if not case.driven:
        near = [number(float(x)) for x in near]
    motion = steady_motion(model, held, near, place, heading)
    return Prepared(case, table, held, [number(float(x)) for x in motion.nu], motion)


def rounded(value: Any, number: Callable[[float], float]) -> Any:
    """A table with its numbers in the core's scalar type."""
    if isinstance(value, dict):
        return {key: rounded(each, number) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(each, number) for each in value]
    return number(value) if isinstance(value, float) else value


def allowed(model: ExactModel, case: Case) -> list[Any]:
    """The case's ν as far as the constraints allow it; for a free spin the multiple of w that turns as fast."""
    if case.steady and not case.driven and case.nu[2]:
        along = model.nu(model.gyro)
        return [x * mpf(case.nu[2]) / along[2] for x in along]
    return model.nu(model.zeta([mpf(x) for x in case.nu]))


def voltages(model: ExactModel, scene: Scene, nu: list[Any]) -> np.ndarray:
    """Those that balance the motors' damping at this ν."""
    zeta = model.zeta(nu)
    speeds = np.array([float(sum(x * y for x, y in zip(row, zeta, strict=True))) for row in model.wheel_rows])
    damping = scene.vehicle["motor_damping_Nms"] / scene.vehicle["motor_gain_Nm_per_V"]
    return speeds * damping


def digits() -> Any:
    """Within which all of this is computed."""
    return mp.workdps(60)
