"""Bodies on hinges in a scene: steered wheels, casters and trailers, and the general body that they are short for.

    found = read_hinges(vehicle_table, wheels)   # wheels: pairs of a table and what read_wheel made of it
    found.bodies, found.wheels                   # as laconic.core.articulated has them, parents first
    found.hinges                                 # names, limits and starts, in the same order
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from laconic.base.paths import scene_names, scene_path
from laconic.core.articulated import CARRIAGE, NAME
from laconic.errors import BadInput, Refused, nearest_of, shown
from laconic.scene.hinge_friction import (
    HITCH,
    NEEDS_GROUND,
    OF_HINGES,
    OF_LOOPS,
    OF_SERVOS,
    PERIOD,
    loop_of,
    of_motor,
    read_contact,
    read_hinge_friction,
    stops_of,
)
from laconic.scene.keys import read_choice, read_number
from laconic.scene.table import Table, read_toml

if TYPE_CHECKING:
    from laconic.scene.scene import Scene

ROLLS_FORWARD_RAD = -math.pi / 2  # the axle of a wheel whose positive speed is forward
SHORT_FORMS = ("caster", "trailer", "body")
STEERED_ALONE = ("name", "scrub_m", "mass_kg", "yaw_inertia_kgm2", "steering_gain_Nm_per_V", "steering_damping_Nms",
                 "stop_low_rad", "stop_low_deg", "stop_high_rad", "stop_high_deg", "start_angle_rad",
                 "start_angle_deg", "start_rate_rad_per_s", "rate_limit_rad_per_s", "at_limit", "steering_motor",
                 *OF_HINGES, *OF_SERVOS, *OF_LOOPS, PERIOD)
"""Keys of a wheel that mean nothing unless it is steered."""
WITHOUT_HINGES = ("give a rigid vehicle, with [[vehicle.support]] in the place of casters and steered wheels, as "
                  "laconic import --no-hinges writes it")
MOTOR_KEYS = ("resistance_ohm", "torque_constant_Nm_per_A", "back_emf_Vs_per_rad", "gear_ratio", "viscous_friction_Nms",
              "rotor_inertia_kgm2")
COMMANDED = ("prescribed", "coordinated")
LIMITED = (*COMMANDED, "servo")
OF_WHOLE_HINGES = ("twist zero", "twist jumps", "massless hinge", "coordinated too few", "steered too often",
                   "coordinated on body", "step beyond trail limit")
"""Refusals that are not about the number that the core names."""


@dataclass(frozen=True)
class Hinge:
    """One hinge of a scene: what the core does not know of it."""

    name: str
    kind: str         # "free", "motor", "prescribed", "coordinated"; where wheels slip also "servo"
    place: str        # its table in the file: "vehicle.caster[1]"
    low_rad: float = -math.inf
    high_rad: float = math.inf
    rate_limit_rad_per_s: float = math.inf
    refuses: bool = False  # at a limit, instead of saturating
    start_angle_rad: float = 0.0
    start_rate_rad_per_s: float = 0.0
    follows: str = ""  # where wheels slip: what of it a servo or loop takes a command of, "angle" or "rate"
    motor: tuple[tuple[str, float], ...] = ()  # the numbers of its motor's table, where it is given at its shaft

    @property
    def has_stops(self) -> bool:
        """Whether its angle is limited."""
        return math.isfinite(self.low_rad) or math.isfinite(self.high_rad)

    @property
    def is_commanded(self) -> bool:
        """Whether its rate follows from an input."""
        return self.kind in COMMANDED

    @property
    def form(self) -> str:
        """What it is in the file: "wheel", "caster", "trailer", "body"."""
        return self.place.removeprefix("vehicle.").partition("[")[0]


@dataclass(frozen=True)
class Hung:
    """All bodies of a scene, parents first, and all wheels with the places of their tables in the file."""

    bodies: list[dict[str, Any]]
    hinges: tuple[Hinge, ...]
    wheels: list[dict[str, Any]]
    wheel_places: tuple[str, ...]


@dataclass(frozen=True)
class _Part:
    """What one table of the file contributes."""

    table: Table
    body: dict[str, Any]
    hinge: Hinge
    wheels: list[dict[str, Any]]


def has_hinges(vehicle: Any) -> bool:
    """Whether the entries of a file's `[vehicle]`, or a vehicle that was read, have bodies on hinges."""
    if not isinstance(vehicle, Mapping):
        return False
    wheels = vehicle.get("wheel")
    hung = isinstance(wheels, list) and any(
        isinstance(each, Mapping) and ("steered" in each or each.get("body", CARRIAGE) != CARRIAGE) for each in wheels)
    return hung or any(vehicle.get(form) for form in SHORT_FORMS)


