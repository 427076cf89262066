"""The page: its HTML with style, scenes, core and script put in."""

from __future__ import annotations

import base64
import gzip
import json
import re
from pathlib import Path

from laconic_build.page.bundle import bundle, read, without_types
from laconic_build.page.scenes import scenes_in

MOST_BYTES = 445_000  # 400,000 and what slip on hinges costs: 27 kB of compressed core, 36 kB in base64, and its script


class TooLarge(Exception):
    """The page is larger than it promises to be."""


def binding_names(binding: Path) -> dict[str, Path]:
    """The names by which the page imports the npm package's modules."""
    inner = ("hinges", "hinge_inputs", "hinge_tables", "module", "scene")
    return {"laconic": binding / "index.js"} | {f"laconic/{name}": binding / f"{name}.js" for name in inner}


def module_text(path: Path) -> str:
    """A module as the page has it: without types, the core of a smaller size, which module.js understands."""
    text = read(path)
    if not path.name.endswith("wasm.js"):
        return without_types(text)
    return re.sub(r'"([A-Za-z0-9+/=]+)"', lambda found: f'"{packed(base64.b64decode(found[1]))}"', text)


def packed(content: bytes) -> str:
    """What gzip makes of it, in base64."""
    return base64.b64encode(gzip.compress(content, mtime=0)).decode("ascii")


def make_page(sources: Path, binding: Path, scenes: Path, native_hash: Path, out: Path) -> None:
    """Writes the one file."""
    facts = {"nativeHash": " ".join(native_hash.read_text().split()), "scenes": scenes_in(scenes)}
    marks = {
        "/* STYLE */": (sources / "style.css").read_text(encoding="utf-8"),
        "/* FACTS */": packed(json.dumps(facts, separators=(",", ":"), ensure_ascii=False).encode("utf-8")),
        "/* SCRIPT */": bundle(sources / "app/main.js", binding_names(binding), module_text),
    }
    text = (sources / "index.html").read_text(encoding="utf-8")
    for mark, put_in in marks.items():
        before, after = text.split(mark)
        text = before + put_in + after
    made = text.encode("utf-8")
    if len(made) > MOST_BYTES:
        raise TooLarge(f"{out.name} has {len(made)} bytes, {MOST_BYTES} at most")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_bytes(made)
