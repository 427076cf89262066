"""The release that is checked: LACONIC_DIST, else dist of the project."""

from __future__ import annotations

import os
import re
import subprocess
import time
from pathlib import Path

import pytest

from laconic_build.c.facts import ROOT, facts

DIST = Path(os.environ.get("LACONIC_DIST", ROOT / "dist"))
VERSION = facts().version
EXAMPLE = re.compile(r"```c\n(.*?)```\n\n```text\n(.*?)```", re.DOTALL)
PRINTED = EXAMPLE.findall((ROOT / "README.md").read_text(encoding="utf-8"))[0][1]

if not (DIST / "SHA256SUMS").exists():
    pytest.skip(f"{DIST}: no release; cmake --workflow --preset release makes it", allow_module_level=True)


def run(folder: Path, *command: str, path: str = "/usr/bin:/bin") -> str:
    """What a command prints that has nothing but these programs; tells how long it took."""
    began = time.perf_counter()
    done = subprocess.run(command, cwd=folder, text=True, check=False, capture_output=True,
                          env={"PATH": path, "HOME": str(folder)})
    print(f"{time.perf_counter() - began:6.2f} s  {' '.join(command)[:90]}")
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
