"""An approximate solution of a friction step, taken to 30 digits: the modes are found, then their equations solved.

Modes: a contact sticks (slip 0, force within the grip) or slips (force of full size along the slip); an axle sticks or
turns; a motor is free, or at one end of its limit. For fixed modes the equations are solved by Newton's method with
residuals of 40 digits and a matrix in double; then every sign is checked, and a mode that does not hold is changed.
Where contacts are redundant their forces are not unique: least squares keep them near the conic solution's.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from mpmath import mp, mpf

from references.friction.conic import ConicSolution, scale_of, solve_conic
from references.friction.equations import DIGITS, Equations, Modes, exact
from references.friction.problem import StepProblem

GOAL = 1e-30           # of the scaled equations
CERTAIN = 1e-14
MOST_MODE_SETS = 25
MOST_PASSES = 25


@dataclass
class Polished:
    """The solution: z to 30 digits and rounded, the modes, and how far the equations are fulfilled."""

    z: np.ndarray
    slip_impulse: np.ndarray    # N × 2, along the slip
    axle_impulse: np.ndarray
    error: float                # of the scaled equations; GOAL or less: polished
    modes: Modes
    exact: list[Any] = field(default_factory=list, repr=False)   # z as mpf

    @property
    def done(self) -> bool:
        """Whether the modes hold and their equations are solved."""
        return self.error <= GOAL

    @property
    def certain(self) -> bool:
        """Whether they are solved to rounding: all that redundant contacts allow, whose rows differ by rounding."""
        return self.error <= CERTAIN


def first_modes(problem: StepProblem, conic: ConicSolution) -> Modes:
    """Which side of its corner each part of an approximate solution is nearer to."""
    speed, slip = conic.z[3:], np.einsum("ndz,z->nd", problem.slip_rows(), conic.z)
    scale = scale_of(problem)
    mass = problem.masses() + np.concatenate([np.zeros(3), problem.viscous])
    weight = np.einsum("ndz,z,ndz->nd", problem.slip_rows(), 1.0 / mass, problem.slip_rows()).max(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        short = 1.0 - np.hypot(*conic.slip_impulse.T) / problem.grip
        room = 1.0 - np.abs(conic.axle_impulse) / problem.axle
        sticks = np.hypot(*slip.T) / (scale * np.sqrt(np.where(weight > 0.0, weight, 1.0))) < np.maximum(short, 0.0)
        stuck = np.abs(speed) * np.sqrt(mass[3:]) / scale < np.maximum(room, 0.0)
    free = problem.drive - problem.drive_slope * speed
    motor = np.where(np.abs(free) > problem.drive_limit, np.sign(free), 0).astype(int)
    return Modes((sticks | np.isinf(problem.grip)) & (problem.grip > 0.0), stuck & (problem.axle > 0.0), motor,
                 _sign(np.where(np.abs(conic.axle_impulse) > 0.5 * problem.axle, conic.axle_impulse, speed)),
                 _sign(conic.slip_impulse[:, 0]))


def _sign(values: np.ndarray) -> np.ndarray:
    return np.where(values < 0.0, -1, 1)


def polish(problem: StepProblem, conic: ConicSolution | None = None) -> Polished:
    """The exact solution; `done` is False where no set of modes was found that holds."""
    conic = conic or solve_conic(problem)
    equations, modes = Equations(problem), first_modes(problem, conic)
    best, seen, random = None, set(), np.random.default_rng(1)
    with mp.workdps(DIGITS):
        start = exact(conic.z), exact(conic.slip_impulse), exact(conic.axle_impulse)
        for _ in range(MOST_MODE_SETS):
            seen.add(modes.key())
            z, p, axle, error = _newton(equations, *start, modes)
            better, violation = _checked(equations, z, p, axle, modes)
            found = Polished(z.astype(float), p.astype(float), axle.astype(float), max(error, violation), modes,
                             list(z))
            best = found if best is None or found.error < best.error else best
            if best.done or (best.certain and better.key() == modes.key()):
                break
            modes = better if better.key() not in seen else _some_of(random, best.modes, better)
    assert best is not None
    return best


def _some_of(random: np.random.Generator, old: Modes, new: Modes) -> Modes:
    """Some of the changes, where all of them lead in a circle."""
    return Modes(*(np.where(random.random(len(a)) < 0.5, a, b)
                   for a, b in zip(vars(old).values(), vars(new).values(), strict=True)))


def _newton(equations: Equations, z: np.ndarray, p: np.ndarray, axle: np.ndarray,
            modes: Modes) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    count, size = equations.count, 3 + equations.count
    units = exact(np.concatenate([equations.z_unit, np.repeat(equations.p_unit, 2), equations.axle_unit]))
    unknown = np.concatenate([z, p.ravel(), axle])
    best = (mpf("inf"), unknown)
    for _ in range(MOST_PASSES):
        z, p, axle = unknown[:size], unknown[size:size + 2 * count].reshape(count, 2), unknown[size + 2 * count:]
        rest = equations.residual(z, p, axle, modes)
        error = max(abs(r) for r in rest)
        best = min(best, (error, unknown), key=lambda pair: pair[0])
        if error <= GOAL / 100 or not mp.isfinite(error):
            break
        power = mpf(10) ** int(mp.floor(mp.log10(error)))      # so that residuals below 1e-300 keep their digits
        matrix = equations.matrix(z.astype(float), p.astype(float), modes)
        step = _least_squares(matrix, (rest / power).astype(float))
        unknown = unknown - exact(step) * power * units
    error, unknown = best
    return (unknown[:size], unknown[size:size + 2 * count].reshape(count, 2), unknown[size + 2 * count:],
            float(error))


def _least_squares(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The shortest step, rows and columns first brought to one size, so that only true redundancy counts as such."""
    rows, columns = np.ones(len(matrix)), np.ones(len(matrix))
    for _ in range(4):
        scaled = np.abs(matrix * rows[:, None] * columns)
        rows /= np.sqrt(np.maximum(scaled.max(axis=1), 1e-300))
        columns /= np.sqrt(np.maximum(scaled.max(axis=0), 1e-300))
    return columns * np.linalg.lstsq(matrix * rows[:, None] * columns, right * rows, rcond=1e-13)[0]


