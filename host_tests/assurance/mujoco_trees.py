"""MuJoCo and this core on the same vehicles with hinges on ground with friction: time of a step, and where they end.

    python host_tests/assurance/run.py mujoco_trees

The MJCF is made from the scene: its masses, inertias, places, motors and servos. Start and inputs are the same in each
step, whose voltages and angles are those of its middle. Wheels are spheres, which touch the ground in one point below
the axle, as wheels here do; a cylinder touches in more points and so resists turning about the vertical, which these
scenes leave out. Servos turn the modules of the swerve robot, in both programs by one law with one limit.

Each end is compared with that of the core in steps of 0.1 ms. One thing of MuJoCo is changed at a time, then several
together, so that the table tells what the difference comes from. Times are CPU times of one process, all in turn. The
core's steps are called one by one from Python, MuJoCo's by its own loop in C. Creep is how far the robot without
voltage slides to its side, in the same time on a slope of 5°.
"""

from __future__ import annotations

import argparse
import copy
import importlib
import importlib.util
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from assurance.common import Unusable
from laconic.core.slipping import TARGET, SlippingPlant, SlippingVehicle
from laconic.scene import Scene, build_scene
from laconic.scene.scene_tables import scene_tables
from laconic.tools.report.many.race import stay_on_one_core

SCENES = ("mir_like", "frc_swerve_mk4i")
FRICTION, DURATION_S, STEP_S, REFERENCE_S = 0.8, 5.0, 1e-3, 1e-4
SERVO = {"steered": "servo", "servo_gain_Nm_per_rad": 60.0, "servo_damping_Nms": 1.5, "servo_limit_Nm": 30.0}
GRAVITY, NO_MASS_KG = 9.81, 1e-6  # a body without mass has this one: MuJoCo has no massless bodies
SLOPE_RAD = math.radians(5.0)
ROUNDS = 10
CORE = "laconic"
Pose = tuple[float, float, float]


@dataclass(frozen=True)
class Robot:
    """A scene on ground with friction, and the twist along which its modules point; None where casters swivel."""

    scene: Scene
    twist: tuple[Any, ...] | None

    @property
    def vehicle(self) -> SlippingVehicle:
        """That of the core."""
        return SlippingVehicle.of(self.scene)

    @property
    def servos(self) -> list[int]:
        """Hinges with a servo."""
        return [at for at, hinge in enumerate(self.scene.hinges) if hinge.kind == "servo"]

    @property
    def motors(self) -> list[int]:
        """Wheels with a motor."""
        return [at for at, wheel in enumerate(self.scene.vehicle["wheel"]) if wheel["driven"]]

    def controls(self, step_s: float, duration_s: float = DURATION_S) -> np.ndarray:
        """Voltages of the motors and angles of the servos in the middle of each step."""
        middles = (np.arange(round(duration_s / step_s)) + 0.5) * step_s
        given = {each.signal: each.at(middles) for each in self.scene.inputs}
        columns = [given[f"voltage_V[{at + 1}]"] for at in self.motors]
        if self.twist is not None:
            along, across, turn = (each.at(middles) for each in self.twist)
            bodies = self.scene.vehicle["body"]
            columns += [np.unwrap(np.arctan2(across + turn * bodies[at]["hinge_x_m"],
                                             along - turn * bodies[at]["hinge_y_m"])) for at in self.servos]
        return np.column_stack(columns)


def robot_of(name: str) -> Robot:
    """A scene of the project on ground with friction, its coordinated modules with servos."""
    tables = copy.deepcopy(scene_tables(name).entries)
    twist = build_scene(tables).inputs
    tables["vehicle"].pop("friction_coefficient", None)
    tables["input"] = [each for each in tables["input"] if each["signal"].startswith("voltage")]
    for wheel in tables["vehicle"]["wheel"]:
        if wheel.get("steered"):
            wheel.pop("rate_limit_rad_per_s")
            wheel |= SERVO
    scene = build_scene(tables | {"ground": {"friction_coefficient": FRICTION}})
    given = tuple(each for each in twist if each.signal.startswith("steering_twist"))
    return Robot(scene, given or None)


# ---- MuJoCo

