"""One quantity of a map: its columns, what brings them to SI units at the wheel, and the table that states it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from laconic.errors import nearest_of, shown
from laconic.robot.logs.log import COMMANDED, POINTS, STEERING
from laconic.robot.logs.units import (
    ANGLE,
    ISO,
    LATITUDE,
    LONGITUDE,
    OF_QUANTITY,
    OF_WHEEL,
    SPEED,
    TICK_SPEED,
    TIME,
    further_units,
    needs_ticks,
    of_tread,
)
from laconic.scene.table import Table

YAW_RATE = "yaw_rate"
OF_ANGLE = ("wheel_angle", STEERING)
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
    members: tuple[int, ...] = ()      # how many of the columns measure each value; empty: one
    radius_m: float | None = None      # that made metres of angles; None: the scene's
    quaternion: str = ""               # order of its parts; empty: the heading is an angle
    mount: tuple[float, float, float] | None = None   # x, y [m], heading [rad] of the tracker on the robot
    lag_s: float = 0.0                 # so much later than its stamps is the pose; of commands: of first order
    keyword: str = ""                  # of the lines that hold it; empty: of all
    time: str = ""                     # column of its own instants; empty: those of the log
    topic: str = ""                    # of messages whose type says which fields are meant
    frames: tuple[str, ...] = ()       # parent and child: the pose of the one in the other, of /tf
    hinges: tuple[str, ...] = ()       # of the scene, whose angle each column is; empty: in the scene's order
    rate_limit_rad_per_s: float = math.inf              # at which a hinge follows
    curve: tuple[tuple[float, float], ...] = ()         # its angle over the column's

    def channel_of(self, index: int, usual: str) -> str:
        """The channel of a column; empty: the only one of the log."""
        return self.channels[index if len(self.channels) > 1 else 0] if self.channels else usual


def is_numbered(columns: tuple[Column, ...]) -> bool:
    """Whether a name with # stands for the columns of all wheels."""
    return len(columns) == 1 and isinstance(columns[0], str) and NUMBERED in columns[0]


def wheel_unit(quantity: Quantity, figure: Any) -> float:
    """Factor of the unit of a wheel's angle or speed: ticks by what the map says is a turn, lengths by the radius (1 m
    where that is the scene's); the gear brings a motor's shaft to the wheel."""
    unit = quantity.units[0]
    if (length := of_tread(quantity.name, unit)) is not None:
        one = length / (quantity.radius_m or 1.0)
    elif needs_ticks(unit):
        one = ANGLE["turn"] / figure(quantity.ticks_per_turn) * TICK_SPEED.get(unit, 1.0)
    else:
        one = (ANGLE if quantity.name in OF_ANGLE else SPEED)[unit]
    return one / figure(quantity.gear_ratio)


def is_by_scene_radius(quantity: Quantity) -> bool:
    """Whether the scene's radius makes angles of what a wheel rolled."""
    return quantity.name in OF_WHEEL and quantity.radius_m is None and of_tread(
        quantity.name, quantity.units[0]) is not None


JOINTS = "/joint_states"


def shorthand(table: Table) -> dict[str, Quantity]:
    """The quantities of `joints` with `wheels`, `pose` as a text and `imu`."""
    found: dict[str, Quantity] = {}
    if table.has("joints"):
        topic = table.text("joints")
        names = table.texts("wheels", ()) if table.has("wheels") else ()
        if not topic:
            table.fail("joints", f"is empty; give a topic such as {JOINTS}")
        if not names:
            table.fail("wheels", "is missing; give the names of the wheels' joints, in the order of the scene's wheels")
        if len(set(names)) < len(names):
            table.fail("wheels", "names a joint twice; give each wheel's joint once")
        found |= joints_of(topic, tuple(names))
    elif table.has("wheels"):
        table.fail("wheels", 'needs joints, the topic with their angles, such as joints = "/joint_states"')
    if isinstance(table.peek("pose"), str):
        topic = table.text("pose")
        if not topic:
            table.fail("pose", "is empty; give a topic such as /odom")
        found["pose"] = pose_of(topic)
    if table.has("imu"):
        topic = table.text("imu")
        if not topic:
            table.fail("imu", "is empty; give a topic such as /imu")
        found[YAW_RATE] = imu_of(topic)
    return found


