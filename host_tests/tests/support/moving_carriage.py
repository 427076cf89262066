"""A scene of three omni wheels that moves at its start, without inputs and run."""

MOVING_CARRIAGE = """
[vehicle]
mass_kg = 10.0
yaw_inertia_kgm2 = 0.3
com_x_m = 0.03
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.002
motor_gain_Nm_per_V = 0.5
motor_damping_Nms = 0.05
wheel = [
    {kind = "omni", x_m = 0.2, y_m = 0.0, axle_deg = 0.0},
    {kind = "omni", x_m = -0.1, y_m = 0.17, axle_deg = 120.0},
    {kind = "omni", x_m = -0.1, y_m = -0.17, axle_deg = 240.0},
]
[initial]
nu_rad_per_s = [10.0, -5.0, 20.0]
"""
