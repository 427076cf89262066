"""One mutant tried: compiled where its file is compiled or included, and given to the tests that it can affect."""

from __future__ import annotations

import re
import subprocess
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from laconic.errors import ResultFails
from laconic.mutation.compiled import Compiled
from laconic.mutation.operators import Mutant
from laconic.mutation.programs import Family, Program, Unit, link

START_S = 0.005  # that any program takes, however little it does
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-sanitize=vptr", "-O1")
VERDICTS = {"killed": "a test failed", "timeout": "a test ran past its bound", "survived": "all tests passed",
            "sanitizers": "all tests passed, and one failed under the sanitizers",
            "same code": "the compiler makes the same bytes of it: equivalent", "invalid": "does not compile"}


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant: one of VERDICTS, and the program that noticed it."""

    verdict: str
    by: str = ""
    seconds: float = 0.0


class Trials:
    """What all trials share: what the files are compiled to, and which programs killed before."""

    def __init__(self, compiled: Compiled):
        self.compiled = compiled
        self._kills: dict[str, Counter[str]] = defaultdict(Counter)
        self._lock = threading.Lock()

    def outcome(self, mutant: Mutant, tree: Path) -> Outcome:
        """Tries it in that copy of the sources."""
        began = time.monotonic()
        changed = tree / mutant.file
        source = changed.read_bytes()
        units = self.compiled.units_of(mutant.file)
        if not units:  # else it would count as the same code
            raise ResultFails(f"{mutant.file}: no test program is made of it, so that its mutants would tell nothing")
        changed.write_bytes(mutant.applied_to(source))
        try:
            verdict, by = self._tried(mutant, tree, source)
        finally:
            changed.write_bytes(source)
        return Outcome(verdict, by, round(time.monotonic() - began, 2))

    def libraries_of(self, mutant: Mutant) -> list[tuple[Family, list[Unit]]]:
        """The families in whose libraries its file is, with its units there."""
        units = self.compiled.units_of(mutant.file)
        found = [(family, [unit for unit in units if unit in family.library_units])
                 for family in self.compiled.families_of(mutant.file)]
        return [(family, of) for family, of in found if of]

    def _tried(self, mutant: Mutant, tree: Path, source: bytes) -> tuple[str, str]:
        differs = False
        for family in self.compiled.families_of(mutant.file):
            objects: dict[Unit, Path] = {}
            for stage, programs in self._stages(mutant, family):
                for unit in stage:
                    out = tree / f"{family.name}_{unit.target}_{unit.source.name}.o"
                    if unit.compile(tree, out).returncode != 0:
                        return "invalid", ""
                    if out.read_bytes() != self.compiled.plain_of(unit, tree):
                        objects[unit] = out
                differs |= bool(objects)
                if objects and (by := self._noticed(mutant, family, objects, tree, programs)):
                    return by
        if not differs:
            return "same code", ""
        return self._with_sanitizers(mutant, tree, source) or ("survived", "")

    def _stages(self, mutant: Mutant, family: Family) -> Iterator[tuple[list[Unit], set[str]]]:
        """What is compiled, and which programs then run: first the library and the programs that do not include the
        mutant's file themselves. Most faults are noticed by these, so that the others need not be compiled."""
        units = self.compiled.units_of(mutant.file)
        include = {program.name for program in family.programs if set(units).intersection(program.units)}
        every = {program.name for program in family.programs}
        yield [unit for unit in units if unit in family.library_units], every - include
        if include:
            yield [unit for unit in units if any(unit in program.units for program in family.programs)], include

    def _with_sanitizers(self, mutant: Mutant, tree: Path, source: bytes) -> tuple[str, str] | None:
        """What the tests passed is given to them once more under the sanitizers, as continuous integration runs them: a
        fault may write past an array, and nothing else."""
        libraries = self.libraries_of(mutant)
        if not libraries or (found := self._checked(mutant, *libraries[0], tree, None)) is None:
            return None
        (tree / mutant.file).write_bytes(source)
        again = self._checked(mutant, *libraries[0], tree, found[1])
        return ("sanitizers", found[1]) if again is None else None  # else it does not pass without the fault

    def _checked(self, mutant: Mutant, family: Family, units: list[Unit], tree: Path,
                 only: str | None) -> tuple[str, str] | None:
        objects = {unit: tree / f"checked_{unit.target}_{unit.source.name}.o" for unit in units}
        if any(unit.compile(tree, out, *SANITIZERS).returncode != 0 for unit, out in objects.items()):
            return None
        every = {program.name for program in family.programs} if only is None else {only}
        return self._noticed(mutant, family, objects, tree, every, checks=SANITIZERS[:1])

    def _noticed(self, mutant: Mutant, family: Family, objects: dict[Unit, Path], tree: Path,
                 programs: set[str], checks: tuple[str, ...] = ()) -> tuple[str, str] | None:
        of_library = {unit: path for unit, path in objects.items() if unit in family.library_units}
        preload = tree / f"fault_{family.name}.so" if of_library else None
        if preload is not None:
            try:
                link([*family.compiler, *checks, "-shared"], list(of_library.values()), preload)
            except ResultFails:
                return "invalid", ""
        affected = set().union(*(family.reach[unit.object] for unit in of_library)) if of_library else set()
        for program in self._in_order(mutant, family, affected, objects):
            if program.name not in programs:
                continue
            own = {unit: path for unit, path in objects.items() if unit in program.units}
            used = program
            if own:
                used = Program(program.name, program.units,
                               family.link_program(program, own, tree / f"{program.name}.with_fault"), program.seconds)
            # the library behind it: a program may need nothing of it, but what the fault's objects need must be there
            loaded = [*(runtime_of_sanitizers(family) if checks else []),
                      *([preload, family.library] if preload else [])]
            status = used.run(family.library, loaded, family.bound_s(program))
            if status != 0:
                with self._lock:
                    self._kills[mutant.file][program.name] += not checks
                return ("timeout" if status is None else "killed"), program.name
        return None

    def _in_order(self, mutant: Mutant, family: Family, affected: set[str], objects: dict[Unit, Path]) -> list[Program]:
        """The program of the file's own name first, then those that notice most in their time: of this file's mutants,
        and a hundredth as much of others."""
        own = {unit for unit in objects if unit not in family.library_units}
        chosen = [program for program in family.programs
                  if program.name in affected or any(unit in own for unit in program.units)]
        with self._lock:
            kills = Counter(self._kills[mutant.file])
            all_kills = sum(self._kills.values(), Counter())
        path = Path(mutant.file)
        stem = path.parent.name if path.stem == "model" else path.stem.removeprefix("node_")
        name = re.compile(rf"(test|node|fmu_[a-z]+)_(node_)?{stem}(_double|_single)?")

        def noticed_per_second(program: Program) -> float:
            return (kills[program.name] + 0.01 * all_kills[program.name] + 0.01) / (program.seconds + START_S)

        return sorted(chosen, key=lambda each: (not name.fullmatch(each.name), -noticed_per_second(each)))


def runtime_of_sanitizers(family: Family) -> list[Path]:
    """It must be loaded before anything else."""
    said = subprocess.run([*family.compiler, "-print-file-name=libasan.so"], capture_output=True, text=True, check=True)
    return [Path(said.stdout.strip()).resolve()]
