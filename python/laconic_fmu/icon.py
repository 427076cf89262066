"""A vehicle's icon, drawn from its wheels: seen from above, the first body axis up.

White bars are the axes of the rollers on top of a wheel, which one sees from above; those of a mecanum wheel are
mirrored against the roller on the ground. A locked wheel is red, ball casters are grey discs.

Draws convex polygons: one list of shapes gives the SVG and the PNG, so that both show the same.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import ceil, cos, hypot, pi, sin

Point = tuple[float, float]
Colour = tuple[int, int, int]
WHITE: Colour = (255, 255, 255)
LINES = 4
"""Lines drawn in each row of pixels; along a line coverage is exact."""
SHADES = 32
"""Parts of a pixel that an edge is told in: finer ones are not seen, and would make a picture half as large again."""


@dataclass(frozen=True)
class Shape:
    """A filled convex polygon; x to the right, y down, in pixels."""

    colour: Colour
    points: tuple[Point, ...]


def svg(shapes: Sequence[Shape], size: int, title: str) -> str:
    """The shapes as SVG."""
    escaped = title.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    polygons = "".join(
        f'  <polygon fill="#{bytes(shape.colour).hex()}" points="'
        + " ".join(f"{x:.2f},{y:.2f}" for x, y in shape.points) + '"/>\n' for shape in shapes)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size} {size}" width="{size}" height="{size}">\n'
            f"  <title>{escaped}</title>\n{polygons}</svg>\n")


def _spans(points: Sequence[Point]) -> dict[int, tuple[float, float]]:
    """By the number of each line that crosses a convex polygon: where the line enters and leaves."""
    found: dict[int, list[float]] = {}
    for (x0, y0), (x1, y1) in pairwise((*points, points[0])):
        for line in range(ceil(LINES * min(y0, y1) - 0.5), ceil(LINES * max(y0, y1) - 0.5)):
            y = (line + 0.5) / LINES
            found.setdefault(line, []).append(x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return {line: (min(ends), max(ends)) for line, ends in found.items()}


def _blend(row: bytearray, k: int, colour: Colour, share: float) -> None:
    for c in range(3):
        row[3 * k + c] = round(row[3 * k + c] + (colour[c] - row[3 * k + c]) * share)


def _paint_row(row: bytearray, spans: Sequence[tuple[float, float]], colour: Colour) -> None:
    """Fills the pixels that all lines cover, and blends those at the edges by the part of them that is covered."""
    size = len(row) // 3
    first, end = max(0, int(min(left for left, _ in spans))), min(size, int(max(right for _, right in spans)) + 1)
    full = max(first, ceil(max(left for left, _ in spans)))
    stop = min(end, int(min(right for _, right in spans))) if len(spans) == LINES else full
    stop = max(full, stop)
    row[3 * full:3 * stop] = bytes(colour) * (stop - full)
    for k in (*range(first, min(full, end)), *range(stop, end)):
        share = sum(max(0.0, min(right, k + 1.0) - max(left, float(k))) for left, right in spans) / LINES
        _blend(row, k, colour, min(1.0, round(SHADES * share) / SHADES))


def _paint(pixels: list[bytearray], shape: Shape) -> None:
    spans = _spans(shape.points)
    for y in sorted({line // LINES for line in spans}):
        if 0 <= y < len(pixels):
            _paint_row(pixels[y], [spans[line] for line in range(LINES * y, LINES * (y + 1)) if line in spans],
                       shape.colour)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


@lru_cache(maxsize=64)
def png(shapes: tuple[Shape, ...], size: int) -> bytes:
    """The shapes as PNG, 8 bits a colour, on white. A vehicle's FMUs show it alike, so it is drawn once."""
    pixels = [bytearray(WHITE * size) for _ in range(size)]
    for shape in shapes:
        _paint(pixels, shape)
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + bytes(row) for row in pixels), 9)
    return b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) + _chunk(b"IDAT", data) + _chunk(b"IEND", b"")


SIZE = 200
MARGIN = 22
SMALLEST = 0.16
"""Least length of a drawn wheel as a fraction of the vehicle's extent, so that small wheels can be seen."""
BLUE, LIGHT, ORANGE, RED, GREY = (27, 73, 101), (190, 233, 232), (202, 103, 2), (174, 32, 18), (130, 140, 148)
FIXED = 2
"""Number of an ordinary wheel in wheel_kind."""


def _disc(x: float, y: float, radius: float, corners: int = 24) -> list[Point]:
    return [(x + radius * cos(2 * pi * k / corners), y + radius * sin(2 * pi * k / corners)) for k in range(corners)]


def _bar(centre: Point, angle: float, length: float, width: float) -> list[Point]:
    """A rectangle whose long side points along an angle."""
    c, s = cos(angle), sin(angle)
    return [(centre[0] + a * length / 2 * c - b * width / 2 * s, centre[1] + a * length / 2 * s + b * width / 2 * c)
            for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]


def _hull(points: Sequence[Point]) -> list[Point]:
    """Convex hull, counter-clockwise (Andrew's monotone chain)."""
    def half(ordered: Sequence[Point]) -> list[Point]:
        chain: list[Point] = []
        for p in ordered:
            while len(chain) > 1 and ((chain[-1][0] - chain[-2][0]) * (p[1] - chain[-2][1])
                                      <= (chain[-1][1] - chain[-2][1]) * (p[0] - chain[-2][0])):
                chain.pop()
            chain.append(p)
        return chain[:-1]
    ordered = sorted(set(points))
    return half(ordered) + half(ordered[::-1])


