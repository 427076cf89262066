"""Optima that are known in closed form, derived here: the optimiser finds them to 1e-6 of their size."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.scene.scene_tables import SceneTables, scene_tables
from laconic.simulation import simulate
from laconic.tools.measures import measure_named
from laconic.tools.measures.arguments import split, with_arguments
from laconic.tools.measures.measure import Measure
from laconic.tools.optimise.candidates import Candidates
from laconic.tools.optimise.gradient import RunGradient
from laconic.tools.optimise.measuring import problem_of
from laconic.tools.optimise.problem import read_constraint, read_free, read_goal
from laconic.tools.optimise.search import Effort
from laconic.tools.optimise.study import optimise

CLOSE = 1e-6
USUAL = Effort()
CARRIAGE = "paper_three_wheel_driven"
SIGMA_M, MASS_KG, RADIUS_M, INERTIA_KGM2, DAMPING_NMS, WHEEL_KGM2 = 0.075, 10.0, 0.05, 0.225, 0.02, 0.009
ALONG_ETA = "straight_stable_speed_m_per_s(direction_deg=90)"


def solved(scene, free, goals, constraints=(), seed=1, effort=USUAL, **more):
    problem, own, _ = problem_of(scene_tables(scene), [read_free(each) for each in free],
                                 [read_goal(each) for each in goals], [read_constraint(each) for each in constraints])
    return optimise(problem, own, effort, seed, **more)


def threshold_m_per_s(third_m: float, com_m: float) -> float:
    """R · 2cΛσ²/ρ with c = c2/(MR²), Λσ R = SIGMA_M and Λρ R = third − com: every R and Λ but one cancels."""
    return 2.0 * DAMPING_NMS * SIGMA_M**2 / (MASS_KG * RADIUS_M**2 * (third_m - com_m))


def test_condition_number_1_of_three_omni_wheels_at_120_degrees():
    """Ξ in metres per second has the singular values √(3/2), √(3/2), √3 d/ℓ: equal at d = ℓ/√2."""
    found = solved("robotino2", ["vehicle.wheel[*].distance_m=0.05:0.4"], ["min:condition(length_m=0.2)"])
    assert found.best.values[0] == pytest.approx(1.0, rel=CLOSE)
    assert found.best.choice[0] == pytest.approx(0.2 / np.sqrt(2.0), rel=CLOSE)


def test_condition_number_1_by_the_angles_of_axles_and_the_place_of_a_wheel():
    """Two wheels stay; with the third where symmetry has it the condition is 1, and nowhere can it be less."""
    free = ["vehicle.wheel[1].axle_deg=20:100", "vehicle.wheel[1].distance_m=0.05:0.3"]
    found = solved("robotino2", free, [f"min:condition(length_m={0.125 * 2.0**0.5!r})"])
    assert found.best.values[0] == pytest.approx(1.0, rel=CLOSE)
    assert found.best.choice == pytest.approx([60.0, 0.125], rel=CLOSE)


def test_yaw_authority_is_largest_with_every_axle_through_the_middle():
    """Turning about the middle moves a rim by cos(angle between axle and arm) at most; the body may only drift to move
    rims less. So the root mean square is 1 at most, which the axle at the wheel's bearing, 60°, attains by symmetry."""
    found = solved("robotino2", ["vehicle.wheel[1].axle_deg=-80:100"], ["max:yaw_authority"])
    assert found.best.values[0] == pytest.approx(1.0, rel=CLOSE)
    assert found.best.choice[0] == pytest.approx(60.0, abs=1e-3)  # flat at its top: half the digits


def yaw_acceleration(third_m: float, com_m: float) -> float:
    """Largest yaw acceleration per volt of the paper's carriage from its own matrices, Ξ and A = E + λ²ΞᵀΞ (§5)."""
    big = np.sqrt(INERTIA_KGM2 / (MASS_KG * RADIUS_M**2))
    sigma, rho = SIGMA_M / (big * RADIUS_M), (third_m - com_m) / (big * RADIUS_M)
    rows = np.array([[0.0, 1.0, sigma], [0.0, -1.0, sigma], [-1.0, 0.0, rho]])
    inertia = np.eye(3) + WHEEL_KGM2 / (MASS_KG * RADIUS_M**2) * rows.T @ rows
    per_volt = np.linalg.solve(inertia, rows.T) * 0.5 / (MASS_KG * RADIUS_M**2)
    return float(np.abs(per_volt[2] / big).sum())


def test_papers_threshold_as_a_constraint_is_active_at_the_optimum_and_gives_the_closed_form():
    """As far from the third wheel as the threshold lets it: ρ = 2cΛσ²/ν, here third − com = 2 c2 σ²/(M R² v)."""
    limit = 0.3
    found = solved(CARRIAGE, ["vehicle.wheel[3].distance_m=0.05:0.2", "vehicle.com_y_m=0:0.1"],
                   ["max:yaw_acceleration_rad_per_s2_per_V"], [f"{ALONG_ETA}>={limit}", "least_load_share>=0.1"])
    gap = 2.0 * DAMPING_NMS * SIGMA_M**2 / (MASS_KG * RADIUS_M**2 * limit)
    assert threshold_m_per_s(gap, 0.0) == pytest.approx(limit)
    third, com = found.best.choice
    assert third - com == pytest.approx(gap, rel=CLOSE)
    assert found.best.values[1] == pytest.approx(limit, rel=CLOSE)
    assert found.active_constraints == [f"{ALONG_ETA}>={limit}"]
    assert found.best.values[0] == pytest.approx(yaw_acceleration(third, com), rel=1e-9)
    near = [yaw_acceleration(share * gap, 0.0) for share in (1.0, 0.99, 0.9)]
    assert near == sorted(near, reverse=True)  # a longer arm accelerates more, so that the threshold is what stops it


