"""What the C tests are linked of, as the build tree's compile_commands.json has it: units (a source as one target
compiles it) and, in each family, test programs around one library. A mutant's library holds the changed units alone and
is loaded before the family's, so that nothing but these is linked anew."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import time
from collections import defaultdict
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from laconic.errors import BadInput, ResultFails
from laconic.paths import SOURCE_DIR, build_dir

FOLDERS = ("core_c", "firmware_stub", "fmu")
FMU_MODELS = ("unit", "derivatives", "estimate", "controller", "node", "bus", "robomaster")
"""What the FMUs' glue stands around; `unit` is the vehicle."""
FAMILIES = {"double": r"laconic_objects_double|laconic_node_double|laconic_wire",
            "single": r"laconic_objects_single|laconic_node_single|laconic_wire",
            "secure": r"laconic_secure|laconic_wire",
            **{f"fmu_{model}": rf"laconic_fmu_checked_{model}|laconic_fmu_memory|laconic_objects_double"
                               + ("|laconic_node_double|laconic_wire" if model == "node" else "")
               for model in FMU_MODELS}}
"""By the targets whose objects make the family's library."""
TESTS = {"double": r"(test|node)_\w+_double", "single": r"(test|node)_\w+_single", "secure": r"node_secure",
         **{f"fmu_{model}": rf"fmu_{model}_\w+" for model in FMU_MODELS}}
LEFT_OUT = r"test_soft_double|node_socketcan_\w+|test_batch\w*"
"""Programs that tell nothing: of files that are not mutated, and of lanes, whose text is not compiled anew here, so
that they differ from every mutant of a method."""
REMEDY = "run `cmake --build build --target laconic_unity_tests`"
PATIENCE, PATIENCE_S = 20.0, 3.0  # so many times as long as without a fault, and so much more


@dataclass(frozen=True, eq=False)
class Unit:
    """A source as one target compiles it: itself alone, so that sets of many need not compare their commands."""

    source: Path
    target: str
    command: tuple[str, ...]
    directory: Path
    object: Path

    def compile(self, tree: Path, out: Path, *more: str, bound_s: int = 600) -> subprocess.CompletedProcess[bytes]:
        """Compiles it as it stands in another tree of sources, to bytes (__FILE__) that do not tell which. It fails
        when a compiler has taken that much of a processor: the shell's limit holds for what the driver starts, too."""
        here = [*(_moved(word, tree) for word in self.command), f"-ffile-prefix-map={tree}/=", *more]
        bounded = ["sh", "-c", f'ulimit -t {bound_s}; exec "$@"', "sh"]
        return subprocess.run([*bounded, *here, "-o", str(out), "-c", _moved(str(self.source), tree)],
                              cwd=self.directory, capture_output=True, check=False)


def _moved(word: str, tree: Path) -> str:
    return re.sub(rf"{re.escape(str(SOURCE_DIR))}(?=/({'|'.join(FOLDERS)})(/|$))", str(tree), word)


# A fault may make a warning, but no other program than its text says: so a wrong pointer is no mutant.
_FLAGS = ("-Werror=implicit-function-declaration", "-Werror=incompatible-pointer-types", "-Werror=int-conversion")


def units() -> list[Unit]:
    """All of the build tree; BadInput where there is none, or one of other sources."""
    path = build_dir().resolve() / "compile_commands.json"
    try:
        entries = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BadInput(f"{path}: is not there; build the project: mutants need its build tree") from error
    found = []
    for entry in entries:
        words = shlex.split(entry["command"])
        out = words[words.index("-o") + 1]
        target = re.search(r"CMakeFiles/([^/]+)\.dir/", out)
        if target:
            kept = [word for word in words[:words.index("-o")] if not word.startswith("-W") and word != "-g"]
            found.append(Unit(Path(entry["file"]), target[1], (*kept, *_FLAGS), Path(entry["directory"]),
                              Path(entry["directory"]) / out))
    if not any(unit.source.resolve().is_relative_to(SOURCE_DIR.resolve()) for unit in found):
        raise BadInput(f"{path}: is of other sources than {SOURCE_DIR}; name their build tree in LACONIC_BUILD_DIR")
    return found


