"""Sources of the core as a static library that is compiled as far as programs ask for it: a step by one method needs a
fifth of the files. Which file defines what is read off the library of the build tree; what that does not tell is
compiled, too."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path

from laconic.base.paths import build_dir
from laconic.tools.report.binary_tools import run_tool

MADE = "core_c/liblaconic.a"  # of the build tree


class CoreArchive:
    """A folder with the library and its objects (and what the compiler writes beside these). `always`: files that
    nothing asks for by name, since they stand in for what the compiler's own library has."""

    def __init__(self, place: Path, sources: Iterable[Path], always: Iterable[Path], compile_command: Sequence[str],
                 prefix: str) -> None:
        """Of these sources, compiled by that command with binary tools of that prefix; nothing is compiled yet."""
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        self.place, self.path = place, place / "libcore.a"
        self._left = {path.name: path for path in sources}
        self._command, self._prefix = list(compile_command), prefix
        self._compile(list(always))

    def provide(self, wanted: Iterable[str]) -> set[str]:
        """Compiles what defines these names and what that wants in turn; returns what the new objects want."""
        home, todo, asked = home_of_names(), set(wanted), set[str]()
        while new := {home[name] for name in todo if home.get(name) in self._left}:
            todo = self._compile([self._left.pop(name) for name in sorted(new)])
            asked |= todo
        return asked

    def provide_all(self) -> bool:
        """Compiles what is left; whether there was anything."""
        left = list(self._left.values())
        self._left.clear()
        self._compile(left)
        return bool(left)

    def _compile(self, sources: list[Path]) -> set[str]:
        """Puts them into the library; returns what they want."""
        objects = [path.with_suffix(".o").name for path in sources]
        if sources:
            run_tool([*self._command, "-c", *map(str, sources)], self.place)
        run_tool([f"{self._prefix}ar", "rcs", self.path.name, *objects], self.place)
        return undefined(self._prefix, [self.place / name for name in objects])


@cache
def home_of_names() -> dict[str, str]:
    """The name of the C file that defines a name of the core; empty where there is no such library to read."""
    made = build_dir() / MADE
    if not made.is_file() or shutil.which("nm") is None:
        return {}
    found = {}
    for line in run_tool(["nm", "-A", "-g", "--defined-only", str(made)]).splitlines():
        member, name = line.rpartition(":")[0].rpartition(":")[2], line.rpartition(" ")[2]
        found[name] = member.partition(".c.")[0] + ".c"
    return found


def undefined(prefix: str, objects: Sequence[Path]) -> set[str]:
    """The names that objects want of others."""
    if not objects:
        return set()
    return {line.split()[-1] for line in run_tool([f"{prefix}nm", "-u", *map(str, objects)]).splitlines()
            if line.startswith(" ")}
