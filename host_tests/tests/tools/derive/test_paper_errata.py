"""Every erratum of the printed paper, as the right statement and, where it is wrong, the printed one."""

import pytest
import sympy as sp

from laconic.tools.derive import brackets, equations, vehicles

theta = sp.Symbol("theta", real=True)
LAMBDA, DELTA = sp.Symbol("Lambda", positive=True), sp.Symbol("Delta", real=True)
MASS, RADIUS = sp.symbols("M R", positive=True)


def test_erratum_1_constraint_rows_are_right_as_printed():
    """The lowest point of the wheel must not move along the roller's axis: this gives (4.3) and (4.4) anew."""
    alpha, beta, gamma, chi_rate, nu_1, nu_2, nu_3 = sp.symbols("alpha beta gamma chi nu_1 nu_2 nu_3", real=True)
    delta = sp.Symbol("delta", real=True)
    hub = RADIUS * delta * sp.Matrix([sp.cos(alpha), sp.sin(alpha)]) - sp.Matrix([0, RADIUS * DELTA])
    yaw_rate = nu_3 / LAMBDA
    hub_velocity = RADIUS * sp.Matrix([nu_1, nu_2]) + yaw_rate * sp.Matrix([-hub[1], hub[0]])
    contact = hub_velocity - RADIUS * chi_rate * sp.Matrix([-sp.sin(beta), sp.cos(beta)])
    along_roller = contact.dot(sp.Matrix([sp.cos(beta + gamma), sp.sin(beta + gamma)]))
    rolled = sp.solve(along_roller, chi_rate)[0]
    printed = sum(s * n for s, n in zip(vehicles.geometry_row(alpha, beta, gamma, delta), (nu_1, nu_2, nu_3),
                                        strict=True))
    assert brackets.tidy(sp.expand_trig(sp.numer(sp.together(rolled - printed)))) == 0


def test_erratum_1_sums_for_the_formal_momenta_run_over_sigma_i1_not_sigma_1i():
    system = vehicles.carriage(vehicles.wheel_rows(2))
    formal = equations.formal_pseudo_momenta(system)
    p_1, p_2 = system.momenta[3:]
    sigma = vehicles.wheel_rows(2)
    for s in range(3):
        assert sp.diff(formal[s], p_1) == sigma[0, s]
        assert sp.diff(formal[s], p_2) == sigma[1, s]
    assert sp.diff(formal[0], p_2) != sigma[0, 1]  # the printed order


def test_erratum_2_the_pushed_point_lies_at_minus_d_along_the_fork():
    """Work of F e_x on δθ: with CQ = −D e_θ it is D F sin θ, with the printed −D e_θ⊥ it is not."""
    arm, force = sp.symbols("D F", real=True)
    along, across = sp.Matrix([sp.cos(theta), sp.sin(theta)]), sp.Matrix([-sp.sin(theta), sp.cos(theta)])

    def moment(lever):
        return sp.simplify(lever[0] * 0 - lever[1] * force)

    assert moment(-arm * along) == arm * force * sp.sin(theta)
    assert sp.simplify(moment(-arm * across) - arm * force * sp.sin(theta)) != 0
    assert vehicles.caster().generalised_force(0) == arm * force * sp.sin(theta)


def test_erratum_2_bracket_of_the_caster_vanishes_and_the_printed_line_does_not():
    system = vehicles.caster()
    formal = equations.formal_pseudo_momenta(system)
    bracket = equations.poisson(system, formal[0], formal[1])
    p_x, p_y = system.momenta[:2]
    assert sp.expand(bracket - RADIUS * (p_x * sp.sin(theta) - p_y * sp.cos(theta))) == 0
    real = system.real_momenta()
    assert brackets.tidy(bracket.xreplace(real)) == 0
    printed = -(p_x * RADIUS * sp.sin(theta) + p_y * RADIUS * sp.cos(theta))
    assert brackets.tidy(printed.xreplace(real)) != 0


def test_caster_equations_are_3_2_and_3_3():
    system = vehicles.caster()
    yaw_inertia, wheel_inertia, mass = sp.symbols("J_1 J_3 m", positive=True)
    arm, force = sp.symbols("D F", real=True)
    turn, roll = system.pseudo_rates
    expected = [yaw_inertia * turn - arm * force * sp.sin(theta),
                (wheel_inertia + mass * RADIUS**2) * roll - RADIUS * force * sp.cos(theta)]
    for form in (equations.laconic_2_3, equations.laconic_2_4, equations.maggi):
        assert [brackets.tidy(e - x) for e, x in zip(form(system), expected, strict=True)] == [0, 0]


def test_erratum_5_first_diagonal_entry_without_the_third_wheel_is_one():
    rows = vehicles.two_wheel_rows()
    assert list(rows[:, 0]) == [0, 0]
    small = sp.Symbol("lambda", positive=True)
    sigma = sp.Symbol("sigma", positive=True)
    inertia = (sp.eye(3) + small**2 * rows.T * rows).applyfunc(sp.simplify)
    assert inertia == sp.diag(1, 1 + 2 * small**2, 1 + 2 * sigma**2 * small**2)


@pytest.mark.parametrize("make", [vehicles.differential_drive, vehicles.differential_drive_from_scratch])
def test_erratum_5_differential_drive_has_delta_squared_over_lambda_squared_without_a1(make):
    system = make()
    found = system.equations() if isinstance(system, brackets.Bracketed) else equations.maggi(system)
    small, sigma = sp.symbols("lambda sigma", positive=True)
    nu_2, nu_3, rate_2, rate_3, m_1, m_2 = sp.symbols("nu_2 nu_3 nu_2' nu_3' M_1 M_2", real=True)
    no_outer_force = {s: 0 for s in sp.symbols("F_xi F_eta tau F_X F_Y", real=True)}
    a2, a3 = 1 + 2 * small**2, 1 + 2 * sigma**2 * small**2
    scale = 1 / (MASS * RADIUS**2)
    expected = [
        a2 * rate_2 - DELTA / LAMBDA**2 * nu_3**2 - scale * (m_1 - m_2),
        (DELTA**2 / LAMBDA**2 + a3) * rate_3 + DELTA / LAMBDA**2 * nu_2 * nu_3 - scale * sigma * (m_1 + m_2),
    ]
    for equation, right in zip(found, expected, strict=True):
        assert brackets.tidy(equation.xreplace(no_outer_force) * scale - right) == 0
