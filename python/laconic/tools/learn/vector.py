"""Many robots that drive to poses of their own, as a gymnasium.vector.VectorEnv on one batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from laconic.core.copies import OwnMemory
from laconic.core.given import by_names, shown, step_count
from laconic.errors import BadInput
from laconic.tools.learn.fleet import Fleet
from laconic.tools.learn.spaces import action_space, check_open, generators_of, observation_space


class DriveToPoseVector(OwnMemory, VectorEnv[np.ndarray, np.ndarray, np.ndarray]):
    """`num_envs` robots. Robot k of seed s does what DriveToPose does with seed s + k, bit for bit.

    `max_episode_steps`: actions until an episode is truncated; None: never. `autoreset_mode` by Gymnasium's contract:
    NEXT_STEP (a robot whose episode ended is reset by the next step, which ignores its action and rewards 0), SAME_STEP
    (at once; its last observation is in info["final_obs"]), DISABLED (the program resets with
    options={"reset_mask": …}). Further settings are those of Fleet.
    """

    def __init__(self, num_envs: int = 1, *, max_episode_steps: int | None = None,
                 autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP, **settings: Any):
        self.fleet, self.num_envs = Fleet(num_envs, **settings), num_envs
        self.max_episode_steps = None if max_episode_steps is None else step_count("max_episode_steps",
                                                                                   max_episode_steps)
        self.autoreset_mode = _mode_of(autoreset_mode)
        self.metadata = {"render_modes": [], "autoreset_mode": self.autoreset_mode}
        self.single_action_space = action_space(self.fleet.wheel_count)
        self.single_observation_space = observation_space()
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._generators: list[np.random.Generator] = []
        self._taken = np.zeros(num_envs, np.int64)
        self._ended = np.zeros(num_envs, bool)

    def reset(self, *, seed: int | Sequence[int | None] | None = None,
              options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """All robots, or those of options["reset_mask"] (bool, (num_envs,)); without a seed their sources go on."""
        check_open("reset", self.closed)
        which = self._mask_of(options)
        if seed is not None or not self._generators:
            fresh = generators_of(seed, self.num_envs)
            self._generators = [new if chosen or not self._generators else self._generators[lane]
                                for lane, (new, chosen) in enumerate(zip(fresh, which, strict=True))]
        self._reset(which)
        return self.fleet.observe(), {}

    def _mask_of(self, options: dict[str, Any] | None) -> np.ndarray:
        given = {} if options is None else by_names("options", options)
        if unknown := [name for name in given if name != "reset_mask"]:
            raise BadInput(f"options: there is no {unknown[0]}; give reset_mask, or nothing")
        mask = np.asarray(given.get("reset_mask", np.ones(self.num_envs, bool)))
        if mask.shape != (self.num_envs,) or mask.dtype != bool or not mask.any():
            raise BadInput(f"options: reset_mask is no mask of {self.num_envs} environments; give as many of true and "
                           "false, one of them true")
        return mask

    def _reset(self, which: np.ndarray) -> None:
        self.fleet.reset(np.flatnonzero(which), self._generators)
        self._taken[which], self._ended[which] = 0, False

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Holds the actions (num_envs, N). Terminated: the target is reached (info["reached"]) or the area left.
        Truncated: max_episode_steps are over, or the core refused a step."""
        check_open("step", self.closed)
        if not self._generators:
            raise BadInput("step: nothing was reset yet; call reset() first")
        before = self._ended.copy()
        if self.autoreset_mode is AutoresetMode.DISABLED and before.any():
            raise BadInput(f"step: environment {int(np.argmax(before))} ended; reset it with options reset_mask first")
        rewards, reached, left, refused = self.fleet.act(actions)
        self._taken += 1
        terminated = (reached | left) & ~before
        overdue = self._taken >= self.max_episode_steps if self.max_episode_steps is not None else before
        truncated = (refused | overdue) & ~before
        info: dict[str, Any] = {"reached": reached & terminated, "_reached": terminated} if terminated.any() else {}
        self._ended = terminated | truncated
        return (*self._after_resets(before, np.where(before, 0.0, rewards), info), terminated, truncated, info)

    def _after_resets(self, before: np.ndarray, rewards: np.ndarray,
                      info: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
        """Resets what the mode asks for: observations and rewards."""
        if self.autoreset_mode is AutoresetMode.NEXT_STEP and before.any():
            self._reset(before)
        if self.autoreset_mode is AutoresetMode.SAME_STEP and self._ended.any():
            ended, last = self._ended.copy(), self.fleet.observe()
            info["final_obs"], info["_final_obs"] = _objects(last, ended), ended
            info["final_info"] = {name: info.pop(name) for name in ("reached", "_reached") if name in info}
            info["_final_info"] = ended.copy()
            self._reset(ended)
        return self.fleet.observe(), rewards


def _mode_of(given: Any) -> AutoresetMode:
    try:
        return AutoresetMode(given)
    except ValueError:
        modes = ", ".join(str(mode.value) for mode in AutoresetMode)
        raise BadInput(f"autoreset_mode: there is no {shown(given)}; give one of {modes}") from None


def _objects(observations: np.ndarray, which: np.ndarray) -> np.ndarray:
    """One observation for each lane of `which`, None for the others, as Gymnasium has them."""
    found = np.full(len(which), None, dtype=object)
    for lane in np.flatnonzero(which):
        found[lane] = observations[lane]
    return found
