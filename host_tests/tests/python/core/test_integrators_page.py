"""docs/integrators.md is right: its formulas, run in 50 digits, give the core's one step to rounding."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
import sympy as sp

from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.scene.methods import EXACT, EXACT_4, EXPLICIT, EXPLICIT_8, ROWS, STIFF, STIFF_4, STIFF_8

PAGE = (SOURCE_DIR / "docs" / "integrators.md").read_text(encoding="utf-8")
DIGITS = 50
TOLERANCE = 2e-14  # of the largest number of a state: some ten roundings
# Functions of the page that are not named as the method's identifier; two are of second order, and extrapolated, too.
FUNCTIONS = {EXPLICIT_8: "taylor", STIFF: "kahan_increment", EXACT: "flow_base", STIFF_4: "kahan_increment",
             EXACT_4: "flow_base", STIFF_8: "gauss"}
SECOND_ORDER = {"kahan_increment", "flow_base"}
METHODS = {row.name: FUNCTIONS.get(row.name, row.identifier) for row in ROWS[1:]}
OF_EIGHTH_ORDER = [row.name for row in ROWS[1:] if row.order == 8]  # their displacement is a quadrature of its own
# damping, step, wheels: hardly damped; damped beside the step (h r about 1.5, `stiff`); free; two fixed wheels
CASES = {"weak": (0.02, 0.05, "omni"), "stiff": (0.3, 0.06, "omni"), "free": (0.0, 0.1, "omni"),
         "constrained": (0.1, 0.1, "fixed")}


def formulas(page: str) -> str:
    """The code blocks of the page, in its order."""
    return "\n".join(re.findall(r"```python [\w-]+\n(.*?)```", page, re.DOTALL))


def vector(*numbers: Any) -> sp.Matrix:
    """A column of numbers in the digits of this test."""
    return sp.Matrix([sp.Float(each, DIGITS) for each in numbers])


def each(function: Any) -> Any:
    """A function of two numbers, for each axis."""
    return lambda x, y: sp.Matrix([function(p, q) for p, q in zip(x, y, strict=True)])


def remembered(weights: Any) -> Any:
    """Weights that are computed once for the same numbers."""
    results: dict[tuple[Any, ...], sp.Matrix] = {}

    def known(i: int, k: int, a: sp.Matrix, to: Any) -> sp.Matrix:
        key = (i, k, *a, to)
        if key not in results:
            results[key] = weights(i, k, a, to)
        return results[key]
    return known


@dataclass
class Case:
    """A random robot, its state and what acts on it, in the core; and the names that the page's formulas use."""

    name: str
    method: str
    sampled: bool
    core: Any = field(default_factory=lambda: load("double"))

    def __post_init__(self) -> None:
        """Draws the numbers."""
        damping, self.step_s, kind = CASES[self.name]
        chance = np.random.default_rng([*map(ord, self.name)])
        wheels = [{"kind": "fixed", "x_m": 0.0, "y_m": side, "axle_rad": -np.pi / 2} for side in (0.3, -0.25)]
        if kind == "omni":
            wheels = [{"kind": "omni", "x_m": 0.3 * np.cos(a), "y_m": 0.2 * np.sin(a), "axle_rad": a + 0.1}
                      for a in chance.uniform(-3, 3, 4)]
        vehicle = self.core.vehicle({
            "mass_kg": 4.0, "yaw_inertia_kgm2": 0.3, "com_x_m": 0.05, "com_y_m": -0.02, "wheel_radius_m": 0.1,
            "wheel_inertia_kgm2": 0.004, "motor_gain_Nm_per_V": 0.1, "motor_damping_Nms": damping, "wheel": wheels})
        nu = chance.uniform(-4, 4, 3)
        if kind == "fixed":
            nu = np.array([3.0, 0.0, 0.0])
        self.plant = self.core.plant(vehicle, self.method, self.step_s, nu_rad_per_s=nu, heading_rad=0.4)
        inputs = [{"voltage_V": chance.uniform(-5, 5, len(wheels)), "body_moment_Nm": chance.uniform(-1, 1)}
                  for _ in range(3 if self.sampled else 1)]
        self.inputs = [self.core.input(each, len(wheels)) for each in inputs] * (1 if self.sampled else 3)

    def names(self) -> dict[str, Any]:
        """Numbers of model, state and input, and functions of vectors."""
        c, numbers = self.plant.c, self.core.numbers
        forcing = []
        for given in self.inputs:
            core_forcing = self.core.ffi.new("laconic_forcing *")
            self.core.lib.laconic_forcing_of(core_forcing, self.core.ffi.addressof(c, "model"), given)
            forcing.append(vector(*numbers(core_forcing.constant)))
        unit = sp.eye(3)
        return {
            "h": sp.Float(self.step_s, DIGITS), "zeta": vector(*(part.value for part in c.state.zeta)),
            "g": vector(*numbers(c.model.nu_of_zeta, 3, 3)[2]), "w": vector(*numbers(c.model.gyro)),
            "r": vector(*numbers(c.model.decay_per_s)), "yaw_rate": vector(*numbers(c.model.yaw_rate_of_zeta)),
            "along": vector(*numbers(c.model.velocity_of_zeta, 2, 3)[0]),
            "across": vector(*numbers(c.model.velocity_of_zeta, 2, 3)[1]), "stiff": c.integrator.stiff,
            "b0": forcing[0], "bm": forcing[1], "b1": forcing[2],
            "dot": lambda x, y: sum(p * q for p, q in zip(x, y, strict=True)), "cross": lambda x, y: x.cross(y),
            "times": each(lambda p, q: p * q), "over": each(lambda p, q: p / q), "vector": lambda *v: sp.Matrix(v),
            "none": vector(0, 0, 0), "ones": vector(1, 1, 1), "e1": unit[:, 0], "e2": unit[:, 1], "e3": unit[:, 2],
            "diagonal": lambda v: sp.diag(*v), "columns": lambda *v: sp.Matrix.hstack(*v),
            "solve": lambda system, right: system.LUsolve(right), "real": sp.re, "I": sp.I,
            "exp": sp.exp, "sin": sp.sin, "cos": sp.cos, "tan": sp.tan, "sqrt": sp.sqrt, "factorial": sp.factorial}

    def by_the_page(self, page: str) -> tuple[dict[str, Any], np.ndarray]:
        """The formulas run, and ζ⁺ with the mean of ζ over the step; but for eighth order displacement and yaw."""
        names = self.names()
        exec(formulas(page), names)
        names["weights"] = remembered(names["weights"])  # the same in each of its 32 sweeps
        base, samples = names[METHODS[self.method]], (names["b0"], names["bm"], names["b1"])
        if METHODS[self.method] not in SECOND_ORDER:
            delta, mean, slope = base(*samples)
        elif self.method in (STIFF_4, EXACT_4):
            delta, mean, slope = names["extrapolated"](base, *samples)
        else:
            delta, mean, slope = base(names["zeta"], names["h"], names["parabola"](*samples))
        found = [*(names["zeta"] + delta), *mean]
        if self.method not in OF_EIGHTH_ORDER:
            moved, yaw_change = names["displacement"](mean, slope)
            moved = sp.expand((moved * sp.exp(sp.I * (sp.Float(0.4, DIGITS) + yaw_change / 2))).evalf(DIGITS))
            found += [*moved.as_real_imag(), yaw_change]
        return names, np.array([float(sp.re(sp.N(each, DIGITS))) for each in found])

    def by_the_core(self) -> np.ndarray:
        """The same numbers after one step of the core."""
        c, ffi = self.plant.c, self.core.ffi
        at = [ffi.addressof(c, name) for name in ("model", "integrator", "state")]
        before = self.plant.pose
        start = (before.x_m, before.y_m, before.heading_rad)
        status = (self.core.lib.laconic_step_sampled(*at, *self.inputs) if self.sampled
                  else self.core.lib.laconic_step(*at, self.inputs[0]))
        assert status == 0
        state, after = c.state, self.plant.pose
        found = [part.value + part.rest for part in state.zeta]
        found += [(part.value + part.rest) / self.step_s for part in state.travel]
        if self.method not in OF_EIGHTH_ORDER:
            found += [after.x_m - start[0], after.y_m - start[1], after.heading_rad - start[2]]
        return np.array(found)

    def difference(self, page: str) -> float:
        """Largest difference beside the size of the state."""
        by_page, by_core = self.by_the_page(page)[1], self.by_the_core()
        return float(np.abs(by_page - by_core).max() / np.abs(by_core).max())


