"""A whole identification: fit, judgement on other runs, and on each session that was left out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from laconic.errors import BadInput
from laconic.robot.identify.controller import FoundController, controller_of
from laconic.robot.identify.evidence import MEASURE, errors_of, evidence_of, kind_of
from laconic.robot.identify.ground import base_of, need_currents
from laconic.robot.identify.parameter import Parameters
from laconic.robot.identify.solve import Fit, fit
from laconic.robot.identify.words import in_words, with_errors
from laconic.robot.identify.words_of_errors import of_errors
from laconic.robot.logs import Log
from laconic.robot.logs.log import remarks_of
from laconic.robot.replay.measures import RunErrors
from laconic.robot.replay.missed_wraps import fitting
from laconic.robot.replay.predicted import predict
from laconic.scene import Scene
from laconic.scene.speed_controller import SpeedController

LEFT_OUT = ("session", "run")


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


def identify(scene: Scene, logs: Sequence[Log], parameters: Parameters, *, judge: Sequence[Log] = (),
             leave_out: str | None = None, with_controller: bool = False,
             advance: Callable[..., None] = lambda *_, **__: None) -> Study:
    """Fits, then judges; BadInput where the logs cannot be of this vehicle or say nothing about it."""
    runs, others = (fitting(scene, given) for given in (logs, judge))
    need_currents(parameters, runs, scene)
    found = _fit(scene, runs, parameters)
    advance()
    controller = controller_of(runs) if with_controller else None
    fitted = fitted_scene(scene, found)
    left = _left_out(scene, runs, parameters, found, leave_out, advance, with_controller) if leave_out else []
    study = Study(scene, runs, found, in_words(scene, found, runs), errors_of(scene, runs, parameters),
                  errors_of(fitted, runs, parameters), left, errors_of(fitted, others, parameters) if others else [],
                  errors_of(scene, others, parameters) if others else [], controller,
                  MEASURE[kind_of(runs, parameters)])
    return replace(study, words=[*remarks_of([*runs, *others]), *with_errors(study.words, of_errors(study, others))])


def fitted_scene(scene: Scene, found: Fit) -> Scene:
    """The scene with the values found."""
    return replace(scene, vehicle=found.parameters.vehicle(base_of(scene, found.parameters), found.values))


def parts(logs: Sequence[Log], leave_out: str) -> list[list[Log]]:
    """What is left out together: the runs of each session, or each run."""
    if leave_out == "run":
        return [[log] for log in logs]
    folders = dict.fromkeys(log.path.resolve().parent for log in logs)
    return [[log for log in logs if log.path.resolve().parent == folder] for folder in folders]


def _fit(scene: Scene, logs: Sequence[Log], parameters: Parameters, start: Fit | None = None) -> Fit:
    return fit(base_of(scene, parameters), parameters, evidence_of(scene, logs, parameters), start)


def _left_out(scene: Scene, logs: Sequence[Log], parameters: Parameters, found: Fit, leave_out: str,
              advance: Callable[..., None], with_controller: bool) -> list[RunErrors]:
    apart = parts(logs, leave_out)
    if len(apart) < 2:
        raise BadInput(f"--leave-out {leave_out}: there is one {leave_out} only; give logs of several")
    by_path: dict[object, RunErrors] = {}
    for part in apart:
        rest = [log for log in logs if log not in part]
        fitted = fitted_scene(scene, _fit(scene, rest, parameters, found))
        errors = errors_of(fitted, part, parameters)
        if with_controller:
            errors = _with_wheel_speeds(fitted, rest, part, errors)
        by_path.update({log.path: each for log, each in zip(part, errors, strict=True)})
        advance()
    return [by_path[log.path] for log in logs]


def _with_wheel_speeds(fitted: Scene, rest: Sequence[Log], part: Sequence[Log],
                       errors: Sequence[RunErrors]) -> list[RunErrors]:
    """With those in closed loop, through the speed controller that the other runs give."""
    scene = replace(fitted, speed_controller=SpeedController(**controller_of(rest).values()))
    return [replace(each, wheel_speed_error=looped.wheel_speed_error)
            for each, (_, looped) in zip(errors, predict(scene, part, "set-speeds"), strict=True)]
