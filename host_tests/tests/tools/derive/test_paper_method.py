"""The method: laconic equations (2.3), (2.4) against Maggi's (1.2), the derivations, and the core against both."""

import re
import shlex
import subprocess

import numpy as np
import pytest
import sympy as sp
from cffi import FFI

from laconic.base.paths import SCENE_DIR, SOURCE_DIR
from laconic.cli import main as cli
from laconic.core import load
from laconic.scene import read_scene
from laconic.tools.analyse.from_core import Subject, nu_rates, subject_of
from laconic.tools.derive import brackets, equations, printing, scene_system, vehicles
from laconic.tools.derive.scene_check import core_difference, forms_difference
from scene_text import ideal_scene_names

SYSTEMS = {
    "caster": vehicles.caster,
    "carriage with 0 wheels": lambda: vehicles.carriage(vehicles.wheel_rows(0)),
    "carriage with 5 wheels": lambda: vehicles.carriage(vehicles.wheel_rows(5)),
    "three-wheel carriage": lambda: vehicles.carriage(vehicles.three_wheel_rows()),
    "differential drive": vehicles.differential_drive_from_scratch,
    "tractor with trailer": vehicles.tractor_with_trailer,
}

x, y = sp.symbols("x y", real=True)


def skate_on_a_turntable() -> equations.System:
    """Constraints that depend on time and are not homogeneous: beyond (2.4), but (2.3) must still equal (1.2)."""
    theta, t = sp.symbols("theta t", real=True)
    rates = sp.symbols("x' y' theta'", real=True)
    speed, turn, rate = sp.symbols("v omega Omega", real=True)
    mass, inertia = sp.symbols("m I", positive=True)
    return equations.System(
        name="skate on a turntable", coordinates=(x, y, theta), rates=rates, pseudo_velocities=(speed, turn),
        pseudo_rates=sp.symbols("v' omega'", real=True), time=t,
        lagrangian=(mass * (rates[0] ** 2 + rates[1] ** 2) + inertia * rates[2] ** 2) / 2 - mass * x**2 * t / 2,
        velocities=(speed * sp.cos(theta) - rate * t * y, speed * sp.sin(theta) + rate * t * x, turn + rate * t),
        forces=(sp.Integer(0), sp.Symbol("F", real=True), sp.Integer(0)))


@pytest.mark.parametrize("make", SYSTEMS.values(), ids=SYSTEMS.keys())
def test_2_3_equals_2_4_equals_maggi(make):
    assert forms_difference(make()) < 1e-13


def test_2_3_equals_maggi_with_constraints_that_depend_on_time_and_are_not_homogeneous():
    system = skate_on_a_turntable()
    difference = sp.Matrix(equations.laconic_2_3(system)) - sp.Matrix(equations.maggi(system))
    assert difference.applyfunc(sp.simplify) == sp.zeros(2, 1)


def test_2_4_refuses_constraints_it_does_not_hold_for():
    with pytest.raises(ValueError, match=r"use \(2.3\)"):
        equations.laconic_2_4(skate_on_a_turntable())


def test_without_constraints_2_4_is_lagranges_equation_of_a_pendulum():
    angle, rate, omega, omega_rate = sp.symbols("q q' w w'", real=True)
    g = sp.Symbol("g", positive=True)
    pendulum = equations.System(
        name="pendulum", coordinates=(angle,), rates=(rate,), pseudo_velocities=(omega,), pseudo_rates=(omega_rate,),
        lagrangian=rate**2 / 2 + g * sp.cos(angle), velocities=(omega,), forces=(sp.Integer(0),))
    assert equations.laconic_2_4(pendulum) == [omega_rate + g * sp.sin(angle)]


@pytest.mark.parametrize("make", [vehicles.tractor_with_trailer, lambda: vehicles.carriage(vehicles.wheel_rows(3))])
def test_power_of_the_derived_equations_is_the_rate_of_the_energy(make):
    system = make()
    unforced = {s: 0 for force in system.forces for s in force.free_symbols
                if s.name.startswith(("M_", "F_", "tau"))}
    residuals = [e.xreplace(unforced) for e in equations.laconic_2_4(system)]
    energy_rate = equations.time_derivative(system, system.constrained_lagrangian())
    work = sum(w * e for w, e in zip(system.pseudo_velocities, residuals, strict=True))
    symbols = sorted(work.free_symbols | energy_rate.free_symbols, key=str)
    evaluate = sp.lambdify(symbols, (work, energy_rate), "math")
    for row in np.random.default_rng(3).uniform(0.5, 2.0, (10, len(symbols))):
        left, right = evaluate(*row)
        assert left == pytest.approx(right, rel=1e-12)


