"""What `laconic report` measures holds on small samples, and its page opens offline with all its parts."""

from __future__ import annotations

import csv
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from laconic.scene import read_scene
from laconic.scene.methods import EXACT, EXPLICIT, STIFF_8
from laconic.tools.report import accuracy, drift, stability
from laconic.tools.report.collect import PARTS, Report
from laconic.tools.report.page import shown
from laconic.tools.report.peers import rates_of_peer
from laconic.tools.report.referenced import beats, stiff_states
from laconic.tools.report.targets import (
    COARSE_S,
    FINE_S,
    ROUNDING,
    at_least,
    at_most,
    orders,
    slope_of,
    targets,
)
from laconic.tools.report.workshop import HOST
from laconic.tools.report.writing import write

pytestmark = pytest.mark.nightly


@pytest.fixture(scope="module")
def ladder() -> list[dict]:
    return accuracy.rows_of(read_scene("s1"), ("double",))


@pytest.mark.parametrize(("method", "order"), orders().items())
def test_the_error_on_s1_falls_at_the_methods_order(ladder: list[dict], method: str, order: int):
    error = {row["step_s"]: row["error_nu"] for row in ladder if row["method"] == method}
    slope = slope_of(error[COARSE_S], error[FINE_S])
    assert slope > order - 0.3 if slope is not None else max(error[COARSE_S], error[FINE_S]) <= ROUNDING


def test_single_precision_keeps_s1_within_three_units_of_its_last_place():
    for row in accuracy.s1_rows(read_scene("s1"), ("auto", EXPLICIT)):
        assert row["error_anywhere"] < 3 * np.finfo(np.float32).eps * row["largest_nu"]


def test_a_heading_of_a_billion_turns_advances_by_the_same_bits():
    assert accuracy.heading_after_many_turns(read_scene("s1"))


def test_x_keeps_its_digits_over_ten_million_steps_in_single_precision():
    assert accuracy.straight_run(read_scene("s1"))["error"] < 1e-6


@pytest.mark.parametrize(("real", "limit"), [("double", 1e-13), ("single", 1e-4)])
def test_exact_flow_keeps_energy_and_yaw_integral_over_a_million_steps(real: str, limit: float):
    rows = drift.drift_rows(read_scene("paper_three_wheel_free"), (real,), (EXACT,))
    assert rows[-1]["steps"] == 1_000_000
    assert rows[-1]["energy"] < limit
    assert rows[-1]["K"] < limit


@pytest.mark.parametrize("real", ["double", "single"])
def test_no_method_lets_the_norm_of_random_vehicles_grow_unnoticed(real: str):
    eps = float(np.finfo(np.float64 if real == "double" else np.float32).eps)
    for row in drift.norm_rows((real,), vehicles=400):
        allowed = 4.0 if row["method"] == EXACT else 2.0**-9 / eps
        assert row["worst_growth_ulp"] <= allowed, row


def test_auto_follows_very_stiff_vehicles_under_voltages_that_vary_inside_the_step():
    rows = stability.stiff_rows([read_scene("robotino2")], factors=(1e3,))
    assert {row["inputs"] for row in rows} == {"constant", "sine 0.5 Hz"}
    for row in rows:
        assert row["status"] == "ok", row
        assert row["error_nu"] < 1e-3
        assert row["error_path"] < 5e-3


def test_the_map_has_no_silent_failure():
    rows = stability.map_rows(read_scene("kuka_youbot"), ("auto", EXPLICIT, EXACT, STIFF_8), (1e4,))
    for row in rows:
        assert row["status"].startswith("step") or row["error_nu"] < 1.0, row
    assert all(row["status"] == "ok" for row in rows if row["method"] == "auto")
    assert any(row["status"] == "step beyond damping limit" for row in rows if row["method"] == EXPLICIT)
    assert max(row["error_nu"] for row in rows if row["method"] == STIFF_8) < 1e-14


def test_the_maps_50_digits_are_the_stiff_solvers_to_its_tolerance():
    scene = stability.strengthened(read_scene("kuka_youbot"), 1e2, stability.four_steps(4), 1.0)
    ends = stability.SEGMENT_S * np.arange(1, stability.SEGMENTS + 1)
    expected = stiff_states(scene.with_run(step_s=stability.SEGMENT_S), ends)
    np.testing.assert_allclose(stability.map_truth(scene), expected, rtol=0.0, atol=1e-8)


@pytest.mark.skipif(not HOST.present, reason="no gcc here")
def test_the_right_hand_side_that_peers_integrate_is_the_numpy_references(tmp_path: Path):
    found, expected = rates_of_peer(read_scene("s1"), tmp_path)
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-14)


def test_goals_are_met_missed_or_not_measured():
    assert at_most("g", "w", 1.0, 2.0).row()["verdict"] == "met"
    assert at_most("g", "w", 3.0, 2.0).row()["verdict"] == "missed"
    assert at_least("g", "w", None, 2.0).row()["verdict"] == "not measured"
    assert at_most("g", "w", math.nan, 2.0).row()["verdict"] == "not measured"


def test_a_refusal_is_as_good_only_where_the_prototype_was_of_no_use():
    assert beats(None, None)
    assert not beats(None, 1e-3)
    assert beats(1e-4, 1e-3)
    assert not beats(2e-3, 1e-3)


def test_the_page_is_one_file_without_anything_from_elsewhere(ladder: list[dict], tmp_path: Path):
    results = {name: [] for name in PARTS} | {"accuracy": ladder}
    results["targets"] = targets(results)
    page = write(Report(results, ["something was left out"]), tmp_path, "1.2.3").read_text()
    assert "Error against run time" in page
    assert "something was left out" in page
    assert page.count("<svg") == 1
    assert 'href="goals.html"' in page
    assert "<tr class=\"heading\">" not in page
    goals = (tmp_path / "goals.html").read_text()
    assert goals.count('<tr class="heading">') == len({row["group"] for row in results["targets"]})
    assert f"Of {len(results['targets'])} goals" in goals
    assert "`" not in page.partition("<body>")[2]
    loaded = re.findall(r"<(?:script|link|img|iframe)|@import|url\((?!#)|src=", page)
    assert loaded == []
    assert len(list(csv.DictReader((tmp_path / "accuracy.csv").open()))) == len(ladder)
    assert json.loads((tmp_path / "report.json").read_text())["accuracy"][0]["scene"] == "s1"


@pytest.mark.parametrize(("name", "value", "text"), [("error_nu", 1.234e-9, "1.2e-09"), ("error_nu", None, "–"),
                                                     ("flash", 1234, "1234"), ("same_bits", True, "yes")])
def test_cells_are_readable(name: str, value: object, text: str):
    assert shown(name, value) == text
