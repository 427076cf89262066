"""Lines and files of product, tests and apparatus, as git tracks them; pages, data and locks count as files alone.

    sizes"""

from __future__ import annotations

import argparse
import subprocess
from collections import Counter, defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
APPARATUS = ("host_tests/assurance/", "host_tests/tests/assurance/", ".ci/", ".clang", "ruff.toml", "mypy.ini",
             "cmake/check_purity.py", "cmake/LaconicChecks.cmake")
TESTS = ("host_tests/",)                          # behaviour of everything together, and its references
OF_TESTS = {"tests", "test"}                      # folders next to what they test
TEXT = (".c", ".h", ".cu", ".py", ".pyi", ".js", ".mjs", ".ts", ".html", ".css", ".cmake", ".txt", ".toml", ".xml",
        ".dbc", ".in", ".ini", ".sh", ".ld", ".S", ".json", "run", "nightly", ".yml", ".yaml", ".cfg", ".properties")
NO_LINES = ("requirements", "docs/", "scenes/", "LICENSE", "CHANGELOG")  # pages, locks, and robots


def kind_of(path: str) -> str:
    """What a file belongs to: product is what a user installs, links or opens, and its build."""
    if path.startswith(APPARATUS):
        return "apparatus"
    return "test" if path.startswith(TESTS) or OF_TESTS & {*Path(path).parent.parts} else "product"


def lines_by_kind(paths: list[str]) -> Counter[str]:
    """Lines of program text."""
    lines: Counter[str] = Counter({"product": 0, "test": 0, "apparatus": 0})
    for path in paths:
        is_text = path.endswith(TEXT) and not path.startswith(NO_LINES) and "requirements" not in path
        if is_text and "/data/" not in path and (ROOT / path).is_file():
            lines[kind_of(path)] += (ROOT / path).read_bytes().count(b"\n")
    return lines


def arguments(parser: argparse.ArgumentParser) -> None:
    """None."""


def run(_: argparse.Namespace) -> bool:
    """Prints the table."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    paths = [path for path in listed.splitlines() if (ROOT / path).exists()]
    lines, files = lines_by_kind(paths), defaultdict[str, int](int)
    for path in paths:
        files[kind_of(path)] += 1
    for kind, count in lines.items():
        print(f"{kind:10} {count:7} lines {100 * count / lines.total():5.1f} % {files[kind]:6} files")
    print(f"apparatus is {100 * lines['apparatus'] / lines['product']:.1f} % of the product; {len(paths)} files in all")
    return True
