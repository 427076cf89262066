"""`[speed_controller]`: what turns set speeds of the wheels into currents on the recorded robot.

Only `laconic replay --inputs set-speeds` runs it; a simulation has voltages and torques as inputs.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from laconic.scene.keys import read_number
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
    numbers = {field.name: read_number(table, field.name) for field in fields(SpeedController)}
    table.done()
    return SpeedController(**numbers)
