"""`laconic analyse` and `laconic derive` as commands: every scene, clear words, exit statuses, pictures."""

import json
import time

import pytest
from matplotlib import image

from laconic.cli import main as cli
from laconic.scene import read_scene
from laconic.tools.analyse.analyse import study
from laconic.tools.analyse.findings import StudyOptions
from laconic.tools.analyse.from_core import subject_of
from laconic.tools.analyse.pictures_steady import driven_picture
from scene_text import ideal_scene_names

SCENES = ideal_scene_names()
QUICK = ("kuka_youbot",)


def run(capsys, *arguments):
    status = cli.run(list(arguments))
    captured = capsys.readouterr()
    return status, captured.out, captured.err


@pytest.mark.parametrize("scene", [pytest.param(name, marks=[] if name in QUICK else [pytest.mark.nightly])
                                   for name in SCENES])
def test_analyse_answers_for_every_scene_in_under_ten_seconds_of_processor_time(capsys, scene):
    start = time.process_time()
    status, out, _ = run(capsys, "analyse", scene, "--json")
    assert time.process_time() - start < 10.0
    found = json.loads(out)
    assert status == 0
    assert found["failures"] == []
    for part in ("geometry", "free", "steady", "bifurcation", "traction"):
        assert found["words"][part], f"no sentence about {part}"


def test_analyse_writes_report_and_pictures_that_can_be_opened(capsys, tmp_path):
    status, _, _ = run(capsys, "analyse", "paper_three_wheel_driven", "--out", str(tmp_path / "new"))
    names = {path.name for path in (tmp_path / "new").iterdir()}
    assert status == 0
    assert names == {"report.md", "report.json", "portrait.png", "path.png", "bifurcation.png", "eigenvalues.png",
                     "driven_portrait.png", "traction.png"}
    for name in names:
        if name.endswith(".png"):
            assert min(image.imread(tmp_path / "new" / name).shape[:2]) > 400


def test_fig_4_is_one_command_with_ellipses_about_k_over_a33(capsys, tmp_path):
    status, out, _ = run(capsys, "analyse", "paper_three_wheel_free", "--only", "free", "--start", "0", "13", "2",
                         "--out", str(tmp_path), "--json")
    found = json.loads(out)["free"]
    assert status == 0
    assert found["kind"] == "periodic"
    assert found["ellipse_centre_rad_per_s"] == pytest.approx(2.0, rel=1e-12)
    assert (tmp_path / "portrait.png").exists()


def test_fig_5_is_one_command_with_the_vertex_where_the_formula_states(capsys, tmp_path):
    status, out, _ = run(capsys, "analyse", "paper_three_wheel_driven", "--only", "bifurcation", "--straight", "3",
                         "12", "--out", str(tmp_path), "--json")
    found = json.loads(out)["bifurcation"]
    fold = next(special for special in found["specials"] if special["kind"] == "fold")
    sigma, rho, big, c = 0.5, 0.4, 3.0, 0.8
    square = rho**2 + 2 * sigma**2
    assert status == 0
    vertex = 2 * c * big * sigma**2 / rho - rho * 9.0 / (8 * c * big * square)
    assert fold["parameter"] == pytest.approx(vertex, abs=1e-9)
    assert fold["nu"][2] == pytest.approx(-rho * 3.0 / (2 * square), abs=1e-6)
    assert (tmp_path / "bifurcation.png").exists()


def test_hopf_scene_reports_subcritical_and_an_unstable_cycle_confirmed_by_the_core(capsys):
    status, out, _ = run(capsys, "analyse", "paper_three_wheel_hopf", "--only", "bifurcation", "--json")
    found = json.loads(out)["bifurcation"]
    assert status == 0
    assert json.loads(out)["failures"] == []
    assert [point["kind"] for point in found["hopf"]] == ["subcritical", "subcritical"]
    assert found["cycles"]
    assert all(cycle["confirmed"] and not cycle["stable"] for cycle in found["cycles"])


@pytest.mark.parametrize(("parameter", "low", "high"), [
    ("com_y_m", "-0.02", "0.05"), pytest.param("input_scale", "0", "2", marks=pytest.mark.nightly)])
def test_diagram_over_another_parameter(capsys, parameter, low, high):
    status, out, _ = run(capsys, "analyse", "paper_three_wheel_driven", "--only", "bifurcation", "--parameter",
                         parameter, "--from", low, "--to", high, "--json")
    found = json.loads(out)["bifurcation"]
    assert status == 0
    assert found["parameter"] == parameter
    assert len(found["branches"]) >= 2


