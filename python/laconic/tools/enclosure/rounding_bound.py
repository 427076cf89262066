"""What rounding in single precision can do in one explicit step of fourth order at most, proved, for all states and
inputs of a scene.

Beside the same step in exact arithmetic with the constants as the core prepared them. Sums of a state carry what they
could not take up, so the bounds do not grow with the distance travelled or the turns made.
"""

from __future__ import annotations

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
from laconic.tools.enclosure.rk4_text import (
    COSINE_ERROR,
    J1_ERROR,
    SINC_ERROR,
    SINE_ERROR,
    Constants,
    direction,
    rk4_step,
)
from laconic.tools.enclosure.state import Format, Rounded

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
