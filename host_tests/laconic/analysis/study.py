"""The whole analysis of one scene: what is found, in numbers and in words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laconic.analysis import confirm, pushed
from laconic.analysis.continuation import Diagram, diagram
from laconic.analysis.cycle import LimitCycle, cycle_near
from laconic.analysis.free_motion import FreeMotion
from laconic.analysis.from_core import Inputs, Subject
from laconic.analysis.geometry import Geometry, diagnose
from laconic.analysis.hopf import HopfPoint
from laconic.analysis.motions import (
    Parameter,
    commanded_straight,
    default_range,
    parameter_named,
    straight_thresholds,
    straight_torques,
)
from laconic.analysis.portrait import Portrait, portrait
from laconic.analysis.steady import Family, SteadyMotion, families, steady_motions
from laconic.analysis.traction import Traction
from laconic.analysis.traction import study as study_traction
from laconic.errors import BadInput

PARTS = ("geometry", "free", "steady", "bifurcation", "traction")
CYCLE_SHARES = (0.97,)  # of the way from the branch's other end to the Hopf point


@dataclass
class FreePart:
    """The free motion that starts where the scene does (or where its motors are switched off)."""

    motion: FreeMotion
    since_s: float
    energy_J: float
    integral: float | None
    core_gap: float                  # largest difference of ν between closed form and exact-flow
    energy_drift: float
    integral_drift: float | None
    portrait: Portrait | None
    path_time_s: np.ndarray
    path_m: np.ndarray
    core_path_m: np.ndarray


@dataclass
class SteadyPart:
    """Steady motions under the held inputs."""

    motions: list[SteadyMotion]
    confirmations: list[confirm.Confirmation]
    families: list[Family]
    pushed: list[pushed.PushedHeading] | None = None
    inputs: dict[str, Any] = field(default_factory=dict)


@dataclass
class CyclePart:
    """A limit cycle and the steady motion inside."""

    cycle: LimitCycle
    centre_nu: np.ndarray
    hopf: HopfPoint
    confirmation: confirm.Confirmation


@dataclass
class BifurcationPart:
    """The diagram over one parameter."""

    parameter: Parameter
    low: float
    high: float
    diagram: Diagram
    thresholds: list[float]
    cycles: list[CyclePart]


@dataclass
class Study:
    """Everything that was found; a part that makes no sense for the scene is None, with the reason in `words`."""

    subject: Subject
    geometry: Geometry | None = None
    free: FreePart | None = None
    steady: SteadyPart | None = None
    bifurcation: BifurcationPart | None = None
    traction: Traction | None = None
    words: dict[str, list[str]] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)

    def say(self, part: str, sentence: str) -> None:
        """Adds a sentence to a part of the report."""
        self.words.setdefault(part, []).append(sentence)


@dataclass(frozen=True)
class Wishes:
    """What the user asked for."""

    parts: tuple[str, ...] = PARTS
    parameter: str | None = None
    low: float | None = None
    high: float | None = None
    straight: tuple[float, float] | None = None
    start: tuple[float, float, float] | None = None


def study(subject: Subject, wishes: Wishes, advance: Callable[[float, str], None]) -> Study:
    """All parts that were asked for, one after another."""
    result = Study(subject)
    share = 1.0 / len(wishes.parts)
    for part in wishes.parts:
        advance(0.0, part)
        if part == "geometry":
            result.geometry = diagnose(subject)
            result.words["geometry"] = list(result.geometry.words)
        elif part == "traction":
            result.traction = study_traction(subject)
            result.words["traction"] = list(result.traction.words)
        else:
            {"free": _free, "steady": _steady, "bifurcation": _bifurcation}[part](result, wishes)
        advance(share, part)
    return result


# ---- free motion


def coasting(subject: Subject) -> Any:
    """The same vehicle with its motors cut off."""
    vehicle = subject.core.ffi.new("laconic_vehicle *", subject.vehicle[0])
    vehicle.motor_gain_Nm_per_V = vehicle.motor_damping_Nms = 0.0
    return vehicle


def _allowed(subject: Subject, nu: tuple[float, float, float]) -> np.ndarray:
    """A ν from the user; BadInput when the constraints forbid it."""
    field_now = subject.field({})
    nearest = field_now.nu(field_now.zeta(np.array(nu)))
    if np.abs(nearest - nu).max() > 1e-9 * max(1.0, float(np.abs(nu).max())):
        shown = " ".join(f"{v:.6g}" for v in nearest)
        raise BadInput(f"--start: the constraints forbid this ν; the nearest allowed one is {shown}")
    return np.array(nu)


def _start_of_free_motion(subject: Subject) -> tuple[np.ndarray, float]:
    """The scene's start; if that is at rest, the moment of its run with the largest ν."""
    start = subject.start_nu()
    if np.abs(start).max() > 0.0:
        return start, 0.0
    run = study_traction(subject)
    turning = np.abs(run.nu[:, 2]) > 1e-6 * np.abs(run.nu).max()
    size = np.linalg.norm(run.nu, axis=1) * (1.0 + 10.0 * turning)
    k = int(np.argmax(size))
    return run.nu[k], float(run.time_s[k])


