"""Frama-C's analyser EVA over calls of public functions of core and node on any input: every number may be any, also an
infinity or NaN. It follows all inputs at once and reports each place at which it cannot exclude undefined behaviour.

    proof [--only ENTRY] [--places]

Fails where memory could be accessed outside of its object, a function pointer be wrong, or an integer be divided by
zero. Other alarms (a conversion, a sum, a number that was not set) are counted by kind, for a reader to judge: the
analyser merges what a loop or a flag keeps apart. An entry takes seconds to a minute."""

from __future__ import annotations

import argparse
import re
import subprocess
from collections import Counter
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from assurance.common import ROOT, Unusable, called, needed, of_targets, once, work

HERE = Path(__file__).parent
SOURCES = {"core.c": ("core_c/src/",), "node.c": ("core_c/src/", "firmware_stub/node/", "firmware_stub/wire/")}
OPTIONS = ("-warn-special-float", "none",  # infinities and NaN are numbers like others
           "-eva-precision", "1", "-eva-split-return", "auto", "-eva-auto-loop-unroll", "20", "-eva-no-print",
           "-eva-domains", "equality,symbolic-locations", "-metrics-eva-cover",
           "-eva-msg-key=-initial-state,-final-states", "-no-unicode")
FOLDED = r's/\[\(?(\d+) ([*+]) (\d+)\)?\]/"[".eval("$1$2$3")."]"/ge'
"""Lengths of arrays such as [2 * 16] as one number: Frama-C 25 ends with a fault of its own at a sum or product."""
ALARM = re.compile(r"^\[eva:alarm\] ([^:]+):(\d+): Warning:\s*([^\[]*?)\.\s", re.MULTILINE)
ENTRY = re.compile(r"^void (prove_\w+)\(void\)", re.MULTILINE)
REACHED = re.compile(r"^  (\d+) stmts in analyzed functions, (\d+) stmts analyzed", re.MULTILINE)
GRAVE = ("out of bounds", "accessing out", "pointer", "division by zero", "invalid", "function")
LIMIT_S = 1800.0
UNROLLED = {"prove_matrices": "17", "prove_contact_prepare": "17", "prove_friction_step": "5"}
"""Entries in which each round of a loop over wheels is followed by itself."""
ACCEPTED = {
    "message.c": "a text has room for its size, which the line before tests; texts and paths end with 0",
    "contact.c": "an index of a support runs from the wheels on, and below them a wheel is taken",
    "friction.c": "an index of a support runs from the wheels on, and below them a wheel is taken",
    "raw_frames.c": "a number is chosen before by the same function; a slot is filled up to its size",
    "loader.c": "find() refuses an item beyond its field's, so that its place lies within the parameters",
    "slcan.c": "a line has room for a frame of the most bytes",
    "protection.c": "a list has sixteen entries, and the index is masked to sixteen",
}
"""Files with grave alarms that cannot happen, and why: the analyser forgets what two lines have in common."""


@cache
def parsed(harness: str) -> Path:
    """All sources of a harness, parsed once for all its entries."""
    own = [entry for entry in of_targets("laconic_objects_double", "laconic_node_double", "laconic_wire")
           if entry.name.startswith(SOURCES[harness]) or ("node.c" in harness and entry.target == "laconic_wire")]
    flags = once(flag.replace("-isystem", "-I") for entry in own
                 for flag in entry.flags("-I", "-isystem", "-DLACONIC_NODE_WITH"))
    if harness == "node.c":
        flags += ["-ULACONIC_NODE_WITH_DRIVES", "-DLACONIC_NODE_WITH_DRIVES=0"]
    return parse([*(entry.source for entry in own if "batch" not in entry.source.parts), HERE / harness], flags,
                 work("proof") / f"{harness}.sav")


def parse(files: list[Path], flags: list[str], out: Path) -> Path:
    language = ["-std=c99", "-DLACONIC_PLAIN_INLINE", "-U__GNUC__", *flags, f"-I{HERE}"]
    command = f"gcc -E -C {' '.join(language)} %args %input | perl -pe '{FOLDED}' > %output"
    called(["frama-c", "-machdep", "gcc_x86_64", "-cpp-frama-c-compliant", "-cpp-command", command, *files, "-save",
            out])
    return out


def analysed(sources: Path, entry: str) -> str:
    """What the analyser prints of one entry."""
    more = ("-eva-min-loop-unroll", UNROLLED[entry]) if entry in UNROLLED else ()
    command = ["frama-c", "-load", str(sources), "-eva", "-main", entry, *OPTIONS, *more]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    if done.returncode != 0 or "ANALYSIS SUMMARY" not in done.stdout:
        raise Unusable(f"{entry}: frama-c ended with status {done.returncode}: {(done.stdout + done.stderr)[-300:]}")
    return done.stdout


def alarms_in(printed: str) -> list[tuple[str, str]]:
    """Place and kind of each alarm once."""
    return sorted({(f"{Path(file).name}:{line}", " ".join(what.split()))
                   for file, line, what in ALARM.findall(printed)})


def alarms(files: list[Path], flags: list[str], entry: str) -> list[tuple[str, str]]:
    """Those of an entry of any files."""
    with TemporaryDirectory() as folder:
        return alarms_in(analysed(parse(files, flags, Path(folder, "some.sav")), entry))


def entries() -> dict[str, str]:
    """Name → harness."""
    return {name.removeprefix("prove_"): harness for harness in SOURCES
            for name in ENTRY.findall((HERE / harness).read_text(encoding="utf-8"))}


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--only", metavar="ENTRY", help=", ".join(entries()))
    parser.add_argument("--places", action="store_true", help="prints the place of each alarm")


def run(options: argparse.Namespace) -> bool:
    """Each entry, or one."""
    needed("frama-c", "gcc", "perl")
    known = entries()
    if options.only is not None and options.only not in known:
        raise Unusable(f"--only {options.only}: is no entry; known are {', '.join(known)}")
    sound = True
    for name in known if options.only is None else (options.only,):
        printed = analysed(parsed(known[name]), f"prove_{name}")
        found = alarms_in(printed)
        grave = [(place, what) for place, what in found if any(word in what for word in GRAVE)]
        wrong = [(place, what) for place, what in grave if place.partition(":")[0] not in ACCEPTED]
        total, reached = (*REACHED.findall(printed), ("0", "0"))[0]
        kinds = ", ".join(f"{count} {what}" for what, count in Counter(what for _, what in found).items()) or "no alarm"
        print(f"{name}: {reached} of {total} statements, {kinds}", flush=True)
        for place, what in found if getattr(options, "places", False) else wrong:
            print(f"  {place} {what}")
        sound &= not wrong
    return sound
