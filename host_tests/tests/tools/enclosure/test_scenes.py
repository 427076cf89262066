"""`--enclose`: scenes that come with the project, numbers as they stand in the file, and what the commands print."""

from __future__ import annotations

import csv
import json
from fractions import Fraction
from pathlib import Path

import pytest
from flint import arb

from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.scene import read_scene, rigid_scene_names
from laconic.simulation import simulate
from laconic.tools.enclosure.balls import ball, precision
from laconic.tools.enclosure.readings import reading_of_core, reading_of_file
from laconic.tools.enclosure.study import enclose, state_signals, study_of
from laconic.tools.verify.trajectories import bound_text

SLIP = ("robotino_green", "robotino_grey", "skid_steer")
SCENES = sorted(set(rigid_scene_names()) - set(SLIP))
PUCK = """name = "puck"
[vehicle]
mass_kg = 0.1
yaw_inertia_kgm2 = 0.3
wheel_radius_m = 0.1
[[input]]
signal = "body_force_N[1]"
kind = "steps"
t_s = [0.0, 0.3]
value = [0.7, 0]
[initial]
y_m = 0.1000000000000000000000000000001
[run]
duration_s = 1.0
step_s = 0.1
"""

# It yaws at 30 rad/s, so that its place is a quadrature over many turns, while all else is at rest.
TURNING = """name = "turning"
[vehicle]
mass_kg = 10.0
yaw_inertia_kgm2 = 0.5
com_x_m = 0.05
wheel_radius_m = 0.1
wheel_inertia_kgm2 = 0.01
motor_gain_Nm_per_V = 1.0
motor_damping_Nms = 10.0
{wheels}
[run]
duration_s = {duration_s}
step_s = 0.3
"""
TURNING_WHEEL = """[[vehicle.wheel]]
kind = "omni"
x_m = {x_m}
y_m = {y_m}
axle_deg = {axle_deg}
[[input]]
signal = "voltage_V[{number}]"
kind = "steps"
t_s = [0.0]
value = [{voltage_V}]
"""


@pytest.fixture
def puck(tmp_path) -> Path:
    path = tmp_path / "puck.toml"
    path.write_text(PUCK)
    return path


def answer(capsys, *arguments: object) -> tuple[int, dict]:
    status = run([*map(str, arguments), "--json"])
    return status, json.loads(capsys.readouterr().out)


@pytest.mark.parametrize("duration_s, turned_rad", [(0.9, 25.2), pytest.param(2.1, 60.0, marks=pytest.mark.nightly)])
def test_the_place_of_a_robot_that_turns_for_long_is_enclosed(tmp_path, duration_s, turned_rad):
    """A slow motion's series may settle before its passes come to the last powers; then it serves no longer time."""
    wheels = "".join(TURNING_WHEEL.format(number=number, x_m=x_m, y_m=y_m, axle_deg=axle_deg, voltage_V=voltage_V)
                     for number, (x_m, y_m, axle_deg, voltage_V) in enumerate(
                         ((0.3, 0.0, 0, 900.0), (-0.15, 0.26, 120, 900.9), (-0.15, -0.26, 240, 901.8)), start=1))
    path = tmp_path / "turning.toml"
    path.write_text(TURNING.format(wheels=wheels, duration_s=duration_s), encoding="utf-8")
    scene = read_scene(path)
    reading = reading_of_file(scene)
    end = enclose(reading, reading.instants([scene.steps()]), None, "", shown=False).end.row()
    assert end[5] > turned_rad
    assert all(x.rad() < 1e-16 for x in end)


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_enclosed_to_1e_20_and_the_core_is_proved_to_be_within_1e_10(name):
    scene = read_scene(name)
    short = scene.with_run(duration_s=20 * scene.run.step_s)
    study = study_of(simulate(short, state_signals(scene.wheel_count)), shown=False)
    for found in (study.of_file, study.of_core):
        assert found.width < 1e-20
        assert max(kind.error for kind in found.kinds()) < 1e-10


@pytest.mark.parametrize(("name", "key"), [("robotino_green", "ground.friction_coefficient"),
                                           ("skid_steer", "ground.friction_coefficient")])
def test_what_slips_is_refused_by_its_key(name, key, capsys):
    assert run(["simulate", name, "--enclose"]) == 2
    assert f"{key}: " in capsys.readouterr().err


def test_decimals_are_taken_as_they_stand_in_the_file_and_the_core_has_the_nearest_doubles(puck):
    scene = read_scene(puck)
    force, mass = Fraction(7, 10), Fraction(1, 10)
    x = force / mass * (Fraction(3, 10) ** 2 / 2 + Fraction(3, 10) * Fraction(7, 10))
    ends = []
    for reading in (reading_of_file(scene), reading_of_core(scene)):
        ends.append(enclose(reading, [reading.step_s * 10], None, "puck", shown=False).end.place_m)
    with precision(160):
        assert ends[0][0].overlaps(ball(x)) and not ends[1][0].overlaps(ball(x))
        assert ends[0][1].contains(ball(Fraction("0.1000000000000000000000000000001")))
        assert ends[1][1].contains(arb(0.1)) and not ends[0][1].contains(arb(0.1))


