"""libFuzzer targets, one after the other: how long, what they found, and what is kept when a signal ends them."""

from __future__ import annotations

import re
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from laconic.errors import BadInput
from laconic.paths import SOURCE_DIR, build_dir, built
from laconic.soak import StoppedEarly

LOOK_S = 0.5
PATIENCE_S = 10.0  # for the end of a target
CORPORA = {name: f"fmu/tests/corpus_{name}" for name in ("fmi", "fmu_state")}


@dataclass(frozen=True)
class Found:
    """What a target says of its run; `crash` is the file with the input that fails, or ""."""

    inputs: int = 0
    edges: int = 0
    crash: str = ""

    def __str__(self) -> str:
        what = f"FOUND: {self.crash}" if self.crash else "nothing found"
        return f"{self.inputs} inputs, {self.edges} edges, {what}"


def fuzz_in_turn(targets: Sequence[str], minutes: float, seed: int, advance: Callable[[float], None]
                 ) -> dict[str, Any]:
    """Each target for so many minutes. New inputs are kept in build/fuzz, apart from the corpus of the sources, and
    tried first by the next run. StoppedEarly, with what was found, when a signal ends it."""
    result: dict[str, Any] = {"passed": True}
    for number, target in enumerate(targets):
        run = Run(target, 60.0 * minutes, seed + number)
        try:
            run.wait(lambda seconds: advance(seconds / len(targets)))
        except KeyboardInterrupt as stopped:
            run.stop()
            raise StoppedEarly(with_found(result, target, run.found())) from stopped
        result = with_found(result, target, run.found())
    return result


def with_found(result: dict[str, Any], target: str, found: Found) -> dict[str, Any]:
    """The result with one target more."""
    return {**result, target: str(found), "passed": result["passed"] and not found.crash}


class Run:
    """One target at work."""

    def __init__(self, target: str, seconds: float, seed: int):
        self.program, fresh = built(f"fuzz/fuzz_{target}"), build_dir() / "fuzz" / target
        fresh.mkdir(exist_ok=True)
        self.log = build_dir() / "fuzz" / f"{target}.log"
        command = [str(self.program), f"-max_total_time={max(1, round(seconds))}", f"-seed={seed % 2**31 or 1}",
                   "-max_len=2000", "-rss_limit_mb=1024", f"-artifact_prefix={fresh}/", str(fresh),
                   str(SOURCE_DIR / CORPORA.get(target, f"firmware_stub/fuzz/corpus/{target}"))]
        with self.log.open("w", encoding="utf-8") as log:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=log)

    def wait(self, advance: Callable[[float], None]) -> None:
        """Until it ends by itself."""
        last = time.monotonic()
        while self.process.poll() is None:
            with suppress(subprocess.TimeoutExpired):
                self.process.wait(LOOK_S)
            now = time.monotonic()
            advance(now - last)
            last = now

    def stop(self) -> None:
        """Ends it in order: it says what it has done so far."""
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def found(self) -> Found:
        """What its log says."""
        text = self.log.read_text(encoding="utf-8", errors="replace")
        if self.process.returncode and "libFuzzer" not in text and "SUMMARY" not in text and "Test unit" not in text:
            raise BadInput(f"{self.program}: is no libFuzzer target; install clang with libclang-rt and build again")
        crash = re.search(r"Test unit written to (\S+)", text)
        inputs = re.findall(r"^(?:#(\d+)\s|Done (\d+) runs|stat::number_of_executed_units: (\d+))", text, re.MULTILINE)
        edges = re.findall(r"cov: (\d+)", text)
        return Found(max((int("".join(each)) for each in inputs), default=0), int(edges[-1]) if edges else 0,
                     crash.group(1) if crash else "")
