"""Geometry diagnosis and traction: rank, yaw authority, wheels in the wrong diagonal, loads, reactions, first slip."""

import numpy as np
import pytest

import friction_scenes
from laconic.scene import read_scene, rigid_scene_names
from laconic.simulation import advance_plant
from laconic.tools.analyse.from_core import rolling_subject, subject_of
from laconic.tools.analyse.geometry import diagnose
from laconic.tools.analyse.traction import static_normal_loads, study
from scene_text import constant, table, wheel

HALF = np.pi / 4


def scene_with(tmp_path, vehicle: str, rest: str = ""):
    path = tmp_path / "scene.toml"
    path.write_text(f"name = 'test'\nsource = 'made up'\n[vehicle]\n{vehicle}\n"
                    f"[run]\nduration_s = 1.0\nstep_s = 0.001\n{rest}")
    return subject_of(read_scene(path))


BODY = """mass_kg = 12.0
yaw_inertia_kgm2 = 0.4
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.003
"""


def mecanum(long_m, wide_m, sign):
    """Four wheels; sign +1 as in `mecanum4` of the reference data, −1 every roller the other way."""
    corners = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    return "".join(wheel("mecanum", x * long_m, y * wide_m, axle_deg=-90.0, roller_deg=45.0 * g * sign)
                   for x, y, g in corners)


def wheels(kind, *mounted):
    return "".join(wheel(kind, x, y, axle_rad=a) for x, y, a in mounted)


def test_mecanum_wheels_mounted_right_have_full_rank_and_good_yaw_authority(tmp_path):
    found = diagnose(scene_with(tmp_path, BODY + mecanum(0.2, 0.15, 1)))
    assert (found.rank, found.dof) == (3, 3)
    assert found.yaw_authority == pytest.approx(0.35 / 0.25, rel=1e-12)
    assert not any("wrong diagonal" in sentence for sentence in found.words)


def test_mecanum_wheels_in_the_wrong_diagonal_are_found_by_yaw_authority_not_by_rank(tmp_path):
    found = diagnose(scene_with(tmp_path, BODY + mecanum(0.2, 0.15, -1)))
    assert (found.rank, found.dof) == (3, 3)
    assert found.yaw_authority == pytest.approx(0.05 / 0.25, rel=1e-12)
    assert found.mirrored_yaw_authority == pytest.approx(0.35 / 0.25, rel=1e-12)
    assert any("wrong diagonal" in sentence for sentence in found.words)


def test_wrong_diagonal_in_a_square_loses_the_rank_too_and_names_the_turn(tmp_path):
    found = diagnose(scene_with(tmp_path, BODY + mecanum(0.2, 0.2, -1)))
    assert found.rank == 2
    assert found.not_driven == ["turning about the centre of mass"]
    assert any("wrong diagonal" in sentence for sentence in found.words)


def test_yaw_authority_does_not_depend_on_where_the_centre_of_mass_is(tmp_path):
    values = [diagnose(scene_with(tmp_path, BODY + f"com_x_m = {x}\n" + mecanum(0.2, 0.15, -1))).yaw_authority
              for x in (0.0, 0.1, -0.3)]
    assert values == pytest.approx([0.2] * 3, rel=1e-9)


def test_two_parallel_omni_wheels_do_not_drive_sideways_motion(tmp_path):
    found = diagnose(scene_with(tmp_path, BODY + wheels("omni", (0.0, 0.2, -np.pi / 2), (0.0, -0.2, -np.pi / 2))))
    assert (found.rank, found.dof) == (2, 3)
    assert found.not_driven == ["moving straight along y"]


def test_single_wheel_leaves_out_a_turn_about_its_own_middle(tmp_path):
    found = diagnose(scene_with(tmp_path, BODY + wheels("omni", (0.3, 0.1, -np.pi / 2))))
    assert found.rank == 1
    assert len(found.not_driven) == 2


