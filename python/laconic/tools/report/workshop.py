"""Compiles the bench for one scene: for the host and for Cortex-M boards, whole core or trimmed to the scene.

Compilers and binary tools, called: what they print, or an error with their message.

Sources of the core as a static library that is compiled as far as programs ask for it: a step by one method needs a
fifth of the files. Which file defines what is read off the library of the build tree; what that does not tell is
compiled, too.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from laconic.base.paths import SOURCE_DIR, build_dir, sources_missing
from laconic.core import Core, load
from laconic.errors import ResultFails
from laconic.scene import Scene
from laconic.scene.methods import ROWS
from laconic.tools.trim import Trimmed, trimmed
from laconic.tools.trim.scene_files import initializer

MADE = "core_c/liblaconic.a"  # of the build tree


class CoreArchive:
    """A folder with the library and its objects (and what the compiler writes beside these). `always`: files that
    nothing asks for by name, since they stand in for what the compiler's own library has."""

    def __init__(self, place: Path, sources: Iterable[Path], always: Iterable[Path], compile_command: Sequence[str],
                 prefix: str) -> None:
        """Of these sources, compiled by that command with binary tools of that prefix; nothing is compiled yet."""
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        self.place, self.path = place, place / "libcore.a"
        self._left = {path.name: path for path in sources}
        self._command, self._prefix = list(compile_command), prefix
        self._compile(list(always))

    def provide(self, wanted: Iterable[str]) -> set[str]:
        """Compiles what defines these names and what that wants in turn; returns what the new objects want."""
        home, todo, asked = home_of_names(), set(wanted), set[str]()
        while new := {home[name] for name in todo if home.get(name) in self._left}:
            todo = self._compile([self._left.pop(name) for name in sorted(new)])
            asked |= todo
        return asked

    def provide_all(self) -> bool:
        """Compiles what is left; whether there was anything."""
        left = list(self._left.values())
        self._left.clear()
        self._compile(left)
        return bool(left)

    def _compile(self, sources: list[Path]) -> set[str]:
        """Puts them into the library; returns what they want."""
        objects = [path.with_suffix(".o").name for path in sources]
        if sources:
            run_tool([*self._command, "-c", *map(str, sources)], self.place)
        run_tool([f"{self._prefix}ar", "rcs", self.path.name, *objects], self.place)
        return undefined(self._prefix, [self.place / name for name in objects])


@cache
def home_of_names() -> dict[str, str]:
    """The name of the C file that defines a name of the core; empty where there is no such library to read."""
    made = build_dir() / MADE
    if not made.is_file() or shutil.which("nm") is None:
        return {}
    found = {}
    for line in run_tool(["nm", "-A", "-g", "--defined-only", str(made)]).splitlines():
        member, name = line.rpartition(":")[0].rpartition(":")[2], line.rpartition(" ")[2]
        found[name] = member.partition(".c.")[0] + ".c"
    return found


def undefined(prefix: str, objects: Sequence[Path]) -> set[str]:
    """The names that objects want of others."""
    if not objects:
        return set()
    return {line.split()[-1] for line in run_tool([f"{prefix}nm", "-u", *map(str, objects)]).splitlines()
            if line.startswith(" ")}


def run_tool(command: Sequence[str], where: Path | None = None) -> str:
    """A compiler or binary tool; its messages when it fails."""
    done = subprocess.run(command, capture_output=True, text=True, cwd=where, check=False)
    if done.returncode != 0:
        first = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr[-300:])
        raise ResultFails(f"{command[0]} failed: {first}")
    return done.stdout


BENCH = SOURCE_DIR / "core_c" / "bench"
FLAGS = ("-std=c99", "-ffp-contract=off", "-fno-tree-slp-vectorize", "-ffunction-sections", "-fdata-sections")
PARTS = {row.name: row.needs for row in ROWS}
"""What each method needs of a build: the end of a macro LACONIC_WITH_…, or NOTHING."""
LEFT_OUT = sorted({need for need in PARTS.values() if need != "NOTHING"})
SAMPLED_STEPS = 16  # of a scene with sampled inputs, taken again and again


