"""The parameters of steered vehicles: how wheels follow the log's steering, where they are, where the tracker is."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, cast

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.robot.identify.parameter import Parameter, Parameters, Vehicle
from laconic.robot.logs.for_vehicle import free_hinges, measuring, wheels_behind
from laconic.robot.logs.log import Log
from laconic.robot.replay.rolling import wheel_radii
from laconic.robot.replay.steered_rolling import STEERED, fixed_wheels
from laconic.robot.replay.steered_signals import Fitted, OfLog
from laconic.scene import Scene

GAIN_SD, CURVE_SD, SPEED_SD = 0.5, 0.3, 0.2   # relative
OFFSET_SD_RAD, HEADING_SD_RAD = 0.2, 0.2
TRACKER_SD_M = 0.5
LAG_SD_S, CLOCK_SD_S = 0.1, 0.1
USUAL_RATE_RAD_PER_S, USUAL_REACH_RAD = 5.0, 0.5
CREEP_SD = 0.1
SCRUB_SD_M, FADE_M = 0.01, 0.1
LEAST_SHARE = 0.05


def _log(vehicle: Vehicle) -> OfLog:
    return cast(Fitted, vehicle).log


def of_map(key: str, name: str, group: str, unit: str, nominal: float, sd: float, low: float = -math.inf) -> Parameter:
    """A correction of the log's map, a member of OfLog."""
    def write(vehicle: Vehicle, value: float) -> None:
        setattr(_log(vehicle), key, value)

    return Parameter(name, f"log.{key}", group, unit, nominal, sd, write, low=low)


Maker = Callable[[Scene, float], list[Parameter]]


def _one(*given: Any) -> Maker:
    return lambda scene, _: [of_map(*given)]


def _curve(scene: Scene, relative_sd: float) -> list[Parameter]:
    """Angles of the hinge at two angles of the log to either side; straight between them."""
    def write(at: float, vehicle: Vehicle, value: float) -> None:
        _log(vehicle).curve[at] = value

    reach = reach_of(scene)
    return [Parameter(f"steering at {at:.4g} rad", f"log.curve[{at:.4g}]", "steering-curve", "rad", at,
                      CURVE_SD * abs(at), partial(write, at))
            for at in (-reach, -0.5 * reach, 0.5 * reach, reach)]


def reach_of(scene: Scene) -> float:
    """How far the wheels steer, by the scene's stops."""
    ends = [hinge.high_rad for hinge in scene.hinges if hinge.kind in STEERED and hinge.high_rad is not None
            and 0.0 < hinge.high_rad < 0.5 * math.pi]
    return float(min(ends, default=USUAL_REACH_RAD))


def _rate(scene: Scene, relative_sd: float) -> list[Parameter]:
    limits = [hinge.rate_limit_rad_per_s for hinge in scene.hinges if hinge.kind in STEERED
              and hinge.rate_limit_rad_per_s]
    nominal = min(limits, default=USUAL_RATE_RAD_PER_S)
    return [of_map("rate_limit_rad_per_s", "rate limit of the steering", "steering-rate", "rad/s", nominal,
                    0.3 * nominal, LEAST_SHARE * nominal)]


def _radii(scene: Scene, relative_sd: float) -> list[Parameter]:
    """Of the driven wheels; the runs say whether others are measured."""
    return [_radius(scene, i, relative_sd) for i, wheel in enumerate(scene.vehicle["wheel"])
            if wheel.get("driven", True)]


def _radius(scene: Scene, index: int, relative_sd: float) -> Parameter:
    def write(vehicle: Vehicle, value: float) -> None:
        vehicle["wheel"][index]["radius_m"] = value

    radius = float(wheel_radii(scene.vehicle)[index])
    return Parameter(f"radius of wheel {index + 1}", f"vehicle.wheel[{index + 1}].radius_m", "radius", "m", radius,
                     relative_sd * radius, write, relative_sd * radius, low=LEAST_SHARE * radius)


def with_measuring(scene: Scene, runs: Sequence[Log], parameters: Parameters) -> Parameters:
    """With the radii of undriven wheels that runs measure, where those of the driven ones are free: wrong, they would
    distort all else."""
    radii = [p for p in parameters.each if p.path.startswith("vehicle.wheel[") and p.group == "radius" and p.unit]
    if not scene.has_hinges or not radii:
        return parameters
    relative_sd = radii[0].prior_sd / radii[0].nominal
    more = [_radius(scene, index, relative_sd) for index in sorted({i for run in runs for i in measuring(run, scene)})]
    place = parameters.each.index(radii[-1]) + 1
    return Parameters((*parameters.each[:place], *more, *parameters.each[place:]))