def _free(result: Study, wishes: Wishes) -> None:
    subject = result.subject
    start, since_s = _start_of_free_motion(subject) if wishes.start is None else (_allowed(subject, wishes.start), 0.0)
    if not np.abs(start).max() > 0.0:
        result.say("free", "The vehicle stands still all through its run: there is no free motion to show.")
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
    _tell_free(result, result.free, wishes)


def _free_duration(subject: Subject, motion: FreeMotion) -> float:
    """Some petals; for other motions the scene's duration."""
    return 9.0 * motion.period_s if motion.kind == "periodic" else subject.scene.run.duration_s


def _core_coasting(subject: Subject, motion: FreeMotion, times: np.ndarray) -> dict[str, Any]:
    """exact-flow beside the closed form: largest gap and drift of the integrals."""
    core, vehicle = subject.core, coasting(subject)
    start = [float(v) for v in motion.start_nu]
    plant = core.plant(vehicle, "exact-flow", float(times[1] - times[0]), nu_rad_per_s=start)
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


def _tell_free(result: Study, free: FreePart, wishes: Wishes) -> None:
    motion, subject = free.motion, result.subject
    if wishes.start:
        where = "from the given start"
    else:
        cut = f"with the motors cut off at {free.since_s:.4g} s"
        where = cut if free.since_s else "from the scene's start"
    nu = _nu_text(motion.start_nu)
    result.say("free", f"Free motion {where}, ν = ({nu}) rad/s: energy {free.energy_J:.6g} J"
               + (f", K = {free.integral:.6g} rad/s." if free.integral is not None else "; with constraints there is "
                                                                                        "no "
                  "second integral K."))
    kinds = {
        "straight": "It does not turn: straight uniform motion for ever.",
        "uniform": "It turns at a constant rate: nothing couples turning to the motion of the centre of mass.",
        "asymptotic": "It tends to straight uniform motion: the yaw rate dies away and never changes its sign"
                      + (f", ν tends to ({_nu_text(motion.limit_nu())}) rad/s."
                         if motion.kind == "asymptotic" else "."),
        "periodic": f"It is periodic in ν with period {motion.period_s:.6g} s"
                    + (f": the path has petals, one every {np.degrees(2.0 * np.pi / motion.petal_rate):.2f}° of "
                       f"heading."
                       if free.portrait is not None else "; ν3 is constant, ν turns evenly against the body."),
    }
    result.say("free", kinds[motion.kind])
    drift = f"energy drifts by {free.energy_drift:.1e}"
    if free.integral_drift is not None:
        drift += f", K by {free.integral_drift:.1e}"
    result.say("free", f"Closed form and the core's exact-flow differ by {free.core_gap:.1e} over "
                       f"{free.path_time_s[-1]:.4g} s; "
               f"{drift} (relative).")
    if free.core_gap > 1e-9:
        result.failures.append(f"closed form and exact-flow differ by {free.core_gap:.1e}")
    if free.portrait is None:
        result.say("free", "No phase portrait: ν3 does not change in free motion of this vehicle.")
    elif subject.model.dof == 3:
        result.say("free", f"On the plane of ν3 and the velocity across, motions of this K lie on ellipses about "
                   f"ν3 = K/A33 = {free.portrait.centre:.6g} rad/s.")


