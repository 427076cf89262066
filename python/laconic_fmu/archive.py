"""The parts of an FMU, and the FMU of a scene, made from that of the build.

The archive: the same bytes from the same parts, on every machine and every day.
"""

from __future__ import annotations

import struct
import xml.etree.ElementTree as ET
import zipfile
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from . import fmi2, fmi3
from .description import Description, identifier_in, parse, start_values, token_in, with_identifier, with_values
from .for_vehicle import for_vehicle, of_step
from .scalars import elements_of, without_enumerations
from .slipping import of_slipping

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


MOST_ROWS = 1000
"""Rows that an importer writes if it uses the default experiment unchanged."""
LEAST_ROWS = 50
"""Fewer show no motion."""

PLATFORMS = {
    "x86_64-linux": ("linux64", "x86_64-linux", ".so"),
    "aarch64-linux": ("aarch64-linux", "aarch64-linux", ".so"),
    "x86_64-windows": ("win64", "x86_64-windows", ".dll"),
    "x86_64-darwin": ("darwin64", "x86_64-darwin", ".dylib"),
    "aarch64-darwin": ("aarch64-darwin", "aarch64-darwin", ".dylib"),
}
"""Folder in FMI 2, folder in FMI 3, ending of the binary."""

COMPILER, OPTIONS = "gcc", "-std=c99 -O2 -ffp-contract=off -fno-tree-slp-vectorize"
"""These options give the same bits as the build's; clang has the same ones."""


def binary_name(version: int, platform: str, identifier: str) -> str:
    """The path of a binary in the archive."""
    folder_2, folder_3, ending = PLATFORMS[platform]
    return f"binaries/{folder_2 if version == 2 else folder_3}/{identifier}{ending}"


def build_description(sources: Sequence[str], identifier: str) -> str:
    """sources/buildDescription.xml of FMI 3."""
    root = ET.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = ET.SubElement(root, "BuildConfiguration", {"modelIdentifier": identifier})
    group = ET.SubElement(configuration, "SourceFileSet", {"language": "C99", "compiler": COMPILER,
                                                            "compilerOptions": OPTIONS})
    for name in sources:
        ET.SubElement(group, "SourceFile", {"name": name})
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def read_parts(path: Path) -> dict[str, bytes]:
    """All parts of an FMU."""
    now = path.stat()
    return dict(_parts_of(path.resolve(), (now.st_mtime_ns, now.st_size, now.st_ino)))


@lru_cache(maxsize=16)
def _parts_of(path: Path, state: tuple[int, int, int]) -> Mapping[str, bytes]:
    """The same. FMUs of many scenes are made from few archives, which are read once."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}


def terminals_of(text: str, description: Description, scalar: bool) -> str:
    """The terminals for a description: array members are named element by element where there are no arrays."""
    if not scalar:
        return text
    root = ET.fromstring(text)
    for terminal in root.iter("Terminal"):
        members = list(terminal)
        for member in members:
            terminal.remove(member)
        for member in members:
            for each in elements_of(description, description.variable(member.get("variableName", ""))):
                suffix = f"[{each.element}]" if each.element else ""
                ET.SubElement(terminal, member.tag, {"variableName": each.name,
                                                     "memberName": member.get("memberName", "") + suffix,
                                                     "variableKind": member.get("variableKind", "")})
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


@dataclass(frozen=True)
class Variant:
    """Which FMU of a scene."""

    version: int
    scalar: bool = False
    """FMI 3 without arrays."""
    enumerations: bool = True
    """False: whole numbers instead, for importers that know no enumerations."""
    sources: bool = True
    derivatives: bool = False
    """Those of the last communication step: of a generic FMU that has them."""
    slipping: bool = False
    """Of a vehicle with hinges on ground with friction."""


@dataclass(frozen=True)
class Content:
    """Name, text and numbers of a scene for its FMU."""

    name: str
    text: str
    values: Mapping[str, Sequence[float]]
    """Start values by the variables' names."""
    duration_s: float
    step_s: float


def output_step(duration_s: float, step_s: float) -> float:
    """The default experiment's step: a number of internal steps that divides that of the run, since with another one an
    importer may pass the stop time.

    At most MOST_ROWS in the run and no fewer than LEAST_ROWS, with a round number of internal steps where there is one.
    A run whose number of steps has no such divisor, a prime say, is shown step by step.
    """
    count = max(1, round(duration_s / step_s))
    round_numbers = [digit * 10**power for power in range(16) for digit in (1, 2, 5)]
    enough = [number for number in round_numbers if count <= MOST_ROWS * number][:3]
    others = [count // rows for rows in range(MOST_ROWS, LEAST_ROWS - 1, -1) if count % rows == 0]
    return step_s * next((number for number in (*enough, *others) if count % number == 0), 1)


def _describe(old: ET.Element, description: Description, variant: Variant) -> str:
    """The description as text; `old`: that of the generic FMU."""
    if variant.version == 3:
        return fmi3.describe_scalar(description) if variant.scalar else fmi3.describe(description)
    files = [file.get("name", "") for file in old.findall("CoSimulation/SourceFiles/File") if variant.sources]
    return fmi2.describe(description, files)


Shown = Callable[[Mapping[str, bytes], Description, int], Mapping[str, bytes]]
"""From the generic FMU's parts, the description and the FMI version to the parts that show the scene."""


def scene_fmu(generic: Path, source: Path, content: Content, out: Path, variant: Variant, shown: Shown | None) -> None:
    """Writes the FMU of a scene: the generic one with the scene's start values, name, icon and page."""
    parts = {name: data for name, data in read_parts(generic).items()
             if variant.sources or not name.startswith("sources/")}
    old = ET.fromstring(parts["modelDescription.xml"])
    given = parse(source.read_text(encoding="utf-8"))
    given = of_slipping(given) if variant.slipping else given
    description = for_vehicle(with_values(given, content.values, content.name, content.text))
    description = with_identifier(description, identifier_in(old))
    if variant.derivatives:
        description = of_step(description)
    experiment = description.root.find("DefaultExperiment")
    if experiment is not None:
        experiment.set("stopTime", repr(float(content.duration_s)))
        experiment.set("stepSize", repr(output_step(content.duration_s, content.step_s)))
    if shown is not None:
        parts |= shown(parts, description, variant.version)
    if not variant.enumerations:
        description = without_enumerations(description)
    xml = _describe(old, description, variant)
    parts["modelDescription.xml"] = xml.encode("utf-8")
    if variant.version == 3:
        terminals = parts["terminalsAndIcons/terminalsAndIcons.xml"].decode("utf-8")
        parts["terminalsAndIcons/terminalsAndIcons.xml"] = \
            terminals_of(terminals, description, variant.scalar).encode("utf-8")
    parts["resources/start.bin"] = start_file(start_values(description), token_in(xml),
                                              variant.scalar or variant.version == 2)
    pack(out, parts)
