"""An audit of a vehicle with steered wheels: radius, distance, gain and offset of the steering, place of the tracker.

Gain, offset and tracker belong to the log's map, not to the scene. A fit keeps them among the keys of `[vehicle]`,
under one key of its own, which is taken out before anything is rolled.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.errors import BadInput
from laconic.robot.identify.geometry import ANGLE_SD_RAD, RELATIVE_SD
from laconic.robot.identify.parameter import Parameter, Parameters, Vehicle
from laconic.robot.identify.resolution import floor_of_all
from laconic.robot.identify.rolling_evidence import path_residual, run_of, stretch_errors, stretch_scores
from laconic.robot.identify.solve import Fit, fit
from laconic.robot.identify.study import Study
from laconic.robot.identify.words import in_words, with_errors
from laconic.robot.identify.words_of_errors import of_errors
from laconic.robot.logs import Log
from laconic.robot.logs.log import remarks_of, run_names
from laconic.robot.logs.poses import at_times
from laconic.robot.replay.measures import RunErrors, path_errors
from laconic.robot.replay.placing import fitted
from laconic.robot.replay.rolling import wheel_radii
from laconic.robot.replay.steered_rolling import STEERED, SteeredRolling
from laconic.scene import Scene
from laconic.simulation.loads import centre_of

OF_LOG = " of the log"        # the key, which no scene can have
SPEED = "speed_m_per_s"       # of logs by commands
NOMINAL = {"radius": 1.0, "distance": 1.0, "gain": 1.0, "offset": 0.0, "x": 0.0, "y": 0.0, "heading": 0.0,
           "lag": 0.0}
GAIN_SD, OFFSET_SD_RAD, TRACKER_SD_M = 0.3, 0.1, 0.3   # steering is known far less well than a radius
LAG_SD_S = 0.1
LEAST = 0.05                  # of a factor: below it nothing rolls
FACTORS = (("radius of the wheels", "radius", RELATIVE_SD), ("distance of the wheels", "distance", RELATIVE_SD),
           ("gain of the steering", "gain", GAIN_SD))


def own_of(vehicle: Vehicle) -> dict[str, float]:
    """What a fit changed, by the names of NOMINAL."""
    found: dict[str, float] = vehicle.get(OF_LOG, {})
    return {**NOMINAL, **found}


def parameters_of(groups: Sequence[str]) -> Parameters:
    """Those of some groups; factors are 1 as the scene and the map say."""
    def writer(key: str) -> Callable[[Vehicle, float], None]:
        def write(vehicle: Vehicle, value: float) -> None:
            vehicle.setdefault(OF_LOG, {})[key] = value
        return write

    found = [Parameter(f"{name}, factor", f"factor.{key}", key, "", 1.0, sd, writer(key), low=LEAST)
             for name, key, sd in FACTORS]
    found.append(Parameter("offset of the steering", "steering_angle.offset", "offset", "rad", 0.0, OFFSET_SD_RAD,
                           writer("offset")))
    found += [Parameter(f"place of the tracker, {key}", f"pose.mount.{key}_m", "place", "m", 0.0, TRACKER_SD_M,
                        writer(key)) for key in ("x", "y")]
    found.append(Parameter("heading of the tracker", "pose.mount.heading_rad", "heading", "rad", 0.0, ANGLE_SD_RAD,
                           writer("heading")))
    found.append(Parameter("lag of the pose", "pose.lag_s", "lag", "s", 0.0, LAG_SD_S, writer("lag")))
    return Parameters(tuple(each for each in found if each.group in groups))


def scene_of(scene: Scene, vehicle: Vehicle) -> Scene:
    """The scene with wheels of the size and at the places found."""
    own, found = own_of(vehicle), copy.deepcopy({key: value for key, value in vehicle.items() if key != OF_LOG})
    radii = own["radius"] * wheel_radii(found)
    for wheel, radius in zip(found["wheel"], radii, strict=True):
        wheel["radius_m"] = float(radius)
    moved = [(wheel, "x_m", "y_m") for wheel in found["wheel"] if wheel.get("body", CARRIAGE) == CARRIAGE]
    moved += [(body, "hinge_x_m", "hinge_y_m") for body, hinge in zip(found["body"], scene.hinges, strict=True)
              if body["parent"] == CARRIAGE and hinge.kind in STEERED]
    for part, *keys in moved:
        for key in keys:
            part[key] *= own["distance"]
    return replace(scene, vehicle=found)


class SteeredModel:
    """How a vehicle with steered wheels rolls, by the values of a fit."""

    free = {"radius of the wheels": ("radius",), "distance of the wheels": ("distance",),
            "gain of the steering": ("gain",), "offset of the steering": ("offset",),
            "place of the tracker": ("place", "heading"), "time lag": ("lag",)}

    def __init__(self, scene: Scene):
        self.scene = scene

    def path(self, vehicle: Vehicle, log: Log) -> np.ndarray:
        """Poses of the tracker at the samples' times, from the true first one; placed to fit positions alone."""
        own, scene = own_of(vehicle), scene_of(self.scene, vehicle)
        changed: dict[str, Any] = {"steering_angle_rad": own["gain"] * log.needs(
            "steering_angle_rad", "an audit of a steered vehicle") + own["offset"]}
        if getattr(log, SPEED, None) is not None:
            changed[SPEED] = own["radius"] * getattr(log, SPEED)
        body = late(SteeredRolling(scene).path(replace(log, pose_point="origin", **changed)), log.time_s, own["lag"])
        return placed(log, body, place_of(log, scene) + complex(own["x"], own["y"]), own["heading"])

    def fit(self, runs: Sequence[Log], groups: Sequence[str]) -> Study:
        """Finds the values of some groups."""
        found = fit(self.scene.vehicle, parameters_of(groups), _Evidence(self, runs))
        after = found.parameters.vehicle(self.scene.vehicle, found.values)
        study = Study(self.scene, list(runs), found, in_words(self.scene, found, runs),
                      self._errors(self.scene.vehicle, runs), self._errors(after, runs), [], [], [])
        return replace(study, words=[*remarks_of(runs), *with_errors(study.words, of_errors(study, ()))])

    def _errors(self, vehicle: Vehicle, runs: Sequence[Log]) -> list[RunErrors]:
        return [path_errors(name, log, self.path(vehicle, log))
                for name, log in zip(run_names(runs), runs, strict=True)]

    def fitted(self, found: Fit) -> Scene:
        """The scene with the values found."""
        return scene_of(self.scene, found.parameters.vehicle(self.scene.vehicle, found.values))


