"""What a scene gives and what would do nothing: a voltage where no motor drives, an instant after the run's end …"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from laconic.core.fields import ABOVE_0
from laconic.scene.ground import has_friction
from laconic.scene.keys import key_of
from laconic.scene.table import Table

if TYPE_CHECKING:
    from laconic.scene.inputs import Input

OF_FIXED = ("roller_rad", "roller_deg", "roller_drag")
OF_MOTOR = ("motor_gain_Nm_per_V", "motor_damping_Nms", "motor_circuit")
STILL = 1e-12  # the sine of 180°, which is no multiple of 1 in rad, is not 0
CIRCUITS = {1: "open", 2: "shorted"}  # laconic_motor_circuit, where no controller sets the voltage


def check_wheel(table: Table, wheel: dict[str, Any]) -> None:
    """Fails for a key of one wheel that means nothing for such a wheel."""
    for key in OF_FIXED if wheel["kind"] == "fixed" else ():
        if table.has(key):
            table.fail(key, "is given for a fixed wheel, which has no rollers; take it out")
    if not wheel["driven"]:
        for key in filter(table.has, OF_MOTOR):
            table.fail(key, "is given for a wheel without a motor; take it out, or driven = false")
    if wheel["locked"] and "axle_friction_Nm" in wheel:
        table.fail("axle_friction_Nm", "has no effect on a locked wheel, which does not turn; take it out, or locked")
    for key in ABOVE_0:
        if key in wheel:
            key_of(table, key).check(table, wheel[key])


def check_ground(top: Table, vehicle: dict[str, Any]) -> None:
    """Fails for what the ground cannot act on."""
    wheels = vehicle["wheel"]
    if vehicle.get("ground") == {}:
        top.fail("ground", "is empty; give friction_coefficient or slope_deg, or take it out for ideal, level ground")
    if "roller_drag" in vehicle.get("ground", {}) and not any(wheel["kind"] != "fixed" for wheel in wheels):
        top.fail("ground.roller_drag", "has no effect, as no wheel has rollers; take it out")


def check_start(top: Table, initial: dict[str, Any], vehicle: dict[str, Any]) -> None:
    """Fails for a speed of a wheel that does not turn."""
    for number, (speed, wheel) in enumerate(zip(initial.get("wheel_speed_rad_per_s", ()), vehicle["wheel"],
                                                strict=False), start=1):
        if wheel["locked"] and speed != 0.0:
            top.fail("initial.wheel_speed_rad_per_s", f"gives wheel {number} {speed:g} rad/s, which is locked; give 0 "
                     "for it")


def check_input(top: Table, each: Input, vehicle: dict[str, Any], duration_s: float) -> None:
    """Fails for an input that moves nothing, or that the run never comes to."""
    if each.signal.startswith("voltage_V"):
        check_motor(top, each, vehicle)
    check_sine(top, each)
    check_end(top, each, duration_s)


def check_places(top: Table, inputs: Sequence[Input]) -> None:
    """Fails for where a world force acts in a scene that gives none."""
    if any(each.signal.startswith("world_force_N[") for each in inputs):
        return
    for each in inputs:
        if each.signal.startswith("world_force_point_m["):
            top.fail(f"{each.location}.signal", f"{each.signal} says where a world force acts, and no input gives one; "
                     "give world_force_N[1] or world_force_N[2], too, or take it out")


def check_motor(top: Table, each: Input, vehicle: dict[str, Any]) -> None:
    """Fails for a voltage where no motor makes a torque of it."""
    number = int(each.signal.partition("[")[2].removesuffix("]"))
    wheel = vehicle["wheel"][number - 1]
    common = 1.0 if "motor" in vehicle else vehicle["motor_gain_Nm_per_V"]
    why = ""
    if not wheel["driven"]:
        why = f"wheel {number} has no motor; take out its driven = false, or drive it by axle_torque_Nm"
    elif wheel.get("motor_gain_Nm_per_V", common) == 0.0:
        why = ("the vehicle has no motor; give [vehicle.motor] or vehicle.motor_gain_Nm_per_V, or drive the wheel by "
               "axle_torque_Nm")
    elif circuit := CIRCUITS.get(wheel["motor_circuit"]):
        why = f"the motor of wheel {number} is {circuit}; take out this input, or its motor_circuit"
    elif wheel["locked"] and not ("motor" in vehicle and has_friction(vehicle)):  # there it draws a current
        why = f"wheel {number} is locked; take out this input, or its locked = true"
    if why:
        top.fail(f"{each.location}.signal", f"{each.signal} would do nothing, {why}")


def check_sine(top: Table, each: Input) -> None:
    """Fails for a sine that stands still at 0; at another phase it is a constant."""
    if each.kind == "sine" and each.frequency_Hz == 0.0 and abs(math.sin(each.phase_rad)) < STILL:
        top.fail(f"{each.location}.frequency_Hz", "is 0, and this sine would do nothing at its phase; give a value "
                 "above 0, or take this input out")


def check_end(top: Table, each: Input, duration_s: float) -> None:
    """Fails for instants that the run never comes to; a table may lead to one that lies beyond its end."""
    if each.kind == "sine":
        return
    reached = [t for t in each.t_s if t <= duration_s * (1.0 + 1e-12)]
    beyond = each.t_s[len(reached) + (each.kind == "table" and bool(reached)):]
    if beyond:
        top.fail(f"{each.location}.t_s", f"{beyond[0]:g} s lies beyond the run of {duration_s:g} s and would do "
                 "nothing; take it out or make run.duration_s longer")
