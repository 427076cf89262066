"""One run of a libFuzzer target: its command, its end, and what its log says."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from laconic.errors import BadInput
from laconic.paths import build_dir, built
from laconic.soak._fuzzing.targets import Target

LOOK_S = 0.5
PATIENCE_S = 10.0  # for the end of a target


@dataclass(frozen=True)
class Found:
    """What a target says of its runs: executions, processor time, edges of the code that were reached; `crash` is the
    file with the input that fails, or ""."""

    executions: int = 0
    cpu_s: float = 0.0
    edges: int = 0
    crash: str = ""
    rate_per_s: float = 0.0
    """Executions a second of processor time, of the first run."""

    def and_then(self, other: Found) -> Found:
        """Both runs together."""
        return Found(self.executions + other.executions, self.cpu_s + other.cpu_s, max(self.edges, other.edges),
                     self.crash or other.crash, self.rate_per_s or other.rate_per_s)

    def __str__(self) -> str:
        what = f"FOUND: {self.crash}" if self.crash else "nothing found"
        rate = f"{self.rate_per_s:,.0f} a second of processor time"
        return f"{self.executions:,} inputs, {rate}, {self.edges} edges, {what}"


class Run:
    """One target at work; what it finds anew goes into the folder of its name in build/fuzz."""

    def __init__(self, target: Target, name: str, most_bytes: int, seconds: float, seed: int):
        self.program, fresh = built(f"fuzz/fuzz_{target.name}"), build_dir() / "fuzz" / name
        fresh.mkdir(exist_ok=True)
        self.log = build_dir() / "fuzz" / f"{name}.log"
        self.cpu_s_before = cpu_s_of_children()
        command = [str(self.program), f"-max_total_time={max(1, round(seconds))}", f"-seed={seed % 2**31 or 1}",
                   f"-max_len={most_bytes}", "-timeout=20", "-rss_limit_mb=1024", f"-artifact_prefix={fresh}/",
                   str(fresh), str(target.corpus)]
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
        executions = max((int("".join(each)) for each in inputs), default=0)
        cpu_s = cpu_s_of_children() - self.cpu_s_before
        return Found(executions, cpu_s, int(edges[-1]) if edges else 0, crash.group(1) if crash else "",
                     executions / max(cpu_s, 1e-3))


def cpu_s_of_children() -> float:
    """Processor time of all processes that this one has started and seen end."""
    times = os.times()
    return times.children_user + times.children_system
