"""Instructions, bytes and stack of a step: QEMU on boards, cachegrind on the host, binary tools for sizes.

A board under QEMU that counts its own instructions: how an image runs there, and one that counts calls by kind.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from laconic.errors import ResultFails
from laconic.tools.report.workshop import BENCH, Target, Variant, Workshop, entry_of, run_tool

CALIBRATED_INSTRUCTIONS = 65536  # of the loop whose ticks an image prints as "calibration"


def lines_of_board(target: Target, image: Path, timeout_s: float = 60.0) -> tuple[list[str], int]:
    """What an image prints, with one instruction every 256 ns, and its exit status."""
    command = ["qemu-system-arm", "-M", target.machine, "-nographic", "-monitor", "none", "-serial", "none", "-icount",
               "shift=8", "-semihosting-config", "enable=on,target=native", "-kernel", str(image)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s, stdin=subprocess.DEVNULL,
                          check=False)
    return [line for line in (done.stdout + done.stderr).splitlines() if line.strip()], done.returncode


def stopped_early(target: Target, image: Path, lines: Sequence[str]) -> ResultFails:
    """What to raise where an image did not print all."""
    return ResultFails(f"{image.name} on {target.machine} stopped early: {' '.join(lines[-2:])}")


def instructions_by_kind(target: Target, counter: str, sources: Sequence[Path], flags: Sequence[str],
                         folder: Path) -> dict[str, float]:
    """Of the loops of `counter`, a file of the core's bench, linked with `sources`."""
    console, startup = BENCH / "cortex_m", BENCH.parent / "cortex_m"
    image = folder / f"{counter}.elf"
    files = [console / f"{counter}.c", console / "bench_board.c", startup / "startup.c", *sources]
    run_tool([target.tool("gcc"), *target.flags, "-O2", "-std=c99", *flags, f"-I{console}", f"-I{startup}",
              f"-L{startup}", "-ffreestanding", "-nostartfiles", *map(str, files), f"-T{target.script}", "-o",
              str(image)])
    lines, status = lines_of_board(target, image, 120.0)
    if status != 0:
        raise stopped_early(target, image, lines)
    ticks = {name: int(value) for name, value in map(str.split, lines)}
    per_instruction = ticks.pop("calibration") / CALIBRATED_INSTRUCTIONS
    return {name: value / per_instruction for name, value in ticks.items()}


LARGEST_COUNTER = 2**24
STATE_LINES = ("zeta", "x", "y", "turns", "heading", "travel", "wheel_speed", "wheel_angle")
CONSTANTS = ("laconic_scene_model", "laconic_scene_integrator", "laconic_scene_friction")
HEAP = re.compile(r"^(malloc|free|calloc|realloc|_sbrk|_malloc_r)$")
DOUBLE_HELPER = re.compile(r"^__(aeabi_(d|cd|u?[ilf]2d)|(add|sub|mul|div|eq|lt|gt|le|ge|ne|unord|neg)df|float.*df"
                           r"|fix.*df|extendsfdf|truncdfsf)")


@dataclass(frozen=True)
class BoardRun:
    """The output of a board: steps taken, instructions for each, the stack, and the state, line by line."""

    steps: int
    instructions: float
    stack_bytes: int
    state: tuple[str, ...]
    status: int


@dataclass(frozen=True)
class Size:
    """Bytes of one step: the code that runs, all flash with constants, RAM of the state, worst stack."""

    step_code: int
    flash: int
    tables: int
    state: int
    static_ram: int
    worst_stack: int
    double_helpers: tuple[str, ...]
    heap: tuple[str, ...]


def count_on_board(workshop: Workshop, target: Target, variant: Variant) -> BoardRun:
    """Runs a variant on a board, with as many steps as its counter can count."""
    for steps in target.windows(variant.real):
        if found := run_on_board(target, workshop.board_image(target, variant, steps)):
            return found
    raise ResultFails(f"{variant.name} on {target.machine}: even {steps} steps do not fit the counter's window")


def run_on_board(target: Target, image: Path) -> BoardRun | None:
    """Runs a counting image; None where the counter overflows."""
    lines, exit_status = lines_of_board(target, image)
    values = {name: text for name, _, text in (line.partition(" ") for line in lines)}
    if exit_status != 0 or "status" not in values:
        raise stopped_early(target, image, lines)
    steps, first, second = int(values["steps"]), int(values["ticks_1"]), int(values["ticks_2"])
    if not first * 1.5 < second < first * 2.5 or first > LARGEST_COUNTER * 0.45:
        return None
    ticks_per_instruction = int(values["calibration"]) / CALIBRATED_INSTRUCTIONS
    state = tuple(line for line in lines if line.split()[0] in STATE_LINES)
    return BoardRun(3 * steps, (second - first) / steps / ticks_per_instruction, int(values["stack"]), state,
                    int(values["status"]))


