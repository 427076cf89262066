"""Gradients of a run's end by the core's derivatives of each step, beside differences of whole runs."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.scene.scene_tables import SceneTables, scene_tables
from laconic.simulation import simulate
from laconic.tools.measures.arguments import split, with_arguments
from laconic.tools.measures.measure import Measure
from laconic.tools.measures.registry import measure_named
from laconic.tools.optimise.candidates import Candidates
from laconic.tools.optimise.gradient import RunGradient
from laconic.tools.optimise.problem import read_free

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
