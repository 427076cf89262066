"""What holds for a key that a scene leaves out: the vehicle's value for a wheel, 0 for an offset …"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from laconic.core import load
from laconic.core.fields import ABOVE_0, OF_GROUND, WHEEL
from laconic.scene.key_path import KeyPath
from laconic.scene.keys import KEYS

ABSENT_IS_0 = ("vehicle", "vehicle.motor", "vehicle.payload", "ground", "initial")


def default_of(entries: Mapping[str, Any], table: Mapping[str, Any], key: KeyPath) -> Any:
    """The value of a key that `table` does not have; None where leaving it out means something of its own."""
    name = key.name
    if key.table == WHEEL:
        return _of_wheel(entries, table, name)
    known = KEYS.get(key.known.path)
    if known is not None and isinstance(known.default, int | float | str):
        return known.default
    if known is not None and isinstance(known.default, tuple) and known.default:
        return list(known.default)
    radians = f"{name.removesuffix('_deg')}_rad" if name.endswith("_deg") else name
    field = next((each for each in load().fields_of(key.table) if each.key == radians), None)
    if field is None or field.kind != "REAL" or key.table not in ABSENT_IS_0 or (key.table == "vehicle" and
                                                                                 field.need != "NEVER"):
        return None
    return [0.0] * field.items if field.path.endswith("[#]") and field.items == 3 else 0.0


def _of_wheel(entries: Mapping[str, Any], wheel: Mapping[str, Any], name: str) -> Any:
    if name in ("locked", "driven", "motor_circuit"):
        return {"locked": False, "driven": True, "motor_circuit": "driven"}[name]
    if name in ("roller_rad", "roller_deg") and wheel.get("kind") == "omni":
        return 90.0 if name == "roller_deg" else math.pi / 2
    own = next((field for field in load().own_fields() if field.key == name), None)
    if own is None:
        return None
    vehicle = entries.get("vehicle", {})
    if name.startswith("motor_") and "motor" in vehicle:  # from the motor at its shaft
        return None
    holder = entries.get("ground", {}) if name in OF_GROUND else vehicle
    return holder.get(own.vehicle_key, None if name in ABOVE_0 else 0.0)
