"""Core, node library and node process for another platform, by the C compiler in the package ziglang.

The compiler keeps what it has compiled: with the same options for all, the node library takes what the core's sources
became before, and the node process what the node library's did.
"""

from __future__ import annotations

from pathlib import Path

from laconic_build.wheel.contents import REALS, Platform
from laconic_fmu.cross import compile_to

OPTIONAL = ("articulated", "articulated_friction", "derivatives", "filter", "estimate", "batch")
"""Parts of the core that the libraries have."""
HOST_PORT = ("main.c", "station.c")
HOST_PORT_OF_LINUX = (*HOST_PORT, "socketcan.c")


def compile_all(platform: Platform, project: Path, wire: Path, out: Path, python: str) -> Path:
    """Compiles into the folders lib and bin of `out`, which is returned."""
    node_dir = project / "firmware_stub"
    core_dir = project / "core_c"
    optional = [core_dir / "optional" / name for name in OPTIONAL]
    core = sorted(path for folder in (core_dir / "src", *optional) for path in folder.rglob("*.c"))
    node = [path for room in ("wire", "node", "drives", "secure") for path in sorted((node_dir / room).rglob("*.c"))]
    node += sorted(wire.glob("*.c"))
    apart = sorted((node_dir / "ports" / "library").glob("*.c"))
    includes = [core_dir / "include", *sorted(path for path in (core_dir / "src").iterdir()), *optional,
                node_dir / "include", node_dir / "node", node_dir / "drives", node_dir / "ports" / "library", wire]
    position = [] if platform.is_windows else ["-fPIC"]
    for real in REALS:
        parts = [f"-DLACONIC_NODE_WITH_{part}=1" for part in ("ESTIMATE", "HINGES", "XCP")]
        flags = [*position, *parts, *(["-DLACONIC_SINGLE"] if real == "single" else [])]
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
