"""`laconic report --scene X` is about that robot, first and only; the project's goals are a page of their own."""

import contextlib
import io
import json
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib import pyplot as plt

import friction_scenes
from laconic.base.paths import SCENE_DIR
from laconic.cli import main as cli
from laconic.errors import Refused
from laconic.pictures.curves import METHOD_STYLES
from laconic.scene import METHODS, read_scene
from laconic.scene.methods import EXACT, EXACT_4, EXPLICIT, EXPLICIT_8
from laconic.tools.report import accuracy, pictures, robot
from laconic.tools.report.collect import PARTS
from laconic.tools.report.pictures import SIZE, plan, svg
from laconic.tools.report.writing import write

pytestmark = pytest.mark.nightly

SCENE = "turtlebot3_burger"
PHONE_CSS_PX, CSS_PX_PER_INCH = 390, 96


def without_layout(picture):
    """A picture as SVG text whose parts may lie over each other: the layout, half of the time, is tested below."""
    picture.set_layout_engine("none")
    return svg(picture)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The page of one robot: no board, one second of its run, two strengths of its motors; the rest takes long."""
    folder = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(robot, "M4F", SimpleNamespace(present=False))
        patch.setattr(robot, "QUICK_FACTORS", (0.1, 1.0))
        patch.setattr("laconic.cli.commands.report.read_scene", lambda name: read_scene(name).with_run(duration_s=1.0))
        patch.setattr("laconic.tools.report.stability.SEGMENTS", 1)
        patch.setattr("laconic.tools.report.robot.mapped", lambda rows: ["auto"])
        for drawing in ("pictures", "plan"):
            patch.setattr(f"laconic.tools.report.{drawing}.svg", without_layout)
        with contextlib.redirect_stdout(io.StringIO()) as out:
            status = cli.run(["report", "--quick", "--scene", SCENE, "--out", str(folder), "--json"])
    return status, folder, out.getvalue()


def test_the_page_of_a_robot_opens_with_it_and_shows_no_other_scene_and_no_goal(made):
    status, folder, _ = made
    page = (folder / "index.html").read_text()
    words = re.sub(r"<style>.*?</style>|<svg.*?</svg>", "", page, flags=re.DOTALL)
    others = {path.stem for path in SCENE_DIR.glob("*.toml")} - {SCENE}
    assert status == 0
    assert re.search(r"<h1>(.*?)</h1>", page)[1] == read_scene(SCENE).name
    assert re.search(r"<h2[^>]*>(.*?)</h2>", page)[1] == "The robot"
    assert not any(re.search(rf"\b{re.escape(name)}\b", words) for name in others)
    assert "Goals" not in words
    assert not (folder / "goals.html").exists()


def test_nothing_but_the_robot_is_measured(made):
    rows = json.loads((made[1] / "report.json").read_text())
    measured = {name for name in PARTS if rows[name]}
    assert measured == {"robots", "take", "accuracy", "map", "rounding"}  # and a board, where one can be emulated
    assert {row["scene"] for name in measured for row in rows[name]} == {SCENE}
    assert rows["targets"] == []  # the keys stay, for those who read the file


def test_json_of_a_robots_report_keeps_page_notes_and_goals(made):
    found = json.loads(made[2])
    assert found["page"].endswith("index.html")
    assert found["goals"] == []
    assert any("arm-none-eabi-gcc" in note for note in found["notes"])


def test_the_scenes_own_step_is_among_the_steps_and_marked(made):
    rows = json.loads((made[1] / "report.json").read_text())["accuracy"]
    assert {row["step_s"] for row in rows if row["own"]} == {read_scene(SCENE).run.step_s}
    assert "the scene&#39;s own step" in (made[1] / "index.html").read_text().replace("'", "&#39;")


def test_what_to_take_is_the_quickest_run_that_is_good_enough_in_everything():
    good = {"scene": "x", "real": "double", "status": "ok", "error_pose": 1e-9, "error_wheel": 0.0, "step_s": 0.01}
    rows = [good | {"method": EXPLICIT, "error_nu": 1e-7, "us_per_second": 5.0},
            good | {"method": EXPLICIT_8, "error_nu": 1e-10, "us_per_second": 9.0},
            good | {"method": EXACT, "error_nu": 1e-7, "error_pose": 1e-2, "us_per_second": 1.0},
            good | {"method": EXACT_4, "error_nu": np.nan, "us_per_second": 0.5}]
    found = robot.advice(rows, SimpleNamespace(path=SimpleNamespace(stem="x")))
    take = {(row["wanted_error"], row["real"]): row["method"] for row in found}
    assert take[1e-3, "double"] == EXPLICIT
    assert take[1e-9, "double"] == EXPLICIT_8
    assert take[1e-3, "single"] == "none of the ladder"


def test_two_scene_files_of_one_name_are_refused_in_one_line(capsys, tmp_path):
    (tmp_path / "s1.toml").write_text((SCENE_DIR / "s1.toml").read_text())
    assert cli.run(["report", "--scene", "s1", "--scene", str(tmp_path / "s1.toml"), "--out", str(tmp_path)]) == 2
    assert "2 files are called s1" in capsys.readouterr().err


@pytest.mark.parametrize(("duration", "own"), [(0.05, 0.001), (0.004, 0.001), (0.366, 0.003), (0.37, 0.001),
                                               (7.77, 0.01), (10.0, 0.002), (4.0, 0.5)])
def test_every_scene_has_steps_to_compare_its_own_among_them(duration, own):
    scene = read_scene(SCENE).with_run(duration_s=duration, step_s=own)
    scene = replace(scene, inputs=())
    ladder, grid_s = accuracy.ladder_of(scene)
    short = accuracy.shortened(scene, grid_s)
    truth = accuracy.Truth(accuracy.checkpoints(short.run.duration_s, grid_s), np.zeros(0))
    fitting = [step_s for step_s in ladder if accuracy.fits(short.with_run(step_s=step_s), truth)]
    assert own in fitting
    assert len(fitting) >= 5
    assert len(truth.at_s) <= accuracy.CHECKPOINTS
    assert truth.at_s[-1] <= duration * (1.0 + 1e-9)


@pytest.fixture
def slipping(tmp_path):
    """A short run with friction."""
    return friction_scenes.skid_steering(tmp_path).with_run(duration_s=0.2)


def test_the_reference_of_a_scene_with_friction_is_as_good_as_its_step(slipping):
    truth = accuracy.truth_of(slipping)
    better = accuracy.follow(slipping.with_run(step_s=0.1 / accuracy.FINE_STEPS / 4), "double", truth.at_s)
    found = accuracy.relative(truth.states[:, :3], better[:, :3])
    assert 0.5 * found < truth.error["error_nu"] < 3.0 * found
    rows = accuracy.rows_of(slipping, ("double",), ladder=(0.002, 0.02))
    assert [row["reference_error_nu"] for row in rows] == [truth.error["error_nu"]] * 2
    assert all(row["error_nu"] > truth.error["error_nu"] > 1e-9 for row in rows)


def test_a_refused_reference_leaves_a_page_that_names_the_file(slipping, monkeypatch, tmp_path):
    def refuse(*_: object) -> None:
        raise Refused("step unsolved", "step_s", 0, "run.step_s: no contact forces found for a step of 1e-05 s")

    monkeypatch.setattr(accuracy, "follow", refuse)
    monkeypatch.setattr(robot, "M4F", SimpleNamespace(present=False))
    report = robot.collect_robots([slipping], tmp_path, quick=True)
    assert {row["status"] for row in report.results["accuracy"]} == {"no reference"}
    assert any(str(slipping.path) in note and "no contact forces found" in note for note in report.notes)
    page = write(report, tmp_path / "out", "0")
    assert str(slipping.path) in page.read_text(encoding="utf-8")


def test_the_page_of_a_scene_with_friction_tells_no_damping_and_both_types_apart(slipping, monkeypatch):
    row = robot.robot_row(slipping)
    assert "h_r" not in row and "fastest_decay_per_s" not in row
    rows = [{"scene": "x", "method": "auto", "real": real, "step_s": h, "us_per_second": 1.0 / h, "error_nu": h,
             "reference_error_nu": 2e-5, "own": False} for real in ("double", "single") for h in (0.001, 0.01, 0.1)]
    monkeypatch.setattr(pictures, "svg", without_layout)
    dashes = [pictures.error_against_time(some, "x").count("stroke-dasharray: ") for some in (rows, rows[:3])]
    assert dashes[0] == dashes[1] + 1  # the curve of single; the legend has its dashes in both
    axes = plt.figure().add_subplot()
    pictures.mark_reference(axes, rows)
    assert axes.get_ylim() == pytest.approx((0.3 * 2e-5, 3.0 * 0.1))  # no empty decades, and no point at the edge
    plt.close()


# ---- the pictures

ERRORS = [{"scene": "x", "method": m, "real": real, "step_s": h, "us_per_second": 1.0 / h, "error_nu": h**4,
           "own": h == 0.01} for m in METHODS for real in ("double", "single") for h in (0.001, 0.01, 0.1)]
MAP = [{"method": EXPLICIT, "step_s": h, "fastest_decay_per_s": r, "status": "ok", "error_nu": h} for h in (0.01, 0.1)
       for r in (1.0, 10.0)]
DRIFT = [{"method": m, "real": "double", "status": "ok", "steps": n, "K": 1e-15} for m in METHODS[1:]
         for n in range(1, 61)]
PEERS = [{"who": who, "real": "double", "ms": x, "error_nu": 1.0 / x} for x in (1.0, 2.0) for who in
         (*METHODS[1:], "DOP853 compiled, numba right-hand side", "CVODE Adams", "CVODE BDF", "SciPy Radau")]
DRAWN = {"error": lambda: pictures.error_against_time(ERRORS, "x", "A robot with a long name, made by somebody"),
         "stability": lambda: pictures.stability(MAP, EXPLICIT, (0.001, 5.0)),
         "drift": lambda: pictures.drift(DRIFT, "double", "K"), "peers": lambda: pictures.precision(PEERS),
         "plan": lambda: plan(read_scene("kuka_youbot"))}


@pytest.fixture(scope="module")
def figures():
    """The pictures as figures, laid out, before they become text."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pictures, "svg", lambda figure: figure)
        patch.setattr("laconic.tools.report.plan.svg", lambda figure: figure)
        made = {name: draw() for name, draw in DRAWN.items()}
    for picture in made.values():
        picture.draw_without_rendering()
    yield made
    for picture in made.values():
        plt.close(picture)


