"""Driven motion (section 5), and errata 3 and 4: steady motions, parabola, thresholds, Andronov–Hopf points, cycles."""

from functools import cache

import numpy as np
import pytest

from laconic.core import load
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.analyse import confirm, steady
from laconic.tools.analyse.continuation import diagram
from laconic.tools.analyse.cycle import cycle_near, first_lyapunov
from laconic.tools.analyse.field import Field
from laconic.tools.analyse.from_core import field_of, nu_rates, subject_of
from laconic.tools.analyse.motions import command_parameter, commanded_straight, default_range, straight_thresholds
from laconic.tools.analyse.steady import SteadyMotion, families, steady_motions, steady_polynomial

CORE = load("double")
NU_1 = (0.0, 3.0, -2.0)


@pytest.mark.parametrize(("yaw", "turns"), [(4e-9, False), (-4e-9, False), (1e-6, True), (0.3, True)])
def test_a_yaw_within_the_rounding_of_a_double_root_is_straight(yaw, turns):
    motion = SteadyMotion(np.zeros(3), np.array([1.0, 0.0, yaw]), np.zeros(3), "stable")
    assert motion.is_turning is turns


class Example:
    """The paper's three-wheel carriage, from its dimensionless numbers."""

    def __init__(self, sigma=0.5, rho=0.4, small=0.6, big=3.0, c=0.8):
        self.sigma, self.rho, self.small, self.big, self.c = sigma, rho, small, big, c
        self.square = rho**2 + 2.0 * sigma**2
        radius, mass, offset = 0.05, 10.0, 0.4
        unit = mass * radius**2
        places = [(big * sigma, 0.0, 0.0), (-big * sigma, 0.0, np.pi), (0.0, offset + big * rho, np.pi / 2)]
        self.vehicle = CORE.vehicle({
            "mass_kg": mass, "yaw_inertia_kgm2": big**2 * unit, "com_y_m": offset * radius, "wheel_radius_m": radius,
            "wheel_inertia_kgm2": small**2 * unit, "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": c * unit,
            "wheel": [{"kind": "omni", "x_m": x * radius, "y_m": y * radius, "axle_rad": a} for x, y, a in places]})
        self.model, self.rows = CORE.prepare(self.vehicle), CORE.matrices(self.vehicle).wheel_rows
        self.threshold = 2.0 * c * big * sigma**2 / rho

    def voltages(self, nu_1, nu_2):
        """U = (c2/c1) Ξ ν⁰."""
        drive = self.c * 10.0 * 0.05**2 / 0.5 * (self.rows @ [nu_1, nu_2, 0.0])
        return {f"voltage_V[{i + 1}]": float(u) for i, u in enumerate(drive)}

    def field(self, nu_1, nu_2) -> Field:
        return field_of(CORE, self.model, self.voltages(nu_1, nu_2))

    def turning(self, nu_1, nu_3):
        """ν of the turning motion with this ν3, and the ν2⁰ that it belongs to, by section 5's formulas, mended."""
        nu = np.array([nu_1 + self.square * nu_3 / self.rho, self.threshold, nu_3])
        command = self.threshold + nu_3 * (self.rho * nu_1 + self.square * nu_3) / (2.0 * self.c * self.big * self.rho)
        return nu, command

    def vertex(self, nu_1):
        nu_3 = -self.rho * nu_1 / (2.0 * self.square)
        return nu_3, self.threshold - self.rho * nu_1**2 / (8.0 * self.c * self.big * self.square)

    def polynomial(self, nu_1, nu_3):
        """a3, a2, a1, a0."""
        lam2, rho2, sig2, c, big = self.small**2, self.rho**2, self.sigma**2, self.c, self.big
        pull = self.rho * nu_1 + 2.0 * nu_3 * self.square
        return [
            (1 + 2 * lam2) * (1 + lam2 * (1 + rho2 + 2 * sig2) + 2 * lam2**2 * sig2),
            c * (3 + rho2 + 2 * sig2 + lam2 * (4 + 4 * rho2 + 10 * sig2) + 8 * lam2**2 * sig2),
            2 * c**2 * (1 + rho2 + 2 * sig2 + 2 * lam2 * sig2) + (nu_3**2 + lam2 * nu_3 * pull) / big**2,
            c * nu_3 * pull / big**2]


