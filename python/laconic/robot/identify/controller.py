"""The robot's own speed controller, from recorded set speeds, wheel speeds and currents.

In steady motion the current of a motor is P (set − s) + I ∫(set − s) dt. P is the slope of steady currents over steady
deviations of all wheels; with an integral part the deviation would go to 0 and the slope to infinity, so I is what the
current still gains within the steady motion per integrated deviation. The dead time is that of the first motion.
Intervals take each run as one observation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit  # the quantile of Student's t; scipy.stats takes long to load

from laconic.errors import BadInput
from laconic.robot.identify.solve import CONFIDENCE
from laconic.robot.logs import Log
from laconic.robot.replay.held_wheels import mean_speeds
from laconic.robot.replay.steady_currents import settled

WANTED = "identify --free controller"
LEAST_SET = 0.1       # rad/s: wheels that are set slower say nothing
LEAST_TURN_RAD = 0.02  # of the first motion
LEAST_RUNS = 2


@dataclass(frozen=True)
class FoundController:
    """Values with the half widths of their 95 % intervals."""

    gain_As_per_rad: tuple[float, float]
    integral_gain_A_per_rad: tuple[float, float]
    dead_time_s: tuple[float, float]

    def rows(self) -> list[tuple[str, float, float]]:
        """Name, value, half width."""
        return [(name, *getattr(self, name)) for name in self.__dataclass_fields__]

    def values(self) -> dict[str, float]:
        """For `[speed_controller]`; an integral part that does not differ from 0 is 0."""
        found = {name: value for name, value, _ in self.rows()}
        value, half = self.integral_gain_A_per_rad
        found["integral_gain_A_per_rad"] = value if value > half else 0.0
        return found

    def comments(self) -> dict[str, str]:
        """The intervals."""
        return {name: f"{value:.4g} ± {half:.2g}" for name, value, half in self.rows()}


def controller_of(logs: Sequence[Log]) -> FoundController:
    """From all runs; BadInput where they have no set speeds, currents or steady motion."""
    each = [_steady(log) for log in logs]
    if len(each) < LEAST_RUNS:
        raise BadInput(f"--free controller: needs at least {LEAST_RUNS} runs for an interval; give more of them")
    gain = _slope([(error, current) for error, current, _, _ in each])
    integral = _slope([(gained, change) for _, _, gained, change in each])
    dead = np.array([_dead_time(log) for log in logs])
    half = stdtrit(len(dead) - 1, 0.5 + CONFIDENCE / 2.0) * dead.std(ddof=1) / np.sqrt(len(dead))
    return FoundController(gain, integral, (float(dead.mean()), float(half)))


def _steady(log: Log) -> tuple[np.ndarray, ...]:
    """Of each wheel that is set to turn: mean deviation and current, what I integrates, slope of the current."""
    wanted, current = log.needs("set_speed_rad_per_s", WANTED), log.needs("current_A", WANTED)
    time, speed = mean_speeds(log)
    now, then = settled(log, time), settled(log, log.time_s)
    turns = np.abs(wanted[then].mean(axis=0)) > LEAST_SET
    if not turns.any():
        raise BadInput(f"{log.path}: no wheel is set to turn, so {WANTED} learns nothing; leave it out")
    sign = np.sign(wanted[then].mean(axis=0))
    error = sign * (wanted[then].mean(axis=0) - speed[now].mean(axis=0))
    clock = log.time_s[then] - log.time_s[then].mean()
    slope = sign * (clock @ current[then]) / (clock @ clock)
    return tuple(values[turns] for values in (error, sign * current[then].mean(axis=0), error, slope))


def _slope(pairs: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[float, float]:
    """y = slope · x through 0 with its half width, robust against dependence within a run."""
    moment = sum(float(x @ x) for x, _ in pairs)
    slope = sum(float(x @ y) for x, y in pairs) / moment
    scores = np.array([float(x @ (y - slope * x)) for x, y in pairs])
    correction = len(pairs) / (len(pairs) - 1)
    half = stdtrit(len(pairs) - 1, 0.5 + CONFIDENCE / 2.0) * np.sqrt(correction * (scores @ scores)) / moment
    return float(slope), float(half)


def _dead_time(log: Log) -> float:
    """From the first set speed to the first motion, less half a sample."""
    wanted = log.needs("set_speed_rad_per_s", WANTED)
    begin = log.time_s[int(np.argmax(np.nanmax(np.abs(wanted), axis=1) > LEAST_SET))]
    rotation = np.nanmax(np.abs(np.cumsum(log.rotation_rad(), axis=0)), axis=1)
    moved = int(np.argmax(rotation > LEAST_TURN_RAD))
    return float(max(0.5 * (log.time_s[moved] + log.time_s[moved + 1]) - begin, 0.0))
