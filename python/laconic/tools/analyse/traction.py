"""When is "no slip" true? The scene's run again, with what the ground would have to deliver at every step.

Reactions and normal loads are the core's. What is added here is the use of the friction cone of each
wheel, |reaction| / (μ N), the first moment at which it passes 1, and the balance of forces and of the moment about the
centre of mass, formed from the reactions and the acceleration alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene.inputs import InputsOnGrid
from laconic.simulation import run_window
from laconic.tools.analyse.from_core import Subject, nu_rates
from laconic.tools.analyse.geometry import wheel_positions_m

MOST_SAMPLES = 1500


@dataclass
class Traction:
    """One run, one row per sample; wheels in columns."""

    time_s: np.ndarray
    along_N: np.ndarray
    lateral_N: np.ndarray
    brake_Nm: np.ndarray
    normal_N: np.ndarray             # wheels, then supports
    use: np.ndarray                  # of the friction cone; nan where there is no friction coefficient
    nu: np.ndarray
    pose: np.ndarray                 # x, y, heading
    balance_N: float                 # worst residual of the force balance
    balance_Nm: float                # and of the moment balance
    first_slip_s: float | None
    slipping_wheels: list[int]       # from 1, at that moment
    lifting: dict[str, float]        # "wheel 2" → first time of a negative normal load
    static_normal_N: np.ndarray      # at rest
    statics_hold: bool               # whether the contact points can balance the weight
    words: list[str] = field(default_factory=list)


def study(subject: Subject, progress: Callable[[float], None] | None = None) -> Traction:
    """Runs the scene and judges it at no more than about MOST_SAMPLES instants; the first slip is found to the step."""
    scene = subject.scene
    plant, inputs = scene.plant(subject.core), scene.inputs_on_grid()
    total, sampler = inputs.steps, _Sampler(subject, plant, inputs.signals)
    ticks = sorted({*range(0, total, max(1, -(-total // MOST_SAMPLES))), *inputs.changes, total})
    slipped = False
    for first, last in zip(ticks[:-1], ticks[1:], strict=True):
        _sample(sampler, inputs, first)
        slipped = slipped or _retaken(sampler, inputs, ticks, first)
        run_window(scene, plant, inputs, first, last - first)
        if progress is not None:
            progress(last / total)
    _sample(sampler, inputs, total)
    return _judged(subject, sampler)


def _sample(sampler: _Sampler, inputs: InputsOnGrid, tick: int) -> None:
    """One sample with the inputs at a tick."""
    sampler.take(tick * inputs.step_s, inputs.held_at(tick))


def _retaken(sampler: _Sampler, inputs: InputsOnGrid, ticks: list[int], at: int) -> bool:
    """Repeats the steps before the first sample that slips one by one, to find the slip; True if it slips."""
    if not sampler.slips():
        sampler.keep = (sampler.plant.save(), at)
        return False
    if sampler.keep is not None:
        newest, state, steps = sampler.rows.pop(), sampler.plant.save(), sampler.plant.steps
        saved, start = sampler.keep
        sampler.plant.restore(saved, start)
        for tick in range(start, at - 1):
            run_window(sampler.subject.scene, sampler.plant, inputs, tick, 1)
            _sample(sampler, inputs, tick + 1)
            if sampler.slips():
                break
        sampler.plant.restore(state, steps)
        sampler.rows.append(newest)
    return True


class _Sampler:
    """Collects one sample after another and checks its balance."""

    def __init__(self, subject: Subject, plant: Plant, signals: tuple[str, ...]):
        self.subject, self.plant = subject, plant
        self.rows: list[tuple[Any, ...]] = []
        self.contact = _prepared_contact(subject)
        core, n = subject.core, subject.wheel_count
        self.offsets = [core.input_offset(signal) for signal in signals]
        self.pull = core.numbers(self.contact.pull, -1, 2)[:n]
        self.axle = core.numbers(self.contact.axle, -1, 2)[:n]
        self.positions_m = core.numbers(self.contact.point_m, -1, 2)[:n]
        self.worst_N = self.worst_Nm = 0.0
        self.keep: Any = None  # the state at the newest sample that does not slip, and its tick

    def slips(self) -> bool:
        """Whether a wheel slips in the newest sample."""
        friction, n = float(self.subject.vehicle.friction_coefficient), self.subject.wheel_count
        if friction <= 0.0:
            return False
        _, along, lateral, _, normal, *_ = self.rows[-1]
        return bool((np.hypot(along, lateral) > friction * np.maximum(normal[:n], 0.0)).any())

    def take(self, time_s: float, inputs: dict[str, float]) -> None:
        """One sample with these inputs, one for each signal."""
        subject, core, n = self.subject, self.subject.core, self.subject.wheel_count
        points = n + subject.vehicle.support_count
        row = np.zeros(core.input_length, core.dtype)
        row[self.offsets] = list(inputs.values())
        held = core.input(row)
        try:
            found = self.plant.reactions(held)
        except Refused as refused:
            raise subject.scene.refusal_in_file(refused, f"at t = {time_s:g} s") from None
        along, lateral = core.numbers(found.along_N)[:n], core.numbers(found.lateral_N)[:n]
        pose, nu = self.plant.pose, self.plant.nu
        self._balance(along, lateral, nu, float(pose.heading_rad), held, inputs)
        self.rows.append((time_s, along, lateral, core.numbers(found.brake_Nm)[:n],
                          core.numbers(found.normal_N)[:points], nu, (pose.x_m, pose.y_m, pose.heading_rad)))

    def _balance(self, along: np.ndarray, lateral: np.ndarray, nu: np.ndarray, heading: float, held: Any,
                 inputs: dict[str, float]) -> None:
        """M v̇_S = Σ reactions + F and I_S θ̈ = Σ r × reaction + τ: what is left over."""
        subject, model = self.subject, self.subject.model
        mass, radius, big = float(model.mass_kg), float(model.wheel_radius_m), float(model.yaw_scale)
        rate = nu_rates(subject.core, model, nu, heading, held)
        yaw_rate = nu[2] / big
        acceleration = radius * np.array([rate[0] - nu[1] * yaw_rate, rate[1] + nu[0] * yaw_rate])
        ground = along[:, None] * self.pull + lateral[:, None] * self.axle
        force, moment = outer_wrench(inputs, heading)
        ground_Nm = self.positions_m[:, 0] @ ground[:, 1] - self.positions_m[:, 1] @ ground[:, 0]
        left_N = mass * acceleration - ground.sum(axis=0) - force
        left_Nm = mass * radius**2 * big * rate[2] - ground_Nm - moment
        self.worst_N = max(self.worst_N, float(np.abs(left_N).max()))
        self.worst_Nm = max(self.worst_Nm, abs(float(left_Nm)))


def outer_wrench(inputs: dict[str, float], heading: float) -> tuple[np.ndarray, float]:
    """Outer force in body axes and its moment about S, from held inputs."""
    def of(name: str, size: int) -> np.ndarray:
        return np.array([inputs.get(f"{name}[{k + 1}]", 0.0) for k in range(size)])

    cos, sin = np.cos(heading), np.sin(heading)
    world = np.array([[cos, sin], [-sin, cos]]) @ of("world_force_N", 2)
    point = of("world_force_point_m", 2)
    moment = inputs.get("body_moment_Nm", 0.0) + point[0] * world[1] - point[1] * world[0]
    return of("body_force_N", 2) + world, float(moment)


def _prepared_contact(subject: Subject) -> Any:
    contact, why = subject.core.ffi.new("laconic_contact *"), subject.core.why()
    lib = subject.core.lib
    subject.core.check(lib.laconic_contact_prepare(contact, subject.vehicle, why), why)
    return contact


def _judged(subject: Subject, sampler: _Sampler) -> Traction:
    time, along, lateral, brake, normal, nu, pose = (np.array(column) for column in zip(*sampler.rows, strict=True))
    n, friction = subject.wheel_count, float(subject.vehicle.friction_coefficient)
    with np.errstate(divide="ignore", invalid="ignore"):
        carried = friction * np.maximum(normal[:, :n], 0.0)
        size = np.hypot(along, lateral)
        use = np.where(size > 0.0, size / carried, 0.0) if friction > 0.0 else np.full_like(size, np.nan)
    slipping = np.nanmax(use, axis=1, initial=0.0) > 1.0
    first = int(np.argmax(slipping)) if slipping.any() else None
    names = [f"wheel {i + 1}" for i in range(n)] + [f"support {i + 1}" for i in range(normal.shape[1] - n)]
    lifting = {name: float(time[np.argmax(column < 0.0)]) for name, column in zip(names, normal.T, strict=True)
               if (column < 0.0).any()}
    result = Traction(
        time, along, lateral, brake, normal, use, nu, pose, sampler.worst_N, sampler.worst_Nm,
        None if first is None else float(time[first]),
        [] if first is None else [i + 1 for i in range(n) if use[first, i] > 1.0],
        lifting, *static_normal_loads(subject))
    result.words.extend(_words(subject, result, friction))
    return result


def static_normal_loads(subject: Subject) -> tuple[np.ndarray, bool]:
    """Normal loads at rest, and whether they balance the weight (one wheel, or wheels in a line, cannot)."""
    contact, model = _prepared_contact(subject), subject.model
    count = int(contact.point_count)
    points = subject.core.numbers(contact.point_m, -1, 2)[:count]
    radius, weight = float(model.wheel_radius_m), float(model.mass_kg) * 9.80665
    loads = subject.core.numbers(contact.normal_load_of_wrench, -1, 3)[:count, 0] * radius * weight
    size = max(float(np.abs(points).max(initial=0.0)), radius)
    spread = np.linalg.matrix_rank(np.column_stack([np.full(count, size), points]), tol=1e-9 * size) if count else 0
    return loads, bool(spread == 3)


def _words(subject: Subject, found: Traction, friction: float) -> list[str]:
    """The judgement in sentences."""
    if subject.wheel_count == 0:
        return ["There are no wheels, so there is nothing to slip."]
    words = []
    points = subject.wheel_count + int(subject.vehicle.support_count)
    if not found.statics_hold:
        alone = "One point of contact" if points == 1 else f"{points} points of contact in a line"
        words.append(f"{alone} cannot hold the body upright; the normal loads are the nearest that statics allows and "
                     "mean little. Add [[vehicle.support]] points.")
    elif points > 3:
        words.append(f"{points} points share the weight: statics alone does not give the normal loads; the least-norm "
                     "distribution is shown, which is that of equally soft suspensions.")
    for name, when in found.lifting.items():
        words.append(f"{name.capitalize()} would lift off at {when:.4g} s: its normal load falls below zero.")
    shared = _shared_lateral(subject)
    if shared:
        words.append(f"Fixed wheels {', '.join(map(str, shared))} stand on one axle line: only the sum of their "
                     "lateral forces is determined; it is shown split equally.")
    words.append(f"The reactions balance the motion: forces to {found.balance_N:.1e} N, moments to "
                 f"{found.balance_Nm:.1e} N m.")
    if friction <= 0.0:
        return [*words, "The scene gives no friction_coefficient, so reactions are shown but not judged."]
    most = float(np.nanmax(found.use))
    if found.first_slip_s is None:
        return [*words, f"No wheel slips: the friction cone is used to {100.0 * most:.0f} % at most."]
    which = ", ".join(str(i) for i in found.slipping_wheels)
    worst = "a wheel pulls without any normal load"
    if np.isfinite(most):
        instant, wheel = np.unravel_index(np.nanargmax(found.use), found.use.shape)
        worst = (f"up to {100.0 * most:.0f} % of the friction cone, wheel {wheel + 1} at "
                 f"{found.time_s[instant]:.4g} s")
    wheels = f"wheel{'s' if len(found.slipping_wheels) > 1 else ''} {which}"
    return [*words, f"At {found.first_slip_s:.4g} s {wheels} would begin to slip: from there on the run shows what a "
                    f"vehicle with more grip would do ({worst})."]


def _shared_lateral(subject: Subject) -> list[int]:
    """Fixed wheels on one common axle line, from 1."""
    wheels, fixed = subject.vehicle.wheel, subject.core.lib.LACONIC_WHEEL_FIXED
    numbers = [i for i in range(subject.wheel_count) if wheels[i].kind == fixed]
    positions_m = wheel_positions_m(subject)
    shared: set[int] = set()
    for a in numbers:
        axle = np.array([np.cos(wheels[a].axle_rad), np.sin(wheels[a].axle_rad)])
        for b in numbers:
            apart = positions_m[b] - positions_m[a]
            parallel = abs(np.sin(wheels[b].axle_rad - wheels[a].axle_rad)) < 1e-9
            off_line = abs(axle[0] * apart[1] - axle[1] * apart[0])
            if a != b and parallel and off_line < 1e-9 * max(1.0, float(np.abs(apart).max())):
                shared |= {a + 1, b + 1}
    return sorted(shared)
