"""From a vehicle of numbers to its equations by the method: the carriage with N wheels, then its constraints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp

from laconic.tools.derive.brackets import Bracketed, bracketed, impose
from laconic.tools.derive.equations import System
from laconic.tools.derive.vehicles import carriage, wheel_rows, wheel_symbols

Row = Sequence[float] | np.ndarray

RANK_TOLERANCE = 1e-9  # relative, as in the core: an angle such as π is not exact in binary


@dataclass(frozen=True)
class VehicleNumbers:
    """What the equations of one vehicle need, as numbers."""

    name: str
    mass_kg: float
    wheel_radius_m: float
    lambda_yaw: float                # Λ
    lambda_wheel: np.ndarray         # λ of each wheel
    motor_gain_Nm_per_V: np.ndarray  # c1 of each wheel
    motor_damping_Nms: np.ndarray    # c2 of each wheel
    wheel_rows: np.ndarray           # Ξ, N × 3
    constraint_rows: np.ndarray      # C, any number × 3

    @property
    def inertias_differ(self) -> bool:
        """Whether the wheels have not all the same J."""
        return len(set(self.lambda_wheel)) > 1

    def symbol_values(self) -> dict[sp.Symbol, sp.Expr]:
        """Numbers for the symbols that remain in the derivation."""
        values = {sp.Symbol("M", positive=True): self.mass_kg, sp.Symbol("R", positive=True): self.wheel_radius_m}
        values |= {sp.Symbol("Lambda", positive=True): self.lambda_yaw}
        if self.inertias_differ:
            values |= dict(zip(wheel_symbols(len(self.wheel_rows)), self.lambda_wheel, strict=True))
        else:
            values |= {sp.Symbol("lambda", positive=True): self.lambda_wheel[0] if len(self.wheel_rows) else 0.0}
        symbols = wheel_rows(len(self.wheel_rows))
        rows = plain_rows(self.wheel_rows)
        entries = ((i, s) for i in range(len(self.wheel_rows)) for s in range(3) if rows[i, s] == symbols[i, s])
        values |= {symbols[i, s]: self.wheel_rows[i, s] for i, s in entries}
        return {symbol: sp.Float(float(value), 17) for symbol, value in values.items()}


def solve_constraints(rows: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """Writes C ν = 0 as ν = G η with η some of the ν themselves: (G, numbers of those kept), by full pivoting."""
    work = np.array(rows, dtype=float).reshape(-1, 3)
    scale = np.abs(work).max(initial=0.0)
    dependent: list[int] = []
    used: list[int] = []
    while len(dependent) < 3:
        open_rows = [r for r in range(len(work)) if r not in used]
        free = [c for c in range(3) if c not in dependent]
        if not open_rows:
            break
        row, column = max(((r, c) for r in open_rows for c in free), key=lambda rc: abs(work[rc]))
        if abs(work[row, column]) <= RANK_TOLERANCE * scale:
            break
        work[row] /= work[row, column]
        for other in range(len(work)):
            if other != row:
                work[other] -= work[other, column] * work[row]
        used.append(row)
        dependent.append(column)
    kept = tuple(c for c in range(3) if c not in dependent)
    basis = np.zeros((3, len(kept)))
    for position, column in enumerate(kept):
        basis[column, position] = 1.0
        for row, gone in zip(used, dependent, strict=True):
            basis[gone, position] = -work[row, column]
    basis[np.abs(basis) < 1e-14] = 0.0
    return basis, kept


def _plain(value: float) -> sp.Integer | None:
    """0, 1 or −1 as an exact number where the value is one of them but for rounding (cos π/2 is 6e-17)."""
    nearest = round(value)
    return sp.Integer(nearest) if nearest in (-1, 0, 1) and abs(value - nearest) < 1e-14 else None


def number_or_plain(value: float) -> sp.Expr:
    exact = _plain(value)
    return sp.Float(value, 17) if exact is None else exact


def plain_rows(rows: np.ndarray) -> sp.Matrix:
    """Ξ as symbols σ_is, save where an entry is 0 or ±1: so short equations come out short."""
    symbols = wheel_rows(len(rows))

    def entry(i: int, s: int) -> sp.Expr:
        exact = _plain(rows[i, s])
        return symbols[i, s] if exact is None else exact

    return sp.Matrix(len(rows), 3, entry)


def carriage_of(numbers: VehicleNumbers) -> System:
    """The scene's carriage in symbols, without its constraints."""
    return carriage(plain_rows(numbers.wheel_rows), numbers.inertias_differ)