def lag_of_fit(study: Study) -> float | None:
    """The lag found; None where its interval contains 0, or the runs do not tell it."""
    found = study.found
    return next((float(value) for p, value, half in zip(found.parameters.each, found.values, found.half_widths,
                                                        strict=True) if p.group == "lag" and abs(value) > half), None)


def late(path: np.ndarray, time_s: np.ndarray, lag_s: float) -> np.ndarray:
    """A path so much later; before it began, and after its end, it stands still."""
    return path if lag_s == 0.0 else at_times(time_s - lag_s, time_s, path)


def place_of(log: Log, scene: Scene) -> complex:
    """The point of the body whose pose the log has."""
    if log.pose_point == "centre_of_mass":
        return centre_of(scene.vehicle)
    return 0j if isinstance(log.pose_point, str) else complex(*log.pose_point)


def place_of_wheel(scene: Scene, wheel: Mapping[str, Any]) -> tuple[float, float]:
    """Of a wheel in the frame of the carriage, all hinges at angle 0."""
    bodies = {hinge.name: body for hinge, body in zip(scene.hinges, scene.vehicle.get("body", ()), strict=True)}
    x_m, y_m, name = wheel["x_m"], wheel["y_m"], wheel.get("body", CARRIAGE)
    while name != CARRIAGE:
        x_m, y_m = x_m + bodies[name]["hinge_x_m"], y_m + bodies[name]["hinge_y_m"]
        name = bodies[name]["parent"]
    return x_m, y_m


def placed(log: Log, body: np.ndarray, point: complex, heading: float) -> np.ndarray:
    """The path of a tracker on a body whose path is known up to a motion of the plane."""
    place, turn = body[:, 0] + 1j * body[:, 1], body[:, 2]
    place = place + point * np.exp(1j * turn)
    if log.pose is None or not log.has_heading:
        path = np.column_stack([place.real, place.imag, turn])
        return path if log.pose is None else fitted(path, log.seen, log.pose[log.seen, :2])
    x, y, angle = log.pose[0]
    turned = angle - heading - turn[0]
    place = complex(x, y) + (place - place[0]) * complex(math.cos(turned), math.sin(turned))
    return np.column_stack([place.real, place.imag, turn - turn[0] + angle])


