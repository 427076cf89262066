"""The free motion of a scene's vehicle: closed form beside the core, integrals, portrait, words.

Steady motions under the held inputs: found, confirmed by the core, described in sentences.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.scene.methods import EXACT
from laconic.simulation import run_window
from laconic.tools.analyse import confirm, steady
from laconic.tools.analyse.findings import FreePart, SteadyPart, Study, StudyOptions
from laconic.tools.analyse.free_motion import FreeMotion
from laconic.tools.analyse.from_core import Inputs, Subject
from laconic.tools.analyse.motions import straight_torques
from laconic.tools.analyse.portrait import portrait
from laconic.tools.analyse.speeds import motion_text
from laconic.tools.analyse.steady import families, steady_motions

MOST_CHECKS = 500  # of ν along the scene's run, to find the instant at which the motors are cut off


def coasting(subject: Subject) -> Any:
    """The same vehicle with its motors cut off."""
    vehicle = subject.core.ffi.new("laconic_vehicle *", subject.vehicle[0])
    vehicle.motor_gain_Nm_per_V = vehicle.motor_damping_Nms = 0.0
    for wheel in vehicle.wheel:
        wheel.own_motor_gain_Nm_per_V = wheel.own_motor_damping_Nms = 0.0
    return vehicle


def _start_of_free_motion(subject: Subject) -> tuple[np.ndarray, float]:
    """The scene's start; if that is at rest, the moment of its run with the largest ν."""
    start = subject.start_nu()
    if np.abs(start).max() > 0.0:
        return start, 0.0
    plant, inputs = subject.scene.plant(subject.core), subject.scene.inputs_on_grid()
    ticks = sorted({*range(0, inputs.steps, max(1, inputs.steps // MOST_CHECKS)), *inputs.changes, inputs.steps})
    rows = [plant.nu]
    for first, last in zip(ticks[:-1], ticks[1:], strict=True):
        run_window(subject.scene, plant, inputs, first, last - first)
        rows.append(plant.nu)
    nu = np.array(rows)
    turning = np.abs(nu[:, 2]) > 1e-6 * np.abs(nu).max()
    k = int(np.argmax(np.linalg.norm(nu, axis=1) * (1.0 + 10.0 * turning)))
    return nu[k], ticks[k] * inputs.step_s


def free_part(result: Study, options: StudyOptions) -> None:
    subject = result.subject
    start, since_s = _start_of_free_motion(subject) if options.start is None else (np.array(options.start), 0.0)
    if not np.abs(start).max() > 0.0:
        result.add("free", "The vehicle stands still all through its run: there is no free motion to show.")
        return
    motion = FreeMotion(start, subject.matrices.inverse_inertia, subject.matrices.lambda_yaw)
    times = np.linspace(0.0, _free_duration(subject, motion), 1201)[1:]
    numbers = _core_coasting(subject, motion, times)
    scale = 0.5 * float(subject.model.mass_kg) * float(subject.model.wheel_radius_m) ** 2
    integral = None if subject.model.dof < 3 else float(subject.matrices.inertia[2] @ start)
    result.free = FreePart(
        motion=motion, since_s=since_s,
        energy_J=scale * float(start @ np.linalg.lstsq(subject.matrices.inverse_inertia, start, rcond=None)[0]),
        integral=integral, portrait=portrait(subject, start), path_time_s=times,
        path_m=motion.path(times, float(subject.model.wheel_radius_m)), **numbers)
    _describe_free(result, result.free, options)


def _free_duration(subject: Subject, motion: FreeMotion) -> float:
    """Some petals; for other motions the scene's duration."""
    return 9.0 * motion.period_s if motion.kind == "periodic" else subject.scene.run.duration_s


def _core_coasting(subject: Subject, motion: FreeMotion, times: np.ndarray) -> dict[str, Any]:
    """The core's exact method beside the closed form: largest gap and drift of the integrals."""
    core, vehicle = subject.core, coasting(subject)
    start = [float(v) for v in motion.start_nu]
    plant = core.plant(vehicle, EXACT, float(times[1] - times[0]), nu_rad_per_s=start)
    held = core.input()
    model, state = core.ffi.addressof(plant.c, "model"), core.ffi.addressof(plant.c, "state")
    energy, integral = plant.energy_J(), float(core.lib.laconic_yaw_integral(model, state))
    gap, energy_drift, integral_drift, path = 0.0, 0.0, 0.0, []
    for expected in motion.nu_at(times):
        plant.run(held, 1)
        gap = max(gap, float(np.abs(plant.nu - expected).max()))
        energy_drift = max(energy_drift, abs(plant.energy_J() - energy))
        integral_drift = max(integral_drift, abs(float(core.lib.laconic_yaw_integral(model, state)) - integral))
        path.append((plant.pose.x_m, plant.pose.y_m))
    size = float(np.abs(motion.start_nu).max())
    return {"core_gap": gap / max(1.0, size), "energy_drift": energy_drift / max(energy, 1e-300),
            "integral_drift": None if subject.model.dof < 3 else integral_drift / max(size, 1e-300),
            "core_path_m": np.array(path)}


def _kind_in_words(subject: Subject, free: FreePart) -> str:
    """The kind of the motion as a sentence."""
    motion = free.motion
    if motion.kind == "straight":
        return "It does not yaw: straight uniform motion for ever."
    if motion.kind == "uniform":
        return "It yaws at a constant rate: yaw is not coupled to the motion of the centre of mass."
    if motion.kind == "asymptotic":
        return ("It tends to straight uniform motion: the yaw rate decays and never changes its sign; it tends to "
                f"{motion_text(subject, motion.limit_nu())}.")
    periodic = f"It is periodic in ν with period {motion.period_s:.6g} s"
    if free.portrait is None:
        return f"{periodic}; ν3 is constant, ν rotates evenly against the body."
    petal_deg = np.degrees(2.0 * np.pi / motion.petal_rate)
    return f"{periodic}: the path has petals, one every {petal_deg:.2f}° of heading."


def _describe_free(result: Study, free: FreePart, options: StudyOptions) -> None:
    motion, subject = free.motion, result.subject
    if options.start:
        where = "from the given start"
    else:
        cut = f"with the motors cut off at {free.since_s:.4g} s, the fastest instant of the run"
        where = cut if free.since_s else "from the scene's start"
    start = f"Free motion {where}: {motion_text(subject, motion.start_nu)}; energy {free.energy_J:.6g} J"
    result.add("free", f"{start}; with constraints there is no second integral K." if free.integral is None else
               f"{start}, K = {free.integral:.6g} rad/s.")
    result.add("free", _kind_in_words(subject, free))
    drift = f"energy drifts by {free.energy_drift:.1e}"
    if free.integral_drift is not None:
        drift += f", K by {free.integral_drift:.1e}"
    result.add("free", f"Closed form and the core's {EXACT} differ by {free.core_gap:.1e} over "
                       f"{free.path_time_s[-1]:.4g} s; {drift} (relative).")
    if free.core_gap > 1e-9:
        result.failures.append(f"closed form and {EXACT} differ by {free.core_gap:.1e}")
    if free.portrait is None:
        result.add("free", "No phase portrait: ν3 does not change in free motion of this vehicle.")
    elif subject.model.dof == 3:
        result.add("free", f"On the plane of ν3 and the velocity across, motions of this K lie on ellipses about "
                   f"ν3 = K/A33 = {free.portrait.centre:.6g} rad/s.")


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
