"""What only FMUs of scenes with ground friction or limits of a drive have: their parameters, outputs, states.

The source has all of it. `for_vehicle` leaves out what a vehicle's start values do not need, so the FMU of a scene on
ideal ground keeps the variables and states of the ideal model.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

from .description import Description
from .reduced import EVERYTHING, Dependencies, is_above_0, reduced

COEFFICIENT = "ground_friction_coefficient"
DRIVE = ("supply_V", "current_limit_A", "motor_circuit")
"""Above 0: the wheels slip, or the drive has limits; as laconic_vehicle_has_friction() has it."""

PARAMETERS = (COEFFICIENT, "own_friction_coefficient", *DRIVE, "ground_roller_drag", "ground_axle_friction_Nm",
              "own_roller_drag", "own_axle_friction_Nm", "supply_resistance_ohm", "winding_resistance_ohm",
              "drive_viscous_friction_Nms", "start_wheel_speed_rad_per_s")
OUTPUTS = ("slip_along_m_per_s", "slip_across_m_per_s", "contact_state", "drive_limit", "motor_current_A",
           "supply_current_A", "supply_voltage_V", "supply_energy_J", "outer_work_J", "slip_loss_J", "axle_loss_J",
           "motor_loss_J", "supply_loss_J", "numerical_loss_J")
OF_RIGID = "nu_rad_per_s"
"""A variable of vehicles without hinges."""
STATE_RATE = "der(wheel_speed_rad_per_s)"
"""The derivative that makes the wheel speeds states."""

OF_ROLLING: Dependencies = dict.fromkeys(
    ("wheel_torque_Nm", "wheel_reaction_N", "wheel_lateral_N", "wheel_load_N", "support_load_N", "no_slip_margin_N",
     "der(nu_rad_per_s)",
     "acceleration_body_m_per_s2", "slip_along_m_per_s", "slip_across_m_per_s"), EVERYTHING)
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
    return is_above_0(description, (COEFFICIENT,))


def has_friction(description: Description) -> bool:
    """Whether the described vehicle is stepped by the friction step."""
    return slips(description) or is_above_0(description, DRIVE)


def for_vehicle(description: Description) -> Description:
    """The description without what its vehicle does not need."""
    if not {COEFFICIENT, OF_RIGID} <= {v.name for v in description.variables}:
        return description  # of another model
    if slips(description):
        return _without_derivatives(reduced(description, lambda v: True, OF_SLIPPING))
    if has_friction(description):
        return _without_derivatives(reduced(description, lambda v: v.name != STATE_RATE, OF_ROLLING))
    extra = {*PARAMETERS, *OUTPUTS, STATE_RATE}
    return reduced(description, lambda v: v.name not in extra)


def _without_derivatives(description: Description) -> Description:
    """Partial derivatives and derivatives of outputs are those of the ideal model only."""
    root = deepcopy(description.root)
    for tag in ("ModelExchange", "CoSimulation"):
        for interface in root.findall(tag):
            for name in ("providesDirectionalDerivatives", "providesAdjointDerivatives", "maxOutputDerivativeOrder"):
                interface.attrib.pop(name, None)
    return replace(description, root=root)
