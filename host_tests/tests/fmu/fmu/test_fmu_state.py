"""Saved states: rollback, bytes that another process continues from, and bytes that are refused."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from fmu_importer import ERROR, OK, Importer, generic
from fmu_saved_states import SUFFIX, deserialize, save, serialize

from laconic.fmu import make_fmu
from laconic.scene import read_scene

NAMES = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "wheel_angle_rad", "wheel_reaction_N", "energy_J")


def drive(importer: Importer, first: int, last: int) -> None:
    """Some steps with voltages that change."""
    for k in range(first, last):
        assert importer.set("voltage_V", *(3.0 + (k % 7) - wheel for wheel in range(importer.wheels))) == OK
        assert importer.step(k * 0.01, 0.01) == OK


def outputs(importer: Importer) -> list[float]:
    """A row of everything that moves."""
    return [value for name in NAMES for value in importer.get(name)]


@pytest.mark.parametrize("version", [2, 3])
def test_rollback_repeats_the_same_bits(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        drive(importer, 0, 50)
        state = save(importer)
        drive(importer, 50, 90)
        once = outputs(importer)
        importer.must(f"Set{SUFFIX[version]}", state[0])
        drive(importer, 50, 90)
        assert outputs(importer) == once
        importer.must(f"Free{SUFFIX[version]}", state)
        assert state[0] == importer.ffi.NULL


CONTINUE = """
import json, sys
from pathlib import Path
from fmu_importer import Importer
from test_fmu_state import deserialize, drive, outputs
with Importer(Path(sys.argv[1])) as importer:
    assert deserialize(importer, Path(sys.argv[2]).read_bytes()) == 0, importer.log
    drive(importer, 60, 100)
    print(json.dumps([value.hex() for value in outputs(importer)]))
"""


@pytest.mark.parametrize("version, method", [
    (2, 0), (3, 3), *(pytest.param(version, method, marks=pytest.mark.nightly) for version in (2, 3)
                      for method in (0, 1, 3, 5, 6) if (version, method) not in ((2, 0), (3, 3)))])
def test_bytes_continue_with_the_same_bits_in_a_fresh_process(version: int, method: int, tmp_path: Path) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set("method", method) == OK
        assert importer.set("payload_mass_kg", 1.5) == OK
        importer.initialize()
        drive(importer, 0, 30)
        assert importer.set("payload_mass_kg", 4.0) == OK
        drive(importer, 30, 60)
        data = serialize(importer)
        drive(importer, 60, 100)
        here = [value.hex() for value in outputs(importer)]
    (tmp_path / "state.bin").write_bytes(data)
    (tmp_path / "go.py").write_text(CONTINUE)
    there = subprocess.run([sys.executable, str(tmp_path / "go.py"), str(generic(version)),
                            str(tmp_path / "state.bin")], env={**os.environ, "PYTHONPATH": str(Path(__file__).parent)},
                           capture_output=True, text=True, check=True).stdout
    assert json.loads(there) == here


@pytest.mark.parametrize("version", [2, 3])
def test_model_exchange_is_saved_too(version: int) -> None:
    with Importer(generic(version), "ModelExchange") as importer:
        importer.initialize()
        importer.must("EnterContinuousTimeMode")
        count = 6 + importer.wheels
        importer.must("SetContinuousStates", importer.ffi.new("double[]", [0.1 * k for k in range(count)]), count)
        data, rates, row = serialize(importer), importer.rates(), outputs(importer)
        importer.must("SetContinuousStates", importer.ffi.new("double[]", count), count)
        assert importer.rates() != rates
        assert deserialize(importer, data) == OK
        assert importer.rates() == rates
        assert outputs(importer) == row


@pytest.mark.parametrize("version", [2, 3])
def test_damaged_bytes_are_refused_and_change_nothing(version: int) -> None:
    with Importer(generic(version)) as importer:
        importer.initialize()
        drive(importer, 0, 20)
        data, before = serialize(importer), outputs(importer)
        for cut in (0, 1, 7, 8, 16, len(data) // 2, len(data) - 1):
            assert deserialize(importer, data[:cut]) == ERROR
        assert deserialize(importer, data + b"\0") == ERROR
        for at in range(0, len(data), 101):
            assert deserialize(importer, data[:at] + bytes([data[at] ^ 0x10]) + data[at + 1:]) == ERROR
        older = data[:8] + (0).to_bytes(8, "little") + data[16:]
        assert deserialize(importer, older) == ERROR
        assert "version 0" in importer.log[-1][2]
        assert outputs(importer) == before


def test_a_state_of_another_fmu_is_refused(tmp_path: Path) -> None:
    other = make_fmu(read_scene("kuka_youbot"), tmp_path / "other.fmu", version=3)
    with Importer(other) as importer:
        importer.initialize()
        data = serialize(importer)
    with Importer(generic(3)) as importer:
        importer.initialize()
        assert deserialize(importer, data) == ERROR
        assert "another FMU" in importer.log[-1][2]


def test_a_state_of_the_other_kind_is_refused() -> None:
    with Importer(generic(3), "ModelExchange") as importer:
        importer.initialize()
        data = serialize(importer)
    with Importer(generic(3)) as importer:
        assert deserialize(importer, data) == ERROR
        assert "other kind" in importer.log[-1][2]


def test_serialized_states_hold_no_addresses() -> None:
    rows = []
    for _ in range(2):
        with Importer(generic(3)) as importer:
            importer.initialize()
            drive(importer, 0, 10)
            rows.append(serialize(importer))
    assert rows[0] == rows[1]
