"""Robots on a batch, each with a target and a source of random numbers of its own: reset and driven, lane by lane.

Domain randomisation: vehicles whose numbers differ within spreads, drawn and prepared once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from laconic.batch import Batch
from laconic.batch.given import lane_count, thread_count
from laconic.core import Vehicle
from laconic.core.copies import OwnMemory
from laconic.core.given import finite_number, shown, whole_number
from laconic.errors import BadInput
from laconic.scene.key_path import key_path
from laconic.scene.methods import STIFF_4
from laconic.scene.scene_tables import SceneTables, scene_tables
from laconic.tools.learn.task import Motion, Rules, checked_actions, distance_of, has_left, has_reached, observed

Spread = float | Sequence[float]
"""A share, 0.1 for ±10 % of the scene's value, or the least and the largest value themselves."""
MOST_VARIANTS = 10**5


def vehicles_of(scene: str | Path, spreads: Mapping[str, Spread], count: int, seed: int, real: str) -> list[Vehicle]:
    """`count` vehicles, drawn evenly within the spreads of keys of `[vehicle]`; one where there are no spreads.

    BadInput names a key that is not of the vehicle, a value that is no spread, and a number that makes no vehicle.
    """
    tables = scene_tables(scene)
    if whole_number("variant_seed", seed) < 0:
        raise BadInput(f"variant_seed: {seed} is below 0; give a whole number from 0 on")
    if not isinstance(spreads, Mapping) or not all(isinstance(key, str) for key in spreads):
        raise BadInput(f"spreads: {shown(spreads)} is no mapping from keys to spreads; give one such as "
                       "{\"vehicle.mass_kg\": 0.2}")
    if not 1 <= whole_number("variants", count) <= MOST_VARIANTS:
        raise BadInput(f"variants: {count} is not from 1 to {MOST_VARIANTS}; give how many vehicles to draw")
    if not spreads:
        return [Vehicle(tables.scene().vehicle, real)]
    ranges = {key: _range_of(tables, key, spread) for key, spread in spreads.items()}
    drawn = np.random.default_rng(seed).uniform(size=(count, len(ranges)))
    return [_vehicle(tables, {key: low + float(share) * (high - low)
                              for share, (key, (low, high)) in zip(shares, ranges.items(), strict=True)}, real)
            for shares in drawn]


def _range_of(tables: SceneTables, key: str, spread: Any) -> tuple[float, float]:
    name = f"spreads[{shown(key)}]"
    path = key_path(key)
    if path.tables[:1] != (("vehicle", None),) or path.known.kind != "number":
        raise BadInput(f"{name}: is no number of the vehicle; give keys such as vehicle.mass_kg")
    if isinstance(spread, Sequence) and not isinstance(spread, str):
        if len(spread) != 2 or not finite_number(name, spread[0]) <= finite_number(name, spread[1]):
            raise BadInput(f"{name}: {list(spread)} is no range; give the least value and the largest")
        return float(spread[0]), float(spread[1])
    share, value = finite_number(name, spread), tables.value(path)
    if not 0 <= share < 1:
        raise BadInput(f"{name}: {share:g} is no share; give 0 to below 1, or the least value and the largest")
    if not isinstance(value, (int, float)) or value == 0:
        raise BadInput(f"{name}: the scene has no value of which {share:g} would be a share; give the least value and "
                       "the largest")
    return tuple(sorted((value * (1 - share), value * (1 + share))))  # type: ignore[return-value]


def _vehicle(tables: SceneTables, values: Mapping[str, float], real: str) -> Vehicle:
    return Vehicle(tables.with_values(values).scene().vehicle, real)


