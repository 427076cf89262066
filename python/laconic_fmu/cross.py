"""Builds binaries for other platforms with the C compiler in the package ziglang."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

TARGETS = {
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-windows": "x86_64-windows-gnu",
    "x86_64-darwin": "x86_64-macos.11.0",
    "aarch64-darwin": "aarch64-macos.11.0",
}
FLAGS = ("-std=c99", "-O2", "-g0", "-s", "-ffp-contract=off", "-fno-slp-vectorize")
"""The same arithmetic as in cmake/LaconicStrict.cmake; clang fuses multiply and add by default even with -std=c99."""


def compile_for(platform: str, sources: Sequence[str], includes: Sequence[str], out: Path, *, shared: bool = True,
                python: str = sys.executable, defined: Sequence[str] = ()) -> None:
    """Links one binary of an FMU for a platform."""
    kind = ["-shared", *([] if platform.endswith("windows") else ["-fPIC"])] if shared else ["-static"]
    named = [f"-D{each}" for each in defined]
    compile_to(TARGETS[platform], sources, includes, out, [*kind, *named, "-fvisibility=hidden"], python=python)


def compile_to(target: str, sources: Sequence[str | Path], includes: Sequence[str | Path], out: Path,
               flags: Sequence[str], *, python: str = sys.executable) -> None:
    """Links one binary for one of zig's targets; the compiler's own messages go to the terminal."""
    out.parent.mkdir(parents=True, exist_ok=True)
    if "macos" in target and "-shared" in flags:  # else it would name itself with this machine's path
        flags = [*flags, f"-Wl,-install_name,@rpath/{out.name}"]
    if target.endswith("musl"):  # else the compiler would first build the whole C library
        flags = [*flags, "-dynamic"]
    command = [python, "-m", "ziglang", "cc", "-target", target, *flags, *FLAGS,
               *(f"-I{folder}" for folder in includes), *map(str, sources), "-o", str(out)]
    subprocess.run(command, check=True, env={**os.environ, "ZIG_PROGRESS": "off"})


def main() -> None:
    """python -m laconic_fmu.cross PLATFORM OUT --include … --sources …"""
    parser = argparse.ArgumentParser(prog="laconic_fmu.cross", description=__doc__)
    parser.add_argument("platform", choices=sorted(TARGETS))
    parser.add_argument("out", type=Path)
    parser.add_argument("--include", nargs="*", default=[])
    parser.add_argument("--sources", nargs="+", required=True)
    parser.add_argument("--define", nargs="*", default=[])
    parser.add_argument("--python", default=sys.executable, help="the interpreter that has ziglang")
    arguments = parser.parse_args()
    compile_for(arguments.platform, arguments.sources, arguments.include, arguments.out, python=arguments.python,
                defined=arguments.define)


if __name__ == "__main__":
    main()
