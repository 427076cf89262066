"""Copies and pickles of what the core keeps in C memory: each has memory of its own, also in another process.

    class Plant(OwnMemory): …               # copy.copy, copy.deepcopy and pickle of a plant
    register(core)                          # the same for saved states, which are bare structs of the core

A pickled struct is its bytes. Addresses of methods are pickled as distances within the core's library, so that only
the same build takes them; it is named by a checksum.
"""

from __future__ import annotations

import copy
import copyreg
import hashlib
import sys
from collections.abc import Iterator
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from laconic.base.paths import library
from laconic.errors import BadInput

if TYPE_CHECKING:
    from laconic.core import Core

METHOD = "struct laconic_method *"
NO_ADDRESS = -1
_cores: list[Core] = []  # whose structs are known

Own = TypeVar("Own", bound="OwnMemory")


class OwnMemory:
    """An object with C memory: each copy has its own, and so has what it watches, as a copy's plant."""

    RENEWED: ClassVar[dict[str, Any]] = {}
    """Attributes that a copy begins with anew, since they hold addresses of the original or what can be made again."""

    def __copy__(self: Own) -> Own:
        """As copy.deepcopy: what shared the memory would move with the original."""
        return copy.deepcopy(self)

    def __getstate__(self) -> dict[str, Any]:
        """All but what is renewed."""
        return {name: value for name, value in self.__dict__.items() if name not in self.RENEWED}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Takes what `__getstate__` gave."""
        self.__dict__.update(state)
        self.__dict__.update(copy.deepcopy(self.RENEWED))


class NotCopied:
    """An object that no copy can stand for; `REMEDY` is what to do instead."""

    REMEDY: ClassVar[str] = ""

    def __reduce_ex__(self, protocol: object) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled; {self.REMEDY}")


def register(core: Core) -> None:
    """Lets copy and pickle take structs of this core that Python owns; what other libraries own stays as it was."""
    _cores.append(core)
    copyreg.pickle(type(core.ffi.new("laconic_refusal *")), _reduced)


def _reduced(struct: Any) -> tuple[Any, ...]:
    for core in _cores:
        kind = core.ffi.typeof(struct)
        name = kind.item.cname.removeprefix("struct ") if kind.kind in ("pointer", "array") else ""
        if name.startswith("laconic_") and core.ffi.typeof(name) is kind.item:
            size = core.ffi.sizeof(kind.item) if kind.kind == "pointer" else core.ffi.sizeof(struct)
            count = None if kind.kind == "pointer" else len(struct)
            data = bytes(core.ffi.buffer(struct, size))
            return made_of, (core.real, name, count, *packed(core, name, data), build_of(core))
    raise TypeError(f"cannot pickle {type(struct).__name__!r} object")


def made_of(real: str, name: str, count: int | None, data: bytes, distances: tuple[int, ...], build: str) -> Any:
    """The struct, or the array of so many, that `_reduced` took apart."""
    from laconic.core.binding import load

    core = load(real)
    made = core.ffi.new(f"{name} *") if count is None else core.ffi.new(f"{name}[]", count)
    core.ffi.memmove(made, unpacked(core, name, data, distances, build), len(data))
    return made


def packed(core: Core, name: str, data: bytes) -> tuple[bytes, tuple[int, ...]]:
    """The bytes of structs with zeros for addresses, and what these point to."""
    bare, distances, base = bytearray(data), list[int](), _base(core)
    for place in _places(core, name, len(data)):
        address = int.from_bytes(bare[place], sys.byteorder)
        distances.append(address - base if address else NO_ADDRESS)
        bare[place] = bytes(place.stop - place.start)
    return bytes(bare), tuple(distances)


def unpacked(core: Core, name: str, data: bytes, distances: tuple[int, ...], build: str) -> bytes:
    """The bytes of structs as this process has them; BadInput for those of another build of the core."""
    if build != build_of(core):
        raise BadInput(f"pickle: holds a {name} of another build of laconic; make it anew, or unpickle it by the build "
                       "that pickled it")
    whole, base = bytearray(data), _base(core)
    for place, distance in zip(_places(core, name, len(data)), distances, strict=True):
        address = 0 if distance == NO_ADDRESS else base + distance
        whole[place] = address.to_bytes(place.stop - place.start, sys.byteorder)
    return bytes(whole)


@cache
def build_of(core: Core) -> str:
    """What names the build of a core: a checksum of its library."""
    return hashlib.sha256(library(f"laconic_{core.real}").read_bytes()).hexdigest()


def _base(core: Core) -> int:
    """Where the core's methods are in this process."""
    return int(core.ffi.cast("uintptr_t", core.method(core.method_names[0])))


def _places(core: Core, name: str, size: int) -> Iterator[slice]:
    """The addresses of methods in so many bytes of structs."""
    each, length = core.ffi.sizeof(name), core.ffi.sizeof("void *")
    for start in range(0, size, each):
        for offset in _offsets(core, name):
            yield slice(start + offset, start + offset + length)


@lru_cache(maxsize=64)
def _offsets(core: Core, name: str) -> tuple[int, ...]:
    return tuple(_offsets_in(core, core.ffi.typeof(name), name, 0))


def _offsets_in(core: Core, kind: Any, name: str, start: int) -> Iterator[int]:
    if kind.kind == "struct":
        for _, field in kind.fields:
            yield from _offsets_in(core, field.type, name, start + field.offset)
    elif kind.kind == "array":
        for item in range(kind.length if _has_addresses(kind.item) else 0):
            yield from _offsets_in(core, kind.item, name, start + item * core.ffi.sizeof(kind.item))
    elif kind.kind == "pointer" and kind.cname == METHOD:
        yield start
    elif kind.kind in ("pointer", "function"):
        raise TypeError(f"a {name} cannot be copied or pickled: it holds addresses; copy what it was made of")


def _has_addresses(kind: Any) -> bool:
    if kind.kind == "struct":
        return any(_has_addresses(field.type) for _, field in kind.fields)
    return _has_addresses(kind.item) if kind.kind == "array" else kind.kind not in ("primitive", "enum")
