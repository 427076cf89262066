"""Runs without noise for the tests of identification, and fits of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.rolling_evidence import RollingEvidence
from laconic.robot.identify.solve import fit
from laconic.robot.logs import Log
from laconic.robot.replay.rolling import path_of, rolling_of, rotations_of


def exact_run(scene, vehicle, velocity, name="run", samples=200, point="origin") -> Log:
    """A run at a constant velocity of the origin; the pose is that of a point."""
    moved = np.tile(0.05 * np.array(velocity), (samples, 1))
    rotation = rotations_of(scene.core(), vehicle, moved)
    angle = np.vstack([np.zeros(rotation.shape[1]), np.cumsum(rotation, axis=0)])
    seen = rolling_of(scene.core(), vehicle, scene.path).moved(rotation, point)
    return Log(Path(f"/made-up/{name}/run.csv"), "exact", 0.05 * np.arange(samples + 1), wheel_angle_rad=angle,
               pose=path_of(seen, np.zeros(3)), pose_point=point)


def found_from(scene, logs, free):
    """A fit of rolling."""
    parameters = geometry_of(scene, free)
    return fit(scene.vehicle, parameters, RollingEvidence(scene.core(), scene.path, logs))


def simulated(folder: Path, name: str, radius: float) -> Path:
    """A run of a TurtleBot whose wheels have another radius, as `laconic simulate` writes it."""
    text = scene_path("turtlebot3_burger").read_text().replace("wheel_radius_m = 0.033", f"wheel_radius_m = {radius}")
    (folder / "true.toml").write_text(text)
    out = folder / name / "run.csv"
    assert run(["simulate", str(folder / "true.toml"), "--out", str(out)]) == 0
    return out
