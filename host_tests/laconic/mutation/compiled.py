"""What a source is compiled to, by each target that compiles or includes it: in copies of the sources, in which a fault
can stand."""

from __future__ import annotations

import re
import shutil
import threading
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

from laconic.errors import ResultFails
from laconic.mutation.programs import FAMILIES, FOLDERS, Family, Unit, families
from laconic.paths import SOURCE_DIR, build_dir


class Compiled:
    """The sources of some families."""

    def __init__(self, families: list[Family], folder: Path):
        self.families, self.folder = families, folder
        self._plain: dict[tuple[str, str], bytes] = {}
        self._units: dict[str, list[Unit]] = {}
        self._lock = threading.Lock()
        self._untouched = self._copied("untouched")
        self._includes = inclusions({unit.source.resolve() for family in families for unit in family.library_units
                                     if build_dir().resolve() in unit.source.resolve().parents})

    @classmethod
    def of(cls, files: Iterable[str], folder: Path) -> Compiled:
        """The families whose tests are those of these files, as the build tree has them."""
        of_fmu = set(map(is_of_fmu, files))
        return cls(families(folder, [name for name in FAMILIES if name.startswith("fmu_") in of_fmu]), folder)

    def tree(self, number: int) -> Path:
        """A copy of the sources in which one thread makes its faults."""
        return self._copied(f"tree{number}")

    def _copied(self, name: str) -> Path:
        copy = self.folder / name
        for part in FOLDERS:
            shutil.copytree(SOURCE_DIR / part, copy / part, dirs_exist_ok=True,
                            ignore=lambda folder, names: [name for name in names if (Path(folder) / name).is_file()
                                                          and not name.endswith((".c", ".h"))])
        return copy

    def families_of(self, file: str) -> list[Family]:
        """The FMU's tests are for its own files: those of the core have theirs."""
        return [family for family in self.families if family.name.startswith("fmu_") == is_of_fmu(file)]

    def units_of(self, file: str) -> list[Unit]:
        """The units that a file is in. Lanes have the methods' text, too, but are not compiled anew."""
        with self._lock:
            if file not in self._units:
                self._units[file] = self._found_units_of(file)
            return self._units[file]

    def _found_units_of(self, file: str) -> list[Unit]:
        every = [unit for family in self.families_of(file)
                 for unit in [*family.library_units, *(unit for program in family.programs for unit in program.units)]]
        path = (SOURCE_DIR / file).resolve()
        if path.suffix == ".c":
            found = [unit for unit in every if unit.source.resolve() == path]
        else:
            users = self._includes[path]
            found = [unit for unit in every if unit.source.resolve() in users and "/batch/" not in str(unit.source)]
        return list(dict.fromkeys(found))

    def plain_of(self, unit: Unit, tree: Path) -> bytes:
        """What it is compiled to without a fault: for a header's mutant that many units have, only when it is their
        turn."""
        name = (unit.target, str(unit.source))
        with self._lock:
            known = self._plain.get(name)
        if known is not None:
            return known
        out = tree / "plain.o"
        done = unit.compile(self._untouched, out)
        if done.returncode != 0:
            raise ResultFails(f"{unit.source}: does not compile without a fault: {done.stderr[-300:]!r}")
        with self._lock:
            return self._plain.setdefault(name, out.read_bytes())


def is_of_fmu(file: str) -> bool:
    """Whether the tests around the FMU's models are those of this file."""
    return file.startswith("fmu/")


def inclusions(generated: Iterable[Path] = ()) -> dict[Path, set[Path]]:
    """The C files that include a header, by the header: by way of others, too. Those that the build has made count."""
    sources = [*(path for folder in FOLDERS for path in (SOURCE_DIR / folder).rglob("*.[ch]")), *generated]
    named: dict[str, list[Path]] = defaultdict(list)
    for path in sources:
        named[path.name].append(path.resolve())
    direct = {path.resolve(): {found for name in re.findall(r'^\s*#\s*include "([^"]+)"', path.read_text("utf-8"),
                                                            re.MULTILINE)
                               for found in named[Path(name).name] if str(found).endswith(name.replace("../", ""))}
              for path in sources}
    users: dict[Path, set[Path]] = defaultdict(set)
    for path in direct:
        seen, todo = set[Path](), [path]
        while todo:
            for found in direct[todo.pop()] - seen:
                seen.add(found)
                todo.append(found)
                users[found].add(path)
    return users
