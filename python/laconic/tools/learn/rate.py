"""How fast environments go under random actions: `laconic benchmark learn`."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np

from laconic.base.progress import progress_bar
from laconic.tools.learn import ID, DriveToPose, DriveToPoseVector

SPREADS = {"vehicle.mass_kg": 0.2, "vehicle.wheel_radius_m": 0.02, "vehicle.motor.torque_constant_Nm_per_A": 0.1,
           "vehicle.motor.viscous_friction_Nms": (0.0, 1e-5)}
ONE_BY_ONE = 16  # environments of Gymnasium's own vector, which steps one after the other


def rows(lanes: int, rounds: int, actions: int = 20) -> list[dict[str, Any]]:
    """Environment steps a second, most of `rounds` in turn, on one core."""
    many = DriveToPoseVector(lanes, max_episode_steps=300)
    mixed = DriveToPoseVector(lanes, max_episode_steps=300, spreads=SPREADS)
    plain = gymnasium.make_vec(ID, ONE_BY_ONE, vectorization_mode="sync")
    contestants: list[tuple[str, int, Callable[[], object]]] = [
        ("one batch", lanes, _walk(many, actions)),
        ("one batch, randomised vehicles", lanes, _walk(mixed, actions)),
        ("Gymnasium's vector of single ones", ONE_BY_ONE, _walk(plain, actions))]
    best = [float("inf")] * len(contestants)
    with progress_bar("environments", rounds) as advance:
        for _ in range(rounds):
            for k, (_, _, walk) in enumerate(contestants):
                start = time.process_time_ns()
                walk()
                best[k] = min(best[k], (time.process_time_ns() - start) * 1e-9)
            advance()
    inner = DriveToPose().fleet.steps
    return [{"who": name, "environments": count, "thousand_actions_per_s": 1e-3 * count * actions / seconds,
             "million_steps_per_s": 1e-6 * count * actions * inner / seconds}
            for (name, count, _), seconds in zip(contestants, best, strict=True)]


def _walk(env: Any, actions: int) -> Callable[[], object]:
    """A run of random actions, drawn beforehand."""
    random = np.random.default_rng(0)
    drawn = [random.uniform(-1.0, 1.0, env.action_space.shape).astype(np.float32) for _ in range(actions)]
    env.reset(seed=0)

    def walk() -> None:
        for each in drawn:
            env.step(each)

    return walk
