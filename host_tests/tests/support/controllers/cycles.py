"""The cycles of a controller: their count, their pace and the slowest of them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

TURN_RAD = 2.0 * math.pi
SLOWEST_CYCLES = 2000  # a period of the wanted speed
PATIENCE_S = 20.0      # until the drives have the speed that is wanted at the end


@dataclass
class Cycles:
    """So many of them. A controller that nothing paces takes one in each `period_s`."""

    wanted: int
    period_s: float
    done: int = 0
    slowest_s: float = 0.0
    _began: float = field(default_factory=time.perf_counter)
    _next: float = 0.0
    _until: float = math.inf

    def go_on(self, arrived: Callable[[], bool]) -> bool:
        """Whether another one is to be done: until all are, and the speed that is wanted at the end has come."""
        if self.done < self.wanted:
            return True
        self._until = min(self._until, time.perf_counter() + PATIENCE_S)
        return not arrived() and time.perf_counter() < self._until

    def end(self) -> None:
        """One is done."""
        now = time.perf_counter()
        if self.done > 0:  # the first one waits for the bus
            self.slowest_s = max(self.slowest_s, now - self._began)
        self._began = now
        self.done += 1

    def pause_s(self) -> float:
        """Seconds to the next period; 0 where it has begun. A controller that is late does not catch up."""
        now = time.perf_counter()
        self._next = max(self._next + self.period_s, now)
        return self._next - now

    def share(self, number: int) -> float:
        """What drive `number` shall do in this cycle, −1 to 1: sines out of step with each other, and at the end a
        constant, so that the speed can settle."""
        if 4 * self.done > 3 * self.wanted:
            return 0.5
        return math.sin(TURN_RAD * self.done / min(SLOWEST_CYCLES, self.wanted) + 2.0 * number)
