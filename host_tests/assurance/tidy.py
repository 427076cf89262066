"""clang-tidy over core, node and FMUs, by the checks of .clang-tidy, which states why some are off: minutes.

    tidy [--only PART|FILE …]"""

from __future__ import annotations

import argparse
import re
import subprocess

from assurance.common import CORES, PARTS, ROOT, TARGETS, Entry, needed, of_targets

FINDING = re.compile(r"^(\S+:\d+):\d+: (?:warning|error): .*\[([\w.,-]+)\]$", re.MULTILINE)
LEFT_OUT = {"batch"}            # the text of the methods once more
NO_PROGRAM = {"derivations.c"}  # a list that others include


def findings(own: list[Entry]) -> set[str]:
    """Place and check of each finding."""
    jobs = [(entry, subprocess.Popen(["clang-tidy", "--quiet", entry.source, "--", "-std=c99", *entry.headers()],
                                     cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True))
            for entry in own]
    return {f"{place.removeprefix(f'{ROOT}/')} {check}" for _, job in jobs
            for place, check in FINDING.findall(job.communicate()[0])}


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--only", nargs="+", default=[], metavar="PART|FILE", help=f"{', '.join(PARTS)} or C files")


def run(options: argparse.Namespace) -> bool:
    """Prints each finding; every one is an error."""
    needed("clang-tidy")
    found, seen = set[str](), 0
    for part, targets in TARGETS.items():
        own = [entry for entry in of_targets(*targets) if entry.name.startswith(PARTS[part])
               and not LEFT_OUT & {*entry.source.parts} and entry.source.name not in NO_PROGRAM
               and (not options.only or part in options.only or entry.name in options.only)]
        for at in range(0, len(own), CORES):
            found |= findings(own[at:at + CORES])
        seen += len(own)
    print(*sorted(found), f"{seen} files, {len(found)} findings", sep="\n")
    return not found
