"""The numpy reference for very stiff vehicles: SciPy's implicit Radau with the exact Jacobian, restarted at jumps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from laconic.scene import Scene
from laconic.tools.verify.reference import Reference, kinks, values_at

RTOL, ATOL = 1e-10, 1e-12

Terms = Callable[[float], tuple[np.ndarray, ...]]


def jacobian(reference: Reference, state: np.ndarray) -> np.ndarray:
    """Derivative of the rates by the state, for inputs without forces fixed in the world."""
    (n1, n2, n3), per_yaw = state[:3], 1.0 / reference.yaw_scale
    cosine, sine, radius = np.cos(state[5]), np.sin(state[5]), reference.totals.wheel_radius_m
    out = np.zeros((len(state), len(state)))
    turning = per_yaw * np.array([[0.0, n3, n2], [-n3, 0.0, -n1], [0.0, 0.0, 0.0]])
    out[:3, :3] = reference.mobility @ turning - reference.damping
    out[3, :3], out[4, :3] = (radius * cosine, -radius * sine, 0.0), (radius * sine, radius * cosine, 0.0)
    out[3, 5], out[4, 5] = radius * (-n1 * sine - n2 * cosine), radius * (n1 * cosine - n2 * sine)
    out[5, 2] = per_yaw
    out[6:, :3] = reference.rows
    return out


def stiff_states(scene: Scene, at_s: np.ndarray) -> np.ndarray:
    """States (ν, x, y, θ, χ) of a scene at some instants, ascending and after 0."""
    reference, inputs, start = Reference(scene.vehicle), scene.inputs_on_grid(), scene.initial
    state = np.concatenate([reference.nu(scene), [start.x_m, start.y_m, start.heading_rad],
                            np.zeros(len(reference.wheels))])
    edges = np.unique(np.concatenate([[0.0], kinks(inputs), at_s]))
    jumps, found = {0.0, *kinks(inputs)}, {}
    begun = 0.0
    for begin, end in zip(edges, edges[1:], strict=False):
        begun = begin if begin in jumps else begun
        state = _stretch(reference, _terms(reference, scene, begun), state, begin, end)
        found[end] = state
    return np.array([found[t] for t in at_s])


def _terms(reference: Reference, scene: Scene, begun: float) -> Terms:
    inputs = scene.inputs_on_grid()
    if inputs.is_held:
        held = reference.forcing_terms(values_at(inputs, begun, begun))
        return lambda t: held
    return lambda t: reference.forcing_terms(values_at(inputs, t, begun))


def _stretch(reference: Reference, terms: Terms, state: np.ndarray, begin: float, end: float) -> np.ndarray:
    solution = solve_ivp(lambda t, y: reference.rates(y, terms(t)), (begin, end), state, "Radau", rtol=RTOL, atol=ATOL,
                         jac=lambda t, y: jacobian(reference, y))
    if not solution.success:
        raise RuntimeError(f"the reference at t = {end:g} s: {solution.message}")
    return solution.y[:, -1]
