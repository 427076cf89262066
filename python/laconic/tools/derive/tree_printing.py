"""Writes the equations of a vehicle with hinges as text, LaTeX or C."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import sympy as sp

from laconic.tools.derive.printing import c_name, latex, rounded
from laconic.tools.derive.tree_system import (
    COORDINATED,
    FOLLOWS,
    OUTER,
    OWN,
    PRESCRIBED,
    SLOPE,
    TWIST,
    Tree,
    TreeNumbers,
    angle,
    energy_of_twists,
    pseudo_velocities,
    twist_of_carriage,
    twist_of_child,
    twist_symbols,
)

KINDS = {FOLLOWS: "its wheels set its yaw rate", OWN: "turns by itself", PRESCRIBED: "its rate is commanded",
         COORDINATED: "the twist commands it"}
Equation = tuple[sp.Basic, sp.Basic]


# --------------------------------------------------------------------------------- text and LaTeX


def _definitions(tree: Tree) -> list[Equation]:
    """The twists from root to leaf, L* in them, and the wheels' speeds."""
    numbers, now = tree.numbers, {sp.Symbol("t"): sp.S.Zero}
    symbols = [twist_symbols(b) for b in range(len(numbers.bodies))]
    lines: list[Equation] = list(zip(symbols[0], twist_of_carriage(numbers), strict=True))
    for b, body in enumerate(numbers.bodies[1:], 1):
        lines += zip(symbols[b], twist_of_child(numbers, b, symbols[body.parent]), strict=True)
        lines.append((sp.Symbol(f"psi_{b}'", real=True), symbols[b][2] - symbols[body.parent][2]))
    lines += [(sp.Symbol(f"chi_{i}'", real=True), sp.Add(*(c * x for c, x in zip(w.row, symbols[w.body], strict=True))))
              for i, w in enumerate(numbers.wheels, 1)]
    return [(left, right.xreplace(now)) for left, right in lines if left != right]


def _equations(tree: Tree) -> tuple[list[Equation], list[Equation]]:
    """Common parts e_k, and the equations in them."""
    parts, (mass, push, constraint, drift) = sp.cse([tree.mass, tree.push, tree.constraint, tree.drift],
                                                    symbols=sp.numbered_symbols("e_"))
    rates = sp.Matrix(tree.system.pseudo_rates)
    count = len(tree.numbers.left)
    forces = sp.Matrix(sp.symbols(f"kappa_1:{count + 1}", real=True)) if count else sp.zeros(0, 1)
    right = push + constraint.T * forces if count else push
    pairs = list(zip(mass * rates, right, strict=True))
    return parts, pairs + (list(zip(constraint * rates, drift, strict=True)) if count else [])


def tree_latex(tree: Tree) -> str:
    """One `align` for the motions that the wheels allow, one for the equations."""
    lagrangian = energy_of_twists(tree.numbers, [twist_symbols(b) for b in range(len(tree.numbers.bodies))])
    given = [f"{symbol} = {value:.9g}" for symbol, value in tree.numbers.values.items()]
    head = [f"% {line}" for line in (*_head(tree), *given, *_torques(tree.numbers))]
    defined = [(sp.Symbol("L^*"), lagrangian)]
    parts, equations = _equations(tree)
    return "\n".join([*head, r"\allowdisplaybreaks", *_align([*_definitions(tree), *defined]),
                      *_align([*parts, *equations])]) + "\n"


def _align(lines: Sequence[Equation]) -> list[str]:
    rows = [rf"{latex(left)} &= {latex(right)} \\" for left, right in lines]
    rows[-1] = rows[-1].removesuffix(r" \\")
    return [r"\begin{align}", *rows, r"\end{align}"]


def tree_text(tree: Tree) -> str:
    """The same for a terminal, with the numbers of the scene."""
    numbers = tree.numbers
    lagrangian = energy_of_twists(numbers, [twist_symbols(b) for b in range(len(numbers.bodies))])
    parts, equations = _equations(tree)
    lines = [*_head(tree), "", *(f"{left} = {rounded(right, 6)}" for left, right in _definitions(tree)),
             f"L* = {lagrangian}", "", *(f"{left} = {rounded(right, 6)}" for left, right in parts), ""]
    lines += [f"{rounded(left, 6)}\n    = {rounded(right, 6)}" for left, right in equations]
    lines += ["", f"with, for {numbers.name},", *(f"  {s} = {v:.9g}" for s, v in numbers.values.items())]
    lines += [f"  {line}" for line in _torques(numbers)]
    return "\n".join(lines) + "\n"


