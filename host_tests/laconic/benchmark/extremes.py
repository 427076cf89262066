"""The extremes table: input at the edge of what numbers can hold gives a right number or a refusal with the reason."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.core import Core, load
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene import Scene, read_scene
from laconic.verification.reference import Reference

STEP_S, STEPS = 0.01, 100
RTOL, ATOL = 1e-12, 1e-14
METHOD_ERROR = 1e-6  # what the step may cost; rounding may cost as many digits as the condition number has

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
    Extreme("damping × 10⁶", setting(motor_damping_Nms=2e4, motor_gain_Nm_per_V=5e5)),
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
    """Every case in every scalar type, by auto."""
    base = read_scene("s1")
    rows = []
    for real in reals:
        for case in CASES:
            with np.errstate(all="ignore"):  # numbers beyond single become infinite on their way in
                rows.append({"case": case.name, "real": real} | run_case(base, case, load(real)))
            advance()
    return rows


def run_case(base: Scene, case: Extreme, core: Core) -> dict[str, Any]:
    """One case: `outcome` is right, wrong, number (not comparable), not finite or refused."""
    vehicle = copy.deepcopy(base.vehicle)
    case.change(vehicle)
    try:
        plant = core.plant(core.vehicle(vehicle), "auto", case.step_s, nu_rad_per_s=case.nu)
        plant.run({"voltage_V": [case.voltage_V] * plant.wheel_count}, STEPS)
    except Refused as refused:
        return {"outcome": "refused", "why": refused.message}
    except IndexError:
        return {"outcome": "refused", "why": f"{len(vehicle['wheel'])} wheels do not fit the structs of this build"}
    digits = math.log10(max(1.0, float(core.lib.laconic_condition_number(core.ffi.addressof(plant.c, "model")))))
    found = {"outcome": "number" if np.all(np.isfinite(plant.nu)) else "not finite", "digits_lost": round(digits, 1)}
    found |= _error(plant, vehicle, case)
    if "error" in found:
        allowed = METHOD_ERROR + 100.0 * float(np.finfo(core.dtype).eps) * 10.0**digits
        found["outcome"] = "right" if found["error"] <= allowed else "wrong"
    return found


def _error(plant: Plant, vehicle: Vehicle, case: Extreme) -> dict[str, Any]:
    """Against the numpy reference, where that has an answer; relative to the largest component of ν."""
    reference = Reference(vehicle)
    state = np.concatenate([case.nu, np.zeros(3 + len(vehicle["wheel"]))])
    values = {f"voltage_V[{i + 1}]": case.voltage_V for i in range(len(vehicle["wheel"]))}
    end = np.array([case.step_s * STEPS])
    stiffness = reference.fastest_decay_per_s() + np.max(np.abs(case.nu)) / reference.yaw_scale
    if not (1e-12 < stiffness * end[0] < 1e4 or len(vehicle["wheel"]) == 0) or end[0] < 1e-200:
        return {"why": "beyond the reference solver"}
    try:
        expected = reference.solve(state, 0.0, end, values, RTOL, ATOL)[-1, :3]
    except (RuntimeError, ValueError, OverflowError):
        return {"why": "beyond the reference solver"}
    size = float(np.max(np.abs(expected)))
    return {"error": float(np.max(np.abs(plant.nu.astype(float) - expected)) / size) if size > 0 else 0.0}
