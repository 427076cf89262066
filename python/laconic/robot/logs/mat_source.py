"""A MATLAB file as a table: vectors of numbers by their names, those inside structures by the path to them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput, nearest_of, reason_of, shown
from laconic.robot.logs.column_map import ColumnMap
from laconic.robot.logs.log import LEAST_SAMPLES
from laconic.robot.logs.quantity import NUMBERED, Column, Quantity
from laconic.robot.logs.sources import Raw, Source, checked_time
from laconic.robot.logs.units import ISO, TIME

HDF5_MAGIC = b"\x89HDF"
MOST_COLUMNS = 64     # of one matrix
GIVE = "give a MATLAB file with vectors of numbers"


def read_mat(path: Path) -> dict[str, np.ndarray]:
    """All vectors and the columns of matrices, by name[number]; BadInput for a file that cannot be read."""
    try:
        with path.open("rb") as file:
            begin = file.read(520)
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); {GIVE}") from None
    found: dict[str, np.ndarray] = {}
    for name, value in (_of_hdf5(path) if HDF5_MAGIC in begin else _of_version_5(path)).items():
        _collect(name, value, found)
    if not found:
        raise BadInput(f"{path}: holds no vector of numbers; save time, wheels and pose as plain arrays, or as fields "
                       "of a structure")
    return found


def _of_version_5(path: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat

    try:
        content: dict[str, Any] = loadmat(str(path), simplify_cells=True)
    except Exception:  # of the library: broken bytes have many kinds of errors
        raise BadInput(f"{path}: is no MATLAB file that can be read; {GIVE}") from None
    return {name: value for name, value in content.items() if not name.startswith("__")}


def _of_hdf5(path: Path) -> Mapping[str, Any]:
    """Version 7.3."""
    import h5py

    found: dict[str, Any] = {}

    def take(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiub" and not name.startswith("#"):
            found[name.replace("/", ".")] = np.asarray(item).T

    try:
        with h5py.File(path, "r") as file:
            file.visititems(take)
    except Exception:  # of the library: broken bytes have many kinds of errors
        raise BadInput(f"{path}: is no MATLAB file that can be read; {GIVE}") from None
    return found


def _collect(name: str, value: Any, found: dict[str, np.ndarray]) -> None:
    if isinstance(value, dict):
        for key, inner in value.items():
            _collect(f"{name}.{key}", inner, found)
        return
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "fiub":
        return
    if value.ndim == 2 and 1 in value.shape:
        value = value.ravel()
    if value.ndim == 1 and len(value) > 1:
        found[name] = value.astype(float)
    elif value.ndim == 2:
        table = value if value.shape[0] >= value.shape[1] else value.T
        for index in range(min(table.shape[1], MOST_COLUMNS)):
            found[f"{name}[{index + 1}]"] = table[:, index].astype(float)


def mat_source(path: Path, columns: ColumnMap) -> Source:
    """A MATLAB file by a map; a quantity with a time of its own is joined to the others."""
    vectors = read_mat(path)
    of_time = columns.quantities["time"]
    main = _seconds(path, of_time, [_vector(path, vectors, each, "time") for each in of_time.columns])
    rows = list(map(str, range(1, len(main) + 1)))
    main = checked_time(path, of_time, main, [int(row) for row in rows])
    others = {each.name: _own_time(path, vectors, of_time, each) for each in columns.quantities.values() if each.time}
    instants = np.unique(np.concatenate([main, *others.values()]))

    def raw(quantity: Quantity) -> Raw | None:
        names = _numbered(quantity, vectors)
        if quantity.is_optional and (not names or any(str(name) not in vectors for name in names)):
            return None
        own = others.get(quantity.name, main)
        found = np.full((len(instants), len(names)), np.nan)
        for index, name in enumerate(names):
            vector = _vector(path, vectors, name, quantity.name)
            if len(vector) != len(own):
                raise BadInput(f"{path}: {name} (for {quantity.name}) has {len(vector)} values and its time {len(own)}"
                               f"; give time under [{quantity.name}] in the map, the name of its own instants")
            found[np.searchsorted(instants, own), index] = vector
        if np.isinf(found).any():
            raise BadInput(f"{path}: {quantity.name} is not finite in places; remove those samples")
        return found, [repr(str(name)) for name in names]

    is_row = np.isin(instants, main) if others else None
    return Source(path, instants - instants[0], raw, lambda row: f"sample {row + 1}", is_row,
                  lines=lambda given: f"{len(given)} samples are", tells_gaps=bool(others))


def _own_time(path: Path, vectors: Mapping[str, np.ndarray], of_time: Quantity, quantity: Quantity) -> np.ndarray:
    found = _seconds(path, of_time, [_vector(path, vectors, quantity.time, quantity.name)])
    return checked_time(path, of_time, found, list(range(1, len(found) + 1)))


def _seconds(path: Path, of_time: Quantity, vectors: list[np.ndarray]) -> np.ndarray:
    if of_time.units[0] == ISO:
        raise BadInput(f"{path}: time: numbers are no dates; give unit as one of {', '.join(TIME)}")
    if len({len(each) for each in vectors}) > 1 or len(vectors[0]) < LEAST_SAMPLES:
        raise BadInput(f"{path}: time has {len(vectors[0])} samples; needs at least {LEAST_SAMPLES} in each column")
    parts = [each * TIME[unit] for each, unit in zip(vectors, of_time.units, strict=False)]
    found: np.ndarray = sum(parts[1:], parts[0]) * of_time.scales[0]
    if not np.isfinite(found).all():
        raise BadInput(f"{path}: time is not finite in places; remove those samples")
    return found


def _vector(path: Path, vectors: Mapping[str, np.ndarray], name: Column, quantity: str) -> np.ndarray:
    found = vectors.get(str(name))
    if found is None:
        some = ", ".join(list(vectors)[:20]) + (" …" if len(vectors) > 20 else "")
        raise BadInput(f"{path}: has no vector {shown(name)} (for {quantity}); correct the map "
                       f"({nearest_of(str(name), vectors, f'it has {some}')})")
    return found


def _numbered(quantity: Quantity, vectors: Mapping[str, np.ndarray]) -> list[Column]:
    """The columns; a name with # stands for those of wheel 1, 2 … as far as they are there."""
    name = str(quantity.columns[0]) if quantity.columns else ""
    if len(quantity.columns) != 1 or NUMBERED not in name:
        return list(quantity.columns)
    found: list[Column] = []
    while (column := name.replace(NUMBERED, str(len(found) + 1))) in vectors:
        found.append(column)
    return found or ([] if quantity.is_optional else [name.replace(NUMBERED, "1")])