def _torques(numbers: TreeNumbers) -> list[str]:
    """What motors, springs and dampers give, with the numbers of the scene."""
    lines = []
    for i, wheel in enumerate(numbers.wheels, 1):
        terms = [(wheel.gain, f" U_{i}"), (-wheel.damping, f" chi_{i}'"), (1.0, f"T_{i}")]
        lines.append(f"M_{i} = {_sum(terms)}")
    for b, body in enumerate(numbers.bodies):
        if body.motion in (FOLLOWS, OWN):
            turn = f"psi_{b}" if not body.rest else f"(psi_{b} - {body.rest:.9g})"
            terms = [(body.gain, f" Y_{b}"), (-body.damping, f" psi_{b}'"), (-body.stiffness, f" {turn}"),
                     (1.0, f"S_{b}")]
            lines.append(f"tau_{b} = {_sum(terms)}")
    return lines


def _sum(terms: Sequence[tuple[float, str]]) -> str:
    """Those that are not 0; a name without a space before it has no number."""
    found = [f"{'-' if value < 0 else '+'} {f'{abs(value):.9g}' if name[0] == ' ' else ''}{name}"
             for value, name in terms if value]
    return " ".join(found).removeprefix("+ ")


def _head(tree: Tree) -> list[str]:
    numbers = tree.numbers
    lines = [f"{numbers.name}: laconic equations {tree.form} of a tree of bodies",
             "u_b, v_b: velocity of the hinge of body b (of body 0: of its centre of mass) in its own axes",
             "U_i, T_i: voltage and torque of wheel i; Y_b, S_b: those of hinge b; kappa_r: force of a constraint"]
    lines += [f"body {b}: {body.name}, on {numbers.bodies[body.parent].name}; {KINDS[body.motion]}"
              for b, body in enumerate(numbers.bodies) if b]
    if numbers.coordinated:
        lines.append("V_xi, V_eta, Omega: twist of the body frame's origin; the carriage moves along sigma times it")
    return lines


# --------------------------------------------------------------------------------------------- C

_C_HEAD = """\
/* {name}: the rates of the pseudo-velocities, derived by the laconic equations {form} and solved for.
 * eta: {eta}
 * psi: angles of the hinges {hinges}.
{notes} * Arrays of hinges have {hinge_count} items, arrays of wheels {wheel_count}.
 * body_wrench: force at the centre of mass of body 0 in its axes [N] and moment [N*m]; world_force_N acts at its point
 * force_point_m, seen from the centre of mass. */
#include <math.h>

"""
_C_SOLVE = """\
/* Solves the n equations of which a row has n coefficients and a right side. */
static void laconic_{identifier}_solve(double (*rows)[{width}], int n, double *x)
{{
    for (int k = 0; k < n; k++) {{
        int best = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(rows[i][k]) > fabs(rows[best][k])) best = i;
        for (int j = 0; j <= n; j++) {{
            const double kept = rows[k][j];
            rows[k][j] = rows[best][j];
            rows[best][j] = kept;
        }}
        for (int i = k + 1; i < n; i++) {{
            const double factor = rows[i][k] / rows[k][k];
            for (int j = k; j <= n; j++) rows[i][j] -= factor * rows[k][j];
        }}
    }}
    for (int k = n - 1; k >= 0; k--) {{
        x[k] = rows[k][n];
        for (int j = k + 1; j < n; j++) x[k] -= rows[k][j] * x[j];
        x[k] /= rows[k][k];
    }}
}}

"""
_C_RATES = """\
void laconic_{identifier}_rates(const double *eta, const double *psi, double heading_rad, const double *voltage_V,
    const double *axle_torque_Nm, const double *hinge_voltage_V, const double *hinge_torque_Nm,
    const double *hinge_rate_rad_per_s, const double *hinge_acceleration_rad_per_s2, const double twist[3],
    const double twist_rate[3], const double body_wrench[3], const double world_force_N[2],
    const double force_point_m[2], double *eta_rate)
{{
    const double c = cos(heading_rad), s = sin(heading_rad);
    const double outer[2] = {{c * world_force_N[0] + s * world_force_N[1],
        c * world_force_N[1] - s * world_force_N[0]}};
    const double wrench[3] = {{body_wrench[0] + outer[0], body_wrench[1] + outer[1],
        body_wrench[2] + force_point_m[0] * outer[1] - force_point_m[1] * outer[0]}};
"""
_C_MOTION = """\

/* What moves the rest: (u, v, yaw rate) of the centre of mass of body 0 in its axes, rates of hinges, wheel speeds. */
void laconic_{identifier}_motion(const double *eta, const double *psi, const double *hinge_rate_rad_per_s,
    const double twist[3], const double twist_rate[3], double body_twist[3], double *psi_rate, double *wheel_speed)
{{
"""
ARGUMENTS = ("eta", "psi", "heading_rad", "voltage_V", "axle_torque_Nm", "hinge_voltage_V", "hinge_torque_Nm",
             "hinge_rate_rad_per_s", "hinge_acceleration_rad_per_s2", "twist", "twist_rate", "wrench", "slope")


