"""The file's numbers and the core's constants lead to one motion, whatever a vehicle has; the starts may differ."""

from __future__ import annotations

import pytest

from laconic.scene import read_scene
from laconic.simulation import simulate
from laconic.tools.enclosure.study import state_signals, study_of

BODY = """[vehicle]
mass_kg = 12.3
yaw_inertia_kgm2 = 0.41
com_x_m = 0.013
com_y_m = -0.021
wheel_radius_m = 0.07
wheel_inertia_kgm2 = 0.0013
"""
SHAFT = """[vehicle.motor]
resistance_ohm = 1.3
torque_constant_Nm_per_A = 0.037
back_emf_Vs_per_rad = 0.041
gear_ratio = 17.3
viscous_friction_Nms = 2.1e-5
rotor_inertia_kgm2 = 1.7e-5
"""
GAIN = "motor_gain_Nm_per_V = 0.31\nmotor_damping_Nms = 0.17\n"
PAYLOAD = """[vehicle.payload]
mass_kg = 3.1
x_m = 0.09
y_m = 0.04
yaw_inertia_kgm2 = 0.023
"""
THREE = "".join(f'[[vehicle.wheel]]\nkind = "omni"\ndistance_m = 0.2{i}\nbearing_deg = {bearing}\n'
                f"axle_deg = {bearing + 3}\n" for i, bearing in enumerate((17, 140, 261)))
ROLLERS = "".join(f'[[vehicle.wheel]]\nkind = "mecanum"\nx_m = {x}\ny_m = {y}\naxle_rad = -1.5707963267948966\n'
                  f"roller_deg = {45 if x * y > 0 else -45}\n" for x in (0.2, -0.2) for y in (0.17, -0.15))
PAIR = "".join(f'[[vehicle.wheel]]\nkind = "fixed"\nx_m = 0.01\ny_m = {y}\naxle_deg = -90\n' for y in (0.2, -0.2))
SLOPE = "[ground]\nslope_deg = 7.5\nslope_heading_deg = 30\n"
MOVING = "[initial]\nvelocity_body_m_per_s = [0.3, -0.2]\nyaw_rate_rad_per_s = 0.7\nx_m = 0.1\nheading_deg = 33\n"
VEHICLES = {
    "gain and damping": BODY + GAIN + THREE + MOVING,
    "motor at its shaft, payload": BODY + SHAFT + THREE + PAYLOAD + MOVING,
    "slope": BODY + GAIN + ROLLERS + SLOPE + MOVING,
    "wheels of their own": BODY + SHAFT + THREE + "radius_m = 0.05\ninertia_kgm2 = 0.0007\n" + MOVING,
    "motor of its own": BODY + GAIN + THREE + "motor_gain_Nm_per_V = 0.21\nmotor_damping_Nms = 0.4\n" + PAYLOAD,
    "a wheel without motor": BODY + SHAFT + THREE + "driven = false\n" + MOVING,
    "a locked wheel": BODY + GAIN + ROLLERS + "locked = true\n" + PAYLOAD + SLOPE,
    "fixed wheels": BODY + SHAFT + PAIR + PAYLOAD + SLOPE}
LOADS = (("voltage_V[1]", 2.3), ("voltage_V[2]", -1.1), ("axle_torque_Nm[2]", 0.13), ("body_force_N[1]", 0.9),
         ("body_force_N[2]", -1.7), ("body_moment_Nm", 0.3), ("world_force_N[1]", 1.9), ("world_force_N[2]", -0.8),
         ("world_force_point_m[1]", 0.11), ("world_force_point_m[2]", -0.07))
INPUTS = "".join(f'[[input]]\nsignal = "{signal}"\nkind = "steps"\nt_s = [0.0, 0.2]\nvalue = [{value}, {value / 3}]\n'
                 for signal, value in LOADS)


@pytest.mark.parametrize("name", VEHICLES)
def test_both_readings_of_a_vehicle_agree_to_rounding_and_the_core_with_them(name, tmp_path):
    path = tmp_path / "vehicle.toml"
    path.write_text(f"{VEHICLES[name]}{INPUTS}[run]\nduration_s = 0.5\nstep_s = 0.0005\n[outputs]\nevery_s = 0.25\n")
    scene = read_scene(path)
    study = study_of(simulate(scene, state_signals(scene.wheel_count)), shown=False)
    for found in (study.of_file, study.of_core):
        assert found.width < 1e-20
        assert max(kind.error for kind in found.kinds()) < 1e-11
    for one, other in zip(study.of_file.end.row(), study.of_core.end.row(), strict=True):
        assert float(abs(one - other).upper()) < 1e-13 * max(1.0, abs(float(one)))