PAPER = Example()
HEAVY_MIDDLE = Example(sigma=1.0, rho=2.0, small=0.1, big=2.0)  # ρ² + 2σ² > 3: loses stability when turning fast


@pytest.mark.parametrize("nu_1", NU_1)
@pytest.mark.parametrize("nu_2", [-4.0, 2.0, 12.0])
def test_voltages_for_straight_motion_keep_it_and_wheels_1_and_2_turn_oppositely(nu_1, nu_2):
    nu = [nu_1, nu_2, 0.0]
    assert np.abs(nu_rates(CORE, PAPER.model, nu, 0.0, CORE.input(PAPER.voltages(nu_1, nu_2)))).max() < 1e-14
    speeds = PAPER.rows @ nu
    assert speeds[0] == pytest.approx(-speeds[1], abs=1e-14)


@pytest.mark.parametrize("nu_1", NU_1)
@pytest.mark.parametrize("example", [PAPER, HEAVY_MIDDLE, Example(rho=1.3, c=0.1, big=0.7)])
def test_erratum_3_straight_motion_is_stable_exactly_below_2_c_lambda_sigma_squared_over_rho(example, nu_1):
    for factor, stability in ((-3.0, "stable"), (0.999, "stable"), (1.001, "unstable"), (4.0, "unstable")):
        motions = steady_motions(example.field(nu_1, factor * example.threshold))
        straight = [motion for motion in motions if not motion.is_turning]
        assert [motion.stability for motion in straight] == [stability]


def test_erratum_3_the_printed_threshold_without_c_is_wrong_in_si_units():
    printed = 2.0 * PAPER.big * PAPER.sigma**2 / PAPER.rho
    between = 0.5 * (printed + PAPER.threshold)
    straight = [m for m in steady_motions(PAPER.field(0.0, between)) if not m.is_turning]
    assert PAPER.threshold < between < printed
    assert straight[0].stability == "unstable"  # the printed formula would call it stable


@pytest.mark.parametrize("nu_1", NU_1)
@pytest.mark.parametrize("nu_3", [-6.0, -0.7, 0.4, 5.0])
def test_turning_motions_are_the_parabola_of_the_formulas(nu_1, nu_3):
    nu, command = PAPER.turning(nu_1, nu_3)
    held = CORE.input(PAPER.voltages(nu_1, command))
    assert np.abs(nu_rates(CORE, PAPER.model, nu, 0.0, held)).max() < 1e-13 * max(1.0, np.abs(nu).max() ** 2)
    found = [motion.nu for motion in steady_motions(PAPER.field(nu_1, command))]
    assert min(np.abs(other - nu).max() for other in found) < 1e-9
    assert len(found) <= 3


@pytest.mark.parametrize("nu_1", NU_1)
@pytest.mark.parametrize("nu_3", [-6.0, -0.7, 0.4, 5.0])
@pytest.mark.parametrize("example", [PAPER, HEAVY_MIDDLE])
def test_characteristic_polynomial_is_the_printed_one(example, nu_1, nu_3):
    nu, command = example.turning(nu_1, nu_3)
    field = example.field(nu_1, command)
    found = np.poly(field.jacobian(field.zeta(nu)))
    expected = np.array(example.polynomial(nu_1, nu_3))
    assert found == pytest.approx(expected / expected[0], rel=1e-9, abs=1e-10)


