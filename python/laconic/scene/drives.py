"""`[rig.drives]`: the motor drives between a controller's bus and the wheels, for `laconic play`; `[ardupilot]`: the
outputs of an autopilot.

A value is one number for all drives or a list with one for each; what is not given gets its value in
laconic.can.play.settings, where the protocol and the vehicle's motor are known.

`[speed_controller]`: what turns set speeds of the wheels into currents on the recorded robot.

Only `laconic replay --inputs set-speeds` runs it; a simulation has voltages and torques as inputs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

from laconic.core.inputs import no_such_wheel
from laconic.errors import nearest_of
from laconic.scene.hinges import Hinge
from laconic.scene.keys import DRIVE_NUMBERS, PROTOCOLS, key_of, read_choice, read_number
from laconic.scene.table import Table

DRIVE_PROTOCOLS = tuple(PROTOCOLS)
NO_DRIVE = False  # in the list node_ids: a wheel without a drive

NUMBERS = tuple(key.path.rpartition(".")[2] for key in DRIVE_NUMBERS)
"""Keys of [rig.drives] that are a number of each drive."""
MOST_COUNTS = 2**31 - 1
LONGEST_WATCHDOG_S = 1000.0
DIVISORS = {"gear_ratio": (1e-6, 1e6), "torque_constant_Nm_per_A": (1e-9, 1e9)}  # sizes that a drive can divide by


@dataclass(frozen=True)
class Drives:
    """What `[rig.drives]` gives: tuples with one entry for each wheel, then for each hinge; 0 for those without a
    drive."""

    protocol: str | None = None
    driven: tuple[bool, ...] = ()             # whether a wheel, or a hinge behind them, has a drive
    node_ids: tuple[int, ...] | None = None
    watchdog_s: float | None = None           # None: the protocol's own
    numbers: dict[str, tuple[float, ...]] = field(default_factory=dict)  # by key, only those that are given


def axes_with_motors(wheels: Sequence[Mapping[str, Any]], hinges: Sequence[Hinge], slips: bool) -> list[bool]:
    """Which wheels, and then which hinges, have a motor that a drive can replace. Coordinated hinges turn together;
    where wheels may slip each has a servo or motor of its own."""
    turned = ("motor", "prescribed", "servo", *(["coordinated"] if slips else []))
    return [*(bool(wheel.get("driven", True)) for wheel in wheels), *(hinge.kind in turned for hinge in hinges)]


def read_drives(table: Table, wheels: Sequence[Mapping[str, Any]], hinges: Sequence[Hinge] = (),
                slips: bool = False) -> Drives:
    """`[rig.drives]` of a vehicle with these wheels and hinges; a wheel with driven = false has no drive. `slips`: the
    ground has friction."""
    if not wheels:
        table.fail("protocol", "drives turn wheels, and the vehicle has none; take [rig.drives] out")
    protocol = read_choice(table, "protocol")
    driven, node_ids = _node_ids(table, axes_with_motors(wheels, hinges, slips), len(wheels))
    numbers = {key: _numbers(table, key, driven) for key in NUMBERS if table.has(key)}
    watchdog_s = read_number(table, "watchdog_s")
    if watchdog_s is not None and watchdog_s > LONGEST_WATCHDOG_S:
        table.fail("watchdog_s", f"is {watchdog_s:g}; give {LONGEST_WATCHDOG_S:g} s or less, or 0 for none")
    table.done()
    return Drives(protocol, driven, node_ids, watchdog_s, numbers)


def _node_ids(table: Table, driven: list[bool], wheel_count: int
              ) -> tuple[tuple[bool, ...], tuple[int, ...] | None]:
    """Which wheels have a drive, and its node id; in a list as long as the wheels `false` stands for none."""
    if not table.has("node_ids"):
        return tuple(driven), None
    given = list(table.value("node_ids", ..., (list,), "a list of whole numbers, one for each wheel, false for none"))
    if len(given) == sum(driven) < len(driven):
        rest = iter(given)
        given = [next(rest) if has_motor else NO_DRIVE for has_motor in driven]
    if len(given) != len(driven):
        table.fail("node_ids", f"has {len(given)} entries; give one for each of the {wheel_count} wheels"
                   f"{_then_hinges(len(driven) - wheel_count)}, false for a wheel without a drive")
    for number, (node_id, has_motor) in enumerate(zip(given, driven, strict=True), start=1):
        if node_id is not NO_DRIVE and (isinstance(node_id, bool) or not isinstance(node_id, int)):
            table.fail("node_ids", f"holds {str(node_id).lower()}; give whole numbers, or false for a wheel without a "
                       "drive")
        if node_id is not NO_DRIVE and not has_motor and number > wheel_count:
            table.fail("node_ids", f"gives hinge {number - wheel_count} a drive, and it is neither a motor nor "
                       "prescribed; give false there")
        if node_id is not NO_DRIVE and not has_motor:
            table.fail("node_ids", f"gives wheel {number} a drive, which has driven = false; give false there")
    has_drive = tuple(node_id is not NO_DRIVE for node_id in given)
    if not any(has_drive):
        table.fail("node_ids", "gives no wheel a drive; give at least one node id")
    return has_drive, tuple(0 if node_id is NO_DRIVE else node_id for node_id in given)


def _then_hinges(count: int) -> str:
    return f", then of the {count} hinges" if count else ""


def _numbers(table: Table, key: str, driven: tuple[bool, ...]) -> tuple[float, ...]:
    """One number for each wheel, 0 where there is no drive."""
    given = table.value(key, ..., (int, float, list), "a number, or a list with one for each drive")
    if isinstance(given, list):
        values = list(table.numbers(key))
        if len(values) == sum(driven):
            rest = iter(values)
            values = [next(rest) if has_drive else 0.0 for has_drive in driven]
        if len(values) != len(driven):
            table.fail(key, f"has {len(values)} entries; give one number, or {sum(driven)}, one for each drive")
    else:
        values = [table.number(key)] * len(driven)
    for value, has_drive in zip(values, driven, strict=True):
        if has_drive:
            _check(table, key, value)
    return tuple(value if has_drive else 0.0 for value, has_drive in zip(values, driven, strict=True))


def _check(table: Table, key: str, value: float) -> None:
    """Fails for a number that no drive can have."""
    key_of(table, key).check(table, value)
    least, most = DIVISORS.get(key, (0.0, float("inf")))
    if not least <= abs(value) <= most:
        table.fail(key, f"is {value:g}; give a size from {least:g} to {most:g}")
    if key == "encoder_counts" and (value != int(value) or value > MOST_COUNTS):
        table.fail(key, f"is {value:g}; give a whole number of counts of one turn, up to {MOST_COUNTS}")


# ---- outputs of an autopilot

SET_SPEED = "wheel_speed_rad_per_s"
"""The set speed of a wheel's controller, in the place of an input."""
USUAL_PULSES_US = (1000.0, 1500.0, 2000.0)
MOST_CHANNELS = 32


