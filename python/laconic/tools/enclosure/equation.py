"""The equation ζ' = (g·ζ)(ζ×w) − Rζ + b with pose and wheel angles, in balls, from the exact numbers of a vehicle.

Everything from (4.3), (4.4) and (4.6) once more; the core's preparation has no part in it. ζ are coordinates in which
|ζ|² = νᵀAν: the length of ζ is the energy norm. G need not make the damping R exactly diagonal: R is a matrix here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb

from laconic.errors import BadInput
from laconic.tools.enclosure.balls import (
    Matrix,
    Number,
    Vector,
    added,
    ball,
    combined_vectors,
    cross,
    dot,
    times,
    transposed,
)

# ---- What acts on the vehicle, held over stretches of time: exact values, and the b0 + b1 cos θ + b2 sin θ of
# each.

@dataclass(frozen=True)
class Stretch:
    """A time over which every input holds its value, by the names of a scene; what is not named is 0."""

    begin_s: Fraction
    end_s: Fraction
    values: Mapping[str, Number]


@dataclass(frozen=True)
class Forcing:
    """b = constant + cos θ · cosine + sin θ · sine."""

    constant: Vector
    cosine: Vector
    sine: Vector


def forcing_of(equation: Equation, values: Mapping[str, Number]) -> Forcing:
    """The forcing of ζ' by held inputs."""
    def value(name: str) -> arb:
        return ball(values.get(name, 0))

    wheels = range(len(equation.wheel_of_zeta))
    torques = [equation.voltage_scale[i] * value(f"voltage_V[{i + 1}]")
               + equation.torque_scale * value(f"axle_torque_Nm[{i + 1}]") for i in wheels]
    point = [value("world_force_point_m[1]"), value("world_force_point_m[2]")]
    world = [value("world_force_N[1]"), value("world_force_N[2]")]
    body = wrench(equation, [value("body_force_N[1]"), value("body_force_N[2]")], value("body_moment_Nm"))
    turned = [world[1], -world[0]]  # in body axes the force is cos θ · world + sin θ · turned
    along, across = (
        combined_vectors([arb(1), arb(1)], [wrench(equation, force, point[0] * force[1] - point[1] * force[0]),
                                            wrench(equation, slope, arb(0))])
        for force, slope in ((world, equation.slope_force_N),
                             (turned, [equation.slope_force_N[1], -equation.slope_force_N[0]])))
    return Forcing(combined_vectors([*torques, arb(1)], [*equation.wheel_of_zeta, body]), along, across)


def wrench(equation: Equation, force_N: Vector, moment_Nm: arb) -> Vector:
    """The part of ζ' by a force in body axes at S, and a moment."""
    rows = [*equation.velocity_of_zeta, equation.yaw_rate_of_zeta]
    return [equation.torque_scale * x for x in combined_vectors([*force_N, moment_Nm], rows)]


GRAVITY_M_PER_S2 = "9.80665"
DEPENDENT = 1e-9  # constraints closer than this count once: the core's own rule, of the model and not of rounding
SWEEPS = 8  # of Jacobi's turns, which square what is left each time

Numbers = Mapping[str, Any]


@dataclass(frozen=True)
class Equation:
    """What the motion needs, for vectors ζ padded with 0 to three numbers."""

    freedoms: int
    spin: Vector                # g: ν3 = g·ζ
    gyro: Vector                # w
    damping: Matrix             # R
    nu_of_zeta: Matrix          # G
    zeta_of_nu: Matrix
    velocity_of_zeta: Matrix    # v_S in body axes, m/s
    yaw_rate_of_zeta: Vector
    wheel_of_zeta: Matrix       # Ξ G
    torque_scale: arb           # 1/(M R²)
    voltage_scale: Vector       # c1/(M R²) of each wheel
    wheel_radius_m: arb
    yaw_scale: arb              # Λ
    slope_force_N: Vector = field(default_factory=lambda: [arb(0), arb(0)])  # world axes, at S


@dataclass(frozen=True)
class Totals:
    """Mass, centre of mass and yaw inertia about it, robot and payload together."""

    mass: arb
    com: Vector
    inertia: arb


def numbers_in(table: Numbers, *keys: str) -> Vector:
    """Some numbers of a table, 0 where one is not given."""
    return [ball(table.get(key, 0)) for key in keys]


def angle(table: Numbers, stem: str, usual: arb | None = None) -> arb:
    """An angle in rad, from stem_rad or from stem_deg."""
    if f"{stem}_deg" in table:
        return ball(table[f"{stem}_deg"]) * arb.pi() / 180
    return ball(table[f"{stem}_rad"]) if f"{stem}_rad" in table or usual is None else usual


