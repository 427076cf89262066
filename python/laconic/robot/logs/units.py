"""Units that a map may name, and what each makes of a number: SI, at the wheel."""

from __future__ import annotations

import math

ISO = "iso"    # a date and a time of day as text
TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}
LENGTH = {"m": 1.0, "mm": 1e-3, "cm": 1e-2}
ANGLE = {"rad": 1.0, "deg": math.pi / 180.0, "turn": math.tau}
SPEED = {"rad/s": 1.0, "deg/s": math.pi / 180.0, "rpm": math.tau / 60.0, "turn/s": math.tau, "rad/min": 1.0 / 60.0,
         "deg/min": math.pi / 10800.0, "mrad/s": 1e-3}
PATH_SPEED = {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "km/h": 1.0 / 3.6}
"""Of a wheel's tread: an angular speed once its radius is known."""
CURRENT = {"A": 1.0, "mA": 1e-3}
VOLTAGE = {"V": 1.0, "mV": 1e-3}
TICK = "tick"  # of an encoder: an angle once the map gives ticks_per_turn
TICK_SPEED = {"tick/s": 1.0, "tick/min": 1.0 / 60.0}
LATITUDE, LONGITUDE = "latitude", "longitude"   # in degrees: positions without a heading
OF_WHEEL = ("wheel_angle", "wheel_speed", "set_speed")

OF_QUANTITY = {
    "time": (TIME,), "set_speed": (SPEED,), "wheel_angle": (ANGLE,), "wheel_speed": (SPEED,), "current": (CURRENT,),
    "voltage": (VOLTAGE,), "yaw_rate": (SPEED,), "steering_angle": (ANGLE,), "speed": (PATH_SPEED,),
    "pose": (LENGTH, LENGTH, ANGLE)}
"""The units of each quantity; of a pose one for each of x, y and heading."""


def of_tread(name: str, unit: str) -> float | None:
    """Metres, or metres a second, for one of a unit that measures how far a wheel rolls; None: it measures an angle."""
    return (LENGTH if name == "wheel_angle" else PATH_SPEED).get(unit) if name in OF_WHEEL else None


def further_units(name: str) -> set[str]:
    """Units that need a number of the map: ticks, and lengths by the wheel's radius."""
    if name == "wheel_angle":
        return {TICK, *LENGTH}
    if name == "steering_angle":
        return {TICK}
    return {*TICK_SPEED, *PATH_SPEED} if name in OF_WHEEL else set()


def needs_ticks(unit: str) -> bool:
    """Whether a unit counts what the map's ticks_per_turn makes an angle."""
    return unit == TICK or unit in TICK_SPEED
