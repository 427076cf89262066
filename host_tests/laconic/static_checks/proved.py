"""What came out of each proof last, and of which sources: `proved.json`, of which the tables of docs/proof.md are made.

A row holds as long as the files that the proof has read are the same but for comments, and Frama-C's options are;
contracts in the files count."""

from __future__ import annotations

import datetime
import hashlib
import json
import re
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path

from laconic.paths import SOURCE_DIR
from laconic.static_checks.contracts import ROOMS, Goals, Room, options_of
from laconic.static_checks.frama_c import PROGRAMS, Alarm, Analysis, Program, options_for, preprocessed, wire

KEPT = Path(__file__).parent / "proved.json"
COMMENT = re.compile(r"/\*(?!@).*?\*/|//[^\n]*", re.DOTALL)
INCLUDED = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
NUMBERED = re.compile(r"_\d+$")  # by which Frama-C tells functions of one name apart
DEFINED = re.compile(r"^(?!\s|#|\}|/|typedef\b).*?\b(\w+)\(", re.MULTILINE)


@dataclass(frozen=True)
class Row:
    """`alarms`: file, line of code and kind of each that the analyser gave; `goals`: how many WP had, `unproved` those
    that no prover closed. `failed`: why it did not end."""

    tool: str  # eva or wp
    part: str
    name: str
    ended: str
    seconds: int
    digest: str
    files: list[str]  # that were read, from the project's root
    alarms: list[list[str]] = field(default_factory=list)
    goals: int = 0
    unproved: list[str] = field(default_factory=list)
    functions: list[str] = field(default_factory=list)
    statements: int = 0
    reached: int = 0
    failed: str = ""

    @property
    def key(self) -> str:
        """One row each."""
        return f"{self.tool} {self.part}: {self.name}"

    @property
    def open(self) -> list[str]:
        """Alarms that no argument of today discharges, and goals that no prover closed."""
        alarms = [Alarm(f"prove_{self.name}", file, 0, code, what) for file, code, what in self.alarms]
        return [f"{each.file}: {each.what} ({self.name}): {each.code}" for each in alarms
                if not each.discharged] + self.unproved

    @property
    def holds(self) -> bool:
        """It ended, and nothing is open."""
        return not self.failed and not self.open

    def is_of_these_sources(self) -> bool:
        """Whether what it has read is still the same, by the same options."""
        options = options_of_row(self.tool, self.part, self.name)
        return bool(self.files) and self.digest == digest_of(self.files, options)


def wanted() -> list[str]:
    """The keys of all proofs that there are, in the order in which they run."""
    analysed = [f"eva {program.name}: {entry.removeprefix('prove_')}" for program in PROGRAMS
                for entry in program.entries()]
    return [*analysed, *(f"wp {room.program.name}: {room.name}" for room in ROOMS)]


def read_kept(path: Path = KEPT) -> dict[str, Row]:
    """All rows by key, of proofs that there are."""
    rows = [Row(**row) for row in json.loads(path.read_text(encoding="utf-8"))] if path.is_file() else []
    there = set(wanted())
    return {row.key: row for row in rows if row.key in there}


def keep(row: Row, path: Path = KEPT) -> None:
    """Adds or replaces one row; one line each, so that versions can be merged."""
    rows = read_kept(path) | {row.key: row}
    lines = [json.dumps(asdict(rows[key]), ensure_ascii=False) for key in wanted() if key in rows]
    path.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


def row_of_analysis(program: Program, entry: str, seconds: float, found: Analysis) -> Row:
    """What the analyser has found for one entry."""
    given = program.files()
    known = set().union(*(_defined(SOURCE_DIR / path) for path in given))
    functions = sorted({name if name in known else NUMBERED.sub("", name) for name in found.functions})
    files = files_read(given, functions, program)
    name = entry.removeprefix("prove_")
    digest = digest_of(files, options_of_row("eva", program.name, name))
    return Row("eva", program.name, name, _today(), round(seconds), digest, files,
               [[alarm.file, alarm.code.strip(), alarm.what] for alarm in found.alarms], functions=functions,
               statements=found.statements, reached=found.reached)


def row_of_goals(room: Room, seconds: float, goals: Goals) -> Row:
    """What WP has found for one room."""
    files = closure(room.files, room.program)
    digest = digest_of(files, options_of_row("wp", room.program.name, room.name))
    return Row("wp", room.program.name, room.name, _today(), round(seconds), digest, files,
               goals=goals.count, unproved=goals.open, functions=sorted(room.functions))


def row_of_failure(key: str, seconds: float, why: str) -> Row:
    """A proof that did not end."""
    tool, rest = key.split(" ", 1)
    part, name = rest.split(": ")
    return Row(tool, part, name, _today(), round(seconds), "", [], failed=why)


def _today() -> str:
    return datetime.datetime.now(datetime.UTC).date().isoformat()


# ------------------------------------------------------------------------------------ which sources


def files_read(given: Iterable[Path], functions: Iterable[str], program: Program) -> list[str]:
    """Of the files that were given those with a function that was followed, and what they include."""
    followed = set(functions)
    found = [str(path) for path in given if followed & _defined(SOURCE_DIR / path)]
    return closure(found, program)


def closure(files: Iterable[str], program: Program) -> list[str]:
    """Files of the project with all that they include; what the build makes follows from laconic.dbc."""
    folders = [SOURCE_DIR / folder for folder in program.folders]
    waiting, found = [SOURCE_DIR / file for file in files], set()
    while waiting:
        path = waiting.pop()
        if path.is_relative_to(wire()):
            path = SOURCE_DIR / "firmware_stub" / "laconic.dbc"
        if path in found:
            continue
        found.add(path)
        for name in INCLUDED.findall(_text(path)):
            waiting += [place for place in (path.parent / name, *(folder / name for folder in folders), wire() / name)
                        if place.is_file()][:1]
    return sorted(str(path.relative_to(SOURCE_DIR)) for path in found)


@cache
def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


@cache
def _defined(path: Path) -> set[str]:
    return set(DEFINED.findall(_text(path)))


def options_of_row(tool: str, part: str, name: str) -> list[str]:
    """All that Frama-C is told beside the files; the place of the build is none of it."""
    if tool == "wp":
        room = next(room for room in ROOMS if room.name == name)
        program, options = room.program, [*room.files, *options_of(room)]
    else:
        program = next(program for program in PROGRAMS if program.name == part)
        options = [*program.sources, *program.without, *options_for(f"prove_{name}")]
    return [option.replace(str(wire()), "wire") for option in (*preprocessed(program), *options)]


def digest_of(files: Iterable[str], options: Iterable[str]) -> str:
    """Of the options, and of the texts without comments and without space; a file that is gone counts as empty."""
    made = hashlib.sha256("\0".join(options).encode())
    for file in files:
        path = SOURCE_DIR / file
        made.update((_bare(path) if path.is_file() else "").encode() + b"\0")
    return made.hexdigest()[:16]


@cache
def _bare(path: Path) -> str:
    """A source without comments and without space."""
    return "".join(COMMENT.sub(" ", _text(path)).split())
