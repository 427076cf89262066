"""The README's C example: extract it, or check that its program prints the output in the README."""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("readme", type=Path)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", type=Path, metavar="FILE", help="write the example there")
    what.add_argument("--check", type=Path, metavar="PROGRAM", help="run it and compare its output")
    arguments = parser.parse_args()
    example, output = blocks(arguments.readme)
    if arguments.write:
        arguments.write.write_text(example, encoding="utf-8")
        return 0
    printed = subprocess.run([str(arguments.check.resolve())], capture_output=True, text=True, check=True).stdout
    if printed == output:
        return 0
    print(f"laconic: the README shows\n{output}but its example prints\n{printed}", file=sys.stderr)
    return 1


def blocks(readme: Path) -> tuple[str, str]:
    """The one C block and the text block that follows it."""
    found = re.findall(r"```c\n(.*?)```\n\n```text\n(.*?)```", readme.read_text(encoding="utf-8"), re.DOTALL)
    if len(found) != 1:
        sys.exit(f"laconic: {readme} must hold one C example followed by its output, not {len(found)}")
    return found[0]


if __name__ == "__main__":
    sys.exit(main())
