"""Looks for fused multiply-adds in object files, which round once where the core rounds twice: OBJDUMP OBJECT…

Exit status 1 names each function that has one, 77 (skipped) says why nothing could be looked at.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

FUSED = re.compile(r"\s(vfn?m(?:add|sub)\w*|fn?m(?:add|sub)|fml[as])\s")  # x86 with FMA or AVX-512; Arm
WIDE = {"lanes_32": "%ymm", "lanes_64": "%zmm"}  # registers by which a build with lanes multiplies
SKIPPED = 77


def main(objdump: str, objects: list[Path]) -> int:
    """Reads every object's instructions."""
    try:
        code = {path: disassembled(objdump, path) for path in objects}
    except OSError:
        print(f"skipped: no objdump ({objdump}), by which the objects could be read")
        return SKIPPED
    found = [f"{path.name}: {place}" for path, text in code.items() for place in fused(text)]
    for place in found:
        print(place, file=sys.stderr)
    wide = {path.name: sum("mulp" in line and register in line for line in text.splitlines())
            for path, text in code.items() for name, register in WIDE.items() if name in path.name}
    print(f"{len(found)} fused operations in {len(code)} objects; multiplications of whole registers: "
          f"{', '.join(f'{count} in {name}' for name, count in wide.items()) or 'none looked for'}")
    return 1 if found or not code else 0


def disassembled(objdump: str, path: Path) -> str:
    """The instructions of an object."""
    done = subprocess.run([objdump, "-d", "--no-show-raw-insn", str(path)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise OSError(done.stderr)
    return done.stdout


def fused(text: str) -> list[str]:
    """Function and instruction of each that is fused."""
    function, found = "", []
    for line in text.splitlines():
        if line.endswith(">:"):
            function = line.partition("<")[2][:-2]
        elif match := FUSED.search(f"{line} "):
            found.append(f"{function} has {match[1]}")
    return found


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], [Path(each) for each in sys.argv[2:]]))
