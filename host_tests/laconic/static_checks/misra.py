"""MISRA C:2012 by cppcheck's addon: what it finds, counted by rule and part, against the deviations that are stated."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

from laconic.errors import BadInput
from laconic.paths import SOURCE_DIR
from laconic.static_checks.deviations import DEVIATIONS
from laconic.static_checks.parts import PARTS, Part

COLUMNS = ("core", "node", "FMU")
# One configuration: gcc's, in double, with everything. Each further one would multiply the time.
DEFINED = ("__GNUC__=12", "DBL_MANT_DIG=53")
UNDEFINED = ("FLT_EVAL_METHOD", "__FAST_MATH__", "__FINITE_MATH_ONLY__", "__ASSOCIATIVE_MATH__", "__RECIPROCAL_MATH__",
             "LACONIC_SCENE_HEADER", "LACONIC_LANES", "LACONIC_SINGLE", "LACONIC_PLAIN_INLINE", "__cplusplus",
             "__clang__", "_WIN32", "__SIZEOF_INT128__")
LINE = re.compile(r"^(?P<file>[^|]+)\|(?P<line>\d+)\|misra-c2012-(?P<rule>[\d.]+)\|", re.MULTILINE)

Finding = tuple[str, str, int]
"""Rule, file and line."""
Counts = dict[str, Counter[str]]
"""Rule → column → how many places."""


def findings_of(part: Part, files: Iterable[Path] | None = None) -> set[Finding]:
    """What the addon reports of a part's files, or of these files with the part's options, each place once."""
    if shutil.which("cppcheck") is None:
        raise BadInput("soak misra: there is no cppcheck; install it (Debian's package brings the addon misra)")
    with TemporaryDirectory() as made:  # else cppcheck writes what it makes beside the sources
        text = _printed(part, part.files() if files is None else files, made)
    found = {(match["rule"], match["file"], int(match["line"])) for match in LINE.finditer(text)}
    own = set(map(str, files or ()))
    return {finding for finding in found  # without headers that we made or others wrote
            if finding[1] in own or not Path(finding[1]).is_absolute()}


def _printed(part: Part, files: Iterable[Path], made: str) -> str:
    command = ["cppcheck", "-q", f"--cppcheck-build-dir={made}", "--std=c99", "--addon=misra", "--inline-suppr",
               "--template={file}|{line}|{id}|{message}",
               *(f"-D{name}" for name in DEFINED), *(f"-U{name}" for name in UNDEFINED),
               *(option for folder in part.includes() for option in ("-I", folder)),
               *map(str, files)]
    ran = subprocess.run(command, cwd=SOURCE_DIR, capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        raise BadInput(f"soak misra: cppcheck ended with status {ran.returncode}: {ran.stderr.strip()[-300:]}")
    return ran.stderr


def column_of(file: str) -> str:
    """Where a finding is counted: headers belong to the folder that they stand in."""
    return {"core_c": "core", "firmware_stub": "node"}.get(file.split("/")[0], "FMU")


def all_findings(advance: Callable[[float], None]) -> set[Finding]:
    """Of all parts; `advance` is told of each file."""
    found: set[Finding] = set()
    for part in PARTS:
        found |= findings_of(part)
        advance(len(part.files()))
    return found


def counted(found: Iterable[Finding]) -> Counts:
    """Places by rule and column."""
    counts: Counts = {}
    for rule, file, _ in found:
        counts.setdefault(rule, Counter())[column_of(file)] += 1
    return counts


def unexplained(counts: Counts) -> list[str]:
    """One line for each rule that is violated without a deviation for that part, or more often than it allows."""
    lines = []
    for rule, by_column in counts.items():
        deviation = DEVIATIONS.get(rule)
        for column, count in by_column.items():
            if deviation is None or column not in deviation.most:
                lines.append(f"rule {rule}, {column}: {count} places, and no deviation is stated")
            elif 0 <= deviation.most[column] < count:
                lines.append(f"rule {rule}, {column}: {count} places, the deviation allows {deviation.most[column]}")
    return sorted(lines)


def places(found: Iterable[Finding], lines: Iterable[str], most: int = 5) -> list[str]:
    """Where the rules of those lines are violated, a few of each."""
    rules = {line.split()[1].rstrip(",") for line in lines}
    by_rule: dict[str, list[str]] = {}
    for rule, file, line in sorted(found):
        if rule in rules:
            by_rule.setdefault(rule, []).append(f"{rule} {file}:{line}")
    return [place for each in by_rule.values() for place in each[:most]]
