"""The parameters of rolling: radii, places and angles of the wheels."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from laconic.errors import BadInput, nearest_of, shown
from laconic.robot.identify import ground, motion, steered
from laconic.robot.identify.parameter import Parameter, Parameters, Vehicle
from laconic.robot.logs.for_vehicle import is_free
from laconic.robot.replay.rolling import wheel_radii
from laconic.scene import Scene

RELATIVE_SD = 0.1                     # of a radius and of the distances, unless --prior says otherwise
PLACE_SD_M = 0.03
ANGLE_SD_RAD = math.radians(2.0)
OF_CARRIAGE = ("radius", "common-radius", "distance", "centre-of-mass", "place", "heading", "axle", "roller")
GROUPS = (*OF_CARRIAGE, *ground.GROUPS, *motion.GROUPS)
OF_TRACKER = {key: f"tracker.{key}" for key in ("x_m", "y_m", "heading")}   # paths of an audit's parameters
LEAST_SHARE = 0.05                    # of a nominal radius or distance: below it no wheel can be
ROLLED = (*OF_CARRIAGE, "clock-lag")
"""What paths by rolling tell of a carriage, with or without casters and trailers behind it."""


def usual(scene: Scene) -> tuple[str, ...]:
    """What is free by default, by what drives and steers the vehicle."""
    if not scene.has_hinges:
        return ("radius", "distance")
    if is_free(scene):
        return "radius", "track"
    return "radius", "wheelbase" if steered.axle_of(scene.vehicle) is not None else "distance", "steering-gain", \
        "steering-offset"


def geometry_of(scene: Scene, free: Sequence[str], relative_sd: float = RELATIVE_SD) -> Parameters:
    """The parameters that --free names; BadInput for a name that is none or that this vehicle has not."""
    makers: dict[str, Callable[[Scene, float], list[Parameter]]] = {
        "radius": _radii, "common-radius": _common_radius, "distance": _distance, "place": _place,
        "heading": _heading, "centre-of-mass": _centre_of_mass, "axle": _axles, "roller": _rollers, **ground.MAKERS,
        **motion.MAKERS, **{name: steered.MAKERS[name] for name in steered.FOR_ALL}}
    if scene.has_hinges:
        makers = {**steered.MAKERS, "common-radius": _common_radius, "friction": ground.MAKERS["friction"]}
        if steered.axle_of(scene.vehicle) is None:  # all wheels steer: no axle from which a wheelbase counts
            makers["distance"] = lambda scene, relative_sd: [steered.distance_of(scene, relative_sd)]
        if {"steering-curve", "steering-gain"} <= set(free):
            raise BadInput("--free steering-curve: says what steering-gain says, and more; take one of them")
    found: list[Parameter] = []
    for name in dict.fromkeys([*(group for group in GROUPS if group in makers), *makers]):
        if name in free:
            made = makers[name](scene, relative_sd)
            if not made:
                raise BadInput(f"--free {name}: {scene.path} {motion.why_none(scene, name)}")
            found += made
    if unknown := [name for name in free if name not in makers]:
        if scene.has_hinges and unknown[0] in GROUPS:
            raise BadInput(f"--free {unknown[0]}: is not found for vehicles with hinges; take some of "
                           f"{', '.join(makers)}")
        if unknown[0] in steered.MAKERS:
            remedy = "take distance" if unknown[0] in ("track", "wheelbase") else "leave it out"
            raise BadInput(f"--free {unknown[0]}: is of vehicles with hinges, and {scene.path} has none; {remedy}")
        raise BadInput(f"--free: there is no {shown(unknown[0])}; {nearest_of(unknown[0], tuple(makers))}")
    return Parameters(tuple(found))


def _radii(scene: Scene, relative_sd: float) -> list[Parameter]:
    """One for each wheel. Their deviations have a part in common: wheels of one make are worn and mis-stated alike."""
    def writer(index: int) -> Callable[[Vehicle, float], None]:
        def write(vehicle: Vehicle, value: float) -> None:
            vehicle["wheel"][index]["radius_m"] = value
        return write

    return [Parameter(f"radius of wheel {i + 1}", f"vehicle.wheel[{i + 1}].radius_m", "radius", "m", radius,
                      relative_sd * radius, writer(i), relative_sd * radius, low=LEAST_SHARE * radius)
            for i, radius in enumerate(wheel_radii(scene.vehicle))]


def _common_radius(scene: Scene, relative_sd: float) -> list[Parameter]:
    """One for all wheels: how far they roll in one turn, which may be less than the wheel's size."""
    def write(vehicle: Vehicle, value: float) -> None:
        vehicle["wheel_radius_m"] = value

    nominal = scene.vehicle.get("wheel_radius_m", 0.0)
    if not nominal or any(wheel.get("radius_m") for wheel in scene.vehicle["wheel"]):
        return []
    return [Parameter("radius of the wheels", "vehicle.wheel_radius_m", "common-radius", "m", nominal,
                      relative_sd * nominal, write, low=LEAST_SHARE * nominal)]


