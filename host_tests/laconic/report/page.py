"""The report as one HTML file that opens offline, with CSV and JSON beside it."""

from __future__ import annotations

import csv
import json
import math
import platform
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jinja2 import Environment
from markupsafe import Markup, escape

from laconic.outputs import opened, write_text
from laconic.report import pictures, texts
from laconic.report.collect import Report
from laconic.scene import METHODS

Row = dict[str, Any]
TITLES = {
    "bound": "", "ns_per_step": "ns a step", "instructions": "instructions", "step_code": "code [B]",
    "flash": "flash [B]", "state": "state [B]",
    "worst_stack": "worst stack [B]",
    "stack_measured": "stack measured [B]", "tables": "constants [B]", "error_nu": "error ν",
    "error_pose": "error pose",
    "error_wheel": "error wheels", "error_path": "error path", "step_s": "h [s]", "same_bits": "host's bits",
    "worst_growth_ulp": "largest growth [ulp]", "steps_taken": "steps taken", "digits_lost": "digits lost",
    "who": "integrator", "as_good": "reached", "fastest_decay_per_s": "r [1/s]", "us_per_second": "µs/s"}
TEXT = {"goal", "scene", "method", "real", "processor", "build", "optimisation", "status", "who", "case",
        "why", "outcome", "drive", "refused", "verdict", "chosen", "same_bits", "as_good"}
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
    if name.startswith("error") or name in ("prototype", "energy", "K"):
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
            cells.append({"text": shown(name, value), "style": " ".join(styles)})
        rows.append({"cells": cells, "heading": heading if heading != above else ""})
        above = heading
    return {"title": table.title, "folded": table.folded, "columns": columns, "rows": rows}


def sections(results: dict[str, list[Row]]) -> list[Section]:
    """What the page says, in order."""
    found = [_goals(results), _accuracy(results), _peers(results), _stability(results), _conserved(results),
             _boards(results), _scenes(results), _references(results), _extremes(results)]
    return [section for section in found if section.pictures or any(table.rows for table in section.tables)]


def _section(key: str, title: str, pictures_of: Sequence[str], *tables: Table) -> Section:
    return Section(key, title, texts.paragraphs(getattr(texts, key.upper())), pictures_of, tables)


def _goals(results: dict[str, list[Row]]) -> Section:
    fields = ("goal", "found", "bound", "wanted", "verdict")
    return _section("goals", "Goals", (), Table(results["targets"], fields, headed_by="group"))


def _accuracy(results: dict[str, list[Row]]) -> Section:
    rows = results["accuracy"]
    drawn = [pictures.error_against_time(rows, scene) for scene in dict.fromkeys(row["scene"] for row in rows)]
    fields = ("scene", "real", "method", "step_s", "status", "error_nu", "error_pose", "error_wheel", "ns_per_step",
              "us_per_second")
    return _section("accuracy", "Error against run time", drawn, Table(rows, fields, "All runs", True))


def _peers(results: dict[str, list[Row]]) -> Section:
    rows = results["precision"]
    steps = Table(results["steps"], ("who", "real", "build", "ns_per_step", "ratio", "instructions"), "One step")
    runs = Table(rows, ("who", "real", "setting", "error_nu", "ms"), "All runs (setting: step [s] or tolerance)", True)
    return _section("peers", "Beside other integrators", [pictures.precision(rows)] if rows else [], steps, runs)


def _stability(results: dict[str, list[Row]]) -> Section:
    drawn = [pictures.stability(results["map"], method) for method in METHODS] if results["map"] else []
    fields = ("scene", "factor", "drive", "step_s", "status", "error_nu", "error_path")
    return _section("stability", "Stability map", drawn, Table(results["stiff"], fields))


def _conserved(results: dict[str, list[Row]]) -> Section:
    drawn = [pictures.drift(results["drift"], real, what) for real in ("double", "single") for what in ("energy", "K")
             if results["drift"]]
    fields = ("real", "method", "steps_taken", "worst_growth_ulp", "refused")
    return _section("conserved", "What is conserved", drawn, Table(results["norm"], fields))


def _boards(results: dict[str, list[Row]]) -> Section:
    rows = [row for row in results["boards"] if row["status"] == "ok"]
    main = [row for row in rows if row["processor"] == "Cortex-M4F" and row["real"] == "single"]
    fields = ("processor", "real", "method", "optimisation", "build", "instructions", "step_code", "flash", "tables",
              "state", "worst_stack", "stack_measured", "same_bits")
    return _section("boards", "On a microcontroller", (), Table(main, fields[2:], "Cortex-M4F, single"),
                    Table(rows, fields, "All boards", True))


def _scenes(results: dict[str, list[Row]]) -> Section:
    fields = ("scene", "chosen", "real", "build", "instructions", "step_code", "flash", "state", "worst_stack",
              "same_bits")
    return _section("scenes", "Whole and trimmed, scene by scene", (), Table(results["scenes"], fields))


def _references(results: dict[str, list[Row]]) -> Section:
    auto = [row for row in results["verified"] if row["method"] == "auto"]
    fields = ("case", "method", "step_s", "status", "error_nu", "error_pose", "error_wheel")
    beside = ("case", "step_s", "method", "prototype", "error_nu", "status", "as_good")
    return _section("references", "Reference trajectories", (), Table(auto, fields, "auto"),
                    Table(results["verified"], fields, "Every method", True),
                    Table(results["prototype"], beside, "Beside the prototype's errors"),
                    Table(results["single"], ("method", "step_s", "error_nu", "error_anywhere"),
                          "S1 in single precision: error of ν in rad/s at 10 s, and the largest on the way"))


def _extremes(results: dict[str, list[Row]]) -> Section:
    fields = ("case", "real", "outcome", "error", "digits_lost", "why")
    return _section("extremes", "Extremes", (), Table(results["extremes"], fields))


def write(report: Report, folder: Path, version: str) -> Path:
    """index.html, report.json and one CSV a section."""
    for name, rows in report.results.items():
        if rows:
            _write_csv(folder / f"{name}.csv", rows)
    write_text(folder / "report.json", json.dumps({"version": version, "notes": report.notes, **report.results},
                                                  indent=1, default=float))
    goals = report.results["targets"]
    count = {verdict: sum(row["verdict"] == verdict for row in goals) for verdict in ("met", "missed", "not measured")}
    summary = (f"Of {len(goals)} goals {count['met']} are met, {count['missed']} missed, "
               f"{count['not measured']} not measured.")
    shown_sections = [{"key": s.key, "title": s.title, "text": s.text, "pictures": s.pictures,
                       "tables": [prepared(t) for t in s.tables if t.rows]} for s in sections(report.results)]
    environment = Environment(autoescape=True)
    environment.filters["code"] = lambda text: Markup(re.sub("`(.*?)`", r"<code>\1</code>", str(escape(text))))
    template = environment.from_string(Path(__file__).with_name("page.html").read_text())
    machine = f"{platform.system()} {platform.machine()}"
    page = folder / "index.html"
    write_text(page, template.render(version=version, machine=machine, summary=summary, notes=report.notes,
                                     sections=shown_sections))
    return page


def _write_csv(path: Path, rows: Sequence[Row]) -> None:
    fields = list(dict.fromkeys(key for row in rows for key in row))
    with opened(path) as file:
        writer = csv.DictWriter(file, fields)
        writer.writeheader()
        writer.writerows(rows)
