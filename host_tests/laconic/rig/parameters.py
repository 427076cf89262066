"""A vehicle, its start and its run as the numbers that PARAMETER frames carry."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from laconic.core.plant import Plant
from laconic.rig.wire import wire

Parameter = tuple[str, int, float | int]  # field (name in the value table), item, value

VEHICLE = {
    "mass_kg": "MASS", "yaw_inertia_kgm2": "YAW_INERTIA", "com_x_m": "COM_X", "com_y_m": "COM_Y", "com_z_m": "COM_Z",
    "wheel_radius_m": "WHEEL_RADIUS", "wheel_inertia_kgm2": "WHEEL_INERTIA", "motor_gain_Nm_per_V": "MOTOR_GAIN",
    "motor_damping_Nms": "MOTOR_DAMPING", "friction_coefficient": "FRICTION_COEFFICIENT"}
PAYLOAD = {"mass_kg": "PAYLOAD_MASS", "x_m": "PAYLOAD_X", "y_m": "PAYLOAD_Y", "yaw_inertia_kgm2": "PAYLOAD_YAW_INERTIA"}
WHEEL = {"x_m": "WHEEL_X", "y_m": "WHEEL_Y", "axle_rad": "AXLE", "roller_rad": "ROLLER"}


OPTIONAL = {"COM_X", "COM_Y", "COM_Z", "FRICTION_COEFFICIENT"}
REQUIRED = {*VEHICLE.values(), *WHEEL.values(), *PAYLOAD.values(), "WHEEL_COUNT", "WHEEL_KIND", "SUPPORT_X",
            "SUPPORT_Y", "METHOD", "STEP"} - OPTIONAL


def parameters_of(plant: Plant, start: Any) -> Iterator[Parameter]:
    """Everything a node needs to play this plant, zeros left out where they need not be said."""
    vehicle, core = plant.c.vehicle, plant.core
    given = [(field, 0, getattr(vehicle, name)) for name, field in VEHICLE.items()]
    payload = [(field, 0, getattr(vehicle.payload, name)) for name, field in PAYLOAD.items()]
    given += payload if any(value for _, _, value in payload) else []
    given += [("WHEEL_COUNT", 0, int(vehicle.wheel_count)), ("SUPPORT_COUNT", 0, int(vehicle.support_count))]
    for i in range(vehicle.wheel_count):
        wheel = vehicle.wheel[i]
        given += [(field, i + 1, getattr(wheel, name)) for name, field in WHEEL.items()]
        given += [("WHEEL_KIND", i + 1, int(wheel.kind)), ("WHEEL_LOCKED", i + 1, int(wheel.locked))]
    for i in range(vehicle.support_count):
        support = vehicle.support[i]
        given += [("SUPPORT_X", i + 1, support.x_m), ("SUPPORT_Y", i + 1, support.y_m)]
    given += [("START_NU", k + 1, start.nu_rad_per_s[k]) for k in range(3)]
    given += [("START_X", 0, start.x_m), ("START_Y", 0, start.y_m), ("START_HEADING", 0, start.heading_rad)]
    given += [("METHOD", 0, method_number(core, plant.c.integrator.method)), ("STEP", 0, plant.step_s)]
    return ((field, item, value) for field, item, value in given if value != 0 or field in REQUIRED)


def method_number(core: Any, method: Any) -> int:
    """The number of a laconic_method."""
    return next(n for n in range(len(core.method_names)) if core.lib.laconic_method_by_number(n) == method)


def parameter_words(parameters: Iterable[Parameter], dtype: np.dtype) -> Iterator[tuple[int, int, int, int]]:
    """(upper half?, field, item, 32 bits) of every PARAMETER frame."""
    numbers = {text: number for number, text in wire()["PARAMETER"].fields["field"].choices.items()}
    for field, item, value in parameters:
        number = numbers[field]
        if isinstance(value, int):
            yield 0, number, item, value & 0xFFFFFFFF
            continue
        words = np.frombuffer(np.array(value, dtype).tobytes(), "<u4")
        for upper, bits in enumerate(words):
            yield upper, number, item, int(bits)