@pytest.mark.parametrize("nu_1", NU_1)
@pytest.mark.parametrize("example", [PAPER, HEAVY_MIDDLE])
def test_turning_motion_is_stable_exactly_when_a0_is_positive_and_a1_a2_exceeds_a0_a3(example, nu_1):
    seen = set()
    for nu_3 in np.concatenate([np.linspace(-20.0, -0.05, 40), np.linspace(0.05, 20.0, 40)]):
        a3, a2, a1, a0 = example.polynomial(nu_1, nu_3)
        nu, command = example.turning(nu_1, nu_3)
        motions = steady_motions(example.field(nu_1, command))
        motion = min(motions, key=lambda m, nu=nu: np.abs(m.nu - nu).max())
        assert (motion.stability == "stable") == (a0 > 0.0 and a1 * a2 > a0 * a3)
        seen.add(motion.stability)
    assert seen == ({"stable"} if example is PAPER and nu_1 == 0.0 else {"stable", "unstable"})


@cache
def diagram_about_the_vertex(nu_1):
    _, command = PAPER.vertex(nu_1)
    return diagram(lambda value: PAPER.field(nu_1, value), command - 3.0, command + 12.0)


@pytest.mark.parametrize("nu_1", NU_1)
def test_erratum_4_vertex_of_the_parabola_has_the_factor_one_eighth_and_is_nu_3(nu_1):
    nu_3, command = PAPER.vertex(nu_1)
    found = diagram_about_the_vertex(nu_1)
    folds = [special for special in found.specials if special.kind == "fold"]
    assert len(folds) == 1
    assert folds[0].parameter == pytest.approx(command, abs=1e-10)
    assert folds[0].nu[2] == pytest.approx(nu_3, abs=1e-8)
    if nu_1:
        printed = PAPER.threshold - PAPER.rho * nu_1**2 / (PAPER.c * PAPER.big * PAPER.square)
        assert abs(printed - folds[0].parameter) > 0.5
        assert abs(nu_3 - folds[0].nu[2] / PAPER.big) > 0.1  # taken as θ', it would be wrong by Λ


@pytest.mark.parametrize("nu_1", NU_1)
def test_branches_of_turning_motions_open_to_the_right_and_cross_straight_motion_at_the_threshold(nu_1):
    _, vertex = PAPER.vertex(nu_1)
    found = diagram_about_the_vertex(nu_1)
    straight, turning = found.branches
    assert np.abs(straight.nu()[:, 2]).max() < 1e-9
    assert min(turning.parameter) == pytest.approx(vertex, abs=1e-2)
    ends = turning.parameter[0], turning.parameter[-1]
    assert min(ends) > vertex + 11.0
    assert turning.nu()[0, 2] * turning.nu()[-1, 2] < 0.0
    crossing = [special for special in found.specials if special.kind == "branch point"]
    assert [special.parameter for special in crossing] == pytest.approx([PAPER.threshold], abs=1e-9)


def test_thresholds_of_straight_motion_are_found_without_a_diagram():
    subject = subject_of(read_scene("paper_three_wheel_driven"))
    parameter = command_parameter(subject, "nu2", np.array([3.0, 12.0, 0.0]))
    assert straight_thresholds(parameter) == pytest.approx([PAPER.threshold], abs=1e-9)
    low, high = default_range(parameter)
    assert low < PAPER.vertex(3.0)[1] < PAPER.threshold < 12.0 < high


# ---- all steady motions, any vehicle


def random_field(seed) -> tuple[Field, object, dict]:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 6))
    vehicle = CORE.vehicle({
        "mass_kg": 8.0, "yaw_inertia_kgm2": 0.3, "com_x_m": 0.02, "com_y_m": 0.03, "wheel_radius_m": 0.05,
        "wheel_inertia_kgm2": 0.004, "motor_gain_Nm_per_V": 0.3, "motor_damping_Nms": 0.02,
        "wheel": [{"kind": "roller", "x_m": rng.normal(0, 0.2), "y_m": rng.normal(0, 0.2),
                   "axle_rad": rng.uniform(-3, 3), "roller_rad": rng.uniform(0.4, 1.5)} for _ in range(count)]})
    inputs = {f"voltage_V[{i + 1}]": float(u) for i, u in enumerate(rng.normal(0.0, 8.0, count))}
    model = CORE.prepare(vehicle)
    return field_of(CORE, model, inputs), model, inputs


