"""The archive: the same bytes from the same parts, on every machine and every day."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path

DATE = (1980, 1, 1, 0, 0, 0)


def token_hash(token: str) -> int:
    """FNV-1a, as in fmu/start_file.c."""
    value = 0xCBF29CE484222325
    for byte in token.encode("utf-8"):
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


PRIVATE_START = 0x8000_0000
"""FMU_PRIVATE_START of fmu/instance.h: from here on references are no variables."""


def start_file(values: Iterable[tuple[int, float]], token: str, scalar: bool,
               private: Iterable[tuple[int, bytes]] = ()) -> bytes:
    """resources/start.bin, as fmu/start_file.c describes it. `private`: 64 bits each for a model's own purpose."""
    rows = [struct.pack("<Qd", reference, value) for reference, value in values]
    rows += [struct.pack("<Q8s", PRIVATE_START + number, bits) for number, bits in private]
    body = b"LACSTART" + struct.pack("<QQQQ", 2, int(scalar), token_hash(token), len(rows)) + b"".join(rows)
    return body + struct.pack("<Q", zlib.crc32(body))


def pack(path: Path, parts: Mapping[str, bytes]) -> None:
    """Writes the FMU: parts by their name in the archive."""
    path.parent.mkdir(parents=True, exist_ok=True)
    whole = io.BytesIO()  # zipfile writes back into the archive's head, which a device or a pipe does not allow
    with zipfile.ZipFile(whole, "w") as archive:
        for name in sorted(parts):
            info = zipfile.ZipInfo(name, DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3
            executable = name.startswith("binaries/")
            info.external_attr = (0o100755 if executable else 0o100644) << 16
            archive.writestr(info, parts[name], compresslevel=9)
    path.write_bytes(whole.getvalue())
