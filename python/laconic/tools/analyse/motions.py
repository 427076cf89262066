"""What is varied in a bifurcation diagram, and over which range."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space

from laconic.errors import BadInput, shown
from laconic.tools.analyse.field import Field
from laconic.tools.analyse.from_core import Inputs, Subject, changed, field_of
from laconic.tools.analyse.speeds import reach_rad_per_s
from laconic.tools.analyse.steady import steady_polynomial

COMMANDS = {"nu1": 0, "nu2": 1}
VEHICLE_KEYS = ("mass_kg", "yaw_inertia_kgm2", "com_x_m", "com_y_m", "wheel_inertia_kgm2", "motor_gain_Nm_per_V",
                "motor_damping_Nms", "wheel_radius_m")


@dataclass(frozen=True)
class Parameter:
    """One number that is varied, and what the vehicle becomes for each of its values."""

    name: str
    label: str
    at_scene: float
    subject_of: Callable[[float], Subject]
    inputs_of: Callable[[float], Inputs]
    field_of: Callable[[float], Field]   # the vector field at a value
    reach: float = float("inf")          # the largest value that the vehicle can reach


def field_line(subject: Subject, inputs_of: Callable[[float], Inputs]) -> Callable[[float], Field]:
    """The field where only the inputs vary, linearly with the parameter, so the core computes it at 0 and 1 only."""
    start, end = (field_of(subject.core, subject.model, inputs_of(value)) for value in (0.0, 1.0))
    return lambda value: replace(start, forcing=start.forcing + value * (end.forcing - start.forcing))


def straight_torques(subject: Subject, nu: np.ndarray) -> Inputs:
    """Axle torques with which the straight motion ν⁰ is steady: c1_i U_i = c2_i Ξ_i ν⁰.

    Torques also serve where c1_i = 0; elsewhere the voltages U_i = (c2_i/c1_i) Ξ_i ν⁰ do the same.
    """
    damping = subject.of_wheels("motor_damping_Nms")
    return {f"axle_torque_Nm[{i + 1}]": float(v) for i, v in enumerate(damping * (subject.matrices.wheel_rows @ nu))}


def straight_columns(subject: Subject) -> np.ndarray:
    """What spans the straight motions (ν1, ν2) that the constraints allow: two rows, a column each; perhaps none."""
    columns = subject.allowed_columns
    return (columns @ null_space(columns[2:]))[:2]


def commanded_straight(subject: Subject) -> np.ndarray | None:
    """ν⁰ of the straight motion that the held inputs command; None when they command a turning motion."""
    field = subject.field()
    m = field.dof
    if not (field.decay_per_s[:m] > 0.0).all():
        return None
    nu = field.nu(field.forcing[:m] / field.decay_per_s[:m])
    return nu if abs(nu[2]) <= 1e-9 * max(1.0, float(np.abs(nu).max())) else None


def command_parameter(subject: Subject, name: str, straight: np.ndarray) -> Parameter:
    """One component of the commanded straight motion ν⁰ = (ν1⁰, ν2⁰, 0)."""
    which = COMMANDS[name]

    def inputs_of(value: float) -> Inputs:
        nu = straight.copy()
        nu[which] = value
        return straight_torques(subject, nu)

    label = f"commanded straight motion $\\nu_{which + 1}^0$ [rad/s]"
    return Parameter(name, label, float(straight[which]), lambda _: subject, inputs_of, field_line(subject, inputs_of),
                     reach_rad_per_s(subject, which, float(straight[which])))


def scale_parameter(subject: Subject) -> Parameter:
    """A factor on all inputs of the scene."""

    def inputs_of(value: float) -> Inputs:
        return {name: value * v for name, v in subject.inputs.items()}

    label = "factor on the inputs [–]"
    return Parameter("input_scale", label, 1.0, lambda _: subject, inputs_of, field_line(subject, inputs_of))


def vehicle_parameter(subject: Subject, key: str) -> Parameter:
    """A number of `[vehicle]`, with the scene's own inputs."""
    if key.startswith("motor_") and subject.scene.vehicle.get("motor"):
        raise BadInput(f"--parameter {key}: the scene gives [vehicle.motor] instead; vary another number")
    current = float(subject.scene.vehicle.get(key, 0.0))
    unit = key.rsplit("_", 1)[-1]
    return Parameter(key, f"{key.removesuffix('_' + unit).replace('_', ' ')} [{unit}]", current,
                     lambda value: changed(subject, key, value), lambda _: subject.inputs,
                     lambda value: changed(subject, key, value).field(), _farthest_wheel_m(subject))


