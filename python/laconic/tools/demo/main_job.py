"""The main job, scene by scene: same bits from all participants, errors against the reference, pictures.

The demo's picture of one scene: path, velocities, error against run time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from laconic.base.progress import Advance
from laconic.fmu import make_fmu
from laconic.pictures.plotting import (
    figure,
    mark_ground,
    plot_error_against_time,
    plot_path,
    plot_velocities,
    save,
    title,
)
from laconic.scene import Scene
from laconic.simulation import Trajectory, simulate, usual_signals
from laconic.tools.demo.rows import Rows, core_rows, difference, node_rows
from laconic.tools.demo.work import Point, Target, measure_all, target_of

LEAST_STEPS = 10_000
NODE_EVERY = 10   # steps a SYNC: the node answers 1,000 times in 10,000 steps
PARTICIPANTS = ("FMI 2", "FMI 3", "node")
STAGES = len(PARTICIPANTS) + 2


@dataclass
class SceneResult:
    """What the demo found out about one scene."""

    name: str
    file: str
    steps: int
    method: str
    same_bits: dict[str, str] = field(default_factory=dict)  # participant → "" or the first difference
    compared: dict[str, int] = field(default_factory=dict)   # participant → exchanges that were compared
    points: list[Point] = field(default_factory=list)
    floor: float = 0.0
    picture: str = ""
    log: dict[str, tuple[str, ...]] = field(default_factory=dict)  # participant → lines of its log
    no_slip: dict[str, Any] | None = None  # Grip.as_json; None: the scene has no data of the ground
    ground: str = ""                       # warning where the ground cannot provide the reactions

    @property
    def passed(self) -> bool:
        """Whether all participants gave the core's bits."""
        return not any(self.same_bits.values())

    def as_json(self) -> dict[str, Any]:
        """Machine-readable."""
        return {**asdict(self), "passed": self.passed}


def steps_of(scene: Scene) -> Scene:
    """The scene, continued with its last inputs where it is shorter than 10,000 steps."""
    if scene.steps() >= LEAST_STEPS:
        return scene
    return scene.with_run(duration_s=LEAST_STEPS * scene.run.step_s)


def rows_of(who: str, scene: Scene, folder: Path) -> Rows:
    """One participant's rows for the whole run."""
    if who == "node":
        return node_rows(scene, scene.steps(), NODE_EVERY)
    from laconic.tools.demo.fmu_rows import fmu_rows

    version = int(who[-1])
    fmu = make_fmu(scene, folder / f"{scene.path.stem}_fmi{version}.fmu", version=version)
    return fmu_rows(scene, fmu, scene.steps())


def run_scene(given: Scene, out: Path, moved: Advance) -> SceneResult:
    """Everything for one scene."""
    scene = steps_of(given)
    core = core_rows(scene, scene.steps())
    held = core if scene.inputs_on_grid().is_held else core_rows(scene, scene.steps(), hold=True)
    result = SceneResult(scene.name, str(scene.path), scene.steps(), scene.plant(scene.core()).chosen_method)
    with TemporaryDirectory() as folder:
        for who in PARTICIPANTS:
            moved(0, what=f"{scene.name}: {who}")
            found = rows_of(who, scene, Path(folder))
            result.same_bits[who] = difference(found, core if who == "node" else held, scene.wheel_count)
            result.compared[who] = len(found.ticks)
            if found.log:
                result.log[who] = found.log
            moved(1)
    moved(0, what=f"{scene.name}: reference, steps and methods")
    target: Target = target_of(scene)
    result.points, result.floor = measure_all(scene, target), target.floor
    moved(1, what=f"{scene.name}: picture")
    draw_scene(scene, result, out)
    moved(1)
    return result


def draw_scene(scene: Scene, result: SceneResult, out: Path) -> None:
    """Draws the scene's picture and adds the result about the ground."""
    picture = out / f"{scene.path.stem}.png"
    run = simulate(scene, usual_signals(scene))
    draw(run, result.points, result.floor, picture)
    result.picture = str(picture)
    if run.grip:
        result.no_slip, result.ground = run.grip.as_json(), run.grip.warning()


def draw(run: Trajectory, points: Sequence[Point], floor: float, path: Path) -> None:
    """Writes the picture."""
    picture = figure(13.0, 7.6)
    axes = picture.subplot_mosaic([["path", "velocities"], ["path", "error"]], width_ratios=(1.0, 1.35))
    title(picture, f"{run.steps} steps of {run.scene.run.step_s:g} s by {run.method}", run)
    plot_velocities(axes["velocities"], run)
    mark_ground(axes, run)
    plot_path(axes["path"], run)
    curves: dict[str, list[tuple[float, float]]] = {}
    for point in points:
        curves.setdefault(point.method, [])
        if point.error is not None and point.us_per_s is not None:
            curves[point.method].append((point.us_per_s, point.error))
    plot_error_against_time(axes["error"], curves, floor)
    save(picture, path)
