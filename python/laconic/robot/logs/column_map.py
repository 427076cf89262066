"""A map: which column of a log is what, in which unit. A small TOML file; docs/logs.md explains its keys."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from laconic.errors import BadInput, shown
from laconic.robot.logs.log import COMMANDED, PER_WHEEL, STEERING
from laconic.robot.logs.quantity import (
    YAW_RATE,
    Quantity,
    channel_of,
    is_numbered,
    quantity_of,
    shorthand,
    single_of,
    time_of,
)
from laconic.scene.table import Table, read_map_toml

MAPS = Path(__file__).with_name("maps")
FORMATS = ("text", "can", "bag", "mat")
DECIMALS = (".", ",")
KEYS = {"separator": "text", "header_lines": "text", "names_line": "text", "decimal": "text", "keyword_column": "text",
        "dbc": "can", "group": "can", "channel": "can", "joints": "bag", "imu": "bag", "stamps": "bag"}
"""Keys that one format alone reads."""
STAMPS = ("header", "arrival")
QUANTITIES = (*PER_WHEEL, STEERING, COMMANDED, "pose", YAW_RATE)


@dataclass(frozen=True)
class ColumnMap:
    """A whole map."""

    path: Path
    name: str
    format: str
    separator: str
    header_lines: int
    names_line: int
    decimal: str                       # the sign before the decimals of a number, one of DECIMALS
    quantities: dict[str, Quantity]
    metadata: str = ""                 # name of the file beside the log
    dbc: str = ""
    group: str = ""                    # CAN: signal that says which wheels a frame is of
    recognise: dict[str, Any] = field(default_factory=dict)
    channel: str = ""                  # CAN: of the bus that all frames are from, unless a quantity names its own
    keyword_column: int = 0            # with a word that says what the line holds; 0: all lines hold the same
    stamps: str = "header"             # bags: whose instants count, one of STAMPS
    notes: tuple[str, ...] = ()        # on what is uncertain about a guess
    is_guess: bool = False             # nobody wrote it: the log's own names were taken for what they say


def project_maps() -> list[ColumnMap]:
    """The maps that come with the project, by name."""
    return [read_map(path) for path in sorted(MAPS.glob("*.toml"))]


def map_names() -> list[str]:
    """The names by which --map takes the project's maps."""
    return [path.stem for path in sorted(MAPS.glob("*.toml"))]


def named_map(given: Path) -> Path:
    """A map by its path, or by the name of one that comes with the project."""
    named = MAPS / f"{given}.toml"
    return named if given.name == str(given) and not given.is_file() and named.exists() else given


def read_map(path: Path) -> ColumnMap:
    """A column map; BadInput names the file and the key that is wrong."""
    return map_of(read_map_toml(path))


def map_of(table: Table) -> ColumnMap:
    """A column map by the table of its file."""
    path, form = table.path, table.choice("format", FORMATS, "text")
    _refuse_keys_of_others(table, form)
    name = table.text("name", path.stem)
    separator = table.text("separator", ",", allowed="\t")
    header_lines = table.whole("header_lines", 1)
    names_line = table.whole("names_line", min(1, header_lines))
    decimal = table.choice("decimal", DECIMALS, ".")
    keyword_column = table.whole("keyword_column", 0)
    dbc, group, channel = table.text("dbc", ""), table.text("group", ""), channel_of(table, form)
    if form == "can" and not dbc:
        table.fail("dbc", "is missing; give the DBC file that names the signals of a CAN log")
    metadata = _metadata(table)
    stamps = table.choice("stamps", STAMPS, STAMPS[0])
    quantities = {"time": time_of(table, form)}
    count: int | None = None
    if form == "bag":
        quantities |= shorthand(table)
    for each in QUANTITIES:
        if each in PER_WHEEL and each in quantities and table.has(each):
            quantities[each] = _of_joints(table.table(each), quantities[each], form)
        elif each == YAW_RATE and each in quantities and table.has(each):
            table.fail(each, "is given besides imu; keep the table, and name the field there: "
                       'column = "/imu.angular_velocity.z"')
        elif table.has(each) and each not in quantities:
            inner = table.table(each)
            found = single_of(inner, each, form) if each in (YAW_RATE, COMMANDED) else quantity_of(
                inner, each, None if each == STEERING else count, form)
            quantities[each] = found
            if each in PER_WHEEL and not found.first and not is_numbered(found.columns):
                count = count or len(found.members or found.columns)
    recognise = _recognise(table)
    table.done()
    if len(separator) != 1 or separator == '"':
        table.fail("separator", f"is {separator!r}; give one character, which is not a quotation mark")
    if separator == decimal:
        table.fail("decimal", f"is {shown(decimal)}, which separates the columns, too; give the log's own separator")
    if not 0 <= names_line <= header_lines:
        raise BadInput(f"{path}: names_line: is {names_line}; give a line from 1 to header_lines")
    if len(quantities) == 1:
        raise BadInput(f"{path}: {QUANTITIES[1]}: is missing; give the columns of at least one of "
                       f"{', '.join(QUANTITIES)}")
    found_map = ColumnMap(path, name, form, separator, header_lines, names_line, decimal, quantities, metadata, dbc,
                          group, recognise, channel, keyword_column, stamps)
    _check_columns(table, found_map)
    return found_map


