"""The meaning of each PARAMETER: its key in a scene, its unit or "integer", and when it is required.

Field in the DBC → (key in a scene file, unit, item, required). The fields of a node follow from the core's list
(vehicle.h) and modelDescription.xml; the test test_wire_page.py compares `required` with the node.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

from laconic.base.paths import SOURCE_DIR
from laconic.core import Field, load

# ---- Motor drives, from the rows of their list (laconic_drives/settings.h).

DRIVE_LIST = SOURCE_DIR / "firmware_stub" / "include" / "laconic_drives" / "settings.h"
DRIVE_ROW = re.compile(r"X\(of, +\d+, (\w+), +(\w+), +\w+, +(\w+),[\s\\]+(\w+),[\s\\]+\w+\)")
UNITS = {"A": "A", "V": "V", "s": "s", "ohm": "Ω", "rad_per_s": "rad/s", "per_s": "1/s", "Nm_per_A": "N m/A",
         "As": "A s", "Vs_per_rad": "V s/rad", "m": "m", "rad": "rad", "m_per_s2": "m/s²",
         "m_per_s2_per_sqrt_Hz": "m/s²/√Hz", "rad_per_s_per_sqrt_Hz": "rad/s/√Hz", "kg": "kg", "kgm2": "kg m²",
         "Nms": "N m s", "Nm": "N m", "Nm_per_V": "N m/V", "m_per_s": "m/s"}
DRIVE_NOTES = {"DRIVE_PROTOCOL": ": see below; 0 or not sent: no drives",
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
    for identifier, member, kind, rule in DRIVE_ROW.findall(DRIVE_LIST.read_text(encoding="utf-8")):
        item = "0" if identifier in ("DRIVE_PROTOCOL", "DRIVE_WATCHDOG") else "wheel, hinge"
        required = "each drive, else NOT_POSITIVE" if rule in ("POSITIVE", "NOT_ZERO") else ""
        key = "node_ids" if member == "node_id" else member
        key = f"rig.drives.{key}{DRIVE_NOTES.get(identifier, '')}"
        found[identifier] = (key, unit_of(member, kind), item, required)
    return found


# ---- Sensors, from the rows of their list (laconic/sensors.h).

SENSOR_LIST = SOURCE_DIR / "core_c" / "include" / "laconic" / "sensors.h"
SENSOR_GROUP = re.compile(r"#define LACONIC_(\w+)_FIELDS\(X, of\)((?:.*\\\n)*.*)")
SENSOR_ROW = re.compile(r"X\(of, +\d+, (\w+), +(\w+),[\s\\]+\w+,[\s\\]+(\w+),[\s\\]+\w+,[\s\\]+\w+\)")
SENSOR_TABLES = {"IMU": ("imu", "0"), "IMU_ARRAY": ("imu", "1, 2"), "ENCODER": ("encoder", "0"),
                 "WHEEL_ENCODER": ("encoder", "wheel")}
SENSOR_NOTES = {"IMU_ACCELERATION_RANGE": ": 0: none", "IMU_YAW_RATE_RANGE": ": 0: none",
                "IMU_DELAY": ": in a scene delay_s",
                "WHEEL_ENCODER_COUNTS": ": 0 or not sent: the wheel has no encoder",
                "WHEEL_ENCODER_GEAR_RATIO": ": turns of the encoder for one of the wheel, below 0: reversed; 0: 1",
                "WHEEL_ENCODER_WRAP": ": it shows 0 to one less; 0: 32 bits with sign"}


def sensor_parameters() -> dict[str, tuple[str, str, str, str]]:
    """Field in the DBC → key in a scene, unit, item, when it is required."""
    found = {}
    for group, rows in SENSOR_GROUP.findall(SENSOR_LIST.read_text(encoding="utf-8")):
        table, item = SENSOR_TABLES[group]
        for identifier, member, kind in SENSOR_ROW.findall(rows):
            key = f"sensors.{table}.{member}{SENSOR_NOTES.get(identifier, '')}"
            found[identifier] = (key, unit_of(member, kind), item, "")
    return found


# ---- The vehicle, from the list of the core, and its hinges.

NEEDS = {
    "NEVER": "", "ALWAYS": "always", "WITH_WHEELS": "with wheels", "WITH_MOTOR": "with the other of the motor",
    "WITH_PAYLOAD": "with any of the payload", "WITH_SUPPORTS": "with any support", "EACH_WHEEL": "each wheel",
    "EACH_ROLLER": "each wheel of kind 1", "EACH_SUPPORT": "each support"}
RESERVED = "not yet: NOT_SUPPORTED"
NONE, WHEEL, SUPPORT, COMPONENT = "0", "wheel", "support", "1, 2, 3"
NOTES = {"WHEEL_KIND": ": 1 rollers (omni, mecanum), 2 fixed", "WHEEL_LOCKED": ": 0 or 1",
         "DRIVEN": ": 0 or 1; 1 where it is not sent", "MOTOR_CIRCUIT": ": 0 driven, 1 open, 2 shorted",
         "METHOD": ": see below"}
HINGE_LISTS = {name: SOURCE_DIR / "core_c" / "include" / "laconic" / f"{name}.h"
               for name in ("articulated", "articulated_friction")}
HINGE_ROW = re.compile(r"X\(of, *\d+, *(\w+), *(\w+), *\w+, *(\w+),[\s\\]*\w+,[\s\\]*(\w+)\)")
ONLY_REFUSED = ("HINGE_VOLTAGE", "HINGE_TORQUE", "HINGE_ACCELERATION", "TWIST_RATE", "HINGE_ANGLE")
"""Inputs, which are only named in refusals."""
HINGE_ITEMS = {**dict.fromkeys(("WHEEL_LOAD", "SCRUB_RADIUS", "SCRUB_FADE", "CREEP"), WHEEL),
               "WHEEL_BODY": WHEEL, "BODY_COUNT": NONE, "START_VELOCITY": "1, 2", "START_YAW_RATE": NONE,
               "TWIST": COMPONENT}
HINGE_NOTES = {"BODY_PARENT": "a body before it; 0: the carriage", "BODY_COUNT": "bodies on hinges; 0: none",
               "BODY_HINGE": "1 free, 2 motor, 3 prescribed, 4 coordinated", "WHEEL_BODY": "its body; 0: the carriage",
               "HINGE_RATE": "at the start, of a prescribed hinge",
               "TWIST": "at the start, where hinges are coordinated",
               "START_VELOCITY": "of the carriage's centre of mass, body axes"}


def units() -> dict[str, str]:
    """Variable → unit, from modelDescription.xml."""
    root = ET.parse(SOURCE_DIR / "modelDescription.xml").getroot()
    types = {each.get("name"): each.get("unit", "1") for each in root.iter("Float64Type")}
    found = {each.get("name", ""): types[each.get("declaredType")] for each in root.iter("Float64")}
    return {name: unit.replace(".", " ").replace("2", "²") for name, unit in found.items()}


def row(field: Field, unit: str) -> tuple[str, str, str, str]:
    """The entry of a field that a node accepts."""
    key = f"how many [[{field.path}]]" if field.counts else field.path.removesuffix("[#]")
    tables = {"vehicle.wheel[#]": WHEEL, "vehicle.support[#]": SUPPORT}
    components = WHEEL if field.items == load().max_wheels else COMPONENT
    item = tables.get(field.table, components if field.items else NONE)
    if item in (WHEEL, SUPPORT):
        key = f"{item}.{field.key}"
    return key + NOTES.get(field.identifier, ""), unit, item, NEEDS[field.need]


def taken() -> dict[str, tuple[str, str, str, str]]:
    """The entries of all fields that a node accepts."""
    unit = units()
    return {field.identifier: row(field, unit[field.name] if field.kind == "REAL" else "integer")
            for field in load().fields if field.table and field.table != "vehicle.motor"}


def hinge_parameters() -> dict[str, tuple[str, str, str, str]]:
    """Field in the DBC → meaning, unit, item, when it is required."""
    found = {}
    rows = [(name, *row) for name, path in HINGE_LISTS.items()
            for row in HINGE_ROW.findall(path.read_text(encoding="utf-8"))]
    for name, identifier, member, kind, need in rows:
        if identifier not in ONLY_REFUSED:
            where = "hinges" if name == "articulated" else "hinges, ground with friction"
            key = f"{where}: {HINGE_NOTES.get(identifier, 'body.' + member if need == 'ALWAYS' else member)}"
            required = "each body" if need == "ALWAYS" else ""
            found[identifier] = (key, unit_of(member, kind), HINGE_ITEMS.get(identifier, "body"), required)
    return found


PARAMETERS = {
    "RESISTANCE": ("vehicle.motor.resistance_ohm", "Ω", NONE, RESERVED),
    "TORQUE_CONSTANT": ("vehicle.motor.torque_constant_Nm_per_A", "N m/A", NONE, RESERVED),
    "BACK_EMF": ("vehicle.motor.back_emf_Vs_per_rad", "V s/rad", NONE, RESERVED),
    "GEAR_RATIO": ("vehicle.motor.gear_ratio", "1", NONE, RESERVED),
    "VISCOUS_FRICTION": ("vehicle.motor.viscous_friction_Nms", "N m s", NONE, RESERVED),
    "ROTOR_INERTIA": ("vehicle.motor.rotor_inertia_kgm2", "kg m²", NONE, RESERVED),
    "DRIVE_FAULTS": ("an order while the node plays, see Drives", "integer", WHEEL, "not of a vehicle"),
} | taken() | drive_parameters() | sensor_parameters() | hinge_parameters()
