"""The packages of embedded tools: the files of the amalgamation, and what each tool wants beside them, from templates.

A tool's template, such as zephyr.txt, has its files one after the other, each below a line `==== its path`. There
`@name@` stands for a fact (facts.py), `@robot@` and `@main@` for what all examples share (robot.c.in, main.c.in).
"""

from __future__ import annotations

import io
import json
import re
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from xml.sax.saxutils import escape

from laconic_build.c.amalgamation import amalgamation
from laconic_build.c.facts import ROOT, Facts, one, placeholders

TEMPLATES = Path(__file__).resolve().parents[2] / "c" / "templates"


@dataclass(frozen=True)
class Tool:
    """Where a package has its headers, the folder around its files (of which tools make its name), its archive."""

    headers: str
    folder: str
    archive: str


TOOLS = {
    "arduino": Tool("src", "Laconic", "Laconic-{version}-arduino.zip"),
    "platformio": Tool("include", "Laconic", "Laconic-{version}-platformio.zip"),
    "esp-idf": Tool("include", "laconic", "laconic-{version}-esp-idf.zip"),
    "zephyr": Tool("include", "laconic", "laconic-{version}-zephyr.zip"),
    "cmsis-pack": Tool("include", "", "{title}.{title}.{version}.pack"),
}
BY_ITS_FOLDER = '''\
/* The same header as <laconic/{name}>, the path that the project's pages include it by. */
#include "../{name}"
'''
OLDEST = (1980, 1, 1, 0, 0, 0)  # that an archive can name: the same files are the same bytes


def packages(facts: Facts) -> dict[str, dict[str, str]]:
    """The files of each tool's package, by their paths."""
    pair, values = amalgamation(facts), values_of(facts)
    return {tool: package(tool, pair, values, facts) for tool in TOOLS}


def package(tool: str, pair: Mapping[str, str], values: Mapping[str, str], facts: Facts) -> dict[str, str]:
    headers = TOOLS[tool].headers
    files = {f"{headers if name.endswith('.h') else 'src'}/{name}": text for name, text in pair.items()}
    files |= {f"{headers}/laconic/{name}": BY_ITS_FOLDER.format(name=name) for name in pair if name.endswith(".h")}
    files |= {"LICENSE": facts.licence, "README.md": filled((TEMPLATES / "README.md").read_text("utf-8"), values)}
    files |= {path: filled(text, values) for path, text in template_of(tool).items()}
    return dict(sorted(files.items()))


def template_of(tool: str) -> dict[str, str]:
    """The files of a tool's template, by their paths in its package."""
    _, *parts = re.split(r"^==== (.+)\n", (TEMPLATES / f"{tool}.txt").read_text("utf-8"), flags=re.MULTILINE)
    return dict(zip(parts[::2], parts[1::2], strict=True))


def values_of(facts: Facts) -> dict[str, str]:
    """What may stand between @ and @ in a template."""
    texts = {name: value for name, value in asdict(facts).items() if isinstance(value, str)}
    return texts | addresses(facts) | {
        "keywords_json": json.dumps(facts.keywords),
        "keyword_elements": "".join(f"    <keyword>{escape(word)}</keyword>\n" for word in facts.keywords),
        "release": escape(first_change()),
        "robot": (TEMPLATES / "robot.c.in").read_text(encoding="utf-8"),
        "main": (TEMPLATES / "main.c.in").read_text(encoding="utf-8"),
    }


def addresses(facts: Facts) -> dict[str, str]:
    """Lines with the project's page and contact, empty while these are placeholders: nobody is sent where nothing is.
    Arduino and CMSIS-Pack demand an address of the page, and get it as it is."""
    missing = placeholders(facts)
    has_page, has_contact = "homepage" not in missing, "contact" not in missing
    return {
        "maintainer": f"{facts.author} <{facts.contact}>" if has_contact else facts.author,
        "email_entry": f', "email": "{facts.contact}"' if has_contact else "",
        "contact_element": f"  <supportContact>{escape(facts.contact)}</supportContact>\n" if has_contact else "",
        "homepage_entry": f'  "homepage": "{facts.homepage}",\n' if has_page else "",
        "homepage_line": f'url: "{facts.homepage}"\n' if has_page else "",
    }


def first_change() -> str:
    """What the changelog says first of its newest version."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    return one(r"\A# Changelog\n\n## .*\n\n(.*)$", text)


def filled(text: str, values: Mapping[str, str]) -> str:
    """A template's text with the facts in it."""
    return re.sub(r"@(\w+)@", lambda found: values[found[1]], text)


def archive(tool: str, files: Mapping[str, str], facts: Facts) -> tuple[str, bytes]:
    """The name of a package's archive and its bytes, which depend on nothing but the files."""
    name = TOOLS[tool].archive.format(version=facts.version, title=facts.title)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as made:
        for path, text in files.items():
            entry = zipfile.ZipInfo((PurePosixPath(TOOLS[tool].folder) / path).as_posix(), OLDEST)
            entry.compress_type, entry.external_attr, entry.create_system = zipfile.ZIP_DEFLATED, 0o100644 << 16, 3
            made.writestr(entry, text.encode("utf-8"))
    return name, buffer.getvalue()
