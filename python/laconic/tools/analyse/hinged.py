"""The analysis of a scene with hinges: steady turns, straight motion, and the tightest turn."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from laconic.core.articulated import ArticulatedPlant, ArticulatedVehicle
from laconic.core.given import finite_number, number
from laconic.errors import BadInput, Refused
from laconic.scene import Scene, check_scene
from laconic.scene.ground import has_friction
from laconic.simulation.articulated import rolling_rates
from laconic.tools.analyse.hinged_straight import StraightMotion, straight_motion
from laconic.tools.analyse.hinged_turns import BodyCircle, Tree, tree_of

SPEEDS_M_PER_S = (1.0, -1.0)
AGREEMENT = 1e-9  # between the angles and rates of a turn and the core's, in SI
SAME_RAD = 1e-9       # rounding of an angle
ROUNDING = 1e-12  # of the largest voltage
STEADY = 1e-9     # of the accelerations without voltages
TITLES = {"limits": "Tightest turns", "turns": "Steady turns", "straight": "Straight motion"}


@dataclass(frozen=True)
class SteadyTurn:
    """One turn: all bodies on circles about one point. Where nothing sets an angle, those of its body are unknown."""

    asked: str
    curvature_per_m: float
    circles: tuple[BodyCircle, ...]
    confirmed: bool | None  # by the core; None where there is no such turn, or an angle is unknown
    held_by_V: Mapping[str, float] | None = None  # voltages that keep it at 1 m/s, on the spot at 1 rad/s, by signal

    @property
    def radius_m(self) -> float:
        """Of the carriage's path: that of the middle of its fixed axle, else of its origin."""
        return 0.0 if math.isinf(self.curvature_per_m) else \
            math.inf if not self.curvature_per_m else 1.0 / abs(self.curvature_per_m)


@dataclass
class HingedStudy:
    """What `laconic analyse` finds of a vehicle with hinges."""

    scene: Scene
    tree: Tree
    limits: dict[str, tuple[float, str]]      # "left", "right": largest curvature [1/m], and what ends there
    turns: list[SteadyTurn]
    straight: list[StraightMotion]
    words: dict[str, list[str]] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)


def study_hinges(scene: Scene, *, speeds_m_per_s: Sequence[float] = SPEEDS_M_PER_S,
                 curvatures_per_m: Sequence[float] = (), steering: Sequence[tuple[str, float]] = ()) -> HingedStudy:
    """Turns, growth rates and limits of a scene with hinges, on level ground.

    `curvatures_per_m`: turns to look at, to the left above 0, infinite on the spot. `steering`: the same by the name of
    a steered hinge of the carriage and its angle [rad]. With neither, half of the largest curvature to the left. Raises
    BadInput for a scene without hinges, with friction, without straight motion or with locked wheels.
    """
    if not check_scene(scene).has_hinges:
        raise BadInput(f"{scene.path}: has no bodies on hinges; use laconic.analyse")
    if has_friction(scene.vehicle):
        raise BadInput(f"{scene.path}: laconic analyse treats ideal ground and motors without limits; give a scene "
                       "without friction in [ground], without [vehicle.drive] and motor_circuit")
    level = {key: value for key, value in scene.vehicle.items() if key != "ground"}
    sloped = "ground" in scene.vehicle
    scene = replace(scene.with_run(real="double"), vehicle=level)
    vehicle, tree = scene.articulated_vehicle(scene.core()), tree_of(scene)
    for speed in speeds_m_per_s:
        if not finite_number("--speed", speed):
            raise BadInput("--speed: is 0; give a speed to go straight at, in m/s")
    asked = [(f"curvature {k:g}/m", _curvature(k)) for k in curvatures_per_m]
    asked += [(_steered_to(name, finite_number("--steering", angle)), tree.curvature_of(name, angle))
              for name, angle in steering]
    limits = {} if tree.turn is None else {"left": tree.limit(1), "right": tree.limit(-1)}
    if asked and tree.turn is None:
        raise BadInput(f"{scene.path}: the fixed wheels of the carriage let it go straight only; analyse it without "
                       "--curvature and --steering")
    if not asked and limits:
        largest = limits["left"][0]
        asked = [("half of the largest curvature", largest / 2.0) if 0.0 < largest < math.inf
                 else ("a turn of twice the vehicle's size", 0.5 / tree.size_m)]
    found = HingedStudy(scene, tree, limits, [_turn(tree, vehicle, *each) for each in asked],
                        [straight_motion(tree, vehicle, float(speed)) for speed in speeds_m_per_s])
    found.failures += [f"the turn with {turn.asked}: the core has other angles" for turn in found.turns
                       if turn.confirmed is False]
    found.failures += [f"straight motion at {each.speed_m_per_s:g} m/s: the core has other growth rates"
                       for each in found.straight if not each.agrees]
    found.words = {"limits": _limit_words(found), "turns": [_turn_words(tree, turn) for turn in found.turns],
                   "straight": _straight_words(found, sloped)}
    return found


