"""What the errors before and after a fit say: a poor fit, a session that widens intervals, a failed judgement."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from laconic.logs import Log
from laconic.recorded_runs.measures import RunErrors, grand_mean, session_means

if TYPE_CHECKING:
    from laconic.identification.study import Study

POOR = 0.02           # path error that wheels which roll do not leave
HARDLY = 0.9          # of the nominal error: a fit that leaves more has explained little
FAR_WORSE = 2.5       # times the median of the other sessions


def of_errors(study: Study, judged: Sequence[Log]) -> list[str]:
    """Sentences; none where there is nothing to warn of."""
    return [*_fit(study), *_sessions(study.fitted), *_same_runs(study.logs, judged), *failures(study)]


def failures(study: Study) -> list[str]:
    """Where the values found are worse than the nominal ones on runs that they were not fitted to."""
    found = []
    for what, nominal, after in (("the runs to judge", study.judged_nominal, study.judged),
                                 ("the runs left out of the fit", study.nominal, study.left_out)):
        before, now = _path(nominal), _path(after)
        if after and now > before:
            found.append(f"On {what} the values found are worse than the nominal ones: path error {_percent(now)} "
                         f"instead of {_percent(before)}. Do not use them for such runs.")
    return found


def _fit(study: Study) -> list[str]:
    before, after = _path(study.nominal), _path(study.fitted)
    if not len(study.found.parameters) or not after > POOR:
        return []
    what = f"The fit is poor: a path error of {_percent(after)} is left of {_percent(before)}"
    if after > HARDLY * before:
        what += ", so what is free hardly explains it"
    return [f"{what}. Wheels that roll leave less than {_percent(POOR)}: look at the order, signs and gear in the map, "
            "at the place of the marker (--free place), or at slip ([ground] with --free drag)."]


def _sessions(errors: Sequence[RunErrors]) -> list[str]:
    """Sessions that fit far worse than the others: all intervals are wider for them."""
    means = [each for each in session_means(errors) if each.path_error is not None]
    values = np.array([each.path_error for each in means])
    found = []
    for index, mean in enumerate(means):
        others = np.delete(values, index)
        if len(others) and values[index] > FAR_WORSE * np.median(others):
            share = np.sqrt(np.mean(others**2) / np.mean(values**2))
            found.append(f"Session {mean.session} fits far worse than the others ({_percent(values[index])}, they "
                         f"{_percent(float(np.median(others)))}) and widens every interval: without it the size of the "
                         f"errors were {share:.2g} of what it is. Find what is different there, or leave it out.")
    return found


def _same_runs(logs: Sequence[Log], judged: Sequence[Log]) -> list[str]:
    fitted = {log.path.resolve() for log in logs}
    same = [log.path.name for log in judged if log.path.resolve() in fitted]
    return [f"{len(same)} of the {len(judged)} runs to judge are runs of the fit ({same[0]}): that judges nothing. "
            "Give others, or take --leave-out."] if same else []


def _path(errors: Sequence[RunErrors]) -> float:
    value = grand_mean(errors).path_error if errors else None
    return float("nan") if value is None else value


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %"
