"""Saved states that a program gives back: their numbers are finite, as all are that the core saved.

    check_saved(core, "state", plant.save())      # BadInput: "state.x_m.value: nan is not finite; …"

The members are public and may be written; a number that the core would carry on with without a word is refused here.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.errors import BadInput

if TYPE_CHECKING:
    from laconic.core import Core


def check_saved(core: Core, name: str, saved: Any) -> None:
    """BadInput names the first real number of a struct of the core that is infinite or NaN."""
    names, places = _reals_of(core, core.ffi.typeof(saved))
    numbers = np.frombuffer(core.ffi.buffer(core.ffi.addressof(saved)), core.dtype)[places]
    if not np.isfinite(numbers).all():
        first = int(np.flatnonzero(~np.isfinite(numbers))[0])
        raise BadInput(f"{name}.{names[first]}: {numbers[first]} is not finite; give what save() gave, unchanged")


@lru_cache(maxsize=32)
def _reals_of(core: Core, kind: Any) -> tuple[tuple[str, ...], np.ndarray]:
    """Names and places, counted in real numbers, of all in a struct."""
    names, offsets = zip(*_reals(core, kind, "", 0), strict=True)
    return names, np.array(offsets) // core.dtype.itemsize


def _reals(core: Core, kind: Any, name: str, offset: int) -> Iterator[tuple[str, int]]:
    if kind.kind == "struct":
        for member, field in kind.fields:
            yield from _reals(core, field.type, f"{name}.{member}" if name else member, offset + field.offset)
    elif kind.kind == "array":
        size = core.ffi.sizeof(kind.item)
        for item in range(kind.length):
            yield from _reals(core, kind.item, f"{name}[{item + 1}]", offset + item * size)
    elif kind.cname in ("float", "double"):
        yield name, offset
