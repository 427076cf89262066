"""Writes derived equations as text, LaTeX or C."""

from __future__ import annotations

import re

import sympy as sp

from laconic.tools.derive.brackets import Bracketed
from laconic.tools.derive.scene_system import VehicleNumbers, explicit_rates


def _latex_name(symbol: sp.Symbol) -> str:
    """nu_1' becomes \\dot{\\nu}_{1}; everything else as SymPy would do it."""
    name = symbol.name
    if not name.endswith("'"):
        return sp.latex(symbol)
    base, _, index = name[:-1].partition("_")
    letter = sp.latex(sp.Symbol(base))
    return rf"\dot{{{letter}}}" + (f"_{{{sp.latex(sp.Symbol(index))}}}" if index else "")


def latex(expression: sp.Basic, digits: int = 6) -> str:
    """LaTeX with dots for rates and numbers rounded to `digits`."""
    shown = rounded(expression, digits)
    names = {s: _latex_name(s) for s in shown.free_symbols}
    return sp.latex(shown, symbol_names=names)


def rounded(expression: sp.Basic, digits: int) -> sp.Basic:
    """The same with every floating-point number cut to `digits` significant ones."""
    if isinstance(expression, sp.MatrixBase):
        return expression.applyfunc(lambda e: rounded(e, digits))
    return expression.xreplace({f: sp.Float(str(sp.N(f, digits)), digits) for f in expression.atoms(sp.Float)})


def sides(system: Bracketed) -> list[tuple[sp.Expr, sp.Expr]]:
    """The equations of motion (a carriage's over M R², as in (4.6)): (what holds the rates, the rest)."""
    wheel = sp.Symbol("lambda", positive=True)
    own = sorted((s for s in system.lagrangian.free_symbols if s.name.startswith("lambda_")), key=str)
    is_carriage = system.lagrangian.has(wheel, *own) or system.name.startswith("carriage")
    by = [s**2 for s in own] if own else wheel**2
    scale = sp.Symbol("M", positive=True) * sp.Symbol("R", positive=True) ** 2 if is_carriage else sp.Integer(1)
    at_rest = {rate: sp.Integer(0) for rate in system.pseudo_rates}
    out = []
    for equation in system.equations():
        rest = sp.expand(-equation.xreplace(at_rest) / scale)
        weights = [sp.collect(sp.expand(sp.diff(equation, rate) / scale), by) for rate in system.pseudo_rates]
        left = sp.Add(*(weight * rate for weight, rate in zip(weights, system.pseudo_rates, strict=True)))
        out.append((left, rest))
    return out


def as_latex(system: Bracketed) -> str:
    """The derivation's results: L*, the brackets, the equations; an `align` for each."""
    lines = [f"% {system.name}: laconic equations (2.4)", r"\begin{align}"]
    lines.append(rf"L^* &= {latex(system.lagrangian)} \\")
    names = [_latex_name(w) for w in system.pseudo_velocities]
    for row in range(len(names)):
        for column in range(row + 1, len(names)):
            bracket = rf"\{{P_{{{names[row]}}}, P_{{{names[column]}}}\}}^*"
            lines.append(rf"{bracket} &= {latex(system.table[row, column])} \\")
    for left, right in sides(system):
        lines.append(rf"{latex(left)} &= {latex(right)} \\")
    lines[-1] = lines[-1].removesuffix(r" \\")
    return "\n".join([*lines, r"\end{align}"]) + "\n"


def as_text(system: Bracketed) -> str:
    """The same for a terminal."""
    lines = [f"{system.name}: laconic equations (2.4)", ""]
    lines.append(f"L* = {rounded(system.lagrangian, 6)}")
    count = len(system.pseudo_velocities)
    for row in range(count):
        for column in range(row + 1, count):
            first, second = system.pseudo_velocities[row], system.pseudo_velocities[column]
            lines.append(f"{{P_{first}, P_{second}}}* = {rounded(system.table[row, column], 6)}")
    lines.append("")
    for left, right in sides(system):
        lines.append(f"{rounded(left, 6)}\n    = {rounded(right, 6)}")
    return "\n".join(lines) + "\n"


def c_name(name: str) -> str:
    """A scene's name as part of a C identifier."""
    return re.sub(r"\W+", "_", name).strip("_").lower() or "vehicle"


def _c_symbols(count: int) -> dict[sp.Symbol, sp.Symbol]:
    targets = {"nu_1": "nu[0]", "nu_2": "nu[1]", "nu_3": "nu[2]", "theta": "heading_rad"}
    targets |= {"F_xi": "wrench[0]", "F_eta": "wrench[1]", "tau": "wrench[2]"}
    targets |= {"F_X": "world_force_N[0]", "F_Y": "world_force_N[1]"}
    targets |= {"r_xi": "force_point_m[0]", "r_eta": "force_point_m[1]"}
    targets |= {f"U_{i + 1}": f"voltage_V[{i}]" for i in range(count)}
    targets |= {f"T_{i + 1}": f"axle_torque_Nm[{i}]" for i in range(count)}
    return {sp.Symbol(name, real=True): sp.Symbol(target, real=True) for name, target in targets.items()}


_C_HEAD = """\
/* {name}: the rates of the pseudo-velocities, derived by the laconic equations (2.4) and solved for.
 * nu [rad/s]; wrench: force in body axes [N] at the centre of mass and moment [N*m]; world_force_N acts at the
 * body point force_point_m, seen from the centre of mass. Wheels: {count}. */
#include <math.h>

void laconic_{identifier}_rates(const double nu[3], double heading_rad, const double *voltage_V,
    const double *axle_torque_Nm, const double wrench[3], const double world_force_N[2],
    const double force_point_m[2], double nu_rate[3])
{{
"""


def as_c(numbers: VehicleNumbers, system: Bracketed) -> str:
    """One C function of the scene's own numbers."""
    count = len(numbers.wheel_rows)
    placed = [e.xreplace(_c_symbols(count)) for e in explicit_rates(numbers, system)]
    shared, results = sp.cse(placed, symbols=sp.numbered_symbols("s"))
    code = _C_HEAD.format(name=numbers.name, identifier=c_name(numbers.name), count=count)
    used = set().union(*(e.free_symbols for e in placed)) if placed else set()
    for argument in ("heading_rad", "voltage_V", "axle_torque_Nm", "wrench", "world_force_N", "force_point_m"):
        if not any(s.name.startswith(argument) for s in used):
            code += f"    (void)({argument});\n"
    code += "".join(f"    const double {symbol} = {sp.ccode(value)};\n" for symbol, value in shared)
    code += "".join(f"    nu_rate[{k}] = {sp.ccode(value)};\n" for k, value in enumerate(results))
    return code + "}\n"
