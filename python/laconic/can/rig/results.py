"""Results for people and for CI: table, JSON, JUnit."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from laconic.base.outputs import opened
from laconic.can.rig.verdict import Judgement


def as_json(judgement: Judgement) -> str:
    """Everything, machine-readable."""
    whole = {"scene": judgement.scene, "mode": judgement.mode, "passed": judgement.passed,
             "verdicts": [in_json(asdict(each)) for each in judgement.verdicts],
             "figures": in_json(judgement.figures), "notes": judgement.notes, **judgement.facts}
    return json.dumps(whole, indent=1, allow_nan=False)


def in_json(values: dict[str, Any]) -> dict[str, Any]:
    """Plain numbers; null for NaN and the infinities, which JSON does not have."""
    plain = {name: value.item() if isinstance(value, np.generic) else value for name, value in values.items()}
    return {name: None if isinstance(value, float) and not math.isfinite(value) else value
            for name, value in plain.items()}


def write_junit(judgement: Judgement, path: Path, seconds: float, command: str = "rig") -> None:
    """One test case per verdict."""
    failures = sum(not each.passed for each in judgement.verdicts)
    suite = ElementTree.Element("testsuite", name=f"laconic {command} {judgement.scene} {judgement.mode}",
                                tests=str(len(judgement.verdicts)), failures=str(failures), time=f"{seconds:.3f}")
    known = [(name, value) for name, value in judgement.figures.items() if math.isfinite(value)]
    if known:
        properties = ElementTree.SubElement(suite, "properties")
        for name, value in known:
            ElementTree.SubElement(properties, "property", name=name, value=f"{value:.6g}")
    for each in judgement.verdicts:
        case = ElementTree.SubElement(suite, "testcase", classname=f"{command}.{judgement.mode}", name=each.name)
        if not each.passed:
            ElementTree.SubElement(case, "failure", message=each.detail).text = each.detail
    if judgement.notes:
        ElementTree.SubElement(suite, "system-out").text = "\n".join(judgement.notes)
    with opened(path, "wb") as file:
        ElementTree.ElementTree(suite).write(file, encoding="utf-8", xml_declaration=True)


def show(judgement: Judgement) -> None:
    """The table for people."""
    table = Table(title=escape(f"{judgement.scene}, {judgement.mode}"), title_justify="left")
    for heading in ("signal", "verdict", "detail"):
        table.add_column(heading)
    for each in judgement.verdicts:
        table.add_row(each.name, "[green]pass" if each.passed else "[red]FAIL", escape(each.detail))
    console = Console()
    console.print(table)
    for name, value in judgement.figures.items():
        console.print(f"{name:>26}  {value:.6g}")
    for note in judgement.notes:
        console.print(note, markup=False)
