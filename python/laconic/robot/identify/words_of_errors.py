"""What the errors before and after a fit say: a poor fit, a session that widens intervals, a failed judgement."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from laconic.robot.identify.evidence import SAID
from laconic.robot.logs import Log
from laconic.robot.replay.measures import RunErrors, grand_mean, session_means

if TYPE_CHECKING:
    from laconic.robot.identify.study import Study

POOR = {"path_error": 0.02, "wheel_speed_error": 0.1}  # what a good model does not leave
REMEDIES = {
    "path_error": "Wheels that roll leave less than {}: look at the order, signs and gear in the map, at the place of "
                  "the marker (--free place), or at slip ([ground] with --free drag).",
    "friction": "Real floors seldom let more be said by this law; look at the loads (--free centre-of-mass, "
                "wheel-friction), and trust no prediction beyond the directions and speeds of these runs.",
    "wheel_speed_error": "A good model leaves less than {}: look at the order, signs and units in the map, at dry "
                         "friction ([ground] axle_friction_Nm), or at limits of the supply ([vehicle.drive])."}
HARDLY = 0.9          # of the nominal error: a fit that leaves more has explained little
FAR_WORSE = 2.5       # times the median of the other sessions


def of_errors(study: Study, judged: Sequence[Log]) -> list[str]:
    """Sentences; none where there is nothing to warn of."""
    return [*_fit(study), *_sessions(study), *_same_runs(study.logs, judged), *failures(study)]


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


def _fit(study: Study) -> list[str]:
    before, after = _mean(study, study.nominal), _mean(study, study.fitted)
    if not len(study.found.parameters) or not after > POOR.get(study.measure, np.inf):
        return []
    name, limit = SAID[study.measure][0], _said(study, POOR[study.measure])
    what = f"The fit is poor: of {_said(study, before)} {name} {_said(study, after)} are left"
    if after > HARDLY * before:
        what += ", so what is free hardly explains it"
    slipping = any(p.path.startswith("ground.") for p in study.found.parameters.each)
    return [f"{what}. {REMEDIES['friction' if slipping else study.measure].format(limit)}"]


def _sessions(study: Study) -> list[str]:
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
