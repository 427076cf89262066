"""Keys that name one number twice: by [*] and an index, in radians and degrees, a place in two kinds of coordinates."""

from __future__ import annotations

from collections.abc import Sequence

from laconic.core.fields import WHEEL
from laconic.errors import BadInput
from laconic.scene.key_path import EVERY, KeyPath

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
