"""Vehicles with hinges from Python: prepared, stepped, read, copied; exact results (docs/articulated.md)."""

from __future__ import annotations

import copy
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hinge_scenes import HINGED

import laconic
from laconic import ArticulatedVehicle
from laconic.core.articulated import method_names
from laconic.errors import BadInput, Refused

FIXED = {"kind": "fixed", "axle_deg": -90.0}
ROBOT: dict[str, Any] = {
    "mass_kg": 20.0, "yaw_inertia_kgm2": 0.8, "wheel_radius_m": 0.08, "wheel_inertia_kgm2": 0.01,
    "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.3,
    "wheel": [{**FIXED, "x_m": 0.0, "y_m": 0.2}, {**FIXED, "x_m": 0.0, "y_m": -0.2},
              {**FIXED, "x_m": -0.05, "y_m": 0.0, "body": "fork", "driven": False}],
    "body": [{"name": "fork", "hinge": "free", "hinge_x_m": 0.25, "hinge_y_m": 0.0, "mass_kg": 0.5,
              "com_x_m": -0.03, "yaw_inertia_kgm2": 1e-3}]}
OMNI = [{"kind": "omni", "distance_m": 0.2, "bearing_deg": angle, "axle_deg": angle} for angle in (60.0, 180.0, 300.0)]


def robot(**changes: Any) -> ArticulatedVehicle:
    return ArticulatedVehicle(copy.deepcopy(ROBOT) | changes)


def arm(**keys: Any) -> dict[str, Any]:
    """A body without wheels."""
    return {"name": "arm", "hinge": "free", "hinge_x_m": 0.1, "hinge_y_m": 0.05, "mass_kg": 3.0, "com_x_m": 0.2,
            "yaw_inertia_kgm2": 0.05} | keys


def test_counts_methods_and_names() -> None:
    made = robot()
    assert (made.wheel_count, made.body_count, made.names, made.is_coordinated) == (3, 1, ("fork",), False)
    assert method_names() == ("auto", "rk4", "circle", "moebius-4")


def test_inputs_by_name_and_by_list_make_the_same_row() -> None:
    made = robot(body=[*ROBOT["body"], arm(hinge="prescribed")])
    one = made.input_row({"voltage_V": [1, 2, 0], "hinge_torque_Nm": [0.3, 0], "steering_twist": [1, 0, 0.5]})
    other = made.input_row({"voltage_V[1]": 1, "voltage_V[2]": 2, "hinge_torque_Nm[fork]": 0.3,
                            "steering_twist[1]": 1, "steering_twist[3]": 0.5})
    assert np.array_equal(one, other) and np.count_nonzero(one) == 5
    assert made.input_row({"steering_rate_rad_per_s[arm]": 0.2})[made.slot("steering_rate_rad_per_s[arm]")] == 0.2


@pytest.mark.parametrize(("inputs", "words"), [
    ({"voltage_V[4]": 1}, "voltage_V[4]"), ({"hinge_torque_Nm[arm]": 1}, "hinges are fork"),
    ({"voltage": 1}, "did you mean voltage_V"), ({"voltage_V": [1, 2]}, "voltage_V"),
    ({"voltage_V[1]": math.nan}, "finite"),
    ({"voltage_V": [1, 2, 3], "voltage_V[1]": 1}, "besides"), ({"steering_twist[4]": 1}, "1 to 3"), ([1, 2], "mapping"),
    ({"hinge_torque_Nm": "much"}, "hinge_torque_Nm")])
def test_inputs_that_fit_nothing_are_refused(inputs: Any, words: str) -> None:
    with pytest.raises(BadInput) as why:
        robot().input_row(inputs)
    assert words in str(why.value)