@pytest.mark.parametrize(("name", "sampled"), [
    pytest.param(name, sampled, id=f"{name}-{'sampled' if sampled else 'held'}",
                 marks=[] if sampled == (name in ("weak", "stiff")) else pytest.mark.nightly)
    for name in CASES for sampled in (False, True)])
@pytest.mark.parametrize("method", METHODS)
def test_the_pages_formulas_give_the_cores_step(method, name, sampled):
    assert Case(name, method, sampled).difference(PAGE) < TOLERANCE


@pytest.mark.parametrize("name", CASES)
def test_the_equation_of_the_page_is_the_one_of_the_paper(name):
    """(4.7) with the matrices of the paper, against G ζ'."""
    case = Case(name, EXACT, False)
    names, core, c = case.names(), case.core, case.plant.c
    exec(formulas(PAGE), names)
    zeta_rate = names["zeta_rate"](names["zeta"], names["b0"])
    by_page = core.numbers(c.model.nu_of_zeta, 3, 3) @ np.array([float(each) for each in zeta_rate])
    matrices, nu = core.matrices(core.ffi.addressof(c, "vehicle")), case.plant.nu
    wheels = matrices.wheel_rows
    unit = c.model.mass_kg * c.model.wheel_radius_m**2
    torque = np.array(case.plant.wheel_torques(case.inputs[0]))
    right = wheels.T @ torque / unit + np.array([nu[1] * nu[2], -nu[0] * nu[2], 0]) / c.model.yaw_scale
    right[2] += case.inputs[0].body_moment_Nm / c.model.yaw_scale / unit
    assert np.abs(by_page - matrices.inverse_inertia @ right).max() < 1e-12 * np.abs(by_page).max()


