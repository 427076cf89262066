"""A node on a CAN bus driven in closed loop: voltages out, IMU and encoder frames in, a Kalman filter between, and
whatever chooses voltages of its estimate. In lockstep: the node waits for each step.

    with virtual_node("double") as node:
        run = drive(node, scene, filter, lambda step, state: controller.voltages(step, state), steps=600, every=5)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from laconic.can.rig.client import NodeClient
from laconic.can.rig.lockstep import load_scene
from laconic.can.rig.scaled import Voltages, await_answers, frames_per_answer, select_bits
from laconic.can.rig.wire import Frame
from laconic.core.given import MOST_STEPS, finite_number, shown, whole_number
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.tools.control.filter import Filter, Innovation

FRAMES = ("POSE", "IMU", "ENCODER")  # the first is the truth, which the controller is not told

Choice = Callable[[int, np.ndarray], np.ndarray]
"""Voltages (N,) for a step of the controller and the filter's state."""


@dataclass(frozen=True)
class Camera:
    """Sees the robot now and then: every `period` steps its pose, with errors of these standard deviations."""

    period: int
    std_m: float
    heading_std_rad: float
    seed: int = 0

    def __post_init__(self) -> None:
        """BadInput names the setting that no camera has."""
        if not 1 <= whole_number("period", self.period) <= MOST_STEPS:
            raise BadInput(f"period: {self.period} is no number of steps between two views; give 1 or more")
        for name in ("std_m", "heading_std_rad"):
            if finite_number(name, getattr(self, name)) < 0:
                raise BadInput(f"{name}: {getattr(self, name):g} is below 0; give 0 for what is not seen, or more")
        if whole_number("seed", self.seed) < 0:
            raise BadInput(f"seed: {self.seed} is below 0; give 0 or more")


@dataclass
class Drive:
    """What happened, a row after each step of the node."""

    step_s: float
    truth: list[np.ndarray] = field(default_factory=list)        # x, y, heading in (−π, π]: the node's POSE
    estimate: list[np.ndarray] = field(default_factory=list)     # ν1, ν2, ν3, x, y, θ, bias
    covariance: list[np.ndarray] = field(default_factory=list)   # (7, 7)
    voltage_V: list[np.ndarray] = field(default_factory=list)
    innovations: list[Innovation] = field(default_factory=list)
    overranges: int = 0  # frames of voltages beyond what the wire has; voltage_V is then what was sent

    @property
    def time_s(self) -> np.ndarray:
        """At the rows, from the first step's end."""
        return self.step_s * np.arange(1, len(self.truth) + 1)

    @property
    def pose_error(self) -> np.ndarray:
        """Estimate − truth in x, y, heading: (steps, 3)."""
        off = np.array(self.estimate)[:, 3:6] - np.array(self.truth)
        off[:, 2] = np.remainder(off[:, 2] + math.pi, 2 * math.pi) - math.pi
        return off

    @property
    def pose_std(self) -> np.ndarray:
        """How well the filter says that it knows them: (steps, 3)."""
        return np.sqrt(np.array([np.diag(each)[3:6] for each in self.covariance]))

    def distance_to(self, states: np.ndarray, every: int) -> np.ndarray:
        """Of the truth to the course, at the steps of the course that begin after a step of the node: (rows,) [m]."""
        seen = np.array(self.truth)[every - 1 :: every, :2]
        return np.hypot(*(seen - states[1 : len(seen) + 1, 3:5]).T)


def drive(node: NodeClient, scene: Scene, filter: Filter, choose: Choice, steps: int, *, every: int = 1,
          camera: Camera | None = None) -> Drive:
    """Loads the scene into the node and drives it for so many steps of the node; new voltages every `every` of them.

    The node steps the scene's vehicle from the scene's start with its sensors; the filter's step is the node's. The
    filter reads encoders and gyro after each step and predicts by the voltages as the wire has them. BadInput for a
    scene without IMU or encoders or where the steps differ.
    """
    check(scene, filter)
    scene = replace(scene, rig=replace(scene.rig, frames=FRAMES))
    load_scene(node, scene)
    node.select(**select_bits(FRAMES))
    node.start_lockstep()
    wire, awaited = Voltages(node, scene), frames_per_answer(scene, FRAMES)
    run, volts = Drive(scene.run.step_s), np.zeros(scene.wheel_count)
    random = np.random.default_rng(camera.seed if camera else 0)
    first = wire.core.input_fields["voltage_V"][0]
    try:
        for step in range(steps):
            if step % every == 0:
                volts = checked(choose(step // every, filter.state), scene.wheel_count)
            row = wire.send({f"voltage_V[{k + 1}]": float(each) for k, each in enumerate(volts)}, sync=True)
            sent = row[first : first + scene.wheel_count]
            filter.predict({"voltage_V": sent.tolist()})
            run.voltage_V.append(sent)
            take(run, filter, await_answers(node, awaited))
            if camera and (step + 1) % camera.period == 0:
                look(run, filter, camera, random)
            run.estimate.append(filter.state)
            run.covariance.append(filter.covariance)
    finally:
        node.stop()
        run.overranges = wire.overranges
    return run


def checked(volts: Any, wheels: int) -> np.ndarray:
    """A controller's voltages; BadInput for what is none."""
    found = np.asarray(volts, float)
    if found.shape != (wheels,) or not np.all(np.isfinite(found)):
        raise BadInput(f"choose: gave {shown(found.tolist())}; give a finite voltage for each of {wheels} wheels")
    return found


def check(scene: Scene, filter: Filter) -> None:
    """BadInput for what does not fit."""
    if scene.sensors.imu is None or scene.sensors.encoder is None:
        raise BadInput(f"{scene.path}: sensors: the filter needs a gyro and encoders; give [sensors.imu] and "
                       "[sensors.encoder]")
    if filter.wheel_count != scene.wheel_count or not math.isclose(filter.step_s, scene.run.step_s, rel_tol=1e-6):
        raise BadInput(f"{scene.path}: the filter has {filter.wheel_count} wheels and a step of {filter.step_s:g} s, "
                       f"the scene {scene.wheel_count} and {scene.run.step_s:g} s; make the filter's plant like it")


def take(run: Drive, filter: Filter, answers: list[tuple[Frame, bytes]]) -> None:
    """What the node showed after a step."""
    counts = [0] * filter.wheel_count
    for frame, data in answers:
        raw = frame.unpack(data)
        values = {name: raw[name] * frame.fields[name].scale for name in raw if name in frame.fields}
        if frame.name == "POSE":
            run.truth.append(np.array([values["x"], values["y"], values["heading"]]))
        elif frame.name == "IMU":
            run.innovations.append(filter.yaw_rate(values["yaw_rate"]))
        elif frame.name == "ENCODER":
            counts[raw["wheel"]] = raw["count"]
    run.innovations.append(filter.counts(counts))


def look(run: Drive, filter: Filter, camera: Camera, random: np.random.Generator) -> None:
    """A fix of the centre of mass, which is what POSE has."""
    x, y, heading = run.truth[-1] + random.normal(size=3) * (camera.std_m, camera.std_m, camera.heading_std_rad)
    run.innovations.append(filter.fix(x, y, heading, std_m=camera.std_m, heading_std_rad=camera.heading_std_rad,
                                      place_m=filter.centre_of_mass_m))
