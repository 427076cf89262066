"""The icon of a vehicle's FMU, and its page of documentation with the vehicle's name and numbers."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from html import escape

from .description import Description, Variable, as_double
from .icon import icon_png, icon_svg

PAGE = "documentation/index.html"
VEHICLE_MARK = "<!-- the vehicle of a scene -->"
"""The comment in the template that the vehicle's part replaces."""
SUPPORTS = ("support_x_m", "support_y_m")
WHEEL_COLUMNS = ("wheel_kind", "wheel_body", "wheel_x_m", "wheel_y_m", "axle_rad", "roller_rad", "wheel_locked")
OWN_COLUMNS = ("wheel_undriven", "own_radius_m", "own_inertia_kgm2", "own_motor_gain_Nm_per_V",
               "own_motor_damping_Nms", "motor_circuit", "own_friction_coefficient", "own_roller_drag",
               "own_axle_friction_Nm", "start_wheel_speed_rad_per_s", "encoder_counts_per_turn", "encoder_gear_ratio")
"""Shown only where a wheel has a value of its own."""
COMMON = {"own_radius_m": "wheel_radius_m", "own_inertia_kgm2": "wheel_inertia_kgm2",
          "own_motor_gain_Nm_per_V": "motor_gain_Nm_per_V", "own_motor_damping_Nms": "motor_damping_Nms",
          "own_friction_coefficient": "ground_friction_coefficient", "own_roller_drag": "ground_roller_drag",
          "own_axle_friction_Nm": "ground_axle_friction_Nm"}
"""The variable that a wheel follows where its own value is 0."""


def vehicle_parts(parts: Mapping[str, bytes], description: Description, version: int) -> dict[str, bytes]:
    """Icon and page of a vehicle's FMU, by their names in the archive. `parts`: the generic FMU's."""
    values = _in_one_frame({v.name: [as_double(text) for text in v.start] for v in description.variables})
    name = description.root.get("modelName", "")
    drawing = icon_svg(values, name)
    page = _page(parts[PAGE].decode("utf-8"), description, drawing).encode("utf-8")
    if version == 2:
        return {PAGE: page, "model.png": icon_png(values)}
    return {PAGE: page, "terminalsAndIcons/icon.png": icon_png(values),
            "terminalsAndIcons/icon.svg": drawing.encode("utf-8")}


def _in_one_frame(values: dict[str, list[float]]) -> dict[str, list[float]]:
    """Wheels on bodies with hinges in the frame of the carriage, with all hinges at the angle 0."""
    hinges = list(zip(values.get("body_parent", ()), values.get("body_hinge_x_m", ()), values.get("body_hinge_y_m", ()),
                      strict=True))
    places = [(0.0, 0.0)]
    for parent, x, y in hinges:
        places.append((places[int(parent)][0] + x, places[int(parent)][1] + y))
    bodies = [int(body) for body in values.get("wheel_body", ())]
    moved = {f"wheel_{axis}_m": [value + places[body][k] for value, body in
                                 zip(values[f"wheel_{axis}_m"], bodies, strict=True)]
             for k, axis in enumerate("xy") if bodies}
    return values | moved


def _page(template: str, description: Description, drawing: str) -> str:
    """The generic page under the vehicle's own name and numbers."""
    name, text = (escape(description.root.get(key, "")) for key in ("modelName", "description"))
    own = f'<p>{text}.</p>\n<p style="text-align:center">{drawing.strip()}</p>\n{_tables(description)}'
    for old, new in (("<title>Laconic: dynamics of wheeled robots</title>", f"<title>{name}</title>"),
                     ("<h1>Laconic</h1>", f"<h1>{name}</h1>"), (VEHICLE_MARK, own)):
        if template.count(old) != 1:
            raise ValueError(f"{PAGE}: {old} must occur exactly once")
        template = template.replace(old, new)
    return template


def _tables(description: Description) -> str:
    units = _units(description.root)
    plain = [v for v in description.variables
             if v.causality == "parameter" and v.name not in (*WHEEL_COLUMNS, *OWN_COLUMNS, *SUPPORTS)]
    rows = "".join(f"<tr><th><code>{escape(v.name)}</code></th><td>{_values(description, v)}"
                   f"{_unit(units, v)}</td><td>{escape(v.description)}</td></tr>\n" for v in plain)
    return f'<h2>Its numbers</h2>\n<table class="wide">\n{rows}</table>\n{_wheels(description)}{_supports(description)}'


def _wheels(description: Description) -> str:
    columns = [v for name in (*WHEEL_COLUMNS, *OWN_COLUMNS) for v in description.variables if v.name == name]
    columns = [v for v in columns if v.name in WHEEL_COLUMNS or any(as_double(text) for text in v.start)]
    count = description.array_size
    if count == 0:
        return "<p>It has no wheels.</p>\n"
    head = "".join(f"<th><code>{v.name}</code></th>" for v in columns)
    cells = ("".join(f"<td>{_value(description, v, i)}</td>" for v in columns) for i in range(count))
    rows = "".join(f"<tr><th>{i}</th>{row}</tr>\n" for i, row in enumerate(cells, start=1))
    table = f"<table>\n<tr><th></th>{head}</tr>\n{rows}</table>"
    return f"<h2>Its wheels</h2>\n<div style='overflow-x:auto'>{table}</div>\n{_without_effect(columns)}"


def _without_effect(columns: list[Variable]) -> str:
    """Names the variables of the vehicle that no wheel follows. (The radius stays the unit of ν.)"""
    idle = [COMMON[v.name] for v in columns
            if v.name in COMMON and v.name != "own_radius_m" and all(as_double(text) for text in v.start)]
    names = ", ".join(f"<code>{name}</code>" for name in idle)
    return (f"<p>Every wheel has a value of its own, so these have no effect before it is set to 0: {names}.</p>\n"
            if idle else "")


def _supports(description: Description) -> str:
    count = int(description.variable("support_count").start[0])
    x, y = (description.variable(name).start for name in SUPPORTS)
    positions = ", ".join(f"({float(x[i]):.6g}, {float(y[i]):.6g})" for i in range(count))
    return f"<p>Ball casters at {positions} m.</p>\n" if count else ""


def _values(description: Description, variable: Variable) -> str:
    return ", ".join(_value(description, variable, i) for i in range(len(variable.start)))


def _value(description: Description, variable: Variable, element: int) -> str:
    """A start value for readers: the name of an enumeration's item, six digits of a number."""
    text = variable.start[element]
    if variable.tag == "Enumeration":
        return escape(description.items(variable)[int(text)][0])
    return f"{float(text):.6g}" if variable.tag == "Float64" else text


def _units(root: ET.Element) -> dict[str, str]:
    return {kind.get("name", ""): kind.get("unit", "") for kind in root.iter("Float64Type")}


def _unit(units: Mapping[str, str], variable: Variable) -> str:
    unit = units.get(variable.attributes.get("declaredType", ""), "")
    return f" {escape(unit)}" if unit else ""
