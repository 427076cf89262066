"""A map: which signal of a DBC is which input or output of the model. A TOML file; docs/play.md explains its keys.

Here its keys are read; laconic.can.play.map_messages joins them to the DBC.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laconic.can.play.checksums import Checksum, read_checksum
from laconic.can.play.map_signals import OF_ANGLE, inputs_of, outputs_of, why_unknown
from laconic.scene.table import Table, read_map_toml

AT_TIMEOUT = ("hold", "zero", "off", "end")
REMOTE = "remote"
PAGES = ("in turn", "together")
MOST_VALUES = 2**64  # of a signal
EXACT = 2.0**53      # a decimal beyond may have lost digits already


@dataclass(frozen=True)
class Conversion:
    """From the value that comes in to the one that goes out: sign · scale · value + offset. `gear`: turns of what the
    signal is about for one of what the model means; `counts_per_turn`: the signal counts, 0: it does not."""

    factor: float = 1.0
    offset: float = 0.0
    gear: float = 1.0
    counts_per_turn: float = 0.0


@dataclass(frozen=True)
class Joint:
    """One signal and what it is joined to; `where` names it in messages."""

    where: str
    signal: str
    model: str                     # input or output; "": a constant
    conversion: Conversion = Conversion()
    constant: int | float | None = None  # the signal always has this value; a whole number stays exact
    wrap: int | float = 0          # raw values wrap at it; 0: they are cut to the signal's range; inf: at its bits


@dataclass(frozen=True)
class Counter:
    """A signal that counts the frames of a message."""

    signal: str
    modulo: int | None = None      # None: as many as the signal has bits for
    max_delta: int | None = None   # of received frames: the largest step that is taken; None: any


@dataclass(frozen=True)
class MessageMap:
    """One message: its signals and what all of it follows."""

    where: str
    message: str
    joints: tuple[Joint, ...]
    counter: Counter | None = None
    checksum: Checksum | None = None


@dataclass(frozen=True)
class Received(MessageMap):
    """A message of the controller."""

    timeout_s: float | None = None
    at_timeout: str = "hold"


@dataclass(frozen=True)
class Sent(MessageMap):
    """A message of the vehicle: cyclic or on request."""

    period_s: float | None = None
    first_s: float = 0.0
    on_request: str = ""           # "remote", or the message that asks for it
    pages: str | None = None      # None: the map does not say


@dataclass(frozen=True)
class SignalMap:
    """A whole map."""

    path: Path
    name: str
    received: tuple[Received, ...]
    sent: tuple[Sent, ...]


def read_map(path: Path, wheel_count: int) -> SignalMap:
    """A map for a vehicle with so many wheels; BadInput names the key that is wrong."""
    table = read_map_toml(path)
    name = table.text("name", path.stem)
    received = tuple(_received(each, wheel_count) for each in table.tables("receive"))
    sent = tuple(_sent(each, wheel_count) for each in table.tables("send"))
    table.done()
    if not received and not sent:
        table.fail("receive", "is missing, and send, too; give [[receive]] for a message of the controller or [[send]] "
                   "for one of the vehicle")
    return SignalMap(path, name, received, sent)


def _received(table: Table, wheel_count: int) -> Received:
    message, counter, checksum = _common(table)
    timeout_s = _positive(table, "timeout_s")
    at_timeout = table.choice("at_timeout", AT_TIMEOUT, "zero" if timeout_s is not None else "hold")
    joints = tuple(_input(each, wheel_count) for each in table.tables("signal"))
    table.done()
    if table.has("at_timeout") and timeout_s is None:
        table.fail("at_timeout", "has no effect without timeout_s; give it, too")
    if not joints and timeout_s is None:
        table.fail("signal", f"is missing, so {message} would do nothing; give [[receive.signal]]")
    return Received(table.location, message, joints, counter, checksum, timeout_s, at_timeout)


def _sent(table: Table, wheel_count: int) -> Sent:
    message, counter, checksum = _common(table)
    period_s, on_request = _positive(table, "period_s"), _text(table, "on_request")
    if (period_s is None) == (not on_request):
        table.fail("period_s", "and on_request are both given; keep one" if on_request else
                   f'is missing; give seconds, or on_request = "{REMOTE}" or a message that asks for {message}')
    first_s = table.number("first_s", 0.0)
    if first_s < 0.0 or (first_s and period_s is None):
        table.fail("first_s", "is given without period_s; take it out" if period_s is None else
                   f"is {first_s:g}; give 0 or more")
    if counter is not None and counter.max_delta is not None:
        table.fail("counter.max_delta", "is for messages of the controller; take it out")
    pages = table.choice("pages", PAGES) if table.has("pages") else None
    joints = tuple(_output(each, wheel_count) for each in table.tables("signal"))
    table.done()
    if not joints:
        table.fail("signal", f"is missing, so {message} would say nothing; give [[send.signal]]")
    return Sent(table.location, message, joints, counter, checksum, period_s, first_s, on_request, pages)


def _common(table: Table) -> tuple[str, Counter | None, Checksum | None]:
    message = table.text("message")
    counter = _counter(table.table("counter")) if table.has("counter") else None
    checksum = read_checksum(table.table("checksum")) if table.has("checksum") else None
    return message, counter, checksum


def _counter(table: Table) -> Counter:
    signal, modulo = table.text("signal"), table.whole("modulo", None)
    if modulo is not None and modulo < 2:
        table.fail("modulo", f"is {modulo}; give 2 or more")
    max_delta = table.whole("max_delta", None)
    if max_delta is not None and max_delta < 1:
        table.fail("max_delta", f"is {max_delta}; give 1 or more")
    table.done()
    return Counter(signal, modulo, max_delta)


def _text(table: Table, key: str) -> str:
    """A text that may be left out, but not be empty."""
    found = table.text(key, "")
    if table.has(key) and not found.strip():
        table.fail(key, "is empty; give a name, or take it out")
    return found


def _positive(table: Table, key: str) -> float | None:
    value = table.number(key, None)
    if value is not None and not value > 0.0:
        table.fail(key, f"is {value:g}; give a number above 0")
    return value


def _input(table: Table, wheel_count: int) -> Joint:
    name, target = table.text("name"), table.text("to")
    if message := why_unknown(target, inputs_of(wheel_count), "input", wheel_count):
        table.fail("to", message)
    conversion = _conversion(table, target)
    table.done()
    return Joint(table.location, name, target, conversion)


def _output(table: Table, wheel_count: int) -> Joint:
    name, source, constant = table.text("name"), _text(table, "from"), _constant(table)
    if (constant is None) == (not source):
        table.fail("from", "and value are both given; keep one of them" if source else
                   "is missing; give an output of the model, or value for a constant")
    if constant is not None:
        table.done()
        return Joint(table.location, name, "", constant=constant)
    if message := why_unknown(source, outputs_of(wheel_count), "output", wheel_count):
        table.fail("from", message)
    conversion, wrap = _conversion(table, source), _wrap(table)
    table.done()
    return Joint(table.location, name, source, conversion, None, wrap)


def _constant(table: Table) -> int | float | None:
    """As it is written: a signal may have more bits than a floating-point number."""
    given: Any = table.value("value", None, (int, float), "a number")
    table.number("value", None)  # refuses one that is not finite
    is_whole = isinstance(given, int) or (given is not None and given.is_integer() and abs(given) < EXACT)
    return int(given) if is_whole else given


def _conversion(table: Table, model: str) -> Conversion:
    scale, sign, gear = table.number("scale", 1.0), table.number("sign", 1.0), table.number("gear", 1.0)
    if scale == 0.0:
        table.fail("scale", "is 0, so that the signal would say nothing; give another number")
    if sign not in (1.0, -1.0):
        table.fail("sign", f"is {sign:g}; give 1 or -1, and scale for other factors")
    if gear == 0.0:
        table.fail("gear", "is 0; give the turns of the signal's shaft for one of the model's")
    if gear != 1.0 and not any(word in model for word in ("angle", "speed", "position", "count")):
        table.fail("gear", f"has no meaning for {model}, which does not turn; use scale")
    counts = table.number("counts_per_turn", 0.0)
    if table.has("counts_per_turn") and not counts > 0.0:
        table.fail("counts_per_turn", f"is {counts:g}; give a number above 0")
    if counts and not OF_ANGLE.match(model):
        table.fail("counts_per_turn", f"has no meaning for {model}, which is no angle; use scale")
    return Conversion(scale * sign, table.number("offset", 0.0), gear, counts)


def _wrap(table: Table) -> int | float:
    value: Any = table.value("wrap", False, (bool, int), "true, or the whole number at which raw values wrap")
    if isinstance(value, bool):
        return float("inf") if value else 0
    if not 2 <= value <= MOST_VALUES:
        table.fail("wrap", f"is {value if value < 2 else 'beyond 2^64'}; give true, or a whole number from 2 to 2^64")
    return int(value)
