"""The core against references of vehicles with hinges on ground with friction: a JSON list of cases.

A case has a vehicle, a start, segments with held inputs and the expected end; or vehicles and single steps with the
motion after each. Errors are the largest differences as they are, not over the size of the reference.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.core.articulated import CARRIAGE
from laconic.core.slipping import SlippingPlant, SlippingVehicle
from laconic.errors import BadInput, Refused
from laconic.scene import MOST_STEPS
from laconic.scene.table import Table
from laconic.tools.verify.trajectories import step_that_fits, worst_of


@dataclass(frozen=True)
class SlippingResult:
    """Result of one case; None when refused, or where a case of single steps has no such error."""

    name: str
    status: str
    error_nu: float | None = None     # of velocity and yaw rate of body 0 and rates of hinges
    error_pose: float | None = None   # of place, heading and angles of hinges
    error_wheel: float | None = None  # of wheel speeds
    error_energy_norm: float | None = None  # of a single step, over the size of its free motion
    error_hinge_rate: float | None = None   # of a single step
    prototype_error: tuple[float, ...] | None = None  # that the file lists at this step: pose, velocities, wheel speeds
    seconds: float = 0.0

    @property
    def errors(self) -> list[float | None]:
        """All of them: velocities, pose, wheel speeds, energy norm, hinge rates."""
        return [self.error_nu, self.error_pose, self.error_wheel, self.error_energy_norm, self.error_hinge_rate]

    @property
    def worst(self) -> float:
        """The largest of the errors; infinite when the case was refused."""
        return worst_of(self.status, self.errors)


def is_slipping(case: Table) -> bool:
    """Whether a case is of a vehicle with hinges whose wheels may slip."""
    vehicle = case.peek("vehicle")
    bodies = vehicle.get("bodies") if isinstance(vehicle, dict) else None
    return "vehicles" in case.plain() or (isinstance(bodies, list) and bool(bodies) and isinstance(bodies[0], dict)
                                          and "hinge_at_parent_m" in bodies[0])


def _limit(table: Table, key: str, usual: float) -> float:
    """A number, or null for none."""
    return usual if table.peek(key) is None and table.has(key) else table.number(key)


def vehicle_table(table: Table) -> dict[str, Any]:
    """A vehicle of a case as laconic.SlippingVehicle takes it."""
    carriage, *hung = list(table.tables("bodies")) or [table.fail("bodies", "holds none; give the carriage first")]
    wheels = [_wheel(each, len(hung) + 1) for each in table.tables("wheels")]
    if not wheels:
        table.fail("wheels", "holds none; give at least one")
    x_m, y_m = carriage.numbers("com_m", 2)
    return {"mass_kg": carriage.number("mass_kg"), "yaw_inertia_kgm2": carriage.number("yaw_inertia_kgm2"),
            "com_x_m": x_m, "com_y_m": y_m, "wheel_radius_m": 1.0, "wheel_inertia_kgm2": 1.0,
            "ground": {"friction_coefficient": 1.0}, "wheel": wheels,
            "body": [_body(each, number) for number, each in enumerate(hung, 1)]}


def _name(number: int) -> str:
    return f"body_{number}" if number else CARRIAGE


def _body(table: Table, number: int) -> dict[str, Any]:
    parent = table.whole("parent")
    if not 0 <= parent < number:
        table.fail("parent", f"is {parent}; give the number of a body before this one, 0 to {number - 1}")
    (x_m, y_m), (com_x_m, com_y_m) = table.numbers("hinge_at_parent_m", 2), table.numbers("com_m", 2)
    low, high = _limit(table, "stop_low_rad", -1e6), _limit(table, "stop_high_rad", 1e6)
    stops = {} if low == -1e6 and high == 1e6 else {"stop_low_rad": low, "stop_high_rad": high}
    keys = {"mass_kg": "mass_kg", "yaw_inertia_kgm2": "yaw_inertia_kgm2", "hinge_viscous_Nms": "damping_Nms",
            "hinge_dry_Nm": "dry_friction_Nm", "spring_Nm_per_rad": "stiffness_Nm", "spring_rest_rad": "rest_rad",
            "servo_kp": "servo_gain_Nm_per_rad", "servo_kd": "servo_damping_Nms"}
    return {"name": _name(number), "parent": _name(parent), "hinge_x_m": x_m, "hinge_y_m": y_m, "com_x_m": com_x_m,
            "com_y_m": com_y_m, "hinge": "prescribed" if table.flag("prescribed") else "free",
            "servo_limit_Nm": _limit(table, "servo_limit_Nm", 0.0), **stops,
            **{name: table.number(key) for key, name in keys.items()}}


def _wheel(table: Table, bodies: int) -> dict[str, Any]:
    body, (x_m, y_m) = table.whole("body"), table.numbers("at_m", 2)
    if not 0 <= body < bodies:
        table.fail("body", f"is {body}; give the number of a body, 0 to {bodies - 1}")
    keys = {"axle_rad": "axle_rad", "radius_m": "radius_m", "inertia_kgm2": "inertia_kgm2",
            "friction_coefficient": "friction_coefficient", "axle_friction_Nm": "axle_friction_Nm",
            "motor_gain_Nm_per_V": "motor_gain_Nm_per_V", "motor_damping_Nms": "motor_damping_Nms",
            "normal_load_N": "load_N", "scrub_radius_m": "scrub_radius_m", "scrub_fade_m": "scrub_fade_m"}
    wheel: dict[str, Any] = {"body": _name(body), "x_m": x_m, "y_m": y_m, "kind": "roller",
                             **{name: table.number(key) for key, name in keys.items()}}
    roller, drag = table.number("roller_rad"), table.number("roller_drag")
    if abs(roller - math.pi / 2) < 1e-12 and drag == 1.0:
        return wheel | {"kind": "fixed"}
    return wheel | {"roller_rad": roller, "roller_drag": drag}


def start_at(vehicle: SlippingVehicle, start: Table, step_s: float) -> SlippingPlant:
    """The vehicle at the start of a case or of a single step."""
    *velocity, yaw_rate = (z := start.numbers("z", 3 + vehicle.body_count))[:3]
    x_m, y_m, heading_rad = start.numbers("pose", 3) if start.has("pose") else (0.0, 0.0, 0.0)
    return vehicle.plant(step_s=step_s, velocity_m_per_s=velocity, yaw_rate_rad_per_s=yaw_rate, x_m=x_m, y_m=y_m,
                         heading_rad=heading_rad, hinge_angle_rad=start.numbers("psi_rad", vehicle.body_count),
                         hinge_rate_rad_per_s=z[3:],
                         wheel_speed_rad_per_s=start.numbers("wheel_speed", vehicle.wheel_count))


def inputs_of(segment: Table, vehicle: SlippingVehicle) -> dict[str, Any]:
    """What a segment or single step holds."""
    return {"voltage_V": segment.numbers("voltage_V", vehicle.wheel_count),
            "steering_angle_rad": segment.numbers("servo_angle_rad", vehicle.body_count)}


def parts_of(plant: SlippingPlant) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Place, heading and angles; velocities and rates; wheel speeds."""
    motion = plant.motion()
    return (np.array([motion.x_m, motion.y_m, motion.heading_rad, *motion.hinge_angle_rad]),
            np.array([*motion.velocity_m_per_s, motion.yaw_rate_rad_per_s, *motion.hinge_rate_rad_per_s]),
            motion.wheel_speed_rad_per_s)


