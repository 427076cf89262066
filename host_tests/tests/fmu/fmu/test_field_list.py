"""The build compares the core's list of fields with modelDescription.xml before it makes anything of both."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.fmu import DESCRIPTION
from laconic_fmu.field_list import rows_in

LIST = SOURCE_DIR / "core_c" / "include" / "laconic" / "vehicle.h"
OF_SENSORS = LIST.with_name("sensors.h")
ROW = "    X(of, 10, FRICTION_COEFFICIENT, friction_coefficient, friction_coefficient, REAL, NOT_NEGATIVE, NEVER)\n"
MADE_UP = "    X(of, 43, TYRE_WIDTH, tyre_width_m, tyre_width_m, REAL, NOT_NEGATIVE, NEVER) \\\n"


def tables(header: Path, out: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "laconic_fmu", "tables", str(DESCRIPTION), "--out", str(out),
                           "--fields", str(header)], capture_output=True, text=True)


def test_the_rows_are_the_fields_of_the_core_but_those_of_the_motor_at_its_shaft() -> None:
    fields = {(field.identifier, field.name) for field in load().fields if field.table != "vehicle.motor"}
    assert set(rows_in(LIST.read_text(encoding="utf-8"))) == fields
    of_sensors = {(field.identifier, field.name) for field in load().sensor_fields}
    assert set(rows_in(OF_SENSORS.read_text(encoding="utf-8"))) == of_sensors


def test_a_field_without_its_variable_stops_the_build_with_one_line(tmp_path: Path) -> None:
    text, out = LIST.read_text(encoding="utf-8"), tmp_path / "made"
    assert ROW in text
    header = tmp_path / "vehicle.h"
    header.write_text(text.replace(ROW, MADE_UP + ROW), encoding="utf-8")
    done = tables(header, out)
    assert done.returncode == 1 and not out.exists()
    assert done.stderr == (f"{header}: the row TYRE_WIDTH has no variable tyre_width_m in {DESCRIPTION}; add one "
                           "there, with its description and unit, and run python -m laconic_fmu renew-token "
                           f"{DESCRIPTION}\n")


@pytest.mark.parametrize("text", ["", "no list\n"])
def test_a_header_without_the_list_is_refused(tmp_path: Path, text: str) -> None:
    header = tmp_path / "vehicle.h"
    header.write_text(text, encoding="utf-8")
    done = tables(header, tmp_path / "made")
    assert done.returncode == 1
    assert f"{header}: holds no rows" in done.stderr
