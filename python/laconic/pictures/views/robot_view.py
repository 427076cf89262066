"""The robot of a scene in three dimensions, where its parts are at each instant, and what is plotted beside it.

Each part has a frame: bodies in the world, wheels on their bodies. A wheel's first axis is its axle, about which it
turns. What scenes do not state is drawn by the size of the wheels: heights of bodies, widths of wheels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.pictures.outlines import DRAWN, hull, outline_points
from laconic.ros2 import FRAMES
from laconic.scene import Scene
from laconic.simulation.loads import centre_of

SEGMENTS = 24                    # of a wheel around its axle
STRIPES = 8                      # that show how a wheel turns
WIDTH_OF_WHEEL = 0.5             # of its radius
BOTTOM, TOP = 0.7, 1.5           # of a body, in radii of the largest wheel
MOST_SLANT = 1.5                 # of the stripes on a wheel with rollers
TYRES = {"fixed": ((40, 44, 52), (120, 126, 138)), "omni": ((34, 84, 61), (120, 190, 150)),
         "mecanum": ((98, 62, 20), (220, 170, 110))}
BODIES = ((70, 120, 190), (225, 140, 60), (90, 165, 90), (190, 85, 85), (140, 110, 185))
WORLD = FRAMES["map"]

Colour = tuple[int, int, int]
Pose = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""x, y, z, w."""


class Viewer(Protocol):
    """What shows or writes a run while it goes."""

    @property
    def remarks(self) -> tuple[str, ...]:
        """What it lacks."""
        ...

    def take(self, time_s: float, signals: Mapping[str, float]) -> None:
        """One instant."""
        ...


@dataclass(frozen=True)
class Area:
    """The ground that a run drives over: its middle and half its width."""

    x_m: float
    y_m: float
    half_m: float


@dataclass(frozen=True)
class Part:
    """A body or wheel: its frame, the frame that carries it, and its triangles in its own frame."""

    name: str
    parent: str
    triangles: np.ndarray         # (T, 3 corners, 3 coordinates), m
    colours: np.ndarray           # (T, 3), 0 … 255


@dataclass(frozen=True)
class Placed:
    """Where a frame is in its parent's."""

    name: str
    parent: str
    place_m: tuple[float, float, float]
    turn: Quaternion


@dataclass(frozen=True)
class Panel:
    """One plot: the curves of these signals, with a label for each."""

    title: str
    signals: tuple[str, ...]


