"""One recorded run: a row per sample, wheels in columns, everything at the wheel and in SI units."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from laconic.errors import BadInput

PER_WHEEL = ("set_speed", "wheel_angle", "wheel_speed", "current", "voltage")
STEERING = "steering_angle"
COMMANDED = "speed"
POINTS = ("origin", "centre_of_mass")
Point = str | tuple[float, float]
"""One of POINTS, or x, y [m] in the body's frame."""
LEAST_SAMPLES = 10
MEMBERS = {"set_speed": "set_speed_rad_per_s", "wheel_angle": "wheel_angle_rad", "wheel_speed": "wheel_speed_rad_per_s",
           "current": "current_A", "voltage": "voltage_V"}
"""The member of a log that holds each quantity of the wheels."""


@dataclass(frozen=True)
class Following:
    """How wheels follow what the log says of their steering and of the vehicle's speed, by the map."""

    is_command: bool = False                # steering: held from its line on
    lag_s: float = 0.0                      # of the steering, first order
    rate_limit_rad_per_s: float = np.inf
    curve: tuple[tuple[float, float], ...] = ()   # angle in the log, angle of the hinge; empty: the same
    speed_lag_s: float = 0.0


@dataclass(frozen=True, eq=False)
class Counter:
    """Where the angles of the wheels begin again, by the map: evidence may show that a row missed half of that."""

    said: str                               # as the map has it
    wrap_rad: np.ndarray                    # one row: of each wheel, NaN: not measured
    place: Callable[[int], str]             # names a sample of the log


@dataclass(frozen=True)
class Log:
    """One run; a quantity that the log does not have is None."""

    path: Path
    map_name: str
    time_s: np.ndarray                      # from 0 on
    set_speed_rad_per_s: np.ndarray | None = None
    wheel_angle_rad: np.ndarray | None = None
    wheel_speed_rad_per_s: np.ndarray | None = None
    current_A: np.ndarray | None = None
    voltage_V: np.ndarray | None = None
    pose: np.ndarray | None = None          # true x, y [m], heading [rad, unwrapped, NaN: not recorded] in the world
    pose_point: Point = "origin"            # which point of the vehicle the pose is of
    yaw_rate_rad_per_s: np.ndarray | None = None  # of a gyro
    steering_angle_rad: np.ndarray | None = None  # of hinges, a column each
    hinge_names: tuple[str, ...] = ()       # of these columns; empty: the scene's steered hinges in their order
    asks_hinges: bool = False               # the map names them: angles of free hinges count, too
    is_ordered: bool = False                # the map says which wheel of the scene each column is of
    moved: np.ndarray | None = None         # the displacements that the log has instead of a pose, summed: x, y, angle
    names: dict[str, str] = field(default_factory=dict)  # quantity → how the log calls its columns, for messages
    pose_rows: np.ndarray | None = None     # the samples whose pose was recorded, None: all; others are between two
    remarks: tuple[str, ...] = ()           # what was left out of the file, or filled in
    by_radius: tuple[str, ...] = ()         # members that are in metres still: the scene's radius makes angles of them
    wheel_names: tuple[str, ...] = ()       # of the columns, where their order is not known yet
    counter: Counter | None = None          # of wheel_angle_rad, until its rows were compared with other evidence
    column_names: tuple[str, ...] = ()      # of the joints of the scene's wheels, where the log names them
    speed_m_per_s: np.ndarray | None = None  # commanded, of the middle of the fixed axle; held from its line on
    following: Following = Following()
    part: str = ""                          # of a log with gaps: "part 2"

    @property
    def seen(self) -> np.ndarray:
        """The samples whose pose was recorded."""
        return np.arange(len(self.time_s)) if self.pose_rows is None else self.pose_rows

    @property
    def has_heading(self) -> bool:
        """Whether the true pose has a heading: GPS and total stations have positions alone."""
        return self.pose is not None and not bool(np.isnan(self.pose[:, 2]).any())

    @property
    def session(self) -> str:
        """The runs of one folder are a session: recorded in a row, on one floor."""
        return self.path.resolve().parent.name

    @property
    def stem(self) -> str:
        """The file's name without its endings."""
        stem = self.path.name.partition(".")[0] or self.path.name
        return f"{stem} {self.part}" if self.part else stem

    def needs(self, quantity: str, why: str) -> np.ndarray:
        """A quantity that must be there; BadInput says why."""
        value: np.ndarray | None = getattr(self, quantity)
        if value is None:
            raise BadInput(f"{self.path}: has no {quantity}, which {why} needs; name its columns in the map")
        return value

    def rotation_rad(self) -> np.ndarray:
        """Rotation of each wheel since the sample before; where there are no angles, speeds by the trapezoidal rule."""
        if self.wheel_angle_rad is not None:
            return np.diff(self.wheel_angle_rad, axis=0)
        speed = self.needs("wheel_speed_rad_per_s", "rolling")
        return 0.5 * (speed[1:] + speed[:-1]) * np.diff(self.time_s)[:, None]


def wheels_of(log: Log) -> int:
    """How many wheels the log has; 0: it has none."""
    values = (getattr(log, name) for name in ("wheel_angle_rad", "wheel_speed_rad_per_s", "set_speed_rad_per_s",
                                              "current_A", "voltage_V"))
    return next((value.shape[1] for value in values if value is not None), 0)


def remarks_of(logs: Sequence[Log]) -> list[str]:
    """What was left out of the files or filled in, each with the name of its run."""
    return [f"{name}: {remark}" for name, log in zip(run_names(logs), logs, strict=True) for remark in log.remarks]


def counted(number: int, what: str) -> str:
    """"1 run", "2 runs"."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def run_names(logs: Sequence[Log]) -> list[str]:
    """A name for each run: the file's, with its session in front where two files have the same."""
    stems = [log.stem for log in logs]
    names = [f"{log.session}/{log.stem}" for log in logs]
    found = stems if len(set(stems)) == len(stems) else names
    return found if len(set(found)) == len(found) else [f"{log.path} {log.part}".strip() for log in logs]


def by_session(logs: Sequence[Log]) -> dict[str, list[Log]]:
    """The runs of each session, in the order in which they came."""
    sessions: dict[str, list[Log]] = {}
    for log in logs:
        sessions.setdefault(str(log.path.resolve().parent), []).append(log)
    return sessions
