"""What a fit changed of a log's map, as a map: how commands are followed, place and lag of the tracker."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.text_file import decoded
from laconic.errors import BadInput
from laconic.robot.identify.fitted_toml import interval_text
from laconic.robot.identify.study import Study, fitted_scene
from laconic.robot.replay.steered_signals import OfLog, curved, of_log
from laconic.scene.scene_text import Comments, rewritten
from laconic.scene.table import read_map_toml

PLACES = {"gain": ("steering_angle", "scale"), "offset_rad": ("steering_angle", "offset"),
          "lag_s": ("steering_angle", "lag_s"), "rate_limit_rad_per_s": ("steering_angle", "rate_limit_rad_per_s"),
          "speed_gain": ("speed", "scale"), "speed_offset_m_per_s": ("speed", "offset"),
          "speed_lag_s": ("speed", "lag_s"), "tracker_x_m": ("pose", "mount", "x_m"),
          "tracker_y_m": ("pose", "mount", "y_m"), "tracker_heading_rad": ("pose", "mount", "heading_rad"),
          "clock_lag_s": ("pose", "lag_s")}
"""Where a map says what each correction finds."""
CURVE = ("steering_angle", "curve")


def fitted_map_text(study: Study, map_path: Path) -> str:
    """A complete map: the one it came from, with the values found."""
    data, comments = read_map_toml(map_path).plain(), dict[tuple[str, ...], str]()
    own = of_log(fitted_scene(study.scene, study.found).vehicle)
    _steering(data.get("steering_angle", {}), own)
    _speed(data.get("speed", {}), own)
    _pose(data.get("pose", {}), own)
    for parameter, value, half in zip(study.found.parameters.each, study.found.values, study.found.half_widths,
                                      strict=True):
        if parameter.path.startswith("log."):
            place = PLACES.get(parameter.path.removeprefix("log."), CURVE)
            if place[1] in ("scale", "offset") and own.curve and place[0] == CURVE[0]:
                place = CURVE
            _note(comments, place, interval_text(parameter, float(value), float(half)))
    return "\n".join([f"# {map_path.name}, with what `laconic identify` found for {study.scene.path.name}.",
                      "# Intervals hold the true value with 95 %, if the rest of the model is right; they are of what",
                      "# is added to the map before it.", "",
                      rewritten(decoded(map_path.read_bytes()).text, data, comments)])


def _note(comments: Comments, place: tuple[str, ...], text: str) -> None:
    comments[place] = f"{comments[place]}; {text}" if place in comments else text


def _scaled(table: dict[str, Any], gain: float, offset: float) -> None:
    """scale · gain, and offset · gain + offset; of each column where the map has several."""
    for key, usual, more in (("scale", 1.0, 0.0), ("offset", 0.0, offset)):
        if f"{key}s" in table:
            table[f"{key}s"] = [gain * each + more for each in table[f"{key}s"]]
        elif key in table or gain * usual + more != usual:
            table[key] = gain * table.get(key, usual) + more


def _steering(table: dict[str, Any], own: OfLog) -> None:
    if not table:
        return
    if own.curve or table.get("curve"):
        table["curve"] = _curve(table.get("curve"), own)
    else:
        _scaled(table, own.gain, own.offset_rad)
    if own.lag_s:
        table["lag_s"] = max(table.get("lag_s", 0.0) + own.lag_s, 0.0)
    if own.rate_limit_rad_per_s < math.inf:
        table["rate_limit_rad_per_s"] = min(table.get("rate_limit_rad_per_s", math.inf), own.rate_limit_rad_per_s)


def _curve(before: list[list[float]] | None, own: OfLog) -> list[list[float]]:
    """Both curves one after the other, then gain and offset."""
    given = tuple((float(x), float(y)) for x, y in before or ())
    at = sorted({x for x, _ in given} | ({*own.curve, 0.0} if not given else set()))
    return [[x, float(y)] for x, y in zip(at, curved(np.array(at), given, own), strict=True)]


def _speed(table: dict[str, Any], own: OfLog) -> None:
    if not table:
        return
    if own.speed_offset_m_per_s or "offset" in table:  # the gain is of the map's offset, too
        table["offset"] = own.speed_gain * table.get("offset", 0.0) + own.speed_offset_m_per_s
    if own.speed_gain != 1.0:
        table["scale"] = own.speed_gain * table.get("scale", 1.0)
    if own.speed_lag_s:
        table["lag_s"] = max(table.get("lag_s", 0.0) + own.speed_lag_s, 0.0)


def _pose(table: dict[str, Any], own: OfLog) -> None:
    """The tracker stands on one that the map has: both mounts one after the other."""
    if own.clock_lag_s:
        table["lag_s"] = table.get("lag_s", 0.0) + own.clock_lag_s
    if not (own.tracker_x_m or own.tracker_y_m or own.tracker_heading_rad):
        return
    if table.get("kind", "absolute") != "absolute":
        raise BadInput("[pose]: a map of displacements has no mount; give absolute poses to find the tracker's place")
    mount = dict(table.get("mount", {}))
    heading = float(mount.pop("heading_rad", math.radians(mount.pop("heading_deg", 0.0))))
    x, y = (float(mount.get(key, 0.0)) for key in ("x_m", "y_m"))
    # T = P ∘ own ∘ before: the old mount is from the point that the new one finds
    cos, sin = math.cos(own.tracker_heading_rad), math.sin(own.tracker_heading_rad)
    table["mount"] = {"x_m": own.tracker_x_m + cos * x - sin * y, "y_m": own.tracker_y_m + sin * x + cos * y,
                      "heading_rad": own.tracker_heading_rad + heading}
