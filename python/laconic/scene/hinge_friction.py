"""What a hinge and its wheels have on ground with friction alone: servos, loops, stops, dry friction, scrub, creep."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from laconic.scene.keys import read_number
from laconic.scene.table import Table

NO_STOP_RAD = 1e6  # on one side of a hinge that has a stop on the other
OF_HINGES = ("com_z_m", "dry_friction_Nm")
OF_SERVOS = ("servo_gain_Nm_per_rad", "servo_damping_Nms", "servo_limit_Nm")
OF_LOOPS = ("loop_V_per_rad", "loop_Vs_per_rad")
PERIOD = "control_period_s"
OF_WHEELS = ("load_N", "scrub_radius_m", "scrub_fade_m", "creep")
HITCH = "hitch"
NEEDS_GROUND = "acts on ground with friction alone; give ground.friction_coefficient, or take it out"


def read_hinge_friction(table: Table, kind: str, slips: bool) -> dict[str, Any]:
    """The keys of one hinge that act where wheels slip; fails for one that does not act."""
    turned = table.location.startswith(("vehicle.wheel", "vehicle.body"))  # casters and trailers swivel
    keys = (*OF_HINGES, *OF_SERVOS, *OF_LOOPS, PERIOD) if turned else OF_HINGES
    known = [key for key in keys if table.has(key)]
    if not slips:
        if known:
            table.fail(known[0], NEEDS_GROUND)
        return {}
    found: dict[str, Any] = {key: read_number(table, key) for key in known}
    has_servo = bool(found.get(OF_SERVOS[0]))
    for key in OF_SERVOS:
        if key in found and kind in ("motor", "prescribed"):
            table.fail(key, f'is of a servo, and this hinge is "{kind}"; take it out, or make the hinge '
                       + ('steered = "servo"' if table.location.startswith("vehicle.wheel") else 'hinge = "free"'))
        if key in found and not has_servo:
            table.fail(key, f"has no effect without {OF_SERVOS[0]}; give it, too")
    for key in OF_LOOPS:
        if key in found and kind != "motor":
            table.fail(key, f'is of a loop of a motor, and this hinge is "{kind}"; take it out, or make it "motor"')
    if PERIOD in found and not (has_servo or any(found.get(key) for key in OF_LOOPS)):
        table.fail(PERIOD, f"is of a servo or loop, and there is none; give {OF_SERVOS[0]} or {OF_LOOPS[0]}, too")
    if kind == "servo" and not has_servo:
        table.fail(OF_SERVOS[0], "is missing; give the torque of the servo per radian that it is off")
    return found


def of_motor(motor: Table, slips: bool) -> dict[str, float]:
    """What of a hinge's motor at its shaft acts where wheels slip: its winding and the limit of its current."""
    limit = read_number(motor, "current_limit_A")
    if not slips:
        if limit is not None:
            motor.fail("current_limit_A", NEEDS_GROUND)
        return {}
    ratio, friction = read_number(motor, "gear_ratio"), read_number(motor, "viscous_friction_Nms")
    found = {"winding_resistance_ohm": read_number(motor, "resistance_ohm"),
             "viscous_friction_Nms": ratio * ratio * friction}
    return found | ({} if limit is None else {"current_limit_A": limit})


def stops_of(low_rad: float, high_rad: float) -> dict[str, float]:
    """The stops of a hinge that turns by itself, as the core has them."""
    if not (math.isfinite(low_rad) or math.isfinite(high_rad)):
        return {}
    return {"stop_low_rad": max(low_rad, -NO_STOP_RAD), "stop_high_rad": min(high_rad, NO_STOP_RAD)}


def loop_of(body: Mapping[str, Any]) -> str:
    """What a command of a hinge sets where wheels slip: "angle" of a servo or loop, "rate" of a speed loop, or ""."""
    if body.get(OF_SERVOS[0]) or body.get(OF_LOOPS[0]):
        return "angle"
    return "rate" if body.get(OF_LOOPS[1]) else ""


def read_contact(table: Table, slips: bool, is_hung: bool = True) -> dict[str, float]:
    """The keys of a wheel, or of the wheels of a caster or trailer, that act where wheels slip and a body hangs."""
    known = [key for key in OF_WHEELS if table.has(key)]
    if known and not is_hung:
        table.fail(known[0], "acts on vehicles with bodies on hinges alone, and this one has none; take it out")
    if known and not slips:
        table.fail(known[0], NEEDS_GROUND)
    found = {key: read_number(table, key) for key in known}
    if found.get("scrub_fade_m") and not found.get("scrub_radius_m"):
        table.fail("scrub_fade_m", "has no effect without scrub_radius_m; give it, too")
    return found