class RobotView:
    """Parts of a scene's robot, and their frames for the signals of an instant."""

    def __init__(self, scene: Scene, area: Area | None = None):
        self.scene = scene
        self.bodies = [FRAMES["base"], *(hinge.name for hinge in scene.hinges)]
        wheels = scene.vehicle["wheel"]
        self._radii = [wheel.get("radius_m", scene.vehicle["wheel_radius_m"]) for wheel in wheels]
        self._on = [self.bodies[0] if (on := wheel.get("body", CARRIAGE)) == CARRIAGE else on for wheel in wheels]
        names = [f"wheel_{number}" for number in range(1, len(wheels) + 1)]
        self.wheels = [name if name not in self.bodies else f"{name}_tyre" for name in names]
        self.parts = [*self._solid_bodies(), *self._solid_wheels()]
        self._centre = centre_of(scene.vehicle)
        self._angles = [0.0] * len(wheels)
        self._before_s: float | None = None
        start = scene.initial
        self.area = area or Area(start.x_m, start.y_m, 2.0 * self.size_m)

    @property
    def distance_m(self) -> float:
        """From which the whole area is seen."""
        return 2.5 * (self.area.half_m + self.size_m)

    @cached_property
    def size_m(self) -> float:
        """About how long the robot is."""
        points = np.concatenate([part.triangles.reshape(-1, 3) for part in self.parts]) if self.parts else np.zeros(1)
        return max(2.0 * float(np.abs(points).max()), 0.05)

    def _solid_bodies(self) -> list[Part]:
        largest = max(self._radii, default=0.1)
        points = outline_points(self.scene)
        found = []
        for number, (name, corners) in enumerate(zip(self.bodies, points.values(), strict=True)):
            corners = [*corners, *self._corners_of_wheels(name)]
            if number == 0 or len(corners) < 3:  # the carriage is never smaller than a wheel
                corners += [largest * complex(math.cos(a), math.sin(a)) + centre_of(self.scene.vehicle) * (number == 0)
                            for a in np.arange(8) * math.pi / 4.0]
            rise = 0.08 * number  # bodies above each other, so that none hides in another one
            solid = prism(hull(corners), (BOTTOM + rise) * largest, (TOP + rise) * largest)
            found.append(Part(name, WORLD, solid, np.tile(BODIES[number % len(BODIES)], (len(solid), 1))))
        return found

    def _corners_of_wheels(self, body: str) -> list[complex]:
        found = []
        for wheel, radius, on in zip(self.scene.vehicle["wheel"], self._radii, self._on, strict=True):
            axle = complex(math.cos(wheel["axle_rad"]), math.sin(wheel["axle_rad"]))
            middle = complex(wheel["x_m"], wheel["y_m"])
            found += [middle + radius * (0.5 * WIDTH_OF_WHEEL * a + 1j * b) * axle
                      for a in (-1.0, 1.0) for b in (-1.0, 1.0) if on == body]
        return found

    def _solid_wheels(self) -> list[Part]:
        found = []
        for name, on, wheel, radius in zip(self.wheels, self._on, self.scene.vehicle["wheel"], self._radii,
                                           strict=True):
            slant = math.tan(wheel["roller_rad"]) if "roller_rad" in wheel else 0.0
            is_omni = abs(slant) > MOST_SLANT
            kind = "omni" if is_omni else "mecanum" if slant else "fixed"
            triangles, stripe = tyre(radius, WIDTH_OF_WHEEL * radius, 0.0 if is_omni else slant)
            found.append(Part(name, on, triangles, np.array(TYRES[kind])[stripe]))
        return found

    def frames(self, time_s: float, signals: Mapping[str, float]) -> list[Placed]:
        """The frames of all bodies and wheels; none without a pose among the signals."""
        poses = self._poses(signals)
        if poses is None:
            return []
        self._turn(time_s, signals)
        found = [Placed(name, WORLD, (x, y, 0.0), about_vertical(heading))
                 for name, (x, y, heading) in zip(self.bodies, poses, strict=True)]
        for name, on, wheel, radius, angle in zip(self.wheels, self._on, self.scene.vehicle["wheel"], self._radii,
                                                  self._angles, strict=True):
            found.append(Placed(name, on, (wheel["x_m"], wheel["y_m"], radius), of_wheel(wheel["axle_rad"], angle)))
        return found

    def _poses(self, signals: Mapping[str, float]) -> list[Pose] | None:
        """Of the carriage's origin, and of the hinges with their bodies."""
        if "heading_rad" not in signals or not {"x_m", "origin_x_m"} & set(signals):
            return None
        heading = signals["heading_rad"]
        if "origin_x_m" in signals:
            x, y = signals["origin_x_m"], signals["origin_y_m"]
        else:
            origin = complex(signals["x_m"], signals["y_m"]) - self._centre * complex(
                math.cos(heading), math.sin(heading))
            x, y = origin.real, origin.imag
        found = [(x, y, heading)]
        for hinge in self.scene.hinges:
            x, y, heading = (signals[f"{name}[{hinge.name}]"] for name in DRAWN[2:])
            found.append((x, y, heading))
        return found

    def _turn(self, time_s: float, signals: Mapping[str, float]) -> None:
        """Angles of the wheels; where a run has speeds alone, their sum."""
        passed = 0.0 if self._before_s is None else time_s - self._before_s
        self._before_s = time_s
        for index in range(len(self._angles)):
            angle = signals.get(f"wheel_angle_rad[{index + 1}]")
            speed = signals.get(f"wheel_speed_rad_per_s[{index + 1}]", 0.0)
            self._angles[index] = self._angles[index] + passed * speed if angle is None else angle


