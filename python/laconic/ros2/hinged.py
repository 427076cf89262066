"""A mobile base whose vehicle has hinges: cars, swerve drives, tricycles, loaders; robots with casters or trailers.

The base turns its steered hinges so that their wheels roll along the commanded motion. The wheels' set speeds are those
of the part of the command that the hinges allow at their present angles. Casters and trailers follow by themselves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from laconic.can.play.vehicle import about_hinge
from laconic.core import Core
from laconic.core.articulated import ArticulatedMotion, ArticulatedPlant
from laconic.errors import BadInput, Refused
from laconic.ros2.base import Base, Loop, Odometry, driven_wheels, loop_of
from laconic.ros2.chassis import STRAIGHT, Chassis, Steered
from laconic.ros2.motion import Motion, Seen
from laconic.scene import Scene
from laconic.scene.base import BaseTable
from laconic.scene.hinge_signals import RATE, TWIST, VOLTAGE
from laconic.scene.hinges import Hinge
from laconic.simulation.articulated import follow_rows, start_plant
from laconic.simulation.loads import Loads, centre_of
from laconic.simulation.steering import Commands, LiveInputs

STEERING_RAD_PER_S = 10.0    # of a hinge whose scene gives no limit, as small servos have
BANDWIDTH_RAD_PER_S = 8.0    # of a steering motor's controller, which is damped critically
INSET_RAD = 1e-6             # what the base keeps away from a stop, so that the scene's own limits never act
OF_MOTOR_RAD = 5e-3          # the same where a motor steers, which may pass its goal
CLEAR_RAD = 0.02             # of a turning centre from a steered wheel, in twists scaled by the vehicle's length
AROUND_RAD = 0.1             # the same on the way to another twist
SHARE = 1.0 - 1e-9           # of a rate limit, for the same reason
HALVINGS = 30
MARGIN_S = 0.02              # between looks at what the ground must give


class Steering:
    """Turns the steered hinges of one robot towards a motion, within rates and stops."""

    def __init__(self, chassis: Chassis, scene: Scene, table: BaseTable):
        self.step_s, self._size = scene.run.step_s, table.believed_size
        self._most_V = table.steering_voltage_limit_V or math.inf
        self.twist, self.goal = STRAIGHT, STRAIGHT  # of coordinated hinges, and the direction that is wished
        self._coordinated = [each for each in chassis.steered if each.kind == "coordinated"]
        self._singly = [each for each in chassis.steered if each.kind != "coordinated"]
        self._places = np.array([each.place for each in self._coordinated])
        self._rates = np.array([each.rate_limit_rad_per_s for each in self._coordinated])
        self._lows = np.array([each.low_rad + INSET_RAD for each in self._coordinated])
        self._highs = np.array([each.high_rad - INSET_RAD for each in self._coordinated])
        self._motors = {each.name: self._motor(scene, each.at) for each in self._singly if each.kind == "motor"}
        self._scale = np.array([1.0, 1.0, chassis.length_m])
        self._poles = _poles(self._places, self._scale) if chassis.axle_x_m is None else np.zeros((0, 3))

    @property
    def signals(self) -> list[str]:
        """The inputs that it sets."""
        found = [f"{TWIST}[{number}]" for number in (1, 2, 3)] if self._coordinated else []
        return found + [f"{RATE if each.kind == 'prescribed' else VOLTAGE}[{each.name}]" for each in self._singly]

    def inputs(self, motion: ArticulatedMotion, rate_limit: float) -> list[float]:
        """Values of `signals` for the coming step."""
        angles, found = motion.hinge_angle_rad, list[float]()
        if self._coordinated:
            self._turn(angles, rate_limit)
            ahead, left, turn = self.twist.tolist()
            found += [ahead, left, turn * self._size]  # as the true places of the hinges need it
        for each in self._singly:
            angle = each.angle(self.goal, float(angles[each.at]))
            inset = INSET_RAD if each.kind == "prescribed" else OF_MOTOR_RAD
            goal = min(max(angles[each.at] if angle is None else angle, each.low_rad + inset), each.high_rad - inset)
            if each.kind == "prescribed":
                most = SHARE * min(each.rate_limit_rad_per_s, rate_limit)
                found.append(min(max((goal - float(angles[each.at])) / self.step_s, -most), most))
            else:
                found.append(self._voltage(each, goal - float(angles[each.at]),
                                           float(motion.hinge_rate_rad_per_s[each.at]), rate_limit))
        return found

    # ---- hinges that share one twist

    def _turn(self, angles: np.ndarray, rate_limit: float) -> None:
        """Takes the twist of coordinated hinges as far towards the goal as rates and stops allow in one step."""
        mine = angles[[each.at for each in self._coordinated]]
        goal = self.clear(self.goal)
        targets = [self._via(unit(sign * goal, self._scale)) for sign in (1.0, -1.0)]
        turns = [self._turns(self.twist, each) for each in targets]
        ways = sorted(range(2), key=lambda k: (bool(self._beyond(mine + turns[k])), float(np.abs(turns[k]).max())))
        target, turn = targets[ways[0]], turns[ways[0]]
        rates = SHARE * self.step_s * np.minimum(self._rates, rate_limit)
        if not turn.any() and not (target != self.twist).any():
            return
        if (np.abs(turn) <= rates).all() and not self._beyond(mine + turn):
            self.twist = target
            return
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            turn = self._turns(self.twist, self.twist + middle * (target - self.twist))
            is_far = (np.abs(turn) > rates).any() or self._beyond(mine + turn)
            low, high = (low, middle) if is_far else (middle, high)
        if low:
            self.twist = unit(self.twist + low * (target - self.twist), self._scale)

    def clear(self, twist: np.ndarray) -> np.ndarray:
        """The twist, or one beside it, about whose centre every steered wheel can point."""
        made = unit(twist, self._scale) * self._scale
        for pole in self._poles:
            along = float(made @ pole)
            if along > math.cos(CLEAR_RAD):
                aside = made - along * pole
                if np.linalg.norm(aside) < 1e-9:
                    aside = np.cross(pole, [1.0, 0.0, 0.0] if abs(pole[0]) < 0.9 else [0.0, 1.0, 0.0])
                made = math.cos(CLEAR_RAD) * pole + math.sin(CLEAR_RAD) * aside / np.linalg.norm(aside)
                return np.asarray(made / self._scale)
        return twist

    def _via(self, target: np.ndarray) -> np.ndarray:
        """The target, or where to go first, so that on the way no turning centre lies in a steered wheel.

        Twists of one size are points on a sphere, and those that leave a wheel without a direction its poles."""
        now, goal = self.twist * self._scale, target * self._scale
        axis = np.cross(now, goal)
        size = float(np.linalg.norm(axis))
        if size < 1e-9 or not len(self._poles):
            return target
        axis /= size
        ahead, first, found = np.cross(axis, now), math.atan2(size, float(now @ goal)), target
        for pole in self._poles:
            off = float(axis @ pole)
            wide = min(AROUND_RAD, 0.5 * math.acos(min(max(float(goal @ pole), -1.0), 1.0)))
            along = math.atan2(float(pole @ ahead), float(pole @ now))
            if abs(off) < wide and 0.0 < along < first:
                aside = math.copysign(1.0, -off) * (axis - off * pole)
                aside /= np.linalg.norm(aside)
                first = along
                found = (math.cos(1.2 * wide) * pole + math.sin(1.2 * wide) * aside) / self._scale
        return found

    def _beyond(self, angles: np.ndarray) -> bool:
        return bool(((angles > self._highs) | (angles < self._lows)).any())

    def _velocities(self, twist: np.ndarray) -> np.ndarray:
        found: np.ndarray = complex(twist[0], twist[1]) + 1j * twist[2] * self._places
        return found

    def _turns(self, now: np.ndarray, then: np.ndarray) -> np.ndarray:
        return np.asarray(np.angle(self._velocities(then) * np.conj(self._velocities(now))))

    # ---- hinges with motors

    def _motor(self, scene: Scene, at: int) -> tuple[float, float]:
        """P [V/rad] and D [V·s/rad] of a steering motor."""
        body = scene.vehicle["body"][at]
        gain, bandwidth = body["gain_Nm_per_V"], min(BANDWIDTH_RAD_PER_S, 0.1 / self.step_s)
        inertia = about_hinge(body)
        damping = max(2.0 * bandwidth * inertia - body.get("damping_Nms", 0.0), 0.0)
        stiffness = bandwidth * max(bandwidth * inertia, 0.5 * body.get("damping_Nms", 0.0))
        return stiffness / gain, damping / gain

    def _voltage(self, each: Steered, way: float, rate: float, rate_limit: float) -> float:
        proportional, derivative = self._motors[each.name]
        most = min(each.rate_limit_rad_per_s, rate_limit)
        way = min(max(way, -most / BANDWIDTH_RAD_PER_S), most / BANDWIDTH_RAD_PER_S)
        return min(max(proportional * way - derivative * rate, -self._most_V), self._most_V)


def _poles(places: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Twists about each place, both ways, of size 1 in the scaled metric."""
    found = np.array([(place.imag, -place.real, 1.0) for place in places]).reshape(-1, 3) * scale
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return np.concatenate([found, -found])