@dataclass(frozen=True)
class Contacts:
    """How MuJoCo computes; as it stands here are its defaults, but for the cone."""

    step_s: float = STEP_S
    cone: str = "elliptic"
    impratio: float = 1.0
    time_s: float = 0.02           # solref: in which a contact settles across the ground,
    slip_time_s: float = 0.0       # solreffriction: and a slip along it; 0: the same time
    least: float = 0.9             # solimp: impedance at no depth,
    most: float = 0.95             # and from 1 mm on
    noslip: int = 0
    is_cylinder: bool = False
    tilt_share: float = 1.0        # of the inertia about the vertical, about the others
    spin_is_armature: bool = False


USUAL = Contacts()
HARD = replace(USUAL, impratio=100.0, time_s=0.002, least=0.999, most=0.9999)
CHANGES = {
    "usual": USUAL,
    "pyramidal cone": replace(USUAL, cone="pyramidal"),
    "solimp 0.999, 0.9999": replace(USUAL, least=0.999, most=0.9999),
    "impratio 100": replace(USUAL, impratio=100.0),
    "noslip, 20 passes": replace(USUAL, noslip=20),
    "step 0.1 ms": replace(USUAL, step_s=1e-4),
    "inertia of tilt 0.55 of it": replace(USUAL, tilt_share=0.55),
    "wheels' spin as armature": replace(USUAL, spin_is_armature=True),
    "cylinders 40 mm wide": replace(USUAL, is_cylinder=True),
    "solref 0.002": replace(USUAL, time_s=0.002),
    "the same across the ground alone": replace(USUAL, time_s=0.002, slip_time_s=0.02),
    "the same along it alone": replace(USUAL, slip_time_s=0.002),
    "solref 0.002, solimp and impratio as above": HARD,
    "the same, solref 0.0002, step 0.1 ms": replace(HARD, step_s=1e-4, time_s=2e-4),
}


def mjcf_of(robot: Robot, how: Contacts, gravity: tuple[float, float] = (0.0, GRAVITY)) -> str:
    """The robot on a level plane; `gravity` pulls to the right and down."""
    vehicle, table = robot.vehicle, robot.scene.vehicle
    base = vehicle.tree.hinged.base
    wheels = [(each.get("body", "carriage"), *_wheel(base, at, how)) for at, each in enumerate(table["wheel"])]
    inside = {name: "".join(text for of, text, _ in wheels if of == name)
              for name in ("carriage", *vehicle.names)}
    taken = {name: sum(upright for of, _, upright in wheels if of == name) for name in inside}
    hinged = ""
    for at, body in enumerate(table["body"]):
        name = body["name"]
        place = (body.get("com_x_m", 0.0), body.get("com_y_m", 0.0), vehicle.tree.hinge[at].com_z_m)
        inertia = body["yaw_inertia_kgm2"] - taken[name]
        hinged += (f'<body pos="{body["hinge_x_m"]} {body["hinge_y_m"]} 0"><joint name="hinge{at}" axis="0 0 1" '
                   f'damping="{body.get("damping_Nms", 0.0)}"/>{_inertial(place, body["mass_kg"], inertia)}'
                   f"{inside[name]}</body>")
    carriage = _inertial((base.com_x_m, base.com_y_m, base.com_z_m), base.mass_kg,
                         base.yaw_inertia_kgm2 - taken["carriage"], how.tilt_share)
    motors = "".join(f'<general joint="axle{at}" gainprm="{base.motor_gain_Nm_per_V}"/>' for at in robot.motors)
    slip_time = f' solreffriction="{how.slip_time_s} 1"' if how.slip_time_s else ""
    pairs = "".join(f'<pair geom1="wheel{at}" geom2="ground"/>' for at in range(len(wheels)))
    return f"""<mujoco><option timestep="{how.step_s!r}" cone="{how.cone}" impratio="{how.impratio}"
 integrator="implicitfast" gravity="0 {-gravity[0]} {-gravity[1]}" noslip_iterations="{how.noslip}"/>
<default><geom contype="0" conaffinity="0"/><pair condim="3" friction="{FRICTION} {FRICTION} 0 0 0"
 solref="{how.time_s} 1" solimp="{how.least} {how.most} 0.001"{slip_time}/></default>
<worldbody><geom name="ground" type="plane" size="0 0 1"/>
<body name="carriage"><freejoint/>{carriage}{inside["carriage"]}{hinged}</body></worldbody><contact>{pairs}</contact>
<actuator>{motors}{"".join(_servo(table["body"][at], at) for at in robot.servos)}</actuator></mujoco>"""