def _distance(scene: Scene, relative_sd: float) -> list[Parameter]:
    """One factor for the places of all wheels about the origin of the body frame."""
    def write(vehicle: Vehicle, value: float) -> None:
        for wheel in vehicle["wheel"]:
            wheel["x_m"] *= value
            wheel["y_m"] *= value

    if not any(math.hypot(wheel["x_m"], wheel["y_m"]) > 0.0 for wheel in scene.vehicle["wheel"]):
        return []
    return [Parameter("distance of the wheels", "vehicle.wheel[*].distance", "distance", "", 1.0, relative_sd, write,
                      low=LEAST_SHARE)]


def _place(scene: Scene, relative_sd: float) -> list[Parameter]:
    """Where the robot stands in its frame, against the point whose pose the log gives.

    All of it moves: the wheels, and with them the centre of mass, the supports and the payload, whose places are given
    in the same frame. So the robot stays the robot that it was, and only the marker is another.
    """
    def writer(key: str) -> Callable[[Vehicle, float], None]:
        def write(vehicle: Vehicle, value: float) -> None:
            vehicle[f"com_{key}"] += value
            for part in parts_of(vehicle):
                part[key] += value
        return write

    return [Parameter(f"place of the robot, {key[0]}", f"vehicle.*.{key}", "place", "m", 0.0, PLACE_SD_M,
                      writer(key)) for key in ("x_m", "y_m") if scene.vehicle["wheel"]]


def parts_of(vehicle: Vehicle) -> list[dict[str, float]]:
    """What has a place of its own in the frame, beside the centre of mass."""
    return [*vehicle["wheel"], *vehicle.get("support", []), *([vehicle["payload"]] if "payload" in vehicle else [])]


def _centre_of_mass(scene: Scene, relative_sd: float) -> list[Parameter]:
    """Of the robot without payload, against its wheels."""
    def writer(key: str) -> Callable[[Vehicle, float], None]:
        def write(vehicle: Vehicle, value: float) -> None:
            vehicle[key] = value
        return write

    return [Parameter(f"centre of mass, {key[4]}", f"vehicle.{key}", "centre-of-mass", "m", scene.vehicle[key],
                      PLACE_SD_M, writer(key)) for key in ("com_x_m", "com_y_m") if scene.vehicle["wheel"]]


def _heading(scene: Scene, relative_sd: float) -> list[Parameter]:
    """How far the whole robot is turned in the frame whose pose the log gives."""
    return [Parameter("heading of the robot", "vehicle.*.heading", "heading", "rad", 0.0, ANGLE_SD_RAD, _turn)
            for _ in scene.vehicle["wheel"][:1]]


def _turn(vehicle: Vehicle, angle: float) -> None:
    cos, sin = math.cos(angle), math.sin(angle)
    x, y = vehicle["com_x_m"], vehicle["com_y_m"]
    vehicle["com_x_m"], vehicle["com_y_m"] = cos * x - sin * y, sin * x + cos * y
    for part in parts_of(vehicle):
        x, y = part["x_m"], part["y_m"]
        part["x_m"], part["y_m"] = cos * x - sin * y, sin * x + cos * y
    for wheel in vehicle["wheel"]:
        wheel["axle_rad"] += angle


def tracker_of(is_centre: bool, has_heading: bool) -> list[Parameter]:
    """Place and heading of the tracker on a robot without hinges: the robot is placed in the tracker's frame. With
    `is_centre` the log has the pose of the centre of mass, which is moved alone then."""
    def writer(key: str) -> Callable[[Vehicle, float], None]:
        def write(vehicle: Vehicle, value: float) -> None:
            vehicle[f"com_{key}"] += value if is_centre else -value
            for part in () if is_centre else parts_of(vehicle):
                part[key] -= value
        return write

    found = [Parameter(f"place of the tracker, {key[0]}", f"vehicle.com_{key}" if is_centre else OF_TRACKER[key],
                       "place", "m", 0.0, PLACE_SD_M, writer(key)) for key in ("x_m", "y_m")]
    heading = Parameter("heading of the tracker", OF_TRACKER["heading"], "heading", "rad", 0.0, ANGLE_SD_RAD,
                        lambda vehicle, value: _turn(vehicle, -value))
    return [*found, heading] if has_heading else found


def _axles(scene: Scene, relative_sd: float) -> list[Parameter]:
    """Each wheel with rollers; the axles of fixed wheels must stay on one line, or nothing moves."""
    return [_angle(scene, i, "axle", "axle_rad") for i, wheel in enumerate(scene.vehicle["wheel"])
            if wheel["kind"] != "fixed"]


def _rollers(scene: Scene, relative_sd: float) -> list[Parameter]:
    return [_angle(scene, i, "roller", "roller_rad") for i, wheel in enumerate(scene.vehicle["wheel"])
            if wheel["kind"] != "fixed"]


def _angle(scene: Scene, index: int, what: str, key: str) -> Parameter:
    def write(vehicle: Vehicle, value: float) -> None:
        vehicle["wheel"][index][key] = value

    return Parameter(f"{what} of wheel {index + 1}", f"vehicle.wheel[{index + 1}].{key}", what, "rad",
                     float(scene.vehicle["wheel"][index][key]), ANGLE_SD_RAD, write)
