"""Integrators of other projects on the same equations: CasADi's generated RK4, CVODE from C, compiled DOP853, SciPy.

A peer that is not installed is left out and named. C sources are in core_c/bench/peers; the matrices of the vehicle
and, for CasADi, the whole step are generated here, from the same numpy reference that SciPy integrates.
"""

from __future__ import annotations

import ctypes
import importlib
import importlib.util
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from laconic.scene import Scene
from laconic.tools.report.workshop import BENCH, run_tool
from laconic.tools.verify.reference import Reference

SOURCES = BENCH / "peers"
COMPILE = ("gcc", "-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-Wl,-Bsymbolic")
SUNDIALS = ("sundials_cvode", "sundials_nvecserial", "sundials_sunmatrixdense", "sundials_sunlinsoldense",
            "sundials_sunnonlinsolfixedpoint")


@dataclass(frozen=True)
class Course:
    """A scene with held voltages, as a general solver sees it."""

    reference: Reference
    start: np.ndarray
    durations_s: np.ndarray
    voltages_V: np.ndarray


@dataclass(frozen=True)
class Solution:
    """Result of a run: states at the segments' ends and the thread CPU time it took."""

    states: np.ndarray
    seconds: float


def course_of(scene: Scene) -> Course:
    """From a scene whose only inputs are voltages in steps."""
    reference, wheels = Reference(scene.vehicle), range(1, scene.wheel_count + 1)
    segments = list(scene.inputs_on_grid().segments())
    at = scene.initial
    start = np.concatenate([reference.nu(scene), [at.x_m, at.y_m, at.heading_rad], np.zeros(scene.wheel_count)])
    voltages = [[segment.values.get(f"voltage_V[{i}]", 0.0) for i in wheels] for segment in segments]
    return Course(reference, start, np.array([s.steps for s in segments]) * scene.run.step_s, np.array(voltages))


def missing_peers() -> list[str]:
    """Names of what is not installed here."""
    found = [name for name in ("casadi", "numbalsoda") if importlib.util.find_spec(name) is None]
    headers = (Path("/usr/include"), Path("/usr/local/include"))
    cvode = any((folder / "cvode/cvode.h").exists() for folder in headers)
    return found if cvode else [*found, "SUNDIALS CVODE (libsundials-dev)"]


def _rows(rows: Any) -> str:
    return "{" + ", ".join("{" + ", ".join(repr(float(v)) for v in row) + "}" for row in np.atleast_2d(rows)) + "}"


def scene_header(course: Course, casadi_work: Sequence[int] = (2, 1, 1, 1)) -> str:
    """peer_scene.h: the constants of one vehicle and its inputs."""
    r, t = course.reference, course.reference.totals
    numbers = {"yaw_scale": r.yaw_scale, "radius": t.wheel_radius_m, "gain": r.scale * t.motor_gain_Nm_per_V,
               "damping": r.scale * t.motor_damping_Nms}
    names = ("ARGUMENTS", "RESULTS", "INTEGER_WORK", "WORK")
    lines = ["#ifndef PEER_SCENE_H", "#define PEER_SCENE_H", f"#define PEER_WHEELS {len(r.wheels)}",
             f"#define PEER_SEGMENTS {len(course.durations_s)}"]
    lines += [f"#define PEER_CASADI_{name} {max(1, size)}" for name, size in zip(names, casadi_work, strict=True)]
    lines += [f"static const double peer_{name} = {value!r};" for name, value in numbers.items()]
    lines += [f"static const double peer_wheel_rows[PEER_WHEELS][3] = {_rows(r.rows)};",
              f"static const double peer_inverse_inertia[3][3] = {_rows(r.mobility)};",
              f"static const double peer_start[6] = {_rows([course.start[:6]])[1:-1]};",
              f"static const double peer_voltage_V[PEER_SEGMENTS][PEER_WHEELS] = {_rows(course.voltages_V)};",
              f"static const double peer_segment_s[PEER_SEGMENTS] = {_rows([course.durations_s])[1:-1]};", "#endif", ""]
    return "\n".join(lines)


