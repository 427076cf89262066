"""Detects a node that sends no more, by the contract's cycle times and timeouts.

A cyclic frame that is missing for its GenMsgTimeout fails the verdict `timeouts`. When one is missing for the timeout
of HEARTBEAT, too, the node counts as dead and the run ends. All times are the rig's listening time: see Punctuality.
"""

from __future__ import annotations

from collections.abc import Iterable

from laconic.can.rig.errors import NodeSilent
from laconic.can.rig.verdict import Verdict
from laconic.can.rig.wire import wire

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
