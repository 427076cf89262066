"""Draws convex polygons: one list of shapes gives the SVG and the PNG, so that both show the same."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import ceil

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


def _span(points: Sequence[Point], y: float) -> tuple[float, float] | None:
    """Where a horizontal line enters and leaves a convex polygon."""
    found = [x0 + (y - y0) * (x1 - x0) / (y1 - y0) for (x0, y0), (x1, y1) in pairwise((*points, points[0]))
             if (y0 <= y) != (y1 <= y)]
    return (min(found), max(found)) if found else None


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
    heights = [y for _, y in shape.points]
    for y in range(max(0, int(min(heights))), min(len(pixels), int(max(heights)) + 1)):
        spans = [span for line in range(LINES) if (span := _span(shape.points, y + (line + 0.5) / LINES))]
        if spans:
            _paint_row(pixels[y], spans, shape.colour)


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
