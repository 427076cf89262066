"""The bifurcation diagram over one parameter, with the limit cycles born at its Andronov–Hopf points."""

from __future__ import annotations

import numpy as np

from laconic.analysis import confirm, pushed
from laconic.analysis.continuation import Diagram, diagram
from laconic.analysis.cycle import cycle_near
from laconic.analysis.findings import BifurcationPart, CyclePart, Study, Wishes, nu_text
from laconic.analysis.from_core import Subject
from laconic.analysis.hopf import HopfPoint
from laconic.analysis.motions import (
    Parameter,
    commanded_straight,
    default_range,
    parameter_named,
    straight_thresholds,
)
from laconic.analysis.steady import steady_motions

CYCLE_SHARES = (0.97,)  # of the way from the branch's other end to the Hopf point


def bifurcation_part(result: Study, wishes: Wishes) -> None:
    subject = result.subject
    reason = _no_diagram(subject, wishes)
    if reason:
        result.say("bifurcation", reason)
        return
    straight = np.array([*wishes.straight, 0.0]) if wishes.straight else commanded_straight(subject)
    parameter = parameter_named(subject, wishes.parameter, straight)
    low, high = default_range(parameter)
    low, high = (low if wishes.low is None else wishes.low), (high if wishes.high is None else wishes.high)
    found = diagram(parameter.field_of, low, high)
    thresholds = straight_thresholds(parameter) if parameter.name in ("nu1", "nu2") else []
    cycles = [part for hopf in found.hopf for part in _cycles_of(parameter, found, hopf)]
    result.bifurcation = BifurcationPart(parameter, low, high, found, thresholds, cycles)
    _tell_bifurcation(result, result.bifurcation)


def _no_diagram(subject: Subject, wishes: Wishes) -> str | None:
    if float(subject.model.motor_damping_Nms) == 0.0 or not subject.field({}).decay_per_s.any():
        return "No bifurcation diagram: the motors do not damp (c2 = 0), so constant inputs have no steady answer."
    if pushed.world_force_acts(subject):
        return "No bifurcation diagram: a force fixed in the world acts."
    inputs_zero = not any(subject.inputs.values())
    if inputs_zero and wishes.straight is None and wishes.parameter in (None, "input_scale"):
        return ("No bifurcation diagram: all inputs are zero at this instant; choose another with --at, or give a "
                "straight "
                "motion with --straight NU1 NU2.")
    return None


def _cycles_of(parameter: Parameter, found: Diagram, hopf: HopfPoint) -> list[CyclePart]:
    """Limit cycles on the side of the Hopf point where they exist, at some distances from it."""
    branch = min(found.branches, key=lambda b: float(np.abs(b.nu() - hopf.nu).sum(axis=1).min()))
    reach = max(abs(p - hopf.parameter) for p in branch.parameter)
    values = [hopf.parameter + sign * (1.0 - share) * reach for share in CYCLE_SHARES for sign in (-1.0, 1.0)]
    if abs(parameter.at_scene - hopf.parameter) < 0.1 * reach:
        values.append(parameter.at_scene)
    parts = []
    for value in values:
        here = parameter.field_of(value)
        motions = steady_motions(here)
        if not motions:
            continue
        motion = min(motions, key=lambda m: float(np.abs(m.nu - hopf.nu).max()))
        cycle = cycle_near(here, motion.zeta, value, hopf.lyapunov)
        if cycle is not None:
            subject, inputs = parameter.subject_of(value), parameter.inputs_of(value)
            confirmation = confirm.limit_cycle(subject, inputs, here, cycle, motion.zeta)
            parts.append(CyclePart(cycle, motion.nu, hopf, confirmation))
    return parts


def _speeds(result: Study, part: BifurcationPart) -> str:
    """What a range of commanded ν means for the body's speed."""
    if part.parameter.name not in ("nu1", "nu2"):
        return ""
    low, high = (float(result.subject.model.wheel_radius_m) * nu for nu in (part.low, part.high))
    return f" rad/s ({low:.4g} to {high:.4g} m/s)"


def _tell_bifurcation(result: Study, part: BifurcationPart) -> None:
    name = part.parameter.name
    count = len(part.diagram.branches)
    result.say("bifurcation", f"Steady motions for {name} from {part.low:.6g} to {part.high:.6g}"
                              f"{_speeds(result, part)}: {count} branch{'es' if count != 1 else ''}.")
    for value in part.thresholds:
        result.say("bifurcation", f"Straight motion changes its stability at {name} = {value:.9g}.")
    for special in part.diagram.specials:
        result.say("bifurcation", f"{special.kind.capitalize()} at {name} = {special.parameter:.9g}, ν = "
                   f"({nu_text(special.nu)}) rad/s.")
    for hopf in part.diagram.hopf:
        born = "an unstable limit cycle around the stable motion" if hopf.lyapunov > 0.0 else "a stable limit cycle"
        result.say("bifurcation", f"Andronov–Hopf point at {name} = {hopf.parameter:.9g}, ν3 = {hopf.nu[2]:.6g} rad/s, "
                   f"{hopf.frequency_rad_per_s:.6g} rad/s: first Lyapunov coefficient {hopf.lyapunov:+.3e}, "
                   f"{hopf.kind}: "
                   f"{born} is born.")
    for item in part.cycles:
        multipliers = ", ".join(f"{abs(m):.6g}" for m in item.cycle.multipliers)
        result.say("bifurcation", f"Limit cycle at {name} = {item.cycle.parameter:.6g} about ν3 = "
                                  f"{item.centre_nu[2]:.6g} rad/s: "
                   f"period {item.cycle.period_s:.6g} s, multipliers {multipliers}: "
                   f"{'stable' if item.cycle.stable else 'unstable'}; {item.confirmation.words}.")
        if not item.confirmation.holds:
            result.failures.append(f"limit cycle at {name} = {item.cycle.parameter:.6g}: {item.confirmation.words}")
    if not part.diagram.hopf:
        result.say("bifurcation", "No Andronov–Hopf point in this range.")
