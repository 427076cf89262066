"""Robust nonlinear least squares with a prior, and 95 % intervals that do not trust the residuals to be independent.

Evidence gives for each run a residual whose sum of squares is the run's squared error. Every session counts as one
observation, its runs share that: what a model leaves out (floor, marker, load) repeats in all runs of a session, so
more of them tell less than more sessions. The error's size σ is estimated along with the parameters; a run whose error
is more than OUTLIER times the median counts as Huber's function has it. With J the weighted Jacobian in z,

    H = JᵀJ/σ² + 1        covariance of z = H⁻¹ (S/σ⁴ + 1) H⁻¹

where S is the covariance of the score Jᵀr. Its parts, which the evidence names, are errors of single stretches of a
run, not residuals, which a path has summed. Where neighbouring stretches err alike, sums over longer blocks take their
place (identification.structure).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from scipy.optimize import least_squares
from scipy.special import stdtrit  # the quantile of Student's t; scipy.stats takes long to load

from laconic.robot.identify.parameter import Parameters, Vehicle
from laconic.robot.identify.structure import Structure, block_sums, likeness_of, unexplained

CONFIDENCE = 0.95
OUTLIER = 3.0
MOST_ROUNDS = 12
FAR_FROM_SETTLED = 0.2
ROUGHLY_SETTLED = 0.01
SETTLED = 1e-3       # relative change of σ
SAME_WEIGHT = 0.02
BEYOND = 3.0         # times the floor of the stretches' errors: what is less is sampling and rounding
SMALLEST_SCALE = 1e-9
STEP = 1e-4          # of z, for derivatives
UNTOLD = 0.99        # a parameter whose sd is more than this share of the prior's is not told by the runs


class Evidence(Protocol):
    """What runs say about parameters."""

    @property
    def sessions(self) -> Sequence[str]:
        """Of each run."""

    @property
    def directions(self) -> float:
        """Independent components of a residual at one instant."""

    @property
    def difference(self) -> float:
        """Step of z for derivatives by differences; 0: residuals are exact, as small a one as numbers allow."""

    def residuals(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Of each run: numbers whose sum of squares is the run's squared error."""

    def errors(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Of each run: the errors of its stretches one after the other, stretches × components."""

    def scores(self, vehicle: Vehicle, jacobians: list[np.ndarray]) -> list[np.ndarray]:
        """Of each run: the independent parts of Jᵀr, one row each."""


@dataclass(frozen=True)
class Fit:
    """The values found, and how well the runs tell them."""

    parameters: Parameters
    values: np.ndarray
    covariance: np.ndarray          # of the values
    information: np.ndarray         # JᵀJ/σ² in z: what the runs say, in units of the prior
    half_widths: np.ndarray         # of the 95 % intervals
    scale: float                    # σ, of the run's error
    weights: np.ndarray             # of each run by Huber, 1: whole
    structure: Structure            # whether neighbouring stretches err alike
    untold: tuple[str, ...] = ()    # names of parameters that stay nominal
    asked: Parameters | None = None             # those that were free, with what the runs say about all of them
    asked_information: np.ndarray | None = None


def fit(base: dict[str, Any], parameters: Parameters, evidence: Evidence,
        start: Fit | Mapping[str, float] | None = None) -> Fit:
    """The parameters that the runs tell; the others stay nominal to the digit. `start`: a fit to begin from."""
    untold: tuple[str, ...] = ()
    asked, information = parameters, None
    while True:
        found = _fit(base, parameters, evidence, _start(parameters, start))
        information = found.information if information is None else information
        found = replace(found, asked=asked, asked_information=information)
        share = told_share(found)
        lost = tuple(p.name for p, s in zip(parameters.each, share, strict=True) if s > UNTOLD)
        untold, parameters = untold + lost, parameters.without(lost)
        if not len(parameters):
            nothing = np.zeros((0, 0))
            return replace(found, parameters=parameters, values=np.zeros(0), half_widths=np.zeros(0),
                           covariance=nothing, information=nothing, untold=untold)
        if not lost:
            return replace(found, untold=untold)


def told_share(found: Fit) -> np.ndarray:
    """Standard deviation of each parameter after the runs, over that before."""
    inner = np.linalg.inv(found.information + np.eye(len(found.parameters)))
    factor = found.parameters.factor
    share: np.ndarray = np.sqrt(np.diag(factor @ inner @ factor.T) / np.diag(found.parameters.covariance))
    return share


def values_by_name(start: Fit | Mapping[str, float] | None) -> Mapping[str, float]:
    """Those of a fit, or as they are."""
    if isinstance(start, Fit):
        return dict(zip((p.name for p in start.parameters.each), start.values.tolist(), strict=True))
    return start or {}


def _start(parameters: Parameters, start: Fit | Mapping[str, float] | None) -> np.ndarray:
    """z of the values of another fit; nominal where it has none."""
    known = values_by_name(start)
    off = np.array([known.get(p.name, p.nominal) - p.nominal for p in parameters.each])
    return np.linalg.solve(parameters.factor, off) if len(parameters) else off


def _fit(base: dict[str, Any], parameters: Parameters, evidence: Evidence, z: np.ndarray) -> Fit:
    sessions = list(evidence.sessions)
    in_session = np.array([1.0 / sessions.count(name) for name in sessions])
    freedom = len(set(sessions)) * evidence.directions
    weights, counts = np.ones(len(sessions)), getattr(evidence, "counts_stretches", False)

    def stacked(z: np.ndarray, factors: np.ndarray) -> np.ndarray:
        blocks = evidence.residuals(parameters.vehicle(base, parameters.values(z)))
        return np.concatenate([block * factor for block, factor in zip(blocks, factors, strict=True)])

    least = _least_scale(evidence)
    scale = _scale(stacked(z, np.sqrt(in_session)), freedom, least)
    for _ in range(MOST_ROUNDS):
        factors = np.sqrt(in_session * weights)
        z = _least(base, parameters, evidence, z, factors, scale, stacked)
        blocks = evidence.residuals(parameters.vehicle(base, parameters.values(z)))
        weighted = np.concatenate([block * factor for block, factor in zip(blocks, factors, strict=True)])
        before, scale = scale, _scale(weighted, freedom, least)
        change, taken = abs(scale / before - 1.0), weights
        if change < FAR_FROM_SETTLED:  # before, what a strong prior leaves of a run is no outlier
            weights = _huber(np.array([np.sqrt(block @ block / (len(block) if counts else 1)) for block in blocks]))
        is_settled = change < (ROUGHLY_SETTLED if evidence.difference else SETTLED)
        if is_settled and np.abs(weights - taken).max() < SAME_WEIGHT:
            break
    return _judged(base, parameters, evidence, z, scale, in_session * weights, weights)


def _least(base: dict[str, Any], parameters: Parameters, evidence: Evidence, z: np.ndarray, factors: np.ndarray,
           scale: float, stacked: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """The least squares for given weights; where residuals carry a solver's tolerance, with differences beyond it."""
    def residual(z: np.ndarray) -> np.ndarray:
        return np.concatenate([stacked(z, factors) / scale, z])

    def jacobian(z: np.ndarray) -> np.ndarray:
        each = _ahead(base, parameters, evidence, z) if getattr(evidence, "counts_stretches", False) else jacobians_of(
            base, parameters, evidence, z)
        return np.vstack([*(j * f / scale for j, f in zip(each, factors, strict=True)), np.eye(len(z))])

    solved = least_squares(residual, z, ftol=1e-6, xtol=1e-5) if not evidence.difference else least_squares(
        residual, z, jac=jacobian, ftol=1e-4, xtol=1e-3, max_nfev=12)
    found: np.ndarray = solved.x
    return found


def _least_scale(evidence: Evidence) -> float:
    """σ that sampling and rounding of the logs make."""
    floor = getattr(evidence, "floor", None)
    return SMALLEST_SCALE if floor is None else max(SMALLEST_SCALE, floor.path_error)


def _scale(residual: np.ndarray, freedom: float, least: float) -> float:
    """σ; `least`: what sampling and rounding make, below which an error tells nothing."""
    return max(float(np.sqrt(residual @ residual / freedom)), least)


def _huber(errors: np.ndarray) -> np.ndarray:
    limit = OUTLIER * float(np.median(errors))
    weights: np.ndarray = np.minimum(1.0, limit / np.maximum(errors, 1e-300)) if limit > 0.0 else np.ones(len(errors))
    return weights


def _judged(base: dict[str, Any], parameters: Parameters, evidence: Evidence, z: np.ndarray, scale: float,
            squares: np.ndarray, weights: np.ndarray) -> Fit:
    """Intervals at the solution; `squares`: what multiplies each run's squared error."""
    jacobians = jacobians_of(base, parameters, evidence, z)
    count = len(parameters)
    information = sum((w * j.T @ j for w, j in zip(squares, jacobians, strict=True)), np.zeros((count, count)))
    vehicle = parameters.vehicle(base, parameters.values(z))
    parts = [w * s for w, s in zip(squares, evidence.scores(vehicle, jacobians), strict=True)]
    of_poses = getattr(evidence, "noise_scores", None) if getattr(evidence, "has_noise", False) else None
    noise = [w * s for w, s in zip(squares, of_poses(vehicle, jacobians) if of_poses else [], strict=bool(of_poses))]
    beside = np.vstack([*noise, np.zeros((0, count))]) / scale**2, np.eye(count)
    inverse = np.linalg.inv(information / scale**2 + np.eye(count))

    def covariance(rows: np.ndarray) -> np.ndarray:
        # a fit of whole paths does not make its stretches' errors smaller; sums over blocks it does
        correction = own if rows is single else len(rows) / max(len(rows) - count, 1)
        roots = np.vstack([np.sqrt(correction) / scale**2 * rows, *beside]) @ inverse.T @ parameters.factor.T
        found: np.ndarray = roots.T @ roots  # never below 0, however nearly two parameters are one
        return found

    def half_widths(rows: np.ndarray) -> np.ndarray:
        freedom = max(len(rows) - count, 1)
        widths: np.ndarray = stdtrit(freedom, 0.5 + CONFIDENCE / 2.0) * np.sqrt(np.diag(covariance(rows)))
        return widths

    single = np.concatenate(parts)
    numbers = sum(len(jacobian) for jacobian in jacobians)  # a fit of the stretches themselves makes these smaller
    own = numbers / max(numbers - count, 1) if getattr(evidence, "counts_stretches", False) else 1.0
    plain = widest = half_widths(single)
    likeness, is_found = likeness_of(_beyond_floor(evidence, vehicle, _unexplained(base, parameters, evidence, z)))
    is_found &= scale > BEYOND * _least_scale(evidence)  # rounding repeats, too
    if is_found:
        widest = np.max([plain, *(half_widths(each) for each in block_sums(parts, evidence.sessions, count))], axis=0)
    structure = Structure(likeness, is_found, float((widest / plain).max(initial=1.0)))
    return Fit(parameters, parameters.values(z), covariance(single), information / scale**2, widest, scale, weights,
               structure)


def _unexplained(base: dict[str, Any], parameters: Parameters, evidence: Evidence, z: np.ndarray) -> list[np.ndarray]:
    """The errors of stretches; where derivatives cost little, less what parameters near by would explain."""
    errors = evidence.errors(parameters.vehicle(base, parameters.values(z)))
    if evidence.difference or not len(parameters):
        return errors
    return unexplained(errors, differences(base, parameters, evidence.errors, z, STEP))


def _beyond_floor(evidence: Evidence, vehicle: Vehicle, errors: list[np.ndarray]) -> list[np.ndarray]:
    """The errors, 0 in components in which sampling and rounding of the log explain their size."""
    floor = getattr(evidence, "floor", None)
    if floor is None:
        return errors
    size = np.sqrt(np.mean(np.concatenate(evidence.errors(vehicle)) ** 2, axis=0))
    return [each * (size > BEYOND * floor.stretch) for each in errors]


def jacobians_of(base: dict[str, Any], parameters: Parameters, evidence: Evidence, z: np.ndarray) -> list[np.ndarray]:
    """Of each run's residual in z."""
    found = differences(base, parameters, evidence.residuals, z, evidence.difference or STEP)
    return found if len(parameters) else [np.zeros((1, 0))] * len(evidence.sessions)


def _ahead(base: dict[str, Any], parameters: Parameters, evidence: Evidence, z: np.ndarray) -> list[np.ndarray]:
    """The same by differences to one side, at half the cost: on the way to a solution that is enough."""
    here = evidence.residuals(parameters.vehicle(base, parameters.values(z)))
    columns = []
    for step in evidence.difference * np.eye(len(parameters)):
        there = evidence.residuals(parameters.vehicle(base, parameters.values(z + step)))
        columns.append([(a - b) / evidence.difference for a, b in zip(there, here, strict=True)])
    return [np.stack(each, axis=-1) for each in zip(*columns, strict=True)]


def differences(base: dict[str, Any], parameters: Parameters, of: Callable[[Vehicle], list[np.ndarray]],
                z: np.ndarray, width: float) -> list[np.ndarray]:
    """Derivatives in z, along a new last axis, of numbers of each run, by central differences."""
    columns: list[list[np.ndarray]] = []
    for index in range(len(parameters)):
        step = np.zeros(len(parameters))
        step[index] = width
        ahead, behind = (of(parameters.vehicle(base, parameters.values(z + s))) for s in (step, -step))
        columns.append([(a - b) / (2.0 * width) for a, b in zip(ahead, behind, strict=True)])
    return [np.stack(each, axis=-1) for each in zip(*columns, strict=True)]