@pytest.mark.parametrize("seed", range(10))
def test_vector_field_is_the_cores_derivative(seed):
    field, model, inputs = random_field(seed)
    for zeta in np.random.default_rng(seed).normal(0.0, 4.0, (20, 3)):
        rate = nu_rates(CORE, model, field.nu(zeta), 0.3, CORE.input(inputs))
        assert np.abs(field.nu(field.rates(zeta)) - rate).max() < 1e-12 * max(1.0, np.abs(rate).max())


@pytest.mark.parametrize("seed", range(10))
def test_jacobian_is_the_derivative_of_the_field(seed):
    field, _, _ = random_field(seed)
    zeta, step = np.random.default_rng(seed).normal(0.0, 3.0, 3), 1e-6
    columns = [(field.rates(zeta + step * e) - field.rates(zeta - step * e)) / (2 * step) for e in np.eye(3)]
    assert np.column_stack(columns) == pytest.approx(field.jacobian(zeta), abs=1e-6)


@pytest.mark.parametrize("seed", range(10))
def test_the_polynomial_is_that_of_its_determinants(seed):
    field, _, _ = random_field(seed)
    for yaw_rate in np.random.default_rng(seed).normal(0.0, 3.0, 5):
        matrix = -field.linear_matrix - yaw_rate * field.cross_matrix
        det = np.linalg.det(matrix)
        expected = yaw_rate * det - det * field.yaw_row @ np.linalg.solve(matrix, field.forcing)
        assert np.polynomial.polynomial.polyval(yaw_rate, steady_polynomial(field)) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_no_steady_motion_is_missed_by_the_polynomial(seed):
    """Newton from 200 random states finds nothing that is not in the list."""
    from scipy.optimize import root

    field, _, _ = random_field(seed)
    listed = [motion.zeta for motion in steady_motions(field)]
    assert 1 <= len(listed) <= 3
    assert all(np.abs(field.rates(zeta)).max() < 1e-9 * max(1.0, np.abs(zeta).max() ** 2) for zeta in listed)
    size = 3.0 * max(np.abs(zeta).max() for zeta in listed)
    for start in np.random.default_rng(seed).uniform(-size, size, (200, 3)):
        found = root(field.rates, start, jac=field.jacobian, tol=1e-12)
        if found.success and np.abs(field.rates(found.x)).max() < 1e-8:
            assert min(np.abs(found.x - zeta).max() for zeta in listed) < 1e-4 * size


@pytest.mark.parametrize("seed", range(10))
def test_fixed_point_of_the_damped_vehicle_is_the_least_squares_motion_when_it_does_not_turn(seed):
    """Ξν⁰ = (c1/c2) U in the least-squares sense is steady when ν3 = 0 (or ν1 = ν2 = 0), and only then."""
    rng = np.random.default_rng(seed)
    field, model, _ = random_field(seed)
    rows = CORE.numbers(model.wheel_of_zeta, -1, 3)[: model.wheel_count] @ np.linalg.inv(field.nu_of_zeta)
    for nu, stays in (((*rng.normal(size=2), 0.0), True), ((0.0, 0.0, rng.normal()), True),
                      ((*rng.normal(size=2), 1.0), False)):
        voltage = 0.02 / 0.3 * (rows @ nu) + _unseen(rows, rng)
        rate = nu_rates(CORE, model, nu, 0.0, CORE.input({"voltage_V": voltage}, len(voltage)))
        assert (np.abs(rate).max() < 1e-11) == stays


def _unseen(rows, rng):
    """Voltages that no motion answers to: across the range of Ξ."""
    across = np.linalg.svd(rows)[0][:, 3:]
    return across @ rng.normal(size=across.shape[1])


