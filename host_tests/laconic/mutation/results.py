"""What came out, kept as JSON lines so that a run goes on where the last one ended."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from laconic.mutation.operators import Mutant
from laconic.mutation.trial import Outcome
from laconic.paths import SOURCE_DIR


class Results:
    """Outcomes by mutant. One is known as long as its file is the same; and a survivor, as long as the tests are."""

    def __init__(self, path: Path, files: Iterable[str]):
        self.path = path
        self._tests = fingerprint(*(SOURCE_DIR / folder for folder in ("core_c/tests", "firmware_stub/tests",
                                                                       "fmu/tests")))
        self._files = {file: fingerprint(SOURCE_DIR / file) for file in files}
        self._known: dict[str, tuple[str, str, Outcome]] = {}
        if path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                self._take(line)

    def _take(self, line: str) -> None:
        try:
            row = json.loads(line)
            outcome = Outcome(row["verdict"], row["by"], row["seconds"])
            self._known[row["key"]] = row["source"], row["tests"], outcome
        except (ValueError, KeyError):
            pass  # the last line of a run that was killed

    def known(self, mutant: Mutant) -> Outcome | None:
        """What became of it in an earlier run, if that still holds."""
        source, tests, outcome = self._known.get(mutant.key, ("", "", Outcome("")))
        holds = source == self._files[mutant.file] and (outcome.verdict != "survived" or tests == self._tests)
        return outcome if holds else None

    def keep(self, mutant: Mutant, outcome: Outcome) -> None:
        """Adds a line."""
        row = {key: value for key, value in asdict(mutant).items() if key not in ("start", "end", "text")}
        row |= {**asdict(outcome), "source": self._files[mutant.file], "tests": self._tests}
        self._known[mutant.key] = row["source"], self._tests, outcome
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row, ensure_ascii=False) + "\n")


def fingerprint(*paths: Path) -> str:
    """Of files, or of the C files of folders."""
    files = [file for path in paths for file in (sorted(path.rglob("*.[ch]")) if path.is_dir() else [path])]
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()[:16]
