"""A made-up vehicle as a scene file, which `laconic simulate` and `laconic verify --enclose` run again."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.population.made import END_S, INSTANTS, TICK_S, Made
from laconic.population.truth import named
from laconic.scene.scene_text import lines_of

MOTOR = ("motor_gain_Nm_per_V", "motor_damping_Nms")


def scene_text(vehicle: Made, start_nu: np.ndarray, method: str, step_s: float) -> str:
    """The same vehicle, start, inputs and step; every number with all its digits."""
    table = {key: value for key, value in vehicle.trial.table.items() if key != "ground"}
    table["wheel"] = [wheel_of(each) for each in table["wheel"]]
    entries: dict[str, Any] = {
        "name": f"vehicle {vehicle.number} of a population, {vehicle.trial.kind}",
        "source": f"made up; its damping is {vehicle.factor:.3g} times the usual", "vehicle": table}
    if "ground" in vehicle.trial.table:
        entries["ground"] = vehicle.trial.table["ground"]
    entries["initial"] = {"nu_rad_per_s": [float(x) for x in start_nu], "heading_rad": vehicle.trial.heading_rad}
    entries["input"] = inputs_of(vehicle)
    entries["run"] = {"duration_s": END_S, "step_s": step_s, "method": method}
    return "\n".join(lines_of(entries, {})) + "\n"


def wheel_of(wheel: dict[str, Any]) -> dict[str, Any]:
    """A wheel without the motor that nothing turns."""
    return {key: value for key, value in wheel.items() if wheel.get("driven", True) or key not in MOTOR}


def inputs_of(vehicle: Made) -> list[dict[str, Any]]:
    """Each signal with its value before and after the change; those without an effect are left out."""
    first, second = (named(held) for held in vehicle.helds)
    wheels = list(enumerate(vehicle.trial.table["wheel"], start=1))
    idle = {f"voltage_V[{i}]" for i, wheel in wheels if wheel.get("locked") or not wheel.get("driven", True)}
    idle |= {f"axle_torque_Nm[{i}]" for i, wheel in wheels if wheel.get("locked")}
    if not any(value for held in vehicle.helds for value in held["world_force_N"]):
        idle |= {"world_force_point_m[1]", "world_force_point_m[2]"}
    change_s = float(INSTANTS[0][-1] * TICK_S[vehicle.real])
    return [{"signal": signal, "kind": "steps", "t_s": [0.0, change_s], "value": [value, second[signal]]}
            for signal, value in first.items() if signal not in idle and (value or second[signal])]
