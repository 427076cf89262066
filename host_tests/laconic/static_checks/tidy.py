"""clang-tidy over core, node and FMU, by the checks of .clang-tidy, which says why some are off."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable

from laconic.errors import BadInput
from laconic.paths import SOURCE_DIR
from laconic.static_checks.parts import PARTS, Part

FINDING = re.compile(r"^(\S+:\d+):\d+: (?:warning|error): .*\[([\w.,-]+)\]$", re.MULTILINE)
MORE = {"core": ("core_c/derivatives/*.c", "core_c/filter/*.c"),
        "node": ("firmware_stub/drives/*.c", "firmware_stub/drives/*/*.c")}
NO_PROGRAM = ("derivations.c",)  # a list that others include


def tidy_findings(advance: Callable[[float], None]) -> list[str]:
    """Place and check of each finding, in all parts."""
    if shutil.which("clang-tidy") is None:
        raise BadInput("soak misra: there is no clang-tidy; install it")
    found: set[str] = set()
    for part in PARTS:
        found |= _of(part)
        advance(len(part.files()))
    return sorted(found)


def _of(part: Part) -> set[str]:
    more = [path for pattern in MORE.get(part.name, ()) for path in SOURCE_DIR.glob(pattern)]
    files = [*part.files(), *(path for path in more if path.name not in NO_PROGRAM)]
    flags = ["-std=c99", *(f"-I{folder}" for folder in (*part.includes(), "core_c/src", "core_c/derivatives"))]
    ran = subprocess.run(["clang-tidy", "--quiet", *map(str, files), "--", *flags], cwd=SOURCE_DIR, capture_output=True,
                         text=True, check=False)
    found = {f"{place} {check}" for place, check in FINDING.findall(ran.stdout)}
    if ran.returncode != 0 and not found:
        raise BadInput(f"soak misra: clang-tidy ended with status {ran.returncode}: {ran.stderr.strip()[-300:]}")
    return {line.removeprefix(f"{SOURCE_DIR}/") for line in found}
