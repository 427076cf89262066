"""One robot that drives to a pose, as a gymnasium.Env."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from laconic.learn.fleet import Fleet
from laconic.learn.spaces import action_space, observation_space


class DriveToPose(gymnasium.Env[np.ndarray, np.ndarray]):
    """A fleet of one; settings are those of Fleet. An episode's length is bounded by gymnasium.make()."""

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012

    def __init__(self, **settings: Any):
        self.fleet = Fleet(1, **settings)
        self.action_space, self.observation_space = action_space(self.fleet.wheel_count), observation_space()

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """At rest at the origin, with a new target."""
        super().reset(seed=seed)
        self.fleet.reset([0], [self.np_random])
        return self.fleet.observe()[0], {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Holds the action; terminated: the target is reached (info["reached"]) or the area left; truncated: the core
        refused a step."""
        rewards, reached, left, refused = self.fleet.act(np.asarray(action)[None])
        ends = bool(reached[0] or left[0])
        info = {"reached": bool(reached[0])} if ends else {}
        return self.fleet.observe()[0], float(rewards[0]), ends, bool(refused[0]), info
