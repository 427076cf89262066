"""Our ES modules as one script: in the order in which they import each other, without imports and exports.

All of them then share one scope, so no two modules may have a name in common at their top level; the bundler checks.
"""

from __future__ import annotations

import re
from pathlib import Path

IMPORT = re.compile(r'^import \{[^}]*\} from "(?P<target>[^"]+)";\n', re.MULTILINE)
EXPORT_LIST = re.compile(r"^export \{[^}]*\};\n", re.MULTILINE)
EXPORT = re.compile(r"^export (?=async |function |class |const |let )", re.MULTILINE)
TOP_LEVEL = re.compile(r"^(?:export )?(?:async )?(?:function\*?|class|const|let) (?:(\w+)|\{([^}]*)\}|\[([^\]]*)\])",
                       re.MULTILINE)


class BadBundle(Exception):
    """What the modules have that the bundler cannot take; one line."""


def bundle(entry: Path, aliases: dict[str, Path]) -> str:
    """The script of `entry` and all that it imports; a name of `aliases` stands for a file elsewhere."""
    ordered: list[Path] = []
    visit(entry.resolve(), aliases, ordered, ())
    owner: dict[str, Path] = {}
    parts = []
    for path in ordered:
        text = path.read_text(encoding="utf-8")
        for name in top_level_names(text):
            if name in owner:
                raise BadBundle(f"{path.name}: {name} is a name of {owner[name].name}, too; rename one of them")
            owner[name] = path
        parts.append(stripped(text, path))
    return "\n".join(parts)


def visit(path: Path, aliases: dict[str, Path], ordered: list[Path], above: tuple[Path, ...]) -> None:
    """Appends what a module imports, then the module."""
    if path in ordered:
        return
    if path in above:
        raise BadBundle(f"{path.name}: imports itself by way of {above[-1].name}")
    for found in IMPORT.finditer(path.read_text(encoding="utf-8")):
        target = found["target"]
        visit(aliases.get(target, path.parent / target).resolve(), aliases, ordered, (*above, path))
    ordered.append(path)


def top_level_names(text: str) -> list[str]:
    """What a module declares at its top level."""
    found = []
    for name, *destructured in TOP_LEVEL.findall(text):
        listed = [each.split(":")[-1].split("=")[0].strip() for part in destructured for each in part.split(",")]
        found += [name] if name else [each for each in listed if each]
    return found


def stripped(text: str, path: Path) -> str:
    """A module without imports and exports."""
    text = EXPORT.sub("", EXPORT_LIST.sub("", IMPORT.sub("", text)))
    if left := re.search(r"^(?:import|export)\b.*", text, re.MULTILINE):
        raise BadBundle(f"{path.name}: {left[0]!r} is no import or export that the bundler knows")
    if "</script" in text:
        raise BadBundle(f"{path.name}: holds the end of a script element")
    return text