@dataclass
class Program:
    """A test program, linked against the family's library."""

    name: str
    units: list[Unit]
    path: Path
    seconds: float = 0.0

    def run(self, library: Path, preload: list[Path], bound_s: float | None, **more: str) -> int | None:
        """Its exit status, with more in its environment; None: it ran past the bound."""
        environment = {"LD_LIBRARY_PATH": str(library.parent), "ASAN_OPTIONS": "detect_leaks=0", **more}
        if preload:
            environment["LD_PRELOAD"] = ":".join(map(str, preload))
        try:
            return subprocess.run([str(self.path)], env=environment, stdin=subprocess.DEVNULL, timeout=bound_s,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode
        except subprocess.TimeoutExpired:
            return None


@dataclass
class Family:
    """The tests of one scalar type, of what knows none (secure), or of the FMU around one model: all of them around one
    library."""

    name: str
    folder: Path
    library_units: list[Unit]
    programs: list[Program] = field(default_factory=list)

    @property
    def library(self) -> Path:
        """Of what is not changed."""
        return self.folder / f"liblaconic_{self.name}.so"

    def link(self) -> None:
        """The library and the programs, of what the build made."""
        self.folder.mkdir(parents=True, exist_ok=True)
        if not is_newer(self.library, self.library_units):
            link([*self.compiler, "-shared"], [unit.object for unit in self.library_units], self.library)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            stale = [program for program in self.programs if not is_newer(program.path, program.units)]
            list(pool.map(lambda program: self.link_program(program, {}), stale))

    @property
    def compiler(self) -> list[str]:
        """What links."""
        return [self.library_units[0].command[0]]

    def link_program(self, program: Program, instead: dict[Unit, Path], path: Path | None = None) -> Path:
        """A program; of some units another object."""
        objects = [instead.get(unit, unit.object) for unit in program.units]
        path = path or program.path
        link(self.compiler, [*objects, unity(), self.library], path, "-lm")
        return path

    def check(self) -> None:
        """Each program passes without a fault, and shows how long it takes; ResultFails else."""
        for program in self.programs:
            began = time.monotonic()
            status = program.run(self.library, [], 120.0)
            program.seconds = time.monotonic() - began
            if status != 0:
                raise ResultFails(f"{program.name}: fails without any fault in the sources; mutants would tell nothing")

    @cached_property
    def reach(self) -> dict[Path, set[str]]:
        """The programs that link an object of the library, by its path."""
        of_object = symbols(unit.object for unit in [*self.library_units, *(unit for program in self.programs
                                                                            for unit in program.units)])
        in_library = [unit.object for unit in self.library_units]
        home = {name: path for path in in_library for name in of_object[path][0]}
        found: dict[Path, set[str]] = defaultdict(set)
        for program in self.programs:
            wanted = [name for unit in program.units for name in of_object[unit.object][1]]
            seen: set[Path] = set()
            while wanted:
                path = home.get(wanted.pop())
                if path is not None and path not in seen:
                    seen.add(path)
                    found[path].add(program.name)
                    wanted += of_object[path][1]
        return found

    def bound_s(self, program: Program) -> float:
        """How long a program may take with a fault."""
        return PATIENCE_S + PATIENCE * program.seconds


def families(folder: Path, wanted: Iterable[str] = FAMILIES) -> list[Family]:
    """Those that the build tree has, linked and checked."""
    every, found = units(), []
    for name in wanted:
        library = [unit for unit in every if re.fullmatch(FAMILIES[name], unit.target)]
        if not any(re.fullmatch(TESTS[name], unit.target) for unit in every):
            continue
        family = Family(name, folder / name, library)
        of_target: dict[str, list[Unit]] = defaultdict(list)
        for unit in every:
            if re.fullmatch(TESTS[name], unit.target) and not re.fullmatch(LEFT_OUT, unit.target):
                of_target[unit.target].append(unit)
        family.programs = [Program(target, of, family.folder / target) for target, of in sorted(of_target.items())]
        missing = [unit.object for unit in [*library, *(unit for of in of_target.values() for unit in of)]
                   if not unit.object.exists()]
        if missing:
            raise BadInput(f"{missing[0]}: is not built; {REMEDY}")
        found.append(family)
    return found


def unity() -> Path:
    """The library of the test framework."""
    for path in sorted(build_dir().rglob("liblaconic_unity.a")):
        return path
    raise BadInput(f"{build_dir()}: has no liblaconic_unity.a; {REMEDY}")


def link(command: list[str], objects: list[Path], out: Path, *last: str) -> None:
    """Links; ResultFails says what the linker said."""
    done = subprocess.run([*command, "-o", str(out), *map(str, objects), *last], capture_output=True, text=True,
                          check=False)
    if done.returncode != 0:
        raise ResultFails(f"{out.name}: cannot be linked: {done.stderr[-300:]}")


def is_newer(path: Path, units: list[Unit]) -> bool:
    """Whether it is there, and made after the objects of these."""
    return path.exists() and path.stat().st_mtime > max(unit.object.stat().st_mtime for unit in units)


def symbols(paths: Iterable[Path]) -> dict[Path, tuple[set[str], set[str]]]:
    """What each object defines for others, and what it wants of them."""
    found: dict[Path, tuple[set[str], set[str]]] = {path: (set(), set()) for path in paths}
    said = subprocess.run(["nm", "-g", "-A", *map(str, found)], capture_output=True, text=True, check=True).stdout
    for line in said.splitlines():
        path, _, rest = line.partition(":")
        words = rest.split()
        found[Path(path)][words[-2] == "U"].add(words[-1])
    return found
