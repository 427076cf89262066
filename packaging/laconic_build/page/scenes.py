"""The scenes of the project for the page: as `laconic simulate` reads them, angles in rad, wheels in x and y."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from laconic import Scene, read_scene
from laconic.scene.hinges import file_has_hinges
from laconic.scene.table import read_toml

NOTHING: tuple[Any, ...] = (0, False, "", None, (), (0.0, 0.0))


OF_FILE = ("vehicle", "ground", "initial")
"""Tables of a scene with hinges that the npm package reads as they are."""


def scenes_in(folder: Path) -> list[dict[str, Any]]:
    """Every scene, sorted by its name; those of the paper are last."""
    found = [hinged_scene(path) if file_has_hinges(path) else plain_scene(path)
             for path in sorted(folder.glob("*.toml"))]
    return sorted(found, key=lambda scene: (scene["id"].startswith("paper"), scene["name"].casefold()))


def hinged_scene(path: Path) -> dict[str, Any]:
    """One scene with hinges by the tables of its file, in which a caster is a caster."""
    scene, given = read_scene(path), read_toml(path).plain()
    return {"id": path.stem, "name": scene.name, "source": scene.source,
            **{key: given[key] for key in OF_FILE if key in given}, **driven(scene)}


def driven(scene: Scene) -> dict[str, Any]:
    """What drives a scene, for how long, and by what."""
    return {"input": [plain_input(each) for each in scene.inputs],
            "run": {"duration_s": scene.run.duration_s, "step_s": scene.run.step_s, "method": scene.run.method}}


def plain_scene(path: Path) -> dict[str, Any]:
    """One scene by the keys of its file; what is 0 or absent is left out where that means the same."""
    scene = read_scene(path)
    vehicle = dict(scene.vehicle)
    ground = vehicle.pop("ground", None)
    wheels = [plain_wheel(wheel) for wheel in vehicle.pop("wheel")]
    supports = vehicle.pop("support")
    tables = {key: shortened(value) if isinstance(value, dict) else value for key, value in vehicle.items()}
    plain: dict[str, Any] = {
        "id": path.stem, "name": scene.name, "source": scene.source,
        "vehicle": shortened(tables) | {"wheel": wheels} | ({"support": supports} if supports else {})}
    if ground:
        plain["ground"] = ground
    if initial := shortened(dataclasses.asdict(scene.initial)):
        plain["initial"] = initial
    return plain | driven(scene)


def plain_wheel(wheel: dict[str, Any]) -> dict[str, Any]:
    """A wheel by the keys of a scene; what a wheel usually has is left out."""
    circuit = ("driven", "open", "shorted")[wheel["motor_circuit"]]
    left_out = {"motor_circuit", *(["driven"] if wheel["driven"] else []), *([] if wheel["locked"] else ["locked"])}
    kept = {key: value for key, value in wheel.items() if key not in left_out}
    return kept | ({} if circuit == "driven" else {"motor_circuit": circuit})


def plain_input(given: Any) -> dict[str, Any]:
    """One `[[input]]`."""
    keys = ("amplitude", "frequency_Hz", "phase_rad") if given.kind == "sine" else ("t_s", "value")
    return {"signal": given.signal, "kind": given.kind} | {key: getattr(given, key) for key in keys}


def shortened(table: dict[str, Any]) -> dict[str, Any]:
    """Without what is 0 or absent."""
    return {key: value for key, value in table.items() if value not in NOTHING}
