"""From a scene with hinges to its equations: a tree of planar bodies by (2.4), and by (2.3) with commanded hinges.

The coordinates are x, y, theta of body 0, psi_b of each hinge and chi_i of each wheel. The carriage has the velocity
u_0, v_0 of its centre of mass in its own axes and the yaw rate omega_0; pseudo-velocities are those of them that its
own wheels leave. Each body whose wheels do not set its yaw rate adds omega_b. Where a twist T coordinates hinges, the
carriage has one pseudo-velocity sigma, with (u_0, v_0, omega_0) = sigma T. Further fixed wheels are constraints
C eta' = gamma with multipliers. Only forces fixed in the world depend on x, y and theta. They are given in body axes,
and theta is set to 0 at the end.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from laconic.core.articulated import ArticulatedVehicle
from laconic.scene import Scene
from laconic.tools.derive.equations import System, laconic_2_3, laconic_2_4, mass_matrix_and_rest, time_derivative
from laconic.tools.derive.scene_system import number_or_plain, solve_constraints

FOLLOWS, OWN, PRESCRIBED, COORDINATED = range(4)
OF_CARRIAGE = ("u_0", "v_0", "omega_0")
Triple = tuple[sp.Expr, sp.Expr, sp.Expr]
TIME = sp.Symbol("t")
OUTER: Triple = sp.symbols("F_xi F_eta tau", real=True)
"""Force at the centre of mass of body 0 in its axes, and moment."""
SLOPE = sp.symbols("g_xi g_eta", real=True)
"""Acceleration downhill in the axes of body 0."""


class Values:
    """Numbers by the symbols that stand for them; 0 and ±1 are put in at once."""

    def __init__(self) -> None:
        self.of: dict[sp.Symbol, float] = {}

    def symbol(self, name: str, value: float, positive: bool = False) -> sp.Expr:
        """The symbol of that name, whose number is kept, or the number itself."""
        plain = number_or_plain(float(value))
        if plain.is_Integer:
            return plain
        symbol = sp.Symbol(name, **({"positive": True} if positive else {"real": True}))
        self.of[symbol] = float(value)
        return symbol


@dataclass(frozen=True)
class TreeBody:
    """One body with symbols for its numbers; body 0 has no hinge."""

    name: str
    parent: int
    motion: int                        # FOLLOWS … COORDINATED; −1 of body 0
    hinge: tuple[sp.Expr, sp.Expr]     # in the parent's frame, of the carriage from its centre of mass
    com: tuple[sp.Expr, sp.Expr]
    mass: sp.Expr
    inertia: sp.Expr
    slope: tuple[sp.Expr, sp.Expr]     # n/l of a following hinge
    gain: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0


@dataclass(frozen=True)
class TreeWheel:
    """One wheel: chi' = row · (u, v, omega) of its body."""

    body: int
    row: Triple
    inertia: sp.Expr
    gain: float
    damping: float


@dataclass(frozen=True)
class TreeNumbers:
    """What the equations of one vehicle with hinges need."""

    name: str
    bodies: tuple[TreeBody, ...]
    wheels: tuple[TreeWheel, ...]
    left: tuple[tuple[int, Triple], ...]  # body and row of each constraint that is left over
    basis: sp.Matrix                      # (u_0, v_0, omega_0) of the pseudo-velocities of the carriage
    kept: tuple[int, ...]
    sloped: tuple[float, float]           # acceleration downhill, world axes
    com: tuple[sp.Expr, sp.Expr]          # of body 0, in the body frame of the scene
    values: Mapping[sp.Symbol, float]

    @property
    def coordinated(self) -> bool:
        """Whether a twist commands the carriage."""
        return any(body.motion == COORDINATED for body in self.bodies)


@dataclass(frozen=True)
class Tree:
    """The derivation's result: mass · eta' = push + constraintᵀ kappa and constraint · eta' = drift."""

    numbers: TreeNumbers
    system: System
    twists: tuple[Triple, ...]  # (u, v, omega) of each body, at theta = 0
    velocities: tuple[sp.Expr, ...]
    lagrangian: sp.Expr
    mass: sp.Matrix
    push: sp.Matrix
    constraint: sp.Matrix
    drift: sp.Matrix
    form: str = field(default="(2.4)")