def radius_of_all(scene: Scene, relative_sd: float) -> Parameter:
    """One factor for all wheels, and for a commanded speed."""
    free = wheels_behind(scene, free_hinges(scene))  # which nobody measures

    def write(vehicle: Vehicle, value: float) -> None:
        if vehicle.get("wheel_radius_m"):
            vehicle["wheel_radius_m"] *= value
        for index, wheel in enumerate(vehicle["wheel"]):
            if wheel.get("radius_m") and index not in free:
                wheel["radius_m"] *= value
        _log(vehicle).speed_gain = value

    return Parameter("radius of the wheels, factor", "vehicle.wheel[*].radius_m", "radius", "", 1.0, relative_sd, write,
                     low=LEAST_SHARE)


def distance_of(scene: Scene, relative_sd: float) -> Parameter:
    """One factor for the places of all wheels and steered hinges on the carriage, about the origin."""
    def write(vehicle: Vehicle, value: float) -> None:
        for wheel in vehicle["wheel"]:
            if wheel.get("body", CARRIAGE) == CARRIAGE:
                wheel["x_m"], wheel["y_m"] = value * wheel["x_m"], value * wheel["y_m"]
        for i in steered_bodies(scene):
            body = vehicle["body"][i]
            body["hinge_x_m"], body["hinge_y_m"] = value * body["hinge_x_m"], value * body["hinge_y_m"]

    return Parameter("distance of the wheels, factor", "vehicle.wheel[*].distance", "distance", "", 1.0, relative_sd,
                     write, low=LEAST_SHARE)


def steered_bodies(scene: Scene) -> list[int]:
    """Indices of bodies with steered wheels on the carriage."""
    return [i for i, hinge in enumerate(scene.hinges)
            if hinge.kind in STEERED and scene.vehicle["body"][i].get("parent", CARRIAGE) == CARRIAGE]


def axle_of(vehicle: Mapping[str, Any]) -> complex | None:
    """The middle of the fixed axle."""
    fixed = fixed_wheels(vehicle)
    return complex(*np.mean([(wheel["x_m"], wheel["y_m"]) for wheel in fixed], axis=0)) if fixed else None


def _wheelbase(scene: Scene, relative_sd: float) -> list[Parameter]:
    """From the fixed axle to the steered wheels, which all move alike."""
    bodies, axle = steered_bodies(scene), axle_of(scene.vehicle)
    if not bodies or axle is None:
        return []
    nominal = float(np.mean([scene.vehicle["body"][i]["hinge_x_m"] for i in bodies])) - axle.real
    if abs(nominal) < 1e-6:
        return []

    def write(vehicle: Vehicle, value: float) -> None:
        for i in bodies:
            vehicle["body"][i]["hinge_x_m"] = scene.vehicle["body"][i]["hinge_x_m"] + value - nominal

    low, high = sorted((LEAST_SHARE * nominal, math.copysign(math.inf, nominal)))
    return [Parameter("wheelbase", "vehicle.*.wheelbase", "wheelbase", "m", nominal, relative_sd * abs(nominal), write,
                      low=low, high=high)]


def _track(scene: Scene, relative_sd: float) -> list[Parameter]:
    """Between the outermost wheels of the fixed axle; steered wheels at both sides move in proportion."""
    ys = [wheel["y_m"] for wheel in fixed_wheels(scene.vehicle)]
    if not ys or max(ys) - min(ys) < 1e-6:
        return []
    nominal, middle = max(ys) - min(ys), 0.5 * (max(ys) + min(ys))

    def write(vehicle: Vehicle, value: float) -> None:
        share = value / nominal
        for wheel in fixed_wheels(vehicle):
            wheel["y_m"] = middle + share * (wheel["y_m"] - middle)  # type: ignore[index]
        for i in steered_bodies(scene):
            vehicle["body"][i]["hinge_y_m"] = middle + share * (scene.vehicle["body"][i]["hinge_y_m"] - middle)

    return [Parameter("track", "vehicle.*.track", "track", "m", nominal, relative_sd * nominal, write,
                      low=LEAST_SHARE * nominal)]


