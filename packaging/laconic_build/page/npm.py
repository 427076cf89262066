"""The npm package: our modules, the WebAssembly module as text, and an archive as `npm pack` lays it out."""

from __future__ import annotations

import base64
import gzip
import io
import json
import re
import shutil
import tarfile
from pathlib import Path
from typing import Any

from laconic.scene.methods import METHODS

NPM_TIME = 499162500  # 1985-10-26, which npm, too, gives every file, so that archives do not differ by their times


def make_package(sources: Path, wasm: Path, version: str, out: Path, archive: Path) -> None:
    """Fills the folder `out` and packs it."""
    shutil.rmtree(out, ignore_errors=True)
    (out / "src").mkdir(parents=True)
    for path in sorted((sources / "src").iterdir()):
        shutil.copyfile(path, out / "src" / path.name)
    types = out / "src/index.d.ts"
    types.write_text(with_names(types.read_text(encoding="utf-8")), encoding="utf-8")
    text = base64.b64encode(wasm.read_bytes()).decode("ascii")
    module = f'// The core, compiled to WebAssembly, as base64.\nexport const wasm =\n  "{text}";\n'
    (out / "src/wasm.js").write_text(module, encoding="ascii")
    (out / "package.json").write_text(json.dumps(manifest_of(sources, version), indent=2) + "\n", encoding="utf-8")
    shutil.copyfile(sources / "README.md", out / "README.md")
    shutil.copyfile(sources.parents[1] / "LICENSE", out / "LICENSE")
    archive.write_bytes(packed(out))


def with_names(types: str) -> str:
    """The types, which take no method but the core's."""
    names = " | ".join(f'"{name}"' for name in METHODS)
    text, count = re.subn(r"(export type MethodName = )string;", rf"\1{names};", types)
    if count != 1:
        raise ValueError(f"index.d.ts: `export type MethodName = string;` occurs {count} times, not once")
    return text


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
