"""`python -m laconic_build.c amalgamation FOLDER`: the core as two files; `packages FOLDER`: embedded packages.

`declarations HEADER`: a preprocessed header as the tables of cffi beside it (….py), which load in a millisecond, where
reading C takes 200.
"""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Mapping
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

from laconic_build.c.amalgamation import amalgamation
from laconic_build.c.embedded import TOOLS, archive, packages
from laconic_build.c.facts import facts


def main() -> None:
    parser = argparse.ArgumentParser(prog="laconic_build.c", description=__doc__)
    parser.add_argument("what", choices=("amalgamation", "packages", "declarations"))
    parser.add_argument("path", type=Path, metavar="FOLDER|HEADER")
    arguments = parser.parse_args()
    if arguments.what == "amalgamation":
        write(arguments.path, amalgamation(facts()))
    elif arguments.what == "packages":
        write_packages(arguments.path)
    else:
        write_declarations(arguments.path)


def write_packages(folder: Path) -> None:
    """A folder for each tool, as it is used in place, and its archive beside it."""
    shutil.rmtree(folder, ignore_errors=True)
    for tool, files in packages(facts()).items():
        write(folder / tool / TOOLS[tool].folder, files)
        name, content = archive(tool, files, facts())
        (folder / name).write_bytes(content)


def write_declarations(header: Path) -> None:
    """A module with an object `ffi` that knows the header's types and opens a library with its functions."""
    from cffi import FFI  # the other files are made by Python alone

    ffi, out = FFI(), header.with_suffix(".py")
    ffi.cdef(without_inline_functions(header.read_text(encoding="utf-8")))
    ffi.set_source(out.stem, None)
    out.unlink(missing_ok=True)  # cffi leaves an equal file alone, and so its date
    with redirect_stdout(StringIO()):  # cffi announces itself
        ffi.emit_python_code(str(out))


def without_inline_functions(text: str) -> str:
    """cffi reads declarations only: `static inline` functions of the headers are left out."""
    lines, skipping = [], False
    for line in text.splitlines():
        skipping = skipping or line.startswith("static inline")
        if not skipping:
            lines.append(line)
        skipping = skipping and line != "}"
    return "\n".join(lines)


def write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
