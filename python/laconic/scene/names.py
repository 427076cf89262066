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
    text = in_degrees_of(text, refused)
    for radians, degrees in DEGREES.items():
        text = text.replace(radians, degrees)
    text = f"{key.removesuffix('_rad')}_deg: {text}"
    return Refused(refused.status, refused.field, refused.item, text, value=refused.value, limit=refused.limit)


def in_degrees_of(text: str, refused: Refused) -> str:
    """A text whose numbers are the refusal's value and limit, in degrees; the limit rounded so that it is within."""
    value, limit = (f"{number:.6g}" for number in (refused.value, refused.limit))
    if text.startswith(f"with {value} rad"):
        return text.replace(f"{value} rad", f"{math.degrees(refused.value):.6g} degrees", 1)
    if not text.startswith(f"{value} is"):
        return text
    verdict = text.removeprefix(value)
    if refused.limit:
        verdict = verdict.replace(limit, f"{math.floor(1e3 * math.degrees(refused.limit)) / 1e3:.6g}")
    return f"{math.degrees(refused.value):.6g}{verdict}"
