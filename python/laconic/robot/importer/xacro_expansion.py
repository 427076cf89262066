"""xacro files, expanded by the library `xacro`, bounded in time and memory: their expressions may compute anything."""

from __future__ import annotations

import sys
import types
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from laconic.errors import BadInput, nearest_of
from laconic.robot.importer.bounded import Library, bounded
from laconic.robot.importer.checked import words_of
from laconic.robot.importer.meshes import MeshFiles

XACRO = Library("xacro", "the expression, macro or include that goes on for ever")


def expanded(path: Path, arguments: Mapping[str, str], packages: Mapping[str, Path]) -> str:
    """The URDF of a xacro file with `NAME:=VALUE` arguments; $(find NAME) looks beside and above the file."""
    text: str = bounded(XACRO, _expand, path, dict(arguments), dict(packages))
    return text


def _expand(path: Path, arguments: dict[str, str], packages: dict[str, Path]) -> str:
    import xacro

    files, given = MeshFiles(path, packages), _Asked(arguments)
    _answer_for_ros(files)
    _keep_texts_of_yaml()
    try:
        text = str(xacro.process_file(str(path), mappings=given).toxml())
    except Exception as error:
        causes = _causes(error)
        if any(isinstance(each, MemoryError) for each in causes):
            raise MemoryError from None
        if name := files.asked_for:
            raise BadInput(f"{path}: package {name} is not beside or above the file; give --package {name}=FOLDER"
                           ) from None
        if any(isinstance(each, RecursionError) for each in causes):
            raise BadInput(f"{path}: xacro cannot expand it: a macro calls, or a file includes, itself without end; "
                           "mend it") from None
        raise BadInput(f"{path}: xacro cannot expand it: {words_of(error)}") from None
    for name in arguments:
        if name not in given.names:
            raise BadInput(f"--set {name}: {path} does not ask for an argument of this name; "
                           + (nearest_of(name, given.names) if given.names else "leave it out"))
    return text


class _Asked(dict[str, str]):
    """Arguments that note which `names` were asked for, by <xacro:arg> or $(arg …)."""

    def __init__(self, given: Mapping[str, str]):
        super().__init__(given)
        self.names: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.names.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.names.add(name)
        return super().__getitem__(name)


def _causes(error: BaseException) -> list[Any]:
    """The error and those that xacro has wrapped."""
    causes: list[Any] = [error]
    for each in causes:  # which grows meanwhile
        inner = getattr(each, "exc", None) or each.__cause__ or each.__context__
        if inner is not None and inner not in causes:
            causes.append(inner)
    return causes


def _keep_texts_of_yaml() -> None:
    """`load_yaml` takes the path of any file, whose text no message may show: it is to have keys, or to be a list."""
    import yaml

    load = yaml.safe_load

    def safe_load(stream: Any) -> Any:
        try:
            found = load(stream)
        except (yaml.YAMLError, UnicodeDecodeError):
            raise ValueError(f"load_yaml: {stream.name} is no YAML") from None
        if not isinstance(found, (dict, list)):
            raise ValueError(f"load_yaml: {stream.name} has no keys and is no list")
        return found

    yaml.safe_load = safe_load


def _answer_for_ros(files: MeshFiles) -> None:
    """xacro asks ROS (`ament_index_python`) where a package is; without ROS it asks `files`."""
    name = "ament_index_python.packages"
    module = types.ModuleType(name)
    module.get_package_share_directory = files.package_for_xacro  # type: ignore[attr-defined]
    sys.modules.update({name: module, "ament_index_python": types.ModuleType("ament_index_python")})