def _targets(numbers: TreeNumbers) -> dict[sp.Symbol, sp.Symbol]:
    """Arguments of the C function for symbols."""
    names = {s.name: f"eta[{k}]" for k, s in enumerate(pseudo_velocities(numbers))}
    for b in range(1, len(numbers.bodies)):
        names |= {f"psi_{b}": f"psi[{b - 1}]", f"r_{b}": f"hinge_rate_rad_per_s[{b - 1}]",
                  f"r_{b}'": f"hinge_acceleration_rad_per_s2[{b - 1}]", f"Y_{b}": f"hinge_voltage_V[{b - 1}]",
                  f"S_{b}": f"hinge_torque_Nm[{b - 1}]"}
    for i in range(1, len(numbers.wheels) + 1):
        names |= {f"U_{i}": f"voltage_V[{i - 1}]", f"T_{i}": f"axle_torque_Nm[{i - 1}]"}
    for k, name in enumerate(TWIST):
        names |= {name: f"twist[{k}]", f"{name}'": f"twist_rate[{k}]"}
    names |= {s.name: f"wrench[{k}]" for k, s in enumerate(OUTER)}
    names |= {s.name: f"slope[{k}]" for k, s in enumerate(SLOPE)}
    return {sp.Symbol(name, real=True): sp.Symbol(target, real=True) for name, target in names.items()}


def _with_torques(tree: Tree) -> dict[sp.Symbol, sp.Expr]:
    """What motors, springs and dampers put in for the torques."""
    first = len(tree.numbers.bodies) + 2
    found = {}
    for i, wheel in enumerate(tree.numbers.wheels, 1):
        given = _exact(wheel.gain) * _real(f"U_{i}") + _real(f"T_{i}")
        found[_real(f"M_{i}")] = given - _exact(wheel.damping) * tree.velocities[first + i - 1]
    for b, body in enumerate(tree.numbers.bodies):
        if body.motion in (FOLLOWS, OWN):
            given = _exact(body.gain) * _real(f"Y_{b}") + _real(f"S_{b}")
            given -= _exact(body.damping) * tree.velocities[2 + b]
            found[_real(f"tau_{b}")] = given - _exact(body.stiffness) * (angle(b) - _exact(body.rest))
    return found


