"""Finds the logs among files and folders, and for each the map of the project that recognises it.

The folder formats reads each: text_table.py text, bag_source.py recordings of topics; can_frames.py chooses the reader
of a CAN log.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from laconic.base.paths import exists
from laconic.errors import BadInput
from laconic.robot.bags.messages import ENDINGS as OF_BAG
from laconic.robot.bags.messages import OF_ROSBAG2, is_bag
from laconic.robot.logs.column_map import ColumnMap, fits, project_maps, read_map
from laconic.robot.logs.formats.text_table import text_of
from laconic.robot.logs.guess import Guess
from laconic.robot.logs.log import Log
from laconic.robot.logs.read import read_log
from laconic.robot.logs.sources import numbered
from laconic.scene.table import read_map_toml

ENDINGS = (".csv", ".csv.gz", ".txt", ".blf", ".asc")
OF_CAN = (*ENDINGS[3:], ".log", ".trc", ".mf4", ".asc.gz", ".blf.gz", ".log.gz", ".trc.gz")
OF_TEXT = ENDINGS[:3]
OF_SIGNALS = "laconic"      # the map of what `laconic simulate` writes
PARTS = (" x", " y", " heading")
OF_FORMAT = {"can": OF_CAN, "text": OF_TEXT, "bag": OF_BAG, "mat": (".mat",)}
"""The endings that a map of each format looks for in a folder."""


def natural(path: Path) -> list[object]:
    """Sorting key: numbers inside names by their value."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", str(path))]


def gather_logs(given: Sequence[Path], map_path: Path | None = None) -> tuple[list[Log], list[Path]]:
    """(every run, files of folders that are none); a file that was named itself must be a run."""
    maps = [read_map(map_path)] if map_path else project_maps()
    logs, skipped = [], []
    endings = (*ENDINGS, *OF_BAG) if map_path is None else OF_FORMAT[maps[0].format]
    for path in files_of(given, endings):
        if map_path is None and is_bag(path):
            from laconic.robot.logs.inspection import map_of_bag  # which the project's own logs do not need

            logs.append(read_log(path, map_of_bag(path)))
            continue
        if (columns := map_for(path, maps, is_given=map_path is not None)) is None:
            if path in given:
                raise unknown(path, maps)
            if path.name not in {each.metadata for each in maps}:
                skipped.append(path)
            continue
        try:
            logs.append(read_log(path, columns))
        except BadInput as reason:
            if path in given or "has no column" not in str(reason):
                raise
            skipped.append(path)
    if not logs:
        raise BadInput(f"{given[0] if given else 'LOG'}: holds no log that a map recognises; give another folder, or "
                       "the map of its columns with --map")
    return logs, skipped


def files_of(given: Sequence[Path], endings: tuple[str, ...] = ENDINGS) -> list[Path]:
    """Files as they are named, and those of folders with the ending of a log, sorted by the numbers in their names."""
    found: list[Path] = []
    for path in given:
        if exists(path) and path.is_dir():
            inside = [path] if set(OF_BAG) & set(endings) and is_bag(path) else _inside(path, endings)
            if not inside:
                raise BadInput(f"{path}: holds no {_in_words(endings)}; give a folder with recorded runs")
            found += sorted(inside, key=natural)
        else:
            found.append(path)
    return list(dict.fromkeys(found))


def _inside(folder: Path, endings: tuple[str, ...]) -> list[Path]:
    """The logs in a folder; the files of a rosbag2 are one log, their own folder."""
    found = [each for each in folder.rglob("*") if each.is_file() and each.name.lower().endswith(endings)]
    return [each.parent if each.name.lower().endswith(OF_ROSBAG2) and (each.parent / "metadata.yaml").is_file()
            else each for each in found]


def _in_words(endings: tuple[str, ...]) -> str:
    return {OF_CAN: "BLF, ASC, candump or TRC file", OF_TEXT: "CSV file", OF_BAG: "rosbag, MCAP or ULog",
            (".mat",): "MATLAB file"}.get(endings, "CSV file, BLF or ASC file, rosbag, MCAP or ULog")


def map_for(path: Path, maps: Sequence[ColumnMap], *, is_given: bool) -> ColumnMap | None:
    """The first map that recognises a file; a map that was given is taken for every file but its own metadata."""
    if is_given:
        return None if maps[0].metadata and path.name == maps[0].metadata else maps[0]
    return next((each for each in maps if fits(each, path, _names(path, each))), None)


def _names(path: Path, columns: ColumnMap) -> list[str]:
    """The names of the columns in all header lines that this map expects; none where it takes none."""
    if columns.format == "can" or not columns.recognise.get("names"):
        return []
    try:
        lines = text_of(path).lines[: columns.header_lines]
    except BadInput:
        return []
    return [name.strip().strip('"') for line in lines for name in line.split(columns.separator)]


def known_guess(path: Path, names: Sequence[str]) -> Guess | None:
    """What a map of the project says about a text log; None if no such map finds wheels in it.
    `names`: of its columns."""
    known = map_for(path, [each for each in project_maps() if each.format == "text"], is_given=False)
    if known is None:
        return None
    what = "the columns are signals of laconic simulate" if known.path.stem == OF_SIGNALS else \
        f"the project's map {known.path.stem} recognises this log"
    found = Guess(notes=[f"{what}: no map needed by replay, identify and audit"])
    tables = read_map_toml(known.path).plain()
    found.entries = {key: value for key, value in tables.items() if key not in ("name", "recognise")}
    for key, quantity in known.quantities.items():
        columns = range(quantity.first, len(names) + 1) if quantity.first else numbered(quantity, names)
        labels = [each if isinstance(each, str) else names[each - 1] for each in columns
                  if isinstance(each, str) or each <= len(names)]
        if quantity.is_optional and not (labels and set(labels) <= set(names)):
            del found.entries[key]
            continue
        if "#" in str(tables[key].get("columns", "")):
            found.entries[key] = {"columns": labels}
        units = quantity.units if len(quantity.units) == len(labels) else quantity.units[:1] * len(labels)
        parts = PARTS if key == "pose" and len(labels) == len(PARTS) else [""] * len(labels)
        found.meaning |= {label: f"{key}{part} [{unit}]"
                          for label, part, unit in zip(labels, parts, units, strict=True)}
    return found if {"wheel_angle", "wheel_speed"} & set(found.entries) else None


def unknown(path: Path, maps: Sequence[ColumnMap]) -> BadInput:
    """Why a file is no log: it cannot be read, or no map knows it."""
    if path.suffix.lower() == ".mat":
        return BadInput(f"{path}: is a MATLAB file, which needs its map: give it with --map (`laconic logs {path.name} "
                        "-o map.toml` guesses one)")
    try:
        if not text_of(path).text.strip():
            return BadInput(f"{path}: is empty, so it has no samples; give a recorded run")
    except BadInput as reason:
        return reason
    return BadInput(f"{path}: no map recognises it (known are {', '.join(each.name for each in maps)}); a CSV of "
                    "signals has the first column time_s and commas between columns, other columns need their map: "
                    "give it with --map (`laconic logs` guesses one)")
