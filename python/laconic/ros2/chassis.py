"""Where the wheels of a vehicle with hinges are at given hinge angles, what they allow, and how to steer them.

A twist is the velocity of the body frame's origin and the yaw rate. Rows have three columns for it and one for the rate
of each hinge. A hinge is steered if it is commanded or has a motor, hangs on the carriage and carries a fixed wheel.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.can.play.vehicle import about_hinge
from laconic.core.articulated import CARRIAGE, ArticulatedMotion
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.base import BaseTable
from laconic.scene.hinge_signals import RATE, TWIST, VOLTAGE

STRAIGHT = np.array([1.0, 0.0, 0.0])
HALVINGS = 40          # of the way to a command that the stops do not allow
TINY = 1e-12
BANDWIDTH_RAD_PER_S = 8.0    # of a steering motor's controller, which is damped critically
INSET_RAD = 1e-6             # what the base keeps away from a stop, so that the scene's own limits never act
OF_MOTOR_RAD = 5e-3          # the same where a motor steers, which may pass its goal
CLEAR_RAD = 0.02             # of a turning centre from a steered wheel, in twists scaled by the vehicle's length
AROUND_RAD = 0.1             # the same on the way to another twist
SHARE = 1.0 - 1e-9           # of a rate limit, for the same reason
PARTS_OF_TURN = 30


@dataclass(frozen=True)
class Steered:
    """One hinge that the base turns."""

    at: int                # its number among the hinges
    name: str
    kind: str              # "motor", "prescribed", "coordinated"
    place: complex         # of the hinge, in the carriage's frame
    ahead_rad: float       # the direction in which its wheel rolls, in its own frame
    trail_m: float         # of the wheel ahead of the hinge in that direction; below 0 behind it
    low_rad: float
    high_rad: float
    rate_limit_rad_per_s: float

    def angle(self, twist: np.ndarray, near_rad: float) -> float | None:
        """The angle at which its wheel rolls along a twist, within the stops and nearest to another angle; None: none.

        A wheel rolls both ways, so half turns more or less serve as well.
        """
        ahead, left, turn = twist.tolist()
        velocity = complex(ahead, left) + 1j * turn * self.place
        across, size = turn * self.trail_m, abs(velocity)
        if size < TINY:
            return near_rad
        if abs(across) > size:
            return None
        angle = cmath.phase(velocity) - self.ahead_rad + math.asin(across / size)
        turns = round((near_rad - angle) / math.pi)
        found = [angle + (turns + more) * math.pi for more in (0, 1, -1)]
        found = [each for each in found if self.low_rad <= each <= self.high_rad]
        return min(found, key=lambda each: abs(each - near_rad)) if found else None


class Chassis:
    """The geometry of one vehicle with hinges, as it is or as its base believes it to be."""

    def __init__(self, scene: Scene, rate_limit_rad_per_s: float, *, size: float = 1.0,
                 radius_m: tuple[float, ...] = ()):
        vehicle = scene.vehicle
        bodies, wheels = vehicle["body"], vehicle["wheel"]
        names = [CARRIAGE, *(body["name"] for body in bodies)]
        self._parents = [names.index(body["parent"]) for body in bodies]
        self._hinges = [size * complex(body["hinge_x_m"], body["hinge_y_m"]) for body in bodies]
        self.of_wheel = np.array([names.index(wheel.get("body", CARRIAGE)) for wheel in wheels])
        self._place = np.array([size * complex(wheel["x_m"], wheel["y_m"]) for wheel in wheels])
        axle = np.array([wheel["axle_rad"] for wheel in wheels])
        is_fixed = np.array([wheel["kind"] == "fixed" for wheel in wheels])
        roller = np.array([math.pi / 2 if wheel["kind"] == "fixed" else wheel["roller_rad"] for wheel in wheels])
        self.radius_m = np.array(radius_m or [wheel.get("radius_m", vehicle["wheel_radius_m"]) for wheel in wheels])
        self._along = np.exp(1j * (axle + roller))         # in which the ground holds the wheel, in its body's frame
        self._across = np.exp(1j * axle)[is_fixed]
        self._per_radius = 1.0 / (self.radius_m * np.sin(roller))
        self._fixed = np.flatnonzero(is_fixed)
        self._turned_by = np.array([[hinge in self._chain(body) for hinge in range(len(bodies))]
                                    for body in self.of_wheel], float).reshape(len(wheels), len(bodies))
        is_free = [each.kind == "free" for each in scene.hinges]
        self.is_known = np.array([not any(is_free[hinge] for hinge in self._chain(body)) for body in self.of_wheel])
        self._known_fixed = self.is_known[self._fixed]
        self.length_m = max(float(np.abs([*self._hinges, *self._place[self.of_wheel == 0]]).max()), 1e-3)
        self._scale = np.array([1.0, 1.0, self.length_m])
        self.steered = [found for at in range(len(bodies))
                        if (found := self._steered(scene, at, rate_limit_rad_per_s, is_fixed, axle)) is not None]
        sliding = self.rows([0.0] * len(bodies))[1]
        self._inverted: tuple[bytes | None, np.ndarray] = None, np.zeros(0)  # rows, and their inverse
        self._of_carriage = sliding[self.of_wheel[self._fixed] == 0, :3]
        self.axle_x_m = self._axle(wheels, is_fixed)

    def _chain(self, body: int) -> list[int]:
        """Hinges between a body and the carriage."""
        return [] if body == 0 else [*self._chain(self._parents[body - 1]), body - 1]

    def _steered(self, scene: Scene, at: int, most: float, is_fixed: np.ndarray, axle: np.ndarray) -> Steered | None:
        hinge = scene.hinges[at]
        wheels = np.flatnonzero((self.of_wheel == at + 1) & is_fixed)
        if hinge.kind == "free" or not len(wheels):
            return None
        if self._parents[at] != 0:
            raise BadInput(f"{scene.path}: {hinge.place} ({hinge.name}): is steered and hangs on another body, which "
                           "laconic ros2 cannot drive; hang it on the carriage")
        direction = float(axle[wheels[0]]) + math.pi / 2
        behind = (self._place[wheels].mean() * cmath.exp(-1j * direction)).real
        return Steered(at, hinge.name, hinge.kind, self._hinges[at], direction, behind, hinge.low_rad, hinge.high_rad,
                       min(hinge.rate_limit_rad_per_s, most))

    def _axle(self, wheels: list[dict[str, Any]], is_fixed: np.ndarray) -> float | None:
        """ξ of the carriage's fixed axle, whose wheels roll along ξ; None where it has none."""
        places = [wheel["x_m"] for wheel, body, fixed in zip(wheels, self.of_wheel, is_fixed, strict=True)
                  if fixed and body == 0 and abs(math.cos(wheel["axle_rad"])) < 1e-9]
        return float(np.mean(places)) if places else None

    @property
    def wheelbase_m(self) -> float | None:
        """From the fixed axle to the steered wheels; None for a vehicle that has no such axle or steers on it."""
        if self.axle_x_m is None or not self.steered:
            return None
        base = abs(float(np.mean([(each.place + cmath.rect(each.trail_m, each.ahead_rad)).real
                                  for each in self.steered])) - self.axle_x_m)
        return base if base > 1e-6 * self.length_m else None

    # ---- rows

    def rows(self, angles: Any) -> tuple[np.ndarray, np.ndarray]:
        """Rolling of wheels [rad/s], and sliding of fixed wheels along their axles [m/s]: (N, 3 + H) and (F, 3 + H)."""
        origins, directions = [0j], [1 + 0j]
        for parent, hinge, angle in zip(self._parents, self._hinges, angles, strict=True):
            origins.append(origins[parent] + directions[parent] * hinge)
            directions.append(directions[parent] * cmath.rect(1.0, angle))
        turned, hinges = np.array(directions)[self.of_wheel], np.array(origins[1:])
        places = np.array(origins)[self.of_wheel] + turned * self._place
        arms = (places[:, None] - hinges[None, :]) * self._turned_by
        roll = _projected(turned * self._along, places, arms) * self._per_radius[:, None]
        fixed = self._fixed
        return roll, _projected(turned[fixed] * self._across, places[fixed], arms[fixed])

    def allowed(self, sliding: np.ndarray, along: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """What wheels that slide by these rows leave of a twist (3, 3), and the twist that hinge rates cause (3, H).

        `along`: the only twist that coordinated hinges leave."""
        if along is not None:
            scaled = along * self._scale
            return np.outer(along, scaled * self._scale) / float(scaled @ scaled), np.zeros((3, sliding.shape[1] - 3))
        side = sliding[self._known_fixed]
        inverse = self._inverse(side[:, :3] / self._scale)
        caused = -(inverse @ side[:, 3:]) / self._scale[:, None]
        keeps = np.eye(3) - inverse @ (side[:, :3] / self._scale)
        return keeps * self._scale / self._scale[:, None], caused

    def _inverse(self, rows: np.ndarray) -> np.ndarray:
        """The pseudo-inverse; wheels that do not turn ask for the same again and again."""
        if (key := rows.tobytes()) != self._inverted[0]:
            self._inverted = key, np.linalg.pinv(rows, rcond=1e-9)
        return self._inverted[1]

    def travelled(self, before: np.ndarray, after: np.ndarray, wheel_turns: np.ndarray, measured: np.ndarray
                  ) -> tuple[float, float, float]:
        """Ahead, left and turn from what encoders of wheels and steering show between two looks."""
        roll, side = self.rows(0.5 * (before + after))
        side, hinge_turns = side[self._known_fixed], after - before
        metres = self.radius_m[measured]
        rolled = metres * (wheel_turns[measured] - roll[measured, 3:] @ hinge_turns)
        matrix = np.vstack([roll[measured, :3] * metres[:, None], side[:, :3]])
        ahead, left, turn = np.linalg.lstsq(matrix, np.concatenate([rolled, -side[:, 3:] @ hinge_turns]), 1e-9)[0]
        return float(ahead), float(left), float(turn)

    # ---- commands

    def possible(self, twist: np.ndarray, angles: np.ndarray) -> np.ndarray:
        """The part of a twist that the fixed axle and the stops allow; it keeps the speed and gives up yaw rate."""
        if len(self._of_carriage):
            scaled = self._of_carriage / self._scale
            twist = (np.eye(3) - np.linalg.pinv(scaled, rcond=1e-9) @ scaled) @ (twist * self._scale) / self._scale
            if self.axle_x_m is not None:
                twist[1] = -self.axle_x_m * twist[2]
        if not twist.any() or self._is_reachable(twist, angles):
            return twist
        slow, fast = self._without_turn(twist), twist
        if not slow.any() or not self._is_reachable(slow, angles):
            return np.zeros(3)
        for _ in range(HALVINGS):
            middle = 0.5 * (slow + fast)
            slow, fast = (middle, fast) if self._is_reachable(middle, angles) else (slow, middle)
        return slow

    def _without_turn(self, twist: np.ndarray) -> np.ndarray:
        side = 0.0 if self.axle_x_m is not None else twist[1]
        return np.array([twist[0], side, 0.0])

    def _is_reachable(self, twist: np.ndarray, angles: np.ndarray) -> bool:
        return all(each.angle(twist, angles[each.at]) is not None for each in self.steered)


def _projected(direction: np.ndarray, places: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Velocity of points along a direction, for a unit of each number of the twist and each hinge rate."""
    found = np.empty((len(places), 3 + arms.shape[1]))
    found[:, 0], found[:, 1] = direction.real, direction.imag
    quarter = np.conj(direction) * 1j
    found[:, 2] = (quarter * places).real
    found[:, 3:] = (quarter[:, None] * arms).real
    return found


# ---- how to steer them

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
        back = np.conj(self._velocities(self.twist))
        turns = [self._turns(back, each) for each in targets]
        ways = sorted(range(2), key=lambda k: (bool(self._beyond(mine + turns[k])), float(np.abs(turns[k]).max())))
        target, turn = targets[ways[0]], turns[ways[0]]
        rates = SHARE * self.step_s * np.minimum(self._rates, rate_limit)
        if not turn.any() and not (target != self.twist).any():
            return
        if (np.abs(turn) <= rates).all() and not self._beyond(mine + turn):
            self.twist = target
            return
        low, high = 0.0, 1.0
        for _ in range(PARTS_OF_TURN):
            middle = 0.5 * (low + high)
            turn = self._turns(back, self.twist + middle * (target - self.twist))
            is_far = (np.abs(turn) > rates).any() or self._beyond(mine + turn)
            low, high = (low, middle) if is_far else (middle, high)
        if low:
            self.twist = unit(self.twist + low * (target - self.twist), self._scale)

    def clear(self, twist: np.ndarray) -> np.ndarray:
        """The twist, or one beside it, about whose centre every steered wheel can point."""
        if not len(self._poles):
            return twist
        made = unit(twist, self._scale) * self._scale
        for pole in self._poles:
            along = float(made @ pole)
            if along > math.cos(CLEAR_RAD):
                aside = made - along * pole
                if _size(aside) < 1e-9:
                    aside = _cross(pole, np.array([1.0, 0.0, 0.0] if abs(pole[0]) < 0.9 else [0.0, 1.0, 0.0]))
                made = math.cos(CLEAR_RAD) * pole + math.sin(CLEAR_RAD) * aside / _size(aside)
                return np.asarray(made / self._scale)
        return twist

    def _via(self, target: np.ndarray) -> np.ndarray:
        """The target, or where to go first, so that on the way no turning centre lies in a steered wheel.

        Twists of one size are points on a sphere, and those that leave a wheel without a direction its poles."""
        if not len(self._poles):
            return target
        now, goal = self.twist * self._scale, target * self._scale
        axis = _cross(now, goal)
        size = _size(axis)
        if size < 1e-9:
            return target
        axis /= size
        ahead, first, found = _cross(axis, now), math.atan2(size, float(now @ goal)), target
        for pole in self._poles:
            off = float(axis @ pole)
            wide = min(AROUND_RAD, 0.5 * math.acos(min(max(float(goal @ pole), -1.0), 1.0)))
            along = math.atan2(float(pole @ ahead), float(pole @ now))
            if abs(off) < wide and 0.0 < along < first:
                aside = math.copysign(1.0, -off) * (axis - off * pole)
                aside /= _size(aside)
                first = along
                found = (math.cos(1.2 * wide) * pole + math.sin(1.2 * wide) * aside) / self._scale
        return found

    def _beyond(self, angles: np.ndarray) -> bool:
        return bool(((angles > self._highs) | (angles < self._lows)).any())

    def _velocities(self, twist: np.ndarray) -> np.ndarray:
        found: np.ndarray = complex(twist[0], twist[1]) + 1j * twist[2] * self._places
        return found

    def _turns(self, back: np.ndarray, then: np.ndarray) -> np.ndarray:
        """How far hinges turn to a twist; `back`: conjugates of their velocities by the present one."""
        way = self._velocities(then) * back
        return np.asarray(np.arctan2(way.imag, way.real))

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


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The cross product, by the operations of np.cross, which takes ten times as long for one pair."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _size(vector: np.ndarray) -> float:
    """As np.linalg.norm."""
    return math.sqrt(vector.dot(vector))


def unit(twist: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """The twist of size 1 in that metric."""
    made = twist / max(map(abs, twist.tolist()))  # first, as squares of the smallest numbers are 0
    return np.asarray(made / _size(made * scale))
