"""One robot that drives to a pose, as a gymnasium.Env."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from laconic.core.copies import OwnMemory
from laconic.errors import BadInput
from laconic.tools.learn.fleet import Fleet
from laconic.tools.learn.spaces import action_space, check_open, checked_seed, observation_space
from laconic.tools.learn.task import checked_actions


class DriveToPose(OwnMemory, gymnasium.Env[np.ndarray, np.ndarray]):
    """A fleet of one; settings are those of Fleet. An episode's length is bounded by gymnasium.make()."""

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012

    def __init__(self, **settings: Any):
        self.fleet = Fleet(1, **settings)
        self.action_space, self.observation_space = action_space(self.fleet.wheel_count), observation_space()
        self._has_begun = self._is_closed = False

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """At rest at the origin, with a new target."""
        check_open("reset", self._is_closed)
        if seed is not None:
            super().reset(seed=checked_seed("seed", seed))
        self.fleet.reset([0], [self.np_random])
        self._has_begun = True
        return self.fleet.observe()[0], {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Holds the action; terminated: the target is reached (info["reached"]) or the area left; truncated: the core
        refused a step."""
        check_open("step", self._is_closed)
        if not self._has_begun:
            raise BadInput("step: nothing was reset yet; call reset() first")
        rewards, reached, left, refused = self.fleet.act(checked_actions(action, (self.fleet.wheel_count,))[None])
        ends = bool(reached[0] or left[0])
        info = {"reached": bool(reached[0])} if ends else {}
        return self.fleet.observe()[0], float(rewards[0]), ends, bool(refused[0]), info

    def close(self) -> None:
        """No step and no reset after it."""
        self._is_closed = True