def _inertial(place: Sequence[float], mass_kg: float, inertia_kgm2: float, tilt_share: float = 1.0) -> str:
    x, y, z = place
    tilt = tilt_share * inertia_kgm2
    return (f'<inertial pos="{x} {y} {z}" mass="{max(mass_kg, NO_MASS_KG)}" '
            f'diaginertia="{tilt} {tilt} {inertia_kgm2}"/>')


def _wheel(base: Any, at: int, how: Contacts) -> tuple[str, float]:
    """A wheel, whose mass its body has; and its inertia about the vertical, which the body therefore lacks."""
    wheel = base.wheel[at]
    radius_m, spin = wheel.own_radius_m or base.wheel_radius_m, wheel.own_inertia_kgm2 or base.wheel_inertia_kgm2
    upright = 1e-9 if how.spin_is_armature else 0.51 * spin
    moments, armature = (1e-9, spin) if how.spin_is_armature else (spin, 0.0)
    damping = 0.0 if wheel.undriven else base.motor_damping_Nms
    turn = wheel.axle_rad + math.pi
    shape = f'type="cylinder" size="{radius_m} 0.02"' if how.is_cylinder else f'type="sphere" size="{radius_m}"'
    return (f'<body pos="{wheel.x_m} {wheel.y_m} {radius_m}" quat="{_axle_quaternion(turn)}">'
            f'<joint name="axle{at}" axis="0 0 1" damping="{damping}" armature="{armature}"/>'
            f'<inertial pos="0 0 0" mass="{NO_MASS_KG}" diaginertia="{upright} {upright} {moments}"/>'
            f'<geom name="wheel{at}" {shape}/></body>'), upright


def _axle_quaternion(heading_rad: float) -> str:
    """Turns the third axis to a level one with that heading."""
    half, quarter = heading_rad / 2, math.sqrt(0.5)
    return f"{quarter * math.cos(half)} {-quarter * math.sin(half)} {quarter * math.cos(half)} " \
           f"{quarter * math.sin(half)}"


def _servo(body: dict[str, Any], at: int) -> str:
    gain, damping, limit = (body[f"servo_{key}"] for key in ("gain_Nm_per_rad", "damping_Nms", "limit_Nm"))
    return (f'<general joint="hinge{at}" biastype="affine" gainprm="{gain}" biasprm="0 {-gain} {-damping}" '
            f'forcelimited="true" forcerange="{-limit} {limit}"/>')


class InMujoco:
    """A run of MuJoCo that can be repeated."""

    def __init__(self, robot: Robot, how: Contacts, controls: np.ndarray, right: float = 0.0, down: float = GRAVITY):
        if importlib.util.find_spec("mujoco") is None:
            raise Unusable("MuJoCo is missing; install mujoco from python/requirements.txt")
        mujoco = importlib.import_module("mujoco")
        self.rollout = importlib.import_module("mujoco.rollout").rollout
        self.model = mujoco.MjModel.from_xml_string(mjcf_of(robot, how, (right, down)))
        self.data, self.controls = mujoco.MjData(self.model), np.ascontiguousarray(controls[None])
        for at, hinge in enumerate(robot.scene.hinges):
            self.data.joint(f"hinge{at}").qpos[0] = hinge.start_angle_rad
        kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
        self.start = np.empty((1, mujoco.mj_stateSize(self.model, kind)))
        mujoco.mj_getState(self.model, self.data, self.start[0], kind)
        self.com_m = complex(*self.model.body("carriage").ipos[:2])
        self.end: Pose = (0.0, 0.0, 0.0)

    def run(self) -> None:
        """From the start to the end."""
        states, _ = self.rollout(self.model, self.data, self.start, self.controls)
        _, x_m, y_m, _, w, x, y, z = states[0, -1, :8]
        heading_rad = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        place = complex(x_m, y_m) + self.com_m * complex(math.cos(heading_rad), math.sin(heading_rad))
        self.end = place.real, place.imag, heading_rad


# ---- this core

