"""One hash on every target that can be reached here: all trajectories of trajectory_hash.c in both scalar types, and
check_double.c, compiled for a processor and run by it, by an emulator or by an emulated board: minutes.

    targets [--only NAME] [--steps N]

Fails where two targets differ. A fault that check_double.c finds in a compiler's library is printed."""

from __future__ import annotations

import argparse
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from assurance.common import ROOT, Unusable, build, called, work
from laconic.tools.report.workshop import BENCH, BOARDS, Target

CORE = ROOT / "core_c"
SOFT_DOUBLE = CORE / "optional/soft_double"
SELF_TEST = CORE / "src/common/self_test.c"
BITS = CORE / "tests/bits"
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", f"-I{CORE / 'include'}")
STEPS = 4000       # of each trajectory, as trajectory_hash.c has them by itself
LONGEST_S = 900.0  # zig builds the C library of a target when it is asked for it first
WASI = ("node", "--no-warnings", "-e", """
    const { WASI } = require("node:wasi"), wasi = new WASI({ version: "preview1" });
    WebAssembly.instantiate(require("fs").readFileSync(process.argv[1]), wasi.getImportObject())
        .then(({ instance }) => process.exit(wasi.start(instance)));""")


@dataclass(frozen=True)
class HashTarget:
    """A processor with a compiler for it, and what runs its programs here."""

    name: str
    zig: str = ""                   # zig's name of the target
    compiler: tuple[str, ...] = ()  # where it is another
    runner: tuple[str, ...] = ()
    board: Target | None = None

    def lacks(self) -> str:
        """What is not here of what it needs."""
        if self.board:
            return "" if self.board.present else f"{self.board.tools}gcc or qemu-system-arm"
        missing = [tool for tool in (*self.runner[:1], *self.compiler[:1]) if shutil.which(tool) is None]
        if self.zig and not zig().exists():
            missing.append("ziglang (cmake --build build --target laconic_cross)")
        return " and ".join(missing)

    def bits(self, folder: Path, real: str, steps: int) -> tuple[list[str], list[str]]:
        """The hashes of its trajectories, and the lines of check_double.c that tell a fault."""
        if self.board:
            found = board_lines(self.board, folder, real=real, steps=steps, optimisation="-O2")
            hashes = [line.removeprefix("hash ") for line in found if line.startswith("hash ")]
            return hashes, faults(found[1:len(found) - len(hashes)])
        flags = [f"-DSTEPS={steps}", *(["-DLACONIC_SINGLE"] if real == "single" else [])]
        sources = [BITS / "trajectory_hash.c", amalgamation()]
        check = self._run(folder / "check", [SOFT_DOUBLE / "check_double.c"], [])
        return self._run(folder / "hash", sources, flags), faults(check)

    def _run(self, program: Path, sources: Sequence[Path], flags: Sequence[str]) -> list[str]:
        cross = [str(zig()), "-m", "ziglang", "cc", "-target", self.zig] if self.zig else []
        careful = ["-fno-tree-slp-vectorize"] if self.compiler[:1] == ("gcc",) else []
        called([*(cross or self.compiler), *FLAGS, *careful, *flags, *sources, "-o", program], LONGEST_S)
        done = subprocess.run([*self.runner, str(program)], capture_output=True, text=True, timeout=LONGEST_S,
                              check=False)
        if done.returncode != 0 and not done.stdout:  # check_double.c ends with 1 where it has found a fault
            raise Unusable(f"{self.name}: ended with status {done.returncode}: {done.stderr.strip()[-300:]}")
        return done.stdout.splitlines()


def faults(check: Sequence[str]) -> list[str]:
    """The lines of check_double.c but the last, which sums up."""
    return [line for line in check if not line.startswith("double: ")]


def zig() -> Path:
    """The interpreter with the package ziglang, which the build makes for FMUs and wheels."""
    return build() / "cross/bin/python"


def amalgamation() -> Path:
    """The core as one file."""
    path = build() / "amalgamation/laconic.c"
    if not path.exists():
        raise Unusable(f"{path}: not built yet; cmake --build {build()} --target laconic_amalgamation")
    return path


def board_lines(board: Target, folder: Path, *, real: str = "double", soft_double: bool = True, steps: int = 0,
                optimisation: str = "-O0") -> list[str]:
    """The output of a board: the result of the self-test, the lines of check_double.c and, with so many steps of each
    trajectory, `hash …`. Without `soft_double` libgcc adds."""
    image = board_image(board, folder, real=real, soft_double=soft_double, steps=steps, optimisation=optimisation)
    done = subprocess.run(
        ["qemu-system-arm", "-M", board.machine, "-nographic", "-monitor", "none", "-serial", "none",
         "-semihosting-config", "enable=on,target=native", "-kernel", str(image)],
        capture_output=True, text=True, timeout=LONGEST_S, stdin=subprocess.DEVNULL, check=False)
    lines = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()]
    if done.returncode != 0:
        raise Unusable(f"{board.name} stopped early: {' '.join(lines[-2:])}")
    return lines


def board_image(board: Target, folder: Path, *, real: str, soft_double: bool, steps: int, optimisation: str) -> Path:
    """Compiles it; without steps the core is its self-test alone."""
    start, console = CORE / "cortex_m", BENCH / "cortex_m"
    chosen = [*([f"-DSTEPS={steps}", "-DLACONIC_HASH"] if steps else []),
              *(["-DLACONIC_SINGLE"] if real == "single" else [])]
    flags = [optimisation, *board.flags, *chosen, "-std=c99", "-ffp-contract=off", "-ffunction-sections",
             "-fdata-sections", "-DCHECK_DOUBLE_MAIN=0", '-DPRIx64="llx"', f"-I{CORE / 'include'}",
             f"-I{SELF_TEST.parent}", f"-I{console}", f"-I{start}"]
    compiler, out = board.tool("gcc"), folder / f"{board.name}.elf"
    sources = [BITS / "board_bits.c", SOFT_DOUBLE / "check_double.c", console / "bench_board.c", start / "startup.c",
               amalgamation() if steps else SELF_TEST, *([SOFT_DOUBLE / "soft_double.c"] if soft_double else [])]
    if steps:
        sources.append(folder / f"{board.name}.trajectories.o")
        called([compiler, *flags, "-Dmain=laconic_trajectory_hash", "-c", BITS / "trajectory_hash.c", "-o",
                sources[-1]])
    called([compiler, *flags, *sources, "-nostartfiles", "-Wl,--gc-sections", f"-L{start}", f"-T{board.script}", "-o",
            out])
    return out


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


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--only", metavar="NAME", help="targets whose name contains this")
    parser.add_argument("--steps", type=int, default=STEPS, help=f"of each trajectory, {STEPS} by default")


def run(options: argparse.Namespace) -> bool:
    """Each target once in both scalar types."""
    seen: dict[str, list[str]] = {}
    for target in TARGETS:
        if options.only and options.only not in target.name:
            continue
        if lacking := target.lacks():
            print(f"{target.name}: not here: no {lacking}")
            continue
        for real in ("double", "single"):
            hashes, wrong = target.bits(work("targets"), real, options.steps)
            is_same = hashes == seen.setdefault(real, hashes) and bool(hashes)
            print(f"{target.name}, {real}: {' '.join(hashes)}{'' if is_same else ', OTHER BITS'}", *wrong, flush=True)
            seen["differs"] = seen.get("differs", []) + ([] if is_same else [target.name])
    return not seen.get("differs") and len(seen) > 1
