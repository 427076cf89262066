"""The rules of CONTRIBUTING.md that a script can hold: prints each violation and ends with status 1 if there is one.

    rules, or this file by itself
"""

from __future__ import annotations

import argparse
import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from assurance import sizes  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
MOST_FILES = 1650
MOST_LINES_OF_CODE = 400
GENERATED = (".fmu", ".o", ".so", ".a", ".pyc", ".profraw", ".log", "laconic_dbc.c", "laconic_dbc.h", "unity.c")
RUN_DATE = re.compile(r"\b20[2-9]\d-[01]\d-[0-3]\d\b")
DATED = ("CHANGELOG.md", "scenes/", "python/requirements", "packaging/requirements", "host_tests/tests/", "web/",
         "LICENSE")
C_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
GENERATORS = ("packaging/laconic_build/c/", "packaging/laconic_build/wire/generate_wire.py", "python/laconic_fmu/")


def main() -> int:
    """Prints the violations."""
    paths = tracked()
    found = [line for rule in (shape, dates, made, shipping, imports, jobs) for line in rule(paths)]
    print("\n".join(found) or f"rules: {len(paths)} files, none violates one")
    return 1 if found else 0


def tracked() -> list[str]:
    """The files of git, by their paths from the root; those that the working tree has removed are left out."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [path for path in listed.splitlines() if (ROOT / path).exists()]


def text_of(path: str) -> str:
    """The text of a file; empty where it is not text."""
    try:
        return (ROOT / path).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""


def shape(paths: list[str]) -> Iterator[str]:
    """How many files there are, and how large the apparatus is beside the product."""
    if len(paths) > MOST_FILES:
        yield f"{len(paths)} files: at most {MOST_FILES}"
    lines = sizes.lines_by_kind(paths)
    if lines["apparatus"] > 0.1 * lines["product"]:
        yield f"apparatus has {lines['apparatus']} lines, more than a tenth of the product's {lines['product']}"


def dates(paths: list[str]) -> Iterator[str]:
    """No date of a run."""
    for path in paths:
        if not path.startswith(DATED):
            for day in RUN_DATE.findall(text_of(path)):
                yield f"{path}: has the date {day}: results of runs are printed, not committed"


def made(paths: list[str]) -> Iterator[str]:
    """No output of a tool."""
    yield from (f"{path}: is made by a tool" for path in paths if path.endswith(GENERATED))


def shipping(paths: list[str]) -> Iterator[str]:
    """What people install takes nothing from host_tests."""
    for path in paths:
        what_ships = path.startswith(("packaging/laconic_build/wheel/", "packaging/laconic_build/c/"))
        if what_ships and "host_tests" in text_of(path):
            yield f"{path}: names host_tests, nothing of which ships"


def imports(paths: list[str]) -> Iterator[str]:
    """Generators of C and XML do not import laconic; adapters do not include each other."""
    for path in paths:
        if path.startswith(GENERATORS) and path.endswith(".py"):
            for node in ast.walk(ast.parse(text_of(path))):
                names = [node.module or ""] if isinstance(node, ast.ImportFrom) else \
                    [each.name for each in node.names] if isinstance(node, ast.Import) else []
                yield from (f"{path}: imports {name}" for name in names if name.split(".")[0] == "laconic")
        if path.startswith(("fmu/", "firmware_stub/")) and path.endswith((".c", ".h")):
            other = "firmware_stub/" if path.startswith("fmu/") else "fmu/"
            if re.search(rf'#include [<"]{other}', text_of(path)):
                yield f"{path}: includes a file of {other}"


def jobs(paths: list[str]) -> Iterator[str]:
    """Every source file begins with its one job, and no reader has to hold more than some hundred lines of it."""
    for path in paths:
        if not path.endswith((".c", ".h", ".py", ".cmake", "CMakeLists.txt")):
            continue
        text = text_of(path)
        if text.strip() and not job_of(path, text):
            yield f"{path}: does not begin with a comment that states its job"
        if path.endswith((".c", ".h")) and not path.endswith("/laconic.h"):
            code = sum(bool(line.strip()) for line in C_COMMENT.sub("", text).splitlines())
            if code > MOST_LINES_OF_CODE:
                yield f"{path}: {code} lines of code"
        for number, line in enumerate(text.splitlines(), 1):
            if len(line) > 120 and path.endswith((".c", ".h", ".py")):
                yield f"{path}:{number}: is longer than 120 characters"


def job_of(path: str, text: str) -> bool:
    """Whether the file's first comment has some words."""
    if path.endswith(".py"):
        comment = ast.get_docstring(ast.parse(text))
    else:
        start = re.match(r"/\*(.*?)\*/" if path.endswith((".c", ".h")) else r"#(.*)", text, re.DOTALL)
        comment = start[1] if start else None
    return comment is not None and len(comment.split()) > 2


def arguments(parser: argparse.ArgumentParser) -> None:
    """None."""


def run(_: argparse.Namespace) -> bool:
    """Whether none is violated."""
    return main() == 0


if __name__ == "__main__":
    sys.exit(main())
