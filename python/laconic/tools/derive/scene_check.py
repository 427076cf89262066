"""The C core's derivative against the derived equations, at random states and inputs."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.tools.analyse.from_core import Subject, nu_rates
from laconic.tools.derive.brackets import Bracketed
from laconic.tools.derive.scene_system import rate_function


def core_difference(subject: Subject, system: Bracketed, *, count: int = 1000, seed: int = 2) -> float:
    """Largest difference of ν' over `count` random states, over the size of what is added up in it."""
    rng, core, n = np.random.default_rng(seed), subject.core, subject.wheel_count
    derived = rate_function(subject.numbers(), system)
    basis = np.linalg.svd(core.numbers(subject.model.nu_of_zeta, 3, 3)[:, : subject.model.dof])[0]
    allowed = basis[:, : subject.model.dof]
    worst = 0.0
    for _ in range(count):
        nu = allowed @ rng.normal(0.0, 5.0, allowed.shape[1])
        theta = rng.uniform(-10.0, 10.0)
        inputs: dict[str, Any] = {
            "voltage_V": rng.normal(0.0, 5.0, n), "axle_torque_Nm": rng.normal(0.0, 0.5, n),
            "body_force_N": rng.normal(0.0, 2.0, 2), "body_moment_Nm": rng.normal(0.0, 0.5),
            "world_force_N": rng.normal(0.0, 2.0, 2), "world_force_point_m": rng.normal(0.0, 0.2, 2),
        }
        found = nu_rates(core, subject.model, nu, theta, core.input(inputs, n))
        wrench = (*inputs["body_force_N"], inputs["body_moment_Nm"])
        expected = derived(nu, theta, inputs["voltage_V"], inputs["axle_torque_Nm"], wrench,
                           inputs["world_force_N"], inputs["world_force_point_m"])
        worst = max(worst, float(np.abs(found - expected).max() / max(1.0, np.abs(expected).max())))
    return worst
