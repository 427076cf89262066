"""The core against reference trajectories of vehicles with hinges: the format articulated-1.

Bodies, hinges, wheels; segments with held inputs and polynomials of rates and twists; states at the segments' ends.
Within a step the core has rates and twists as cubics, so polynomials up to that degree are given without error.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import polynomial

from laconic.core import Core
from laconic.core.articulated import CARRIAGE, HINGES, ArticulatedPlant, ArticulatedVehicle
from laconic.core.articulated_input import member_of
from laconic.errors import BadInput, Refused
from laconic.scene.table import Table
from laconic.tools.verify.trajectories import decimal, error_of, held_of, steps_of, worst_of

STATE = (("velocity", "velocity"), ("pose", "pose"), ("psi", "hinge_angle"), ("hinge_rate", "hinge_rate"),
         ("chi", "wheel"))


@dataclass(frozen=True)
class ArticulatedResult:
    """Result of one case; errors are relative to max(1, largest reference value of the kind), None when refused."""

    name: str
    status: str
    error_velocity: float | None = None
    error_hinge_rate: float | None = None
    error_hinge_angle: float | None = None
    error_pose: float | None = None
    error_wheel: float | None = None
    seconds: float = 0.0

    @property
    def errors(self) -> list[float | None]:
        """All of them: velocity, hinge rate, hinge angle, pose, wheels."""
        return [self.error_velocity, self.error_hinge_rate, self.error_hinge_angle, self.error_pose, self.error_wheel]

    @property
    def worst(self) -> float:
        """The largest of the errors; infinite when the case was refused."""
        return worst_of(self.status, self.errors)


def vehicle_table(case: Table) -> dict[str, Any]:
    """The case's vehicle as laconic.core.ArticulatedVehicle takes it."""
    table = case.table("vehicle", required=True)
    bodies, wheels = list(table.tables("bodies")), list(table.tables("wheels"))
    if not bodies:
        table.fail("bodies", "holds none; give the carriage first")
    carriage = bodies[0]
    x_m, y_m = carriage.numbers("com", 2)
    return {"mass_kg": carriage.number("mass"), "yaw_inertia_kgm2": carriage.number("inertia"), "com_x_m": x_m,
            "com_y_m": y_m, "wheel_radius_m": wheels[0].number("radius") if wheels else 0.0,
            "body": [_body(each, number) for number, each in enumerate(bodies[1:], 1)],
            "wheel": [_wheel(each, len(bodies)) for each in wheels]}


def _name(number: int) -> str:
    return f"body_{number}" if number else CARRIAGE


def _body(table: Table, number: int) -> dict[str, Any]:
    parent = table.whole("parent")
    if not 0 <= parent < number:
        table.fail("parent", f"is {parent}; give the number of a body before this one, 0 to {number - 1}")
    joint = table.table("joint", required=True)
    (x_m, y_m), (com_x_m, com_y_m) = table.numbers("hinge", 2), table.numbers("com", 2)
    keys = {"damping": "damping_Nms", "stiffness": "stiffness_Nm", "rest": "rest_rad", "gain": "gain_Nm_per_V"}
    return {"name": _name(number), "parent": _name(parent), "hinge": joint.choice("kind", HINGES), "hinge_x_m": x_m,
            "hinge_y_m": y_m, "mass_kg": table.number("mass"), "com_x_m": com_x_m, "com_y_m": com_y_m,
            "yaw_inertia_kgm2": table.number("inertia"),
            **{name: joint.number(key, 0.0) for key, name in keys.items()}}


def _wheel(table: Table, bodies: int) -> dict[str, Any]:
    kind, body = table.choice("kind", ("roller", "fixed")), table.whole("body")
    if not 0 <= body < bodies:
        table.fail("body", f"is {body}; give the number of a body, 0 to {bodies - 1}")
    x_m, y_m = table.numbers("at", 2)
    gain, damping = table.number("gain"), table.number("damping")
    wheel = {"kind": kind, "body": _name(body), "x_m": x_m, "y_m": y_m, "axle_rad": table.number("axle"),
             "radius_m": table.number("radius"), "inertia_kgm2": table.number("inertia"), "motor_gain_Nm_per_V": gain,
             "motor_damping_Nms": damping}
    wheel |= {"roller_rad": table.number("roller")} if kind == "roller" else {}
    return wheel | ({"locked": True} if table.has("locked") and table.flag("locked") else {})


def held_with_hinges(segment: Table, vehicle: ArticulatedVehicle) -> dict[str, Any]:
    """What a segment holds, by the names of inputs."""
    held = held_of(segment, vehicle.wheel_count)
    for key, name in (("hinge_U", "hinge_voltage_V"), ("hinge_torque", "hinge_torque_Nm")):
        for number in _by_hinge(segment, key, vehicle):
            held[f"{name}[{_name(number)}]"] = segment.table(key).number(str(number))
    return held


def _by_hinge(segment: Table, key: str, vehicle: ArticulatedVehicle) -> list[int]:
    """The numbers of the bodies that an object names."""
    found = segment.table(key).plain() if segment.has(key) else {}
    for number in found:
        if not number.isdecimal() or not 1 <= int(number) <= vehicle.body_count:
            segment.fail(key, f"names the body {number}; give 1 to {vehicle.body_count}")
    return [int(number) for number in found]


