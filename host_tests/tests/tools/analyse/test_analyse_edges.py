"""Edges of `laconic analyse`: rounding taken for motion, warnings, names beyond the margin, older pages."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from matplotlib import pyplot as plt

from laconic.cli import main as cli
from laconic.pictures.curves import wrapped
from laconic.pictures.plotting import figure, save
from laconic.scene import read_scene
from laconic.tools.analyse.analyse import analyse, study
from laconic.tools.analyse.bifurcation_part import bifurcation_part
from laconic.tools.analyse.continuation import diagram
from laconic.tools.analyse.findings import Study, StudyOptions
from laconic.tools.analyse.from_core import Subject, subject_of
from laconic.tools.analyse.geometry import diagnose
from laconic.tools.analyse.motions import command_parameter, default_range, vehicle_parameter
from laconic.tools.analyse.pictures_steady import bifurcation_picture
from laconic.tools.analyse.speeds import HEADROOM, largest_nu
from laconic.tools.report.pictures import svg
from scene_text import constant, wheel

SIDEWAYS = ["turtlebot3_burger", "--only", "steady"]
ODD_NAMES = {"one word": "x" * 5000, "words": "wheel " * 900, "capitals": "WHEEL " * 900, "all of capitals": "Q" * 300,
             "wide": "W" * 300}


def offset_mecanum() -> str:
    """Four mecanum wheels, the centre of mass beside their middle: straight motion turns by rounding alone."""
    wheels = "".join(f'[[vehicle.wheel]]\nkind = "mecanum"\nx_m = {x}\ny_m = {y}\naxle_deg = -90\nroller_deg = {r}\n'
                     for x, y, r in ((0.319, 0.2755, 45), (0.319, -0.2755, -45), (-0.319, 0.2755, -45),
                                     (-0.319, -0.2755, 45)))
    inputs = "".join(f'[[input]]\nsignal = "voltage_V[{k}]"\nkind = "steps"\nt_s = [0.0]\nvalue = [12.0]\n'
                     for k in range(1, 5))
    return ("[vehicle]\nmass_kg = 135.0\nyaw_inertia_kgm2 = 13.5\ncom_x_m = 0.02\ncom_y_m = -0.01\n"
            "wheel_radius_m = 0.0759\nwheel_inertia_kgm2 = 0.02\nmotor_gain_Nm_per_V = 3.43\n"
            f"motor_damping_Nms = 4.1\n{wheels}[vehicle.payload]\nmass_kg = 60\nx_m = 0.1\ny_m = 0.05\n"
            f"yaw_inertia_kgm2 = 2.0\n{inputs}[run]\nduration_s = 1.0\nstep_s = 0.01\n")


def subject_from(tmp_path, text: str) -> Subject:
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return subject_of(read_scene(path))


def test_lines_of_a_text_beside_formulas_are_no_letters_without_a_glyph(caplog, recwarn, tmp_path):
    picture = figure(2.0, 2.0)
    text = picture.suptitle("$\\nu_1$: one\n$\\nu_2$: another")
    save(picture, tmp_path / "picture.png")
    assert not caplog.records
    assert not recwarn.list
    assert text.get_parse_math()


def test_a_name_with_dollars_that_is_no_formula_is_drawn_in_a_page_too():
    picture = figure(2.0, 2.0)
    picture.suptitle("robot for $5^$\nsecond line")
    assert "robot for $5^$" in svg(picture)


def test_a_straight_motion_that_turns_by_rounding_alone_has_no_yaw_rate(tmp_path):
    found = Study(subject_from(tmp_path, offset_mecanum()))
    bifurcation_part(found, StudyOptions(("bifurcation",)))
    raw = np.array([motion.nu[2] for branch in found.bifurcation.diagram.branches for motion in branch.motion])
    assert raw.any()  # else this scene tests nothing
    picture = bifurcation_picture(found)
    yaw = np.concatenate([line.get_ydata() for line in picture.axes[0].lines if len(line.get_ydata()) > 2])
    low, high = picture.axes[0].get_ylim()
    plt.close(picture)
    assert not yaw.any()
    assert high - low > 1e-3


@pytest.mark.parametrize(("option", "nearest"), [(["--straight", "0", "5"], "0 0"), (["--start", "0", "5", "0"],
                                                                                     "0 0 0")])
def test_motion_that_the_constraints_forbid_is_refused_with_the_nearest_they_allow(capsys, option, nearest):
    assert cli.run(["analyse", *SIDEWAYS, *option]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert re.fullmatch(rf"laconic: {option[0]}: the constraints forbid .*; the nearest allowed one is {nearest}\n",
                        printed.err)


def test_varying_a_motion_that_the_constraints_forbid_is_refused(capsys):
    options = ["--only", "bifurcation", "--straight", "5", "0", "--parameter", "nu2"]
    assert cli.run(["analyse", "turtlebot3_burger", *options]) == 2
    assert "--parameter nu2: the constraints forbid" in capsys.readouterr().err


def test_without_motors_no_sentence_lets_them_drive_or_damp(tmp_path):
    text = re.sub(r"motor_.*\n", "", offset_mecanum()).split("[[input]]")[0]
    words = " ".join(diagnose(subject_from(tmp_path, text + "[run]\nduration_s = 1.0\nstep_s = 0.01\n")).words)
    assert "there are no motors" in words
    assert "the motors" not in words


def test_the_yaw_authority_is_explained_and_an_unusual_one_has_its_remedy(tmp_path):
    usual = " ".join(diagnose(subject_from(tmp_path, offset_mecanum())).words)
    assert "1.41, that is the rim speed in yaw, over" in usual
    assert "check" not in usual
    wheels = "".join(f'[[vehicle.wheel]]\nkind = "mecanum"\nx_m = {x}\ny_m = {y}\naxle_deg = -90\nroller_deg = {r}\n'
                     for x, y, r in ((0.3, 0.3, 15), (0.3, -0.3, -15), (-0.3, 0.3, -15), (-0.3, -0.3, 15)))
    text = re.sub(r"\[\[vehicle.wheel\]\].*?\[vehicle.p", wheels + "[vehicle.p", offset_mecanum(), flags=re.DOTALL)
    unusual = " ".join(diagnose(subject_from(tmp_path, text)).words)
    assert "strong but slow" in unusual and "check the positions" in unusual


@pytest.mark.parametrize("name", ODD_NAMES.values(), ids=ODD_NAMES)
@pytest.mark.parametrize(("letters", "inches", "size"), [(68, 7.2, 11), (44, 4.5, 11), (110, 12.0, 12)])
def test_a_title_of_any_name_stays_within_the_picture_and_ends_in_an_ellipsis(name, letters, inches, size):
    picture = figure(inches, 3.0)
    text = picture.suptitle(wrapped(name, letters, "what it shows"), fontsize=size)
    width = text.get_window_extent(picture.canvas.get_renderer()).width
    plt.close(picture)
    assert width <= picture.bbox.width
    assert len(text.get_text().splitlines()) <= 4
    assert "…: what it shows" in text.get_text().replace("\n", " ")


def test_a_short_name_stands_in_one_line_with_its_description():
    assert wrapped("Robot", 40, "auto, step 0.01 s") == "Robot: auto, step 0.01 s"


def test_a_new_page_takes_away_the_older_pages_pictures_and_nothing_else(capsys, tmp_path):
    assert cli.run(["analyse", "paper_three_wheel_free", "--only", "free", "--out", str(tmp_path)]) == 0
    older = {path.name for path in tmp_path.glob("*.png")}
    assert older
    (tmp_path / "bifurcation.png").write_text("the user's own, though of one of the tool's names")
    (tmp_path / "mine.png").write_text("the user's own")
    capsys.readouterr()
    assert cli.run(["analyse", "paper_three_wheel_free", "--only", "geometry", "--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.glob("*.png")} == {"bifurcation.png", "mine.png"}
    printed = capsys.readouterr().err
    assert all(name in printed for name in older)
    assert json.loads((tmp_path / "report.json").read_text())["pictures"] == []


def test_the_worst_use_of_the_friction_cone_is_told_with_its_wheel_and_instant() -> None:
    study = analyse(read_scene("example_two_wheel_sizes"), ["traction"])
    traction = study.traction
    assert traction is not None and traction.first_slip_s is not None
    instant, wheel = np.unravel_index(np.nanargmax(traction.use), traction.use.shape)
    assert f"wheel {wheel + 1} at {traction.time_s[instant]:.4g} s)" in study.words["traction"][-1]
    assert f"(up to {100 * traction.use[instant, wheel]:.0f} % of the friction cone, " in study.words["traction"][-1]


# ---- Ranges and words of `laconic analyse` are those of a vehicle: speeds that it can reach, in m/s beside rad/s.

MECANUM = [(0.319, 0.2755, 45), (0.319, -0.2755, -45), (-0.319, 0.2755, -45), (-0.319, -0.2755, 45)]
ROLL_M, VOLTS = 0.0759, 12.0
SPEED = VOLTS / (0.06 * 20.0)  # of a wheel whose motor balances its own back-EMF [rad/s]


@pytest.fixture
def base(tmp_path):
    """A mecanum base of 135 kg with strong motors, that drives ahead."""
    wheels = "".join(wheel("mecanum", x, y, axle_deg=-90.0, roller_deg=g) for x, y, g in MECANUM)
    inputs = "".join(constant(f"voltage_V[{i}]", VOLTS) for i in range(1, 5))
    path = tmp_path / "base.toml"
    path.write_text(f"""name = "base"
