"""C tables from the core's own structs: a prepared model as constant data, so that flash holds no preparation."""

from __future__ import annotations

import math
from typing import Any

import numpy as np


def c_literal(value: float, single: bool) -> str:
    """A C literal that is compiled to the same bits."""
    if not math.isfinite(value):
        raise ValueError(f"a table cannot hold {value}")
    text = str(np.float32(value)) if single else repr(float(value))
    if "." not in text and "e" not in text:
        text += ".0"
    return text + ("F" if single else "")


def initializer(ffi: Any, value: Any, names: dict[int, str]) -> str:
    """A C initializer for a struct, array or number; zeros are left out, pointers become the names in `names`.

    Without zeros a table also fits a build whose arrays are shorter (LACONIC_MAX_WHEELS).
    """
    kind = ffi.typeof(value) if isinstance(value, ffi.CData) else None
    if kind is None:
        raise TypeError(f"no C value: {value!r}")
    if kind.kind == "struct":
        parts = [(f".{name}", _member(ffi, value, name, field.type, names)) for name, field in kind.fields]
    elif kind.kind == "array":
        parts = [(f"[{i}]", _element(ffi, value, i, kind.item, names)) for i in range(kind.length)]
    elif kind.kind == "pointer":
        return names[int(ffi.cast("uintptr_t", value))]
    else:
        raise TypeError(f"cannot write {kind.cname}")
    return "{" + (", ".join(f"{designator} = {text}" for designator, text in parts if text) or "0") + "}"


def _member(ffi: Any, struct: Any, name: str, kind: Any, names: dict[int, str]) -> str:
    return _text(ffi, getattr(struct, name), kind, names)


def _element(ffi: Any, array: Any, index: int, kind: Any, names: dict[int, str]) -> str:
    return _text(ffi, array[index], kind, names)


def _text(ffi: Any, value: Any, kind: Any, names: dict[int, str]) -> str:
    """The value as text, empty where it is zero."""
    if kind.kind in ("struct", "array"):
        text = initializer(ffi, value, names)
        return "" if text == "{0}" else text
    if kind.kind == "pointer":
        return names[int(ffi.cast("uintptr_t", value))] if value else ""
    if kind.cname in ("float", "double"):
        return "" if value == 0 and math.copysign(1, value) > 0 else c_literal(value, kind.cname == "float")
    if kind.kind == "enum":
        value = int(ffi.cast("int", value)) if isinstance(value, ffi.CData) else value
    number = int(value)
    suffix = "ULL" if number > 0x7FFFFFFF else ""
    return f"{number}{suffix}" if number else ""
