"""What only FMUs of scenes with ground friction or limits of a drive have: their parameters, outputs, states.

The source has all of it. `for_vehicle` leaves out what a vehicle's start values do not need, so the FMU of a scene on
ideal ground keeps the variables and states of the ideal model.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from dataclasses import replace

from .description import Description, Unknown, Variable, as_double

COEFFICIENT = "ground_friction_coefficient"
DRIVE = ("supply_V", "current_limit_A", "motor_circuit")
"""Above 0: the wheels slip, or the drive has limits; as laconic_vehicle_has_friction() has it."""

PARAMETERS = (COEFFICIENT, "own_friction_coefficient", *DRIVE, "ground_roller_drag", "ground_axle_friction_Nm",
              "own_roller_drag", "own_axle_friction_Nm", "supply_resistance_ohm", "winding_resistance_ohm",
              "drive_viscous_friction_Nms", "start_wheel_speed_rad_per_s")
OUTPUTS = ("slip_along_m_per_s", "slip_across_m_per_s", "contact_state", "drive_limit", "motor_current_A",
           "supply_current_A", "supply_voltage_V", "supply_energy_J", "outer_work_J", "slip_loss_J", "axle_loss_J",
           "motor_loss_J", "supply_loss_J", "numerical_loss_J")
STATE_RATE = "der(wheel_speed_rad_per_s)"
"""The derivative that makes the wheel speeds states."""

EVERYTHING = None
Dependencies = Mapping[str, tuple[str, ...] | None]
OF_ROLLING: Dependencies = dict.fromkeys(
    ("wheel_torque_Nm", "wheel_reaction_N", "wheel_lateral_N", "no_slip_margin_N", "der(nu_rad_per_s)",
     "slip_along_m_per_s", "slip_across_m_per_s"), EVERYTHING)
"""What these depend on where a drive has limits: its supply couples all motors."""
OF_SLIPPING: Dependencies = {
    **OF_ROLLING,
    "slip_along_m_per_s": ("nu_rad_per_s", "wheel_speed_rad_per_s"),
    "slip_across_m_per_s": ("nu_rad_per_s", "wheel_speed_rad_per_s"),
    "wheel_speed_rad_per_s": ("wheel_speed_rad_per_s",),
    "der(wheel_angle_rad)": ("wheel_speed_rad_per_s",),
    "energy_J": ("nu_rad_per_s", "wheel_speed_rad_per_s"),
}
"""The same where wheel speeds are states of their own."""


def slips(description: Description) -> bool:
    """Whether a wheel of the described vehicle can slip."""
    return _above_0(description, (COEFFICIENT,))


def has_friction(description: Description) -> bool:
    """Whether the described vehicle is stepped by the friction step."""
    return slips(description) or _above_0(description, DRIVE)


def _above_0(description: Description, names: tuple[str, ...]) -> bool:
    given = [v for v in description.variables if v.name in names]
    return any(as_double(text) > 0.0 for v in given for text in v.start)


def for_vehicle(description: Description) -> Description:
    """The description without what its vehicle does not need."""
    if not any(v.name == COEFFICIENT for v in description.variables):
        return description  # of another model
    if slips(description):
        return _rebuilt(description, lambda v: True, OF_SLIPPING)
    if has_friction(description):
        return _rebuilt(description, lambda v: v.name != STATE_RATE, OF_ROLLING)
    extra = {*PARAMETERS, *OUTPUTS, STATE_RATE}
    return _rebuilt(description, lambda v: v.name not in extra, None)


def _rebuilt(description: Description, kept: Callable[[Variable], bool], depends: Dependencies | None) -> Description:
    """`depends`: what differs from the source's dependencies; None for ideal ground and motors."""
    variables = tuple(v for v in description.variables if kept(v))
    left = {v.reference for v in variables}
    unknowns = tuple(_depending(description, u, depends or {}) for u in description.unknowns if u.reference in left)
    root = ET.fromstring(ET.tostring(description.root))
    _shorten(root, {v.name for v in variables}, unknowns)
    if depends is not None:
        _forgo_derivatives(root)
    return replace(description, root=root, variables=variables, unknowns=unknowns)


def _depending(description: Description, unknown: Unknown, depends: Dependencies) -> Unknown:
    name = description.variables[unknown.reference].name
    if name not in depends:
        return unknown
    names = depends[name]
    if unknown.tag == "InitialUnknown" or names is EVERYTHING:
        return replace(unknown, dependencies=None, kinds=None)
    references = tuple(description.variable(each).reference for each in names)
    kind = "constant" if len(names) == 1 else "dependent"
    return replace(unknown, dependencies=references, kinds=(kind,) * len(names))


def _shorten(root: ET.Element, names: set[str], unknowns: tuple[Unknown, ...]) -> None:
    """Takes the other variables out, and writes the structure anew."""
    variables, structure = root.find("ModelVariables"), root.find("ModelStructure")
    assert variables is not None
    assert structure is not None
    for element in list(variables):
        if element.get("name") not in names:
            variables.remove(element)
    structure.clear()
    for unknown in unknowns:
        attributes = {"valueReference": str(unknown.reference)}
        if unknown.dependencies is not None:
            attributes["dependencies"] = " ".join(map(str, unknown.dependencies))
        if unknown.kinds is not None:
            attributes["dependenciesKind"] = " ".join(unknown.kinds)
        ET.SubElement(structure, unknown.tag, attributes)


def _forgo_derivatives(root: ET.Element) -> None:
    """Partial derivatives and derivatives of outputs are those of the ideal model only."""
    for tag in ("ModelExchange", "CoSimulation"):
        interface = root.find(tag)
        assert interface is not None
        for name in ("providesDirectionalDerivatives", "providesAdjointDerivatives", "maxOutputDerivativeOrder"):
            interface.attrib.pop(name, None)
