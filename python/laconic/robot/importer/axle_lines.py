"""Wheels whose axles lie on one line, or meet in one point, but for rounding in the file, are brought onto it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from laconic.robot.importer.placement import Array
from laconic.robot.importer.wheels import FoundWheel
from laconic.scene.axle_lines import (
    EXACT_M,
    EXACT_RAD,
    TOLD_M,
    TOLD_RAD,
    WITHIN_RAD,
    Line,
    grouped,
    meeting_point,
    misses_by,
    tolerance_m,
    words_of,
)


def line_of(wheel: FoundWheel) -> Line:
    """Its axle, seen from above."""
    return Line(wheel.hub_m[:2], wheel.axle[:2])


def lines_of(wheels: Sequence[FoundWheel]) -> list[Line]:
    """Those of all wheels."""
    return [line_of(wheel) for wheel in wheels]


def straightened(wheels: Sequence[FoundWheel]) -> tuple[list[FoundWheel], list[str]]:
    """The wheels with their axles on common lines, and a remark that has the numbers of each that was moved."""
    moved, told = list(wheels), []
    for group, line in grouped(lines_of(wheels)):
        for index in group:
            own = line_of(wheels[index])
            angle, offset = line.angle_to(own), line.offset_of(own.point)
            if angle <= EXACT_RAD and offset <= EXACT_M:
                continue
            moved[index] = placed(wheels[index], line.nearest(own.point), line.direction)
            if angle > TOLD_RAD or offset > TOLD_M:
                told.append(f"{wheels[index].name} by {words_of(angle, offset)}")
    remark = (f"axles within 0.2° and 1 mm (or 0.5 % of the track) of one line, or of one direction, are brought onto "
              f"it: {', '.join(told)}")
    return moved, [remark] if told else []


def placed(wheel: FoundWheel, point: Array, direction: Array) -> FoundWheel:
    """The wheel at another place, its axle turned by less than a right angle."""
    sense = 1.0 if wheel.axle[:2] @ direction >= 0.0 else -1.0
    return replace(wheel, hub_m=np.array([*point, wheel.hub_m[2]]), axle=np.array([*(sense * direction), 0.0]))


def brought_to_meet(wheels: Sequence[FoundWheel]) -> tuple[list[FoundWheel], list[str]]:
    """Plain wheels whose axles meet in one point but for rounding, turned to meet there."""
    lines = lines_of(wheels)
    point = meeting_point(lines)
    if point is None or not nearly_meet(lines, point):
        return list(wheels), []
    point = _on_shared_line(lines, point)
    moved, told = list(wheels), []
    for index, (wheel, line) in enumerate(zip(wheels, lines, strict=True)):
        to_point = point - line.point
        distance, offset = float(np.linalg.norm(to_point)), line.offset_of(point)
        if offset <= EXACT_M:
            continue
        if distance <= tolerance_m([]):  # it turns about itself
            moved[index] = placed(wheel, point, line.direction)
            told.append(f"{wheel.name} by {words_of(0.0, distance)}")
            continue
        direction = Line(line.point, to_point / distance)
        if (angle := direction.angle_to(line)) > WITHIN_RAD:
            return list(wheels), []
        moved[index] = placed(wheel, line.point, direction.direction)
        if angle > TOLD_RAD:
            told.append(f"{wheel.name} by {words_of(angle, offset)}")
    remark = f"axles within 0.2° and 1 mm of one point are brought to meet in it: {', '.join(told)}"
    return moved, [remark] if told else []


def nearly_meet(lines: Sequence[Line], point: Array) -> bool:
    """Whether all lines pass a point but for rounding."""
    return misses_by(lines, point)[1] <= tolerance_m([each.point for each in lines])


def _on_shared_line(lines: Sequence[Line], point: Array) -> Array:
    """The same point, moved onto the axle that two wheels share, which so stays as it is."""
    for group, line in grouped(lines):
        if len(group) > 1:
            return line.nearest(point)
    return point
