"""A vehicle's equation (4.7) in 50 digits, from the numbers of a scene: independent of the core's preparation.

Vectors are lists of mpf. ζ has as many numbers as there are degrees of freedom, padded with 0 to three.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mpmath import mp, mpf

GRAVITY = "9.80665"
RANK_TOLERANCE = mpf("1e-9")

Vector = list[Any]
Numbers = dict[str, Any]


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return sum((x * y for x, y in zip(a, b, strict=True)), mpf(0))


def cross(a: Vector, b: Vector) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def added(a: Vector, factor: Any, b: Vector) -> Vector:
    return [x + factor * y for x, y in zip(a, b, strict=True)]


def numbers_of(table: Mapping[str, Any], stem: str = "") -> Numbers:
    """Every number of a [vehicle] by its path: "mass_kg", "wheel[2].x_m", "payload.x_m", "ground.slope_rad"."""
    found: Numbers = {}
    for key, value in table.items():
        if isinstance(value, Mapping):
            found |= numbers_of(value, f"{stem}{key}.")
        elif isinstance(value, list):
            for item, each in enumerate(value, start=1):
                found |= numbers_of(each, f"{stem}{key}[{item}].")
        else:
            found[stem + key] = mpf(value) if isinstance(value, float) else value
    return found


@dataclass(frozen=True)
class ExactModel:
    """G by rows, w, r, and what inputs and outputs need."""

    nu_of_zeta: list[Vector]
    zeta_of_nu: list[Vector]
    gyro: Vector
    decay: Vector
    radius: Any
    yaw_scale: Any
    torque_scale: Any
    wheel_rows: list[Vector]  # Ξ G
    gains: Vector             # c1 of each wheel
    slope_force: Vector

    def zeta(self, nu: Vector) -> Vector:
        return [dot(row, nu) for row in self.zeta_of_nu]

    def nu(self, zeta: Vector) -> Vector:
        return [dot(row, zeta) for row in self.nu_of_zeta]


def _orthonormal(rows: list[Vector], known: list[Vector]) -> list[Vector]:
    """Directions of the rows beyond those known, dependent ones left out."""
    found = list(known)
    for row in rows:
        size = mp.sqrt(dot(row, row))
        rest = [x / size for x in row]
        for _ in range(2):
            for axis in found:
                rest = added(rest, -dot(rest, axis), axis)
        size = mp.sqrt(dot(rest, rest))
        if size > RANK_TOLERANCE and len(found) < 3:
            found.append([x / size for x in rest])
    return found[len(known) :]


class _Wheel:
    """One wheel's numbers, its own or the vehicle's."""

    def __init__(self, v: Numbers, stem: str):
        own = {key: v.get(f"{stem}{key}") for key in (
            "radius_m", "inertia_kgm2", "motor_gain_Nm_per_V", "motor_damping_Nms")}
        given = {"radius_m": v["wheel_radius_m"], "inertia_kgm2": v["wheel_inertia_kgm2"],
                 "motor_gain_Nm_per_V": v["motor_gain_Nm_per_V"], "motor_damping_Nms": v["motor_damping_Nms"]}
        self.radius, self.inertia, self.gain, self.damping = (
            given[key] if value is None else value for key, value in own.items())
        if not v.get(f"{stem}driven", True):
            self.gain = self.damping = mpf(0)
        self.fixed = v[f"{stem}kind"] == "fixed"
        self.locked = v.get(f"{stem}locked", False)
        self.x, self.y, self.axle = v[f"{stem}x_m"], v[f"{stem}y_m"], v[f"{stem}axle_rad"]
        self.roller = mp.pi / 2 if self.fixed else v[f"{stem}roller_rad"]


def _line(x: Any, y: Any, angle: Any, scale: Any) -> Vector:
    return [mp.cos(angle), mp.sin(angle), (x * mp.sin(angle) - y * mp.cos(angle)) / scale]


def _diagonalised(basis: list[Vector], inertia: Any, damping: Any) -> tuple[list[Vector], Vector]:
    """Columns of G, and the rates: GᵀAG = 1, GᵀDG = diag(r)."""
    span = mp.matrix(basis).T
    lower = mp.cholesky(span.T * inertia * span)
    scaled = span * mp.inverse(lower).T
    reduced = scaled.T * damping * scaled
    rates, axes = mp.eigsy((reduced + reduced.T) / 2)
    full = scaled * axes
    return [[full[i, k] for i in range(3)] for k in range(len(basis))], list(rates)


def exact_model(v: Numbers) -> ExactModel:
    """The model of the vehicle with these numbers."""
    load, load_x, load_y, load_inertia = (v.get(f"payload.{key}", mpf(0))
                                          for key in ("mass_kg", "x_m", "y_m", "yaw_inertia_kgm2"))
    mass, radius = v["mass_kg"] + load, v["wheel_radius_m"]
    com_x = (v["mass_kg"] * v["com_x_m"] + load * load_x) / mass
    com_y = (v["mass_kg"] * v["com_y_m"] + load * load_y) / mass
    apart = (load_x - v["com_x_m"]) ** 2 + (load_y - v["com_y_m"]) ** 2
    inertia = v["yaw_inertia_kgm2"] + load_inertia + v["mass_kg"] * load / mass * apart
    yaw_scale, unit = mp.sqrt(inertia / mass) / radius, mass * radius**2
    stems = sorted({key.partition(".")[0] for key in v if key.startswith("wheel[")}, key=lambda s: int(s[6:-1]))
    wheels = [_Wheel(v, f"{stem}.") for stem in stems]
    rows, constraints = [], []
    form, damped = mp.eye(3), mp.zeros(3)
    for wheel in wheels:
        line = _line(wheel.x - com_x, wheel.y - com_y, wheel.axle + wheel.roller, radius * yaw_scale)
        row = [x * radius / wheel.radius / mp.sin(wheel.roller) for x in line]
        if wheel.fixed:
            constraints.append(_line(wheel.x - com_x, wheel.y - com_y, wheel.axle, radius * yaw_scale))
        if wheel.locked:
            constraints.append(row)
        rows.append(row)
        square = mp.matrix(row) * mp.matrix(row).T
        form += wheel.inertia / unit * square
        damped += wheel.damping / unit * square
    bound = _orthonormal(constraints, [])
    basis = _orthonormal([[mpf(i == k) for k in range(3)] for i in range(3)], bound)
    columns, rates = _diagonalised(basis, form, damped)
    spread = mp.matrix(columns).T
    inverse = mp.inverse(spread.T * spread) * spread.T
    missing = 3 - len(columns)
    g = [[columns[k][i] for k in range(len(columns))] + [mpf(0)] * missing for i in range(3)]
    pull = mass * mpf(GRAVITY) * mp.sin(v.get("ground.slope_rad", mpf(0)))
    uphill = v.get("ground.slope_heading_rad", mpf(0))
    return ExactModel(
        g, [[inverse[k, i] for i in range(3)] for k in range(len(columns))] + [[mpf(0)] * 3] * missing,
        [x / yaw_scale for x in cross(g[0], g[1])], rates + [mpf(0)] * missing, radius, yaw_scale, 1 / unit,
        [[dot(row, column) for column in columns] + [mpf(0)] * missing for row in rows], [w.gain for w in wheels],
        [-pull * mp.cos(uphill), -pull * mp.sin(uphill)])
