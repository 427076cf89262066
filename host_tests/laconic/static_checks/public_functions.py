"""The public functions of core and node, read from their headers, and which proof follows each."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache

from laconic.paths import SOURCE_DIR
from laconic.static_checks.frama_c import PROGRAMS
from laconic.static_checks.proved import Row

FOLDERS = ("core_c/include/laconic", "firmware_stub/include/laconic_node", "firmware_stub/include/laconic_drives",
           "firmware_stub/include/laconic_secure")
HEADERS = tuple(str(path.relative_to(SOURCE_DIR)) for folder in FOLDERS
                for path in sorted((SOURCE_DIR / folder).glob("*.h")))
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
PROTOTYPE = re.compile(r"^(?!typedef|return|#|\s)[\w ]+?[ *](laconic_\w+)\([^;{]*\)\s*[;{]", re.MULTILINE)

LANES = "is compiled for registers of several numbers by extensions of C that Frama-C does not read"
WITHOUT_HEADERS = {
    "core_c/include/laconic/batch.h": LANES,
}
"""Headers of which no entry follows a function, each with the reason."""
OF_STEPS = ("the derivatives of a step: the analyser merges refusal and acceptance of the step, and takes all that is "
            "set by the latter for perhaps not set; sanitizers and fuzzing watch them")
WITHOUT = {
    **dict.fromkeys(("laconic_step_jacobian_of", "laconic_step_tangent", "laconic_step_adjoint"),
                    "calls the function of the same name with _by, of which an entry follows the derivation of rk4"),
    **dict.fromkeys(("laconic_filter_predict", "laconic_filter_predict_by"), OF_STEPS),
}
"""Functions of other headers that no entry follows, each with the reason."""


def reason_without(header: str, name: str) -> str:
    """Why no entry follows a function; empty where one should."""
    return WITHOUT_HEADERS.get(header) or WITHOUT.get(name, "")


@cache
def public_functions(header: str) -> tuple[str, ...]:
    """In the order of the header."""
    text = COMMENT.sub(" ", (SOURCE_DIR / header).read_text(encoding="utf-8"))
    bare = "\n".join(line for line in text.splitlines() if not line.rstrip().endswith("\\"))
    return tuple(dict.fromkeys(PROTOTYPE.findall(bare)))


def covered_by(rows: Iterable[Row]) -> dict[str, list[str]]:
    """Function → the entries of the analyser that follow it, ended, and have no open alarm."""
    found: dict[str, list[str]] = {}
    stand_ins = {program.name: program.stand_ins() for program in PROGRAMS}
    for row in rows:
        if row.tool == "eva" and row.holds:
            for function in set(row.functions) - stand_ins[row.part]:
                found.setdefault(function, []).append(row.name)
    return found
