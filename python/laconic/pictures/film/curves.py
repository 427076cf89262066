"""The curves of a film: panels below each other over time, and a veil over what is still to come."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from laconic.pictures.film.timing import Timing

COLOURS = ("#1f6fb2", "#d1495b", "#2e8b57", "#8d5fbf", "#c77d0a", "#3aa6a6", "#6b6b6b", "#b04a90")
TITLE = 26.0  # of a panel, in the picture's units
GAP = 10.0    # below one
MOST_POINTS = 160
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Panel:
    """Some curves with one scale; names of none where there is one or there are too many."""

    title: str
    values: np.ndarray
    names: tuple[str, ...]


def curves(panels: Sequence[Panel], time_s: np.ndarray, timing: Timing, box: Box) -> tuple[str, str]:
    """The panels of a run with rows at these instants, in a box, and the rules by which their veil moves.

    Left of the box is room for the numbers of the scales.
    """
    left, top, width, height = box
    each = height / len(panels)
    boxes = [(left, top + number * each, width, each) for number in range(len(panels))]
    drawn = "".join(_panel(panel, time_s, place) for panel, place in zip(panels, boxes, strict=True))
    tall = each - TITLE - GAP
    plots = "".join(f"M{left} {place[1] + TITLE - 2.0:.1f}v{tall + 4.0:.1f}h{width + 2}v{-tall - 4.0:.1f}z"
                    for place in boxes)
    line = "".join(f"M{left} {place[1] + TITLE:.1f}v{tall:.1f}" for place in boxes)
    veil = (f'<path class="m veil" d="{plots}" fill="#fff" fill-opacity="0.78"/>\n'
            f'<path class="m now" d="{line}" stroke="#5b6672"/>\n')
    end = f"{100.0 * timing.shares[-1]:.4g}%"
    style = (f"@keyframes veil {{ 0% {{ transform: scaleX(1); }} {end} {{ transform: scaleX(0); }} "
             f"100% {{ transform: scaleX(0); }} }}\n@keyframes now {{ 0% {{ transform: translateX(0); }} "
             f"{end} {{ transform: translateX({width}px); }} 100% {{ transform: translateX({width}px); }} }}\n"
             f".veil {{ animation-name: veil; transform: scaleX(0); transform-origin: {left + width + 2}px 0; }}\n"
             f".now {{ animation-name: now; transform: translateX({width}px); }}\n")
    return drawn + veil, style


def _tick(most: float) -> float:
    """The largest of 1, 2, 5, 10 … that a scale up to `most` has."""
    decade = 10.0 ** math.floor(math.log10(max(most, 1e-9)))
    return max(digit * decade for digit in (1, 2, 5) if digit * decade <= most * (1.0 + 1e-9) or digit == 1)


def _panel(panel: Panel, time_s: np.ndarray, box: Box) -> str:
    left, top, width, height = box
    low, high = min(0.0, float(panel.values.min())), max(0.0, float(panel.values.max()))
    span, plot_top, plot_height = max(high - low, 1e-9), top + TITLE, height - TITLE - GAP
    rows = np.unique(np.linspace(0, len(panel.values) - 1, MOST_POINTS).astype(int))
    x = left + width * time_s[rows] / max(float(time_s[-1]), 1e-9)
    zero = plot_top + plot_height * high / span
    text = [f'<text x="{left}" y="{top + 17:.1f}">{panel.title}</text>']
    tick = _tick(max(high, -low)) * (1 if high >= -low else -1)
    for value, colour in ((0.0, "#c8d0d8"), (tick, "#e6eaee")):
        at = zero - plot_height * value / span
        text.append(f'<path d="M{left} {at:.1f}h{width}" stroke="{colour}"/><text x="{left - 6}" y="{at + 5:.1f}" '
                    f'text-anchor="end" font-size="16" fill="#5b6672">{value:g}</text>')
    end = left + width
    for number, name in reversed(list(enumerate(panel.names))):
        text.append(f'<text x="{end:.0f}" y="{top + 17:.1f}" text-anchor="end" fill="{COLOURS[number]}">{name}</text>')
        end -= 10.0 * len(name) + 12.0
    for number, values in enumerate(panel.values.T):
        y = plot_top + plot_height * (high - values[rows]) / span
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        text.append(f'<polyline points="{points}" fill="none" stroke="{COLOURS[number % len(COLOURS)]}" '
                    'stroke-width="2"/>')
    return "\n".join(text) + "\n"
