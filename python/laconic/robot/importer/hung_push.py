"""What a driver does with an imported robot on hinges, so that its first run shows it: a ramp ahead, then a turn.

Torques of the driven wheels accelerate the robot to a speed. Then a command steers it to the left; where nothing
steers, the torques of the two sides differ for half a second.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laconic.errors import BadInput, Refused
from laconic.robot.importer.first_run import Promise
from laconic.robot.importer.hung import CARRIAGE, COORDINATED, FREE, PRESCRIBED, HungBody, rolling_of
from laconic.robot.importer.hung_scene import Placed, rate_of
from laconic.robot.importer.robot_tree import RigidBody
from laconic.scene import scene_of
from laconic.scene.table import Table

ACCELERATION_M_PER_S2 = 0.3
SLOW_M_PER_S, PER_METRE = 0.3, 0.6  # speed: at least, and by the distance of the wheels
RAMP_S = 0.5
STEER_RAD, OF_STOP = 0.3, 0.7
LONGEST_S, SHORTEST_S = 40.0, 8.0
ROUNDS, GOOD, MOST = 4, 0.003, 4.0
STEP_S = 0.01
TURN_S = 2.0  # from the end of the ramp to that of the pulse that turns
LEAD_M, BRIEF_S = 1e-3, 3.0  # a turn that its own mass tightens is short
SETTLES_S = 1.0  # of a turn that has begun
ALONG = 0.5  # of a driven wheel's way that must lie ahead

Tables = list[dict[str, Any]]


@dataclass(frozen=True, eq=False)
class Plan:
    """What the inputs are made of."""

    placed: Sequence[Placed]
    bodies: Sequence[HungBody]
    carriage: RigidBody
    ahead: np.ndarray

    @property
    def size_m(self) -> float:
        """The distance of the farthest wheels ahead of each other or beside each other."""
        points = np.array([each.wheel.hub_m[:2] for each in self.placed if each.body is None
                           or each.body.parent == CARRIAGE])
        return float(np.ptp(points, axis=0).max()) if len(points) else 0.5

    @property
    def speed_m_per_s(self) -> float:
        """That the ramp reaches."""
        return float(f"{max(SLOW_M_PER_S, PER_METRE * self.size_m):.2g}")

    @property
    def yaw_rate_rad_per_s(self) -> float:
        """Of a turn that torques make: a circle three times as wide as the robot."""
        return self.speed_m_per_s / max(1.5 * self.size_m, 0.1)

    @property
    def mass_kg(self) -> float:
        """Of all bodies."""
        return self.carriage.mass_kg + sum(body.whole.mass_kg for body in self.bodies)

    @property
    def ramp_s(self) -> float:
        """How long it takes."""
        return self.speed_m_per_s / ACCELERATION_M_PER_S2 + RAMP_S

    def along(self, point: np.ndarray) -> float:
        """How far ahead of the origin."""
        return float(point[:2] @ self.ahead)

    def across(self, point: np.ndarray) -> float:
        """How far to the left of the origin."""
        return float(self.ahead[0] * point[1] - self.ahead[1] * point[0])


@dataclass(frozen=True)
class Driven:
    """Inputs, the length of the run, what they do in words, and what to remark."""

    inputs: Tables
    duration_s: float
    words: tuple[str, ...]
    remark: str = ""
    promise: Promise = Promise(None)


def drive(plan: Plan, data: Mapping[str, Any], where: Any, rounded: Callable[[float], float]) -> Driven:
    """Inputs for a scene whose other tables are `data`: ahead, or back where its hinges let it go there alone."""
    found = _drive(plan, data, where, rounded)
    if found.inputs:
        return found
    back = _drive(replace(plan, ahead=-plan.ahead), data, where, rounded)
    return replace(back, words=tuple(each.replace("ahead", "back") for each in back.words)) if back.inputs else found


def shortened(inputs: Tables, until_s: float) -> Tables:
    """The inputs of a run that ends earlier."""
    return [_within(each, until_s) for each in inputs]


def _drive(plan: Plan, data: Mapping[str, Any], where: Any, rounded: Callable[[float], float]) -> Driven:
    steering, steer_words, ends_s = _steering(plan, data["vehicle"], rounded)
    ahead = _torques(plan)
    if not ahead:
        return Driven(steering, SHORTEST_S, steer_words, "nothing that the file drives rolls ahead; no torques are "
                                                         "given")
    differ = {} if steering else _differential(plan)
    data = {**data, "input": steering}
    ahead, speed = _corrected(plan, data, where, ahead, {}, plan.ramp_s, plan.speed_m_per_s, 0)
    if speed is None:
        return Driven([], SHORTEST_S, (), "torques that roll the driven wheels ahead do not move the robot ahead; no "
                                          "inputs are given")
    turned_at, remark = None, ""
    if differ:
        differ, turned_at = _corrected(plan, data, where, differ, ahead, plan.ramp_s + TURN_S,
                                       plan.yaw_rate_rad_per_s, 1)
        differ = differ if turned_at is not None else {}
        remark = "" if differ else "a turn is refused, as where a caster comes to its stop; the run goes straight ahead"
    inputs = _tables(plan, ahead, differ, rounded)
    words = (f"these torques roll it ahead to {speed:.2g} m/s in {plan.ramp_s:.3g} s",)
    if differ:
        words = (f"{words[0]}, and then turn it to the left",)
        ends_s = plan.ramp_s + TURN_S + (2.0 * math.pi / plan.yaw_rate_rad_per_s if _lead(plan) > -LEAD_M else BRIEF_S)
    duration = float(math.ceil(min(max(ends_s, SHORTEST_S), LONGEST_S)))
    turns_at_s = plan.ramp_s + TURN_S - 2.0 * RAMP_S if differ else plan.ramp_s + 0.5 if steering else math.inf
    promise = Promise(plan.ahead, turns_at_s, SETTLES_S, plan.ramp_s)
    return Driven([*inputs, *steering], duration, (*words, *steer_words), remark, promise)


# ------------------------------------------------------------------------------------------ torques


def _driven(plan: Plan) -> list[tuple[int, Placed, np.ndarray]]:
    """Driven wheels that roll ahead once the run begins, with the way of each as it turns positively."""
    found = []
    for at, each in enumerate(plan.placed):
        way = rolling_of(each.wheel)
        if each.body is not None and each.body.kind != FREE:  # it begins straight
            angle = each.body.axle_rad_of(each.wheel) + math.pi / 2.0 + each.body.parent_rad
            if each.body.kind == COORDINATED:
                angle += math.atan2(plan.ahead[1], plan.ahead[0])
            way = np.array([math.cos(angle), math.sin(angle)])
        elif each.body is not None and each.body.form == "caster":  # its wheels turn ahead by a scene's sense
            way = np.array([math.cos(each.body.frame_rad), math.sin(each.body.frame_rad)])
        if each.is_driven and abs(way @ plan.ahead) > ALONG:
            found.append((at, each, way))
    return found


def _torques(plan: Plan) -> dict[int, tuple[float, float]]:
    """Of each driven wheel the torque that accelerates, and the one that its damping takes at the speed reached."""
    driven = _driven(plan)
    if not driven:
        return {}
    mass = plan.mass_kg + sum(each.wheel.inertia_kgm2 / each.wheel.radius_m**2 for each in plan.placed)
    moment = plan.carriage.mass_kg * plan.across(plan.carriage.com_m)
    moment += sum(body.whole.mass_kg * plan.across(body.hinge_m) for body in plan.bodies)
    rows = np.array([[way @ plan.ahead for _, _, way in driven],
                     [(way @ plan.ahead) * plan.across(each.wheel.hub_m) for _, each, way in driven]])
    drag = [(each.wheel.joint.damping_Nms * plan.speed_m_per_s / each.wheel.radius_m**2, plan.across(each.wheel.hub_m))
            for each in plan.placed if each.body is None or each.body.form in ("wheel", "body")]
    wanted = np.array([[ACCELERATION_M_PER_S2 * mass, sum(force for force, _ in drag)],
                       [ACCELERATION_M_PER_S2 * moment, sum(force * across for force, across in drag)]])
    forces = np.linalg.lstsq(rows, wanted, rcond=1e-9)[0]
    if np.abs(rows @ forces - wanted)[0, 0] > 1e-6 * wanted[0, 0]:  # a wheel beside the middle; others keep it straight
        forces = np.linalg.lstsq(rows[:1], wanted[:1], rcond=1e-9)[0]
    return {at: (float(push) * each.wheel.radius_m, float(hold) * each.wheel.radius_m)
            for (push, hold), (at, each, _) in zip(forces, driven, strict=True)}


def _differential(plan: Plan) -> dict[int, tuple[float, float]]:
    """Torques that turn the robot to the left and do not push it; none where wheels keep it straight."""
    driven = _driven(plan)
    lines = {round(plan.along(each.wheel.hub_m), 3) for each in plan.placed if each.body is None}
    arms = np.array([plan.across(each.wheel.hub_m) * float(way @ plan.ahead) for _, each, way in driven])
    pushes = np.array([float(way @ plan.ahead) for _, _, way in driven])
    if len(lines) > 1 or len(driven) < 2 or np.ptp(arms) < 1e-6:
        return {}
    inertia = float(plan.carriage.inertia_kgm2[2, 2])
    for body in plan.bodies:
        off = body.hinge_m - plan.carriage.com_m[:2]
        inertia += float(body.whole.inertia_kgm2[2, 2]) + body.whole.mass_kg * float(off @ off)
    rate, swing = plan.yaw_rate_rad_per_s, plan.mass_kg * _lead(plan)
    wanted = np.array([[0.0, inertia * rate / RAMP_S], [-swing * rate**2, swing * rate * plan.speed_m_per_s]]).T
    forces = np.linalg.lstsq(np.array([pushes, -arms]), wanted, rcond=1e-9)[0]
    return {at: (float(push) * each.wheel.radius_m, float(hold) * each.wheel.radius_m - each.wheel.joint.damping_Nms
                 * rate * plan.across(each.wheel.hub_m) * float(way @ plan.ahead) / each.wheel.radius_m)
            for (push, hold), (at, each, way) in zip(forces, driven, strict=True)}


def _lead(plan: Plan) -> float:
    """How far the centre of mass lies ahead of the plain wheels: in a turn it pulls them straight, or else round."""
    axle = _axle(plan)
    if axle is None:
        return 0.0
    return (plan.along(plan.carriage.com_m) - plan.along(axle)) * plan.carriage.mass_kg / plan.mass_kg


def _ramp(plan: Plan, push: float, hold: float) -> tuple[list[float], list[float]]:
    """Instants and values of a torque: up, held, down to what damping takes."""
    end = plan.ramp_s
    early = 0.5 * RAMP_S / (end - RAMP_S)  # of the speed, at the end of the rise
    return ([0.0, RAMP_S, end - RAMP_S, end], [0.0, push + early * hold, push + (1.0 - early) * hold, hold])


def _pulse(plan: Plan, push: float, hold: float) -> tuple[list[float], list[float]]:
    """The same of what turns the robot, after the ramp."""
    at = plan.ramp_s + TURN_S - 2.0 * RAMP_S
    return ([at, at + 0.5 * RAMP_S, at + RAMP_S, at + 1.5 * RAMP_S],
            [0.0, push + 0.125 * hold, push + 0.875 * hold, hold])


def _tables(plan: Plan, ahead: Mapping[int, tuple[float, float]], differ: Mapping[int, tuple[float, float]],
            rounded: Callable[[float], float]) -> Tables:
    """One table of each driven wheel."""
    found: Tables = []
    for at, (push, hold) in ahead.items():
        times, values = _ramp(plan, push, hold)
        if at in differ:
            more_t, more = _pulse(plan, *differ[at])
            both = sorted({*times, *more_t})
            values = [float(np.interp(t, times, values) + np.interp(t, more_t, more)) for t in both]
            times = both
        found.append({"signal": f"axle_torque_Nm[{at + 1}]", "kind": "table", "t_s": [rounded(t) for t in times],
                      "value": [rounded(each) for each in values]})
    return found


def _corrected(plan: Plan, data: Mapping[str, Any], where: Any, own: dict[int, tuple[float, float]],
               other: Mapping[int, tuple[float, float]], until_s: float, wanted: float, which: int
               ) -> tuple[dict[int, tuple[float, float]], float | None]:
    """Torques made larger or smaller until the run reaches the wanted speed, or yaw rate (`which` = 1)."""
    best, reached_best = own, None
    for _ in range(ROUNDS):
        inputs = _tables(plan, own if which == 0 else other, own if which == 1 else {}, float)
        reached = _reached(plan, data, where, inputs, until_s, which)
        if reached is None:
            break
        if reached_best is None or abs(reached - wanted) < abs(reached_best - wanted):
            best, reached_best = own, reached
        if abs(reached / wanted - 1.0) < GOOD or reached <= 0.0:
            break
        factor = min(wanted / reached, MOST)
        own = {at: (factor * push, hold) for at, (push, hold) in own.items()}
    return best, reached_best if reached_best is not None and reached_best > 0.0 else None


def _reached(plan: Plan, data: Mapping[str, Any], where: Any, inputs: Tables, until_s: float, which: int
             ) -> float | None:
    """Speed ahead of the carriage, or its yaw rate, after some time; None where a step is refused."""
    from laconic.simulation import simulate

    until_s = math.ceil(until_s / STEP_S) * STEP_S
    whole_s = round(until_s, 6)
    tables = {**data, "run": {"duration_s": whole_s, "step_s": STEP_S}, "outputs": {"every_s": whole_s}}
    tables["input"] = [_within(each, until_s) for each in (*inputs, *data["input"])]
    try:
        scene = scene_of(Table(where, "", copy.deepcopy(tables)))
        columns = simulate(scene, ("velocity_body_m_per_s", "yaw_rate_rad_per_s")).columns
    except (Refused, BadInput):
        return None
    if which == 1:
        return float(columns["yaw_rate_rad_per_s"][-1])
    return float(plan.ahead @ [columns[f"velocity_body_m_per_s[{i}]"][-1] for i in (1, 2)])


def _within(table: dict[str, Any], until_s: float) -> dict[str, Any]:
    """A table without the instants that a shorter run never comes to."""
    count = sum(t <= until_s for t in table["t_s"]) + 1
    if count == 1:  # none is reached: it has its first value throughout
        return {**table, "t_s": [0.0], "value": table["value"][:1]}
    return {**table, "t_s": table["t_s"][:count], "value": table["value"][:count]}


# ------------------------------------------------------------------------------------------ steering


def _steering(plan: Plan, vehicle: Mapping[str, Any], rounded: Callable[[float], float]
              ) -> tuple[Tables, tuple[str, ...], float]:
    """Commands that turn the robot to the left, what they do in words, and when a circle is complete."""
    begin = plan.ramp_s + 0.5
    coordinated = [body for body in plan.bodies if body.kind == COORDINATED]
    prescribed = [body for body in plan.bodies if body.kind == PRESCRIBED and body.parent == CARRIAGE and body.wheels]
    if coordinated:
        middle = _axle(plan)
        places = [(body, body.hinge_m) for body in coordinated]
        curvature = _curvature(plan, places, middle if middle is not None else np.zeros(2))
        ramp = _ramp_of(coordinated, STEER_RAD)
        times = [rounded(begin), rounded(begin + ramp)]
        if plan.ahead[0] > 0.999:
            tables = [{"signal": "steering_curvature_per_m", "kind": "table", "t_s": times,
                       "value": [0.0, rounded(curvature)]}]
        else:
            off = middle if middle is not None else np.zeros(2)
            ends = (plan.ahead[0] + curvature * off[1], plan.ahead[1] - curvature * off[0], curvature)
            starts = (plan.ahead[0], plan.ahead[1], 0.0)
            tables = [{"signal": f"steering_twist[{i + 1}]", "kind": "table", "t_s": times,
                       "value": [rounded(float(starts[i])), rounded(float(ends[i]))]} for i in range(3)]
        words = (f"this steers all of them to a circle of {1.0 / curvature:.3g} m to the left",)
        return tables, words, begin + ramp + 2.0 * math.pi / (curvature * plan.speed_m_per_s)
    if not prescribed:
        return [], (), 0.0
    middle = _axle(plan)
    if middle is None:
        middle = np.mean([body.axle_m() for body in prescribed], axis=0)
        if len(prescribed) == 1:
            middle = plan.carriage.com_m[:2]
    places = [(body, body.axle_m()) for body in prescribed]
    curvature = _curvature(plan, places, middle)
    found: Tables = []
    for body, place in places:
        angle = _angle(plan, place, middle, curvature)
        if abs(angle) < 1e-6:
            continue
        ramp = _ramp_of([body], abs(angle))
        found.append({"signal": f"steering_angle_rad[{body.name}]", "kind": "table",
                      "t_s": [rounded(begin), rounded(begin + ramp)], "value": [0.0, rounded(angle)]})
    words = (f"this steers it to a circle of {1.0 / curvature:.3g} m to the left",)
    return found, words if found else (), begin + 1.0 + 2.0 * math.pi / (curvature * plan.speed_m_per_s)


def _axle(plan: Plan) -> np.ndarray | None:
    """The middle of the carriage's plain wheels; None where it has none."""
    points = [each.wheel.hub_m[:2] for each in plan.placed if each.body is None and not each.wheel.rollers]
    return np.asarray(np.mean(points, axis=0)) if points else None


