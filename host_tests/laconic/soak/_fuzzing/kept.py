"""What is kept of fuzz runs: the last result of each target, the table of docs/assurance.md, and minimal corpora."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from laconic.errors import ResultFails
from laconic.paths import SOURCE_DIR, build_dir, built
from laconic.soak._fuzzing.file_readers import FILE_TARGETS
from laconic.soak._fuzzing.libfuzzer import Found
from laconic.soak._fuzzing.targets import Target, targets_by_name

PAGE = SOURCE_DIR / "docs/assurance.md"
BEGIN, END = "<!-- fuzzing, made by laconic soak fuzz --minimise -->\n", "<!-- end of fuzzing -->\n"


def results_path() -> Path:
    """The file of last results."""
    return build_dir() / "fuzz" / "results.json"


def read_results() -> dict[str, Any]:
    """By target; what is not there is empty."""
    path = results_path()
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return found


def keep_result(name: str, found: Found) -> None:
    """Writes down a target's last rate and edges, and all executions of all runs so far."""
    results = read_results()
    before = results.get(name, {}).get("executions in all", 0)
    results[name] = {"executions": found.executions, "processor time, s": round(found.cpu_s, 1),
                     "executions/s": round(found.rate_per_s), "edges": found.edges, "found": found.crash,
                     "executions in all": before + found.executions}
    results_path().write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")


def minimised(names: Sequence[str]) -> dict[str, str]:
    """Replaces each kept corpus of the sources by the fewest inputs of it and of what was found that reach the same,
    and makes the page's table of the last results."""
    known = targets_by_name()
    told = {f"{name}, kept inputs": minimise(known[name]) for name in names if name in known}
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    PAGE.write_text(before + BEGIN + table(known, read_results()) + END + rest.split(END)[1], encoding="utf-8")
    return told


def minimise(target: Target) -> str:
    """By libFuzzer's merge, in which an input counts that reaches an edge none before it reached, smallest first."""
    fresh = build_dir() / "fuzz" / target.name
    before = len(list(target.corpus.iterdir()))
    with tempfile.TemporaryDirectory() as folder:
        least = Path(folder, "least")
        least.mkdir()
        command: list[str | Path] = [built(f"fuzz/fuzz_{target.name}"), "-merge=1", "-use_counters=0",
                                     f"-max_len={target.most_bytes}", f"-artifact_prefix={fresh}/", least,
                                     target.corpus, *([fresh] if fresh.is_dir() else [])]
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        inputs = sorted(least.iterdir())
        if done.returncode != 0 or not inputs:
            raise ResultFails(f"{target.name}: its corpus was not merged, and stays: {done.stderr[-300:]!r}")
        shutil.rmtree(target.corpus)
        shutil.copytree(least, target.corpus)
    return f"{before} before, {len(inputs)} now"


def table(known: dict[str, Target], results: dict[str, Any]) -> str:
    """The page's table."""
    head = "| target | executions/s | wanted | executions in all | edges | kept inputs |"
    lines = ["", head, "| --- " * head.count(" | ") + "| --- |"]
    for name, target in known.items():
        of = results.get(name, {})
        lines.append(f"| `{name}` | {of.get('executions/s', 0):,} | {target.wanted_per_s:,} | "
                     f"{of.get('executions in all', 0):,} | {of.get('edges', 0):,} | "
                     f"{len(list(target.corpus.iterdir()))} |")
    for name in FILE_TARGETS:
        of = results.get(name, {})
        lines.append(f"| `{name}` | {of.get('executions/s', 0):,} | – | {of.get('executions in all', 0):,} | "
                     f"{of.get('edges', 0):,} lines | – |")
    return "\n".join(lines) + "\n\n"
