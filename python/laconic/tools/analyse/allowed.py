"""Whether the motions that a user asks for are possible: constraints forbid a differential drive to go sideways."""

from __future__ import annotations

import numpy as np

from laconic.errors import BadInput
from laconic.tools.analyse.findings import StudyOptions
from laconic.tools.analyse.from_core import Subject
from laconic.tools.analyse.motions import straight_columns
from laconic.tools.analyse.speeds import ROUNDING, without_rest


def check(subject: Subject, options: StudyOptions) -> None:
    """BadInput when the constraints forbid a ν that was asked for; it names the nearest that they allow."""
    columns = subject.allowed_columns
    if options.start is not None:
        _fits("--start: the constraints forbid this ν", np.array(options.start), columns)
    if options.straight is not None:
        _fits("--straight: the constraints forbid this motion", np.array(options.straight), straight_columns(subject))


def _fits(refusal: str, nu: np.ndarray, columns: np.ndarray) -> None:
    size = float(np.abs(nu).max())
    nearest = columns @ np.linalg.lstsq(columns, nu, rcond=None)[0] if columns.size else np.zeros_like(nu)
    if np.abs(nearest - nu).max() > ROUNDING * max(1.0, size):
        shown = " ".join(f"{v:.6g}" for v in without_rest(nearest, size))
        raise BadInput(f"{refusal}; the nearest allowed one is {shown}")
