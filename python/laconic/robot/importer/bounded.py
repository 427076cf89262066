"""What a library makes of a file, in a process of its own: a file can make it compute for ever, or fill the memory.

`bounded` calls a function there, by `python -m laconic.robot.importer.bounded`; a `Reader` calls one after another.
Ctrl-C, which a library written in C does not see, ends that process, too.
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
from typing import IO, Any

from laconic.errors import BadInput

LONGEST_S = 20.0        # of one call
MOST_BYTES = 2 * 2**30  # of memory
HEAD_BYTES = 8          # of a message: its length


@dataclass(frozen=True)
class Library:
    """Who reads, and what in a file makes it read for ever."""

    name: str
    endless: str


class Unanswered(Exception):
    """Why a call came to nothing, in words."""


def bounded(library: Library, call: Callable[..., Any], path: Path, *more: Any) -> Any:
    """What call(path, *more) returns, a function of a module with arguments and a result that pickle takes.

    Raises what the call raises; BadInput for one that takes more than LONGEST_S or MOST_BYTES, or whose process fails.
    """
    with Reader(library.name) as reader:
        try:
            return reader.ask(call, path, *more)
        except Unanswered as why:
            raise BadInput(f"{path}: {why}; mend {library.endless}") from None


class Reader:
    """A process that begins with the first call, and anew with the first after one that came to nothing."""

    def __init__(self, name: str):
        self.name = name  # of the library
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Reader:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.kill()
            self._ended()

    def ask(self, call: Callable[..., Any], *arguments: Any) -> Any:
        """As `bounded`, but Unanswered says why nothing came."""
        process = self._process = self._process or _begun()
        late = threading.Event()
        bell = threading.Timer(LONGEST_S, _end, [process, late])
        bell.daemon = True
        bell.start()
        try:
            answer = _answer_to((call, *arguments), process)
        finally:
            bell.cancel()
        if answer is None or late.is_set():
            raise Unanswered(self._why_not(late.is_set(), self._ended()))
        result, failure = pickle.loads(answer)  # from our own process
        if failure is not None:
            raise failure
        return result

    def _ended(self) -> int:
        """The exit status of the process, which nobody can ask any more."""
        process, self._process = self._process, None
        assert process is not None
        status = process.wait()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):  # what was not sent any more
                pipe.close()  # type: ignore[union-attr]  # both are there
        return status

    def _why_not(self, is_too_late: bool, status: int) -> str:
        if is_too_late:
            return f"{self.name} does not come to an end within {LONGEST_S:g} s"
        if status == TOO_MUCH:
            return f"{self.name} needs more than {MOST_BYTES / 2**30:g} GiB of memory"
        return f"{self.name} failed with status {status}, as where its memory is not enough"


def _begun() -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-m", __name__], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            stderr=subprocess.DEVNULL, env=_environment())


def _end(process: subprocess.Popen[bytes], late: threading.Event) -> None:
    late.set()
    process.kill()


def _environment() -> dict[str, str]:
    """The process finds the modules that this one finds, and from Python 3.11 on none in the working folder besides.
    Each thread of numpy would take a part of the memory."""
    folders = os.pathsep.join(str(Path(each).absolute()) for each in sys.path)
    return os.environ | {"PYTHONSAFEPATH": "1", "PYTHONPATH": folders, "OPENBLAS_NUM_THREADS": "1"}


def _answer_to(call: tuple[Any, ...], process: subprocess.Popen[bytes]) -> bytes | None:
    """None where the process ended before."""
    assert process.stdin and process.stdout
    with suppress(BrokenPipeError):
        _send(process.stdin, pickle.dumps(call))
    return _received(process.stdout)


def _send(pipe: IO[bytes], message: bytes) -> None:
    pipe.write(len(message).to_bytes(HEAD_BYTES, "little"))
    pipe.write(message)
    pipe.flush()


def _received(pipe: IO[bytes]) -> bytes | None:
    """The next message; None at the end."""
    head = pipe.read(HEAD_BYTES)
    length = int.from_bytes(head, "little")
    message = pipe.read(length) if len(head) == HEAD_BYTES else b""
    return message if head and len(message) == length else None


# ---------------------------------------------------------------------------------- in the process --

LOOKS_EVERY_S = 0.2
TOO_MUCH = 3  # its exit status for MemoryError


def answer() -> None:
    """Reads calls from stdin, writes (result, None) or (None, what it raised) of each to stdout."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries print
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    _bound("RLIMIT_AS", MOST_BYTES)
    while (asked := _received(sys.stdin.buffer)) is not None:
        _bound("RLIMIT_CPU", int(LONGEST_S + time.process_time()) + 1)  # where nobody is there any more to end it
        try:
            call, *arguments = pickle.loads(asked)
            _send(answers, pickle.dumps(_found(call, arguments)))
        except MemoryError:
            os._exit(TOO_MUCH)
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
        resource.setrlimit(limit, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


if __name__ == "__main__":
    answer()