def compile_peer(folder: Path, name: str, course: Course, files: list[Path], libraries: Sequence[str],
                 casadi_work: Sequence[int] = (2, 1, 1, 1)) -> ctypes.CDLL:
    """Compiles a peer for a course into a shared library and loads it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "peer_scene.h").write_text(scene_header(course, casadi_work))
    target = folder / f"lib{name}.so"
    run_tool([*COMPILE, f"-I{folder}", f"-I{SOURCES}", *map(str, files), "-o", str(target),
              *(f"-l{library}" for library in libraries)])
    return ctypes.CDLL(str(target))


class CasadiRk4:
    """CasADi's generated C of one classical Runge-Kutta step of all states, by gcc -O2."""

    def __init__(self, course: Course, steps_per_second: int, folder: Path) -> None:
        """Generate, compile and load."""
        folder.mkdir(parents=True, exist_ok=True)
        self.course, self.steps_per_second, self.folder = course, steps_per_second, folder
        self.work = casadi_rk4_source(course.reference, 1.0 / steps_per_second, folder)
        self.library = compile_peer(folder, "casadi", course, [SOURCES / "casadi_rk4.c", folder / "peer_step.c"], ["m"],
                                self.work)
        self.library.peer_run.argtypes = [ctypes.c_long, ctypes.c_long]
        self.library.peer_reset()

    def run(self, steps: int) -> float:
        """Thread CPU seconds for `steps` steps."""
        start = time.thread_time_ns()
        self.library.peer_run(steps, self.steps_per_second)
        return (time.thread_time_ns() - start) * 1e-9

    def state_after(self, steps: int) -> np.ndarray:
        """The state after `steps` steps from the start."""
        out = (ctypes.c_double * len(self.course.start))()
        self.library.peer_reset()
        self.library.peer_run(steps, self.steps_per_second)
        self.library.peer_state(out)
        return np.array(out)

    def program(self) -> Path:
        """The same as a program that takes the number of steps, for counting instructions."""
        target = self.folder / "count_casadi"
        run_tool(["gcc", "-std=c99", "-O2", "-ffp-contract=off", f"-DSTEPS_PER_SECOND={self.steps_per_second}",
                  f"-I{self.folder}", f"-I{SOURCES}", str(SOURCES / "casadi_rk4.c"), str(SOURCES / "casadi_count.c"),
                  str(self.folder / "peer_step.c"), "-o", str(target), "-lm"])
        return target


