"""What an earlier analysis left in the folder of this one: pictures that would stand beside a page they are not of."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path


def pictures_of_older_page(folder: Path, drawn: Sequence[Path]) -> list[Path]:
    """Pictures in the folder that the report.json there lists and this run has not drawn.

    A file is the tool's own only when it has one of its pictures' names and that page lists it; all else
    in the folder is the user's.
    """
    from laconic.tools.analyse.pictures import PICTURES

    try:
        listed = json.loads((folder / "report.json").read_text(encoding="utf-8"))["pictures"]
        written = {Path(name).name for name in listed}
    except (OSError, ValueError, KeyError, TypeError):
        return []
    ours = written & {f"{name}.png" for name in PICTURES} - {path.name for path in drawn}
    return sorted(path for path in (folder / name for name in ours) if path.is_file())
