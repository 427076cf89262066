"""Friction from the recorded currents: least squares on the wheel torques, with confidence intervals.

What (4.7) leaves to friction is y = τ − M, with the motor's torque τ = G k_t I on each wheel and the torque M that the
recorded motion needs, M = Ξ⁺ᵀ M R² (A ν' − Λ⁻¹ a). Three models are fitted, each containing the one before:
    ideal           y_i = c2 χ_i'               (4.7) alone
    dry             … + T_i sign χ_i'           a dry-friction torque for each wheel
    dry and drag    … + its share of a force of constant size against the travel (rollers with friction, or slip)
The intervals take each run as one observation of its own (cluster-robust, Student's t with runs − 1 degrees of
freedom), because samples within a run are not independent.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit  # the quantile of Student's t; scipy.stats takes long to load

from laconic.errors import BadInput
from laconic.robot.replay.log import Recording
from laconic.tools.analyse.from_core import Subject

MODELS = ("ideal", "dry", "dry and drag")
SOFT_SPEED = 0.3   # rad/s at the wheel: below it dry friction falls to zero, so that a wheel at rest does not chatter
SOFT_TRAVEL = 0.01  # m/s: the same for the drag force
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Friction:
    """One fitted model."""

    model: str
    names: tuple[str, ...]
    values: np.ndarray
    half_widths: np.ndarray     # 95 % confidence
    residual_Nm: float          # root mean square over the samples fitted

    def part(self, name: str) -> float:
        """A fitted value; 0 for one that the model does not have."""
        return float(self.values[self.names.index(name)]) if name in self.names else 0.0

    def torque(self, subject: Subject, speed: np.ndarray) -> np.ndarray:
        """Friction torque on the wheels at these wheel speeds (against the motor's)."""
        return regressors(subject, speed, self.model) @ self.values

    def dry_torque(self, subject: Subject) -> Callable[[np.ndarray], np.ndarray]:
        """The same without damping, as a quick function of one row of wheel speeds."""
        radius, share = float(subject.model.wheel_radius_m), np.linalg.pinv(subject.matrices.wheel_rows)
        drag = self.part("drag_N")
        torques = np.array([self.part(f"dry_torque_Nm[{i + 1}]") for i in range(subject.wheel_count)])

        def torque(speed: np.ndarray) -> np.ndarray:
            out = torques * np.tanh(speed / SOFT_SPEED)
            if drag:
                travel = radius * (share[:2] @ speed)
                size = math.hypot(*travel)
                out = out + share[:2].T @ (radius * drag * travel / max(size, 1e-12) * math.tanh(size / SOFT_TRAVEL))
            return out

        return torque


def torque_per_ampere(subject: Subject) -> float:
    """G k_t at the wheel."""
    motor = subject.scene.vehicle.get("motor")
    if not motor:
        raise BadInput(f"{subject.scene.path}: vehicle.motor: is missing; the measured currents need gear_ratio and "
                       "torque_constant_Nm_per_A to become torques")
    return float(motor["gear_ratio"] * motor["torque_constant_Nm_per_A"])


def body_motion(subject: Subject, wheel_speed: np.ndarray) -> np.ndarray:
    """ν that fits the wheel speeds best (pure rolling), one row each."""
    return wheel_speed @ np.linalg.pinv(subject.matrices.wheel_rows).T


def regressors(subject: Subject, speed: np.ndarray, model: str) -> np.ndarray:
    """What multiplies (c2, T_1 … T_N, drag force): samples × wheels × parameters; also for one row of speeds."""
    rows = np.atleast_2d(speed)
    count = rows.shape[1]
    columns = [rows[:, :, None]]
    if model != "ideal":
        columns.append(np.tanh(rows / SOFT_SPEED)[:, :, None] * np.eye(count))
    if model == "dry and drag":
        radius = float(subject.model.wheel_radius_m)
        travel = radius * body_motion(subject, rows)[:, :2]
        size = np.hypot(travel[:, 0], travel[:, 1])
        direction = travel / np.maximum(size, 1e-12)[:, None] * np.tanh(size / SOFT_TRAVEL)[:, None]
        wrench = np.column_stack([radius * direction, np.zeros(len(rows))])
        columns.append((wrench @ np.linalg.pinv(subject.matrices.wheel_rows))[:, :, None])
    whole = np.concatenate(columns, axis=2)
    return whole if np.ndim(speed) == 2 else whole[0]


def parameter_names(count: int, model: str) -> tuple[str, ...]:
    """Names with units, in the order of the regressors."""
    names = ["damping_Nms"]
    if model != "ideal":
        names += [f"dry_torque_Nm[{i + 1}]" for i in range(count)]
    if model == "dry and drag":
        names.append("drag_N")
    return tuple(names)


def inertial_torque(subject: Subject, recording: Recording) -> np.ndarray:
    """The wheel torques that the recorded motion needs by (4.6), without friction."""
    nu = body_motion(subject, recording.smooth_speed_rad_per_s)
    rate = np.gradient(nu, recording.time_s, axis=0)
    big = subject.matrices.lambda_yaw
    gyroscopic = np.column_stack([nu[:, 1] * nu[:, 2], -nu[:, 0] * nu[:, 2], np.zeros(len(nu))]) / big
    unit = float(subject.model.mass_kg) * float(subject.model.wheel_radius_m) ** 2
    needed = unit * (rate @ subject.matrices.inertia.T - gyroscopic)
    return needed @ np.linalg.pinv(subject.matrices.wheel_rows)


def friction_torque(subject: Subject, recording: Recording) -> np.ndarray:
    """y: the motor's torque less what the motion needs."""
    return torque_per_ampere(subject) * recording.current_A - inertial_torque(subject, recording)


def fit(subject: Subject, recordings: list[Recording], model: str) -> Friction:
    """Least squares over some runs."""
    blocks = []
    for recording in recordings:
        columns = regressors(subject, recording.smooth_speed_rad_per_s, model)
        blocks.append((columns.reshape(-1, columns.shape[2]), friction_torque(subject, recording).ravel()))
    whole, target = np.concatenate([b[0] for b in blocks]), np.concatenate([b[1] for b in blocks])
    values = np.linalg.lstsq(whole, target, rcond=None)[0]
    residual = target - whole @ values
    names = parameter_names(subject.wheel_count, model)
    half = _half_widths(blocks, values, whole)
    return Friction(model, names, values, half, float(np.sqrt((residual**2).mean())))


def _half_widths(blocks: Sequence[tuple[np.ndarray, np.ndarray]], values: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """Cluster-robust: every run counts as one observation."""
    runs = len(blocks)
    if runs < 2:
        return np.full(len(values), np.inf)
    bread = np.linalg.pinv(whole.T @ whole)
    scores = np.array([columns.T @ (target - columns @ values) for columns, target in blocks])
    covariance = bread @ (scores.T @ scores) @ bread * runs / (runs - 1)
    return stdtrit(runs - 1, 0.5 + CONFIDENCE / 2.0) * np.sqrt(np.diag(covariance))
