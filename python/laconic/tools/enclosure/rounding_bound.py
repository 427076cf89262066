"""What rounding in single precision can do in one explicit step of fourth order at most, proved, for all states and
inputs of a scene.

Beside the same step in exact arithmetic with the constants as the core prepared them. Sums of a state carry what they
could not take up, so the bounds do not grow with the distance travelled or the turns made.

The operations of a Runge-Kutta step with its inputs held, in the core's order, for any kind of number.

With numpy's float32 it has the core's bits (a test compares them); with laconic.tools.enclosure.state it tells how
far rounding can bring them from exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb

from laconic.core import load
from laconic.errors import BadInput, Refused
from laconic.scene import Scene
from laconic.scene.methods import EXPLICIT
from laconic.simulation import advance_plant
from laconic.tools.enclosure.balls import ball, precision, upper
from laconic.tools.enclosure.readings import check_enclosable
from laconic.tools.enclosure.state import Format, Rounded

Numbers = list[Any]

SINE = (-0.16666654940256574587, 0.0083321779190321380808, -0.00019517267132177431398)
COSINE = (0.041666646860773310301, -0.0013887367223119975287, 0.000024438416549882651326)
SINC = (-0.16666664580678050564, 0.0083290180090501000745)
J1 = (0.33333329701864815124, -0.033314737524190506486)
SINE_ERROR, COSINE_ERROR, SINC_ERROR, J1_ERROR = 4e-9, 1e-10, 3e-11, 4e-8  # of the polynomials, as polynomials.h has


@dataclass(frozen=True)
class Constants:
    """What a step reads of model and integrator, as the kind of number that it is taken with."""

    step_s: Any
    spin: Numbers
    gyro: Numbers
    decay: Numbers
    along: Numbers
    across: Numbers
    yaw: Numbers
    of: Any  # makes a constant of the text such a number


@dataclass(frozen=True)
class Step:
    """What a step adds: to ζ, to ∫ζ dt, along and across the heading in its middle, to the heading."""

    delta: Numbers
    path: Numbers
    forth: Any
    left: Any
    yaw: Any


def dot(a: Numbers, b: Numbers) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Numbers, b: Numbers) -> Numbers:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def scaled(factor: Any, v: Numbers) -> Numbers:
    return [factor * x for x in v]


def plus(a: Numbers, b: Numbers) -> Numbers:
    return [x + y for x, y in zip(a, b, strict=True)]


def rate(k: Constants, z: Numbers, b: Numbers) -> Numbers:
    """zeta_rate of step_internals.h"""
    gyroscopic = scaled(dot(k.spin, z), cross(z, k.gyro))
    return [q - r * x + f for q, r, x, f in zip(gyroscopic, k.decay, z, b, strict=True)]


def rk4_step(k: Constants, z: Numbers, b: Numbers) -> Step:
    """held_stages, simpson and displacement."""
    h, half = k.step_s, k.of(0.5) * k.step_s
    k1 = rate(k, z, b)
    k2 = rate(k, plus(z, scaled(half, k1)), b)
    k3 = rate(k, plus(z, scaled(half, k2)), b)
    k4 = rate(k, plus(z, scaled(h, k3)), b)
    sixth = h * k.of(1.0 / 6.0)
    inner = plus(k2, k3)
    forth = scaled(sixth, plus(k1, inner))
    mean = plus(z, forth)
    delta = plus(forth, scaled(sixth, plus(inner, k4)))
    return displaced(k, delta, scaled(h, mean), scaled(h, delta))


def displaced(k: Constants, delta: Numbers, path: Numbers, bend: Numbers) -> Step:
    """displacement of step_internals.h, for a yaw below a quarter of a radian."""
    yaw, yaw_bend = dot(k.yaw, path), dot(k.yaw, bend) * k.of(1.0 / 12.0)
    forth, left = dot(k.along, path), dot(k.across, path)
    alpha = k.of(0.5) * yaw
    square = alpha * alpha
    sinc = k.of(1.0) + square * horner(k, SINC, square)
    half_j1 = k.of(0.5) * alpha * horner(k, J1, square)
    aside_forth = half_j1 * dot(k.along, bend) - yaw_bend * forth
    aside_left = half_j1 * dot(k.across, bend) - yaw_bend * left
    return Step(delta, path, sinc * forth - aside_left, sinc * left + aside_forth, yaw)


def horner(k: Constants, coefficients: Sequence[float], x: Any) -> Any:
    """c0 + x (c1 + x (c2 …))"""
    found = k.of(coefficients[-1])
    for each in reversed(coefficients[:-1]):
        found = k.of(each) + x * found
    return found


def direction(k: Constants, x: Any) -> tuple[Any, Any]:
    """Sine and cosine of an angle of at most π/4."""
    z = x * x
    return (x + x * z * horner(k, SINE, z), k.of(1.0) - z * k.of(0.5) + z * z * horner(k, COSINE, z))


BITS = 100
MARGIN = 1.05           # of the box, over what the run shows
SMALL_YAW = 0.125       # half the yaw of a step, up to which the polynomials hold
FLUSHED = 1e-24         # what a component below 1e-18 rad/s loses in single
TURN_BITS = 32
SUM = 3                 # roundings of an addend at most, in being added to a sum that keeps what it could not take up


@dataclass(frozen=True)
class Bounds:
    """Of one step: of ζ as ν in rad/s, of the heading, of the place."""

    nu_rad_per_s: float
    heading_rad: float
    place_m: float


@dataclass(frozen=True)
class Box:
    """What the scene meets: the largest |ζ| of each axis, and b by its smallest and largest."""

    zeta: np.ndarray
    forcing: tuple[np.ndarray, np.ndarray]
    far_m: float


def constants_of(plant: Any, of: Any) -> Constants:
    """A plant's, as a kind of number."""
    m = plant.c.model
    rows = (m.nu_of_zeta[2], m.gyro, m.decay_per_s, m.velocity_of_zeta[0], m.velocity_of_zeta[1], m.yaw_rate_of_zeta)
    spin, gyro, decay, along, across, yaw = ([of(float(x)) for x in row] for row in rows)
    return Constants(of(float(plant.c.integrator.step_s)), spin, gyro, decay, along, across, yaw, of)


