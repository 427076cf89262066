"""docs/articulated.md: its C program, its figures, its refusals and its robots are as the page says."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from hinge_scenes import CASTER, HINGED, SLIDING, WHEEL, held, scene_with

import laconic
from laconic.base.paths import SOURCE_DIR, built
from laconic.cli.main import run
from laconic.errors import BadInput, Refused

PAGE = (SOURCE_DIR / "docs" / "articulated.md").read_text(encoding="utf-8")
REFERENCE = Path(__file__).parents[1] / "data" / "articulated_reference.json"
KINDS = ("velocity", "hinge_rate", "hinge_angle", "pose", "wheel")
COLUMNS = (("auto", "0.001"), ("auto", "0.01"), ("circle", "0.01"), ("moebius-4", "0.01"))
AXLE = [{**WHEEL, "x_m": 0.0, "y_m": y} for y in (0.2, -0.2)]
CORNERS = {"fl": (0.3, 0.2), "fr": (0.3, -0.2), "rl": (-0.3, 0.2), "rr": (-0.3, -0.2)}
MOTOR = {"yaw_inertia_kgm2": 0.01, "steering_gain_Nm_per_V": 1.0, "steering_damping_Nms": 1.0}


def rows_after(heading: str) -> list[list[str]]:
    """The cells of the first table behind a line of the page."""
    table = re.search(r"(?:^\|.*\n)+", PAGE[PAGE.index(heading):], re.MULTILINE)
    assert table is not None
    return [[cell.strip() for cell in line.strip("|\n ").split("|")] for line in table[0].splitlines()][2:]


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")
def test_the_c_program_of_the_page_compiles_without_a_warning_and_prints_what_the_page_shows(tmp_path: Path) -> None:
    program, printed = re.findall(r"```c\n(.*?)```\n\n```text\n(.*?)```", PAGE, re.DOTALL)[0]
    (tmp_path / "program.c").write_text(program, encoding="utf-8")
    library = built("lib/liblaconic_double.so")
    subprocess.run(["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-I", SOURCE_DIR / "core_c/include", "program.c",
                    library, f"-Wl,-rpath,{library.parent}", "-o", "program"], cwd=tmp_path, check=True)
    assert subprocess.run(["./program"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout == printed


def test_the_errors_of_the_page_are_those_that_verify_prints(capsys: pytest.CaptureFixture[str]) -> None:
    found: dict[str, list[float]] = {}
    for method, step in COLUMNS:
        assert run(["verify", str(REFERENCE), "--method", method, "--step", step, "--json"]) == 0
        for case in json.loads(capsys.readouterr().out)["cases"]:
            found.setdefault(case["name"], []).append(max(case[f"error_{kind}"] for kind in KINDS))
    table = {row[0].strip("`"): [float(cell) for cell in row[1:]] for row in rows_after("| reference |")}
    assert {*table} == {*found}
    for name, errors in found.items():
        assert table[name] == pytest.approx(errors, rel=0.3, abs=2e-14), name


def steered(kind: str, *names: str, **more: Any) -> list[dict[str, Any]]:
    return [{"kind": "fixed", "steered": kind, "name": name, "x_m": CORNERS[name][0], "y_m": CORNERS[name][1], **more}
            for name in names]


def simulated(wheels: list[dict[str, Any]], inputs: list[dict[str, Any]], **vehicle: Any) -> laconic.Trajectory:
    return laconic.simulate(scene_with({
        "vehicle": {"mass_kg": 20.0, "yaw_inertia_kgm2": 0.8, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 1e-3,
                    "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.5, "wheel": wheels, **vehicle},
        "input": inputs, "run": {"duration_s": 0.1, "step_s": 0.01}}))


@pytest.mark.parametrize(("wheels", "inputs", "vehicle", "words"), [
    ([*steered("prescribed", "fl", "fr", "rl", start_angle_rad=0.3),
      *steered("prescribed", "rr", start_angle_rad=0.301)], held(voltage_V__1=1.0), {},
     "ask for different turning centres"),
    ([*AXLE, *steered("prescribed", "fl", "fr", start_angle_rad=0.2)], held(voltage_V__1=1.0), {},
     "ask for different turning centres.*use coordinated hinges"),
    (steered("motor", "fl", "fr", "rl", **MOTOR), [], {}, "hold the carriage at nearly every angle"),
    ([*AXLE, *steered("motor", "fl", "fr", **MOTOR)], [], {}, "hold the carriage at nearly every angle"),
    (steered("coordinated", "fl"), [], {}, "but 2 are needed.*use a prescribed or motor hinge"),
    (steered("coordinated", *CORNERS), held(steering_twist__1=0.0), {}, "no direction.*scale the voltages"),
    (steered("coordinated", *CORNERS), held(steering_twist__1=0.2, steering_twist__2=-0.3, steering_twist__3=1.0), {},
     "no direction"),
    (AXLE, [], {"caster": [{**CASTER, "trail_m": 0.0}]}, "trail_m: is 0"),
    ([AXLE[0], *steered("motor", "fl", **{**MOTOR, "yaw_inertia_kgm2": 0.0})], [], {}, "turns without inertia")])
def test_what_the_page_says_is_refused_is_refused_with_these_words(
        wheels: list[dict[str, Any]], inputs: list[dict[str, Any]], vehicle: dict[str, Any], words: str) -> None:
    with pytest.raises((BadInput, Refused), match=words):
        simulated(wheels, inputs, **vehicle)


def test_a_free_hinge_on_its_axle_line_keeps_its_angle_and_a_body_with_two_axles_goes_straight_only() -> None:
    fork = {"name": "fork", "hinge": "free", "hinge_x_m": 0.3, "mass_kg": 1.0, "yaw_inertia_kgm2": 0.01,
            "start_angle_rad": 0.4}
    wheel = {**WHEEL, "x_m": 0.0, "y_m": 0.0, "body": "fork", "driven": False}
    free = simulated([*AXLE, wheel], held(voltage_V__1=2.0, voltage_V__2=2.0), body=[fork])
    assert abs(free.columns["hinge_angle_rad[fork]"][-1]) > 0.3
    cart = {"name": "cart", "hinge": "free", "hinge_x_m": -0.3, "mass_kg": 9.0, "yaw_inertia_kgm2": 1.0}
    two = [{**wheel, "body": "cart", "x_m": x} for x in (-0.8, -1.2)]
    run_ = simulated([*AXLE, *two], held(voltage_V__1=1.0, voltage_V__2=2.0), body=[cart])
    assert abs(run_.columns["yaw_rate_rad_per_s"][-1]) < 1e-12 < run_.columns["velocity_body_m_per_s[1]"][-1]


def test_the_page_has_every_robot_with_hinges() -> None:
    assert {row[0].partition("]")[0].lstrip("[") for row in rows_after("## The ten robots")} == {*HINGED, *SLIDING}
