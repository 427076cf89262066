"""Pictures of runs: nothing is covered, nothing hidden, and what the ground cannot give is marked."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

import laconic
from laconic.core import load
from laconic.pictures import plotting
from laconic.pictures.curves import METHOD_STYLES, MOST_CURVES, share_zero, stripes, style_of
from laconic.pictures.plotting import figure, simulation_picture
from laconic.scene import METHODS, read_scene
from laconic.scene.methods import EXACT_4, EXPLICIT
from laconic.simulation import Trajectory, simulate, usual_signals
from laconic.tools.demo import main_job as demo_pictures
from laconic.tools.demo.work import Point


@pytest.fixture
def drawn(monkeypatch):
    """The figures that were saved, laid out."""
    kept: list[Figure] = []

    def keep(picture: Figure, path: Path) -> None:
        picture.canvas.draw()
        kept.append(picture)

    monkeypatch.setattr(plotting, "save", keep)
    monkeypatch.setattr(demo_pictures, "save", keep)
    yield kept
    for picture in kept:
        plt.close(picture)


def ring(tmp_path: Path, wheels: int, volts: str = "{k}.0", ground: str = "") -> Trajectory:
    """Omni wheels in a ring, each with a voltage of its own or all with one."""
    text = ("[vehicle]\nmass_kg = 20.0\nyaw_inertia_kgm2 = 1.2\nwheel_radius_m = 0.05\nwheel_inertia_kgm2 = 0.001\n"
            f"motor_gain_Nm_per_V = 0.3\nmotor_damping_Nms = 0.05\n{ground}\n")
    for k in range(wheels):
        bearing = 360.0 * k / wheels + 10.0
        text += (f'[[vehicle.wheel]]\nkind = "omni"\ndistance_m = 0.3\nbearing_deg = {bearing}\naxle_deg = {bearing}\n'
                 f'[[input]]\nsignal = "voltage_V[{k + 1}]"\nkind = "steps"\nt_s = [0.0, 0.5]\n'
                 f"value = [0.1, {volts.format(k=k)}]\n")
    path = tmp_path / "ring.toml"
    path.write_text(text + "[run]\nduration_s = 1.0\nstep_s = 0.001\n[outputs]\nevery_s = 0.01\n")
    scene = read_scene(path)
    return simulate(scene, usual_signals(scene))


def assert_legends_stand_apart(picture: Figure) -> None:
    """No legend lies over any axes: neither its own nor a neighbour's."""
    legends = [axes.get_legend() for axes in picture.axes if axes.get_legend()]
    assert legends
    for legend in legends:
        box = legend.get_window_extent()
        for axes in picture.axes:
            over = box.intersection(box, axes.patch.get_window_extent())
            assert over is None or min(over.width, over.height) < 2.0


@pytest.mark.parametrize("wheels", [8, pytest.param(12, marks=pytest.mark.nightly)])
def test_legends_never_cover_curves(tmp_path, drawn, wheels):
    simulation_picture(ring(tmp_path, wheels, ground="friction_coefficient = 0.5\ncom_z_m = 0.2"), tmp_path / "run.png")
    assert_legends_stand_apart(drawn[0])


@pytest.mark.nightly
def test_legends_of_the_demo_never_cover_curves(tmp_path, drawn):
    points = [Point(method, method, 0.001 * k, 1e-9 * k, 1e-9, 1e-9, 50.0, 100.0 / k)
              for method in METHODS for k in (1, 2)]
    demo_pictures.draw(ring(tmp_path, 4), points, 1e-13, tmp_path / "demo.png")
    assert_legends_stand_apart(drawn[0])
    texts = " ".join(text.get_text() for axes in drawn[0].axes for text in axes.texts)
    assert "independent integrator" in texts and "grey" in texts


def test_curves_that_coincide_take_turns_on_top():
    x = np.linspace(0.0, 10.0, 400)
    same = np.column_stack([np.sin(x)] * 3)
    assert {k for _, _, k in stripes(same)} == {0, 1, 2}
    apart = np.column_stack([np.sin(x), np.sin(x) + 1.0, np.sin(x) - 1.0])
    assert stripes(apart) == []


def test_curves_that_part_are_striped_only_where_they_coincide():
    x = np.linspace(0.0, 1.0, 600)
    forked = np.column_stack([x, np.where(x < 0.5, x, 2.0 * x)])
    found = stripes(forked)
    assert {k for _, _, k in found} == {0, 1}
    assert max(last for _, last, _ in found) <= 310


