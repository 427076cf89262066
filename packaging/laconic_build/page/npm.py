"""The npm package: our modules, the WebAssembly module as text, and an archive as `npm pack` lays it out."""

from __future__ import annotations

import base64
import gzip
import io
import json
import re
import shutil
import tarfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from laconic.core.articulated import method_names
from laconic.scene.keys import HINGE_KEYS, KEYS, NOT_NEGATIVE, NOT_ZERO, POSITIVE, Key
from laconic.scene.methods import METHODS
from laconic.scene.table import REQUIRED

NPM_TIME = 499162500  # 1985-10-26, which npm, too, gives every file, so that archives do not differ by their times

OF_ROBOTS = ("vehicle", "ground", "initial", "input", "run", "outputs", "sensors")

RULES = {POSITIVE: "POSITIVE", NOT_NEGATIVE: "NOT_NEGATIVE", NOT_ZERO: "NOT_ZERO"}
"""The rules of keys by the names that hinge_tables.js has for them."""


def make_package(sources: Path, wasm: Path, hinged_wasm: Path, version: str, out: Path, archive: Path) -> None:
    """Fills the folder `out` and packs it."""
    shutil.rmtree(out, ignore_errors=True)
    (out / "src").mkdir(parents=True)
    for path in sorted((sources / "src").iterdir()):
        shutil.copyfile(path, out / "src" / path.name)
    for name, methods in (("index", METHODS), ("hinges", method_names())):
        types = out / f"src/{name}.d.ts"
        types.write_text(with_names(types.read_text(encoding="utf-8"), methods, types.name), encoding="utf-8")
    (out / "src/wasm.js").write_text(module_of("The core", wasm), encoding="ascii")
    (out / "src/hinged_wasm.js").write_text(module_of("The core's part for hinges", hinged_wasm), encoding="ascii")
    (out / "src/hinge_keys.js").write_text(keys_of_hinges(), encoding="utf-8")
    (out / "src/tool_tables.js").write_text(tables_of_tools(), encoding="ascii")
    (out / "package.json").write_text(json.dumps(manifest_of(sources, version), indent=2) + "\n", encoding="utf-8")
    shutil.copyfile(sources / "README.md", out / "README.md")
    shutil.copyfile(sources.parents[1] / "LICENSE", out / "LICENSE")
    archive.write_bytes(packed(out))


def module_of(what: str, wasm: Path) -> str:
    text = base64.b64encode(wasm.read_bytes()).decode("ascii")
    return f'// {what}, compiled to WebAssembly, as base64.\nexport const wasm =\n  "{text}";\n'


def with_names(types: str, methods: Sequence[str], file: str) -> str:
    """The types, which take no method but the core's."""
    names = " | ".join(f'"{name}"' for name in methods)
    text, count = re.subn(r"(export type MethodName = )string;", rf"\1{names};", types)
    if count != 1:
        raise ValueError(f"{file}: `export type MethodName = string;` occurs {count} times, not once")
    return text


def keys_of_hinges() -> str:
    """The keys of bodies on hinges, as the command reads them: table → key → what it may be."""
    tables: dict[str, dict[str, Any]] = {}
    for key in HINGE_KEYS:
        table, _, name = key.path.rpartition(".")
        tables.setdefault(table, {})[name] = traits_of(key)
    text = json.dumps(tables, separators=(",", ":")).replace('"},"', '"},\n"')
    return ("// Made of the command's list of keys (python/laconic/scene/keys.py).\n"
            f"/** @type {{Record<string, Record<string, any>>}} */\nexport const HINGE_KEYS = {text};\n")


def tables_of_tools() -> str:
    """The tables of a scene that other tools read: all but those of a robot and its run."""
    tables = dict.fromkeys(path.partition(".")[0].removesuffix("[#]") for path in KEYS if "." in path)
    names = [name for name in tables if name not in OF_ROBOTS]
    return ("// Made of the command's list of keys (python/laconic/scene/keys.py).\n"
            f"export const OF_TOOLS = {json.dumps(names)};\n")


def traits_of(key: Key) -> dict[str, Any]:
    """One key; `default` is absent where it must be given."""
    found: dict[str, Any] = {"kind": key.kind}
    if key.default is not REQUIRED:
        found["default"] = key.default
    if key.choices is not None:
        found["choices"] = list(key.choices)
    if key.rule is not None:
        found["rule"] = RULES[key.rule]
    return found


def manifest_of(sources: Path, version: str) -> dict[str, Any]:
    """package.json, with what packaging/facts.json tells of all packages."""
    own = json.loads((sources / "package.json").read_text(encoding="utf-8"))
    facts = json.loads((sources.parents[1] / "packaging" / "facts.json").read_text(encoding="utf-8"))
    told = {"description": facts["sentence"], "keywords": [*facts["keywords"], "webassembly"],
            "author": facts["author"]}
    if not facts["homepage"].endswith(".example"):  # a placeholder, as laconic_build.c.facts tells
        told["homepage"] = facts["homepage"]
    return {"name": own.pop("name"), "version": version, **told, **own}


def packed(folder: Path) -> bytes:
    """The same bytes for the same files: sorted, with npm's time, owner and mode."""
    tape = io.BytesIO()
    with tarfile.open(fileobj=tape, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for path in sorted(each for each in folder.rglob("*") if each.is_file()):
            entry = tarfile.TarInfo(f"package/{path.relative_to(folder).as_posix()}")
            entry.size, entry.mtime, entry.mode = path.stat().st_size, NPM_TIME, 0o644
            with path.open("rb") as file:
                tar.addfile(entry, file)
    return gzip.compress(tape.getvalue(), mtime=0)
