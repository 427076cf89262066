"""The report's table of estimated beside true errors."""

from __future__ import annotations

import pytest

from laconic.scene import read_scene
from laconic.tools.report import accuracy, estimated


@pytest.mark.parametrize("name", ["s1", "skid_steer"])
def test_estimates_are_within_a_factor_of_ten_in_every_run_of_the_ladder(name: str) -> None:
    rows = accuracy.rows_of(read_scene(name).with_run(duration_s=1.0), ("double",), ladder=(0.005, 0.01, 0.02, 0.05))
    assert all({"estimate_nu", "estimate_pose", "estimate_wheel"} <= set(row) for row in rows if row["status"] == "ok")
    told = estimated.rows_of(rows)
    assert told and all(row["within_10"] == 1.0 and 0.1 <= row["least"] <= row["median"] for row in told)


def test_what_the_reference_cannot_tell_is_not_compared() -> None:
    row = {"method": "auto", "real": "double", "error_nu": 1e-10, "estimate_nu": 1e-3}
    assert estimated.rows_of([row]) == []
    assert estimated.rows_of([row | {"error_nu": 1e-8}])[0]["largest"] == pytest.approx(1e5)
    assert estimated.rows_of([row | {"error_nu": 1e-8, "reference_error_nu": 1e-8}]) == []