def joints_of(topic: str, names: tuple[str, ...]) -> dict[str, Quantity]:
    """Angles and speeds of wheels, of messages of the type JointState; either may be absent in them."""
    wheels = tuple(range(1, len(names) + 1))
    return {name: Quantity(name, tuple(f"{topic}.{field}[{joint}]" for joint in names), (unit,), wheels=wheels,
                           is_optional=True)
            for name, field, unit in (("wheel_angle", "position", "rad"), ("wheel_speed", "velocity", "rad/s"))}


def pose_of(topic: str) -> Quantity:
    """Of messages whose type says where the pose is."""
    return Quantity("pose", (), ("m", "m", "rad"), topic=topic)


def imu_of(topic: str) -> Quantity:
    """Of an Imu."""
    return Quantity(YAW_RATE, (f"{topic}.angular_velocity.z",), ("rad/s",))


COMMAND = "command"
KINDS = {"wheel_angle": ("absolute", "increments"), STEERING: ("absolute", COMMAND),
         "pose": ("absolute", "increments", "body-increments")}
MOST_WHEELS = 1000
QUATERNIONS = ("xyzw", "wxyz", "zw")
FORMS_OF_POSE = "3, of x, y and heading, or 2, of x and y, or 6, of x, y and a quaternion"


def channel_of(table: Table, form: str) -> str:
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
        return (channel,) if (channel := channel_of(table, form)) else ()
    if table.has("channel"):
        table.fail("channels", "is given besides channel; keep one of them")
    if form != "can":
        table.fail("channels", 'has a meaning only with format = "can"; take it out, or give that format')
    values = table.value("channels", ..., (list,), "a list of channels, one for each column")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, (str, int)) or value == "":
            table.fail("channels", f"holds {shown(value)}; give channels as the log writes them, such as 1 or can0")
    return tuple(map(str, values))


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


def time_of(table: Table, form: str) -> Quantity:
    if form in ("can", "bag"):
        return Quantity("time", (), ("s",))  # frames and messages carry their time
    inner = table.table("time", required=True)
    if inner.has("columns"):
        return _time_of_parts(inner)
    column = _column(inner, "column")
    unit = inner.text("unit", "s")
    if unit not in (*TIME, ISO):
        inner.fail("unit", f"there is no unit {shown(unit)} of time; {nearest_of(unit, (*TIME, ISO))}")
    scale, wrap = inner.number("scale", 1.0), _wrap(inner, (int, float))
    inner.done()
    if not scale > 0.0:
        inner.fail("scale", f"is {scale:g}; give a factor above 0, or leave it out")
    return Quantity("time", (column,), (unit,), (scale,), wrap=wrap)


def _time_of_parts(inner: Table) -> Quantity:
    """Seconds and nanoseconds on columns of their own, or a date and a time of day."""
    if inner.has("column"):
        inner.fail("columns", "is given besides column; keep one of them")
    given = inner.value("columns", ..., (list,), "the columns of seconds and nanoseconds")
    columns = tuple(_checked(inner, "columns", each) for each in given)
    default = ("s", "ns")[:len(columns)]
    units = inner.texts("units", default) if not inner.has("unit") else [inner.text("unit")] * len(columns)
    inner.done()
    if len(columns) != 2 or len(set(columns)) < 2:
        inner.fail("columns", f"has {len(columns)} entries; give 2 different ones, of seconds and of their rest, or of "
                   "date and time of day")
    if len(units) != 2 or not (set(units) <= set(TIME) or set(units) == {ISO}):
        inner.fail("units", f"is {shown(list(units))}; give 2 of {', '.join(TIME)}, or unit = \"{ISO}\"")
    return Quantity("time", columns, tuple(units))


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


