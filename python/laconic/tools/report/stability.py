"""Stiffness: one vehicle with ever stronger motors, over steps from milliseconds to a tenth of a second and more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from laconic.core import load
from laconic.errors import Refused
from laconic.scene import METHODS, Scene
from laconic.scene.inputs import Input
from laconic.tools.report.accuracy import follow, relative
from laconic.tools.report.referenced import exact_states, stiff_states
from laconic.tools.verify.reference import Reference, totals_of

SEGMENT_S, SEGMENTS = 0.25, 4
STEPS_S = tuple(SEGMENT_S / n for n in (250, 160, 100, 64, 40, 25, 16, 10, 6, 4, 2, 1))
FACTORS = tuple(float(f) for f in 10.0 ** np.arange(-1.0, 6.01, 0.5))
PATTERN, SIGNS = (6.0, -2.0, 4.0, 1.0), (1.0, -0.7, 0.5, -1.0)
FINER = 32
STIFF_STEPS_S, STIFF_FACTORS = (1e-3, 5e-3, 0.02, 0.1), (1e3, 1e6)
SINE_HZ, STIFF_S = 0.5, 3.0
OWN = {"inertia_kgm2", "motor_gain_Nm_per_V", "motor_damping_Nms"}  # of a wheel, what the motors bring


def strengthened(scene: Scene, factor: float, inputs: Sequence[Input], duration_s: float) -> Scene:
    """Motor gain and damping times a factor (the same speeds, reached sooner), with other inputs, from rest."""
    totals = totals_of(scene.vehicle)
    vehicle = {k: v for k, v in scene.vehicle.items() if k != "motor"}
    vehicle |= {"motor_gain_Nm_per_V": factor * totals.motor_gain_Nm_per_V,
                "motor_damping_Nms": factor * totals.motor_damping_Nms,
                "wheel_inertia_kgm2": totals.wheel_inertia_kgm2}
    if any(OWN & wheel.keys() or not wheel["driven"] for wheel in vehicle["wheel"]):
        own = zip(vehicle["wheel"], totals.inertias_kgm2, factor * totals.gains_Nm_per_V,
                  factor * totals.dampings_Nms, strict=True)
        vehicle["wheel"] = [wheel | {"inertia_kgm2": inertia, "motor_gain_Nm_per_V": gain, "motor_damping_Nms": damping}
                            for wheel, inertia, gain, damping in own]
    return replace(scene, vehicle=vehicle, inputs=tuple(inputs)).with_run(duration_s=duration_s)


def four_steps(wheels: int) -> list[Input]:
    """Four voltage steps of a quarter second."""
    times = tuple(k * SEGMENT_S for k in range(SEGMENTS))
    return [Input(f"voltage_V[{i + 1}]", "steps", f"input[{i + 1}]", times, tuple(PATTERN[i % 4] * s for s in SIGNS))
            for i in range(wheels)]


def constant(wheels: int) -> list[Input]:
    """Constant voltages."""
    return [Input(f"voltage_V[{i + 1}]", "steps", f"input[{i + 1}]", (0.0,), (PATTERN[i % 4],)) for i in range(wheels)]


def sinusoids(wheels: int) -> list[Input]:
    """Half a hertz, each wheel with its own phase."""
    return [Input(f"voltage_V[{i + 1}]", "sine", f"input[{i + 1}]", amplitude=PATTERN[i % 4], frequency_Hz=SINE_HZ,
                  phase_rad=0.7 * i) for i in range(wheels)]


def map_rows(scene: Scene, methods: Sequence[str] = METHODS, factors: Sequence[float] = FACTORS,
             advance: Any = lambda: None) -> list[dict[str, Any]]:
    """Error of ν at the four segments' ends, for each method, step and strength."""
    rows, ends = [], SEGMENT_S * np.arange(1, SEGMENTS + 1)
    for factor in factors:
        strong = strengthened(scene, factor, four_steps(scene.wheel_count), SEGMENT_S * SEGMENTS)
        expected = map_truth(strong)
        rate = Reference(strong.vehicle).fastest_decay_per_s()
        for method in methods:
            for step_s in STEPS_S:
                row = {"scene": scene.path.stem, "method": method, "factor": factor, "fastest_decay_per_s": rate,
                       "step_s": step_s}
                rows.append(row | _map_run(strong.with_run(method=method, step_s=step_s), ends, expected))
        advance()
    return rows


