"""How curves that may lie on each other, and long names, are drawn in the pictures of analyses and reports.

How a method is drawn in every picture of the project: one colour and one marker each, by its number.

    axes.loglog(times, errors, **style_of("auto"))             # line and markers, with the method's name as the label
    axes.plot(t, y, **style_of("auto", marker="", label=None)) # a keyword replaces the one of the table

`auto` gives the numbers of the method that it picks, so its points lie on that method's. Its markers are large and
hollow, lie on top and have no line, so that both are seen.
"""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass
from typing import Any

from laconic.scene.methods import METHODS

MOST_LINES = 3         # of a name in a title
THICK, THIN = 3.6, 0.9  # points: the first of curves that coincide, and the last


def nested(order: int, count: int) -> dict[str, Any]:
    """Line width and height in the picture of curve `order` (from 0) of `count`: later ones are thinner and lie on top.

    So where curves coincide, the earlier ones show on both sides of the later ones.
    """
    share = order / max(1, count - 1)
    return {"linewidth": THICK + share * (THIN - THICK), "zorder": 2.0 + share}


def alternating_markers(order: int, count: int) -> tuple[int, int]:
    """`markevery` of curve `order` of `count`: where curves coincide, their markers do not."""
    return order % count, count


def wrapped(name: str, letters: int, addition: str = "") -> str:
    """A title in lines as wide as so many letters: a long name is wrapped, one of too many lines ends in an ellipsis.

    The `addition` follows the name after a colon and is never cut off.
    """
    lines: list[str] = []
    words = " ".join(name.split())
    while words and len(lines) < MOST_LINES:
        line = _fitting(words, letters)
        lines.append(line)
        words = words[len(line):].lstrip()
    if words:
        lines[-1] = _fitting(lines[-1], letters - 1, at_a_space=False) + "…"
    if addition and lines:
        is_short = _width(f"{lines[-1]}: {addition}") <= letters
        lines[-1:] = [f"{lines[-1]}: {addition}"] if is_short else [f"{lines[-1]}:", addition]
    return "\n".join(lines) or addition


def _fitting(words: str, letters: int, at_a_space: bool = True) -> str:
    """As much of the words as one line takes; a word that is longer than a line is broken."""
    if _width(words) <= letters:
        return words
    count = 1
    while _width(words[: count + 1]) <= letters:
        count += 1
    space = words.rfind(" ", 1, count + 1)
    return words[: space if at_a_space and space > 0 else count].rstrip()


def _width(words: str) -> float:
    """In letters of middle width: capitals are wider, those of Chinese twice as wide."""
    return sum(2.0 if unicodedata.east_asian_width(letter) in "WF" else 1.7 if letter in "MWmw@%" else
               1.2 if letter.isupper() else 1.0 for letter in words[:MOST_LINES * 200])


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
