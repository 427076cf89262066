"""Runs programs that must all print the same, and says which one does not."""

from __future__ import annotations

import subprocess
import sys


def main() -> int:
    printed = {}
    for program in sys.argv[1:]:
        done = subprocess.run([program], capture_output=True, text=True, check=False)
        if done.returncode or not done.stdout.strip():
            print(f"{program}: exit status {done.returncode}, a run was refused", file=sys.stderr)
            return 1
        printed[program] = " ".join(done.stdout.split())
    for program, numbers in printed.items():
        print(numbers, program)
    return 0 if len(printed) > 1 and len(set(printed.values())) == 1 else 1


if __name__ == "__main__":
    sys.exit(main())
