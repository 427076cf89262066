"""The scene of an imported robot: its numbers with their origin, and a mark at each that the file does not tell."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core import load
from laconic.errors import BadInput, Refused
from laconic.robot.importer.answers import Answers
from laconic.robot.importer.axle_lines import brought_to_meet, straightened
from laconic.robot.importer.axle_lines import lines_of as lines_of_axles
from laconic.robot.importer.dropped import doubts_of, drives_elsewhere, dropped_of, idle_of
from laconic.robot.importer.first_run import Damping, Promise, run_of, steadied, unrest_of
from laconic.robot.importer.formats import read_robot
from laconic.robot.importer.gravity import listed
from laconic.robot.importer.hung import on_one_axle
from laconic.robot.importer.push import (
    ACCELERATION_M_PER_S2,
    PUSH_S,
    REACHES,
    Axles,
    Push,
    push,
    tables_of,
)
from laconic.robot.importer.robot_tree import RigidBody, Robot, add_up
from laconic.robot.importer.rollers import Kind, kinds_of
from laconic.robot.importer.supports import Support, find_supports
from laconic.robot.importer.surfaces import grips_along
from laconic.robot.importer.wheels import FoundWheel, Ground, find_wheels
from laconic.scene import Scene, scene_of
from laconic.scene.axle_lines import meeting_point
from laconic.scene.scene_text import Comments, lines_of
from laconic.scene.standing import Standing, standing_of
from laconic.scene.table import Table

if TYPE_CHECKING:
    from laconic.simulation import Trajectory

DIGITS = 9
SQUARE = 1e-12  # of an axle along or across the body
TOUCHING_M = 1e-9  # a centre so little below the ground is on it, but for rounding
DURATION_S, STEP_S = 3.0, 0.01
FRICTION_STEP_S = 0.001
SHARED = {"radius_m": ("wheel_radius_m", "by the shapes of the wheels, unless said with --radius"),
          "inertia_kgm2": ("wheel_inertia_kgm2", "about the axle, rollers included, without gear and rotor"),
          "motor_damping_Nms": ("motor_damping_Nms", "damping of the joints")}
WITH_ARMATURE = "about the axle, rollers and the armature of joints included"
NEED_SLIP = {  # refusals of the core whose remedy is an option here
    "nothing moves": "plain wheels on these axles prevent every motion",
    "straight only": "plain wheels on parallel axles that are not one line only drive straight, whatever motors do"}
MOTOR = ("# The file does not tell the motors. With them, voltage_V[i] drives wheel i; their data sheet gives:",
         "#   [vehicle.motor]", "#   resistance_ohm = …", "#   torque_constant_Nm_per_A = …",
         "#   back_emf_Vs_per_rad = …")
GEAR = "#   gear_ratio = …"
DAMPED = ("#   viscous_friction_Nms = …      # the motor_damping_Nms below, divided by gear_ratio²",
          "# [vehicle.motor] takes the place of every motor_gain_Nm_per_V and motor_damping_Nms: take these lines out.")
LOADS = ("wheel_load_N", "support_load_N")  # outputs where friction makes them matter


@dataclass(frozen=True)
class Imported:
    """The scene as TOML text, and what the user should know of it, a line each."""

    name: str
    text: str
    wheels: tuple[str, ...]
    assumptions: tuple[str, ...]
    remarks: tuple[str, ...]
    supports: tuple[str, ...]
    standing: Standing
    hinges: tuple[str, ...] = ()


def import_robot(path: Path, answers: Answers) -> Imported:
    """Reads URDF, xacro, MJCF or SDF; BadInput where the file cannot be used, or where something must be asked for."""
    robot = read_robot(path, answers)
    ground = find_wheels(robot, answers)
    on_hinges = [wheel for wheel in ground.casters if wheel.swivel] if answers.with_hinges else []
    answers.check([wheel.name for wheel in (*ground.wheels, *on_hinges)])
    count = len(ground.wheels) + len(on_hinges)
    if count > (room := load("double").max_wheels):
        raise BadInput(f"{path}: has {count} wheels, and this build of the core has room for {room}; give "
                       "--wheel JOINT for those that count")
    wheels, straight = straightened(ground.wheels)
    if any(wheel.is_steered for wheel in on_hinges) and not answers.rollers and not any(
            wheel.rollers or wheel.surface and grips_along(wheel.surface) is not None for wheel in wheels):
        wheels, merged = on_one_axle(wheels, robot.base) if wheels else (wheels, [])
        straight = [*straight, *merged]
    kinds = kinds_of(str(path), wheels, answers)
    if kinds and all(kind.kind == "fixed" for kind in kinds):
        wheels, meeting = brought_to_meet(wheels)
        straight = [*straight, *meeting]
    ground = replace(ground, wheels=tuple(wheels), remarks=(*straight, *ground.remarks))
    whole = add_up(robot.links.values())
    if whole.mass_kg <= 0.0:
        raise BadInput(f"{path}: all links are without mass; give them an <inertial>")
    if on_hinges:
        from laconic.robot.importer.hung_writer import HungWriter  # which builds on this module

        return steadied(lambda *how: HungWriter(robot, how[0], kinds, whole, answers, how[1]), ground, whole.mass_kg)
    return steadied(lambda *how: Writer(robot, how[0], kinds, whole, answers, how[1]), ground, whole.mass_kg)


def in_one_line(text: str) -> str:
    """A comment or remark in which names of the file stand: what is no character of a line is written as its escape,
    since a line break in a name would end the comment, and what follows would be a key."""
    return "".join(each if each.isprintable() else each.encode("unicode_escape").decode("ascii") for each in text)


class Writer:
    """Collects the tables and their comments."""

    def __init__(self, robot: Robot, ground: Ground, kinds: Sequence[Kind], whole: RigidBody, answers: Answers,
                 damping: Damping | None = None):
        self.robot, self.ground, self.kinds, self.whole, self.answers = robot, ground, kinds, whole, answers
        self.damping, self.promise, self.fault = damping, Promise(None), ""
        self.comments: Comments = {}
        self.every = ground  # with the wheels on hinges
        self.begin()

    def begin(self) -> None:
        """What stands on the ground besides wheels, who drives, and what is to be remarked."""
        self.supports, untouching = find_supports(self.robot, self.ground)
        self.idle = idle_of(self.ground)
        self.remarks = [*self.robot.remarks, *self.ground.remarks, *untouching, *self.doubts(self.ground)]

    def doubts(self, ground: Ground) -> list[str]:
        """Numbers that no robot has, and what the scene does not take."""
        return [*doubts_of(self.robot, ground, self.whole, self.answers), *dropped_of(ground, self.answers)]

    def imported(self) -> Imported:
        """All tables, checked by the core."""
        data: dict[str, Any] = {"name": self.robot.name, "source": f"{self.robot.path.name}, {self.robot.format}",
                                "vehicle": self.vehicle()}
        slips = self.answers.friction_coefficient is not None
        if slips:
            data["ground"] = self.ground_table(data["vehicle"]["wheel"])
        else:
            self.remark_friction()
        names = [in_one_line(wheel.name) for wheel in self.ground.wheels]
        if names and all(names) and len(set(names)) == len(names):
            data["base"] = {"joint_names": names}
            self.comments["base", "joint_names"] = "for laconic ros2"
        run = {"run": {"duration_s": DURATION_S, "step_s": FRICTION_STEP_S if slips else STEP_S}}
        scene = self.checked(data | run)
        standing = standing_of(scene)
        self.remark_standing(scene, standing)
        data |= {"input": self.push(scene)} | run
        if slips:
            data["outputs"] = {"every_s": STEP_S, "signals": self.signals(data)}
        self.judge(self.checked(data))
        return self.written(data, standing)

    def judge(self, scene: Scene, run: Trajectory | None = None) -> None:
        """Remarks where the first run is unstable or not what its line says; `run`: that run, if there is one yet."""
        if scene.inputs and (run := run or run_of(scene)):
            self.fault = unrest_of(scene, run, self.promise, self.ground.wheels, self.whole.com_m)
        if self.fault:
            self.remarks.append(self.fault)

    def motors(self) -> list[str]:
        """The driven wheels."""
        return [wheel.name for wheel in self.ground.wheels if wheel.joint not in self.idle]

    def written(self, data: dict[str, Any], standing: Standing, hinges: Sequence[str] = ()) -> Imported:
        """The tables as text with their comments, and what is told besides."""
        assumed = [f"{_path(where)}: {why}" for where, why in self.comments.items()
                   if why.startswith("assumption") and where[-1] != "kind"]  # of kinds, words() tells
        for index, (each, load_N) in enumerate(zip(self.supports, standing.support_N, strict=True)):
            self.comments["vehicle", "support", str(index), "x_m"] = f"{each.why}; carries {standing.share(load_N)}"
        comments = {where: in_one_line(why) for where, why in self.comments.items()}
        text = "\n".join([*map(in_one_line, self.head()), *lines_of(data, comments)]) + "\n"
        words, assumptions, remarks, supports, hung = (tuple(map(in_one_line, each)) for each in (
            self.words(), assumed, self.remarks, self.words_of_supports(standing), hinges))
        return Imported(self.robot.name, text, words, assumptions, remarks, supports, standing, hung)

    def signals(self, data: dict[str, Any]) -> list[str]:
        """The usual outputs, and the loads, by which wheels grip or slip."""
        from laconic.simulation.run import USUAL

        return [*USUAL, LOADS[0], *(LOADS[1:] if data["vehicle"].get("support") else ())]

    def remark_standing(self, scene: Scene, standing: Standing) -> None:
        """Says what tips the robot, and that plain wheels leave it a rotation alone."""
        if standing.tips:
            unread = [link.name for link in self.robot.links.values() if link.unread]
            hint = f"; meshes of {listed(unread)} were not read, and may touch the ground" if unread else ""
            self.remarks.append(f"the robot: {standing.tips}{hint}")
        if scene.model(scene.core()).dof == 1 and not self.answers.friction_coefficient:
            self.remarks.append("plain wheels on these axles leave the robot one motion alone, a rotation about the "
                                f"point where the axles meet{self.meeting()}")

    def meeting(self) -> str:
        """Where that is, and the angle that makes it so."""
        lines = lines_of_axles(self.ground.wheels)
        point = meeting_point(lines)
        if point is None:
            return ""
        index = max(range(len(lines)), key=lambda k: lines[0].angle_to(lines[k]))
        angle = np.degrees(lines[0].angle_to(lines[index]))
        names = [wheel.name for wheel in self.ground.wheels]
        return (f", ({point[0]:.4g}, {point[1]:.4g}) m: the axle of {names[index]} is {angle:.3g}° from that of "
                f"{names[0]}")

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
                               "may slip, or --rollers for wheels that have them"
                               f"{self.hindering(refused)}") from None
            raise
        return scene

    def hindering(self, refused: Refused) -> str:
        """The wheel that the core names, and by how much it hinders."""
        names = [wheel.name for wheel in self.ground.wheels]
        if not 0 < refused.item <= len(names):
            return ""
        if refused.status == "straight only":
            return f" (the axle of {names[refused.item - 1]} lies {refused.value:.3g} m beside that of {names[0]})"
        return f" ({names[refused.item - 1]} would slide by {100.0 * refused.value:.3g} % of its way)"

    def head(self) -> list[str]:
        """What the scene is, and what was left open."""
        told = [f"# {self.robot.name}, imported from {self.robot.path.name} ({self.robot.format}). The body frame is "
                "that of link",
                f"# {self.robot.base}; all joints are in their zero position.", *MOTOR, self.gear()]
        if any(wheel.joint.damping_Nms > 0.0 for wheel in self.every.wheels):
            told += DAMPED[1:] if self.damping else DAMPED
        if self.remarks:
            told += ["# Seen on the way:", *(f"#   {remark}" for remark in self.remarks)]
        return told

    def gear(self) -> str:
        """The line of the gear ratio, with what the file tells of it."""
        gears: dict[float, str] = {}
        for command in (each for wheel in self.every.wheels for each in wheel.joint.commands):
            if command.gear:
                gears.setdefault(command.gear, command.what)
        return GEAR + (f"      # {', '.join(f'{gear:g} ({what})' for gear, what in gears.items())}" if gears else "")

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
        if wheel.inertia_kgm2 <= 0.0 and self.needs_inertia(wheel):
            raise BadInput(f"{self.robot.path}: wheel {wheel.name} has no inertia about its axle; give its link an "
                           "<inertia>, or "
                           f"--wheel-inertia {wheel.name}=KGM2")
        off = float(np.linalg.norm(wheel.hub_m - wheel.joint.point_m))
        if off > 1e-3:
            self.comments[(*where, "x_m")] = f"middle of its shape, {1e3 * off:.0f} mm along the axle from the joint"
        exact = _rounded if min(map(abs, wheel.axle[:2])) < SQUARE else float  # lines of any other direction must meet
        table: dict[str, Any] = {"kind": kind.kind, "x_m": exact(wheel.hub_m[0]), "y_m": exact(wheel.hub_m[1]),
                                 "axle_deg": exact(np.degrees(wheel.axle_rad))}
        if kind.roller_deg is not None:
            table["roller_deg"] = _rounded(kind.roller_deg)
        table |= {"radius_m": _rounded(wheel.radius_m), "inertia_kgm2": _rounded(wheel.inertia_kgm2)}
        if wheel.joint.damping_Nms > 0.0:
            table["motor_damping_Nms"] = _rounded(wheel.joint.damping_Nms)
        elif wheel.joint in self.idle:
            table["driven"] = False
            self.comments[(*where, "driven")] = "the file commands other joints, and not this one"
        return table

    def needs_inertia(self, wheel: FoundWheel) -> bool:
        """Whether the file must have that of a wheel."""
        return True

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
            if key == "motor_damping_Nms" and self.damping:
                self.comments["vehicle", of_all] = self.damping.words(value)
            if key == "inertia_kgm2" and any(wheel.joint.armature_kgm2 for wheel in self.every.wheels):
                self.comments["vehicle", of_all] = WITH_ARMATURE
            for index, wheel in enumerate(wheels):
                if wheel.get(key, 0.0) == value:
                    wheel.pop(key, None)
                else:
                    wheel[key] = values[index]
        if "motor_damping_Nms" in found:
            found["motor_gain_Nm_per_V"] = 0.0
        return found

    def push(self, scene: Scene) -> list[dict[str, Any]]:
        """Torques that push the robot ahead, or else as its wheels let it move, so that the scene shows a motion. Where
        a wheel drives it that is not modelled, a force takes its place."""
        slips = "ground" in scene.vehicle  # only there have the axles their friction
        wheels = self.ground.wheels
        axles = Axles(np.array([wheel.joint.damping_Nms for wheel in wheels]),
                      np.array([wheel.joint.friction_Nm if slips else 0.0 for wheel in wheels]),
                      np.array([wheel.joint not in self.idle for wheel in wheels]))
        elsewhere = drives_elsewhere(self.ground)
        by_force = not axles.are_driven.any()
        found = push(scene, axles, by_force)
        if found.why_not:
            self.remarks.append(self.named(found.why_not))
            return []
        what = f"these torques {found.way}"
        if by_force:
            what = (f"this force takes the place of {' and '.join(elsewhere)} and "
                    + found.way.replace("push", "pushes").replace("turn", "turns"))
        self.promise = Promise(None if found.straight is None else np.array(found.straight), fast_at_s=PUSH_S)
        self.comments["input", "0", "signal"] = f"assumption: {what}{found.measured} {self.reached(found)}"
        if found.instead:
            self.remarks.append(self.named(f"{found.instead}; the inputs {found.way} instead"))
        return tables_of(found.values, scene.run.step_s, _rounded)

    def named(self, text: str) -> str:
        """With the joint's name behind the number of a wheel."""
        for index, wheel in enumerate(self.ground.wheels, 1):
            text = text.replace(f"of wheel {index} is", f"of wheel {index} ({wheel.name}) is")
        return text

    @staticmethod
    def reached(found: Push) -> str:
        """How fast the push is, as far as wheels do not slip."""
        wanted = ACCELERATION_M_PER_S2 * PUSH_S
        if abs(found.speed_m_per_s / wanted - 1.0) <= REACHES:
            return f"with about {ACCELERATION_M_PER_S2:g} m/s² for {PUSH_S:g} s"
        return f"for {PUSH_S:g} s and reach {found.speed_m_per_s:.2g} m/s, as wheels slip"

    def words(self) -> list[str]:
        """A line for each wheel."""
        return [f"wheel {index + 1}: {wheel.name}, {kind.kind}"
                + (f" with rollers at {kind.roller_deg:.4g}°" if kind.roller_deg is not None else "")
                + f", radius {wheel.radius_m:.4g} m at {_place(wheel)} m; {kind.why}"
                for index, (wheel, kind) in enumerate(zip(self.ground.wheels, self.kinds, strict=True))]

    def words_of_supports(self, standing: Standing) -> list[str]:
        """The same of each support."""
        return [f"support {index + 1}: {each.name} at ({each.x_m:.4g}, {each.y_m:.4g}) m; carries "
                + standing.share(standing.support_N[index]) for index, each in enumerate(self.supports)]


def _place(wheel: FoundWheel) -> str:
    """Where it is, seen from above."""
    x, y = map(_rounded, wheel.hub_m[:2])
    return f"({x:.4g}, {y:.4g})"


def _path(where: tuple[str, ...]) -> str:
    """`vehicle.support[1].x_m`, as messages name a value."""
    return "".join(f"[{int(part) + 1}]" if part.isdigit() else f".{part}" for part in where).lstrip(".")


def _rounded(value: float) -> float:
    number = float(f"{value:.{DIGITS}g}")
    return 0.0 if abs(number) < 1e-9 else number