def _real(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


def _exact(value: float) -> sp.Expr:
    return sp.Float(value, 17) if value else sp.S.Zero


def with_numbers(tree: Tree, expressions: Sequence[Any]) -> list[Any]:
    """The expressions with torques and the scene's numbers put in."""
    values = {symbol: sp.Float(value, 17) for symbol, value in tree.numbers.values.items()}
    torques = {symbol: torque.xreplace(values) for symbol, torque in _with_torques(tree).items()}
    return [each.xreplace(values).xreplace(torques) for each in expressions]


def tree_c(tree: Tree) -> str:
    """Two C functions of the scene's own numbers."""
    numbers, identifier = tree.numbers, c_name(tree.numbers.name)
    unknown, rows = len(tree.system.pseudo_rates), len(numbers.left)
    size = unknown + rows
    hinges = [body.name for body in numbers.bodies[1:]]
    notes = f" * Those of {', '.join(_named(numbers, COORDINATED))} are as the twist has them.\n" \
        if numbers.coordinated else ""
    code = _C_HEAD.format(name=numbers.name, form=tree.form, eta=", ".join(map(str, tree.system.pseudo_velocities)),
                          hinges=", ".join(hinges), notes=notes, hinge_count=len(hinges),
                          wheel_count=len(numbers.wheels))
    code += _C_SOLVE.format(identifier=identifier, width=size + 1) + _C_RATES.format(identifier=identifier)
    if any(numbers.sloped):
        x, y = (repr(each) for each in numbers.sloped)
        code += f"    const double slope[2] = {{c * {x} + s * {y}, c * {y} - s * {x}}};\n"
    results = with_numbers(tree, [*tree.mass, *tree.push, *tree.constraint, *tree.drift, *(-tree.constraint.T)])
    lines, values, used = _shared(numbers, results)
    code += f"    double rows[{size}][{size + 1}], x[{size}];\n" + lines
    for name in ("eta", "psi", "voltage_V", "axle_torque_Nm", "hinge_voltage_V", "hinge_torque_Nm",
                 "hinge_rate_rad_per_s", "hinge_acceleration_rad_per_s2", "twist", "twist_rate"):
        code += "" if name in used else f"    (void)({name});\n"
    mass, push, constraint, drift, pull = (values[a:b] for a, b in _parts(unknown, rows))
    for i in range(unknown):
        entries = [*mass[i * unknown:(i + 1) * unknown], *pull[i * rows:(i + 1) * rows], push[i]]
        code += "".join(f"    rows[{i}][{j}] = {entry};\n" for j, entry in enumerate(entries))
    for r in range(rows):
        entries = [*constraint[r * unknown:(r + 1) * unknown], *["0.0"] * rows, drift[r]]
        code += "".join(f"    rows[{unknown + r}][{j}] = {entry};\n" for j, entry in enumerate(entries))
    code += f"    laconic_{identifier}_solve(rows, {size}, x);\n"
    code += f"    for (int k = 0; k < {unknown}; k++) eta_rate[k] = x[k];\n}}\n"
    return code + _c_motion(tree, identifier)


def _parts(unknown: int, rows: int) -> list[tuple[int, int]]:
    ends = np.cumsum([0, unknown * unknown, unknown, rows * unknown, rows, rows * unknown])
    return list(zip(map(int, ends[:-1]), map(int, ends[1:]), strict=True))


def _named(numbers: TreeNumbers, motion: int) -> list[str]:
    return [body.name for body in numbers.bodies[1:] if body.motion == motion]


def _c_motion(tree: Tree, identifier: str) -> str:
    numbers, hinges = tree.numbers, len(tree.numbers.bodies) - 1
    results = with_numbers(tree, [*tree.twists[0], *tree.velocities[3:]])
    lines, values, used = _shared(numbers, results)
    names = [*(f"body_twist[{k}]" for k in range(3)), *(f"psi_rate[{b}]" for b in range(hinges)),
             *(f"wheel_speed[{i}]" for i in range(len(numbers.wheels)))]
    code = _C_MOTION.format(identifier=identifier) + lines
    for name in ("psi", "hinge_rate_rad_per_s", "twist", "twist_rate"):
        code += "" if name in used else f"    (void)({name});\n"
    return code + "".join(f"    {name} = {value};\n" for name, value in zip(names, values, strict=True)) + "}\n"


def _shared(numbers: TreeNumbers, results: Sequence[sp.Expr]) -> tuple[str, list[str], set[str]]:
    """Lines of common parts, the results in them as C, and the arguments that occur."""
    placed = [each.xreplace(_targets(numbers)) for each in results]
    shared, left = sp.cse(placed, symbols=sp.numbered_symbols("e"))
    used = {re.split(r"\[", s.name)[0] for each in placed for s in each.free_symbols}
    return "".join(f"    const double {symbol} = {sp.ccode(value)};\n" for symbol, value in shared), \
        [sp.ccode(each) for each in left], used
