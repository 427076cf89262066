"""The fitted scene as TOML: the one it came from with the values found, their sources and intervals in comments."""

from __future__ import annotations

import cmath
import math
from typing import Any

from laconic.core.articulated import CARRIAGE
from laconic.robot.identify.geometry import OF_TRACKER
from laconic.robot.identify.ground import OF_TREES
from laconic.robot.identify.parameter import Parameter
from laconic.robot.identify.report import judgement
from laconic.robot.identify.study import Study, fitted_scene, parts
from laconic.robot.logs.for_vehicle import wheels_on_carriage
from laconic.scene.scene_text import Comments, rewritten
from laconic.scene.table import read_toml

PLACED_BY = ("distance_m", "bearing_rad", "bearing_deg")
HUNG_AT = {"caster": ("x_m", "y_m"), "trailer": ("hitch_x_m", "hitch_y_m"), "body": ("hinge_x_m", "hinge_y_m")}
"""The keys of each table that say where on the carriage it hangs."""


def fitted_text(study: Study) -> str:
    """A complete scene: the file with other numbers, its own comments kept."""
    data = read_toml(study.scene.path).plain()
    data["source"] = f"{data.get('source', '')}; identified".removeprefix("; ")
    comments: Comments = {}
    wheels, has_hinges = data["vehicle"]["wheel"], study.scene.has_hinges
    rows = range(len(wheels)) if has_hinges else wheels_on_carriage(data["vehicle"])  # of free bodies: left out
    for index, row in enumerate(rows):
        _rewrite(study, index, wheels[row], comments, row)
    _rewrite_vehicle(study, data, comments)
    (_rewrite_hinges if has_hinges else _move_hung)(study, data["vehicle"], comments)
    head = [f"# {study.scene.path.name}, with parameters identified by `laconic identify` from recorded runs:"]
    head += [f"#   {', '.join(log.path.name for log in part)} of {part[0].session}"
             for part in parts(study.logs, "session")]
    head += ["# Intervals hold the true value with 95 %, if the rest of the model is right. In words:"]
    head += [f"#   {word}" for word in study.words]
    head += [f"# {line}" for line in judgement(study)]
    if of_map := [p for p in study.found.parameters.each if p.path.startswith("log.")]:
        head += ["# These belong to the log's map, which --map-out writes; this scene does not have them:",
                 *(f"#   {_interval(study, p.path)}" for p in of_map)]
    text = study.scene.path.read_text(encoding="utf-8-sig")
    return "\n".join([*head, "", rewritten(text, data, comments)])


def _rewrite_vehicle(study: Study, data: dict[str, Any], comments: Comments) -> None:
    """Keys that are no wheel's: of [vehicle], [vehicle.motor], [ground] and [speed_controller]."""
    after = fitted_scene(study.scene, study.found).vehicle
    tables = {("vehicle",): data["vehicle"], ("vehicle", "motor"): data["vehicle"].get("motor", {})}
    if any(p.path.startswith("ground.") or p.group in OF_TREES
           for p in (study.found.asked or study.found.parameters).each):
        data["vehicle"].pop("friction_coefficient", None)  # ground.friction_coefficient says it
        tables["ground",] = data.setdefault("ground", {})
        tables["ground",].update({key: after["ground"][key] for key in after["ground"] if not key.startswith("slope_")})
    _rewrite_places(study, data["vehicle"], after, comments)
    if after.get("wheel_radius_m") != study.scene.vehicle.get("wheel_radius_m"):
        data["vehicle"]["wheel_radius_m"] = after["wheel_radius_m"]
        comments["vehicle", "wheel_radius_m"] = _of_group(study, "radius")
    for key, value in after.get("motor", {}).items():  # the back-EMF's constant follows the torque's
        if value != study.scene.vehicle["motor"][key]:
            data["vehicle"]["motor"][key] = value
    for parameter in study.found.parameters.each:
        *location, key = parameter.path.split(".")
        if tuple(location) in tables:
            values = after
            for part in location[location[0] == "vehicle":]:
                values = values[part]
            tables[tuple(location)][key] = values[key]
            comments[(*location, key)] = _interval(study, parameter.path)
    if study.controller is not None:
        data["speed_controller"] = study.controller.values()
        comments.update({("speed_controller", key): text for key, text in study.controller.comments().items()})


