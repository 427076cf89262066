"""What each PARAMETER means: its unit, whether it is a number or an integer, and when it must come.

Field in the DBC → (key in a scene file, unit, item, required). The test test_wire_page.py holds `required` against the
node itself.
"""

from __future__ import annotations

ALWAYS, NEVER = "always", ""
WHEELS, MOTOR, PAYLOAD = "with wheels", "with the other of the motor", "with any of the payload"
EACH_WHEEL, EACH_SUPPORT = "each wheel", "each support"
RESERVED = "not yet: NOT_SUPPORTED"
NONE, WHEEL, SUPPORT, COMPONENT = "0", "wheel", "support", "1, 2, 3"

PARAMETERS = {
    "MASS": ("vehicle.mass_kg", "kg", NONE, ALWAYS),
    "YAW_INERTIA": ("vehicle.yaw_inertia_kgm2", "kg m²", NONE, ALWAYS),
    "COM_X": ("vehicle.com_x_m", "m", NONE, NEVER),
    "COM_Y": ("vehicle.com_y_m", "m", NONE, NEVER),
    "COM_Z": ("vehicle.com_z_m", "m", NONE, NEVER),
    "WHEEL_RADIUS": ("vehicle.wheel_radius_m", "m", NONE, ALWAYS),
    "WHEEL_INERTIA": ("vehicle.wheel_inertia_kgm2", "kg m²", NONE, WHEELS),
    "MOTOR_GAIN": ("vehicle.motor_gain_Nm_per_V", "N m/V", NONE, MOTOR),
    "MOTOR_DAMPING": ("vehicle.motor_damping_Nms", "N m s", NONE, MOTOR),
    "FRICTION_COEFFICIENT": ("vehicle.friction_coefficient", "1", NONE, NEVER),
    "PAYLOAD_MASS": ("vehicle.payload.mass_kg", "kg", NONE, PAYLOAD),
    "PAYLOAD_X": ("vehicle.payload.x_m", "m", NONE, PAYLOAD),
    "PAYLOAD_Y": ("vehicle.payload.y_m", "m", NONE, PAYLOAD),
    "PAYLOAD_YAW_INERTIA": ("vehicle.payload.yaw_inertia_kgm2", "kg m²", NONE, PAYLOAD),
    "WHEEL_COUNT": ("how many [[vehicle.wheel]]", "integer", NONE, ALWAYS),
    "WHEEL_KIND": ("wheel.kind: 1 rollers (omni, mecanum), 2 fixed", "integer", WHEEL, EACH_WHEEL),
    "WHEEL_X": ("wheel.x_m", "m", WHEEL, EACH_WHEEL),
    "WHEEL_Y": ("wheel.y_m", "m", WHEEL, EACH_WHEEL),
    "AXLE": ("wheel.axle_rad", "rad", WHEEL, EACH_WHEEL),
    "ROLLER": ("wheel.roller_rad", "rad", WHEEL, "each wheel of kind 1"),
    "WHEEL_LOCKED": ("wheel.locked: 0 or 1", "integer", WHEEL, NEVER),
    "SUPPORT_COUNT": ("how many [[vehicle.support]]", "integer", NONE, "with any support"),
    "SUPPORT_X": ("support.x_m", "m", SUPPORT, EACH_SUPPORT),
    "SUPPORT_Y": ("support.y_m", "m", SUPPORT, EACH_SUPPORT),
    "START_NU": ("initial.nu_rad_per_s", "rad/s", COMPONENT, NEVER),
    "START_X": ("initial.x_m", "m", NONE, NEVER),
    "START_Y": ("initial.y_m", "m", NONE, NEVER),
    "START_HEADING": ("initial.heading_rad", "rad", NONE, NEVER),
    "METHOD": ("run.method: see below", "integer", NONE, NEVER),
    "STEP": ("run.step_s", "s", NONE, ALWAYS),
    "RESISTANCE": ("vehicle.motor.resistance_ohm", "Ω", NONE, RESERVED),
    "TORQUE_CONSTANT": ("vehicle.motor.torque_constant_Nm_per_A", "N m/A", NONE, RESERVED),
    "BACK_EMF": ("vehicle.motor.back_emf_Vs_per_rad", "V s/rad", NONE, RESERVED),
    "GEAR_RATIO": ("vehicle.motor.gear_ratio", "1", NONE, RESERVED),
    "VISCOUS_FRICTION": ("vehicle.motor.viscous_friction_Nms", "N m s", NONE, RESERVED),
    "ROTOR_INERTIA": ("vehicle.motor.rotor_inertia_kgm2", "kg m²", NONE, RESERVED),
    "OWN_RADIUS": ("a wheel's own radius_m", "m", WHEEL, RESERVED),
    "OWN_INERTIA": ("a wheel's own inertia_kgm2", "kg m²", WHEEL, RESERVED),
    "OWN_MOTOR_GAIN": ("a wheel's own motor_gain_Nm_per_V", "N m/V", WHEEL, RESERVED),
    "OWN_MOTOR_DAMPING": ("a wheel's own motor_damping_Nms", "N m s", WHEEL, RESERVED),
    "DRIVEN": ("a wheel has a motor: 0 or 1", "integer", WHEEL, RESERVED),
    "WHEEL_FRICTION_COEFFICIENT": ("a wheel's own friction_coefficient", "1", WHEEL, RESERVED),
    "WHEEL_ROLLER_DRAG": ("a wheel's own roller_drag", "1", WHEEL, RESERVED),
    "WHEEL_AXLE_FRICTION": ("a wheel's own axle_friction_Nm", "N m", WHEEL, RESERVED),
    "GROUND_FRICTION_COEFFICIENT": ("the ground's friction_coefficient", "1", NONE, RESERVED),
    "GROUND_ROLLER_DRAG": ("the ground's roller_drag", "1", NONE, RESERVED),
    "GROUND_AXLE_FRICTION": ("the ground's axle_friction_Nm", "N m", NONE, RESERVED),
    "SLOPE": ("the ground's slope_rad", "rad", NONE, RESERVED),
    "SLOPE_HEADING": ("the ground's slope_heading_rad, of steepest ascent", "rad", NONE, RESERVED),
    "SUPPLY_VOLTAGE": ("the drive's supply_V", "V", NONE, RESERVED),
    "SUPPLY_RESISTANCE": ("the drive's supply_resistance_ohm", "Ω", NONE, RESERVED),
    "CURRENT_LIMIT": ("the drive's current_limit_A", "A", NONE, RESERVED),
    "START_WHEEL_SPEED": ("a wheel's speed at the start", "rad/s", WHEEL, RESERVED),
}
