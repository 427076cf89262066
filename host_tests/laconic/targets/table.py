"""The targets and how each is reached: this machine's compilers, zig's with emulators, Arm's with boards."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from laconic.benchmark.workshop import BOARDS, Target
from laconic.errors import ResultFails
from laconic.paths import SOURCE_DIR, build_dir, built
from laconic.targets.boards import LONGEST_S, SOFT_DOUBLE, board_lines

CORE = SOURCE_DIR / "core_c"
STEPS = 4000  # of each trajectory, as trajectory_hash.c has them by itself
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", f"-I{CORE / 'include'}")
WASI = ("node", "--no-warnings", "-e", """
    const { WASI } = require("node:wasi"), wasi = new WASI({ version: "preview1" });
    WebAssembly.instantiate(require("fs").readFileSync(process.argv[1]), wasi.getImportObject())
        .then(({ instance }) => process.exit(wasi.start(instance)));""")


@dataclass(frozen=True)
class Bits:
    """The hashes that trajectory_hash.c prints, line by line, and what check_double.c finds."""

    hashes: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()


@dataclass(frozen=True)
class HashTarget:
    """A processor with a compiler for it, and what runs its programs here."""

    name: str
    zig: str = ""                      # zig's name of the target
    compiler: tuple[str, ...] = ()     # where it is another
    runner: tuple[str, ...] = ()
    board: Target | None = None

    def lacks(self) -> str:
        """What is not here of what it needs; empty where it can run."""
        if self.board:
            return "" if self.board.present else f"{self.board.tools}gcc or qemu-system-arm"
        wanted = [self.runner[0]] if self.runner else []
        missing = [tool for tool in (*wanted, *self.compiler[:1]) if shutil.which(tool) is None]
        if self.zig and not zig().exists():
            missing.append("ziglang (cmake --build build --target laconic_cross)")
        return " and ".join(missing)

    def bits(self, folder: Path, real: str = "double", steps: int = STEPS) -> Bits:
        """What its trajectories hash to, and its faults."""
        if self.board:
            found = board_lines(self.board, folder, real=real, steps=steps, optimisation="-O2")
            hashes = [line.removeprefix("hash ") for line in found if line.startswith("hash ")]
            return Bits(tuple(hashes), faults(found[1:len(found) - len(hashes)]))
        check = self._run(folder / "check", [SOFT_DOUBLE / "check_double.c"], [])
        flags = [f"-DSTEPS={steps}", *(["-DLACONIC_SINGLE"] if real == "single" else [])]
        sources = [CORE / "tests" / "trajectory_hash.c", built("amalgamation/laconic.c")]
        return Bits(tuple(self._run(folder / "hash", sources, flags)), faults(check))

    def _run(self, program: Path, sources: Sequence[Path], flags: Sequence[str]) -> list[str]:
        cross = [str(zig()), "-m", "ziglang", "cc", "-target", self.zig] if self.zig else []
        eager = ["-fno-tree-slp-vectorize"] if self.compiler[:1] == ("gcc",) else []
        called([*(cross or self.compiler), *FLAGS, *eager, *flags, *map(str, sources), "-o", str(program)])
        return called([*self.runner, str(program)], may_fail=True).splitlines()


def faults(check: Sequence[str]) -> tuple[str, ...]:
    """The lines of check_double.c but the last, which sums up."""
    return tuple(line for line in check if not line.startswith("double: "))


def zig() -> Path:
    """The interpreter with the package ziglang, which the build makes for FMUs and wheels."""
    return build_dir() / "cross" / "bin" / "python"


def called(command: Sequence[str], *, may_fail: bool = False) -> str:
    """The output of a program; check_double.c ends with 1 where it found a fault."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=False)
    except subprocess.TimeoutExpired:
        raise ResultFails(f"{command[0]} took longer than {LONGEST_S:g} s") from None
    if done.returncode != 0 and not (may_fail and done.stdout):
        raise ResultFails(f"{command[0]} failed: {(done.stderr or done.stdout).strip()[-300:]}")
    return done.stdout


def _emulated(name: str, zig_name: str, processor: str) -> HashTarget:
    return HashTarget(name, zig_name, runner=(f"qemu-{processor}-static",))


def _with_room(board: Target) -> Target:
    """A micro:bit's 16 KB are too few for these programs: the code of a Cortex-M0 then runs on a Cortex-M3."""
    return replace(board, machine="mps2-an385", script="mps2.ld") if board.machine == "microbit" else board


TARGETS = (
    HashTarget("x86-64, gcc", compiler=("gcc",)),
    HashTarget("x86-64, clang", compiler=("clang",)),
    HashTarget("x86-64 Windows", "x86_64-windows-gnu", runner=("wine",)),
    HashTarget("WebAssembly", "wasm32-wasi", runner=WASI),
    _emulated("i386 with SSE2", "x86-linux-musl", "i386"),
    _emulated("AArch64", "aarch64-linux-musl", "aarch64"),
    _emulated("ARMv7 hard float", "arm-linux-musleabihf", "arm"),
    _emulated("ARMv7 soft float", "arm-linux-musleabi", "arm"),
    _emulated("RISC-V 64", "riscv64-linux-musl", "riscv64"),
    _emulated("PowerPC 64, little-endian", "powerpc64le-linux-musl", "ppc64le"),
    _emulated("S/390, big-endian", "s390x-linux-musl", "s390x"),
    _emulated("MIPS 64", "mips64el-linux-muslabi64", "mips64el"),
    *(HashTarget(board.name, board=_with_room(board)) for board in BOARDS),
)