def _steered_to(name: str, angle_rad: float) -> str:
    """In words; a wheel turned by half a turn rolls along the same line."""
    near_rad = math.remainder(angle_rad, math.pi)
    same = "" if abs(near_rad - angle_rad) < SAME_RAD else f", where it rolls as at {math.degrees(near_rad):.4g}°"
    return f"{name} at {math.degrees(angle_rad):.4g}°{same}"


def _curvature(given: float) -> float:
    """Of a turn; infinite: on the spot."""
    if math.isnan(found := number("--curvature", given)):
        raise BadInput("--curvature: is not a number; give one in 1/m, or inf for a turn on the spot")
    return found


def _turn(tree: Tree, vehicle: ArticulatedVehicle, asked: str, curvature: float) -> SteadyTurn:
    circles = tuple(tree.circles(tree.twist(curvature)))
    exists = not any(each.problem or each.period or math.isnan(each.radius_m) for each in circles)
    if not exists:
        return SteadyTurn(asked, curvature, circles, None)
    return SteadyTurn(asked, curvature, circles, *_confirmed(tree, vehicle, curvature, circles))


def _confirmed(tree: Tree, vehicle: ArticulatedVehicle, curvature: float, circles: Sequence[BodyCircle]
               ) -> tuple[bool, dict[str, float] | None]:
    """Whether the core allows this motion, with the same angles, which then stay as they are; and what holds it."""
    velocity, omega = tree.twist(curvature)
    there = velocity + 1j * omega * tree.centre
    angles = [limb.hinge.start_angle_rad if each.angle_rad is None else each.angle_rad
              for limb, each in zip(tree.limbs, circles, strict=True)]
    inputs: dict[str, list[float]] = {}
    if any(limb.hinge.kind == "coordinated" for limb in tree.limbs):
        inputs = {"steering_twist": [velocity.real, velocity.imag, omega]}
    pair, still = (there.real, there.imag), [0.0] * len(angles)
    try:
        rates = rolling_rates(vehicle, pair, omega, angles, still)
        plant = vehicle.plant(velocity_m_per_s=pair, yaw_rate_rad_per_s=omega, hinge_angle_rad=angles,
                              hinge_rate_rad_per_s=still, inputs=inputs)
    except Refused:
        return False, None
    off = [math.remainder(a - b, 2.0 * math.pi) for a, b in zip(angles, plant.motion().hinge_angle_rad, strict=True)]
    allowed = AGREEMENT * max(1.0, abs(omega))
    of_rates = [allowed + tree.rounding_per_s(limb, each.velocity) for limb, each
                in zip(tree.limbs, circles, strict=True)]
    agrees = max([plant.changed_m_per_s, *map(abs, off)]) < allowed and all(
        abs(rate) < most for rate, most in zip(rates, of_rates, strict=True))
    return agrees, _held_by(vehicle, plant, inputs) if agrees else None


def _held_by(vehicle: ArticulatedVehicle, plant: ArticulatedPlant, inputs: Mapping[str, list[float]]
             ) -> dict[str, float] | None:
    """The least voltages with which no velocity changes; None where motors cannot do that."""
    signals = [f"voltage_V[{i + 1}]" for i in range(vehicle.wheel_count) if vehicle.model.wheel[i].gain_Nm_per_V]
    signals += [f"hinge_voltage_V[{name}]" for b, name in enumerate(vehicle.names)
                if vehicle.model.link[b].gain_Nm_per_V]
    if not signals:
        return None
    try:
        still = plant.rates(inputs)[1].ravel()
        columns = [plant.rates({**inputs, signal: 1.0})[1].ravel() - still for signal in signals]
        needed = np.linalg.lstsq(np.array(columns).T, -still, rcond=1e-12)[0]
        needed[np.abs(needed) <= ROUNDING * np.abs(needed).max()] = 0.0
        found = dict(zip(signals, needed.tolist(), strict=True))
        left = float(np.abs(plant.rates({**inputs, **found})[1]).max())
    except Refused:  # at a posture where wheels contradict each other by rounding
        return None
    return found if left <= STEADY * max(1.0, float(np.abs(still).max())) else None


# ------------------------------------------------------------------------------------------- words


def _limit_words(study: HingedStudy) -> list[str]:
    if not study.limits:
        return ["The fixed wheels of the carriage let it go straight only."]
    words = []
    for side, (curvature, why) in study.limits.items():
        if math.isinf(curvature):
            words.append(f"To the {side} it can turn on the spot.")
        elif not curvature:
            words.append(f"To the {side} it cannot turn: {why}.")
        else:
            words.append(f"To the {side} the largest curvature is {curvature:.5g}/m, a circle of radius "
                         f"{1.0 / curvature:.5g} m; beyond it {why}.")
    return words


def _degrees(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad) + 0.0:.5g}°"


