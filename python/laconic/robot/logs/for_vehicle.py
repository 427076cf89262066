"""A log for the wheels of one vehicle: as many of them, in its order, with its radii. Names say where a wheel is."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.errors import BadInput
from laconic.robot.logs.log import MEMBERS, Log, wheels_of
from laconic.scene import Scene
from laconic.scene.ground import slips

SIDES = {"left": 1.0, "right": -1.0}
ENDS = {"front": 1.0, "rear": -1.0, "back": -1.0}
SHORT = {"fl": ("front", "left"), "fr": ("front", "right"), "rl": ("rear", "left"), "rr": ("rear", "right"),
         "bl": ("rear", "left"), "br": ("rear", "right"), "lf": ("front", "left"), "rf": ("front", "right"),
         "lr": ("rear", "left"), "lb": ("rear", "left"), "rb": ("rear", "right"), "l": ("", "left"), "r": ("", "right"),
         "lhs": ("", "left"), "rhs": ("", "right")}
NEAR_M = 1e-6
FREE = "free"     # hinges of casters and trailers


def words_of(name: str) -> list[str]:
    """Words and numbers of a name: of encoderLeft_ticks[2] encoder, left, ticks, 2."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name)]


def corner_of(name: str) -> tuple[str, str]:
    """(front, rear or nothing, left, right or nothing) of a wheel's name."""
    words = words_of(name)
    end = next(("rear" if word in ("rear", "back") else "front" for word in words if word in ENDS), "")
    side = next((word for word in words if word in SIDES), "")
    if not (end and side):
        short = next((SHORT[word] for word in words if word in SHORT), ("", ""))
        end, side = end or short[0], side or short[1]
    return end, side


def places_by_name(names: Sequence[str], wheels: Sequence[Mapping[str, Any]]) -> list[int] | None:
    """For each name the index of its wheel; None where names and places do not say it without doubt."""
    numbers = [re.findall(r"\d+", name) for name in names]
    if all(len(each) == 1 for each in numbers) and sorted(int(each[0]) for each in numbers) == list(
            range(1, len(wheels) + 1)):
        return [int(each[0]) - 1 for each in numbers]
    found: list[int] = []
    for name in names:
        end, side = corner_of(name)
        fitting = [index for index, wheel in enumerate(wheels)
                   if (not side or SIDES[side] * wheel.get("y_m", 0.0) > NEAR_M)
                   and (not end or ENDS[end] * wheel.get("x_m", 0.0) > NEAR_M)]
        if not (end or side) or len(fitting) != 1:
            return None
        found.append(fitting[0])
    return found if len(set(found)) == len(found) else None


def for_vehicle(log: Log, vehicle: Mapping[str, Any]) -> Log:
    """The log for this vehicle; BadInput where it has another number of wheels."""
    return for_wheels(log, vehicle["wheel"], vehicle.get("wheel_radius_m"))


def for_wheels(log: Log, wheels: Sequence[Mapping[str, Any]], radius_m: float | None = None) -> Log:
    """The log for a vehicle with these wheels; BadInput where it has another number of them.

    A wheel without a motor may have no encoder either: its columns are NaN then. Frames on a bus have room for more
    wheels than there are; those beyond the vehicle's must be silent. `radius_m`: of wheels without one of their own,
    where the log has metres.
    """
    log = _by_name(_by_radius(log, wheels, radius_m), wheels)
    there, count = wheels_of(log), len(wheels)
    if there == count or (there == 0 and log.speed_m_per_s is not None):
        return log
    if there > count and log.map_name == "rig" and all(not value[:, count:].any() for value in _members(log).values()):
        return _reordered(log, lambda values: values[:, :count])
    driven = [index for index, wheel in enumerate(wheels) if wheel.get("driven", True)]
    places = list(range(there)) if log.is_ordered else driven
    if there != len(places) or not set(driven) <= set(places) <= set(range(count)):
        raise BadInput(f"{log.path}: has {there} wheels, the scene {count}; give the scene of the recorded robot, or "
                       "driven = false for a wheel that the log has not")
    return _reordered(log, lambda values: spread(values, places, count))