def test_third_wheel_at_a_vertex_of_two_bounds():
    """Largest threshold with the load bound: com/third ≤ 1 − 2 s on the front wheels, so third as near as it may be."""
    found = solved(CARRIAGE, ["vehicle.wheel[3].distance_m=0.06:0.2", "vehicle.com_y_m=0:0.1"], [f"max:{ALONG_ETA}"],
                   ["least_load_share>=0.1"])
    assert found.best.choice == pytest.approx([0.06, 0.8 * 0.06], rel=CLOSE)
    assert found.best.values[0] == pytest.approx(threshold_m_per_s(0.06, 0.048), rel=CLOSE)
    assert found.active_constraints == ["least_load_share>=0.1"]
    assert found.at_ends == ["vehicle.wheel[3].distance_m is at its lower end"]


def test_front_of_threshold_and_load_is_the_closed_curve():
    """At third = 0.06 m the load s = (1 − com/third)/2 gives third − com = 2 s third: threshold · s is constant."""
    found = solved(CARRIAGE, ["vehicle.wheel[3].distance_m=0.06:0.2", "vehicle.com_y_m=0:0.1"],
                   [f"max:{ALONG_ETA}", "max:least_load_share"], ["least_load_share>=0.1"],
                   effort=Effort(generations=60), points=2)
    product = threshold_m_per_s(0.06, 0.0) / 2.0
    assert len(found.front) == 4
    for point in found.front:
        assert point.values[0] * point.values[1] == pytest.approx(product, rel=1e-3)
    speeds = [point.values[0] for point in found.front]
    loads = [point.values[1] for point in found.front]
    assert speeds == sorted(speeds, reverse=True) and loads == sorted(loads)
    assert speeds[0] == pytest.approx(product / 0.1, rel=CLOSE)
    assert loads[-1] == pytest.approx(1.0 / 3.0, rel=CLOSE)


def test_same_seed_gives_the_same_result_bit_for_bit():
    free, goals = ["vehicle.com_y_m=0:0.07"], [f"max:{ALONG_ETA}"]
    one, other = (solved(CARRIAGE, free, goals, ["least_load_share>=0.1"], seed=3) for _ in range(2))
    assert one.best.choice.tobytes() == other.best.choice.tobytes()
    assert one.measured == other.measured


# ---- Gradients of a run's end by the core's derivatives of each step, beside differences of whole runs.

ENDS = ("end_x_m", "end_y_m", "end_heading_rad", "end_distance_m(x_m=0.3, y_m=-0.2)")
PLACE = ("x_m", "y_m", "heading_rad")


def coarse(name: str) -> SceneTables:
    return scene_tables(name).with_values({"run.step_s": 0.02, "outputs.every_s": 0.1})


def measure(text: str) -> Measure:
    name, given = split(text)
    return with_arguments(measure_named(name, "run"), given)


def end_of(scene) -> np.ndarray:
    run = simulate(scene, PLACE)
    return np.array([run.columns[name][-1] for name in PLACE])


CASES = [("robotino2", ("vehicle.mass_kg=10:14", "vehicle.wheel[1].distance_m=0.1:0.2", "vehicle.com_x_m=0:0.02",
                             "vehicle.wheel[2].axle_deg=170:190", "vehicle.wheel_radius_m=0.03:0.05",
                             "input[1].value[1]=1:4")),
         ("paper_differential_drive", ("vehicle.com_y_m=0.01:0.05", "vehicle.yaw_inertia_kgm2=0.2:0.4",
                                            "vehicle.wheel[1].distance_m,vehicle.wheel[2].distance_m=0.1:0.2")),
         ("paper_three_wheel_driven", ("vehicle.wheel[3].distance_m=0.05:0.1", "initial.nu_rad_per_s[3]=0:0.1"))]


@pytest.mark.parametrize(("name", "given"), CASES, ids=[name for name, *_ in CASES])
def test_gradient_of_an_end_is_that_of_differences_of_runs(name, given):
    free = [read_free(text) for text in given]
    candidates = Candidates(coarse(name), free)
    choice = np.array([0.4 * each.low + 0.6 * each.high for each in free])
    exact = RunGradient(candidates, [measure(end) for end in ENDS]).jacobian(choice)
    for number, each in enumerate(free):
        step = 1e-4 * (each.high - each.low)
        ends = []
        for times in (-2, -1, 1, 2):
            beside = choice.copy()
            beside[number] += times * step
            end = end_of(candidates.scene(beside))
            ends.append([*end, np.hypot(end[0] - 0.3, end[1] + 0.2)])
        differences = np.array([1.0, -8.0, 8.0, -1.0]) @ np.array(ends) / (12.0 * step)
        assert exact[:, number] == pytest.approx(differences, rel=2e-7, abs=2e-7 * np.abs(differences).max())


def test_what_has_no_exact_gradient_says_so_by_nan():
    free = [read_free("vehicle.mass_kg=10:14")]
    candidates = Candidates(coarse("robotino2"), free)
    found = RunGradient(candidates, [measure(name) for name in ("distance_m", "end_x_m")]).jacobian(np.array([12.0]))
    assert np.isnan(found[0]).all() and np.isfinite(found[1]).all()
    stepped = Candidates(coarse("robotino2"), [read_free("run.step_s=0.01:0.02"), *free])
    found = RunGradient(stepped, [measure("end_x_m")]).jacobian(np.array([0.02, 12.0]))
    assert np.isnan(found).tolist() == [[True, False]]
    slipping = Candidates(scene_tables("robotino_grey"), free)
    found = RunGradient(slipping, [measure("end_x_m")]).jacobian(np.array([12.0]))
    assert np.isnan(found).all()
