"""The options of python-can's interfaces. Most of them accept any name and ignore unknown ones; a run without
the faults that the user wanted would pass wrongly, so names are checked here."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Callable, Iterable

import can
from can.interfaces import BACKENDS
from can.typechecking import BitTimingDict, BitTimingFdDict

from laconic.can.rig.faults import FIELD_TYPES, faults_from
from laconic.errors import BadInput, nearest_of

FAULTY = "faulty"
OF_THE_RIG = {"channel": "--channel", "interface": "--interface", "bitrate": "--bitrate"}
NOT_FOR_TEXT = {"self", "kwargs", "timing", "can_filters", "inner", "clock", *OF_THE_RIG}


def read_bus_options(given: Iterable[str], interface: str) -> dict[str, str | int | float | bool]:
    """{"loss": "0.1"} from ["loss=0.1"]; BadInput for an option that the interface does not have."""
    found: dict[str, str | int | float | bool] = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not name or not equals:
            raise BadInput(f"--bus-option {text}: give NAME=VALUE, such as under=slcan")
        if name in found:
            raise BadInput(f"--bus-option {text}: {name} is given twice; give it once")
        if name == "receive_own_messages":
            raise BadInput(f"--bus-option {text}: would take frames of its own for another station's; leave it out")
        found[name] = value if interface == FAULTY and name in FIELD_TYPES else plain_value(value)
    check_names(found, interface)
    try:
        faults_from({name: value for name, value in found.items() if interface == FAULTY and name in FIELD_TYPES})
    except ValueError as error:
        raise BadInput(f"--bus-option {error}") from None
    return found


def plain_value(text: str) -> str | int | float | bool:
    """A number or truth value where the text is one: the text `false` would count as true."""
    return can.util.cast_from_string(text)


def check_names(options: dict[str, str | int | float | bool], interface: str) -> None:
    """BadInput with the nearest name for an option that would be ignored."""
    under = str(options.get("under", "virtual"))
    known = known_options(interface)
    if interface == FAULTY and known is not None:
        beneath = known_options(under)
        known = None if beneath is None else known | beneath | {*FIELD_TYPES, "under"}
    if known is None:
        return
    for name in options:
        if name not in known:
            raise BadInput(f"--bus-option {name}: {remedy_for(name, interface, under, known)}")


def remedy_for(name: str, interface: str, under: str, known: set[str]) -> str:
    """The remedy for an unknown option."""
    if name in OF_THE_RIG:
        return f"has an option of its own; give {OF_THE_RIG[name]}"
    if interface == FAULTY:
        return f"faulty over {under} has no such option; {nearest_of(name, known)}"
    if name in FIELD_TYPES or name == "under":
        return f"{interface} makes no faults; give --interface faulty --bus-option under={interface}"
    return f"{interface} has no such option; {nearest_of(name, known) if known else 'it has none'}"


def known_options(interface: str) -> set[str] | None:
    """Options of an interface's constructor and those of its bases: named, documented, or read from their **kwargs.
    None where the interface cannot be loaded: opening it gives the better message."""
    bus_class = class_of(interface)
    if bus_class is None:
        return None
    names: set[str] = set()
    for each in bus_class.__mro__:
        constructor = each.__dict__.get("__init__")
        if inspect.isfunction(constructor):
            names |= names_in(inspect.unwrap(constructor))
    if "timing" in names:  # python-can makes it of these
        names |= {*BitTimingDict.__annotations__, *BitTimingFdDict.__annotations__}
    return {name for name in names - NOT_FOR_TEXT if not name.startswith("_")}


def names_in(constructor: Callable[..., None]) -> set[str]:
    """Parameters by signature and by documentation, and keys that are read from **kwargs."""
    parameters = inspect.signature(constructor).parameters.values()
    names = {each.name for each in parameters if each.kind not in (each.VAR_KEYWORD, each.VAR_POSITIONAL)}
    names |= set(re.findall(r":param\s+(?:[^:\n]*\s)?(\w+)\s*:", constructor.__doc__ or ""))
    for rest in (each.name for each in parameters if each.kind is each.VAR_KEYWORD):
        names |= set(re.findall(rf"""\b{rest}(?:\.get\(|\.pop\(|\[)\s*["'](\w+)["']""", inspect.getsource(constructor)))
    return names


def class_of(interface: str) -> type | None:
    """The bus class; None when it or its library is missing: opening the bus gives the better message."""
    if interface not in BACKENDS:
        return None
    module, name = BACKENDS[interface]
    try:
        return getattr(importlib.import_module(module), name)
    except Exception:  # a driver that is not installed can fail in any way
        return None
