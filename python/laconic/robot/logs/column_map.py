"""A map: which column of a log is what, in which unit. A small TOML file; docs/logs.md explains its keys."""

from __future__ import annotations

from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from laconic.errors import BadInput, nearest_of, shown
from laconic.robot.logs.log import PER_WHEEL, POINTS
from laconic.robot.logs.units import ANGLE, OF_QUANTITY, TICK
from laconic.scene.map_toml import read_map_toml
from laconic.scene.table import Table

MAPS = Path(__file__).with_name("maps")
FORMATS = ("text", "can")
DECIMALS = (".", ",")
OF_TEXT = ("separator", "header_lines", "names_line", "decimal", "time")
OF_CAN = ("dbc", "group", "channel")
YAW_RATE = "yaw_rate"
QUANTITIES = (*PER_WHEEL, "pose", YAW_RATE)
KINDS = {"wheel_angle": ("absolute", "increments"), "pose": ("absolute", "increments", "body-increments")}
MOST_WHEELS = 1000
NUMBERED = "#"  # in a column's name: one column for each wheel, counted from 1

Column = str | int
Figure = float | str
"""A number, or the name of a row of the metadata file that holds it."""


@dataclass(frozen=True)
class Quantity:
    """The columns of one quantity and what brings them to SI units at the wheel: scale · unit · value + offset."""

    name: str
    columns: tuple[Column, ...]
    units: tuple[str, ...]
    scales: tuple[float, ...] = (1.0,)
    offsets: tuple[float, ...] = (0.0,)
    kind: str = "absolute"
    ticks_per_turn: Figure | None = None
    gear_ratio: Figure = 1.0
    wheels: tuple[int, ...] = ()       # wheel of the scene that each column is of, from 1; empty: in the scene's order
    first: int = 0                     # instead of columns: this one and all after it
    is_optional: bool = False
    sign_from_set_speed: bool = False
    point: str = "origin"
    wrap: float | bool | None = None   # where the column begins again; True: after one turn, False: never, None: unsaid
    channels: tuple[str, ...] = ()     # CAN: of the bus that the frames are from, one for all columns or for each

    def channel_of(self, index: int, usual: str) -> str:
        """The channel of a column; empty: the only one of the log."""
        return self.channels[index if len(self.channels) > 1 else 0] if self.channels else usual


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
    table = read_map_toml(path)
    form = table.choice("format", FORMATS, "text")
    _refuse_keys_of_others(table, form)
    name = table.text("name", path.stem)
    separator = table.text("separator", ",", allowed="\t")
    header_lines = table.whole("header_lines", 1)
    names_line = table.whole("names_line", min(1, header_lines))
    decimal = table.choice("decimal", DECIMALS, ".")
    dbc, group, channel = table.text("dbc", ""), table.text("group", ""), _channel(table, form)
    if form == "can" and not dbc:
        table.fail("dbc", "is missing; give the DBC file that names the signals of a CAN log")
    metadata = _metadata(table)
    quantities = {"time": _time(table, form)}
    count: int | None = None
    for each in QUANTITIES:
        if table.has(each):
            inner = table.table(each)
            found = _yaw_rate(inner, form) if each == YAW_RATE else _quantity(inner, each, count, form)
            quantities[each] = found
            if each in PER_WHEEL and not found.first and not _is_numbered(found.columns):
                count = count or len(found.columns)
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
                          group, recognise, channel)
    _check_columns(table, found_map)
    return found_map


def _refuse_keys_of_others(table: Table, form: str) -> None:
    """A key that this format would not read."""
    for key in OF_TEXT if form == "can" else OF_CAN:
        if table.has(key):
            table.fail(key, f'has a meaning only with format = "{"text" if form == "can" else "can"}"; take it out, or '
                       "give that format")


def _channel(table: Table, form: str) -> str:
    """The channel of a CAN log as it is written there: a number, or a name such as can0."""
    value = table.value("channel", "", (str, int), "the channel of the log, such as 1 or can0")
    if table.has("channel") and form != "can":
        table.fail("channel", 'has a meaning only with format = "can"; take it out, or give that format')
    if table.has("channel") and value == "":
        table.fail("channel", "is empty; give the channel of the log, such as 1 or can0, or take it out")
    return str(value)


def _channels(table: Table, form: str) -> tuple[str, ...]:
    """The channel of all columns, or that of each: equal devices on several buses send the same identifiers."""
    if not table.has("channels"):
        return (channel,) if (channel := _channel(table, form)) else ()
    if table.has("channel"):
        table.fail("channels", "is given besides channel; keep one of them")
    if form != "can":
        table.fail("channels", 'has a meaning only with format = "can"; take it out, or give that format')
    values = table.value("channels", ..., (list,), "a list of channels, one for each column")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, (str, int)) or value == "":
            table.fail("channels", f"holds {shown(value)}; give channels as the log writes them, such as 1 or can0")
    return tuple(map(str, values))


