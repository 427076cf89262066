"""What the runs can tell, in words: which parameters, which only together, and which run would tell them apart.

Then what the errors before and after a fit say: a poor fit, a session that widens intervals, a failed judgement.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from laconic.core import Core
from laconic.robot.identify.evidence import SAID, evidence_of, kind_of, like
from laconic.robot.identify.ground import base_of
from laconic.robot.identify.motion import ELECTRIC, inputs_of, stepping
from laconic.robot.identify.parameter import Parameters
from laconic.robot.identify.solve import Fit, jacobians_of
from laconic.robot.identify.steered_evidence import SteeredEvidence, motions, sizes_of
from laconic.robot.logs import Log
from laconic.robot.replay.held_wheels import hold
from laconic.robot.replay.measures import RunErrors, grand_mean, path_length, session_means
from laconic.robot.replay.rolling import path_of, rotations_of
from laconic.robot.replay.steady_currents import axles_of
from laconic.scene import Scene
from laconic.scene.ground import slips

if TYPE_CHECKING:
    from laconic.robot.identify.study import Study

WEAK = 1.0            # information in units of the prior: below it the runs say less than was known beforehand
PARTS = 0.35          # a parameter is named where its share in a combination is at least so much of the largest
TELLS_ALL = "The runs tell every parameter better than it was known before."
LEAST_LEFT = 1e-15     # of the uncertainty beforehand: sums in double precision know no less
HELPS = 0.9           # of the uncertainty: a run that leaves more is no advice
SAMPLES, PERIOD_S = 200, 0.05
MOTIONS = {
    "straight ahead": (0.3, 0.0, 0.0), "straight sideways": (0.0, 0.3, 0.0), "rotation on the spot": (0.0, 0.0, 0.8),
    "a circle to the left": (0.3, 0.0, 0.4), "a circle to the right": (0.3, 0.0, -0.4),
    "a circle sideways": (0.0, 0.3, 0.4)}


def in_words(scene: Scene, found: Fit, runs: Sequence[Log], advises: bool = True) -> list[str]:
    """Sentences; every number is computed. `runs`: those of the fit, as the next one will be of their kind; `advises`:
    which one would tell most."""
    assert found.asked is not None and found.asked_information is not None
    size, directions = np.linalg.eigh(found.information)
    weak = [each for each in zip(size, directions.T, strict=True) if each[0] < WEAK]
    candidates = candidate_information(scene, found, runs) if advises and (weak or found.untold) else {}
    words = [_untold(name, found, candidates) for name in found.untold]
    hint = _hint(found, runs)
    words += [_weak(found, strength, direction, candidates, hint) for strength, direction in weak]
    words += [f"{name}: lies at the bound of what is possible, {value:.4g}; its interval means little."
              for name, value in _at_bounds(found)]
    if found.structure.is_found:
        words.append(_structured(found))
    if found.weights.min() < 1.0:
        words.append(f"{int((found.weights < 1.0).sum())} of {len(found.weights)} runs are far worse than the others "
                     f"and count less (the least by a factor of {found.weights.min():.2g}).")
    return words or [TELLS_ALL]


def with_errors(words: Sequence[str], errors: Sequence[str]) -> list[str]:
    """Errors first, as a poor fit makes the other sentences doubtful; they replace the one that all is well."""
    return [*errors, *(word for word in words if word != TELLS_ALL or not errors)]


def _at_bounds(found: Fit) -> list[tuple[str, float]]:
    names = found.parameters.at_bounds(found.values)
    return [(p.name, float(v)) for p, v in zip(found.parameters.each, found.values, strict=True) if p.name in names]


def _structured(found: Fit) -> str:
    """Errors that are no chance."""
    return (f"Neighbouring stretches of a run err alike (correlation {found.structure.likeness:.2g}), which chance "
            "does not explain: the model lacks something, and errors repeat. The intervals are therefore built from "
            f"longer blocks, too, {_widened(found.structure.widening)}.")


def _widened(factor: float) -> str:
    return f"which made them up to {factor:.2g} times as wide" if factor > 1.05 else "which are hardly wider"


def _untold(name: str, found: Fit, candidates: dict[str, np.ndarray]) -> str:
    """A parameter that stays nominal, and the run that would tell it."""
    assert found.asked is not None
    index = [p.name for p in found.asked.each].index(name)
    remedy = advice(found, found.asked.factor[index] / np.linalg.norm(found.asked.factor[index]), candidates)
    reason = remedy or ("; nor would a run of this kind, whatever its motion" if candidates else "")
    return f"{name}: the runs do not tell it, so it stays nominal{reason}."


def _hint(found: Fit, runs: Sequence[Log]) -> str:
    """What no other motion would mend: other sensors would."""
    assert found.asked is not None
    if any(p.group in ELECTRIC for p in found.asked.each):
        return ("; voltages tell forces in units of each other alone: take one of these out of --free, or record "
                "currents and leave the electric ones out")
    return "; a gyro tells no lengths: record a true pose" if kind_of(runs, found.asked) == "turn" else ""


def _weak(found: Fit, strength: float, direction: np.ndarray, candidates: dict[str, np.ndarray], hint: str) -> str:
    """One combination that only the prior holds."""
    change = found.parameters.factor @ direction
    share = change / np.array([np.hypot(p.prior_sd, p.shared_sd) for p in found.parameters.each])
    sign = np.sign(share[np.argmax(np.abs(share))])
    named = [f"{p.name} {'larger' if s * sign > 0.0 else 'smaller'}"
             for p, s in zip(found.parameters.each, share, strict=True) if abs(s) >= PARTS * np.abs(share).max()]
    known = f"{100.0 / np.sqrt(1.0 + max(0.0, strength)):.0f} % of the uncertainty beforehand is left"
    if len(named) == 1:
        what = f"{named[0].rpartition(' ')[0]}: the runs hardly tell it"
    else:
        what = f"{', '.join(named[:-1])} and {named[-1]} together: the runs hardly tell this from nothing"
    return f"{what} ({known}){advice(found, _in_asked(found, change), candidates) or hint}."


def _in_asked(found: Fit, change: np.ndarray) -> np.ndarray:
    """A change of the parameters found as a direction in the z of all that were asked for."""
    assert found.asked is not None
    names = [p.name for p in found.asked.each]
    whole = np.zeros(len(names))
    whole[[names.index(p.name) for p in found.parameters.each]] = change
    z = np.linalg.solve(found.asked.factor, whole)
    z /= np.linalg.norm(z)
    return z


def advice(found: Fit, direction: np.ndarray, candidates: dict[str, np.ndarray]) -> str:
    """The motion after which least uncertainty in this direction of z is left, whatever the other parameters are.

    The inverse of the whole information does that: what a run says about a parameter counts only as far as no other
    parameter that is free could say the same.
    """
    assert found.asked_information is not None
    now = found.asked_information + np.eye(len(direction))

    def left(more: np.ndarray) -> float:
        return max(float(direction @ np.linalg.solve(now + more, direction)), LEAST_LEFT)  # rounding may go below 0

    before = left(np.zeros_like(now))
    best = min(candidates, key=lambda name: left(candidates[name]), default="")
    after = np.sqrt(left(candidates[best]) / before) if best else 1.0
    if after > HELPS:
        return ""
    return f"; one more run, {best}, would tell most about it and leave {100.0 * after:.0f} % of what is uncertain now"


def candidate_information(scene: Scene, found: Fit, runs: Sequence[Log]) -> dict[str, np.ndarray]:
    """What one more session of each motion that the wheels allow would say about all that was asked, in z.

    Its error has the size of that of the runs in metres, not as a share of its path: a run on the spot is not seen more
    sharply for being short.
    """
    assert found.asked is not None
    if scene.has_hinges:
        return _of_hinges(scene, found, runs)
    core, parameters, information = scene.core(), found.asked, {}
    z = _z_of_found(found)
    base, vehicle = base_of(scene, parameters), parameters.vehicle(base_of(scene, parameters), parameters.values(z))
    is_held = bool(len(core.matrices(core.vehicle(scene.vehicle)).constraint_rows))
    for name, velocity in MOTIONS.items():
        if (is_held and velocity[1] != 0.0) or (kind_of(runs, parameters) == "turn" and velocity[2] == 0.0):
            continue
        log = _candidate(scene, vehicle, parameters, np.array(velocity), runs)
        evidence = evidence_of(scene, [log], parameters)
        jacobian = jacobians_of(base, parameters, evidence, z)[0]
        information[name] = jacobian.T @ jacobian * (_length(log) / _usual_length(runs) / found.scale) ** 2
    return information


def _of_hinges(scene: Scene, found: Fit, runs: Sequence[Log]) -> dict[str, np.ndarray]:
    assert found.asked is not None
    parameters, z, information = found.asked, _z_of_found(found), {}
    base = base_of(scene, parameters)
    sizes = sizes_of(SteeredEvidence(scene, base, runs).errors(parameters.vehicle(base, parameters.values(z))))
    for name, log in motions(scene, parameters.vehicle(base, parameters.values(z)), runs).items():
        jacobian = jacobians_of(base, parameters, SteeredEvidence(scene, base, [log], sizes), z)[0]
        information[name] = jacobian.T @ jacobian / found.scale**2
    return information


def _z_of_found(found: Fit) -> np.ndarray:
    """The values found, in the z of all that were asked for; those that stay nominal are 0."""
    assert found.asked is not None
    values = dict(zip((p.name for p in found.parameters.each), found.values, strict=True))
    off = np.array([values.get(p.name, p.nominal) - p.nominal for p in found.asked.each])
    return np.linalg.solve(found.asked.factor, off) if len(off) else off


def _candidate(scene: Scene, vehicle: dict[str, object], parameters: Parameters, velocity: np.ndarray,
               runs: Sequence[Log]) -> Log:
    """A run of the kind that was recorded: driven to and fro by voltages, or held at a velocity."""
    if kind_of(runs, parameters) == "motion":
        inputs = inputs_of(scene, runs, [p.group for p in parameters.each])
        return stepping(scene.core(), vehicle, velocity, SAMPLES * PERIOD_S, inputs)
    return like(runs, _motion(scene.core(), vehicle, velocity, runs[0]), float(velocity[2]))


def _length(log: Log) -> float:
    return 1.0 if log.pose is None else path_length(log.time_s[log.seen], log.pose[log.seen])


def _usual_length(runs: Sequence[Log]) -> float:
    return float(np.median([_length(log) for log in runs]))


def _motion(core: Core, vehicle: dict[str, object], velocity: np.ndarray, like: Log) -> Log:
    """A run at a constant velocity; one on the spot moves a little, so that its path has a length."""
    moved = np.tile(PERIOD_S * velocity, (SAMPLES, 1))
    if velocity[0] == velocity[1] == 0.0:
        moved[:, 0] = PERIOD_S * 0.02
    rotation = rotations_of(core, vehicle, moved)
    angle = np.vstack([np.zeros(rotation.shape[1]), np.cumsum(rotation, axis=0)])
    log = Log(Path("motion"), "motion", PERIOD_S * np.arange(SAMPLES + 1), wheel_angle_rad=angle,
              pose=path_of(moved, np.zeros(3)), pose_point=like.pose_point)
    return log if like.current_A is None or not slips(vehicle) else _with_currents(core, vehicle, log)


def _with_currents(core: Core, vehicle: dict[str, object], log: Log) -> Log:
    """The steady currents that the vehicle itself would take."""
    axles, held = axles_of(core, vehicle), hold(core, vehicle, log)
    if axles is None:
        return log
    steady = axles.current_A(held.load_Nm[len(held.load_Nm) // 2:].mean(axis=0), held.speed_rad_per_s[-1])
    return Log(log.path, log.map_name, log.time_s, wheel_angle_rad=log.wheel_angle_rad, pose=log.pose,
               pose_point=log.pose_point, current_A=np.tile(steady, (len(log.time_s), 1)))


POOR = {"path_error": 0.02, "wheel_speed_error": 0.1}  # what a good model does not leave
REMEDIES = {
    "path_error": "Wheels that roll leave less than {}: look at the order, signs and gear in the map, at the place of "
                  "the marker (--free place), or at slip ([ground] with --free drag). `laconic replay` with this map "
                  "tries signs, order and units.",
    "friction": "Real floors seldom let more be said by this law; look at the loads (--free centre-of-mass, "
                "wheel-friction), and trust no prediction beyond the directions and speeds of these runs.",
    "wheel_speed_error": "A good model leaves less than {}: look at the order, signs and units in the map, at dry "
                         "friction ([ground] axle_friction_Nm), or at limits of the supply ([vehicle.drive])."}
HARDLY = 0.9          # of the nominal error: a fit that leaves more has explained little
FAR_WORSE = 2.5       # times the median of the other sessions


def of_errors(study: Study, judged: Sequence[Log]) -> list[str]:
    """Sentences; none where there is nothing to warn of."""
    return [*_of_fit(study), *_of_sessions(study), *_same_runs(study.logs, judged), *failures(study)]


def failures(study: Study) -> list[str]:
    """Where the values found are worse than the nominal ones on runs that they were not fitted to."""
    found, (name, _, _) = [], SAID[study.measure]
    for what, nominal, after in (("the runs to judge", study.judged_nominal, study.judged),
                                 ("the runs left out of the fit", study.nominal, study.left_out)):
        before, now = _mean(study, nominal), _mean(study, after)
        if after and now > before:
            found.append(f"On {what} the values found are worse than the nominal ones: {name} "
                         f"{_said(study, now)} instead of {_said(study, before)}. Do not use them for such runs.")
    return found


def _of_fit(study: Study) -> list[str]:
    before, after = _mean(study, study.nominal), _mean(study, study.fitted)
    if not after > POOR.get(study.measure, np.inf):
        return []
    name, limit = SAID[study.measure][0], _said(study, POOR[study.measure])
    what = f"The fit is poor: of {_said(study, before)} {name} {_said(study, after)} are left"
    if after > HARDLY * before:
        what += ", so what is free hardly explains it"
    slipping = any(p.path.startswith("ground.") for p in study.found.parameters.each)
    return [f"{what}. {REMEDIES['friction' if slipping else study.measure].format(limit)}"]


def _of_sessions(study: Study) -> list[str]:
    """Sessions that fit far worse than the others: all intervals are wider for them."""
    means = [each for each in session_means(study.fitted) if getattr(each, study.measure) is not None]
    values = np.array([getattr(each, study.measure) for each in means])
    found = []
    for index, mean in enumerate(means):
        others = np.delete(values, index)
        if len(others) and values[index] > FAR_WORSE * np.median(others):
            share = np.sqrt(np.mean(others**2) / np.mean(values**2))
            found.append(f"Session {mean.session} fits far worse than the others ({_said(study, values[index])}, they "
                         f"{_said(study, float(np.median(others)))}) and widens every interval: without it the size of "
                         f"the errors were {share:.2g} of what it is. Find what is different there, or leave it out.")
    return found


def _same_runs(logs: Sequence[Log], judged: Sequence[Log]) -> list[str]:
    fitted = {log.path.resolve() for log in logs}
    same = [log.path.name for log in judged if log.path.resolve() in fitted]
    return [f"{len(same)} of the {len(judged)} runs to judge are runs of the fit ({same[0]}): that judges nothing. "
            "Give others, or take --leave-out."] if same else []


def _mean(study: Study, errors: Sequence[RunErrors]) -> float:
    value = getattr(grand_mean(errors), study.measure) if errors else None
    return float("nan") if value is None else float(value)


def _said(study: Study, value: float) -> str:
    _, factor, unit = SAID[study.measure]
    return f"{factor * value:.2g} {unit}"
