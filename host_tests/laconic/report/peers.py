"""Other people's integrators on the same equations: CasADi's generated RK4, CVODE from C, compiled DOP853, SciPy.

What is not installed is left out and said so. C sources are in core_c/bench/peers; the matrices of the vehicle and,
for CasADi, the whole step are generated here.
"""

from __future__ import annotations

import ctypes
import importlib
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laconic.report.equations import Course, Equations, equations_of, solve

COMPILE = ["gcc", "-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=default", "-Wl,-Bsymbolic"]


def _c_number(value: float) -> str:
    return repr(float(value))


def _c_rows(rows: Any) -> str:
    return "{" + ", ".join("{" + ", ".join(map(_c_number, row)) + "}" for row in np.atleast_2d(rows)) + "}"


def scene_header(course: Course, casadi_work: tuple[int, int, int, int] = (2, 1, 1, 1)) -> str:
    """peer_scene.h: the constants of one vehicle and its drive."""
    e = equations_of(course.vehicle)
    voltages = [segment.voltage_V for segment in course.segments]
    numbers = {"yaw_scale": e.yaw_scale, "radius": e.radius_m, "gain": e.gain, "damping": e.damping}
    names = ("ARGUMENTS", "RESULTS", "INTEGER_WORK", "WORK")
    lines = ["#ifndef PEER_SCENE_H", "#define PEER_SCENE_H"]
    lines += [f"#define PEER_WHEELS {len(course.vehicle.wheels)}", f"#define PEER_SEGMENTS {len(course.segments)}"]
    lines += [f"#define PEER_CASADI_{name} {max(1, size)}" for name, size in zip(names, casadi_work, strict=True)]
    lines += [f"static const double peer_{name} = {_c_number(value)};" for name, value in numbers.items()]
    lines += [f"static const double peer_wheel_rows[PEER_WHEELS][3] = {_c_rows(e.wheel_rows)};"]
    lines += [f"static const double peer_inverse_inertia[3][3] = {_c_rows(e.inverse_inertia)};"]
    lines += [f"static const double peer_start[6] = {_c_rows([*course.nu, *course.pose])[1:-1]};"]
    lines += [f"static const double peer_voltage_V[PEER_SEGMENTS][PEER_WHEELS] = {_c_rows(voltages)};"]
    durations = [[segment.duration_s for segment in course.segments]]
    lines += [f"static const double peer_segment_s[PEER_SEGMENTS] = {_c_rows(durations)[1:-1]};", "#endif", ""]
    return "\n".join(lines)


@dataclass(frozen=True)
class Solution:
    """What one run gave: states at the segments' ends and the thread CPU time it took."""

    states: list[Any]
    seconds: float


