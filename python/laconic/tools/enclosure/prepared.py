"""The equation with the constants that the core made of a vehicle, each taken exactly: the second reading of a scene.

The distance of the core's result to this motion is what its steps alone cost; to that of the file's numbers it is what
they and the rounded preparation cost.
"""

from __future__ import annotations

from typing import Any

from flint import arb

from laconic.tools.enclosure.balls import Vector
from laconic.tools.enclosure.equation import Equation


def exact(numbers: Any) -> Vector:
    """Numbers of C as exact balls."""
    return [arb(float(x)) for x in numbers]


def prepared_equation(model: Any) -> Equation:
    """The equation of a laconic_model."""
    own, wheels = getattr(model, "rotated_twice", False), range(model.wheel_count)
    columns = zip(*(exact(row) for row in model.nu_of_zeta), strict=True)
    back = ([exact(row) for row in model.zeta_of_nu] if own else
            [[inertia * x for x in column] for inertia, column in zip(exact(model.inertia), columns, strict=True)])
    decay, sloped = exact(model.decay_per_s), getattr(model, "sloped", False)
    nu = [exact(row) for row in model.nu_of_zeta]
    return Equation(
        freedoms=model.dof, spin=nu[2], gyro=exact(model.gyro),
        damping=[[decay[i] if i == j else arb(0) for j in range(3)] for i in range(3)], nu_of_zeta=nu, zeta_of_nu=back,
        velocity_of_zeta=[exact(row) for row in model.velocity_of_zeta],
        yaw_rate_of_zeta=exact(model.yaw_rate_of_zeta),
        wheel_of_zeta=[exact(model.wheel_of_zeta[i]) for i in wheels], torque_scale=arb(model.torque_scale),
        voltage_scale=[arb(model.voltage_scale[i]) for i in wheels], wheel_radius_m=arb(model.wheel_radius_m),
        yaw_scale=arb(model.yaw_scale),
        slope_force_N=exact(model.slope_force_N) if sloped else [arb(0), arb(0)])
