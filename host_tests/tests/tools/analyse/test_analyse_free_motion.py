"""Free motion (section 5): integrals, invariant measure, closed form, ellipses, and what straight motion does."""

import json
from pathlib import Path

import numpy as np
import pytest

from laconic.core import load
from laconic.scene.methods import EXACT, EXACT_4, EXPLICIT
from laconic.tools.analyse.field import Field
from laconic.tools.analyse.free_motion import S2, FreeMotion, yaw_by_integral
from laconic.tools.analyse.from_core import field_of, nu_rates

REFERENCE = json.loads((Path(__file__).parents[2] / "data" / "free_motion.json").read_text())["cases"]
CORE = load("double")


def wheel(x_m, y_m, axle, gamma=np.pi / 2, kind="roller", **more):
    return {"kind": kind, "x_m": x_m, "y_m": y_m, "axle_rad": axle, "roller_rad": gamma, **more}


def vehicle_of(wheels, **more):
    return CORE.vehicle({"mass_kg": 9.0, "yaw_inertia_kgm2": 0.2, "com_x_m": 0.01, "com_y_m": 0.025,
                         "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 0.01, "wheel": wheels, **more})


def random_vehicle(seed):
    rng = np.random.default_rng(seed)
    places = rng.normal(0.0, 0.2, (rng.integers(3, 8), 2))
    return vehicle_of([wheel(x, y, rng.uniform(-3, 3), rng.uniform(0.3, 1.5)) for x, y in places])


def three_wheels(offset_m=0.02, **more):
    """Section 5: Λ = 3, λ = 0.6, σ = 0.5, ρ = 0.4 for the default offset."""
    return CORE.vehicle({
        "mass_kg": 10.0, "yaw_inertia_kgm2": 0.225, "com_y_m": offset_m, "wheel_radius_m": 0.05,
        "wheel_inertia_kgm2": 0.009, **more,
        "wheel": [wheel(0.075, 0.0, 0.0), wheel(-0.075, 0.0, np.pi), wheel(0.0, 0.08, np.pi / 2)]})


def reference_vehicle(case):
    v = case["vehicle"]
    return CORE.vehicle({
        "mass_kg": v["M"], "yaw_inertia_kgm2": v["I_S"], "com_y_m": v["offset"], "wheel_radius_m": v["R"],
        "wheel_inertia_kgm2": v["J"],
        "wheel": [wheel(w["delta"] * np.cos(w["alpha"]), w["delta"] * np.sin(w["alpha"]), w["beta"], w["gamma"])
                  for w in v["wheels"]]})


def free_motion(vehicle, nu) -> FreeMotion:
    found = CORE.matrices(vehicle)
    return FreeMotion(np.asarray(nu, dtype=float), found.inverse_inertia, found.lambda_yaw)


def free_field(vehicle) -> Field:
    return field_of(CORE, CORE.prepare(vehicle), {})


@pytest.mark.parametrize("seed", range(6))
def test_energy_and_yaw_integral_do_not_change_along_the_equations(seed):
    vehicle, rng = random_vehicle(seed), np.random.default_rng(seed)
    model, inertia = CORE.prepare(vehicle), CORE.matrices(vehicle).inertia
    for nu in rng.normal(0.0, 4.0, (20, 3)):
        rate = nu_rates(CORE, model, nu, 0.0, CORE.input())
        size = np.abs(inertia).max() * np.abs(nu).max() * max(1.0, np.abs(rate).max())
        assert abs(nu @ inertia @ rate) < 1e-13 * size * np.abs(nu).max()
        assert abs(inertia[2] @ rate) < 1e-13 * size


@pytest.mark.parametrize("seed", range(4))
def test_invariant_measure_has_density_one_over_nu_3(seed):
    """div f − f·∇ ln|ν3| = 0, so dν1 dν2 dν3/|ν3| is carried along."""
    field, rng = free_field(random_vehicle(seed)), np.random.default_rng(seed)
    for zeta in rng.normal(0.0, 3.0, (20, 3)):
        divergence = np.trace(field.jacobian(zeta))
        logarithmic = field.yaw_row @ field.rates(zeta) / (field.yaw_row @ zeta)
        assert divergence == pytest.approx(logarithmic, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_closed_form_is_the_matrix_formula_with_omega_the_root_of_det_p(seed):
    """Against the matrix exponential of A⁻¹S in the heading, which knows nothing of P, Ω or harmonics."""
    from scipy.linalg import expm

    vehicle, rng = random_vehicle(seed), np.random.default_rng(seed + 50)
    found, nu = CORE.matrices(vehicle), rng.normal(0.0, 3.0, 3)
    motion = free_motion(vehicle, nu)
    turning = np.zeros((3, 3))
    turning[:2, :2] = S2
    assert motion.petal_rate == pytest.approx(np.sqrt(np.linalg.det(found.inverse_inertia[:2, :2])), rel=1e-13)
    for angle in rng.uniform(-8.0, 8.0, 10):
        assert motion.nu_at_angle(angle) == pytest.approx(expm(angle * found.inverse_inertia @ turning) @ nu, abs=1e-11)


@pytest.mark.parametrize("seed", range(6))
def test_closed_form_of_nu_3_is_that_of_the_integral_k(seed):
    vehicle, rng = random_vehicle(seed), np.random.default_rng(seed + 70)
    nu = rng.normal(0.0, 3.0, 3)
    along = free_motion(vehicle, nu).nu_at_angle(np.linspace(-9.0, 9.0, 50))
    assert along[:, 2] == pytest.approx(yaw_by_integral(CORE.matrices(vehicle).inertia, nu, along), abs=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_time_of_the_closed_form_is_lambda_times_the_integral_of_one_over_nu_3(seed):
    from scipy.integrate import quad

    vehicle, rng = random_vehicle(seed), np.random.default_rng(seed + 90)
    motion = free_motion(vehicle, rng.normal(0.0, 3.0, 3))
    for time in rng.uniform(0.1, 3.0, 4):
        angle = float(motion.angle_at(time))
        whole = quad(lambda phi: motion.lambda_yaw / motion.nu_at_angle(phi)[2], 0.0, angle, epsabs=1e-12, limit=200)[0]
        assert whole == pytest.approx(time, rel=1e-9)


@pytest.mark.parametrize("case", REFERENCE, ids=[case["name"] for case in REFERENCE])
def test_closed_form_equals_the_reference_trajectories_to_1e_12(case):
    vehicle = reference_vehicle(case)
    motion = free_motion(vehicle, case["initial"]["nu"])
    times = np.array([state["t"] for state in case["states"]])
    nu = np.array([[float(v) for v in state["nu"]] for state in case["states"]])
    pose = np.array([[float(v) for v in state["pose"]] for state in case["states"]])
    fine = np.linspace(0.0, times[-1], 601)[1:]
    path = motion.path(fine, case["vehicle"]["R"])[np.searchsorted(fine, times - 1e-9)]
    assert np.abs(motion.nu_at(times) - nu).max() < 1e-12
    assert np.abs(motion.angle_at(times) - pose[:, 2]).max() < 1e-12
    assert np.abs(path - pose[:, :2]).max() < 1e-12


@pytest.mark.parametrize("seed", range(8))
def test_closed_form_equals_the_cores_exact_flow_to_1e_12(seed):
    vehicle, rng = random_vehicle(seed), np.random.default_rng(seed + 20)
    nu = rng.normal(0.0, 2.0, 3)
    motion, plant = free_motion(vehicle, nu), CORE.plant(vehicle, EXACT, 0.1, nu_rad_per_s=nu)
    for step in range(1, 101):
        plant.run(CORE.input(), 1)
        assert np.abs(plant.nu - motion.nu_at(0.1 * step)).max() < 1e-12 * max(1.0, np.abs(nu).max())


@pytest.mark.parametrize("seed", range(4))
def test_heading_and_path_of_the_closed_form_are_those_of_the_core_to_1e_11(seed):
    vehicle, rng = random_vehicle(seed), np.random.default_rng(seed + 20)
    nu = rng.normal(0.0, 2.0, 3)
    motion, plant = free_motion(vehicle, nu), CORE.plant(vehicle, EXACT_4, 0.005, nu_rad_per_s=nu)
    plant.run(CORE.input(), 2000)
    path = motion.path(np.linspace(0.0, 10.0, 401)[1:], 0.05)[-1]
    assert plant.pose.heading_rad == pytest.approx(float(motion.angle_at(10.0)), abs=1e-11)
    assert [plant.pose.x_m, plant.pose.y_m] == pytest.approx(list(path), abs=1e-11)


@pytest.mark.parametrize("wheels", [
    [wheel(0.15, 0.0, 0.0, kind="fixed"), wheel(-0.15, 0.0, np.pi, kind="fixed")],
    [wheel(0.1, 0.1, 0.5, kind="fixed"), wheel(-0.1, 0.0, 0.1)],
    [wheel(0.01, 0.3, -np.pi / 2, kind="fixed")],
], ids=["differential drive", "oblique fixed wheel", "axle line through the centre of mass"])
def test_closed_form_holds_with_constraints_too(wheels):
    vehicle = vehicle_of(wheels)
    field = free_field(vehicle)
    nu = field.nu(field.zeta([1.0, 2.0, 1.5]))
    motion, plant = free_motion(vehicle, nu), CORE.plant(vehicle, EXACT, 0.05, nu_rad_per_s=nu)
    for step in range(1, 101):
        plant.run(CORE.input(), 1)
        assert np.abs(plant.nu - motion.nu_at(0.05 * step)).max() < 1e-12


def test_motion_is_periodic_exactly_when_nu_3_never_vanishes_on_its_curve():
    vehicle, rng = three_wheels(), np.random.default_rng(4)
    kinds = set()
    for nu in rng.normal(0.0, 1.0, (60, 3)) * np.array([2.0, 8.0, 1.5]):
        motion = free_motion(vehicle, nu)
        curve = motion.nu_at_angle(np.linspace(0.0, 2.0 * np.pi / motion.petal_rate, 4001))[:, 2]
        vanishes = curve.min() * curve.max() < 0.0
        assert motion.kind == ("asymptotic" if vanishes else "periodic")
        kinds.add(motion.kind)
    assert kinds == {"periodic", "asymptotic"}


def test_periodic_motion_returns_after_its_period_in_the_core():
    motion = free_motion(three_wheels(), [0.3, 1.0, 2.0])
    plant = CORE.plant(three_wheels(), EXPLICIT, motion.period_s / 4000, nu_rad_per_s=[0.3, 1.0, 2.0])
    plant.run(CORE.input(), 4000)
    assert plant.nu == pytest.approx([0.3, 1.0, 2.0], abs=1e-10)
    assert motion.angle_at(motion.period_s) == pytest.approx(2.0 * np.pi / motion.petal_rate, rel=1e-12)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_asymptotic_motion_tends_to_straight_motion_and_never_crosses_nu_3_zero(side):
    motion = free_motion(three_wheels(), [-0.2, 5.0, 0.05 * side])
    assert motion.kind == "asymptotic"
    times = np.linspace(0.0, 400.0, 4000)
    nu = motion.nu_at(times)
    assert (side * nu[:, 2] > -1e-13).all()
    assert nu[-1] == pytest.approx(motion.limit_nu(), abs=1e-9)
    assert abs(motion.limit_nu()[2]) < 1e-9
    assert motion.limit_nu()[1] < 0.0  # the stable side


def test_motion_without_turning_is_straight_for_ever():
    motion = free_motion(three_wheels(), [0.4, -3.0, 0.0])
    plant = CORE.plant(three_wheels(), EXACT, 0.1, nu_rad_per_s=[0.4, -3.0, 0.0])
    plant.run(CORE.input(), 1000)
    assert motion.kind == "straight"
    assert list(plant.nu) == pytest.approx([0.4, -3.0, 0.0], abs=1e-14)
    assert motion.nu_at(100.0) == pytest.approx([0.4, -3.0, 0.0], abs=1e-15)


# ---- the three-wheel example


def test_three_wheel_example_has_the_matrices_of_section_5():
    found = CORE.matrices(three_wheels())
    lam2, sigma, rho = 0.36, 0.5, 0.4
    assert found.wheel_rows == pytest.approx(np.array([[0, 1, sigma], [0, -1, sigma], [-1, 0, rho]]), abs=1e-15)
    a3 = 1.0 + (2 * sigma**2 + rho**2) * lam2
    expected = np.array([[1 + lam2, 0, -rho * lam2], [0, 1 + 2 * lam2, 0], [-rho * lam2, 0, a3]])
    assert found.inertia == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("nu", [(0.0, 1.0), (0.7, -2.0), (-1.0, 0.0)])
def test_line_nu_3_zero_is_all_equilibria(nu):
    rates = nu_rates(CORE, CORE.prepare(three_wheels()), [*nu, 0.0], 0.0, CORE.input())
    assert np.abs(rates).max() < 1e-15


@pytest.mark.parametrize("nu_2", [-3.0, -0.5, 0.5, 3.0])
def test_straight_free_motion_is_stable_for_negative_nu_2_and_unstable_for_positive(nu_2):
    field = free_field(three_wheels())
    values = np.linalg.eigvals(field.jacobian(field.zeta([0.2, nu_2, 0.0])))
    crossing = values.real[np.argmax(np.abs(values.real))]
    assert np.sign(crossing) == np.sign(nu_2)
    plant = CORE.plant(three_wheels(), EXACT, 0.1, nu_rad_per_s=[0.2, nu_2, 1e-3])
    plant.run(CORE.input(), 20)
    assert (plant.nu[2] > 1e-3) == (nu_2 > 0.0)


@pytest.mark.parametrize("nu", [(0.3, 1.0, 2.0), (-0.2, 3.0, 0.05), (0.1, -4.0, -1.0)])
def test_trajectories_lie_on_ellipses_about_k_over_a3(nu):
    """In (ν3, ν2): A2 ν2² + c (ν3 − K/A3)² is constant, c from ν1 = (A3 ν3 − K)/(ρλ²) put into the energy."""
    vehicle = three_wheels()
    inertia = CORE.matrices(vehicle).inertia
    centre = inertia[2] @ nu / inertia[2, 2]
    steep = inertia[2, 2] / -inertia[2, 0]
    weight = inertia[0, 0] * steep**2 + 2.0 * inertia[0, 2] * steep + inertia[2, 2]
    plant, sizes = CORE.plant(vehicle, EXACT, 0.2, nu_rad_per_s=nu), []
    for _ in range(100):
        _, nu_2, nu_3 = plant.nu
        sizes.append(inertia[1, 1] * nu_2**2 + weight * (nu_3 - centre) ** 2)
        plant.run(CORE.input(), 1)
    assert np.ptp(sizes) < 1e-11 * np.mean(sizes)


@pytest.mark.parametrize(("nu", "sense"), [((0.1, 2.0, 1.5), -1.0), ((0.1, 2.0, -1.5), 1.0)])
def test_ellipses_are_run_clockwise_for_positive_nu_3_and_the_other_way_for_negative(nu, sense):
    """In the plane with ν3 to the right and ν2 upward, as in Fig. 4."""
    vehicle = three_wheels()
    inertia = CORE.matrices(vehicle).inertia
    centre = inertia[2] @ nu / inertia[2, 2]
    track = free_motion(vehicle, nu).nu_at(np.linspace(0.0, 3.0, 50))
    arm = track[:-1, 2] - centre, track[:-1, 1]
    step = np.diff(track[:, 2]), np.diff(track[:, 1])
    assert (np.sign(arm[0] * step[1] - arm[1] * step[0]) == sense).all()
