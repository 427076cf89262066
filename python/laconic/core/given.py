"""What a Python program gives to the core: what does not fit is refused by its name, before cffi speaks of C types."""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.errors import BadInput, nearest_of
from laconic.errors import shown as shown

if TYPE_CHECKING:
    from laconic.core import Core

MAKERS = {"articulated_state": "plant.save()", "tree_state": "plant.save()",
          "input": "plant.input_of({…})", "vehicle": "laconic.Vehicle({…})", "model": "core.prepare(vehicle)",
          "state": "plant.save()", "plant": "plant.save()", "sensors": "sensors.save()",
          "estimate": "estimate.save()",
          "batch_kind": "batch.prepared(vehicle)"}
FLAGS = ("FLAG", "ABSENCE")
MOST_STEPS = 2**64 - 1
MOST_BITS = 128  # of a whole number: more than any that is asked for has
REAL = ("f", "i", "u")  # kinds of NumPy's types that are real numbers


def is_real(value: Any) -> bool:
    """Whether it may be a real number: no text, bytes, flag, complex number, date or duration, of Python or NumPy, and
    none that is masked."""
    return not (isinstance(value, str | bool) or is_bytes(value) or is_masked(value)) \
        and getattr(getattr(value, "dtype", None), "kind", "f") in REAL


def is_bytes(value: Any) -> bool:
    """Whether it is bytes, or a view of memory as bytes, whose numbers nobody meant."""
    return isinstance(value, bytes | bytearray) or (isinstance(value, memoryview) and value.itemsize == 1)


def is_masked(value: Any) -> bool:
    """Whether NumPy holds no measurement there: it would show NaN or whatever stands under the mask."""
    known = sys.modules.get("numpy.ma")  # NumPy loads it late: there is no such array before
    return known is not None and isinstance(value, known.MaskedArray) and bool(np.ma.is_masked(value))


def number(name: str, value: Any) -> float:
    """A number; one beyond all floats becomes infinite, which the core refuses."""
    try:
        return float(value if is_real(value) else "no number")
    except OverflowError:
        return math.inf if value > 0 else -math.inf
    except Exception:  # of whatever class it is
        raise BadInput(f"{name}: {shown(value)} is no number; give one") from None


def several(values: Any) -> list[Any] | None:
    """The items of a list, tuple, array …; None for what is none: text, bytes, a mapping, and a set, which has no
    order."""
    if isinstance(values, str | Mapping | Set) or is_bytes(values):
        return None
    try:
        return list(values)
    except TypeError:
        return None


def numbers(name: str, values: Any, count: int) -> list[float]:
    """So many numbers."""
    many = several(values)
    if many is None or len(many) != count:
        raise BadInput(f"{name}: {shown(values)} is no list of {count} numbers; give one")
    return [number(f"{name}[{item}]", value) for item, value in enumerate(many, start=1)]


def finite_number(name: str, value: Any) -> float:
    """A number, neither infinite nor NaN."""
    found = number(name, value)
    if not math.isfinite(found):
        raise BadInput(f"{name}: {shown(value)} is not finite; give a finite number")
    return found


def finite_numbers(name: str, values: Any, count: int) -> list[float]:
    """So many numbers, neither infinite nor NaN; also an array."""
    many = numbers(name, getattr(values, "tolist", lambda: values)(), count)
    return [finite_number(f"{name}[{item}]", value) for item, value in enumerate(many, start=1)]


def name_list(name: str, given: Any) -> list[str]:
    """A list of names."""
    try:
        many = list(given)
    except TypeError:
        many = [None]
    if isinstance(given, str | bytes) or not all(isinstance(each, str) for each in many):
        raise BadInput(f"{name}: {shown(given)} is no list of names; give one, such as [\"mass_kg\"]")
    return many


def one_of(name: str, given: Any, known: Iterable[str]) -> str:
    """A word that is among those that are known."""
    words = list(known)
    if not isinstance(given, str) or given not in words:
        near = nearest_of(given if isinstance(given, str) else "", words)
        raise BadInput(f"{name}: there is no {shown(given)}; {near}")
    return given


def flag(name: str, value: Any) -> bool:
    """True or false; no text, of which each that is not empty would be true, and no number."""
    if not isinstance(value, bool | np.bool_):
        raise BadInput(f"{name}: {shown(value)} is neither True nor False; give one of them")
    return bool(value)


