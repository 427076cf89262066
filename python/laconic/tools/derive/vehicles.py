"""The paper's vehicles and a further one, as systems for the laconic equations."""

from __future__ import annotations

import sympy as sp

from laconic.tools.derive.brackets import Bracketed, bracketed, impose
from laconic.tools.derive.equations import System


def _positive(names: str) -> tuple[sp.Symbol, ...]:
    return sp.symbols(names, positive=True)


def _real(names: str) -> tuple[sp.Symbol, ...]:
    return sp.symbols(names, real=True)


def caster() -> System:
    """Section 3, the piano wheel: pushed by a force F along OX at the fork's point Q = C − D e_θ."""
    m, radius, yaw_inertia, wheel_inertia = _positive("m R J_1 J_3")
    x, y, theta, chi, arm, force = _real("x y theta chi D F")
    rates = _real("x' y' theta' chi'")
    yaw_rate, roll_rate = _real("omega_theta omega_chi")
    lagrangian = (m * (rates[0] ** 2 + rates[1] ** 2) + yaw_inertia * rates[2] ** 2 + wheel_inertia * rates[3] ** 2) / 2
    # the work of F e_x on δr_C + δθ e_z × (−D e_θ): the lever of F about C is D sin θ
    return System(
        name="caster",
        coordinates=(x, y, theta, chi),
        rates=rates,
        pseudo_velocities=(yaw_rate, roll_rate),
        pseudo_rates=_real("omega_theta' omega_chi'"),
        lagrangian=lagrangian,
        velocities=(radius * roll_rate * sp.cos(theta), radius * roll_rate * sp.sin(theta), yaw_rate, roll_rate),
        forces=(force, sp.Integer(0), arm * force * sp.sin(theta), sp.Integer(0)),
    )


def wheel_rows(wheel_count: int) -> sp.Matrix:
    """Ξ as symbols σ_i1, σ_i2, σ_i3 (the paper's sums for P_α print the indices the other way round)."""
    return sp.Matrix(wheel_count, 3, lambda i, s: sp.Symbol(f"sigma_{i + 1}{s + 1}", real=True))


def carriage(rows: sp.Matrix, wheels_differ: bool = False) -> System:
    """Section 4: N roller-carrying wheels with Ξ = rows, axle torques M_i, an outer force and moment.

    The force (F_xi, F_eta) is given in body axes and acts at the centre of mass, with the moment tau; the force
    (F_X, F_Y) is fixed in the world and acts at the body point (r_xi, r_eta), seen from the centre of mass. With
    `wheels_differ` each wheel has an inertia of its own, lambda_i**2 M R**2; a radius of its own is in its row.
    """
    count = rows.shape[0]
    mass, radius, lambda_yaw, _ = _positive("M R Lambda lambda")
    x, y, theta = _real("x y theta")
    chi = tuple(sp.Symbol(f"chi_{i + 1}", real=True) for i in range(count))
    chi_rates = tuple(sp.Symbol(f"chi_{i + 1}'", real=True) for i in range(count))
    torques = tuple(sp.Symbol(f"M_{i + 1}", real=True) for i in range(count))
    nu = _real("nu_1 nu_2 nu_3")
    rates = (*_real("x' y' theta'"), *chi_rates)
    yaw_inertia, unit = lambda_yaw**2 * mass * radius**2, mass * radius**2
    cos, sin = sp.cos(theta), sp.sin(theta)
    energy = mass * (rates[0] ** 2 + rates[1] ** 2) + yaw_inertia * rates[2] ** 2
    if wheels_differ:
        energy += unit * sp.Add(*(s**2 * rate**2 for s, rate in zip(wheel_symbols(count), chi_rates, strict=True)))
    else:
        energy += sp.Symbol("lambda", positive=True) ** 2 * unit * sp.Add(*(rate**2 for rate in chi_rates))
    velocities = (radius * (cos * nu[0] - sin * nu[1]), radius * (sin * nu[0] + cos * nu[1]), nu[2] / lambda_yaw)
    body_xi, body_eta, moment, world_x, world_y, arm_xi, arm_eta = _real("F_xi F_eta tau F_X F_Y r_xi r_eta")
    lever_x, lever_y = cos * arm_xi - sin * arm_eta, sin * arm_xi + cos * arm_eta
    return System(
        name=f"carriage with {count} wheels",
        coordinates=(x, y, theta, *chi),
        rates=rates,
        pseudo_velocities=nu,
        pseudo_rates=_real("nu_1' nu_2' nu_3'"),
        lagrangian=energy / 2,
        velocities=(*velocities, *(rows * sp.Matrix(nu))),
        forces=(
            cos * body_xi - sin * body_eta + world_x,
            sin * body_xi + cos * body_eta + world_y,
            moment + lever_x * world_y - lever_y * world_x,
            *torques,
        ),
    )


def wheel_symbols(count: int) -> list[sp.Symbol]:
    """lambda_1 … of wheels that differ: J_i = lambda_i**2 M R**2."""
    return [sp.Symbol(f"lambda_{i + 1}", positive=True) for i in range(count)]


