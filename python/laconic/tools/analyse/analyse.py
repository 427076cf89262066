"""The analysis of a scene for the command and for programs: which subject it is about, and its parts."""

from __future__ import annotations

from collections.abc import Sequence

from laconic.core.given import finite_number, one_of, several
from laconic.errors import BadInput, shown
from laconic.scene import Scene, check_scene
from laconic.scene.ground import check_ideal_ground
from laconic.tools.analyse.findings import Study, StudyOptions
from laconic.tools.analyse.from_core import Subject, rolling_subject, subject_of
from laconic.tools.analyse.parts import GEOMETRY, PARTS
from laconic.tools.analyse.study import study


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
    check_scene(scene)
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
