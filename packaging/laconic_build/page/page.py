"""The page: its HTML with style, scenes, core and script put in.

The scenes of the project for the page: as `laconic simulate` reads them, angles in rad, wheels in x and y.
"""

from __future__ import annotations

import base64
import dataclasses
import gzip
import json
import re
from pathlib import Path
from typing import Any

from laconic import Scene, read_scene
from laconic.scene.hinges import file_has_hinges
from laconic.scene.table import read_toml
from laconic_build.page.bundle import bundle, read, without_types

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


MOST_BYTES = 445_000  # 400,000 and what slip on hinges costs: 27 kB of compressed core, 36 kB in base64, and its script


class TooLarge(Exception):
    """The page is larger than it promises to be."""


def binding_names(binding: Path) -> dict[str, Path]:
    """The names by which the page imports the npm package's modules."""
    inner = ("hinges", "hinge_friction", "hinge_inputs", "hinge_tables", "module", "scene")
    return {"laconic": binding / "index.js"} | {f"laconic/{name}": binding / f"{name}.js" for name in inner}


def module_text(path: Path) -> str:
    """A module as the page has it: without types, the core of a smaller size, which module.js understands."""
    text = read(path)
    if not path.name.endswith("wasm.js"):
        return without_types(text)
    return re.sub(r'"([A-Za-z0-9+/=]+)"', lambda found: f'"{packed(base64.b64decode(found[1]))}"', text)


def packed(content: bytes) -> str:
    """What gzip makes of it, in base64."""
    return base64.b64encode(gzip.compress(content, mtime=0)).decode("ascii")


def make_page(sources: Path, binding: Path, scenes: Path, native_hash: Path, out: Path) -> None:
    """Writes the one file."""
    facts = {"nativeHash": " ".join(native_hash.read_text().split()), "scenes": scenes_in(scenes)}
    marks = {
        "/* STYLE */": (sources / "style.css").read_text(encoding="utf-8"),
        "/* FACTS */": packed(json.dumps(facts, separators=(",", ":"), ensure_ascii=False).encode("utf-8")),
        "/* SCRIPT */": bundle(sources / "app/main.js", binding_names(binding), module_text),
    }
    text = (sources / "index.html").read_text(encoding="utf-8")
    for mark, put_in in marks.items():
        before, after = text.split(mark)
        text = before + put_in + after
    made = text.encode("utf-8")
    if len(made) > MOST_BYTES:
        raise TooLarge(f"{out.name} has {len(made)} bytes, {MOST_BYTES} at most")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_bytes(made)
