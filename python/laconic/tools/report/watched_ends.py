"""Both ends of the bus in a case of the fault matrix, watched for what must not happen."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import can

from laconic.can.rig.buses import NodeOnBus, VirtualClock
from laconic.can.rig.link import Link, Received
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.wire import ID_BASE, wire


@dataclass
class Row:
    """One case."""

    fault: str
    frame: str
    injected: int = 0
    undetected: int = 0                     # changed or doubled frames that were accepted
    detected_by: Counter[str] = field(default_factory=Counter)
    detection_ms: float | None = None       # from the first fault to the first sign of it
    stage: str = "open"
    state: str = ""
    problems: list[str] = field(default_factory=list)

    @property
    def good(self) -> bool:
        """Nothing that must not happen has happened."""
        return not self.problems


Multiset = Counter[tuple[int, bytes]]  # frames, with how often they were sent and not yet taken


class WatchedLink(Link):
    """A link that records the frames of the node and its own."""

    def __init__(self, *arguments: Any, row: Row, sent: Multiset, node_sent: Multiset, **options: Any):
        super().__init__(*arguments, **options)
        self.sent, self.node_sent = sent, node_sent
        self.row = row

    def send_message(self, message: can.Message) -> None:
        self.sent[message.arbitration_id, bytes(message.data)] += 1
        super().send_message(message)

    def take(self, message: can.Message) -> Received | None:
        before = sum(self.faults.values())
        received = super().take(message)
        key = (message.arbitration_id, bytes(message.data))
        if received is not None:
            self.row.undetected += self.node_sent[key] <= 0
            self.node_sent[key] -= 1
        if sum(self.faults.values()) > before:
            self.row.detected_by["rig"] += 1
        return received


class WatchedNode(NodeOnBus):
    """The node's end; checks the invariants after every frame."""

    def __init__(self, node: LibraryNode, bus: can.BusABC, clock: VirtualClock, row: Row):
        super().__init__(node, bus, clock)
        self.row = row
        self.rig_sent: Multiset = Counter()
        self.sent: Multiset = Counter()
        self.allowed_V: set[float] = {0.0}
        self.view = node.inspect()
        self.snapshot = node.snapshot()  # of that view

    def deliver(self, message: can.Message) -> None:
        before = self.node.inspect()
        super().deliver(message)
        after = self.node.inspect()
        key = (message.arbitration_id, bytes(message.data))
        if after["accepted"] > before["accepted"]:
            self.row.undetected += self.rig_sent[key] <= 0
            self.rig_sent[key] -= self.takes_once(message)
        for name in ("crc_errors", "sequence_errors", "repeated", "lost", "malformed", "refused"):
            if after[name] > before[name]:
                self.row.detected_by[name] += after[name] - before[name]
        self.refresh()

    @staticmethod
    def takes_once(message: can.Message) -> bool:
        """HELLO changes no state, so the contract allows duplicates; a corrupted HELLO is refused as any frame."""
        return message.arbitration_id != ID_BASE + wire()["HELLO"].offset

    def sent_frame(self, message: can.Message) -> None:
        self.sent[message.arbitration_id, bytes(message.data)] += 1
        super().sent_frame(message)

    def pump(self) -> bool:
        busy = super().pump()
        self.refresh()
        return busy

    def refresh(self) -> None:
        """The invariants, where anything differs from the last time."""
        snapshot = self.node.snapshot()
        if snapshot == self.snapshot:
            return
        self.snapshot = snapshot
        view, before = self.node.inspect(), self.view
        strange = [v for v in view["voltage_V"] if v not in self.allowed_V]
        if strange:
            self.row.problems.append(f"voltage {strange[0]} was never sent")
        if view["state"] in ("empty", "ready", "timeout", "fault") and any(view["voltage_V"]):
            self.row.problems.append(f"voltage in state {view['state']}")
        stands = view["state"] == before["state"] and view["state"] in ("empty", "ready", "fault")
        if stands and view["steps"] > before["steps"]:
            self.row.problems.append(f"stepped in state {view['state']}")
        if view["state"] == "timeout" and before["state"] == "free run":
            self.row.detected_by["timeout"] += 1
        self.view = view


# ---- Two ends of a bus in one thread, for cases by the hundred in virtual time: python-can's virtual bus copies
# each frame deeply and locks a queue for each look at it.

class PairedBus(can.BusABC):
    """One end; what it sends waits at the other, and a look at it never blocks."""

    channel_info = "paired bus"

    def __init__(self) -> None:
        super().__init__(channel=self.channel_info)
        self._arrived: deque[can.Message] = deque()
        self._other = self

    def join(self, other: PairedBus) -> None:
        """From now on they are two ends of the same bus."""
        self._other, other._other = other, self

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """The frame is at the other end at once; neither end changes it."""
        self._other._arrived.append(msg)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """The next frame; None where none waits, whatever the timeout: no other thread could send one meanwhile."""
        return self._arrived.popleft() if self._arrived else None


@contextmanager
def paired_buses() -> Iterator[tuple[PairedBus, PairedBus]]:
    """Both ends of one bus."""
    with PairedBus() as near, PairedBus() as far:
        near.join(far)
        yield near, far