def _metadata(table: Table) -> str:
    if not table.has("metadata"):
        return ""
    inner = table.table("metadata")
    file = inner.text("file")
    inner.done()
    return file


def _recognise(table: Table) -> dict[str, Any]:
    inner = table.table("recognise")
    found = {"file": inner.text("file", ""), "beside": inner.text("beside", ""), "names": inner.texts("names", ())}
    inner.done()
    return {key: value for key, value in found.items() if value}


def _time(table: Table, form: str) -> Quantity:
    if form == "can":
        return Quantity("time", (), ("s",))  # frames carry their time
    inner = table.table("time", required=True)
    column = _column(inner, "column")
    unit, scale = _units(inner, "time", 1), inner.number("scale", 1.0)
    wrap = _wrap(inner, (int, float))
    inner.done()
    if not scale > 0.0:
        inner.fail("scale", f"is {scale:g}; give a factor above 0, or leave it out")
    return Quantity("time", (column,), unit, (scale,), wrap=wrap)


def _wrap(table: Table, kinds: tuple[type, ...]) -> float | bool | None:
    """Where a column begins again, in its own numbers."""
    what = "the number at which the column begins again" + (
        ", true for one turn, or false where it never does" if bool in kinds else "")
    value: float | bool | None = table.value("wrap", None, kinds, what)
    if value is None or isinstance(value, bool):
        return value
    wrap = float(table.number("wrap"))
    if not wrap > 0.0:
        table.fail("wrap", f"is {wrap:g}; give the number at which the column begins again, such as 65536 or 360")
    return wrap


def _yaw_rate(table: Table, form: str) -> Quantity:
    """Of a gyro: one column."""
    column, unit, sign = _column(table, "column"), _units(table, YAW_RATE, 1), table.number("sign", 1.0)
    scale, offset = table.number("scale", 1.0), table.number("offset", 0.0)
    if abs(sign) != 1.0 or scale == 0.0:
        table.fail("scale" if scale == 0.0 else "sign", "holds no factor that keeps the values; give sign 1 or -1, "
                   "and a scale that is not 0")
    is_optional, channel = table.flag("optional", False), _channel(table, form)
    table.done()
    return Quantity(YAW_RATE, (column,), unit, (sign * scale,), (offset,), is_optional=is_optional,
                    channels=(channel,) if channel else ())


def _column(table: Table, key: str) -> Column:
    value = table.value(key, ..., (str, int), "a column's name, or its number from 1")
    return _checked(table, key, value)


def _checked(table: Table, key: str, value: Any) -> Column:
    if isinstance(value, bool) or not isinstance(value, (str, int)) or value == "" \
            or (isinstance(value, int) and value < 1):
        table.fail(key, f"holds {shown(value)}; give columns by name, or by number from 1")
    return value


def _quantity(table: Table, name: str, count: int | None, form: str) -> Quantity:
    columns, first = _columns(table, name, count)
    channels = _channels(table, form)
    _check_twice(table, columns, channels, form)
    length = len(columns) if columns and not _is_numbered(columns) else None
    scales = _each(table, "scale", length, 1.0)
    signs = _each(table, "sign", length, 1.0)
    if any(abs(sign) != 1.0 for sign in signs):
        table.fail("sign", "holds a number that is neither 1 nor -1; use scale for other factors")
    if len(scales) != len(signs) and 1 not in (len(scales), len(signs)):
        table.fail("signs", f"has {len(signs)} entries, scales {len(scales)}; give as many")
    factors = _product(scales, signs)
    if 0.0 in scales:
        table.fail("scale", "is 0, which would make every value the same; give the column's factor, or leave it out")
    kind = table.choice("kind", KINDS.get(name, ("absolute",)), "absolute")
    given = table.numbers("wheels", length) if table.has("wheels") else ()
    wheels = tuple(int(each) for each in given)
    if len(set(wheels)) < len(wheels) or min(wheels, default=1) < 1 or wheels != given \
            or max(wheels, default=1) > MOST_WHEELS:
        table.fail("wheels", f"is {[*map(plain_number, given)]}; give each wheel of the scene once, counted from 1")
    if name == "pose" and len(columns) == 2 and kind == "body-increments":
        table.fail("columns", "has 2 entries; give 3, as the frame of the sample before needs a heading")
    units = _units(table, name, len(columns) if name == "pose" else 1)
    ticks, gear = _figure(table, "ticks_per_turn"), _figure(table, "gear_ratio")
    if TICK in units and ticks is None:
        table.fail("ticks_per_turn", "is missing; ticks need how many of them are one turn of the encoder")
    found = Quantity(
        name, columns, units, factors, _each(table, "offset", length, 0.0), kind, ticks,
        1.0 if gear is None else gear, wheels, first, table.flag("optional", False),
        table.flag("sign_from_set_speed", False) if name == "current" else False,
        table.choice("point", POINTS, "origin") if name == "pose" else "origin",
        _wrap(table, (bool, int, float)) if name == "wheel_angle" else None, channels)
    table.done()
    return found


