"""The demo of docs/fmu-importers.md: vehicle, bus and controller in the FMU toolbox's container, and joined by FMPy."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from fmpy import simulate_fmu
from fmu_manipulation_toolbox.assembly import Assembly

from laconic.base.paths import SOURCE_DIR
from laconic.fmu.bus_demo import SETPOINT_RAD_PER_S, demo, main

PAGE = (SOURCE_DIR / "docs" / "fmu-importers.md").read_text(encoding="utf-8")
UNTIL_S = 0.2


def test_the_toolboxs_container_and_fmpy_move_the_vehicle_by_the_same_bits(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    by_fmpy = demo(tmp_path, UNTIL_S)
    assembly = Assembly("demo.json", fmu_directory=tmp_path)
    assembly.make_fmu(fmi_version=3)
    speeds = {f"setpoint_rad_per_s[{wheel}]": SETPOINT_RAD_PER_S for wheel in (1, 2, 3, 4)}
    rows = simulate_fmu("demo.fmu", stop_time=UNTIL_S, step_size=0.001, output_interval=0.001, start_values=speeds,
                        relative_tolerance=1e-9, validate=False)
    in_container = {name: float(rows[-1][name]) for name in by_fmpy if name in rows.dtype.names}
    assert in_container == by_fmpy
    assert by_fmpy["x_m"] > 0.01


def test_the_demo_prints_the_figures_of_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert printed.strip() in PAGE
    assert set(json.loads((tmp_path / "demo.json").read_text())["fmu"]) == {
        "bus.fmu", "vehicle.fmu", "controller.fmu"}
    assert re.search(r"x_m +0\.\d+", printed)
