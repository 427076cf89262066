"""What the C tests of a build tree are linked of, and which objects a source is compiled into."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from assurance.common import ROOT, Entry, Unusable, build, called, entries


@dataclass(frozen=True)
class Link:
    """How a program or an archive is made of others."""

    words: tuple[str, ...]
    folder: Path
    inputs: tuple[Path, ...]


@cache
def links() -> dict[Path, Link]:
    """By what they make, of the whole build tree."""
    if (build() / "build.ninja").exists():
        text = called(["ninja", "-C", build(), "-t", "commands", "laconic_unity_tests"])
        lines = [(build(), line) for line in text.splitlines()]
    else:
        lines = [(path.parents[2], line) for path in build().rglob("CMakeFiles/*.dir/link.txt")
                 for line in path.read_text(encoding="utf-8").splitlines()]
    found = {}
    for folder, line in lines:
        for words in map(shlex.split, re.split(r"&&", line)):
            if len(words) < 3 or "-c" in words:
                continue
            out = words.index("qc") + 1 if "qc" in words else words.index("-o") + 1 if "-o" in words else 0
            if out:
                inputs = tuple((folder / word).resolve() for word in words if word.endswith((".o", ".a")))
                made = (folder / words[out]).resolve()
                found[made] = Link(tuple(words), folder, tuple(path for path in inputs if path != made))
    return found


@cache
def objects_of(made: Path) -> frozenset[Path]:
    """All objects that a program or archive may take."""
    link = links().get(made)
    if link is None:
        return frozenset({made} if made.suffix == ".o" else ())
    return frozenset[Path]().union(*(objects_of(path) for path in link.inputs))


@cache
def programs() -> tuple[Path, ...]:
    """The Unity tests."""
    told = json.loads(called(["ctest", "--test-dir", build(), "--show-only=json-v1", "-L", "unity"]))
    paths = [Path(test["command"][0]).resolve() for test in told["tests"] if "command" in test]
    found = tuple(path for path in paths if path in links() and path.exists())
    if not found:
        raise Unusable(f"the C tests are not built; cmake --build {build()} --target laconic_unity_tests")
    if len(found) < len(told["tests"]):
        print(f"only {len(found)} of {len(told['tests'])} C tests are built, and the others notice nothing")
    return found


@cache
def all_entries() -> tuple[Entry, ...]:
    needed = frozenset[Path]().union(*map(objects_of, programs()))
    return tuple(entry for entry in entries() if entry.source.is_relative_to(ROOT) and entry.output in needed
                 and "batch" not in entry.source.parts)


INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]+"([^"]+)"', re.MULTILINE)


@cache
def included(path: Path, folders: tuple[str, ...]) -> tuple[Path, ...]:
    """What a file of the project includes itself."""
    places = [[Path(folder, name) for folder in (str(path.parent), *folders)]
              for name in INCLUDE.findall(path.read_text(encoding="utf-8", errors="replace"))]
    found = [next((place for place in each if place.is_file()), None) for each in places]
    return tuple(place.resolve() for place in found if place)


@cache
def includes(path: Path, folders: tuple[str, ...]) -> frozenset[Path]:
    """A file with all of the project that it includes."""
    found, waiting = set[Path](), [path]
    while waiting:
        each = waiting.pop()
        if each not in found:
            found.add(each)
            waiting += included(each, folders)
    return frozenset(found)


def affected(file: str) -> list[Entry]:
    """The objects that a file is compiled into."""
    path = (ROOT / file).resolve()
    return [entry for entry in all_entries() if path in includes(
        entry.source.resolve(), tuple(word.removeprefix("-I") for word in entry.flags("-I")))]


def ran(program: Path, limit_s: float, **environment: str) -> bool:
    """Whether a test passes within the time."""
    with suppress(subprocess.TimeoutExpired):
        done = subprocess.run([str(program)], env={**os.environ, **environment}, stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=limit_s, check=False)
        return done.returncode == 0
    return False
