"""What an MJCF file has and a scene has not: constraints, actuators, tendons, and gravity of its own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from typing import Any

from laconic.robot.importer.gravity import gravity_left_out, listed
from laconic.robot.importer.robot_tree import Command

JOINT = 2  # mjtEq
AT_JOINT = (0, 1)  # mjtTrn: mjTRN_JOINT, mjTRN_JOINTINPARENT
AT_TENDON = 3
OF_JOINT = 1  # mjtWrap
CONSTRAINTS = {0: "connect", 1: "weld", 2: "joint", 3: "tendon", 4: "flex"}


def left_out(model: Any, inside: Collection[int]) -> list[str]:
    """A remark for each kind of thing; `inside` are the bodies of the robot."""
    return [*_equalities(model, inside), *_actuators(model), *_tendons(model), *_gravity(model, inside)]


def _equalities(model: Any, inside: Collection[int]) -> list[str]:
    remarks, others = [], []
    for each in range(model.neq):
        kind = int(model.eq_type[each])
        if kind != JOINT:
            others.append(CONSTRAINTS.get(kind, "other"))
        elif model.jnt_bodyid[model.eq_obj1id[each]] in inside:
            remarks.append(_joined(model, each))
    if others:
        kinds = ", ".join(f"{count} {kind}" for kind, count in Counter(others).items())
        remarks.append(f"<equality> is not taken over: {kinds}")
    return remarks


def _joined(model: Any, equality: int) -> str:
    one, other = _joint(model, int(model.eq_obj1id[equality])), int(model.eq_obj2id[equality])
    if other < 0:
        return f"joint {one} is held by an <equality>, which is not taken over: it turns on its own"
    return f"joint {one} mimics {_joint(model, other)}, which is not taken over: each wheel turns on its own"


def _actuators(model: Any) -> list[str]:
    names = [model.actuator(each).name or str(each + 1) for each in range(model.nu)]
    return [f"actuators are not taken over: {listed(names)}; the inputs are torques at the axles"] if names else []


def commands_of(model: Any) -> dict[int, list[Command]]:
    """The actuators of each joint, also by way of a tendon."""
    found: dict[int, list[Command]] = {}
    for each in range(model.nu):
        gear = float(model.actuator_gear[each][0])
        command = Command(f"actuator {model.actuator(each).name or each + 1}", None if gear in (0.0, 1.0) else gear)
        for joint in _joints_of(model, int(model.actuator_trntype[each]), int(model.actuator_trnid[each][0])):
            found.setdefault(joint, []).append(command)
    return found


def _joints_of(model: Any, kind: int, of: int) -> list[int]:
    """What an actuator acts on."""
    if kind in AT_JOINT:
        return [of]
    if kind != AT_TENDON:
        return []
    wraps = range(int(model.tendon_adr[of]), int(model.tendon_adr[of]) + int(model.tendon_num[of]))
    return [int(model.wrap_objid[each]) for each in wraps if int(model.wrap_type[each]) == OF_JOINT]


def _tendons(model: Any) -> list[str]:
    names = [model.tendon(each).name or str(each + 1) for each in range(model.ntendon)]
    return [f"tendons are not taken over: {listed(names)}"] if names else []


def _gravity(model: Any, inside: Collection[int]) -> list[str]:
    weightless = [model.body(body).name or f"body {body}" for body in inside if model.body_gravcomp[body] != 0.0]
    return gravity_left_out([float(each) for each in model.opt.gravity], weightless)


def _joint(model: Any, joint: int) -> str:
    """By its name, or by its body's, as the robot's tree names it."""
    return str(model.joint(joint).name or model.body(int(model.jnt_bodyid[joint])).name)
