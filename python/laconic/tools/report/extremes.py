"""The extremes table: input at the edge of what numbers can hold gives a right number or a refusal with the reason."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from laconic.core import Core, load
from laconic.core.plant import Plant
from laconic.errors import LaconicError, Refused
from laconic.scene import Scene, read_scene
from laconic.scene.methods import STIFF_8
from laconic.tools.report.referenced import exact_states

STEP_S, STEPS, LONG_STEPS = 0.01, 100, 10
METHODS = ("auto", STIFF_8)
LARGEST_ANGLE_RAD = 1e4  # of yaw in the run, up to which the motion is followed in 50 digits
METHOD_ERROR = 1e-6  # what the step may cost; rounding may cost as many digits as the condition number has
COARSE = 0.5  # from there on no digit is right

Vehicle = dict[str, Any]
Change = Callable[[Vehicle], None]


@dataclass(frozen=True)
class Extreme:
    """A named case: what is changed in the vehicle, its voltages and start."""

    name: str
    change: Change = lambda vehicle: None
    voltage_V: float = 2.0
    nu: tuple[float, float, float] = (0.5, -0.3, 1.0)
    step_s: float = STEP_S
    steps: int = STEPS


def with_wheels(count: int, spread_m: float = 0.2) -> Change:
    """So many omni wheels in a circle."""
    def change(vehicle: Vehicle) -> None:
        angles = [2.0 * math.pi * k / max(count, 1) + 0.1 for k in range(count)]
        vehicle["wheel"] = [{"kind": "omni", "x_m": spread_m * math.cos(a), "y_m": spread_m * math.sin(a),
                             "axle_rad": a, "roller_rad": math.pi / 2} for a in angles]
    return change


def roller(angle_rad: float) -> Change:
    """All rollers at this angle from the axle."""
    def change(vehicle: Vehicle) -> None:
        for wheel in vehicle["wheel"]:
            wheel["roller_rad"] = angle_rad
    return change


def setting(**values: float) -> Change:
    """Some numbers of the vehicle replaced."""
    return lambda vehicle: vehicle.update(values)


def scaled(name: str, factor: float) -> Change:
    """Λ² or λ² (as the inertia) times a factor squared."""
    def change(vehicle: Vehicle) -> None:
        vehicle[name] = vehicle["mass_kg"] * vehicle["wheel_radius_m"] ** 2 * factor**2
    return change


def far_wheels(vehicle: Vehicle) -> None:
    """Wheels a million radii away."""
    for wheel in vehicle["wheel"]:
        wheel["x_m"] *= 1e6 * vehicle["wheel_radius_m"] / 0.05
        wheel["y_m"] *= 1e6 * vehicle["wheel_radius_m"] / 0.05


def far_apart(vehicle: Vehicle) -> None:
    """One wheel's motor 10⁹ times as strong as the others': so far apart are the fastest and the slowest damping."""
    for wheel, factor in zip(vehicle["wheel"], (4e9, 1.0, 1.0), strict=True):
        wheel |= {"motor_gain_Nm_per_V": 0.5 * factor, "motor_damping_Nms": 0.02 * factor}


def stiff(vehicle: Vehicle) -> None:
    """All motors a million times as strong."""
    vehicle |= {"motor_damping_Nms": 2e4, "motor_gain_Nm_per_V": 5e5}


def mixed_sixteen(vehicle: Vehicle) -> None:
    """Fourteen wheels with rollers at all angles, two fixed ones on a line with the centre of mass; each of its own
    radius, inertia and motor, two without a motor."""
    with_wheels(14, 0.3)(vehicle)
    vehicle["wheel"] += [{"kind": "fixed", "x_m": 0.0, "y_m": y, "axle_rad": -math.pi / 2} for y in (0.25, -0.25)]
    for k, wheel in enumerate(vehicle["wheel"]):
        wheel |= {"radius_m": 0.03 + 0.005 * k, "inertia_kgm2": 0.001 * (k + 1), "driven": k not in (3, 8),
                  "motor_gain_Nm_per_V": 0.1 + 0.05 * k, "motor_damping_Nms": 0.002 * (k + 1)}
        if wheel["kind"] != "fixed":
            wheel |= {"kind": "roller", "roller_rad": 0.5 + 0.15 * k}


def parallel(vehicle: Vehicle) -> None:
    """All wheels alike: ΞᵀΞ has rank 1."""
    vehicle["wheel"] = [dict(vehicle["wheel"][0]) for _ in range(3)]


CASES = (
    *(Extreme(f"γ = {g:g} rad", roller(g)) for g in (1e-1, 1e-2, 1e-3, 1e-4, 1e-7, 0.0)),
    # ν3 = Λ θ': the same turning for every Λ, so that the step stays a fair one
    *(Extreme(f"Λ = {f:g}", scaled("yaw_inertia_kgm2", f), nu=(0.5, -0.3, min(1.0, f)))
      for f in (1e-6, 1e-3, 1e3, 1e6)),
    *(Extreme(f"λ = {f:g}", scaled("wheel_inertia_kgm2", f)) for f in (1e-6, 1e-3, 1e3, 1e6)),
    Extreme("no wheels (N = 0)", with_wheels(0)),
    Extreme("one wheel (rank 1)", with_wheels(1)),
    Extreme("two wheels (rank 2)", with_wheels(2)),
    Extreme("three equal wheels (rank 1)", parallel),
    Extreme("as many wheels as the build has room for", with_wheels(16)),
    Extreme("one wheel too many", with_wheels(17)),
    Extreme("wheels 10⁶ R away", far_wheels),
    Extreme("c2 = 0", setting(motor_damping_Nms=0.0)),
    Extreme("damping × 10⁶", stiff),
    Extreme("fast to slow damping 10⁹", far_apart),
    Extreme("16 mixed wheels", mixed_sixteen, nu=(0.5, 0.0, 1.0)),
    Extreme("16 mixed wheels, step 1 s", mixed_sixteen, nu=(0.5, 0.0, 1.0), step_s=1.0, steps=LONG_STEPS),
    Extreme("step 1 s", step_s=1.0, steps=LONG_STEPS),
    Extreme("step 1 s, damping × 10⁶", stiff, step_s=1.0, steps=LONG_STEPS),
    Extreme("step 1 s, fast to slow damping 10⁹", far_apart, step_s=1.0, steps=LONG_STEPS),
    Extreme("step 1 s, no damping", setting(motor_damping_Nms=0.0), voltage_V=0.0, step_s=1.0, steps=LONG_STEPS),
    Extreme("voltage 1e30 V", voltage_V=1e30),
    Extreme("voltage 1e300 V", voltage_V=1e300),
    Extreme("voltage infinite", voltage_V=math.inf),
    Extreme("voltage not a number", voltage_V=math.nan),
    Extreme("voltage subnormal", voltage_V=1e-310),
    Extreme("start at 1e15 rad/s", nu=(1e15, 0.0, 1e15)),
    Extreme("mass subnormal", setting(mass_kg=1e-310)),
    Extreme("mass 0", setting(mass_kg=0.0)),
    Extreme("mass infinite", setting(mass_kg=math.inf)),
    Extreme("radius not a number", setting(wheel_radius_m=math.nan)),
    Extreme("step 0", step_s=0.0),
    Extreme("step negative", step_s=-0.01),
    Extreme("step infinite", step_s=math.inf),
    Extreme("step 1e-300 s", step_s=1e-300),
    Extreme("step 1000 s", step_s=1e3),
)


def extreme_rows(reals: tuple[str, ...], advance: Any = lambda: None) -> list[dict[str, Any]]:
    """Every case in every scalar type, by auto and by the method of order 8."""
    base = read_scene("s1")
    rows = []
    for real in reals:
        for case in CASES:
            with np.errstate(all="ignore"):  # numbers beyond single become infinite on their way in
                rows += [{"case": case.name, "real": real, "method": method} | run_case(base, case, load(real), method)
                         for method in METHODS]
            advance()
    return rows


def run_case(base: Scene, case: Extreme, core: Core, method: str = "auto") -> dict[str, Any]:
    """One case: `outcome` is right, coarse (some digits: the step is long), wrong (none), number (not comparable), not
    finite or refused."""
    vehicle = copy.deepcopy(base.vehicle)
    case.change(vehicle)
    try:
        plant = core.plant(core.vehicle(vehicle), method, case.step_s, nu_rad_per_s=case.nu)
        plant.run({"voltage_V": [case.voltage_V] * plant.wheel_count}, case.steps)
    except Refused as refused:
        return {"outcome": "refused", "why": refused.message}
    except IndexError:
        return {"outcome": "refused", "why": f"{len(vehicle['wheel'])} wheels do not fit the structs of this build"}
    digits = math.log10(max(1.0, float(core.lib.laconic_condition_number(core.ffi.addressof(plant.c, "model")))))
    found = {"outcome": "number" if np.all(np.isfinite(plant.nu)) else "not finite", "digits_lost": round(digits, 1)}
    off = _error(plant, case)
    if (error := off.get("error")) is not None:
        allowed = METHOD_ERROR + 100.0 * float(np.finfo(core.dtype).eps) * 10.0**digits
        found["outcome"] = "right" if error <= allowed else "coarse" if error < COARSE else "wrong"
    return found | off


def _error(plant: Plant, case: Extreme) -> dict[str, Any]:
    """Against the motion in 50 digits, where it can be followed; relative to the largest component of ν."""
    speed = float(np.max(np.abs(case.nu))) * max(1.0, abs(case.voltage_V))
    if not plant.step_s * case.steps * speed < LARGEST_ANGLE_RAD:
        return {"why": "too far to be followed in 50 digits"}
    try:
        expected = end_of(case.name)
    except (LaconicError, ValueError, ZeroDivisionError, OverflowError):
        return {"why": "too far to be followed in 50 digits"}
    size = float(np.max(np.abs(expected)))
    return {"error": float(np.max(np.abs(plant.nu.astype(float) - expected)) / size) if size > 0 else 0.0}


@lru_cache(maxsize=2 * len(CASES))
def end_of(name: str) -> np.ndarray:
    """ν at the end, of the case of this name."""
    case = next(each for each in CASES if each.name == name)
    vehicle = copy.deepcopy(read_scene("s1").vehicle)
    case.change(vehicle)
    volts = [case.voltage_V] * len(vehicle["wheel"])
    return exact_states(vehicle, case.nu, [volts], [[case.steps * Fraction(case.step_s)]])[0, :3]