def file_has_hinges(path: Path) -> bool:
    """Whether a scene file has bodies on hinges; False for a file that is no scene, which its reader refuses."""
    try:
        return has_hinges(read_toml(path).peek("vehicle"))
    except BadInput:
        return False


def rigid_scene_names() -> list[str]:
    """Names of the scenes without hinges that come with the project."""
    return [name for name in scene_names() if not file_has_hinges(scene_path(name))]


def check_without_hinges(scene: Scene, command: str) -> None:
    """BadInput where something that knows rigid vehicles alone gets one with hinges."""
    if scene.has_hinges:
        raise BadInput(f"{scene.path}: {scene.hinges[0].place}: {command} does not take vehicles with hinges yet; use "
                       f"laconic simulate, or {WITHOUT_HINGES}")


def read_hinges(table: Table, wheels: Sequence[tuple[Table, dict[str, Any]]], slips: bool) -> Hung:
    """Every body that `[vehicle]` has; `wheels` are those of its `[[vehicle.wheel]]`; `slips`: the ground has
    friction."""
    plain, places, parts = [wheel for _, wheel in wheels], [each.location for each, _ in wheels], list[_Part]()
    for each in table.tables("body"):
        parts.append(_general(each, slips))
    for number, (each, wheel) in enumerate(wheels, 1):
        if "steered" in wheel:
            parts.append(_steered(each, wheel, number, slips))
    for number, each in enumerate(table.tables("caster"), 1):
        parts.append(_caster(each, number, slips))
    for number, each in enumerate(table.tables("trailer"), 1):
        parts.append(_trailer(each, number, slips))
    _check_names(parts)
    parts = _parents_first(parts)
    names = [CARRIAGE, *(part.hinge.name for part in parts)]
    for each, wheel in wheels:
        if wheel.get("body", CARRIAGE) not in names:
            each.fail("body", f"there is no body {shown(wheel['body'])}; {nearest_of(wheel['body'], names)}")
    for form in ("caster", "trailer"):
        for part in sorted((p for p in parts if p.hinge.form == form), key=lambda p: _number_of(p.hinge.place)):
            plain += part.wheels
            places += [part.hinge.place] * len(part.wheels)
    for part in parts:
        part.table.done()
    return Hung([part.body for part in parts], tuple(part.hinge for part in parts), plain, tuple(places))


def _number_of(place: str) -> int:
    return int(place.partition("[")[2].rstrip("]"))


# ------------------------------------------------------------------------------------ short forms


def _steered(table: Table, wheel: dict[str, Any], number: int, slips: bool) -> _Part:
    """A steered wheel: a body with the wheel under its hinge. The wheel's place becomes that in the body's frame."""
    kind = wheel.pop("steered")
    if wheel["kind"] != "fixed":
        table.fail("kind", f"is {shown(wheel['kind'])}; a steered wheel is \"fixed\" to what turns it")
    if kind == "servo" and not slips:
        table.fail("steered", '"servo" gives way, which needs ground.friction_coefficient; give it, or "prescribed"')
    hinge = _hinge(table, read_name(table, f"wheel_{number}"), kind, slips)
    body = {"name": hinge.name, "parent": wheel.get("body", CARRIAGE), "hinge": kind, "hinge_x_m": wheel["x_m"],
            "hinge_y_m": wheel["y_m"], "mass_kg": read_number(table, "mass_kg"),
            "yaw_inertia_kgm2": read_number(table, "yaw_inertia_kgm2")}
    turned, motor = _motor(table, kind, "steering_motor", "steering_gain_Nm_per_V", "steering_damping_Nms", body, slips)
    body, hinge = body | turned, replace(hinge, motor=motor)
    wheel |= {"x_m": 0.0, "y_m": read_number(table, "scrub_m"), "body": hinge.name}
    return _turned(_Part(table, body, hinge, []), slips)


