"""The parts that static checks look at: files with the options by which a compiler would be given them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from laconic.errors import BadInput
from laconic.paths import SOURCE_DIR, build_dir, sources_missing

CORE, NODE, FMU = "core_c/src", "firmware_stub/src", "fmu"
OF_NODE = ("firmware_stub/include", "firmware_stub/drives", "firmware_stub/src")


@dataclass(frozen=True)
class Part:
    """Files that are looked at together. `column`: where its findings are counted."""

    name: str
    column: str
    patterns: tuple[str, ...]
    folders: tuple[str, ...]  # of headers, of the project
    without: tuple[str, ...] = ()  # names of files that another build compiles

    def files(self) -> list[Path]:
        """Its C files, from the project's root."""
        found = {path for pattern in self.patterns for path in SOURCE_DIR.glob(pattern)}
        return [path.relative_to(SOURCE_DIR) for path in sorted(found) if path.name not in self.without]

    def includes(self) -> list[str]:
        """Folders of headers: of the project, made by the build, and of FMI."""
        return [*map(str, ("core_c/include", *self.folders)), *map(str, made_folders())]


NETWORK = ("fmu", "fmu/network", *OF_NODE)
PARTS = (
    Part("core", "core", ("core_c/src/*.c",), (CORE,)),
    Part("node", "node", ("firmware_stub/src/*.c", "firmware_stub/secure/*.c"), OF_NODE),
    Part("FMU glue and vehicle", "FMU", ("fmu/*.c", "fmu/vehicle/*.c"),
         ("fmu", "fmu/vehicle", CORE, "core_c/derivatives"), without=("kept_step.c", "estimate_part.c")),
    Part("controller", "FMU", ("fmu/controller/*.c",), ("fmu", "fmu/controller")),
    Part("bus", "FMU", ("fmu/network/*.c", "fmu/network/bus/*.c"), ("fmu/network/bus", *NETWORK)),
    Part("node as FMU", "FMU", ("fmu/network/node/*.c",), ("fmu/network/node", *NETWORK)),
    Part("RoboMaster as FMU", "FMU", ("fmu/network/robomaster/*.c",), ("fmu/network/robomaster", *NETWORK)),
)


def made_folders() -> Iterable[Path]:
    """Headers that no checkout has: the wire contract, and FMI's from FMPy."""
    wire = build_dir() / "firmware_stub" / "wire"
    fmpy = find_spec("fmpy")
    if sources_missing() or not wire.is_dir() or fmpy is None or fmpy.origin is None:
        raise BadInput("static checks: need the project's sources with a build tree; "
                       "build the target laconic_wire_files in a checkout")
    return wire, Path(fmpy.origin).parent / "c-code"
