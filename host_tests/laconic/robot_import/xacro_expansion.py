"""xacro files, expanded in a process of their own: their expressions may compute for ever, or fill the memory.

`python -m laconic.robot_import.xacro_expansion` is that process: {"path", "arguments", "packages"} as JSON on stdin,
{"text"}, {"package"} that is not there, or {"failure"} on stdout.
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import types
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from laconic.errors import BadInput
from laconic.robot_import.checked import words_of
from laconic.robot_import.meshes import MeshFiles

LONGEST_S = 20.0
MOST_BYTES = 2 * 2**30  # of memory


def expanded(path: Path, arguments: Mapping[str, str], packages: Mapping[str, Path]) -> str:
    """The URDF of a xacro file with `NAME:=VALUE` arguments; $(find NAME) looks beside and above the file."""
    asked = {"path": str(path), "arguments": dict(arguments),
             "packages": {name: str(folder) for name, folder in packages.items()}}
    try:
        done = subprocess.run([sys.executable, "-m", __name__], input=json.dumps(asked), capture_output=True, text=True,
                              encoding="utf-8", env=os.environ | {"PYTHONIOENCODING": "utf-8"}, timeout=LONGEST_S,
                              check=False)
    except subprocess.TimeoutExpired:
        raise BadInput(f"{path}: xacro does not come to an end within {LONGEST_S:g} s; mend the expression or macro "
                       "that goes on for ever") from None
    try:
        found: dict[str, str] = json.loads(done.stdout)
    except ValueError:
        raise BadInput(f"{path}: xacro cannot expand it: it ended with status {done.returncode}; mend the expression "
                       "or macro that takes so much memory") from None
    if name := found.get("package"):
        raise BadInput(f"{path}: package {name} is not beside or above the file; give --package {name}=FOLDER")
    if "failure" in found:
        raise BadInput(f"{path}: xacro cannot expand it: {found['failure']}")
    return found["text"]


def answer(asked: Mapping[str, Any]) -> dict[str, str]:
    """What the process finds."""
    import xacro

    files = MeshFiles(Path(asked["path"]), {name: Path(folder) for name, folder in asked["packages"].items()})
    _answer_for_ros(files)
    try:
        with contextlib.redirect_stdout(sys.stderr):  # xacro prints of what it does not know
            return {"text": xacro.process_file(asked["path"], mappings=asked["arguments"]).toxml()}
    except Exception as error:
        if files.asked_for:
            return {"package": files.asked_for}
        return {"failure": words_of(error)}


def _answer_for_ros(files: MeshFiles) -> None:
    """xacro asks ROS (`ament_index_python`) where a package is; without ROS it asks `files`."""
    name = "ament_index_python.packages"
    module = types.ModuleType(name)
    module.get_package_share_directory = files.package_for_xacro  # type: ignore[attr-defined]
    sys.modules.update({name: module, "ament_index_python": types.ModuleType("ament_index_python")})

def _bound_memory() -> None:
    """Where the system can; elsewhere the time alone is bounded."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))


if __name__ == "__main__":
    _bound_memory()
    print(json.dumps(answer(json.load(sys.stdin))))