@pytest.mark.parametrize(("left", "right"), [((0.0, 0.3), (-0.5, 0.8)), ((-2.0, -1.0), (3.0, 5.0)),
                                             ((0.0, 0.0), (0.0, 0.0)), ((-1e-12, 2e-12), (-7.0, 1.0))])
def test_twin_axes_share_their_zero_and_hold_their_curves(left, right):
    picture = figure(4.0, 3.0)
    one = picture.add_subplot()
    other = one.twinx()
    one.plot([0.0, 1.0], left)
    other.plot([0.0, 1.0], right)
    share_zero(one, other)
    heights = [-low / (high - low) for low, high in (one.get_ylim(), other.get_ylim())]
    plt.close(picture)
    assert heights[0] == pytest.approx(heights[1], abs=1e-12)
    for axes, values in ((one, left), (other, right)):
        low, high = axes.get_ylim()
        assert low < min(values) and max(values) < high


def test_more_wheels_than_colours_are_rows_each_with_its_number(tmp_path, drawn):
    simulation_picture(ring(tmp_path, 12), tmp_path / "run.png")
    rows = next(axes for axes in drawn[0].axes if axes.get_ylabel() == "wheel")
    assert [round(tick) for tick in rows.get_yticks()] == list(range(1, 13))
    assert MOST_CURVES < 10
    assert [bar.get_ylabel() for bar in rows.child_axes] == ["wheel speed [rad/s]"]


def test_what_the_ground_cannot_give_is_marked_where_and_when_it_happens(tmp_path, drawn):
    simulation_picture(ring(tmp_path, 4, "10.0", "friction_coefficient = 0.05"), tmp_path / "run.png")
    words = [text.get_text() for axes in drawn[0].axes if axes.get_legend() for text in axes.get_legend().get_texts()]
    assert any("slips first, 0.5 s" in word for word in words)
    for axes in drawn[0].axes:
        if axes.get_xlabel() == "time [s]":
            assert any(math.isclose(line.get_xdata()[0], 0.5) for line in axes.lines if len(set(line.get_xdata())) == 1)
    assert "cannot give" in drawn[0].get_supxlabel() and "slips at 0.5 s" in drawn[0].get_supxlabel()


def test_a_run_that_holds_has_no_mark(tmp_path, drawn):
    simulation_picture(ring(tmp_path, 4, "0.2", "friction_coefficient = 0.9"), tmp_path / "run.png")
    assert drawn[0].get_supxlabel() == ""


# ---- laconic.plot: the picture of a run from a program.

@pytest.fixture(scope="module")
def run():
    return laconic.simulate(laconic.read_scene("s1").with_run(duration_s=0.2))


def test_a_run_is_drawn_and_written(run, tmp_path):
    picture = laconic.plot(run, tmp_path / "run.png")
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")
    assert {axes.get_xlabel() for axes in picture.axes} >= {"x [m]", "time [s]"}


def test_a_run_without_the_usual_signals_is_refused():
    run = laconic.simulate(laconic.read_scene("s1").with_run(duration_s=0.2), ("x_m",))
    with pytest.raises(laconic.BadInput, match=r"run: has not kept nu_rad_per_s\[1\]; simulate without"):
        laconic.plot(run)


def test_a_name_that_is_no_picture_is_refused_and_leaves_no_figure_open(run, tmp_path):
    before = plt.get_fignums()
    with pytest.raises(laconic.BadInput, match=r"choose a name that ends in .png, .svg or .pdf"):
        laconic.plot(run, tmp_path / "run.txt")
    assert plt.get_fignums() == before


# ---- A method is drawn the same in every picture.

def test_every_method_of_the_core_has_a_colour_and_a_marker_of_its_own():
    assert set(METHOD_STYLES) == set(METHODS) == set(load("double").method_names)
    assert len({style.colour for style in METHOD_STYLES.values()}) == len(METHOD_STYLES)
    assert len({style.marker for style in METHOD_STYLES.values()}) == len(METHOD_STYLES)


def test_what_auto_lies_upon_stays_visible():
    assert style_of("auto")["markerfacecolor"] == "none"
    assert style_of("auto")["markersize"] > style_of(EXACT_4)["markersize"]


def test_what_a_caller_gives_replaces_the_table():
    assert style_of(EXPLICIT, label=None, linestyle="--") == {
        "color": "#d1495b", "marker": "s", "markersize": 5.0, "label": None, "linestyle": "--"}
