"""A set of recorded runs: some to fit on, the others to judge."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from laconic.analysis.from_core import Subject
from laconic.errors import BadInput
from laconic.paths import exists
from laconic.recorded_runs.compare import Comparison, compare
from laconic.recorded_runs.friction import MODELS, Friction, fit
from laconic.recorded_runs.log import ColumnMap, Recording, read_log


@dataclass
class Replay:
    """Models fitted on some runs, and their predictions of the others."""

    subject: Subject
    fitted_on: list[str]
    models: list[Friction]
    comparisons: list[Comparison]
    shown: Comparison               # the run of the picture, predicted from end to end
    skipped: list[str] = field(default_factory=list)

    def judged(self) -> list[Comparison]:
        """The runs that were not fitted on; all of them when there are no others."""
        others = [c for c in self.comparisons if c.recording.name not in self.fitted_on]
        return others or self.comparisons


def natural(path: Path) -> list[object]:
    """Sorting key: numbers inside names by their value."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", path.name)]


def gather(given: Path, fit_on: tuple[Path, ...], columns: ColumnMap) -> tuple[list[Recording], list[str], list[str]]:
    """(all runs, names of those to fit on, files without the columns of the map)."""
    if not (exists(given) and given.is_dir()):
        runs, skipped = [read_log(given, columns)], list[str]()
    else:
        runs, skipped = _folder(given, columns)
    known = {run.name: run for run in runs}
    extra = [read_log(path, columns) for path in fit_on if path.stem not in known]
    if fit_on:
        names = [path.stem for path in fit_on]
    else:
        names = [run.name for run in runs[::2]] if len(runs) > 1 else [runs[0].name]
    return [*runs, *extra], names, skipped


def _folder(given: Path, columns: ColumnMap) -> tuple[list[Recording], list[str]]:
    """Every CSV file of a folder that has the wanted columns; the others are named."""
    runs, skipped = [], []
    for path in sorted(given.glob("*.csv"), key=natural):
        try:
            runs.append(read_log(path, columns))
        except BadInput as reason:
            if "has no column" not in str(reason):
                raise
            skipped.append(path.name)
    if not runs:
        raise BadInput(f"{given}: holds no CSV file with the columns of the map; give another folder, or --map")
    return runs, skipped


def compare_all(subject: Subject, runs: list[Recording], fit_names: list[str], skipped: list[str],
                advance: Callable[..., None]) -> Replay:
    """Fits, then compares run by run."""
    if runs[0].wheel_angle_rad.shape[1] != subject.wheel_count:
        raise BadInput(f"{subject.scene.path}: has {subject.wheel_count} wheels, the column map "
                       f"{runs[0].wheel_angle_rad.shape[1]}; give the scene of the recorded robot")
    if np.linalg.matrix_rank(subject.matrices.wheel_rows) < 3:
        raise BadInput(f"{subject.scene.path}: its wheel speeds do not determine its motion; replay needs wheels "
                       "that drive all three directions")
    fitting = [recording for recording in runs if recording.name in fit_names]
    models = [fit(subject, fitting, model) for model in MODELS]
    comparisons = []
    for recording in runs:
        comparisons.append(compare(subject, recording, models))
        advance(1, what=recording.name)
    others = [recording for recording in runs if recording.name not in fit_names] or runs
    shown = compare(subject, others[0], models, whole=True)
    advance(1, what="drawing")
    return Replay(subject, fit_names, models, comparisons, shown, skipped)
