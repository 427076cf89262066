"""One recorded run beside the model: rolled distance, steady currents, and predicted wheel speeds by the core."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit  # the quantile of Student's t; scipy.stats takes long to load

from laconic.robot.replay.friction import CONFIDENCE, Friction, body_motion, torque_per_ampere
from laconic.robot.replay.log import Recording
from laconic.tools.analyse.from_core import Subject

STEP_S = 0.002
TRANSIENT_S = 1.0
SETTLED_S = 1.5     # after the start, from then on the motion counts as steady
BLOCK_S = 1.0       # length of the blocks whose means count as independent


@dataclass(frozen=True)
class Mean:
    """A mean with the half width of its 95 % confidence interval."""

    value: float
    half_width: float

    def __str__(self) -> str:
        return f"{self.value:.3g} ± {self.half_width:.2g}"


@dataclass(frozen=True)
class Rolled:
    """How far the wheels rolled and how far the robot went."""

    direction_deg: float
    speed_m_per_s: float           # set speed
    rolled_m: float
    camera_m: float
    ratio: Mean | None             # rolled over camera; None without a camera
    rolled_direction_deg: float    # direction of travel by pure rolling
    camera_direction_deg: float    # direction of travel by the camera
    path_m: np.ndarray             # rolled x, y in the robot's frame, summed


@dataclass(frozen=True)
class Prediction:
    """The prediction of one friction model for one run."""

    model: str
    speed_rad_per_s: np.ndarray    # at the samples' times, from the core; nan where it was not run
    transient_error: float         # root mean square over the first second, rad/s
    transient_error_share: float   # over the size of the measured speeds
    steady_current_A: np.ndarray   # predicted from the measured steady speeds
    steady_error_A: float          # root mean square over the wheels


@dataclass(frozen=True)
class Comparison:
    """All results of one run."""

    recording: Recording
    rolled: Rolled
    steady_speed_rad_per_s: np.ndarray
    steady_current_A: list[Mean]
    predictions: list[Prediction]


def compare(subject: Subject, recording: Recording, models: list[Friction], whole: bool = False) -> Comparison:
    """Judges one run; predicts its first second, or all of it."""
    settled = _settled(recording)
    speed = recording.smooth_speed_rad_per_s
    currents = [block_mean(recording.time_s[settled], recording.current_A[settled, i])
                for i in range(subject.wheel_count)]
    steady = speed[settled].mean(axis=0)
    predictions = [_prediction(subject, recording, model, steady, currents, whole) for model in models]
    return Comparison(recording, rolled(subject, recording), steady, currents, predictions)


def start_index(recording: Recording) -> int:
    """The last sample before the wheels rotate."""
    moving = np.abs(recording.wheel_angle_rad - recording.wheel_angle_rad[0]).max(axis=1) > 0.02
    return max(int(np.argmax(moving)) - 1, 0) if moving.any() else 0


def _settled(recording: Recording) -> np.ndarray:
    begin = recording.time_s[start_index(recording)] + SETTLED_S
    found = (recording.time_s > begin) & (recording.time_s < recording.time_s[-1] - 0.3)
    return found if found.any() else np.ones(len(recording.time_s), dtype=bool)


def block_mean(time_s: np.ndarray, values: np.ndarray) -> Mean:
    """Mean and interval from the means of blocks of BLOCK_S."""
    number = ((time_s - time_s[0]) / BLOCK_S).astype(int)
    means = np.array([values[number == k].mean() for k in np.unique(number) if (number == k).sum() > 5])
    if len(means) < 2:
        return Mean(float(values.mean()), float("inf"))
    half = stdtrit(len(means) - 1, 0.5 + CONFIDENCE / 2.0) * means.std(ddof=1) / np.sqrt(len(means))
    return Mean(float(means.mean()), float(half))


def rolled(subject: Subject, recording: Recording) -> Rolled:
    """The measured wheel angles rolled without slip, beside the camera's displacements."""
    radius = float(subject.model.wheel_radius_m)
    steps = radius * body_motion(subject, np.diff(recording.wheel_angle_rad, axis=0))[:, :2]
    path = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
    wanted = radius * body_motion(subject, recording.set_speed_rad_per_s.mean(axis=0)[None, :])[0, :2]
    ratio, camera_m, camera_deg = None, float("nan"), float("nan")
    if recording.camera is not None:
        seen = recording.camera[:, :2] - recording.camera[0, :2]
        camera_m, camera_deg = float(np.hypot(*seen[-1])), bearing_deg(seen[-1])
        ratio = _ratio(recording.time_s, path, seen, wanted / max(float(np.hypot(*wanted)), 1e-300))
    return Rolled(bearing_deg(wanted), float(np.hypot(*wanted)), float(np.hypot(*path[-1])), camera_m, ratio,
                  bearing_deg(path[-1]), camera_deg, path)