@pytest.mark.parametrize(("scene", "part", "word"), [
    ("paper_three_wheel_free", "bifurcation", "do not damp"),
    ("paper_caster", "steady", "fixed in the world"),
    ("paper_caster", "traction", "cannot hold the body upright"),
    ("kuka_youbot", "free", "No phase portrait"),
])
def test_question_that_makes_no_sense_gets_clear_words(capsys, scene, part, word):
    status, out, _ = run(capsys, "analyse", scene, "--only", part, "--json")
    assert status == 0
    assert any(word in sentence for sentence in json.loads(out)["words"][part])


def test_one_steady_motion_alone_is_drawn_with_motions_that_lead_to_it():
    found = study(subject_of(read_scene("paper_differential_drive"), 5.0), StudyOptions(("steady",)), lambda *_: None)
    (steady,) = found.steady.motions
    (axes,) = driven_picture(found).axes
    runs = [line.get_xdata() for line in axes.lines if len(line.get_xdata()) > 100]
    assert steady.stability == "stable"
    assert len(runs) > 10
    assert all(abs(run[0] - steady.nu[2]) > 5 * abs(run[-1] - steady.nu[2]) for run in runs)
    assert "unstable steady motion" not in [line.get_label() for line in axes.lines]


@pytest.mark.parametrize(("arguments", "words"), [
    (("analyse", "nowhere"), "no such scene"),
    (("analyse", "s1", "--parameter", "colour"), "known are"),
    (("analyse", "s1", "--at", "1e9"), "--at"),
    (("analyse", "s1", "--from", "2", "--to", "1"), "smaller number first"),
    (("analyse", "s1", "--from", "nan"), "finite"),
    (("analyse", "paper_differential_drive", "--start", "1", "2", "3"), "constraints forbid"),
    (("analyse", "s1", "--parameter", "mass_kg", "--from", "-1", "--to", "2"), "mass_kg"),
    (("analyse", "s1", "--only", "geometry", "--out", "/dev/null/x"), "cannot be written"),
    (("derive",), "SCENE or --example"),
    (("derive", "--example", "caster", "--c"), "needs a scene"),
    (("derive", "s1", "-o", "/dev/null/x.txt"), "cannot be written"),
])
def test_bad_input_is_one_clear_line_and_exit_status_2(capsys, arguments, words):
    status, _, err = run(capsys, *arguments)
    lines = [line for line in err.splitlines() if line.startswith("laconic: ")]
    assert status == 2
    assert len(lines) == 1
    assert words in lines[0]


def test_analysis_that_the_core_does_not_confirm_is_exit_status_1(capsys, monkeypatch):
    from laconic.tools.analyse import confirm

    monkeypatch.setattr(confirm, "steady_motion", lambda *_: confirm.Confirmation(False, "it went elsewhere"))
    status, out, err = run(capsys, "analyse", "s1", "--only", "steady")
    assert status == 1
    assert "## Not confirmed" in out
    assert "not confirmed" in err


def test_derivation_that_contradicts_itself_is_exit_status_1(capsys, monkeypatch):
    from laconic.tools.derive import scene_check

    monkeypatch.setattr(scene_check, "forms_difference", lambda *_: 1e-3)
    status, _, err = run(capsys, "derive", "--example", "caster")
    assert status == 1
    assert "contradicts itself" in err


@pytest.mark.parametrize("form", [(), ("--c",), pytest.param(("--latex",), marks=pytest.mark.nightly)])
def test_derive_prints_and_checks_against_the_core(capsys, form):
    status, out, err = run(capsys, "derive", "turtlebot3_burger", *form)
    assert status == 0
    assert len(out) > 200
    assert "derived equations and the C core's derivative differ" in err


@pytest.mark.parametrize("example", [
    "caster", "differential-drive",
    *(pytest.param(name, marks=pytest.mark.nightly) for name in ("carriage", "trailer"))])
def test_derive_prints_the_worked_examples(capsys, example):
    status, out, _ = run(capsys, "derive", "--example", example, "--json")
    found = json.loads(out)
    assert status == 0
    assert "laconic equations (2.4)" in found["text"]
    assert all(value < 1e-12 for value in found["checks"].values())


@pytest.mark.parametrize("command", ["analyse", "derive"])
def test_a_vehicle_with_friction_is_refused_in_one_line(command, capsys):
    assert cli.run([command, "robotino_grey"]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "robotino_grey.toml" in line
    assert "ideal ground" in line
