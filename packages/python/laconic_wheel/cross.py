"""Core, node library and node process for another platform, by the C compiler in the package ziglang.

The compiler keeps what it has compiled: with the same options for all, the node library takes what the core's sources
became before, and the node process what the node library's did.
"""

from __future__ import annotations

from pathlib import Path

from laconic_fmu.cross import compile_to
from laconic_wheel.contents import REALS
from laconic_wheel.platforms import Platform

HOST_PORT = ("main.c", "station.c")
HOST_PORT_OF_LINUX = (*HOST_PORT, "socketcan.c")


def compile_all(platform: Platform, project: Path, wire: Path, out: Path, python: str) -> Path:
    """Compiles into the folders lib and bin of `out`, which is returned."""
    node_dir = project / "firmware_stub"
    rooms = ("src", "derivatives", "filter", "estimate", "batch")
    core = sorted(path for room in rooms for path in (project / "core_c" / room).glob("*.c"))
    apart = [node_dir / "src" / name for name in ("shared_library.c", "library_drives.c")]
    rooms_of_node = ("src", "drives", "secure")
    node = [path for room in rooms_of_node for path in sorted((node_dir / room).rglob("*.c"))
            if path not in apart] + sorted(wire.glob("*.c"))
    includes = [project / "core_c" / "include", project / "core_c" / "src", node_dir / "include", node_dir / "src",
                node_dir / "drives", wire]
    position = [] if platform.is_windows else ["-fPIC"]
    for real in REALS:
        flags = [*position, "-DLACONIC_NODE_WITH_ESTIMATE=1", *(["-DLACONIC_SINGLE"] if real == "single" else [])]
        whole = [*core, *node]
        for name, sources in ((f"laconic_{real}", core), (f"laconic_node_{real}", [*whole, *apart])):
            compile_to(platform.target, sources, includes, out / "lib" / platform.library.format(name),
                       ["-shared", *flags], python=python)
        if platform.has_node_process:
            names = HOST_PORT_OF_LINUX if platform.is_linux else HOST_PORT
            port = [node_dir / "ports" / "host" / name for name in names]
            compile_to(platform.target, [*whole, *port], includes, out / "bin" / f"laconic-node-{real}", flags,
                       python=python)
    return out