def verify_slipping_case(core: Core, case: Table, method: str, step_s: float, advance: Callable[[], None]
                         ) -> SlippingResult:
    """Runs one case and compares; a refusal of the core becomes the status. `method` is auto: there is one step."""
    name, check = case.text("name"), _trajectory if case.has("segments") else _single_steps
    try:
        return check(core, case, name, step_s, advance)
    except Refused as refused:
        return SlippingResult(name, f"{refused.status}: {refused}")
    except BadInput as bad:
        raise BadInput(f"{case.path}: {case.location}: {bad}" if str(case.path) not in str(bad) else str(bad)) from None


def _trajectory(core: Core, case: Table, name: str, step_s: float, advance: Callable[[], None]) -> SlippingResult:
    vehicle = SlippingVehicle(vehicle_table(case.table("vehicle", required=True)), core.real)
    plant, seconds = start_at(vehicle, case.table("start", required=True), step_s), 0.0
    for segment in case.tables("segments"):
        duration_s = segment.number("duration_s")
        if not 0.0 < duration_s < MOST_STEPS * step_s:
            segment.fail("duration_s", f"is {duration_s:g}; give a time above 0 that can be counted in steps of "
                         f"{step_s:g} s")
        steps, fitting = step_that_fits(duration_s, step_s)
        plant.set_step(fitting)
        began = time.perf_counter()
        plant.run(inputs_of(segment, vehicle), steps)
        seconds += time.perf_counter() - began
        advance()
    end = case.table("expected", required=True)
    pose = [end.number(key) for key in ("x_m", "y_m", "heading_rad")]
    expected = (np.array([*pose, *end.numbers("psi_rad", vehicle.body_count)]),
                np.array(end.numbers("z", 3 + vehicle.body_count)),
                np.array(end.numbers("wheel_speed", vehicle.wheel_count)))
    pose_error, nu_error, wheel_error = (float(np.abs(a - b).max())
                                         for a, b in zip(parts_of(plant), expected, strict=True))
    listed, key = case.table("prototype_error_by_step_s"), f"{step_s:g}"
    known = tuple(listed.numbers(key, 3)) if listed.has(key) else None
    return SlippingResult(name, "ok", nu_error, pose_error, wheel_error, prototype_error=known, seconds=seconds)