def polynomials_of(segment: Table, core: Core, vehicle: ArticulatedVehicle) -> dict[int, tuple[int, np.ndarray]]:
    """Rates and twists: where they stand in a row → where their derivative stands, and their coefficients."""
    rates, accelerations, twists, twist_rates = (member_of(core, name)[0] for name in (
        "hinge_rate_rad_per_s", "hinge_acceleration_rad_per_s2", "twist", "twist_rate"))
    found = {}
    for number in _by_hinge(segment, "hinge_rate", vehicle):
        values = np.array(segment.table("hinge_rate").numbers(str(number)) or (0.0,))
        found[rates + number - 1] = (accelerations + number - 1, values)
    if segment.has("twist"):
        rows = segment.value("twist", ..., (list,), "three lists of coefficients")
        inner = Table(segment.path, segment.name("twist"), {str(i): row for i, row in enumerate(rows, 1)})
        if len(rows) != 3:
            segment.fail("twist", f"has {len(rows)} lists; give three: ξ, η, yaw")
        for i in range(3):
            values = np.array(inner.numbers(str(i + 1)) or (0.0,))
            found[twists + i] = (twist_rates + i, values)
    return found


def rows_of(base: np.ndarray, polynomials: dict[int, tuple[int, np.ndarray]], step_s: float, steps: int) -> np.ndarray:
    """Inputs at the start and end of each step of a segment."""
    rows = np.broadcast_to(base, (steps, 2, len(base))).copy()
    times = step_s * (np.arange(steps)[:, None] + np.array([0.0, 1.0]))
    for slot, (rate, values) in polynomials.items():
        rows[:, :, slot] = polynomial.polyval(times, values)
        rows[:, :, rate] = polynomial.polyval(times, polynomial.polyder(values))
    return rows


def start_case(vehicle: ArticulatedVehicle, case: Table, method: str, step_s: float, row: np.ndarray
               ) -> ArticulatedPlant:
    """The case's vehicle at its start, which is projected onto what its wheels allow."""
    initial, hinges = case.table("initial", required=True), vehicle.body_count
    x_m, y_m, heading_rad = initial.numbers("pose", 3)
    *velocity, yaw_rate = initial.numbers("velocity", 3)
    return vehicle.plant(method, step_s, velocity_m_per_s=velocity, yaw_rate_rad_per_s=yaw_rate, x_m=x_m, y_m=y_m,
                         heading_rad=heading_rad, hinge_angle_rad=initial.numbers("psi", hinges),
                         hinge_rate_rad_per_s=initial.numbers("hinge_rate", hinges), inputs=row)


def state_of(plant: ArticulatedPlant) -> dict[str, np.ndarray]:
    """The state as the reference has it, by the kinds of errors."""
    motion = plant.motion()
    return {"velocity": np.array([*motion.velocity_m_per_s, motion.yaw_rate_rad_per_s]),
            "pose": np.array([motion.x_m, motion.y_m, motion.heading_rad]), "hinge_angle": motion.hinge_angle_rad,
            "hinge_rate": motion.hinge_rate_rad_per_s, "wheel": motion.wheel_angle_rad}


def follow(core: Core, vehicle: ArticulatedVehicle, case: Table, method: str, step_s: float,
           advance: Callable[[], None]) -> tuple[list[dict[str, np.ndarray]], float]:
    """States at the start and at the segments' ends, and the seconds that the core took."""
    segments, plant = list(case.tables("segments")), None
    if not segments:
        case.fail("segments", "holds none; give at least one")
    states, seconds = [], 0.0
    for segment in segments:
        steps, fitting = steps_of(segment, step_s)
        base = vehicle.input_row(held_with_hinges(segment, vehicle)).astype(float)
        rows = rows_of(base, polynomials_of(segment, core, vehicle), fitting, steps).astype(core.dtype)
        if plant is None:
            plant = start_case(vehicle, case, method, fitting, rows[0, 0])
            states.append(state_of(plant))
        plant.set_step(fitting)
        began = time.perf_counter()
        plant.follow(rows, ramped=False)
        seconds += time.perf_counter() - began
        states.append(state_of(plant))
        advance()
    return states, seconds


def verify_articulated_case(core: Core, case: Table, method: str, step_s: float, advance: Callable[[], None]
                            ) -> ArticulatedResult:
    """Runs one case and compares; a refusal of the core becomes the status."""
    name = case.text("name")
    table = vehicle_table(case)
    try:
        vehicle = ArticulatedVehicle(table, core.real)
        states, seconds = follow(core, vehicle, case, method, step_s, advance)
    except Refused as refused:
        return ArticulatedResult(name, f"{refused.status}: {refused}")
    except BadInput as bad:
        raise BadInput(f"{case.path}: {case.location}: {bad}" if str(case.path) not in str(bad) else str(bad)) from None
    given = list(case.tables("states"))
    if len(given) != len(states):
        case.fail("states", f"are {len(given)}; give one at the start and one at the end of each of the "
                  f"{len(states) - 1} segments")
    errors = {}
    for key, kind in STATE:
        expected = np.array([[decimal(state, key, text) for text in state.texts(key)] for state in given])
        found = np.array([state[kind] for state in states], float)
        if found.shape != expected.shape:
            case.fail("states", f"have {key} of shape {expected.shape}, the vehicle needs {found.shape}")
        errors[f"error_{kind}"] = error_of(found, expected)
    return ArticulatedResult(name, "ok", seconds=seconds, **errors)
