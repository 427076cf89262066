"""What the FMU of a vehicle with hinges is made of: start values by the names of its variables, and what it lacks."""

from __future__ import annotations

import math
from typing import Any

from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.core.articulated import body_members, method_names
from laconic.core.slipping import hinge_keys, wheel_keys
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.hinge_signals import ANGLE, CURVATURE, TWIST
from laconic.scene.hinges import Hinge
from laconic.simulation.articulated import start_plant
from laconic.simulation.slipping import SlippingCommands, start_slipping
from laconic.simulation.steering import Commands
from laconic_fmu.description import Description, read
from laconic_fmu.slipping import of_slipping, without_slip

DESCRIPTION = SOURCE_DIR / "fmu/articulated/modelDescription.xml"
OF_BODY = ("hinge_x_m", "hinge_y_m", "mass_kg", "com_x_m", "com_y_m", "yaw_inertia_kgm2")
"""Members of a body whose variables begin with body_; those of the others begin with hinge_."""


OF_WHEEL = {"load_N": "given_load_N", "creep": "wheel_creep"}
"""Variables of a wheel's members on ground with friction that do not have the members' names."""


INSTEAD = {CURVATURE: "steering_twist and steering_twist_rate",
           ANGLE: "steering_twist and steering_twist_rate", f"{ANGLE}[": "steering_rate_rad_per_s of prescribed hinges"}
"""Inputs of scenes that the FMU does not have, and its inputs that replace them. The angle without a name is that of
coordinated hinges; with a name, that of a prescribed one."""
SLIPPING_INSTEAD = dict.fromkeys((CURVATURE, ANGLE, f"{ANGLE}[", TWIST), "steering_rate_rad_per_s of prescribed "
                                                                         "hinges, and steering_angle_rad of servos")
"""The same on ground with friction."""


def variable_of(member: str) -> str:
    """The variable of a body's member."""
    return f"{'body' if member in OF_BODY else 'hinge'}_{member}"


def variable_of_hinge(member: str) -> str:
    """The variable of what a body and its hinge have in addition on ground with friction."""
    if member.startswith(("servo_", "loop_", "control_")):
        return member
    return f"{'body' if member == 'com_z_m' else 'hinge'}_{member}"


def start_values(scene: Scene) -> dict[str, list[float]]:
    """The scene's vehicle, start, method and step by the names of the FMI variables."""
    if scene.slips_on_hinges:
        return _slipping_values(scene)
    articulated = scene.articulated_vehicle(load("double"))
    row = Commands(scene, articulated, scene.inputs_on_grid()).first_row()
    start_plant(scene, articulated, row)  # refuses a scene that cannot start, naming the field
    twist = articulated.slot(TWIST)
    values = _vehicle(scene, articulated.c, without_slip(read(DESCRIPTION)))
    values["hinge_is_ball"] = [hinge.form == "trailer" for hinge in scene.hinges]
    if articulated.is_coordinated:
        values["steering_twist"] = list(row[twist : twist + 3])
    return values | _start(scene) | {"method": [method_names().index(scene.run.method)]}


def _slipping_values(scene: Scene) -> dict[str, list[float]]:
    """The same of a scene on ground with friction. Servos begin at the angle that they have."""
    core = load("double")
    slipping = scene.slipping_vehicle(core)
    angles = SlippingCommands(scene, slipping, scene.inputs_on_grid()).start_angles()
    start_slipping(scene, slipping, angles)  # refuses as above
    tree, speeds = slipping.tree, scene.initial.wheel_speed_rad_per_s
    values = _vehicle(scene, tree.hinged, of_slipping(read(DESCRIPTION)))
    values |= {variable_of_hinge(member): [float(getattr(tree.hinge[b], member)) for b in range(len(angles))]
               for member in hinge_keys(core)}
    values |= {OF_WHEEL.get(member, member): [float(getattr(tree.wheel[i], member)) for i in range(scene.wheel_count)]
               for member in wheel_keys(core)}
    if speeds:
        values |= {"start_wheel_speed_rad_per_s": list(speeds), "start_wheels_stand": [True]}
    targets = [angle if hinge.follows == "angle" else 0.0 for angle, hinge in zip(angles, scene.hinges, strict=True)]
    return values | _start(scene) | {"start_hinge_rad": angles, "steering_angle_rad": targets}


