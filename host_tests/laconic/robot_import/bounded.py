"""What a library makes of a file, in a process of its own: a file can make it compute for ever, or fill the memory.

`bounded` calls a function there, by `python -m laconic.robot_import.bounded`. Ctrl-C, which a library written in C does
not see, ends that process, too.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laconic.errors import BadInput

LONGEST_S = 20.0
MOST_BYTES = 2 * 2**30  # of memory


@dataclass(frozen=True)
class Library:
    """Who reads, and what in a file makes it read for ever."""

    name: str
    endless: str

    @property
    def needs_too_much(self) -> str:
        """The memory was not enough."""
        return f"{self.name} needs more than {MOST_BYTES / 2**30:g} GiB of memory; mend {self.endless}"


def bounded(library: Library, call: Callable[..., Any], path: Path, *more: Any) -> Any:
    """What call(path, *more) returns, a function of a module with arguments and a result that pickle takes.

    Raises what the call raises; BadInput for one that takes more than LONGEST_S or MOST_BYTES, or whose process fails.
    """
    try:
        done = subprocess.run([sys.executable, "-m", __name__], input=pickle.dumps((call, path, *more)),
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=_environment(), timeout=LONGEST_S,
                              check=False)
    except subprocess.TimeoutExpired:
        raise BadInput(f"{path}: {library.name} does not come to an end within {LONGEST_S:g} s; mend "
                       f"{library.endless}") from None
    if done.returncode == TOO_MUCH:
        raise BadInput(f"{path}: {library.needs_too_much}")
    if done.returncode != 0:
        raise BadInput(f"{path}: {library.name} failed with status {done.returncode}, as where its memory is not "
                       f"enough; mend {library.endless}")
    result, failure = pickle.loads(done.stdout)  # from our own process
    if failure is not None:
        raise failure
    return result


def _environment() -> dict[str, str]:
    """The process finds the modules that this one finds, and from Python 3.11 on none in the working folder besides.
    Each thread of numpy would take a part of the memory."""
    folders = os.pathsep.join(str(Path(each).absolute()) for each in sys.path)
    return os.environ | {"PYTHONSAFEPATH": "1", "PYTHONPATH": folders, "OPENBLAS_NUM_THREADS": "1"}


# ---------------------------------------------------------------------------------- in the process --

LOOKS_EVERY_S = 0.2
TOO_MUCH = 3  # its exit status for MemoryError


def answer() -> None:
    """Reads the call from stdin, writes (result, None) or (None, what it raised) to stdout."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries print
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    _bound("RLIMIT_AS", MOST_BYTES)
    _bound("RLIMIT_CPU", int(LONGEST_S) + 1)  # where nobody is there any more to end it
    try:
        call, *arguments = pickle.load(sys.stdin.buffer)
        found = pickle.dumps(_found(call, arguments))
    except MemoryError:
        os._exit(TOO_MUCH)
    answers.write(found)
    answers.flush()
    os._exit(0)  # what was read is not taken apart


def _end_with(parent: int) -> None:
    """Ends this process soon after the one that asks, which nobody can hear of who is killed. One long operation of
    Python's own, such as a power of huge numbers, lets no thread run; RLIMIT_CPU ends that."""
    while os.getppid() == parent:
        time.sleep(LOOKS_EVERY_S)
    os._exit(1)


def _found(call: Callable[..., Any], arguments: list[Any]) -> tuple[Any, Exception | None]:
    try:
        return call(*arguments), None
    except MemoryError:
        raise
    except Exception as error:  # such as that of a library that is not installed, whose extra the command names
        return None, error


def _bound(what: str, most: int) -> None:
    """Where the system can; elsewhere the time alone is bounded."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        limit = getattr(resource, what)
        hard = resource.getrlimit(limit)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(limit, (most, most))


if __name__ == "__main__":
    answer()
