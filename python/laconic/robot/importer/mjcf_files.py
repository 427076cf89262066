"""Files that an MJCF model names: none is opened that lies outside the robot's folder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from laconic.errors import BadInput
from laconic.robot.importer.meshes import is_inside, own_folder
from laconic.robot.importer.xml_file import Element, bytes_of, root_of

OF_MESHES = ("meshdir", "assetdir")
FOLDERS = {"mesh": OF_MESHES, "hfield": OF_MESHES, "skin": OF_MESHES, "flexcomp": OF_MESHES,
           "texture": ("texturedir", "assetdir")}
MOST_FILES = 1000  # that include each other


def check_files(path: Path, packages: Mapping[str, Path]) -> None:
    """BadInput for a mesh, texture or included file that lies elsewhere; `packages`: folders that may be read, too."""
    inside = [own_folder(path), *packages.values()]
    models = {path.resolve(): path}
    for model in (waiting := [path]):  # which grows meanwhile
        for other in _check_model(path, model, inside):
            if other.is_file() and other.resolve() not in models and len(models) < MOST_FILES:
                models[other.resolve()] = other
                waiting.append(other)


def _check_model(path: Path, model: Path, inside: list[Path]) -> list[Path]:
    """One model with what it includes, all relative to its folder; returns the models that it attaches."""
    files, seen = [model], {model.resolve()}
    elements: list[Element] = []
    for file in files:  # which grows meanwhile
        root = root_of(file, bytes_of(file), "is no XML")
        elements += root.iter()
        for include in root.iter("include"):
            named = model.parent / include.get("file", "")
            _check(path, include, named, inside)
            if named.is_file() and named.resolve() not in seen and len(seen) < MOST_FILES:
                seen.add(named.resolve())
                files.append(named)
    options = {key: value for each in elements if each.tag == "compiler" for key, value in each.attrib.items()}
    for element in elements:
        for named in _named(model.parent, element, options):
            _check(path, element, named, inside)
    return [model.parent / each.get("file", "") for each in elements if each.tag == "model" and each.get("file")]


def _named(folder: Path, element: Element, options: Mapping[str, str]) -> Iterator[Path]:
    """The files that an element names."""
    base = next((options[key] for key in FOLDERS.get(element.tag, ()) if key in options), "")
    for key, value in element.attrib.items():
        if key.startswith("file") and value:
            yield folder / base / (Path(value).name if options.get("strippath") == "true" else value)


def _check(path: Path, element: Element, named: Path, inside: list[Path]) -> None:
    if not is_inside(named, inside):
        raise BadInput(f"{path}: <{element.tag}> {element.get('file', '')}: lies outside the robot's folder and is "
                       "not opened; --package NAME=FOLDER says where it may lie")