def host_state(program: Path, steps: int) -> tuple[str, ...]:
    """The state after some steps, as the host writes it."""
    lines = run_tool([str(program), str(steps)]).splitlines()
    return tuple(line for line in lines if not line.startswith("status"))


def host_instructions(program: Path, steps: int = 2000) -> float:
    """I(2n) − I(n) over n, by cachegrind."""
    return (instructions_of([str(program), str(2 * steps)]) - instructions_of([str(program), str(steps)])) / steps


def cachegrind_present() -> bool:
    """Whether valgrind is installed."""
    return shutil.which("valgrind") is not None


def instructions_of(command: list[str]) -> int:
    """Instructions of a program from its start to its end, by cachegrind."""
    done = subprocess.run(["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null",
                           *command], capture_output=True, text=True, check=False)
    found = re.search(r"I\s+refs:\s+([\d,]+)", done.stderr)
    if not found or done.returncode != 0:
        raise ResultFails(f"cachegrind did not count {Path(command[0]).name}: {done.stderr[-200:]}")
    return int(found[1].replace(",", ""))


def size_of_step(workshop: Workshop, target: Target, variant: Variant) -> Size:
    """Links what one step needs, and adds it up."""
    image = workshop.step_image(target, variant)
    symbols = _symbols(target, image)
    folder, files = workshop.files(variant)
    graph = CallGraph.read(tuple(sorted(workshop.archive(target, variant, folder).place.glob("*.ci"))))
    entry = entry_of(files, variant.scene)
    method = [title for title in graph.stack if title.rpartition(":")[2] in files.method_steps]
    reached = graph.reached(entry, method)
    text, data, bss = _sections(target, image)
    tables = sum(symbols.get(name, 0) for name in CONSTANTS)
    outside = sum(symbols.get(name, 0) for name in ("laconic_scene_start", "laconic_scene_slip", "bench_state_bytes"))
    return Size(
        step_code=sum(symbols.get(name.rpartition(":")[2], 0) for name in reached), flash=text + data - outside,
        tables=tables, state=symbols["bench_state_bytes"], static_ram=data + bss,
        worst_stack=graph.worst_stack(entry, method),
        double_helpers=tuple(sorted(filter(DOUBLE_HELPER.match, symbols))),
        heap=tuple(sorted(filter(HEAP.match, symbols))))


def _symbols(target: Target, image: Path) -> dict[str, int]:
    """Name → bytes, of what is in the image."""
    found = {}
    for line in run_tool([target.tool("nm"), "-S", str(image)]).splitlines():
        parts = line.split()
        if len(parts) == 4:
            found[parts[3]] = int(parts[1], 16)
        elif len(parts) == 3:
            found.setdefault(parts[2], 0)
    return found


def _sections(target: Target, image: Path) -> tuple[int, int, int]:
    numbers = run_tool([target.tool("size"), str(image)]).splitlines()[1].split()
    return int(numbers[0]), int(numbers[1]), int(numbers[2])


NODE = re.compile(r'node: \{ title: "([^"]+)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')
BYTES = re.compile(r"(\d+) bytes \((\w+)")


@dataclass(frozen=True)
class CallGraph:
    """Who calls whom, and the stack each takes, as gcc writes it (-fcallgraph-info=su)."""

    stack: dict[str, int]
    calls: dict[str, frozenset[str]]

    @classmethod
    @lru_cache(maxsize=64)
    def read(cls, files: tuple[Path, ...]) -> CallGraph:
        """From .ci files."""
        stack: dict[str, int] = {}
        calls: dict[str, set[str]] = {}
        for path in files:
            text = path.read_text()
            for title, label in NODE.findall(text):
                if found := BYTES.search(label):
                    stack[_short(title)] = int(found[1])
            for source, target in EDGE.findall(text):
                calls.setdefault(_short(source), set()).add(_short(target))
        return cls(stack, {name: frozenset(targets) for name, targets in calls.items()})

    def _next(self, name: str, pointed: Iterable[str]) -> frozenset[str]:
        direct = self.calls.get(name, frozenset())
        return (direct | frozenset(pointed)) - {"__indirect_call"} if "__indirect_call" in direct else direct

    def reached(self, entry: str, pointed: list[str]) -> set[str]:
        """Everything a call of `entry` can run; calls through pointers go to `pointed`."""
        found, waiting = set(), [entry]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                waiting += self._next(name, pointed)
        return found

    def worst_stack(self, entry: str, pointed: list[str], above: frozenset[str] = frozenset()) -> int:
        """The deepest path, in bytes; library helpers without stack data count as nothing."""
        if entry in above:
            return 0
        deeper = (self.worst_stack(name, pointed, above | {entry}) for name in self._next(entry, pointed))
        return self.stack.get(entry, 0) + max(deeper, default=0)


def _short(title: str) -> str:
    """`folder/file.c:function` → `file.c:function`."""
    return title.rpartition("/")[2]