def totals_of(vehicle: Numbers) -> Totals:
    """Parallel axes."""
    mass, com_x, com_y, inertia = numbers_in(vehicle, "mass_kg", "com_x_m", "com_y_m", "yaw_inertia_kgm2")
    load, load_x, load_y, own = numbers_in(vehicle.get("payload", {}), "mass_kg", "x_m", "y_m", "yaw_inertia_kgm2")
    both = mass + load
    com = [(mass * com_x + load * load_x) / both, (mass * com_y + load * load_y) / both]
    return Totals(both, com, inertia + own + mass * load / both * ((load_x - com_x) ** 2 + (load_y - com_y) ** 2))


def drive_of(vehicle: Numbers) -> tuple[arb, arb, arb]:
    """Gain c1, damping c2 and the rotor's inertia at the wheel."""
    if "motor" not in vehicle:
        gain, damping = numbers_in(vehicle, "motor_gain_Nm_per_V", "motor_damping_Nms")
        return gain, damping, arb(0)
    motor = vehicle["motor"]
    resistance, torque, emf, ratio, viscous, rotor = numbers_in(
        motor, "resistance_ohm", "torque_constant_Nm_per_A", "back_emf_Vs_per_rad", "gear_ratio",
        "viscous_friction_Nms", "rotor_inertia_kgm2")
    return ratio * torque / resistance, ratio**2 * (torque * emf / resistance + viscous), ratio**2 * rotor


def place_of(wheel: Numbers) -> Vector:
    """The wheel's centre in the body frame."""
    if "distance_m" not in wheel:
        return numbers_in(wheel, "x_m", "y_m")
    bearing = angle(wheel, "bearing")
    return [ball(wheel["distance_m"]) * bearing.cos(), ball(wheel["distance_m"]) * bearing.sin()]


@dataclass(frozen=True)
class Wheel:
    """One wheel's row of Ξ, its inertia and motor at the wheel, and the constraints that it adds."""

    row: Vector
    inertia: arb
    gain: arb
    damping: arb
    constraints: list[Vector]


def wheel_of(wheel: Numbers, vehicle: Numbers, totals: Totals, scale: arb) -> Wheel:
    """A wheel by its own values, else the vehicle's; `scale` is R Λ."""
    gain, damping, rotor = drive_of(vehicle)
    if not wheel.get("driven", True):
        gain = damping = rotor = arb(0)
    elif "motor_gain_Nm_per_V" in wheel or "motor_damping_Nms" in wheel:
        gain = ball(wheel["motor_gain_Nm_per_V"]) if "motor_gain_Nm_per_V" in wheel else gain
        damping = ball(wheel["motor_damping_Nms"]) if "motor_damping_Nms" in wheel else damping
    inertia = ball(wheel.get("inertia_kgm2", vehicle.get("wheel_inertia_kgm2", 0))) + rotor
    radius = ball(vehicle["wheel_radius_m"]) / ball(wheel.get("radius_m", vehicle["wheel_radius_m"]))
    axle, is_fixed = angle(wheel, "axle"), wheel["kind"] == "fixed"
    roller = arb.pi() / 2 if is_fixed else angle(wheel, "roller", arb.pi() / 2 if wheel["kind"] == "omni" else None)
    arm = [p - s for p, s in zip(place_of(wheel), totals.com, strict=True)]
    row = [x * radius / roller.sin() for x in velocity_along(arm, axle + roller, scale)]
    bound = ([velocity_along(arm, axle, scale)] if is_fixed else []) + ([row] if wheel.get("locked") else [])
    return Wheel(row, inertia, gain, damping, bound)


def velocity_along(arm: Vector, direction: arb, scale: arb) -> Vector:
    """Velocity of a point of the body along a direction, over R, as factors of ν."""
    sine, cosine = direction.sin_cos()
    return [cosine, sine, (arm[0] * sine - arm[1] * cosine) / scale]


def orthonormal(rows: Sequence[Vector], known: Sequence[Vector]) -> list[Vector]:
    """Directions of the rows beyond those known; a row that depends on them adds none."""
    found = list(known)
    for row in rows:
        rest = [x / dot(row, row).sqrt() for x in row]
        for _ in range(2):
            for axis in found:
                rest = added(rest, -dot(rest, axis), axis)
        size = dot(rest, rest)
        if len(found) < 3 and size > DEPENDENT**2:
            found.append([x / size.sqrt() for x in rest])
        elif not size < DEPENDENT**2:
            raise BadInput("two constraints of wheels are too near to the border between one and two to be told apart; "
                           "move a wheel")
    return found[len(known):]