def geometry_row(alpha: sp.Expr, beta: sp.Expr, gamma: sp.Expr, delta: sp.Expr) -> list[sp.Expr]:
    """One row of Ξ by (4.3) and (4.4): polar position (δ R, α) from Q, axle β, roller γ; S is at Δ R on Qη."""
    offset, lambda_yaw = sp.Symbol("Delta", real=True), sp.Symbol("Lambda", positive=True)
    lever = offset * sp.cos(beta + gamma) + delta * sp.sin(beta + gamma - alpha)
    return [entry / sp.sin(gamma) for entry in (sp.cos(beta + gamma), sp.sin(beta + gamma), lever / lambda_yaw)]


def two_wheel_rows() -> sp.Matrix:
    """Ξ⁰ of (6.1): two wheels on the line through Q along ξ, δ1 = δ2 = Λσ, α = β = 0, π, γ = π/2."""
    half_track = sp.Symbol("Lambda", positive=True) * sp.Symbol("sigma", positive=True)
    return sp.Matrix([geometry_row(angle, angle, sp.pi / 2, half_track) for angle in (sp.Integer(0), sp.pi)])


def three_wheel_rows() -> sp.Matrix:
    """Ξ of the paper's section 5 example (Fig. 3), in σ and ρ."""
    sigma, rho = _positive("sigma rho")
    return sp.Matrix([[0, 1, sigma], [0, -1, sigma], [-1, 0, rho]])


def differential_drive() -> Bracketed:
    """Section 6: the two-wheel carriage under ν1 = −Δ ν3/Λ, by linearity of the brackets alone."""
    offset, lambda_yaw = sp.Symbol("Delta", real=True), sp.Symbol("Lambda", positive=True)
    basis = sp.Matrix([[0, -offset / lambda_yaw], [1, 0], [0, 1]])
    return impose(bracketed(carriage(two_wheel_rows())), basis, kept=(1, 2), name="differential drive")


def differential_drive_from_scratch() -> System:
    """The same vehicle with the constraint put into the velocities at once: the check of the shortcut."""
    wide = carriage(two_wheel_rows())
    offset, lambda_yaw = sp.Symbol("Delta", real=True), sp.Symbol("Lambda", positive=True)
    nu_1, nu_2, nu_3 = wide.pseudo_velocities
    narrow = {nu_1: -offset * nu_3 / lambda_yaw}
    return System(
        name="differential drive",
        coordinates=wide.coordinates,
        rates=wide.rates,
        pseudo_velocities=(nu_2, nu_3),
        pseudo_rates=wide.pseudo_rates[1:],
        lagrangian=wide.lagrangian,
        velocities=tuple(v.xreplace(narrow) for v in wide.velocities),
        forces=wide.forces,
    )


def tractor_with_trailer() -> System:
    """Not in the paper: a differential-drive tractor that pulls a one-axle trailer on a hitch behind its axle.

    Here L* depends on the fold angle φ = θ − ψ (ψ: the trailer's heading), so the bracket {P_α, L*} does not vanish,
    unlike in the paper's vehicles. (x, y) is the middle of the tractor's axle, which moves along e_θ; the tractor's
    centre of mass lies d ahead of it, the hitch a behind it, the trailer's axle b behind the hitch, and the trailer's
    centre of mass l ahead of the trailer's axle.
    """
    mass, trailer_mass, yaw_inertia, trailer_inertia, wheel_inertia = _positive("M m I I_t J")
    radius, half_track, ahead, hitch, drawbar, trailer_ahead = _positive("R s d a b l")
    x, y, theta, fold, chi_l, chi_r = _real("x y theta phi chi_l chi_r")
    rates = _real("x' y' theta' phi' chi_l' chi_r'")
    speed, yaw_rate = _real("v omega")
    left, right = _real("M_l M_r")
    forward = rates[0] * sp.cos(theta) + rates[1] * sp.sin(theta)
    sideways = rates[1] * sp.cos(theta) - rates[0] * sp.sin(theta)
    trailer_turn, back = rates[2] - rates[3], drawbar - trailer_ahead
    tractor = forward**2 + (sideways + ahead * rates[2]) ** 2
    trailer = (forward - back * trailer_turn * sp.sin(fold)) ** 2
    trailer += (sideways - hitch * rates[2] - back * trailer_turn * sp.cos(fold)) ** 2
    turning = yaw_inertia * rates[2] ** 2 + trailer_inertia * trailer_turn**2
    turning += wheel_inertia * (rates[4] ** 2 + rates[5] ** 2)
    # the hitch moves with v e_θ − a ω e_θ⊥; what of that lies across the trailer yaws the trailer
    trailer_yaw = (speed * sp.sin(fold) - hitch * yaw_rate * sp.cos(fold)) / drawbar
    return System(
        name="tractor with trailer",
        coordinates=(x, y, theta, fold, chi_l, chi_r),
        rates=rates,
        pseudo_velocities=(speed, yaw_rate),
        pseudo_rates=_real("v' omega'"),
        lagrangian=(mass * tractor + trailer_mass * trailer + turning) / 2,
        velocities=(
            speed * sp.cos(theta), speed * sp.sin(theta), yaw_rate, yaw_rate - trailer_yaw,
            (speed - half_track * yaw_rate) / radius, (speed + half_track * yaw_rate) / radius,
        ),
        forces=(sp.Integer(0), sp.Integer(0), sp.Integer(0), sp.Integer(0), left, right),
    )
