"""Pictures of runs with hinges: bodies with their wheels at their angles along the path, paths of trailers, hinges."""

from __future__ import annotations

import cmath
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from laconic.core.articulated import CARRIAGE
from laconic.pictures.curves import plot_over_time
from laconic.pictures.outlines import DRAWN, hull, outline_points

if TYPE_CHECKING:
    from laconic.scene import Scene
    from laconic.simulation import Trajectory

POSES = 5           # at which the whole vehicle is drawn
APART = 1.3         # sizes of the vehicle at least between two of them
BODY, WHEEL, TYRE = "0.35", "black", 3.0
Frames = list[tuple[complex, complex]]


def is_drawn(run: Trajectory) -> bool:
    """Whether a run has kept what draws its bodies."""
    return all(any(name.partition("[")[0] == each for name in run.columns) for each in DRAWN)


def plot_vehicle_path(axes: Axes, run: Trajectory) -> None:
    """Paths of the carriage and of what trails behind it, and the vehicle with its wheels at some instants."""
    x, y = run.columns["x_m"], run.columns["y_m"]
    axes.plot(x, y, color="tab:blue", label="centre of mass of the carriage")
    for colour, (name, path) in zip(("tab:orange", "tab:green", "tab:red", "tab:purple"), trailed(run), strict=False):
        axes.plot(path.real, path.imag, "--", color=colour, lw=1.1, label=f"axle of {name}")
    outline = outline_points(run.scene)
    for row in poses(run):
        draw_vehicle(axes, run.scene, frames_at(run, row), outline)
    axes.plot(x[0], y[0], "o", ms=12, mfc="none", mew=2.0, color="tab:green", label="start", zorder=4)
    axes.plot(x[-1], y[-1], "s", color="tab:red", label="end", zorder=4)
    axes.margins(0.06)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x [m]", ylabel="y [m]", title="Paths, and the vehicle on its way")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2, borderaxespad=0.0, fontsize=9)


def frames_at(run: Trajectory, row: int) -> Frames:
    """Origin and direction of each body in the world, the carriage first."""
    columns = run.columns
    found = [(complex(columns["origin_x_m"][row], columns["origin_y_m"][row]),
              cmath.rect(1.0, columns["heading_rad"][row]))]
    for hinge in run.scene.hinges:
        x, y, heading = (columns[f"{name}[{hinge.name}]"][row] for name in DRAWN[2:])
        found.append((complex(x, y), cmath.rect(1.0, heading)))
    return found


def trailed(run: Trajectory) -> list[tuple[str, np.ndarray]]:
    """The path of the axle of each trailer, and of each other body that carries wheels away from its hinge."""
    found = []
    for hinge in run.scene.hinges:
        wheels = [wheel for wheel in run.scene.vehicle["wheel"] if wheel.get("body") == hinge.name]
        if hinge.form not in ("trailer", "body") or not wheels:
            continue
        axle = complex(np.mean([wheel["x_m"] for wheel in wheels]), np.mean([wheel["y_m"] for wheel in wheels]))
        if abs(axle) < 1e-9:
            continue
        x, y, heading = (run.columns[f"{name}[{hinge.name}]"] for name in DRAWN[2:])
        found.append((hinge.name, x + 1j * y + np.exp(1j * heading) * axle))
    return found


def poses(run: Trajectory) -> list[int]:
    """Rows at which the vehicle is drawn: start, end, and between them where it does not lie over itself."""
    place = run.columns["x_m"] + 1j * run.columns["y_m"]
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(place)))])
    size = 2.0 * max((abs(point) for points in outline_points(run.scene).values() for point in points), default=0.1)
    rows = [0]
    for part in range(1, POSES):
        row = int(np.searchsorted(way, way[-1] * part / (POSES - 1)))
        row = min(row, len(place) - 1)
        if all(abs(place[row] - place[other]) > APART * size for other in rows):
            rows.append(row)
    if rows[-1] != len(place) - 1 and abs(place[-1] - place[0]) > 0.5 * size:
        rows = [row for row in rows if row == 0 or abs(place[row] - place[-1]) > APART * size] + [len(place) - 1]
    return rows


def draw_vehicle(axes: Axes, scene: Scene, frames: Frames, outline: dict[str, list[complex]]) -> None:
    """Outlines of bodies and their wheels, at one instant."""
    names = [CARRIAGE, *(hinge.name for hinge in scene.hinges)]
    for name, (origin, direction) in zip(names, frames, strict=True):
        corners = np.array(hull(outline[name]))
        if len(corners) > 1:
            shape = origin + direction * np.append(corners, corners[0])
            axes.plot(shape.real, shape.imag, color=BODY, lw=0.9, zorder=3)
    for wheel in scene.vehicle["wheel"]:
        origin, direction = frames[names.index(wheel.get("body", CARRIAGE))]
        middle = origin + direction * complex(wheel["x_m"], wheel["y_m"])
        half = direction * cmath.rect(wheel.get("radius_m", scene.vehicle["wheel_radius_m"]),
                                      wheel["axle_rad"] + np.pi / 2)
        axes.plot([(middle - half).real, (middle + half).real], [(middle - half).imag, (middle + half).imag],
                  color=WHEEL, lw=TYRE, solid_capstyle="butt", zorder=3.2)


SLIPPING = {"slip": ("slip_across_m_per_s", "slip across [m/s]", "Slip of each wheel across its rolling direction"),
            "loads": ("wheel_load_N", "load [N]", "Normal loads of the wheels")}
ENERGIES = ("energy_J", "supply_energy_J", "slip_loss_J", "motor_loss_J", "axle_loss_J", "hinge_loss_J")


def slipping_panels(run: Trajectory) -> list[str]:
    """Panels of a run on ground with friction: those whose signals it kept."""
    if not run.scene.slips_on_hinges:
        return []
    names = {signal.partition("[")[0] for signal in run.columns}
    found = [panel for panel, (name, _, _) in SLIPPING.items() if name in names]
    return [*found, *(["energy"] if names.issuperset(ENERGIES) else [])]


def plot_slipping(axes: Axes, panel: str, run: Trajectory) -> None:
    """Slip or load of each wheel, or the book of energies, over time."""
    if panel == "energy":
        columns, labels = np.column_stack([run.columns[name] for name in ENERGIES]), list(ENERGIES)
        unit, title = "energy [J]", "Energy: what moves, what came from the supply, what was lost"
    else:
        name, unit, title = SLIPPING[panel]
        columns = run.columns_of(name)
        labels = [f"wheel {i}" for i in range(1, columns.shape[1] + 1)]
    plot_over_time(axes, run, columns, labels, (unit, title))


def plot_hinges(axes: Axes, run: Trajectory) -> None:
    """The angle of every hinge over time."""
    plot_over_time(axes, run, run.columns_of("hinge_angle_rad"), [hinge.name for hinge in run.scene.hinges],
               ("hinge angle [rad]", "Hinge angles"), "hinge")
