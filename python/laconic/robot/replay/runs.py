"""A set of recorded runs: some to fit on, the others to judge."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from laconic.errors import BadInput
from laconic.robot.logs import Log, gather_logs
from laconic.robot.logs.log import remarks_of
from laconic.robot.replay.compare import Comparison, compare
from laconic.robot.replay.friction import MODELS, Friction, fit
from laconic.robot.replay.log import recording_of
from laconic.robot.replay.measures import RunErrors, all_errors
from laconic.robot.replay.missed_wraps import fitting
from laconic.robot.replay.rolling import rolling_of
from laconic.tools.analyse.from_core import Subject


@dataclass
class Replay:
    """Models fitted on some runs, and their predictions of the others."""

    subject: Subject
    fitted_on: list[str]
    models: list[Friction]
    comparisons: list[Comparison]
    shown: Comparison               # the run of the picture, predicted from end to end
    skipped: list[str] = field(default_factory=list)
    errors: list[RunErrors] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)   # what was left out of the files, or filled in

    def judged(self) -> list[Comparison]:
        """The runs that were not fitted on; all of them when there are no others."""
        others = [c for c in self.comparisons if c.recording.name not in self.fitted_on]
        return others or self.comparisons


def gather(given: Sequence[Path], fit_on: tuple[Path, ...],
           map_path: Path | None = None) -> tuple[list[Log], list[str], list[str]]:
    """(all runs, names of those to fit on, files of folders that are no runs)."""
    logs, skipped = gather_logs(given, map_path)
    known = {log.stem for log in logs}
    extra = gather_logs([path for path in fit_on if path.stem not in known], map_path)[0] if set(
        path.stem for path in fit_on) - known else []
    names = [path.stem for path in fit_on] or [log.stem for log in logs[::2]]
    return [*logs, *extra], names, [path.name for path in skipped]


def compare_all(subject: Subject, logs: list[Log], fit_names: list[str], skipped: list[str],
                advance: Callable[..., None]) -> Replay:
    """Fits, then compares run by run."""
    runs = [recording_of(log) for log in logs]
    if runs[0].wheel_angle_rad.shape[1] != subject.wheel_count:
        raise BadInput(f"{subject.scene.path}: has {subject.wheel_count} wheels, the column map "
                       f"{runs[0].wheel_angle_rad.shape[1]}; give the scene of the recorded robot")
    if np.linalg.matrix_rank(subject.matrices.wheel_rows) < 3:
        raise BadInput(f"{subject.scene.path}: its wheel speeds do not determine its motion; replay needs wheels "
                       "that drive all three directions")
    logs = fitting(subject.scene, logs)
    fitted_on = [recording for recording in runs if recording.name in fit_names]
    models = [fit(subject, fitted_on, model) for model in MODELS]
    comparisons = []
    for recording in runs:
        comparisons.append(compare(subject, recording, models))
        advance(1, what=recording.name)
    others = [recording for recording in runs if recording.name not in fit_names] or runs
    shown = compare(subject, others[0], models, whole=True)
    advance(1, what="drawing")
    return Replay(subject, fit_names, models, comparisons, shown, skipped, rolled_errors(subject, logs, comparisons),
                  remarks_of(logs))


def rolled_errors(subject: Subject, logs: list[Log], comparisons: list[Comparison]) -> list[RunErrors]:
    """Paths by pure rolling; wheel speeds and steady currents by the ideal model, which is the first."""
    rolling = rolling_of(subject.core, subject.scene.vehicle, subject.scene.path)
    rows = all_errors(logs, (rolling.path(log) for log in logs))
    ideal = [c.predictions[0] for c in comparisons]
    return [replace(row, wheel_speed_error=p.transient_error_share, current_error_A=p.steady_error_A)
            for row, p in zip(rows, ideal, strict=True)]