def _angle(plan: Plan, place: np.ndarray, middle: np.ndarray, curvature: float) -> float:
    """Of a wheel whose place moves round the centre of the circle that the middle runs through."""
    off = place[:2] - middle[:2]
    return math.atan2(curvature * plan.along(off), 1.0 - curvature * plan.across(off))


def _curvature(plan: Plan, places: Sequence[tuple[HungBody, np.ndarray]], middle: np.ndarray) -> float:
    """So that the wheel that turns most turns by 0.3 rad, or by a part of its stop."""
    reach = max((abs(plan.along(place[:2] - middle[:2])) for _, place in places), default=0.0)
    if reach < 1e-3:
        return 1.0 / max(plan.size_m, 0.5)
    curvature = math.tan(STEER_RAD) / reach
    for _ in range(40):
        if all(_is_within(body, _angle(plan, place, middle, curvature), plan) for body, place in places):
            break
        curvature *= 0.9
    return float(f"{curvature:.3g}")


def _is_within(body: HungBody, angle: float, plan: Plan) -> bool:
    low, high = body.stops_rad
    straight = math.atan2(plan.ahead[1], plan.ahead[0]) if body.kind == COORDINATED else 0.0
    return OF_STOP * (low - straight) <= angle <= OF_STOP * (high - straight)


def _ramp_of(bodies: Sequence[HungBody], angle: float) -> float:
    """How long it takes a driver to turn the wheels so far."""
    rate = min(rate_of(body) for body in bodies)
    return max(1.0, math.ceil(10.0 * angle / (0.8 * rate)) / 10.0)
