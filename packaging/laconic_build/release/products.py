"""What a release gives out: each file's name, what it is for, where it comes from, and what is inside of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from laconic_build.c.embedded import TOOLS
from laconic_build.c.facts import Facts
from laconic_build.release import archives, readmes
from laconic_build.release.tree import Tree
from laconic_build.wheel.contents import FMUS, PLATFORMS
from laconic_fmu.licences import COMPILER_TEXTS

IN_EVERY_FMU = ("fmi-headers", *COMPILER_TEXTS)
FOR_DEVELOPERS = ("bench", "cdef.h", "cortex_m", "tests")  # of core_c, what a user's build does not take
NODE_FMU = "LaconicNode"


@dataclass(frozen=True)
class Product:
    """One file of the release."""

    name: str
    text: str  # what it is for, as it stands in the release's README
    kind: str  # its MIME type
    content: Callable[[], bytes]
    holds: tuple[str, ...] = ()  # keys of parts.py
    is_wheel: bool = False


def products(tree: Tree, facts: Facts, build: Path) -> list[Product]:
    """All of them, in the order in which the README lists them."""
    return [*of_python(facts, build), *of_c(tree, facts, build), *of_embedded(facts, build),
            *of_web(tree, facts, build), *of_fmi(build), source(tree, facts)]


def of_python(facts: Facts, build: Path) -> list[Product]:
    """A wheel for each platform."""
    made = []
    for platform in PLATFORMS.values():
        name = f"laconic-{facts.version}-py3-none-{platform.tag}.whl"
        made.append(Product(name, f"Python and the command `laconic` on {platform.name}: `pip install` this file",
                            "application/zip", (build / "dist" / name).read_bytes,
                            ("fmi-headers", "cantools", *COMPILER_TEXTS), is_wheel=True))
    return made


def of_c(tree: Tree, facts: Facts, build: Path) -> list[Product]:
    """The core as two files, and as sources with CMake."""
    two, core = f"laconic-amalgamation-{facts.version}", f"laconic-core-{facts.version}"

    def two_files() -> bytes:
        files = {f"laconic/{name}": file for name, file in archives.read_folder(build / "amalgamation").items()}
        return archives.zip_of(archives.under(two, files | readmes.of_two_files(tree, facts)), tree.epoch)

    def core_files() -> archives.Files:
        own = {name.removeprefix("core_c/"): file for name, file in tree.read("core_c/").items()
               if name.split("/")[1] not in FOR_DEVELOPERS}
        return archives.under(core, own | readmes.of_core(tree, facts))

    text = "C with CMake: find_package(laconic) after `cmake --install`, add_subdirectory or FetchContent"
    return [Product(f"{two}.zip", "C without a build system: laconic.h and laconic.c, with an example",
                    "application/zip", two_files),
            Product(f"{core}.tar.gz", text, "application/gzip",
                    lambda: archives.tar_gz_of(core_files(), tree.epoch)),
            Product(f"{core}.zip", f"{text}; the same", "application/zip",
                    lambda: archives.zip_of(core_files(), tree.epoch))]


def of_embedded(facts: Facts, build: Path) -> list[Product]:
    """Packages of embedded tools."""
    names = {tool: each.archive.format(version=facts.version, title=facts.title) for tool, each in TOOLS.items()}
    return [Product(name, f"C on a microcontroller: package for {tool}", "application/zip",
                    (build / "packages" / "embedded" / name).read_bytes) for tool, name in names.items()]


def of_web(tree: Tree, facts: Facts, build: Path) -> list[Product]:
    """The page, the npm package and the documentation."""
    docs = f"laconic-docs-{facts.version}"

    def site() -> bytes:
        files = {name: file for name, file in archives.read_folder(build / "site" / "html").items()
                 if not name.startswith(".")}  # .buildinfo and the like serve Sphinx alone
        return archives.zip_of(archives.under(docs, files), tree.epoch)

    npm = f"laconic-robots-{facts.version}.tgz"
    return [Product("laconic.html", "to see it at once: open this one file in a browser, no installation, no network",
                    "text/html", (build / "page" / "laconic.html").read_bytes),
            Product(npm, f"JavaScript and TypeScript: `npm install ./{npm}`", "application/gzip",
                    (build / "npm" / npm).read_bytes),
            Product(f"{docs}.zip", "the documentation: unpack, open index.html; its search works from disk",
                    "application/zip", site, ("furo", "sphinx-basic-ng", "sphinx", "pygments", "snowballstemmer"))]


def of_fmi(build: Path) -> list[Product]:
    """The FMUs, each with binaries for every platform."""
    return [Product(name, f"FMI {name[-5]}: an importer's file, for Linux, Windows and macOS, with sources",
                    "application/zip", (build / "fmu" / name).read_bytes,
                    (*IN_EVERY_FMU, *(("cantools",) if name.startswith(NODE_FMU) else ()))) for name in FMUS]


def source(tree: Tree, facts: Facts) -> Product:
    """Everything, as the commit has it; not named as pip names sources, since pip cannot build it."""
    folder = f"laconic-source-{facts.version}"
    return Product(f"{folder}.tar.gz", "the whole project, with its tests: `cmake --workflow --preset demo`",
                   "application/gzip", lambda: archives.tar_gz_of(archives.under(folder, tree.read()), tree.epoch))
