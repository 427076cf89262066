"""What driving to a pose is: how observations, rewards and ends follow from the motion; docs/batch.md has the units.

Everything here works on numbers of many robots at once, shape (lanes,) each, and knows nothing of Gymnasium.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from laconic.core.given import finite_number
from laconic.core.given_array import real_array
from laconic.errors import BadInput

OBSERVATION = ("target_ahead_m", "target_left_m", "cos_to_target", "sin_to_target", "velocity_ahead_m_per_s",
               "velocity_left_m_per_s", "yaw_rate_rad_per_s")
"""The numbers of an observation, in body axes."""


@dataclass(frozen=True)
class Rules:
    """Numbers of the task; each may be given to the environment by its name."""

    largest_voltage_V: float = 12.0     # of an action of 1
    area_m: float = 2.0                 # targets lie within ±area_m in x and y
    reach_m: float = 0.05               # a target is reached within these three
    reach_rad: float = 0.1
    reach_m_per_s: float = 0.1
    metres_per_rad: float = 0.2         # what a radian of heading counts beside a metre
    effort: float = 0.01                # what a step with all voltages at their largest costs
    bonus: float = 1.0                  # for reaching the target

    def __post_init__(self) -> None:
        for field in fields(self):
            value = finite_number(field.name, getattr(self, field.name))
            if value < 0 or (value == 0 and field.name in ("largest_voltage_V", "area_m", "reach_m", "reach_rad")):
                raise BadInput(f"{field.name}: {value:g} leaves no task; give a number above 0")


@dataclass(frozen=True)
class Motion:
    """Where robots are and how they move, (lanes,) each; velocities in body axes."""

    x_m: np.ndarray
    y_m: np.ndarray
    heading_rad: np.ndarray
    velocity_m_per_s: np.ndarray  # (2, lanes)
    yaw_rate_rad_per_s: np.ndarray


def wrapped(angle_rad: np.ndarray) -> np.ndarray:
    """To −π … π."""
    return np.remainder(angle_rad + np.pi, 2 * np.pi) - np.pi


def observed(motion: Motion, target: np.ndarray) -> np.ndarray:
    """(lanes, 7), float32; target (3, lanes): x, y, heading."""
    ahead, left = target[0] - motion.x_m, target[1] - motion.y_m
    cosine, sine = np.cos(motion.heading_rad), np.sin(motion.heading_rad)
    turn = target[2] - motion.heading_rad
    return np.stack([ahead * cosine + left * sine, left * cosine - ahead * sine, np.cos(turn), np.sin(turn),
                     *motion.velocity_m_per_s, motion.yaw_rate_rad_per_s], axis=1).astype(np.float32)


def distance_of(motion: Motion, target: np.ndarray, rules: Rules) -> np.ndarray:
    """To the target [m], its heading included; the reward of a step is how much of it is gained."""
    place = np.hypot(target[0] - motion.x_m, target[1] - motion.y_m)
    return place + rules.metres_per_rad * np.abs(wrapped(target[2] - motion.heading_rad))


def has_reached(motion: Motion, target: np.ndarray, rules: Rules) -> np.ndarray:
    """Near, turned as wanted, and nearly at rest."""
    place = np.hypot(target[0] - motion.x_m, target[1] - motion.y_m) <= rules.reach_m
    turned = np.abs(wrapped(target[2] - motion.heading_rad)) <= rules.reach_rad
    return place & turned & (np.hypot(*motion.velocity_m_per_s) <= rules.reach_m_per_s)


def has_left(motion: Motion, rules: Rules) -> np.ndarray:
    """Twice as far from the start as any target in x or y."""
    return np.maximum(np.abs(motion.x_m), np.abs(motion.y_m)) > 2 * rules.area_m


def checked_actions(given: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Actions as numbers of that shape; BadInput for others and for what is beyond −1 … 1, which is not clamped."""
    actions = real_array("actions", given, shape, "shares of largest_voltage_V, -1 to 1", dtype=None, is_finite=False)
    if not np.all(np.abs(actions) <= 1):
        raise BadInput("actions: some are beyond -1 to 1, or no numbers; clip them where that is meant")
    return actions
