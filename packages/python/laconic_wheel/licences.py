"""Licences of what others wrote that was compiled into the binaries.

Sources of others state theirs at their head; what the compiler of the package ziglang adds has files of its own.
"""

from __future__ import annotations

import re
from pathlib import Path

from laconic_wheel.platforms import Platform

COMPILER_TEXTS = {"zig": "LICENSE", "mingw-w64": "lib/libc/mingw/COPYING", "glibc": "lib/libc/glibc/LICENSES",
                  "musl": "lib/libc/musl/COPYRIGHT"}
"""By names of parts of the compiler that are in binaries: files of the package ziglang."""
SPOKEN_OF = re.compile(r"copyright|licen[cs]e", re.IGNORECASE)


def licences(fmi_headers: Path, wire: Path) -> dict[str, str]:
    """Texts by the names of their files in the wheel's dist-info."""
    return {"LICENSE-fmi-headers.txt": licence_of(fmi_headers / "fmi3FunctionTypes.h"),
            "LICENSE-cantools.txt": licence_of(wire / "laconic_dbc.c")}


def compiler_parts(platform: Platform | None = None) -> list[str]:
    """Keys of COMPILER_TEXTS for what is in a wheel: FMUs have binaries of every platform, but of no musl."""
    return [key for key in COMPILER_TEXTS if key != "musl" or (platform and platform.target.endswith("musl"))]


def compiler_licences(platform: Platform, python: str) -> dict[str, str]:
    """Texts as above, by the interpreter that has ziglang."""
    zig = ziglang_in(Path(python).parents[1])
    return {f"LICENSE-{key}.txt": compiler_text(zig, key) for key in compiler_parts(platform)}


def ziglang_in(environment: Path) -> Path:
    """The folder of the package ziglang in an environment of Python."""
    (found,) = environment.glob("lib/python3*/site-packages/ziglang")
    return found


def compiler_text(zig: Path, key: str) -> str:
    """The licence of a part of the compiler; some have an old encoding."""
    return (zig / COMPILER_TEXTS[key]).read_bytes().decode("utf-8", errors="replace")


def licence_of(path: Path) -> str:
    """The first comment of a C file, from its first line about copyright or licence on."""
    found = re.search(r"/\*+(.*?)\*/", path.read_text(encoding="utf-8"), re.DOTALL)
    lines = [re.sub(r"^\s*\*? ?", "", line).rstrip() for line in found[1].splitlines()] if found else []
    first = next((number for number, line in enumerate(lines) if SPOKEN_OF.search(line)), None)
    if first is None:
        raise SystemExit(f"laconic: {path}: begins without its licence")
    return "\n".join(lines[first:]).strip() + "\n"
