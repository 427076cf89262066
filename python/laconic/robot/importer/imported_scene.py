"""The scene of an imported robot: its numbers with their origin, and a mark at each that the file does not tell."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput, Refused
from laconic.robot.importer.answers import Answers
from laconic.robot.importer.formats import read_robot
from laconic.robot.importer.plausible import doubts_of
from laconic.robot.importer.rigid_body import RigidBody, add_up
from laconic.robot.importer.robot_tree import Robot
from laconic.robot.importer.rollers import Kind, kinds_of
from laconic.robot.importer.supports import Support, find_supports
from laconic.robot.importer.wheels import FoundWheel, Ground, find_wheels
from laconic.scene import Scene, scene_of
from laconic.scene.scene_text import Comments, lines_of
from laconic.scene.table import Table

DIGITS = 9
ACCELERATION_M_PER_S2 = 0.3
PUSH_S = 1.0
TOUCHING_M = 1e-9  # a centre so little below the ground is on it, but for rounding
ASIDE = 0.05  # of the way ahead, at which a push still is one ahead
DURATION_S, STEP_S = 3.0, 0.01
FRICTION_STEP_S = 0.001
SHARED = {"radius_m": ("wheel_radius_m", "by the shapes of the wheels, unless said with --radius"),
          "inertia_kgm2": ("wheel_inertia_kgm2", "about the axle, rollers included, without gear and rotor"),
          "motor_damping_Nms": ("motor_damping_Nms", "damping of the joints")}
NEED_SLIP = {  # refusals of the core whose remedy is an option here
    "nothing moves": "plain wheels on these axles prevent every motion",
    "straight only": "plain wheels on parallel axles that are not one line only drive straight, whatever motors do"}
MOTOR = ("# The file does not tell the motors. With them, voltage_V[i] drives wheel i; their data sheet gives:",
         "#   [vehicle.motor]", "#   resistance_ohm = …", "#   torque_constant_Nm_per_A = …",
         "#   back_emf_Vs_per_rad = …", "#   gear_ratio = …")
DAMPED = ("#   viscous_friction_Nms = …      # the motor_damping_Nms below, divided by gear_ratio²",
          "# [vehicle.motor] takes the place of every motor_gain_Nm_per_V and motor_damping_Nms: take these lines out.")


@dataclass(frozen=True)
class Imported:
    """The scene as TOML text, and what the user should know of it, a line each."""

    name: str
    text: str
    wheels: tuple[str, ...]
    assumptions: tuple[str, ...]
    remarks: tuple[str, ...]


def import_robot(path: Path, answers: Answers) -> Imported:
    """Reads URDF, xacro, MJCF or SDF; BadInput where the file cannot be used, or where something must be asked for."""
    robot = read_robot(path, answers)
    ground = find_wheels(robot, answers)
    answers.check([wheel.name for wheel in ground.wheels])
    kinds = kinds_of(str(path), ground.wheels, answers)
    whole = add_up(robot.links.values())
    if whole.mass_kg <= 0.0:
        raise BadInput(f"{path}: all links are without mass; give them an <inertial>")
    return _Writer(robot, ground, kinds, whole, find_supports(robot, ground), answers).imported()


def in_one_line(text: str) -> str:
    """A comment or remark in which names of the file stand: what is no character of a line is written as its escape,
    since a line break in a name would end the comment, and what follows would be a key."""
    return "".join(each if each.isprintable() else each.encode("unicode_escape").decode("ascii") for each in text)


class _Writer:
    """Collects the tables and their comments."""

    def __init__(self, robot: Robot, ground: Ground, kinds: Sequence[Kind], whole: RigidBody,
                 supports: Sequence[Support], answers: Answers):
        self.robot, self.ground, self.kinds, self.whole = robot, ground, kinds, whole
        self.supports, self.answers = supports, answers
        self.comments: Comments = {}
        self.remarks = [*robot.remarks, *ground.remarks, *doubts_of(robot, ground, whole)]

    def imported(self) -> Imported:
        """All tables, checked by the core."""
        data: dict[str, Any] = {"name": self.robot.name, "source": f"{self.robot.path.name}, {self.robot.format}",
                                "vehicle": self.vehicle()}
        slips = self.answers.friction_coefficient is not None
        if slips:
            data["ground"] = self.ground_table(data["vehicle"]["wheel"])
        else:
            self.remark_friction()
        run = {"run": {"duration_s": DURATION_S, "step_s": FRICTION_STEP_S if slips else STEP_S}}
        data |= {"input": self.push(self.checked(data | run))} | run
        if slips:
            data["outputs"] = {"every_s": STEP_S}
        self.checked(data)
        assumed = [f"{_path(where)}: {why}" for where, why in self.comments.items()
                   if why.startswith("assumption") and where[-1] != "kind"]  # of kinds, words() tells
        comments = {where: in_one_line(why) for where, why in self.comments.items()}
        text = "\n".join([*map(in_one_line, self.head()), *lines_of(data, comments)]) + "\n"
        words, remarks = tuple(map(in_one_line, self.words())), tuple(map(in_one_line, self.remarks))
        return Imported(self.robot.name, text, words, tuple(map(in_one_line, assumed)), remarks)

    def ground_table(self, wheels: list[dict[str, Any]]) -> dict[str, float]:
        """`[ground]`, with the dry friction of the axles; a wheel whose own is another keeps it."""
        ground = {"friction_coefficient": float(self.answers.friction_coefficient or 0.0)}
        self.comments["ground", "friction_coefficient"] = "said with --friction"
        frictions = [_rounded(wheel.joint.friction_Nm) for wheel in self.ground.wheels]
        if any(frictions):
            ground["axle_friction_Nm"] = common = max(frictions, key=frictions.count)
            self.comments["ground", "axle_friction_Nm"] = "friction of the joints"
            for wheel, own in zip(wheels, frictions, strict=True):
                if own != common:
                    wheel["axle_friction_Nm"] = own
        return ground

    def remark_friction(self) -> None:
        """Says that the joints' dry friction is left out, as wheels have it on ground with friction alone."""
        rubbing = [f"{wheel.name} ({wheel.joint.friction_Nm:g} N·m)" for wheel in self.ground.wheels
                   if wheel.joint.friction_Nm > 0.0]
        if rubbing:
            self.remarks.append(f"friction of the joints is left out, which needs ground with friction: "
                                f"{', '.join(rubbing)}; --friction MU takes it as axle_friction_Nm")

    def checked(self, data: dict[str, Any]) -> Scene:
        """The scene that the tables make; what the core refuses is BadInput, by the robot's file."""
        scene = scene_of(Table(self.robot.path, "", copy.deepcopy(data)))
        try:
            scene.plant(scene.core())
        except Refused as refused:
            if refused.status in NEED_SLIP:
                raise BadInput(f"{self.robot.path}: {NEED_SLIP[refused.status]}; give --friction MU, so that wheels "
                               "may slip, or --rollers for wheels that have them") from None
            raise
        return scene

    def head(self) -> list[str]:
        """What the scene is, and what was left open."""
        told = [f"# {self.robot.name}, imported from {self.robot.path.name} ({self.robot.format}). The body frame is "
                "that of link",
                f"# {self.robot.base}; all joints are in their zero position.", *MOTOR]
        if any(wheel.joint.damping_Nms > 0.0 for wheel in self.ground.wheels):
            told += DAMPED
        if self.remarks:
            told += ["# Seen on the way:", *(f"#   {remark}" for remark in self.remarks)]
        return told

    def vehicle(self) -> dict[str, Any]:
        """`[vehicle]`: totals, what all wheels share, wheels, supports."""
        wheels = [self.wheel(i, w, k) for i, (w, k) in enumerate(zip(self.ground.wheels, self.kinds, strict=True))]
        vehicle = self.totals() | self.shared(wheels)
        vehicle["wheel"] = wheels
        if self.supports:
            vehicle["support"] = [self.support(i, each) for i, each in enumerate(self.supports)]
        return vehicle

    def totals(self) -> dict[str, Any]:
        """Mass, yaw inertia and centre of mass of the whole."""
        whole, count = self.whole, sum(link.mass_kg > 0.0 for link in self.robot.links.values())
        self.comments["vehicle", "mass_kg"] = f"sum of {count} links" if count > 1 else "of one link"
        self.comments["vehicle", "yaw_inertia_kgm2"] = "of all links about their common centre of mass"
        self.comments["vehicle", "com_z_m"] = "above the lowest point of the wheels"
        massless = [link.name for link in self.robot.links.values() if not link.has_inertia and link.shapes]
        if massless:
            self.remarks.append(f"links without <inertial> count as without mass: {', '.join(massless)}")
        yaw = float(whole.inertia_kgm2[2, 2])
        if yaw <= 0.0:
            raise BadInput(f"{self.robot.path}: the yaw inertia of all links is {yaw:g} kg·m²; give the links' "
                           "<inertia>")
        if (below_m := self.ground.height_m - float(whole.com_m[2])) > TOUCHING_M:
            raise BadInput(f"{self.robot.path}: the centre of mass lies {below_m:.3g} m below the lowest point of the "
                           "wheels; see the origins of the wheels' joints and of <inertial>")
        return {"mass_kg": _rounded(whole.mass_kg), "yaw_inertia_kgm2": _rounded(yaw),
                "com_x_m": _rounded(whole.com_m[0]), "com_y_m": _rounded(whole.com_m[1]),
                "com_z_m": _rounded(max(float(whole.com_m[2]) - self.ground.height_m, 0.0))}

    def wheel(self, index: int, wheel: FoundWheel, kind: Kind) -> dict[str, Any]:
        """One wheel, with a radius and an inertia of its own."""
        where = ("vehicle", "wheel", str(index))
        self.comments[(*where, "kind")] = f"{wheel.name}; {kind.why}" if kind.is_told else f"{kind.why} ({wheel.name})"
        if wheel.inertia_kgm2 <= 0.0:
            raise BadInput(f"{self.robot.path}: wheel {wheel.name} has no inertia about its axle; give its link an "
                           "<inertia>, or "
                           f"--wheel-inertia {wheel.name}=KGM2")
        off = float(np.linalg.norm(wheel.hub_m - wheel.joint.point_m))
        if off > 1e-3:
            self.comments[(*where, "x_m")] = f"middle of its shape, {1e3 * off:.0f} mm along the axle from the joint"
        table: dict[str, Any] = {"kind": kind.kind, "x_m": _rounded(wheel.hub_m[0]), "y_m": _rounded(wheel.hub_m[1]),
                                 "axle_deg": _rounded(np.degrees(wheel.axle_rad))}
        if kind.roller_deg is not None:
            table["roller_deg"] = _rounded(kind.roller_deg)
        table |= {"radius_m": _rounded(wheel.radius_m), "inertia_kgm2": _rounded(wheel.inertia_kgm2)}
        if wheel.joint.damping_Nms > 0.0:
            table["motor_damping_Nms"] = _rounded(wheel.joint.damping_Nms)
        return table

    def support(self, index: int, support: Support) -> dict[str, Any]:
        """A point that carries a load."""
        self.comments["vehicle", "support", str(index), "x_m"] = support.why
        return {"x_m": _rounded(support.x_m), "y_m": _rounded(support.y_m)}

    def shared(self, wheels: list[dict[str, Any]]) -> dict[str, float]:
        """What most wheels share stands once, at the vehicle; it is taken out of these wheels."""
        found = {}
        for key, (of_all, why) in SHARED.items():
            values = [wheel.get(key, 0.0) for wheel in wheels]
            value = max(values, key=values.count)
            if key == "motor_damping_Nms" and not any(values):
                continue
            found[of_all] = value
            self.comments["vehicle", of_all] = why
            for index, wheel in enumerate(wheels):
                if wheel.get(key, 0.0) == value:
                    wheel.pop(key, None)
                else:
                    wheel[key] = values[index]
        if "motor_damping_Nms" in found:
            found["motor_gain_Nm_per_V"] = 0.0
        return found

    def push(self, scene: Scene) -> list[dict[str, Any]]:
        """Torques that push the robot ahead, so that the scene shows a motion; none where it cannot roll ahead."""
        rolling = rolling_ahead(scene)
        if not rolling.any():
            self.remarks.append("the wheels do not let the robot roll straight ahead; no inputs are given")
            return []
        slips = "ground" in scene.vehicle  # only there have the axles their friction
        scale = scene.vehicle["mass_kg"] * ACCELERATION_M_PER_S2 / float(rolling @ rolling)
        inputs: list[dict[str, Any]] = []
        self.comments["input", "0", "signal"] = (f"assumption: these torques push ahead with about "
                                                 f"{ACCELERATION_M_PER_S2:g} m/s² "
                                                 f"for {PUSH_S:g} s")
        damping = np.array([wheel.joint.damping_Nms for wheel in self.ground.wheels])
        speed_m_per_s = speed_of_drag(float(damping @ rolling**2) / scene.vehicle["mass_kg"])
        for index, rate in enumerate(rolling):
            if abs(rate) > 1e-9 * np.abs(rolling).max():
                rubbing = np.sign(rate) * self.ground.wheels[index].joint.friction_Nm if slips else 0.0
                inputs.append({"signal": f"axle_torque_Nm[{index + 1}]", "kind": "steps", "t_s": [0.0, PUSH_S],
                               "value": [_rounded((scale + damping[index] * speed_m_per_s) * rate + rubbing), 0.0]})
        if goes_ahead(scene, {each["signal"]: each["value"][0] for each in inputs}):
            return inputs
        del self.comments["input", "0", "signal"]
        self.remarks.append("torques that roll the wheels ahead push the robot aside, too, by where its wheels and its "
                            "centre of mass are; no inputs are given")
        return []

    def words(self) -> list[str]:
        """A line for each wheel."""
        return [f"wheel {index + 1}: {wheel.name}, {kind.kind}"
                + (f" with rollers at {kind.roller_deg:.4g}°" if kind.roller_deg is not None else "")
                + f", radius {wheel.radius_m:.4g} m at {_place(wheel)} m; {kind.why}"
                for index, (wheel, kind) in enumerate(zip(self.ground.wheels, self.kinds, strict=True))]


