"""Edges of `laconic analyse`: rounding taken for motion, warnings, names beyond the margin, older pages."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from matplotlib import pyplot as plt

from laconic.cli import main as cli
from laconic.pictures.curve_style import wrapped
from laconic.pictures.plotting import figure, save
from laconic.scene import read_scene
from laconic.tools.analyse.analyse import analyse
from laconic.tools.analyse.bifurcation_part import bifurcation_part
from laconic.tools.analyse.findings import Study, StudyOptions
from laconic.tools.analyse.from_core import Subject, subject_of
from laconic.tools.analyse.geometry import diagnose
from laconic.tools.analyse.pictures_steady import bifurcation_picture
from laconic.tools.report.svg import svg

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