def _caster(table: Table, number: int, slips: bool) -> _Part:
    hinge = _hinge(table, read_name(table, f"caster_{number}"), "free", slips)
    trail, offset, twin = (read_number(table, key) for key in ("trail_m", "offset_m", "twin_m"))
    places = [offset] if twin is None else [offset + twin / 2, offset - twin / 2]
    body = {"hinge_x_m": table.number("x_m", finite=False), "hinge_y_m": table.number("y_m", finite=False)}
    return _free_part(table, hinge, body, trail, places, slips, table.flag("driven", False))


def _trailer(table: Table, number: int, slips: bool) -> _Part:
    hinge = _hinge(table, read_name(table, f"trailer_{number}"), "free", slips)
    half = read_number(table, "track_m") / 2
    body = {"hinge_x_m": read_number(table, "hitch_x_m"), "hinge_y_m": read_number(table, "hitch_y_m")}
    body |= {HITCH: True} if slips else {}
    return _free_part(table, hinge, body, read_number(table, "length_m"), [half, -half], slips)


def _free_part(table: Table, hinge: Hinge, body: dict[str, Any], behind_m: float, left_m: Sequence[float],
               slips: bool, driven: bool = False) -> _Part:
    """A body on a free hinge with wheels on one axle behind it."""
    radius, inertia = read_number(table, "radius_m"), read_number(table, "wheel_inertia_kgm2")
    if slips and not inertia:
        table.fail("wheel_inertia_kgm2", "is 0, and a wheel that may slip has a speed of its own; give a value above 0")
    com = read_number(table, "com_x_m")
    _check_mass(table, com)
    body = {"name": hinge.name, "parent": read_parent(table), "hinge": "free", **body,
            "com_x_m": -behind_m if com is None else com,
            **{key: read_number(table, key) for key in ("mass_kg", "yaw_inertia_kgm2", "damping_Nms")}}
    contact = read_contact(table, slips)
    wheels = [{"kind": "fixed", "x_m": -behind_m, "y_m": left, "axle_rad": ROLLS_FORWARD_RAD, "locked": False,
               "driven": driven, "motor_circuit": 0, "radius_m": radius, "inertia_kgm2": inertia, "body": hinge.name,
               **contact} for left in left_m]
    return _turned(_Part(table, body, hinge, wheels), slips)


def _check_mass(table: Table, *places_m: float | None) -> None:
    """Fails for a centre of mass of a body that has none."""
    for key, place in zip(("com_x_m", "com_y_m"), places_m, strict=False):
        if place and not read_number(table, "mass_kg"):
            table.fail(key, "has no effect on a body without mass; give mass_kg, or take it out")


def _general(table: Table, slips: bool) -> _Part:
    kind = read_choice(table, "hinge")
    kind = "servo" if slips and kind == "free" and table.peek("servo_gain_Nm_per_rad") else kind
    hinge = _hinge(table, read_name(table, None), kind, slips)
    numbers = ("hinge_x_m", "hinge_y_m", "mass_kg", "yaw_inertia_kgm2", "com_x_m", "com_y_m", "stiffness_Nm")
    body = {"name": hinge.name, "parent": read_parent(table), "hinge": kind,
            **{key: read_number(table, key) for key in numbers}, "rest_rad": table.angle("rest", 0.0)}
    _check_mass(table, body["com_x_m"], body["com_y_m"])
    turned, motor = _motor(table, kind, "motor", "gain_Nm_per_V", "damping_Nms", body, slips)
    body, hinge = body | turned, replace(hinge, motor=motor)
    if hinge.is_commanded:
        for key in ("damping_Nms", "stiffness_Nm"):
            if body.get(key):
                table.fail(key, f"has no effect on a {kind} hinge, whose rate is an input; take it out")
    if table.has(HITCH):
        hitch = table.flag(HITCH)
        if not slips:
            table.fail(HITCH, NEEDS_GROUND)
        body[HITCH] = hitch
    return _turned(_Part(table, body, hinge, []), slips)


