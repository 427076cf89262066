"""One run as a moving picture: the robot on its path, and its velocities and wheel speeds over time.

The file is text made of the run's numbers alone, so the same run gives the same bytes. Its CSS moves the parts; what
shows no animation (a printer, a reader who wants none) shows the end of the run with the whole path.
"""

from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np

from laconic.base.outputs import write_text
from laconic.pictures.film.curves import Panel, curves
from laconic.pictures.film.robot import hung, robot
from laconic.pictures.film.timing import timing_of
from laconic.pictures.film.world import grid_m, world
from laconic.simulation import Trajectory

WIDTH, HEIGHT, HEAD = 720, 420, 52
FIELD = (16, HEAD, 350, HEIGHT - HEAD - 42)
MOST_LETTERS = 50  # of a name
INK, PAPER = "#1d2733", "#ffffff"
FILMED = ("origin_x_m", "origin_y_m")
"""What a run keeps for its film beside the usual signals: the place of the body frame, in which the wheels stand."""


def write_film(run: Trajectory, path: Path) -> None:
    """Writes the film of a run that has kept the usual signals and FILMED."""
    write_text(path, film(run))


def film(run: Trajectory) -> str:
    """The SVG."""
    timing = timing_of(run.time_s)
    field, moving = world(run, timing, FIELD)
    drawn, wheels = robot(run, timing)
    bodies, turning = hung(run, timing)
    panels, cursor = curves(_panels(run), run.time_s, timing, (428, HEAD, 276, HEIGHT - HEAD - 10))
    style = "".join((timing.style(), moving, wheels, turning, cursor))
    name, words = escape(_short(run.scene.name), quote=False), f"{timing.in_words()}, grid of {grid_m(run, FIELD):g} m"
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
            f'font-family="system-ui, sans-serif" font-size="19" fill="{INK}">\n'
            f"<title>{name}: {words}</title>\n<style>\n{style}</style>\n"
            f'<rect width="{WIDTH}" height="{HEIGHT}" rx="10" fill="{PAPER}"/>\n'
            f'<text x="16" y="34" font-size="24" font-weight="600">{name}</text>\n'
            f'<text x="16" y="{HEIGHT - 18}" fill="#5b6672">{words}</text>\n'
            f"{field.format(robot=drawn, bodies=bodies)}{panels}</svg>\n")


def _short(name: str) -> str:
    return name if len(name) <= MOST_LETTERS else f"{name[:MOST_LETTERS - 1]}…"


def _panels(run: Trajectory) -> list[Panel]:
    velocity = run.columns_of("velocity_body_m_per_s")
    panels = [Panel("velocity, m/s", velocity, ("ahead", "left")),
              Panel("yaw rate, rad/s", run.columns["yaw_rate_rad_per_s"][:, np.newaxis], ())]
    if run.scene.wheel_count:
        speeds = run.columns_of("wheel_speed_rad_per_s")
        names = tuple(str(i + 1) for i in range(speeds.shape[1])) if speeds.shape[1] <= 4 else ()
        panels.append(Panel("wheel speeds, rad/s", speeds, names))
    return panels
