"""Laconic equations (2.3) and (2.4) and Maggi's equations (1.2) of one system.

Every function returns the list of left side minus right side, one entry for each pseudo-velocity: the equations
of motion are that all of them vanish. All quantities are plain symbols; time derivatives are written out by
the chain rule, so the three forms share no step but the differentiation itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class System:
    """A Lagrangian system under constraints that are solved for the velocities, q' = v(ω, q, t) (1.1)."""

    name: str
    coordinates: tuple[sp.Symbol, ...]        # q_i
    rates: tuple[sp.Symbol, ...]              # q_i', as they stand in the Lagrangian
    pseudo_velocities: tuple[sp.Symbol, ...]  # ω_α
    pseudo_rates: tuple[sp.Symbol, ...]       # ω_α'
    lagrangian: sp.Expr                       # L(q', q, t)
    velocities: tuple[sp.Expr, ...]           # v_i(ω, q, t)
    forces: tuple[sp.Expr, ...]               # Q_i
    time: sp.Symbol = sp.Symbol("t")

    def __post_init__(self) -> None:
        n = len(self.coordinates)
        if not len(self.rates) == len(self.velocities) == len(self.forces) == n:
            raise ValueError(f"{self.name}: coordinates, rates, velocities and forces must be equally many")
        if len(self.pseudo_rates) != len(self.pseudo_velocities):
            raise ValueError(f"{self.name}: pseudo-velocities and their rates must be equally many")

    @property
    def momenta(self) -> tuple[sp.Symbol, ...]:
        """Formal momenta p_i; their values are put in after all brackets are done."""
        return tuple(sp.Symbol(f"p_{q.name}") for q in self.coordinates)

    def with_constraints(self, expression: sp.Expr) -> sp.Expr:
        """(·)*: the constraints put in for the velocities."""
        return expression.xreplace(dict(zip(self.rates, self.velocities, strict=True)))

    def constrained_lagrangian(self) -> sp.Expr:
        """L* = L(v(ω, q, t), q, t)."""
        return self.with_constraints(self.lagrangian)

    def real_momenta(self) -> dict[sp.Symbol, sp.Expr]:
        """p_i = (∂L/∂q_i')*, to be put in after all brackets are done."""
        pairs = zip(self.momenta, self.rates, strict=True)
        return {p: self.with_constraints(sp.diff(self.lagrangian, rate)) for p, rate in pairs}

    def generalised_force(self, alpha: int) -> sp.Expr:
        """Q_i ∂v_i/∂ω_α."""
        omega = self.pseudo_velocities[alpha]
        return sp.Add(*(q * sp.diff(v, omega) for q, v in zip(self.forces, self.velocities, strict=True)))


def poisson(system: System, f: sp.Expr, g: sp.Expr) -> sp.Expr:
    """The paper's bracket {F, G} = −∂F/∂p_i ∂G/∂q_i + ∂F/∂q_i ∂G/∂p_i."""
    pairs = zip(system.coordinates, system.momenta, strict=True)
    return sp.Add(*(sp.diff(f, q) * sp.diff(g, p) - sp.diff(f, p) * sp.diff(g, q) for q, p in pairs))


def omega_derivative(system: System, f: sp.Expr) -> sp.Expr:
    """d^ω/dt (2.2): time and pseudo-velocities run, coordinates rest."""
    pairs = zip(system.pseudo_velocities, system.pseudo_rates, strict=True)
    return sp.diff(f, system.time) + sp.Add(*(sp.diff(f, w) * rate for w, rate in pairs))


def time_derivative(system: System, f: sp.Expr) -> sp.Expr:
    """d/dt of a function of ω, q, t along the motion."""
    pairs = zip(system.coordinates, system.velocities, strict=True)
    return omega_derivative(system, f) + sp.Add(*(sp.diff(f, q) * v for q, v in pairs))


