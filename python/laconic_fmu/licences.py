"""Licences of what others wrote that is inside an FMU: texts of what is installed where it is built.

Sources of others state theirs at their head; what the compiler of the package ziglang adds has files of its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

FOLDER = "documentation/licenses/"
NOTICE = """
Parts of this FMU were written by others. Their licences stand beside this file:
"""
COMPILER_TEXTS = {"zig": "LICENSE", "mingw-w64": "lib/libc/mingw/COPYING", "glibc": "lib/libc/glibc/LICENSES",
                  "musl": "lib/libc/musl/COPYRIGHT"}
"""By names of parts of the compiler that are in binaries: files of the package ziglang."""
IN_BINARIES_FOR = {"linux": ("zig", "glibc"), "windows": ("zig", "mingw-w64", "musl"), "darwin": ("zig",)}
"""Its library for Windows is that of mingw-w64 with functions of musl."""
SPOKEN_OF = re.compile(r"copyright|licen[cs]e", re.IGNORECASE)


def licence_parts(own: bytes, fmi_header: Path, sources: Mapping[str, Path], platforms: Iterable[str],
                  zig: Path | None) -> dict[str, bytes]:
    """Texts by their names in the archive; `zig`: the compiler's package where it made the binaries."""
    texts = {"fmi-headers": licence_of(fmi_header)}
    if "laconic_dbc.c" in sources:
        texts["cantools"] = licence_of(sources["laconic_dbc.c"])
    if zig is not None:
        keys = {key for platform in platforms for key in IN_BINARIES_FOR[platform.rpartition("-")[2]]}
        texts |= {key: compiler_text(zig, key) for key in sorted(keys)}
    names = {f"{key}.txt": text.encode("utf-8") for key, text in texts.items()}
    told = NOTICE + "".join(f"    {name}\n" for name in sorted(names))
    return {FOLDER + name: text for name, text in {"license.txt": own + told.encode("utf-8"), **names}.items()}


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
