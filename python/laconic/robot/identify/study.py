"""A whole identification: fit, judgement on other runs, and on each session that was left out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from laconic.errors import BadInput
from laconic.robot.identify.controller import FoundController, controller_of
from laconic.robot.identify.evidence import MEASURE, errors_of, evidence_of, kind_of
from laconic.robot.identify.ground import OF_TREES, base_of, need_currents
from laconic.robot.identify.parameter import Parameters
from laconic.robot.identify.solve import Fit, fit, values_by_name
from laconic.robot.identify.steered import SLIPPING, with_measuring
from laconic.robot.identify.steered_evidence import SteeredEvidence
from laconic.robot.identify.words import in_words, of_errors, with_errors
from laconic.robot.logs import Log
from laconic.robot.logs.log import remarks_of, run_names
from laconic.robot.replay.measures import RunErrors
from laconic.robot.replay.missed_wraps import fitting
from laconic.robot.replay.predicted import predict
from laconic.robot.replay.steered_signals import Fitted, of_log
from laconic.scene import Scene
from laconic.scene.drives import SpeedController
from laconic.scene.ground import slips

LEFT_OUT = ("session", "run")


@dataclass(frozen=True)
class WithoutSlip:
    """The best fit of rolling without slip, by all that is free besides friction, on the same runs."""

    found: Fit
    fitted: list[RunErrors]
    left_out: list[RunErrors]
    judged: list[RunErrors]


@dataclass(frozen=True)
class Study:
    """The fit, and the errors of runs before and after."""

    scene: Scene
    logs: list[Log]
    found: Fit
    words: list[str]
    nominal: list[RunErrors]             # of the runs fitted on, with the scene as it was
    fitted: list[RunErrors]
    left_out: list[RunErrors]            # each judged by a fit without it and its like; empty: not asked for
    judged: list[RunErrors]              # other runs, with the fitted scene
    judged_nominal: list[RunErrors]
    controller: FoundController | None = None
    measure: str = "path_error"          # which of the errors the fit is about
    without_slip: WithoutSlip | None = None   # of a vehicle with hinges on ground with friction


def identify(scene: Scene, logs: Sequence[Log], parameters: Parameters, *, judge: Sequence[Log] = (),
             leave_out: str | None = None, with_controller: bool = False, whole: bool = False,
             advance: Callable[..., None] = lambda *_, **__: None) -> Study:
    """Fits, then judges; BadInput where the logs cannot be of this vehicle or say nothing about it. `whole`: by whole
    paths, for an audit of a vehicle with hinges, whose fit counts stretches otherwise."""
    runs, others = (fitting(scene, given) for given in (logs, judge))
    parameters = with_measuring(scene, [*runs, *others], parameters)
    need_currents(parameters, runs, scene)
    found = _fit(scene, runs, parameters, whole=whole)
    advance()
    controller = controller_of(runs) if with_controller else None
    fitted = fitted_scene(scene, found)
    left = _left_out(scene, runs, parameters, found, leave_out, advance, with_controller) if leave_out else []
    without = _without_slip(scene, runs, others, parameters, leave_out, advance)
    study = Study(scene, runs, found, in_words(scene, found, runs, not whole), errors_of(scene, runs, parameters),
                  errors_of(fitted, runs, parameters), left, errors_of(fitted, others, parameters) if others else [],
                  errors_of(scene, others, parameters) if others else [], controller,
                  MEASURE[kind_of(runs, parameters)], without)
    return replace(study, words=[*remarks_of([*runs, *others]), *with_errors(study.words, of_errors(study, others))])


def fitted_scene(scene: Scene, found: Fit) -> Scene:
    """The scene with the values found."""
    base = base_of(scene, found.asked or found.parameters)
    return replace(scene, vehicle=found.parameters.vehicle(base, found.values))


def parts(logs: Sequence[Log], leave_out: str) -> list[list[Log]]:
    """What is left out together: the runs of each session, or each run, with all of its parts."""
    if leave_out == "run":
        return [[log for log in logs if log.path == path] for path in dict.fromkeys(log.path for log in logs)]
    folders = dict.fromkeys(log.path.resolve().parent for log in logs)
    return [[log for log in logs if log.path.resolve().parent == folder] for folder in folders]


def _fit(scene: Scene, logs: Sequence[Log], parameters: Parameters, start: Fit | None = None,
         whole: bool = False) -> Fit:
    base, evidence = base_of(scene, parameters), evidence_of(scene, logs, parameters, whole)
    if isinstance(evidence, SteeredEvidence):
        begun = values_by_name(start) if start is not None else _near(scene, logs, parameters, evidence)
        evidence.sized(base, parameters, begun)
        return fit(base, parameters, evidence, begun)
    return fit(base, parameters, evidence, start)


def _near(scene: Scene, logs: Sequence[Log], parameters: Parameters, evidence: SteeredEvidence) -> Mapping[str, float]:
    """Where the fit of a steered vehicle begins; with friction, where rolling without slip has ended."""
    if evidence.difference:
        rolling = rigid_ground(scene), rolls_by(parameters)
        inside = {p.name: p.nominal + p.prior_sd for p in parameters.each if p.group in OF_TREES and p.nominal <= p.low}
        return {**inside, **values_by_name(_fit(rolling[0], logs, rolling[1]))}  # a bound is no place to begin
    return evidence.rough(base_of(scene, parameters), parameters)


def rolls_by(parameters: Parameters) -> Parameters:
    """What is free of rolling without slip."""
    return parameters.without([p.name for p in parameters.each if p.group in SLIPPING])


def rigid_ground(scene: Scene) -> Scene:
    """The scene on which no wheel slips."""
    vehicle = Fitted({key: value for key, value in scene.vehicle.items() if key != "ground"}, of_log(scene.vehicle))
    return replace(scene, vehicle=vehicle)


def _without_slip(scene: Scene, runs: Sequence[Log], others: Sequence[Log], parameters: Parameters,
                  leave_out: str | None, advance: Callable[..., None]) -> WithoutSlip | None:
    """None where wheels do not slip on hinges."""
    if not scene.has_hinges or not slips(base_of(scene, parameters)):
        return None
    rolling, free = rigid_ground(scene), rolls_by(parameters)
    found = _fit(rolling, runs, free)
    fitted = fitted_scene(rolling, found)
    left = _left_out(rolling, runs, free, found, leave_out, advance, False) if leave_out else []
    return WithoutSlip(found, errors_of(fitted, runs, free), left, errors_of(fitted, others, free) if others else [])


def _left_out(scene: Scene, logs: Sequence[Log], parameters: Parameters, found: Fit, leave_out: str,
              advance: Callable[..., None], with_controller: bool) -> list[RunErrors]:
    apart = parts(logs, leave_out)
    if len(apart) < 2:
        raise BadInput(f"--leave-out {leave_out}: there is one {leave_out} only; give logs of several")
    by_path: dict[tuple[Path, str], RunErrors] = {}
    names = {_key(log): name for log, name in zip(logs, run_names(logs), strict=True)}
    for part in apart:
        left = {_key(log) for log in part}
        rest = [log for log in logs if _key(log) not in left]
        fitted = fitted_scene(scene, _fit(scene, rest, parameters, found))
        errors = errors_of(fitted, part, parameters)
        if with_controller:
            errors = _with_wheel_speeds(fitted, rest, part, errors)
        by_path.update({_key(log): replace(each, run=names[_key(log)]) for log, each in zip(part, errors, strict=True)})
        advance()
    return [by_path[_key(log)] for log in logs]


def _key(log: Log) -> tuple[Path, str]:
    return log.path, log.part


def _with_wheel_speeds(fitted: Scene, rest: Sequence[Log], part: Sequence[Log],
                       errors: Sequence[RunErrors]) -> list[RunErrors]:
    """With those in closed loop, through the speed controller that the other runs give."""
    scene = replace(fitted, speed_controller=SpeedController(**controller_of(rest).values()))
    return [replace(each, wheel_speed_error=looped.wheel_speed_error)
            for each, (_, looped) in zip(errors, predict(scene, part, "set-speeds"), strict=True)]