@pytest.mark.parametrize(("changes", "words"), [
    ({"body": [{**ROBOT["body"][0], "hinge": "ball"}]}, "body[1].hinge"),
    ({"body": [{k: v for k, v in ROBOT["body"][0].items() if k != "mass_kg"}]}, "body[1].mass_kg: is missing"),
    ({"body": [{**ROBOT["body"][0], "length": 1}]}, "body[1].length: unknown key"),
    ({"body": [arm(parent="fork"), ROBOT["body"][0]]}, "body[1].parent: 'fork' comes later"),
    ({"body": [ROBOT["body"][0], {**ROBOT["body"][0]}]}, "body[2].name: 'fork' is taken"),
    ({"body": [arm()]}, "wheel[3].body: there is no 'fork'"), ({"body": 3}, "vehicle.body"),
    ({"body": [arm(name="a[1]")]}, "body[1].name"), ({"body": [arm(mass_kg="x")], "wheel": []}, "body[1].mass_kg"),
    ({"body": [arm(mass_kg=-1.0)], "wheel": OMNI}, "body[1].mass_kg"),
    ({"body": [arm(hinge="coordinated")], "wheel": OMNI}, "use a prescribed or motor hinge")])
def test_tables_that_make_no_vehicle_are_refused_by_field(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(BadInput) as why:
        robot(**changes)
    assert words in str(why.value)


def test_a_copy_and_a_pickle_go_on_alone_with_the_same_bits() -> None:
    plant = robot().plant(step_s=0.01, hinge_angle_rad=[1.0])
    plant.run({"voltage_V[1]": 3.0}, 20)
    twins = [copy.copy(plant), pickle.loads(pickle.dumps(plant))]
    saved, steps = plant.save(), plant.steps
    plant.run({"voltage_V[2]": 3.0}, 30)
    for twin in twins:
        assert twin.steps == 20
        twin.run({"voltage_V[2]": 3.0}, 30)
        assert twin.motion().x_m == plant.motion().x_m
        assert np.array_equal(twin.motion().hinge_rate_rad_per_s, plant.motion().hinge_rate_rad_per_s)
    plant.restore(saved, steps)
    plant.run({"voltage_V[2]": 3.0}, 30)
    assert plant.motion().x_m == twins[0].motion().x_m
    with pytest.raises(BadInput, match="saved state"):
        plant.restore({}, 3)


def test_linear_inputs_over_one_long_step_are_those_over_many_short_ones() -> None:
    made = robot(body=[*ROBOT["body"], arm(hinge="prescribed")])

    def at(part: float) -> dict[str, float]:
        return {"voltage_V[1]": 4.0 * part, "steering_rate_rad_per_s[arm]": 2.0 * part}

    long, short = made.plant(step_s=0.02), made.plant(step_s=0.0005)
    long.step(at(0.0), at(1.0))
    for k in range(40):
        short.step(at(k / 40), at((k + 1) / 40))
    assert long.motion().hinge_angle_rad[1] == pytest.approx(0.02, rel=1e-12)
    assert long.motion().yaw_rate_rad_per_s == pytest.approx(short.motion().yaw_rate_rad_per_s, rel=1e-5)


def test_a_refused_step_keeps_the_state_and_a_bad_method_or_step_is_named() -> None:
    plant = robot().plant("rk4", 0.01, velocity_m_per_s=(3.0, 0.0), hinge_angle_rad=[0.5])
    plant.set_step(0.2)
    before = plant.motion()
    with pytest.raises(Refused, match="auto"):
        plant.run(steps=10)
    assert plant.steps == 0 and plant.motion().x_m == before.x_m
    for arguments in (("euler", 0.01), ("auto", -1.0)):
        with pytest.raises(BadInput):
            robot().plant(*arguments)


def test_a_start_against_the_wheels_becomes_the_nearest_motion_and_says_by_how_much() -> None:
    plant = robot().plant(velocity_m_per_s=(1.0, 0.5))
    assert plant.changed_m_per_s > 0.1 and abs(plant.motion().velocity_m_per_s[1]) < 1e-12
    rolls = robot().plant(velocity_m_per_s=(1.0, 0.0))
    assert rolls.changed_m_per_s < 1e-12


def test_the_balance_of_reactions_is_rounding_and_the_margin_judges_the_largest() -> None:
    plant = robot().plant(step_s=0.01, hinge_angle_rad=[1.0])
    plant.run({"voltage_V[1]": 5.0}, 10)
    found = plant.reactions({"voltage_V[1]": 5.0}, [100.0, 100.0, 10.0])
    assert found.balance < 1e-12 and found.hinge_force_N.shape == (1, 2)
    assert found.largest_N == pytest.approx(max(np.hypot(found.along_N, found.lateral_N)))
    assert found.wheel_torque_Nm[0] == pytest.approx(0.5 * 5.0 - 0.3 * plant.motion().wheel_speed_rad_per_s[0])
    with pytest.raises(BadInput, match="normal_N"):
        plant.reactions(None, [1.0])


def test_the_acceleration_is_the_change_of_velocity() -> None:
    plant = robot().plant(step_s=1e-5, velocity_m_per_s=(0.5, 0.0), hinge_angle_rad=[1.0])
    inputs = {"voltage_V[1]": 5.0}
    plant.run(inputs, 10)
    before, acceleration = plant.motion(), plant.acceleration(inputs)
    plant.run(inputs)
    after = plant.motion()
    turned = [complex(*m.velocity_m_per_s) * np.exp(1j * m.heading_rad) for m in (before, after)]
    change = (turned[1] - turned[0]) / 1e-5 * np.exp(-1j * before.heading_rad)
    assert (change.real, change.imag) == pytest.approx(tuple(acceleration), abs=1e-4)


@pytest.mark.parametrize("method", method_names())
def test_free_motion_keeps_its_energy_and_without_wheels_its_momenta(method: str) -> None:
    free = ArticulatedVehicle({"mass_kg": 8.0, "yaw_inertia_kgm2": 0.4, "wheel_radius_m": 0.05, "body": [
        arm(), arm(name="hand", parent="arm", hinge_x_m=0.4, mass_kg=1.0)]})
    plant = free.plant(method, 0.002, velocity_m_per_s=(0.4, -0.2), yaw_rate_rad_per_s=1.5,
                       hinge_rate_rad_per_s=[-2.0, 1.0], hinge_angle_rad=[0.3, -0.4])

    def momentum() -> complex:
        motion, total = plant.motion(), 0j
        twists = [(complex(*motion.velocity_m_per_s) * np.exp(1j * motion.heading_rad), motion.yaw_rate_rad_per_s)]
        for number, parent in ((0, 0), (1, 1)):
            above = complex(motion.x_m, motion.y_m) if parent == 0 else complex(motion.body_x_m[0], motion.body_y_m[0])
            arm_ = complex(motion.body_x_m[number], motion.body_y_m[number]) - above
            v, omega = twists[parent]
            twists.append((v + 1j * omega * arm_, omega + motion.hinge_rate_rad_per_s[number]))
        for number, mass in enumerate((8.0, 3.0, 1.0)):
            v, omega = twists[number]
            lever = 0.2 * np.exp(1j * motion.body_heading_rad[number - 1]) if number else 0.0
            total += mass * (v + 1j * omega * lever)
        return total

    energy, before = plant.motion().energy_J, momentum()
    plant.run(steps=1000)
    assert plant.motion().energy_J == pytest.approx(energy, rel=1e-9)
    assert abs(momentum() - before) < 1e-8 * abs(before)


def test_a_hinge_held_still_is_one_rigid_body() -> None:
    angle = 0.7
    held = ArticulatedVehicle({"mass_kg": 8.0, "yaw_inertia_kgm2": 0.4, "wheel_radius_m": 0.05,
                               "wheel_inertia_kgm2": 1e-3, "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.2,
                               "wheel": OMNI, "body": [arm(hinge="prescribed")]})
    tip = 0.1 + 0.05j + 0.2 * np.exp(1j * angle)
    com = 3.0 * tip / 11.0
    inertia = 0.4 + 8.0 * abs(com)**2 + 0.05 + 3.0 * abs(tip - com)**2
    whole = laconic.Vehicle({"mass_kg": 11.0, "yaw_inertia_kgm2": float(inertia), "com_x_m": com.real,
                             "com_y_m": com.imag, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 1e-3,
                             "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.2, "wheel": OMNI})
    inputs = {"voltage_V": [3.0, -1.0, 2.0]}
    one, other = held.plant("auto", 0.001, hinge_angle_rad=[angle]), whole.plant("auto", 0.001)
    one.run(inputs, 2000)
    other.run(inputs, 2000)
    assert one.motion().heading_rad == pytest.approx(other.pose.heading_rad, abs=1e-9)
    assert np.abs(one.motion().wheel_angle_rad - other.wheel_angles()).max() < 1e-9


def test_a_massless_body_without_wheels_changes_nothing() -> None:
    plain = robot()
    with_more = robot(body=[*ROBOT["body"], arm(hinge="prescribed", mass_kg=0.0, yaw_inertia_kgm2=0.0)])
    ends = []
    for each in (plain, with_more):
        angles = [1.0, 0.0][: each.body_count]
        plant = each.plant(step_s=0.005, velocity_m_per_s=(0.5, 0.0), hinge_angle_rad=angles)
        plant.run({"voltage_V[1]": 3.0}, 200)
        ends.append(plant.motion())
    assert ends[0].x_m == pytest.approx(ends[1].x_m, abs=1e-14)
    assert ends[0].energy_J == pytest.approx(ends[1].energy_J, rel=1e-13)


@pytest.mark.parametrize("name", HINGED)
def test_each_scene_gives_its_vehicle_in_both_precisions(name: str) -> None:
    for real in ("double", "single"):
        scene = laconic.read_scene(name).with_run(real=real)
        made = ArticulatedVehicle.of(scene)
        assert made.wheel_count == scene.wheel_count and made.names == tuple(hinge.name for hinge in scene.hinges)
    with pytest.raises(BadInput, match=r"laconic\.Vehicle"):
        ArticulatedVehicle.of(laconic.read_scene("s1"))


def test_a_rigid_vehicle_of_a_scene_with_hinges_names_the_one_that_takes_them() -> None:
    with pytest.raises(BadInput, match=r"caster\[1\]: laconic\.Vehicle does not .* laconic\.ArticulatedVehicle\.of"):
        laconic.Vehicle.of(laconic.read_scene("mir_like"))


def test_variants_that_the_fmu_of_hinges_lacks_are_refused_by_the_name_of_the_option(tmp_path: Path) -> None:
    for option in ("derivatives", "estimate"):
        with pytest.raises(BadInput, match=f"^--{option}: the FMU of a vehicle with hinges"):
            laconic.make_fmu(laconic.read_scene("mir_like"), tmp_path / "f.fmu", version=3, **{option: True})


@pytest.mark.parametrize(("scene", "inputs", "words"), [
    ("mir_like", {"voltage_V[3]": 1.0}, r"voltage_V\[3\]: would do nothing, wheel 3 has no motor; .*axle_torque_Nm"),
    ("f1tenth", {"hinge_torque_Nm[front_left]": 1.0}, r"hinge_torque_Nm\[front_left\]: would do nothing"),
    ("f1tenth", {"hinge_voltage_V[front_left]": 1.0}, r"hinge_voltage_V\[front_left\]: .* as it needs a motor"),
    ("f1tenth", {"steering_rate_rad_per_s[front_left]": 1.0}, r"steering_rate_rad_per_s\[front_left\]: .*prescribed")])
def test_an_input_that_would_do_nothing_is_refused_as_in_a_scene(scene: str, inputs: dict[str, float], words: str
                                                                 ) -> None:
    vehicle = laconic.ArticulatedVehicle.of(laconic.read_scene(scene))
    plant = vehicle.plant(inputs={"steering_twist": [1, 0, 0]} if vehicle.is_coordinated else {})
    with pytest.raises(BadInput, match=words):
        plant.run(inputs)


def test_a_number_that_is_not_finite_is_named_by_its_signal() -> None:
    vehicle = laconic.ArticulatedVehicle.of(laconic.read_scene("frc_swerve_mk4i"))
    plant = vehicle.plant(inputs={"steering_twist": [1.0, 0.0, 0.0]})
    row = vehicle.input_row({"steering_twist": [1.0, 0.0, 0.0]})
    row[vehicle.slot("steering_twist[2]")] = math.nan
    for call in (lambda: plant.run(row), lambda: plant.follow(np.array([[row, row]]))):
        with pytest.raises(Refused, match=r"^steering_twist\[2\]: NaN"):
            call()
    with pytest.raises(BadInput, match=r"^steering_twist\[2\]: nan is not finite"):
        plant.run({"steering_twist[2]": math.nan})
