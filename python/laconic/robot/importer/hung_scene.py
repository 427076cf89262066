"""The tables of a scene for bodies on hinges: `steered` in [[vehicle.wheel]], and [[vehicle.caster]],
[[vehicle.trailer]], [[vehicle.body]]."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.robot.importer.gravity import listed
from laconic.robot.importer.hung import CARRIAGE, COORDINATED, FREE, PRESCRIBED, HungBody, turned
from laconic.robot.importer.placement import Array
from laconic.robot.importer.robot_tree import Joint
from laconic.robot.importer.wheels import FoundWheel
from laconic.scene.scene_text import Comments

RATE_RAD_PER_S = 1.0  # of a prescribed hinge whose file states none
STRAIGHT_DEG = -90.0
ZERO_M, TOLD_M, TOLD_RAD = 1e-6, 1e-3, math.radians(0.2)
WHAT = {"wheel": "steered wheel", "caster": "swivel caster", "trailer": "trailer", "body": "body on a hinge"}
Rounded = Callable[[float], float]


@dataclass(frozen=True, eq=False)
class Placed:
    """A wheel of the scene in the order of its signals; `body` is None on the carriage."""

    wheel: FoundWheel
    body: HungBody | None
    is_driven: bool


class HungTables:
    """Makes the tables and their comments."""

    def __init__(self, bodies: Sequence[HungBody], idle: Sequence[Joint], has_carriage_wheels: bool, comments: Comments,
                 rounded: Rounded):
        self.bodies, self.idle, self.comments, self.rounded = bodies, idle, comments, rounded
        self.by_name = {body.name: body for body in bodies}
        self.has_carriage_wheels = has_carriage_wheels
        self.remarks: list[str] = []

    def is_driven(self, wheel: FoundWheel, body: HungBody) -> bool:
        """By the file; one that commands no wheel drives those of the carriage, or else those that are steered."""
        if wheel.joint.commands:
            return True
        return not self.idle and not self.has_carriage_wheels and body.kind != FREE

    def extra_wheels(self) -> list[tuple[FoundWheel, HungBody]]:
        """Those that have tables [[vehicle.wheel]], behind the carriage's."""
        return [(wheel, body) for body in self.bodies if body.form in ("wheel", "body") for wheel in body.wheels]

    def placed(self, carriage: Sequence[FoundWheel]) -> list[Placed]:
        """All wheels, as signals count them."""
        found = [Placed(wheel, None, wheel.joint not in self.idle) for wheel in carriage]
        found += [Placed(wheel, body, self.is_driven(wheel, body)) for wheel, body in self.extra_wheels()]
        for form in ("caster", "trailer"):
            found += [Placed(wheel, body, form == "caster" and _are_driven(body)) for body in self.bodies
                      if body.form == form for wheel in left_first(body)]
        return found

    def wheel(self, table: dict[str, Any], wheel: FoundWheel, body: HungBody, where: tuple[str, ...]
              ) -> dict[str, Any]:
        """One [[vehicle.wheel]] that a hinge carries; `table` as the carriage has it."""
        if not self.is_driven(wheel, body) and "motor_damping_Nms" not in table:  # damping is that of a motor
            table["driven"] = False
            self.comments.pop((*where, "driven"), None)
        else:
            table.pop("driven", None)
        axle_deg = float(np.degrees(body.axle_rad_of(wheel)))
        own = {"axle_deg": self.rounded(axle_deg)}
        rest = {key: value for key, value in table.items() if key not in ("kind", "x_m", "y_m", "axle_deg")}
        if body.form == "wheel":
            x, y = self.hinge_place(body)
            place = {"kind": "fixed", "steered": body.kind, "name": body.name,
                     **({} if body.parent == CARRIAGE else {"body": body.parent}), "x_m": x, "y_m": y}
            if own["axle_deg"] == STRAIGHT_DEG:
                own = {}
            scrub = self.rounded(float(body.local(wheel.hub_m)[1]))
            own |= {"scrub_m": scrub} if abs(scrub) > ZERO_M else {}
            self.comments[(*where, "kind")] = f"{wheel.name}, steered by {body.joint.name} ({body.why})"
            return {**place, **own, **rest, **self.mass(body, where, about_axis=True), **self.limits(body, where)}
        place_in_body = body.local(wheel.hub_m)
        if body.kind == COORDINATED:
            place_in_body[0] = 0.0
        self.comments[(*where, "kind")] = f"{wheel.name}, on {body.name}"
        return {"kind": "fixed", "body": body.name, "x_m": self.rounded(place_in_body[0]),
                "y_m": self.rounded(place_in_body[1]), **own, **rest}

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """[[vehicle.body]], [[vehicle.caster]], [[vehicle.trailer]]."""
        found: dict[str, list[dict[str, Any]]] = {}
        for form, make in (("body", self.body), ("caster", self.caster), ("trailer", self.trailer)):
            for body in (each for each in self.bodies if each.form == form):
                where = ("vehicle", form, str(len(found.setdefault(form, []))))
                found[form].append(make(body, where))
                self.comments[(*where, "name")] = f"hinge {body.joint.name} ({body.why})"
        self.remark()
        return found

    def hinge_place(self, body: HungBody) -> tuple[float, float]:
        """In the parent's frame."""
        above = self.by_name.get(body.parent)
        point = turned(body.hinge_m - above.hinge_m, -above.frame_rad) if above else body.hinge_m
        return self.rounded(float(point[0])), self.rounded(float(point[1]))

    def mass(self, body: HungBody, where: tuple[str, ...], *, about_axis: bool = False) -> dict[str, Any]:
        """Mass and yaw inertia of all that turns with it; of none nothing."""
        whole = body.whole
        yaw = float(whole.inertia_kgm2[2, 2]) + body.joint.armature_kgm2
        if whole.mass_kg <= 0.0:
            return {"mass_kg": 0.0, "yaw_inertia_kgm2": self.rounded(yaw)} if body.form == "body" or yaw else {}
        if about_axis:
            off = whole.com_m[:2] - body.hinge_m
            yaw += whole.mass_kg * float(off @ off)
        self.comments[(*where, "mass_kg")] = f"of {listed([link.name for link in body.links if link.mass_kg > 0.0])}"
        return {"mass_kg": self.rounded(whole.mass_kg), "yaw_inertia_kgm2": self.rounded(max(yaw, 0.0))}

    def limits(self, body: HungBody, where: tuple[str, ...]) -> dict[str, Any]:
        """Stops, the largest rate, and the angle at the start."""
        found: dict[str, Any] = {}
        for key, stop in zip(("stop_low_deg", "stop_high_deg"), body.stops_rad, strict=True):
            if math.isfinite(stop):
                found[key] = self.rounded(math.degrees(stop))
        if (body.kind == PRESCRIBED or math.isfinite(body.joint.speed_limit_rad_per_s)) and body.kind != FREE:
            found["rate_limit_rad_per_s"] = rate_of(body)
            self.comments[(*where, "rate_limit_rad_per_s")] = (
                "of the joint" if math.isfinite(body.joint.speed_limit_rad_per_s) else
                "assumption: the file has no speed limit of this joint")
        if body.start_rad:
            found["start_angle_deg"] = self.rounded(math.degrees(body.start_rad))
            self.comments[(*where, "start_angle_deg")] = (
                "as the file places it" if body.kind == FREE else "straight ahead")
        return found

    def caster(self, body: HungBody, where: tuple[str, ...]) -> dict[str, Any]:
        """[[vehicle.caster]]."""
        x, y = self.hinge_place(body)
        places = [body.local(each.hub_m) for each in left_first(body)]
        trail, offset = -float(np.mean([p[0] for p in places])), float(np.mean([p[1] for p in places]))
        table: dict[str, Any] = {"name": body.name, **self.parent(body), "x_m": x, "y_m": y,
                                 "trail_m": self.rounded(trail)}
        if abs(offset) > ZERO_M:
            table["offset_m"] = self.rounded(offset)
        if len(places) == 2:
            table["twin_m"] = self.rounded(float(places[0][1] - places[1][1]))
        if _are_driven(body):
            table["driven"] = True
        return {**table, **self.free(body, where)}

    def trailer(self, body: HungBody, where: tuple[str, ...]) -> dict[str, Any]:
        """[[vehicle.trailer]]."""
        x, y = self.hinge_place(body)
        one, other = (body.local(each.hub_m) for each in left_first(body))
        return {"name": body.name, **self.parent(body), "hitch_x_m": x, "hitch_y_m": y,
                "length_m": self.rounded(-float(one[0] + other[0]) / 2.0),
                "track_m": self.rounded(float(one[1] - other[1])), **self.free(body, where)}

    def free(self, body: HungBody, where: tuple[str, ...]) -> dict[str, Any]:
        """What casters and trailers share."""
        first = body.wheels[0]
        table: dict[str, Any] = {"radius_m": self.rounded(first.radius_m)}
        if first.inertia_kgm2 > 0.0:
            table["wheel_inertia_kgm2"] = self.rounded(first.inertia_kgm2)
        table |= self.mass(body, where)
        if body.whole.mass_kg > 0.0:
            table["com_x_m"] = self.rounded(float(body.local(body.whole.com_m)[0]))
        if body.joint.damping_Nms > 0.0:
            table["damping_Nms"] = self.rounded(body.joint.damping_Nms)
        return table | self.limits(body, where)

    def body(self, body: HungBody, where: tuple[str, ...]) -> dict[str, Any]:
        """[[vehicle.body]]."""
        x, y = self.hinge_place(body)
        table: dict[str, Any] = {"name": body.name, **self.parent(body), "hinge": body.kind, "hinge_x_m": x,
                                 "hinge_y_m": y, **self.mass(body, where)}
        if body.whole.mass_kg > 0.0:
            com = body.local(body.whole.com_m)
            table |= {"com_x_m": self.rounded(float(com[0])), "com_y_m": self.rounded(float(com[1]))}
        if body.kind == FREE and body.joint.damping_Nms > 0.0:
            table["damping_Nms"] = self.rounded(body.joint.damping_Nms)
        return table | self.limits(body, where)

    def parent(self, body: HungBody) -> dict[str, str]:
        """Its parent, where that is not the carriage."""
        return {} if body.parent == CARRIAGE else {"parent": body.parent}

    def remark(self) -> None:
        """What is dropped or taken otherwise, by name."""
        free = [body for body in self.bodies if body.form in ("caster", "trailer")]
        if damped := [each.name for body in free for each in body.wheels if each.joint.damping_Nms > 0.0]:
            self.remarks.append(f"damping of wheels that only roll is left out: {listed(damped)}")
        for body in free:
            aside = float(body.local(body.whole.com_m)[1]) if body.whole.mass_kg > 0.0 else 0.0
            if abs(aside) > 1e-3:
                self.remarks.append(f"the centre of mass of {body.name} lies {1e3 * abs(aside):.3g} mm beside the "
                                    "swivel axis and counts as behind it; its mass stays as it is")
        if rubbing := [f"{body.joint.name} ({body.joint.friction_Nm:g} N·m)" for body in self.bodies
                       if body.joint.friction_Nm > 0.0]:
            self.remarks.append(f"dry friction of hinges is left out: {', '.join(rubbing)}")
        for body in self.bodies:
            self.remark_zero(body)
        commanded = [body.joint.name for body in self.bodies if body.kind != FREE and body.joint.damping_Nms > 0.0]
        if commanded:
            self.remarks.append(f"damping of joints that follow a command has no effect and is left out: "
                                f"{listed(commanded)}")

    def remark_zero(self, body: HungBody) -> None:
        """A sense or a zero of the hinge that is not that of the joint."""
        zero, straight = body.zero_rad, body.start_rad
        if body.kind != FREE and abs(zero - straight) > TOLD_RAD:
            self.remarks.append(f"hinge {body.name} is {math.degrees(straight):.3g}° where its wheel rolls straight "
                                f"ahead, and starts so; joint {body.joint.name} is 0 at {math.degrees(zero):.3g}°")
        trail = max((abs(float(body.local(each.hub_m)[0])) for each in body.wheels), default=0.0)
        if (body.kind == COORDINATED or body.form == "wheel") and trail > TOLD_M:
            self.remarks.append(f"the trail of {body.name}, {1e3 * trail:.3g} mm, counts as 0")
        if body.kind != FREE and body.sense < 0.0:
            self.remarks.append(f"hinge {body.name} turns to the left, joint {body.joint.name} to the right: their "
                                "signs differ")

    def words(self) -> list[str]:
        """A line for each hinge."""
        found: list[str] = []
        for body in self.bodies:
            x, y = self.hinge_place(body)
            kind = "swivels freely" if body.kind == FREE else body.kind
            what = WHAT[body.form]
            if body.form == "caster" and len(body.wheels) == 2:
                what += " with two wheels"
            on = "" if body.parent == CARRIAGE else f" of {body.parent}"
            found.append(f"hinge {len(found) + 1}: {body.name}, {what}, {kind}, at ({x:.4g}, {y:.4g}) m{on}; "
                         f"{body.why}")
        return found


