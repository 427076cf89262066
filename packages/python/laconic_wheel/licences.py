"""Licences of what others wrote that was compiled into the binaries: each from the head of a file of theirs."""

from __future__ import annotations

import re
from pathlib import Path

SPOKEN_OF = re.compile(r"copyright|licen[cs]e", re.IGNORECASE)


def licences(fmi_headers: Path, wire: Path) -> dict[str, str]:
    """Texts by the names of their files in the wheel's dist-info."""
    return {"LICENSE-fmi-headers.txt": licence_of(fmi_headers / "fmi3FunctionTypes.h"),
            "LICENSE-cantools.txt": licence_of(wire / "laconic_dbc.c")}


def licence_of(path: Path) -> str:
    """The first comment of a C file, from its first line about copyright or licence on."""
    found = re.search(r"/\*+(.*?)\*/", path.read_text(encoding="utf-8"), re.DOTALL)
    lines = [re.sub(r"^\s*\*? ?", "", line).rstrip() for line in found[1].splitlines()] if found else []
    first = next((number for number, line in enumerate(lines) if SPOKEN_OF.search(line)), None)
    if first is None:
        raise SystemExit(f"laconic: {path}: begins without its licence")
    return "\n".join(lines[first:]).strip() + "\n"
