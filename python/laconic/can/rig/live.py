"""The frames on the bus, live on the terminal: one line a frame, as many as the terminal has lines for."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import can
from rich.console import Console, ConsoleOptions, RenderResult
from rich.live import Live
from rich.table import Table
from rich.text import Text

from laconic.can.rig.link import Link
from laconic.can.rig.wire import WHEELS_A_GROUP, Frame, wire

HIDDEN = re.compile("crc|counter|request|data(_[0-9]+)?|segment|group|page")
REFRESHES_PER_S = 10
AROUND = 6  # lines that are no frames: title, heading with its two rules, last rule, faults

Key = tuple[int, int]  # offset of the identifier; group or page


class View:
    """The last frame of each kind, group and page, as a table."""

    def __init__(self, link: Link, what: str, steps: int):
        self.link, self.what, self.steps = link, what, steps
        self.done = 0.0
        self._last: dict[Key, can.Message] = {}
        self._count: Counter[Key] = Counter()
        self._newest: dict[Key, int] = {}
        self._order = itertools.count()

    def moved(self, steps: float) -> None:
        """Notes that the run has taken so many more steps."""
        self.done += steps

    def take(self, message: can.Message) -> None:
        """A frame was sent or received."""
        frame = wire().by_offset.get(message.arbitration_id - self.link.id_base)
        part = part_of(frame, message) if frame is not None and not message.is_extended_id else 0
        key = (message.arbitration_id - self.link.id_base, part)
        self._last[key] = message
        self._count[key] += 1
        self._newest[key] = next(self._order)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        known = list(self._last)  # a copy: frames come while this is drawn
        shown = self._newest_of(known, (options.height or console.size.height) - AROUND)
        title = f"{self.what}, ID base 0x{self.link.id_base:X}, step {self.done:.0f} of {self.steps}"
        table = Table(title=title, title_justify="left", caption=self._caption(len(known) - len(shown)),
                      caption_justify="left", expand=True)
        table.add_column("frame", no_wrap=True)
        table.add_column("count", no_wrap=True, justify="right")
        table.add_column("signals", no_wrap=True, overflow="ellipsis", ratio=1)
        for key in shown:
            table.add_row(self._name(key), str(self._count[key]), Text(self.text_of(key)))
        yield table

    def _newest_of(self, keys: list[Key], room: int) -> list[Key]:
        """The `room` latest ones, in the order of their identifiers."""
        newest = sorted(keys, key=lambda key: self._newest.get(key, 0), reverse=True)
        return sorted(newest[:max(1, room)])

    def _caption(self, hidden: int) -> str:
        faults = ", ".join(f"{count} × {name}" for name, count in list(self.link.faults.items())) or "no faults"
        return faults + (f"; {hidden} more kinds of frames" if hidden else "")

    def _name(self, key: Key) -> str:
        frame = wire().by_offset.get(key[0])
        return frame.name if frame else f"0x{key[0] + self.link.id_base:X}"

    def text_of(self, key: Key) -> str:
        """The signals of a frame with their values; the bytes of a frame that the contract does not have."""
        message, frame = self._last[key], wire().by_offset.get(key[0])
        if frame is None or message.is_extended_id or len(message.data) != frame.length:
            return bytes(message.data).hex(" ")
        shown = {name: raw for name, raw in frame.unpack(message.data).items() if not HIDDEN.fullmatch(name)}
        return signals_text(frame, key[1], shown)


def part_of(frame: Frame, message: can.Message) -> int:
    """Which group of wheels or page of counters; 0 for frames that have none."""
    if not {"group", "page"} & set(frame.fields) or len(message.data) != frame.length:
        return 0
    values = frame.unpack(message.data)
    return values.get("group", values.get("page", 0))


def signals_text(frame: Frame, part: int, raw: dict[str, int]) -> str:
    """Names and values; of flags the names of those that are set; of numbered signals the name once."""
    texts, base_before = [], ""
    for name, value in raw.items():
        if frame.fields[name].bits == 1:
            texts += [name] if value else []
            continue
        base, _, digits = name.rpartition("_")
        number = f"_{wheel_of(frame, part, int(digits))}" if digits.isdigit() else ""
        base = base if number else name
        texts.append(f"{'' if base == base_before else base}{number} {value_text(frame, name, value)}")
        base_before = base
    return "  ".join(texts)


def wheel_of(frame: Frame, part: int, number: int) -> int:
    """The number of a wheel, from its number in its group."""
    return WHEELS_A_GROUP * part + number if "group" in frame.fields else number


def value_text(frame: Frame, name: str, raw: int) -> str:
    """Its name in the value table, or the number in its unit."""
    field = frame.fields[name]
    return wire().choice(frame.name, name, raw) if field.choices else f"{field.value(raw):.6g}"


@contextmanager
def live_view(link: Link, what: str, steps: int) -> Iterator[Callable[[float], None]]:
    """Shows a link's frames until the end of the context; yields a function to call after steps of the run."""
    view = View(link, what, steps)
    link.listeners.append(view.take)
    with Live(view, console=Console(stderr=True), refresh_per_second=REFRESHES_PER_S):
        yield view.moved
