"""The analysis of a scene: what may be asked, and the study of all parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from laconic.core.given import finite_number, one_of, several
from laconic.errors import BadInput, shown
from laconic.scene import Scene, check_scene
from laconic.scene.ground import check_ideal_ground
from laconic.tools.analyse import GEOMETRY, PARTS
from laconic.tools.analyse.bifurcation_part import bifurcation_part
from laconic.tools.analyse.findings import Study, StudyOptions
from laconic.tools.analyse.free_part import free_part, steady_part
from laconic.tools.analyse.from_core import Subject, rolling_subject, subject_of
from laconic.tools.analyse.geometry import diagnose
from laconic.tools.analyse.motions import straight_columns
from laconic.tools.analyse.speeds import ROUNDING, without_rest
from laconic.tools.analyse.traction import study as study_traction

# ---- Whether the motions that a user asks for are possible: constraints forbid a differential drive to go
# sideways.

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


# ---- The whole analysis of one scene, part after part.

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


# ---- The analysis of a scene for the command and for programs: which subject it is about, and its parts.

def chosen_subject(scene: Scene, parts: Sequence[str], at_s: float = 0.0) -> Subject:
    """The vehicle under the inputs of one instant; only the geometry is that of any ground."""
    if set(parts) <= {GEOMETRY}:
        return rolling_subject(scene, at_s)
    check_ideal_ground(scene, "analyse", f"; laconic analyse --only {GEOMETRY} takes this one, too")
    return subject_of(scene, at_s)


def analyse(scene: Scene, parts: Sequence[str] = PARTS, *, at_s: float = 0.0) -> Study:
    """What `laconic analyse` finds: a `Study` with a member for each part, and sentences about each in `words`.

    `parts`: of "geometry", "free", "steady", "bifurcation", "traction"; all of them by default, which takes seconds.
    `at_s`: the inputs of this instant are held [s]. What a simulation with the core does not confirm is in `failures`.
    Raises BadInput for an unknown part, and for a scene whose ground or drive has no such motions.
    """
    if check_scene(scene).has_hinges:
        raise BadInput(f"{scene.path}: {scene.hinges[0].place}: laconic.analyse has the parts of vehicles without "
                       "hinges; use study_hinges of laconic.tools.analyse.hinged")
    if (given := several(parts)) is None:
        what = "one text" if isinstance(parts, str) else "no list"
        raise BadInput(f"parts: {shown(parts)} is {what}; give a list, such as [{shown(GEOMETRY)}]")
    if not 0.0 <= finite_number("at_s", at_s) <= scene.run.duration_s:
        raise BadInput(f"at_s: {at_s:g} s lies outside the run; give 0 to {scene.run.duration_s:g} s")
    for part in given:
        one_of("parts", part, PARTS)
    if not (chosen := tuple(part for part in PARTS if part in given)):
        raise BadInput(f"parts: is empty; give one or more of {', '.join(PARTS)}")
    return study(chosen_subject(scene, chosen, at_s), StudyOptions(chosen), lambda share, part: None)
