"""Ranges and words of `laconic analyse` are those of a vehicle: speeds that it can reach, in m/s beside rad/s."""

import json

import numpy as np
import pytest

from laconic.cli import main as cli
from laconic.scene import read_scene
from laconic.tools.analyse.findings import StudyOptions
from laconic.tools.analyse.from_core import subject_of
from laconic.tools.analyse.motions import command_parameter, default_range, vehicle_parameter
from laconic.tools.analyse.reach import HEADROOM, largest_nu
from laconic.tools.analyse.study import study
from scene_text import constant, wheel

MECANUM = [(0.319, 0.2755, 45), (0.319, -0.2755, -45), (-0.319, 0.2755, -45), (-0.319, -0.2755, 45)]
ROLL_M, VOLTS = 0.0759, 12.0
SPEED = VOLTS / (0.06 * 20.0)  # of a wheel whose motor balances its own back-EMF [rad/s]


@pytest.fixture
def base(tmp_path):
    """A mecanum base of 135 kg with strong motors, that drives ahead."""
    wheels = "".join(wheel("mecanum", x, y, axle_deg=-90.0, roller_deg=g) for x, y, g in MECANUM)
    inputs = "".join(constant(f"voltage_V[{i}]", VOLTS) for i in range(1, 5))
    path = tmp_path / "base.toml"
    path.write_text(f"""name = "base"
source = "numbers of this test"
[vehicle]
mass_kg = 135.0
yaw_inertia_kgm2 = 14.3
com_x_m = 0.03
wheel_radius_m = {ROLL_M}
wheel_inertia_kgm2 = 0.04
[vehicle.motor]
resistance_ohm = 0.3
torque_constant_Nm_per_A = 0.06
back_emf_Vs_per_rad = 0.06
gear_ratio = 20.0
viscous_friction_Nms = 0.0
rotor_inertia_kgm2 = 0.0
{wheels}{inputs}[run]
duration_s = 2.0
step_s = 0.001
""")
    return path


def test_a_bases_bifurcation_range_is_what_its_motors_reach_and_not_kilometres_a_second(base, capsys):
    assert cli.run(["analyse", str(base), "--only", "bifurcation", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["bifurcation"]
    assert found["reach_rad_per_s"] == pytest.approx(HEADROOM * SPEED, rel=1e-6)
    assert (found["from"], found["to"]) == pytest.approx((-HEADROOM * SPEED, HEADROOM * SPEED), rel=1e-6)
    assert found["to_m_per_s"] == pytest.approx(ROLL_M * found["to"])
    assert abs(found["straight_thresholds"][0]) > 100.0 * found["to"]  # it exists, and stays in the numbers


def test_a_change_of_stability_out_of_reach_is_reported_with_its_speed_and_not_drawn(base, capsys):
    assert cli.run(["analyse", str(base), "--only", "bifurcation"]) == 0
    out = capsys.readouterr().out
    assert "out of reach" in out
    assert " m/s)" in out
    assert "Fold" not in out


def test_steady_and_free_motions_are_reported_in_metres_a_second_too(base):
    found = study(subject_of(read_scene(base)), StudyOptions(("steady", "free")), lambda *_: None)
    assert any(f"({ROLL_M * SPEED:.4g}, 0) m/s" in words for words in found.words["steady"])
    assert all("m/s" in words[0] for words in found.words.values())


def test_reach_counts_every_input_at_its_largest_whatever_its_kind_and_sign():
    subject = subject_of(read_scene("s1"))
    field = subject.field({"voltage_V[1]": 2.0})
    expected = np.abs(field.nu(field.forcing / field.decay_per_s))
    for name, value in (("voltage_V[2]", 2.0), ("voltage_V[3]", 1.0)):
        field = subject.field({name: value})
        expected += np.abs(field.nu(field.forcing / field.decay_per_s))
    assert largest_nu(subject) == pytest.approx(expected)


def test_a_straight_motion_that_the_user_gives_is_always_within_the_range():
    subject = subject_of(read_scene("turtlebot3_burger"))
    low, high = default_range(command_parameter(subject, "nu1", np.array([500.0, 0.0, 0.0])))
    assert low < 0.0 < 500.0 < high <= HEADROOM * 500.0


def test_the_centre_of_mass_is_varied_within_the_vehicle():
    subject = subject_of(read_scene("turtlebot3_burger"))
    low, high = default_range(vehicle_parameter(subject, "com_y_m"))
    assert max(abs(low), abs(high)) < 0.08  # half the track