def test_free_vehicle_has_a_plane_of_straight_motions_and_no_isolated_ones():
    field = subject_of(read_scene("paper_three_wheel_free")).field()
    assert steady_motions(field) == []
    shapes = sorted(len(family.directions) for family in families(field))
    assert shapes == [1, 2]


def test_direction_without_damping_makes_a_line_of_steady_motions():
    """Two wheels on one axle line leave ν1 undamped: any ν1 goes on for ever."""
    vehicle = CORE.vehicle({
        "mass_kg": 8.0, "yaw_inertia_kgm2": 0.3, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 0.004,
        "motor_gain_Nm_per_V": 0.3, "motor_damping_Nms": 0.02,
        "wheel": [{"kind": "omni", "x_m": s * 0.2, "axle_rad": (1 - s) * np.pi / 2} for s in (1, -1)]})
    field = field_of(CORE, CORE.prepare(vehicle), {"voltage_V": [2.0, -2.0]})
    found = families(field)
    assert len(found) == 1
    direction = np.abs(found[0].directions[0])
    assert direction / direction.max() == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    assert found[0].nu[1] == pytest.approx(30.0, rel=1e-9)


def test_eigenvalues_are_confirmed_by_the_core_for_every_steady_motion():
    subject = subject_of(read_scene("paper_three_wheel_driven"))
    field = subject.field()
    motions = steady_motions(field)
    assert [motion.stability for motion in motions] == ["stable", "unstable", "stable"]
    for motion in motions:
        assert confirm.steady_motion(subject, subject.inputs, field, motion).holds


def test_confirmation_fails_for_a_wrong_eigenvalue():
    subject = subject_of(read_scene("paper_three_wheel_driven"))
    field = subject.field()
    slower = Field(field.dof, field.nu_of_zeta, field.gyro, 0.8 * field.decay_per_s, field.forcing, field.lambda_yaw)
    assert not confirm.steady_motion(subject, subject.inputs, slower, steady_motions(field)[0]).holds


# ---- Andronov–Hopf


@pytest.fixture(scope="module")
def hopf_scene():
    subject = subject_of(read_scene("paper_three_wheel_hopf"))
    parameter = command_parameter(subject, "nu2", commanded_straight(subject))
    return subject, parameter, diagram(parameter.field_of, 80.0, 140.0, grid=9)


def test_turning_motion_loses_stability_where_a1_a2_equals_a0_a3(hopf_scene):
    _, _, found = hopf_scene
    assert len(found.hopf) == 2
    for point in found.hopf:
        a3, a2, a1, a0 = HEAVY_MIDDLE.polynomial(0.0, point.nu[2])
        assert a0 > 0.0
        assert a1 * a2 == pytest.approx(a0 * a3, rel=1e-9)
        assert point.frequency_rad_per_s == pytest.approx(np.sqrt(a1 / a3), rel=1e-9)
        assert point.parameter == pytest.approx(HEAVY_MIDDLE.turning(0.0, point.nu[2])[1], rel=1e-9)


def test_first_lyapunov_coefficient_is_that_of_a_subcritical_point(hopf_scene):
    _, _, found = hopf_scene
    assert all(point.lyapunov > 0.0 and point.kind == "subcritical" for point in found.hopf)


def test_first_lyapunov_coefficient_of_a_system_with_a_known_one():
    """x' = −y + x z, y' = x + y z, z' = −z − (x² + y²)… : z ≈ −r² slaved with a delay; l1 by hand on the plane.

    With B from f = A u + q(u, u): r' = r z, z' = −z + s r². Near the origin z = s r² + …, so r' = s r³:
    in z = x + iy with |q| = 1, q = (1, −i, 0)/√2, r² = 2|amplitude|², l1 = s · 2 / Ω with Ω = 1 (sign of s).
    """
    for s in (1.0, -1.0):
        matrix = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])

        class Known:
            def jacobian(self, zeta):
                return matrix  # noqa: B023

            def quadratic(self, u, v):
                return 0.5 * np.array([u[0] * v[2] + u[2] * v[0], u[1] * v[2] + u[2] * v[1],
                                       2.0 * s * (u[0] * v[0] + u[1] * v[1])])  # noqa: B023

        value, frequency = first_lyapunov(Known(), np.zeros(3))
        assert frequency == pytest.approx(1.0)
        assert value == pytest.approx(2.0 * s, rel=1e-9)


