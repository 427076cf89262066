"""How a method is drawn in every picture of the project: one colour and one marker each, by its number.

    axes.loglog(times, errors, **style_of("auto"))             # line and markers, with the method's name as the label
    axes.plot(t, y, **style_of("auto", marker="", label=None)) # a keyword replaces the one of the table

`auto` gives the numbers of the method that it picks, so its points lie on that method's. Its markers are large and
hollow, lie on top and have no line, so that both are seen.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from laconic.scene.methods import METHODS

MARKER_SIZE = 5.0  # points; hollow markers are twice as large


@dataclass(frozen=True)
class MethodStyle:
    """A colour that differs from the others in lightness as well as in hue, and a marker that no other method has."""

    colour: str
    marker: str
    hollow: bool = False


PALETTE = (
    MethodStyle("#111111", "o", hollow=True), MethodStyle("#d1495b", "s"), MethodStyle("#e9a23b", "^"),
    MethodStyle("#2a9d8f", "D"), MethodStyle("#8d6cab", "v"), MethodStyle("#3066be", "P"), MethodStyle("#7a5230", "X"),
    MethodStyle("#c2185b", "*"), MethodStyle("#9bc53d", "p"), MethodStyle("#5bc0eb", "h"), MethodStyle("#1b5e20", "<"),
    MethodStyle("#f4a6c0", ">"))
"""By the numbers of the methods; those beyond the first eight are for methods to come."""
METHOD_STYLES = dict(zip(METHODS, PALETTE, strict=False))
FOREIGN = MethodStyle("#777777", "x")  # somebody else's integrator


def style_of(method: str, size: float = MARKER_SIZE, **replaced: Any) -> dict[str, Any]:
    """Keywords for matplotlib's plot functions: colour, marker and label of a method. `size`: marker size in points."""
    style = METHOD_STYLES.get(method, FOREIGN)
    keywords: dict[str, Any] = {"color": style.colour, "marker": style.marker, "markersize": size, "label": method}
    if style.hollow:
        keywords |= {"markersize": 2.0 * size, "markerfacecolor": "none", "linestyle": "none", "zorder": 3}
    return keywords | replaced
