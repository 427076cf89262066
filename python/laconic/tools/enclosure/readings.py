"""The two readings of a scene: the numbers as they stand in its file, and the constants that the core made of them.

The equation with the constants that the core made of a vehicle, each taken exactly: the second reading of a scene.

The distance of the core's result to this motion is what its steps alone cost; to that of the file's numbers it is what
they and the rounded preparation cost.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

from flint import arb

from laconic.errors import BadInput, reason_of
from laconic.scene import Scene
from laconic.scene.ground import slips
from laconic.scene.hinges import check_without_hinges
from laconic.scene.inputs import as_written
from laconic.scene.keys import MOTOR_CIRCUITS
from laconic.scene.table import entries_of
from laconic.tools.enclosure.balls import Vector, ball, times
from laconic.tools.enclosure.equation import Equation, Stretch, angle, equation_of
from laconic.tools.enclosure.motion import Motion
from laconic.tools.enclosure.state import Beginning


def exact(numbers: Any) -> Vector:
    """Numbers of C as exact balls."""
    return [arb(float(x)) for x in numbers]


def prepared_equation(model: Any) -> Equation:
    """The equation of a laconic_model."""
    own, wheels = getattr(model, "rotated_twice", False), range(model.wheel_count)
    columns = zip(*(exact(row) for row in model.nu_of_zeta), strict=True)
    back = ([exact(row) for row in model.zeta_of_nu] if own else
            [[inertia * x for x in column] for inertia, column in zip(exact(model.inertia), columns, strict=True)])
    decay, sloped = exact(model.decay_per_s), getattr(model, "sloped", False)
    nu = [exact(row) for row in model.nu_of_zeta]
    return Equation(
        freedoms=model.dof, spin=nu[2], gyro=exact(model.gyro),
        damping=[[decay[i] if i == j else arb(0) for j in range(3)] for i in range(3)], nu_of_zeta=nu, zeta_of_nu=back,
        velocity_of_zeta=[exact(row) for row in model.velocity_of_zeta],
        yaw_rate_of_zeta=exact(model.yaw_rate_of_zeta),
        wheel_of_zeta=[exact(model.wheel_of_zeta[i]) for i in wheels], torque_scale=arb(model.torque_scale),
        voltage_scale=[arb(model.voltage_scale[i]) for i in wheels], wheel_radius_m=arb(model.wheel_radius_m),
        yaw_scale=arb(model.yaw_scale),
        slope_force_N=exact(model.slope_force_N) if sloped else [arb(0), arb(0)])


Entries = Mapping[str, Any]
MakeMotion = Callable[[int], Motion]


@dataclass(frozen=True)
class Reading:
    """One reading: `motion(goal_bits)` makes its motion, in the precision in use; times are exact."""

    motion: MakeMotion
    stretches: Sequence[Stretch]
    step_s: Fraction = Fraction(1)

    def instants(self, ticks: Sequence[int]) -> list[Fraction]:
        """The times at which some steps begin."""
        return [tick * self.step_s for tick in ticks]


def check_enclosable(scene: Scene) -> None:
    """BadInput, by the key, for what has no smooth right-hand side or no held inputs, and for hinges."""
    check_without_hinges(scene, "an enclosure")
    vehicle = scene.vehicle
    switches = [f"vehicle.wheel[{i}].motor_circuit" for i, wheel in enumerate(vehicle["wheel"], start=1)
                if wheel.get("motor_circuit")]
    if vehicle["wheel"] and slips(vehicle):
        raise BadInput(f"{scene.path}: ground.friction_coefficient: wheels stick and slip, which cannot be enclosed; "
                       "take [ground] friction out for ideal ground")
    if vehicle["wheel"] and "drive" in vehicle:
        raise BadInput(f"{scene.path}: vehicle.drive: limits switch on and off, which cannot be enclosed; take "
                       "[vehicle.drive] out")
    if switches:
        raise BadInput(f"{scene.path}: {switches[0]}: such a motor switches, which cannot be enclosed; take it out for "
                       f'"{next(iter(MOTOR_CIRCUITS))}"')
    for each in scene.inputs:
        if each.kind != "steps":
            raise BadInput(f"{scene.path}: {each.location}.kind: a {each.kind} changes within the steps, which cannot "
                           'be enclosed; give kind = "steps"')


def entries_as_written(path: Path) -> dict[str, Any]:
    """The tables of a scene file with its decimal numbers as they are written."""
    try:
        return entries_of(path.read_text(encoding="utf-8-sig"), Decimal)
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); an enclosure needs the scene's file") from None


def given_or(written: Any, used: float) -> Fraction:
    """A number of the file, or the one that is used instead of it, as for `"auto"`."""
    return Fraction(written) if written != "auto" and float(written) == used else as_written(used)


def reading_of_file(scene: Scene) -> Reading:
    """Every number of the file as the decimal that stands there."""
    entries = entries_as_written(scene.path)
    run = entries["run"]
    step_s = given_or(run["step_s"], scene.run.step_s)

    def motion(goal_bits: int) -> Motion:
        equation = equation_of(entries["vehicle"], entries.get("ground"))
        start = entries.get("initial", {})
        zeta = times(equation.zeta_of_nu, start_nu(start, equation.wheel_radius_m, equation.yaw_scale))
        return Motion(equation, beginning(zeta, start), goal_bits)

    return Reading(motion, stretches_of(entries.get("input", ()), step_s * scene.steps()), step_s)


def start_nu(start: Entries, wheel_radius_m: Any, yaw_scale: Any) -> list[Any]:
    """ν of `[initial]`: given, or from velocity and yaw rate."""
    if "nu_rad_per_s" in start:
        return [ball(x) for x in start["nu_rad_per_s"]]
    velocity = [ball(x) / wheel_radius_m for x in start.get("velocity_body_m_per_s", (0, 0))]
    return [*velocity, yaw_scale * ball(start.get("yaw_rate_rad_per_s", 0))]


def beginning(zeta: list[Any], start: Entries) -> Beginning:
    """With the pose of `[initial]`, its heading in rad or degrees."""
    return Beginning(zeta, [ball(start.get("x_m", 0)), ball(start.get("y_m", 0))], angle(start, "heading", ball(0)))


def stretches_of(inputs: Sequence[Entries], end_s: Fraction) -> list[Stretch]:
    """Stretches between the instants of all inputs, up to the run's end; inputs of one signal add up."""
    instants = {Fraction(t) for each in inputs for t in each["t_s"]}
    cuts = sorted({Fraction(0), end_s} | {t for t in instants if t < end_s})
    return [Stretch(begin, end, held_at(inputs, begin)) for begin, end in pairwise(cuts)]