@dataclass(frozen=True)
class Channel:
    """An output of the autopilot: the inputs that it sets, and their value at the longest pulse."""

    number: int
    signals: tuple[str, ...]
    full: float


@dataclass(frozen=True)
class ArduPilotTable:
    """The values of `[ardupilot]`; None: not given."""

    full_V: float | None = None  # noqa: N815
    full_speed_rad_per_s: float | None = None
    full_steering_rad: float | None = None
    pwm_us: tuple[float, ...] = USUAL_PULSES_US
    channels: tuple[Channel, ...] = ()


def read_ardupilot(table: Table, wheel_count: int, known: Sequence[str]) -> ArduPilotTable:
    """`[ardupilot]` of a vehicle with these inputs."""
    numbers = {name: read_number(table, name) for name in ("full_V", "full_speed_rad_per_s", "full_steering_rad")}
    if numbers["full_V"] and numbers["full_speed_rad_per_s"]:
        table.fail("full_V", "is given besides full_speed_rad_per_s, so throttle would be two things; keep one of them")
    channels = _channels(table.tables("channel"), wheel_count, known)
    for name in numbers if channels else ():
        if numbers[name]:
            table.fail(name, "has no effect besides [[ardupilot.channel]], which gives each output its own full value; "
                       "take it out")
    pulses = table.numbers("pwm_us", 3) if table.has("pwm_us") else USUAL_PULSES_US
    if not 0.0 < pulses[0] < pulses[1] < pulses[2]:
        table.fail("pwm_us", "must rise from above 0: the pulses for -1, 0 and 1, such as [1000, 1500, 2000]")
    table.done()
    return ArduPilotTable(**numbers, pwm_us=pulses, channels=channels)


def _channels(tables: Iterable[Table], wheel_count: int, known: Sequence[str]) -> tuple[Channel, ...]:
    """All of them; an output may have a second table only for inputs with another full value."""
    found: list[Channel] = []
    for table in tables:
        channel = _channel(table, wheel_count, known)
        for before, other in enumerate(found, start=1):
            if other.number != channel.number:
                continue
            if twice := [signal for signal in channel.signals if signal in other.signals]:
                table.fail("signals", f"sets {twice[0]} by output {channel.number}, as channel[{before}] does; keep "
                           "one of them")
            if other.full == channel.full:
                table.fail("number", f"is {channel.number}, as of channel[{before}] with the same full; name all of "
                           "this output's inputs in the signals of one table, or correct the number")
        found.append(channel)
    return tuple(found)


def _channel(table: Table, wheel_count: int, known: Sequence[str]) -> Channel:
    number, signals = table.whole("number"), table.texts("signals")
    if not 1 <= number <= MOST_CHANNELS:
        table.fail("number", f"is {number}; give the number of an output, 1 to {MOST_CHANNELS}")
    if not signals:
        table.fail("signals", "is empty; name the inputs that this output sets, or take the table out")
    speeds = [f"{SET_SPEED}[{wheel}]" for wheel in range(1, wheel_count + 1)]
    for signal in signals:
        if signal.startswith(f"{SET_SPEED}[") and signal not in speeds:
            table.fail("signals", no_such_wheel(signal, SET_SPEED, wheel_count))
        if signal not in (*known, *speeds):
            table.fail("signals", f"there is no input {signal}; {nearest_of(signal, (*known, *speeds))}")
    full = read_number(table, "full")
    table.done()
    return Channel(number, signals, full)


@dataclass(frozen=True)
class SpeedController:
    """Current of a motor: P (set − s) + I ∫(set − s) dt, speeds at the wheel; of all motors alike."""

    gain_As_per_rad: float                  # P
    integral_gain_A_per_rad: float = 0.0    # I
    dead_time_s: float = 0.0                # from the set speed to the current


def read_speed_controller(top: Table, vehicle: dict[str, Any]) -> SpeedController | None:
    """None where the scene has none."""
    if not top.has("speed_controller"):
        return None
    table = top.table("speed_controller")
    if not vehicle.get("motor"):
        top.fail("speed_controller", "gives currents, which need [vehicle.motor]; give it, or take "
                 "[speed_controller] out")
    numbers = {field.name: read_number(table, field.name) for field in fields(SpeedController)}
    table.done()
    return SpeedController(**numbers)
