"""What a library makes of a file, in a process of its own: files can make libraries compute for ever, or fill the memory.

`bounded` calls a function there. Ctrl-C, which a library written in C does not see, ends that process, too.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laconic.errors import BadInput

LONGEST_S = 20.0
MOST_BYTES = 2 * 2**30  # of memory
START = "import sys; sys.path = [each for each in sys.path if each]; " \
        f"from {__name__} import answer; answer({{longest_s!r}}, {{most_bytes!r}})"


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

    BadInput: that of the call; a call that takes more than LONGEST_S or MOST_BYTES, or whose process fails.
    """
    start = START.format(longest_s=int(LONGEST_S) + 1, most_bytes=MOST_BYTES)
    try:
        done = subprocess.run([sys.executable, "-c", start], input=pickle.dumps((call, path, *more)),
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
    if failure:
        raise BadInput(failure)
    return result


def _environment() -> dict[str, str]:
    """The child finds the modules that this process finds, none in the working folder besides; threads of numpy would
    take of the memory, each a part of its own."""
    return os.environ | {"PYTHONPATH": os.pathsep.join(os.path.abspath(each) for each in sys.path),
                         "OPENBLAS_NUM_THREADS": "1"}


# ---------------------------------------------------------------------------------- in the process --

TOO_MUCH = 3  # its exit status for MemoryError


def answer(longest_s: int, most_bytes: int) -> None:
    """Reads the call from stdin, writes (result, None) or (None, why not) to stdout."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries print
    _bound("RLIMIT_AS", most_bytes)
    _bound("RLIMIT_CPU", longest_s)  # where nobody is there any more to end it
    try:
        call, *arguments = pickle.load(sys.stdin.buffer)
        found = pickle.dumps(_found(call, arguments))
    except MemoryError:
        os._exit(TOO_MUCH)
    answers.write(found)
    answers.flush()
    os._exit(0)  # what was read is not taken apart


def _found(call: Callable[..., Any], arguments: list[Any]) -> tuple[Any, str | None]:
    try:
        return call(*arguments), None
    except BadInput as error:
        return None, str(error)


def _bound(what: str, most: int) -> None:
    """Where the system can; elsewhere the time alone is bounded."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        limit = getattr(resource, what)
        hard = resource.getrlimit(limit)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(limit, (most, most))
