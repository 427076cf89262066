"""The robot of a film in its body frame, in metres: a body around its wheels, and wheels whose treads turn."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.pictures.film.timing import Timing
from laconic.pictures.film.world import reach_m
from laconic.pictures.outlines import DRAWN, hull, outline_points
from laconic.simulation import Trajectory

BODY, EDGE, WHEEL, TREAD, NOSE = "#f3b54a", "#b97a12", "#2b3a49", "#8fa3b5", "#b97a12"
TREADS = 3   # pairs of a bar and a gap along a wheel's length
THICK = 0.7  # of a wheel, of its radius


def robot(run: Trajectory, timing: Timing) -> tuple[str, str]:
    """The group, and the rules by which the treads turn."""
    wheels, style = _wheels_of(run, timing, CARRIAGE)
    return _body(run) + wheels + _marks(run), style


def hung(run: Trajectory, timing: Timing) -> tuple[str, str]:
    """The bodies on hinges, each moving in the world by itself, and the rules by which they do."""
    groups, style = "", ""
    outlines = outline_points(run.scene) if run.scene.has_hinges else {}
    for number, hinge in enumerate(run.scene.hinges, start=1):
        x, y, heading = (run.columns[f"{name}[{hinge.name}]"] for name in DRAWN[2:])
        turn = np.degrees(np.unwrap(heading))  # so that the browser turns it the short way
        states = [f"transform: translate({x[row]:.4f}px, {y[row]:.4f}px) rotate({turn[row]:.2f}deg)"
                  for row in (*timing.rows, -1)]
        wheels, of_wheels = _wheels_of(run, timing, hinge.name)
        style += timing.keyframes(f"b{number}", states[:-1]) + of_wheels
        style += f".b{number} {{ animation-name: b{number}; {states[-1]}; }}\n"
        corners = " ".join(f"{point.real:.4f},{point.imag:.4f}" for point in hull(outlines[hinge.name]))
        wide = 0.6 * run.scene.vehicle["wheel_radius_m"]
        groups += (f'<g class="m b{number}"><polygon points="{corners}" fill="{BODY}" stroke="{EDGE}" '
                   f'stroke-width="{wide:.4f}" stroke-linejoin="round"/>\n{wheels}</g>\n')
    return groups, style


def _wheels_of(run: Trajectory, timing: Timing, body: str) -> tuple[str, str]:
    """The wheels of one body, and the rules by which their treads turn."""
    vehicle = run.scene.vehicle
    style, wheels = "", ""
    for number, wheel in enumerate(vehicle["wheel"], start=1):
        if wheel.get("body", CARRIAGE) != body:
            continue
        radius = wheel.get("radius_m", vehicle["wheel_radius_m"])
        rolled_m = radius * run.columns[f"wheel_angle_rad[{number}]"]
        style += timing.keyframes(f"w{number}", [f"stroke-dashoffset: {-rolled_m[row]:.4f}" for row in timing.rows])
        style += f".w{number} {{ animation-name: w{number}; }}\n"
        wheels += _wheel(wheel, radius, number)
    return wheels, style


def _wheel(wheel: dict[str, Any], radius: float, number: int) -> str:
    """A wheel from above, and its tread: bars that move with the wheel's angle."""
    thick, bar = THICK * radius, radius / TREADS
    turn = f"translate({wheel['x_m']:.4f} {wheel['y_m']:.4f}) rotate({np.degrees(wheel['axle_rad']) + 90.0:.3f})"
    return (f'<g transform="{turn}"><rect x="{-radius:.4f}" y="{-thick / 2:.4f}" width="{2 * radius:.4f}" '
            f'height="{thick:.4f}" rx="{0.2 * thick:.4f}" fill="{WHEEL}"/>'
            f'<path class="m w{number}" d="M{-0.94 * radius:.4f} 0H{0.94 * radius:.4f}" stroke="{TREAD}" '
            f'stroke-width="{0.6 * thick:.4f}" stroke-dasharray="{bar:.4f}"/></g>\n')


def _body(run: Trajectory) -> str:
    """A rounded plate around the wheels; around none, or wheels in one line, a disc."""
    vehicle = run.scene.vehicle
    radius = vehicle["wheel_radius_m"]
    points = np.array([(wheel["x_m"], wheel["y_m"]) for wheel in vehicle["wheel"]]).reshape(-1, 2)
    if run.scene.has_hinges:
        found = np.array(hull(outline_points(run.scene)[CARRIAGE]))
        points = np.column_stack([found.real, found.imag])
    if len(points) < 3 or np.linalg.matrix_rank(points - points[0], tol=1e-6) < 2:
        return (f'<circle r="{0.9 * reach_m(run):.4f}" fill="{BODY}" stroke="{EDGE}" '
                f'stroke-width="{0.1 * radius:.4f}"/>\n')
    middle = points.mean(axis=0)
    order = np.argsort(np.arctan2(*(points - middle).T[::-1]), kind="stable")
    outline = " ".join(f"{x:.4f},{y:.4f}" for x, y in points[order])
    wide = f'points="{outline}" stroke-linejoin="round"'
    return (f'<polygon {wide} fill="{EDGE}" stroke="{EDGE}" stroke-width="{1.5 * radius:.4f}"/>'
            f'<polygon {wide} fill="{BODY}" stroke="{BODY}" stroke-width="{1.3 * radius:.4f}"/>\n')


def _marks(run: Trajectory) -> str:
    """An arrow ahead from the origin, and the centre of mass, which draws the path."""
    long, com = 0.5 * reach_m(run), (run.scene.vehicle["com_x_m"], run.scene.vehicle["com_y_m"])
    return (f'<path d="M0 0H{long:.4f}m{-0.3 * long:.4f} {0.25 * long:.4f}l{0.3 * long:.4f} {-0.25 * long:.4f}'
            f'l{-0.3 * long:.4f} {-0.25 * long:.4f}" fill="none" stroke="{NOSE}" stroke-width="{0.1 * long:.4f}" '
            f'stroke-linecap="round" stroke-linejoin="round"/>'
            f'<circle cx="{com[0]:.4f}" cy="{com[1]:.4f}" r="{0.1 * long:.4f}" fill="#1f6fb2"/>')
