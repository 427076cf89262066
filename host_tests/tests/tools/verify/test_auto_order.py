"""How the error of `auto` falls when its step is halved, on made-up vehicles with h·r up to 1."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from assurance.population import Made, made
from laconic.core import load

SEED, VEHICLES = 5, 2000
STEPS = 8             # compared with as many times FINER, which err 2^48 times less
FINER = 64
ROUNDING = 1e-13      # above it an error is of the method
WHOLE_DECAY = 0.125   # up to it a step is one panel
CORE = load("double")


def end_of(vehicle: Made, step_s: float, steps: int) -> np.ndarray:
    plant = vehicle.plant(CORE, "auto", step_s)
    plant.run(vehicle.helds[0], steps)
    pose = plant.pose
    return np.array([*plant.nu, pose.x_m, pose.y_m, pose.heading_rad])


def errors_where(is_meant: Callable[[float], bool], longest_s: float, most_yaw_rad: float) -> Iterator[list[float]]:
    """Of a step and of half of it, for vehicles and steps by chance; `is_meant` takes h·r, a step's yaw is bounded."""
    for number in range(VEHICLES):
        vehicle = made(SEED, number, VEHICLES)
        start = vehicle.plant(CORE, "auto", 0.001)
        decay_per_s = max(start.c.model.decay_per_s[k] for k in range(3))
        h_r = float(10 ** np.random.default_rng([SEED, number]).uniform(-1.3, 0))
        step_s = h_r / decay_per_s
        if not (is_meant(h_r) and step_s < longest_s and step_s * abs(start.nu[2]) < most_yaw_rad):
            continue
        true = end_of(vehicle, step_s / FINER, STEPS * FINER)
        size = max(1.0, np.abs(true).max())
        yield [float(np.abs(end_of(vehicle, step_s / k, STEPS * k) - true).max() / size) for k in (1, 2)]


def test_half_a_step_errs_at_least_200_times_less_where_both_have_as_many_panels():
    pairs = list(errors_where(lambda h_r: not WHOLE_DECAY < h_r <= 2 * WHOLE_DECAY, 0.1, 1.5))
    slopes = [np.log2(whole / half) for whole, half in pairs if half > ROUNDING]
    assert len(pairs) > 700
    assert len(slopes) >= 5
    assert min(slopes) >= 7.7


def test_where_half_a_step_loses_its_panels_nothing_but_rounding_is_seen():
    pairs = list(errors_where(lambda h_r: WHOLE_DECAY < h_r <= 2 * WHOLE_DECAY, 0.03, 0.3))
    assert len(pairs) > 200
    assert max(map(max, pairs)) <= ROUNDING