def _single_steps(core: Core, case: Table, name: str, step_s: float, advance: Callable[[], None]) -> SlippingResult:
    """Each step is taken with the size that the file gives it, whatever `step_s`."""
    vehicles, norm, rate, nu, wheel, seconds = case.table("vehicles", required=True), 0.0, 0.0, 0.0, 0.0, 0.0
    for step in case.tables("steps"):
        table = vehicle_table(vehicles.table(step.text("vehicle"), required=True))
        vehicle = SlippingVehicle(table, core.real)
        plant = start_at(vehicle, step, step.number("step_s"))
        began = time.perf_counter()
        plant.run(inputs_of(step, vehicle), 1)
        seconds += time.perf_counter() - began
        _, z, s = parts_of(plant)
        dz = np.array(plant.core.numbers(plant.c.z)[: len(z)], float) - step.numbers("expected_z", len(z))
        ds = s - step.numbers("expected_wheel_speed", len(s))
        mass = mass_matrix(table, step.numbers("solved_at_psi_rad", vehicle.body_count))
        inertia = np.array([each["inertia_kgm2"] for each in table["wheel"]])
        size = step.number("size_of_free_motion")
        norm = max(norm, float(np.sqrt(dz @ mass @ dz + inertia @ ds**2)) / (size if size > 0.0 else 1.0))
        rate, nu = max(rate, float(np.abs(dz[3:]).max(initial=0.0))), max(nu, float(np.abs(dz).max()))
        wheel = max(wheel, float(np.abs(ds).max(initial=0.0)))
    return SlippingResult(name, "ok", error_nu=nu, error_wheel=wheel, error_energy_norm=norm, error_hinge_rate=rate,
                          seconds=seconds)


def mass_matrix(table: dict[str, Any], angles: tuple[float, ...]) -> np.ndarray:
    """That of body 0's velocity and yaw rate and the hinge rates, axes of body 0, by the speed of each centre."""
    names, count = [CARRIAGE, *(body["name"] for body in table["body"])], len(table["body"])
    places, turns, paths = [complex(-table["com_x_m"], -table["com_y_m"])], [0.0], list[list[int]]([[]])
    mass = np.zeros((3 + count, 3 + count))
    for b, body in enumerate((table, *table["body"])):
        if b:
            above = names.index(body["parent"])
            places.append(places[above] + np.exp(1j * turns[above]) * complex(body["hinge_x_m"], body["hinge_y_m"]))
            turns.append(turns[above] + angles[b - 1])
            paths.append([*paths[above], b])
        centre = places[b] + np.exp(1j * turns[b]) * complex(body["com_x_m"], body["com_y_m"])
        rows = np.zeros((3, 3 + count))
        rows[0, 0] = rows[1, 1] = 1.0
        for column, lever in ((2, centre), *((2 + j, centre - places[j]) for j in paths[b])):
            rows[:, column] = -lever.imag, lever.real, 1.0
        mass += rows.T @ np.diag([body["mass_kg"], body["mass_kg"], body["yaw_inertia_kgm2"]]) @ rows
    return mass
