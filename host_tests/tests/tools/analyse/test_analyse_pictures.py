"""Pictures of `laconic analyse` can be read: nothing is cut or covered, units of a driver, many wheels, words."""

import math

import numpy as np
import pytest
from matplotlib import pyplot as plt

from laconic.pictures.curves import alternating_markers, nested, wrapped
from laconic.scene import read_scene
from laconic.tools.analyse.analyse import study
from laconic.tools.analyse.findings import StudyOptions
from laconic.tools.analyse.from_core import subject_of
from laconic.tools.analyse.pictures import PICTURES
from scene_text import constant, table

LONG_NAME = "A robot of many wheels whose maker gave it a name that is longer than any picture is wide, almost twice"


def ring(count: int, path) -> str:
    """A scene with so many omni wheels on a ring, that slips."""
    angles = [360 / count * k for k in range(count)]
    wheels = "".join(table("[[vehicle.wheel]]", kind="omni", distance_m=0.4, bearing_deg=angle, axle_deg=angle)
                     for angle in angles)
    inputs = "".join(constant(f"voltage_V[{k + 1}]", round(6 * math.cos(math.radians(angle)) + 0.5, 4))
                     for k, angle in enumerate(angles))
    path.write_text(f"""name = "{LONG_NAME}"
source = "numbers of this test"
[vehicle]
mass_kg = 60.0
yaw_inertia_kgm2 = 6.0
com_x_m = 0.01
com_y_m = 0.02
com_z_m = 0.2
wheel_radius_m = 0.06
wheel_inertia_kgm2 = 0.004
friction_coefficient = 0.5
motor_gain_Nm_per_V = 0.8
motor_damping_Nms = 0.15
{wheels}{inputs}[run]
duration_s = 2.0
step_s = 0.01
""")
    return str(path)


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    """Twelve wheels."""
    path = ring(12, tmp_path_factory.mktemp("ring") / "ring.toml")
    return study(subject_of(read_scene(path)), StudyOptions(), lambda *_: None)


@pytest.fixture(scope="module")
def hopf():
    """Turning motions, with no limit cycle beside them: those take long."""
    options = StudyOptions(("free", "steady", "bifurcation"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("laconic.tools.analyse.bifurcation_part.cycle_near", lambda *_: None)
        return study(subject_of(read_scene("paper_three_wheel_hopf")), options, lambda *_: None)


@pytest.fixture(scope="module")
def drawn():
    """(study, picture's name) → the figure; each is drawn once."""
    made = {}

    def draw(found, name):
        if (id(found), name) not in made:
            made[id(found), name] = PICTURES[name](found)
            made[id(found), name].draw_without_rendering()
        return made[id(found), name]

    yield draw
    for picture in made.values():
        plt.close(picture)


@pytest.mark.parametrize("name", PICTURES)
def test_nothing_is_cut_and_no_legend_covers_a_curve_even_with_a_long_name(many, name, drawn):
    picture = drawn(many, name)
    frame, box = picture.bbox.padded(2.0), picture.get_tightbbox().transformed(picture.dpi_scale_trans)
    assert frame.x0 <= box.x0
    assert box.x1 <= frame.x1
    assert frame.y0 <= box.y0
    assert box.y1 <= frame.y1
    assert not any(axes.get_legend() for axes in picture.axes)
    for legend in picture.legends:
        assert not any(legend.get_window_extent().overlaps(axes.get_window_extent()) for axes in picture.axes)


def test_twelve_wheels_have_a_row_each_with_its_number(many, drawn):
    picture = drawn(many, "traction")
    rows = [axes for axes in picture.axes if axes.get_ylabel() == "wheel"]
    assert len(rows) == 3
    for axes in rows:
        assert [label.get_text() for label in axes.get_yticklabels()] == [str(i) for i in range(1, 13)]
        (mesh,) = (c for c in axes.collections if hasattr(c, "get_coordinates"))
        assert mesh.get_array().shape[0] == 12


def test_where_a_wheel_slips_its_row_is_outlined(many, drawn):
    found, picture = many.traction, drawn(many, "traction")
    outlined = {round(float(np.mean(line.get_ydata()[:4]))) for line in picture.axes[2].lines
                if line.get_color() == "tab:cyan" and len(line.get_xdata()) == 5}
    slips = {i + 1 for i in range(12) if (np.nan_to_num(found.use[:, i], nan=0.0, posinf=9.0) > 1.0).any()}
    assert slips
    assert outlined == slips


def test_wheels_whose_curves_coincide_are_drawn_one_inside_the_other():
    subject = subject_of(read_scene("kuka_youbot").with_run(duration_s=0.5))
    picture = PICTURES["traction"](study(subject, StudyOptions(("traction",)), lambda *_: None))
    widths = [line.get_linewidth() for line in picture.axes[1].lines[:4]]
    plt.close(picture)
    assert widths == sorted(widths, reverse=True)
    assert min(np.diff(widths[::-1])) > 0.5
    assert len({nested(i, 12)["linewidth"] for i in range(12)}) == 12
    assert len({alternating_markers(i, 6) for i in range(6)}) == 6


@pytest.mark.parametrize(("name", "beside"), [
    ("portrait", "m/s"), *(pytest.param(each, "m/s", marks=pytest.mark.nightly)
                           for each in ("driven_portrait", "bifurcation"))])
def test_axes_in_rad_per_second_have_one_in_metres_per_second_with_the_same_zero(hopf, name, beside, drawn):
    (axes,) = drawn(hopf, name).axes
    labels = [f"{second.get_xlabel()} {second.get_ylabel()}" for second in axes.child_axes]
    assert any(beside in label for label in labels)
    for second in axes.child_axes:
        if name == "bifurcation" or second.get_ylabel():
            here, there = (axes.get_xlim(), second.get_xlim()) if second.get_xlabel() else (
                axes.get_ylim(), second.get_ylim())
            zero, other = (-low / (high - low) for low, high in (here, there))
            assert zero == pytest.approx(other, abs=1e-9)
            assert max(map(abs, there)) == pytest.approx(0.05 * max(map(abs, here)))  # times the wheel radius


def test_a_portrait_explains_its_symbols(hopf, drawn):
    (legend,) = drawn(hopf, "portrait").legends
    words = legend.get_title().get_text()
    assert "stays in free motion" in words
    assert "wheel radius" in words


def test_eigenvalues_of_mirrored_motions_are_drawn_around_each_other(hopf, drawn):
    (axes,) = drawn(hopf, "eigenvalues").axes
    sizes = [line.get_markersize() for line in axes.lines if "turning" in str(line.get_label())]
    assert len(sizes) == 2
    assert max(sizes) >= 1.5 * min(sizes)


def test_a_long_title_is_wrapped_and_keeps_its_words():
    assert wrapped(LONG_NAME, 44).split() == LONG_NAME.split()
    assert max(map(len, wrapped(LONG_NAME, 44).splitlines())) <= 44