def test_near_parallel_rollers_are_called_lopsided(tmp_path):
    three = wheels("omni", (0.2, 0.0, 0.0), (-0.2, 0.1, np.pi), (0.0, 0.2, 0.004))
    found = diagnose(scene_with(tmp_path, BODY + three))
    assert found.rank == 3
    assert found.condition > 100.0
    assert any("lopsided" in sentence for sentence in found.words)


def test_fixed_wheels_are_reported_with_the_motion_that_the_constraints_leave(tmp_path):
    two = BODY + wheels("fixed", (0.0, 0.2, -np.pi / 2), (0.0, -0.2, -np.pi / 2))
    found = diagnose(scene_with(tmp_path, two))
    assert found.dof == 2
    assert "moving straight along x" in found.words[0]
    assert "turning about" in found.words[0]


def test_a_vehicle_without_wheels_is_reported_in_words(tmp_path):
    found = diagnose(scene_with(tmp_path, BODY))
    assert (found.rank, found.dof) == (0, 3)
    assert any("no wheels" in sentence for sentence in found.words)


# ---- traction

THREE = wheels("omni", (0.2, 0.0, 0.0), (-0.1, 0.15, 2.0), (-0.1, -0.15, -2.0))


def test_normal_loads_of_three_wheels_are_those_of_statics(tmp_path):
    subject = scene_with(tmp_path, BODY + "com_x_m = 0.03\ncom_y_m = 0.02\n" + THREE)
    loads, hold = static_normal_loads(subject)
    places = np.array([[0.2, 0.0], [-0.1, 0.15], [-0.1, -0.15]])
    weight = 12.0 * 9.80665
    assert hold
    balance = np.vstack([np.ones(3), places.T])
    assert loads == pytest.approx(np.linalg.solve(balance, weight * np.array([1.0, 0.03, 0.02])))


def test_normal_loads_of_four_wheels_are_the_least_squares_share(tmp_path):
    subject = scene_with(tmp_path, BODY + "com_x_m = 0.05\n" + mecanum(0.2, 0.15, 1))
    loads, hold = static_normal_loads(subject)
    places = np.array([[0.2, 0.15], [0.2, -0.15], [-0.2, 0.15], [-0.2, -0.15]])
    balance = np.vstack([np.ones(4), places.T])
    weight = 12.0 * 9.80665
    assert hold
    assert loads == pytest.approx(np.linalg.pinv(balance) @ (weight * np.array([1.0, 0.05, 0.0])))


def test_wheels_in_a_line_cannot_hold_the_body_and_this_is_reported(tmp_path):
    subject = scene_with(tmp_path, BODY + wheels("fixed", (0.0, 0.2, -np.pi / 2), (0.0, -0.2, -np.pi / 2)))
    assert not static_normal_loads(subject)[1]
    assert any("cannot hold the body upright" in sentence for sentence in study(subject).words)


PUSH = (table("[[input]]", signal="body_force_N[1]", kind="table", t_s=[0.0, 1.0], value=[0.0, 60.0])
        + table("[[input]]", signal="body_moment_Nm", kind="sine", amplitude=0.8, frequency_Hz=3.0)
        + table("[[input]]", signal="world_force_N[2]", kind="steps", t_s=[0.0, 0.4], value=[3.0, -5.0])
        + constant("world_force_point_m[1]", 0.12))
MOTORS = "motor_gain_Nm_per_V = 0.4\nmotor_damping_Nms = 0.02\nfriction_coefficient = 0.5\ncom_z_m = 0.05\n"
LOCKED = mecanum(0.2, 0.15, 1).replace("roller_deg = 45.0", "roller_deg = 45.0\nlocked = true", 1)
MIXED = wheels("fixed", (0.0, 0.2, -np.pi / 2), (0.0, -0.2, -np.pi / 2)) + wheels("omni", (0.2, 0.0, 0.4))
MIXED_LOCKED = MIXED.replace("axle_rad = 0.4", "axle_rad = 0.4\nlocked = true")
CASES = {"rollers": mecanum(0.2, 0.15, 1), "locked": LOCKED, "fixed": MIXED, "fixed and locked": MIXED_LOCKED}