def casadi_rk4_source(equations: Equations, wheels: int, step_s: float, folder: Path) -> tuple[int, int, int, int]:
    """Write peer_step.c: one classical Runge-Kutta step of all states. Returns the sizes of its work arrays."""
    casadi = importlib.import_module("casadi")
    state, voltage = casadi.SX.sym("state", 6 + wheels), casadi.SX.sym("voltage", wheels)
    rates = casadi.Function("rates", [state, voltage], [_casadi_rates(casadi, equations, state, voltage)])
    k1 = rates(state, voltage)
    k2 = rates(state + step_s / 2 * k1, voltage)
    k3 = rates(state + step_s / 2 * k2, voltage)
    k4 = rates(state + step_s * k3, voltage)
    step = casadi.Function("peer_step", [state, voltage], [state + step_s / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
    generator = casadi.CodeGenerator("peer_step.c", {"with_header": False})
    generator.add(step)
    generator.generate(f"{folder}/")
    return step.sz_arg(), step.sz_res(), step.sz_iw(), step.sz_w()


def _casadi_rates(casadi: Any, e: Equations, state: Any, voltage: Any) -> Any:
    nu, heading = state[:3], state[5]
    rows = casadi.DM(e.wheel_rows)
    speed = casadi.mtimes(rows, nu)
    gyroscopic = casadi.vertcat(nu[1] * nu[2], -nu[0] * nu[2], 0) / e.yaw_scale
    force = gyroscopic + casadi.mtimes(rows.T, e.gain * voltage - e.damping * speed)
    cosine, sine = casadi.cos(heading), casadi.sin(heading)
    travel = e.radius_m * casadi.vertcat(nu[0] * cosine - nu[1] * sine, nu[0] * sine + nu[1] * cosine)
    return casadi.vertcat(casadi.mtimes(casadi.DM(e.inverse_inertia), force), travel, nu[2] / e.yaw_scale, speed)


class CasadiRk4:
    """CasADi's generated C for one step size, compiled by gcc -O2."""

    def __init__(self, course: Course, steps_per_second: int, sources: Path, folder: Path) -> None:
        """Generate, compile and load."""
        folder.mkdir(parents=True, exist_ok=True)
        self.course, self.steps_per_second = course, steps_per_second
        wheels = len(course.vehicle.wheels)
        work = casadi_rk4_source(equations_of(course.vehicle), wheels, 1.0 / steps_per_second, folder)
        (folder / "peer_scene.h").write_text(scene_header(course, work))
        self.library = _compile(folder, "casadi", [sources / "casadi_rk4.c", folder / "peer_step.c"], sources, ["-lm"])
        self.library.peer_run.argtypes = [ctypes.c_long, ctypes.c_long]

    def run(self, steps: int) -> float:
        """Thread CPU seconds for `steps` steps."""
        start = time.thread_time_ns()
        self.library.peer_run(steps, self.steps_per_second)
        return (time.thread_time_ns() - start) * 1e-9

    def state_after(self, steps: int) -> Any:
        """The state after `steps` steps from the start."""
        out = (ctypes.c_double * (6 + len(self.course.vehicle.wheels)))()
        self.library.peer_reset()
        self.library.peer_run(steps, self.steps_per_second)
        self.library.peer_state(out)
        return np.array(out)


def _compile(folder: Path, name: str, files: list[Path], include: Path, libraries: list[str]) -> ctypes.CDLL:
    target = folder / f"lib{name}.so"
    command = [*COMPILE, f"-I{folder}", f"-I{include}", *map(str, files), "-o", str(target), *libraries]
    subprocess.run(command, check=True, capture_output=True, text=True)
    return ctypes.CDLL(str(target))


SUNDIALS = ["-lsundials_cvode", "-lsundials_nvecserial", "-lsundials_sunmatrixdense", "-lsundials_sunlinsoldense"]


def cvode_runner(course: Course, sources: Path, folder: Path) -> Callable[[bool, float], Solution]:
    """CVODE from C: call with (BDF?, rtol); runs the whole course."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "peer_scene.h").write_text(scene_header(course))
    libraries = [*SUNDIALS, "-lsundials_sunnonlinsolfixedpoint", "-lm"]
    library = _compile(folder, "cvode", [sources / "cvode.c", sources / "rhs.c"], sources, libraries)
    library.peer_cvode.argtypes = [ctypes.c_int, ctypes.c_double, ctypes.c_double, ctypes.POINTER(ctypes.c_double)]
    size, ends = 6 + len(course.vehicle.wheels), len(course.segments)

    def run(bdf: bool, rtol: float) -> Solution:
        out = (ctypes.c_double * (size * ends))()
        start = time.thread_time_ns()
        failed = library.peer_cvode(int(bdf), rtol, rtol * 1e-2, out)
        seconds = (time.thread_time_ns() - start) * 1e-9
        if failed:
            raise RuntimeError(f"CVODE gave up at rtol {rtol:g}")
        return Solution(list(np.array(out).reshape(ends, size)), seconds)

    return run


def dop853_runner(course: Course, sources: Path, folder: Path) -> Callable[[float], Solution]:
    """numbalsoda's compiled DOP853 on the C right-hand side, its loop compiled too: call with rtol."""
    numba, numbalsoda = importlib.import_module("numba"), importlib.import_module("numbalsoda")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "peer_scene.h").write_text(scene_header(course))
    library = _compile(folder, "rhs", [sources / "rhs.c"], sources, ["-lm"])
    address = ctypes.cast(library.peer_rhs, ctypes.c_void_p).value
    dop853 = numbalsoda.dop853

    def course_loop(function, state, durations, voltages, rtol, states):  # noqa: ANN001, ANN202
        good = True
        for k in range(durations.size):
            times = np.array([0.0, durations[k]])
            points, success = dop853(function, state, times, voltages[k], rtol, rtol * 1e-2)
            state = points[1].copy()
            states[k] = state
            good = good and success
        return good

    compiled = numba.njit(course_loop)
    durations = np.array([segment.duration_s for segment in course.segments])
    voltages = np.array([segment.voltage_V for segment in course.segments])
    begin = np.concatenate([course.nu, course.pose, np.zeros(len(course.vehicle.wheels))])

    def run(rtol: float) -> Solution:
        states = np.zeros((durations.size, begin.size))
        start = time.thread_time_ns()
        good = compiled(address, begin.copy(), durations, voltages, rtol, states)
        seconds = (time.thread_time_ns() - start) * 1e-9
        if not good:
            raise RuntimeError(f"DOP853 gave up at rtol {rtol:g}")
        return Solution(list(states), seconds)

    run.library = library  # type: ignore[attr-defined]  # the address must stay loaded
    run(1e-3)  # compiles
    return run


def scipy_runner(course: Course, solver: str) -> Callable[[float], Solution]:
    """SciPy with the numpy right-hand side: call with rtol."""

    def run(rtol: float) -> Solution:
        start = time.thread_time_ns()
        states = solve(course, solver, rtol, rtol * 1e-2)
        return Solution(states, (time.thread_time_ns() - start) * 1e-9)

    return run
