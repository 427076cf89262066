"""Populations whose vehicles differ in their numbers: C structs as numpy arrays, one item for each vehicle.

    vehicles = copies_of(core, "laconic_vehicle", vehicle.c, 1000)
    vehicles["mass_kg"] = masses                        # (1000,)
    kinds = Kinds.of(core, vehicles, "auto", 1e-3)
    batch = Batch.of_kinds(kinds.usable())
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.copies import build_of, packed, unpacked

if TYPE_CHECKING:
    from laconic.batch.lanes import Batch
    from laconic.core import Core

KIND = "laconic_batch_kind"


@cache
def struct_dtype(core: Core, name: str) -> np.dtype[Any]:
    """The layout of a C struct: its members by their names, arrays as such."""
    return _dtype_of(core.ffi, core.ffi.typeof(name))


def _dtype_of(ffi: Any, ctype: Any) -> np.dtype[Any]:
    if ctype.kind == "array":
        return np.dtype((_dtype_of(ffi, ctype.item), (ctype.length,)))
    if ctype.kind == "struct":
        members = list(ctype.fields)
        return np.dtype({"names": [name for name, _ in members],
                         "formats": [_dtype_of(ffi, member.type) for _, member in members],
                         "offsets": [member.offset for _, member in members], "itemsize": ffi.sizeof(ctype)})
    size = ffi.sizeof(ctype)
    if ctype.kind == "primitive" and ctype.cname in ("float", "double"):
        return np.dtype(f"f{size}")
    is_bool = ctype.cname in ("_Bool", "bool")
    return np.dtype("?" if is_bool else f"u{size}" if ctype.kind == "pointer" else f"i{size}")


def zeros(core: Core, name: str, count: int) -> np.ndarray:
    """So many structs of all zero."""
    return np.zeros(count, struct_dtype(core, name))


def copies_of(core: Core, name: str, given: Any, count: int) -> np.ndarray:
    """So many copies of one struct, bit by bit."""
    one = np.frombuffer(core.ffi.buffer(given, core.ffi.sizeof(name)), np.uint8)
    return np.tile(one, count).view(struct_dtype(core, name))


def items_of(core: Core, name: str, array: np.ndarray | None) -> Any:
    """The array as C sees it; NULL for None."""
    return core.ffi.NULL if array is None else core.ffi.from_buffer(f"{name}[]", array)


@dataclass(frozen=True)
class Kinds:
    """What laconic_batch_kinds_of() made of an array of vehicles; `status` is 0 for those that can be stepped."""

    core: Core
    kinds: np.ndarray   # (count,)  laconic_batch_kind
    status: np.ndarray  # (count,)  int32
    wheel_count: int
    step_s: float

    @classmethod
    def of(cls, core: Core, vehicles: np.ndarray, method: str, step_s: float,
           motors: np.ndarray | None = None) -> Kinds:
        """Kinds of vehicles; motors: one for each, which the core fits to it first. BadInput for an unknown method."""
        kinds, status = zeros(core, "laconic_batch_kind", len(vehicles)), np.zeros(len(vehicles), np.int32)
        core.lib.laconic_batch_kinds_of(
            items_of(core, "laconic_batch_kind", kinds), items_of(core, "int32_t", status),
            items_of(core, "laconic_vehicle", vehicles), items_of(core, "laconic_motor", motors), len(vehicles),
            core.method(method), step_s)
        return cls(core, kinds, status, int(vehicles["wheel_count"].max()), step_s)

    def __reduce__(self) -> tuple[Any, ...]:
        """By their bytes, in which another process finds its own methods."""
        bare = packed(self.core, KIND, self.kinds.tobytes())
        return Kinds.of_bytes, (self.core, *bare, build_of(self.core), self.status, self.wheel_count, self.step_s)

    @classmethod
    def of_bytes(cls, core: Core, data: bytes, distances: tuple[int, ...], build: str, status: np.ndarray,
                 wheel_count: int, step_s: float) -> Kinds:
        """Those that were pickled."""
        whole = bytearray(unpacked(core, KIND, data, distances, build))
        return cls(core, np.frombuffer(whole, struct_dtype(core, KIND)), status, wheel_count, step_s)

    def usable(self) -> Kinds:
        """Those that were not refused."""
        good = self.status == 0
        kinds = self.kinds if good.all() else self.kinds[good]
        return Kinds(self.core, kinds, self.status[good], self.wheel_count, self.step_s)


def contacts_of(core: Core, vehicles: np.ndarray, motors: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Contacts of vehicles with their ground, and the status of each."""
    contacts, status = zeros(core, "laconic_contact", len(vehicles)), np.zeros(len(vehicles), np.int32)
    core.lib.laconic_batch_contacts_of(items_of(core, "laconic_contact", contacts), items_of(core, "int32_t", status),
                                       items_of(core, "laconic_vehicle", vehicles),
                                       items_of(core, "laconic_motor", motors), len(vehicles))
    return contacts, status


def start_lanes(batch: Batch, starts: np.ndarray) -> np.ndarray:
    """Puts every lane at its start (lanes,) of laconic_start; returns a copy of each lane's status."""
    core = batch.core
    core.lib.laconic_batch_start(batch.c, 0, len(starts), items_of(core, "laconic_start", starts))
    return batch.status.copy()


def outputs_of(batch: Batch, outputs: np.ndarray, contacts: np.ndarray | None = None) -> None:
    """Fills (lanes,) of laconic_outputs with what each lane shows now; with contacts the reactions, too."""
    core = batch.core
    core.lib.laconic_batch_outputs(batch.c, 0, len(outputs), items_of(core, "laconic_contact", contacts),
                                   items_of(core, "laconic_outputs", outputs))
