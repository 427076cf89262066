"""The file of a population: a line that says what it is, then a line for each vehicle that is done, in their order.

Whatever ends the program, the lines that are whole stay, and the next run goes on after them.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

from laconic.errors import BadInput, reason_of
from laconic.outputs import make_folder
from laconic.paths import library
from laconic.population.measure import Row

FILE = "population.jsonl"


@dataclass(frozen=True)
class About:
    """What a population is made of; `core`: a digest of the library that it measures."""

    seed: int
    vehicles: int
    methods: tuple[str, ...]
    real: str
    core: str


def core_digest(real: str = "double") -> str:
    """Of the core's library."""
    return hashlib.sha256(library(f"laconic_{real}").read_bytes()).hexdigest()[:16]


class Store:
    """A folder with the rows of the vehicles that are done."""

    def __init__(self, folder: Path, about: About):
        self.path, self.about = folder / FILE, about
        make_folder(folder)
        self.done = self._read()
        self._write_whole()

    def _read(self) -> list[list[Row]]:
        """Rows of each vehicle that is done; BadInput where another population is there."""
        try:
            lines = self.path.read_bytes().split(b"\n")[:-1]  # what stands behind the last end of a line is not whole
        except FileNotFoundError:
            return []
        except OSError as error:
            raise BadInput(f"{self.path}: cannot be read ({reason_of(error)}); give another --out") from None
        try:
            there, *rows = [json.loads(line) for line in lines] or [asdict(self.about)]
            there["methods"] = tuple(there["methods"])
            different = [name for name, value in asdict(self.about).items() if there[name] != value]
        except (ValueError, KeyError, TypeError):
            raise BadInput(f"{self.path}: is no file of a population; give another --out") from None
        if different:
            raise BadInput(f"{self.path}: holds a population that differs in {', '.join(different)}; give another "
                           "--out, or remove it")
        return rows

    def _write_whole(self) -> None:
        """The file with whole lines only, ready for the next one."""
        fresh = self.path.with_suffix(".fresh")
        try:
            fresh.write_bytes(b"".join(line(each) for each in (asdict(self.about), *self.done)))
            fresh.replace(self.path)
        except OSError as error:
            raise self._full(error) from None

    def keep(self, rows: list[Row]) -> None:
        """The next vehicle's rows."""
        try:
            with self.path.open("ab") as file:
                file.write(line(rows))
        except OSError as error:
            raise self._full(error) from None
        self.done.append(rows)

    def _full(self, error: OSError) -> BadInput:
        return BadInput(f"{self.path}: cannot be written ({reason_of(error)}); make room, or give another --out")


def line(content: object) -> bytes:
    return json.dumps(content).encode() + b"\n"