def bearing_deg(vector: np.ndarray) -> float:
    """Direction of a vector, 0 … 360°."""
    return round(float(np.degrees(np.arctan2(vector[1], vector[0]))), 3) % 360.0


def _ratio(time_s: np.ndarray, path: np.ndarray, seen: np.ndarray, unit: np.ndarray) -> Mean:
    """Rolled over camera, along the direction of travel, from blocks of BLOCK_S."""
    edges = np.searchsorted(time_s, np.arange(time_s[0] + SETTLED_S, time_s[-1], BLOCK_S))
    shares = []
    for first, last in zip(edges[:-1], edges[1:], strict=True):
        moved = float((seen[last] - seen[first]) @ unit)
        if last > first and abs(moved) > 1e-3:
            shares.append(float((path[last] - path[first]) @ unit) / moved)
    values = np.array(shares)
    if len(values) < 2:
        return Mean(float(values.mean()) if len(values) else float("nan"), float("inf"))
    half = stdtrit(len(values) - 1, 0.5 + CONFIDENCE / 2.0) * values.std(ddof=1) / np.sqrt(len(values))
    return Mean(float(values.mean()), float(half))


def _prediction(subject: Subject, recording: Recording, model: Friction, steady: np.ndarray,
                currents: list[Mean], whole: bool) -> Prediction:
    begin = recording.time_s[start_index(recording)]
    speed = predicted_speeds(subject, recording, model, np.inf if whole else begin + TRANSIENT_S)
    window = (recording.time_s >= begin) & (recording.time_s <= begin + TRANSIENT_S)
    measured = recording.smooth_speed_rad_per_s
    error = float(np.sqrt(((speed - measured)[window] ** 2).mean()))
    size = float(np.sqrt((measured[window] ** 2).mean()))
    current = model.torque(subject, steady) / torque_per_ampere(subject)
    gap = current - np.array([mean.value for mean in currents])
    return Prediction(model.model, speed, error, error / max(size, 1e-300), current, float(np.sqrt((gap**2).mean())))


def predicted_speeds(subject: Subject, recording: Recording, model: Friction, until_s: float = np.inf) -> np.ndarray:
    """Wheel speeds at the samples' times: the core driven by the measured currents as torques, less the friction.

    Damping is the core's c2; dry friction and drag are axle torques, computed at every step from the core's speeds.
    """
    core = subject.core
    vehicle = core.ffi.new("laconic_vehicle *", subject.vehicle[0])
    vehicle.motor_gain_Nm_per_V, vehicle.motor_damping_Nms = 0.0, max(model.part("damping_Nms"), 0.0)
    plant = core.plant(vehicle, "auto", STEP_S)
    first, per_ampere, dry = start_index(recording), torque_per_ampere(subject), model.dry_torque(subject)
    speeds, held = np.zeros_like(recording.wheel_angle_rad), core.input()
    torque = np.frombuffer(core.ffi.buffer(held.axle_torque_Nm), core.dtype)[: plant.wheel_count]
    for k in range(first, len(recording.time_s) - 1):
        begin, end = recording.time_s[k], recording.time_s[k + 1]
        if begin > until_s:
            speeds[k + 1 :] = np.nan
            break
        count = max(1, int(round((end - begin) / STEP_S)))
        plant.set_step((end - begin) / count)
        for part in range(count):
            share = (part + 0.5) / count
            current = (1.0 - share) * recording.current_A[k] + share * recording.current_A[k + 1]
            torque[:] = per_ampere * current - dry(plant.wheel_speeds())
            plant.run(held)
        speeds[k + 1] = plant.wheel_speeds()
    return speeds
