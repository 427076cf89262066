"""A key of a scene by its path, `vehicle.wheel[2].x_m`: what a sweep varies and an optimiser frees.

Tables of several are numbered from 1, and so are the numbers of a list (`initial.nu_rad_per_s[3]`); `[*]` is all of
them. An angle may be named in radians or in degrees, whichever of the two the file has.

Keys that name one number twice: by [*] and an index, in radians and degrees, a place in two kinds of coordinates.

What holds for a key that a scene leaves out: the vehicle's value for a wheel, 0 for an offset …
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from laconic.core import load
from laconic.core.fields import ABOVE_0, OF_GROUND, WHEEL
from laconic.core.given import shown
from laconic.errors import BadInput, nearest_of
from laconic.scene.keys import KEYS, TABLES
from laconic.scene.reference import KINDS, path_of, scene_fields

EVERY = 0  # an item `[*]`
PART = re.compile(r"(\w+)(?:\[(\*|\d{1,9})\])?")
SEVERAL = tuple(table.removesuffix("[#]") for table in TABLES if table.endswith("[#]"))
"""Tables of which there are several."""


@dataclass(frozen=True)
class KnownKey:
    """What every scene may have at a path: `items` counts the numbers of a list, -1 where the file decides."""

    path: str       # "vehicle.wheel[#].x_m"
    kind: str       # "number", "whole number", "true or false", "text"
    items: int = 0  # 0: no list


@dataclass(frozen=True)
class KeyPath:
    """One key, or with `[*]` the same key of every wheel …; `item` counts from 1, EVERY for all, None for no list."""

    text: str
    tables: tuple[tuple[str, int | None], ...]  # each with its number from 1, EVERY, or None for a single table
    name: str
    item: int | None
    known: KnownKey

    @property
    def table(self) -> str:
        """The path of its table in the reference: "vehicle.wheel[#]"."""
        return self.known.path.rpartition(".")[0]


def key_path(text: str | KeyPath) -> KeyPath:
    """Reads a path; BadInput names what is no key of any scene, and keys that are near."""
    return text if isinstance(text, KeyPath) else _key_path(text)


@cache
def _key_path(text: str) -> KeyPath:
    parts = [PART.fullmatch(part) for part in text.strip().split(".")]
    if not all(parts):
        raise BadInput(f"{shown(text)}: is no key of a scene; give one such as vehicle.wheel[2].x_m, counted from 1")
    steps = [(part[1], _item(text, part[2])) for part in parts if part]
    (name, item), tables = steps[-1], steps[:-1]
    known = _known(text, tables, name)
    if item is None and known.items:
        raise BadInput(f"{text}: is a list; name one of its numbers, {text}[1] …, or {text}[*] for all")
    if item is not None and not known.items:
        raise BadInput(f"{text}: {name} is no list; take [{'*' if item == EVERY else item}] out")
    return KeyPath(text.strip(), tuple(tables), name, item, known)


def _item(text: str, given: str | None) -> int | None:
    if given == "0":
        raise BadInput(f"{text}: [0] is no item; they count from 1")
    return None if given is None else EVERY if given == "*" else int(given)


def _known(text: str, tables: list[tuple[str, int | None]], name: str) -> KnownKey:
    """The key in the list of all; BadInput with the nearest."""
    found, before = known_keys(), ".".join(table + ("[#]" if _are_several(tables[: place + 1]) else "")
                                           for place, (table, _) in enumerate(tables))
    keys = {path.rpartition(".")[2] for path in found if path.rpartition(".")[0] == before}
    if not keys or (not tables and name not in keys):
        spelled = [re.sub(r"\[#\]", "", path) for path in found]
        ends = [path for path in spelled if path.rpartition(".")[2] == name]
        wanted = ".".join((*(table for table, _ in tables), name))
        near = f"did you mean {ends[0]}?" if ends and not tables else _near(wanted, spelled)
        raise BadInput(f"{text}: is no key of a scene; {near}")
    if name not in keys:
        known = keys | {f"{table}.…" for table in _tables_in(before)}
        raise BadInput(f"{text}: {before.replace('[#]', '')} has no key {shown(name)}; {nearest_of(name, known)}")
    for place, (_, item) in enumerate(tables):
        _check_number(text, tables[: place + 1], item)
    return found[f"{before}.{name}" if before else name]


def _tables_in(table: str) -> set[str]:
    """The names of the tables that a table has."""
    inner = {path.rpartition(".")[0] for path in known_keys() if path.startswith(f"{table}.")} - {table}
    return {path.removeprefix(f"{table}.").partition(".")[0].replace("[#]", "[1]") for path in inner}


def _are_several(tables: list[tuple[str, int | None]]) -> bool:
    return ".".join(table for table, _ in tables) in SEVERAL


def _near(wanted: str, paths: list[str]) -> str:
    tables = sorted({path.rpartition(".")[0] for path in paths} - {""})
    return nearest_of(wanted, paths, f"known tables are {', '.join(tables)}")


def _check_number(text: str, tables: list[tuple[str, int | None]], item: int | None) -> None:
    """Fails for a table of several without its number, and for one of which there is one with a number."""
    name = ".".join(table for table, _ in tables)
    if item is None and _are_several(tables):
        raise BadInput(f"{text}: there may be several {name}; give a number, {name}[1], or [*] for all")
    if item is not None and not _are_several(tables):
        raise BadInput(f"{text}: there is one {name}; take its number out")


@cache
def known_keys() -> dict[str, KnownKey]:
    """Every key of a scene by its path; angles in both units."""
    found: dict[str, KnownKey] = {}
    for field in scene_fields():
        kind = KINDS.get(field.kind, "number")
        items = field.items if field.path.endswith("[#]") else 0
        found[path_of(field)] = KnownKey(path_of(field), kind, -1 if items > 3 else items)
    for path, key in KEYS.items():
        if key.kind:
            found[path] = KnownKey(path, *_kind_of(key.kind))
    for path, known in list(found.items()):
        if path.endswith("_rad"):
            spelled = f"{path.removesuffix('_rad')}_deg"
            found[spelled] = KnownKey(spelled, known.kind, known.items)
    return found


def _kind_of(words: str) -> tuple[str, int]:
    """A kind of keys.py: what one value is, and how many there are."""
    one = next((each for each in ("whole number", "number", "true or false") if words.startswith(each)), "")
    if one:  # a list instead of one number for all is not taken apart
        return one, 0
    return ("text", -1 if words.startswith("list") else 0) if "text" in words else \
        ("number", 2 if " 2 " in words else -1)


PLAIN, POLAR = ("x_m", "y_m"), ("distance_m", "bearing_rad")


def check_apart(option: str, keys: Sequence[KeyPath]) -> None:
    """BadInput names the first two keys of which a run could not have both values; `option` is how they are given."""
    for place, key in enumerate(keys):
        for other in keys[:place]:
            if not _same_tables(key, other):
                continue
            if _radians(key.name) == _radians(other.name) and _meet(key.item, other.item):
                raise BadInput(f"{option} {key.text}: names a number that {option} {other.text} names, too; keep "
                               "one of them")
            if _coordinates(key) and _coordinates(key) != _coordinates(other) != ():
                raise BadInput(f"{option} {key.text}: places a wheel that {option} {other.text} places, too; keep x_m "
                               "and y_m, or distance_m and bearing_rad")


def _same_tables(one: KeyPath, other: KeyPath) -> bool:
    """Whether some table holds both."""
    return len(one.tables) == len(other.tables) and all(
        name == name_too and _meet(item, item_too)
        for (name, item), (name_too, item_too) in zip(one.tables, other.tables, strict=True))


def _meet(one: int | None, other: int | None) -> bool:
    return one == other or EVERY in (one, other)


def _radians(name: str) -> str:
    return f"{name.removesuffix('_deg')}_rad" if name.endswith("_deg") else name


def _coordinates(key: KeyPath) -> tuple[str, ...]:
    """In which a key says where a wheel is; none where it says something else."""
    if key.table != WHEEL:
        return ()
    return next((each for each in (PLAIN, POLAR) if _radians(key.name) in each), ())


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