def casadi_rk4_source(reference: Reference, step_s: float, folder: Path) -> tuple[int, int, int, int]:
    """Write peer_step.c. Returns the sizes of its work arrays."""
    casadi = importlib.import_module("casadi")
    wheels = len(reference.wheels)
    state, voltage = casadi.SX.sym("state", 6 + wheels), casadi.SX.sym("voltage", wheels)
    rates = casadi.Function("rates", [state, voltage], [_casadi_rates(casadi, reference, state, voltage)])
    k1 = rates(state, voltage)
    k2 = rates(state + step_s / 2 * k1, voltage)
    k3 = rates(state + step_s / 2 * k2, voltage)
    k4 = rates(state + step_s * k3, voltage)
    step = casadi.Function("peer_step", [state, voltage], [state + step_s / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
    generator = casadi.CodeGenerator("peer_step.c", {"with_header": False})
    generator.add(step)
    generator.generate(f"{folder}/")
    return step.sz_arg(), step.sz_res(), step.sz_iw(), step.sz_w()


def _casadi_rates(casadi: Any, r: Reference, state: Any, voltage: Any) -> Any:
    nu, heading, rows = state[:3], state[5], casadi.DM(r.rows)
    gain, damping = r.scale * r.totals.motor_gain_Nm_per_V, r.scale * r.totals.motor_damping_Nms
    speed = casadi.mtimes(rows, nu)
    turning = casadi.vertcat(nu[1] * nu[2], -nu[0] * nu[2], 0) / r.yaw_scale
    force = turning + casadi.mtimes(rows.T, gain * voltage - damping * speed)
    cosine, sine = casadi.cos(heading), casadi.sin(heading)
    radius = r.totals.wheel_radius_m
    travel = radius * casadi.vertcat(nu[0] * cosine - nu[1] * sine, nu[0] * sine + nu[1] * cosine)
    return casadi.vertcat(casadi.mtimes(casadi.DM(r.mobility), force), travel, nu[2] / r.yaw_scale, speed)


def cvode_runner(course: Course, folder: Path) -> Callable[[bool, float], Solution]:
    """CVODE from C: call with (BDF?, rtol); runs the whole course."""
    library = compile_peer(folder, "cvode", course, [SOURCES / "cvode.c", SOURCES / "rhs.c"], [*SUNDIALS, "m"])
    library.peer_cvode.argtypes = [ctypes.c_int, ctypes.c_double, ctypes.c_double, ctypes.POINTER(ctypes.c_double)]
    shape = (len(course.durations_s), len(course.start))

    def run(bdf: bool, rtol: float) -> Solution:
        out = (ctypes.c_double * (shape[0] * shape[1]))()
        start = time.thread_time_ns()
        failed = library.peer_cvode(int(bdf), rtol, rtol * 1e-2, out)
        seconds = (time.thread_time_ns() - start) * 1e-9
        if failed:
            raise RuntimeError(f"CVODE gave up at rtol {rtol:g}")
        return Solution(np.array(out).reshape(shape), seconds)

    return run


def dop853_runner(course: Course, folder: Path, compiled_rhs: bool) -> Callable[[float], Solution]:
    """numbalsoda's DOP853 with the loop over segments compiled too: call with rtol.

    The right-hand side is the C one (compiled_rhs), or one written for numba, as numbalsoda's manual shows it.
    """
    numba, numbalsoda = importlib.import_module("numba"), importlib.import_module("numbalsoda")
    library = compile_peer(folder, "rhs", course, [SOURCES / "rhs.c"], ["m"])
    rhs = None if compiled_rhs else _numba_rhs(numba, numbalsoda, course)
    address = ctypes.cast(library.peer_rhs, ctypes.c_void_p).value if rhs is None else rhs.address
    dop853 = numbalsoda.dop853

    def segments(function: Any, state: Any, durations: Any, voltages: Any, rtol: float, states: Any) -> bool:
        good = True
        for k in range(durations.size):
            points, success = dop853(function, state, np.array([0.0, durations[k]]), voltages[k], rtol, rtol * 1e-2)
            state = points[1].copy()
            states[k] = state
            good = good and success
        return good

    loop = numba.njit(segments)

    def run(rtol: float) -> Solution:
        states = np.zeros((len(course.durations_s), len(course.start)))
        start = time.thread_time_ns()
        good = loop(address, course.start.copy(), course.durations_s, course.voltages_V, rtol, states)
        seconds = (time.thread_time_ns() - start) * 1e-9
        if not good:
            raise RuntimeError(f"DOP853 gave up at rtol {rtol:g}")
        return Solution(states, seconds)

    run.keeps = (library, rhs)  # type: ignore[attr-defined]  # the address must stay loaded
    run(1e-3)  # compiles
    return run


def _numba_rhs(numba: Any, numbalsoda: Any, course: Course) -> Any:
    r = course.reference
    rows, mobility, wheels = r.rows.copy(), r.mobility.copy(), len(r.wheels)
    yaw_scale, radius = r.yaw_scale, r.totals.wheel_radius_m
    gain, damping = r.scale * r.totals.motor_gain_Nm_per_V, r.scale * r.totals.motor_damping_Nms

    def rhs(_t: float, state_at: Any, rates_at: Any, voltage_at: Any) -> None:
        state = numba.carray(state_at, (6 + wheels,))
        rates = numba.carray(rates_at, (6 + wheels,))
        voltage = numba.carray(voltage_at, (wheels,))
        n1, n2, n3 = state[0], state[1], state[2]
        cosine, sine, yaw_rate = np.cos(state[5]), np.sin(state[5]), n3 / yaw_scale
        f1, f2, f3 = n2 * yaw_rate, -n1 * yaw_rate, 0.0
        for i in range(wheels):
            speed = rows[i, 0] * n1 + rows[i, 1] * n2 + rows[i, 2] * n3
            torque = gain * voltage[i] - damping * speed
            f1, f2, f3 = f1 + rows[i, 0] * torque, f2 + rows[i, 1] * torque, f3 + rows[i, 2] * torque
            rates[6 + i] = speed
        for k in range(3):
            rates[k] = mobility[k, 0] * f1 + mobility[k, 1] * f2 + mobility[k, 2] * f3
        rates[3], rates[4] = radius * (n1 * cosine - n2 * sine), radius * (n1 * sine + n2 * cosine)
        rates[5] = yaw_rate

    return numba.cfunc(numbalsoda.lsoda_sig)(rhs)


def scipy_runner(course: Course, solver: str) -> Callable[[float], Solution]:
    """SciPy with the numpy right-hand side: call with rtol."""
    names = [f"voltage_V[{i + 1}]" for i in range(course.voltages_V.shape[1])]

    def run(rtol: float) -> Solution:
        state, states, start = course.start, [], time.thread_time_ns()
        for duration, voltages in zip(course.durations_s, course.voltages_V, strict=True):
            terms = course.reference.forcing_terms(dict(zip(names, voltages, strict=True)))
            found = solve_ivp(lambda _t, y, b=terms: course.reference.rates(y, b), (0.0, duration), state, solver,
                              rtol=rtol, atol=rtol * 1e-2)
            state = found.y[:, -1]
            states.append(state)
        return Solution(np.array(states), (time.thread_time_ns() - start) * 1e-9)

    return run


def rates_of_peer(scene: Scene, folder: Path, states: int = 20, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Rates at random states by the C source that all peers integrate, and by the numpy reference."""
    course, random = course_of(scene), np.random.default_rng(seed)
    library = compile_peer(folder, "rhs", course, [SOURCES / "rhs.c"], ["m"])
    found, expected = [], []
    names = [f"voltage_V[{i + 1}]" for i in range(course.voltages_V.shape[1])]
    for state in random.normal(size=(states, len(course.start))):
        rates, held = np.empty_like(state), course.voltages_V[0].copy()
        library.peer_derivative(*(ctypes.c_void_p(a.ctypes.data) for a in (state, held, rates)))
        found.append(rates)
        terms = course.reference.forcing_terms(dict(zip(names, held, strict=True)))
        expected.append(course.reference.rates(state, terms))
    return np.array(found), np.array(expected)
