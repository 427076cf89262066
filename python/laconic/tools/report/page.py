"""A page of the report as one HTML file that opens offline: tables, sections, and the template they go into."""

from __future__ import annotations

import math
import platform
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jinja2 import Environment
from markupsafe import Markup, escape

Row = dict[str, Any]
TITLES = {
    "bound": "", "fact": "", "value": "", "ns_per_step": "ns a step", "step_code": "code [B]", "flash": "flash [B]",
    "state": "state [B]", "worst_stack": "worst stack [B]", "stack_measured": "stack measured [B]",
    "tables": "constants [B]", "error_nu": "error ν", "error_pose": "error pose", "error_wheel": "error wheels",
    "estimate_nu": "estimated ν", "estimate_pose": "estimated pose", "estimate_wheel": "estimated wheels",
    "within_10": "within a factor of 10", "error_path": "error path", "step_s": "h [s]", "same_bits": "host's bits",
    "worst_growth_ulp": "largest growth [ulp]", "steps_taken": "steps taken", "digits_lost": "digits lost",
    "who": "integrator", "as_good": "reached", "us_per_second": "µs a second",
    "fastest_decay_per_s": "fastest damping r [1/s]", "wanted_error": "error at most", "ratio": "over CasADi's"}
TEXT = {"goal", "scene", "method", "real", "processor", "build", "optimisation", "status", "who", "case",
        "why", "outcome", "inputs", "fact", "value", "refused", "verdict", "chosen", "same_bits", "as_good"}
STYLED = {"verdict", "outcome", "same_bits", "as_good"}


@dataclass(frozen=True)
class Table:
    """Some columns of some rows."""

    rows: Sequence[Row]
    fields: Sequence[str]
    title: str = ""
    folded: bool = False
    headed_by: str = ""  # a field whose value stands above the rows that share it


@dataclass(frozen=True)
class Section:
    """A heading with text, pictures and tables."""

    key: str
    title: str
    text: Sequence[str]
    pictures: Sequence[str] = ()
    tables: Sequence[Table] = field(default_factory=tuple)


def shown(name: str, value: Any) -> str:
    """A cell's text."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    if name.startswith(("error", "estimate")) or name in ("prototype", "energy", "K", "wanted_error"):
        return "0" if value == 0 else f"{value:.1e}"
    if isinstance(value, int):
        return str(value)
    return f"{value:.4g}" if abs(value) < 1e4 and (abs(value) >= 1e-3 or value == 0) else (
        f"{value:.0f}" if 1e4 <= abs(value) < 1e7 else f"{value:.1e}")


def prepared(table: Table) -> dict[str, Any]:
    """What the template needs of a table."""
    columns = [{"name": name, "title": TITLES.get(name, name), "kind": "text" if name in TEXT else ""}
               for name in table.fields]
    rows, above = [], ""
    for row in table.rows:
        cells, heading = [], str(row.get(table.headed_by, ""))
        for name in table.fields:
            value = row.get(name)
            styles = [f"f-{name}", *(["text"] if name in TEXT else [])]
            styles += ["long"] if name in ("why", "goal", "refused") else []
            styles += [str(value).replace(" ", "")] if name in STYLED else []
            cells.append({"text": shown(name, value), "style": " ".join(styles), "title": TITLES.get(name, name)})
        rows.append({"cells": cells, "heading": heading if heading != above else ""})
        above = heading
    return {"title": table.title, "folded": table.folded, "columns": columns, "rows": rows}


@dataclass(frozen=True)
class Document:
    """One page: the text above its sections, and the other pages it leads to (title → file)."""

    title: str
    lead: str
    sections: Sequence[Section]
    notes: Sequence[str] = ()
    links: Mapping[str, str] = field(default_factory=dict)


def render(document: Document, version: str) -> str:
    """The page's HTML: one file that needs nothing else. Sections that have nothing to show are left out."""
    found = [section for section in document.sections
             if section.pictures or any(table.rows for table in section.tables)]
    shown_sections = [{"key": s.key, "title": s.title, "text": s.text, "pictures": s.pictures,
                       "tables": [prepared(t) for t in s.tables if t.rows]} for s in found]
    environment = Environment(autoescape=True)
    environment.filters["code"] = lambda text: Markup(re.sub("`(.*?)`", r"<code>\1</code>", str(escape(text))))
    template = environment.from_string(Path(__file__).with_name("page.html").read_text())
    return template.render(version=version, machine=f"{platform.system()} {platform.machine()}", document=document,
                           sections=shown_sections)
