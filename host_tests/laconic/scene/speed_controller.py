"""`[speed_controller]`: what turns set speeds of the wheels into currents on the recorded robot.

Only `laconic replay --inputs set-speeds` runs it; a simulation has voltages and torques as inputs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from laconic.scene.table import Table


@dataclass(frozen=True)
class SpeedController:
    """Current of a motor: P (set − s) + I ∫(set − s) dt, speeds at the wheel; of all motors alike."""

    gain_As_per_rad: float                  # P
    integral_gain_A_per_rad: float = 0.0    # I
    dead_time_s: float = 0.0                # from the set speed to the current


def read_speed_controller(top: Table, vehicle: dict[str, Any]) -> SpeedController | None:
    """None where the scene has none."""
    if not top.has("speed_controller"):
        return None
    table = top.table("speed_controller")
    if not vehicle.get("motor"):
        top.fail("speed_controller", "gives currents, which need [vehicle.motor]; give it, or take "
                 "[speed_controller] out")
    gain = table.number("gain_As_per_rad")
    rest = {key: table.number(key, 0.0) for key in ("integral_gain_A_per_rad", "dead_time_s")}
    table.done()
    if not gain > 0.0:
        table.fail("gain_As_per_rad", f"is {gain:g}; give a value above 0")
    for key, value in rest.items():
        if not value >= 0.0:
            table.fail(key, f"is {value:g}; give a value of 0 or more")
    return SpeedController(gain, **rest)