@pytest.mark.parametrize("name", DRAWN)
def test_no_legend_covers_a_curve_and_nothing_is_cut(figures, name):
    picture = figures[name]
    frame = picture.bbox.padded(2.0)
    box = picture.get_tightbbox().transformed(picture.dpi_scale_trans)
    assert frame.x0 <= box.x0
    assert box.x1 <= frame.x1
    assert frame.y0 <= box.y0
    assert box.y1 <= frame.y1
    legends = [*picture.legends, *(axes.get_legend() for axes in picture.axes if axes.get_legend())]
    assert legends
    for legend in legends:
        assert not any(legend.get_window_extent().overlaps(axes.get_window_extent()) for axes in picture.axes)


@pytest.mark.parametrize("name", DRAWN)
def test_letters_stay_of_reading_size_on_a_phone(figures, name):
    picture = figures[name]
    shrunk = min(1.0, (PHONE_CSS_PX - 24) / (SIZE[0] * CSS_PX_PER_INCH))
    smallest = min(text.get_fontsize() for legend in picture.legends for text in legend.get_texts())
    assert picture.get_size_inches()[0] == SIZE[0]
    assert smallest * CSS_PX_PER_INCH / 72 * shrunk >= 8.5  # pixels


def test_curves_that_coincide_keep_markers_of_their_own(figures):
    (axes,) = figures["drift"].axes
    places = [line.get_markevery() for line in axes.lines]
    widths = [line.get_linewidth() for line in axes.lines]
    assert len(set(places)) == len(places) == len(METHODS) - 1
    assert widths == sorted(widths, reverse=True)
    assert widths[0] > widths[-1] + 1.0


def test_a_method_has_the_same_colour_and_marker_in_every_picture(figures):
    for name in ("error", "drift", "peers"):
        for line in figures[name].axes[0].lines:
            if line.get_label() in METHOD_STYLES:
                style = METHOD_STYLES[line.get_label()]
                assert (line.get_color(), line.get_marker()) == (style.colour, style.marker)
