"""Rolled over travelled distance against the drag of the rollers: the law for this robot, and what the runs show."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from laconic.robot.logs import Log
from laconic.robot.logs.log import Log as Run
from laconic.robot.replay.held_wheels import hold
from laconic.robot.replay.rolling import rolling_of, rotations_of
from laconic.scene import Scene

DRAGS = np.linspace(0.05, 0.95, 13)
DIRECTIONS_DEG = (0.0, 45.0, 90.0)
SPEED_M_PER_S, SECONDS, PERIOD_S, STEADY_S = 0.2, 1.0, 0.1, 0.3


def draw_drag(scene: Scene, logs: Sequence[Log], folder: Path) -> Path:
    """Lines: the core with wheels held for straight motion; points: recorded runs, at the drag of the scene.

    A line and the points whose direction is nearest to its own have one colour.
    """
    from laconic.pictures.plotting import figure, save

    picture = figure(6.4, 4.2)
    axes = picture.subplots()
    drag = scene.vehicle["ground"].get("roller_drag", 0.0)
    found = [_recorded(scene, log) for log in logs if log.pose is not None]
    for direction in DIRECTIONS_DEG:
        line, = axes.plot(DRAGS, [_ratio(scene, direction, drag) for drag in DRAGS], label=f"{direction:g}°, the model")
        near = [ratio for degrees, ratio in found if min(DIRECTIONS_DEG, key=lambda d: abs(d - degrees)) == direction]
        if near:
            axes.scatter([drag] * len(near), near, color=line.get_color(), zorder=3, label=f"{direction:g}°, the runs")
    axes.set(xlabel="drag of the rollers k", ylabel="rolled over travelled distance")
    axes.legend(fontsize=8, title="direction of travel from the x axis", title_fontsize=8)
    save(picture, folder / "drag.png")
    return folder / "drag.png"


def _ratio(scene: Scene, direction_deg: float, drag: float) -> float:
    """Of the distance that the wheels' speeds mean over that which the core goes, in steady motion."""
    vehicle = copy.deepcopy(scene.vehicle)
    vehicle["ground"]["roller_drag"], vehicle["com_z_m"] = float(drag), 0.0  # no load moves from wheel to wheel
    way, count = np.radians(direction_deg), round(SECONDS / PERIOD_S)
    moved = SPEED_M_PER_S * PERIOD_S * np.tile([np.cos(way), np.sin(way), 0.0], (count, 1))
    rotation = rotations_of(scene.core(), vehicle, moved)
    angle = np.vstack([np.zeros(rotation.shape[1]), np.cumsum(rotation, axis=0)])
    log = Run(Path("straight"), "straight", PERIOD_S * np.arange(count + 1), wheel_angle_rad=angle)
    held = hold(scene.core(), vehicle, log)
    steady = held.time_s >= STEADY_S
    length = np.hypot(*np.diff(held.pose[steady][:, :2], axis=0).T).sum()
    return float(SPEED_M_PER_S * np.ptp(held.time_s[steady]) / length)


def _recorded(scene: Scene, log: Log) -> tuple[float, float]:
    """(angle of travel to the x axis, 0 to 90°, by the wheels; rolled over true distance)."""
    assert log.pose is not None
    moved = rolling_of(scene.core(), scene.vehicle, scene.path).moved(log.rotation_rad())[:, :2].sum(axis=0)
    travelled = np.hypot(*(log.pose[-1] - log.pose[0])[:2])
    return float(np.degrees(np.arctan2(abs(moved[1]), abs(moved[0])))), float(np.hypot(*moved) / travelled)
