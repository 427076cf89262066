"""Many mutants, in an order that a seed gives: so far as the time or a sample goes, and on from there the next time."""

from __future__ import annotations

import hashlib
import os
import queue
import threading
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from pathlib import Path

from laconic.errors import BadInput
from laconic.mutation.compiled import Compiled
from laconic.mutation.equivalent import read_equivalents
from laconic.mutation.listed import Listed
from laconic.mutation.operators import Mutant, mutants_of
from laconic.mutation.results import Results
from laconic.mutation.switches import bench_of
from laconic.mutation.trial import Outcome, Trials
from laconic.paths import SOURCE_DIR, build_dir, sources_missing

PARTS = {"core": ("core_c/src", "core_c/derivatives", "core_c/estimate", "core_c/filter"),
         "node": ("firmware_stub/src",),
         "drives": ("firmware_stub/drives", *(f"firmware_stub/drives/{protocol}" for protocol in
                                              ("canopen", "moteus", "odrive", "robomaster"))),
         "commands": ("firmware_stub/secure",),
         "fmu": ("fmu", "fmu/vehicle", "fmu/controller", "fmu/network", "fmu/network/node", "fmu/network/bus",
                 "fmu/network/robomaster")}
MANY = 40
"""Mutants of one file, from which on it is worth a library with switches."""
LEFT_OUT = ("firmware_stub/src/shared_library.c", "firmware_stub/src/shared_library.h",
            "firmware_stub/src/library_drives.c", "firmware_stub/src/library_drives.h")
"""What Python alone calls."""


@dataclass
class Tally:
    """What came out, by file."""

    of_file: dict[str, Counter[str]] = field(default_factory=dict)
    survivors: list[Mutant] = field(default_factory=list)
    listed_yet_killed: list[Mutant] = field(default_factory=list)

    def add(self, mutant: Mutant, verdict: str, *, is_listed: bool) -> None:
        """One mutant more."""
        if verdict == "survived" and is_listed:
            verdict = "listed"
        elif verdict == "survived":
            self.survivors.append(mutant)
        elif verdict in ("killed", "timeout") and is_listed:
            self.listed_yet_killed.append(mutant)
        self.of_file.setdefault(mutant.file, Counter())[verdict] += 1

    @property
    def total(self) -> Counter[str]:
        """Of all files."""
        return sum(self.of_file.values(), Counter())


def files_of(part: str | None) -> list[str]:
    """The C files of a part, of all parts, or one file by its path; BadInput where there is none."""
    folders = [folder for name, each in PARTS.items() if part in (None, name) for folder in each]
    paths = [path for folder in folders for path in sorted((SOURCE_DIR / folder).glob("*.[ch]"))]
    if part is not None and not folders:
        given = SOURCE_DIR / part
        if given.suffix not in (".c", ".h") or not given.is_file():
            raise BadInput(f"--only {part}: is neither a part ({', '.join(PARTS)}) nor a C file of the project")
        paths = [given]
    names = [path.relative_to(SOURCE_DIR).as_posix() for path in paths]
    return [name for name in names if name not in LEFT_OUT]


def place_of(seed: int, mutant: Mutant) -> bytes:
    """Its place in the order that a seed gives, by itself alone: a change elsewhere leaves a sample as it was."""
    return hashlib.sha256(f"{seed} {mutant.key}".encode()).digest()


