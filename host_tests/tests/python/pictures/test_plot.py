"""laconic.plot: the picture of a run from a program."""

from __future__ import annotations

import pytest
from matplotlib import pyplot as plt

import laconic


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
