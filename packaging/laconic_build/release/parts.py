"""What others wrote that is inside of what a release gives out: each part's licence, and the text of it.

A part is told once, here; a product (products.py) names the keys of the parts inside of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import Distribution, distribution, distributions
from pathlib import Path

from laconic_fmu.licences import compiler_text, licence_of

NORMALIZE = "/*! normalize.css v8.0.1 | MIT License | github.com/necolas/normalize.css */"  # the head of furo.css


@dataclass(frozen=True)
class Part:
    """One of them."""

    key: str
    name: str
    version: str
    licence: str  # as SPDX names it, or a sentence where SPDX has no name
    is_spdx: bool
    what: str  # of it, and where
    text: Callable[[], str]


@dataclass(frozen=True)
class Places:
    """Folders where the texts are."""

    fmi_headers: Path
    wire: Path  # generated C of the wire contract
    zig: Path  # the package ziglang
    site_python: Path  # what made the site


def parts(places: Places) -> dict[str, Part]:
    """All parts by their keys."""
    every = (*compiled_in(places), *of_the_compiler(places.zig), *in_the_site(places.site_python))
    return {part.key: part for part in every}


def compiled_in(places: Places) -> tuple[Part, ...]:
    """What is compiled with our sources."""
    return (
        Part("fmi-headers", "FMI standard headers", "2.0.4 and 3.0.1", "BSD-2-Clause", True,
             "types of the interface, compiled into the FMUs",
             lambda: licence_of(places.fmi_headers / "fmi3FunctionTypes.h")),
        Part("cantools", "cantools", distribution("cantools").version, "MIT", True,
             "C that it generates from laconic.dbc, compiled into the node",
             lambda: licence_of(places.wire / "laconic_dbc.c")))


def of_the_compiler(zig: Path) -> tuple[Part, ...]:
    """What the compiler adds to binaries."""
    version = by_name(zig.parent)["ziglang"].version

    def text(key: str) -> Callable[[], str]:
        return lambda: compiler_text(zig, key)

    return (
        Part("zig", "zig compiler runtime", version, "MIT", True, "compiler-rt, in every binary", text("zig")),
        Part("mingw-w64", "mingw-w64 runtime", f"of zig {version}", "public domain, ZPL-2.1 and others", False,
             "start of Windows libraries", text("mingw-w64")),
        Part("musl", "musl", f"of zig {version}", "MIT", True,
             "start of programs for musl, functions of libraries for Windows", text("musl")),
        Part("glibc", "glibc start files", f"of zig {version}", "LGPL-2.1-or-later with the exception for start files",
             False, "start of programs and libraries for glibc", text("glibc")))


def in_the_site(made_by: Path) -> tuple[Part, ...]:
    """What Sphinx and its theme put into the site."""
    found = by_name(made_by)

    def part(key: str, name: str, licence: str, what: str) -> Part:
        of = found[key]
        return Part(key, name, of.version, licence, True, what, lambda: licence_file(of))

    furo = found["furo"]
    return (
        Part("furo", "Furo", furo.version, "MIT", True, "the site's style and script, with normalize.css 8.0.1, "
             "gumshoe 5.1.2 and icons of Feather and Tabler, all MIT", lambda: furo_text(furo, made_by)),
        part("sphinx-basic-ng", "sphinx-basic-ng", "MIT", "the site's frame"),
        part("sphinx", "Sphinx", "BSD-2-Clause", "the site's search and its basic style"),
        part("pygments", "Pygments", "BSD-2-Clause", "colours of the site's listings"),
        part("snowballstemmer", "Snowball", "BSD-3-Clause", "the site's search: English word stems"))


def by_name(folder: Path) -> dict[str, Distribution]:
    """The distributions that are installed in a folder, by their names."""
    return {found.metadata["Name"].lower().replace("_", "-"): found for found in distributions(path=[str(folder)])}


def licence_file(of: Distribution) -> str:
    """The text of a distribution's licence, from the file among its metadata."""
    for path in of.files or ():
        if ".dist-info/" in str(path) and path.name.upper().startswith(("LICEN", "COPYING")):
            return str(path.read_text())
    raise SystemExit(f"laconic: {of.metadata['Name']}: has no file of its licence")


def furo_text(furo: Distribution, site_python: Path) -> str:
    """Furo's licence, and the notice of the script in it."""
    notice = (site_python / "furo/theme/furo/static/scripts/furo.js.LICENSE.txt").read_text(encoding="utf-8")
    return f"{licence_file(furo)}\n\n{notice}\n{NORMALIZE}\n"