def _turn_words(tree: Tree, turn: SteadyTurn) -> str:
    path = "on the spot" if math.isinf(turn.curvature_per_m) else "straight ahead" if not turn.curvature_per_m else \
        f"radius {turn.radius_m:.5g} m to the {'left' if turn.curvature_per_m > 0.0 else 'right'}"
    pieces = []
    for limb, each in zip(tree.limbs, turn.circles, strict=True):
        name = limb.hinge.name
        if each.problem:
            return f"With {turn.asked} ({path}) there is no steady turn: {each.problem}."
        if each.period:
            pieces.append(f"{name} turns for ever, once in {each.period:.5g} s at "
                          f"{'1 rad/s' if math.isinf(turn.curvature_per_m) else '1 m/s'}")
        elif each.angle_rad is not None:
            beyond = "" if each.within_stops else " (beyond its stop)"
            circle = "" if not math.isfinite(each.radius_m) else f" on a circle of {each.radius_m:.5g} m"
            pieces.append(f"{name} at {_degrees(each.angle_rad)}{beyond}{circle}")
        else:
            pieces.append(f"{name} at an angle that its wheels do not set")
    if turn.held_by_V:
        speed = "1 rad/s" if math.isinf(turn.curvature_per_m) else "1 m/s"
        volts = ", ".join(f"{signal} = {value:.5g}" for signal, value in turn.held_by_V.items())
        pieces.append(f"{volts} {'holds' if len(turn.held_by_V) == 1 else 'hold'} {speed}")
    return f"With {turn.asked} ({path}): {'; '.join(pieces)}."


def _straight_words(study: HingedStudy, sloped: bool) -> list[str]:
    words = ["The slope of [ground] is left out: these motions are those on level ground."] if sloped else []
    for each in study.straight:
        laws = [f"{limb.hinge.name} {_rate(rate)}" for limb, rate
                in zip(study.tree.limbs, each.growth_per_s, strict=True) if rate is not None]
        start = f"At {each.speed_m_per_s:g} m/s"
        if laws:
            words.append(f"{start}, with the carriage held straight: {'; '.join(laws)}.")
        largest = max((z.real for z in each.eigenvalues_per_s), default=0.0)
        kind = "unstable" if largest > 0.0 else "neutral" if largest == 0.0 else "stable"
        values = ", ".join(_complex(z) for z in each.eigenvalues_per_s if z.imag >= 0.0)
        words.append(f"{start} the whole motion is {kind}: eigenvalues {values} 1/s.")
    return words


def _rate(rate: float) -> str:
    if abs(rate) < 1e-12:
        return "keeps a small angle"
    return f"{'grows' if rate > 0.0 else 'decays'} at {abs(rate):.5g}/s"


def _complex(z: complex) -> str:
    return f"{z.real:.5g}" if not z.imag else f"{z.real:.5g} ± {z.imag:.5g}i"


# ----------------------------------------------------------------------------------------- numbers


def hinged_numbers(study: HingedStudy) -> dict[str, Any]:
    """The same for machines; what is infinite is null, complex numbers are [real, imaginary]."""
    names = [limb.hinge.name for limb in study.tree.limbs]
    limits = {side: {"curvature_per_m": k, "radius_m": 0.0 if math.isinf(k) else 1.0 / k if k else None,
                     "on_the_spot": math.isinf(k), "beyond": why} for side, (k, why) in study.limits.items()}
    straight = [{"speed_m_per_s": each.speed_m_per_s, "growth_per_s": dict(zip(names, each.growth_per_s, strict=True)),
                 "core_growth_per_s": dict(zip(names, each.core_growth_per_s, strict=True)),
                 "eigenvalues_per_s": each.eigenvalues_per_s, "held_by_N_N_Nm": each.held_by}
                for each in study.straight]
    return {"scene": str(study.scene.path), "name": study.scene.name, "limits": limits,
            "turns": [_turn_numbers(turn, names) for turn in study.turns], "straight": straight,
            "words": study.words, "failures": study.failures}


def _turn_numbers(turn: SteadyTurn, names: Sequence[str]) -> dict[str, Any]:
    return {"asked": turn.asked, "curvature_per_m": turn.curvature_per_m, "radius_m": turn.radius_m,
            "exists": not any(each.problem for each in turn.circles), "confirmed": turn.confirmed,
            "held_by_V": None if turn.held_by_V is None else dict(turn.held_by_V),
            "bodies": {name: _circle_numbers(each) for name, each in zip(names, turn.circles, strict=True)}}


def _circle_numbers(circle: BodyCircle) -> Mapping[str, Any]:
    return {"angle_rad": circle.angle_rad, "within_stops": circle.within_stops, "radius_m": circle.radius_m,
            "growth_at_1_m_per_s_per_s": circle.growth, "turns_for_ever_in_s": circle.period, "problem": circle.problem}


def hinged_text(study: HingedStudy) -> str:
    """A short report for people."""
    lines = [f"# {study.scene.name}", ""]
    for part, title in TITLES.items():
        lines += [f"## {title}", "", *(f"* {sentence}" for sentence in study.words[part]), ""]
    if study.failures:
        lines += ["## Not confirmed", "", *(f"* {failure}" for failure in study.failures), ""]
    return "\n".join(lines)
