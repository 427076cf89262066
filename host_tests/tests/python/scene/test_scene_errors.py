"""Bad input gives one clear line that names file, field and remedy, and exit status 2."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from laconic.cli.main import run
from laconic.scene.methods import EXPLICIT

GOOD = """
name = "Four wheels"
source = "a test"
[vehicle]
mass_kg = 20.0
yaw_inertia_kgm2 = 1.2
com_y_m = 0.03
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.004
motor_gain_Nm_per_V = 0.8
motor_damping_Nms = 0.05
[[vehicle.wheel]]
kind = "mecanum"
x_m = 0.2
y_m = 0.15
axle_deg = -90
roller_deg = 45
[[vehicle.wheel]]
kind = "omni"
distance_m = 0.2
bearing_deg = 180
axle_deg = 180
[[input]]
signal = "voltage_V[1]"
kind = "steps"
t_s = [0.0, 0.5]
value = [6.0, -3.0]
[run]
duration_s = 1.0
step_s = 0.01
"""

STEPS = 'kind = "steps"\nt_s = [0.0, 0.5]\nvalue = [6.0, -3.0]'
SINE = 'kind = "sine"\namplitude = {}\nfrequency_Hz = {}\nphase_deg = {}'

# what is changed in the good scene, and what the line must contain
BAD = {
    "missing field": (("mass_kg = 20.0\n", ""), ("vehicle.mass_kg", "missing")),
    "missing table": (("[run]\nduration_s = 1.0\nstep_s = 0.01\n", ""), ("run", "missing")),
    "missing wheel inertia": (("wheel_inertia_kgm2 = 0.004\n", ""), ("vehicle.wheel_inertia_kgm2", "missing")),
    "missing damping": (("motor_damping_Nms = 0.05\n", ""), ("vehicle.motor_damping_Nms", "missing")),
    "missing roller angle": (("roller_deg = 45\n", ""), ("vehicle.wheel[1].roller_rad", "missing")),
    "missing bearing": (("bearing_deg = 180\n", ""), ("vehicle.wheel[2].bearing_rad", "missing")),
    "negative mass": (("mass_kg = 20.0", "mass_kg = -20.0"), ("vehicle.mass_kg: -20", "above 0")),
    "no friction": (("mass_kg = 20.0", "mass_kg = 20.0\nfriction_coefficient = 0.0"),
                    ("vehicle.friction_coefficient: is 0; give a value above 0 (1e-6 is ice), or take it out for",)),
    "negative distance": (("distance_m = 0.2", "distance_m = -0.2"), ("vehicle.wheel[2].distance_m: is -0.2; give 0",)),
    "negative frequency": (('kind = "steps"\nt_s = [0.0, 0.5]\nvalue = [6.0, -3.0]',
                            'kind = "sine"\namplitude = 1.0\nfrequency_Hz = -1.0'),
                           ("input[1].frequency_Hz: is -1; give 0 or more",)),
    "a sine of amplitude 0": ((STEPS, SINE.format(0, 1, 90)),
                              ("input[1].amplitude: is 0; give another value, or take this input out, which would",)),
    "a sine of 0 Hz": ((STEPS, SINE.format(1, 0, 0)), ("input[1].frequency_Hz: is 0, and this sine would do nothing",)),
    "a sine of 0 Hz at 180°": ((STEPS, SINE.format(1, 0, 180)), ("input[1].frequency_Hz: is 0, and this sine would",)),
    "a radius whose square is no number": (("axle_deg = -90", "radius_m = 1e300\naxle_deg = -90"),
                                           ("vehicle.wheel[1].radius_m: a result leaves the range of double",)),
    "a place whose square is no number": (("x_m = 0.2", "x_m = -1e300"), ("vehicle.wheel[1].x_m: a result leaves",)),
    "an inertia whose square is no number": (("yaw_inertia_kgm2 = 1.2", "yaw_inertia_kgm2 = 1e300"),
                                             ("vehicle.yaw_inertia_kgm2: a result leaves the range of double",)),
    "zero radius": (("wheel_radius_m = 0.05", "wheel_radius_m = 0.0"), ("vehicle.wheel_radius_m", "above 0")),
    "negative inertia": (("wheel_inertia_kgm2 = 0.004", "wheel_inertia_kgm2 = -1"), ("vehicle.wheel_inertia_kgm2: -",)),
    "NaN": (("yaw_inertia_kgm2 = 1.2", "yaw_inertia_kgm2 = nan"), ("vehicle.yaw_inertia_kgm2: NaN", "finite")),
    "infinite place": (("x_m = 0.2", "x_m = inf"), ("vehicle.wheel[1].x_m: ", "finite")),
    "infinite bearing": (("bearing_deg = 180", "bearing_deg = inf"), ("wheel[2].bearing_deg: is inf", "finite")),
    "roller along axle": (
        ("roller_deg = 45", "roller_deg = 0"), ("vehicle.wheel[1].roller_deg: with 0 degrees", "axle", "have 90")),
    "roller along axle, in radians": (
        ("roller_deg = 45", "roller_rad = 0"), ("vehicle.wheel[1].roller_rad: with 0 rad", "pi/2")),
    "infinite axle": (("axle_deg = 180", "axle_deg = inf"), ("vehicle.wheel[2].axle_deg: infinity",)),
    "infinite axle, in radians": (("axle_deg = 180", "axle_rad = inf"), ("vehicle.wheel[2].axle_rad: infinity",)),
    "infinite heading": (("[run]", "[initial]\nheading_deg = inf\n[run]"), ("initial.heading_deg: is inf",)),
    "heading beyond counting": (("[run]", "[initial]\nheading_deg = 1e300\n[run]"), ("initial.heading_deg: ",)),
    "negative payload": (
        ("[run]", "[vehicle.payload]\nmass_kg = -1\nx_m = 0\ny_m = 0\nyaw_inertia_kgm2 = 0\n[run]"),
        ("vehicle.payload.mass_kg: -1", "negative")),
    "infinite support": (
        ("[run]", "[[vehicle.support]]\nx_m = 0\ny_m = inf\n[run]"), ("vehicle.support[1].y_m: infinity",)),
    "motor without resistance": (
        ("motor_gain_Nm_per_V = 0.8\nmotor_damping_Nms = 0.05\n", "motor = {resistance_ohm = 0, "
         "torque_constant_Nm_per_A = 1, back_emf_Vs_per_rad = 1, gear_ratio = 1}\n"),
        ("vehicle.motor.resistance_ohm: 0", "above 0")),
    "motor without gear": (
        ("motor_gain_Nm_per_V = 0.8\nmotor_damping_Nms = 0.05\n", "motor = {resistance_ohm = 1, "
         "torque_constant_Nm_per_A = 1, back_emf_Vs_per_rad = 1, gear_ratio = 0}\n"),
        ("vehicle.motor.gear_ratio: 0 is zero; give a value above 0, or below 0 for a shaft that turns the other",)),
    "caster": (('kind = "mecanum"', 'kind = "caster"'), ("wheel[1].kind", "[[vehicle.support]]")),
    "swivel caster": (('kind = "omni"', 'kind = "swivel-caster"'), ("wheel[2].kind", "[[vehicle.support]]")),
    "steered wheel": (('kind = "mecanum"', 'kind = "steered"'), ("wheel[1].kind", 'steered = "coordinated"')),
    "skid-steered wheel": (('kind = "mecanum"', 'kind = "skid"'), ("wheel[1].kind", "[ground] friction_coefficient")),
    "plain wheel": (('kind = "mecanum"', 'kind = "standard"'), ("wheel[1].kind", '"fixed"')),
    "table of casters": (("[run]", "[[vehicle.caster]]\nx_m = 0\n[run]"), ("vehicle.caster[1].trail_m", "is missing")),
    "steering of a wheel": (("axle_deg = 180", "axle_deg = 180\nsteer_deg = 5"), ("wheel[2].steer_deg", "steered")),
    "no radius of a wheel": (("axle_deg = 180", "axle_deg = 180\nradius_m = 0"),
                             ("wheel[2].radius_m: is 0; give a value above 0", "take it out")),
    "negative radius of a wheel": (("axle_deg = 180", "axle_deg = 180\nradius_m = -1"),
                                   ("wheel[2].radius_m: is -1; give a value above 0", "take it out")),
    "radius of a wheel": (("axle_deg = 180", "axle_deg = 180\nradius = 1"), ("wheel[2].radius:", "radius_m")),
    "slope": (("mass_kg = 20.0", "mass_kg = 20.0\nslope_deg = 5"), ("vehicle.slope_deg", "[ground] slope_rad")),
    "suspension": (("mass_kg = 20.0", "mass_kg = 20.0\nspring_N_per_m = 5"), ("vehicle.spring_N_per_m", "rigid")),
    "output twice": (
        ("[run]", '[outputs]\nsignals = ["x_m", "y_m", "x_m"]\n[run]'), ("outputs.signals: names x_m twice",)),
    "output twice, once as one of all": (
        ("[run]", '[outputs]\nsignals = ["nu_rad_per_s", "nu_rad_per_s[2]"]\n[run]'),
        ("outputs.signals: names nu_rad_per_s[2] twice",)),
    "instant beyond the run": (
        ("t_s = [0.0, 0.5]", "t_s = [0.0, 1.5]"), ("input[1].t_s: 1.5 s lies beyond the run of 1 s", "duration_s")),
    "table that goes on beyond the run": (
        ('"steps"\nt_s = [0.0, 0.5]\nvalue = [6.0, -3.0]', '"table"\nt_s = [0, 2, 3]\nvalue = [1, 2, 3]'),
        ("input[1].t_s: 3 s lies beyond",)),
    "roller of a fixed wheel": (('kind = "mecanum"', 'kind = "fixed"'), ("wheel[1].roller_deg", "no rollers")),
    "unknown kind": (('kind = "mecanum"', 'kind = "mecanun"'), ("wheel[1].kind", "did you mean mecanum?")),
    "unknown key": (("mass_kg = 20.0", "mass_kg = 20.0\nmas_kg = 1"), ("vehicle.mas_kg", "did you mean mass_kg?")),
    "mistyped key": (("mass_kg = 20.0", "mas_kg = 20.0"), ("vehicle.mass_kg", "is missing", "you wrote mas_kg")),
    "half of a pair": (("[run]", "[[vehicle.support]]\ny_m = 1.0\n[run]"),
                       ("vehicle.support[1].x_m: is missing; give it as a number\n",)),
    "place of a force that is not there": (
        ('"voltage_V[1]"\n', '"world_force_point_m[2]"\n'),
        ("input[1].signal: world_force_point_m[2] says where a world force acts", "give world_force_N[1] or")),
    "unknown key at the top": (('name = "Four', 'colour = "red"\nname = "Four'), ("colour", "no known key")),
    "unknown key of a wheel": (("axle_deg = 180", "axle_deg = 180\nwidth_m = 1"), ("wheel[2].width_m", "known key")),
    "wheel count mismatch": (("voltage_V[1]", "voltage_V[3]"), ("input[1].signal", "2 wheels", "voltage_V[2]")),
    "unknown signal": (("voltage_V[1]", "volts[1]"), ("input[1].signal", "volts[1]")),
    "unknown input kind": (('"steps"', '"ramp"'), ("input[1].kind", "ramp")),
    "lists of different length": (("value = [6.0, -3.0]", "value = [6.0]"), ("input[1].value", "1 entries, not 2")),
    "NaN voltage": (("value = [6.0, -3.0]", "value = [6.0, nan]"), ("input[1].value", "finite")),
    "instants out of order": (("t_s = [0.0, 0.5]", "t_s = [0.5, 0.5]"), ("input[1].t_s", "ascending")),
    "instant before the start": (("t_s = [0.0, 0.5]", "t_s = [-1.0, 0.5]"), ("input[1].t_s", "begins at 0")),
    "change inside a step": (("t_s = [0.0, 0.5]", "t_s = [0.0, 0.5049]"), ("input[1].t_s", "0.5049", "would do")),
    "text for a number": (("mass_kg = 20.0", 'mass_kg = "20"'), ("vehicle.mass_kg", "not a number")),
    "true for a number": (("mass_kg = 20.0", "mass_kg = true"), ("vehicle.mass_kg", "true")),
    "number for a text": (('source = "a test"', "source = 3"), ("source", "not text")),
    "both angles": (("axle_deg = 180", "axle_deg = 180\naxle_rad = 3"), ("wheel[2].axle_deg", "keep one")),
    "both places": (("distance_m = 0.2", "distance_m = 0.2\nx_m = 1"), ("wheel[2].distance_m", "x_m")),
    "motor twice": (("[run]", "[vehicle.motor]\nresistance_ohm = 1\n[run]"), ("motor_gain_Nm_per_V", "keep one")),
    "motor and a gain": (("motor_damping_Nms = 0.05", "[vehicle.motor]\nresistance_ohm = 1"),
                         ("motor_gain_Nm_per_V: is given besides [vehicle.motor]; keep one of them",)),
    "zero duration": (("duration_s = 1.0", "duration_s = 0"), ("run.duration_s", "value above 0")),
    "negative step": (("step_s = 0.01", "step_s = -0.01"), ("run.step_s", "value above 0")),
    "more steps than a count holds": (("duration_s = 1.0", "duration_s = 1e14"), ("run.duration_s", "shorter time")),
    "more rows than memory holds": (("duration_s = 1.0", "duration_s = 1e9"), ("outputs.every_s", "10000000 or fewer")),
    "date for a number": (("mass_kg = 20.0", "mass_kg = 2026-01-02"), ("vehicle.mass_kg: is 2026-01-02, not",)),
    "start beyond the range": (
        ("[run]", "[initial]\nnu_rad_per_s = [1e300, 1e300, 1e300]\n[run]"), ("initial.nu_rad_per_s: ", "range")),
    "sine too fast to have a value": (
        ('"steps"\nt_s = [0.0, 0.5]\nvalue = [6.0, -3.0]', '"sine"\namplitude = 1\nfrequency_Hz = 1e308'),
        ("input[1].frequency_Hz: 1e+308 Hz",)),
    "step does not fit": (("step_s = 0.01", "step_s = 0.03"), ("run.duration_s", "0.03 s", "step of 0.02941176470")),
    "unknown method": (("[run]", '[run]\nmethod = "rk5"'), ("run.method", f"did you mean {EXPLICIT}?")),
    "unknown scalar type": (("[run]", '[run]\nreal = "half"'), ("run.real", "half")),
    "unknown output": (("[run]", '[outputs]\nsignals = ["speed"]\n[run]'), ("outputs.signals", "speed")),
    "outputs between steps": (("[run]", "[outputs]\nevery_s = 0.015\n[run]"), ("outputs.every_s", "would do")),
    "velocity twice": (
        ("[run]", "[initial]\nnu_rad_per_s = [0,0,0]\nyaw_rate_rad_per_s = 1\n[run]"), ("yaw_rate_rad_per_s", "keep")),
    "explicit step too large": (
        ("motor_damping_Nms = 0.05", "motor_damping_Nms = 50.0"), ("run.step_s", "use at most")),
    "identifier too large": (("[run]", "[rig]\nid_base = 4096\n[run]"), ("rig.id_base", "0x7FF")),
    "no valid TOML": (("mass_kg = 20.0", "mass_kg = "), ("no valid TOML", "line 5")),
}


def complaint(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> str:
    """The one line that a command prints for bad input."""
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1, captured.err
    assert captured.err.endswith("\n")
    return captured.err


@pytest.mark.parametrize(("change", "words"), BAD.values(), ids=BAD.keys())
@pytest.mark.filterwarnings("error")  # a warning would be a second line
def test_bad_scene_is_one_line_with_file_field_and_remedy(change, words, tmp_path, capsys):
    old, new = change
    text = GOOD.replace(old, new, 1)
    assert text != GOOD
    path = tmp_path / "scene.toml"
    path.write_text(text)
    explicit = [] if "method" in text else ["--method", EXPLICIT]
    line = complaint(capsys, ["simulate", str(path), *explicit])
    assert str(path) in line
    for word in words:
        assert word in line


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("kind", "t_s", "value"), [("steps", [0.0, 0.5], [6.0, 1e39]),
                                                    ("table", [0.5, 0.51], [0.0, 1e39])])  # at the end of the step
def test_an_input_beyond_single_precision_is_named_with_its_time(kind, t_s, value, tmp_path, capsys):
    path = tmp_path / "scene.toml"
    old = 'kind = "steps"\nt_s = [0.0, 0.5]\nvalue = [6.0, -3.0]'
    path.write_text(GOOD.replace(old, f'kind = "{kind}"\nt_s = {t_s}\nvalue = {value}'))
    line = complaint(capsys, ["simulate", str(path), "--real", "single"])
    assert f"{path}: at t = 0.5 s: voltage_V[1]: infinity is not a finite number" in line


def test_analyse_reports_when_a_step_is_refused(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(GOOD.replace("-3.0", "-1e300"))
    assert f"{path}: at t = 0.5 s: " in complaint(capsys, ["analyse", str(path), "--only", "traction"])


def test_a_start_that_slides_a_fixed_wheel(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(GOOD.replace('"omni"', '"fixed"') + "[initial]\nnu_rad_per_s = [1.0, 1.0, 1.0]\n")
    line = complaint(capsys, ["simulate", str(path)])
    assert str(path) in line
    assert "initial.nu_rad_per_s[" in line


def test_a_start_that_slides_a_fixed_wheel_is_reported_by_the_keys_that_were_given(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    start = "[initial]\nvelocity_body_m_per_s = [0.2, 0.1]\n"
    path.write_text(GOOD.replace('"omni"', '"fixed"').replace("axle_deg = 180", "axle_deg = 90") + start)
    line = complaint(capsys, ["simulate", str(path)])
    assert "initial.velocity_body_m_per_s[2]: 0.1 " in line
    allowed = float(line.split()[-1])
    path.write_text(path.read_text().replace("0.1]", f"{allowed}]"))
    assert abs(allowed) < 0.1


def test_the_good_scene_is_good(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(GOOD)
    assert run(["simulate", str(path)]) == 0
    assert capsys.readouterr().err == ""


def test_a_scene_that_is_not_there(capsys):
    assert "no such scene file" in complaint(capsys, ["simulate", "nowhere/to/be/found.toml"])


def test_a_misspelt_scene_of_the_project(capsys):
    assert "did you mean robotino2?" in complaint(capsys, ["simulate", "robotino"])


def test_a_folder_is_no_scene(tmp_path, capsys):
    assert "cannot be read" in complaint(capsys, ["simulate", str(tmp_path)])


@pytest.mark.skipif(os.geteuid() == 0 if hasattr(os, "geteuid") else True, reason="root may read every file")
def test_an_unreadable_file(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(GOOD)
    path.chmod(0)
    assert "cannot be read" in complaint(capsys, ["simulate", str(path)])


def test_a_file_that_is_no_text(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xff\xfe\x00")
    assert "UTF-8" in complaint(capsys, ["simulate", str(path)])


def test_a_file_saved_with_a_byte_order_mark_is_read(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text("\ufeff" + GOOD, encoding="utf-8")
    assert run(["simulate", str(path)]) == 0


def test_lists_in_lists_without_end(tmp_path, capsys):
    path = tmp_path / "deep.toml"
    path.write_text("x = " + 20_000 * "[" + 20_000 * "]")
    assert "too deeply" in complaint(capsys, ["simulate", str(path)])
    assert "no valid JSON" in complaint(capsys, ["verify", str(path)])
    path.write_text(200_000 * "[")
    assert "no valid JSON" in complaint(capsys, ["verify", str(path)])


@pytest.mark.parametrize("arguments", [["simulate"], ["verify"], ["replay", "robotino2"], ["derive"]])
def test_a_name_too_long_for_a_file(arguments, capsys):
    command, *more = arguments
    line = complaint(capsys, [command, 5000 * "a", *more])
    assert "no such scene file" in line or "too long" in line


def test_too_many_wheels(tmp_path, capsys):
    wheel = '[[vehicle.wheel]]\nkind = "omni"\nx_m = 0.1\ny_m = 0.1\naxle_rad = 0.3\n'
    path = tmp_path / "scene.toml"
    path.write_text(GOOD.replace("[[input]]", 16 * wheel + "[[input]]"))
    line = complaint(capsys, ["simulate", str(path)])
    assert "18" in line
    assert "16" in line
    assert str(path) in line


@pytest.mark.parametrize("step", ["0", "-1", "nan", "inf"])
def test_a_step_on_the_command_line_that_is_none(step, capsys):
    assert "--step" in complaint(capsys, ["simulate", "s1", "--step", step])


@pytest.mark.parametrize("arguments", [["simulat", "s1"], ["simulate"], ["simulate", "s1", "--stp", "1"],
                                       ["simulate", "s1", "--method", "euler"], ["--nonsense"]])
def test_a_wrong_command_line(arguments, capsys):
    assert "--help" in complaint(capsys, arguments)


@pytest.mark.parametrize(("arguments", "words"), [
    (["derive", "s1", "--c", "--latex"], ("--latex --c", "give one")),
    (["analyse", "s1", "--at", "nan"], ("--at nan", "give 0 to 10 s")),
    (["analyse", "s1", "--at", "11"], ("--at 11", "give 0 to 10 s")),
    (["simulate", "s1", "--plot", "picture"], ("picture", "ends in .png")),
    (["rig", "s1", "--lockstep", "--free-run"], ("--lockstep --free-run", "give one")),
    (["rig", "s1", "--same-bits", "--tolerance", "x=1"], ("--same-bits --tolerance", "give one")),
    (["rig", "s1", "--same-bits", "--replay", "run.blf"], ("--same-bits --replay", "give one")),
    (["rig", "s1", "--rate", "100"], ("--rate", "add --free-run")),
    (["rig", "s1", "--same-bits", "--watchdog", "5"], ("--watchdog", "add --free-run")),
    (["rig", "s1", "--every", "5"], ("--every", "add --same-bits")),
    (["rig", "s1", "--free-run", "--fd"], ("--fd", "add --same-bits")),
    (["rig", "s1", "--free-run", "--rate", "7"], ("run.step_s: 7 periods a second", "choose another --rate")),
    (["rig", "s1", "--tolerance", "nu_4=1"], ("--tolerance nu_4=1: there is no signal nu_4", "nu_")),
    (["rig", "s1", "--tolerance", "NU.wheel_speed_4=1"], ("no signal NU.wheel_speed_4", "wheel_speed_3")),
    (["rig", "s1", "--interface", "slcan"], ("--interface slcan", "without --channel")),
    (["rig", "s1", "--interface", "slcan", "--channel", "socket://here"], ("socket://here", "HOST:PORT"))])
def test_options_that_mean_nothing(arguments, words, capsys):
    line = complaint(capsys, arguments)
    for word in words:
        assert word in line


@pytest.mark.parametrize(("arguments", "place"), [
    (["trim", "s1", "--out"], "file"), (["trim", "s1", "--out"], "file/inside"),
    (["derive", "--example", "caster", "-o"], "file/inside.txt")])
def test_a_folder_that_is_a_file(arguments, place, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    line = complaint(capsys, [*arguments, str(tmp_path / place)])
    assert f"{tmp_path / place}: cannot be written" in line
    assert "choose another" in line


@pytest.mark.parametrize("option, ending", [("--out", ".csv"), ("--plot", ".png")])
def test_a_place_that_cannot_be_written(option, ending, tmp_path, capsys):
    blocked = tmp_path / "file"
    blocked.write_text("")
    line = complaint(capsys, ["simulate", "s1", option, str(blocked / f"inside{ending}")])
    assert str(blocked) in line
    assert "cannot be written" in line


def test_the_command_itself_ends_with_status_2():
    done = subprocess.run([sys.executable, "-m", "laconic", "simulate", "nowhere.toml"], capture_output=True,
                          text=True, check=False, cwd=Path(__file__).parents[3])
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)


def test_angles_in_degrees_are_the_same_as_in_radians(tmp_path, capsys):
    def final(text: str) -> str:
        path = tmp_path / "scene.toml"
        path.write_text(text)
        assert run(["simulate", str(path), "--out", "-"]) == 0
        return capsys.readouterr().out

    in_radians = GOOD.replace("axle_deg = -90", f"axle_rad = {-math.pi / 2!r}")
    in_radians = in_radians.replace("roller_deg = 45", f"roller_rad = {math.pi / 4!r}")
    assert final(in_radians) == final(GOOD)