def single_of(table: Table, name: str, form: str) -> Quantity:
    """One column: of a gyro, or the commanded speed."""
    column, unit, sign = _column(table, "column"), _units(table, name, 1), table.number("sign", 1.0)
    scale, offset = table.number("scale", 1.0), table.number("offset", 0.0)
    if abs(sign) != 1.0 or scale == 0.0:
        table.fail("scale" if scale == 0.0 else "sign", "holds no factor that keeps the values; give sign 1 or -1, "
                   "and a scale that is not 0")
    is_optional, channel = table.flag("optional", False), channel_of(table, form)
    lag_s = _lag(table) if name == COMMANDED else 0.0
    keyword = table.text("rows", "") if name == COMMANDED else ""
    table.done()
    return Quantity(name, (column,), unit, (sign * scale,), (offset,), is_optional=is_optional,
                    channels=(channel,) if channel else (), lag_s=lag_s, keyword=keyword)


def _lag(table: Table) -> float:
    lag_s = table.number("lag_s", 0.0)
    if lag_s < 0.0:
        table.fail("lag_s", f"is {lag_s:g}; give the time in which a command is followed, at least 0")
    return lag_s


def _following(table: Table) -> dict[str, Any]:
    """How a wheel follows the angle that is given for it."""
    limit = table.number("rate_limit_rad_per_s") if table.has("rate_limit_rad_per_s") else math.inf
    curve: tuple[tuple[float, float], ...] = ()
    if not limit > 0.0:
        table.fail("rate_limit_rad_per_s", f"is {limit:g}; give a rate above 0, or leave it out")
    if table.has("curve"):
        given = table.value("curve", ..., (list,), "pairs of an angle in the log and the hinge's, in rad")
        if not all(isinstance(pair, list) and len(pair) == 2 and all(
                isinstance(x, (int, float)) and not isinstance(x, bool) and math.isfinite(x) for x in pair)
                for pair in given) or len(given) < 2:
            table.fail("curve", f"is {shown(given)}; give at least 2 pairs of an angle in the log and the hinge's, rad")
        curve = tuple((float(one), float(other)) for one, other in given)
        if any(after[0] <= before[0] for before, after in zip(curve, curve[1:], strict=False)):
            table.fail("curve", "has angles of the log that do not grow; give its pairs in their order")
    return {"lag_s": _lag(table), "rate_limit_rad_per_s": limit, "curve": curve}


def _column(table: Table, key: str) -> Column:
    value = table.value(key, ..., (str, int), "a column's name, or its number from 1")
    return _checked(table, key, value)


def _checked(table: Table, key: str, value: Any) -> Column:
    if isinstance(value, bool) or not isinstance(value, (str, int)) or value == "" \
            or (isinstance(value, int) and value < 1):
        table.fail(key, f"holds {shown(value)}; give columns by name, or by number from 1")
    return value


