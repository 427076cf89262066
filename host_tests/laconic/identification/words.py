"""What the runs can tell, in words: which parameters, which only together, and which run would tell them apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from laconic.core import Core
from laconic.identification.ground import base_of, evidence_of
from laconic.identification.parameter import Parameters
from laconic.identification.solve import Fit, jacobians_of
from laconic.logs import Log
from laconic.recorded_runs.rolling import path_of, rotations_of
from laconic.scene import Scene

WEAK = 1.0            # information in units of the prior: below it the runs say less than was known beforehand
PARTS = 0.35          # a parameter is named where its share in a combination is at least so much of the largest
SAMPLES, PERIOD_S = 200, 0.05
MOTIONS = {
    "straight ahead": (0.3, 0.0, 0.0), "sideways": (0.0, 0.3, 0.0), "rotation on the spot": (0.0, 0.0, 0.8),
    "a circle to the left": (0.3, 0.0, 0.4), "a circle to the right": (0.3, 0.0, -0.4),
    "a circle sideways": (0.0, 0.3, 0.4)}


def in_words(scene: Scene, found: Fit) -> list[str]:
    """Sentences; every number is computed."""
    words = [f"{name}: the runs do not tell it, so it stays nominal." for name in found.untold]
    size, directions = np.linalg.eigh(found.information)
    candidates = candidate_information(scene, found.parameters)
    for strength, direction in zip(size, directions.T, strict=True):
        if strength < WEAK:
            words.append(_weak(found, strength, direction, candidates))
    if found.weights.min() < 1.0:
        words.append(f"{int((found.weights < 1.0).sum())} of {len(found.weights)} runs are far worse than the others "
                     f"and count less (the least by a factor of {found.weights.min():.2g}).")
    if not words:
        words.append("The runs tell every parameter better than it was known before.")
    return words


def _weak(found: Fit, strength: float, direction: np.ndarray, candidates: dict[str, np.ndarray]) -> str:
    """One combination that only the prior holds."""
    change = found.parameters.factor @ direction
    share = change / np.array([np.hypot(p.prior_sd, p.shared_sd) for p in found.parameters.each])
    sign = np.sign(share[np.argmax(np.abs(share))])
    named = [f"{p.name} {'larger' if s * sign > 0.0 else 'smaller'}"
             for p, s in zip(found.parameters.each, share, strict=True) if abs(s) >= PARTS * np.abs(share).max()]
    known = f"{100.0 / np.sqrt(1.0 + strength):.0f} % of the uncertainty beforehand is left"
    best = max(candidates, key=lambda name: float(direction @ candidates[name] @ direction), default="")
    if len(named) == 1:
        what = f"{named[0].rpartition(' ')[0]}: the runs hardly tell it"
    else:
        what = f"{', '.join(named[:-1])} and {named[-1]} together: the runs hardly tell this from nothing"
    remedy = f"; {best} would tell most about it" if best and direction @ candidates[best] @ direction > 0.0 else ""
    return f"{what} ({known}){remedy}."


def candidate_information(scene: Scene, parameters: Parameters) -> dict[str, np.ndarray]:
    """What each motion that the wheels allow would say about the parameters, in z, all with one size of error."""
    core, found = scene.core(), {}
    is_held = bool(len(core.matrices(core.vehicle(scene.vehicle)).constraint_rows))
    for name, velocity in MOTIONS.items():
        if is_held and velocity[1] != 0.0:
            continue
        evidence = evidence_of(scene, [_motion(core, scene, np.array(velocity))], parameters)
        jacobian = jacobians_of(base_of(scene, parameters), parameters, evidence, np.zeros(len(parameters)))[0]
        found[name] = jacobian.T @ jacobian
    return found


def _motion(core: Core, scene: Scene, velocity: np.ndarray) -> Log:
    """A run at a constant velocity; one on the spot moves a little, so that its path has a length."""
    moved = np.tile(PERIOD_S * velocity, (SAMPLES, 1))
    if velocity[0] == velocity[1] == 0.0:
        moved[:, 0] = PERIOD_S * 0.02
    rotation = rotations_of(core, scene.vehicle, moved)
    angle = np.vstack([np.zeros(rotation.shape[1]), np.cumsum(rotation, axis=0)])
    return Log(Path("motion"), "motion", PERIOD_S * np.arange(SAMPLES + 1), wheel_angle_rad=angle,
               current_A=np.zeros((SAMPLES + 1, rotation.shape[1])), pose=path_of(moved, np.zeros(3)))
