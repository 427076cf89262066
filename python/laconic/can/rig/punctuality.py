"""How punctual the rig itself is. A PC that stalls sends late and reads late, which must not count against the node."""

from __future__ import annotations

from laconic.can.rig.link import Clock
from laconic.can.rig.verdict import Verdict
from laconic.can.rig.wire import wire


class Punctuality:
    """Instants at which voltages were due and were sent, and the time in which the rig did not listen.

    `now_us` is the time that has passed while the rig was listening: frames that wait in a queue while the PC stalls
    are not late in it.
    """

    def __init__(self, clock: Clock, cycle_s: float, watchdog_ms: int):
        self.clock, self.cycle_us = clock, round(1e6 * cycle_s)
        self.allowed_us = 1000 * (watchdog_ms or int(wire()["VOLTAGE"].attributes["GenMsgTimeout"]))
        self.watchdog_ms = watchdog_ms
        self.worst_lateness_us = 0
        self.left_out = 0           # cycles in which no voltages went out
        self.next_us = clock.now_us()
        self._longest_pause_us = 0
        self._sent_us: int | None = self.next_us  # START restarts the watchdog, too
        self._not_listening_us = 0
        self._listened_us: int | None = None

    # ---- sending

    def is_due(self) -> bool:
        """Whether the next voltages are due."""
        return self.clock.now_us() >= self.next_us

    def is_late(self) -> bool:
        """Whether they are overdue by more than half a cycle."""
        return self.clock.now_us() - self.next_us > self.cycle_us // 2

    def sent(self) -> None:
        """Notes that voltages were sent. Cycles that have passed meanwhile are left out, not sent in a burst."""
        now_us = self.clock.now_us()
        lateness = now_us - self.next_us
        missed = max(0, lateness // self.cycle_us)
        self.worst_lateness_us = max(self.worst_lateness_us, lateness)
        self._longest_pause_us = self.longest_pause_us()
        self.left_out += missed
        self.next_us += (1 + missed) * self.cycle_us
        self._sent_us = now_us

    def longest_pause_us(self) -> int:
        """Longest pause between two sets of voltages, the present one included."""
        lasting = 0 if self._sent_us is None else self.clock.now_us() - self._sent_us
        return max(self._longest_pause_us, lasting)

    def ended(self) -> None:
        """No more voltages are due: the last pause ends here."""
        self._longest_pause_us, self._sent_us = self.longest_pause_us(), None

    # ---- listening

    def listens(self) -> None:
        """The rig begins to wait for a frame; it did not listen since the last wait ended."""
        now_us = self.clock.now_us()
        if self._listened_us is not None:
            self._not_listening_us += now_us - self._listened_us

    def listened(self, until_us: int) -> None:
        """The wait is over; it was to end at `until_us` at the latest."""
        self._listened_us = self.clock.now_us()
        self._not_listening_us += max(0, self._listened_us - until_us)

    def now_us(self) -> int:
        """The clock less the time in which the rig did not listen."""
        return self.clock.now_us() - self._not_listening_us

    # ---- results

    def was_too_late(self) -> bool:
        """Whether the rig itself has caused a timeout."""
        return self.longest_pause_us() > self.allowed_us

    def explains_timeout(self) -> str:
        """Why the node's watchdog has expired: the rig was late, or its frames were lost."""
        pause_ms = self.longest_pause_us() / 1000.0
        if self.was_too_late():
            return (f"because the rig sent no voltages for {pause_ms:.0f} ms (watchdog {self.watchdog_ms} ms): this PC "
                    "has stalled, not the node")
        return (f"although the rig sent voltages in time (longest pause {pause_ms:.0f} ms, watchdog "
                f"{self.watchdog_ms} ms): they did not arrive")

    def verdict(self) -> Verdict:
        """Whether the rig has kept its own cycle; no verdict on the node."""
        pause_us = self.longest_pause_us()
        detail = (f"voltages at most {self.worst_lateness_us / 1000.0:.1f} ms late, longest pause "
                  f"{pause_us / 1000.0:.1f} ms of {self.allowed_us / 1000.0:.0f} ms, {self.left_out} cycles left out")
        detail += ": this PC has stalled" if self.was_too_late() else ""
        return Verdict("rig", not self.was_too_late(), detail, pause_us / 1e6, self.allowed_us / 1e6)

    def figures(self) -> dict[str, float]:
        """For JSON."""
        return {"rig_worst_lateness_us": self.worst_lateness_us, "rig_longest_pause_us": self.longest_pause_us(),
                "rig_left_out_cycles": self.left_out}