def needed_signals(scene: Scene) -> tuple[str, ...]:
    """The signals of a run that draw the robot, and those that are plotted beside it."""
    from laconic.scene.hinge_signals import output_signals_of
    from laconic.simulation import input_signals, usual_signals, wanted_signals

    if scene.has_hinges:
        known = output_signals_of(scene.vehicle, scene.hinges)
        drawn = [signal for name in (*DRAWN, "wheel_angle_rad") for signal in known[name]]
    else:
        drawn = ["origin_x_m", "origin_y_m"]
    return tuple(dict.fromkeys((*usual_signals(scene), *drawn, *input_signals(scene), *wanted_signals(scene))))


GROUPS = (("velocity [m/s], yaw rate [rad/s]", ("velocity_body_m_per_s", "yaw_rate_rad_per_s")),
          ("wheel speeds [rad/s]", ("wheel_speed_rad_per_s",)),
          ("hinge angles [rad]", ("hinge_angle_rad",)))
NOT_PLOTTED = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "heading_wrapped_rad", "wheel_angle_rad", *DRAWN,
               "hinge_rate_rad_per_s", "energy_J")
MOST_PANELS = 6


def panels_of(scene: Scene, names: Sequence[str]) -> list[Panel]:
    """Plots of the signals that there are: motion, wheels, hinges, inputs; then what the scene's outputs name."""
    from laconic.simulation import input_signals

    by_name: dict[str, list[str]] = {}
    for signal in names:
        by_name.setdefault(signal.partition("[")[0], []).append(signal)
    inputs = {signal.partition("[")[0] for signal in input_signals(scene)}
    named = {signal.partition("[")[0] for signal in scene.outputs.signals}
    shown = {name for _, group in GROUPS for name in group}
    groups = [*GROUPS, ("inputs", tuple(name for name in by_name if name in inputs))]
    groups += [(name, (name,)) for name in by_name if name not in shown | inputs and (
        name in named or name not in NOT_PLOTTED)]
    found = [Panel(title, tuple(signal for name in group for signal in by_name.get(name, ())))
             for title, group in groups]
    return [panel for panel in found if panel.signals][:MOST_PANELS]


# --------------------------------------------------------------------------------- shapes and turns


def about_vertical(heading: float) -> Quaternion:
    """A turn about the third axis."""
    return 0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading)


def of_wheel(axle: float, angle: float) -> Quaternion:
    """A wheel whose axle has this direction on its body. It rolls to the left of the axle, so its angle counts against
    the right-hand rule."""
    a, b = 0.5 * axle, -0.5 * angle
    return math.cos(a) * math.sin(b), math.sin(a) * math.sin(b), math.sin(a) * math.cos(b), math.cos(a) * math.cos(b)


def prism(corners: Sequence[complex], bottom: float, top: float) -> np.ndarray:
    """Triangles of an upright solid on a convex outline, whose corners go around to the left."""
    low = np.array([(p.real, p.imag, bottom) for p in corners])
    high = low + (0.0, 0.0, top - bottom)
    count, found = len(corners), []
    for k in range(count):
        n = (k + 1) % count
        found += [(low[k], low[n], high[n]), (low[k], high[n], high[k])]
    for k in range(1, count - 1):
        found += [(high[0], high[k], high[k + 1]), (low[0], low[k + 1], low[k])]
    return np.array(found)


def tyre(radius: float, width: float, slant: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of a cylinder about the first axis, and which of two colours each has. `slant`: tangent of the angle
    from the axle to the rollers' axes, as they are where they touch the ground."""
    around = 2.0 * math.pi * np.arange(SEGMENTS + 1) / SEGMENTS
    rims = []
    for side in (-0.5 * width, 0.5 * width):
        angles = around + side * slant / radius
        rims.append(np.column_stack([np.full_like(angles, side), radius * np.sin(angles), -radius * np.cos(angles)]))
    left, right = rims
    hubs = [np.array([side, 0.0, 0.0]) for side in (-0.5 * width, 0.5 * width)]
    triangles, stripe = [], []
    for k in range(SEGMENTS):
        is_light = (k * STRIPES * 2 // SEGMENTS) % 2
        triangles += [(left[k], right[k + 1], right[k]), (left[k], left[k + 1], right[k + 1]),
                      (hubs[0], left[k + 1], left[k]), (hubs[1], right[k], right[k + 1])]
        stripe += [is_light, is_light, int(k < 3), int(k < 3)]
    return np.array(triangles), np.array(stripe)
