"""A map of Nav2's kind, and the planar scan that a robot would see in it: rays through the image, by numpy."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.text_file import text_of_file
from laconic.errors import BadInput, reason_of
from laconic.ros2.messages import new
from laconic.ros2.motion import Seen
from laconic.ros2.names import LATCHED, NANO, Out
from laconic.ros2.node import RobotNode

KEYS = ("image", "resolution", "origin")
RAYS = 360
RANGE_LEAST_M, RANGE_MOST_M = 0.12, 12.0
SCAN_S = 0.1
OCCUPIED, FREE, UNKNOWN = 100, 0, -1
MOST_CELLS = 10**8


@dataclass(frozen=True)
class Map:
    """Cells of an occupancy grid, row 0 at the bottom."""

    cells: np.ndarray       # (rows, columns), int8
    resolution_m: float
    x_m: float              # of the lower left corner
    y_m: float

    @classmethod
    def read(cls, path: Path) -> Map:
        """Reads a map's YAML file and its image; BadInput names the file and the key."""
        entries = entries_of(path)
        resolution, origin = number(path, entries, "resolution"), origin_of(path, entries)
        if not 0.0 < resolution < math.inf:
            raise BadInput(f"{path}: resolution: is {resolution:g}; give metres of a cell, above 0")
        occupied, free = number(path, entries, "occupied_thresh", 0.65), number(path, entries, "free_thresh", 0.25)
        shades = image_of(path.parent / entries["image"])
        share = shades if entries.get("negate", "0") in ("1", "true", "True") else 1.0 - shades
        cells = np.full(share.shape, UNKNOWN, np.int8)
        cells[share > occupied], cells[share < free] = OCCUPIED, FREE
        return cls(np.ascontiguousarray(cells[::-1]), resolution, origin[0], origin[1])

    def ranges(self, x_m: float, y_m: float, angles_rad: np.ndarray) -> np.ndarray:
        """Distances from a point to the nearest occupied cell along each ray; infinite where there is none in range."""
        distances = np.arange(0.0, RANGE_MOST_M, 0.5 * self.resolution_m)
        columns = (x_m - self.x_m + np.outer(np.cos(angles_rad), distances)) / self.resolution_m
        rows = (y_m - self.y_m + np.outer(np.sin(angles_rad), distances)) / self.resolution_m
        column, row = np.floor(columns).astype(np.int64), np.floor(rows).astype(np.int64)
        height, width = self.cells.shape
        is_inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        hits = is_inside & (self.cells[np.where(is_inside, row, 0), np.where(is_inside, column, 0)] == OCCUPIED)
        found: np.ndarray = np.where(hits.any(axis=1), distances[np.argmax(hits, axis=1)], np.inf)
        return found

    def message(self, frame: str) -> Any:
        """The nav_msgs/OccupancyGrid."""
        height, width = self.cells.shape
        grid = new("nav_msgs/msg/OccupancyGrid", data=self.cells.ravel().tolist())
        grid.header.frame_id = frame
        grid.info.resolution, grid.info.width, grid.info.height = self.resolution_m, width, height
        grid.info.origin.position.x, grid.info.origin.position.y = self.x_m, self.y_m
        return grid


class Scanner:
    """Publishes the map once, and each robot's scan ten times a second."""

    def __init__(self, world: Map, robots: list[RobotNode]):
        self.world, self._next_ns = world, [-1] * len(robots)
        self._angles = np.linspace(-math.pi, math.pi, RAYS, endpoint=False)
        first = robots[0]
        first.node.publisher("/map", "nav_msgs/msg/OccupancyGrid", LATCHED).write(world.message(first.frames["map"]))
        self._outs = []
        for robot in robots:
            scan = new("sensor_msgs/msg/LaserScan", angle_min=-math.pi, angle_max=math.pi - 2.0 * math.pi / RAYS,
                       angle_increment=2.0 * math.pi / RAYS, scan_time=SCAN_S, range_min=RANGE_LEAST_M,
                       range_max=RANGE_MOST_M, ranges=[0.0] * RAYS)
            scan.header.frame_id = robot.frames["scan"]
            out = Out(robot.node, "scan", "sensor_msgs/msg/LaserScan", scan)
            self._outs.append((out, out.packed.slot("ranges", f"{RAYS}f")))

    def see(self, robot: RobotNode, seen: Seen, stamp_ns: int) -> None:
        """Publishes a robot's scan where it is due."""
        if stamp_ns < self._next_ns[robot.robot]:
            return
        self._next_ns[robot.robot] = stamp_ns + round(SCAN_S * NANO)
        out, slot = self._outs[robot.robot]
        slot.put(*self.world.ranges(seen.x_m, seen.y_m, seen.heading_rad + self._angles).tolist())
        out.write(divmod(stamp_ns, NANO))
        robot.messages += 1


def entries_of(path: Path) -> dict[str, str]:
    """The keys of a map's YAML file, which is a list of `key: value`."""
    found = {}
    for line in text_of_file(path, "a map's YAML file").lines:
        key, colon, value = line.partition("#")[0].partition(":")
        if colon:
            found[key.strip()] = value.strip().strip("\"'")
    for key in KEYS:
        if not found.get(key):
            raise BadInput(f"{path}: {key}: is missing; give the YAML file of a map as Nav2's map_saver writes it")
    return found


def number(path: Path, entries: dict[str, str], key: str, usual: float | None = None) -> float:
    """A number of the file."""
    text = entries.get(key)
    if text is None and usual is not None:
        return usual
    try:
        return float(text or "")
    except ValueError:
        raise BadInput(f"{path}: {key}: is {text}, not a number") from None


def origin_of(path: Path, entries: dict[str, str]) -> tuple[float, float]:
    """x and y of the lower left corner; BadInput for a map that is turned."""
    try:
        x_m, y_m, yaw_rad = (float(each) for each in entries["origin"].strip("[]").split(","))
    except ValueError:
        raise BadInput(f"{path}: origin: is {entries['origin']}, not three numbers; give [x, y, yaw]") from None
    if yaw_rad != 0.0 or not (math.isfinite(x_m) and math.isfinite(y_m)):
        raise BadInput(f"{path}: origin: has the yaw {yaw_rad:g}; give a map whose rows lie along x, yaw 0")
    return x_m, y_m


def image_of(path: Path) -> np.ndarray:
    """Brightness of an image's cells, 0 to 1, row 0 at the top."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            if image.width * image.height > MOST_CELLS:
                raise BadInput(f"{path}: has more than {MOST_CELLS:g} cells; give a coarser map")
            return np.asarray(image.convert("L"), np.float64) / 255.0
    except UnidentifiedImageError:
        raise BadInput(f"{path}: is no image that can be read; give a .pgm or .png") from None
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); give the image that the map names") from None
    except Image.DecompressionBombError:
        raise BadInput(f"{path}: has more than {MOST_CELLS:g} cells; give a coarser map") from None
