"""Friction steps that are hard on purpose: the solution is chosen first, at the corners, and the free motion from it.

From z, p and the axle's impulse τ that are a solution, the free motion is z + M⁻¹(Bᵀp + τ) (no motor). Kinds:
  border       each contact slips by some 1e-7 of the speeds, or sticks with the full force, wheels placed regularly
  small drag   the same at ordinary slips, k from 1e-6 to 1e-2
  no grip      some or all contacts carry nothing
  ratios       wheel inertias and grips over twelve decades
  rigid        contacts without a limit: rolling, or fixed wheels on one axle line
  rest         everything sticks, the axles too
"""

from __future__ import annotations

import numpy as np

from references.friction.problem import StepProblem
from references.friction.vehicles import geometry, random_vehicle

KINDS = ("border", "small drag", "no grip", "ratios", "rigid", "rest")


def hard_problem(kind: str, random: np.random.Generator, wheels: int | None = None) -> StepProblem:
    """One problem of the kind."""
    count = wheels or int(random.integers(1, 5))
    rows, drag = _geometry(random, count), _drags(kind, random, count)
    inertia = 10.0 ** random.uniform(-3, 0.5, count)
    grip = np.full(count, 10.0 ** random.uniform(-4, 1))
    if kind == "ratios":
        inertia, grip = 10.0 ** random.uniform(-6, 6, count), 10.0 ** random.uniform(-6, 6, count)
    if kind == "no grip":
        grip *= random.random(count) < 0.3
    if kind == "rigid":
        grip[:] = np.inf
    axle = np.full(count, float(random.choice([0.0, 10.0 ** random.uniform(-4, 0)])))
    none = np.zeros(count)
    shape = StepProblem(**rows, inertia=inertia, drag=drag, grip=grip, axle=axle, drive=none, drive_slope=none,
                        drive_limit=np.full(count, np.inf), viscous=none, free_speed=none, free_nu=np.zeros(3))
    return _from_solution(kind, random, shape)


def _geometry(random: np.random.Generator, count: int) -> dict[str, np.ndarray]:
    """Of a regular vehicle, whose contacts are redundant, more often than not."""
    return geometry(random_vehicle(random, count))


def _drags(kind: str, random: np.random.Generator, count: int) -> np.ndarray:
    if kind == "small drag":
        return np.full(count, 10.0 ** random.uniform(-6, -2))
    if kind == "rigid":
        return np.full(count, float(random.choice([0.0, 1.0])))
    return np.full(count, float(random.choice([0.0, 0.5, 0.87, 1.0])))


def _from_solution(kind: str, random: np.random.Generator, shape: StepProblem) -> StepProblem:
    count, rows, mass = shape.wheels, shape.slip_rows(), shape.masses()
    pace = 10.0 ** random.uniform(-1, 1.5)
    flat = rows.reshape(2 * count, -1)
    _, sizes, basis = np.linalg.svd(flat)
    still = basis[int((sizes > 1e-9 * sizes.max()).sum()):]         # motions without slip
    z = pace * still.T @ random.standard_normal(len(still))
    if kind in ("border", "small drag", "ratios", "no grip"):
        z = z + pace * (1e-7 if kind == "border" else 1.0) * random.standard_normal(len(z))
    if kind == "rest":
        z = np.zeros_like(z)
    slip = np.einsum("ndz,z->nd", rows, z)
    slip[np.hypot(*slip.T) <= 1e-12 * pace] = 0.0
    bound = np.where(np.isfinite(shape.grip), shape.grip, pace)
    p = np.array([_impulse(random, s, g, d) for s, g, d in zip(slip, bound, shape.drag, strict=True)])
    axle = shape.axle * np.where(z[3:] == 0.0, random.uniform(-1, 1, count), np.sign(z[3:]))
    free = z + np.einsum("ndz,nd->z", rows, p) / mass
    free[3:] += axle / shape.inertia
    return StepProblem(**(vars(shape) | {"free_nu": free[:3], "free_speed": free[3:]}))


def _impulse(random: np.random.Generator, slip: np.ndarray, grip: float, drag: float) -> np.ndarray:
    size = float(np.hypot(*slip))
    if size > 0.0:
        return grip * slip / size
    p = random.standard_normal(2) * np.array([1.0, float(drag > 0.0)])
    return grip * p / max(float(np.hypot(*p)), 1e-300) * float(random.choice([1.0, 1.0, random.random()]))
