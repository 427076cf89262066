"""`laconic identify` beside UMBmark (Borenstein and Feng 1996) on squares that a two-wheeled robot drives both ways.

UMBmark takes the ends of squares, clockwise and counterclockwise, for the ratio of the wheels and their distance; the
size of the wheels must be known. The side is L, b the distance; errors are true less rolled ends, in the frame of the
start.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.rolling_evidence import RollingEvidence
from laconic.robot.identify.solve import fit
from laconic.robot.logs import Log
from laconic.robot.replay.rolling import path_of, rolling_of, rotations_of
from laconic.scene import read_scene

SIDE_M, STEPS, DISTANCE_M = 4.0, 100, 0.2
RATIO, DISTANCE = 1.001, 1.008     # right over left radius; distance over nominal


def square(scene, vehicle, way: float, noise: float, random) -> Log:
    """What the robot does while its nominal odometry sees a perfect square; way: 1 to the left, -1 to the right."""
    leg = np.tile([SIDE_M / STEPS, 0.0, 0.0], (STEPS, 1))
    turn = np.tile([0.0, 0.0, way * np.pi / 2.0 / STEPS], (STEPS, 1))
    rotation = rotations_of(scene.core(), scene.vehicle, np.vstack([leg, turn] * 4))
    slipped = rotation * (1.0 + noise * random.standard_normal(rotation.shape))
    angle = np.vstack([np.zeros(2), np.cumsum(rotation, axis=0)])
    true = path_of(rolling_of(scene.core(), vehicle, scene.path).moved(slipped), np.zeros(3))
    return Log(Path(f"/made-up/{way}{noise}{random.random()}/run.csv"), "square", 0.05 * np.arange(len(angle)),
               wheel_angle_rad=angle, pose=true)


def umbmark(ends: dict[int, list[np.ndarray]]) -> tuple[float, float]:
    """(right over left radius, distance over nominal) from the centres of gravity of the ends."""
    left, right = (np.mean(ends[way], axis=0)[0] for way in (1, -1))
    alpha, beta = (right + left) / (-4.0 * SIDE_M), (right - left) / (-4.0 * SIDE_M)
    radius = SIDE_M / 2.0 / np.sin(beta / 2.0)
    return (radius + DISTANCE_M / 2.0) / (radius - DISTANCE_M / 2.0), (np.pi / 2.0) / (np.pi / 2.0 - alpha)


def both(noise: float, seed: int) -> tuple[tuple[float, float], tuple[float, float]]:
    """UMBmark's and identify's ratio and distance from five squares each way."""
    scene, random = read_scene("optiodom_diff"), np.random.default_rng(seed)
    parameters = geometry_of(scene, ("radius", "distance"))
    vehicle = parameters.vehicle(scene.vehicle, np.array([0.042 * np.sqrt(RATIO), 0.042 / np.sqrt(RATIO), DISTANCE]))
    logs = {way: [square(scene, vehicle, way, noise, random) for _ in range(5)] for way in (1, -1)}
    found = fit(scene.vehicle, parameters, RollingEvidence(scene.core(), scene.path, [*logs[1], *logs[-1]]))
    right, left, distance = found.values
    ends = {way: [log.pose[-1] for log in runs] for way, runs in logs.items()}
    return umbmark(ends), (right / left, distance)


def test_umbmark_agrees_to_its_approximation_and_identify_is_exact_on_squares_without_noise():
    one, other = both(0.0, 1)
    assert one == pytest.approx((RATIO, DISTANCE), abs=6e-4)
    assert other == pytest.approx((RATIO, DISTANCE), abs=1e-6)


def test_on_squares_with_slip_both_are_as_near_to_the_truth():
    off = np.array([np.abs(np.array(both(0.03, seed)) - [RATIO, DISTANCE]) for seed in range(5)]).mean(axis=0)
    assert (off[1] < 2.0 * off[0]).all() and (off[0] < 2.0 * off[1]).all()
    assert off[1][0] < 1.5e-3 and off[1][1] < 0.02