def _are_driven(body: HungBody) -> bool:
    return any(each.joint.commands for each in body.wheels)


def left_first(body: HungBody) -> list[FoundWheel]:
    """Its wheels as a scene's short forms order them."""
    return sorted(body.wheels, key=lambda each: -float(body.local(each.hub_m)[1]))


def rate_of(body: HungBody) -> float:
    """The largest rate of a commanded hinge."""
    limit = body.joint.speed_limit_rad_per_s
    return float(f"{limit:.9g}") if math.isfinite(limit) else RATE_RAD_PER_S


def rigid_table(vehicle: Mapping[str, Any], placed: Sequence[Placed], mass_kg: float, com_m: Array
                ) -> dict[str, Any]:
    """The vehicle as it stands in the file's zero position, on wheels that carry a load: for its loads at rest."""
    wheels = [{**_without_body(vehicle["wheel"][at]), "kind": "fixed", "x_m": float(each.wheel.hub_m[0]),
               "y_m": float(each.wheel.hub_m[1]), "axle_rad": each.wheel.axle_rad,
               "inertia_kgm2": 1.0}  # of no effect at rest; a caster's may be 0
              for at, each in enumerate(placed)]
    return {**_without_body(vehicle), "wheel": wheels, "mass_kg": mass_kg, "com_x_m": float(com_m[0]),
            "com_y_m": float(com_m[1])}


def _without_body(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if key != "body"}
