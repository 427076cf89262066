"""What the parts share: places, the compile commands of a build tree, and calls of programs."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PARTS = {"core": "core_c", "node": "firmware_stub", "fmu": "fmu"}
TARGETS = {"core": ("laconic_objects_double",), "node": ("laconic_node_double", "laconic_secure"),
           "fmu": ("Laconic_fmi2", "Laconic_fmi3", "LaconicController_fmi3", "LaconicNode_fmi3", "LaconicCanBus_fmi3",
                   "LaconicCanController_fmi3")}
"""The folder of each part, and the targets of CMake that it is shipped as, in double precision."""
CORES = os.cpu_count() or 1


class Unusable(Exception):
    """What is missing for a part to run, in one line with the remedy."""


def build() -> Path:
    """The build tree: LACONIC_BUILD_DIR, else the one of this Python environment, else build/ of the sources."""
    around = Path(sys.prefix).parent
    usual = around if (around / "CMakeCache.txt").exists() else ROOT / "build"
    return Path(os.environ.get("LACONIC_BUILD_DIR") or usual).resolve()


def work(name: str) -> Path:
    """A folder of the build tree for what a part makes."""
    folder = build() / "assurance" / name
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def needed(*tools: str) -> None:
    """Unusable where one of these programs is not installed."""
    for tool in tools:
        if shutil.which(tool) is None:
            raise Unusable(f"there is no {tool}; install it")


def called(command: Sequence[str | Path], limit_s: float = 900.0, folder: Path = ROOT) -> str:
    """What a program prints; Unusable where it fails."""
    done = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, timeout=limit_s,
                          stdin=subprocess.DEVNULL, check=False)
    if done.returncode != 0:
        raise Unusable(f"{Path(command[0]).name} failed: {(done.stderr or done.stdout).strip()[-600:]}")
    return done.stdout


def each(jobs: Sequence[Sequence[str | Path]], folder: Path = ROOT) -> None:
    """Calls many programs, as many at once as there are processors."""
    with ThreadPoolExecutor(CORES) as pool:
        for _ in pool.map(lambda job: called(job, folder=folder), jobs):
            pass


@dataclass(frozen=True)
class Entry:
    """A source with the command by which the build compiles it; `output` is its object in the build tree."""

    source: Path
    output: Path
    command: tuple[str, ...]

    @property
    def name(self) -> str:
        """The source, from the project's root where it lies there."""
        return (self.source.relative_to(ROOT) if self.source.is_relative_to(ROOT) else self.source).as_posix()

    @property
    def target(self) -> str:
        """The target of CMake that it belongs to."""
        return next((part[:-4] for part in self.output.parts if part.endswith(".dir")), "")

    def flags(self, *starts: str) -> list[str]:
        """Options that begin so, with the folder that may follow."""
        found = []
        for word, after in zip(self.command, (*self.command[1:], ""), strict=True):
            if word.startswith(starts):
                found += [word, after] if word in ("-isystem", "-I", "-D") else [word]
        return found

    def headers(self) -> list[str]:
        """Folders of headers and macros."""
        return self.flags("-I", "-isystem", "-D")


def entries() -> Iterator[Entry]:
    """Everything that the build tree compiles, in its order."""
    path = build() / "compile_commands.json"
    if not path.exists():
        raise Unusable(f"{path}: is not there; configure with Ninja or Make: cmake --preset default")
    for each in json.loads(path.read_text(encoding="utf-8")):
        command = shlex.split(each["command"])
        output = Path(each["directory"], command[command.index("-o") + 1]).resolve()
        yield Entry(Path(each["file"]), output, tuple(command))


def of_targets(*targets: str) -> list[Entry]:
    """Each source of these targets of CMake once, in the order of the targets; none for a target that is not there."""
    found: dict[Path, Entry] = {}
    for entry in sorted((entry for entry in entries() if entry.target in targets), key=lambda each: targets.index(
            each.target)):
        found.setdefault(entry.source, entry)
    if not found:
        raise Unusable(f"the build tree has no target {' or '.join(targets)}; configure it with tests")
    return list(found.values())


def once(flags: Iterable[str]) -> list[str]:
    """The same options, each once, in their order; pairs such as -isystem FOLDER stay together."""
    words, found = list(flags), dict[tuple[str, ...], None]()
    while words:
        word = words.pop(0)
        found[(word, words.pop(0)) if word in ("-isystem", "-I", "-D") else (word,)] = None
    return [word for pair in found for word in pair]


class Clock:
    """Time that is left of so many minutes."""

    def __init__(self, minutes: float):
        self.end = time.monotonic() + 60.0 * minutes

    def __bool__(self) -> bool:
        return time.monotonic() < self.end
