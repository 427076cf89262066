"""A vehicle, its start and its run as the numbers of PARAMETER frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from laconic.can.rig.wire import wire
from laconic.core import Core, Field
from laconic.core.plant import Plant

Parameter = tuple[str, int, float | int]  # field (name in the value table), item, value

DRIVE = "vehicle.drive"  # has numbers of every motor, but only the friction step reads them


def parameters_of(plant: Plant, start: Any) -> Iterator[Parameter]:
    """All parameters of this plant; zeros are left out where the node does not require the field."""
    yield from vehicle_parameters(plant.core, plant.c.vehicle, start, with_drive=plant.has_friction)
    yield "METHOD", 0, method_number(plant.core, plant.c.integrator.method)
    yield "STEP", 0, plant.step_s


def vehicle_parameters(core: Core, vehicle: Any, start: Any, *, with_drive: bool = False) -> Iterator[Parameter]:
    """Those of a laconic_vehicle and a laconic_start."""
    has_payload = any(value for field in core.fields_of("vehicle.payload") for value in field.values(vehicle))
    left_out = ("vehicle.motor",) if with_drive else ("vehicle.motor", DRIVE)
    for field in core.fields:
        root = field.root
        if root not in ("vehicle", "initial") or field.table in left_out:
            continue
        values = field.values(vehicle if root == "vehicle" else start)[:in_use(field, vehicle)]
        required = field.need not in ("NEVER", "WITH_SUPPORTS") and (field.need != "WITH_PAYLOAD" or has_payload)
        for item, value in enumerate(values, start=int(field.items > 0)):
            if value != 0 or required:
                yield field.identifier, item, 1 - int(value) if field.kind == "ABSENCE" else value


def in_use(field: Field, vehicle: Any) -> int | None:
    """Number of items that the vehicle uses; None: all."""
    counts = {"vehicle.wheel[#]": vehicle.wheel_count, "vehicle.support[#]": vehicle.support_count}
    return counts.get(field.table)


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
