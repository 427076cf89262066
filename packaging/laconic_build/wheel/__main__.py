"""python -m laconic_build.wheel native|PLATFORM… makes wheels; the build gives the options."""

from __future__ import annotations

import argparse
import sys
import sysconfig
from pathlib import Path

from laconic_build.wheel import contents
from laconic_build.wheel.archive import make_wheel
from laconic_build.wheel.contents import PLATFORMS, compiler_licences, licences
from laconic_build.wheel.cross import compile_all

NATIVE = "native"
ENDINGS = {"win32": "{}.dll", "darwin": "lib{}.dylib"}


def main() -> None:
    """Prints each wheel with its size."""
    given = parse()
    same = contents.python_files(given.project) | contents.project_files(given.project) | \
        contents.for_every_platform(given.build)
    of_others = licences(given.fmi_headers, given.wire)
    for name in given.platforms:
        of_compiler: dict[str, str] = {}
        if name == NATIVE:
            tag = sysconfig.get_platform().replace("-", "_").replace(".", "_")
            files = contents.compiled(given.build, ENDINGS.get(sys.platform, "lib{}.so"), contents.PROGRAMS)
        else:
            platform = PLATFORMS[name]
            tag = platform.tag
            folder = compile_all(platform, given.project, given.wire, given.build / "cross-wheels" / name, given.zig)
            files = contents.compiled(folder, platform.library, contents.PROGRAMS if platform.has_node_process else ())
            of_compiler = compiler_licences(given.zig)
        texts = of_others | of_compiler
        made = make_wheel(given.project, same | files, texts, version=given.version, tag=tag, out=given.out)
        print(f"{made} ({made.stat().st_size / 1e6:.1f} MB)", flush=True)


def parse() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="laconic_build.wheel", description=__doc__)
    parser.add_argument("platforms", nargs="+", choices=(NATIVE, *PLATFORMS))
    for name, text in (("project", "the sources"), ("build", "the build tree"), ("out", "where the wheels go"),
                       ("wire", "the wire contract's C"), ("fmi-headers", "those of FMI")):
        parser.add_argument(f"--{name}", type=Path, required=True, help=f"folder: {text}")
    parser.add_argument("--version", required=True)
    parser.add_argument("--zig", default=sys.executable, help="the interpreter that has ziglang")
    return parser.parse_args()


if __name__ == "__main__":
    main()