def forcing_of(plant: Any, values: Any) -> np.ndarray:
    """b of held inputs; BadInput where it turns with the heading."""
    core = plant.core
    found = core.ffi.new("laconic_forcing *")
    core.lib.laconic_forcing_of(found, core.ffi.addressof(plant.c, "model"), core.input(values))
    if found.rotates:
        raise BadInput("a force fixed in the world turns with the heading; no bound is known for it")
    return core.numbers(found.constant).astype(float)


def box_of(scene: Scene) -> Box:
    """From the scene's own run; its inputs are held, so b takes the values of its segments."""
    plant, inputs = scene.plant(load(scene.run.real)), scene.inputs_on_grid()
    most, far = np.abs([float(part.value) for part in plant.c.state.zeta]), 0.0
    forcings = []
    for segment in inputs.segments():
        forcings.append(forcing_of(plant, segment.values))
        for first in range(segment.first_step, segment.first_step + segment.steps):
            advance_plant(plant, inputs, first, 1)
            most = np.maximum(most, [abs(float(part.value)) for part in plant.c.state.zeta])
            far = max(far, abs(float(plant.pose.x_m)), abs(float(plant.pose.y_m)))
    return Box(MARGIN * most, (np.min(forcings, axis=0), np.max(forcings, axis=0)), MARGIN * far)


def rounding_bounds(scene: Scene) -> Bounds:
    """Of an explicit step of the scene's length. BadInput for a scene that has no such bound, Refused for a step that
    the method does not take."""
    check_enclosable(scene)
    scene = scene.with_run(method=EXPLICIT, real="single")
    box, plant = box_of(scene), scene.plant(load("single"))
    with precision(BITS):
        form = Format.of("single")
        k = constants_of(plant, lambda x: Rounded(arb(x), arb(0), form))
        zeta = [Rounded(arb(0, float(x)), form.unit * float(x), form) for x in box.zeta]
        forcing = [Rounded(ball(float(low)).union(ball(float(high))), arb(0), form)
                   for low, high in zip(*box.forcing, strict=True)]
        return bounds_of(plant, k, rk4_step(k, zeta, forcing), box, form)


def bounds_of(plant: Any, k: Constants, step: Any, box: Box, form: Format) -> Bounds:
    """The step's own rounding, and that of adding it to the state."""
    if not upper(step.yaw.exact) < 2 * SMALL_YAW:
        raise BadInput("a step in which it yaws by a quarter of a radian: no bound is known for it; take a shorter one")
    sums = [upper(d.off + SUM * form.unit * (upper(d.exact) + d.off + 2 * form.unit * float(z))) + FLUSHED
            for d, z in zip(step.delta, box.zeta, strict=True)]
    nu = max(float(sum(abs(float(x)) * e for x, e in zip(row, sums, strict=True))) for row in plant.c.model.nu_of_zeta)
    unit = arb(2) ** (1 - TURN_BITS)  # of half turns
    turned = upper(step.yaw.exact)
    heading = step.yaw.off + 3 * form.unit * turned + form.unit * (turned + unit * arb.pi())
    return Bounds(nu, float(upper(heading)), float(place_of(k, step, box, form, unit)))


def place_of(k: Constants, step: Any, box: Box, form: Format, unit: arb) -> arb:
    """The displacement turned into the world and added."""
    near = Rounded(arb(0, 1) * arb.pi() / 4, form.unit * arb.pi() / 2, form)
    sine, cosine = direction(k, near)
    off = upper(sine.off + SINE_ERROR + cosine.off + COSINE_ERROR + 2 * unit * arb.pi())
    turned = Rounded(arb(0, 1), off, form)
    chord = arb(SINC_ERROR) + arb(J1_ERROR)
    ahead, aside = (each.with_more(chord * (upper(step.forth.exact) + upper(step.left.exact)))
                    for each in (step.forth, step.left))
    moved = turned * ahead + turned * aside
    return upper(moved.off + SUM * form.unit * (upper(moved.exact) + moved.off + 2 * form.unit * box.far_m))


def rounding_row(scene: Scene) -> dict[str, Any]:
    """For the report: bounds of a step, and what they come to in an hour if every step rounds as badly as it can."""
    row: dict[str, Any] = {"scene": scene.path.stem, "step_s": scene.run.step_s}
    try:
        found = rounding_bounds(scene)
    except (Refused, BadInput) as why:
        return row | {"status": str(why).removeprefix(f"{scene.path}: ")}
    hour = 3600.0 / scene.run.step_s
    return row | {"status": "ok", "nu_rad_per_s": found.nu_rad_per_s, "heading_rad": found.heading_rad,
                  "place_m": found.place_m, "heading_rad_per_hour": hour * found.heading_rad,
                  "place_m_per_hour": hour * found.place_m}
