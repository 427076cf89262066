"""Cases of a reference file: their motion enclosed, whether the file's digits lie inside, how far the core is off."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, arb_mat

from laconic.core import Core
from laconic.errors import Refused
from laconic.scene.table import Table
from laconic.tools.enclosure.balls import Vector, ball, times, widened
from laconic.tools.enclosure.equation import Equation, Stretch, equation_of, padded
from laconic.tools.enclosure.motion import Motion
from laconic.tools.enclosure.readings import Reading
from laconic.tools.enclosure.state import Beginning, Sample
from laconic.tools.enclosure.study import Enclosed, enclose, kinds_json
from laconic.tools.verify.trajectories import EnclosedResult, follow, held_of, start_case

KEYS = {"M": "mass_kg", "I_S": "yaw_inertia_kgm2", "R": "wheel_radius_m", "J": "wheel_inertia_kgm2",
        "offset": "com_y_m", "c1": "motor_gain_Nm_per_V", "c2": "motor_damping_Nms"}

LEFT_OUT = Decimal("1e-36")  # they stop at terms of 1e-38


@dataclass(frozen=True)
class EnclosedCase:
    """One case; `outside`: the states of the file that are proved not to be the motion's, empty where all may be."""

    name: str
    enclosed: Enclosed
    outside: tuple[str, ...]


def vehicle_as_written(case: Table) -> dict[str, Any]:
    """The case's vehicle with the keys of a scene, each number the double that the file gives: places stay polar, so
    that no rounded sine comes in."""
    table = case.table("vehicle", required=True)
    locked = table.numbers("locked") if table.has("locked") else ()
    vehicle: dict[str, Any] = {name: table.number(key) for key, name in KEYS.items()}
    vehicle["wheel"] = [wheel_as_written(each, number in locked) for number, each in enumerate(table.tables("wheels"))]
    return vehicle


def wheel_as_written(table: Table, locked: bool) -> dict[str, Any]:
    """One wheel."""
    kind = table.choice("kind", ("roller", "fixed"))
    wheel = {"kind": kind, "locked": locked, "distance_m": table.number("delta"), "bearing_rad": table.number("alpha"),
             "axle_rad": table.number("beta")}
    return wheel | ({"roller_rad": table.number("gamma")} if kind == "roller" else {})


def stretches_of(case: Table) -> list[Stretch]:
    """The segments, one after the other."""
    found: list[Stretch] = []
    count = len(list(case.table("vehicle").tables("wheels")))
    for segment in case.tables("segments"):
        begin_s = found[-1].end_s if found else Fraction(0)
        found.append(Stretch(begin_s, begin_s + Fraction(segment.number("duration")), signals_of(segment, count)))
    return found


def signals_of(segment: Table, wheel_count: int) -> dict[str, float]:
    """The held inputs of a segment by the names of signals."""
    found: dict[str, float] = {}
    for name, values in held_of(segment, wheel_count).items():
        if isinstance(values, Sequence):
            found |= {f"{name}[{i}]": value for i, value in enumerate(values, start=1)}
        else:
            found[name] = values
    return found


def reading_of_case(case: Table, altered: Callable[[Equation], Equation] = lambda equation: equation) -> Reading:
    """The case as a motion; `altered` puts faults into its equation, for trials of the check itself."""
    initial = case.table("initial", required=True)
    vehicle, pose, nu = vehicle_as_written(case), initial.numbers("pose", 3), initial.numbers("nu", 3)
    given = [int(i) - 1 for i in case.numbers("independent")] if case.has("independent") else []

    def motion(goal_bits: int) -> Motion:
        equation = altered(equation_of(vehicle))
        zeta = start_zeta(equation, [ball(x) for x in nu], given)
        return Motion(equation, Beginning(zeta, [ball(pose[0]), ball(pose[1])], ball(pose[2])), goal_bits)

    return Reading(motion, stretches_of(case))


def start_zeta(equation: Equation, nu: Vector, given: Sequence[int]) -> Vector:
    """ζ with the components of ν that the case gives independently; the others follow from the constraints, which
    doubles meet to rounding alone. Without such a list it is the projection of ν."""
    if len(given) != equation.freedoms:
        return times(equation.zeta_of_nu, nu)
    rows = arb_mat([equation.nu_of_zeta[i][:equation.freedoms] for i in given])
    return padded(list(rows.solve(arb_mat([[nu[i]] for i in given])).entries()))


def digits_in_file(case: Table) -> list[list[arb]]:
    """The file's states as balls of one unit of the last digit that it gives."""
    return [[last_digit_ball(text) for key in ("nu", "pose", "chi") for text in state.texts(key)]
            for state in case.tables("states")]


def last_digit_ball(text: str) -> arb:
    """A decimal, give or take one of its last digit, or what the references' own arithmetic left out."""
    number = Decimal(text)
    return widened(ball(number), ball(max(LEFT_OUT, Decimal(1).scaleb(int(number.as_tuple().exponent)))))


def names_of(wheel_count: int) -> list[str]:
    """ν, pose and wheel angles as the file names them."""
    return [*(f"nu[{i}]" for i in (1, 2, 3)), "x", "y", "theta", *(f"chi[{i}]" for i in range(1, wheel_count + 1))]


def enclose_case(case: Table, found: np.ndarray | None, shown: bool = False,
                 reading: Reading | None = None) -> EnclosedCase:
    """A case enclosed at its segments' ends, beside the core's states there."""
    reading = reading or reading_of_case(case)
    outside: dict[int, list[str]] = {}

    def compare(number: int, sample: Sample) -> None:
        row, given = sample.row(), digits_in_file(case)[number]
        if len(row) != len(given):
            case.fail("states", f"have {len(given)} numbers, the vehicle has {len(row)}")
        each = zip(names_of(len(row) - 6), row, given, strict=True)
        outside[number] = [f"{name} at state {number + 1}" for name, state, digits in each
                           if not state.overlaps(digits)]

    name = case.text("name")
    enclosed = enclose(reading, [each.end_s for each in reading.stretches], found, name, shown, compare)
    return EnclosedCase(name, enclosed, tuple(name for number in sorted(outside) for name in outside[number]))


def verify_enclosed_case(core: Core, case: Table, method: str, step_s: float,
                         advance: Callable[[], None]) -> EnclosedResult:
    """Runs and encloses one case; a refusal of the core, or states of the file outside, become the status."""
    name = case.text("name")
    try:
        states, seconds = follow(start_case(core, case, method, step_s), case, step_s, advance)
    except Refused as refused:
        return EnclosedResult(name, f"{refused.status}: {refused}")
    if len(list(case.tables("states"))) != len(states):
        case.fail("states", f"has {len(list(case.tables('states')))} entries, the segments need {len(states)}")
    found = enclose_case(case, np.array(states, dtype=float))
    wrong = f"{found.outside[0]} of the file lies outside the enclosure" if found.outside else "ok"
    return EnclosedResult(name, wrong, seconds=seconds, **kinds_json(found.enclosed))
