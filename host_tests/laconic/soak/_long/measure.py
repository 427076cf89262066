"""How far a vehicle is from its closed form: heading and place from the state with all that it holds."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from mpmath import mp, mpf

from laconic.soak._long.cases import Prepared
from laconic.soak._long.closed_form import velocity_of

Row = dict[str, Any]
BITS = {"double": 64, "single": 32}  # of a turn
LEAST_PATH_M = 1.0


def total(part: Any) -> Any:
    """A compensated sum's value and rest."""
    return mpf(float(part.value)) + mpf(float(part.rest))


def heading_of(state: Any, real: str) -> Any:
    """Turns, their fraction, and what is left of a unit."""
    unit = mpf(2) ** -BITS[real]
    return (mpf(int(state.heading.turns)) + int(state.heading.fraction) * unit
            + 2 * unit * mpf(float(state.heading.rest))) * 2 * mp.pi


def row_of(prepared: Prepared, state: Any, real: str, steps: int, step_s: float) -> Row:
    """Errors after so many steps. `aside_m`: of the place, less what the heading's own error brings, which moves it
    along the path."""
    truth, model = prepared.motion.at(steps * Fraction(step_s)), prepared.motion.model
    late = heading_of(state, real) - truth.heading
    off = mp.mpc(total(state.x_m), total(state.y_m)) - truth.place
    turned = truth.heading - prepared.motion.heading
    yaw_rate, path = truth.nu[2] / model.yaw_scale, max(truth.path, mpf(LEAST_PATH_M))
    speed = model.radius * mp.sqrt(sum(x**2 for x in truth.nu))  # of which ν is rounded, whatever the place does
    aside = off
    if abs(turned) > 1:
        aside = off - velocity_of(model, truth.nu) * mp.expj(truth.heading) * late / yaw_rate
    return {"case": prepared.case.name, "steps": steps, "heading_error_rad": float(late),
            "heading_relative": float(abs(late) / max(abs(turned), mpf(1))), "place_error_m": float(abs(off)),
            "place_relative": float(abs(off) / path), "aside_m": float(abs(aside)),
            "reach_m": float(max(speed * steps * mpf(step_s), mpf(LEAST_PATH_M))), "path_m": float(truth.path),
            "turns": float(turned / (2 * mp.pi))}
