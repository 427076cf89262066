"""The meaning of each PARAMETER of bodies and hinges, from the rows of their lists (laconic/articulated.h)."""

from __future__ import annotations

import re

from laconic.base.paths import SOURCE_DIR

from .drive_parameters import unit_of

LIST = SOURCE_DIR / "core_c" / "include" / "laconic" / "articulated.h"
ROW = re.compile(r"X\(of, +\d+, (\w+), +(\w+), +\w+, +(\w+),[\s\\]+\w+,[\s\\]+(\w+)\)")
REFUSED = ("HINGE_VOLTAGE", "HINGE_TORQUE", "HINGE_ACCELERATION", "TWIST_RATE")
"""Inputs, which are only named in refusals."""
UNITS = {"kg": "kg", "kgm2": "kg m²", "Nms": "N m s", "Nm": "N m", "Nm_per_V": "N m/V", "m_per_s": "m/s"}
ITEMS = {"WHEEL_BODY": "wheel", "BODY_COUNT": "0", "START_VELOCITY": "1, 2", "START_YAW_RATE": "0", "TWIST": "1, 2, 3"}
NOTES = {"BODY_PARENT": "a body before it; 0: the carriage", "BODY_COUNT": "bodies on hinges; 0: none",
         "BODY_HINGE": "1 free, 2 motor, 3 prescribed, 4 coordinated", "WHEEL_BODY": "its body; 0: the carriage",
         "HINGE_RATE": "at the start, of a prescribed hinge", "TWIST": "at the start, where hinges are coordinated",
         "START_VELOCITY": "of the carriage's centre of mass, body axes"}


def hinge_parameters() -> dict[str, tuple[str, str, str, str]]:
    """Field in the DBC → meaning, unit, item, when it is required."""
    found = {}
    for identifier, member, kind, need in ROW.findall(LIST.read_text(encoding="utf-8")):
        if identifier not in REFUSED:
            endings = [ending for ending in UNITS if member.endswith("_" + ending)]
            unit = UNITS[max(endings, key=len)] if endings else unit_of(member, kind)
            key = f"hinges: {NOTES.get(identifier, 'body.' + member if need == 'ALWAYS' else member)}"
            found[identifier] = (key, unit, ITEMS.get(identifier, "body"), "each body" if need == "ALWAYS" else "")
    return found
