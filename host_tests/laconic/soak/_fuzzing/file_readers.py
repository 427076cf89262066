"""The files whose readers are fuzzed: where good ones are, and how one is read and used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from laconic.errors import BadInput, ResultFails
from laconic.logs.column_map import MAPS
from laconic.logs.column_map import read_map as read_columns
from laconic.paths import SCENE_DIR, SOURCE_DIR
from laconic.play.map_file import read_map as read_joints
from laconic.play.map_join import join
from laconic.scene.scene import read_scene

OF_PLAY = SOURCE_DIR / "host_tests/tests/play"
DBC = "transporter.dbc"
STEPS = 3


@dataclass(frozen=True)
class FileTarget:
    """Good files to begin with, and what is done with a spoilt one: it raises BadInput, or nothing."""

    seeds: Callable[[], list[Path]]
    use: Callable[[Path], None]


def _use_scene(path: Path) -> None:
    """Reads, prepares, takes steps; a motion that is accepted is one of numbers."""
    scene = read_scene(path)
    if scene.run.tolerance is not None:
        return  # its step was found by runs
    core = scene.core()
    plant = scene.plant(core)
    try:
        plant.run(core.input(), STEPS)
    except BadInput:
        return
    pose = plant.pose
    values = [pose.x_m, pose.y_m, pose.heading_rad]
    if any(value != value or abs(value) == float("inf") for value in values):
        raise ResultFails(f"{path}: was accepted, and its motion is {values}")


def _use_columns(path: Path) -> None:
    read_columns(path)


def _use_joints(path: Path) -> None:
    join(read_joints(path, 2), OF_PLAY / DBC)


def _use_dbc(path: Path) -> None:
    join(read_joints(OF_PLAY / "transporter.toml", 2), path)


FILE_TARGETS = {
    "scenes": FileTarget(lambda: sorted(SCENE_DIR.glob("*.toml")), _use_scene),
    "column-maps": FileTarget(lambda: sorted(MAPS.glob("*.toml")), _use_columns),
    "dbc-maps": FileTarget(lambda: sorted(OF_PLAY.glob("transporter*.toml")), _use_joints),
    "dbc": FileTarget(lambda: sorted(OF_PLAY.glob("*.dbc")), _use_dbc),
}