def _motor(table: Table, kind: str, motor_key: str, gain: str, damping: str, body: Mapping[str, Any],
           slips: bool) -> tuple[dict[str, float], tuple[tuple[str, float], ...]]:
    """Gain, damping and inertia of a hinge: given directly, or those of a motor at its shaft; and that motor."""
    direct = {"gain_Nm_per_V": read_number(table, gain), "damping_Nms": read_number(table, damping)}
    if kind != "motor":
        for key in (gain, motor_key):
            if table.peek(key):
                table.fail(key, f'is given for a hinge that is "{kind}"; take it out, or make the hinge "motor"')
        return direct, ()
    if not table.has(motor_key):
        if not direct["gain_Nm_per_V"]:
            table.fail(gain, f"is missing; give it, or a table {motor_key}, for a hinge with a motor")
        return direct, ()
    for key in (gain, damping):
        if table.peek(key) is not None:
            table.fail(key, f"is given besides {motor_key}; keep one of them")
    motor = table.table(motor_key)
    numbers = {key: read_number(motor, key) for key in MOTOR_KEYS}
    resistance, torque, emf, ratio, friction, rotor = numbers.values()
    further = of_motor(motor, slips)
    motor.done()
    turned = further | {"gain_Nm_per_V": ratio * torque / resistance,
              "damping_Nms": ratio * ratio * (torque * emf / resistance + friction),
              "yaw_inertia_kgm2": body["yaw_inertia_kgm2"] + ratio * ratio * rotor}
    return turned, tuple(numbers.items())


def _turned(part: _Part, slips: bool) -> _Part:
    """A part with what acts on its hinge where wheels slip: there a servo, a rate or a motor turns each hinge."""
    more = read_hinge_friction(part.table, part.hinge.kind, slips)
    if not slips:
        return part
    body, hinge = part.body | more, part.hinge
    if hinge.kind == "coordinated" and body["parent"] != CARRIAGE:
        part.table.fail("body" if hinge.form == "wheel" else "parent", "a coordinated hinge is on the carriage; take "
                        "it out, or give the hinge a servo of its own")
    if hinge.kind in ("coordinated", "servo"):
        body["hinge"] = "free" if body.get("servo_gain_Nm_per_rad") else "prescribed"
    if body["hinge"] != "prescribed":
        body |= stops_of(hinge.low_rad, hinge.high_rad)
    return _Part(part.table, body, replace(hinge, follows=loop_of(body)), part.wheels)


# --------------------------------------------------------------------------- names, limits, order


def read_name(table: Table, default: str | None) -> str:
    """The name of a body; it can stand in brackets behind a signal."""
    name = table.text("name", ... if default is None else default)
    if not NAME.fullmatch(name):
        table.fail("name", f"is {shown(name)}; use letters, digits, _ and -, with a letter first, as it is part of "
                   "the names of signals")
    if name == CARRIAGE:
        table.fail("name", f"is {shown(name)}, the name of body 0; give another one")
    return name


def read_parent(table: Table) -> str:
    """The name of the body that a body hangs on."""
    return table.text("parent", CARRIAGE)


def _hinge(table: Table, name: str, kind: str, slips: bool) -> Hinge:
    low, high = table.angle("stop_low", None), table.angle("stop_high", None)
    if low is not None and high is not None and not low < high:
        table.fail("stop_high_rad", f"is {high:g}, which is not above stop_low_rad = {low:g}; exchange them")
    commanded = table.location.startswith(("vehicle.wheel", "vehicle.body"))
    rate = read_number(table, "rate_limit_rad_per_s") if commanded else None
    at_limit = read_choice(table, "at_limit") if commanded else None
    if rate is not None and kind not in LIMITED:
        table.fail("rate_limit_rad_per_s", f'has no effect on a hinge that is "{kind}"; take it out, or make it '
                   '"prescribed" or "coordinated"')
    if at_limit == "saturate" and kind not in LIMITED:
        table.fail("at_limit", f'"saturate" needs a command to be limited, and this hinge is "{kind}": a stop would '
                   'push against it, which the model does not have; give "refuse"')
    start_angle = table.angle("start_angle", 0.0, finite=True)
    low, high = -math.inf if low is None else low, math.inf if high is None else high
    if not low <= start_angle <= high:
        table.fail("start_angle_rad", f"is {start_angle:g}, beyond the stops ({low:g} to {high:g}); start within them")
    start_rate = table.number("start_rate_rad_per_s", 0.0)
    if start_rate and kind in COMMANDED:
        table.fail("start_rate_rad_per_s", f'has no effect on a hinge that is "{kind}", whose rate is an input; take '
                   "it out")
    return Hinge(name, kind, table.location, low, high, math.inf if rate is None else rate,
                 at_limit == "refuse" or kind not in LIMITED, start_angle, start_rate)


def check_not_steered(table: Table) -> None:
    """Fails for keys of a wheel that mean nothing unless it is steered, and for one that was to steer it."""
    if typed := table.mistyped("steered"):
        table.fail(typed, "is no known key here; did you mean steered?")
    for key in STEERED_ALONE:
        if table.peek(key) is not None:
            table.fail(key, "has a meaning for a steered wheel alone; give steered, or take it out")


