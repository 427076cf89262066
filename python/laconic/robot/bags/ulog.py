"""ULog of PX4: topics with flat fields, each with the autopilot's own clock."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput, nearest_of
from laconic.robot.bags.recording import GIVE

CLOCK = "timestamp"


def load_ulog(path: Path, names: Sequence[str] | None = None) -> Any:
    """The file, with the data of some topics alone; BadInput for one that cannot be read."""
    from pyulog import ULog

    try:
        with redirect_stdout(io.StringIO()):  # it prints warnings of its own, and states the same as file_corruption
            return ULog(str(path), names, disable_str_exceptions=True)
    except Exception:  # of the library: broken bytes have many kinds of errors
        raise BadInput(f"{path}: is no ULog that can be read; {GIVE}") from None


def name_of(dataset: Any) -> str:
    """vehicle_odometry, and its second instance vehicle_odometry#1."""
    return dataset.name + (f"#{dataset.multi_id}" if dataset.multi_id else "")


def read_ulog(path: Path, wanted: Mapping[str, Sequence[str]]) -> Any:
    """Some fields of some topics."""
    from laconic.robot.bags.samples import Found, Samples

    log = load_ulog(path, [name.partition("#")[0] for name in wanted])
    sets = {name_of(each): each for each in log.data_list}
    found = {}
    for name, fields in wanted.items():
        if name not in sets:
            known = sets or {each.message_name for each in load_ulog(path).logged_messages}
            raise BadInput(f"{path}: has no topic {name}; correct the map "
                           f"({nearest_of(name, known, f'it has {chr(44).join(sorted(known)[:20])}')})")
        data = sets[name].data
        columns = [np.asarray(data[each], float) if each in data else None for each in fields]
        missing = next((each for each, column in zip(fields, columns, strict=True) if column is None), None)
        if missing is not None:
            raise BadInput(f"{path}: {name} has no field {missing}; {nearest_of(missing, data)}")
        stamp = np.asarray(data[CLOCK], np.int64) * 1000
        stamp, first = np.unique(stamp, return_index=True)
        values = np.column_stack([each for each in columns if each is not None])[first] if columns else \
            np.zeros((len(stamp), 0))
        found[name] = Samples(name, stamp, stamp, values, True)
    remarks = [f"{path.name}: {len(log.dropouts)} dropouts"] if log.dropouts else []
    if log.file_corruption:
        remarks.append(f"{path.name} is broken in places; what can be read is taken")
    return Found(found, {}, tuple(remarks))


def topics_of_ulog(path: Path) -> dict[str, Any]:
    """All topics by name, each with its dataset."""
    return {name_of(each): each for each in load_ulog(path).data_list}
