"""What the pictures of an analysis share: titles, legends with explanations, axes in m/s beside rad/s."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.axis import YAxis
from matplotlib.figure import Figure

from laconic.pictures.curves import wrapped
from laconic.tools.analyse.findings import Study
from laconic.tools.analyse.from_core import Subject
from laconic.tools.analyse.speeds import wheel_radius_m

BOLD, THIN = 3.0, 1.1
LETTERS = 68  # in a line of a title
YAW = r"yaw rate $\omega=\nu_3/\Lambda$ [rad/s]"
ACROSS = r"$\nu_\perp$: the part of ($\nu_1$, $\nu_2$) across the direction that turning is coupled to"
INTEGRAL = r"$K=(A\nu)_3$ stays in free motion, as the energy does; $A$: the matrix of inertia, $A_{33}$ its last entry"
ROLLING = r"$R\nu_1$, $R\nu_2$: velocity of the centre of mass along the body axes $\xi$, $\eta$; $R$: wheel radius"


def head(study: Study, what: str) -> str:
    """A title: whose picture it is, and what it shows."""
    return f"{wrapped(study.subject.scene.name, LETTERS)}\n{what}"


def keys(axes: Axes, entries: Sequence[tuple[str, float, str, str]]) -> list[Any]:
    """Lines for a legend: (colour, width, style, text)."""
    return [axes.plot([], [], color=c, lw=w, ls=s, label=text)[0] for c, w, s, text in entries]


def legend_below(picture: Figure, handles: Sequence[Any], explained: str = "", columns: int = 3) -> None:
    """Outside of the axes, where it covers no curve; above it, in words, what the axes' symbols mean."""
    legend = picture.legend(handles=handles, loc="outside lower center", ncols=columns, fontsize=9,
                            title=explained or None, title_fontsize=8.5, alignment="left")
    legend.get_title().set_color("0.3")


def speed_axes(axes: Axes, subject: Subject, component: str) -> None:
    """Beside ν3 across and a component of (ν1, ν2) upwards: yaw rate on top and metres a second on the right.

    They are the same numbers in other units, so all four axes have their zeros in common.
    """
    yaw, roll = subject.matrices.lambda_yaw, wheel_radius_m(subject)
    top = axes.secondary_xaxis("top", functions=_divided_by(yaw))
    top.set_xlabel(YAW)
    metres_beside(axes, "right", f"R {component} [m/s]", roll)
    power_aside(axes.yaxis)


def _divided_by(unit: float) -> tuple[Callable[[Any], Any], Callable[[Any], Any]]:
    """From numbers to multiples of a unit, and back."""
    return lambda number: number / unit, lambda multiple: multiple * unit


def power_aside(upright: YAxis) -> None:
    """Moves the power of ten of a vertical scale ("1e-5") off the first number of the scale on top."""
    upright.get_offset_text().set(x=-0.06, ha="right")


def metres_beside(axes: Axes, side: Literal["top", "right"], label: str, roll: float) -> None:
    """A second scale in m/s beside one of ν in rad/s, on "top" or on the "right"."""
    back, there = _divided_by(roll)
    if side == "top":
        axes.secondary_xaxis(side, functions=(there, back)).set_xlabel(label)
    else:
        axes.secondary_yaxis(side, functions=(there, back)).set_ylabel(label)


def explained(label: str, integral: bool) -> str:
    """What the symbols of a portrait mean, as far as they occur."""
    return "\n".join([ACROSS] * ("perp" in label) + [ROLLING] + [INTEGRAL] * integral)
