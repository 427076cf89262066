"""Runs every measurement of the project's report, with a progress bar; what cannot be measured here is noted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from laconic.base.progress import progress_bar
from laconic.scene import METHODS, Outputs, Scene, read_scene
from laconic.scene.methods import EXACT
from laconic.tools.enclosure.rounding_bound import rounding_row
from laconic.tools.report import (
    accuracy,
    boards,
    drift,
    extremes,
    friction_accuracy,
    friction_cost,
    peers,
    referenced,
    speed,
    stability,
    targets,
)
from laconic.tools.report.workshop import BOARDS, HOST, M4F, Variant, Workshop

REALS = ("double", "single")
MAP_SCENE, BENCH_SCENE, FREE_SCENE = "kuka_youbot", "s1", "paper_three_wheel_free"
STIFF_SCENES = ("robotino2", "kuka_youbot")
PARTS = ("targets", "robots", "take", "accuracy", "drift", "norm", "map", "stiff", "extremes",
         "rounding", "verified", "prototype",
         "single", "long", "steps", "precision", "boards", "scenes", "smallest",
         "friction_cost", "friction_order", "friction_extremes")  # all that report.json may hold


@dataclass
class Report:
    """Rows by section, and what had to be left out."""

    results: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    robots: list[Scene] = field(default_factory=list)  # robots of the report; none: the project's scenes and goals


def collect(scenes: Sequence[Scene], folder: Path, quick: bool = False) -> Report:
    """Everything. `quick` takes fewer repetitions and vehicles (for tests; the figures are then rough)."""
    bench = read_scene(BENCH_SCENE).with_run(step_s=speed.STEP_S)
    workshop, report = Workshop(folder / "bench"), Report({name: [] for name in PARTS})
    sections = (_numeric, _stiffness, _edges, _speed, _boards, _friction)
    with progress_bar("report", _amount(scenes, quick)) as advance:
        for section in sections:
            report.results |= section(report, scenes, bench, workshop, folder, quick, advance)
    report.results["targets"] = targets.targets(report.results)
    if quick:
        report.notes.append("Made with --quick: fewer steps, vehicles, repetitions and boards than the texts say.")
    return report


def _amount(scenes: Sequence[Scene], quick: bool) -> int:
    """Number of moves of the progress bar."""
    numeric = 2 * len(METHODS) * len(scenes) + 2 * len(METHODS[1:])
    board_count = 1 if quick else len(BOARDS)
    sizes = 2 * len(METHODS[1:]) * board_count + 2 * len(scenes)
    costs = len(REALS) * len(friction_cost.cost_scenes())
    return numeric + 2 * len(stability.FACTORS) + 8 + 2 * len(extremes.CASES) + 2 + sizes + costs


def _numeric(report: Report, scenes: Sequence[Scene], bench: Scene, workshop: Workshop, folder: Path, quick: bool,
             advance: Any) -> dict[str, list[dict[str, Any]]]:
    advance(0, "error against run time")
    rows = [row for scene in scenes for row in accuracy.rows_of(scene, REALS, advance=advance)]
    if bench.path.stem not in {scene.path.stem for scene in scenes}:
        rows += accuracy.rows_of(bench, REALS, METHODS[1:])
    advance(0, "what is conserved")
    steps = 10_000 if quick else drift.STEPS
    return {"accuracy": rows, "drift": drift.drift_rows(read_scene(FREE_SCENE), REALS, steps=steps, advance=advance),
            "norm": drift.norm_rows(REALS, vehicles=200 if quick else 10_000)}


def _stiffness(report: Report, scenes: Sequence[Scene], bench: Scene, workshop: Workshop, folder: Path, quick: bool,
               advance: Any) -> dict[str, list[dict[str, Any]]]:
    advance(0, "stability map")
    ideal = read_scene(MAP_SCENE)
    slips = replace(ideal, vehicle=ideal.vehicle | {"friction_coefficient": 0.0, "ground": friction_cost.GROUND})
    return {"map": [*stability.map_rows(ideal, advance=advance), *stability.friction_map_rows(slips, advance=advance)],
            "stiff": stability.stiff_rows([read_scene(name) for name in STIFF_SCENES], advance=advance)}


def _edges(report: Report, scenes: Sequence[Scene], bench: Scene, workshop: Workshop, folder: Path, quick: bool,
           advance: Any) -> dict[str, list[dict[str, Any]]]:
    advance(0, "extremes and references")
    if referenced.reference_file("trajectories.json") is None:
        report.notes.append("The reference trajectories are not in this checkout: not compared.")
    straight = accuracy.straight_run(bench)
    long_runs = [{"what": "heading", "found": float(accuracy.heading_after_many_turns(bench))},
                 {"what": "x", "found": straight["error"]}]
    return {"extremes": extremes.extreme_rows(REALS, advance), "rounding": [rounding_row(scene) for scene in scenes],
            "verified": referenced.verified_rows(),
            "prototype": referenced.table_rows(), "single": accuracy.s1_rows(bench, METHODS), "long": long_runs}


def _speed(report: Report, scenes: Sequence[Scene], bench: Scene, workshop: Workshop, folder: Path, quick: bool,
           advance: Any) -> dict[str, list[dict[str, Any]]]:
    advance(0, "other integrators")
    if missing := peers.missing_peers():
        report.notes.append(f"Not installed, so not compared: {', '.join(missing)} (see docs/performance.md).")
    if missing := boards.missing_tools():
        report.notes.append(f"Not installed, so not measured: {', '.join(missing)} (see docs/performance.md).")
    if not HOST.present:
        return {"steps": [], "precision": []}
    steps = speed.step_rows(workshop, bench, folder / "peers", 5 if quick else speed.ROUNDS)
    advance()
    rows = speed.precision_rows(workshop, bench, folder / "peers", 2 if quick else speed.ROUNDS)
    advance()
    return {"steps": steps, "precision": rows}


def _boards(report: Report, scenes: Sequence[Scene], bench: Scene, workshop: Workshop, folder: Path, quick: bool,
            advance: Any) -> dict[str, list[dict[str, Any]]]:
    advance(0, "Cortex-M")
    if not M4F.present:
        return {"boards": [], "scenes": [], "smallest": []}
    targets_here = (M4F,) if quick else BOARDS
    smallest = replace(read_scene(FREE_SCENE).with_run(method=EXACT),
                       outputs=Outputs(signals=tuple(f"nu_rad_per_s[{k}]" for k in (1, 2, 3))))
    return {"boards": boards.method_rows(workshop, bench, REALS, targets_here, advance=advance),
            "scenes": boards.scene_rows(workshop, scenes, REALS, advance=advance),
            "smallest": [boards.board_row(Workshop(folder / "smallest"), M4F,
                                          Variant(smallest, "single", "-Os", True))]}


def _friction(report: Report, scenes: Sequence[Scene], bench: Scene, workshop: Workshop, folder: Path, quick: bool,
              advance: Any) -> dict[str, list[dict[str, Any]]]:
    advance(0, "ground with friction")
    costs = friction_cost.cost_rows(workshop, M4F if M4F.present else None, REALS, advance)
    return {"friction_order": friction_accuracy.order_rows(),
            "friction_extremes": friction_accuracy.extreme_rows(REALS), "friction_cost": costs}
