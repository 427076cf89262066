"""What the report says of the friction step: its order, also through a cut, and what extreme grounds do to it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from friction_scenes import slipping
from laconic.scene import read_scene
from laconic.tools.report import accuracy, friction_accuracy, friction_cost, robot
from laconic.tools.report.targets import friction_targets
from laconic.tools.report.workshop import HOST

pytestmark = pytest.mark.nightly


def test_the_order_through_a_current_limit_and_on_smooth_slip_is_printed_and_is_one(
        capsys: pytest.CaptureFixture[str]) -> None:
    rows = friction_accuracy.order_rows()
    with capsys.disabled():
        print(f"\n  {'friction step on':32s} {'h [s]':>8s} {'error of ν':>10s}  order")
        for row in rows:
            order = "" if row["order"] is None else f"{row['order']:5.2f}"
            print(f"  {row['what']:32s} {row['step_s']:8.5f} {row['error_nu']:10.2e}  {order}")
    orders = [row["order"] for row in rows if row["order"] is not None]
    assert len(orders) == 8 and min(orders) > 0.9 and max(orders) < 1.3


def test_the_current_limit_of_the_order_scene_is_entered_and_left_within_the_run() -> None:
    scene = friction_accuracy.order_scenes()["current limit entered and left"]
    limited = np.array(list(friction_accuracy.limits_met(scene, 0.00125))) == 2
    assert not limited[0].any() and limited.any(axis=0).all() and not limited[-1].any()


def test_extreme_grounds_refuse_no_step_and_lose_no_number() -> None:
    rows = friction_accuracy.extreme_rows()
    assert {row["real"] for row in rows} == {"double", "single"} and all(row["finite"] for row in rows)
    assert sum(row["refused"] for row in rows) == 0


def test_a_scene_with_friction_is_judged_by_a_finer_step_of_its_only_method(tmp_path: Path) -> None:
    scene = slipping(tmp_path).with_run(duration_s=0.5)
    rows = accuracy.rows_of(scene, ("double",), ladder=(0.01, 0.02, 0.05))
    assert {row["method"] for row in rows} == {"auto"} and len(rows) == 3
    errors = [row["error_nu"] for row in sorted(rows, key=lambda row: row["step_s"])]
    assert 0.0 < errors[0] < errors[1] < errors[2] < 1.0
    assert robot.robot_row(scene)["works"] == "the friction step"


def test_the_stability_map_of_a_scene_with_friction_is_the_friction_steps(tmp_path: Path) -> None:
    assert robot.map_rows(slipping(tmp_path), (1.0,)) == []  # its motors have limits
    scene = read_scene("kuka_youbot")
    vehicle = scene.vehicle | {"friction_coefficient": 0.0, "ground": friction_cost.GROUND}
    rows = robot.map_rows(replace(scene, vehicle=vehicle), (0.1, 1e6))
    assert {(row["method"], row["status"]) for row in rows} == {("friction step", "ok")}
    for factor in (0.1, 1e6):
        mine = {row["step_s"]: row for row in rows if row["factor"] == factor}
        assert mine[0.001]["error_nu"] < mine[0.01]["error_nu"] < 0.05
        assert mine[0.001]["reference_error_nu"] < 0.2 * mine[0.001]["error_nu"]
        assert max(row["error_nu"] for row in mine.values()) < 1.0


def test_costs_are_median_99th_percentile_and_worst_in_ideal_steps() -> None:
    row = friction_cost.cost_row(HOST, {"wheels": 3, "run": friction_cost.CALM, "real": "double"},
                                 np.array([598.0] * 99 + [59_800.0]))
    assert (row["median_ideal"], row["worst_ideal"]) == (1.0, 100.0) and row["steps_counted"] == 100
    results = {"friction_cost": [row], "friction_extremes": []}
    verdicts = {each.what.partition(": ")[2]: each.met for each in friction_targets(results)}
    assert verdicts["median of a step [ideal steps]"] is True and verdicts["worst step [ideal steps]"] is False


def test_voltages_of_the_restless_runs_change_every_ten_steps() -> None:
    runs = friction_cost.cost_scenes()
    assert [(kind, scene.wheel_count) for kind, scene in runs] == [
        (kind, wheels) for kind in (friction_cost.CALM, friction_cost.RESTLESS) for wheels in (3, 4, 16)]
    assert {segment.steps for segment in runs[3][1].inputs_on_grid().segments()} == {10}
