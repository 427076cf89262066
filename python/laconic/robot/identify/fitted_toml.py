"""The fitted scene as TOML: the one it came from with the values found, their sources and intervals in comments."""

from __future__ import annotations

import math
from typing import Any

from laconic.robot.identify.parameter import Parameter
from laconic.robot.identify.report import judgement
from laconic.robot.identify.study import Study, fitted_scene, parts
from laconic.scene.scene_text import Comments, lines_of
from laconic.scene.table import read_toml


def fitted_text(study: Study) -> str:
    """A complete scene."""
    data = read_toml(study.scene.path).plain()
    data["source"] = f"{data.get('source', '')}; identified".removeprefix("; ")
    comments: Comments = {}
    for index, wheel in enumerate(data["vehicle"]["wheel"]):
        _rewrite(study, index, wheel, comments)
    _rewrite_vehicle(study, data, comments)
    head = [f"# {study.scene.path.name}, with parameters identified by `laconic identify` from recorded runs:"]
    head += [f"#   {', '.join(log.path.name for log in part)} of {part[0].session}"
             for part in parts(study.logs, "session")]
    head += ["# Intervals hold the true value with 95 %, if the rest of the model is right. In words:"]
    head += [f"#   {word}" for word in study.words]
    head += [f"# {line}" for line in judgement(study)]
    return "\n".join([*head, *lines_of(data, comments)]) + "\n"


def _rewrite_vehicle(study: Study, data: dict[str, Any], comments: Comments) -> None:
    """Keys that are no wheel's: of [vehicle], [vehicle.motor], [ground] and [speed_controller]."""
    after = fitted_scene(study.scene, study.found).vehicle
    tables = {("vehicle",): data["vehicle"], ("vehicle", "motor"): data["vehicle"].get("motor", {})}
    if any(p.path.startswith("ground.") for p in study.found.parameters.each) and "ground" in after:
        data["vehicle"].pop("friction_coefficient", None)  # ground.friction_coefficient says it
        tables["ground",] = data.setdefault("ground", {})
        tables["ground",].update({key: after["ground"][key] for key in after["ground"] if not key.startswith("slope_")})
    _rewrite_places(study, data["vehicle"], after, comments)
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


def _that_move(study: Study) -> list[Parameter]:
    """The parameters by which parts of the robot are elsewhere."""
    return [p for p in study.found.parameters.each if p.group in ("distance", "place", "heading")]


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


def _rewrite(study: Study, index: int, wheel: dict[str, Any], comments: Comments) -> None:
    """The keys of one wheel that parameters have moved; the others stay as they were written."""
    before, after = (scene.vehicle["wheel"][index] for scene in (study.scene, fitted_scene(study.scene, study.found)))
    location = ("vehicle", "wheel", str(index))
    if after.get("radius_m") != before.get("radius_m"):
        wheel["radius_m"] = after["radius_m"]
        comments[(*location, "radius_m")] = _interval(study, f"vehicle.wheel[{index + 1}].radius_m")
    if after.get("friction_coefficient") != before.get("friction_coefficient"):
        wheel["friction_coefficient"] = after["friction_coefficient"]
        comments[(*location, "friction_coefficient")] = _interval(
            study, f"vehicle.wheel[{index + 1}].friction_coefficient")
    moved = _that_move(study)
    if (after["x_m"], after["y_m"]) != (before["x_m"], before["y_m"]):
        for key in ("distance_m", "bearing_rad", "bearing_deg"):
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
    return "turned with all wheels"


def interval_text(parameter: Parameter, value: float, half: float) -> str:
    """"radius of wheel 1: 0.0491 ± 0.0007 m, nominal 0.051"."""
    unit = f" {parameter.unit}" if parameter.unit else ""
    if parameter.group == "distance":
        return f"{parameter.name}: {value:.5g} ± {half:.2g} times the nominal ones"
    return f"{parameter.name}: {value:.5g} ± {half:.2g}{unit}, nominal {parameter.nominal:.5g}"
