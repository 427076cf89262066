"""The archive: the same bytes from the same parts, on every machine and every day."""

from __future__ import annotations

import struct
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path

FIRST_OF_1980 = 1 << 5 | 1  # the date of every part: years since 1980, month and day
VERSION_NEEDED, UNIX = 20, 3  # of the format, to read it; the system whose modes of files it has


def token_hash(token: str) -> int:
    """FNV-1a, as in fmu/glue/start_file.c."""
    value = 0xCBF29CE484222325
    for byte in token.encode("utf-8"):
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


PRIVATE_START = 0x8000_0000
"""FMU_PRIVATE_START of fmu/glue/instance.h: from here on references are no variables."""


def start_file(values: Iterable[tuple[int, float]], token: str, scalar: bool,
               private: Iterable[tuple[int, bytes]] = ()) -> bytes:
    """resources/start.bin, as fmu/glue/start_file.c describes it. `private`: 64 bits each for a model's own purpose."""
    rows = [struct.pack("<Qd", reference, value) for reference, value in values]
    rows += [struct.pack("<Q8s", PRIVATE_START + number, bits) for number, bits in private]
    body = b"LACSTART" + struct.pack("<QQQQ", 2, int(scalar), token_hash(token), len(rows)) + b"".join(rows)
    return body + struct.pack("<Q", zlib.crc32(body))


@lru_cache(maxsize=512)
def deflated(data: bytes) -> bytes:
    """A part, compressed. The FMUs of many scenes share most parts, which are compressed once."""
    compressor = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    return compressor.compress(data) + compressor.flush()


def pack(path: Path, parts: Mapping[str, bytes]) -> None:
    """Writes the FMU: parts by their name in the archive."""
    path.parent.mkdir(parents=True, exist_ok=True)
    whole, directory = bytearray(), bytearray()
    for name in sorted(parts):
        size, known = len(deflated(parts[name])), name.encode("ascii")
        facts = struct.pack("<5H3L2H", VERSION_NEEDED, 0, zipfile.ZIP_DEFLATED, 0, FIRST_OF_1980,
                            zlib.crc32(parts[name]), size, len(parts[name]), len(known), 0)
        mode = 0o100755 if name.startswith("binaries/") else 0o100644
        directory += b"PK\1\2" + struct.pack("<BB", VERSION_NEEDED, UNIX) + facts
        directory += struct.pack("<3H2L", 0, 0, 0, mode << 16, len(whole)) + known
        whole += b"PK\3\4" + facts + known + deflated(parts[name])
    end = b"PK\5\6" + struct.pack("<4H2LH", 0, 0, len(parts), len(parts), len(directory), len(whole), 0)
    path.write_bytes(whole + directory + end)
