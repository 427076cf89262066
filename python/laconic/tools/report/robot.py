"""What a report about the user's robot measures: that robot alone, first and only, with a progress bar."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.paths import sources_missing
from laconic.base.progress import progress_bar
from laconic.core import load
from laconic.errors import BadInput, Refused
from laconic.scene import METHODS, Scene
from laconic.scene.ground import has_friction
from laconic.tools.enclosure.rounding_bound import rounding_row
from laconic.tools.report import accuracy, boards, pictures, sections, stability
from laconic.tools.report.collect import PARTS, REALS, Report
from laconic.tools.report.estimated import table_of
from laconic.tools.report.page import Section, Table
from laconic.tools.report.pictures import plan
from laconic.tools.report.sections import mapped, rounding_section
from laconic.tools.report.workshop import M4F, Workshop
from laconic.tools.verify.reference import totals_of

QUICK_FACTORS = tuple(float(10**k) for k in range(-1, 7))
WANTED = (1e-3, 1e-6, 1e-9)
WANTED_SLIPPING = (1e-1, 1e-2, 1e-3)  # of the friction step, which is of first order
ERRORS = ("error_nu", "error_pose", "error_wheel")

Row = dict[str, Any]


def collect_robots(scenes: Sequence[Scene], folder: Path, quick: bool = False) -> Report:
    """Everything about these robots. `quick`: a coarser stability map, and the board in single precision alone."""
    _distinct(scenes)
    report, workshop = Report({name: [] for name in PARTS}, robots=list(scenes)), Workshop(folder / "bench")
    factors = QUICK_FACTORS if quick else stability.FACTORS
    reals = REALS[1:] if quick else REALS
    amount = len(scenes) * (len(REALS) * len(METHODS) + len(factors) + len(reals))
    with progress_bar("report", amount) as advance:
        report.results["robots"] = [robot_row(scene) for scene in scenes]
        advance(0, "error against run time")
        report.results["accuracy"] = [row for scene in scenes for row in ladder_rows(scene, advance)]
        report.notes += [f"Not compared, as the reference was refused: {why}" for why in
                         dict.fromkeys(row["why"] for row in report.results["accuracy"] if "why" in row)]
        report.results["take"] = [row for scene in scenes for row in advice(report.results["accuracy"], scene)]
        advance(0, "stability map")
        report.results["map"] = [row for scene in scenes for row in map_rows(scene, factors, advance)]
        report.results["rounding"] = [rounding_row(scene) for scene in scenes]
        advance(0, "Cortex-M")
        if M4F.present:
            report.results["scenes"] = boards.scene_rows(workshop, scenes, reals, advance=advance)
        else:
            report.notes.append("Not installed, so not measured: "
                                f"{sources_missing() or 'arm-none-eabi-gcc and qemu-system-arm'} "
                                "(see docs/performance.md).")
    if quick:
        report.notes.append("Made with --quick: a coarser stability map, and the microcontroller in single alone.")
    return report


def _distinct(scenes: Sequence[Scene]) -> None:
    """Rows and build folders are named after the file."""
    count = Counter(scene.path.stem for scene in scenes)
    for name, times in count.items():
        if times > 1:
            raise BadInput(f"--scene: {times} files are called {name}; give each once, and rename those that differ")


def robot_row(scene: Scene) -> Row:
    """The constants of the robot that the core has prepared. With friction the model is that of the body alone, which
    no motor damps: then there is no rate."""
    core = load("double")
    plant = scene.with_run(real="double").plant(core)
    model = plant.c.model
    rates = core.numbers(model.decay_per_s)[: int(model.dof)]
    kinds = Counter(wheel["kind"] for wheel in scene.vehicle["wheel"])
    wheels = ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "none"
    supports = len(scene.vehicle["support"])
    return {"scene": scene.path.stem, "name": scene.name, "mass_kg": float(model.mass_kg),
            "wheels": wheels + (f", {supports} support{'s' if supports > 1 else ''}" if supports else ""),
            "dof": int(model.dof), "method": scene.run.method,
            "works": "the friction step" if plant.has_friction else plant.chosen_method,
            "real": scene.run.real, "step_s": scene.run.step_s} | (
                {} if plant.has_friction else {"fastest_decay_per_s": float(rates.max(initial=0.0)),
                                               "h_r": scene.run.step_s * float(rates.max(initial=0.0))})


def ladder_rows(scene: Scene, advance: Any = lambda: None) -> list[Row]:
    """Error against run time, the scene's own step among the others."""
    ladder, grid_s = accuracy.ladder_of(scene)
    return [row | {"own": row["step_s"] == scene.run.step_s}
            for row in accuracy.rows_of(scene, REALS, METHODS, advance, ladder, grid_s)]