@pytest.mark.parametrize("layout", CASES.values(), ids=CASES.keys())
def test_reactions_balance_forces_and_the_moment_locked_and_fixed_wheels_included(tmp_path, layout):
    offset = "com_x_m = 0.02\ncom_y_m = -0.01\n"
    voltage = '[[input]]\nsignal = "voltage_V[2]"\nkind = "sine"\namplitude = 6.0\nfrequency_Hz = 2.0\n'
    found = study(scene_with(tmp_path, BODY + MOTORS + offset + layout, PUSH + voltage))
    scale = float(np.abs(found.along_N).max())
    assert scale > 1.0
    assert found.balance_N < 1e-12 * scale * 10
    assert found.balance_Nm < 1e-12 * scale * 10


def test_balance_notices_a_missing_force(tmp_path, monkeypatch):
    from laconic.tools.analyse import traction

    monkeypatch.setattr(traction, "outer_wrench", lambda inputs, heading: (np.zeros(2), 0.0))
    assert study(scene_with(tmp_path, BODY + MOTORS + MIXED, PUSH)).balance_N > 1.0


def test_first_slip_is_the_first_step_at_which_a_reaction_leaves_the_friction_cone(tmp_path):
    """A force along x that grows evenly on locked-free omni wheels: reactions grow with it; checked step by step."""
    subject = scene_with(tmp_path, BODY + MOTORS + mecanum(0.2, 0.15, 1), PUSH.replace("60.0", "4000.0"))
    found = study(subject)
    plant, inputs = subject.scene.plant(subject.core), subject.scene.inputs_on_grid()
    for tick in range(inputs.steps):
        held = subject.core.input(inputs.held_at(tick))
        if plant.reactions(held).no_slip_margin_N < 0.0:
            break
        advance_plant(plant, inputs, tick, 1)
    assert 0 < tick < 999
    assert found.first_slip_s == pytest.approx(tick * 0.001, abs=1e-9)
    assert found.slipping_wheels


def test_lifting_wheel_is_named(tmp_path):
    """A tall body that brakes hard lifts its rear wheel."""
    tall = BODY + MOTORS.replace("com_z_m = 0.05", "com_z_m = 0.6") + THREE
    found = study(scene_with(tmp_path, tall, constant("voltage_V[2]", 40.0) + constant("voltage_V[3]", -40.0)))
    assert found.lifting
    assert any("would lift off" in sentence for sentence in found.words)


def test_shared_lateral_force_is_reported_as_split(tmp_path):
    found = study(scene_with(tmp_path, BODY + MIXED))
    assert any("only the sum of their lateral forces" in sentence for sentence in found.words)


@pytest.mark.parametrize("name", rigid_scene_names())
def test_every_scene_without_hinges_gets_a_diagnosis_without_a_false_alarm(name):
    found = diagnose(subject_of(read_scene(name)))
    assert found.words
    assert not any("wrong diagonal" in sentence for sentence in found.words)


def test_the_geometry_of_a_robot_does_not_depend_on_ground_and_drives(tmp_path):
    on_ground = friction_scenes.slipping(tmp_path)
    assert diagnose(rolling_subject(on_ground)) == diagnose(subject_of(read_scene("robotino2")))
    assert diagnose(rolling_subject(friction_scenes.limited(tmp_path))).rank == 3


def test_a_robot_that_turns_by_slip_alone_drives_straight_and_yaw(tmp_path):
    found = diagnose(rolling_subject(friction_scenes.skid_steering(tmp_path)))
    assert (found.dof, found.rank, found.not_driven) == (3, 2, ["moving straight along y"])
    assert found.words[0].startswith("By slipping alone")
