"""FMUs with a bus terminal by FMI-LS-BUS: the node of a scene, made from that of the build."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from . import fmi3
from .archive import Content, pack, read_parts, start_file
from .description import parse, start_values, token_in, with_token, with_values

TX_CLOCKS = ("triggered", "countdown")
TX_CLOCK = "CAN.Tx_Clock"
PAGE = "documentation/index.html"
TAKEN_BASES = 255  # the private start value of NodeContent.taken_bases (fmu/network/node/model.c)


@dataclass(frozen=True)
class NodeContent:
    """What an FMU of a node has besides its start values."""

    frames: Sequence[tuple[int, bytes]]
    """Those of the rig that loads the scene: the offset of the identifier and eight bytes."""
    tx_clock: str
    """One of TX_CLOCKS."""
    sources: bool = True
    taken_bases: int = 0
    """Bit k: drives use one of the 32 identifiers from 32 k on, so that they cannot be the node's own."""

    @property
    def private(self) -> list[tuple[int, bytes]]:
        """The start values that are no variable's (fmu/network/node/model.c)."""
        return [*self.frames, (TAKEN_BASES, self.taken_bases.to_bytes(8, "little"))]


def with_countdown(text: str) -> str:
    """The description with a Tx_Clock that announces its ticks by an interval, as FMI-LS-BUS recommends."""
    root = ET.fromstring(text)
    clock = next(each for each in root.iter("Clock") if each.get("name") == TX_CLOCK)
    clock.set("causality", "input")
    clock.set("intervalVariability", "countdown")
    reference, structure = clock.get("valueReference"), root.find("ModelStructure")
    assert structure is not None
    for entry in list(structure):
        if entry.get("valueReference") == reference:  # an input is no output
            structure.remove(entry)
    ET.indent(root)
    return with_token(f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n')


def node_fmu(generic: Path, source: Path, content: Content, own: NodeContent, out: Path) -> None:
    """Writes the FMU of a scene's node: scalar variables, and the frames that load the scene."""
    parts = {name: data for name, data in read_parts(generic).items()
             if own.sources or not name.startswith("sources/")}
    description = with_values(parse(source.read_text(encoding="utf-8")), content.values, content.name, content.text)
    experiment = description.root.find("DefaultExperiment")
    assert experiment is not None
    experiment.set("stopTime", repr(float(content.duration_s)))
    experiment.set("stepSize", repr(float(content.step_s)))
    xml = fmi3.describe_scalar(description)
    if own.tx_clock == "countdown":
        xml = with_countdown(xml)
    parts["modelDescription.xml"] = xml.encode("utf-8")
    parts[PAGE] = _page(parts, content)
    parts["resources/start.bin"] = start_file(start_values(description), token_in(xml), True, own.private)
    pack(out, parts)


def _page(parts: Mapping[str, bytes], content: Content) -> bytes:
    """The generic page under the scene's name."""
    text, mark = parts[PAGE].decode("utf-8"), "</h1>\n"
    if text.count(mark) != 1:
        raise ValueError(f"{PAGE}: {mark.strip()} must occur exactly once")
    return text.replace(mark, f"{mark}<p><b>{escape(content.name)}.</b> {escape(content.text)}.</p>\n").encode("utf-8")