def _members(log: Log) -> dict[str, np.ndarray]:
    """The quantities of wheels that the log has."""
    return {member: value for member in MEMBERS.values() if (value := getattr(log, member)) is not None}


def _reordered(log: Log, of_wheels: Callable[[np.ndarray], np.ndarray]) -> Log:
    """The log with other columns of wheels, and its counter with them."""
    parts: dict[str, Any] = {member: of_wheels(value) for member, value in _members(log).items()}
    return replace(_with_wraps(log, of_wheels), **parts)


def _with_wraps(log: Log, of_wheels: Callable[[np.ndarray], np.ndarray]) -> Log:
    """The log whose counter is that of the wheels as they are ordered now."""
    counter = log.counter
    return log if counter is None else replace(log, counter=replace(counter, wrap_rad=of_wheels(counter.wrap_rad)))


def spread(values: np.ndarray, places: Sequence[int], count: int) -> np.ndarray:
    """Columns at their places among so many; the others are NaN."""
    found = np.full((len(values), count), np.nan)
    found[:, places] = values
    return found


def _by_radius(log: Log, wheels: Sequence[Mapping[str, Any]], radius_m: float | None) -> Log:
    """Angles of what each wheel rolled, by the radius that the scene gives it."""
    if not log.by_radius:
        return log
    radii = np.array([wheel.get("radius_m") or radius_m or np.nan for wheel in wheels])
    there = wheels_of(log)
    if len(radii) != there:  # free wheels have no column: all others must have one radius
        radii = np.full(there, radii[0]) if len(set(radii)) == 1 else np.full(there, np.nan)
    if np.isnan(radii).any():
        raise BadInput(f"{log.path}: has wheels in metres, and the scene's radii do not say of which wheels; give "
                       "radius_m in the map, with which the robot makes metres of angles")
    parts: dict[str, Any] = {member: getattr(log, member) / radii for member in log.by_radius}
    remark = f"metres of the wheels became angles by the scene's radius of {', '.join(f'{r:g}' for r in set(radii))} m"
    log = _with_wraps(log, lambda wraps: wraps / radii) if "wheel_angle_rad" in log.by_radius else log
    return replace(log, by_radius=(), remarks=(*log.remarks, remark), **parts)


def _by_name(log: Log, wheels: Sequence[Mapping[str, Any]]) -> Log:
    """Columns in the scene's order where nobody gave one and the names of the wheels say where they are."""
    if log.is_ordered or not log.wheel_names:
        return log
    places = places_by_name(log.wheel_names, wheels)
    names = ", ".join(log.wheel_names)
    if places is None:
        return replace(log, wheel_names=(), remarks=(
            *log.remarks, f"the columns {names} are taken for the scene's wheels in this order; name them in a map "
            "if that is wrong"))
    words = ", ".join(f"{name} to wheel {place + 1}" for name, place in zip(log.wheel_names, places, strict=True))
    ordered = [log.wheel_names[places.index(index)] if index in places else "" for index in range(len(wheels))]
    log = _reordered(log, lambda values: spread(values, places, len(wheels)))
    return replace(log, wheel_names=(), column_names=tuple(ordered), is_ordered=True,
                   remarks=(*log.remarks, f"the names assign {words} of the scene; if "
                                                "that is wrong, name the wheels in a map"))


def is_free(scene: Scene) -> bool:
    """Whether all of its hinges are free: casters and trailers behind a carriage without steered wheels."""
    return scene.has_hinges and all(hinge.kind == FREE for hinge in scene.hinges)


def free_hinges(scene: Scene) -> set[str]:
    """Names of hinges of casters and trailers."""
    return {hinge.name for hinge in scene.hinges if hinge.kind == FREE}


def asks_free(scene: Scene, logs: Sequence[Log]) -> bool:
    """Whether a map names free hinges of the scene, so that their angles count; or angles, and not of which."""
    free = free_hinges(scene)
    return any(log.asks_hinges and log.steering_angle_rad is not None and (not log.hinge_names or free & {
        *log.hinge_names}) for log in logs)


