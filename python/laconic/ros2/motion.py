"""The core's vehicles behind a base: one by one with all their sensors, or many as a batch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from laconic.batch import Batch
from laconic.core import Core, Vehicle
from laconic.core.grip import Grip
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene import Scene
from laconic.scene.base import has_motor
from laconic.scene.scene import Initial
from laconic.simulation.run import is_watched

GRAVITY_M_PER_S2 = 9.80665
COUNTER = 2**32


@dataclass
class Seen:
    """One robot at one moment. Pose and velocity are those of the body frame's origin."""

    x_m: float
    y_m: float
    heading_rad: float
    velocity: tuple[float, float, float]      # ahead, left, yaw rate
    angle_rad: list[float]                    # of each wheel
    speed_rad_per_s: list[float]
    encoder_rad: np.ndarray                   # wheel angles as the encoders show them
    imu: tuple[float, float, float]           # acceleration ahead and left, yaw rate, in the IMU's axes
    supply: tuple[float, float] | None = None  # V, A
    hinge_rad: Sequence[float] = ()           # angle of each hinge
    hinge_rate_rad_per_s: Sequence[float] = ()


class Motion(Protocol):
    """Robots that step together."""

    steps: int

    def step(self, given: np.ndarray) -> list[tuple[int, Refused]]:
        """One step with an input (N, robots); returns the refusals, each told once."""

    def speeds(self) -> np.ndarray:
        """Of the wheels, (N, robots)."""

    def look(self, robot: int, period_s: float) -> Seen:
        """One robot now; `period_s` since the last look."""

    def restart(self, robot: int) -> None:
        """Back to the scene's start."""

    def place(self, robot: int, x_m: float, y_m: float, heading_rad: float) -> None:
        """At rest with the body frame at a pose."""

    def has_refused(self, robot: int) -> bool:
        """Whether a step of a robot was refused since it was last placed."""

    def grip(self, robot: int) -> str:
        """What the ground could not give since the last question, in words; empty where nothing is wrong."""

    def folded(self, robot: int) -> Sequence[str]:
        """Trailers that have folded since the last question, in words that begin with their names."""


def motion_of(scene: Scene, robots: int) -> Singles | Lanes:
    """A batch where it can step the vehicles and nothing is lost, else one by one."""
    needs_own = scene.vehicle.get("ground") or scene.sensors.imu is not None or scene.sensors.encoder is not None
    if robots > 1 and not needs_own and not Vehicle.of(scene).has_friction:
        return Lanes(scene, robots)
    return Singles(scene, robots)


def turning(scene: Scene) -> np.ndarray:
    """Which wheels have an encoder where the scene gives none: those that a motor turns."""
    return np.array([bool(wheel["driven"] and not wheel["locked"]) for wheel in scene.vehicle["wheel"]])


