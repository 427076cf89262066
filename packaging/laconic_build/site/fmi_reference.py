"""The variables of the FMUs, from modelDescription.xml."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree


def fmi_page(source: Path) -> str:
    """A table for each causality."""
    root = ElementTree.parse(source / "modelDescription.xml").getroot()
    groups: dict[str, list[str]] = {}
    for variable in root.iterfind(".//ModelVariables/*"):
        causality = variable.get("causality", "local")
        dimensions = "[]" * len(variable.findall("Dimension"))
        cells = [f"`{variable.get('name')}{dimensions}`", variable.get("unit") or variable.tag.removeprefix("fmi"),
                 variable.get("start") or "", (variable.get("description") or "").replace("|", "\\|")]
        groups.setdefault(causality, []).append("| " + " | ".join(cells) + " |")
    parts = ["# FMI variables", "Made from `modelDescription.xml`. FMI 2 has each element of an array as a variable "
                                "of its own, counted "
             "from 1."]
    for causality, rows in groups.items():
        parts += [f"## {causality}", "\n".join(["| variable | unit or type | start | description |", "| --- | --- | "
                                                                                                     "--- | --- "
                                                                                                     "|", *rows])]
    return "\n\n".join(parts) + "\n"
