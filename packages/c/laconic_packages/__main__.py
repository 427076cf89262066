"""`python -m laconic_packages amalgamation FOLDER`: the core as two files."""

from __future__ import annotations

import argparse
from pathlib import Path

from laconic_packages.amalgamation import amalgamation
from laconic_packages.facts import facts


def main() -> None:
    parser = argparse.ArgumentParser(prog="laconic_packages", description=__doc__)
    parser.add_argument("what", choices=("amalgamation",))
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    write(arguments.folder, amalgamation(facts()))


def write(folder: Path, files: dict[str, str]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
