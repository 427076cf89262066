"""A mobile base whose vehicle has hinges: cars, swerve drives, tricycles, loaders; robots with casters or trailers.

The base turns its steered hinges so that their wheels roll along the commanded motion. The wheels' set speeds are those
of the part of the command that the hinges allow at their present angles. Casters and trailers follow by themselves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from laconic.core import Core
from laconic.core.articulated import ArticulatedPlant
from laconic.errors import BadInput, Refused
from laconic.ros2.base import TWIST_NAMES, Base, Loop, driven_wheels, loop_of
from laconic.ros2.chassis import STRAIGHT, Chassis, Steering
from laconic.ros2.motion import Motion, Seen, felt, of_origin
from laconic.scene import Scene
from laconic.scene.base import BaseTable
from laconic.simulation.articulated import follow_rows, start_plant, trailers_of, watched_hinges
from laconic.simulation.kept_rows import Folds, refusal_of_run
from laconic.simulation.loads import Loads, centre_of
from laconic.simulation.steering import Commands, LiveInputs

STEERING_RAD_PER_S = 10.0    # of a hinge whose scene gives no limit, as small servos have
MARGIN_S = 0.02              # between looks at what the ground must give


class Hinged:
    """One robot with hinges."""

    def __init__(self, scene: Scene, core: Core, of_wheels: Sequence[str], chassis: Chassis):
        self.steering = Steering(chassis, scene, scene.base or BaseTable())
        self.scene, self.live = scene, LiveInputs([*of_wheels, *self.steering.signals], scene.run.step_s)
        vehicle = scene.articulated_vehicle(core)
        self._first, count = len(of_wheels), len(self.steering.signals)
        self.live.values[self._first :] = [*STRAIGHT, *[0.0] * (count - 3)] if vehicle.is_coordinated else 0.0
        self.commands = Commands(scene, vehicle, self.live)
        self.row = self.commands.first_row()
        self.plant: ArticulatedPlant = start_plant(scene, vehicle, self.row)
        self.motion, self.has_refused = self.plant.motion(), False
        self.watched = watched_hinges(scene)
        self.steps = 0
        self.before: tuple[float, float, float] | None = None  # velocity at the last look
        self.margin_N, self.margin_steps = math.inf, 0
        self.folds, self.folds_told = Folds(trailers_of(scene, vehicle)), set[str]()

    def steer(self, rate_limit: float) -> None:
        """Sets what turns the hinges in the coming step; the first keeps them, as a record begins with their twist."""
        if self.steps:
            self.live.values[self._first :] = self.steering.inputs(self.motion, rate_limit)

    def step(self, given: np.ndarray) -> None:
        """One step with these voltages or torques of the wheels."""
        self.live.values[: self._first] = given
        table = self.commands.rows(self.steps, 1)
        if self.commands.refused:
            raise self.commands.refused
        follow_rows(self.plant, table, self.watched)
        self.row, self.steps, self.motion = table[-1, 1], self.steps + 1, self.plant.motion()


class HingedRobots:
    """Robots with hinges, one by one."""

    def __init__(self, scene: Scene, robots: int, of_wheels: Sequence[str], chassis: Chassis):
        self.scene, self.core, self.steps = scene, scene.core(), 0
        self._of_wheels, self._chassis = of_wheels, chassis
        self._centre, self._loads = centre_of(scene.vehicle), Loads(scene)
        self.robots = [self._new(scene) for _ in range(robots)]

    def _new(self, scene: Scene) -> Hinged:
        return Hinged(scene, self.core, self._of_wheels, self._chassis)

    def step(self, given: np.ndarray) -> list[tuple[int, Refused]]:
        """As Motion.step."""
        self.steps += 1
        refusals = []
        for number, each in enumerate(self.robots):
            if not each.has_refused:
                try:
                    each.step(given[:, number])
                except Refused as refused:
                    each.has_refused = True
                    refusals.append((number, refusal_of_run(self.scene, refused)))
        return refusals

    def speeds(self) -> np.ndarray:
        """As Motion.speeds."""
        return np.stack([each.motion.wheel_speed_rad_per_s for each in self.robots], axis=1).astype(float)

    def look(self, robot: int, period_s: float) -> Seen:
        """As Motion.look; encoders and IMU are ideal, and the IMU shows the mean acceleration since the last look."""
        each = self.robots[robot]
        motion, (x, y) = each.motion, self._loads.origin_of(each.motion)
        now = of_origin((self._centre.real, self._centre.imag), motion.velocity_m_per_s, motion.yaw_rate_rad_per_s)
        before, each.before = each.before or now, now
        self._watch(each)
        each.folds.take(motion.hinge_angle_rad[None], np.array([each.steps * self.scene.run.step_s]))
        angles, hinges = motion.wheel_angle_rad.astype(float), motion.hinge_angle_rad.astype(float)
        return Seen(x, y, motion.heading_rad, now, angles.tolist(), motion.wheel_speed_rad_per_s.tolist(),
                    np.concatenate([angles, hinges]), felt(before, now, period_s), None,
                    hinges.tolist(), motion.hinge_rate_rad_per_s.tolist())

    def _watch(self, each: Hinged) -> None:
        """Keeps the least margin to the friction limit, now and then."""
        if not self.scene.vehicle["friction_coefficient"] or \
                (each.steps - each.margin_steps) * self.scene.run.step_s < MARGIN_S:
            return
        each.margin_steps = each.steps
        try:
            found = each.plant.reactions(each.row, self._loads.under(each.plant, each.motion, each.row))
        except Refused:
            return  # a posture that has no reactions, which the next step refuses
        each.margin_N = min(each.margin_N, found.no_slip_margin_N)

    def restart(self, robot: int) -> None:
        """As Motion.restart."""
        self.robots[robot] = self._new(self.scene)

    def place(self, robot: int, x_m: float, y_m: float, heading_rad: float) -> None:
        """As Motion.place; hinges are as at the scene's start."""
        centre = self._centre * complex(math.cos(heading_rad), math.sin(heading_rad))
        start = replace(self.scene.initial, x_m=x_m + centre.real, y_m=y_m + centre.imag, heading_rad=heading_rad,
                        velocity_body_m_per_s=(0.0, 0.0), yaw_rate_rad_per_s=0.0)
        hinges = tuple(replace(hinge, start_rate_rad_per_s=0.0) for hinge in self.scene.hinges)
        self.robots[robot] = self._new(replace(self.scene, initial=start, hinges=hinges))

    def folded(self, robot: int) -> Sequence[str]:
        """As Motion.folded."""
        each = self.robots[robot]
        found = [fold for fold in each.folds.found() if fold.hinge not in each.folds_told]
        each.folds_told |= {fold.hinge for fold in found}
        return [f"{fold.hinge} folds: its hinge angle is beyond 90°; {fold.remedy()}" for fold in found]

    def has_refused(self, robot: int) -> bool:
        """As Motion.has_refused."""
        return self.robots[robot].has_refused

    def grip(self, robot: int) -> str:
        """As Motion.grip."""
        each = self.robots[robot]
        found, each.margin_N = each.margin_N, math.inf
        return f"wheels would slip: the ground had to hold {-found:.3g} N more than friction allows" if found < 0.0 \
            else ""