def _checked(equations: Equations, z: np.ndarray, p: np.ndarray, axle: np.ndarray,
             modes: Modes) -> tuple[Modes, float]:
    """Modes with those changed that do not hold, and by how much they do not."""
    problem, x, tiny = equations.problem, equations.x, mpf(GOAL)
    new = Modes(*(part.copy() for part in vars(modes).values()))
    worst, slips = mpf(0), equations.slips(z)
    for i in range(equations.count):
        if equations.active[i]:
            worst = max(worst, _check_contact(equations, i, slips[i], p[i], modes, new))
        if problem.axle[i] > 0.0:
            over = (abs(axle[i]) / x["axle"][i] - 1) if modes.stuck[i] else \
                -int(modes.turning[i]) * z[3 + i] / mpf(equations.z_unit[3 + i])
            if over > tiny:
                new.stuck[i] = not modes.stuck[i]
                new.turning[i] = _sign(np.array(float(axle[i])))
                worst = max(worst, over)
        if np.isfinite(problem.drive_limit[i]) and problem.drive_slope[i] > 0.0:
            free, limit = x["drive"][i] - x["drive_slope"][i] * z[3 + i], x["drive_limit"][i]
            wanted = 0 if abs(free) <= limit else (1 if free > 0 else -1)
            over = (abs(abs(free) - limit) / limit) if limit > 0 else abs(free)
            if wanted != modes.motor[i] and over > tiny:
                new.motor[i] = wanted
                worst = max(worst, over)
    return new, float(worst)


def _check_contact(equations: Equations, i: int, slip: np.ndarray, p: np.ndarray, modes: Modes, new: Modes) -> mpf:
    grip, tiny = equations.x["grip"][i], mpf(GOAL)
    if np.isinf(equations.problem.grip[i]):
        return mpf(0)
    if modes.sticks[i]:
        over = mp.sqrt(p[0]**2 + p[1]**2) / grip - 1
        if over <= tiny:
            return mpf(0)
        new.sticks[i], new.sliding[i] = False, 1 if p[0] > 0 else -1
        return over
    unit = mpf(equations.scale) * mp.sqrt(mpf(equations.weight[i]))
    along = (slip @ p) / grip / unit       # the slip's size where it points as the force does
    short = abs(mp.sqrt(p[0]**2 + p[1]**2) / grip - 1)
    if along >= 0 and (short <= mpf(10)**-20 or not equations.two[i, 1]):
        return mpf(0) if along >= 0 else -along
    new.sticks[i] = True
    return max(-along, short)
