"""What goes over the bus, on the terminal, while it goes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

import can
from rich.console import Console
from rich.live import Live
from rich.table import Table

from laconic.rig.link import Link
from laconic.rig.wire import wire

HIDDEN = ("crc", "counter", "data", "segment")
REFRESHES_PER_S = 10


class View:
    """The last of each frame, as a table."""

    def __init__(self, link: Link):
        self.link = link
        self._last: dict[int, bytes] = {}
        self._count: Counter[int] = Counter()

    def take(self, message: can.Message) -> None:
        """A frame was sent or received."""
        offset = message.arbitration_id - self.link.id_base
        self._last[offset] = bytes(message.data)
        self._count[offset] += 1

    def __rich__(self) -> Table:
        table = Table(title=f"ID base 0x{self.link.id_base:X}", title_justify="left")
        for heading in ("frame", "count", "signals"):
            table.add_column(heading)
        for offset, data in sorted(self._last.items()):
            frame = wire().by_offset.get(offset)
            known = frame is not None and len(data) == frame.length
            signals = "  ".join(f"{name} {value:.6g}" for name, value in frame.physical(data).items()
                                if not name.startswith(HIDDEN)) if known else data.hex(" ")
            name = frame.name if frame else f"0x{offset + self.link.id_base:X}"
            table.add_row(name, str(self._count[offset]), signals)
        faults = ", ".join(f"{count} × {name}" for name, count in self.link.faults.items())
        table.caption = faults or "no faults"
        return table


@contextmanager
def live_view(link: Link) -> Iterator[None]:
    """Shows a link's frames until the end of the context."""
    view = View(link)
    link.listeners.append(view.take)
    with Live(view, console=Console(stderr=True), refresh_per_second=REFRESHES_PER_S):
        yield