def _rewrite_hinges(study: Study, data: dict[str, Any], comments: Comments) -> None:
    """Places of steered wheels, trails of casters, and what wheels have on ground with friction."""
    before, after = study.scene.vehicle, fitted_scene(study.scene, study.found).vehicle
    notes = {group: _of_group(study, group, "distance") for group in ("wheelbase", "track")}
    bodies = {body["name"]: (body, was) for body, was in zip(after["body"], before["body"], strict=True)}
    for index, wheel in enumerate(data["wheel"]):
        now, place = after["wheel"][index], ("vehicle", "wheel", str(index))
        for key in ("creep", "scrub_radius_m", "scrub_fade_m"):
            if now.get(key) != before["wheel"][index].get(key):
                wheel[key] = now[key]
                which = "steered" if "body" in now else "fixed"
                comments[(*place, key)] = _interval(
                    study, f"vehicle.wheel[{'*' if key == 'scrub_fade_m' else which}].{key}")
        if "steered" in wheel:
            _move(wheel, ("x_m", "y_m"), *bodies[now["body"]], place, notes, comments)
        elif now["y_m"] != before["wheel"][index]["y_m"] and now["x_m"] == before["wheel"][index]["x_m"]:
            comments[(*place, "x_m")], comments[(*place, "y_m")] = "", notes["track"]
    for index, body in enumerate(data.get("body", ())):
        _move(body, ("hinge_x_m", "hinge_y_m"), *bodies[body["name"]], ("vehicle", "body", str(index)), notes, comments)
    for index, caster in enumerate(data.get("caster", ())):
        wheel = next((i for i, each in enumerate(after["wheel"]) if each.get("body") == caster["name"]), None)
        if wheel is not None and after["wheel"][wheel]["x_m"] != before["wheel"][wheel]["x_m"]:
            caster["trail_m"] = -after["wheel"][wheel]["x_m"]
            comments["vehicle", "caster", str(index), "trail_m"] = _interval(
                study, f"vehicle.wheel[{wheel + 1}].trail_m")


def _move(table: dict[str, Any], keys: tuple[str, str], now: dict[str, Any], was: dict[str, Any],
          place: tuple[str, ...], notes: dict[str, str], comments: Comments) -> None:
    """A hinge that a fit has moved."""
    for key, own, group in zip(keys, ("hinge_x_m", "hinge_y_m"), ("wheelbase", "track"), strict=True):
        if now[own] != was[own]:
            if table.keys() & {*PLACED_BY}:  # by distance and bearing, which the place replaces
                table.update(zip(keys, (now["hinge_x_m"], now["hinge_y_m"]), strict=True))
            for other in PLACED_BY:
                table.pop(other, None)
            table[key] = now[own]
            comments[(*place, key)] = notes[group]


def _that_move(study: Study) -> list[Parameter]:
    """The parameters by which parts of the robot are elsewhere."""
    return [p for p in study.found.parameters.each if p.group in ("distance", "place", "heading")
            and not p.path.startswith("log.")]


def _rewrite_places(study: Study, data: dict[str, Any], after: dict[str, Any], comments: Comments) -> None:
    """The centre of mass, supports and payload of a robot that has another place in its frame."""
    before = study.scene.vehicle
    why = "moved with the robot: " + "; ".join(_interval(study, p.path) for p in _that_move(study))
    for key in ("com_x_m", "com_y_m"):
        if after[key] != before[key]:
            data[key], comments["vehicle", key] = after[key], why
    if after.get("payload") != before.get("payload"):
        data["payload"].update({key: after["payload"][key] for key in ("x_m", "y_m")})
        comments["vehicle", "payload", "x_m"] = why
    if after["support"] != before["support"]:
        for index, (point, moved) in enumerate(zip(data["support"], after["support"], strict=True)):
            point.update(moved)
            comments["vehicle", "support", str(index), "x_m"] = why


