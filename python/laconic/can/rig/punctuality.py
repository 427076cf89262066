"""How punctual the rig itself is. A PC that stalls sends late and reads late, which must not count against the node.

Detects a node that sends no more, by the contract's cycle times and timeouts.

A cyclic frame that is missing for its GenMsgTimeout fails the verdict `timeouts`. When one is missing for the timeout
of HEARTBEAT, too, the node counts as dead and the run ends. All times are the rig's listening time: see Punctuality.
"""

from __future__ import annotations

from collections.abc import Iterable

from laconic.can.rig.errors import NodeSilent
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


ONCE_A_PERIOD = ("NU", "POSE", "WHEEL_SPEED", "STATE_FD", "WHEEL_ANGLE", "IMU", "ENCODER")


class Silence:
    """Instant of the last frame of each cyclic kind, and the longest gap between two of them."""

    def __init__(self, names: Iterable[str], period_s: float, now_us: int):
        self.allowed_us = {name: timeout_us(name, period_s) for name in names}
        self.longest_us = dict.fromkeys(self.allowed_us, 0)
        self._last_us = dict.fromkeys(self.allowed_us, now_us)
        self._dead_us = timeout_us("HEARTBEAT", period_s)

    def received(self, name: str, now_us: int) -> None:
        """Notes the instant of a frame."""
        if name in self._last_us:
            self.longest_us[name] = max(self.longest_us[name], now_us - self._last_us[name])
            self._last_us[name] = now_us

    def check(self, now_us: int) -> None:
        """NodeSilent once a frame has been missing for too long. Call it when nothing more waits to be read."""
        missing_us = {name: now_us - last_us for name, last_us in self._last_us.items()}
        for name, silent_us in missing_us.items():
            self.longest_us[name] = max(self.longest_us[name], silent_us)
        if any(silent_us > max(self.allowed_us[name], self._dead_us) for name, silent_us in missing_us.items()):
            late = [name for name, silent_us in missing_us.items() if silent_us > self.allowed_us[name]]
            raise NodeSilent(f"no {', '.join(late)} for {max(missing_us.values()) / 1000.0:.0f} ms, more than the "
                             "contract's timeouts: the node or the line to it is dead")

    def verdict(self) -> Verdict:
        """Whether every cyclic frame came within its timeout."""
        worst = max(self.longest_us, key=lambda name: self.longest_us[name] / self.allowed_us[name])
        longest_us, allowed_us = self.longest_us[worst], self.allowed_us[worst]
        return Verdict("timeouts", longest_us <= allowed_us, f"{worst} missing for {longest_us / 1000.0:.1f} ms at "
                       f"most, {allowed_us / 1000.0:.0f} ms allowed", longest_us / 1e6, allowed_us / 1e6)


def timeout_us(name: str, period_s: float) -> int:
    """GenMsgTimeout; longer in proportion where the node's period is longer than GenMsgCycleTime."""
    attributes = wire()[name].attributes
    timeout_ms, cycle_ms = float(attributes["GenMsgTimeout"]), float(attributes["GenMsgCycleTime"])
    stretch = max(1.0, 1000.0 * period_s / cycle_ms) if name in ONCE_A_PERIOD else 1.0
    return round(1000.0 * timeout_ms * stretch)