def test_trailer_needs_the_bracket_with_the_lagrangian_that_vanishes_for_the_papers_vehicles():
    assert brackets.bracketed(vehicles.tractor_with_trailer()).slopes != sp.zeros(2, 1)
    for make in (vehicles.caster, lambda: vehicles.carriage(vehicles.wheel_rows(4))):
        slopes = brackets.bracketed(make()).slopes
        assert slopes == sp.zeros(*slopes.shape)


def test_carriage_is_4_6_with_the_outer_force_of_4_7():
    rows = vehicles.wheel_rows(4)
    system = vehicles.carriage(rows)
    matrix, rest = equations.mass_matrix_and_rest(system, equations.laconic_2_4(system))
    mass, radius, big, small = sp.symbols("M R Lambda lambda", positive=True)
    nu = sp.symbols("nu_1 nu_2 nu_3", real=True)
    theta, f_xi, f_eta, tau, f_x, f_y, r_xi, r_eta = sp.symbols("theta F_xi F_eta tau F_X F_Y r_xi r_eta", real=True)
    inertia = sp.eye(3) + small**2 * rows.T * rows
    assert (matrix - mass * radius**2 * inertia).applyfunc(brackets.tidy) == sp.zeros(3, 3)
    world = sp.Matrix([[sp.cos(theta), sp.sin(theta)], [-sp.sin(theta), sp.cos(theta)]]) * sp.Matrix([f_x, f_y])
    force = sp.Matrix([f_xi, f_eta]) + world
    moment = tau + r_xi * world[1] - r_eta * world[0]
    outer = sp.Matrix([radius * force[0], radius * force[1], moment / big])
    torques = sp.Matrix(sp.symbols("M_1:5", real=True))
    gyroscopic = sp.Matrix([nu[1] * nu[2], -nu[0] * nu[2], 0]) * mass * radius**2 / big
    assert (rest - gyroscopic - rows.T * torques - outer).applyfunc(brackets.tidy) == sp.zeros(3, 1)


def test_section_6_shortcut_gives_what_the_derivation_from_scratch_gives():
    shortcut = vehicles.differential_drive().equations()
    for form in (equations.laconic_2_3, equations.laconic_2_4, equations.maggi):
        whole = form(vehicles.differential_drive_from_scratch())
        assert [brackets.tidy(a - b) for a, b in zip(shortcut, whole, strict=True)] == [0, 0]


def test_shortcut_refuses_a_constraint_that_depends_on_the_place():
    with pytest.raises(ValueError, match="constant coefficients"):
        brackets.impose(brackets.bracketed(vehicles.caster()), sp.Matrix([x, 1]), (1,), "bent")


# ---- the core against the derived equations


def vehicle_of(wheels, **more):
    return {"mass_kg": 11.0, "yaw_inertia_kgm2": 0.31, "com_x_m": 0.013, "com_y_m": -0.021, "wheel_radius_m": 0.06,
            "wheel_inertia_kgm2": 0.007, "motor_gain_Nm_per_V": 0.4, "motor_damping_Nms": 0.03, "wheel": wheels, **more}


def roller(x_m, y_m, axle, gamma):
    return {"kind": "roller", "x_m": x_m, "y_m": y_m, "axle_rad": axle, "roller_rad": gamma}


OWN = ({"radius_m": 0.05, "inertia_kgm2": 0.002, "motor_damping_Nms": 0.09}, {"driven": False},
       {"radius_m": 0.075, "motor_gain_Nm_per_V": -0.7}, {"inertia_kgm2": 0.0, "motor_damping_Nms": 0.0})