class HingedBase(Base):
    """Robots with hinges that follow velocity commands."""

    motion: HingedRobots

    def _make(self, robots: int) -> tuple[Motion, Loop]:
        scene, table = self.scene, self.table
        if scene.vehicle.get("ground", {}).get("friction_coefficient"):
            raise BadInput(f"{scene.path}: ground.friction_coefficient: laconic ros2 drives vehicles with hinges on "
                           "ideal ground alone; take it out, and give vehicle.friction_coefficient for the margin")
        most = table.steering_rate_limit_rad_per_s or STEERING_RAD_PER_S
        driven = driven_wheels(scene)
        self.believed = Chassis(scene, most, size=table.believed_size, radius_m=table.believed_radius_m)
        self._measured = self.believed.is_known & np.array(driven)
        if not self._measured.any():
            raise BadInput(f"{scene.path}: vehicle.wheel: no driven wheel is on the carriage or on what steers, so no "
                           "command can move the robot; give one with driven = true")
        self.loop = loop_of(scene, table, self.believed.radius_m.tolist())
        self._rate_limit = np.full(robots, math.inf)
        self._own_ramps = np.full(robots, math.inf)
        return HingedRobots(scene, robots, super().signals, self.believed), self.loop

    def _travelled(self, before: np.ndarray, after: np.ndarray) -> Sequence[float]:
        count = len(self._measured)  # the angles of all hinges are behind those of the wheels
        return self.believed.travelled(before[count:], after[count:], after[:count] - before[:count], self._measured)

    @property
    def signals(self) -> list[str]:
        """As in Base."""
        return [*super().signals, *self.motion.robots[0].steering.signals]

    # ---- commands

    def command(self, robot: int, ahead: float, left: float, yaw_rate: float) -> list[str]:
        """As in Base; a car that cannot turn so tightly keeps its speed and turns less."""
        return self._follow(robot, np.array([ahead, left, yaw_rate]), TWIST_NAMES)

    @property
    def is_car(self) -> bool:
        """As in Base: one fixed axle, and steered wheels ahead of or behind it."""
        return self.believed.wheelbase_m is not None

    def ackermann(self, robot: int, speed_m_per_s: float, steering_rad: float, *, acceleration_m_per_s2: float = 0.0,
                  steering_rad_per_s: float = 0.0) -> list[str]:
        """As in Base; 0 for an acceleration or a rate means the scene's limits."""
        base_m, axle_m = self.believed.wheelbase_m, self.believed.axle_x_m
        assert base_m is not None and axle_m is not None
        curvature = math.tan(steering_rad) / base_m
        line = np.array([1.0, -axle_m * curvature, curvature])
        angles = self.motion.robots[robot].motion.hinge_angle_rad
        possible = self.believed.possible(line, angles)
        self.motion.robots[robot].steering.goal = possible
        remarks = self._follow(robot, speed_m_per_s * possible, ())
        got = math.atan(possible[2] / possible[0] * base_m) if possible[0] else 0.0
        if abs(got - steering_rad) > 1e-6:
            remarks.append(f"a steering angle of {steering_rad:g} rad is limited to {got:g} rad")
        self._rate_limit[robot] = steering_rad_per_s or math.inf
        self._own_ramps[robot] = acceleration_m_per_s2 or math.inf
        return remarks

    def _follow(self, robot: int, given: np.ndarray, names: Sequence[str]) -> list[str]:
        each = self.motion.robots[robot]
        wanted = self.believed.possible(given, each.motion.hinge_angle_rad)
        remarks = [*self._impossible(names, given, wanted), *self._limit(wanted)]
        if wanted.any() and (each.steering.clear(wanted) != wanted).any():
            remarks.append("a turning centre in a steered wheel is moved beside it")
        if wanted.any():
            each.steering.goal = wanted / float(np.abs(wanted).max())
        self._wanted[:, robot] = wanted
        self._rate_limit[robot] = self._own_ramps[robot] = math.inf
        return remarks

    def _ramp(self) -> None:
        """As in Base; a car changes its speed so, and its yaw rate with it."""
        own = np.minimum(self.table.acceleration_limit_m_per_s2 or math.inf, self._own_ramps)
        self._ramps = (own if np.isfinite(own).any() else None, self._ramps[1])
        super()._ramp()
        if self.believed.wheelbase_m is None:
            return
        for robot, each in enumerate(self.motion.robots):
            ahead, left, turn = each.steering.goal
            if ahead:
                self._set[1:, robot] = self._set[0, robot] / ahead * np.array([left, turn])

    def _aim(self) -> None:
        """Steers, and makes the wheels' set speeds of what the hinges allow at their present angles."""
        if (self._set != self._wanted).any():
            self._ramp()
        for robot, each in enumerate(self.motion.robots):
            if each.has_refused:
                continue
            each.steer(float(self._rate_limit[robot]))
            along = each.steering.twist if each.commands.vehicle.is_coordinated else None
            rolling, sliding = self.believed.rows(each.motion.hinge_angle_rad)
            allowed, caused = self.believed.allowed(sliding, along)
            rates = each.motion.hinge_rate_rad_per_s
            twist = allowed @ self._set[:, robot] + caused @ rates
            self._set_speeds[:, robot] = rolling[:, :3] @ twist + rolling[:, 3:] @ rates

    def _inputs(self, given: np.ndarray) -> np.ndarray:
        return np.concatenate([given[:, 0], self.motion.robots[0].live.values[self.wheel_count :]])


def base_of(scene: Scene, robots: int = 1) -> Base:
    """The base of a scene of any kind."""
    return HingedBase(scene, robots) if scene.has_hinges else Base(scene, robots)
