"""Vehicles with hinges whose wheels slip: their description, from that of all vehicles with hinges.

One source has all variables. `without_slip` gives the vehicle on ideal ground; `of_slipping` gives the other, for
Co-Simulation alone: with friction an instant has no accelerations from which a solver could step.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

from .description import Description, parse
from .reduced import reduced, without_model_exchange

FIRST = "ground_friction_coefficient"
"""The first variable that only such vehicles have."""
IDEAL_STATE = "carriage_zeta"
"""A variable of ideal ground, by which a description of that vehicle is known."""
IDEAL = (IDEAL_STATE, "own_yaw_rate_rad_per_s", "friction_coefficient", "hinge_is_ball", "method",
         "steering_acceleration_rad_per_s2", "steering_twist", "steering_twist_rate", "hinge_force_along_N",
         "hinge_force_across_N", "no_slip_margin_N")
"""What else they do not have; nor derivatives."""
UNITS = ("N.m/rad", "V/rad", "V.s/rad", "Ohm", "A")
STARTS = {FIRST: "0.8"}
TEXTS = {
    "steering_rate_rad_per_s": "Rate of each prescribed hinge, and the target rate of each servo or loop",
    "hinge_torque_Nm": "Torque on the body of each hinge that is not prescribed, the opposite on its parent",
    "start_velocity_m_per_s": "Initial velocity of the carriage's centre of mass, body axes",
    "start_hinge_rad": "Initial angle of each hinge",
    "start_hinge_rate_rad_per_s": "Initial rate of each hinge",
    "wheel_torque_Nm": "Torque of the motor on each axle in the last internal step",
    "wheel_reaction_N": "Force of the ground on each wheel along its roller axis in the last internal step; fixed "
                        "wheels: along the rolling direction",
    "wheel_lateral_N": "Force of the ground on each wheel 90 degrees to the right of its roller axis in the last "
                       "internal step",
    "hinge_reaction_Nm": "Torque of servo, motor or prescribed rate on the body of each hinge in the last internal "
                         "step",
    "wheel_load_N": "Normal load of each wheel, by statics with the ground's forces of the internal step before; below "
                    "0 it has lifted and carries nothing",
    "support_load_N": "Normal load of each support, as of the wheels"}


def without_slip(description: Description) -> Description:
    """The description of a vehicle with hinges on ideal ground; that of another model stays."""
    if IDEAL_STATE not in (names := [v.name for v in description.variables]) or FIRST not in names:
        return description
    first = description.variable(FIRST).reference
    found = reduced(description, lambda v: v.reference < first)
    for group in ("UnitDefinitions", "TypeDefinitions"):
        part = found.root.find(group)
        assert part is not None
        for each in [each for each in part if (each.get("unit") or each.get("name")) in UNITS]:
            part.remove(each)
    return found


def of_slipping(description: Description) -> Description:
    """The description of a vehicle with hinges on ground with friction. An input acts on outputs only by a step."""
    kept = without_model_exchange(reduced(description, lambda v: v.name not in IDEAL
                                          and "derivative" not in v.attributes))
    root = kept.root
    root.set("modelName", "LaconicSlipping")
    root.set("description", "Dynamics of articulated vehicles whose wheels slip: trailers, swerves, casters on ground "
                            "with friction")
    for each in root.find("ModelVariables") or ():
        name = each.get("name", "")
        each.attrib |= {"description": TEXTS.get(name, each.get("description", ""))}
        each.attrib |= {"start": STARTS[name]} if name in STARTS else {}
    kinds = root.find("TypeDefinitions")
    if kinds is not None and (unread := kinds.find("EnumerationType[@name='ArticulatedMethod']")) is not None:
        kinds.remove(unread)
    _renumber(root, {v.reference: number for number, v in enumerate(kept.variables)})
    return parse(ET.tostring(root, encoding="unicode"))


def _renumber(root: ET.Element, numbers: dict[int, int]) -> None:
    """Value references 0, 1, 2 … in the order that the variables have."""
    for part in ("ModelVariables", "ModelStructure"):
        for each in root.iterfind(f"{part}//*[@valueReference]"):
            each.set("valueReference", str(numbers[int(each.get("valueReference", ""))]))
            each.attrib.pop("dependenciesKind", None)
            if part == "ModelStructure":
                each.attrib.pop("dependencies", None)
            if each.tag == "Output":
                each.set("dependencies", "")
