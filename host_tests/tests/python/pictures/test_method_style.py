"""A method is drawn the same in every picture."""

from __future__ import annotations

from laconic.core import load
from laconic.pictures.method_style import METHOD_STYLES, style_of
from laconic.scene import METHODS
from laconic.scene.methods import EXACT_4, EXPLICIT


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