def _place(wheel: FoundWheel) -> str:
    """Where it is, seen from above."""
    x, y = map(_rounded, wheel.hub_m[:2])
    return f"({x:.4g}, {y:.4g})"


def rolling_ahead(scene: Scene) -> np.ndarray:
    """Wheel speeds at 1 m/s ahead (rad/s); zeros where fixed wheels do not allow that motion."""
    core = scene.core()
    found = core.matrices(scene.c_vehicle(core))
    if found.constraint_rows.size and np.abs(found.constraint_rows[:, 0]).max() > 1e-9:
        return np.zeros(scene.wheel_count)
    return np.asarray(found.wheel_rows[:, 0] / scene.vehicle["wheel_radius_m"])


def goes_ahead(scene: Scene, torques: dict[str, float]) -> bool:
    """Whether a push from rest moves the robot along its ξ axis, aside by a small part of the way alone."""
    plant = scene.plant(scene.core())
    try:
        plant.run(torques, round(PUSH_S / scene.run.step_s))
    except Refused:
        return False
    way_m = plant.pose.x_m
    return way_m > 0.0 and max(abs(plant.pose.y_m), way_m * abs(plant.pose.heading_rad)) <= ASIDE * way_m


def speed_of_drag(decay_per_s: float) -> float:
    """The speed (m/s) whose damping a steady push must add, so that it ends as fast as without any.

    Half the speed at the end where damping is weak, nearly all of it where damping balances the push long before.
    """
    k = decay_per_s * PUSH_S
    return ACCELERATION_M_PER_S2 * PUSH_S * (1.0 / -math.expm1(-k) - 1.0 / k if k > 1e-6 else 0.5)


def _path(where: tuple[str, ...]) -> str:
    """`vehicle.support[1].x_m`, as messages name a value."""
    return "".join(f"[{int(part) + 1}]" if part.isdigit() else f".{part}" for part in where).lstrip(".")


def _rounded(value: float) -> float:
    number = float(f"{value:.{DIGITS}g}")
    return 0.0 if abs(number) < 1e-9 else number
