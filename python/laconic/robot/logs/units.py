"""Units that a map may name, and what each makes of a number: SI, at the wheel."""

from __future__ import annotations

import math

TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
LENGTH = {"m": 1.0, "mm": 1e-3, "cm": 1e-2}
ANGLE = {"rad": 1.0, "deg": math.pi / 180.0, "turn": math.tau}
SPEED = {"rad/s": 1.0, "deg/s": math.pi / 180.0, "rpm": math.tau / 60.0, "turn/s": math.tau}
CURRENT = {"A": 1.0, "mA": 1e-3}
VOLTAGE = {"V": 1.0, "mV": 1e-3}
TICK = "tick"  # of an encoder: an angle once the map gives ticks_per_turn

OF_QUANTITY = {
    "time": (TIME,), "set_speed": (SPEED,), "wheel_angle": (ANGLE,), "wheel_speed": (SPEED,), "current": (CURRENT,),
    "voltage": (VOLTAGE,), "yaw_rate": (SPEED,), "pose": (LENGTH, LENGTH, ANGLE)}
"""The units of each quantity; of a pose one for each of x, y and heading."""