def test_the_proved_error_is_that_of_the_true_motion(puck):
    run_of_core = simulate(read_scene(puck), ("nu_rad_per_s", "x_m", "y_m", "heading_rad"))
    found = study_of(run_of_core, shown=False).of_file
    x = Fraction(7) * (Fraction(3, 10) ** 2 / 2 + Fraction(3, 10) * Fraction(7, 10))
    true_error = abs(Fraction(float(run_of_core.columns["x_m"][-1])) - x)
    assert 0 < true_error <= Fraction(float(found.errors[-1, 3])) < true_error * Fraction(100001, 100000)


@pytest.mark.parametrize("options", [(), ("--step", "0.1")])
def test_a_step_that_is_found_or_given_instead_is_enclosed_as_a_number(puck, options, capsys):
    puck.write_text(PUCK.replace("step_s = 0.1", 'step_s = "auto"\ntolerance = 1e-9'))
    status, said = answer(capsys, "simulate", puck, "--enclose", *options)
    assert status == 0 and said["enclosure"]


def test_simulate_writes_error_and_width_beside_each_state(puck, tmp_path, capsys):
    out = tmp_path / "out.csv"
    status, said = answer(capsys, "simulate", puck, "--enclose", "--out", out)
    rows = list(csv.DictReader(out.open()))
    assert status == 0 and len(rows) == 11
    assert list(rows[0])[-2:] == ["heading_rad_error", "heading_rad_width"]
    assert 0.0 < float(rows[-1]["x_m_error"]) < 1e-14 and float(rows[-1]["x_m_width"]) < 1e-25
    enclosure = said["enclosure"]
    assert enclosure["final"]["x_m"]["middle"].startswith("1.785") and enclosure["final"]["x_m"]["radius"] < 1e-25
    assert float(enclosure["final"]["heading_cosine"]["middle"]) == 1.0
    assert enclosure["rows"] == 11 and not enclosure["inside"] and enclosure["own_constants"]["error_nu"] < 1e-14


def test_the_table_states_width_and_distance(puck, capsys):
    assert run(["simulate", str(puck), "--enclose"]) == 0
    printed = capsys.readouterr().out
    assert "width at most" in printed and printed.count("distance ≤") >= 2 and "wheel angles" not in printed


def test_verify_of_a_scene_fails_beyond_the_tolerance_and_passes_within(puck, capsys):
    status, said = answer(capsys, "verify", puck, "--enclose", "--tolerance", "1e-12")
    (case,) = said["cases"]
    assert status == 0 and case["status"] == "ok" and 0.0 < case["error_pose"] < 1e-14 and case["width_pose"] < 1e-25
    assert (said["step_s"], said["real"]) == (0.1, "double")
    assert run(["verify", str(puck), "--enclose", "--tolerance", "1e-30"]) == 1
    assert "over the tolerance" in capsys.readouterr().out
    status, said = answer(capsys, "verify", puck, "--enclose", "--real", "single", "--tolerance", "1e-12")
    assert status == 1 and 1e-9 < said["cases"][0]["error_pose"] < 1e-6


def test_verify_of_references_states_bounds_and_a_state_that_is_wrong_fails(tmp_path, capsys):
    from laconic.tools.verify.trajectories import read_reference

    data = Path(__file__).parents[2] / "data" / "trajectories.json"
    case = next(case.plain() for case in read_reference(data) if case.text("name") == "puck")
    path = tmp_path / "puck.json"
    path.write_text(json.dumps({"format": 1, "cases": [case]}))
    status, said = answer(capsys, "verify", path, "--enclose")
    assert status == 0 and said["cases"][0]["width_nu"] < 1e-25 and said["cases"][0]["error_nu"] < 1e-14
    digits = case["states"][1]["nu"][0]
    case["states"][1]["nu"][0] = digits[:-4] + f"{int(digits[-4]) ^ 1}" + digits[-3:]
    path.write_text(json.dumps({"format": 1, "cases": [case]}))
    status, said = answer(capsys, "verify", path, "--enclose")
    assert status == 1 and said["cases"][0]["status"] == "nu[1] at state 2 of the file lies outside the enclosure"


def test_a_scene_that_no_file_holds_is_refused(tmp_path, puck):
    scene = read_scene(puck)
    puck.unlink()
    with pytest.raises(BadInput, match="an enclosure needs the scene's file"):
        reading_of_file(scene)


def test_a_printed_bound_is_not_below_the_bound():
    for number in (1.04e-13, 9.96e-13, 1.0e-15, 2.55e-3, 0.0):
        assert float(bound_text(number)) >= number
