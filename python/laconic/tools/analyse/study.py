"""The whole analysis of one scene, part after part."""

from __future__ import annotations

from collections.abc import Callable

from laconic.tools.analyse.allowed import check
from laconic.tools.analyse.bifurcation_part import bifurcation_part
from laconic.tools.analyse.findings import Study, StudyOptions
from laconic.tools.analyse.free_part import free_part
from laconic.tools.analyse.from_core import Subject
from laconic.tools.analyse.geometry import diagnose
from laconic.tools.analyse.steady_part import steady_part
from laconic.tools.analyse.traction import study as study_traction


def study(subject: Subject, options: StudyOptions, advance: Callable[[float, str], None]) -> Study:
    """All parts of the options, one after another."""
    check(subject, options)
    result = Study(subject)
    share = 1.0 / len(options.parts)
    for part in options.parts:
        advance(0.0, part)
        if part == "geometry":
            result.geometry = diagnose(subject)
            result.words["geometry"] = list(result.geometry.words)
        elif part == "traction":
            result.traction = study_traction(subject)
            result.words["traction"] = list(result.traction.words)
        else:
            {"free": free_part, "steady": steady_part, "bifurcation": bifurcation_part}[part](result, options)
        advance(share, part)
    return result