def by_names(name: str, given: Any) -> Mapping[str, Any]:
    """A mapping from names."""
    if not isinstance(given, Mapping) or not all(isinstance(key, str) for key in given):
        raise BadInput(f"{name}: {shown(given)} is no mapping from names to numbers; give one, such as "
                       "{\"mass_kg\": 1.0}")
    return given


def whole_number(name: str, value: Any) -> int:
    """A whole number of either sign, of at most MOST_BITS."""
    try:
        found = operator.index(value if is_real(value) else None)  # type: ignore[arg-type]  # which it refuses
    except TypeError:
        raise BadInput(f"{name}: {shown(value)} is no whole number (int); give one, such as 100") from None
    if found.bit_length() > MOST_BITS:
        raise BadInput(f"{name}: {shown(found)} is beyond all bounds; give one such as 100")
    return found


def step_count(name: str, value: Any) -> int:
    """A whole number of steps."""
    count = whole_number(name, value)
    if not 0 <= count <= MOST_STEPS:
        raise BadInput(f"{name}: {count} steps cannot be taken; give a number from 0 to {MOST_STEPS}")
    return count


def c_object(core: Core, kind: str, given: Any) -> Any:
    """A pointer to laconic_`kind` as it is, for a vehicle also that of a laconic.Vehicle; anything else, also one of
    the other scalar type, is BadInput."""
    ffi = core.ffi
    found = getattr(given, "c", given) if kind == "vehicle" and not isinstance(given, ffi.CData) else given
    if not isinstance(found, ffi.CData) or ffi.typeof(found) is not ffi.typeof(f"laconic_{kind} *"):
        if isinstance(its := getattr(given, "core", None), type(core)) and its is not core:
            raise BadInput(f"{kind}: is in {its.real} precision, and this is in {core.real}; make both in one")
        raise BadInput(f"{kind}: {shown(given)} is no laconic_{kind} of this core; make it with {MAKERS[kind]}")
    return found


def table(core: Core, path: str, name: str, given: Any, others: Sequence[str] = ()) -> dict[str, float | bool]:
    """The numbers of one table of a vehicle by the core's list of fields, angles in rad whatever the table has;
    `others` are keys that the caller reads.

    BadInput names a key that is unknown or that holds no number.
    """
    if not isinstance(given, Mapping):
        raise BadInput(f"{name}: {shown(given)} is no table; give a mapping from keys to numbers")
    from laconic.core.spelling import with_radians  # which reads numbers by this room

    fields = {field.key: field for field in core.fields_of(path)}
    given = with_radians(name, given, fields)
    known = list(dict.fromkeys((*fields, *others)))
    if unknown := [key for key in given if key not in known]:
        raise BadInput(f"{name}.{unknown[0]}: unknown key; {nearest_of(str(unknown[0]), known)}")
    found: dict[str, float | bool] = {}
    for key in given:
        if key not in others:
            found[key] = _of_kind(fields[key].kind, f"{name}.{key}", given[key])
    return found


def check_there(core: Core, path: str, name: str, given: Mapping[str, Any], need: str) -> None:
    """BadInput for the first number of a table that must be given, by the core's list of fields, and is not."""
    for field in core.fields_of(path):
        if field.need == need and field.key not in given:
            raise BadInput(f"{name}.{field.key}: is missing; give a number")


def _of_kind(kind: str, name: str, given: Any) -> float | bool:
    """A number as the core's list of fields says that it is one; a flag as everywhere."""
    if kind in FLAGS:
        return flag(name, given)
    value = number(name, given)
    if kind != "INTEGER":
        return value
    if not (math.isfinite(value) and value == int(value) and abs(value) < 2**31):
        raise BadInput(f"{name}: {value:g} is no whole number of 32 bits; give one")
    return int(value)


def items(name: str, given: Any) -> Iterator[tuple[str, Any]]:
    """The tables of a list with their names, numbered from 1."""
    if isinstance(given, str | Mapping) or is_bytes(given) or not isinstance(given, Sequence):
        raise BadInput(f"{name}: {shown(given)} is no list; give a list of tables")
    return ((f"{name}[{item}]", each) for item, each in enumerate(given, start=1))
