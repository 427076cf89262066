"""One quantity of a map: its columns, and what brings them to SI units at the wheel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from laconic.robot.logs.units import ANGLE, OF_WHEEL, SPEED, TICK_SPEED, needs_ticks, of_tread

YAW_RATE = "yaw_rate"
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
    channel: str = ""                  # CAN: of the bus that the frames are from; empty: the only one
    members: tuple[int, ...] = ()      # how many of the columns measure each value; empty: one
    radius_m: float | None = None      # that made metres of angles; None: the scene's
    quaternion: str = ""               # order of its parts; empty: the heading is an angle
    mount: tuple[float, float, float] | None = None   # x, y [m], heading [rad] of the tracker on the robot
    lag_s: float = 0.0                 # so much later than its stamps is the pose
    keyword: str = ""                  # of the lines that hold it; empty: of all
    time: str = ""                     # column of its own instants; empty: those of the log
    topic: str = ""                    # of messages whose type says which fields are meant
    frames: tuple[str, ...] = ()       # parent and child: the pose of the one in the other, of /tf


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
        one = (ANGLE if quantity.name == "wheel_angle" else SPEED)[unit]
    return one / figure(quantity.gear_ratio)


def is_by_scene_radius(quantity: Quantity) -> bool:
    """Whether the scene's radius makes angles of what a wheel rolled."""
    return quantity.name in OF_WHEEL and quantity.radius_m is None and of_tread(
        quantity.name, quantity.units[0]) is not None
