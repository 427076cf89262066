"""Fuzzing: whatever reads bytes, frames, calls, vehicles and files, under sanitizers for addresses and undefined
behaviour. By libFuzzer where clang has it; else the seeds alone are tried.

    fuzz [--only TARGET] [--seconds S] [--runs N] [--seed K]

Each target runs S seconds, or N inputs, the same ones for the same seed. A fault is printed with the file that shows
it, below the build tree."""

from __future__ import annotations

import argparse
import hashlib
import random
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from assurance.common import Entry, Unusable, build, called, each, of_targets, once, work

HERE = Path(__file__).parent
CHECKS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
FLAGS = ("-std=c99", "-O2", "-g", "-ffp-contract=off")
# Comparisons are not watched, which takes two thirds of the time; nor is the depth of the stack, which differs by run.
FEEDBACK = ("-fsanitize=fuzzer", "-fno-sanitize-coverage=trace-cmp,stack-depth")
LIBRARIES = {"core": ("laconic_objects_double",), "node": ("laconic_node_double", "laconic_wire"),
             "fmi": ("Laconic_fmi2", "Laconic_fmi3", "laconic_fmu_core"), "bus": ("LaconicNode_fmi3",)}
"""What a target is linked with; behind a colon the files, where a few are enough."""
WITHOUT = ("batch", "soft_double")  # folders of the core


@dataclass(frozen=True)
class Target:
    """`most_bytes`: of an input. `takes`: what it is linked with; `also`: further sources and options. `source`: the
    name in fuzz_NAME.c, the target's own if empty."""

    most_bytes: int
    takes: tuple[str, ...]
    also: tuple[str, ...] = ()
    source: str = ""


NODE, FMI = ("node", "core"), ("fmi",)
CHECKSUM = ("fuzz_checksum.c", "-Wl,--wrap=fmu_checksum")
TARGETS = {"slcan": Target(400, ("node:slcan",)), "frames": Target(240, NODE), "loader": Target(1000, NODE),
           "vehicle": Target(120, ("core",)), "steps": Target(80, ("core",)), "canopen": Target(240, NODE),
           **{name: Target(most_bytes, NODE, (f"-DFUZZ_{name.upper()}",), "drives")
              for name, most_bytes in (("odrive", 200), ("moteus", 200), ("robomaster", 150))},
           "fmi": Target(100, FMI, CHECKSUM), "fmu_state": Target(100, FMI, CHECKSUM),
           "bus": Target(300, ("bus:ls_bus,can_controller,network_port",))}


def compiler() -> list[str]:
    """clang with libFuzzer where it is, else gcc, which replays."""
    probe = work("fuzz") / "probe.c"
    probe.write_text("int LLVMFuzzerTestOneInput(const char *d, unsigned long n);\n"
                     "int LLVMFuzzerTestOneInput(const char *d, unsigned long n) { return d == 0 && n; }\n")
    for clang in ("clang", "clang-19"):
        if shutil.which(clang) and not subprocess.run([clang, *CHECKS, *FEEDBACK, probe, "-o", probe.with_suffix("")],
                                                      capture_output=True, check=False).returncode:
            return [clang, *CHECKS, *FLAGS, *FEEDBACK]
    return ["gcc", *CHECKS, *FLAGS]


def library(name: str, command: list[str]) -> tuple[Path, list[Entry]]:
    """An archive of a part's sources under sanitizers, made anew when a source or an option is another."""
    part, _, files = name.partition(":")
    own = [entry for entry in of_targets(*LIBRARIES[part]) if not set(WITHOUT) & {*entry.source.parts}
           and (not files or entry.source.stem in files.split(","))]
    sources = sorted({path for entry in own for path in (entry.source, *entry.source.parent.glob("*.h"))})
    folders = {Path(flag) for entry in own for flag in entry.flags("-isystem") if flag != "-isystem"}
    if missing := [path for path in (*sources, *folders) if not path.exists()]:
        raise Unusable(f"{missing[0]}: is not made yet; cmake --build {build()}")
    digest = hashlib.sha256(repr(command).encode() + b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]
    folder = work("fuzz") / f"{name.replace(':', '-')}-{digest}"
    archive = folder / "lib.a"
    if not archive.exists():
        for old in folder.parent.glob(f"{folder.name[:-16]}*"):
            shutil.rmtree(old)
        folder.mkdir()
        objects = [folder / f"{number}.o" for number in range(len(own))]
        each([[*command, "-w", *entry.headers(), "-c", entry.source, "-o", out]
              for entry, out in zip(own, objects, strict=True)])
        called(["ar", "qcs", archive, *objects])
    return archive, own


