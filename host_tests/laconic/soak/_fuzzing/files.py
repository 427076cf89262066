"""Fuzzes readers of files with feedback: what reaches new lines of the package is kept and spoilt further.

A spoilt file is read, or refused by one line that names the file and says what to do; nothing else may come of it.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

from laconic.errors import BadInput
from laconic.paths import build_dir
from laconic.soak._fuzzing.file_readers import FILE_TARGETS, FileTarget
from laconic.soak._fuzzing.libfuzzer import Found
from laconic.soak._fuzzing.spoil import Spoiler

PACKAGE = str(Path(__file__).resolve().parents[2])
LONGEST_LINE = 2000
REMEDIES = ("; ", "give ", "take ", "correct ", "did you mean", "save ", "use ", "name ", "put ", ", not ")


class Lines:
    """Lines of the package that ran: all so far, and since the last question."""

    def __init__(self) -> None:
        self.seen: set[tuple[CodeType, int]] = set()
        self.fresh = False

    def _call(self, frame: FrameType, event: str, argument: Any) -> Any:
        return self._line if frame.f_code.co_filename.startswith(PACKAGE) else None

    def _line(self, frame: FrameType, event: str, argument: Any) -> Any:
        key = (frame.f_code, frame.f_lineno)
        if key not in self.seen:
            self.seen.add(key)
            self.fresh = True
        return self._line

    def reached_by(self, act: Callable[[], None]) -> bool:
        """Whether something new ran."""
        self.fresh = False
        before = sys.gettrace()
        sys.settrace(self._call)
        try:
            act()
        finally:
            sys.settrace(before)
        return self.fresh


def complaint(target: FileTarget, path: Path) -> str:
    """What is wrong with how a file is taken; "" where it is read, or refused as it should be."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            target.use(path)
    except BadInput as refusal:
        return unclear(str(refusal), path)
    except Exception:  # noqa: BLE001 - whatever it is, the user would see it
        return traceback.format_exc()
    return ""


def unclear(line: str, path: Path) -> str:
    """Why a refusal is no good line."""
    if "\n" in line or "\r" in line:
        return f"more than one line: {line!r}"
    if path.name not in line:
        return f"does not name the file: {line!r}"
    if not any(remedy in line for remedy in REMEDIES):
        return f"says not what to do: {line!r}"
    return f"longer than {LONGEST_LINE}: {line!r}" if len(line) > LONGEST_LINE else ""


class FileRun:
    """Spoilt files of one kind."""

    def __init__(self, name: str, seed: int):
        self.target, self.spoiler, self.lines = FILE_TARGETS[name], Spoiler(seed), Lines()
        self.fresh = build_dir() / "fuzz" / name
        self.fresh.mkdir(parents=True, exist_ok=True)
        good = self.target.seeds()
        self.suffix = good[0].suffix
        self.waiting = [path.read_text(encoding="utf-8") for path in (*good, *sorted(self.fresh.glob("kept-*")))]
        self.texts: list[str] = []
        self.executions, self.crash = 0, ""
        self.began_s = cpu_s()

    def next_text(self) -> str:
        """Good ones and those of earlier runs first."""
        if self.waiting:
            self.texts.append(self.waiting.pop())
            return self.texts[-1]
        choice = self.spoiler.random.choice
        return self.spoiler.spoilt(choice(self.texts), choice(self.texts))

    def take(self, path: Path) -> None:
        """One file more."""
        text, wrong = self.next_text(), []
        path.write_text(text, encoding="utf-8", errors="surrogatepass", newline="")
        is_new = self.lines.reached_by(lambda: wrong.append(complaint(self.target, path)))
        self.executions += 1
        if wrong[0]:
            self.crash = keep(self.fresh, "crash", text, self.suffix)
            Path(f"{self.crash}.txt").write_text(wrong[0] + "\n", encoding="utf-8")
        elif is_new and text not in self.texts:
            self.texts.append(text)
            keep(self.fresh, "kept", text, self.suffix)

    def found(self) -> Found:
        """So far."""
        spent_s = cpu_s() - self.began_s
        return Found(self.executions, spent_s, len(self.lines.seen), self.crash, self.executions / max(spent_s, 1e-3))


def fuzz_files(name: str, seconds: float, seed: int, advance: Callable[[float], None], most: int = sys.maxsize
               ) -> tuple[Found, KeyboardInterrupt | None]:
    """Spoils files of one kind for so long, or so many; ends with the first that is taken wrongly, or by a signal."""
    run, last = FileRun(name, seed), time.monotonic()
    end = last + seconds
    with tempfile.TemporaryDirectory() as folder:
        try:
            while not run.crash and run.executions < most and last < end:
                run.take(Path(folder, f"spoilt{run.suffix}"))
                now = time.monotonic()
                advance(now - last)
                last = now
        except KeyboardInterrupt as stopped:
            return run.found(), stopped
    return run.found(), None


def cpu_s() -> float:
    """Processor time of this process."""
    times = os.times()
    return times.user + times.system


def keep(folder: Path, what: str, text: str, suffix: str) -> str:
    """Writes a text down by its hash; returns where."""
    data = text.encode("utf-8", errors="surrogatepass")
    path = folder / f"{what}-{hashlib.sha1(data).hexdigest()[:16]}{suffix}"  # noqa: S324 - a name, no secret
    path.write_bytes(data)
    return str(path)