source = "numbers of this test"
[vehicle]
mass_kg = 135.0
yaw_inertia_kgm2 = 14.3
com_x_m = 0.03
wheel_radius_m = {ROLL_M}
wheel_inertia_kgm2 = 0.04
[vehicle.motor]
resistance_ohm = 0.3
torque_constant_Nm_per_A = 0.06
back_emf_Vs_per_rad = 0.06
gear_ratio = 20.0
viscous_friction_Nms = 0.0
rotor_inertia_kgm2 = 0.0
{wheels}{inputs}[run]
duration_s = 2.0
step_s = 0.001
""")
    return path


def test_a_bases_bifurcation_range_is_what_its_motors_reach_and_not_kilometres_a_second(base, capsys):
    assert cli.run(["analyse", str(base), "--only", "bifurcation", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["bifurcation"]
    assert found["reach_rad_per_s"] == pytest.approx(HEADROOM * SPEED, rel=1e-6)
    assert (found["from"], found["to"]) == pytest.approx((-HEADROOM * SPEED, HEADROOM * SPEED), rel=1e-6)
    assert found["to_m_per_s"] == pytest.approx(ROLL_M * found["to"])
    assert abs(found["straight_thresholds"][0]) > 100.0 * found["to"]  # it exists, and stays in the numbers


def test_a_change_of_stability_out_of_reach_is_reported_with_its_speed_and_not_drawn(base, capsys):
    assert cli.run(["analyse", str(base), "--only", "bifurcation"]) == 0
    out = capsys.readouterr().out
    assert "out of reach" in out
    assert " m/s)" in out
    assert "Fold" not in out


def test_steady_and_free_motions_are_reported_in_metres_a_second_too(base):
    found = study(subject_of(read_scene(base)), StudyOptions(("steady", "free")), lambda *_: None)
    assert any(f"({ROLL_M * SPEED:.4g}, 0) m/s" in words for words in found.words["steady"])
    assert all("m/s" in words[0] for words in found.words.values())


def test_reach_counts_every_input_at_its_largest_whatever_its_kind_and_sign():
    subject = subject_of(read_scene("s1"))
    field = subject.field({"voltage_V[1]": 2.0})
    expected = np.abs(field.nu(field.forcing / field.decay_per_s))
    for name, value in (("voltage_V[2]", 2.0), ("voltage_V[3]", 1.0)):
        field = subject.field({name: value})
        expected += np.abs(field.nu(field.forcing / field.decay_per_s))
    assert largest_nu(subject) == pytest.approx(expected)


def test_a_straight_motion_that_the_user_gives_is_always_within_the_range():
    subject = subject_of(read_scene("turtlebot3_burger"))
    low, high = default_range(command_parameter(subject, "nu1", np.array([500.0, 0.0, 0.0])))
    assert low < 0.0 < 500.0 < high <= HEADROOM * 500.0


def test_the_centre_of_mass_is_varied_within_the_vehicle():
    subject = subject_of(read_scene("turtlebot3_burger"))
    low, high = default_range(vehicle_parameter(subject, "com_y_m"))
    assert max(abs(low), abs(high)) < 0.08  # half the track


# ---- A scene that stands at a bifurcation, or a little beside it, is reported as it is and never "not confirmed".

@pytest.fixture(scope="module")
def subject():
    return subject_of(read_scene("paper_three_wheel_hopf"))


@pytest.fixture(scope="module")
def hopf(subject) -> float:
    parameter = command_parameter(subject, "nu2", np.array([0.0, 112.5, 0.0]))
    return float(diagram(parameter.field_of, 115.0, 121.0, grid=5).hopf[0].parameter)


@pytest.fixture(scope="module")
def at_hopf(subject, hopf):
    return at(subject, hopf)


def at(subject, command):
    return study(subject, StudyOptions(("steady", "bifurcation"), straight=(0.0, command)), lambda *_: None)


def test_a_scene_at_a_hopf_point_is_not_a_failure(at_hopf):
    assert at_hopf.failures == []


@pytest.mark.parametrize("beside", [
    1e-6, *(pytest.param(each, marks=pytest.mark.nightly) for each in (-1e-6, -1e-4, 1e-4))])
def test_a_scene_a_little_beside_a_hopf_point_is_not_a_failure(subject, hopf, beside):
    assert at(subject, hopf * (1.0 + beside)).failures == []


def test_a_scene_at_a_hopf_point_is_reported_and_gets_no_cycle_without_size(at_hopf, hopf):
    found = at_hopf
    assert any("stands at the Andronov–Hopf point" in words for words in found.words["bifurcation"])
    assert all(abs(item.cycle.parameter - hopf) > 1.0 for item in found.bifurcation.cycles)


def test_a_scene_well_beside_a_hopf_point_still_gets_its_own_cycle_simulated(subject, hopf):
    found = at(subject, 0.99 * hopf)
    (own, *_) = [item for item in found.bifurcation.cycles if abs(item.cycle.parameter - 0.99 * hopf) < 1e-9]
    assert own.confirmation.simulated
    assert "started at 0.9" in own.confirmation.words
    assert not any("stands at" in words for words in found.words["bifurcation"])


@pytest.mark.parametrize("beside", [0.0, -1e-6, 1e-5])
def test_a_scene_at_the_threshold_of_straight_motion_is_not_a_failure(subject, beside):
    assert at(subject, 1.6 * (1.0 + beside)).failures == []
