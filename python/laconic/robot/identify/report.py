"""The result of an identification as text and as numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.robot.identify.evidence import SAID
from laconic.robot.identify.study import Study
from laconic.robot.logs.log import counted
from laconic.robot.replay.measures import RunErrors, grand_mean
from laconic.robot.replay.rolled_paths import error_table

MOST_DIGITS = 12      # of the ends of an interval


def as_text(study: Study) -> str:
    """A report in Markdown."""
    lines = [f"# {study.scene.name}, from {counted(len(study.logs), 'run')}", "",
             "| parameter | nominal | found | 95 % interval | prior ± |", "| --- " * 5 + "|", *_rows(study),
             *_controller_rows(study), "",
             *(f"* {word}" for word in study.words), "", *_summary(study), ""]
    for title, errors in (("Fitted on", study.fitted), ("Left out", study.left_out), ("Judged", study.judged)):
        if errors:
            lines += [f"## {title}", "", *error_table(errors), ""]
    return "\n".join(lines)


def interval(value: float, half: float) -> str:
    """Both ends, with at least two digits that show where they differ."""
    size = max(abs(value - half), abs(value + half))
    digits = 6 if not 0.0 < half < size else int(np.clip(np.ceil(np.log10(size / half)) + 2, 6, MOST_DIGITS))
    return f"{value - half:.{digits}g} … {value + half:.{digits}g}"


def _rows(study: Study) -> list[str]:
    found = study.found
    return [f"| {p.name} [{p.unit or '–'}] | {p.nominal:.6g} | {value:.6g} | {interval(value, half)} | "
            f"{np.hypot(p.prior_sd, p.shared_sd):.2g} |"
            for p, value, half in zip(found.parameters.each, found.values, found.half_widths, strict=True)]


def _controller_rows(study: Study) -> list[str]:
    return [] if study.controller is None else [
        f"| {name} | – | {value:.6g} | {interval(value, half)} | – |"
        for name, value, half in study.controller.rows()]


def _summary(study: Study) -> list[str]:
    rows = [("nominal, on the runs of the fit", study.nominal), ("fitted, on the same runs", study.fitted),
            ("left out of the fit", study.left_out), ("nominal, on the runs to judge", study.judged_nominal),
            ("fitted, on the runs to judge", study.judged)]
    if (other := study.without_slip) is not None:
        rows += [("rolling without slip, on the runs of the fit", other.fitted),
                 ("rolling without slip, left out of the fit", other.left_out),
                 ("rolling without slip, on the runs to judge", other.judged)]
    what, factor, unit = SAID[study.measure]
    lines = [f"| {what}, mean over sessions | {unit} |", "| --- | --- |"]
    return lines + [f"| {name} | {factor * mean_error(errors, study.measure):.3f} |" for name, errors in rows if errors]


def judgement(study: Study) -> list[str]:
    """The summary as lines of text."""
    head, _, *rows = (line.strip("| ").replace(" | ", ": ") for line in _summary(study))
    return [head, *(f"  {row}" for row in rows)]


def mean_error(errors: list[RunErrors], measure: str) -> float:
    """Over the sessions; NaN where no log tells it."""
    value = getattr(grand_mean(errors), measure) if errors else None
    return float("nan") if value is None else float(value)


def _without_slip(study: Study) -> list[tuple[str, list[RunErrors]]]:
    other = study.without_slip
    return [] if other is None else [("rolling", other.fitted), ("rolling_left_out", other.left_out),
                                     ("rolling_judged", other.judged)]


def as_numbers(study: Study) -> dict[str, Any]:
    """For JSON; `runs` are those to judge, or those of the fit where there are none."""
    found = study.found
    parameters = [{"name": p.name, "path": p.path, "unit": p.unit, "nominal": p.nominal, "value": float(value),
                   "low": float(value - half), "high": float(value + half),
                   "prior_sd": float(np.hypot(p.prior_sd, p.shared_sd))}
                  for p, value, half in zip(found.parameters.each, found.values, found.half_widths, strict=True)]
    if study.controller is not None:
        parameters += [{"name": name, "path": f"speed_controller.{name}", "value": value, "low": value - half,
                        "high": value + half} for name, value, half in study.controller.rows()]
    means = {name: grand_mean(errors).as_json() for name, errors in (
        ("nominal", study.nominal), ("fitted", study.fitted), ("left_out", study.left_out), ("judged", study.judged),
        ("judged_nominal", study.judged_nominal), *_without_slip(study)) if errors}
    return {"scene": str(study.scene.path), "parameters": parameters, "nominal_kept": list(found.untold),
            "words": study.words, "means": means, "runs": [e.as_json() for e in study.judged or study.fitted],
            "left_out": [each.as_json() for each in study.left_out]}
