"""A run for the viewer of Rerun, live or as a file: robot, path and signals, with a blueprint that arranges them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.outputs import claims, make_folder
from laconic.errors import BadInput, reason_of
from laconic.pictures.views.robot_view import Area, Panel, Placed, RobotView, panels_of
from laconic.scene import Scene

TIMELINE = "time"
LIVE_ROWS, FILE_ROWS = 10, 2000    # instants that are sent together
WORLD_PATH, ROBOT_PATH, WAY_PATH, SIGNALS_PATH = "world", "world/robot", "world/path", "signals"
PATH_COLOUR = (33, 115, 217)
LIVE = Path()                    # --rerun without a file: the viewer itself


@contextmanager
def open_rerun(path: Path, scene: Scene, area: Area | None = None) -> Iterator[RerunStream]:
    """A recording file, or the viewer, started here, where no file is named."""
    import rerun

    stream = rerun.RecordingStream("laconic")
    stream.send_recording_name(scene.name)
    try:
        if path == LIVE:
            stream.spawn()
        else:
            claims().write(path)
            make_folder(path.parent)
            with path.open("wb"):  # the library reports a path that cannot be written in its own log alone
                pass
            stream.save(str(path))
        viewer = RerunStream(stream, scene, LIVE_ROWS if path == LIVE else FILE_ROWS, area)
        try:
            yield viewer
        finally:
            viewer.close()
    except OSError as error:
        raise BadInput(f"--rerun {path}: cannot be written ({reason_of(error)}); choose another path") from None
    except RuntimeError:  # of the library: the viewer did not start
        raise BadInput("--rerun: the viewer did not start; give --rerun FILE.rrd, and open that file on a machine with "
                       "a screen by `rerun FILE.rrd`") from None


class RerunStream:
    """Sends a run in pieces of some instants, as columns."""

    remarks = ()

    def __init__(self, stream: Any, scene: Scene, rows: int, area: Area | None = None):
        self.scene, self._stream, self._rows = scene, stream, rows
        self._view = RobotView(scene, area)
        self._parents = {each.name: each.parent for each in self._view.parts}
        self._names: list[str] | None = None
        self._times: list[float] = []
        self._values: list[list[float]] = []
        self._frames: list[list[Placed]] = []
        self._end: tuple[float, float, float] | None = None

    def take(self, time_s: float, signals: Mapping[str, float]) -> None:
        """One instant."""
        if self._names is None:
            self._begin(list(signals))
        assert self._names is not None
        self._times.append(time_s)
        self._values.append([signals.get(name, float("nan")) for name in self._names])
        self._frames.append(self._view.frames(time_s, signals))
        if len(self._times) >= self._rows:
            self._send()

    def entity_of(self, part: str) -> str:
        """Where a body or wheel is in the tree of entities: below what carries it."""
        above = self._parents[part]
        carrier = self.entity_of(above) if above in self._parents else ROBOT_PATH
        return f"{carrier}/{_escaped(part)}"

    def _begin(self, names: list[str]) -> None:
        """What never changes: shapes, colours of curves, and the blueprint."""
        import rerun

        self._names, stream = names, self._stream
        stream.log(WORLD_PATH, rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for part in self._view.parts:
            corners = part.triangles.reshape(-1, 3)
            stream.log(f"{self.entity_of(part.name)}/shape", rerun.Mesh3D(
                vertex_positions=corners, triangle_indices=np.arange(len(corners)).reshape(-1, 3),
                vertex_normals=_normals(part.triangles), vertex_colors=np.repeat(part.colours, 3, axis=0)), static=True)
        panels = panels_of(self.scene, names)
        for panel in panels:
            for signal in panel.signals:
                stream.log(_of_signal(signal), rerun.SeriesLines(names=signal), static=True)
        stream.send_blueprint(self._blueprint(panels))

    def _blueprint(self, panels: list[Panel]) -> Any:
        import rerun.blueprint as views

        plots = [views.TimeSeriesView(name=panel.title, origin=f"/{SIGNALS_PATH}",
                                      contents=[f"/{_of_signal(signal)}" for signal in panel.signals])
                 for panel in panels]
        robot = views.Spatial3DView(name=self.scene.name, origin=f"/{WORLD_PATH}", contents="$origin/**",
                                    line_grid=True, eye_controls=self._eye())
        parts = views.Horizontal(robot, views.Vertical(*plots), column_shares=[3, 2]) if plots else robot
        return views.Blueprint(parts, views.TimePanel(timeline=TIMELINE, state="collapsed"),
                               views.SelectionPanel(state="collapsed"), views.BlueprintPanel(state="collapsed"))

    def _eye(self) -> Any:
        """The camera: the whole area from behind and above."""
        import rerun.blueprint as views

        area, far = self._view.area, self._view.distance_m
        return views.EyeControls3D(kind=views.Eye3DKind.Orbital, look_target=(area.x_m, area.y_m, 0.0),
                                   position=(area.x_m - 0.6 * far, area.y_m - 0.4 * far, 0.7 * far),
                                   eye_up=(0.0, 0.0, 1.0))

    def _send(self) -> None:
        import rerun

        if not self._times or self._names is None:
            return
        index = [rerun.TimeColumn(TIMELINE, duration=self._times)]
        for name, column in zip(self._names, np.array(self._values).T, strict=True):
            self._stream.send_columns(_of_signal(name), index, rerun.Scalars.columns(scalars=column))
        self._send_frames()
        self._times, self._values, self._frames = [], [], []

    def _send_frames(self) -> None:
        import rerun

        there = [number for number, frames in enumerate(self._frames) if frames]
        if not there:
            return
        times = [self._times[number] for number in there]
        index = [rerun.TimeColumn(TIMELINE, duration=times)]
        for each in range(len(self._frames[there[0]])):
            frames = [self._frames[number][each] for number in there]
            self._stream.send_columns(self.entity_of(frames[0].name), index, rerun.Transform3D.columns(
                translation=[frame.place_m for frame in frames], quaternion=[frame.turn for frame in frames]))
        self._send_way([self._frames[number][0].place_m for number in there], times[-1])

    def _send_way(self, places: list[tuple[float, float, float]], end_s: float) -> None:
        """The piece of the path since the last one, which stays."""
        import rerun

        strip = places if self._end is None else [self._end, *places]
        self._end = places[-1]
        if len(strip) > 1:
            self._stream.log(f"{WAY_PATH}/{round(1e6 * end_s)}", rerun.LineStrips3D(
                [strip], colors=[PATH_COLOUR], radii=rerun.Radius.ui_points(1.5)), static=True)

    def close(self) -> None:
        """Sends what is left."""
        self._send()
        self._stream.flush()
        self._stream.disconnect()


def _of_signal(signal: str) -> str:
    name, _, inside = signal.partition("[")
    return f"{SIGNALS_PATH}/{name}/{_escaped(inside.removesuffix(']'))}" if inside else f"{SIGNALS_PATH}/{name}"


def _escaped(part: str) -> str:
    """A name as one part of the path of an entity."""
    return "".join(letter if letter.isalnum() or letter in "_-" else f"\\{letter}" for letter in part)


def _normals(triangles: np.ndarray) -> np.ndarray:
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    return np.repeat(across / np.where(length > 0.0, length, 1.0), 3, axis=0)