def tree_numbers(scene: Scene, vehicle: ArticulatedVehicle) -> TreeNumbers:
    """Those of a scene, from the core's prepared model."""
    model, values = vehicle.model, Values()
    wheels = [model.wheel[i] for i in range(vehicle.wheel_count)]
    of_wheels = sum(float(w.inertia_kgm2) * float(w.roll.z) ** 2 for w in wheels if w.body == 0)
    bodies = [TreeBody("carriage", 0, -1, _pair(values, "h", 0, 0.0, 0.0), _pair(values, "s", 0, 0.0, 0.0),
                       values.symbol("m_0", model.mass_kg, True),
                       values.symbol("I_0", float(model.inertia.ww) - of_wheels, True), (sp.S.Zero, sp.S.Zero))]
    for b in range(vehicle.body_count):
        bodies.append(_body(values, b + 1, vehicle.names[b], model.link[b],
                            float(scene.vehicle["body"][b]["yaw_inertia_kgm2"])))
    left = tuple((int(row.body), _row(values, f"c_{r}", row.axle)) for r, row in
                 enumerate((model.row[k] for k in range(model.row_count)), 1))
    held = np.array([[v.x, v.y, v.z] for v in (model.held[k] for k in range(model.held_count))], float).reshape(-1, 3)
    basis, kept = solve_constraints(held)
    exact = sp.Matrix(3, len(kept), lambda i, k: values.symbol(f"g_{i + 1}{k + 1}", float(basis[i, k])))
    return TreeNumbers(
        scene.name, tuple(bodies), tuple(_wheel(values, i, w) for i, w in enumerate(wheels, 1)), left, exact, kept,
        (float(model.slope_acceleration.x), float(model.slope_acceleration.y)),
        _pair(values, "c", 0, model.com_x_m, model.com_y_m), values.of)


def _pair(values: Values, letter: str, b: int, x: float, y: float) -> tuple[sp.Expr, sp.Expr]:
    return values.symbol(f"{letter}_xi_{b}", x), values.symbol(f"{letter}_eta_{b}", y)


def _row(values: Values, name: str, v: Any) -> Triple:
    return values.symbol(f"{name}1", v.x), values.symbol(f"{name}2", v.y), values.symbol(f"{name}3", v.z)


def _body(values: Values, b: int, name: str, link: Any, inertia: float) -> TreeBody:
    mass = float(link.first_moment.z)
    com = (float(link.first_moment.x) / mass, float(link.first_moment.y) / mass) if mass else (0.0, 0.0)
    return TreeBody(
        name, int(link.parent), int(link.motion), _pair(values, "h", b, link.hinge.x, link.hinge.y),
        _pair(values, "s", b, *com), values.symbol(f"m_{b}", mass, True), values.symbol(f"I_{b}", inertia, True),
        _pair(values, "a", b, link.axle_per_lever.x, link.axle_per_lever.y), float(link.gain_Nm_per_V),
        float(link.damping_Nms), float(link.stiffness_Nm), float(link.rest_rad))


def _wheel(values: Values, i: int, wheel: Any) -> TreeWheel:
    return TreeWheel(int(wheel.body), _row(values, f"sigma_{i}", wheel.roll),
                     values.symbol(f"J_{i}", wheel.inertia_kgm2, True), float(wheel.gain_Nm_per_V),
                     float(wheel.damping_Nms))


# ------------------------------------------------------------------------------------- the system


def pseudo_velocities(numbers: TreeNumbers) -> tuple[sp.Symbol, ...]:
    """eta: of the carriage, then omega_b of the hinges with a velocity of their own."""
    own = [f"omega_{b}" for b, body in enumerate(numbers.bodies) if body.motion == OWN]
    carriage = ["sigma"] if numbers.coordinated else [OF_CARRIAGE[k] for k in numbers.kept]
    return tuple(sp.Symbol(name, real=True) for name in (*carriage, *own))


def command(name: str, order: int = 0) -> sp.Symbol:
    """The symbol of a commanded number, or of its rate."""
    return sp.Symbol(name + "'" * order, real=True)


def _linear(name: str) -> sp.Expr:
    """A command near this moment, t = 0."""
    return command(name) + TIME * command(name, 1)


