"""The meaning of each PARAMETER: its key in a scene, its unit or "integer", and when it is required.

Field in the DBC → (key in a scene file, unit, item, required). The fields of a node follow from the core's list
(vehicle.h) and modelDescription.xml; the test test_wire_page.py compares `required` with the node.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

from laconic.base.paths import SOURCE_DIR
from laconic.core import Field, load

from .drive_parameters import drive_parameters, unit_of
from .sensor_parameters import sensor_parameters

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
