"""The frames between controller and vehicle, live on the terminal: one line for each identifier."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import can
from rich.console import Console, ConsoleOptions, RenderResult
from rich.live import Live
from rich.table import Table

from laconic.can.play.loop import Traffic
from laconic.can.rig.live import AROUND, REFRESHES_PER_S

Key = tuple[int, bool, bool]  # identifier, 29 bits, remote


class TrafficView:
    """The last frame of each identifier; those that come most often stay when there is no room for all."""

    def __init__(self, what: str):
        self.what, self.seconds = what, 0.0
        self._last: dict[Key, can.Message] = {}
        self._count: Counter[Key] = Counter()

    def moved(self, seconds: float) -> None:
        """So much time has passed."""
        self.seconds += seconds

    def take(self, message: can.Message) -> None:
        """A frame has passed."""
        key = (message.arbitration_id, message.is_extended_id, message.is_remote_frame)
        self._last[key] = message
        self._count[key] += 1

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        room = max(1, (options.height or console.size.height) - AROUND)
        shown = sorted(key for key, _ in self._count.most_common(room))
        hidden = len(self._count) - len(shown)
        table = Table(title=f"{self.what}, {self.seconds:.1f} s", title_justify="left", expand=True,
                      caption=f"{hidden} more identifiers" if hidden else "", caption_justify="left")
        table.add_column("identifier", no_wrap=True)
        table.add_column("count", no_wrap=True, justify="right")
        table.add_column("last", no_wrap=True, overflow="ellipsis", ratio=1)
        for key in shown:
            identifier, is_long, is_remote = key
            text = "remote" if is_remote else bytes(self._last[key].data).hex(" ")
            table.add_row(f"{identifier:0{8 if is_long else 3}X}", str(self._count[key]), text)
        yield table


@contextmanager
def live_traffic(traffic: Traffic, what: str) -> Iterator[Callable[[float], None]]:
    """Shows a bus until the end of the context; yields a function to call when time has passed."""
    view = TrafficView(what)
    traffic.listeners.append(view.take)
    with Live(view, console=Console(stderr=True), refresh_per_second=REFRESHES_PER_S):
        yield view.moved
