"""The step for JAX, as its manual advises: written for one vehicle, jax.vmap over many, all steps in one jax.jit."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable
from typing import Any

import numpy as np

from laconic.tools.report.many.task import Equations, Runner, Task, equations_of

ONE_CORE = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"


def jax_on_one_core() -> Any:
    """JAX for the processor, without threads of its own, in double precision where arrays are; call it first."""
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} {ONE_CORE}".strip()
    jax = importlib.import_module("jax")
    jax.config.update("jax_enable_x64", True)
    return jax


def jax_run(task: Task, real: str) -> Runner:
    """A run and the states, compiled."""
    jax, dtype = jax_on_one_core(), np.float64 if real == "double" else np.float32
    e = equations_of(task, dtype)
    step = jax.vmap(_step_of(jax.numpy, e))
    all_steps = jax.jit(lambda state, b: jax.lax.fori_loop(0, task.steps, lambda _, now: step(now, b), state))
    forcing = (e.forcing @ task.voltages_V.astype(dtype)).astype(dtype)
    b = tuple(jax.numpy.asarray(row) for row in forcing)
    rows = [np.zeros(task.lanes, dtype) for _ in range(9)]
    rows[5] = task.headings_rad.astype(dtype)
    held = {"state": tuple(jax.numpy.asarray(row) for row in rows)}
    jax.block_until_ready(all_steps(held["state"], b))  # compiles

    def run() -> None:
        held["state"] = jax.block_until_ready(all_steps(held["state"], b))

    def states() -> np.ndarray:
        found = np.array([np.asarray(row) for row in held["state"]])
        return np.vstack([found[:6], e.wheels @ found[6:]]).astype(float)

    return run, states


def _step_of(jnp: Any, e: Equations) -> Callable[[Any, Any], Any]:
    """One step of one vehicle: a tuple of numbers, so that vmap gives each an array of its own."""
    dtype = type(e.step_s)
    h, half, sixth, two = e.step_s, e.step_s / dtype(2), e.step_s / dtype(6), dtype(2)
    radius, yaw, turning, damping = e.radius_m, dtype(1) / e.yaw_scale, e.turning, e.damping

    def rate(nu: Any, b: Any) -> Any:
        ahead, aside = nu[1] * nu[2], -nu[0] * nu[2]
        return tuple(turning[k, 0] * ahead + turning[k, 1] * aside
                     - (damping[k, 0] * nu[0] + damping[k, 1] * nu[1] + damping[k, 2] * nu[2]) + b[k] for k in range(3))

    def along(nu: Any, by: Any, k: Any) -> Any:
        return tuple(n + by * each for n, each in zip(nu, k, strict=True))

    def velocity(nu: Any, heading: Any) -> Any:
        cosine, sine = jnp.cos(heading), jnp.sin(heading)
        return nu[0] * cosine - nu[1] * sine, nu[0] * sine + nu[1] * cosine

    def weighted(a: Any, b: Any, c: Any, d: Any) -> Any:
        return tuple(sixth * (one + two * (two_ + three) + four)
                     for one, two_, three, four in zip(a, b, c, d, strict=True))

    def step(state: Any, b: Any) -> Any:
        n, heading = state[:3], state[5]
        k1 = rate(n, b)
        p = along(n, half, k1)
        k2 = rate(p, b)
        q = along(n, half, k2)
        k3 = rate(q, b)
        r = along(n, h, k3)
        k4 = rate(r, b)
        moved = weighted(velocity(n, heading), velocity(p, heading + half * (yaw * n[2])),
                         velocity(q, heading + half * (yaw * p[2])), velocity(r, heading + h * (yaw * q[2])))
        path = weighted(n, p, q, r)
        gained = weighted(k1, k2, k3, k4)
        return (*along(n, dtype(1), gained), state[3] + radius * moved[0], state[4] + radius * moved[1],
                heading + yaw * path[2], *along(state[6:], dtype(1), path))

    return step