@pytest.fixture(scope="module")
def cycle(hopf_scene):
    _, parameter, found = hopf_scene
    point = max(found.hopf, key=lambda p: p.nu[2])
    value = 0.95 * point.parameter
    field = parameter.field_of(value)
    centre = max(steady_motions(field), key=lambda m: m.nu[2])
    return field, centre, value, cycle_near(field, centre.zeta, value, point.lyapunov)


def test_limit_cycle_exists_below_the_hopf_point_around_the_still_stable_motion(cycle):
    _, centre, _, found = cycle
    assert centre.stability == "stable"
    assert found is not None
    assert found.residual < 1e-7


def test_limit_cycle_is_unstable_by_its_multipliers(cycle):
    _, _, _, found = cycle
    sizes = np.sort(np.abs(found.multipliers))
    assert not found.stable
    assert np.abs(found.multipliers - 1.0).min() < 1e-6      # along the motion
    assert sizes[0] < 0.5 < 1.001 < sizes[-1]                # one way in, one way out


def test_no_cycle_on_the_other_side_of_the_hopf_point(hopf_scene):
    _, parameter, found = hopf_scene
    point = max(found.hopf, key=lambda p: p.nu[2])
    field = parameter.field_of(1.02 * point.parameter)
    centre = max(steady_motions(field), key=lambda m: m.nu[2])
    assert centre.stability == "unstable"
    assert cycle_near(field, centre.zeta, 0.0, point.lyapunov) is None


def test_cycle_separates_motions_that_return_from_those_that_leave_in_the_core(hopf_scene, cycle):
    subject, parameter, _ = hopf_scene
    field, centre, value, found = cycle
    inputs = parameter.inputs_of(value)
    step_s = found.period_s / 600
    for share, returns in ((0.5, True), (0.97, True), (1.03, False), (1.3, False)):
        distance = confirm.distance_after(subject, inputs, field, found, centre.zeta, share, step_s)
        assert (distance < 0.3) if returns else (distance > 2.0)
    assert confirm.limit_cycle(subject, inputs, field, found, centre.zeta).holds


# ---- the caster


def test_caster_theta_pi_is_stable_and_theta_0_is_not():
    """Section 3: the wheel's centre follows the point that is pushed."""
    found = steady.headings(subject_of(read_scene("paper_caster")))
    assert [heading.heading_rad for heading in found] == pytest.approx([0.0, np.pi], abs=1e-12)
    assert [heading.stable for heading in found] == [False, True]
    rate = 0.15 * 1.0 / 0.2  # D F / J1
    assert [heading.rate_squared_per_s2 for heading in found] == pytest.approx([rate, -rate], rel=1e-12)


@pytest.mark.parametrize(("heading", "stays"), [(np.pi, True), (0.0, False)])
def test_caster_simulated_from_near_a_heading_stays_or_leaves(heading, stays):
    subject = subject_of(read_scene("paper_caster"))
    plant = CORE.plant(subject.vehicle, EXPLICIT, 0.002, nu_rad_per_s=[0.0, 0.0, 0.0], heading_rad=heading + 0.01)
    held, furthest = CORE.input(subject.inputs), 0.0
    for _ in range(200):
        plant.run(held, 25)
        furthest = max(furthest, abs(plant.pose.heading_rad - heading))
    assert (furthest < 0.011) == stays
    assert stays or furthest > 1.0