def map_truth(scene: Scene) -> np.ndarray:
    """The states at the four segments' ends, in 50 digits."""
    volts = [[PATTERN[i % 4] * sign for i in range(scene.wheel_count)] for sign in SIGNS[:SEGMENTS]]
    nu = scene.plant(load("double")).nu
    return exact_states(scene.vehicle, nu.tolist(), volts, [[k * Fraction(SEGMENT_S)] for k in range(1, SEGMENTS + 1)])


def friction_map_rows(scene: Scene, factors: Sequence[float] = FACTORS, advance: Any = lambda: None
                      ) -> list[dict[str, Any]]:
    """The same of the friction step, beside itself in steps FINER times as fine as the finest; `reference_error_nu`:
    what these are off by, as twice their length tells."""
    rows, ends = [], SEGMENT_S * np.arange(1, SEGMENTS + 1)
    for factor in factors:
        strong = strengthened(scene, factor, four_steps(scene.wheel_count), SEGMENT_S * SEGMENTS)
        row = {"scene": scene.path.stem, "method": "friction step", "factor": factor,
               "fastest_decay_per_s": Reference(strong.vehicle).fastest_decay_per_s()}
        try:
            expected, coarser = (follow(strong.with_run(method="auto", step_s=STEPS_S[0] / finer), "double", ends)
                                 for finer in (FINER, FINER // 2))
        except Refused as refused:
            rows += [row | {"step_s": step_s, "status": f"no reference: {refused.status}"} for step_s in STEPS_S]
            advance()
            continue
        row["reference_error_nu"] = relative(coarser[:, :3], expected[:, :3])
        for step_s in STEPS_S:
            rows.append(row | {"step_s": step_s} | _map_run(strong.with_run(method="auto", step_s=step_s), ends,
                                                           expected))
        advance()
    return rows


def _map_run(scene: Scene, ends: np.ndarray, expected: np.ndarray) -> dict[str, Any]:
    try:
        states = follow(scene, "double", ends)
    except Refused as refused:
        return {"status": refused.status}
    return {"status": "ok", "error_nu": relative(states[:, :3], expected[:, :3])}


def path_error(found: np.ndarray, expected: np.ndarray) -> float:
    """Error of the position at the end over the length of the path so far (chords between the instants)."""
    legs = np.diff(np.vstack([np.zeros(2), expected[:, 3:5]]), axis=0)
    length = float(np.sum(np.hypot(legs[:, 0], legs[:, 1])))
    return float(np.hypot(*(found[-1, 3:5] - expected[-1, 3:5]))) / length


def stiff_rows(scenes: Sequence[Scene], factors: Sequence[float] = STIFF_FACTORS,
               advance: Any = lambda: None) -> list[dict[str, Any]]:
    """auto on very stiff vehicles, with constant voltages and with sinusoids sampled inside the step."""
    rows = []
    for scene in scenes:
        for factor in factors:
            for name, inputs in (("constant", constant), ("sine 0.5 Hz", sinusoids)):
                strong = strengthened(scene, factor, inputs(scene.wheel_count), STIFF_S).with_run(method="auto")
                at_s = np.linspace(0.0, STIFF_S, 16)[1:]
                expected = stiff_states(strong.with_run(step_s=0.1), at_s)
                rows += [_stiff_run(strong.with_run(step_s=h), name, factor, at_s, expected) for h in STIFF_STEPS_S]
                advance()
    return rows


def _stiff_run(scene: Scene, inputs_name: str, factor: float, at_s: np.ndarray, expected: np.ndarray) -> dict[str, Any]:
    row = {"scene": Path(scene.path).stem, "factor": factor, "inputs": inputs_name, "step_s": scene.run.step_s}
    try:
        states = follow(scene, "double", at_s)
    except Refused as refused:
        return row | {"status": refused.status}
    nu = float(np.max(np.abs(states[-1, :3] - expected[-1, :3])) / np.max(np.abs(expected[-1, :3])))
    return row | {"status": "ok", "error_nu": nu, "error_path": path_error(states, expected)}
