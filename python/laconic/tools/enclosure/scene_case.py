"""A scene as a case of `laconic verify --enclose`."""

from __future__ import annotations

from laconic.scene import Scene
from laconic.simulation import RunRefused, simulate
from laconic.tools.enclosure.readings import check_enclosable
from laconic.tools.enclosure.study import Study, kinds_json, state_signals, study_of
from laconic.tools.verify.enclosed_result import EnclosedResult


def verify_scene_enclosed(scene: Scene, shown: bool = True) -> EnclosedResult:
    """Runs and encloses a scene at its rows; a step that the core refuses becomes the status."""
    check_enclosable(scene)
    try:
        run = simulate(scene, state_signals(scene.wheel_count), progress=shown)
    except RunRefused as refused:
        return EnclosedResult(scene.name, f"{refused.status}: {refused}")
    return scene_result(study_of(run, shown))


def scene_result(study: Study) -> EnclosedResult:
    """The result of a scene's study."""
    return EnclosedResult(study.run.scene.name, "ok", seconds=study.run.seconds,
                          own_constants=kinds_json(study.of_core), **kinds_json(study.of_file))
