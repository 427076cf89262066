"""The page: its HTML with style, scenes, core and script put in."""

from __future__ import annotations

import json
from pathlib import Path

from laconic_build.page.bundle import bundle
from laconic_build.page.scenes import scenes_in

MOST_BYTES = 400_000


class TooLarge(Exception):
    """The page is larger than it promises to be."""


def make_page(sources: Path, binding: Path, scenes: Path, native_hash: Path, out: Path) -> None:
    """Writes the one file."""
    facts = {"nativeHash": " ".join(native_hash.read_text().split()), "scenes": scenes_in(scenes)}
    marks = {
        "/* STYLE */": (sources / "style.css").read_text(encoding="utf-8"),
        "/* FACTS */": json.dumps(facts, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c"),
        "/* SCRIPT */": bundle(sources / "app/main.js", {"laconic": binding / "index.js"}),
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
