"""Frama-C's analyser EVA over calls of every public function with any input: its alarms, less those that an argument
discharges.

An alarm is a place at which the analyser could not exclude undefined behaviour: an index beyond an array, memory that
was not set, a signed sum beyond its range, a number that does not fit an integer."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from laconic.errors import BadInput
from laconic.paths import SOURCE_DIR, build_dir
from laconic.static_checks.discharged import DISCHARGED

ENTRY = re.compile(r"^void (prove_\w+)\(void\)", re.MULTILINE)
ALARM = re.compile(r"^\[eva:alarm\] (?P<file>[^:]+):(?P<line>\d+): Warning:(?P<text>[^\[]*)", re.MULTILINE)
ENDED = "ANALYSIS SUMMARY"
RELATIONS = ("-eva-domains", "equality,symbolic-locations")
OPTIONS = ("-warn-special-float", "none",  # infinities and NaN are numbers like others
           "-eva-precision", "1", "-eva-split-return", "auto", "-eva-auto-loop-unroll", "20", "-eva-no-print",
           "-eva-msg-key=-initial-state,-final-states", "-no-unicode")
TOO_MUCH = ("prove_contact_prepare", "prove_matrices", "prove_friction_of")
"""Entries on which Frama-C 25 ends with a fault of its own where it follows relations."""


@dataclass(frozen=True)
class Program:
    """What the analyser reads of one part, and its entries."""

    name: str
    harness: str
    sources: tuple[str, ...]
    folders: tuple[str, ...]
    defined: tuple[str, ...] = ()

    def entries(self) -> list[str]:
        """The functions of the harness that call the part's."""
        return ENTRY.findall((SOURCE_DIR / self.harness).read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Alarm:
    """`code`: the source line at which it stands, which outlives changes above it."""

    entry: str
    file: str
    line: int
    code: str
    what: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.what} ({self.entry})"

    @property
    def discharged(self) -> bool:
        """Whether an argument says why it cannot happen."""
        return any(file == self.file and part in self.code and kind in self.what for file, part, kind, _ in DISCHARGED)


CORE = Program("core", "core_c/proof/core.c", ("core_c/src/*.c",), ("core_c/include", "core_c/src"))
NODE = Program("node", "firmware_stub/proof/node.c", ("core_c/src/*.c", "firmware_stub/src/*.c"),
               ("core_c/include", "core_c/src", "firmware_stub/include", "firmware_stub/drives", "firmware_stub/src"),
               ("LACONIC_NODE_WITH_DRIVES=0",))
PROGRAMS = (CORE, NODE)


def prove(program: Program, entry: str, limit_s: float = 3600.0) -> list[Alarm]:
    """The alarms of one entry; BadInput where the analyser is not there or does not end well."""
    if shutil.which("frama-c") is None:
        raise BadInput("soak proof: there is no frama-c; install it (Debian's package frama-c-base)")
    command = ["frama-c", *_language(program), *_sources(program), "-eva", "-main", entry, *OPTIONS,
               *(() if entry in TOO_MUCH else RELATIONS)]
    try:
        ran = subprocess.run(command, cwd=SOURCE_DIR, capture_output=True, text=True, check=False, timeout=limit_s)
    except subprocess.TimeoutExpired as long:
        raise BadInput(f"soak proof: {entry}: did not end within {limit_s:g} s") from long
    if ran.returncode != 0 or ENDED not in ran.stdout:
        raise BadInput(f"soak proof: {entry}: frama-c ended with status {ran.returncode}: {ran.stdout[-300:]}")
    return alarms_of(entry, ran.stdout)


def alarms_of(entry: str, printed: str) -> list[Alarm]:
    """Each place with its kind once."""
    found = {}
    for match in ALARM.finditer(printed):
        line, what = int(match["line"]), " ".join(match["text"].split())
        if "assertion got status" in what and not match["file"].startswith(("core_c/proof", "firmware_stub/proof")):
            continue
        alarm = Alarm(entry, match["file"], line, code_at(match["file"], line), what)
        found[alarm.file, alarm.line, alarm.what] = alarm
    return list(found.values())


@cache
def _lines(file: str) -> list[str]:
    path = SOURCE_DIR / file
    return path.read_text(encoding="utf-8").splitlines() if path.is_file() else []


def code_at(file: str, line: int) -> str:
    """A line of a source file."""
    lines = _lines(file)
    return lines[line - 1] if 0 < line <= len(lines) else ""


def _wire() -> Path:
    return build_dir() / "firmware_stub" / "wire"


def _language(program: Program) -> list[str]:
    folders = [*program.folders, *([str(_wire())] if program is NODE else [])]
    macros = ["-DLACONIC_PLAIN_INLINE", *(f"-D{name}" for name in program.defined), "-U__GNUC__"]
    options = ["-std=c99", *macros, *(f"-I{each}" for each in folders)]
    return ["-machdep", "gcc_x86_64", "-cpp-extra-args=" + " ".join(options)]


def _sources(program: Program) -> list[str]:
    paths = [path for pattern in program.sources for path in sorted(SOURCE_DIR.glob(pattern))]
    found = [path for path in paths if "library" not in path.name]
    made = sorted(_wire().glob("*.c")) if program is NODE else []
    return [*(str(path.relative_to(SOURCE_DIR)) for path in found), *map(str, made), program.harness]
