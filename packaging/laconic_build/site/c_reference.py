"""The C interface from the public headers: each declaration under the comment that stands above it."""

from __future__ import annotations

import re
from pathlib import Path

HEADERS = ("laconic.h", "vehicle.h", "friction.h", "sensors.h", "batch.h", "derivatives.h", "filter.h", "estimate.h",
           "articulated.h", "articulated_friction.h", "status.h", "real.h")
SECTION = re.compile(r"/\* -{8,} (.+?) -+ \*/")
COMMENT = re.compile(r"/\*(.*?)\*/", re.DOTALL)


def c_page(source: Path) -> str:
    """One page, a part for each header."""
    parts = ["# C reference", "Made from the comments of `core_c/include/laconic`. Compile with the folder "
                              "`core_c/include` on the "
             "include path and `#include <laconic/laconic.h>`, which includes the others but "
             "`batch.h`, `derivatives.h`, `filter.h` and `estimate.h`."]
    for name in HEADERS:
        path = source / "core_c" / "include" / "laconic" / name
        if path.is_file():
            parts += [f"## {name}", *_blocks(path.read_text(encoding="utf-8"))]
    return "\n\n".join(parts) + "\n"


def _blocks(text: str) -> list[str]:
    """Paragraphs of the header: its head comment, sections, comments, declarations."""
    found: list[str] = []
    for block in re.split(r"\n\s*\n", text):
        block = block.strip("\n")
        if not block.strip() or _is_frame(block):
            continue
        if section := SECTION.match(block.strip()):
            found.append(f"### {section[1].strip().capitalize()}")
            block = block.strip()[section.end():].strip("\n")
            if not block.strip():
                continue
        found.append(f"```c\n{_without_frame(block)}\n```")
    return found


def _without_frame(block: str) -> str:
    """Without include guards and extern "C", which tell a reader nothing."""
    lines = [line for line in block.splitlines() if not re.match(r"#(ifndef|define|endif).*_H\b|#include|#ifdef "
                                                                  "__cplusplus", line)]
    return "\n".join(lines).strip("\n")


def _is_frame(block: str) -> bool:
    frame = re.compile(r"#|\}$|extern \"C\"|/\* extern")
    lines = [line.strip() for line in block.splitlines() if line.strip()]
    return all(frame.match(line) for line in lines) and "#define LACONIC_MAX" not in block
