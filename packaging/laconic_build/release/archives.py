"""Archives that depend on their files alone: sorted, one date, no owner, permissions by kind.

SHA256SUMS: the checksum of every other file of a folder, as `sha256sum -c` reads them.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import tarfile
import time
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class File:
    """What an archive holds under a name."""

    data: bytes
    is_program: bool = False

    @property
    def mode(self) -> int:
        """Its permissions."""
        return 0o755 if self.is_program else 0o644


Files = Mapping[str, File]


def under(folder: str, files: Files) -> dict[str, File]:
    """The same files in a folder, so that unpacking makes one thing."""
    return {f"{folder}/{name}": file for name, file in files.items()}


def read_folder(folder: Path) -> dict[str, File]:
    """All files of a folder, by their paths in it."""
    return {path.relative_to(folder).as_posix(): File(path.read_bytes())
            for path in folder.rglob("*") if path.is_file()}


def zip_of(files: Files, epoch: int) -> bytes:
    """A zip archive; its dates are the epoch's in UTC, to two seconds, as the format has them."""
    date = time.gmtime(epoch)[:6]
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as made:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, date)
            entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, 3
            entry.external_attr = (0o100000 | files[name].mode) << 16
            made.writestr(entry, files[name].data, compresslevel=9)
    return buffer.getvalue()


def tar_gz_of(files: Files, epoch: int) -> bytes:
    """A tar archive, compressed."""
    tape = io.BytesIO()
    with tarfile.open(fileobj=tape, mode="w", format=tarfile.USTAR_FORMAT) as made:
        for name in sorted(files):
            entry = tarfile.TarInfo(name)
            entry.size, entry.mtime, entry.mode = len(files[name].data), epoch, files[name].mode
            made.addfile(entry, io.BytesIO(files[name].data))
    return gzip.compress(tape.getvalue(), compresslevel=9, mtime=0)


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
