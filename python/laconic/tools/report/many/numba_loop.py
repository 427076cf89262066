"""The step for numba, as its manual advises: arrays of numbers side by side, one compiled loop, constants frozen in it.

Two loops: vehicle by vehicle, whose numbers stay in registers over all steps; and step by step over short rows of
vehicles, which LLVM may put side by side. And two steps: the textbook's, with sine and cosine at each of four stages;
and one with the core's formula of the pose, which needs a single sine and cosine.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from laconic.tools.report.many.task import Equations, Runner, Task, equations_of

ROW = 64  # vehicles that stay in the first cache


def numba_runs(task: Task, real: str) -> dict[str, Runner]:
    """Name → (a run, the states), compiled."""
    dtype = np.float64 if real == "double" else np.float32
    equations = equations_of(task, dtype)
    return {"numba, by vehicle": _runner(task, equations, _by_vehicle(equations, _textbook_pose)),
            "numba, by rows": _runner(task, equations, _by_rows(equations, _textbook_pose)),
            "numba, core's formula": _runner(task, equations, _by_vehicle(equations, _core_pose))}


def _runner(task: Task, equations: Equations, loop: Any) -> Runner:
    dtype = equations.wheels.dtype
    state, travel = np.zeros((6, task.lanes), dtype), np.zeros((3, task.lanes), dtype)
    state[5] = task.headings_rad
    forcing = (equations.forcing @ task.voltages_V.astype(dtype)).astype(dtype)
    loop(state, travel, forcing, 0)  # compiles

    def run() -> None:
        loop(state, travel, forcing, task.steps)

    def states() -> np.ndarray:
        return np.vstack([state, equations.wheels @ travel]).astype(float)

    return run, states


def _step_of(numba: Any, e: Equations, pose: Callable[[Any, Equations], Any]) -> Any:
    """One step of one vehicle: numbers in, numbers out. Its parts are inlined, its constants are literals."""
    dtype = type(e.step_s)
    h, half, sixth, two = e.step_s, e.step_s / dtype(2), e.step_s / dtype(6), dtype(2)
    (t11, t12), (t21, t22), (t31, t32) = ((dtype(v) for v in row) for row in e.turning)
    (d11, d12, d13), (d21, d22, d23), (d31, d32, d33) = ((dtype(v) for v in row) for row in e.damping)
    moved = pose(numba, e)

    @numba.njit(inline="always")
    def rate(n1, n2, n3, b1, b2, b3):  # type: ignore[no-untyped-def]
        ahead, aside = n2 * n3, -n1 * n3
        return (t11 * ahead + t12 * aside - (d11 * n1 + d12 * n2 + d13 * n3) + b1,
                t21 * ahead + t22 * aside - (d21 * n1 + d22 * n2 + d23 * n3) + b2,
                t31 * ahead + t32 * aside - (d31 * n1 + d32 * n2 + d33 * n3) + b3)

    @numba.njit(inline="always")
    def step(n1, n2, n3, x, y, heading, s1, s2, s3, b1, b2, b3):  # type: ignore[no-untyped-def]
        k1, k2, k3 = rate(n1, n2, n3, b1, b2, b3)
        p1, p2, p3 = n1 + half * k1, n2 + half * k2, n3 + half * k3
        l1, l2, l3 = rate(p1, p2, p3, b1, b2, b3)
        q1, q2, q3 = n1 + half * l1, n2 + half * l2, n3 + half * l3
        m1, m2, m3 = rate(q1, q2, q3, b1, b2, b3)
        r1, r2, r3 = n1 + h * m1, n2 + h * m2, n3 + h * m3
        j1, j2, j3 = rate(r1, r2, r3, b1, b2, b3)
        w1, w2 = sixth * (n1 + two * (p1 + q1) + r1), sixth * (n2 + two * (p2 + q2) + r2)
        w3 = sixth * (n3 + two * (p3 + q3) + r3)
        g1, g2 = sixth * (k1 + two * (l1 + m1) + j1), sixth * (k2 + two * (l2 + m2) + j2)
        g3 = sixth * (k3 + two * (l3 + m3) + j3)
        dx, dy, yawed = moved(heading, n1, n2, n3, p1, p2, p3, q1, q2, q3, r1, r2, w1, w2, w3, g1, g2, g3)
        return n1 + g1, n2 + g2, n3 + g3, x + dx, y + dy, heading + yawed, s1 + w1, s2 + w2, s3 + w3

    return step


def _textbook_pose(numba: Any, e: Equations) -> Any:
    """Pose by the same four stages as ν."""
    dtype = type(e.step_s)
    h, half, two, yaw = e.step_s, e.step_s / dtype(2), dtype(2), dtype(1) / e.yaw_scale
    length = e.radius_m * e.step_s / dtype(6)

    @numba.njit(inline="always")
    def velocity(n1, n2, heading):  # type: ignore[no-untyped-def]
        cosine, sine = math.cos(heading), math.sin(heading)
        return n1 * cosine - n2 * sine, n1 * sine + n2 * cosine

    @numba.njit(inline="always")
    def moved(heading, n1, n2, n3, p1, p2, p3, q1, q2, q3, r1, r2,  # type: ignore[no-untyped-def]
              w1, w2, w3, g1, g2, g3):
        ax, ay = velocity(n1, n2, heading)
        bx, by = velocity(p1, p2, heading + half * (yaw * n3))
        cx, cy = velocity(q1, q2, heading + half * (yaw * p3))
        dx, dy = velocity(r1, r2, heading + h * (yaw * q3))
        return length * (ax + two * (bx + cx) + dx), length * (ay + two * (by + cy) + dy), yaw * w3

    return moved


def _core_pose(numba: Any, e: Equations) -> Any:
    """Pose from the mean w/h of ν and its change g, as step_internals.h derives it; small yaws alone."""
    dtype, h, radius, yaw = type(e.step_s), e.step_s, e.radius_m, type(e.step_s)(1) / e.yaw_scale
    half, one, twelfth = dtype(0.5), dtype(1), dtype(1 / 12)
    s3, s5, s7 = dtype(1 / 6), dtype(1 / 120), dtype(1 / 5040)
    j1, j3, j5 = dtype(1 / 6), dtype(1 / 60), dtype(1 / 1680)

    @numba.njit(inline="always")
    def moved(heading, n1, n2, n3, p1, p2, p3, q1, q2, q3, r1, r2,  # type: ignore[no-untyped-def]
              w1, w2, w3, g1, g2, g3):
        yawed = yaw * w3
        a = half * yawed
        z = a * a
        sinc, half_j1 = one - z * (s3 - z * (s5 - z * s7)), a * (j1 - z * (j3 - z * j5))
        bend, forth, left = yaw * h * g3 * twelfth, radius * w1, radius * w2
        along = sinc * forth - (half_j1 * radius * h * g2 - bend * left)
        across = sinc * left + (half_j1 * radius * h * g1 - bend * forth)
        cosine, sine = math.cos(heading + a), math.sin(heading + a)
        return cosine * along - sine * across, sine * along + cosine * across, yawed

    return moved


def _by_vehicle(e: Equations, pose: Any) -> Any:
    numba = importlib.import_module("numba")
    step = _step_of(numba, e, pose)

    @numba.njit(parallel=False, fastmath=False, error_model="numpy")
    def loop(state, travel, b, steps):  # type: ignore[no-untyped-def]
        for i in range(state.shape[1]):
            n1, n2, n3 = state[0, i], state[1, i], state[2, i]
            x, y, heading = state[3, i], state[4, i], state[5, i]
            s1, s2, s3, b1, b2, b3 = travel[0, i], travel[1, i], travel[2, i], b[0, i], b[1, i], b[2, i]
            for _ in range(steps):
                n1, n2, n3, x, y, heading, s1, s2, s3 = step(n1, n2, n3, x, y, heading, s1, s2, s3, b1, b2, b3)
            state[0, i], state[1, i], state[2, i], state[3, i], state[4, i], state[5, i] = n1, n2, n3, x, y, heading
            travel[0, i], travel[1, i], travel[2, i] = s1, s2, s3

    return loop


def _by_rows(e: Equations, pose: Any) -> Any:
    numba = importlib.import_module("numba")
    step = _step_of(numba, e, pose)

    @numba.njit(parallel=False, fastmath=False, error_model="numpy")
    def loop(state, travel, b, steps):  # type: ignore[no-untyped-def]
        for first in range(0, state.shape[1], ROW):
            end = min(first + ROW, state.shape[1])
            for _ in range(steps):
                for i in range(first, end):
                    (state[0, i], state[1, i], state[2, i], state[3, i], state[4, i], state[5, i], travel[0, i],
                     travel[1, i], travel[2, i]) = step(
                        state[0, i], state[1, i], state[2, i], state[3, i], state[4, i], state[5, i], travel[0, i],
                        travel[1, i], travel[2, i], b[0, i], b[1, i], b[2, i])

    return loop