def _wheel(values: Mapping[str, Sequence[float]], i: int, length: float) -> list[tuple[Colour, list[Point]]]:
    """A wheel and its rollers, in body axes."""
    centre, axle = (values["wheel_x_m"][i], values["wheel_y_m"][i]), values["axle_rad"][i]
    colour = RED if values["wheel_locked"][i] else BLUE
    parts = [(colour, _bar(centre, axle + pi / 2, length, 0.5 * length))]
    if values["wheel_kind"][i] == FIXED:
        return parts
    seen = axle - values["roller_rad"][i]
    across = abs(cos(seen - axle))  # rollers along the wheel's rim are short, so that three of them follow each other
    for k in (-1, 0, 1):
        middle = (centre[0] - 0.31 * k * length * sin(axle), centre[1] + 0.31 * k * length * cos(axle))
        parts.append((WHITE, _bar(middle, seen, (0.2 + 0.22 * across) * length, 0.07 * length)))
    return parts


def _radii(values: Mapping[str, Sequence[float]], count: int) -> list[float]:
    """Of each wheel: its own radius, else the vehicle's."""
    common = values["wheel_radius_m"][0]
    return [own or common for own in values.get("own_radius_m", [0.0] * count)][:count]


def _drawing(values: Mapping[str, Sequence[float]]) -> list[tuple[Colour, list[Point]]]:
    """Everything but the frame, in body axes and metres."""
    supports = [(values["support_x_m"][i], values["support_y_m"][i]) for i in range(int(values["support_count"][0]))]
    wheels = list(zip(values.get("wheel_x_m", ()), values.get("wheel_y_m", ()), strict=True))
    centre = (values["com_x_m"][0], values["com_y_m"][0])
    points = [*wheels, *supports, centre]
    extent = max(hypot(x - centre[0], y - centre[1]) for x, y in points)
    lengths = [max(2 * radius, SMALLEST * 2 * extent) for radius in _radii(values, len(wheels))]
    length = max(2 * values["wheel_radius_m"][0], SMALLEST * 2 * extent)
    body = _hull([corner for x, y in points for corner in _disc(x, y, 0.45 * length)])
    parts: list[tuple[Colour, list[Point]]] = [(BLUE, body), (LIGHT, _smaller(body, 0.06 * length))]
    parts += [(GREY, _disc(*support, 0.22 * length)) for support in supports]
    parts += [part for i in range(len(wheels)) for part in _wheel(values, i, lengths[i])]
    reach = max(0.5 * length, 0.45 * extent)
    tip = (centre[0] + reach, centre[1])
    parts.append((ORANGE, _bar((centre[0] + 0.4 * reach, centre[1]), 0.0, 0.8 * reach, 0.14 * reach)))
    parts.append((ORANGE, [tip, (tip[0] - 0.45 * reach, tip[1] + 0.3 * reach), (tip[0] - 0.45 * reach,
                                                                              tip[1] - 0.3 * reach)]))
    return [*parts, (ORANGE, _disc(*centre, 0.12 * reach))]


def _smaller(hull: Sequence[Point], border: float) -> list[Point]:
    """A convex polygon without a border of about this width: each corner moves towards the middle."""
    x, y = (sum(p[k] for p in hull) / len(hull) for k in (0, 1))
    return [(x + (px - x) * (1 - border / hypot(px - x, py - y)), y + (py - y) * (1 - border / hypot(px - x, py - y)))
            for px, py in hull]


def _frame(inset: float, radius: float) -> tuple[Point, ...]:
    """A square with round corners."""
    low, high = inset + radius, SIZE - inset - radius
    corners = ((high, high, 0.0), (low, high, pi / 2), (low, low, pi), (high, low, 3 * pi / 2))
    return tuple((x + radius * cos(start + k * pi / 16), y + radius * sin(start + k * pi / 16))
                 for x, y, start in corners for k in range(9))


def shapes(values: Mapping[str, Sequence[float]]) -> list[Shape]:
    """The polygons of the icon. `values`: the start values of a vehicle's description, by name."""
    drawing = _drawing(values)
    xs, ys = ([p[k] for _, points in drawing for p in points] for k in (0, 1))
    scale = (SIZE - 2 * MARGIN) / max(max(xs) - min(xs), max(ys) - min(ys))
    middle = ((max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2)

    def placed(p: Point) -> Point:
        return SIZE / 2 - scale * (p[1] - middle[1]), SIZE / 2 - scale * (p[0] - middle[0])
    return [Shape(BLUE, _frame(1, 15)), Shape(WHITE, _frame(6, 11)),
            *(Shape(colour, tuple(placed(p) for p in points)) for colour, points in drawing)]


def icon_svg(values: Mapping[str, Sequence[float]], title: str) -> str:
    """The icon as SVG."""
    return svg(shapes(values), SIZE, title)


def icon_png(values: Mapping[str, Sequence[float]]) -> bytes:
    """The icon as PNG."""
    return png(tuple(shapes(values)), SIZE)