VEHICLES = {
    "four mecanum wheels, each unlike the others": vehicle_of([
        roller(x, y, -np.pi / 2, turn) | own for (x, y, turn), own in zip(
            ((0.2, 0.15, 0.8), (0.2, -0.15, -0.8), (-0.2, 0.15, -0.7), (-0.2, -0.15, 0.9)), OWN, strict=True)]),
    "two fixed wheels of two sizes": vehicle_of([
        {"kind": "fixed", "x_m": 0.0, "y_m": s * 0.2, "axle_rad": -np.pi / 2} | own
        for s, own in zip((1, -1), OWN, strict=False)]),
    "puck": vehicle_of([]),
    "three omni wheels": vehicle_of([roller(0.2 * np.cos(a), 0.2 * np.sin(a), a, np.pi / 2) for a in (0.3, 2.2, 4.5)]),
    "four mecanum wheels": vehicle_of([
        roller(0.2, 0.15, -np.pi / 2, np.pi / 4), roller(0.2, -0.15, -np.pi / 2, -np.pi / 4),
        roller(-0.2, 0.15, -np.pi / 2, -np.pi / 4), roller(-0.2, -0.15, -np.pi / 2, np.pi / 4)]),
    "seven unequal wheels": vehicle_of([
        roller(0.1 + 0.05 * k, 0.2 - 0.07 * k, 0.9 * k, 0.5 + 0.3 * k) for k in range(7)]),
    "mecanum with a locked wheel": vehicle_of([
        {**roller(0.2, 0.15, -np.pi / 2, np.pi / 4), "locked": True}, roller(-0.2, -0.15, -np.pi / 2, np.pi / 4)]),
    "oblique fixed wheel and an omni wheel": vehicle_of([
        {"kind": "fixed", "x_m": 0.1, "y_m": 0.05, "axle_rad": 0.7}, roller(-0.2, 0.0, 0.2, np.pi / 2)]),
    "two fixed wheels on one axle line": vehicle_of([
        {"kind": "fixed", "x_m": 0.0, "y_m": s * 0.2, "axle_rad": -np.pi / 2} for s in (1, -1)]),
    "two fixed wheels whose axles cross: it only turns": vehicle_of([
        {"kind": "fixed", "x_m": 0.2, "y_m": 0.0, "axle_rad": 0.3},
        {"kind": "fixed", "x_m": -0.1, "y_m": 0.1, "axle_rad": 1.4}]),
}


ALIKE = ("three omni wheels", "four mecanum wheels", "two fixed wheels on one axle line")
QUICK = ("paper_three_wheel_driven", "kuka_youbot", "turtlebot3_burger", "example_two_wheel_sizes")


def at_night(names, which):
    """The names; those for which `which` holds at night alone."""
    return [pytest.param(name, marks=pytest.mark.nightly) if which(name) else name for name in names]


def subject_from(data) -> Subject:
    core = load("double")
    vehicle = core.vehicle(data)
    scene = read_scene("paper_three_wheel_free")
    return Subject(scene, core, vehicle, core.prepare(vehicle), core.matrices(vehicle), {})


@pytest.mark.parametrize("name", at_night(VEHICLES, lambda name: name in ALIKE))
def test_core_derivative_equals_the_derived_one_at_1000_random_states(name):
    subject = subject_from(VEHICLES[name])
    assert core_difference(subject, scene_system.derive(subject.numbers()), count=1000) < 1e-12


@pytest.mark.parametrize("name", at_night(ideal_scene_names(), lambda name: name not in QUICK))
def test_core_derivative_equals_the_derived_one_for_scenes_on_ideal_ground(name):
    subject = subject_of(read_scene(name))
    assert core_difference(subject, scene_system.derive(subject.numbers()), count=100) < 1e-12


def test_check_of_the_core_notices_a_wrong_equation():
    subject = subject_from(VEHICLES["three omni wheels"])
    system = scene_system.derive(subject.numbers())
    forces = system.forces.copy()
    forces[1] = -forces[1]
    wrong = brackets.Bracketed(**{**system.__dict__, "forces": forces})
    assert core_difference(subject, wrong, count=5) > 1e-3


