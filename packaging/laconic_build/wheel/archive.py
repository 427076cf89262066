"""The wheel itself, by setuptools: the same bytes from the same files on every machine and every day."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

EARLIEST = 315532800  # 1980-01-01, where the dates of zip archives begin
VERSION_ELSEWHERE = re.compile(r'^dynamic = \["version"\].*$', re.MULTILINE)
SETUP = """\
from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel

class Binary(Distribution):
    def has_ext_modules(self):
        return True

class Wheel(bdist_wheel):  # for every Python 3 (cffi loads the libraries), but for one platform
    def get_tag(self):
        return "py3", "none", {tag!r}

setup(distclass=Binary, cmdclass={{"bdist_wheel": Wheel}})
"""


def make_wheel(project: Path, files: Mapping[str, Path], licences: Mapping[str, str], *, version: str, tag: str,
               out: Path) -> Path:
    """Writes the wheel of these files (names in the wheel → files) for a platform into the folder `out`.

    `licences` are texts of what others wrote, by their names in dist-info.
    """
    with tempfile.TemporaryDirectory() as folder:
        stage = Path(folder)
        given = {"LICENSE": project / "LICENSE", "README.md": project / "packaging" / "wheel" / "README.md"}
        for name, path in sorted((given | dict(files)).items()):
            place(path, stage / name)
        for name, text in licences.items():
            (stage / name).write_text(text, encoding="utf-8")
        (stage / "pyproject.toml").write_text(metadata(project, version), encoding="utf-8")
        (stage / "setup.py").write_text(SETUP.format(tag=tag), encoding="utf-8")
        command = [sys.executable, "setup.py", "-q", "bdist_wheel", "--dist-dir", "dist"]
        run = subprocess.run(command, cwd=stage, env={**os.environ, "SOURCE_DATE_EPOCH": str(epoch(project))},
                             capture_output=True, text=True, check=False, umask=0o022)
        if run.returncode:
            raise SystemExit(f"{run.stdout}{run.stderr}laconic: setuptools could not make the wheel")
        (made,) = (stage / "dist").glob("*.whl")
        out.mkdir(parents=True, exist_ok=True)
        return Path(shutil.copyfile(made, out / made.name))


def metadata(project: Path, version: str) -> str:
    """pyproject.toml of the package, with its version and the page that package indices show."""
    text = (project / "python" / "pyproject.toml").read_text(encoding="utf-8")
    found, count = VERSION_ELSEWHERE.subn(f'version = "{version}"\\nreadme = "README.md"', text)
    if count != 1:
        raise SystemExit('laconic: pyproject.toml has no line dynamic = ["version"]')
    return found


def place(path: Path, target: Path) -> None:
    """Copies a file; its permissions are those of its kind, whatever the umask that made it."""
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, target)
    target.chmod(0o755 if target.parent.name in ("bin", "lib") and target.suffix != ".h" else 0o644)


def epoch(project: Path) -> int:
    """The date of everything in the wheel: SOURCE_DATE_EPOCH, else that of the commit."""
    if given := os.environ.get("SOURCE_DATE_EPOCH"):
        return max(EARLIEST, int(given))
    command = ["git", "-C", str(project), "log", "-1", "--format=%ct"]
    try:
        found = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    except OSError:
        found = ""
    return int(found) if found else EARLIEST