def _move_hung(study: Study, data: dict[str, Any], comments: Comments) -> None:
    """Where casters and trailers hang on a carriage that has another place in its frame."""
    values = {p.path: float(value) for p, value in zip(study.found.parameters.each, study.found.values, strict=True)
              if p.group in ("place", "heading")}
    if not values:
        return
    heading, *place_m = (values.get(f"vehicle.*.{key}", 0.0) - values.get(OF_TRACKER[key], 0.0)
                         for key in ("heading", "x_m", "y_m"))
    turn, shift = cmath.exp(1j * heading), complex(*place_m)
    for table, keys in HUNG_AT.items():
        for index, part in enumerate(data.get(table, ())):
            if part.get("parent", CARRIAGE) == CARRIAGE:
                place = turn * (complex(*(part.get(key, 0.0) for key in keys)) + shift)
                part.update(zip(keys, (place.real, place.imag), strict=True))
                comments["vehicle", table, str(index), keys[0]] = "moved with the robot"


def _rewrite(study: Study, index: int, wheel: dict[str, Any], comments: Comments, row: int) -> None:
    """The keys of one wheel that parameters have moved; the others stay as they were written. `row`: in the file."""
    before, after = (scene.vehicle["wheel"][index] for scene in (study.scene, fitted_scene(study.scene, study.found)))
    location = ("vehicle", "wheel", str(row))
    if after.get("radius_m") != before.get("radius_m"):
        wheel["radius_m"] = after["radius_m"]
        of_one = f"vehicle.wheel[{index + 1}].radius_m"
        is_own = any(p.path == of_one for p in study.found.parameters.each)
        comments[(*location, "radius_m")] = _interval(study, of_one) if is_own else _of_group(study, "radius")
    if after.get("friction_coefficient") != before.get("friction_coefficient"):
        wheel["friction_coefficient"] = after["friction_coefficient"]
        comments[(*location, "friction_coefficient")] = _interval(
            study, f"vehicle.wheel[{index + 1}].friction_coefficient")
    moved = _that_move(study)
    if (after["x_m"], after["y_m"]) != (before["x_m"], before["y_m"]):
        for key in PLACED_BY:
            wheel.pop(key, None)
        wheel["x_m"], wheel["y_m"] = after["x_m"], after["y_m"]
        comments[(*location, "x_m")] = "; ".join(_interval(study, p.path) for p in moved)
        comments[(*location, "y_m")] = f"nominal {before['x_m']:.6g}, {before['y_m']:.6g}"
    for key in ("axle_rad", "roller_rad"):
        if after.get(key) != before.get(key):
            _write_angle(wheel, key, after[key])
            path = f"vehicle.wheel[{index + 1}].{key}"
            comments[(*location, key)] = comments[(*location, key.replace("_rad", "_deg"))] = _interval(study, path)


def _write_angle(wheel: dict[str, Any], key: str, value: float) -> None:
    """In the unit that the scene has."""
    degrees = key.replace("_rad", "_deg")
    if degrees in wheel:
        wheel[degrees] = math.degrees(value)
    else:
        wheel[key] = value


def _interval(study: Study, path: str) -> str:
    found = study.found
    for parameter, value, half in zip(found.parameters.each, found.values, found.half_widths, strict=True):
        if parameter.path == path:
            return interval_text(parameter, float(value), float(half))
    return "turned with all wheels" if not study.scene.has_hinges else ""


def _of_group(study: Study, *groups: str) -> str:
    return "; ".join(_interval(study, p.path) for p in study.found.parameters.each if p.group in groups)


def interval_text(parameter: Parameter, value: float, half: float) -> str:
    """"radius of wheel 1: 0.0491 ± 0.0007 m, nominal 0.051"."""
    unit = f" {parameter.unit}" if parameter.unit else ""
    if parameter.group == "distance":
        return f"{parameter.name}: {value:.5g} ± {half:.2g} times the nominal ones"
    return f"{parameter.name}: {value:.5g} ± {half:.2g}{unit}, nominal {parameter.nominal:.5g}"
