"""What every package states of the project, each fact from the one place where it stands."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CORE = ROOT / "core_c"


@dataclass(frozen=True)
class Facts:
    """Of packaging/facts.json, but version (laconic.h), licence and copyright (LICENSE)."""

    version: str
    licence: str  # the whole text
    copyright: str  # its line in the licence
    licence_id: str  # as SPDX names it
    title: str
    sentence: str
    paragraph: str
    author: str
    contact: str
    homepage: str
    keywords: tuple[str, ...]


def facts() -> Facts:
    told = json.loads((ROOT / "packaging" / "facts.json").read_text(encoding="utf-8"))
    licence = (ROOT / "LICENSE").read_text(encoding="utf-8")
    return Facts(**{**told, "keywords": tuple(told["keywords"])}, version=version(), licence=licence,
                 copyright=one(r"^(Copyright .*)$", licence), licence_id=one(r"^(\w+) License$", licence))


def placeholders(of: Facts) -> list[str]:
    """Names of the facts that stand for ones which do not exist yet: their addresses end with .example."""
    return [name for name, value in asdict(of).items() if isinstance(value, str) and re.search(r"[@/.]example$", value)]


def version() -> str:
    header = (CORE / "include" / "laconic" / "laconic.h").read_text(encoding="utf-8")
    return one(r'^#define LACONIC_VERSION "([^"]+)"$', header)


def one(pattern: str, text: str) -> str:
    found = re.findall(pattern, text, re.MULTILINE)
    if len(found) != 1:
        raise ValueError(f"{pattern} occurs {len(found)} times, not once")
    return str(found[0])
