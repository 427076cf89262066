"""Branches of steady motions in a parameter, followed by arc length.

All steady motions of a parameter value are the roots n = ν3 of one polynomial (`steady`), so the branches are curves
in the plane (parameter, n): the followed curve cannot end in the middle, and roots found on a grid of parameter
values start every branch that exists there. Folds, branch points and Andronov–Hopf points are found on the way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from dataclasses import field as dataclass_field

import numpy as np
from numpy.polynomial import polynomial as poly
from scipy.optimize import brentq

from laconic.tools.analyse.cycle import HopfPoint, first_lyapunov, has_oscillating_pair
from laconic.tools.analyse.field import Field
from laconic.tools.analyse.speeds import without_rest
from laconic.tools.analyse.steady import SteadyMotion, classify, steady_at_yaw, steady_motions, steady_polynomial

FieldOf = Callable[[float], Field]


@dataclass
class Branch:
    """One curve of steady motions, in the order of its arc length."""

    parameter: list[float] = dataclass_field(default_factory=list)
    motion: list[SteadyMotion] = dataclass_field(default_factory=list)

    def nu(self) -> np.ndarray:
        """ν along the branch, one row per point; what rounding left beside its largest speed is zero."""
        return without_rest(np.array([motion.nu for motion in self.motion]))

    def stable(self) -> np.ndarray:
        """Where it is stable."""
        return np.array([motion.stability == "stable" for motion in self.motion])


@dataclass(frozen=True)
class Special:
    """A fold or a branch point."""

    kind: str
    parameter: float
    nu: np.ndarray


@dataclass
class Diagram:
    """All branches between two parameter values, with what happens on them."""

    branches: list[Branch]
    specials: list[Special]
    hopf: list[HopfPoint]


class Curve:
    """P(parameter, n) = 0 in scaled coordinates (u, v): parameter = low + spread·u, n = yaw_scale·v.

    Where straight motion n = 0 exists for every parameter value it is a factor of P; it is divided out and kept as a
    branch of its own, so that the curve followed is smooth where both cross.
    """

    def __init__(self, field_of: FieldOf, low: float, high: float, yaw_scale: float, straight: bool):
        self.field_of, self.low, self.spread = field_of, low, high - low
        self.yaw_scale, self.straight = yaw_scale, straight
        self._newest = float("nan"), np.zeros(0)

    def parameter(self, u: float) -> float:
        """Parameter value of the scaled coordinate u in [0, 1]."""
        return self.low + self.spread * u

    def coefficients(self, u: float) -> np.ndarray:
        """Of the polynomial in v, lowest first. The newest are kept: value and slopes at a point need the same."""
        if u != self._newest[0]:
            found = steady_polynomial(self.field_of(self.parameter(u))) * self.yaw_scale ** np.arange(4)
            self._newest = u, found[1:] if self.straight else found
        return self._newest[1]

    def value(self, point: np.ndarray) -> float:
        """The polynomial at a scaled point."""
        return float(poly.polyval(point[1], self.coefficients(point[0])))

    def by_yaw(self, point: np.ndarray, order: int = 1) -> float:
        """Its derivative in v."""
        return float(poly.polyval(point[1], poly.polyder(self.coefficients(point[0]), order)))

    def gradient(self, point: np.ndarray) -> np.ndarray:
        """By central differences in u: ∂P/∂parameter has no closed form."""
        step = np.array([1e-6, 0.0])
        by_parameter = (self.value(point + step) - self.value(point - step)) / 2e-6
        return np.array([by_parameter, self.by_yaw(point)])

    def correct(self, point: np.ndarray, tangent: np.ndarray) -> np.ndarray | None:
        """Newton across the tangent; None if it does not settle nearby."""
        start = point.copy()
        for _ in range(8):
            slope = np.vstack([self.gradient(point), tangent])
            try:
                step = np.linalg.solve(slope, -np.array([self.value(point), tangent @ (point - start)]))
            except np.linalg.LinAlgError:
                return None
            point = point + step
            if np.abs(step).max() < 1e-11:
                return point
        return point if np.abs(step).max() < 1e-8 else None

    def motion(self, point: np.ndarray) -> SteadyMotion | None:
        """The steady motion of a point, None where the linear system does not determine it."""
        field = self.field_of(self.parameter(point[0]))
        zeta = steady_at_yaw(field, self.yaw_scale * point[1])
        return None if zeta is None else classify(field, zeta)


def follow(curve: Curve, start: np.ndarray, direction: float, step: float, most: int = 600) -> list[np.ndarray]:
    """Points along the curve from a start, until the parameter leaves its interval or the branch closes."""
    points, tangent = [start], None
    while len(points) < most:
        slope = curve.gradient(points[-1])
        size = np.linalg.norm(slope)
        if size == 0.0:
            break
        along = np.array([-slope[1], slope[0]]) / size
        forward = np.sign(along[0]) * direction if tangent is None else np.sign(along @ tangent)
        along = along * (forward or 1.0)
        found = curve.correct(points[-1] + step * along, along)
        if found is None or np.linalg.norm(found - points[-1]) > 3.0 * step:
            break
        tangent = found - points[-1]
        points.append(found)
        if not -1e-9 <= found[0] <= 1.0 + 1e-9 or abs(found[1]) > 3.0:
            break
        if len(points) > 10 and np.linalg.norm(found - start) < 0.5 * step:
            break
    return points


def _covered(branches: list[list[np.ndarray]], point: np.ndarray, near: float) -> bool:
    """Whether a followed branch passes through the point already (measured to its chords)."""
    for points in branches:
        track = np.array(points)
        if len(track) < 2:
            continue
        first, chord = track[:-1], np.diff(track, axis=0)
        share = np.clip(((point - first) * chord).sum(axis=1) / np.maximum((chord**2).sum(axis=1), 1e-300), 0.0, 1.0)
        if np.linalg.norm(first + share[:, None] * chord - point, axis=1).min() < near:
            return True
    return False


def diagram(field_of: FieldOf, low: float, high: float, *, grid: int = 41, step: float = 0.01) -> Diagram:
    """All branches of steady motions for low ≤ parameter ≤ high."""
    values = np.linspace(low, high, grid)
    seeds = [(value, motion) for value in values for motion in steady_motions(field_of(value))]
    largest = max((abs(motion.nu[2]) for _, motion in seeds if motion.is_turning), default=0.0)
    straight = _always_straight(field_of, values)
    curve = Curve(field_of, low, high, largest if largest > 0.0 else 1.0, straight)
    tracks: list[list[np.ndarray]] = []
    for value, motion in seeds:
        point = np.array([(value - low) / (high - low), motion.nu[2] / curve.yaw_scale])
        if not (straight and not motion.is_turning) and not _covered(tracks, point, 0.2 * step):
            back = follow(curve, point, -1.0, step)
            tracks.append(back[::-1] + follow(curve, point, 1.0, step)[1:])
    if straight:
        tracks.insert(0, [np.array([u, 0.0]) for u in np.linspace(0.0, 1.0, 201)])
    return _read_all(curve, tracks)


def _always_straight(field_of: FieldOf, values: np.ndarray) -> bool:
    """Whether n = 0 solves the equation for every value of the parameter."""
    lowest, size = [], 0.0
    for value in values:
        field = field_of(value)
        r = field.decay_per_s.copy()
        r[field.dof :] = 1.0
        terms = field.yaw_row * field.forcing * np.array([r[1] * r[2], r[2] * r[0], r[0] * r[1]])
        lowest.append(abs(terms.sum()))
        size = max(size, float(np.abs(terms).max()), float(r.max() ** 2 * np.abs(field.forcing).max() * 1e-3))
    return max(lowest) <= 1e-10 * size


def _read_all(curve: Curve, tracks: list[list[np.ndarray]]) -> Diagram:
    """Stability along the tracks and what changes on them."""
    result = Diagram([], [], [])
    for number, track in enumerate(tracks):
        inside = [(point, curve.motion(point)) for point in track if -1e-9 <= point[0] <= 1.0 + 1e-9]
        kept = [(point, motion) for point, motion in inside if motion is not None]
        if not kept:
            continue
        branch = Branch([curve.parameter(point[0]) for point, _ in kept], [motion for _, motion in kept])
        result.branches.append(branch)
        points = [point for point, _ in kept]
        is_line = curve.straight and number == 0
        sums = [_pair_sum(motion.eigenvalues) for motion in branch.motion]
        for k in range(1, len(points)):
            if sums[k - 1] * sums[k] < 0.0:
                result.hopf += _hopf_between(curve, points[k - 1], points[k], is_line)
            if not is_line:
                result.specials += _fold_at(curve, points, k) + _crossing_between(curve, points[k - 1], points[k])
    return result


def _fold_at(curve: Curve, points: list[np.ndarray], k: int) -> list[Special]:
    """A fold near points[k], where the parameter reverses; Newton on P = ∂P/∂v = 0."""
    if k + 1 >= len(points) or (points[k][0] - points[k - 1][0]) * (points[k + 1][0] - points[k][0]) >= 0.0:
        return []
    point = points[k].copy()
    for _ in range(20):
        slope = curve.gradient(point)
        step = np.array([1e-6, 0.0])
        mixed = (curve.by_yaw(point + step) - curve.by_yaw(point - step)) / 2e-6
        matrix = np.array([slope, [mixed, curve.by_yaw(point, 2)]])
        try:
            move = np.linalg.solve(matrix, -np.array([curve.value(point), slope[1]]))
        except np.linalg.LinAlgError:
            break
        point = point + move
        if np.abs(move).max() < 1e-12:
            break
    motion = curve.motion(point)
    nu = np.array([np.nan, np.nan, curve.yaw_scale * point[1]]) if motion is None else motion.nu
    return [Special("fold", curve.parameter(point[0]), nu)]


def _crossing_between(curve: Curve, first: np.ndarray, second: np.ndarray) -> list[Special]:
    """Where a branch of turning motions crosses that of straight ones."""
    if not curve.straight or first[1] * second[1] > 0.0 or first[1] == second[1]:
        return []
    share = first[1] / (first[1] - second[1])
    u = first[0] + share * (second[0] - first[0])
    for _ in range(20):
        value, slope = curve.value(np.array([u, 0.0])), curve.gradient(np.array([u, 0.0]))[0]
        if slope == 0.0:
            break
        u -= value / slope
        if abs(value / slope) < 1e-13:
            break
    motion = curve.motion(np.array([u, 0.0]))
    return [] if motion is None else [Special("branch point", curve.parameter(u), motion.nu)]


def _hopf_between(curve: Curve, first: np.ndarray, second: np.ndarray, is_line: bool) -> list[HopfPoint]:
    """An Andronov–Hopf point between two neighbouring points of a branch, if there is one."""
    chord = second - first
    unit = chord / np.linalg.norm(chord)

    def at(share: float) -> np.ndarray:
        point = first + share * chord
        found = None if is_line else curve.correct(point, unit)
        return point if found is None else found

    def test(share: float) -> float:
        motion = curve.motion(at(share))
        return float("nan") if motion is None else _pair_sum(motion.eigenvalues)

    point = at(brentq(test, 0.0, 1.0, xtol=1e-12))
    parameter = curve.parameter(point[0])
    field, motion = curve.field_of(parameter), curve.motion(point)
    if motion is None or not has_oscillating_pair(field.jacobian(motion.zeta)):
        return []
    lyapunov, frequency = first_lyapunov(field, motion.zeta)
    return [HopfPoint(parameter, motion.nu, frequency, lyapunov)]


def _pair_sum(eigenvalues: np.ndarray) -> float:
    """Zero when two eigenvalues add up to zero: the product of their sums in pairs."""
    if len(eigenvalues) == 2:
        return float(eigenvalues.sum().real)
    if len(eigenvalues) != 3:
        return float("nan")
    a, b, c = eigenvalues
    return float(((a + b) * (b + c) * (c + a)).real)