def product(rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """(N, robots) of (N, 3) and (3, robots), by operations whose bits do not depend on how many robots there are."""
    found: np.ndarray = rows[:, 0:1] * columns[0] + rows[:, 1:2] * columns[1] + rows[:, 2:3] * columns[2]
    return found


Velocity = tuple[float, float, float]  # ahead, left, yaw rate


def of_origin(centre: tuple[float, float], velocity: np.ndarray, yaw_rate: float) -> Velocity:
    """The velocity of the body frame's origin, of that of the centre of mass and its place in the body frame."""
    x, y = centre
    return float(velocity[0]) + yaw_rate * y, float(velocity[1]) - yaw_rate * x, yaw_rate


def felt(before: Velocity, now: Velocity, period_s: float) -> Velocity:
    """What an ideal IMU in the origin shows: the mean acceleration between two velocities, and the yaw rate."""
    ahead, left = ((now[axis] - before[axis]) / period_s if period_s else 0.0 for axis in range(2))
    return ahead - now[2] * now[1], left + now[2] * now[0], now[2]


class Geometry:
    """Numbers of a scene that both kinds of motion need."""

    def __init__(self, scene: Scene, plant: Plant):
        self.scene, self.core = scene, plant.core
        pose = plant.pose
        dx, dy = pose.x_m - pose.origin_x_m, pose.y_m - pose.origin_y_m
        sine, cosine = math.sin(pose.heading_rad), math.cos(pose.heading_rad)
        self.centre = cosine * dx + sine * dy, cosine * dy - sine * dx  # of mass, in body axes
        matrices, radius_m = plant.core.matrices(scene.c_vehicle(plant.core)), scene.vehicle["wheel_radius_m"]
        self.of_nu = matrices.wheel_rows.astype(float)
        ahead, left, turn = (column.copy() for column in self.of_nu.T)
        turn = matrices.lambda_yaw * turn + (self.centre[0] * left - self.centre[1] * ahead) / radius_m
        self.rows = np.stack([ahead / radius_m, left / radius_m, turn], axis=1)
        self.signal = "voltage_V" if has_motor(scene.vehicle) else "axle_torque_Nm"

    def speeds(self, nu: np.ndarray) -> np.ndarray:
        """Wheel speeds (N, robots) of ν (3, robots)."""
        return product(self.of_nu, nu)

    def start(self, x_m: float, y_m: float, heading_rad: float) -> Initial:
        """At rest with the body frame at a pose."""
        sine, cosine = math.sin(heading_rad), math.cos(heading_rad)
        x, y = self.centre
        return Initial(x_m=x_m + cosine * x - sine * y, y_m=y_m + sine * x + cosine * y, heading_rad=heading_rad)


class Single:
    """One robot with its sensors."""

    def __init__(self, scene: Scene, core: Core):
        self.plant, self.has_refused = scene.plant(core), False
        self.sensors = scene.sensors_of(self.plant)
        self.held = core.input(None, scene.wheel_count)
        self.counts: np.ndarray | None = None
        self.travel = np.zeros(scene.wheel_count)
        self.refusal: Refused | None = None  # that is not told yet
        self.grip_told: tuple[int, float] = (0, 0.0)
        self.grip: Any = core.ffi.new("laconic_grip *")


class Singles:
    """Robots one by one: every scene, every sensor."""

    def __init__(self, scene: Scene, robots: int):
        self.scene, self.core = scene, scene.core()
        self.robots = [Single(scene, self.core) for _ in range(robots)]
        self.geometry = Geometry(scene, self.robots[0].plant)
        self.rows, self.steps, self._count = self.geometry.rows, 0, scene.wheel_count
        encoder = scene.sensors.encoder
        counts = (encoder or {}).get("counts_per_turn", ())
        self.measured = np.array([bool(each) for each in counts]) if encoder else turning(scene)
        gears = (encoder or {}).get("gear_ratio", [1.0] * self._count)
        self._per_count = np.array([2.0 * math.pi / (count * gear) if count else 0.0
                                    for count, gear in zip(counts, gears, strict=True)]) if encoder else None
        self._wrap = int((encoder or {}).get("wrap", COUNTER))
        self._why, self._nu = self.core.why(), self.core.ffi.new("laconic_real[3]")
        self._nu_view = np.frombuffer(self.core.ffi.buffer(self._nu), self.core.dtype)
        self._is_watched, self._has_friction = is_watched(scene), self.robots[0].plant.has_friction
        self._has_supply = bool(scene.vehicle.get("drive", {}).get("supply_V"))

    def step(self, given: np.ndarray) -> list[tuple[int, Refused]]:
        """As Motion.step."""
        self.steps += 1
        refusals, run, count, why = [], self.core.lib.laconic_sensors_run, self._count, self._why
        for number, each in enumerate(self.robots):
            if not each.has_refused:
                getattr(each.held, self.geometry.signal)[0:count] = given[:, number].tolist()
                if run(each.sensors.c, each.plant.c, each.held, 1, why):
                    self._stop(each, self.core.refusal(why))
            if each.refusal is not None:
                refusals.append((number, each.refusal))
                each.refusal = None
        return refusals

    def _stop(self, each: Single, refused: Refused) -> None:
        """Lets a robot stand where it is, without an input."""
        each.has_refused, each.refusal = True, self.scene.refusal_in_file(refused)
        each.held = self.core.input(None, self._count)

    def speeds(self) -> np.ndarray:
        """As Motion.speeds."""
        if self._has_friction:
            return np.stack([self.core.numbers(each.plant.c.slip.wheel_speed_rad_per_s)[:self._count]
                             for each in self.robots], axis=1).astype(float)
        nu = np.empty((3, len(self.robots)))
        for number, each in enumerate(self.robots):
            self.core.lib.laconic_nu(each.plant._at("model"), each.plant._at("state"), self._nu)
            nu[:, number] = self._nu_view
        return self.geometry.speeds(nu)

    def look(self, robot: int, period_s: float) -> Seen:
        """As Motion.look."""
        each = self.robots[robot]
        try:
            return self._look(each)
        except Refused as refused:  # an output with this input is beyond all numbers
            self._stop(each, refused)
            return self._look(each)

    def _look(self, each: Single) -> Seen:
        plant, pose = each.plant, each.plant.pose
        velocity, yaw_rate = plant.body_velocity()
        reading = each.sensors.read(each.held)
        angles = plant.wheel_angles()
        speeds = plant.wheel_speeds()
        shown = angles.astype(float) if self._per_count is None else self._counted(each, reading.encoder_count)
        acceleration = reading.imu_acceleration_m_per_s2
        supply = None
        if self._has_supply:
            friction = plant._outputs(each.held).friction
            supply = float(friction.supply_voltage_V), float(friction.supply_current_A)
        if self._is_watched:
            self.core.lib.laconic_grip_watch(each.grip, plant.contact, plant._at("model"),
                                             plant.reactions(each.held), plant.steps)
        return Seen(pose.origin_x_m, pose.origin_y_m, pose.heading_rad,
                    of_origin(self.geometry.centre, velocity, float(yaw_rate)), angles.tolist(), speeds.tolist(), shown,
                    (float(acceleration[0]), float(acceleration[1]), reading.imu_yaw_rate_rad_per_s), supply)

    def _counted(self, each: Single, counts: np.ndarray) -> np.ndarray:
        """Angles from counts that wrap; between two looks no shaft may turn through half of its counter."""
        if each.counts is not None:
            change = (counts - each.counts + self._wrap // 2) % self._wrap - self._wrap // 2
            each.travel = each.travel + change * self._per_count
        each.counts = counts
        return each.travel

    def restart(self, robot: int) -> None:
        """As Motion.restart."""
        self.robots[robot] = Single(self.scene, self.core)

    def place(self, robot: int, x_m: float, y_m: float, heading_rad: float) -> None:
        """As Motion.place."""
        moved = replace(self.scene, initial=self.geometry.start(x_m, y_m, heading_rad))
        self.robots[robot] = Single(moved, self.core)

    def folded(self, robot: int) -> Sequence[str]:
        """As Motion.folded: nothing is hung on these."""
        return ()

    def has_refused(self, robot: int) -> bool:
        """As Motion.has_refused."""
        return self.robots[robot].has_refused

    def grip(self, robot: int) -> str:
        """As Motion.grip."""
        each = self.robots[robot]
        if not self._is_watched:
            return ""
        found = Grip.of(each.grip, each.plant, self.scene.run.step_s)
        told, each.grip_told = each.grip_told, (found.slipping + found.lifting, found.slip_loss_J or 0.0)
        if found.slip_loss_J is not None:
            lost_J = found.slip_loss_J - told[1]
            return f"wheels slip: {lost_J:.3g} J since the last report" if lost_J > 1e-6 else ""
        return found.warning() if each.grip_told[0] > told[0] else ""


class Lanes:
    """Robots as a batch: ideal ground and ideal sensors, the bits of `Singles`."""

    def __init__(self, scene: Scene, robots: int):
        self.scene, self.core = scene, scene.core()
        self.plant = scene.plant(self.core)  # one that stays at the start, and reads states
        self.geometry = Geometry(scene, self.plant)
        self.batch = Batch(Vehicle.of(scene), robots, scene.run.method, scene.run.step_s)
        self.rows, self.steps = self.geometry.rows, 0
        self.measured = turning(scene)
        self._start = self.plant.save()
        self._before: list[tuple[float, float, float]] = [(0.0, 0.0, 0.0)] * robots
        self._told = np.zeros(robots, bool)
        self._given: np.ndarray = getattr(self.batch, self.geometry.signal)
        for robot in range(robots):
            self.restart(robot)

    def step(self, given: np.ndarray) -> list[tuple[int, Refused]]:
        """As Motion.step."""
        self.steps += 1
        self._given[:] = given
        if not self.batch.run(1):
            return []
        found = [int(each) for each in np.flatnonzero((self.batch.status != 0) & ~self._told)]
        self._told[found] = True
        return [(robot, self.scene.refusal_in_file(refused)) for robot in found
                if (refused := self.batch.refusal(robot)) is not None]

    def speeds(self) -> np.ndarray:
        """As Motion.speeds."""
        return self.geometry.speeds(self.batch.nu_rad_per_s)

    def look(self, robot: int, period_s: float) -> Seen:
        """As Motion.look; the IMU is ideal and shows the mean acceleration since the last look."""
        plant = self.plant
        plant.c.state = self.batch.state(robot)[0]
        pose = plant.pose
        velocity, yaw_rate = plant.body_velocity()
        now, before = of_origin(self.geometry.centre, velocity, float(yaw_rate)), self._before[robot]
        self._before[robot] = now
        angles = plant.wheel_angles()
        return Seen(pose.origin_x_m, pose.origin_y_m, pose.heading_rad, now, angles.tolist(),
                    plant.wheel_speeds().tolist(), angles.astype(float), felt(before, now, period_s))

    def restart(self, robot: int) -> None:
        """As Motion.restart."""
        self.batch.load(robot, self._start)
        self._told[robot], self._before[robot] = False, (0.0, 0.0, 0.0)

    def place(self, robot: int, x_m: float, y_m: float, heading_rad: float) -> None:
        """As Motion.place."""
        start = self.geometry.start(x_m, y_m, heading_rad)
        self.batch.start(robot, x_m=start.x_m, y_m=start.y_m, heading_rad=start.heading_rad)
        self._told[robot], self._before[robot] = False, (0.0, 0.0, 0.0)

    def folded(self, robot: int) -> Sequence[str]:
        """As Motion.folded: nothing is hung on these."""
        return ()

    def has_refused(self, robot: int) -> bool:
        """As Motion.has_refused."""
        return bool(self._told[robot])

    def grip(self, robot: int) -> str:
        """As Motion.grip: a batch does not watch the ground."""
        return ""
