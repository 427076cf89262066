"""Our ES modules as one script: in the order in which they import each other, without imports and exports.

All of them then share one scope, so no two modules may have a name in common at their top level; the bundler checks.
A module that is imported under another name, `import { load as loadHinges }`, gets a scope of its own.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

IMPORT = re.compile(r'^import \{(?P<names>[^}]*)\} from "(?P<target>[^"]+)";\n', re.MULTILINE)
RENAMED = re.compile(r"(\w+) as (\w+)")
COMMENT = r"/\*\*(?:(?!\*/)[\s\S])*?\*/"
DOCUMENTED = re.compile(rf"^[ \t]*{COMMENT}\n|{COMMENT} ?", re.MULTILINE)
EXPORT_LIST = re.compile(r"^export \{[^}]*\};\n", re.MULTILINE)
EXPORT = re.compile(r"^export (?=async |function |class |const |let )", re.MULTILINE)
TOP_LEVEL = re.compile(r"^(?:export )?(?:async )?(?:function\*?|class|const|let) (?:(\w+)|\{([^}]*)\}|\[([^\]]*)\])",
                       re.MULTILINE)


class BadBundle(Exception):
    """What the modules have that the bundler cannot take; one line."""


def read(path: Path) -> str:
    """A module as it is."""
    return path.read_text(encoding="utf-8")


def bundle(entry: Path, aliases: dict[str, Path], text_of: Callable[[Path], str] = read) -> str:
    """The script of `entry` and all that it imports; a name of `aliases` stands for a file elsewhere."""
    ordered: list[Path] = []
    renamed: dict[Path, dict[str, str]] = {}
    visit(entry.resolve(), aliases, ordered, renamed, ())
    owner: dict[str, Path] = {}
    parts = []
    for path in ordered:
        text, others = text_of(path), renamed[path]
        for name in others.values() if others else top_level_names(text):
            if name in owner:
                raise BadBundle(f"{path.name}: {name} is a name of {owner[name].name}, too; rename one of them")
            owner[name] = path
        parts.append(in_own_scope(stripped(text, path), others) if others else stripped(text, path))
    return "\n".join(parts)


def visit(path: Path, aliases: dict[str, Path], ordered: list[Path], renamed: dict[Path, dict[str, str]],
          above: tuple[Path, ...]) -> None:
    """Appends what a module imports, then the module; notes the other names by which one is imported."""
    renamed.setdefault(path, {})
    if path in ordered:
        return
    if path in above:
        raise BadBundle(f"{path.name}: imports itself by way of {above[-1].name}")
    for found in IMPORT.finditer(read(path)):
        target = aliases.get(found["target"], path.parent / found["target"]).resolve()
        names, others = found["names"].split(","), dict(RENAMED.findall(found["names"]))
        if others and len(others) < len([name for name in names if name.strip()]):
            raise BadBundle(f"{path.name}: imports {target.name} by its own and by other names; use one kind")
        if target in renamed and renamed[target] != others:
            raise BadBundle(f"{path.name}: imports {target.name} by other names than another module; use the same")
        visit(target, aliases, ordered, renamed, (*above, path))
        renamed[target] = others
    ordered.append(path)


def in_own_scope(text: str, others: dict[str, str]) -> str:
    """A module whose names no other one sees but by the other names."""
    outside = ", ".join(f"{name}: {other}" for name, other in others.items())
    return f"const {{ {outside} }} = (() => {{\n{text}return {{ {', '.join(others)} }};\n}})();\n"


def without_types(text: str) -> str:
    """A module without its comments of types and functions, which mean nothing to a browser."""
    return DOCUMENTED.sub("", text)


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