def derive(numbers: VehicleNumbers) -> Bracketed:
    """Equations of the scene's vehicle in symbols; the constraints' coefficients are numbers."""
    free = bracketed(carriage_of(numbers))
    basis, kept = solve_constraints(numbers.constraint_rows)
    if len(kept) == 3:
        return free
    exact = sp.Matrix(3, len(kept), [number_or_plain(v) for v in basis.flat])
    fixed = " and ".join(f"nu_{k + 1}" for k in range(3) if k not in kept)
    return impose(free, exact, kept, name=f"{free.name}, {fixed} bound by constraints")


def motor_torques(numbers: VehicleNumbers) -> dict[sp.Symbol, sp.Expr]:
    """M_i = c1_i U_i − c2_i Ξ_i ν + T_i: what the motors (and a torque besides) put in for the axle torques."""
    nu = sp.Matrix(sp.symbols("nu_1 nu_2 nu_3", real=True))
    torques = {}
    for i, row in enumerate(numbers.wheel_rows, start=1):
        speed = sp.Add(*(number_or_plain(float(s)) * v for s, v in zip(row, nu, strict=True)))
        driving = sp.Float(float(numbers.motor_gain_Nm_per_V[i - 1]), 17) * sp.Symbol(f"U_{i}", real=True)
        damping = sp.Float(float(numbers.motor_damping_Nms[i - 1]), 17) * speed
        torques[sp.Symbol(f"M_{i}", real=True)] = driving - damping + sp.Symbol(f"T_{i}", real=True)
    return torques


def explicit_rates(numbers: VehicleNumbers, system: Bracketed) -> list[sp.Expr]:
    """ν1', ν2', ν3' solved for, as expressions of ν, θ, voltages, torques and outer forces, with numbers put in."""
    values = numbers.symbol_values()
    equations = system.equations()
    at_rest = {rate: sp.Integer(0) for rate in system.pseudo_rates}
    matrix = [[float(sp.diff(e, rate).xreplace(values)) for rate in system.pseudo_rates] for e in equations]
    inverse = np.linalg.inv(np.array(matrix))
    size = np.sqrt(np.outer(np.diag(inverse), np.diag(inverse)))
    inverse = sp.Matrix(np.where(np.abs(inverse) < 1e-15 * size, 0.0, inverse))  # a rest of rounding would be printed
    basis, _ = solve_constraints(numbers.constraint_rows)
    right = sp.Matrix([(-e).xreplace(at_rest).xreplace(values).xreplace(motor_torques(numbers)) for e in equations])
    return list((sp.Matrix(basis) * inverse * right).applyfunc(sp.expand))


def rate_function(numbers: VehicleNumbers, system: Bracketed) -> Callable[..., np.ndarray]:
    """Numeric ν'(ν, θ, U, T, body wrench, world force, its point) of the derived equations, for checks."""
    count = len(numbers.wheel_rows)
    arguments = [*sp.symbols("nu_1 nu_2 nu_3 theta", real=True)]
    arguments += [sp.Symbol(f"U_{i + 1}", real=True) for i in range(count)]
    arguments += [sp.Symbol(f"T_{i + 1}", real=True) for i in range(count)]
    arguments += [*sp.symbols("F_xi F_eta tau F_X F_Y r_xi r_eta", real=True)]
    compiled = sp.lambdify(arguments, explicit_rates(numbers, system), "math", cse=True)

    def rates(nu: Row, theta: float, voltage: Row, torque: Row, wrench: Row = (0, 0, 0), world: Row = (0, 0),
              point: Row = (0, 0)) -> np.ndarray:
        return np.array(compiled(*nu, theta, *voltage, *torque, *wrench, *world, *point), dtype=float)

    return rates