def quantity_of(table: Table, name: str, count: int | None, form: str) -> Quantity:
    columns, first, members = _columns(table, name, count, form)
    channels = _channels(table, form)
    _check_twice(table, columns, channels, form)
    quaternion = _quaternion(table, len(columns)) if name == "pose" else ""
    length = len(columns) if columns and not is_numbered(columns) else None
    length = 3 if quaternion or (name == "pose" and not columns) else length
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
    if name == "pose" and len(columns) == 2 and kind == "body-increments":
        table.fail("columns", "has 2 entries; give 3, as the frame of the sample before needs a heading")
    if members and (kind != "absolute" or name == "pose" and quaternion):
        table.fail("columns", "holds lists, which are averages of absolute values without quaternions; give one column "
                   "for each")
    units = _pose_units(table, columns, members, quaternion) if name == "pose" else _units(table, name, 1)
    ticks, gear = _figure(table, "ticks_per_turn"), _figure(table, "gear_ratio")
    if any(map(needs_ticks, units)) and ticks is None:
        table.fail("ticks_per_turn", "is missing; ticks need how many of them are one turn of the encoder")
    found = Quantity(
        name, columns, units, factors, _each(table, "offset", length, 0.0), kind, ticks,
        1.0 if gear is None else gear, _wheels(table, len(members) or length), first, table.flag("optional", False),
        table.flag("sign_from_set_speed", False) if name == "current" else False,
        table.choice("point", POINTS, "origin") if name == "pose" else "origin",
        _wrap(table, (bool, int, float)) if name in OF_ANGLE else None, channels, members,
        _radius(table, name, units), quaternion, *(_mounting(table, kind) if name == "pose" else (None, 0.0)),
        table.text("rows", ""), table.text("time", "") if form == "mat" else "",
        *_topic(table, name, form))
    if name == STEERING:
        found = replace(found, hinges=_hinges(table, len(members) or length), **_following(table))
    table.done()
    return found


def _hinges(table: Table, length: int | None) -> tuple[str, ...]:
    names = tuple(table.texts("hinges", ()))
    if names and (len(set(names)) < len(names) or (length is not None and len(names) != length)):
        table.fail("hinges", f"is {shown(list(names))}; give the name of another hinge of the scene for each column")
    return names


def _wheels(table: Table, length: int | None) -> tuple[int, ...]:
    given = table.numbers("wheels", length) if table.has("wheels") else ()
    wheels = tuple(int(each) for each in given)
    if len(set(wheels)) < len(wheels) or min(wheels, default=1) < 1 or wheels != tuple(given) \
            or max(wheels, default=1) > MOST_WHEELS:
        table.fail("wheels", f"is {[*map(plain_number, given)]}; give each wheel of the scene once, counted from 1")
    return wheels


def _radius(table: Table, name: str, units: tuple[str, ...]) -> float | None:
    """With which the robot made metres of its wheels' angles."""
    if not table.has("radius_m"):
        return None
    radius = float(table.number("radius_m"))
    if of_tread(name, units[0]) is None:
        table.fail("radius_m", f"has a meaning for lengths alone, and the unit is {units[0]}; take it out")
    if not radius > 0.0:
        table.fail("radius_m", f"is {radius:g}; give the radius with which the robot makes metres of angles")
    return radius


def _quaternion(table: Table, count: int) -> str:
    """The order of a quaternion's parts; empty where there is none."""
    order = table.choice("quaternion", QUATERNIONS, QUATERNIONS[0])
    if table.has("quaternion") and count != 2 + len(order):
        table.fail("quaternion", f"is {order}, which needs {2 + len(order)} columns: x, y and the quaternion's parts; "
                   f"there are {count}")
    if count == 4 and not table.has("quaternion"):
        table.fail("columns", f"has 4 entries; give {FORMS_OF_POSE}, or quaternion = \"zw\" with x, y, z and w")
    return order if count in (4, 6) else ""


def _mounting(table: Table, kind: str) -> tuple[tuple[float, float, float] | None, float]:
    """Where a tracker is on the robot, and how late it is."""
    lag_s, mount = table.number("lag_s", 0.0), None
    if table.has("mount"):
        inner = table.table("mount")
        mount = (inner.number("x_m", 0.0), inner.number("y_m", 0.0), inner.angle("heading", 0.0))
        inner.done()
    if kind != "absolute" and (mount or lag_s):
        table.fail("mount" if mount else "lag_s", f"has a meaning for absolute poses, and kind is {kind}; take it out")
    return mount, lag_s