@dataclass(frozen=True)
class Target:
    """A processor: its compiler with flags and, for a board, QEMU's machine and the linker script."""

    name: str
    tools: str  # prefix of gcc, nm, size
    flags: tuple[str, ...] = ()
    machine: str = ""
    script: str = ""
    hardware_single: bool = False
    hardware_double: bool = False

    def tool(self, name: str) -> str:
        """The full name of a tool of this target."""
        return self.tools + name

    @property
    def present(self) -> bool:
        """Whether its compiler, its emulator and our sources are here."""
        return not self.missing

    @property
    def missing(self) -> str:
        """What of that is not, with what to do; empty where all is."""
        if lacking := sources_missing():
            return lacking
        if self.machine and shutil.which("qemu-system-arm") is None:
            return "qemu-system-arm: install it"
        if not can_link(self.tool("gcc"), self.flags, bare=bool(self.machine)):
            return f"{self.tool('gcc')} with its C library, which comes apart: install both"
        return ""

    def windows(self, real: str) -> tuple[int, ...]:
        """Numbers of steps to try: twice as many must fit the 24-bit counter."""
        in_hardware = self.hardware_double if real == "double" else self.hardware_single
        return (256, 40, 10) if in_hardware else (10, 2)


@cache
def can_link(compiler: str, flags: tuple[str, ...], bare: bool) -> bool:
    """Whether a compiler is there and finds headers and library of C for a processor."""
    if shutil.which(compiler) is None:
        return False
    more = ("-nostartfiles", "-Wl,-e,main") if bare else ()
    with TemporaryDirectory() as folder:
        command = [compiler, *flags, *more, "-x", "c", "-", "-o", str(Path(folder) / "probe")]
        return subprocess.run(command, input="#include <stdint.h>\nint main(void) { return 0; }\n", text=True,
                              capture_output=True, check=False).returncode == 0