def quadratic(rows: Sequence[Vector], weights: Sequence[arb]) -> Matrix:
    """Σ weight · row rowᵀ."""
    return [[sum((s * row[i] * row[j] for s, row in zip(weights, rows, strict=True)), arb(0)) for j in range(3)]
            for i in range(3)]


def energy_axes(form: Matrix, basis: Sequence[Vector]) -> list[Vector]:
    """Columns of G with GᵀAG = 1 on the motions that `basis` spans: Gram and Schmidt by the inner product of A."""
    found: list[Vector] = []
    for row in basis:
        rest = list(row)
        for _ in range(2):
            for axis in found:
                rest = added(rest, -dot(times(form, rest), axis), axis)
        found.append([x / dot(times(form, rest), rest).sqrt() for x in rest])
    return found


def principal(columns: Sequence[Vector], damped: Matrix) -> list[Vector]:
    """The columns turned to near the axes of the damping, by Jacobi's turns; each turn is exactly orthonormal, only its
    angle is rounded."""
    axes = list(columns)
    for _ in range(SWEEPS):
        for i in range(len(axes)):
            for j in range(i):
                across = dot(times(damped, axes[i]), axes[j]).mid()
                if across != 0:
                    along, other = (dot(times(damped, axes[k]), axes[k]).mid() for k in (i, j))
                    sine, cosine = (arb.atan2(2 * across, along - other).mid() / 2).sin_cos()
                    axes[i], axes[j] = (added([x * cosine for x in axes[i]], sine, axes[j]),
                                        added([x * cosine for x in axes[j]], -sine, axes[i]))
    return axes


def pseudo_inverse(columns: Sequence[Vector], form: Matrix) -> Matrix:
    """ζ = Gᵀ A ν, which takes each ν that the constraints allow to its ζ."""
    return [times(form, column) for column in columns]


def padded(vector: Sequence[arb]) -> Vector:
    return [*vector, *(arb(0) for _ in range(3 - len(vector)))]


def slope_of(ground: Numbers, mass: arb) -> Vector:
    """The downhill part of the weight, in world axes."""
    if not ("slope_rad" in ground or "slope_deg" in ground):
        return [arb(0), arb(0)]
    pull = mass * arb(GRAVITY_M_PER_S2) * angle(ground, "slope").sin()
    uphill = angle(ground, "slope_heading", arb(0))
    return [-pull * uphill.cos(), -pull * uphill.sin()]


def equation_of(vehicle: Numbers, ground: Numbers | None = None) -> Equation:
    """The equation of `[vehicle]` (and of a slope of `[ground]`) with the keys of a scene file, numbers exact."""
    totals, radius = totals_of(vehicle), ball(vehicle["wheel_radius_m"])
    unit = totals.mass * radius**2
    yaw_scale = (totals.inertia / unit).sqrt()
    wheels = [wheel_of(each, vehicle, totals, radius * yaw_scale) for each in vehicle.get("wheel", ())]
    rows = [wheel.row for wheel in wheels]
    identity = [[arb(i == j) for j in range(3)] for i in range(3)]
    form = [[e + a for e, a in zip(*both, strict=True)]
            for both in zip(identity, quadratic(rows, [w.inertia / unit for w in wheels]), strict=True)]
    damped = quadratic(rows, [w.damping / unit for w in wheels])
    bound = orthonormal([row for wheel in wheels for row in wheel.constraints], [])
    columns = principal(energy_axes(form, orthonormal(identity, bound)), damped)
    nu = [padded(row) for row in transposed(columns)]
    missing = [[arb(0)] * 3] * (3 - len(columns))
    return Equation(
        freedoms=len(columns), spin=nu[2], gyro=[x / yaw_scale for x in cross(nu[0], nu[1])],
        damping=[*(padded([dot(times(damped, a), b) for a in columns]) for b in columns), *missing],
        nu_of_zeta=nu, zeta_of_nu=[*pseudo_inverse(columns, form), *missing],
        velocity_of_zeta=[[radius * x for x in row] for row in nu[:2]],
        yaw_rate_of_zeta=[x / yaw_scale for x in nu[2]],
        wheel_of_zeta=[[dot(row, axis) for axis in transposed(nu)] for row in rows],
        torque_scale=1 / unit, voltage_scale=[w.gain / unit for w in wheels], wheel_radius_m=radius,
        yaw_scale=yaw_scale, slope_force_N=slope_of(ground or {}, totals.mass))
