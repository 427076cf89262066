"""Inputs and outputs of vehicles with hinges by name, and what of the inputs contradicts or would do nothing.

A signal of a hinge or body has its name in brackets: `hinge_angle_rad[front]`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.inputs import no_such_wheel
from laconic.errors import nearest_of, shown
from laconic.scene.ground import slips
from laconic.scene.hinges import Hinge
from laconic.scene.signals import FRICTION_PER_WHEEL, LENGTHS, PER_WHEEL, SUPPORT_LOAD
from laconic.scene.table import Table

if TYPE_CHECKING:
    from laconic.scene.inputs import Input

TWIST, CURVATURE, ANGLE, RATE = ("steering_twist", "steering_curvature_per_m", "steering_angle_rad",
                                 "steering_rate_rad_per_s")
VOLTAGE, TORQUE = "hinge_voltage_V", "hinge_torque_Nm"

HINGE_INPUTS = {
    VOLTAGE: ("[name]", "Voltage of the motor of a hinge", 'a hinge that is "motor"'),
    TORQUE: ("[name]", "Torque on the body of a hinge, the opposite on its parent, besides motor, spring and damping",
             'a hinge that is "free" or "motor"'),
    RATE: ("[name]", "Rate of a prescribed hinge", 'a hinge that is "prescribed"'),
    ANGLE: ("[name]", "Angle that a hinge is to have, followed within its `rate_limit_rad_per_s`; without a name that "
            "of a wheel on the middle line in the place of the coordinated wheels", 'a hinge that is "prescribed" or '
            '"coordinated"'),
    CURVATURE: ("", "Curvature of the path to the left: of the middle of the fixed axle, or of the body frame's "
                "origin where there is none", 'hinges that are "coordinated"'),
    TWIST: ("[1|2|3]", "Motion along which all coordinated wheels point: velocity of the body frame's origin and yaw "
            "rate, of which only the proportion counts", 'hinges that are "coordinated"')}
"""Inputs of hinges: their items, their words, and what they need."""

PLAIN_OUTPUTS = ("x_m", "y_m", "heading_rad", "heading_wrapped_rad", "origin_x_m", "origin_y_m", "yaw_rate_rad_per_s",
                 "no_slip_margin_N", "energy_J")
PAIRS = ("velocity_body_m_per_s", "acceleration_body_m_per_s2")
WHEEL_OUTPUTS = ("wheel_speed_rad_per_s", "wheel_angle_rad", "wheel_torque_Nm", "wheel_reaction_N", "wheel_lateral_N")
HINGE_OUTPUTS = {
    "hinge_angle_rad": "Angle of a hinge: of the body against its parent, unwrapped",
    "hinge_rate_rad_per_s": "Rate of that angle",
    "hinge_reaction_Nm": "Torque of a hinge on its body: motor, spring, damping and input, or what a commanded rate "
                         "takes",
    "hinge_force_along_N": "Force of the parent on a body at its hinge, along the body's first axis",
    "hinge_force_across_N": "Force of the parent on a body at its hinge, to the body's left",
    "body_x_m": "Place of a body's hinge in the world", "body_y_m": "Place of a body's hinge in the world",
    "body_heading_rad": "Direction of a body in the world, in (−π, π]"}
"""Outputs of each hinge, with its name."""
OF_GROUND = ("scrub_torque_Nm", "wheel_load_N")
"""Outputs of each wheel where wheels may slip on hinges, besides those of FRICTION_PER_WHEEL."""
SLIPPING_ALONE = {
    "scrub_torque_Nm": ("[i]", "Torque of the ground on a wheel about the vertical"),
    "servo_work_J": ("", "Work of servos and prescribed hinges since the start"),
    "scrub_loss_J": ("", "Loss by scrub since the start"), "hinge_loss_J": ("", "Loss in hinges since the start"),
    "stop_loss_J": ("", "Loss at stops since the start"),
    "spring_energy_J": ("", "Energy in the springs of hinges")}
"""Outputs that only vehicles have whose wheels slip on hinges."""
SLIPPING_OUTPUTS = {
    "hinge_friction_Nm": "Torque of dry friction on the body of a hinge", "hinge_stop_Nm": "Torque of its stops",
    "hinge_current_A": "Current of the motor of a hinge",
    "hinge_drive_limit": "What limits the motor of a hinge: 0 nothing, 1 the voltage, 2 the current"}
"""Outputs of each hinge where wheels may slip."""
NOT_SLIPPING = ("no_slip_margin_N", "acceleration_body_m_per_s2", "hinge_force_along_N", "hinge_force_across_N")
"""Outputs of ideal ground alone."""
BOOK = ("supply_energy_J", "outer_work_J", "servo_work_J", "slip_loss_J", "scrub_loss_J", "axle_loss_J",
        "hinge_loss_J", "stop_loss_J", "motor_loss_J", "supply_loss_J", "numerical_loss_J", "spring_energy_J")
"""What came and went since the start, where wheels may slip; the last is stored."""
OF_SUPPLY = ("supply_current_A", "supply_voltage_V")


def input_signals(vehicle: Mapping[str, Any], hinges: Sequence[Hinge]) -> dict[str, tuple[str, ...]]:
    """Every input of a vehicle with hinges: the signals of each name."""
    found = {name: tuple(f"{name}[{i}]" for i in range(1, len(vehicle["wheel"]) + 1)) for name in PER_WHEEL}
    found |= {name: tuple(f"{name}[{i}]" for i in range(1, n + 1)) if n else (name,) for name, n in LENGTHS.items()}
    for name, kinds in ((VOLTAGE, ("motor",)), (TORQUE, ("free", "motor")), (RATE, ("prescribed",)),
                        (ANGLE, ("prescribed",))):
        found[name] = tuple(f"{name}[{hinge.name}]" for hinge in hinges if hinge.kind in kinds)
    for hinge in hinges:
        if hinge.follows and hinge.kind != "coordinated":
            name = ANGLE if hinge.follows == "angle" else RATE
            found[name] = (*found[name], f"{name}[{hinge.name}]")
        if hinge.kind == "servo":
            found[TORQUE] = (*found[TORQUE], f"{TORQUE}[{hinge.name}]")
    if any(hinge.kind == "coordinated" for hinge in hinges):
        found |= {TWIST: tuple(f"{TWIST}[{i}]" for i in (1, 2, 3)), CURVATURE: (CURVATURE,),
                  ANGLE: (ANGLE, *found[ANGLE])}
    return found


def output_signals_of(vehicle: Mapping[str, Any], hinges: Sequence[Hinge]) -> dict[str, tuple[str, ...]]:
    """Every output of a vehicle with hinges."""
    found = {name: tuple(f"{name}[{i}]" for i in (1, 2)) for name in PAIRS}
    found |= {name: (name,) for name in PLAIN_OUTPUTS if name != "no_slip_margin_N" or vehicle["friction_coefficient"]}
    slipping, wheels = slips(vehicle), range(1, len(vehicle["wheel"]) + 1)
    of_hinges = (*HINGE_OUTPUTS, *(SLIPPING_OUTPUTS if slipping else ()))
    of_wheels = (*WHEEL_OUTPUTS, *((*FRICTION_PER_WHEEL, *OF_GROUND) if slipping else ()))
    found |= {name: tuple(f"{name}[{hinge.name}]" for hinge in hinges) for name in of_hinges}
    found |= {name: tuple(f"{name}[{i}]" for i in wheels) for name in of_wheels}
    if not slipping:
        return found
    found |= {name: (name,) for name in (*BOOK, *OF_SUPPLY)}
    if supports := len(vehicle["support"]):
        found[SUPPORT_LOAD] = tuple(f"{SUPPORT_LOAD}[{j}]" for j in range(1, supports + 1))
    return {name: signals for name, signals in found.items() if name not in NOT_SLIPPING}


def check_hinge_signal(table: Table, key: str, signal: str, known: Mapping[str, str],
                       hinges: Sequence[Hinge] = ()) -> None:
    """Fails for a signal that this vehicle does not have, with the reason; `known`: signal → its name."""
    if signal in known:
        return
    name, _, item = signal.partition("[")
    coordinated = [hinge.name for hinge in hinges if hinge.kind == "coordinated"]
    if name in (ANGLE, RATE) and item[:-1] in coordinated:
        table.fail(key, f"{signal}: {item[:-1]} is coordinated, and all such wheels are steered together; give one of "
                   f"{CURVATURE}, {ANGLE} (without a name) and {TWIST}, or make it \"prescribed\"")
    _check_ground(table, key, name, signal, known)
    if name in PER_WHEEL:
        table.fail(key, no_such_wheel(signal, name, sum(1 for each in known.values() if each == name)))
    if name in HINGE_INPUTS and name not in HINGE_OUTPUTS:
        there = [each for each in known if known[each] == name]
        needs = HINGE_INPUTS[name][2]
        table.fail(key, f"{signal} needs {needs}; " + (f"there {'are' if there[1:] else 'is'} {', '.join(there)}"
                                                       if there else "this vehicle has none"))
    table.fail(key, f"there is no signal {shown(signal)}; {nearest_of(signal, known)}")


def _check_ground(table: Table, key: str, name: str, signal: str, known: Mapping[str, str]) -> None:
    """Fails for an output that only the other ground has: with friction, or ideal."""
    on_friction = {*SLIPPING_OUTPUTS, *SLIPPING_ALONE, *FRICTION_PER_WHEEL, *OF_GROUND, *BOOK, *OF_SUPPLY}
    there = set(known.values())
    if name in there:
        return
    if name in on_friction and not there & set(FRICTION_PER_WHEEL):
        instead = ("; `laconic simulate` prints the loads at rest if vehicle.friction_coefficient is given"
                   if name == "wheel_load_N" else "")
        table.fail(key, f"{shown(signal)} is an output of vehicles whose wheels may slip; give "
                   f"ground.friction_coefficient, or take the signal out{instead}")
    if name in NOT_SLIPPING and there & set(FRICTION_PER_WHEEL):
        table.fail(key, f"{shown(signal)} is an output of ideal ground, and here wheels may slip; take it out, or take "
                   "out ground.friction_coefficient")


def read_hinge_signals(table: Table, known: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """The list `signals`: a signal without its index stands for all of them; none is named twice."""
    every = {signal: name for name, signals in known.items() for signal in signals}
    found: list[str] = []
    for signal in table.texts("signals", ()):
        if signal == "no_slip_margin_N" and signal not in every and not known.get(FRICTION_PER_WHEEL[0]):
            table.fail("signals", f"{signal} needs vehicle.friction_coefficient; give it, or take the signal out")
        if known.get(signal):
            found += known[signal]
        else:
            check_hinge_signal(table, "signals", signal, every)
            found.append(signal)
    for number, signal in enumerate(found):
        if signal in found[:number]:
            table.fail("signals", f"names {signal} twice; keep one of them")
    return tuple(found)


def check_commands(top: Table, inputs: Sequence[Input], hinges: Sequence[Hinge]) -> None:
    """Fails for two commands of one hinge, for an angle without a rate limit, and for a twist that begins as 0."""
    of_all = {each.signal.partition("[")[0]: each for each in reversed(inputs)
              if each.signal.partition("[")[0] in (TWIST, CURVATURE) or each.signal == ANGLE}
    if len(of_all) > 1:
        first, second = list(of_all.values())[:2]
        top.fail(f"{first.location}.signal", f"{first.signal} is given besides {second.signal}; steer the coordinated "
                 "wheels by one of them")
    for each in inputs:
        name, _, item = each.signal.partition("[")
        if name == ANGLE and item:
            _check_angle(top, each, inputs, next(hinge for hinge in hinges if hinge.name == item[:-1]))
        if each.signal == ANGLE and not any(hinge.follows or np.isfinite(hinge.rate_limit_rad_per_s) for hinge in hinges
                                            if hinge.kind == "coordinated"):
            _fail_without_rate(top, each, next(hinge for hinge in hinges if hinge.kind == "coordinated"))


def _check_angle(top: Table, each: Input, inputs: Sequence[Input], hinge: Hinge) -> None:
    rate = f"{RATE}[{hinge.name}]"
    if any(other.signal == rate for other in inputs):
        top.fail(f"{each.location}.signal", f"{each.signal} is given besides {rate}; keep one of them")
    if not np.isfinite(hinge.rate_limit_rad_per_s) and not hinge.follows:
        _fail_without_rate(top, each, hinge)


def _fail_without_rate(top: Table, each: Input, hinge: Hinge) -> None:
    top.fail(f"{hinge.place}.rate_limit_rad_per_s", f"is missing; {each.signal} is followed within a largest rate, "
             "which it must give")
