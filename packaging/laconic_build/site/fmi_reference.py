"""The variables of the FMUs, from their descriptions."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

DESCRIPTIONS = {"Rigid vehicles": "modelDescription.xml",
                "Vehicles with hinges": "fmu/articulated/modelDescription.xml"}
HEAD = "| variable | unit or type | start | description |\n| --- | --- | --- | --- |"


def fmi_page(source: Path) -> str:
    """A table for each causality of each description."""
    parts = ["# FMI variables", "FMI 2 has each element of an array as a variable of its own, counted from 1."]
    for title, name in DESCRIPTIONS.items():
        parts += [f"## {title}", f"Made from `{name}`."]
        for causality, rows in _groups(source / name).items():
            parts += [f"### {causality}", "\n".join([HEAD, *rows])]
    return "\n\n".join(parts) + "\n"


def _groups(path: Path) -> dict[str, list[str]]:
    groups: dict[str, list[str]] = {}
    for variable in ElementTree.parse(path).getroot().iterfind(".//ModelVariables/*"):
        dimensions = "[]" * len(variable.findall("Dimension"))
        cells = [f"`{variable.get('name')}{dimensions}`", variable.get("unit") or variable.tag.removeprefix("fmi"),
                 variable.get("start") or "", (variable.get("description") or "").replace("|", "\\|")]
        groups.setdefault(variable.get("causality", "local"), []).append("| " + " | ".join(cells) + " |")
    return groups
