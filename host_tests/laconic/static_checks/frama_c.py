"""Frama-C's analyser EVA over calls of every public function with any input: its alarms, less those that an argument
discharges.

An alarm is a place at which the analyser could not exclude undefined behaviour: an index beyond an array, memory that
was not set, a signed sum beyond its range, a number that does not fit an integer."""

from __future__ import annotations

import os
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
STAND_IN = re.compile(r"^(?!static\b)\w[\w ]*?[ *](laconic_\w+)\(", re.MULTILINE)
HARNESS_HEADER = re.compile(r'^#include "(\w+_stand_in\.h)"', re.MULTILINE)
ALARM = re.compile(r"^\[eva:alarm\] (?P<file>[^:]+):(?P<line>\d+): Warning:(?P<text>[^\[]*)", re.MULTILINE)
REACHED = re.compile(r"^  (\w+): \d+ stmts out of \d+ ", re.MULTILINE)
COUNTED = re.compile(r"^  (\d+) stmts in analyzed functions, (\d+) stmts analyzed", re.MULTILINE)
MISSING = re.compile(r"Neither code nor specification for function (laconic_\w+)")
ENDED = "ANALYSIS SUMMARY"
OPTIONS = ("-warn-special-float", "none",  # infinities and NaN are numbers like others
           "-eva-precision", "1", "-eva-split-return", "auto", "-eva-auto-loop-unroll", "20", "-eva-no-print",
           "-eva-domains", "equality,symbolic-locations", "-metrics-eva-cover",
           "-eva-msg-key=-initial-state,-final-states", "-no-unicode")
PARSING_S = 600.0
OPTIONS_OF: dict[str, tuple[str, ...]] = {
    **{f"prove_friction_step_{wheels}": ("-eva-min-loop-unroll", str(wheels + 1)) for wheels in range(17)},
    "prove_integrity": ("-eva-precision", "0", "-eva-auto-loop-unroll", "0"),  # hours otherwise
}
"""Of entries with one number of wheels: each round of a loop over them is followed by itself."""
FOLDED = r's/\[\(?(\d+) ([*+]) (\d+)\)?\]/"[".eval("$1$2$3")."]"/ge'
"""Lengths of arrays such as [2 * 16] as one number: Frama-C 25 ends with a fault of its own at a sum or product."""


@dataclass(frozen=True)
class Program:
    """What the analyser reads of one part, and its entries: functions of the harnesses that call the part's."""

    name: str
    harnesses: str
    sources: tuple[str, ...]
    folders: tuple[str, ...]
    defined: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()  # names of entries
    without: tuple[str, ...] = ()  # files of which the harness has stand-ins

    def entries(self) -> dict[str, str]:
        """Entry → the file in which it is."""
        found = {entry: str(path.relative_to(SOURCE_DIR)) for path in sorted(SOURCE_DIR.glob(self.harnesses))
                 for entry in ENTRY.findall(path.read_text(encoding="utf-8"))}
        return {entry: path for entry, path in found.items()
                if entry.removeprefix("prove_") not in self.left_out}

    def files(self) -> list[Path]:
        """The C files that are given to the analyser; those that the build makes with their whole path."""
        paths = [path for pattern in self.sources for path in sorted(SOURCE_DIR.glob(pattern))]
        found = [path.relative_to(SOURCE_DIR) for path in paths
                 if "library" not in path.name and path.name not in self.without]
        made = sorted(wire().glob("*.c")) if self.reads_wire() else []
        return [*found, *made, *map(Path, dict.fromkeys(self.entries().values()))]

    def stand_ins(self) -> set[str]:
        """Functions of the project that a harness, or a header of harnesses that it includes, writes anew: no run of
        this program follows the real ones."""
        texts = [(SOURCE_DIR / path).read_text(encoding="utf-8") for path in set(self.entries().values())]
        headers = {header for text in texts for header in HARNESS_HEADER.findall(text)}
        texts += [(SOURCE_DIR / "core_c" / "proof" / header).read_text(encoding="utf-8") for header in headers]
        return {name for text in texts for name in STAND_IN.findall(text)}

    def reads_wire(self) -> bool:
        """Whether it needs the tables that the build makes of laconic.dbc."""
        return any(folder.startswith("firmware_stub") for folder in self.folders)

    def language(self) -> list[str]:
        """Options of the preprocessor."""
        folders = [*self.folders, *([str(wire())] if self.reads_wire() else [])]
        macros = ["-DLACONIC_PLAIN_INLINE", *(f"-D{name}" for name in self.defined), "-U__GNUC__"]
        return ["-std=c99", *macros, *(f"-I{each}" for each in folders)]


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
        return any(argument.meets(self.entry, self.file, self.code, self.what) for argument in DISCHARGED)


