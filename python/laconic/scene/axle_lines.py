"""Axle lines of wheels seen from above: which are one line, parallel, or meet in one point, but for rounding in a file.

To the core a micrometre between two axles makes another robot. Files have angles such as 3.14 and lengths in
millimetres, so what is within 0.2° and 1 mm (or 0.5 % of the track) counts as rounding here, and is reported.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from laconic.scene.scene import Scene

Array = np.ndarray
WITHIN_RAD = float(np.radians(0.2))
WITHIN_M, OF_TRACK = 1e-3, 0.005
EXACT_RAD, EXACT_M = 1e-13, 1e-13  # what is less is the rounding of computations
TOLD_RAD, TOLD_M = 2e-9, 1e-10  # what is less is not reported: the core takes it for nothing


@dataclass(frozen=True, eq=False)
class Line:
    """A straight line, or the axle of a wheel whose middle is `point`."""

    point: Array      # (2,) in m
    direction: Array  # (2,) unit vector; its sense does not matter

    @property
    def normal(self) -> Array:
        """Square to it."""
        return np.array([-self.direction[1], self.direction[0]])

    def angle_to(self, other: Line) -> float:
        """Between the two, from 0 to a quarter turn."""
        return float(np.arcsin(min(1.0, abs(self.normal @ other.direction))))

    def offset_of(self, point: Array) -> float:
        """The distance of a point from it."""
        return float(abs(self.normal @ (point - self.point)))

    def nearest(self, point: Array) -> Array:
        """Its point that is nearest to another."""
        return np.asarray(self.point + self.direction * (self.direction @ (point - self.point)))


def line_of(x_m: float, y_m: float, axle_rad: float) -> Line:
    """Of a wheel in a scene."""
    return Line(np.array([x_m, y_m]), np.array([np.cos(axle_rad), np.sin(axle_rad)]))


def tolerance_m(points: Sequence[Array]) -> float:
    """How far wheels may lie off one line: 1 mm, or 0.5 % of their track."""
    track = max((float(np.linalg.norm(a - b)) for a, b in combinations(points, 2)), default=0.0)
    return max(WITHIN_M, OF_TRACK * track)


def common_line(axles: Sequence[Line]) -> Line | None:
    """The line that all of these are but for rounding: across the body or along it, if it can be; else None."""
    points = [each.point for each in axles]
    most_m = tolerance_m(points)
    for direction in _directions(axles):
        through = _through(points, direction)
        if all(through.angle_to(each) <= WITHIN_RAD and through.offset_of(each.point) <= most_m for each in axles):
            return through
    return None


def _directions(axles: Sequence[Line]) -> list[Array]:
    """Those that a common line may have: the body's axes, the mean of the axles, from one wheel to the farthest."""
    found = [np.array([0.0, 1.0]), np.array([1.0, 0.0])]
    same_sense = [each.direction * (1.0 if each.direction @ axles[0].direction >= 0.0 else -1.0) for each in axles]
    mean = np.sum(same_sense, axis=0)
    found.append(mean / np.linalg.norm(mean))
    if len(axles) > 1:
        one, other = max(combinations([each.point for each in axles], 2), key=lambda pair: np.linalg.norm(
            pair[0] - pair[1]))
        if (apart := float(np.linalg.norm(other - one))) > 0.0:
            found.append((other - one) / apart)
    return found


def _through(points: Sequence[Array], direction: Array) -> Line:
    """In this direction through the point from which the others lie least far off."""
    normal = np.array([-direction[1], direction[0]])
    offsets = np.array([normal @ point for point in points])
    worst = np.abs(offsets[:, None] - offsets[None, :]).max(axis=1)
    best = int(np.flatnonzero(worst <= worst.min() + EXACT_M)[0])
    return Line(points[best], direction)


def grouped(axles: Sequence[Line]) -> list[tuple[list[int], Line]]:
    """The axles that share a line, each with the line; those of one direction, but for rounding, have the same."""
    groups: list[list[int]] = []
    for index in range(len(axles)):
        joined = next((group for group in groups if common_line([axles[k] for k in (*group, index)])), None)
        if joined is None:
            groups.append([index])
        else:
            joined.append(index)
    lines: list[Line] = []
    for group in groups:
        line = common_line([axles[k] for k in group])
        assert line is not None  # each was joined only if there is one
        like = next((each for each in lines if 0.0 < each.angle_to(line) <= WITHIN_RAD), None)
        lines.append(Line(line.point, like.direction) if like else line)
    return list(zip(groups, lines, strict=True))


def are_parallel(lines: Sequence[Line]) -> bool:
    """Within the tolerance."""
    return all(lines[0].angle_to(each) <= WITHIN_RAD for each in lines)


def meeting_point(lines: Sequence[Line]) -> Array | None:
    """The one point that all lines come near to; None where they are parallel."""
    if are_parallel(lines):
        return None
    rows = np.array([each.normal for each in lines])
    right = np.array([each.normal @ each.point for each in lines])
    point, *_ = np.linalg.lstsq(rows, right, rcond=None)
    return np.asarray(point)


def misses_by(lines: Sequence[Line], point: Array) -> tuple[int, float]:
    """Which line passes a point at the largest distance, and that distance."""
    distances = [each.offset_of(point) for each in lines]
    worst = int(np.argmax(distances))
    return worst, distances[worst]


def words_of(angle_rad: float, offset_m: float) -> str:
    """Both numbers."""
    return f"{np.degrees(angle_rad):.3g}° and {1e3 * offset_m:.3g} mm"


def nearly_one_line(scene: Scene) -> list[str]:
    """A line for each plain wheel of a scene on ideal ground whose axle lies just off that of another: to the core they
    are two lines, and leave another robot than one line would."""
    if "friction_coefficient" in scene.vehicle.get("ground", {}):
        return []
    return [f"vehicle.wheel[{index + 1}]: {text}" for index, text in off_line(scene.vehicle).items()]


def off_line(vehicle: Mapping[str, Any]) -> dict[int, str]:
    """The same by the index of the wheel."""
    wheels = vehicle["wheel"]
    fixed = [index for index, wheel in enumerate(wheels) if wheel["kind"] == "fixed"]
    axles = {index: line_of(*(wheels[index][key] for key in ("x_m", "y_m", "axle_rad"))) for index in fixed}
    found = {}
    for group, line in grouped([axles[index] for index in fixed]) if fixed else []:
        first, *others = (fixed[k] for k in group)
        for index in others:
            angle, offset = axles[first].angle_to(axles[index]), axles[first].offset_of(axles[index].point)
            if angle > TOLD_RAD or offset > TOLD_M:
                found[index] = (f"its axle lies {words_of(angle, offset)} off that of wheel {first + 1}, which makes "
                                f"another robot than one line; give {_on(line, axles[index])}")
    return found


def _on(line: Line, axle: Line) -> str:
    """The numbers that place a wheel on a line."""
    x, y = line.nearest(axle.point) + 0.0
    sense = 1.0 if line.direction @ axle.direction >= 0.0 else -1.0
    degrees = float(np.degrees(np.arctan2(*(sense * line.direction[::-1]))))
    return f"x_m = {float(x):.9g}, y_m = {float(y):.9g} and axle_deg = {degrees:.12g}"
