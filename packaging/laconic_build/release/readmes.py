"""Texts and examples that only the release's files have: made from the README of the project."""

from __future__ import annotations

import re
from collections.abc import Iterable

from laconic_build.c.facts import Facts
from laconic_build.release.archives import File
from laconic_build.release.tree import Tree

EXAMPLE = re.compile(r"```c\n(.*?)```\n\n```text\n(.*?)```", re.DOTALL)
TWO_FILES = """\
# Laconic {version} as two files

{paragraph}

    cc -O2 -I. program.c laconic/laconic.c -o program
    ./program

prints `{printed}`. `laconic/laconic.h` is the manual. The pair
`laconic_single.h`, `laconic_single.c` computes in float.
"""
CORE = """\
# The core of Laconic {version}

{paragraph}

    cmake -S . -B build
    cmake --build build
    cmake --install build --prefix ~/laconic

Then `find_package(laconic)` and `laconic::core` (double) or `laconic::core_single` (float), as in `example`; without
installing, `add_subdirectory` or FetchContent of this folder gives the same targets. The manual is
`include/laconic/laconic.h`.
"""
LISTS = """\
cmake_minimum_required(VERSION 3.18)
project(program LANGUAGES C)
find_package(laconic {version} REQUIRED COMPONENTS core)
add_executable(program program.c)
target_link_libraries(program PRIVATE laconic::core)
"""


def of_two_files(tree: Tree, facts: Facts) -> dict[str, File]:
    """What lies beside the folder `laconic`."""
    return texts({"program.c": example(tree)[0], "LICENSE": facts.licence,
                  "README.md": filled(TWO_FILES, facts, printed=example(tree)[1].strip())})


def of_core(tree: Tree, facts: Facts) -> dict[str, File]:
    """What lies beside the core's own files."""
    return texts({"LICENSE": facts.licence, "README.md": filled(CORE, facts), "example/program.c": example(tree)[0],
                  "example/CMakeLists.txt": filled(LISTS, facts)})


def example(tree: Tree) -> tuple[str, str]:
    """The README's program in C, and what it prints."""
    found = EXAMPLE.search((tree.folder / "README.md").read_text(encoding="utf-8"))
    if found is None:
        raise SystemExit("laconic: README.md has no example in C, followed by what it prints")
    return found[1], found[2]


def of_release(facts: Facts, rows: Iterable[tuple[str, str]]) -> str:
    """README.md of the release: what each file is for."""
    lines = "".join(f"* `{name}`: {text}\n" for name, text in rows)
    return f"# {facts.title} {facts.version}\n\n{facts.sentence}\n\n{lines}"


def filled(template: str, facts: Facts, **more: str) -> str:
    """A template with the project's facts."""
    return template.format(version=facts.version, paragraph=facts.paragraph, **more)


def texts(given: dict[str, str]) -> dict[str, File]:
    """Texts as files."""
    return {name: File(text.encode("utf-8")) for name, text in given.items()}