def _farthest_wheel_m(subject: Subject) -> float:
    """Largest offset of a centre of mass: half the distance of the farthest wheel; infinite without wheels."""
    distances_m = [np.hypot(wheel.x_m, wheel.y_m) for wheel in subject.vehicle.wheel[0 : subject.wheel_count]]
    return 0.5 * max(distances_m, default=0.0) or float("inf")


def parameter_named(subject: Subject, name: str | None, straight: np.ndarray | None) -> Parameter:
    """The parameter the user asked for, or the one that suits: the larger component of the straight motion."""
    if name is None:
        if straight is None:
            return scale_parameter(subject)
        name = "nu2" if abs(straight[1]) >= abs(straight[0]) and _is_possible(subject, "nu2") else "nu1"
    if name in COMMANDS:
        if straight is None:
            raise BadInput(f"--parameter {name}: the inputs command no straight motion; give one with --straight NU1 "
                           f"NU2")
        if not _is_possible(subject, name):
            raise BadInput(f"--parameter {name}: the constraints forbid straight motion that way; vary another number")
        return command_parameter(subject, name, straight)
    if name == "input_scale":
        return scale_parameter(subject)
    if name in VEHICLE_KEYS:
        return vehicle_parameter(subject, name)
    known = ", ".join((*COMMANDS, "input_scale", *VEHICLE_KEYS))
    raise BadInput(f"--parameter: there is no {shown(name)}; known are {known}")


def _is_possible(subject: Subject, name: str) -> bool:
    return bool(np.abs(straight_columns(subject)[COMMANDS[name]]).max(initial=0.0) > 1e-9)


def straight_thresholds(parameter: Parameter) -> list[float]:
    """Where the straight motion of a command parameter changes stability: det J is a cubic in the parameter."""

    def determinant(value: float) -> float:
        field = parameter.field_of(value)
        m = field.dof
        return float(np.linalg.det(field.jacobian(field.forcing[:m] / field.decay_per_s[:m])))

    return _real_roots(determinant, 3, max(1.0, abs(parameter.at_scene)))


def turning_folds(parameter: Parameter) -> list[float]:
    """Vertices: with straight motion divided out, turning ones solve a quadratic; its discriminant is a quadratic."""

    def discriminant(value: float) -> float:
        _, lowest, linear, square = steady_polynomial(parameter.field_of(value))
        return linear**2 - 4.0 * lowest * square

    return _real_roots(discriminant, 2, max(1.0, abs(parameter.at_scene)))


def _real_roots(function: Callable[[float], float], degree: int, size: float) -> list[float]:
    """Real roots of a polynomial known by its values."""
    samples = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    coefficients = np.polyfit(samples, [function(size * u) for u in samples], degree)
    coefficients[np.abs(coefficients) < 1e-10 * np.abs(coefficients).max()] = 0.0
    roots = np.roots(np.trim_zeros(coefficients, "f")) if coefficients.any() else np.zeros(0)
    return sorted(float(r.real) * size for r in roots if abs(r.imag) < 1e-9 * max(1.0, abs(r)))


def default_range(parameter: Parameter) -> tuple[float, float]:
    """A range that the vehicle can reach, and in it the scene's own value and every change of stability.

    Where a commanded motion changes nothing within reach, all that is within reach is shown.
    """
    value = parameter.at_scene
    if parameter.name in COMMANDS:
        return _command_range(parameter)
    if parameter.name == "input_scale":
        return -2.0, 2.0
    if parameter.name.startswith("com_"):
        size = abs(value) or min(0.1, parameter.reach)
        return value - size, value + size
    return (0.3 * value, 3.0 * value) if value > 0.0 else (0.0, 0.1)


def _command_range(parameter: Parameter) -> tuple[float, float]:
    reach = parameter.reach or 1.0
    marks = [m for m in (*straight_thresholds(parameter), *turning_folds(parameter)) if abs(m) <= reach]
    if not marks:
        return -reach, reach
    marks += [0.0, parameter.at_scene]
    low, high = min(marks), max(marks)
    spread = high - low
    return max(low - 0.15 * spread, -reach), min(high + 0.25 * spread, reach)