@pytest.mark.parametrize("method, order", [(row.name, row.order) for row in ROWS if row.keeps == "EXACTLY"])
def test_in_free_motion_exact_flow_has_zeta_to_rounding_and_pose_and_travel_to_its_order(method, order):
    def after(method: str, steps: int) -> tuple[np.ndarray, np.ndarray]:
        case = Case("free", method, False)
        plant = case.core.plant(case.core.ffi.addressof(case.plant.c, "vehicle"), method, 0.8 / steps,
                                nu_rad_per_s=[3.0, -2.0, 4.0])
        plant.run(case.core.input({}), steps)
        pose, state = plant.pose, plant.c.state
        return (np.array([each.value for each in state.zeta]),
                np.array([pose.x_m, pose.y_m, pose.heading_rad, *(each.value for each in state.travel)]))

    zeta, quadratures = after(EXPLICIT_8, 400)
    errors = []
    for steps in (16, 32):
        found = after(method, steps)
        assert np.abs(found[0] - zeta).max() < TOLERANCE * np.abs(zeta).max()
        errors.append(np.abs(found[1] - quadratures).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.1)


WRONG = {  # method → what is put instead of what
    EXPLICIT: ("2 * k2 + 2 * k3", "2 * k2 + 3 * k3"), EXPLICIT_8: ("h / (n + 1)", "h / (n + 2)"),
    STIFF_8: ("+ b - times(r, z0)", "+ b + times(r, z0)"),
    STIFF: ("cross(x, w)) / 2", "cross(x, w)) / 3"),
    EXACT: ("(1 - across * tangent)", "(1 + across * tangent)"),
    STIFF_4: ("(mean - whole[1]) / 3", "(mean - whole[1]) / 4"),
    EXACT_4: ("- times(p2, change)", "+ times(p2, change)"),
    "the pose": ("dot(yaw_rate, slope) / 12", "dot(yaw_rate, slope) / 6")}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_formula_is_noticed(what):
    right, wrong = WRONG[what]
    assert PAGE.count(right) == 1
    case = Case("weak", what if what in METHODS else EXPLICIT, True)
    assert case.difference(PAGE.replace(right, wrong)) > 1e3 * TOLERANCE


def test_the_table_of_the_page_has_every_method_with_its_order():
    rows = dict(re.findall(r"^\| `([\w-]+)` \| (\d) \|", PAGE, re.MULTILINE))
    assert rows == {row.name: str(row.order) for row in ROWS}


def test_every_formula_of_the_page_is_run():
    assert PAGE.count("```") == 2 * len(re.findall(r"```python [\w-]+\n", PAGE)) >= 20