def _refuse_keys_of_others(table: Table, form: str) -> None:
    """A key that this format would not read."""
    without_time = ("can", "bag")
    for key, owner in (*KEYS.items(), *((("time", "text"),) if form in without_time else ())):
        if form != owner and table.has(key):
            table.fail(key, f'has a meaning only with format = "{owner}"; take it out, or give that format')


def _metadata(table: Table) -> str:
    if not table.has("metadata"):
        return ""
    inner = table.table("metadata")
    file = inner.text("file")
    inner.done()
    return file


def _of_joints(inner: Table, joints: Quantity, form: str) -> Quantity:
    """What a table says of wheels whose columns `joints` names: signs, gears, wrap."""
    entries = {"columns": list(joints.columns), "unit": joints.units[0]} | inner.plain()
    return replace(quantity_of(Table(inner.path, inner.location, entries), joints.name, len(joints.columns), form),
                   is_optional=joints.is_optional)


def _recognise(table: Table) -> dict[str, Any]:
    inner = table.table("recognise")
    found = {"file": inner.text("file", ""), "beside": inner.text("beside", ""), "names": inner.texts("names", ())}
    inner.done()
    return {key: value for key, value in found.items() if value}


def _check_columns(table: Table, found: ColumnMap) -> None:
    for quantity in found.quantities.values():
        for figure in (quantity.ticks_per_turn, quantity.gear_ratio):
            if isinstance(figure, str) and not found.metadata:
                table.fail(f"{quantity.name}",
                           f"takes {shown(figure)} from a metadata file; name it in [metadata] file")
        named = [column for column in quantity.columns if isinstance(column, str)]
        if named and found.format == "text" and not found.names_line:
            table.fail(f"{quantity.name}.columns", f"names {shown(named[0])}, but the log has no line of names; give "
                       "the columns by number, or names_line")
        if quantity.keyword and not found.keyword_column:
            table.fail(f"{quantity.name}.rows", "needs keyword_column, the number of the column with this word")
        if found.format == "bag":
            for column in quantity.columns:
                if not isinstance(column, str) or "." not in column.partition("[")[0]:
                    table.fail(f"{quantity.name}.columns", f"holds {shown(column)}; give /topic.field")
        if found.format == "can":
            for column in quantity.columns:
                if not isinstance(column, str) or column.count(".") != 1:
                    table.fail(f"{quantity.name}.columns", f"holds {shown(column)}; give MESSAGE.signal of the DBC")


def fits(found: ColumnMap, path: Path, names: list[str]) -> bool:
    """Whether a map recognises a file by its name, by the file beside it and by the names of its columns."""
    wanted = found.recognise
    if not wanted:
        return False
    return ((not wanted.get("file") or any(fnmatch(path.name, each) for each in wanted["file"].split("|")))
            and (not wanted.get("beside") or (path.parent / wanted["beside"]).exists())
            and set(wanted.get("names", ())) <= set(names))