ARM, THUMB = "arm-none-eabi-", "-mthumb"
HOST = Target("host", "")
M4F = Target("Cortex-M4F", ARM, (THUMB, "-mcpu=cortex-m4", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"), "mps2-an386",
             "mps2.ld", hardware_single=True)
BOARDS = (
    Target("Cortex-M0", ARM, (THUMB, "-mcpu=cortex-m0"), "microbit", "microbit.ld"),
    Target("Cortex-M3", ARM, (THUMB, "-mcpu=cortex-m3"), "mps2-an385", "mps2.ld"),
    M4F,
    Target("Cortex-M7", ARM, (THUMB, "-mcpu=cortex-m7", "-mfloat-abi=hard", "-mfpu=fpv5-d16"), "mps2-an500", "mps2.ld",
           hardware_single=True, hardware_double=True),
)


@dataclass(frozen=True)
class Variant:
    """What is built: a scene (with its method and step), a scalar type, an optimisation, whole or trimmed."""

    scene: Scene
    real: str
    optimisation: str = "-O2"
    trim: bool = False

    @property
    def name(self) -> str:
        """A folder's name."""
        run, kind = self.scene.run, "trimmed" if self.trim else "whole"
        parts = (self.scene.path.stem, run.method, f"{run.step_s:g}", self.real, self.optimisation.strip("-"), kind)
        return "_".join(parts)


def segments_source(core: Core, scene: Scene, names: dict[int, str] | None = None) -> str:
    """bench_segments.c: the scene's inputs."""
    inputs, rows = scene.inputs_on_grid(), []
    if inputs.is_held:
        for segment in inputs.segments():
            held = initializer(core.ffi, core.input(segment.values)[0], names or {})
            rows.append(f"{{.steps = {segment.steps}, .start = {held}}}")
    else:
        for sample in inputs.samples(0, SAMPLED_STEPS):
            at = [initializer(core.ffi, core.input(dict(zip(inputs.signals, row.tolist(), strict=True)))[0], {})
                  for row in sample]
            rows.append(f"{{.steps = 1, .sampled = true, .start = {at[0]}, .middle = {at[1]}, .end = {at[2]}}}")
    table = ",\n    ".join(rows)
    return (f'#include "bench.h"\n\nconst bench_segment bench_segments[] = {{\n    {table}}};\n'
            f"const uint32_t bench_segment_count = {len(rows)};\n"
            "const char bench_state_bytes[BENCH_STATE_BYTES] = {0};\n")


def _whole(variant: Variant) -> str:
    """The folder of what is built for all scenes alike."""
    method = variant.scene.run.method
    return f"whole_{method}" if PARTS[method] in LEFT_OUT else "whole"


def _trimmed(variant: Variant) -> str:
    """The folder of what is built for a scene, whose methods share a core but those with structs of their own."""
    method, stem = variant.scene.run.method, variant.scene.path.stem
    return f"trimmed_{stem}_{method}" if PARTS[method] in LEFT_OUT else f"trimmed_{stem}"


def _kind(target: Target, variant: Variant, extra: Sequence[str] = ()) -> str:
    """The folder of what one compiler makes with the same options."""
    return "_".join((target.name, variant.real, variant.optimisation.strip("-"), *(each.strip("-") for each in extra)))


def entry_of(files: Trimmed, scene: Scene) -> str:
    """The function of the core that takes a step of the scene."""
    if files.needs.friction:
        return "laconic_friction_step"
    return "laconic_step" if scene.inputs_on_grid().is_held else "laconic_step_sampled"


class Workshop:
    """Builds into one folder; a file of the core is compiled once per target, scalar type and optimisation.

    Boards without double precision in hardware get soft_double.c with it, unless `soft_double` is False: then libgcc's
    adder, which has its faults (docs/c.md).
    """

    def __init__(self, folder: Path, core_dir: Path = SOURCE_DIR / "core_c", *, soft_double: bool = True) -> None:
        """Where to build, from which core."""
        self.folder, self.core_dir = folder.resolve(), core_dir  # gcc runs in other folders
        self.soft_double = soft_double
        self._archives: dict[Path, CoreArchive] = {}
        self._trimmed: dict[tuple[str, str, str, float], Trimmed] = {}

    def files(self, variant: Variant) -> tuple[Path, Trimmed]:
        """The generated C of a variant, and the folder it is in."""
        folder = self.folder / variant.name
        key = (str(variant.scene.path), variant.real, variant.scene.run.method, variant.scene.run.step_s)
        if key not in self._trimmed:
            self._trimmed[key] = trimmed(variant.scene, variant.real)
        files = self._trimmed[key]
        files.write(folder)
        (folder / "bench_segments.c").write_text(segments_source(load(variant.real), variant.scene))
        return folder, files

    def definitions(self, target: Target, variant: Variant, folder: Path) -> list[str]:
        """The definitions for the preprocessor: on a board those of firmware images, unless the method needs more."""
        found = ["-DLACONIC_SINGLE"] if variant.real == "single" else []
        if variant.trim:
            found.append(f'-DLACONIC_SCENE_HEADER="{folder / "laconic_scene.h"}"')
        elif target.machine:
            found += [f"-DLACONIC_WITH_{need}=0" for need in LEFT_OUT if need != PARTS[variant.scene.run.method]]
        return found

    def includes(self) -> list[str]:
        """The folders of the core's headers, public and its own."""
        own = sorted(path for path in (self.core_dir / "src").iterdir() if path.is_dir())
        return [f"-I{path}" for path in (self.core_dir / "include", *own)]

    def archive(self, target: Target, variant: Variant, folder: Path, extra: Sequence[str] = ()) -> CoreArchive:
        """The core as a static library, with .ci files (call graph and stack) beside its objects."""
        place = self.folder / (_trimmed(variant) if variant.trim else _whole(variant)) / _kind(target, variant, extra)
        if place not in self._archives:
            needs_sum = self.soft_double and target.machine and variant.real == "double" and not target.hardware_double
            always = [self.core_dir / "optional" / "soft_double" / "soft_double.c"] if needs_sum else []
            graph = ("-fstack-usage", "-fcallgraph-info=su") if target.machine else ()
            self._archives[place] = CoreArchive(place, (self.core_dir / "src").rglob("*.c"), always, [
                target.tool("gcc"), *FLAGS, *graph, *extra, variant.optimisation, *target.flags,
                *self.definitions(target, variant, folder), *self.includes()], target.tools)
        return self._archives[place]

    def _link(self, target: Target, variant: Variant, name: str, sources: Sequence[Path], flags: Sequence[str],
              extra: Sequence[str] = (), tables: Sequence[str] = ("laconic_scene_model.c", "bench_segments.c"),
              before: Sequence[CoreArchive] = ()) -> Path:
        folder, _ = self.files(variant)
        output = folder / f"{target.name}_{name}"
        archives = [*before, self.archive(target, variant, folder, extra)]
        gcc = [target.tool("gcc"), *FLAGS, *extra, variant.optimisation, *target.flags]
        objects = self._objects(folder / f"{output.name}.objects", [
            *gcc, *self.definitions(target, variant, folder), f"-I{self.core_dir / 'include'}", f"-I{BENCH}",
            f"-I{folder}", *flags], [*sources, *(folder / table for table in tables)])
        wanted = undefined(target.tools, objects) | {word for flag in flags for word in flag.split(",")[2:]}
        for archive in archives:
            wanted |= archive.provide(wanted)
        command = [*gcc, *map(str, objects), *(str(archive.path) for archive in archives), "-Wl,--gc-sections",
                   "-Wl,-z,defs", *flags, "-o", str(output)]
        try:
            run_tool(command)
        except ResultFails:
            if not any([archive.provide_all() for archive in archives]):
                raise
            run_tool(command)
        return output

    def _objects(self, place: Path, compile_command: Sequence[str], sources: Sequence[Path]) -> list[Path]:
        """What is linked beside the core, compiled by itself, so that it tells what it wants."""
        place.mkdir(exist_ok=True)
        run_tool([*compile_command, "-c", *map(str, sources)], place)
        return [place / source.with_suffix(".o").name for source in sources]

    def host_program(self, variant: Variant) -> Path:
        """count STEPS."""
        return self._link(HOST, variant, "count", [BENCH / "bench.c", BENCH / "count_host.c"], [])

    def host_library(self, variant: Variant) -> Path:
        """The bench as a shared library: bench_reset, bench_run."""
        return self._link(HOST, variant, "bench.so", [BENCH / "bench.c"], ["-shared", "-Wl,-Bsymbolic"], ["-fPIC"])

    def hand_program(self, variant: Variant, *, refuses: bool) -> Path:
        """Counts steps of the kernel that was written by hand for one method; the model is part of it."""
        return self._hand(variant, f"hand{refuses:d}", [BENCH / "count_host.c"], [f"-DHAND_REFUSES={refuses:d}"])

    def hand_library(self, variant: Variant, *, refuses: bool) -> Path:
        """The same as a shared library."""
        flags = [f"-DHAND_REFUSES={refuses:d}", "-shared", "-Wl,-Bsymbolic"]
        return self._hand(variant, f"hand{refuses:d}.so", [], flags, ["-fPIC"])

    def _hand(self, variant: Variant, name: str, sources: Sequence[Path], flags: Sequence[str],
              extra: Sequence[str] = ()) -> Path:
        kernel = BENCH / "peers" / "hand_rk4.c"
        return self._link(HOST, variant, name, [kernel, *sources], [*self.includes(), *flags], extra,
                          ["bench_segments.c"])

    def board_image(self, target: Target, variant: Variant, steps: int, program: str = "count") -> Path:
        """The image that counts so many steps on a board: all together, or each by itself (`spread`)."""
        board, startup = BENCH / "cortex_m", BENCH.parent / "cortex_m"
        sources = [BENCH / "bench.c", startup / "startup.c", board / "bench_board.c", board / f"{program}.c"]
        flags = [f"-DBENCH_STEPS={steps}", f"-I{board}", f"-I{startup}", "-ffreestanding", "-nostartfiles",
                 f"-L{startup}", f"-T{target.script}"]
        return self._link(target, variant, f"{program}.elf", sources, flags)

    def filter_image(self, target: Target, variant: Variant, readings: str, sources: Sequence[Path],
                     flags: Sequence[str]) -> Path:
        """The core with its filter and recorded readings, and these sources, linked with these flags."""
        folder, _ = self.files(variant)
        (folder / "bench_readings.c").write_text(readings)
        name = f"filter_{sources[-1].stem}" if sources else "filter"
        return self._link(target, variant, name, [BENCH / "filter.c", folder / "bench_readings.c", *sources], flags,
                          before=[self._filter_archive(target, variant)])

    def _filter_archive(self, target: Target, variant: Variant) -> CoreArchive:
        place = self.folder / f"filter_{_whole(variant)}" / _kind(target, variant)
        if place not in self._archives:
            folders = [self.core_dir / "optional" / name for name in ("derivatives", "filter")]
            sources = [path for folder in folders for path in folder.glob("*.c")]
            self._archives[place] = CoreArchive(place, sources, [], [
                target.tool("gcc"), *FLAGS, variant.optimisation, *target.flags,
                *self.definitions(target, variant, self.files(variant)[0]), *self.includes(),
                *(f"-I{folder}" for folder in folders)], target.tools)
        return self._archives[place]

    def step_image(self, target: Target, variant: Variant) -> Path:
        """What laconic_step with the scene's constants brings into flash, and nothing else."""
        _, files = self.files(variant)
        entry, slips = entry_of(files, variant.scene), ["laconic_scene_friction"] if files.needs.friction else []
        kept = ["laconic_scene_model", "laconic_scene_integrator", "bench_state_bytes", *slips]
        keep = [f"-Wl,-u,{name}" for name in kept]
        flags = ["-nostartfiles", "-ffreestanding", f"-Wl,-e,{entry}", "-Wl,-Ttext=0x1000", *keep]
        return self._link(target, variant, "step.elf", [], flags)