def carriage_of(scene: Scene, logs: Sequence[Log]) -> Scene:
    """The carriage alone, which rolls like a vehicle without hinges, where casters and trailers are all that hangs on
    it; the scene itself where wheels steer or slip, or a map asks for angles of free hinges."""
    if not is_free(scene) or slips(scene.vehicle) or asks_free(scene, logs):
        return scene
    return replace(scene, vehicle=carriage_alone(scene.vehicle), hinges=(), wheel_places=())


def carriage_alone(vehicle: Mapping[str, Any]) -> dict[str, Any]:
    """The vehicle of body 0 with its own wheels."""
    return {key: value for key, value in vehicle.items() if key != "body"} | {
        "wheel": [vehicle["wheel"][index] for index in wheels_on_carriage(vehicle)]}


def wheels_on_carriage(vehicle: Mapping[str, Any]) -> list[int]:
    """Their indices."""
    return [index for index, wheel in enumerate(vehicle["wheel"]) if wheel.get("body", CARRIAGE) == CARRIAGE]


def for_carriage(log: Log, scene: Scene) -> Log:
    """The log for the carriage of a scene, with a remark on what of it casters and trailers measured."""
    kept = wheels_on_carriage(scene.vehicle)
    if wheels_of(log) <= len(kept):
        found, others = for_vehicle(log, carriage_alone(scene.vehicle)), list[int]()
    else:
        full = for_vehicle(log, scene.vehicle)
        others = [index for index in range(len(scene.vehicle["wheel"])) if index not in kept]
        joints = tuple(full.column_names[index] for index in kept) if full.column_names else ()
        found = replace(_reordered(full, lambda values: values[:, kept]), column_names=joints, is_ordered=True)
    names = [f"hinge {name}" for name in log.hinge_names] or ["angles of steering"]
    return _told(replace(found, steering_angle_rad=None, hinge_names=()),
                 _numbered(others) + (names if log.steering_angle_rad is not None else []))


def without_free(log: Log, scene: Scene) -> Log:
    """The log without angles of free hinges that no map asks for: what nobody drives measures no odometry."""
    free = free_hinges(scene)
    angles = log.steering_angle_rad
    if angles is None and is_free(scene):  # nothing steers, so that no angle is missing
        return replace(log, steering_angle_rad=np.zeros((len(log.time_s), 0)))
    if angles is None or log.asks_hinges or not free & {*log.hinge_names}:
        return log
    kept = [index for index, name in enumerate(log.hinge_names) if name not in free]
    names = tuple(log.hinge_names[index] for index in kept)
    found = replace(log, hinge_names=names, steering_angle_rad=angles[:, kept] if kept or is_free(scene) else None)
    return _told(found, _numbered(wheels_behind(scene, free)) + [
        f"hinge {name}" for name in log.hinge_names if name in free])


def measuring(log: Log, scene: Scene) -> list[int]:
    """Indices of wheels that roll along and whose turning tells the way: their hinges have angles."""
    values = log.wheel_angle_rad if log.wheel_angle_rad is not None else log.wheel_speed_rad_per_s
    if values is None or values.shape[1] != len(scene.vehicle["wheel"]):
        return []
    loose = wheels_behind(scene, free_hinges(scene) - {*log.hinge_names})
    return [index for index, wheel in enumerate(scene.vehicle["wheel"]) if not wheel.get("driven", True)
            and index not in loose and not np.isnan(values[:, index]).any()]


def wheels_behind(scene: Scene, names: Container[str]) -> list[int]:
    """Indices of wheels behind hinges of some names, with other hinges between or without."""
    parents = {hinge.name: body["parent"] for hinge, body in zip(scene.hinges, scene.vehicle["body"], strict=True)}
    found = []
    for index, wheel in enumerate(scene.vehicle["wheel"]):
        name = wheel.get("body", CARRIAGE)
        while name != CARRIAGE and name not in names:
            name = parents[name]
        found += [index] if name != CARRIAGE else []
    return found


def _numbered(wheels: Sequence[int]) -> list[str]:
    return [f"wheel {index + 1}" for index in wheels]


def _told(log: Log, names: Sequence[str]) -> Log:
    """With a remark that these were left out."""
    if not names:
        return log
    return replace(log, remarks=(*log.remarks, f"{', '.join(names)}: left out, as nobody drives or steers them; to "
                                 "take such angles as measured, name hinges under [steering_angle] of a map"))
