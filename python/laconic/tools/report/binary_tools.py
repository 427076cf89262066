"""Compilers and binary tools, called: what they print, or an error with their message."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

from laconic.errors import ResultFails


def run_tool(command: Sequence[str], where: Path | None = None) -> str:
    """A compiler or binary tool; its messages when it fails."""
    done = subprocess.run(command, capture_output=True, text=True, cwd=where, check=False)
    if done.returncode != 0:
        first = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr[-300:])
        raise ResultFails(f"{command[0]} failed: {first}")
    return done.stdout
