"""MISRA C:2012 by cppcheck's addon over core, node and FMUs: minutes. misra_suppressions.txt lists the deviations.

    misra [--only PART|FILE …]

One configuration: gcc's, in double precision, with everything built in."""

from __future__ import annotations

import argparse
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from assurance.common import PARTS, TARGETS, Entry, Unusable, needed, of_targets, once

SUPPRESSIONS = Path(__file__).with_name("misra_suppressions.txt")
DEFINED = ("__GNUC__=12", "DBL_MANT_DIG=53")
UNDEFINED = ("FLT_EVAL_METHOD", "__FAST_MATH__", "__FINITE_MATH_ONLY__", "__ASSOCIATIVE_MATH__", "__RECIPROCAL_MATH__",
             "LACONIC_SCENE_HEADER", "LACONIC_LANES", "LACONIC_SINGLE", "LACONIC_PLAIN_INLINE", "__cplusplus",
             "__clang__", "_WIN32", "__SIZEOF_INT128__")
LEFT_OUT = {"batch", "derivatives", "filter", "estimate", "drives"}  # folders in which the addon takes hours


def sources(only: list[str]) -> dict[str, list[Entry]]:
    """Entries of each target of CMake, each source once, of the parts or files that were asked for."""
    seen, found = set[Path](), dict[str, list[Entry]]()
    for part, targets in TARGETS.items():
        for target in targets:
            own = [entry for entry in of_targets(target) if entry.source not in seen
                   and entry.name.startswith(PARTS[part]) and not LEFT_OUT & {*entry.source.parts}
                   and (not only or part in only or entry.name in only)]
            seen |= {entry.source for entry in own}
            found[target] = own
    return {target: own for target, own in found.items() if own}


def findings(files: list[Path], headers: list[str]) -> list[str]:
    """What the addon reports of these files."""
    with TemporaryDirectory() as made:  # else cppcheck writes beside the sources
        command = ["cppcheck", "-q", f"--cppcheck-build-dir={made}", "--std=c99", "--addon=misra", "--inline-suppr",
                   f"--suppressions-list={SUPPRESSIONS}", "--template={file}:{line}: {id}",
                   *(f"-D{name}" for name in DEFINED), *(f"-U{name}" for name in UNDEFINED), *headers, *map(str, files)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Unusable(f"cppcheck ended with status {done.returncode}: {done.stderr.strip()[-300:]}")
    own = {str(folder) for file in files for folder in (file, file.parent)}
    return sorted({line for line in done.stderr.splitlines() if "misra-c2012" in line
                   and ({line.split(":")[0], str(Path(line.split(":")[0]).parent)} & own or "laconic" in line)})


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--only", nargs="+", default=[], metavar="PART|FILE", help=f"{', '.join(PARTS)} or C files")


def run(options: argparse.Namespace) -> bool:
    """Prints each violation without a deviation."""
    needed("cppcheck")
    found = set[str]()
    for target, own in sources(options.only).items():
        headers = [flag.replace("-isystem", "-I") for flag in once(flag for entry in own for flag in entry.flags(
            "-I", "-isystem"))]
        new = findings([entry.source for entry in own], headers)
        found |= {*new}
        print(f"{target}: {len(own)} files, {len(new)} violations without a deviation", flush=True)
    print(*sorted(found), sep="\n")
    return not found