def program(name: str) -> Path:
    """A target's program."""
    target, command = TARGETS[name], compiler()
    made = [library(each, command) for each in target.takes]
    headers = once(flag for _, own in made for entry in own for flag in entry.headers())
    also = [str(HERE / word) if word.endswith(".c") else word for word in target.also]
    replay = [] if command[0] != "gcc" else [HERE / "replay_main.c"]
    out = work("fuzz") / f"fuzz_{name}"
    archives = [archive for archive, _ in made]
    called([*command, *headers, HERE / f"fuzz_{target.source or name}.c", *also, *replay, *archives, "-o", out])
    return out


def search(name: str, seconds: float, runs: int | None, seed: int) -> bool:
    """Runs a target; prints what it found."""
    target, made, folder = TARGETS[name], program(name), work("fuzz") / "inputs" / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write_seeds(name, target.most_bytes, folder)
    limit = [f"-runs={runs}"] if runs is not None else [f"-max_total_time={max(1, round(seconds))}"]
    options = [f"-seed={seed}", *limit, "-reload=0", "-timeout=20", f"-max_len={target.most_bytes}",
               "-rss_limit_mb=1024", f"-artifact_prefix={folder.parent}/{name}-"]
    has_feedback = b"libFuzzer" in made.read_bytes()
    done = subprocess.run([made, *(options if has_feedback else ()), folder], capture_output=True, text=True,
                          errors="replace", stdin=subprocess.DEVNULL, check=False)
    told = done.stderr + done.stdout
    counts = re.findall(r"Done (\d+) runs|(\d+) files replayed|^#(\d+)\s", told, re.MULTILINE)
    inputs = max((int("".join(count)) for count in counts), default=0)
    edges = (re.findall(r"cov: (\d+)", told) or ["no"])[-1]
    is_sound = done.returncode == 0 and inputs > 0
    print(f"{name}: {inputs} inputs, {edges} edges, {'nothing found' if is_sound else 'FOUND:'}", flush=True)
    if not is_sound:
        print(told[-3000:])
    return is_sound


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--only", metavar="TARGET", help="one of " + ", ".join((*TARGETS, "files")))
    parser.add_argument("--seconds", type=float, default=60.0, help="for each target, 60 by default")
    parser.add_argument("--runs", type=int, metavar="N", help="so many inputs instead")
    parser.add_argument("--seed", type=int, default=1)


def run(options: argparse.Namespace) -> bool:
    """All targets, or one."""
    known = (*TARGETS, "files")
    if options.only is not None and options.only not in known:
        raise Unusable(f"--only {options.only}: is no fuzz target; known are {', '.join(known)}")
    found = True
    for name in known if options.only is None else (options.only,):
        if name == "files":
            from assurance.fuzz import files

            found &= files.search(options.seconds, options.runs, options.seed)
        else:
            found &= search(name, options.seconds, options.runs, options.seed)
    return found


# ---- Seeds for the fuzz targets: a few dozen inputs each, made anew with every run. Coverage leads on from them.

SEEDS = 24
LINES = (b"O\r", b"L\r", b"C\r", b"S6\r", b"V\r", b"N\r", b"F\r", b"Y2\r", b"t10080102030405060708\r",
         b"T123456788AABBCCDD\r", b"r1234\r", b"R1FFFFFFF0\r",
         b"d0609" + 24 * b"A5" + b"\r", b"D1234567F" + 64 * b"0F" + b"\r", b"b1111FF\r")
RECORDS = {"frames": (10, 32), "canopen": (12, 16), "loader": (7, 64)}
"""Of targets whose inputs are records: their bytes, and how many choices their first byte has."""


def write_seeds(target: str, most_bytes: int, folder: Path) -> None:
    """The same ones each time."""
    source = random.Random(target)
    for number in range(SEEDS):
        (folder / f"seed-{number:02}").write_bytes(seed_of(target, source, most_bytes)[:most_bytes])


def seed_of(target: str, source: random.Random, most_bytes: int) -> bytes:
    """One input."""
    if target == "slcan":
        return b"1O\r" + b"".join(source.choice(LINES) for _ in range(source.randrange(1, 12)))
    if target in RECORDS:
        length, choices = RECORDS[target]
        return b"".join(bytes([source.randrange(choices)]) + source.randbytes(length - 1)
                        for _ in range(most_bytes // length))
    if target in ("odrive", "moteus", "robomaster"):
        return b"".join(drive_record(source) for _ in range(12))
    # numbers mostly from the tables of usual ones
    return bytes(source.randrange(128) if source.random() < 0.7 else source.randrange(256)
                 for _ in range(source.randrange(8, most_bytes)))


def drive_record(source: random.Random) -> bytes:
    """Steps, or a frame to a drive."""
    if source.random() < 0.4:
        return bytes([128 + source.randrange(128)])
    length, number = source.randrange(9), source.choice((1, 2)) << source.choice((0, 5)) | source.randrange(32)
    return bytes([length]) + number.to_bytes(4, "little") + source.randbytes(length)