def unit(twist: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """The twist of size 1 in that metric."""
    made = twist / float(np.abs(twist).max())  # first, as squares of the smallest numbers are 0
    return np.asarray(made / np.linalg.norm(made * scale))


class Hinged:
    """One robot with hinges."""

    def __init__(self, scene: Scene, core: Core, signals: Sequence[str], chassis: Chassis):
        self.scene, self.live = scene, LiveInputs(signals, scene.run.step_s)
        vehicle = scene.articulated_vehicle(core)
        self.steering = Steering(chassis, scene, scene.base or BaseTable())
        count = len(self.steering.signals)
        self._first = len(signals) - count
        self.live.values[self._first :] = [*STRAIGHT, *[0.0] * (count - 3)] if vehicle.is_coordinated else 0.0
        self.commands = Commands(scene, vehicle, self.live)
        self.row = self.commands.first_row()
        self.plant: ArticulatedPlant = start_plant(scene, vehicle, self.row)
        self.motion, self.has_refused = self.plant.motion(), False
        self.watched: list[tuple[int, Hinge]] = [
            (at, hinge) for at, hinge in enumerate(scene.hinges) if hinge.has_stops and not hinge.is_commanded]
        self.steps = 0
        self.before: tuple[float, float, float] | None = None  # velocity at the last look
        self.margin_N, self.margin_steps = math.inf, 0

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

    def __init__(self, scene: Scene, robots: int, signals: Sequence[str], chassis: Chassis):
        self.scene, self.core, self.steps = scene, scene.core(), 0
        self._signals, self._chassis = signals, chassis
        self._centre, self._loads = centre_of(scene.vehicle), Loads(scene)
        self.robots = [self._new(scene) for _ in range(robots)]

    def _new(self, scene: Scene) -> Hinged:
        return Hinged(scene, self.core, self._signals, self._chassis)

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
                    text = refused.message
                    refusals.append((number, refused if str(self.scene.path) in text
                                     else self.scene.refusal_in_file(refused)))
        return refusals

    def speeds(self) -> np.ndarray:
        """As Motion.speeds."""
        return np.stack([each.motion.wheel_speed_rad_per_s for each in self.robots], axis=1).astype(float)

    def look(self, robot: int, period_s: float) -> Seen:
        """As Motion.look; encoders and IMU are ideal, and the IMU shows the mean acceleration since the last look."""
        each = self.robots[robot]
        motion, rate = each.motion, each.motion.yaw_rate_rad_per_s
        x, y = self._loads.origin_of(motion)
        now = (float(motion.velocity_m_per_s[0]) + rate * self._centre.imag,
               float(motion.velocity_m_per_s[1]) - rate * self._centre.real, rate)
        before, each.before = each.before or now, now
        ahead, left = ((now[axis] - before[axis]) / period_s if period_s else 0.0 for axis in range(2))
        self._watch(each)
        angles, hinges = motion.wheel_angle_rad.astype(float), motion.hinge_angle_rad.astype(float)
        return Seen(x, y, motion.heading_rad, now, angles.tolist(), motion.wheel_speed_rad_per_s.tolist(),
                    np.concatenate([angles, hinges]), (ahead - rate * now[1], left + rate * now[0], rate), None,
                    hinges.tolist(), motion.hinge_rate_rad_per_s.tolist())

    def _watch(self, each: Hinged) -> None:
        """Keeps the least margin to the friction limit, now and then."""
        if not self.scene.vehicle["friction_coefficient"] or \
                (each.steps - each.margin_steps) * self.scene.run.step_s < MARGIN_S:
            return
        each.margin_steps = each.steps
        try:
            found = each.plant.reactions(each.row, self._loads.of(each.motion))
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

    def has_refused(self, robot: int) -> bool:
        """As Motion.has_refused."""
        return self.robots[robot].has_refused

    def grip(self, robot: int) -> str:
        """As Motion.grip."""
        each = self.robots[robot]
        found, each.margin_N = each.margin_N, math.inf
        return f"wheels would slip: the ground had to hold {-found:.3g} N more than friction allows" if found < 0.0 \
            else ""


class HingedOdometry(Odometry):
    """Odometry from the encoders of wheels and steering."""

    def __init__(self, chassis: Chassis, measured: np.ndarray):
        self._chassis, self._measured = chassis, measured
        self._angles: np.ndarray | None = None
        self.x_m = self.y_m = self.heading_rad = 0.0
        self.velocity = (0.0, 0.0, 0.0)

    def see(self, angles_rad: np.ndarray, period_s: float) -> None:
        """As Odometry.see, with the angles of all hinges behind those of the wheels."""
        before, self._angles = self._angles, angles_rad
        if before is None or period_s <= 0.0:
            return
        count = len(self._measured)
        self.add(*self._chassis.travelled(before[count:], angles_rad[count:], angles_rad[:count] - before[:count],
                                          self._measured), period_s)


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
        loop = loop_of(scene, table, self.believed.radius_m.tolist())
        self.loop, self._steering_signals = loop, Steering(self.believed, scene, table).signals
        self._rate_limit = np.full(robots, math.inf)
        self._own_ramps = np.full(robots, math.inf)
        return HingedRobots(scene, robots, self.signals, self.believed), loop

    def _new_odometry(self) -> Odometry:
        return HingedOdometry(self.believed, self._measured)

    @property
    def signals(self) -> list[str]:
        """As in Base."""
        return [*super().signals, *self._steering_signals]

    # ---- commands

    def command(self, robot: int, ahead: float, left: float, yaw_rate: float) -> list[str]:
        """As in Base; a car that cannot turn so tightly keeps its speed and turns less."""
        return self._follow(robot, np.array([ahead, left, yaw_rate]), ("linear.x", "linear.y", "angular.z"))

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
        self._rate_limit[robot] = abs(steering_rad_per_s) or math.inf
        self._own_ramps[robot] = abs(acceleration_m_per_s2) or math.inf
        return remarks

    def _follow(self, robot: int, given: np.ndarray, names: Sequence[str]) -> list[str]:
        each = self.motion.robots[robot]
        wanted = self.believed.possible(given, each.motion.hinge_angle_rad)
        remarks = [f"{name} = {asked:g} is impossible for these wheels and becomes {got:g}"
                   for name, asked, got in zip(names, given, np.round(wanted, 9) + 0.0, strict=False)
                   if abs(asked - got) > 1e-6]
        remarks += self._limit(wanted)
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
