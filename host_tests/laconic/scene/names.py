"""The one thing that the core does not know of a scene file: which angles it gives in degrees. Tables and keys are the
core's own (laconic_field_path)."""

from __future__ import annotations

import math
from collections.abc import Collection

from laconic.errors import Refused

DEGREES = {"pi/2": "90", "pi/4": "45"}


def in_file(refused: Refused, in_degrees: Collection[str]) -> Refused:
    """A refusal of the core by the key, and in the unit, that the file has."""
    key, _, text = refused.message.partition(": ")
    if key not in in_degrees:
        return refused
    text = text.replace(f"{refused.value:.6g} rad", f"{math.degrees(refused.value):.6g} degrees")
    for radians, degrees in DEGREES.items():
        text = text.replace(radians, degrees)
    text = f"{key.removesuffix('_rad')}_deg: {text}"
    return Refused(refused.status, refused.field, refused.item, text, value=refused.value, limit=refused.limit)
