"""`python -m laconic_build.c amalgamation FOLDER`: the core as two files; `packages FOLDER`: embedded packages."""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Mapping
from pathlib import Path

from laconic_build.c.amalgamation import amalgamation
from laconic_build.c.embedded import TOOLS, archive, packages
from laconic_build.c.facts import facts


def main() -> None:
    parser = argparse.ArgumentParser(prog="laconic_build.c", description=__doc__)
    parser.add_argument("what", choices=("amalgamation", "packages"))
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    if arguments.what == "amalgamation":
        write(arguments.folder, amalgamation(facts()))
    else:
        write_packages(arguments.folder)


def write_packages(folder: Path) -> None:
    """A folder for each tool, as it is used in place, and its archive beside it."""
    shutil.rmtree(folder, ignore_errors=True)
    for tool, files in packages(facts()).items():
        write(folder / tool / TOOLS[tool].folder, files)
        name, content = archive(tool, files, facts())
        (folder / name).write_bytes(content)


def write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
