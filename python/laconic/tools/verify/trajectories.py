"""The core against reference trajectories: cases of a vehicle, segments with held inputs, states at their ends.

Results of `laconic verify --enclose`: errors that are proved bounds, with the enclosure's width beside them.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.core.plant import Plant
from laconic.errors import BadInput, Refused, reason_of, shown
from laconic.scene import MOST_STEPS
from laconic.scene.table import Table

ARTICULATED = "articulated-1"  # of a file with vehicles on hinges


@dataclass(frozen=True)
class CaseResult:
    """Result of one case; errors are relative to max(1, largest reference value of the kind), None when refused."""

    name: str
    status: str
    error_nu: float | None = None
    error_pose: float | None = None
    error_wheel: float | None = None
    seconds: float = 0.0

    @property
    def worst(self) -> float:
        """The largest of the three errors; infinite when the case was refused."""
        return worst_of(self.status, (self.error_nu, self.error_pose, self.error_wheel))


def worst_of(status: str, errors: Iterable[float | None]) -> float:
    """The largest of a case's errors that are known; infinite when the case was refused."""
    return math.inf if status != "ok" else max(each for each in errors if each is not None)


def read_reference(path: Path) -> list[Table]:
    """The cases of a reference file."""
    try:
        content = json.loads(path.read_bytes())
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); give a reference file") from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        where = f" in line {error.lineno}" if isinstance(error, json.JSONDecodeError) else " in UTF-8"
        raise BadInput(f"{path}: is no valid JSON{where}; give a reference file") from None
    except (ValueError, RecursionError):
        raise BadInput(f"{path}: is no valid JSON: it nests its lists too deeply, or holds a number of thousands of "
                       "digits; give a reference file") from None
    if isinstance(content, list) and content:  # of vehicles with hinges on ground with friction
        content = {"format": 1, "cases": content}
    if not isinstance(content, dict):
        raise BadInput(f"{path}: contains no object with cases; give a reference file")
    top = Table(path, "", content)
    if top.peek("format") == ARTICULATED:
        top.has("format")
    elif top.whole("format") != 1:
        top.fail("format", f'is {top.whole("format")}; this program reads format 1 and "{ARTICULATED}"')
    cases = list(top.tables("cases"))
    if not cases:
        top.fail("cases", "holds none, so there is nothing to compare; give at least one")
    return cases


def is_articulated(case: Table) -> bool:
    """Whether a case is of a file with vehicles on hinges, which name their bodies."""
    vehicle = case.peek("vehicle")
    return isinstance(vehicle, dict) and "bodies" in vehicle


def vehicle_of(case: Table) -> dict[str, Any]:
    """The case's vehicle with the keys of a scene: S lies at `offset` on the +η axis from Q."""
    table = case.table("vehicle", required=True)
    wheels, locked = list(table.tables("wheels")), table.numbers("locked") if table.has("locked") else ()
    if not set(locked) <= set(range(len(wheels))):
        table.fail("locked", f"names wheels that are not there; the first is 0, the last {len(wheels) - 1}")
    keys = {"M": "mass_kg", "I_S": "yaw_inertia_kgm2", "R": "wheel_radius_m", "J": "wheel_inertia_kgm2",
            "offset": "com_y_m", "c1": "motor_gain_Nm_per_V", "c2": "motor_damping_Nms"}
    vehicle: dict[str, Any] = {name: table.number(key) for key, name in keys.items()}
    vehicle["wheel"] = [wheel_of(each, number in locked) for number, each in enumerate(wheels)]
    return vehicle


def wheel_of(table: Table, locked: bool) -> dict[str, Any]:
    """A wheel with polar position from Q, axle β and roller γ."""
    kind = table.choice("kind", ("roller", "fixed"))
    delta, alpha = table.number("delta"), table.number("alpha")
    wheel = {"kind": kind, "locked": locked, "x_m": delta * math.cos(alpha), "y_m": delta * math.sin(alpha),
             "axle_rad": table.number("beta")}
    return wheel | ({"roller_rad": table.number("gamma")} if kind == "roller" else {})


def held_of(segment: Table, wheel_count: int) -> dict[str, Any]:
    """Inputs of a segment, by the names of laconic_input."""
    held: dict[str, Any] = {}
    if segment.has("U"):
        held["voltage_V"] = segment.numbers("U", wheel_count)
    if segment.has("body_wrench"):
        *held["body_force_N"], held["body_moment_Nm"] = segment.numbers("body_wrench", 3)
    if segment.has("world_force"):
        held["world_force_N"], held["world_force_point_m"] = segment.numbers("world_force", 2), (0.0, 0.0)
    if segment.has("point"):
        held["world_force_point_m"] = segment.numbers("point", 2)
    return held


