"""A run as an MCAP that Foxglove opens: frames, robot, path and signals as JSON with Foxglove's own schemas, and a
layout file next to it with the robot in three dimensions and its plots."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import orjson

from laconic.base.outputs import check_file, claims, make_folder, write_text
from laconic.errors import BadInput, reason_of
from laconic.pictures.views.robot_view import WORLD, Area, Panel, Part, Placed, RobotView, panels_of
from laconic.scene import Scene

BYTES_OF_CHUNK = 1 << 18
LAYOUT_ENDING = ".layout.json"
PATH_COLOUR = (0.13, 0.45, 0.85, 1.0)
LEAST_STEP = 0.01        # of the robot's size between two points of its path
CURVES = ("#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f")

Json = dict[str, Any]


# ------------------------------------------------------------------------------------------ schemas


def _object(title: str, members: Json, description: str = "") -> Json:
    return {"title": title, "type": "object", "properties": members, "required": list(members),
            **({"description": description} if description else {})}


def _list(items: Json) -> Json:
    return {"type": "array", "items": items}


NUMBER, TEXT, WHOLE, YES_OR_NO = ({"type": kind} for kind in ("number", "string", "integer", "boolean"))
ANYTHING: Json = {"type": "object"}
TIME, DURATION = (_object(name, {"sec": WHOLE, "nsec": WHOLE}) for name in ("time", "duration"))
VECTOR, POINT = (_object(f"foxglove.{name}", dict.fromkeys("xyz", NUMBER)) for name in ("Vector3", "Point3"))
QUATERNION = _object("foxglove.Quaternion", dict.fromkeys("xyzw", NUMBER))
COLOUR = _object("foxglove.Color", dict.fromkeys("rgba", NUMBER))
POSE = _object("foxglove.Pose", {"position": VECTOR, "orientation": QUATERNION})
TRANSFORM = _object("foxglove.FrameTransform", {
    "timestamp": TIME, "parent_frame_id": TEXT, "child_frame_id": TEXT, "translation": VECTOR, "rotation": QUATERNION})
TRIANGLES = _object("foxglove.TriangleListPrimitive", {
    "pose": POSE, "points": _list(POINT), "color": COLOUR, "colors": _list(COLOUR), "indices": _list(WHOLE)})
LINES = _object("foxglove.LinePrimitive", {
    "type": WHOLE, "pose": POSE, "thickness": NUMBER, "scale_invariant": YES_OR_NO, "points": _list(POINT),
    "color": COLOUR, "colors": _list(COLOUR), "indices": _list(WHOLE)})
WITHOUT = ("arrows", "cubes", "spheres", "cylinders", "texts", "models")
ENTITY = _object("foxglove.SceneEntity", {
    "timestamp": TIME, "frame_id": TEXT, "id": TEXT, "lifetime": DURATION, "frame_locked": YES_OR_NO,
    "metadata": _list(ANYTHING), **{name: _list(ANYTHING) for name in WITHOUT}, "lines": _list(LINES),
    "triangles": _list(TRIANGLES)})
SCHEMAS = {
    "/tf": _object("foxglove.FrameTransforms", {"transforms": _list(TRANSFORM)}),
    "/robot": _object("foxglove.SceneUpdate", {"deletions": _list(ANYTHING), "entities": _list(ENTITY)}),
    "/path": _object("foxglove.SceneUpdate", {"deletions": _list(ANYTHING), "entities": _list(ENTITY)}),
    "/pose": _object("foxglove.PoseInFrame", {"timestamp": TIME, "frame_id": TEXT, "pose": POSE})}
"""Of the topics that Foxglove draws, by their topics."""

SIGNALS = "/signals"


def schema_of_signals(names: Sequence[str]) -> Json:
    """Each signal by its name: with numbers in brackets as a list from 0 on, with names as an object."""
    members: Json = {"timestamp": TIME}
    for signal in names:
        name, inside = _parts(signal)
        if not inside:
            members[name] = NUMBER
        elif inside.isdigit():
            members[name] = _list(NUMBER)
        else:
            members.setdefault(name, {"type": "object", "properties": {}})["properties"][inside] = NUMBER
    return {"title": "laconic.Signals", "type": "object", "properties": members}


def _parts(signal: str) -> tuple[str, str]:
    name, _, inside = signal.partition("[")
    return name, inside.removesuffix("]")


def field_of(signal: str) -> str:
    """Where a plot finds a signal."""
    name, inside = _parts(signal)
    if not inside:
        return f"{SIGNALS}.{name}"
    if inside.isdigit():
        return f"{SIGNALS}.{name}[{int(inside) - 1}]"
    plain = inside if re.fullmatch(r"[A-Za-z_]\w*", inside) else f'"{inside}"'
    return f"{SIGNALS}.{name}.{plain}"


# ------------------------------------------------------------------------------------------- messages


def _time(stamp_ns: int) -> Json:
    return {"sec": stamp_ns // 10**9, "nsec": stamp_ns % 10**9}


def _vector(values: Sequence[float] | np.ndarray) -> Json:
    x, y, z = map(float, values)
    return {"x": x, "y": y, "z": z}


def _quaternion(turn: Sequence[float]) -> Json:
    return dict(zip("xyzw", turn, strict=True))


def _colour(colour: Sequence[float]) -> Json:
    return dict(zip("rgba", colour, strict=True))


AT_ORIGIN: Json = {"position": _vector((0.0, 0.0, 0.0)), "orientation": _quaternion((0.0, 0.0, 0.0, 1.0))}


def _entity(stamp_ns: int, frame: str, name: str, **primitives: list[Json]) -> Json:
    return {"timestamp": _time(stamp_ns), "frame_id": frame, "id": name, "lifetime": _time(0), "frame_locked": True,
            "metadata": [], "lines": [], "triangles": [], **{each: [] for each in WITHOUT}, **primitives}


def _solid(stamp_ns: int, part: Part) -> Json:
    """A part in its own frame, which moves it from then on."""
    colours = [_colour((*(colour / 255.0).tolist(), 1.0)) for colour in part.colours for _ in range(3)]
    points = [_vector(point) for point in part.triangles.reshape(-1, 3)]
    return _entity(stamp_ns, part.name, part.name, triangles=[{
        "pose": AT_ORIGIN, "points": points, "color": _colour((1.0, 1.0, 1.0, 1.0)), "colors": colours,
        "indices": list(range(len(points)))}])


def _transforms(stamp_ns: int, frames: Sequence[Placed]) -> Json:
    return {"transforms": [{"timestamp": _time(stamp_ns), "parent_frame_id": each.parent, "child_frame_id": each.name,
                            "translation": _vector(each.place_m), "rotation": _quaternion(each.turn)}
                           for each in frames]}


# ----------------------------------------------------------------------------------------- the file


def layout_of(path: Path) -> Path:
    """The layout that belongs to a file: run.mcap has run.layout.json."""
    return path.with_name(path.stem + LAYOUT_ENDING)


@contextmanager
def open_foxglove(path: Path, scene: Scene, area: Area | None = None) -> Iterator[FoxgloveFile]:
    """A new file with its layout, completed whatever happens on the way."""
    claims().write(path)
    check_file("--foxglove", layout_of(path))
    try:
        make_folder(path.parent)
        viewer = FoxgloveFile(path, scene, area)
        try:
            yield viewer
        finally:
            viewer.close()
    except OSError as error:
        raise BadInput(f"--foxglove {path}: cannot be written ({reason_of(error)}); choose another path") from None


class FoxgloveFile:
    """Writes a run instant by instant; the layout is there with the first one, the path at the end."""

    remarks = ()

    def __init__(self, path: Path, scene: Scene, area: Area | None = None):
        from mcap.writer import CompressionType, Writer

        self.path, self.scene = path, scene
        self._view = RobotView(scene, area)
        self._file = path.open("wb")
        self._writer = Writer(self._file, chunk_size=BYTES_OF_CHUNK, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="laconic")
        self._channels: dict[str, int] = {}
        self._way: list[tuple[float, float, float]] = []
        self._first_ns: int | None = None

    def take(self, time_s: float, signals: Mapping[str, float]) -> None:
        """One instant; without a pose its signals alone."""
        stamp_ns = round(1e9 * time_s)
        frames = self._view.frames(time_s, signals)
        if self._first_ns is None:
            self._begin(stamp_ns, list(signals))
        if frames:
            self._write("/tf", stamp_ns, _transforms(stamp_ns, frames))
            carriage = frames[0]
            self._write("/pose", stamp_ns, {"timestamp": _time(stamp_ns), "frame_id": WORLD, "pose": {
                "position": _vector(carriage.place_m), "orientation": _quaternion(carriage.turn)}})
            self._keep(carriage.place_m)
        self._write(SIGNALS, stamp_ns, _signals(stamp_ns, signals))

    def _begin(self, stamp_ns: int, names: list[str]) -> None:
        """Channels, the robot, and the layout, which depends on what there is to plot."""
        self._first_ns = stamp_ns
        for topic, schema in (*SCHEMAS.items(), (SIGNALS, schema_of_signals(names))):
            key = self._writer.register_schema(schema["title"], "jsonschema", orjson.dumps(schema))
            self._channels[topic] = self._writer.register_channel(topic, "json", key)
        self._write("/robot", stamp_ns, {"deletions": [], "entities": [_solid(stamp_ns, part)
                                                                       for part in self._view.parts]})
        layout = layout_json(self.scene.name, panels_of(self.scene, names), self._view)
        write_text(layout_of(self.path), orjson.dumps(layout, option=orjson.OPT_INDENT_2).decode() + "\n")

    def _keep(self, place: tuple[float, float, float]) -> None:
        """Notes a point of the path that is far enough from the one before."""
        if not self._way or abs(complex(place[0] - self._way[-1][0], place[1] - self._way[-1][1])) > \
                LEAST_STEP * self._view.size_m:
            self._way.append(place)

    def _write(self, topic: str, stamp_ns: int, message: Json) -> None:
        self._writer.add_message(self._channels[topic], stamp_ns, orjson.dumps(message), stamp_ns)

    def close(self) -> None:
        """Writes the whole path, to be seen from the first instant on, and the index."""
        try:
            if self._first_ns is not None and len(self._way) > 1:
                line = {"type": 0, "pose": AT_ORIGIN, "thickness": 2.0, "scale_invariant": True,
                        "points": [_vector(place) for place in self._way], "color": _colour(PATH_COLOUR), "colors": [],
                        "indices": []}
                self._write("/path", self._first_ns, {"deletions": [], "entities": [
                    _entity(self._first_ns, WORLD, "path", lines=[line])]})
            self._writer.finish()  # type: ignore[no-untyped-call]
        finally:
            self._file.close()


def _signals(stamp_ns: int, signals: Mapping[str, float]) -> Json:
    found: Json = {"timestamp": _time(stamp_ns)}
    for signal, value in signals.items():
        name, inside = _parts(signal)
        if not inside:
            found[name] = value
        elif inside.isdigit():
            values = found.setdefault(name, [])
            values += [None] * (int(inside) - 1 - len(values))  # wheels that nothing drives show no speed
            values.append(value)
        else:
            found.setdefault(name, {})[inside] = value
    return found


# --------------------------------------------------------------------------------------- the layout


def layout_json(name: str, panels: Sequence[Panel], view: RobotView) -> Json:
    """The robot on the left, its plots below each other on the right."""
    robot = "3D!robot"
    configs: Json = {robot: _robot_panel(name, view)}
    plots = [f"Plot!{number}" for number in range(1, len(panels) + 1)]
    configs |= {key: _plot(panel) for key, panel in zip(plots, panels, strict=True)}
    layout: Any = robot if not plots else {
        "direction": "row", "first": robot, "second": _below_each_other(plots), "splitPercentage": 58}
    return {"configById": configs, "globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1},
            "layout": layout}


def _below_each_other(keys: Sequence[str]) -> Any:
    if len(keys) == 1:
        return keys[0]
    return {"direction": "column", "first": keys[0], "second": _below_each_other(keys[1:]),
            "splitPercentage": 100.0 / len(keys)}


def _robot_panel(name: str, view: RobotView) -> Json:
    hidden = {f"frame:{frame}": {"visible": False} for frame in (WORLD, *view.bodies, *view.wheels)}
    return {
        "foxglovePanelTitle": name, "followTf": WORLD, "followMode": "follow-none",
        "cameraState": {"perspective": True, "distance": view.distance_m, "phi": 50.0, "thetaOffset": 35.0, "fovy": 45,
                        "near": 0.01, "far": 5000, "target": [0.0, 0.0, 0.0],
                        "targetOffset": [view.area.x_m, view.area.y_m, 0.0],
                        "targetOrientation": [0.0, 0.0, 0.0, 1.0]},
        "scene": {"transforms": {"showLabel": False, "editable": False}}, "transforms": hidden,
        "topics": {"/robot": {"visible": True}, "/path": {"visible": True}, "/pose": {"visible": False}},
        "layers": {"grid": {"visible": True, "frameLocked": True, "label": "Ground", "instanceId": "grid",
                            "layerId": "foxglove.Grid", "frameId": WORLD, "size": 20.0, "divisions": 20, "lineWidth": 1,
                            "color": "#9aa4b2", "position": [0.0, 0.0, 0.0], "rotation": [0.0, 0.0, 0.0]}}}


def _plot(panel: Panel) -> Json:
    return {"foxglovePanelTitle": panel.title, "title": panel.title, "showLegend": True, "legendDisplay": "top",
            "showXAxisLabels": True, "showYAxisLabels": True, "isSynced": True, "xAxisVal": "timestamp",
            "paths": [{"value": field_of(signal), "enabled": True, "timestampMethod": "receiveTime", "label": signal,
                       "color": CURVES[index % len(CURVES)]} for index, signal in enumerate(panel.signals)]}
