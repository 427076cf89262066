"""Every key and every signal of a scene as rows for a reference: from the core's list of fields and laconic.scene.keys.

The words of the core's fields are those of the FMU's variables, which the caller reads from modelDescription.xml.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from laconic.core import Field, load
from laconic.core.fields import ITEM, OF_GROUND
from laconic.scene.hinge_signals import HINGE_INPUTS, HINGE_OUTPUTS, SLIPPING_ALONE, SLIPPING_OUTPUTS
from laconic.scene.keys import A_NUMBER, KEYS, TABLES, Key
from laconic.scene.sensors import DELAY, OF_ENCODERS, OF_IMU
from laconic.scene.signals import (
    FRICTION_LENGTHS,
    FRICTION_PER_WHEEL,
    LENGTHS,
    NEEDED,
    OUTPUT_LENGTHS,
    OUTPUTS_PER_WHEEL,
    PER_WHEEL,
    SUPPORT_LOAD,
    WHEEL_LOAD,
)
from laconic.scene.table import REQUIRED

NOT_IN_FILES = ("vehicle.drive.winding_resistance_ohm", "vehicle.drive.viscous_friction_Nms", f"sensors.imu.{DELAY}")
"""Fields that the program fills from other keys."""

KINDS = {"REAL": A_NUMBER, "INTEGER": "whole number", "FLAG": "true or false", "ABSENCE": "true or false"}
RANGES = {"POSITIVE": "above 0", "NOT_NEGATIVE": "0 or more", "SHARE": "0 to 1", "INCLINE": "0 to below 90°",
          "NOT_ZERO": "not 0"}
NEEDS = {"WITH_WHEELS": "must be given where there are wheels", "NEVER": "0",
         "WITH_MOTOR": "no motor; one of the two alone is refused"}
MUST = "must be given"
SLIPPING = "bodies on hinges and ground friction"
OF_FMUS = (r"; Co-Simulation only: .*|; all 0: .*|(?<=friction )in Co-Simulation (?=the mean)"
           r"|; 0 (without|where|for) [^;]*")
"""Words that a variable has for the sake of FMI alone."""
UNITS = {"m": "m", "s": "s", "s2": "s²", "kg": "kg", "kgm2": "kg·m²", "rad": "rad", "Hz": "Hz", "V": "V", "A": "A",
         "N": "N", "Nm": "N·m", "Nms": "N·m·s", "ohm": "Ω", "Vs": "V·s", "As": "A·s", "J": "J"}


@dataclass(frozen=True)
class Row:
    """One key of a table of a scene, in words."""

    table: str
    key: str
    kind: str
    unit: str
    default: str
    range: str
    meaning: str
    choices: Mapping[str, str]


@dataclass(frozen=True)
class Signal:
    """One input or output; items: "" for one number, "[1|2]", "[i]", one for each wheel, "[j]", for each support, or
    "[name]", for each hinge."""

    name: str
    items: str
    unit: str
    meaning: str
    needs: str


def unit_of(name: str) -> str:
    """The unit at the end of a name: "m/s²" of acceleration_m_per_s2; empty where it has none."""
    words = name.split("_")
    for start in range(len(words)):
        numerator, *parts = "_".join(words[start:]).split("_per_")
        if start and words[start] == "per":
            numerator, *parts = "1", *"_".join(words[start + 1:]).split("_per_")
        known = [UNITS.get(part) or ("√Hz" if part == "sqrt_Hz" else None) for part in parts]
        if (numerator in UNITS or numerator == "1") and None not in known:
            return "/".join([UNITS.get(numerator, "1"), *(unit or "" for unit in known)])
    return ""


def rows(words: Mapping[str, str], methods: Mapping[str, str]) -> Iterator[Row]:
    """All keys, table by table; words: of each variable of the FMU; methods: each with its words."""
    fields = {path_of(field): field for field in scene_fields()}
    for table in TABLES:
        paths = [path for path in {**fields, **KEYS} if path.rpartition(".")[0] == table]
        for path in paths:
            key = KEYS.get(path, Key(path))
            choices = methods if path == "run.method" else key.choices or {}
            yield _row(table, key, fields.get(path), words, choices)


def scene_fields() -> list[Field]:
    """Fields of the core that are keys of a scene; of the run and of inputs the file has keys of its own."""
    core = load()
    fields = [field for table in TABLES if table for field in core.fields_of(table)]
    return [field for field in fields if path_of(field) not in NOT_IN_FILES]


def path_of(field: Field) -> str:
    """The key with its table, as the file has it."""
    return f"{field.table}.{field.key}"


def _row(table: str, key: Key, field: Field | None, words: Mapping[str, str], choices: Mapping[str, str]) -> Row:
    name = key.path.rpartition(".")[2]
    kind = key.kind or (_kind_of(field) if field else "")
    return Row(table, name, kind, unit_of(name), _default(key, field), _range(key, field),
               key.meaning or (_in_file(words[field.name], field) if field else ""), choices)


def _kind_of(field: Field) -> str:
    if not field.path.endswith(ITEM):
        return KINDS[field.kind]
    return "list of 3 numbers" if field.items == 3 else "list of numbers, one for each wheel"


def _default(key: Key, field: Field | None) -> str:
    if key.usual:
        return key.usual
    if field is not None and key.default is REQUIRED:
        return _common(field) if field.is_own else NEEDS.get(field.need, MUST)
    if key.default is REQUIRED:
        return MUST
    return "none" if key.default in ("", (), None) else f"`{key.default}`" if isinstance(key.default, str) else \
        str(list(key.default) if isinstance(key.default, tuple) else f"{key.default:g}")


def _common(field: Field) -> str:
    """Whose value a wheel has without one of its own."""
    return f"`{'ground' if field.key in OF_GROUND else 'vehicle'}.{field.vehicle_key}`"


def _range(key: Key, field: Field | None) -> str:
    if key.range or key.rule:
        return key.range or (key.rule.range if key.rule else "")
    return RANGES.get(field.rule, "") if field else ""


def _in_file(text: str, field: Field) -> str:
    """The words of a variable by the names that a file has, without its range and what its 0 means in an FMU."""
    text = re.sub(OF_FMUS + r"|; 0: [^;]*$| \((more than|at most) [^)]*\)", "", text)
    for other in filter(lambda each: "_" in each.name, scene_fields()):
        name = other.key if other.table == field.table else path_of(other).replace("[#]", "")
        text = re.sub(rf"(?<![\w.`]){other.name}\b", f"`{name}`", text)
    return text


def inputs(words: Mapping[str, str]) -> list[Signal]:
    """What an `[[input]]` may set."""
    of_hinges = [Signal(name, items, unit_of(name), meaning, needs)
                 for name, (items, meaning, needs) in HINGE_INPUTS.items()]
    return _signals({**dict.fromkeys(PER_WHEEL, -1), **LENGTHS}, words) + of_hinges


def outputs(words: Mapping[str, str]) -> list[Signal]:
    """What `[outputs]` may list."""
    friction = {**dict.fromkeys(FRICTION_PER_WHEEL, -1), **FRICTION_LENGTHS}
    every = {**OUTPUT_LENGTHS, **dict.fromkeys(OUTPUTS_PER_WHEEL, -1), **friction, **OF_IMU,
             **dict.fromkeys(OF_ENCODERS, -1), WHEEL_LOAD: -1, SUPPORT_LOAD: -2}
    of_hinges = [Signal(name, "[name]", unit_of(name), meaning, "bodies on hinges")
                 for name, meaning in HINGE_OUTPUTS.items()]
    slipping = {name: ("[name]", meaning) for name, meaning in SLIPPING_OUTPUTS.items()} | SLIPPING_ALONE
    of_hinges += [Signal(name, each, unit_of(name), meaning, SLIPPING) for name, (each, meaning) in slipping.items()]
    return _signals(every, words) + of_hinges


def _signals(lengths: Mapping[str, int], words: Mapping[str, str]) -> list[Signal]:
    items = {-2: "[j]", -1: "[i]", 0: "", 2: "[1|2]", 3: "[1|2|3]"}
    return [Signal(name, items[length], unit_of(name), re.sub(OF_FMUS, "", words[name]), NEEDED.get(name, ""))
            for name, length in lengths.items()]
