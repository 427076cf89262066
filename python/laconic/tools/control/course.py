"""A course over time, as the states that a robot has on it step by step, and the voltages that keep it there.

    course = Course(robot.plant("auto", step_s=0.05), lambda t: (0.5 * t, 0.2 * np.sin(t), 0.0), duration_s=6.0)
    course.states[k], course.voltage_V[k]
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from laconic.core.copies import OwnMemory
from laconic.core.derivatives import check_smooth
from laconic.core.given import finite_number, shown
from laconic.core.given_array import real_array
from laconic.core.plant import Plant
from laconic.errors import BadInput

MOMENT_S = 1e-4  # over which velocities are differences of poses
STATES = 6       # ν1, ν2, ν3, x, y, θ
MOST_STEPS = 10**6
ROUNDING = 1e-7  # of a duration beside the nearest whole number of steps, which single precision rounds


class Course(OwnMemory):
    """States (steps + 1, 6) in the order ν1, ν2, ν3, x, y, θ, and voltages (steps, N), at the steps of `plant`.

    `pose_at(t)` gives x, y of the centre of mass and the heading, not wrapped, also a moment before 0 and after the
    end. A motion that the wheels do not allow is replaced by the nearest that they do; the voltages are the least that
    move ν along the course, whatever limits a motor has. `plant` is left at the start of the course; a controller of
    the course steps it. BadInput for a duration that is no whole number of steps, and for a `pose_at` that gives
    anything but three finite numbers.
    """

    def __init__(self, plant: Plant, pose_at: Callable[[float], Sequence[float]], duration_s: float):
        check_smooth(plant)
        if not callable(pose_at):
            raise BadInput(f"pose_at: {shown(pose_at)} is no function; give one of time [s] that returns x [m], y [m] "
                           "and the heading [rad]")
        steps = steps_of(duration_s, plant.step_s)
        self.plant, self.step_s = plant, plant.step_s
        self._scale = plant.core.matrices(plant.core.ffi.addressof(plant.c, "vehicle")).lambda_yaw
        self.states = np.array([self._state(pose_at, k * self.step_s) for k in range(steps + 1)])
        self.voltage_V = np.array([self._voltage(*pair) for pair in zip(self.states, self.states[1:], strict=False)])
        place(plant, self.states[0])

    def __len__(self) -> int:
        """Steps."""
        return len(self.voltage_V)

    def _state(self, pose_at: Callable[[float], Sequence[float]], t_s: float) -> np.ndarray:
        pose, before, after = (pose_of(pose_at, t_s + moment_s) for moment_s in (0.0, -MOMENT_S, MOMENT_S))
        cosine, sine, radius = np.cos(pose[2]), np.sin(pose[2]), self.plant.c.model.wheel_radius_m
        with np.errstate(over="ignore", invalid="ignore"):
            vx, vy, yaw_rate = np.subtract(after, before) / (2 * MOMENT_S)
            nu = ((cosine * vx + sine * vy) / radius, (cosine * vy - sine * vx) / radius, self._scale * yaw_rate)
        if not np.isfinite(nu).all():
            raise BadInput(f"pose_at({t_s:g}): moves faster than numbers go; give x and y in m, the heading in rad, "
                           "without jumps")
        place(self.plant, [*nu, *pose])
        return np.array([*self.plant.nu, *pose])

    def _voltage(self, now: np.ndarray, then: np.ndarray) -> np.ndarray:
        """ν after a step is linear in voltages but for a small part: Newton's step from none and one more."""
        volts = np.zeros(self.plant.wheel_count)
        for _ in range(2):
            after, _, by_voltage = step_from(self.plant, now, volts)
            volts = volts + np.linalg.lstsq(by_voltage[:3], then[:3] - after[:3], rcond=1e-9)[0]
        return volts


def steps_of(duration_s: Any, step_s: float) -> int:
    """How many steps a course has."""
    duration = finite_number("duration_s", duration_s)
    if duration > MOST_STEPS * step_s:
        raise BadInput(f"duration_s: {duration:g} s are more than {MOST_STEPS} steps of {step_s:g} s; give less")
    steps = round(duration / step_s)
    if steps < 1:
        raise BadInput(f"duration_s: {duration:g} s is less than a step of {step_s:g} s; give more")
    if abs(duration - steps * step_s) > ROUNDING * duration:
        below = max(1, int(duration / step_s))
        raise BadInput(f"duration_s: {duration:g} s is no whole number of steps of {step_s:g} s; give "
                       f"{below * step_s:g} or {(below + 1) * step_s:g}")
    return steps


def pose_of(pose_at: Callable[[float], Sequence[float]], t_s: float) -> np.ndarray:
    """A pose of a course, (3,)."""
    return real_array(f"pose_at({t_s:g})", pose_at(t_s), (3,), "m, m, rad")


def place(plant: Plant, state: Sequence[float] | np.ndarray) -> None:
    """Puts a plant into a motion (ν1, ν2, ν3, x, y, θ), or the nearest that its wheels allow."""
    ffi, lib, why = plant.core.ffi, plant.core.lib, plant.core.why()
    start = ffi.new("laconic_start *", {"nu_rad_per_s": [float(nu) for nu in state[:3]], "x_m": float(state[3]),
                                        "y_m": float(state[4]), "heading_rad": float(state[5])})
    plant.core.check(lib.laconic_state_project(
        ffi.addressof(plant.c, "state"), ffi.addressof(plant.c, "model"), start, why), why)


def moved(plant: Plant, state: np.ndarray, volts: np.ndarray) -> np.ndarray:
    """The state after a step."""
    place(plant, state)
    plant.run({"voltage_V": list(volts)})
    return np.array([*plant.nu, *plant.pose[:3]])


def step_from(plant: Plant, state: np.ndarray, volts: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The state after a step, and its derivatives by the state (6, 6) and the voltages (6, N)."""
    place(plant, state)
    jacobian = plant.step_derivatives({"voltage_V": list(volts)}).jacobian()
    after = moved(plant, state, volts)
    return after, jacobian.by_state[:STATES, :STATES], jacobian.by_input[:STATES, : plant.wheel_count]
