"""Becomes another program, which Linux ends with the process that asked for it, also where that is killed.

    python with_parent.py PARENT PROGRAM ARGUMENT …     # PARENT: the number of that process

It is a program of its own: between fork and exec of a process with threads Python code must not run.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys

PR_SET_PDEATHSIG = 1


def main() -> None:
    """Asks Linux for the signal, and looks whether the parent had ended before that."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, int(signal.SIGKILL))
    parent, program = int(sys.argv[1]), sys.argv[2:]
    if os.getppid() == parent:
        os.execvp(program[0], program)


if __name__ == "__main__":
    main()