def _trail(scene: Scene, relative_sd: float) -> list[Parameter]:
    """Of casters: how far their wheels are behind the hinge."""
    found = []
    for body, hinge in enumerate(scene.hinges):
        wheels = [i for i, wheel in enumerate(scene.vehicle["wheel"]) if wheel.get("body") == hinge.name]
        if hinge.kind != "free" or len(wheels) != 1 or not scene.vehicle["wheel"][wheels[0]]["x_m"]:
            continue
        nominal = -float(scene.vehicle["wheel"][wheels[0]]["x_m"])

        def write(vehicle: Vehicle, value: float, index: int = wheels[0]) -> None:
            vehicle["wheel"][index]["x_m"] = -value

        assert body < len(scene.hinges)
        found.append(Parameter(f"trail of {hinge.name}", f"vehicle.wheel[{wheels[0] + 1}].trail_m", "trail", "m",
                               nominal, relative_sd * abs(nominal), write))
    return found


def wheels_steered(scene: Scene) -> list[int]:
    """Indices of wheels behind hinges."""
    return [i for i, wheel in enumerate(scene.vehicle["wheel"]) if wheel.get("body", CARRIAGE) != CARRIAGE]


def _of_wheels(scene: Scene, key: str, what: str, group: str, unit: str, sd: float) -> list[Parameter]:
    """One value of the wheels behind hinges, one of those on the carriage."""
    def write(indices: list[int], vehicle: Vehicle, value: float) -> None:
        for index in indices:
            vehicle["wheel"][index][key] = value

    behind = wheels_steered(scene)
    others = [i for i in range(len(scene.vehicle["wheel"])) if i not in behind]
    return [Parameter(f"{what} of {which}", f"vehicle.wheel[{where}].{key}", group, unit,
                      float(scene.vehicle["wheel"][indices[0]].get(key, 0.0)), sd, partial(write, indices), low=0.0)
            for which, where, indices in (("the steered wheels", "steered", behind),
                                          ("the other wheels", "fixed", others))
            if indices]


def _fade(scene: Scene, relative_sd: float) -> list[Parameter]:
    def write(vehicle: Vehicle, value: float) -> None:
        for wheel in vehicle["wheel"]:
            if wheel.get("scrub_radius_m"):
                wheel["scrub_fade_m"] = value

    return [Parameter("fading of the scrub", "vehicle.wheel[*].scrub_fade_m", "scrub-fade", "m", FADE_M, FADE_M, write,
                      low=0.01 * FADE_M)]


MAKERS: dict[str, Maker] = {
    "radius": _radii, "wheelbase": _wheelbase, "track": _track, "trail": _trail,
    "steering-gain": _one("gain", "gain of the steering", "steering-gain", "", 1.0, GAIN_SD),
    "steering-offset": _one("offset_rad", "offset of the steering", "steering-offset", "rad", 0.0, OFFSET_SD_RAD),
    "steering-curve": _curve,
    "steering-lag": _one("lag_s", "lag of the steering", "steering-lag", "s", 0.0, LAG_SD_S),
    "steering-rate": _rate,
    "speed-gain": _one("speed_gain", "gain of the speed", "speed-gain", "", 1.0, SPEED_SD, LEAST_SHARE),
    "speed-offset": _one("speed_offset_m_per_s", "offset of the speed", "speed-offset", "m/s", 0.0, 0.1),
    "speed-lag": _one("speed_lag_s", "lag of the speed", "speed-lag", "s", 0.0, LAG_SD_S),
    "place": lambda scene, _: [of_map(f"tracker_{axis}_m", f"place of the tracker, {axis}", "place", "m", 0.0,
                                       TRACKER_SD_M) for axis in "xy"],
    "heading": _one("tracker_heading_rad", "heading of the tracker", "heading", "rad", 0.0, HEADING_SD_RAD),
    "clock-lag": _one("clock_lag_s", "lag of the tracker", "clock-lag", "s", 0.0, CLOCK_SD_S),
    "creep": lambda scene, _: _of_wheels(scene, "creep", "creep", "creep", "", CREEP_SD),
    "scrub": lambda scene, _: _of_wheels(scene, "scrub_radius_m", "scrub", "scrub", "m", SCRUB_SD_M),
    "scrub-fade": _fade}
SLIPPING = ("creep", "scrub", "scrub-fade", "friction")
"""What acts on ground with friction alone."""
FOR_ALL = ("clock-lag",)
"""Parameters of vehicles without hinges, too."""