def held_at(inputs: Sequence[Entries], time_s: Fraction) -> dict[str, Fraction]:
    """What each signal holds from an instant on."""
    held: dict[str, Fraction] = {}
    for each in inputs:
        passed = [Fraction(v) for t, v in zip(each["t_s"], each["value"], strict=True) if Fraction(t) <= time_s]
        held[each["signal"]] = held.get(each["signal"], Fraction(0)) + (passed[-1] if passed else 0)
    return held


def reading_of_core(scene: Scene) -> Reading:
    """The core's prepared constants, start, inputs and step, each exactly the number that the core has."""
    core = scene.core()
    model, number = scene.model(core), (float if scene.run.real == "double" else as_single)
    step_s = Fraction(number(scene.run.step_s))

    def motion(goal_bits: int) -> Motion:
        equation, start = prepared_equation(model), scene.initial
        zeta = times(equation.zeta_of_nu, [ball(number(x)) for x in start.nu(model)])
        pose = {key: number(getattr(start, key)) for key in ("x_m", "y_m", "heading_rad")}
        return Motion(equation, beginning(zeta, pose), goal_bits)

    segments = scene.inputs_on_grid().segments()
    return Reading(motion, [
        Stretch(each.first_step * step_s, (each.first_step + each.steps) * step_s,
                {name: number(value) for name, value in each.values.items()}) for each in segments], step_s)


def as_single(number: float) -> float:
    """The nearest number of 32 bits."""
    return float(struct.unpack("f", struct.pack("f", number))[0])
