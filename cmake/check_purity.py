"""Fail the build when the core includes or calls what it must not (docs: the core depends on nothing).

Sources: only <float.h>, <stdbool.h>, <stddef.h>, <stdint.h> and the core's own headers.
Objects: no undefined symbols but memcpy, memmove and memset, which compilers call by themselves (so no libm, no heap,
no stdio); no writable data (so no globals); no fused multiply-add, which would change the last bit.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path

STANDARD = {"float.h", "stdbool.h", "stddef.h", "stdint.h"}
SCENE_MACRO = "LACONIC_SCENE_HEADER"  # the one include whose name a build chooses
COMPILER_MAY_CALL = {"memcpy", "memmove", "memset", "_GLOBAL_OFFSET_TABLE_"}
SOFT_FLOAT = re.compile(r"__(aeabi_|[a-z]+(?:[sdt]f|[sd]i)\d?[a-z0-9]*$)")  # libgcc's arithmetic, without an FPU
# Allowed where plain C is the alternative: |x| as one instruction (a call would show in the objects), and attributes
# that force or forbid inlining (noipa also forbids all conclusions of gcc from one function about another)
FORBIDDEN_WORDS = re.compile(
    r"\b(?:__builtin_(?!fabsf?\b)\w+|__attribute__(?!\(\((?:always_inline|noinline|noipa)\)\))"
    r"|asm|__asm__|_Pragma|static_assert)\b"
    r"|#\s*pragma"
)
WRITABLE = re.compile(r"^\s*\d+\s+(\.(?:data|bss|tdata|tbss|sdata|sbss|lbss|ldata)\S*|COMMON)\s+([0-9a-f]+)\s")
FUSED = re.compile(r"\t(vfn?m(?:add|sub)\w*|fn?m(?:add|sub)\b|fml[as]\b|vfn?m[as]\.\w+)")


def main() -> int:
    arguments = parse()
    faults = source_faults(arguments.sources)
    for binary in arguments.objects:
        faults += binary_faults(binary, arguments)
    for fault in faults:
        print(f"laconic: purity: {fault}", file=sys.stderr)
    if not faults and arguments.stamp:
        arguments.stamp.write_text("pure\n")
    return 1 if faults else 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sources", type=Path, nargs="*", default=[], help="C files and headers")
    parser.add_argument("--objects", type=Path, nargs="*", default=[], help="object files or static libraries")
    parser.add_argument("--nm", default="nm")
    parser.add_argument("--objdump", default="objdump")
    parser.add_argument("--no-fpu", action="store_true", help="allow the compiler's soft-float helpers")
    parser.add_argument("--stamp", type=Path, help="written when all is well")
    return parser.parse_args()


def source_faults(paths: list[Path]) -> list[str]:
    own = {path.name for path in paths} | {f"laconic/{path.name}" for path in paths}
    return [fault for path in paths for fault in one_source(path, own)]


def one_source(path: Path, own: set[str]) -> list[str]:
    text = re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    faults = []
    for written, name in re.findall(r"^\s*#\s*include\s+(?:([<\"])([^>\"]+)[>\"]|\w+)", text, re.MULTILINE):
        allowed = STANDARD if written == "<" else own
        if written and name not in allowed:
            faults.append(f"{path.name} includes {name}; the core includes only its own headers and {sorted(STANDARD)}")
    for macro in re.findall(r"^\s*#\s*include\s+(\w+)", text, re.MULTILINE):
        if macro != SCENE_MACRO:
            faults.append(f"{path.name} includes by the macro {macro}")
    return faults + [f"{path.name} uses {word}, which is not C99" for word in FORBIDDEN_WORDS.findall(text)]


def binary_faults(path: Path, arguments: argparse.Namespace) -> list[str]:
    faults = [f"{path.name} calls {symbol}" for symbol in sorted(foreign_symbols(path, arguments))]
    for line in run(arguments.objdump, "-h", str(path)).splitlines():
        section = WRITABLE.match(line)
        # .data.rel.ro: constant tables of addresses, written by the loader only
        if section and int(section[2], 16) and not section[1].startswith(".data.rel.ro"):
            faults.append(f"{path.name} has writable data in {section[1]}; the core has no globals")
    fused = sorted(set(FUSED.findall(run(arguments.objdump, "-d", "--no-show-raw-insn", str(path)))))
    return faults + [f"{path.name} uses {name}: not the same bits as elsewhere" for name in fused]


def foreign_symbols(path: Path, arguments: argparse.Namespace) -> set[str]:
    wanted, defined = set(), set()
    for line in run(arguments.nm, str(path)).splitlines():
        words = line.split()
        if len(words) >= 2 and words[-2] in ("U", "w", "v"):
            wanted.add(words[-1])
        elif len(words) == 3:
            defined.add(words[2])
    foreign = wanted - defined - COMPILER_MAY_CALL
    return {symbol for symbol in foreign if not (arguments.no_fpu and SOFT_FLOAT.match(symbol))}


def run(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    sys.exit(main())
