"""The pages of the site: those of docs/ as they are, the README as the first one, and the generated references."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from laconic_build.site.references import c_page, command_page, fmi_page, python_page
from laconic_build.site.scene_reference import scene_page

PICTURES = (".png", ".svg", ".gif")
MADE_LATER = re.compile(r"^\.|^__pycache__$|\.egg-info$|^(build|dist)\b")  # what a folder's list leaves out
LINK = re.compile(r"(!?\[[^\]]*\]\()([^)#\s]+)(#[^)\s]*)?(\))")
GROUPS = {  # the parts of the manual, in the order in which a reader needs them
    "Start": ("tutorial", "how-to"),
    "Guides": ("scenes", "articulated", "import", "sensors", "fmu-importers", "fmu", "rig",
               "rig-ports", "play", "play-drives", "ros2", "frc", "logs", "bags",
               "control", "c", "python", "sweep", "batch", "page"),
    "Reference": ("reference-commands", "reference-scene", "signals", "reference-c", "reference-python",
                  "reference-fmi", "wire", "glossary"),
    "Theory": ("paper", "integrators", "friction", "accuracy"),
    "How far it is checked": ("assurance", "performance"),
    "For developers": ("architecture", "changelog"),
}


def stage(source: Path, pages: Path) -> None:
    """Writes all pages and what they show; a link out of the pages goes to a copy in files/."""
    pages.mkdir(parents=True)
    texts = {path.stem: path.read_text(encoding="utf-8") for path in sorted((source / "docs").glob("*.md"))}
    texts |= {"reference-c": c_page(source), "reference-python": python_page(), "reference-commands": command_page(),
              "reference-scene": scene_page(source), "reference-fmi": fmi_page(source),
              "changelog": (source / "CHANGELOG.md").read_text(encoding="utf-8")}
    for folder in (source / "docs").iterdir():
        if folder.is_dir():
            shutil.copytree(folder, pages / folder.name)
    for picture in (source / "docs").iterdir():
        if picture.suffix in PICTURES:
            shutil.copy(picture, pages)
    for name, text in texts.items():
        home = source if name == "changelog" else source / "docs"
        (pages / f"{name}.md").write_text(_with_links(text, home, source, pages), encoding="utf-8")
    (pages / "index.md").write_text(_index(source, pages, texts), encoding="utf-8")


def _index(source: Path, pages: Path, texts: dict[str, str]) -> str:
    """The README, and behind it the tables of contents."""
    readme = _with_links((source / "README.md").read_text(encoding="utf-8"), source, source, pages)
    listed = {name for names in GROUPS.values() for name in names}
    groups = {**GROUPS, "More": tuple(sorted(set(texts) - listed))}
    trees = []
    for title, names in groups.items():
        there = "\n".join(name for name in names if name in texts)
        trees.append(f":::{{toctree}}\n:hidden:\n:caption: {title}\n\n{there}\n:::\n" if there else "")
    return readme + "\n" + "\n".join(trees)


def _with_links(text: str, home: Path, source: Path, pages: Path) -> str:
    """Links as the site has them."""
    def moved(found: re.Match[str]) -> str:
        start, target, anchor, end = found[1], found[2], found[3] or "", found[4]
        if "://" in target or target.startswith("mailto:"):
            return found[0]
        return start + _target((home / target).resolve(), source.resolve(), pages) + anchor + end

    return LINK.sub(moved, text)


def _target(path: Path, source: Path, pages: Path) -> str:
    docs = source / "docs"
    if path == source / "README.md":
        return "index.md"
    if path.name in ("CHANGELOG.md",):
        return "changelog.md"
    if docs in path.parents:
        return str(path.relative_to(docs))
    name = path.relative_to(source)
    if path.is_file():
        copy = pages / "files" / (str(name) + (".txt" if path.suffix == ".md" else ""))
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, copy)
        return str(copy.relative_to(pages))
    listing = pages / "files" / f"{'-'.join(name.parts)}.txt"
    listing.parent.mkdir(parents=True, exist_ok=True)
    names = sorted(str(each.relative_to(source)) for each in path.iterdir() if not MADE_LATER.search(each.name))
    listing.write_text("\n".join(names) + "\n", encoding="utf-8")
    return str(listing.relative_to(pages))