@pytest.mark.parametrize("name", ["three omni wheels", "two fixed wheels on one axle line"])
def test_printed_c_compiles_and_gives_the_cores_derivative(name, tmp_path):
    subject = subject_from(VEHICLES[name])
    numbers = subject.numbers()
    source = tmp_path / "derived.c"
    source.write_text(printing.as_c(numbers, scene_system.derive(numbers)))
    library = tmp_path / "derived.so"
    subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-o", library, source, "-lm"],
                   check=True)
    function = f"laconic_{printing.c_name(numbers.name)}_rates"
    ffi = FFI()
    ffi.cdef(f"void {function}(const double *, double, const double *, const double *, const double *, "
             "const double *, const double *, double *);")
    derived = getattr(ffi.dlopen(str(library)), function)
    rng, n, core = np.random.default_rng(5), subject.wheel_count, subject.core
    model_basis = core.numbers(subject.model.nu_of_zeta, 3, 3)[:, : subject.model.dof]
    for _ in range(50):
        nu = model_basis @ rng.normal(0.0, 3.0, subject.model.dof)
        values = {"voltage_V": rng.normal(size=n), "axle_torque_Nm": rng.normal(size=n),
                  "body_force_N": rng.normal(size=2), "body_moment_Nm": rng.normal(),
                  "world_force_N": rng.normal(size=2), "world_force_point_m": rng.normal(size=2)}
        theta, out = rng.uniform(-4.0, 4.0), ffi.new("double[3]")
        wrench = [*values["body_force_N"], values["body_moment_Nm"]]
        derived(list(nu), theta, list(values["voltage_V"]), list(values["axle_torque_Nm"]), wrench,
                list(values["world_force_N"]), list(values["world_force_point_m"]), out)
        expected = nu_rates(core, subject.model, nu, theta, core.input(values, n))
        assert np.abs(np.array(list(out)) - expected).max() <= 1e-12 * max(1.0, np.abs(expected).max())


def test_latex_has_dots_for_rates_and_no_bare_primes():
    text = printing.as_latex(vehicles.differential_drive())
    assert r"\dot{\nu}_{3}" in text
    assert r"\frac{\Delta \nu_{3}^{2}}{\Lambda^{2}}" in text
    assert "'" not in text


def test_solve_constraints_counts_equal_rows_once_and_keeps_what_moves():
    rows = np.array([[1.0, 0.0, 0.4], [-1.0, 1e-16, -0.4]])
    basis, kept = scene_system.solve_constraints(rows)
    assert kept == (1, 2)
    assert np.abs(rows @ basis).max() < 1e-15


# ---- Every erratum of the printed paper, as the right statement and, where it is wrong, the printed one.

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


# ---- docs/paper.md keeps its promises: the tests it names exist, its pictures are there, its commands can be
# called.

PAGE = (SOURCE_DIR / "docs" / "paper.md").read_text()
TESTS = "\n".join(path.read_text() for path in (SOURCE_DIR / "host_tests" / "tests").rglob("test_*.py"))
COMMANDS = [shlex.split(line, comments=True) for line in PAGE.splitlines() if line.startswith("laconic ")]


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`(test_\w+)`", PAGE))))
def test_every_test_that_the_page_names_exists(name):
    assert f"def {name}(" in TESTS


@pytest.mark.parametrize("picture", re.findall(r"!\[.*?\]\((.*?)\)", PAGE))
def test_every_picture_of_the_page_is_there(picture):
    assert (SOURCE_DIR / "docs" / picture).stat().st_size > (1_000 if picture.endswith(".svg") else 10_000)


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_every_command_of_the_page_can_be_called_as_it_stands(words):
    command = cli.commands.get_command(None, words[1])
    context = command.make_context(words[1], list(words[2:]))
    scene = context.params.get("scene")
    assert scene is None or (SCENE_DIR / f"{scene}.toml").exists()


def test_each_equation_of_the_page_leads_to_a_function_of_its_file():
    rows = re.findall(r"^\| (\S.*?) \| .*? \| `(\w+)` in \[\S+\]\((\S+?)\) \| `test_\w+` \|$", PAGE, re.MULTILINE)
    assert {"(1.2)", "(2.4)", "(4.6)", "(4.7)", "(6.1)"} <= {equation for equation, _, _ in rows}
    for equation, function, path in rows:
        text = (SOURCE_DIR / "docs" / path).read_text(encoding="utf-8")
        assert re.search(rf"^(?:\s*def |\w[\w *]*[ *]){function}\(", text, re.MULTILINE), f"{equation}: {path}"


def test_every_erratum_and_the_whole_of_section_5_are_on_the_page():
    for number in range(1, 6):
        assert f"`test_erratum_{number}_" in PAGE
    for word in ("ellipses", "many petals", "parabola", "subcritical", "caster", "no slip"):
        assert word in PAGE