def _columns(table: Table, name: str, count: int | None) -> tuple[tuple[Column, ...], int]:
    if table.has("first_column"):
        if table.has("columns"):
            table.fail("first_column", "is given besides columns; keep one of them")
        first = table.whole("first_column")
        if first < 1 or name == "pose":
            table.fail("first_column", f"is {first}; give the number of the first wheel's column, from 1")
        return (), first
    values = table.value("columns", ..., (list, str), "a list of columns, by name or by number")
    if isinstance(values, str):
        if NUMBERED not in values or name == "pose":
            table.fail("columns", f"is {shown(values)}; give a list of columns, or one name with {NUMBERED} for the "
                       "wheel's number")
        return (values,), 0
    columns = tuple(_checked(table, "columns", value) for value in values)
    if name == "pose":
        if len(columns) not in (2, 3):
            table.fail("columns", f"has {len(columns)} entries; give 3, of x, y and heading, or 2, of x and y")
    elif not columns or len(columns) != (count or len(columns)):
        table.fail("columns", f"has {len(columns)} entries; give {count or 'one for each wheel'}")
    return columns, 0


def _check_twice(table: Table, columns: tuple[Column, ...], channels: tuple[str, ...], form: str) -> None:
    """Refuses a column that is named twice, unless its frames come from several buses."""
    if len(channels) > 1 and len(channels) != len(columns):
        table.fail("channels", f"has {len(channels)} entries; give {len(columns)}, one for each column")
    each = channels if len(channels) > 1 else ("",) * len(columns)
    pairs = list(zip(columns, each, strict=True))
    for number, (column, channel) in enumerate(pairs):
        if (column, channel) not in pairs[:number]:
            continue
        where = f" on channel {channel}" if channel else ""
        remedy = ", or channels = [1, 2] for equal devices on two buses" if form == "can" and not channel else ""
        table.fail("columns", f"names {shown(column)} twice{where}; give each column once{remedy}")


def plain_number(value: float) -> float:
    """As it was written: 2, not 2.0."""
    return int(value) if value == int(value) else value


def _is_numbered(columns: tuple[Column, ...]) -> bool:
    return len(columns) == 1 and isinstance(columns[0], str) and NUMBERED in columns[0]


def _each(table: Table, key: str, length: int | None, default: float) -> tuple[float, ...]:
    """One number for all columns (key), or one for each (key with an s)."""
    several = f"{key}s"
    if table.has(several):
        if table.has(key):
            table.fail(several, f"is given besides {key}; keep one of them")
        return tuple(table.numbers(several, length))
    return (table.number(key, default),)


def _product(one: tuple[float, ...], other: tuple[float, ...]) -> tuple[float, ...]:
    length = max(len(one), len(other))
    return tuple(a * b for a, b in zip(one * (length // len(one)), other * (length // len(other)), strict=True))


def _figure(table: Table, key: str) -> Figure | None:
    value = table.value(key, None, (int, float, str), "a number, or the name of a row of the metadata file")
    if isinstance(value, (int, float)):
        table.number(key)  # refuses one that is not finite
        if not value > 0.0:
            table.fail(key, f"is {value:g}; give a number above zero")
    return value


def _units(table: Table, name: str, length: int) -> tuple[str, ...]:
    allowed = [set(units) | ({TICK} if name == "wheel_angle" else set()) for units in OF_QUANTITY[name][:length]]
    default = [next(iter(units)) for units in OF_QUANTITY[name][:length]]
    key = "units" if length > 1 else "unit"
    given = list(table.texts(key, default)) if length > 1 else [table.text(key, default[0])]
    if len(given) != length:
        table.fail(key, f"has {len(given)} entries; give {length}")
    for unit, known in zip(given, allowed, strict=True):
        if unit not in known:
            table.fail(key, f"there is no unit {shown(unit)} of {name}; {nearest_of(unit, known)}")
    return tuple(given)


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


def angle_unit(quantity: Quantity, unit: str, figure: Any) -> float:
    """Factor of an angle's unit; ticks by what the map says is a turn; the gear brings a motor's shaft to the wheel."""
    one = ANGLE["turn"] / figure(quantity.ticks_per_turn) if unit == TICK else ANGLE[unit]
    return one / figure(quantity.gear_ratio)