def step_that_fits(duration_s: float, step_s: float) -> tuple[int, float]:
    """The number of steps in a segment, and the step: shortened, where necessary, to divide the segment."""
    nearest = max(1, round(duration_s / step_s))
    fits = abs(nearest * step_s - duration_s) <= 1e-6 * step_s
    steps = nearest if fits else math.ceil(duration_s / step_s)
    return steps, step_s if fits else duration_s / steps


def steps_of(segment: Table, step_s: float) -> tuple[int, float]:
    """The number of steps in a segment, and the step; fails where they cannot be counted."""
    duration_s = segment.number("duration")
    if not 0.0 < duration_s < MOST_STEPS * step_s:
        segment.fail("duration", f"{duration_s:g} s takes no number of steps of {step_s:g} s; give a time above zero "
                     "that can be counted in them")
    return step_that_fits(duration_s, step_s)


def start_case(core: Core, case: Table, method: str, step_s: float) -> Plant:
    """The case's vehicle at its start."""
    initial = case.table("initial", required=True)
    x_m, y_m, heading_rad = initial.numbers("pose", 3)
    return core.plant(core.vehicle(vehicle_of(case)), method, step_s, nu_rad_per_s=initial.numbers("nu", 3),
                      x_m=x_m, y_m=y_m, heading_rad=heading_rad)


def follow(plant: Plant, case: Table, step_s: float, advance: Callable[[], None]) -> tuple[list[np.ndarray], float]:
    """States (ν, pose, χ in one row) at the segments' ends, and the seconds the core took."""
    states, seconds = [], 0.0
    segments = list(case.tables("segments"))
    if not segments:
        case.fail("segments", "holds none; give at least one")
    for segment in segments:
        held = plant.input_of(held_of(segment, plant.wheel_count))
        steps, fitting = steps_of(segment, step_s)
        began = time.perf_counter()
        plant.set_step(fitting)
        plant.run(held, steps)
        seconds += time.perf_counter() - began
        pose = plant.pose
        states.append(np.concatenate([plant.nu, [pose.x_m, pose.y_m, pose.heading_rad], plant.wheel_angles()]))
        advance()
    return states, seconds


def expected_states(case: Table) -> np.ndarray:
    """The reference's states, one row a segment's end."""
    rows = []
    for state in case.tables("states"):
        rows.append([decimal(state, key, text) for key in ("nu", "pose", "chi") for text in state.texts(key)])
    if len({len(row) for row in rows}) > 1:
        case.fail("states", "have rows of different length; give every state all components")
    return np.array(rows)


def decimal(state: Table, key: str, text: str) -> float:
    """A number written as text, with more digits than a double holds."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        state.fail(key, f"holds {shown(text)}; give finite decimal numbers")
    return value


def error_of(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest error over states and components, relative to max(1, largest reference value); 0 for no components."""
    if not expected.size:
        return 0.0
    return float(np.max(np.abs(found - expected)) / max(1.0, float(np.max(np.abs(expected)))))


def verify_case(core: Core, case: Table, method: str, step_s: float, advance: Callable[[], None]) -> CaseResult:
    """Runs one case and compares; a refusal of the core becomes the status."""
    name = case.text("name")
    try:
        plant = start_case(core, case, method, step_s)
        states, seconds = follow(plant, case, step_s, advance)
    except Refused as refused:
        return CaseResult(name, f"{refused.status}: {refused}")
    found, expected = np.array(states, dtype=float), expected_states(case)
    if found.shape != expected.shape:
        case.fail("states", f"have shape {expected.shape}, the segments and wheels need {found.shape}")
    nu, pose, wheels = (error_of(found[:, part], expected[:, part])
                        for part in (slice(0, 3), slice(3, 6), slice(6, None)))
    return CaseResult(name, "ok", nu, pose, wheels, seconds)


def as_json(results: Sequence[Any], method: str, step_s: float, real: str) -> dict[str, Any]:
    """All results for JSON."""
    return {"method": method, "step_s": step_s, "real": real, "cases": [asdict(each) for each in results]}


ROUNDED_UP = 1.05  # so that the second digit is one higher


@dataclass(frozen=True)
class EnclosedResult(CaseResult):
    """One case; all numbers are bounds, relative to max(1, largest proved size of the kind).

    `inside`: the core's numbers lie inside the enclosure at all rows; `own_constants`: the same errors to the motion by
    the constants that the core prepared, where it was enclosed.
    """

    width_nu: float = 0.0
    width_pose: float = 0.0
    width_wheel: float = 0.0
    inside: bool = False
    own_constants: dict[str, float | bool | None] | None = None

    @property
    def width(self) -> float:
        """The largest of the three widths."""
        return max(self.width_nu, self.width_pose, self.width_wheel)


def bound_text(number: float) -> str:
    """A bound in two digits, not below what it is."""
    text = f"{number:.1e}"
    return text if float(text) >= number else f"{number * ROUNDED_UP:.1e}"