@dataclass(frozen=True)
class Analysis:
    """What came out for one entry: alarms, the functions that were followed, and how many statements of theirs."""

    alarms: list[Alarm]
    functions: list[str]
    statements: int
    reached: int


CORE_FOLDERS = ("core_c/include", "core_c/src", "core_c/proof")
NODE_FOLDERS = (*CORE_FOLDERS, "firmware_stub/include", "firmware_stub/drives", "firmware_stub/src")
CORE = Program("core", "core_c/proof/*.c", ("core_c/src/*.c",), CORE_FOLDERS)
SINGLE = Program("core, single", "core_c/proof/*.c", ("core_c/src/*.c",), CORE_FOLDERS, ("LACONIC_SINGLE",),
                 left_out=(*(f"friction_step_{wheels}" for wheels in range(17) if wheels != 4),
                           *(f"refused_{method}" for method in (
                               "rk4", "exponential_kahan", "exponential_kahan_4", "exact_flow", "exact_flow_4",
                               "taylor_8", "exponential_gauss_8", "auto"))))
PLANTS = Program("plants", "core_c/proof/plants/*.c", CORE.sources, CORE_FOLDERS, without=("friction_step.c",))
ESTIMATES = Program("estimates", "core_c/proof/estimates/*.c", ("core_c/src/*.c", "core_c/estimate/*.c"),
                    (*CORE_FOLDERS, "core_c/estimate"), without=PLANTS.without)
NODE = Program("node", "firmware_stub/proof/node.c", ("core_c/src/*.c", "firmware_stub/src/*.c"), NODE_FOLDERS,
               ("LACONIC_NODE_WITH_DRIVES=0",))
FRAMES = Program("node, on frames", "firmware_stub/proof/frames.c", NODE.sources, NODE_FOLDERS, NODE.defined,
                 without=("plant.c", "sensors.c", "loader.c"))
WATCHED = Program("node, watched", "firmware_stub/proof/watched/*.c",
                  ("core_c/src/*.c", "firmware_stub/src/integrity.c"), NODE_FOLDERS, NODE.defined)
DRIVES = Program("drives", "firmware_stub/proof/drives/*.c",
                 ("core_c/src/*.c", "firmware_stub/drives/*.c", "firmware_stub/drives/*/*.c"), NODE_FOLDERS,
                 left_out=("drives_by_canopen", "drives_by_moteus"),  # not run to their ends: minutes
                 without=("plant.c",))
SECURE = Program("secure", "firmware_stub/proof/secure.c", ("firmware_stub/secure/*.c",), NODE_FOLDERS, NODE.defined)
DERIVATIVES = Program("derivatives", "core_c/proof/parts/derivatives*.c",
                      ("core_c/src/*.c", "core_c/derivatives/*.c"), CORE_FOLDERS)
FILTER = Program("filter", "core_c/proof/parts/filter.c", (*DERIVATIVES.sources, "core_c/filter/*.c"), CORE_FOLDERS)
PROGRAMS = (CORE, SINGLE, PLANTS, NODE, FRAMES, WATCHED, DRIVES, SECURE, ESTIMATES, DERIVATIVES, FILTER)
"""In the order in which they run."""


def prove(program: Program, entry: str, limit_s: float = 3600.0) -> Analysis:
    """One entry; BadInput where the analyser is not there or does not end well."""
    if shutil.which("frama-c") is None:
        raise BadInput("soak proof: there is no frama-c; install it (Debian's package frama-c-base)")
    command = ["frama-c", "-load", str(_parsed(program)), "-eva", "-main", entry, *options_for(entry)]
    ran = run_frama_c(entry, command, limit_s)
    if ran.returncode != 0 or ENDED not in ran.stdout:
        raise BadInput(f"soak proof: {entry}: frama-c ended with status {ran.returncode}: {_last_words(ran)}")
    if (missing := MISSING.search(ran.stdout)) is not None:
        raise BadInput(f"soak proof: {entry}: calls {missing[1]}(), which is in none of the files")
    if _changed_since(_parsed(program), program):
        raise BadInput(f"soak proof: {entry}: a source changed while it ran; run it again")
    return analysis_of(entry, ran.stdout)


