"""Steady motions under the held inputs: found, confirmed by the core, described in sentences."""

from __future__ import annotations

import numpy as np

from laconic.tools.analyse import confirm, steady
from laconic.tools.analyse.findings import SteadyPart, Study, StudyOptions
from laconic.tools.analyse.from_core import Inputs, Subject
from laconic.tools.analyse.motions import straight_torques
from laconic.tools.analyse.speeds import motion_text
from laconic.tools.analyse.steady import families, steady_motions


def _studied_inputs(subject: Subject, options: StudyOptions) -> Inputs:
    if options.straight is None:
        return subject.inputs
    return straight_torques(subject, np.array([*options.straight, 0.0]))


def steady_part(result: Study, options: StudyOptions) -> None:
    subject, inputs = result.subject, _studied_inputs(result.subject, options)
    if options.straight is None and steady.world_force_acts(subject):
        _describe_pushed(result)
        return
    if options.straight is None and subject.held:
        result.add("steady", subject.held)
    found = subject.field(inputs)
    motions = steady_motions(found)
    confirmations = [confirm.steady_motion(subject, inputs, found, motion) for motion in motions]
    result.steady = SteadyPart(motions, confirmations, families(found), inputs=dict(inputs))
    for motion, confirmation in zip(motions, confirmations, strict=True):
        rates = ", ".join(_complex_text(v) for v in motion.eigenvalues)
        shape = "circle" if motion.is_turning else "straight"
        result.add("steady", f"{shape}, {motion.stability}: {motion_text(subject, motion.nu)}; eigenvalues {rates} "
                             f"1/s; {confirmation.words}.")
        if not confirmation.holds:
            result.failures.append(f"steady motion, {motion_text(subject, motion.nu)}: {confirmation.words}")
    for family in result.steady.families:
        result.add("steady", f"{family.words}.")
    if not motions and not result.steady.families:
        result.add("steady", "There is no steady motion: a direction without damping is driven and speeds up without "
                             "end.")
    if not subject.field(inputs).decay_per_s.any():
        result.add("steady", "The motors do not damp (c2 = 0), so nothing is asymptotically stable.")


def _complex_text(value: complex) -> str:
    return f"{value.real:.5g}" if abs(value.imag) < 1e-12 * abs(value) else f"{value.real:.5g} {value.imag:+.5g}i"


def _describe_pushed(result: Study) -> None:
    found = steady.headings(result.subject)
    result.steady = SteadyPart([], [], [], pushed=found)
    result.add("steady", "A force fixed in the world acts: it rotates against the body, so ν has no steady value; "
               "the question is which heading the vehicle keeps.")
    if found is None:
        result.add("steady", "With damping or a gyroscopic term the heading depends on the speed; see `laconic "
                             "simulate`.")
    for heading in found or []:
        result.add("steady", heading.words + ".")
