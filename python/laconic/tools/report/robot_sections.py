"""The sections of a page about the user's robot."""

from __future__ import annotations

from collections.abc import Sequence

from laconic.scene import Scene
from laconic.tools.report import pictures, sections
from laconic.tools.report.estimated import table_of
from laconic.tools.report.page import Row, Section, Table
from laconic.tools.report.pictures import plan
from laconic.tools.report.sections import mapped, rounding_section

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
