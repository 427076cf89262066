"""What the wheels can do with the body: which motions they drive or damp, how evenly, and how well they yaw it.

Ξ is judged in metres per second: rim speeds R_i χ_i' against the body's (v_ξ, v_η, ℓ θ'), where ℓ is the wheels' root
mean square distance from their middle. Its null space holds the motions that no motor drives or damps. The rank misses
the classic mistake, mecanum wheels mounted in the wrong diagonal: it leaves full rank (unless the wheels stand in a
square) and almost no lever arm in yaw. So yaw has a measure of its own, the yaw authority: the least rim speed (root
mean square) that goes with a yaw rate of 1 rad/s about any point, over ℓ. About 1 is usual, near 0 is a mistake.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laconic.scene.ground import slips
from laconic.tools.analyse.from_core import Subject
from laconic.tools.measures.authority import RANK_TOLERANCE, condition_of, spread_m, yaw_authority_of

WEAK_YAW = 0.5            # below this fraction of what mirrored rollers would give, the mounting is called wrong
STRONG_YAW = 2.0          # above, the yaw authority is as unusual as below 1/2
MEANING = ("that is the rim speed in yaw, over the yaw rate times the wheels' distance from their middle; about 1 "
           "is usual")
ILL_CONDITIONED = 100.0   # rim speeds for one direction this many times those for another


@dataclass(frozen=True)
class Geometry:
    """The diagnosis."""

    dof: int
    rank: int
    singular_values: list[float]
    condition: float                      # largest over smallest singular value; inf when the rank is short
    yaw_authority: float
    mirrored_yaw_authority: float | None  # with every mecanum roller angle negated; None without such wheels
    not_driven: list[str]
    words: list[str] = field(default_factory=list)


def diagnose(subject: Subject) -> Geometry:
    """Everything about the geometry of one vehicle."""
    length = float(spread_m(wheel_positions_m(subject)))
    allowed = _allowed_motions(subject, length)
    rows = _rim_rows(subject, subject.matrices.wheel_rows, length) @ allowed
    values, undriven = _null_motions(rows, allowed)
    rank = allowed.shape[1] - len(undriven)
    authority = float(yaw_authority_of(rows, allowed))
    mirrored = _mirrored_authority(subject, length, allowed)
    condition = float(condition_of(rows))
    not_driven = [motion_words(motion, subject, length) for motion in undriven]
    result = Geometry(allowed.shape[1], rank, [float(v) for v in values], condition, authority, mirrored, not_driven)
    result.words.extend(_words(subject, result, allowed, length))
    return result


def wheel_positions_m(subject: Subject) -> np.ndarray:
    """Wheel centres in the body frame [m], one row each."""
    wheels = subject.vehicle.wheel
    return np.array([[wheels[i].x_m, wheels[i].y_m] for i in range(subject.wheel_count)]).reshape(-1, 2)


def _body_of_nu(subject: Subject, length: float) -> np.ndarray:
    """Diagonal: (v_ξ, v_η, ℓ θ') = scale · ν."""
    radius = float(subject.model.wheel_radius_m)
    return np.array([radius, radius, length / subject.matrices.lambda_yaw])


def _rim_rows(subject: Subject, wheel_rows: np.ndarray, length: float) -> np.ndarray:
    """R_i Ξ_i against (v_ξ, v_η, ℓ θ')."""
    return subject.radii_m()[:, None] * wheel_rows / _body_of_nu(subject, length)


def _allowed_motions(subject: Subject, length: float) -> np.ndarray:
    """Orthonormal columns of (v_ξ, v_η, ℓ θ') that the constraints allow, as the core found them."""
    columns = subject.allowed_columns * _body_of_nu(subject, length)[:, None]
    return np.linalg.svd(columns, full_matrices=False)[0]


def _null_motions(rows: np.ndarray, allowed: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Singular values, and the allowed motions that rotate no wheel."""
    if len(rows) == 0:
        return np.zeros(0), list(np.eye(3) @ allowed.T if allowed.shape[1] == 3 else allowed.T)
    _, values, right = np.linalg.svd(rows)
    padded = np.zeros(allowed.shape[1])
    padded[: len(values)] = values[: allowed.shape[1]]
    null = padded <= RANK_TOLERANCE * max(padded[0], 1e-300)
    return padded, _tidied(allowed @ right[null].T)


def _tidied(columns: np.ndarray) -> list[np.ndarray]:
    """The same space by vectors with as many zeros as possible, so that words for them are simple."""
    work = columns.T.copy()
    for k in range(len(work)):
        pivot = int(np.argmax(np.abs(work[k])))
        work[k] /= work[k, pivot]
        for other in range(len(work)):
            if other != k:
                work[other] -= work[other, pivot] * work[k]
    return list(work)


def _mirrored_authority(subject: Subject, length: float, allowed: np.ndarray) -> float | None:
    """The yaw authority if every mecanum roller angle had the other sign."""
    vehicle, core = subject.vehicle, subject.core
    roller = core.lib.LACONIC_WHEEL_ROLLER
    other: Any = core.ffi.new("laconic_vehicle *", vehicle[0])
    leaning = 0
    for i in range(subject.wheel_count):
        wheel = other.wheel[i]
        if wheel.kind == roller and abs(np.cos(wheel.roller_rad)) > 1e-3:
            wheel.roller_rad = -wheel.roller_rad
            leaning += 1
    if leaning == 0:
        return None
    return float(yaw_authority_of(_rim_rows(subject, core.matrices(other).wheel_rows, length) @ allowed, allowed))


def motion_words(motion: np.ndarray, subject: Subject, length: float) -> str:
    """(v_ξ, v_η, ℓ θ') as words: a direction, or a turning motion about a point of the body."""
    along, across, yaw = motion / np.abs(motion).max()
    if abs(yaw) < 1e-9:
        return direction_words(along, across)
    yaw_rate = yaw / length
    centre_m = (float(subject.model.com_x_m) - across / yaw_rate, float(subject.model.com_y_m) + along / yaw_rate)
    x, y = (0.0 if abs(metres) < 1e-9 * length else metres for metres in centre_m)
    if abs(along) < 1e-9 and abs(across) < 1e-9:
        return "turning about the centre of mass"
    return f"turning about the body's point ({x:.3g}, {y:.3g}) m"


def direction_words(along: float, across: float) -> str:
    """A direction of travel in the body frame."""
    if abs(across) < 1e-9 * abs(along):
        return "moving straight along x"
    if abs(along) < 1e-9 * abs(across):
        return "moving straight along y"
    return f"moving straight at {np.degrees(np.arctan2(across, along)):.1f}° from x"


def _words(subject: Subject, found: Geometry, allowed: np.ndarray, length: float) -> list[str]:
    """The diagnosis in sentences."""
    words = [_freedom_words(subject, allowed, length)]
    if subject.wheel_count == 0:
        return [*words, "There are no wheels: nothing drives or brakes the body but outer forces."]
    if found.not_driven:
        words.append(f"The wheels neither drive nor feel {' and '.join(found.not_driven)}.")
    else:
        words.append(f"Every motion that is possible rotates at least one wheel, {_reach_words(subject)}.")
    if np.isfinite(found.condition) and found.condition > ILL_CONDITIONED:
        words.append(f"The geometry is lopsided: one direction needs {found.condition:.0f} times the rim speed of "
                     f"another.")
    if np.abs(allowed[2]).max() < 1e-12:
        return [*words, "The body cannot yaw."]
    return [*words, *_yaw_words(found)]


def _yaw_words(found: Geometry) -> list[str]:
    value, mirrored = found.yaw_authority, found.mirrored_yaw_authority
    if mirrored is not None and value < WEAK_YAW * mirrored:
        return [f"The mecanum rollers look mounted in the wrong diagonal: the yaw authority is {value:.3g}, with every "
                f"roller leaning the other way it would be {mirrored:.3g}. Swap the left and right wheels of each "
                "axle, or negate the roller angles if only the description is wrong."]
    if value < 1e-9:
        return ["The wheels cannot yaw the body (yaw authority 0): only an outer force does."]
    if value < 0.1:
        return [f"The wheels hardly yaw the body: the yaw authority is {value:.3g}, {MEANING}. Check the positions, "
                "axle and roller angles of the wheels."]
    words = f"The yaw authority is {value:.3g}"
    if value > STRONG_YAW:
        return [f"{words}, {MEANING}: yaw is strong but slow. Where that is not meant, check the positions and axle "
                "angles of the wheels."]
    if value < WEAK_YAW:
        return [f"{words}, {MEANING}: yaw is quick but weak. Where that is not meant, check the positions, axle and "
                "roller angles of the wheels."]
    return [f"{words}, {MEANING}."]


def _reach_words(subject: Subject) -> str:
    """What reaches the wheels: motors with a gain, motors with damping only, or none."""
    gain, damping = subject.of_wheels("motor_gain_Nm_per_V"), subject.of_wheels("motor_damping_Nms")
    if gain.any() and not (gain.all() and (damping.all() or not damping.any())):
        return (f"of which motors drive those of {np.count_nonzero(gain)} and damp those of "
                f"{np.count_nonzero(damping)} wheels")
    if gain.any():
        return "so the motors drive and damp all of them" if damping.any() else (
            "so the motors drive all of them; they damp none")
    if damping.any():
        return "so the motors' damping brakes all of them; no voltage drives them"
    return "but there are no motors to drive or damp it: only forces and axle torques do"


def _freedom_words(subject: Subject, allowed: np.ndarray, length: float) -> str:
    count = allowed.shape[1]
    if count == 3 and slips(subject.scene.vehicle):
        return "By slipping alone the body moves anywhere in the plane: three degrees of freedom."
    if count == 3:
        return "The body moves freely in the plane: three degrees of freedom."
    motions = " and ".join(motion_words(motion, subject, length) for motion in _tidied(allowed))
    return f"Constraints leave {count} degree{'s' if count > 1 else ''} of freedom: {motions}."
