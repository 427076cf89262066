"""The core's list of methods is the one that Python reads and FMUs enumerate; the build names what differs.

The build compares the core's list of fields with modelDescription.xml before it makes anything of both.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.fmu import DESCRIPTION
from laconic.scene.methods import METHODS, ROWS, method_with
from laconic_fmu.description import parse, token_in, token_of
from laconic_fmu.field_list import methods_in, rows_in

LIST = SOURCE_DIR / "core_c" / "include" / "laconic" / "methods.h"
TEXT = LIST.read_text(encoding="utf-8")
LAST = '"' + ROWS[-1].title + '")\n'
MADE_UP = LAST.replace("\n", " \\\n") + (
    f'    X({len(ROWS)}, made_up, "made-up", 2, ANY_DAMPING, NOTHING, NOTHING, \\\n'
    '      "Second order & quick")\n')


def laconic_fmu(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "laconic_fmu", *map(str, arguments)], capture_output=True, text=True)


def header_with_another_method(folder: Path) -> Path:
    assert TEXT.count(LAST) == 1
    header = folder / "methods.h"
    header.write_text(TEXT.replace(LAST, MADE_UP), encoding="utf-8")
    return header


@pytest.mark.parametrize("real", ["double", "single"])
def test_the_rows_are_the_methods_of_the_core(real: str) -> None:
    core = load(real)
    assert [row.number for row in ROWS] == list(range(len(ROWS)))
    for row in ROWS:
        method = core.lib.laconic_method_by_number(row.number)
        assert (core.text(method.name), method.order) == (row.name, row.order)
    assert core.lib.LACONIC_METHOD_COUNT == len(ROWS) and core.method_names == METHODS


def test_what_a_row_takes_is_what_the_core_takes() -> None:
    """Steps of a second of a vehicle that is damped by 200 1/s."""
    core = load("double")
    wheels = [{"kind": "omni", "x_m": x, "y_m": y, "axle_rad": a} for x, y, a in ((1, 0, 0.1), (-1, 1, 2), (-1, -1, 4))]
    vehicle = core.vehicle({"mass_kg": 1.0, "yaw_inertia_kgm2": 1.0, "wheel_radius_m": 0.1, "wheel_inertia_kgm2": 0.01,
                            "motor_gain_Nm_per_V": 1.0, "motor_damping_Nms": 3.0, "wheel": wheels})
    for row in ROWS:
        integrator, why = core.ffi.new("laconic_integrator *"), core.why()
        status = core.lib.laconic_integrator_prepare(
            integrator, core.method(row.name), core.ffi.new("laconic_model *", core.prepare(vehicle)[0]), 1.0, why)
        refused = status == core.lib.LACONIC_STEP_BEYOND_DAMPING_LIMIT
        assert refused == (row.takes == "SLOW_DAMPING"), row.name


def test_a_method_is_found_by_its_traits() -> None:
    for row in ROWS[1:]:
        name = method_with(row.order, row.takes, row.keeps)
        assert METHODS.index(name) <= row.number and METHODS.index(name) > 0
    assert {method_with(row.order, keeps="EXACTLY") for row in ROWS if row.keeps == "EXACTLY"} <= set(METHODS)


def test_the_enumeration_of_fmus_has_every_method_with_its_title() -> None:
    description = parse(DESCRIPTION.read_text(encoding="utf-8"))
    items = description.items(description.variable("method"))
    assert items == {row.number: (row.name, row.title) for row in ROWS}


def test_a_method_that_is_no_item_stops_the_build_with_one_line_and_one_command_adds_it(tmp_path: Path) -> None:
    header, out, source = header_with_another_method(tmp_path), tmp_path / "made", tmp_path / "modelDescription.xml"
    source.write_text(DESCRIPTION.read_text(encoding="utf-8"), encoding="utf-8")
    done = laconic_fmu("tables", source, "--out", out, "--methods", header)
    assert done.returncode == 1 and not out.exists()
    assert done.stderr == (f"{header}: {source} has no item number {len(ROWS)}, made-up, with its title; "
                           f"run python -m laconic_fmu renew-methods {source} {header}\n")
    assert laconic_fmu("renew-methods", source, header).returncode == 0
    text = source.read_text(encoding="utf-8")
    assert token_in(text) == token_of(text) != token_in(DESCRIPTION.read_text(encoding="utf-8"))
    assert f'<Item name="made-up" value="{len(ROWS)}" description="Second order &amp; quick"/>' in text
    done = laconic_fmu("tables", source, "--out", out, "--methods", header)
    assert (done.returncode, done.stderr) == (0, "")
    done = laconic_fmu("tables", source, "--out", out, "--methods", LIST)
    assert done.stderr.startswith(f"{LIST}: has no method number {len(ROWS)}, which is an item of {source}; run ")


def test_renewing_an_enumeration_that_is_right_changes_no_byte(tmp_path: Path) -> None:
    source = tmp_path / "modelDescription.xml"
    source.write_bytes(DESCRIPTION.read_bytes())
    assert laconic_fmu("renew-methods", source, LIST).returncode == 0
    assert source.read_bytes() == DESCRIPTION.read_bytes()


def test_a_header_without_the_list_is_refused(tmp_path: Path) -> None:
    header = tmp_path / "methods.h"
    header.write_text("no list\n", encoding="utf-8")
    done = laconic_fmu("tables", DESCRIPTION, "--out", tmp_path / "made", "--methods", header)
    assert done.returncode == 1 and f"{header}: holds no rows" in done.stderr
    assert methods_in("") == ()


FIELDS = SOURCE_DIR / "core_c" / "include" / "laconic" / "vehicle.h"
OF_SENSORS = FIELDS.with_name("sensors.h")
ROW = "    X(of, 10, FRICTION_COEFFICIENT,"  # its beginning
MADE_UP_FIELD = "    X(of, 43, TYRE_WIDTH, tyre_width_m, tyre_width_m, REAL, NOT_NEGATIVE, NEVER) \\\n"


def tables(header: Path, out: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "laconic_fmu", "tables", str(DESCRIPTION), "--out", str(out),
                           "--fields", str(header)], capture_output=True, text=True)


def test_the_rows_are_the_fields_of_the_core_but_those_of_the_motor_at_its_shaft() -> None:
    fields = {(field.identifier, field.name) for field in load().fields if field.table != "vehicle.motor"}
    assert set(rows_in(FIELDS.read_text(encoding="utf-8"))) == fields
    of_sensors = {(field.identifier, field.name) for field in load().sensor_fields}
    assert set(rows_in(OF_SENSORS.read_text(encoding="utf-8"))) == of_sensors


def test_a_field_without_its_variable_stops_the_build_with_one_line(tmp_path: Path) -> None:
    text, out = FIELDS.read_text(encoding="utf-8"), tmp_path / "made"
    assert ROW in text
    header = tmp_path / "vehicle.h"
    header.write_text(text.replace(ROW, MADE_UP_FIELD + ROW), encoding="utf-8")
    done = tables(header, out)
    assert done.returncode == 1 and not out.exists()
    assert done.stderr == (f"{header}: the row TYRE_WIDTH has no variable tyre_width_m in {DESCRIPTION}; add one "
                           "there, with its description and unit, and run python -m laconic_fmu renew-token "
                           f"{DESCRIPTION}\n")


def test_a_variable_out_of_its_order_stops_the_build_with_one_line(tmp_path: Path) -> None:
    text = DESCRIPTION.read_text(encoding="utf-8")
    first = text.index('    <Float64 name="mass_kg"')
    description = tmp_path / "modelDescription.xml"
    description.write_text(text[:first] + '    <Float64 name="tyre_width_m" valueReference="999" causality="parameter" '
                           'variability="fixed" start="0"/>\n' + text[first:], encoding="utf-8")
    laconic_fmu = [sys.executable, "-m", "laconic_fmu"]
    subprocess.run([*laconic_fmu, "renew-token", str(description)], check=True)
    done = subprocess.run([*laconic_fmu, "tables", str(description), "--out", str(tmp_path / "made")],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert done.stderr.startswith(f"{description}: tyre_width_m: its value reference is 999")


@pytest.mark.parametrize("text", ["", "no list\n"])
def test_a_header_without_the_list_of_fields_is_refused(tmp_path: Path, text: str) -> None:
    header = tmp_path / "vehicle.h"
    header.write_text(text, encoding="utf-8")
    done = tables(header, tmp_path / "made")
    assert done.returncode == 1
    assert f"{header}: holds no rows" in done.stderr
