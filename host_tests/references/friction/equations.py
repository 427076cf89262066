"""The equations of one friction step for given modes, in scaled unknowns: residuals of 40 digits, the matrix in double.

Unknowns are z = (ν, s), each contact's impulse p along its slip, and each axle's impulse along its speed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpmath import mp, mpf

from references.friction.conic import scale_of
from references.friction.problem import StepProblem

DIGITS = 40


@dataclass
class Modes:
    """What each contact, axle and motor does."""

    sticks: np.ndarray          # N, bool: contacts
    stuck: np.ndarray           # N, bool: axles
    motor: np.ndarray           # N, int: 0 within the limit, ±1 at it
    turning: np.ndarray         # N, int: the sign of s where an axle turns
    sliding: np.ndarray         # N, int: the sign of slip_u where a contact with k = 0 slips

    def key(self) -> bytes:
        """For comparison."""
        return b"|".join(np.ascontiguousarray(part).tobytes() for part in vars(self).values())


def exact(values: np.ndarray) -> np.ndarray:
    """The same numbers as mpf."""
    flat = np.empty(values.size, object)
    flat[:] = [mpf(float(v)) for v in values.ravel()]
    return flat.reshape(values.shape)


class Equations:
    """The equations of one problem in scaled unknowns; residuals in mpf, matrix in double."""

    def __init__(self, problem: StepProblem):
        self.problem, self.count, self.scale = problem, problem.wheels, scale_of(problem)
        self.two = np.array([[True, k > 0.0] for k in problem.drag])       # directions that a contact has
        self.active = problem.grip > 0.0
        rows = problem.slip_rows()
        self.rows = rows
        mass = problem.masses() + np.concatenate([np.zeros(3), problem.viscous])
        self.mass = mass
        weight = np.einsum("ndz,z,ndz->nd", rows, 1.0 / mass, rows)
        self.weights = np.where(weight > 0.0, weight, 1.0)      # of each direction
        self.weight = np.where(weight.max(axis=1) > 0.0, weight.max(axis=1), 1.0)
        self.z_unit = self.scale / np.sqrt(mass)
        self.p_unit = np.minimum(np.where(self.active, problem.grip, np.inf), self.scale / np.sqrt(self.weight))
        self.p_unit = np.where(self.active, self.p_unit, 1.0)
        self.axle_unit = np.where(problem.axle > 0.0, np.minimum(problem.axle, self.scale * np.sqrt(mass[3:])), 1.0)
        with mp.workdps(DIGITS):
            self.x_rows = np.stack([exact(problem.along), exact(problem.across)], axis=1)
            self.x = {name: exact(np.where(np.isfinite(value), value, 0.0))
                      for name, value in vars(problem).items() if value.ndim == 1}

    def slips(self, z: np.ndarray) -> np.ndarray:
        """N × 2, mpf."""
        x, nu, speed = self.x, z[:3], z[3:]
        along = self.x_rows[:, 0] @ nu - x["rim_along"] * speed
        across = x["drag"] * (self.x_rows[:, 1] @ nu - x["rim_across"] * speed)
        return np.stack([along, across], axis=1)

    def motor(self, speed: np.ndarray, modes: Modes) -> np.ndarray:
        """Impulses in mpf."""
        x = self.x
        free = x["drive"] - x["drive_slope"] * speed
        return np.where(modes.motor == 0, free, modes.motor * x["drive_limit"])

    def residual(self, z: np.ndarray, p: np.ndarray, axle: np.ndarray, modes: Modes) -> np.ndarray:
        """All equations, scaled, mpf: 3 + N of balance, 2N of contacts, N of axles."""
        x, speed, drag = self.x, z[3:], self.x["drag"]
        body = z[:3] - x["free_nu"] + p[:, 0] @ self.x_rows[:, 0] + (drag * p[:, 1]) @ self.x_rows[:, 1]
        wheel = (x["inertia"] * (speed - x["free_speed"]) + x["viscous"] * speed - self.motor(speed, modes) + axle
                 - x["rim_along"] * p[:, 0] - x["rim_across"] * drag * p[:, 1])
        balance = np.concatenate([body, wheel]) / exact(self.scale * np.sqrt(self.mass))
        return np.concatenate([balance, self._contacts(z, p, modes).ravel(), self._axles(speed, axle, modes)])

    def _contacts(self, z: np.ndarray, p: np.ndarray, modes: Modes) -> np.ndarray:
        slips, out = self.slips(z), np.empty((self.count, 2), object)
        unit = exact(self.scale * np.sqrt(self.weight))
        for i in range(self.count):
            grip = self.x["grip"][i]
            if not self.active[i]:
                out[i] = p[i]
            elif modes.sticks[i]:
                out[i] = slips[i] / exact(self.scale * np.sqrt(self.weights[i]))
            elif not self.two[i, 1]:
                out[i, 0] = (p[i, 0] - int(modes.sliding[i]) * grip) / mpf(self.p_unit[i])
            else:
                size = mp.sqrt(slips[i, 0]**2 + slips[i, 1]**2)
                out[i] = (size * p[i] / grip - slips[i]) / unit[i]
            if not self.two[i, 1]:
                out[i, 1] = p[i, 1]
        return out

    def _axles(self, speed: np.ndarray, axle: np.ndarray, modes: Modes) -> np.ndarray:
        out = np.empty(self.count, object)
        for i in range(self.count):
            if modes.stuck[i]:
                out[i] = speed[i] / mpf(self.z_unit[3 + i])
            else:
                out[i] = (axle[i] - int(modes.turning[i]) * self.x["axle"][i]) / mpf(self.axle_unit[i])
        return out

    def matrix(self, z: np.ndarray, p: np.ndarray, modes: Modes) -> np.ndarray:
        """The derivative of the scaled residual by the scaled unknowns, double."""
        count, problem = self.count, self.problem
        size = 3 + count
        out = np.zeros((size + 3 * count, size + 3 * count))
        stiff = self.mass + np.concatenate([np.zeros(3), np.where(modes.motor == 0, problem.drive_slope, 0.0)])
        out[:size, :size] = np.diag(stiff * self.z_unit / (self.scale * np.sqrt(self.mass)))
        unit = self.scale * np.sqrt(self.weight)
        for i in range(count):
            at = slice(size + 2 * i, size + 2 * i + 2)
            rows = self.rows[i]
            out[:size, at] = rows.T * self.p_unit[i] / (self.scale * np.sqrt(self.mass))[:, None]
            out[at, :size], out[at, at] = self._contact_matrix(i, rows @ z, p[i], modes, unit[i])
            place = size + 2 * count + i
            out[3 + i, place] = self.axle_unit[i] / (self.scale * np.sqrt(self.mass[3 + i]))
            if modes.stuck[i]:
                out[place, 3 + i] = 1.0
            else:
                out[place, place] = 1.0
        return out

    def _contact_matrix(self, i: int, slip: np.ndarray, p: np.ndarray, modes: Modes,
                        unit: float) -> tuple[np.ndarray, np.ndarray]:
        by_z, by_p = np.zeros((2, 3 + self.count)), np.zeros((2, 2))
        if not self.active[i]:
            return by_z, np.eye(2) * self.p_unit[i]
        if modes.sticks[i]:
            by_z = self.rows[i] * self.z_unit / (self.scale * np.sqrt(self.weights[i]))[:, None]
        elif not self.two[i, 1]:
            by_p[0, 0] = 1.0
        else:
            grip, size = self.problem.grip[i], float(np.hypot(*slip))
            direction = slip / size if size > 0.0 else p / max(float(np.hypot(*p)), 1e-300)
            by_z = (np.outer(p / grip, direction) - np.eye(2)) @ self.rows[i] * self.z_unit / unit
            by_p = np.eye(2) * size / grip * self.p_unit[i] / unit
        if not self.two[i, 1]:
            by_z[1], by_p[1] = 0.0, (0.0, self.p_unit[i])
        return by_z, by_p
