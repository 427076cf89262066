"""Domain randomisation: vehicles whose numbers differ within spreads, drawn and prepared once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from laconic.core import Vehicle
from laconic.core.given import finite_number, shown, whole_number
from laconic.errors import BadInput
from laconic.scene.key_path import key_path
from laconic.scene.scene_tables import SceneTables, scene_tables

Spread = float | Sequence[float]
"""A share, 0.1 for ±10 % of the scene's value, or the least and the largest value themselves."""
MOST_VARIANTS = 10**5


def vehicles_of(scene: str | Path, spreads: Mapping[str, Spread], count: int, seed: int, real: str) -> list[Vehicle]:
    """`count` vehicles, drawn evenly within the spreads of keys of `[vehicle]`; one where there are no spreads.

    BadInput names a key that is not of the vehicle, a value that is no spread, and a number that makes no vehicle.
    """
    tables = scene_tables(scene)
    if whole_number("variant_seed", seed) < 0:
        raise BadInput(f"variant_seed: {seed} is below 0; give a whole number from 0 on")
    if not isinstance(spreads, Mapping) or not all(isinstance(key, str) for key in spreads):
        raise BadInput(f"spreads: {shown(spreads)} is no mapping from keys to spreads; give one such as "
                       "{\"vehicle.mass_kg\": 0.2}")
    if not 1 <= whole_number("variants", count) <= MOST_VARIANTS:
        raise BadInput(f"variants: {count} is not from 1 to {MOST_VARIANTS}; give how many vehicles to draw")
    if not spreads:
        return [Vehicle(tables.scene().vehicle, real)]
    ranges = {key: _range_of(tables, key, spread) for key, spread in spreads.items()}
    drawn = np.random.default_rng(seed).uniform(size=(count, len(ranges)))
    return [_vehicle(tables, {key: low + float(share) * (high - low)
                              for share, (key, (low, high)) in zip(shares, ranges.items(), strict=True)}, real)
            for shares in drawn]


def _range_of(tables: SceneTables, key: str, spread: Any) -> tuple[float, float]:
    name = f"spreads[{shown(key)}]"
    path = key_path(key)
    if path.tables[:1] != (("vehicle", None),) or path.known.kind != "number":
        raise BadInput(f"{name}: is no number of the vehicle; give keys such as vehicle.mass_kg")
    if isinstance(spread, Sequence) and not isinstance(spread, str):
        if len(spread) != 2 or not finite_number(name, spread[0]) <= finite_number(name, spread[1]):
            raise BadInput(f"{name}: {list(spread)} is no range; give the least value and the largest")
        return float(spread[0]), float(spread[1])
    share, value = finite_number(name, spread), tables.value(path)
    if not 0 <= share < 1:
        raise BadInput(f"{name}: {share:g} is no share; give 0 to below 1, or the least value and the largest")
    if not isinstance(value, (int, float)) or value == 0:
        raise BadInput(f"{name}: the scene has no value of which {share:g} would be a share; give the least value and "
                       "the largest")
    return tuple(sorted((value * (1 - share), value * (1 + share))))  # type: ignore[return-value]


def _vehicle(tables: SceneTables, values: Mapping[str, float], real: str) -> Vehicle:
    return Vehicle(tables.with_values(values).scene().vehicle, real)
