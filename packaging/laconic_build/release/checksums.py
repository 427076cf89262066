"""SHA256SUMS: the checksum of every other file of a folder, as `sha256sum -c` reads them."""

from __future__ import annotations

import hashlib
from pathlib import Path

NAME = "SHA256SUMS"


def sums_of(folder: Path) -> dict[str, str]:
    """Checksums by the files' paths in the folder, sorted."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != NAME)
    return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def write(folder: Path) -> None:
    """Writes the folder's SHA256SUMS."""
    lines = [f"{digest}  {name}\n" for name, digest in sums_of(folder).items()]
    (folder / NAME).write_text("".join(lines), encoding="utf-8")


def stated(folder: Path) -> dict[str, str]:
    """What the folder's SHA256SUMS states; nothing where there is none."""
    path = folder / NAME
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return {name: digest for digest, _, name in (line.partition("  ") for line in lines)}


def wrong_files(folder: Path) -> list[str]:
    """Files that differ from what SHA256SUMS states of them, are missing, or are not named there."""
    told, found = stated(folder), sums_of(folder)
    return sorted(name for name in told.keys() | found.keys() if told.get(name) != found.get(name))
