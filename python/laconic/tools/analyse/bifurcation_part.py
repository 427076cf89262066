"""The bifurcation diagram over one parameter, with the limit cycles born at its Andronov–Hopf points."""

from __future__ import annotations

import numpy as np

from laconic.tools.analyse import confirm, steady
from laconic.tools.analyse.continuation import Diagram, diagram
from laconic.tools.analyse.cycle import HopfPoint, cycle_near
from laconic.tools.analyse.findings import BifurcationPart, CyclePart, Study, StudyOptions
from laconic.tools.analyse.from_core import Subject
from laconic.tools.analyse.motions import (
    Parameter,
    commanded_straight,
    default_range,
    parameter_named,
    straight_thresholds,
)
from laconic.tools.analyse.speeds import HEADROOM, command_text, motion_text, wheel_radius_m
from laconic.tools.analyse.steady import steady_motions

CYCLE_SHARES = (0.97,)  # of the way from the branch's other end to the Hopf point
NO_SIZE = 1e-4          # of that way: no cycle is reported so close to the Hopf point, where its size vanishes


def bifurcation_part(result: Study, options: StudyOptions) -> None:
    subject = result.subject
    reason = _no_diagram(subject, options)
    if reason:
        result.add("bifurcation", reason)
        return
    straight = np.array([*options.straight, 0.0]) if options.straight else commanded_straight(subject)
    parameter = parameter_named(subject, options.parameter, straight)
    low, high = default_range(parameter)
    low, high = (low if options.low is None else options.low), (high if options.high is None else options.high)
    found = diagram(parameter.field_of, low, high)
    thresholds = straight_thresholds(parameter) if parameter.name in ("nu1", "nu2") else []
    cycles = [part for hopf in found.hopf for part in _cycles_of(parameter, found, hopf)]
    result.bifurcation = BifurcationPart(parameter, low, high, found, thresholds, cycles)
    _describe_bifurcation(result, result.bifurcation)


def _no_diagram(subject: Subject, options: StudyOptions) -> str | None:
    if not subject.of_wheels("motor_damping_Nms").any() or not subject.field({}).decay_per_s.any():
        return "No bifurcation diagram: the motors do not damp (c2 = 0), so constant inputs have no steady motion."
    if steady.world_force_acts(subject):
        return "No bifurcation diagram: a force fixed in the world acts."
    inputs_zero = not any(subject.inputs.values())
    if inputs_zero and options.straight is None and options.parameter in (None, "input_scale"):
        return ("No bifurcation diagram: all inputs are zero at this instant; choose another with --at, or give a "
                "straight motion with --straight NU1 NU2.")
    return None


def _cycles_of(parameter: Parameter, found: Diagram, hopf: HopfPoint) -> list[CyclePart]:
    """Limit cycles on the side of the Hopf point where they exist, at some distances from it."""
    reach = _reach_of_branch(found, hopf)
    values = [hopf.parameter + sign * (1.0 - share) * reach for share in CYCLE_SHARES for sign in (-1.0, 1.0)]
    if NO_SIZE * reach < abs(parameter.at_scene - hopf.parameter) < 0.1 * reach:
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


def _reach_of_branch(found: Diagram, hopf: HopfPoint) -> float:
    """Length of the branch beyond a Hopf point, in the parameter."""
    branch = min(found.branches, key=lambda b: float(np.abs(b.nu() - hopf.nu).sum(axis=1).min()))
    return max(abs(p - hopf.parameter) for p in branch.parameter)


def _stands_at(part: BifurcationPart) -> HopfPoint | None:
    """The Hopf point at which the scene itself stands, if it does."""
    return next((hopf for hopf in part.diagram.hopf if abs(part.parameter.at_scene - hopf.parameter)
                 <= NO_SIZE * _reach_of_branch(part.diagram, hopf)), None)


def _range_text(subject: Subject, part: BifurcationPart) -> str:
    """The range of the parameter; of a commanded ν in m/s, too."""
    shown = f"{part.low:.6g} to {part.high:.6g}"
    if part.parameter.name not in ("nu1", "nu2"):
        return shown
    low, high = (wheel_radius_m(subject) * nu for nu in (part.low, part.high))
    return f"{shown} rad/s ({low:.4g} to {high:.4g} m/s)"


def _threshold_text(subject: Subject, part: BifurcationPart, value: float) -> str:
    where = command_text(subject, part.parameter.name, value)
    if abs(value) <= part.parameter.reach:
        return f"Straight motion changes its stability at {where}."
    reach = part.parameter.reach
    return (f"Straight motion would change its stability at {where}, out of reach: {HEADROOM:g} times the largest "
            f"inputs of this scene give {reach:.4g} rad/s ({wheel_radius_m(subject) * reach:.4g} m/s).")


def _describe_bifurcation(result: Study, part: BifurcationPart) -> None:
    name, subject = part.parameter.name, result.subject
    count = len(part.diagram.branches)
    result.add("bifurcation", f"Steady motions for {name} from {_range_text(subject, part)}: {count} "
                              f"branch{'es' if count != 1 else ''}.")
    for value in part.thresholds:
        result.add("bifurcation", _threshold_text(subject, part, value))
    for special in part.diagram.specials:
        result.add("bifurcation", f"{special.kind.capitalize()} at {command_text(subject, name, special.parameter)}: "
                                  f"{motion_text(subject, special.nu)}.")
    for hopf in part.diagram.hopf:
        born = "an unstable limit cycle around the stable motion" if hopf.lyapunov > 0.0 else "a stable limit cycle"
        result.add("bifurcation", f"Andronov–Hopf point at {command_text(subject, name, hopf.parameter)}, "
                                  f"ν3 = {hopf.nu[2]:.6g} rad/s, with swings at {hopf.frequency_rad_per_s:.6g} "
                                  f"rad/s: first Lyapunov coefficient {hopf.lyapunov:+.3e}, {hopf.kind}: {born} is "
                                  "born.")
    if at_hopf := _stands_at(part):
        where = command_text(subject, name, at_hopf.parameter)
        result.add("bifurcation", f"The scene itself stands at the Andronov–Hopf point {where}: there the limit cycle "
                                  "has no size yet, and the linearised turning motion is neither stable nor unstable.")
    for item in part.cycles:
        multipliers = ", ".join(f"{abs(m):.6g}" for m in item.cycle.multipliers)
        where = command_text(subject, name, item.cycle.parameter, 6)
        result.add("bifurcation", f"Limit cycle at {where} about ν3 = {item.centre_nu[2]:.6g} rad/s: "
                   f"period {item.cycle.period_s:.6g} s, multipliers {multipliers}: "
                   f"{'stable' if item.cycle.stable else 'unstable'}; {item.confirmation.words}.")
        if not item.confirmation.holds:
            result.failures.append(f"limit cycle at {name} = {item.cycle.parameter:.6g}: {item.confirmation.words}")
    if not part.diagram.hopf:
        result.add("bifurcation", "No Andronov–Hopf point in this range.")