def _check_names(parts: Sequence[_Part]) -> None:
    names: dict[str, str] = {}
    for part in parts:
        name = part.hinge.name
        if name in names:
            part.table.fail("name", f"is {shown(name)}, as of {names[name]}; give each body another name")
        names[name] = part.hinge.place


def _parents_first(parts: Sequence[_Part]) -> list[_Part]:
    """The same in an order in which each parent comes before its bodies; else as they are in the file."""
    names = [CARRIAGE, *(part.hinge.name for part in parts)]
    for part in parts:
        key = "body" if part.hinge.form == "wheel" else "parent"
        if part.body["parent"] not in names:
            others = [name for name in names if name != part.hinge.name]
            part.table.fail(key, f"there is no body {shown(part.body['parent'])}; "
                            f"{nearest_of(part.body['parent'], others)}")
        if part.body["parent"] == part.hinge.name:
            part.table.fail(key, f"is {shown(part.hinge.name)}, the body itself; let it hang on another body, or on "
                            "the carriage")
    placed, found, left = {CARRIAGE}, list[_Part](), list(parts)
    while left:
        ready = next((part for part in left if part.body["parent"] in placed), None)
        if ready is None:
            left[0].table.fail("parent", f"hangs on {shown(left[0].body['parent'])}, which in the end hangs on this "
                               "body; let one of them hang on the carriage")
        left.remove(ready)
        found.append(ready)
        placed.add(ready.hinge.name)
    return found


# ------------------------------------------------------------------------------------- refusals

KEYS_OF_FORMS = {
    "wheel": {"hinge_x_m": "x_m", "hinge_y_m": "y_m", "damping_Nms": "steering_damping_Nms",
              "gain_Nm_per_V": "steering_gain_Nm_per_V", "parent": "body", "hinge": "steered"},
    "caster": {"hinge_x_m": "x_m", "hinge_y_m": "y_m"},
    "trailer": {"hinge_x_m": "hitch_x_m", "hinge_y_m": "hitch_y_m"},
    "body": {}}
"""The keys of the short forms for those of a body."""


WORDS_IN_FILES = {
    "this wheel and wheel 0 ask": "this wheel and those of the carriage ask"}
WORDS_OF_SLIP = {
    "turns without inertia, and no wheel behind it sets its rate; give the body a yaw inertia, place the wheel behind "
    "the hinge (a trail), or prescribe the rate":
    "turns without inertia, and a wheel that may slip does not set its rate; give yaw_inertia_kgm2 above 0, or a mass "
    "away from the hinge (mass_kg)"}
"""What the core says of hinges on ideal ground, and what holds where wheels may slip."""
AT_STARTS = {"vehicle.body: ": "vehicle: ", "twist: ": "steering_twist: ", "twist_rate: ": "steering_twist: "}
"""What the core says, and what holds of a scene file."""


def refusal_of_hinges(refused: Refused, hinges: Sequence[Hinge], wheel_places: Sequence[str],
                      slips: bool = False) -> Refused:
    """A refusal of the core by the tables of the file: the core counts all bodies and all wheels."""
    text = refused.message
    for core, file in (WORDS_IN_FILES | (WORDS_OF_SLIP if slips else {})).items():
        text = text.replace(core, file)
    for core, file in AT_STARTS.items():
        if text.startswith(core):
            text = file + text.removeprefix(core)
    if found := re.match(r"vehicle\.body\[(\d+)\](?:\.(\w+))?: ", text):
        hinge = hinges[min(int(found[1]), len(hinges)) - 1]
        key = KEYS_OF_FORMS[hinge.form].get(found[2] or "", found[2] or "")
        name = "" if hinge.form == "body" and not key else f" ({hinge.name})"
        where = hinge.place if refused.status in OF_WHOLE_HINGES or not key else f"{hinge.place}.{key}"
        text = f"{where}{name}: {text[found.end():]}"
    elif (found := re.match(r"vehicle\.wheel\[(\d+)\]", text)) and 1 <= int(found[1]) <= len(wheel_places):
        text = f"{wheel_places[int(found[1]) - 1]}{text[found.end():]}"
    return Refused(refused.status, refused.field, refused.item, text, value=refused.value, limit=refused.limit)
