"""Recorded runs of real robots: not part of the project; they lie beside it, or where RECORDED_DATA says."""

import os
from pathlib import Path

from laconic.base.paths import SOURCE_DIR


def recorded(name: str) -> Path:
    """The folder of one set of runs, which may not be there."""
    return Path(os.environ.get("RECORDED_DATA", SOURCE_DIR.parent / "shared")) / name
