"""The vehicle from above before and after, and the front between the goals."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from matplotlib.transforms import Affine2D

from laconic.pictures.curves import wrapped
from laconic.pictures.plotting import figure, save
from laconic.scene import Scene
from laconic.tools.measures.measure import Measure
from laconic.tools.optimise.study import Result

BODY, WHEEL, TREAD, COM, SUPPORT = "#f3e3c0", "#2b3a49", "#c3ced8", "#1f6fb2", "#8a8f94"
THICK = 0.7    # of a wheel, of its radius
ROLLERS = 5    # lines across a wheel that show how its rollers lie
ROOM = 1.35    # around the outermost wheel
CLEAR = 0.65   # of a wheel's radius from its middle to its number
LETTERS = 100  # in a line of a title


def draw_vehicles(before: Scene, after: Scene, result: Result, path: Path) -> None:
    """Both from above in their body frames, to one scale, with the free numbers below."""
    picture = figure(10.0, 5.6 + 0.2 * sum(len(each.keys) for each in result.problem.free))
    panels = picture.subplots(1, 2, sharex=True, sharey=True)
    reach = ROOM * max(_reach_m(before), _reach_m(after))
    choices = (result.before.choice, result.best.choice)
    for axes, scene, name, choice in zip(panels, (before, after), ("before", "found"), choices, strict=True):
        _vehicle(axes, scene)
        lines = [",\n".join(each.keys) + f" = {value:.5g}"
                 for each, value in zip(result.problem.free, choice, strict=True)]
        axes.set_title(name)
        axes.set_xlabel("\n".join(["x [m]", "", *lines, " "]))
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        axes.locator_params(nbins=6)
    panels[0].set_ylabel("y [m]")
    panels[1].legend(loc="upper right", fontsize=9)
    picture.suptitle(wrapped(after.name, LETTERS, "from above"))
    save(picture, path)


def _radius_m(scene: Scene, wheel: dict[str, Any]) -> float:
    return float(wheel.get("radius_m", scene.vehicle["wheel_radius_m"]))


def _reach_m(scene: Scene) -> float:
    """From the origin to the outermost point of a wheel or support."""
    vehicle = scene.vehicle
    wheels = [np.hypot(wheel["x_m"], wheel["y_m"]) + _radius_m(scene, wheel) for wheel in vehicle["wheel"]]
    supports = [np.hypot(each["x_m"], each["y_m"]) for each in vehicle["support"]]
    com = np.hypot(vehicle["com_x_m"], vehicle["com_y_m"])
    return float(max([*wheels, *supports, 1.2 * com, vehicle["wheel_radius_m"]]))


def _vehicle(axes: Axes, scene: Scene) -> None:
    """Contact points joined, wheels with their numbers, supports, centre of mass, and the body frame's origin."""
    vehicle = scene.vehicle
    points = np.array([[each["x_m"], each["y_m"]] for each in (*vehicle["wheel"], *vehicle["support"])]).reshape(-1, 2)
    if len(points) > 2:
        middle = points - points.mean(axis=0)
        order = np.argsort(np.arctan2(middle[:, 1], middle[:, 0]), kind="stable")
        axes.fill(*points[order].T, color=BODY, zorder=1)
    for number, wheel in enumerate(vehicle["wheel"], start=1):
        _wheel(axes, scene, wheel, number)
    for support in vehicle["support"]:
        place = (support["x_m"], support["y_m"])
        axes.add_patch(Circle(place, 0.3 * vehicle["wheel_radius_m"], color=SUPPORT, zorder=3))
    axes.plot(0.0, 0.0, "+", color="k", ms=12, mew=1.5, zorder=4, label="origin of the body")
    axes.plot(vehicle["com_x_m"], vehicle["com_y_m"], "o", color=COM, ms=8, mec="white", zorder=5,
              label="centre of mass")


def _wheel(axes: Axes, scene: Scene, wheel: dict[str, Any], number: int) -> None:
    """A wheel across its axle, with its rollers' axes at the ground where it has any."""
    radius = _radius_m(scene, wheel)
    turn = Affine2D().rotate(wheel["axle_rad"]).translate(wheel["x_m"], wheel["y_m"]) + axes.transData
    axes.add_patch(Rectangle((-0.5 * THICK * radius, -radius), THICK * radius, 2.0 * radius, color=WHEEL,
                             transform=turn, zorder=2))
    if wheel["kind"] != "fixed":
        roller = wheel.get("roller_rad", 0.5 * np.pi)
        along = 0.15 * radius * np.array([np.cos(roller), np.sin(roller)])
        for offset in np.linspace(-0.8, 0.8, ROLLERS) * radius:
            axes.plot([-along[0], along[0]], [offset - along[1], offset + along[1]], color=TREAD, lw=1.6, zorder=3,
                      transform=turn)
    centre = np.array([wheel["x_m"], wheel["y_m"]])
    axle = np.array([np.cos(wheel["axle_rad"]), np.sin(wheel["axle_rad"])])
    place = centre + CLEAR * radius * (-axle if axle @ centre < 0.0 else axle)
    axes.text(place[0], place[1], str(number), ha="center", va="center", fontsize=9, zorder=6)


def draw_front(result: Result, measures: Sequence[Measure], name: str, path: Path) -> None:
    """Each pair of goals: all that was measured and keeps the constraints, the front, the scene and the choice."""
    goals = result.problem.goals
    pairs = list(combinations(range(len(goals)), 2))
    columns = min(3, len(pairs))
    rows = -(-len(pairs) // columns)
    picture = figure(max(7.0, 5.2 * columns), 4.6 * rows + 0.8)
    panels = picture.subplots(rows, columns, squeeze=False).ravel()
    for axes, (one, other) in zip(panels, pairs, strict=False):
        _pair(axes, result, measures, one, other)
    for axes in panels[len(pairs):]:
        axes.remove()
    picture.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=9)
    picture.suptitle(wrapped(name, LETTERS, "no choice on the front is better in all goals"))
    save(picture, path)


def _pair(axes: Axes, result: Result, measures: Sequence[Measure], one: int, other: int) -> None:
    goals = [result.problem.goals[each] for each in (one, other)]
    columns = [result.problem.column(goal.measure) for goal in goals]
    front = np.array([point.values for point in result.front])[:, columns]
    front = front[np.argsort(front[:, 0], kind="stable")]
    limits = [_limits(np.append(front[:, axis], result.before.values[columns[axis]])) for axis in range(2)]
    cloud = result.cloud[:, columns]
    axes.plot(*cloud.T, ".", ms=2, color="0.8", zorder=1, label="also measured", rasterized=True)
    line = "-" if len(result.problem.goals) == 2 else ""
    axes.plot(*front.T, f"o{line}", color="tab:blue", ms=5, zorder=3, label="front")
    axes.plot(*result.before.values[columns], "s", color="tab:orange", ms=8, zorder=4, label="before")
    axes.plot(*result.best.values[columns], "*", color="tab:red", ms=14, mec="white", zorder=5, label="found")
    axes.set(xlim=limits[0], ylim=limits[1])
    labels = [f"{wrapped(goal.measure, 60)} [{measures[column].unit or '–'}]\n"
              f"({'larger' if goal.is_largest else 'smaller'} is better)"
              for goal, column in zip(goals, columns, strict=True)]
    axes.set(xlabel=labels[0], ylabel=labels[1])


def _limits(values: np.ndarray) -> tuple[float, float]:
    """Around finite values."""
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    margin = 0.08 * (high - low) or 0.1 * abs(high) or 1.0
    return low - margin, high + margin
