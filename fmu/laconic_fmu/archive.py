"""What goes into an FMU, and an FMU for a scene from the one that the build made."""

from __future__ import annotations

import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from . import fmi2, fmi3
from .description import Description, parse, start_values, token_in, with_values
from .package import pack, start_file
from .scalars import elements_of

PLATFORMS = {
    "x86_64-linux": ("linux64", "x86_64-linux", ".so"),
    "aarch64-linux": ("aarch64-linux", "aarch64-linux", ".so"),
    "x86_64-windows": ("win64", "x86_64-windows", ".dll"),
    "x86_64-darwin": ("darwin64", "x86_64-darwin", ".dylib"),
    "aarch64-darwin": ("aarch64-darwin", "aarch64-darwin", ".dylib"),
}
"""Folder in FMI 2, folder in FMI 3, ending of the binary."""

COMPILER, OPTIONS = "gcc", "-std=c99 -O2 -ffp-contract=off -fno-tree-slp-vectorize"
"""What keeps the same bits; clang knows the same options."""


def binary_name(version: int, platform: str, identifier: str) -> str:
    """Where a binary lies in the archive."""
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


def scene_fmu(generic: Path, source: Path, values: Mapping[str, Sequence[float]], name: str, text: str, out: Path, *,
              version: int, scalar: bool, stop_s: float, step_s: float, sources: bool = True) -> None:
    """Writes the FMU of a scene: the generic one with the scene's start values."""
    parts = {name: data for name, data in read_parts(generic).items() if sources or not name.startswith("sources/")}
    description = with_values(parse(source.read_text(encoding="utf-8")), values, name, text)
    experiment = description.root.find("DefaultExperiment")
    if experiment is not None:
        experiment.set("stopTime", repr(float(stop_s)))
        experiment.set("stepSize", repr(float(step_s)))
    if version == 2:
        old = ET.fromstring(parts["modelDescription.xml"])
        files = [file.get("name", "") for file in old.findall("CoSimulation/SourceFiles/File") if sources]
        xml = fmi2.describe(description, files)
    else:
        xml = fmi3.describe_scalar(description) if scalar else fmi3.describe(description)
    parts["modelDescription.xml"] = xml.encode("utf-8")
    if version == 3:
        terminals = parts["terminalsAndIcons/terminalsAndIcons.xml"].decode("utf-8")
        parts["terminalsAndIcons/terminalsAndIcons.xml"] = terminals_of(terminals, description, scalar).encode("utf-8")
    parts["resources/start.bin"] = start_file(start_values(description), token_in(xml), scalar or version == 2)
    pack(out, parts)