def _columns(table: Table, name: str, count: int | None,
             form: str) -> tuple[tuple[Column, ...], int, tuple[int, ...]]:
    """(the columns, or the first of all that follow, how many of them measure each value)."""
    if table.has("first_column"):
        if table.has("columns"):
            table.fail("first_column", "is given besides columns; keep one of them")
        first = table.whole("first_column")
        if first < 1 or name == "pose":
            table.fail("first_column", f"is {first}; give the number of the first wheel's column, from 1")
        return (), first, ()
    if name == "pose" and form == "bag" and (table.has("topic") or table.has("frames")):
        _check_topic(table)
        return (), 0, ()
    values = table.value("columns", ..., (list, str), "a list of columns, by name or by number")
    if isinstance(values, str):
        if NUMBERED not in values or name == "pose":
            table.fail("columns", f"is {shown(values)}; give a list of columns, or one name with {NUMBERED} for the "
                       "wheel's number")
        return (values,), 0, ()
    groups = [value if isinstance(value, list) and value else [value] for value in values]
    columns = tuple(_checked(table, "columns", value) for group in groups for value in group)
    if name == "pose":
        if len(groups) not in (2, 3, 4, 6) or (len(groups) > 3 and len(columns) > len(groups)):
            table.fail("columns", f"has {len(groups)} entries; give {FORMS_OF_POSE}")
    elif not columns or len(groups) != (count or len(groups)):
        table.fail("columns", f"has {len(groups)} entries; give {count or 'one for each wheel'}")
    return columns, 0, tuple(map(len, groups)) if len(columns) > len(groups) else ()


def _topic(table: Table, name: str, form: str) -> tuple[str, tuple[str, ...]]:
    """Of a pose in a bag: the topic, or the two frames."""
    if name != "pose" or form != "bag":
        return "", ()
    return table.text("topic", ""), table.texts("frames", ())


def _check_topic(table: Table) -> None:
    """A pose by the topic of its messages, or by two frames."""
    given = [key for key in ("columns", "topic", "frames") if table.has(key)]
    if len(given) > 1:
        table.fail(given[1], f"is given besides {given[0]}; keep one of them")
    if table.has("frames"):
        frames = table.texts("frames", ())
        if len(frames) != 2 or not all(frames) or frames[0] == frames[1]:
            table.fail("frames", f"is {shown(list(frames))}; give two frames of /tf, such as [\"map\", \"base_link\"]")
    elif not table.text("topic", ""):
        table.fail("topic", "is empty; give the name of a topic with poses")


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


def _pose_units(table: Table, columns: tuple[Column, ...], members: tuple[int, ...],
                quaternion: str) -> tuple[str, ...]:
    """Of x, y and, where there is one, the heading; that of a quaternion needs none."""
    if not quaternion:
        return _units(table, "pose", len(members or columns) or 3)
    given = table.peek("units")
    if isinstance(given, list) and len(given) == 3:
        units = _units(table, "pose", 3)
        if units[2] != "rad":
            table.fail("units", f"gives {units[2]} for a quaternion, which has no unit; give those of x and y alone")
        return units
    return (*_units(table, "pose", 2), "rad")


def _units(table: Table, name: str, length: int) -> tuple[str, ...]:
    allowed = [set(units) | further_units(name) for units in OF_QUANTITY[name][:length]]
    default = [next(iter(units)) for units in OF_QUANTITY[name][:length]]
    key = "units" if length > 1 else "unit"
    given = list(table.texts(key, default)) if length > 1 else [table.text(key, default[0])]
    if len(given) != length:
        table.fail(key, f"has {len(given)} entries; give {length}")
    if name == "pose" and set(given) == {LATITUDE, LONGITUDE}:
        return tuple(given)
    for unit, known in zip(given, allowed, strict=True):
        if unit not in known:
            table.fail(key, f"there is no unit {shown(unit)} of {name}; {nearest_of(unit, known)}")
    return tuple(given)


def plain_number(value: float) -> float:
    """As it was written: 2, not 2.0."""
    return int(value) if value == int(value) else value