def options_for(entry: str) -> tuple[str, ...]:
    """Of the analyser for one entry."""
    return (*OPTIONS, *OPTIONS_OF.get(entry, ()))


@cache
def _parsed(program: Program) -> Path:
    """All files of a program, parsed once for all its entries."""
    kept = build_dir() / "proof" / (re.sub(r"\W+", "-", program.name) + ".sav")
    kept.parent.mkdir(parents=True, exist_ok=True)
    command = ["frama-c", *preprocessed(program), *map(str, program.files()), "-save", str(kept)]
    ran = run_frama_c(program.name, command, PARSING_S)
    if ran.returncode != 0:
        raise BadInput(f"soak proof: {program.name}: frama-c cannot read the sources: {_last_words(ran)}")
    return kept


def run_frama_c(name: str, command: list[str], limit_s: float) -> subprocess.CompletedProcess[str]:
    """From the sources' root, which Frama-C takes from PWD; BadInput where it does not end within the time."""
    environment = {**os.environ, "PWD": str(SOURCE_DIR)}
    try:
        return subprocess.run(command, cwd=SOURCE_DIR, env=environment, capture_output=True, text=True, check=False,
                              timeout=limit_s)
    except subprocess.TimeoutExpired as long:
        raise BadInput(f"soak proof: {name}: did not end within {limit_s:g} s") from long


def _last_words(ran: subprocess.CompletedProcess[str]) -> str:
    """Of what it printed, what may tell why it stopped."""
    return " ".join((ran.stdout[-300:] + ran.stderr[-300:]).split())


def _changed_since(parsed: Path, program: Program) -> bool:
    """Whether a file of the program, or a header of its folders, is newer."""
    headers = [path for folder in program.folders for path in (SOURCE_DIR / folder).rglob("*.h")]
    files = [*(SOURCE_DIR / path for path in program.files()), *headers]
    return any(path.stat().st_mtime > parsed.stat().st_mtime for path in files)


def preprocessed(program: Program) -> list[str]:
    """Options by which Frama-C reads the sources as a compiler does."""
    command = f"gcc -E -C {' '.join(program.language())} %args %input | perl -pe '{FOLDED}' > %output"
    return ["-machdep", "gcc_x86_64", "-cpp-frama-c-compliant", "-cpp-command", command]


def analysis_of(entry: str, printed: str) -> Analysis:
    """What the analyser printed."""
    counts = COUNTED.search(printed)
    statements, reached = (int(counts[1]), int(counts[2])) if counts else (0, 0)
    return Analysis(alarms_of(entry, printed), sorted(set(REACHED.findall(printed))), statements, reached)


def alarms_of(entry: str, printed: str) -> list[Alarm]:
    """Each place with its kind once. What a comment of the sources claims is for `contracts.py` to prove."""
    found = {}
    for match in ALARM.finditer(printed):
        line, what = int(match["line"]), " ".join(match["text"].split())
        if _is_claim(what, match["file"]):
            continue
        alarm = Alarm(entry, match["file"], line, code_at(match["file"], line), what)
        found[alarm.file, alarm.line, alarm.what] = alarm
    return list(found.values())


def _is_claim(what: str, file: str) -> bool:
    """A contract that WP proves, or an assertion of Frama-C's own library; what a caller must grant is no claim, and an
    assertion of ours needs an argument as an alarm does."""
    ours = file.startswith(("core_c/", "firmware_stub/"))
    kinds = ("postcondition", "loop invariant") if ours else ("assertion",)
    return "got status" in what and any(kind in what for kind in kinds)


@cache
def _lines(file: str) -> list[str]:
    path = SOURCE_DIR / file
    return path.read_text(encoding="utf-8").splitlines() if path.is_file() else []


def code_at(file: str, line: int) -> str:
    """A line of a source file."""
    lines = _lines(file)
    return lines[line - 1] if 0 < line <= len(lines) else ""


def wire() -> Path:
    """Where the build makes C of laconic.dbc."""
    return build_dir() / "firmware_stub" / "wire"
