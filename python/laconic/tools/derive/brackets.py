"""The paper's section 6: a further linear constraint needs only linear combinations.

A system is kept as what (2.4) needs of it once the brackets are done: L*, the table {P_α, P_μ}*, {P_α, L*}* and
the generalised forces. A further constraint ω = G η gives P̃ = Gᵀ P, and since the bracket is bilinear, the new
table is Gᵀ{P, P}G: nothing is derived again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from laconic.tools.derive.equations import System, formal_pseudo_momenta, poisson


@dataclass(frozen=True)
class Bracketed:
    """What (2.4) needs of a system whose L* does not depend on time."""

    name: str
    pseudo_velocities: tuple[sp.Symbol, ...]
    pseudo_rates: tuple[sp.Symbol, ...]
    coordinates: tuple[sp.Symbol, ...]
    velocities: tuple[sp.Expr, ...]   # q' along the motion, for d/dt
    lagrangian: sp.Expr               # L*(ω, q)
    table: sp.Matrix                  # {P_α, P_μ}*
    slopes: sp.Matrix                 # {P_α, L*}*
    forces: sp.Matrix                 # Q_i ∂v_i/∂ω_α

    def equations(self) -> list[sp.Expr]:
        """(2.4), left side minus right side."""
        gyroscopic = self.table * sp.Matrix(self.pseudo_velocities)
        out = []
        for alpha, omega in enumerate(self.pseudo_velocities):
            momentum = sp.diff(self.lagrangian, omega)
            variables = (*self.pseudo_velocities, *self.coordinates)
            rates = (*self.pseudo_rates, *self.velocities)
            change = sp.Add(*(sp.diff(momentum, s) * rate for s, rate in zip(variables, rates, strict=True)))
            out.append(tidy(change + self.slopes[alpha] - gyroscopic[alpha]) - self.forces[alpha])
        return out


def _is_even_sine(expression: sp.Expr) -> bool:
    power = expression.is_Pow and isinstance(expression.base, sp.sin) and expression.exp.is_Integer
    return bool(power and expression.exp >= 2)


def _by_cosine(expression: sp.Expr) -> sp.Expr:
    sine, power = expression.base, int(expression.exp)
    return (1 - sp.cos(sine.args[0]) ** 2) ** (power // 2) * sine ** (power % 2)


def tidy(expression: sp.Expr) -> sp.Expr:
    """Expanded, with sin² written as 1 − cos²: enough to make every sum of squares here collapse, and fast."""
    return sp.expand(sp.expand(expression).replace(_is_even_sine, _by_cosine))


def bracketed(system: System) -> Bracketed:
    """Does all brackets of a system once; the momenta are real afterwards."""
    pseudo = formal_pseudo_momenta(system)
    lagrangian = system.constrained_lagrangian()
    real = system.real_momenta()

    def star(f: sp.Expr, g: sp.Expr) -> sp.Expr:
        return tidy(poisson(system, f, g).xreplace(real))

    m = len(pseudo)
    table = sp.zeros(m, m)
    for row in range(m):
        for column in range(row + 1, m):
            table[row, column] = star(pseudo[row], pseudo[column])
            table[column, row] = -table[row, column]
    return Bracketed(
        name=system.name,
        pseudo_velocities=system.pseudo_velocities,
        pseudo_rates=system.pseudo_rates,
        coordinates=system.coordinates,
        velocities=system.velocities,
        lagrangian=tidy(lagrangian),
        table=table,
        slopes=sp.Matrix([star(P, lagrangian) for P in pseudo]),
        forces=sp.Matrix([tidy(system.generalised_force(a)) for a in range(m)]),
    )


def impose(system: Bracketed, basis: sp.Matrix, kept: tuple[int, ...], name: str) -> Bracketed:
    """The same system under ω = basis · η, η being the pseudo-velocities numbered in `kept`; basis is constant."""
    if basis.has(*system.coordinates, *system.pseudo_velocities):
        raise ValueError(f"{name}: the shortcut needs a constraint with constant coefficients")
    eta = tuple(system.pseudo_velocities[k] for k in kept)
    eta_rates = tuple(system.pseudo_rates[k] for k in kept)
    put_in = dict(zip(system.pseudo_velocities, basis * sp.Matrix(eta), strict=True))

    def star(expression: Any) -> Any:
        return expression.xreplace(put_in)

    return Bracketed(
        name=name,
        pseudo_velocities=eta,
        pseudo_rates=eta_rates,
        coordinates=system.coordinates,
        velocities=tuple(star(v) for v in system.velocities),
        lagrangian=star(system.lagrangian),
        table=(basis.T * star(system.table) * basis).applyfunc(sp.expand),
        slopes=basis.T * star(system.slopes),
        forces=basis.T * star(system.forces),
    )
