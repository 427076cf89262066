"""What a friction step costs: instructions of each step of a run in which wheels stick, slip and reach their limits.

Steps differ, as the contact forces take more or fewer passes: median, 99th percentile and worst say how much. The unit
is an RK4 step of the ideal model of three wheels (`IDEAL`), as it was before the core knew friction.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from laconic.errors import ResultFails
from laconic.scene import Scene, read_scene
from laconic.scene.inputs import Input
from laconic.tools.report.counting import (
    CALIBRATED_INSTRUCTIONS,
    cachegrind_present,
    lines_of_board,
    size_of_step,
    stopped_early,
)
from laconic.tools.report.workshop import HOST, Target, Variant, Workshop

Row = dict[str, Any]

IDEAL = {"host": 598.0, "Cortex-M4F": 479.0}  # instructions of an RK4 step
GROUND = {"friction_coefficient": 0.3, "roller_drag": 0.6, "axle_friction_Nm": 0.02}
DRIVE = {"supply_V": 12.0, "supply_resistance_ohm": 0.4, "current_limit_A": 2.0}
HOST_STEPS, BOARD_STEPS = 1000, 500
CALM, RESTLESS = "own inputs", "other voltages every 10 steps, drive with limits"
CALM_STEP_S = 0.01
HELD_S, STEP_S = 0.02, 0.002  # every so often other voltages, up to all that the supply has


def cost_scenes() -> list[tuple[str, Scene]]:
    """The Robotino, the youBot and a ring of sixteen omni wheels, each calm and restless."""
    three, four = read_scene("robotino2"), read_scene("kuka_youbot")
    robots = (three, four, ring(three, 16))
    return [*((CALM, calm(robot)) for robot in robots), *((RESTLESS, restless(robot)) for robot in robots)]


def ring(scene: Scene, count: int) -> Scene:
    """The same vehicle with so many wheels, evenly around it."""
    angles = 2.0 * np.pi * np.arange(count) / count
    wheel = scene.vehicle["wheel"][0]
    wheels = [wheel | {"x_m": 0.125 * float(np.cos(a)), "y_m": 0.125 * float(np.sin(a)), "axle_rad": float(a)}
              for a in angles]
    return replace(scene, path=scene.path.with_name(f"ring_of_{count}.toml"), vehicle=scene.vehicle | {"wheel": wheels})


def calm(scene: Scene) -> Scene:
    """The scene's own inputs on ground with friction."""
    vehicle = scene.vehicle | {"friction_coefficient": 0.0, "ground": GROUND}
    return replace(scene, vehicle=vehicle, path=scene.path.with_name(f"{scene.path.stem}_calm.toml")).with_run(
        duration_s=HOST_STEPS * CALM_STEP_S, step_s=CALM_STEP_S, method="auto")


def restless(scene: Scene, volts: float = 12.0) -> Scene:
    """With limits of the drive, too, and voltages that change so often that the wheels' contacts do, too."""
    source, steps = np.random.default_rng(7), int(HOST_STEPS * STEP_S / HELD_S)
    at = tuple(HELD_S * float(k) for k in range(steps))
    inputs = tuple(Input(f"voltage_V[{i}]", "steps", f"input[{i}]", at, tuple(source.uniform(-volts, volts, steps)))
                   for i in range(1, scene.wheel_count + 1))
    vehicle = scene.vehicle | {"friction_coefficient": 0.0, "ground": GROUND, "drive": DRIVE}
    return replace(scene, vehicle=vehicle, inputs=inputs).with_run(
        duration_s=HOST_STEPS * STEP_S, step_s=STEP_S, method="auto")


def host_spread(program: Path, steps: int = HOST_STEPS) -> np.ndarray:
    """Instructions of each step on the host, by callgrind: it writes a file at the end of each."""
    with TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", "--dump-after=laconic_friction_step",
                   "--toggle-collect=laconic_friction_step", f"--callgrind-out-file={folder}/out", str(program),
                   str(steps)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        files = sorted(Path(folder).glob("out.*"), key=lambda path: int(path.suffix[1:]))
        totals = [re.search(r"^(?:summary|totals): (\d+)", path.read_text(), re.M) for path in files]
    found = [int(total[1]) for total in totals if total and int(total[1]) > 0]
    if done.returncode not in (0, 1) or len(found) < steps:
        raise ResultFails(f"callgrind counted {len(found)} of {steps} steps: {done.stderr[-200:]}")
    return np.array(found[:steps], float)


def board_spread(workshop: Workshop, target: Target, variant: Variant, steps: int = BOARD_STEPS) -> np.ndarray:
    """Instructions of each step on a board under QEMU."""
    image = workshop.board_image(target, variant, steps, "spread")
    printed, _ = lines_of_board(target, image, 120.0)
    lines = [line.split() for line in printed]
    ticks = np.array([int(line[1]) for line in lines if line[0] == "ticks"], float)
    one = {line[0]: int(line[1]) for line in lines if line[0] in ("calibration", "overhead")}
    if len(ticks) != steps or len(one) != 2:
        raise stopped_early(target, image, printed)
    return (ticks - one["overhead"]) / (one["calibration"] / CALIBRATED_INSTRUCTIONS)


def cost_rows(workshop: Workshop, board: Target | None, reals: Sequence[str] = ("double", "single"),
              advance: Callable[[], Any] = lambda: None) -> list[Row]:
    """One row a processor, scalar type and number of wheels."""
    rows = []
    for kind, scene in cost_scenes():
        for real in reals:
            variant = Variant(scene, real, "-O2")
            about = {"run": kind, "real": real, "wheels": scene.wheel_count}
            if HOST.present and cachegrind_present():
                rows.append(cost_row(HOST, about, host_spread(workshop.host_program(variant))))
            if board is not None:
                row = cost_row(board, about, board_spread(workshop, board, variant))
                size = size_of_step(workshop, board, variant)
                rows.append(row | {"flash": size.flash, "step_code": size.step_code, "tables": size.tables,
                                   "worst_stack": size.worst_stack})
            advance()
    return rows


def cost_row(target: Target, about: Row, instructions: np.ndarray) -> Row:
    """Median, 99th percentile and worst, in instructions and in ideal steps."""
    ideal = IDEAL[target.name]
    parts = {"median": np.median(instructions), "p99": np.quantile(instructions, 0.99), "worst": instructions.max()}
    row: Row = {"processor": target.name, **about, "steps_counted": len(instructions)}
    row |= {f"{name}_instructions": round(float(value)) for name, value in parts.items()}
    return row | {f"{name}_ideal": round(float(value) / ideal, 1) for name, value in parts.items()}
