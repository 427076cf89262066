"""Outlines of bodies on hinges from above, for pictures and films."""

from __future__ import annotations

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.scene import Scene
from laconic.scene.standing import hull_of

DRAWN = ("origin_x_m", "origin_y_m", "body_x_m", "body_y_m", "body_heading_rad")
"""What a run keeps for its picture besides the usual signals."""


def outline_points(scene: Scene) -> dict[str, list[complex]]:
    """What a body's outline holds, in its own frame: its hinge, the hinges on it, its wheels and supports."""
    found: dict[str, list[complex]] = {CARRIAGE: [complex(each["x_m"], each["y_m"])
                                                  for each in scene.vehicle.get("support", ())]}
    found |= {hinge.name: [0j] for hinge in scene.hinges}
    for body in scene.vehicle.get("body", ()):
        found[body["parent"]].append(complex(body["hinge_x_m"], body["hinge_y_m"]))
    for wheel in scene.vehicle["wheel"]:
        found[wheel.get("body", CARRIAGE)].append(complex(wheel["x_m"], wheel["y_m"]))
    return found


def hull(points: list[complex]) -> list[complex]:
    """Corners of the smallest convex outline."""
    apart = sorted(set(points), key=lambda p: (p.real, p.imag))
    if len(apart) < 3:
        return apart
    return [apart[k] for k in hull_of(np.array([(point.real, point.imag) for point in apart]))]