TWIST = ("V_xi", "V_eta", "Omega")
"""T: velocity of the body frame's origin and yaw rate, of which the proportions are commanded."""


def commanded_twist(numbers: TreeNumbers) -> Triple:
    """T of the carriage's centre of mass, from T of the body frame's origin."""
    first, second, turn = (_linear(name) for name in TWIST)
    return first - turn * numbers.com[1], second + turn * numbers.com[0], turn


def twist_of_carriage(numbers: TreeNumbers) -> Triple:
    """(u_0, v_0, omega_0) by the pseudo-velocities of the carriage."""
    eta = pseudo_velocities(numbers)
    if numbers.coordinated:
        u, v, turn = commanded_twist(numbers)
        return eta[0] * u, eta[0] * v, eta[0] * turn
    u, v, turn = numbers.basis * sp.Matrix(eta[: len(numbers.kept)])
    return u, v, turn


def twist_of_child(numbers: TreeNumbers, b: int, parent: Triple) -> Triple:
    """(u_b, v_b, omega_b) of a body from those of its parent: u_b, v_b is the velocity of its hinge in its axes."""
    body, (u, v, turn) = numbers.bodies[b], parent
    along, across = u - turn * body.hinge[1], v + turn * body.hinge[0]
    cos, sin = sp.cos(angle(b)), sp.sin(angle(b))
    own_u, own_v = cos * along + sin * across, cos * across - sin * along
    if body.motion == FOLLOWS:
        return own_u, own_v, -(body.slope[0] * own_u + body.slope[1] * own_v)
    if body.motion == OWN:
        return own_u, own_v, sp.Symbol(f"omega_{b}", real=True)
    if body.motion == PRESCRIBED:
        return own_u, own_v, turn + _linear(f"r_{b}")
    first, second, yaw = commanded_twist(numbers)
    w_x, w_y = first - yaw * body.hinge[1], second + yaw * body.hinge[0]
    change = w_x * sp.diff(w_y, TIME) - w_y * sp.diff(w_x, TIME)
    return own_u, own_v, turn + change / (w_x**2 + w_y**2)


def twist_symbols(b: int) -> Triple:
    """u_b, v_b, omega_b."""
    u, v, turn = _symbols([f"u_{b}", f"v_{b}", f"omega_{b}"])
    return u, v, turn


def _twists(numbers: TreeNumbers) -> tuple[list[Triple], list[sp.Expr]]:
    """(u, v, omega) of every body by the pseudo-velocities, and psi' of every hinge."""
    twists, rates = [twist_of_carriage(numbers)], list[sp.Expr]()
    for b, body in enumerate(numbers.bodies[1:], 1):
        twists.append(twist_of_child(numbers, b, twists[body.parent]))
        rates.append(twists[b][2] - twists[body.parent][2])
    return twists, rates


def along_row(row: Triple, twist: Triple) -> sp.Expr:
    """row · (u, v, omega)"""
    return sp.Add(*(c * x for c, x in zip(row, twist, strict=True)))


def energy_of_twists(numbers: TreeNumbers, twists: Sequence[Triple]) -> sp.Expr:
    """L* without a slope, as the sum over bodies and wheels."""
    energy = sp.S.Zero
    for body, (u, v, turn) in zip(numbers.bodies, twists, strict=True):
        energy += body.mass * ((u - turn * body.com[1]) ** 2 + (v + turn * body.com[0]) ** 2) / 2
        energy += body.inertia * turn**2 / 2
    return energy + sp.Add(*(w.inertia * along_row(w.row, twists[w.body]) ** 2 for w in numbers.wheels)) / 2


def angle(b: int) -> sp.Symbol:
    """psi of a hinge."""
    return sp.Symbol(f"psi_{b}", real=True)


def _symbols(names: Sequence[str]) -> tuple[sp.Symbol, ...]:
    return tuple(sp.Symbol(name, real=True) for name in names)