class Fleet(OwnMemory):
    """`lanes` robots of a scene. An action is held for `action_s`, in steps of `step_s` by `method`. The usual one
    takes any damping at a small and equal cost; `auto` has ten digits more for up to 25 times that.

    `spreads`, `variants`, `variant_seed`: the vehicles that robots become, drawn once (laconic.tools.learn.fleet);
    each reset draws one of them. `rules`: numbers of laconic.tools.learn.task.Rules by name.
    """

    def __init__(self, lanes: int, scene: str | Path = "robotino2", *, action_s: float = 0.05, step_s: float = 0.005,
                 method: str = STIFF_4, real: str = "double",
                 spreads: Mapping[str, Spread] | None = None,
                 variants: int = 64, variant_seed: int = 0, threads: int = 1, **rules: float):
        known = {field.name for field in fields(Rules)}
        if unknown := sorted(set(rules) - known):
            raise BadInput(f"{unknown[0]}: is no setting of the environment; known are {', '.join(sorted(known))}")
        self.rules, self.threads = Rules(**rules), thread_count(threads)
        self.steps = steps_of(finite_number("action_s", action_s), finite_number("step_s", step_s))
        lanes = lane_count("num_envs", lanes)
        self.vehicles = vehicles_of(scene, {} if spreads is None else spreads, variants, variant_seed, real)
        many = len(self.vehicles) > 1
        self.batch = Batch([self.vehicles[0]] * lanes if many else self.vehicles, lanes, method, step_s)
        self._prepared = [self.batch.prepared(vehicle, method) for vehicle in self.vehicles] if many else []
        for prepared in self._prepared:
            self.batch.change(0, prepared)  # refuses those that a lane cannot become
        self.variant = np.zeros(lanes, np.int64)
        self.target = np.zeros((3, lanes))
        self._radius_m, self._yaw_scale = (np.array([float(getattr(vehicle.model, name)) for vehicle in self.vehicles])
                                           for name in ("wheel_radius_m", "yaw_scale"))
        self._distance_m = np.zeros(lanes)

    @property
    def wheel_count(self) -> int:
        """N."""
        return self.vehicles[0].wheel_count

    def reset(self, lanes: Sequence[int] | np.ndarray, generators: Sequence[np.random.Generator]) -> None:
        """Puts these lanes at rest at the origin, with headings, targets and vehicles drawn from each lane's own
        generator: lane k of `generators`."""
        for lane in map(int, lanes):
            random, area = generators[lane], self.rules.area_m
            self.target[:, lane] = random.uniform((-area, -area, -np.pi), (area, area, np.pi))
            heading = random.uniform(-np.pi, np.pi)
            if self._prepared:
                self.variant[lane] = random.integers(len(self._prepared))
                self.batch.change(lane, self._prepared[self.variant[lane]])
            self.batch.start(lane, heading_rad=heading)
        self._distance_m = distance_of(self.motion(), self.target, self.rules)

    def motion(self) -> Motion:
        """Of all lanes now."""
        nu, radius, yaw_scale = self.batch.nu_rad_per_s, self._radius_m[self.variant], self._yaw_scale[self.variant]
        return Motion(self.batch.x_m, self.batch.y_m, self.batch.heading_rad, radius * nu[:2], nu[2] / yaw_scale)

    def observe(self) -> np.ndarray:
        """(lanes, 7), a copy."""
        return observed(self.motion(), self.target)

    def act(self, given: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Actions (lanes, N) for one `action_s`: rewards, and which lanes reached their target, left the area, or were
        refused a step, (lanes,) each."""
        actions = checked_actions(given, (self.batch.lane_count, self.wheel_count))
        self.batch.voltage_V = self.rules.largest_voltage_V * actions.T.astype(self.batch.core.dtype)
        self.batch.run(self.steps, self.threads)
        motion, before = self.motion(), self._distance_m
        self._distance_m = distance_of(motion, self.target, self.rules)
        reached = has_reached(motion, self.target, self.rules)
        effort = self.rules.effort * np.mean(np.square(actions, dtype=np.float64), axis=1)
        rewards = before - self._distance_m - effort + self.rules.bonus * reached
        return rewards, reached, has_left(motion, self.rules) & ~reached, self.batch.status != 0


def steps_of(action_s: float, step_s: float) -> int:
    """Steps of one action."""
    steps = round(action_s / step_s) if step_s > 0 else 0
    if steps < 1 or abs(steps * step_s - action_s) > 1e-9 * action_s:
        raise BadInput(f"action_s: {action_s:g} s is no whole number of steps of {step_s:g} s; give one that is")
    return steps