def advice(rows: Sequence[Row], scene: Scene) -> list[Row]:
    """For some accuracies: the quickest method and step that reach it in ν, pose and wheel angles, in each type."""
    found, slips = [], all(row["method"] == "auto" for row in rows if row["scene"] == scene.path.stem)
    for wanted in WANTED_SLIPPING if slips else WANTED:
        for real in REALS:
            good = [(row["us_per_second"], worst_error(row), row) for row in rows
                    if (row["scene"], row["real"], row["status"]) == (scene.path.stem, real, "ok")
                    and (row["method"] != "auto" or slips) and worst_error(row) <= wanted]
            _, error, row = min(good, key=lambda each: each[:2], default=(None, None, {}))
            found.append({"scene": scene.path.stem, "wanted_error": wanted, "real": real,
                          "method": row.get("method", "none of the ladder"), "step_s": row.get("step_s"),
                          "error": error, "us_per_second": row.get("us_per_second")})
    return found


def worst_error(row: Row) -> float:
    """The largest of the three relative errors; infinite where one is not finite."""
    errors = [row[name] for name in ERRORS]
    return max(errors) if np.isfinite(errors).all() else float("inf")


def map_rows(scene: Scene, factors: Sequence[float], advance: Any = lambda: None) -> list[Row]:
    """The stability map of this robot with weaker and stronger motors, on its own ground; none where no motor drives
    and damps it, and none where motors have limits, which would not grow with them."""
    totals = totals_of(scene.vehicle)
    if not (scene.wheel_count and totals.motor_gain_Nm_per_V and totals.motor_damping_Nms) or "drive" in scene.vehicle:
        return []
    try:
        if has_friction(scene.vehicle):
            return stability.friction_map_rows(scene, factors, advance)
        return stability.map_rows(scene, factors=factors, advance=advance)
    except Refused as refused:
        raise refused.at(scene.path) from None


# ---- The sections of a page about the user's robot.

Results = dict[str, list[Row]]


def robot_sections(scenes: Sequence[Scene], results: Results) -> list[Section]:
    """In order."""
    return [_robot(scenes, results), _accuracy(scenes, results), _stability(scenes, results), rounding_section(results),
            _board(scenes, results)]


def _fields(scenes: Sequence[Scene], *fields: str) -> tuple[str, ...]:
    """One robot's name need not stand in every row."""
    return fields if len(scenes) == 1 else ("scene", *fields)


def _robot(scenes: Sequence[Scene], results: Results) -> Section:
    facts = Table([fact for row in results["robots"] for fact in _facts(row)], ("fact", "value"),
                  headed_by="name" if len(scenes) > 1 else "")
    take = Table(results["take"], _fields(scenes, "wanted_error", "real", "method", "step_s", "error", "us_per_second"),
                 "What to take")
    title = "The robot" if len(scenes) == 1 else "The robots"
    return Section("robot", title, sections.paragraphs(sections.ROBOT),
                   [plan(scene) for scene in scenes], (facts, take))


def _facts(row: Row) -> list[Row]:
    """A robot's numbers, one a line."""
    works = "" if row["works"] == row["method"] else f", which picks {row['works']}"
    named = {"wheels": row["wheels"], "mass": f"{row['mass_kg']:.6g} kg", "degrees of freedom": str(row["dof"]),
             "method of the scene": row["method"] + works, "scalar type": row["real"],
             "its own step h": f"{row['step_s']:g} s"}
    if "h_r" in row:
        named["fastest damping r"] = f"{row['fastest_decay_per_s']:.4g} 1/s, h·r = {row['h_r']:.3g}"
    return [{"name": row["name"], "fact": fact, "value": value} for fact, value in named.items()]


def _accuracy(scenes: Sequence[Scene], results: Results) -> Section:
    rows = results["accuracy"]
    drawn = [pictures.error_against_time(rows, scene.path.stem, scene.name) for scene in scenes]
    fields = _fields(scenes, "real", "method", "step_s", "status", "error_nu", "estimate_nu", "error_pose",
                     "estimate_pose", "error_wheel", "estimate_wheel", "ns_per_step", "us_per_second")
    return Section("accuracy", "Error against run time", sections.paragraphs(sections.ACCURACY), drawn,
                   (table_of(rows), Table(rows, fields, "All runs", True)))


def _stability(scenes: Sequence[Scene], results: Results) -> Section:
    drawn = []
    for scene in scenes:
        rows = [row for row in results["map"] if row["scene"] == scene.path.stem]
        own = next(row for row in results["robots"] if row["scene"] == scene.path.stem)
        whose = f", {scene.path.stem}" if len(scenes) > 1 else ""
        star = (own["step_s"], own["fastest_decay_per_s"]) if "fastest_decay_per_s" in own else None
        drawn += [pictures.stability(rows, method, star, whose)
                  for method in mapped(rows)]
    return Section("stability", "Stability map", sections.paragraphs(sections.ROBOT_STABILITY), drawn)


def _board(scenes: Sequence[Scene], results: Results) -> Section:
    rows = [row for row in results["scenes"] if row["status"] == "ok"]
    fields = _fields(scenes, "chosen", "real", "build", "instructions", "step_code", "flash", "state", "worst_stack",
                     "same_bits")
    return Section("board", "On a microcontroller", sections.paragraphs(sections.ROBOT_BOARD), (),
                   (Table(rows, fields),))