# ---- steady motions


def _studied_inputs(subject: Subject, wishes: Wishes) -> Inputs:
    if wishes.straight is None:
        return subject.inputs
    return straight_torques(subject, np.array([*wishes.straight, 0.0]))


def _steady(result: Study, wishes: Wishes) -> None:
    subject, inputs = result.subject, _studied_inputs(result.subject, wishes)
    if wishes.straight is None and pushed.world_force_acts(subject):
        _tell_pushed(result)
        return
    found = subject.field(inputs)
    motions = steady_motions(found)
    confirmations = [confirm.steady_motion(subject, inputs, found, motion) for motion in motions]
    result.steady = SteadyPart(motions, confirmations, families(found), inputs=dict(inputs))
    for motion, confirmation in zip(motions, confirmations, strict=True):
        nu = _nu_text(motion.nu)
        rates = ", ".join(_complex_text(v) for v in motion.eigenvalues)
        shape = "circle" if motion.turns else "straight"
        result.say("steady", f"{shape}, {motion.stability}: ν = ({nu}) rad/s; eigenvalues {rates} 1/s; "
                             f"{confirmation.words}.")
        if not confirmation.holds:
            result.failures.append(f"steady motion ({nu}): {confirmation.words}")
    for family in result.steady.families:
        result.say("steady", f"{family.words}.")
    if not motions and not result.steady.families:
        result.say("steady", "There is no steady motion: a direction without damping is driven and speeds up without "
                             "end.")
    if not subject.field(inputs).decay_per_s.any():
        result.say("steady", "The motors do not damp (c2 = 0), so nothing is asymptotically stable.")


def _nu_text(nu: np.ndarray) -> str:
    """ν without rounding's rest."""
    size = max(float(np.abs(nu).max()), 1e-300)
    return ", ".join(f"{0.0 if abs(v) < 1e-9 * size else v:.6g}" for v in nu)


def _complex_text(value: complex) -> str:
    return f"{value.real:.5g}" if abs(value.imag) < 1e-12 * abs(value) else f"{value.real:.5g} {value.imag:+.5g}i"


def _tell_pushed(result: Study) -> None:
    found = pushed.headings(result.subject)
    result.steady = SteadyPart([], [], [], pushed=found)
    result.say("steady", "A force fixed in the world acts: it turns against the body, so ν has no steady value of its "
               "own; the question is which heading the vehicle keeps.")
    if found is None:
        result.say("steady", "With damping or a gyroscopic term the heading depends on the speed; see `laconic "
                             "simulate`.")
    for heading in found or []:
        result.say("steady", heading.words + ".")


# ---- bifurcations


def _bifurcation(result: Study, wishes: Wishes) -> None:
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


def _tell_bifurcation(result: Study, part: BifurcationPart) -> None:
    name = part.parameter.name
    result.say("bifurcation", f"Steady motions for {name} from {part.low:.6g} to {part.high:.6g}: "
                              f"{len(part.diagram.branches)} "
               f"branch{'es' if len(part.diagram.branches) != 1 else ''}.")
    for value in part.thresholds:
        result.say("bifurcation", f"Straight motion changes its stability at {name} = {value:.9g}.")
    for special in part.diagram.specials:
        result.say("bifurcation", f"{special.kind.capitalize()} at {name} = {special.parameter:.9g}, ν = "
                   f"({_nu_text(special.nu)}) rad/s.")
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