class Campaign:
    """The mutants of some files, tried one after the other by as many threads as there are processors."""

    def __init__(self, only: str | None, seed: int, folder: Path | None = None):
        if missing := sources_missing():
            raise BadInput(f"soak mutants: needs {missing}")
        self.folder = folder or build_dir().resolve() / "mutation"
        self.mutants = [mutant for file in files_of(only) for mutant in mutants_of(SOURCE_DIR, file)]
        self.mutants.sort(key=lambda mutant: place_of(seed, mutant))
        self.tally = Tally()
        self._listed = Listed(read_equivalents(), SOURCE_DIR)
        self._lock = threading.Lock()

    def run(self, sample: int | None, until: float, advance: Callable[[float], None]) -> Tally:
        """The first `sample` mutants, or all, until that moment; what earlier runs found counts."""
        self.folder.mkdir(parents=True, exist_ok=True)
        results = Results(self.folder / "results.jsonl", {mutant.file for mutant in self.mutants})
        todo: list[Mutant] = []
        for mutant in self.mutants[:sample]:
            known = results.known(mutant)
            if known is None:
                todo.append(mutant)
            else:
                self._add(mutant, known)
        if todo:
            self._try(todo, results, until, advance)
        return self.tally

    def _try(self, todo: list[Mutant], results: Results, until: float, advance: Callable[[float], None]) -> None:
        compiled = Compiled.of((mutant.file for mutant in todo), self.folder)
        for family in compiled.families:
            family.link()
            family.check()
        trials, workers = Trials(compiled), os.cpu_count() or 1
        trees: queue.Queue[Path] = queue.Queue()
        for number in range(workers):
            trees.put(compiled.tree(number))

        todo = self._try_by_switches(todo, trials, trees, results, until, advance)

        def one(mutant: Mutant) -> Outcome:
            tree = trees.get()
            try:
                return trials.outcome(mutant, tree)
            finally:
                trees.put(tree)

        with ThreadPoolExecutor(workers) as pool:
            waiting: dict[Future[Outcome], Mutant] = {}
            left = iter(todo)
            try:
                while True:
                    while len(waiting) < workers and time.monotonic() < until and (new := next(left, None)):
                        waiting[pool.submit(one, new)] = new
                    if not waiting:
                        return
                    done: set[Future[Outcome]] = wait(waiting, return_when=FIRST_COMPLETED).done
                    for future in done:
                        mutant = waiting.pop(future)
                        results.keep(mutant, future.result())
                        self._add(mutant, future.result())
                        advance(1.0)
            finally:
                pool.shutdown(cancel_futures=True)

    def _try_by_switches(self, todo: list[Mutant], trials: Trials, trees: queue.Queue[Path], results: Results,
                         until: float, advance: Callable[[float], None]) -> list[Mutant]:
        """Those that no test notices so, those of files with few, and those of the list: what reads beyond an array
        finds other memory there, which would look like a test that notices it."""
        of_file: dict[str, list[Mutant]] = {}
        for mutant in todo:
            if not self._is_listed(mutant):
                of_file.setdefault(mutant.file, []).append(mutant)
        many = [mutants for mutants in of_file.values() if len(mutants) >= MANY]
        done: set[str] = set()
        stopped, lock = threading.Event(), threading.Lock()

        def is_over() -> bool:
            return stopped.is_set() or time.monotonic() > until

        def one(mutants: list[Mutant]) -> None:
            tree = trees.get()
            try:
                bench = None if is_over() else bench_of(mutants, trials.libraries_of(mutants[0]), tree)
                for mutant, outcome in bench.noticed(is_over) if bench else ():
                    with lock:
                        results.keep(mutant, outcome)
                        self._add(mutant, outcome)
                        done.add(mutant.key)
                        advance(1.0)
            finally:
                trees.put(tree)

        with ThreadPoolExecutor(trees.qsize()) as pool:
            try:
                list(pool.map(one, many))
            finally:
                stopped.set()
                pool.shutdown(cancel_futures=True)
        return [mutant for mutant in todo if mutant.key not in done]

    def _add(self, mutant: Mutant, outcome: Outcome) -> None:
        with self._lock:
            listed = (self._listed.reason(mutant.file, mutant.change) is not None if outcome.verdict == "survived"
                      else self._listed.no_test_can_notice(mutant.file, mutant.change))
        self.tally.add(mutant, outcome.verdict, is_listed=listed)

    def _is_listed(self, mutant: Mutant) -> bool:
        with self._lock:
            return self._listed.no_test_can_notice(mutant.file, mutant.change)