def laconic_2_3(system: System) -> list[sp.Expr]:
    """(2.3): d^ω/dt ∂Y/∂ω_α − {∂Y/∂ω_α, Y} = Q_i ∂v_i/∂ω_α with Y = L* − p_i v_i (2.1)."""
    formal_work = sp.Add(*(p * v for p, v in zip(system.momenta, system.velocities, strict=True)))
    y = system.constrained_lagrangian() - formal_work
    equations = []
    for alpha, omega in enumerate(system.pseudo_velocities):
        slope = sp.diff(y, omega)
        left = omega_derivative(system, slope) - poisson(system, slope, y)
        equations.append(left.xreplace(system.real_momenta()) - system.generalised_force(alpha))
    return equations


def formal_pseudo_momenta(system: System) -> list[sp.Expr]:
    """P_α(q, p) from the identity P_α ω_α = p_i v_i; needs constraints linear in ω and free of t."""
    formal_work = sp.Add(*(p * v for p, v in zip(system.momenta, system.velocities, strict=True)))
    pseudo = [sp.diff(formal_work, omega) for omega in system.pseudo_velocities]
    rest = sp.expand(formal_work - sp.Add(*(P * w for P, w in zip(pseudo, system.pseudo_velocities, strict=True))))
    if rest != 0 or any(P.has(*system.pseudo_velocities, system.time) for P in pseudo):
        raise ValueError(f"{system.name}: (2.4) needs constraints linear in the pseudo-velocities; use (2.3)")
    return pseudo


def laconic_2_4(system: System) -> list[sp.Expr]:
    """(2.4): d/dt ∂L*/∂ω_α + {P_α, L*} = {P_α, ω_μ P_μ} + Q_i ∂v_i/∂ω_α."""
    lagrangian = system.constrained_lagrangian()
    pseudo = formal_pseudo_momenta(system)
    total = sp.Add(*(P * w for P, w in zip(pseudo, system.pseudo_velocities, strict=True)))
    equations = []
    for alpha, omega in enumerate(system.pseudo_velocities):
        left = time_derivative(system, sp.diff(lagrangian, omega)) + poisson(system, pseudo[alpha], lagrangian)
        right = poisson(system, pseudo[alpha], total)
        equations.append((left - right).xreplace(system.real_momenta()) - system.generalised_force(alpha))
    return equations


def maggi(system: System) -> list[sp.Expr]:
    """(1.2): (d/dt ∂L/∂q_i' − ∂L/∂q_i)* ∂v_i/∂ω_α = Q_i ∂v_i/∂ω_α, with q'' from the constraints' derivatives."""
    accelerations = [time_derivative(system, v) for v in system.velocities]
    slopes = [sp.diff(system.lagrangian, rate) for rate in system.rates]
    left = []
    for q, slope in zip(system.coordinates, slopes, strict=True):
        by_rates = sp.Add(*(sp.diff(slope, r) * a for r, a in zip(system.rates, accelerations, strict=True)))
        by_place = sp.Add(*(sp.diff(slope, c) * r for c, r in zip(system.coordinates, system.rates, strict=True)))
        whole = by_rates + by_place + sp.diff(slope, system.time) - sp.diff(system.lagrangian, q)
        left.append(system.with_constraints(whole))
    equations = []
    for alpha, omega in enumerate(system.pseudo_velocities):
        work = sp.Add(*(e * sp.diff(v, omega) for e, v in zip(left, system.velocities, strict=True)))
        equations.append(work - system.generalised_force(alpha))
    return equations


def mass_matrix_and_rest(system: System, equations: list[sp.Expr]) -> tuple[sp.Matrix, sp.Matrix]:
    """Writes the equations as A ω' = f, since all three forms are linear in ω'."""
    matrix = sp.Matrix([[sp.diff(e, rate) for rate in system.pseudo_rates] for e in equations])
    at_rest = {rate: sp.Integer(0) for rate in system.pseudo_rates}
    return matrix, sp.Matrix([-e.xreplace(at_rest) for e in equations])
