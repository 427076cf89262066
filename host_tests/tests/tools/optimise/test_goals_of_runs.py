"""Goals of a run: measured as `laconic simulate` would, and brought to optima that are known."""

from __future__ import annotations

import json

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.scene.scene_tables import scene_tables
from laconic.simulation import simulate
from laconic.tools.optimise.measuring import Measuring, problem_of
from laconic.tools.optimise.problem import read_constraint, read_free, read_goal
from laconic.tools.optimise.search import Effort
from laconic.tools.optimise.study import optimise


def coarse(name: str):
    return scene_tables(name).with_values({"run.step_s": 0.02, "outputs.every_s": 0.1})


FEW = Effort(generations=80)


def solved(tables, free, goals, constraints=(), effort=FEW):
    problem, own, _ = problem_of(tables, [read_free(each) for each in free], [read_goal(each) for each in goals],
                                 [read_constraint(each) for each in constraints])
    return optimise(problem, own, effort, seed=1)


def test_voltages_that_lead_to_a_place_are_found_again():
    """The place is the end of a run with known voltages; its distance is 0 there alone, and exact gradients lead in."""
    tables = coarse("robotino2")
    known = {"input[1].value[5]": -4.0, "input[2].value[5]": 1.5}
    end = simulate(tables.with_values(known).scene(), ["x_m", "y_m"]).columns
    x, y = float(end["x_m"][-1]), float(end["y_m"][-1])
    found = solved(tables, [f"{key}=-6:6" for key in known], [f"min:end_distance_m(x_m={x!r}, y_m={y!r})"])
    assert found.best.values[0] < 1e-7
    again = simulate(tables.with_values(dict(zip(known, found.best.choice.tolist(), strict=True))).scene(), ["x_m"])
    assert again.columns["x_m"][-1] == pytest.approx(x, abs=1e-6)


def test_place_within_a_circle_that_is_farthest_along_x_is_its_rightmost_point():
    """Two voltages reach every place near the scene's own end; exact gradients of goal and bound meet there."""
    tables = coarse("robotino2")
    own = simulate(tables.scene(), ["x_m", "y_m"]).columns
    x, y = float(own["x_m"][-1]), float(own["y_m"][-1])
    found = solved(tables, ["input[1].value[5]=-6:6", "input[2].value[5]=-3:3"], ["max:end_x_m"],
                   [f"end_distance_m(x_m={x!r}, y_m={y!r})<=0.2"])
    assert found.best.values == pytest.approx([x + 0.2, 0.2], rel=1e-6)
    assert len(found.active_constraints) == 1 and not found.at_ends


def test_gear_with_the_least_energy_for_a_distance_is_that_of_a_fine_grid():
    tables = coarse("kuka_youbot")
    free, goal, bound = "vehicle.motor.gear_ratio=8:64", "min:electrical_energy_J", "distance_m>=3"
    found = solved(tables, [free], [goal], [bound])
    problem, _, _ = problem_of(tables, [read_free(free)], [read_goal(goal)], [read_constraint(bound)])
    gears = np.linspace(8.0, 64.0, 561)
    energy, distance = problem.measured(gears[:, None]).T
    usable = distance >= 3.0
    assert found.active_constraints == [bound]
    assert found.best.values[1] == pytest.approx(3.0, rel=1e-8)
    assert found.best.values[0] <= energy[usable].min()
    assert found.best.choice[0] == pytest.approx(gears[usable][np.argmin(energy[usable])], abs=0.1)


def test_measures_of_runs_and_models_are_one_row_each_as_simulate_has_them():
    tables = coarse("robotino2")
    names = ["min:end_x_m", "min:total_mass_kg", "max:distance_m"]
    problem, own, measuring = problem_of(tables, [read_free("vehicle.mass_kg=5:20")],
                                         [read_goal(each) for each in names], [])
    assert isinstance(measuring, Measuring) and measuring.exact == ["end_x_m"]
    values = problem.measured(np.array([own, [20.0]]))
    run_of = simulate(tables.with_values({"vehicle.mass_kg": 20.0}).scene(), ["x_m", "y_m"])
    assert values[1, 0] == run_of.columns["x_m"][-1]
    assert values[1, 1] == 20.0
    assert values[:, 2].std() > 0.0


def test_report_says_which_gradients_were_exact_and_a_missing_motor_is_named(tmp_path, capsys):
    scene = tmp_path / "short.toml"
    scene.write_text(coarse("robotino2").toml(), encoding="utf-8")
    options = ["--free", "input[1].value[1]=-6:6", "--goal", "max:end_x_m", "--generations", "5"]
    assert run(["optimise", str(scene), *options]) == 0
    assert "exact gradients of end_x_m" in capsys.readouterr().out
    assert run(["optimise", str(scene), *options, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["exact_gradients"] == ["end_x_m"]
    assert run(["optimise", "paper_three_wheel_driven", "--free", "vehicle.com_y_m=0:0.1", "--goal",
                "min:electrical_energy_J"]) == 2
    assert "needs [vehicle.motor]" in capsys.readouterr().err
