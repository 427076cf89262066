"""One robot that drives to a pose, as a gymnasium.Env.

The spaces of one robot, and seeds for many.

Many robots that drive to poses of their own, as a gymnasium.vector.VectorEnv on one batch.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from laconic.core.copies import OwnMemory
from laconic.core.given import by_names, shown, step_count, whole_number
from laconic.errors import BadInput
from laconic.tools.learn.fleet import Fleet
from laconic.tools.learn.task import OBSERVATION, checked_actions


def action_space(wheel_count: int) -> Box:
    """A share of the largest voltage for each wheel."""
    return Box(-1.0, 1.0, (wheel_count,), np.float32)


def observation_space() -> Box:
    """Of laconic.tools.learn.task.OBSERVATION: sine and cosine are bounded, the rest by physics alone."""
    high = np.array([1.0 if name.startswith(("cos_", "sin_")) else np.inf for name in OBSERVATION], np.float32)
    return Box(-high, high, dtype=np.float32)


def generators_of(seed: int | Sequence[int | None] | None, lanes: int) -> list[np.random.Generator]:
    """One for each lane; of one seed lane k has seed + k, as in Gymnasium's own vector environments."""
    if seed is None or isinstance(seed, int | np.integer):
        first = None if seed is None else checked_seed("seed", seed)
        seeds: list[int | None] = [None if first is None else first + lane for lane in range(lanes)]
    elif isinstance(seed, str) or not isinstance(seed, Sequence | np.ndarray):
        raise BadInput(f"seed: {shown(seed)} is no seed; give a whole number, a list of one for each environment, or "
                       "None")
    else:
        seeds = [None if each is None else checked_seed(f"seed[{lane}]", each) for lane, each in enumerate(seed, 1)]
    if len(seeds) != lanes:
        raise BadInput(f"seed: {len(seeds)} seeds for {lanes} environments; give one for each, or one number")
    return [seeding.np_random(each)[0] for each in seeds]


def check_open(what: str, is_closed: bool) -> None:
    """BadInput where close() was called."""
    if is_closed:
        raise BadInput(f"{what}: this environment is closed; make another one")


def checked_seed(name: str, given: Any) -> int:
    """A seed that Gymnasium takes."""
    seed = whole_number(name, given)
    if seed < 0:
        raise BadInput(f"{name}: {seed} is below 0; give a whole number from 0 on")
    return seed


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
