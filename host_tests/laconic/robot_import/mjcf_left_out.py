"""What an MJCF file has and a scene has not: constraints, actuators, tendons, and gravity that is not along −z."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from typing import Any

import numpy as np

DOWN = np.cos(np.radians(0.1))  # as far as this from −z, gravity is along it
JOINT = 2  # mjtEq
CONSTRAINTS = {0: "connect", 1: "weld", 2: "joint", 3: "tendon", 4: "flex"}


def left_out(model: Any, inside: Collection[int]) -> list[str]:
    """A remark for each kind of thing; `inside` are the bodies of the robot."""
    return [*_equalities(model, inside), *_actuators(model), *_tendons(model), *_gravity(model)]


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
    return [f"actuators are not taken over: {_listed(names)}; the inputs are torques at the axles"] if names else []


def _tendons(model: Any) -> list[str]:
    names = [model.tendon(each).name or str(each + 1) for each in range(model.ntendon)]
    return [f"tendons are not taken over: {_listed(names)}"] if names else []


def _gravity(model: Any) -> list[str]:
    gravity = np.asarray(model.opt.gravity)
    strength = float(np.linalg.norm(gravity))
    if strength == 0.0 or -gravity[2] >= DOWN * strength:
        return []
    told = " ".join(f"{each:g}" for each in gravity)
    return [f"gravity ({told}) m/s² is not along -z, which is not taken over; a slope is [ground] slope_deg"]


def _joint(model: Any, joint: int) -> str:
    """By its name, or by its body's, as the robot's tree names it."""
    return str(model.joint(joint).name or model.body(int(model.jnt_bodyid[joint])).name)


def _listed(names: list[str]) -> str:
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if names[6:] else "")