class InCore:
    """The same of this core."""

    def __init__(self, robot: Robot, step_s: float, controls: np.ndarray, right: float = 0.0):
        vehicle = robot.vehicle
        angles = [hinge.start_angle_rad for hinge in robot.scene.hinges]
        self.plant: SlippingPlant = vehicle.plant(step_s=step_s, hinge_angle_rad=angles)
        self.rows = np.tile(vehicle.input_row({"body_force_N": [0.0, -right]} if right else {}), (len(controls), 1))
        slots = [vehicle.slot(f"voltage_V[{at + 1}]") for at in robot.motors]
        slots += [vehicle.slot(f"{TARGET}[{vehicle.names[at]}]") for at in robot.servos]
        self.rows[:, slots] = controls
        self.start, self.end = self.plant.save(), (0.0, 0.0, 0.0)

    def run(self) -> None:
        """From the start to the end."""
        self.plant.restore(self.start, 0)
        self.plant.follow(self.rows)
        found = self.plant.motion()
        self.end = found.x_m, found.y_m, found.heading_rad


# ---- results

@dataclass(frozen=True)
class Row:
    """One program on one robot."""

    cost_us: float
    off_mm: float
    off_mrad: float


def in_turn(runs: Sequence[Callable[[], None]], rounds: int) -> list[float]:
    """The least CPU time of each, all in turn."""
    found = [math.inf] * len(runs)
    for _ in range(rounds):
        for at, each in enumerate(runs):
            start = time.process_time_ns()
            each()
            found[at] = min(found[at], 1e-9 * (time.process_time_ns() - start))
    return found


def compared(name: str, changes: dict[str, Contacts], rounds: int, duration_s: float = DURATION_S) -> dict[str, Row]:
    """Of the core, and of MuJoCo with each of the changes."""
    robot = robot_of(name)
    right = InCore(robot, REFERENCE_S, robot.controls(REFERENCE_S, duration_s))
    right.run()
    steps = [STEP_S, *(how.step_s for how in changes.values())]
    runs: list[InCore | InMujoco] = [
        InCore(robot, STEP_S, robot.controls(STEP_S, duration_s)),
        *(InMujoco(robot, how, robot.controls(how.step_s, duration_s)) for how in changes.values())]
    seconds = in_turn([each.run for each in runs], rounds)
    costs = [1e6 * spent * step_s / duration_s for spent, step_s in zip(seconds, steps, strict=True)]
    return {program: Row(cost, *off(each.end, right.end))
            for program, cost, each in zip((CORE, *changes), costs, runs, strict=True)}


def off(end: Pose, right: Pose) -> tuple[float, float]:
    """By how much a pose is off another one, in mm and mrad."""
    return (1e3 * math.hypot(end[0] - right[0], end[1] - right[1]),
            1e3 * abs(math.remainder(end[2] - right[2], 2 * math.pi)))


def creep_mm(name: str, how: Contacts | None, duration_s: float = DURATION_S) -> float:
    """How far the robot, without voltage, goes to its right where a slope of 5° pulls it there; None: this core."""
    robot = robot_of(name)
    controls = np.zeros_like(robot.controls(STEP_S if how is None else how.step_s, duration_s))
    right, down = GRAVITY * math.sin(SLOPE_RAD), GRAVITY * math.cos(SLOPE_RAD)
    run: InCore | InMujoco
    if how is None:
        weight = sum(each["mass_kg"] for each in (robot.scene.vehicle, *robot.scene.vehicle["body"]))
        run = InCore(robot, STEP_S, controls, weight * right)
    else:
        run = InMujoco(robot, how, controls, right, down)
    run.run()
    return -1e3 * run.end[1]


def arguments(parser: argparse.ArgumentParser) -> None:
    """How often times are taken."""
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"of which the least time counts ({ROUNDS})")


def run(options: argparse.Namespace) -> bool:
    """Prints the table, and the creep on a slope."""
    stay_on_one_core()
    found = {name: compared(name, CHANGES, options.rounds) for name in SCENES}
    print("| program |", *(f"`{name}`: µs a step (ratio) | off by mm, mrad | creep in mm |" for name in SCENES))
    print("| --- |", *["--- | --- | --- |"] * len(SCENES))
    for program in (CORE, *CHANGES):
        cells = []
        for name, rows in found.items():
            row, creep = rows[program], creep_mm(name, CHANGES.get(program))
            cells.append(f"{row.cost_us:.1f} ({row.cost_us / rows[CORE].cost_us:.1f}) | {_shown(row.off_mm)}, "
                         f"{_shown(row.off_mrad)} | {_shown(abs(creep))}")
        print("|", " | ".join([program, *cells]), "|")
    return True


def _shown(value: float) -> str:
    """Two digits, or all whole ones."""
    return f"{value:.2g}" if value < 100.0 else f"{value:.0f}"
