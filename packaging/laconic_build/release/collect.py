"""From a build tree to the release's folder, by way of a folder beside it: the release is there whole or not at all."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from laconic_build.c.facts import Facts
from laconic_build.release import archives, bill, readmes
from laconic_build.release.parts import Part, Places, by_name, parts
from laconic_build.release.products import Product, products
from laconic_build.release.tree import NoRelease, Tree

PACKERS = ("setuptools", "cantools")  # of the build's environment


@dataclass(frozen=True)
class Made:
    """What stands in the folder now."""

    folder: Path
    count: int
    size: int  # bytes
    commit: str
    changed: tuple[str, ...]


def collect(tree: Tree, facts: Facts, build: Path, dist: Path, places: Places, compilers: Mapping[str, str]) -> Made:
    """Writes the release; NoRelease, and nothing changed, where the folder holds what no release put there."""
    foreign(dist)
    stage = build / "release"
    shutil.rmtree(stage, ignore_errors=True)
    stage.mkdir(parents=True)
    wanted, known = products(tree, facts, build), parts(places)
    write_products(wanted, stage)
    write_licences(wanted, known, facts, stage)
    rows = [*((product.name, product.text) for product in wanted), *of_the_folder(facts)]
    (stage / "README.md").write_text(readmes.of_release(facts, rows), encoding="utf-8")
    write_bill(tree, facts, wanted, known, {**tools(places), **compilers}, stage)
    archives.write(stage)
    shutil.rmtree(dist, ignore_errors=True)
    dist.parent.mkdir(parents=True, exist_ok=True)
    shutil.move(stage, dist)
    files = [path for path in dist.rglob("*") if path.is_file()]
    return Made(dist, len(files), sum(path.stat().st_size for path in files), tree.commit, tree.changed)


def foreign(dist: Path) -> None:
    """NoRelease for a folder with files that its own SHA256SUMS does not name: they would be lost."""
    if dist.exists() and (lost := sorted(archives.sums_of(dist).keys() - archives.stated(dist).keys())):
        raise NoRelease(f"{dist}: holds {lost[0]}, which is of no release; move it away, or name another folder in "
                        "LACONIC_DIST")


def write_products(wanted: list[Product], stage: Path) -> None:
    """Writes all files and prints their sizes; NoRelease names every one that was not built."""
    lacking: dict[str, str] = {}
    for product in wanted:
        try:
            data = product.content()
        except FileNotFoundError as why:
            lacking[product.name] = str(why.filename)
            continue
        (stage / product.name).write_bytes(data)
        print(f"{len(data) / 1e3:9.1f} kB  {product.name}", flush=True)
    if lacking:
        each = ", ".join(f"{name}: {path}" for name, path in lacking.items())
        raise NoRelease(f"{each} {'was' if len(lacking) == 1 else 'were'} not built; build the target laconic_release")


def write_licences(wanted: list[Product], known: Mapping[str, Part], facts: Facts, stage: Path) -> None:
    """Our licence, and those of the parts that are inside of any product."""
    folder = stage / "licences"
    folder.mkdir()
    (folder / "laconic.txt").write_text(facts.licence, encoding="utf-8")
    for key in sorted({key for product in wanted for key in product.holds}):
        (folder / f"{key}.txt").write_text(known[key].text(), encoding="utf-8")


def of_the_folder(facts: Facts) -> list[tuple[str, str]]:
    """What the folder tells of itself."""
    return [("licences", "the licence of Laconic, and of each part in these files that others wrote"),
            (bill_name(facts), "bill of materials (CycloneDX): which part is in which file, with checksums"),
            (archives.NAME, "`sha256sum -c SHA256SUMS` checks all files")]


def bill_name(facts: Facts) -> str:
    """The file of the bill of materials."""
    return f"laconic-{facts.version}.cdx.json"


def write_bill(tree: Tree, facts: Facts, wanted: list[Product], known: Mapping[str, Part], tools: Mapping[str, str],
               stage: Path) -> None:
    """The bill of all that the folder holds up to now, checked by the schema."""
    wheel = next(product.name for product in wanted if product.is_wheel)
    with zipfile.ZipFile(stage / wheel) as opened:
        (metadata,) = (name for name in opened.namelist() if name.endswith(".dist-info/METADATA"))
        needed = bill.needed_by(opened.read(metadata).decode("utf-8").splitlines())
    made = bill.bill_of(tree, facts, wanted, archives.sums_of(stage), known, needed, tools)
    text = bill.written(made)
    if faults := bill.faults_of(text) or ", ".join(bill.unnamed(made, stage)):
        raise NoRelease(f"{bill_name(facts)}: is no valid bill of materials: {faults.splitlines()[0]}")
    (stage / bill_name(facts)).write_text(text, encoding="utf-8")


def tools(places: Places) -> dict[str, str]:
    """What compiled and packed, with versions."""
    made_site = by_name(places.site_python)
    return {**{name: version(name) for name in PACKERS}, "ziglang": by_name(places.zig.parent)["ziglang"].version,
            **{name: made_site[name].version for name in ("sphinx", "myst-parser")}}
