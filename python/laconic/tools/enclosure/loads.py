"""What acts on the vehicle, held over stretches of time: exact values, and the b0 + b1 cos θ + b2 sin θ of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from laconic.tools.enclosure.balls import Number, Vector, ball, combined_vectors
from laconic.tools.enclosure.equation import Equation


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