def _energy(numbers: TreeNumbers, x: Sequence[sp.Symbol], rate: Sequence[sp.Symbol]) -> sp.Expr:
    """L in the coordinates' rates, with the slope's potential."""
    heading, turn, velocity, place = [x[2]], [rate[2]], [(rate[0], rate[1])], [(x[0], x[1])]
    energy = sp.S.Zero
    for b, body in enumerate(numbers.bodies):
        if b:
            p = body.parent
            cos, sin = sp.cos(heading[p]), sp.sin(heading[p])
            arm = cos * body.hinge[0] - sin * body.hinge[1], sin * body.hinge[0] + cos * body.hinge[1]
            place.append((place[p][0] + arm[0], place[p][1] + arm[1]))
            velocity.append((velocity[p][0] - turn[p] * arm[1], velocity[p][1] + turn[p] * arm[0]))
            heading.append(heading[p] + x[2 + b])
            turn.append(turn[p] + rate[2 + b])
        cos, sin = sp.cos(heading[b]), sp.sin(heading[b])
        arm = cos * body.com[0] - sin * body.com[1], sin * body.com[0] + cos * body.com[1]
        com = velocity[b][0] - turn[b] * arm[1], velocity[b][1] + turn[b] * arm[0]
        energy += (body.mass * (com[0] ** 2 + com[1] ** 2) + body.inertia * turn[b] ** 2) / 2
        if any(numbers.sloped):
            energy += body.mass * (SLOPE[0] * (place[b][0] + arm[0]) + SLOPE[1] * (place[b][1] + arm[1]))
    spins = rate[len(numbers.bodies) + 2:]
    return energy + sp.Add(*(w.inertia * spin**2 for w, spin in zip(numbers.wheels, spins, strict=True))) / 2


def tree_system(numbers: TreeNumbers) -> tuple[System, list[Triple]]:
    """The scene's vehicle for the forms of `equations`, and the twists of its bodies."""
    hinges, wheels = range(1, len(numbers.bodies)), range(1, len(numbers.wheels) + 1)
    names = ["x", "y", "theta", *(f"psi_{b}" for b in hinges), *(f"chi_{i}" for i in wheels)]
    coordinates, rates = _symbols(names), _symbols([f"{name}'" for name in names])
    twists, hinge_rates = _twists(numbers)
    (u, v, turn), theta = twists[0], coordinates[2]
    speeds = [along_row(w.row, twists[w.body]) for w in numbers.wheels]
    eta = pseudo_velocities(numbers)
    cos, sin = sp.cos(theta), sp.sin(theta)
    torques = [sp.Symbol(f"tau_{b}", real=True) if numbers.bodies[b].motion in (FOLLOWS, OWN) else sp.S.Zero
               for b in hinges]
    return System(
        name=numbers.name, coordinates=coordinates, rates=rates, pseudo_velocities=eta,
        pseudo_rates=_symbols([f"{s.name}'" for s in eta]), lagrangian=_energy(numbers, coordinates, rates),
        velocities=(cos * u - sin * v, sin * u + cos * v, turn, *hinge_rates, *speeds),
        forces=(cos * OUTER[0] - sin * OUTER[1], sin * OUTER[0] + cos * OUTER[1], OUTER[2], *torques,
                *_symbols([f"M_{i}" for i in wheels])), time=TIME), twists


def derive_tree(numbers: TreeNumbers) -> Tree:
    """Equations of the vehicle: by (2.4), with commanded hinges by (2.3)."""
    system, twists = tree_system(numbers)
    now = {system.coordinates[2]: sp.S.Zero, TIME: sp.S.Zero}
    commanded = any(body.motion >= PRESCRIBED for body in numbers.bodies)
    equations = (laconic_2_3 if commanded else laconic_2_4)(system)
    mass, push = mass_matrix_and_rest(system, [each.xreplace(now) for each in equations])
    rows = [along_row(row, twists[body]) for body, row in numbers.left]
    still = dict.fromkeys(system.pseudo_rates, sp.S.Zero)
    constraint = sp.Matrix(len(rows), len(system.pseudo_velocities),
                           lambda r, k: sp.diff(rows[r], system.pseudo_velocities[k]).xreplace(now))
    drift = sp.Matrix(len(rows), 1, lambda r, _: -time_derivative(system, rows[r]).xreplace(still).xreplace(now))
    return Tree(numbers, system, tuple(tuple(x.xreplace(now) for x in each) for each in twists),
                tuple(v.xreplace(now) for v in system.velocities), system.constrained_lagrangian().xreplace(now), mass,
                push, constraint, drift, "(2.3)" if commanded else "(2.4)")
