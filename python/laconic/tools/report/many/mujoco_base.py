"""The same carriage as a MuJoCo model: a body on wheels that touch the ground.

It models more: the body moves in space, each wheel is a body with a joint, and the ground carries and drives it by
contacts with friction, solved anew in each step, so wheels may slip and lift. A wheel is a short capsule whose
contact has friction across its axle alone, as the rollers of an omni wheel leave it. So the ratio tells what these
contacts cost, not who solves the same equations faster.
"""

from __future__ import annotations

import importlib
import math
from typing import Any

import numpy as np

from laconic.tools.report.many.task import Runner, Task
from laconic.tools.verify.reference import totals_of

HALF_WIDTH_M = 1e-5
ALONG_AXLE, ACROSS_AXLE = 1e-5, 1.0  # friction: MuJoCo's least, and no slip


def mujoco_run(task: Task) -> Runner:
    """A run of all vehicles, one after the other, and their velocities in body axes (3, lanes): m/s, m/s, rad/s."""
    mujoco, rollout = importlib.import_module("mujoco"), importlib.import_module("mujoco.rollout")
    model = mujoco.MjModel.from_xml_string(model_xml(task))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    first = np.empty(size)
    mujoco.mj_getState(model, data, first, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    held = {"state": np.tile(first, (task.lanes, 1))}
    control = np.repeat(task.voltages_V.T[:, None, :], task.steps, axis=1)

    def run() -> None:
        found, _ = rollout.rollout(model, data, held["state"], control)
        held["state"] = found[:, -1].copy()

    def states() -> np.ndarray:
        found = np.empty((3, task.lanes))
        for lane, state in enumerate(held["state"]):
            mujoco.mj_setState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
            w, x, y, z = data.qpos[3:7]
            heading = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
            cosine, sine, v = math.cos(heading), math.sin(heading), data.qvel
            found[:, lane] = v[0] * cosine + v[1] * sine, v[1] * cosine - v[0] * sine, v[5]
        return found

    return run, states


def model_xml(task: Task) -> str:
    """The carriage: mass and yaw inertia are totals of the scene, so wheels add but the armature of their joints."""
    t, wheels = totals_of(task.scene.vehicle), task.scene.vehicle["wheel"]
    parts, pairs, motors = zip(*(_wheel(t, i, wheel) for i, wheel in enumerate(wheels)), strict=True)
    return f"""<mujoco><option timestep="{task.step_s!r}" cone="elliptic"/>
<worldbody><geom name="ground" type="plane" size="0 0 1"/>
<body name="carriage" pos="0 0 {t.wheel_radius_m!r}"><freejoint/>
<inertial pos="{t.com_m[0]} {t.com_m[1]} 0" mass="{t.mass_kg!r}"
 diaginertia="{t.yaw_inertia_kgm2!r} {t.yaw_inertia_kgm2!r} {t.yaw_inertia_kgm2!r}"/>
{"".join(parts)}</body></worldbody>
<contact>{"".join(pairs)}</contact><actuator>{"".join(motors)}</actuator></mujoco>"""


def _wheel(t: Any, i: int, wheel: Any) -> tuple[str, str, str]:
    cosine, sine = math.cos(wheel["axle_rad"]), math.sin(wheel["axle_rad"])
    x, y = wheel["x_m"], wheel["y_m"]
    ends = f"{-HALF_WIDTH_M * cosine} {-HALF_WIDTH_M * sine} 0 {HALF_WIDTH_M * cosine} {HALF_WIDTH_M * sine} 0"
    body = (f'<body pos="{x} {y} 0"><joint name="axle{i}" axis="{-cosine} {-sine} 0" armature="{t.inertias_kgm2[i]}" '
            f'damping="{t.dampings_Nms[i]}"/><geom name="wheel{i}" type="capsule" fromto="{ends}" '
            f'size="{t.radii_m[i]}" mass="1e-4" contype="0" conaffinity="0"/></body>')
    pair = f'<pair geom1="wheel{i}" geom2="ground" condim="3" friction="{ALONG_AXLE} {ACROSS_AXLE} 0 0 0"/>'
    return body, pair, f'<general joint="axle{i}" gainprm="{t.gains_Nm_per_V[i]}"/>'
