"""The meaning of each PARAMETER of motor drives, from the rows of their list (laconic_drives/settings.h)."""

from __future__ import annotations

import re

from laconic.base.paths import SOURCE_DIR

LIST = SOURCE_DIR / "firmware_stub" / "include" / "laconic_drives" / "settings.h"
ROW = re.compile(r"X\(of, +\d+, (\w+), +(\w+), +\w+, +(\w+),[\s\\]+(\w+),[\s\\]+\w+\)")
UNITS = {"A": "A", "V": "V", "s": "s", "ohm": "Ω", "rad_per_s": "rad/s", "per_s": "1/s", "Nm_per_A": "N m/A",
         "As": "A s", "Vs_per_rad": "V s/rad", "m": "m", "rad": "rad", "m_per_s2": "m/s²",
         "m_per_s2_per_sqrt_Hz": "m/s²/√Hz", "rad_per_s_per_sqrt_Hz": "rad/s/√Hz", "kg": "kg", "kgm2": "kg m²",
         "Nms": "N m s", "Nm": "N m", "Nm_per_V": "N m/V", "m_per_s": "m/s"}
NOTES = {"DRIVE_PROTOCOL": ": see below; 0 or not sent: no drives",
         "DRIVE_NODE_ID": ": of a wheel that has a drive; it is sent for no other wheel",
         "DRIVE_GEAR_RATIO": ": turns of the shaft for one of the wheel, below 0: reversed; not 0",
         "DRIVE_WATCHDOG": ": longest silence of the controller; 0: what the protocol says",
         "DRIVE_STALL_TIME": ": so long at a limit of the current without motion is a stall; 0: none",
         "DRIVE_BACK_EMF": ": 0: as the torque constant"}


def unit_of(member: str, kind: str) -> str:
    """The unit that a member's name ends with."""
    endings = [ending for ending in UNITS if member.endswith("_" + ending)]
    return "integer" if kind == "INTEGER" else UNITS[max(endings, key=len)] if endings else "1"


def drive_parameters() -> dict[str, tuple[str, str, str, str]]:
    """Field in the DBC → key in a scene, unit, item, when it is required."""
    found = {}
    for identifier, member, kind, rule in ROW.findall(LIST.read_text(encoding="utf-8")):
        item = "0" if identifier in ("DRIVE_PROTOCOL", "DRIVE_WATCHDOG") else "wheel, hinge"
        required = "each drive, else NOT_POSITIVE" if rule in ("POSITIVE", "NOT_ZERO") else ""
        key = "node_ids" if member == "node_id" else member
        found[identifier] = (f"rig.drives.{key}" + NOTES.get(identifier, ""), unit_of(member, kind), item, required)
    return found