def _vehicle(scene: Scene, vehicle: Any, description: Description) -> dict[str, list[float]]:
    """The numbers of the core's vehicle with hinges, and the step."""
    core, known = load("double"), {variable.name for variable in description.variables}
    base, wheels, bodies = vehicle.base, scene.wheel_count, range(vehicle.body_count)
    values: dict[str, list[float]] = {"step_s": [scene.run.step_s]}
    for field in core.fields:
        if field.root == "vehicle" and field.table != "vehicle.motor" and field.name in known:
            values[field.name] = field.values(base)[: wheels if field.items == core.max_wheels else None]
    values |= {"body_count": [vehicle.body_count], "wheel_body": list(vehicle.wheel_body)[:wheels],
               "body_parent": [vehicle.body[b].parent for b in bodies],
               "body_hinge": [int(vehicle.body[b].hinge) for b in bodies]}
    return values | {variable_of(member): [float(getattr(vehicle.body[b], member)) for b in bodies]
                     for member in body_members(core)}


def _start(scene: Scene) -> dict[str, list[float]]:
    start = scene.initial
    return {"start_velocity_m_per_s": list(start.velocity_body_m_per_s),
            "start_yaw_rate_rad_per_s": [start.yaw_rate_rad_per_s], "start_x_m": [start.x_m],
            "start_y_m": [start.y_m], "start_heading_rad": [start.heading_rad],
            "start_hinge_rad": [hinge.start_angle_rad for hinge in scene.hinges],
            "start_hinge_rate_rad_per_s": [hinge.start_rate_rad_per_s for hinge in scene.hinges]}


def check(scene: Scene, **options: bool) -> None:
    """BadInput for an option, or a part of the scene, that the FMU of a vehicle with hinges does not have."""
    if not scene.has_hinges:
        return
    for option, wanted in options.items():
        if wanted:
            raise BadInput(f"--{option}: the FMU of a vehicle with hinges ({scene.path}) has no such variant yet; "
                           "leave it out")
    if scene.sensors.imu is not None or scene.sensors.encoder is not None:
        raise BadInput(f"{scene.path}: sensors: the FMU of a vehicle with hinges has no sensors yet; take them out")


def _stops_itself(scene: Scene, hinge: Hinge) -> bool:
    """Whether the stops of a hinge are parameters of the FMU."""
    return scene.slips_on_hinges and (bool(hinge.follows) or not hinge.is_commanded)


def left_out(scene: Scene) -> str:
    """One line for what the scene has and its FMU does not; "" for none."""
    limited = [hinge.name for hinge in scene.hinges if math.isfinite(hinge.rate_limit_rad_per_s) or
               (hinge.has_stops and not _stops_itself(scene, hinge))]
    found = []
    if limited:
        found.append(f"the FMU does not limit angle and rate of {', '.join(limited)}; do so in your controller")
    there = [f"{ANGLE}[{hinge.name}]" for hinge in scene.hinges if hinge.follows == "angle"]
    words = SLIPPING_INSTEAD if scene.slips_on_hinges else INSTEAD
    commands = dict.fromkeys(each.signal for each in scene.inputs
                             if each.signal.partition("[")[0] in words and each.signal not in there)
    if commands:
        instead = dict.fromkeys(words[f"{ANGLE}[" if each.startswith(f"{ANGLE}[") else each.partition("[")[0]]
                                for each in commands)
        found.append(f"in place of {', '.join(commands)} give {' and '.join(instead)}")
    return f"{scene.path}: {'; '.join(found)}: see docs/fmu.md" if found else ""
