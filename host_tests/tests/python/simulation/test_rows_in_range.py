"""Outputs beyond the range of numbers end a run, as a refused step does: no row, file or word holds NaN."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from laconic import RunRefused, build_scene, read_scene, simulate
from laconic.cli.main import run
from laconic.core.grip import newtons
from laconic.scene.table import read_toml

SIGNALS = ("no_slip_margin_N", "wheel_reaction_N", "wheel_torque_Nm", "x_m", "voltage_V[1]")
HUGE = 1.7e308


def tables(at_s: float, every_s: float | None) -> dict[str, object]:
    """Robotino 2 with voltages that no torque can be of, from an instant on."""
    found = read_toml(read_scene("robotino2").path).plain()
    found["run"] = {"duration_s": 1.0, "step_s": 0.01}
    found["outputs"] = {} if every_s is None else {"every_s": every_s}
    found["input"] = [{"signal": f"voltage_V[{i}]", "kind": "steps", "t_s": [0.0, at_s], "value": [3.0, HUGE]}
                      for i in (1, 2, 3)]
    return found


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("every_s", [None, 0.1, 0.3])
@pytest.mark.parametrize(("at_s", "words"), [(1.0, "at t = 1 s: outputs: a result leaves the range of double"),
                                             (0.5, "at t = 0.5 s: run.step_s: a result leaves the range of double")])
def test_a_run_ends_before_a_row_that_is_out_of_range(at_s: float, words: str, every_s: float | None) -> None:
    with pytest.raises(RunRefused) as refused:
        simulate(build_scene(tables(at_s, every_s)), SIGNALS, estimated=True)
    assert words in str(refused.value)
    found = refused.value.run
    rows = len(found.time_s)
    assert rows > 1 and found.steps == round(100 * at_s) and found.time_s[-1] < at_s
    assert all(len(column) == rows and np.isfinite(column).all() for column in found.columns.values())
    assert all(len(column) == rows for column in found.error_columns.values())
    assert not found.columns["voltage_V[1]"].max() > 3.0


def test_a_run_whose_kept_signals_are_in_range_goes_to_its_end() -> None:
    found = simulate(build_scene(tables(1.0, None)), ("x_m", "voltage_V[1]"))
    assert (found.time_s[-1], found.columns["voltage_V[1]"][-1]) == (1.0, HUGE)


def test_what_the_command_prints_and_writes_holds_no_nan(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = tmp_path / "s.toml", tmp_path / "run.csv"
    text = read_scene("robotino2").path.read_text(encoding="utf-8").split("[[input]]")[0]
    path.write_text(text + f"""
[[input]]
signal = "voltage_V[1]"
kind = "steps"
t_s = [0.0, 1.0]
value = [3.0, {HUGE}]
[run]
duration_s = 1.0
step_s = 0.01
[outputs]
signals = ["no_slip_margin_N", "x_m"]
""", encoding="utf-8")
    assert run(["simulate", str(path), "--out", str(out), "--errors", "--json"]) == 1
    told = capsys.readouterr()
    assert "nan" not in (told.out + told.err + out.read_text()).lower()
    assert math.isfinite(json.loads(told.out)["final"]["no_slip_margin_N"])


def test_a_force_that_is_no_number_is_told_in_words() -> None:
    assert newtons(math.nan) == newtons(-math.inf) == "beyond all numbers"