class _Evidence:
    """Runs with a true pose, for `solve.fit`."""

    directions = 2
    difference = 0.0

    def __init__(self, model: SteeredModel, logs: Sequence[Log]):
        self.sessions = [str(log.path.resolve().parent) for log in logs]
        self._model, self._logs = model, logs
        self._runs = [run_of(log, by_wheels=False) for log in logs]
        self.floor = floor_of_all(partial(model.path, model.scene.vehicle), logs, self._runs)

    def _paths(self, vehicle: Vehicle) -> list[np.ndarray]:
        return [self._model.path(vehicle, log) for log in self._logs]

    def residuals(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Distances x, y between rolled and true path."""
        return [path_residual(run, path) for run, path in zip(self._runs, self._paths(vehicle), strict=True)]

    def errors(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Of each stretch of each run: displacement ahead and to the left, turn."""
        return [stretch_errors(run, path) for run, path in zip(self._runs, self._paths(vehicle), strict=True)]

    def scores(self, vehicle: Vehicle, jacobians: list[np.ndarray]) -> list[np.ndarray]:
        """Of each stretch: its error, carried to all points of the path after it, times the Jacobian there."""
        return [stretch_scores(run, path, jacobian.reshape(len(run.taken), 2, -1))
                for run, path, jacobian in zip(self._runs, self._paths(vehicle), jacobians, strict=True)]


def controllers_text(scene: Scene, fitted_one: Scene, own: dict[str, float], joints: Sequence[str],
                     steering: Sequence[str]) -> list[str]:
    """Parameters of tricycle_controller or ackermann_steering_controller; BadInput for other vehicles. `joints`: of
    the wheels, `steering`: of the hinges."""
    vehicle = fitted_one.vehicle
    steered = [index for index, hinge in enumerate(scene.hinges) if hinge.kind in STEERED]
    carried = [[number for number, wheel in enumerate(vehicle["wheel"])
                if wheel.get("body", CARRIAGE) == scene.hinges[index].name] for index in steered]
    rear = [number for number, wheel in enumerate(vehicle["wheel"]) if wheel.get("body", CARRIAGE) == CARRIAGE]
    if len(scene.hinges) != len(steered) or len(rear) != 2 or len(steered) > 2 or any(len(c) != 1 for c in carried):
        raise BadInput(f"{scene.path}: its wheels are neither those of tricycle_controller nor of "
                       "ackermann_steering_controller; export a .h file")
    axle_x_m = float(np.mean([vehicle["wheel"][number]["x_m"] for number in rear]))
    places = [(vehicle["body"][index]["hinge_x_m"] - axle_x_m, vehicle["body"][index]["hinge_y_m"])
              for index in steered]
    radii, base = wheel_radii(vehicle), float(np.mean([x for x, _ in places]))
    note = (f"# Multiply each measured steering angle by {own['gain']:.6g} and add {own['offset']:.6g} rad; these "
            "controllers have no keys for that.")
    if len(steered) == 1:
        return [note, "tricycle_controller:", "  ros__parameters:",
                f'    traction_joint_name: "{joints[carried[0][0]]}"',
                f'    steering_joint_name: "{steering[steered[0]]}"',
                f"    wheelbase: {base:.6g}", f"    wheel_radius: {radii[carried[0][0]]:.6g}"]
    tracks = [float(np.ptp([y for _, y in places])), float(np.ptp([vehicle["wheel"][n]["y_m"] for n in rear]))]

    def listed(names: Sequence[str]) -> str:
        return ", ".join(f'"{name}"' for name in names)

    return [note, "# Before Kilted the keys are rear_wheels_names, front_wheels_names, rear_wheel_track,",
            "# front_wheel_track and rear_wheels_radius.", "ackermann_steering_controller:", "  ros__parameters:",
            f"    traction_joints_names: [{listed([joints[number] for number in rear])}]",
            f"    steering_joints_names: [{listed([steering[index] for index in steered])}]",
            f"    wheelbase: {base:.6g}", f"    traction_track_width: {tracks[1]:.6g}",
            f"    steering_track_width: {tracks[0]:.6g}", f"    traction_wheels_radius: {radii[rear].mean():.6g}"]
