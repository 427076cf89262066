"""The core from Python: names, shapes and refusals arrive as they are on the other side."""

from __future__ import annotations

import math
import re
from decimal import Decimal
from typing import Any

import mpmath
import numpy as np
import pytest

from laconic.core import REALS, Vehicle, load
from laconic.core.given_array import AtLeast, real_array
from laconic.errors import BadInput, Refused
from laconic.scene import METHODS, read_scene
from laconic.scene.methods import EXPLICIT

WHEEL = {"kind": "omni", "x_m": 0.1, "y_m": 0.0, "axle_rad": 0.0}
VEHICLE = {
    "mass_kg": 10.0, "yaw_inertia_kgm2": 0.225, "com_y_m": 0.02, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 0.009,
    "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.02, "wheel": [
        {"kind": "omni", "x_m": 0.075, "y_m": 0.0, "axle_rad": 0.0},
        {"kind": "omni", "x_m": -0.075, "y_m": 0.0, "axle_rad": math.pi},
        {"kind": "omni", "x_m": 0.0, "y_m": 0.08, "axle_rad": math.pi / 2}]}


@pytest.fixture(params=REALS)
def core(request):
    """The core in each scalar type."""
    return load(request.param)


def refused(core, **changes) -> Refused:
    """The refusal of a vehicle with some fields changed."""
    with pytest.raises(Refused) as caught:
        core.prepare(core.vehicle({**VEHICLE, **changes}))
    return caught.value


def test_the_matrices_are_the_papers(core):
    found = core.matrices(core.vehicle(VEHICLE))
    sigma, rho = 0.5, 0.4
    rows = np.array([[0, 1, sigma], [0, -1, sigma], [-1, 0, rho]])
    close = 1e-14 if core.real == "double" else 1e-6
    np.testing.assert_allclose(found.wheel_rows, rows, atol=close)
    np.testing.assert_allclose(found.inertia, np.eye(3) + 0.36 * rows.T @ rows, atol=close)
    np.testing.assert_allclose(found.inverse_inertia @ found.inertia, np.eye(3), atol=10 * close)
    assert (found.lambda_yaw, found.lambda_wheel) == pytest.approx((3.0, 0.6), rel=close)
    assert found.constraint_rows.shape == (0, 3)


def test_methods_have_the_names_that_scenes_use(core):
    assert core.method_names == METHODS
    for name in METHODS:
        assert core.text(core.method(name).name) == name


def test_a_method_that_there_is_not(core):
    with pytest.raises(BadInput, match=f"did you mean {EXPLICIT}"):
        core.method("rk44")


def test_a_scalar_type_that_there_is_not():
    with pytest.raises(BadInput, match="half"):
        load("half")


@pytest.mark.parametrize(("changes", "status", "field", "item", "place"), [
    ({"mass_kg": -1.0}, "not positive", "mass_kg", 0, "vehicle.mass_kg: "),
    ({"mass_kg": math.nan}, "not finite", "mass_kg", 0, "vehicle.mass_kg: "),
    ({"com_z_m": -5.0}, "negative", "com_z_m", 0, "vehicle.com_z_m: -5 "),
    ({"wheel": [WHEEL, {**WHEEL, "roller_rad": 0.0}]}, "roller along axle", "roller_rad", 2,
     "vehicle.wheel[2].roller_rad: "),
    ({"wheel": [WHEEL, {**WHEEL, "y_m": math.inf}]}, "not finite", "wheel_y_m", 2, "vehicle.wheel[2].y_m: "),
    ({"wheel": 17 * [WHEEL]}, "too many wheels", "wheel_count", 0, "vehicle.wheel: "),
    ({"wheel": [{**WHEEL, "kind": "fixed", "locked": True}, {**WHEEL, "kind": "fixed", "x_m": 1.0, "axle_rad": 1.5}]},
     "nothing moves", "wheel_kind", 2, "vehicle.wheel[2].kind: "),
    ({"wheel": [{**WHEEL, "kind": "fixed", "y_m": y_m} for y_m in (-0.2, 0.2)]},
     "straight only", "wheel_kind", 2, "vehicle.wheel[2].kind: ")])
def test_a_refusal_arrives_with_status_field_item_and_the_words_of_a_scene(core, changes, status, field, item, place):
    found = refused(core, **changes)
    assert (found.status, found.field, found.item) == (status, field, item)
    assert str(found).startswith(place)
    assert found.exit_status == 2
    assert "\n" not in str(found)


def test_a_wheel_that_nobody_set_is_refused(core):
    vehicle = core.vehicle({**VEHICLE, "wheel": [WHEEL]})
    vehicle.wheel[0].kind = core.lib.LACONIC_WHEEL_UNSET
    with pytest.raises(Refused) as found:
        core.prepare(vehicle)
    assert (found.value.status, found.value.field, found.value.item) == ("wheel not set", "wheel_kind", 1)
    assert str(found.value).startswith("vehicle.wheel[1].kind: ")


def test_motor_data_become_gain_damping_and_inertia():
    core = load("double")
    motor = {"resistance_ohm": 2.0, "torque_constant_Nm_per_A": 0.05, "back_emf_Vs_per_rad": 0.06, "gear_ratio": 10.0,
             "viscous_friction_Nms": 1e-4, "rotor_inertia_kgm2": 1e-5}
    vehicle = core.vehicle({**dict.fromkeys(("mass_kg", "yaw_inertia_kgm2", "wheel_radius_m"), 1.0),
                            "wheel_inertia_kgm2": 0.002, "motor": motor})
    assert vehicle.motor_gain_Nm_per_V == pytest.approx(10.0 * 0.05 / 2.0)
    assert vehicle.motor_damping_Nms == pytest.approx(100.0 * (0.05 * 0.06 / 2.0 + 1e-4))
    assert vehicle.wheel_inertia_kgm2 == pytest.approx(0.002 + 100.0 * 1e-5)


def test_a_motor_without_resistance_is_refused():
    core = load("double")
    motor = dict.fromkeys(("resistance_ohm", "torque_constant_Nm_per_A", "back_emf_Vs_per_rad", "gear_ratio",
                           "viscous_friction_Nms", "rotor_inertia_kgm2"), 0.0)
    with pytest.raises(Refused, match="resistance_ohm"):
        core.vehicle({"motor": motor})


def test_an_input_by_names_stands_where_the_struct_has_it(core):
    held = core.input({"voltage_V": [1.0, 2.0, 3.0], "axle_torque_Nm[2]": 4.0,
                       "body_moment_Nm": 5.0, "world_force_N": [6.0, 7.0], "world_force_point_m[2]": 8.0}, 3)
    assert list(held.voltage_V)[:4] == [1.0, 2.0, 3.0, 0.0]
    assert held.axle_torque_Nm[1] == 4.0
    assert held.body_moment_Nm == 5.0
    assert list(held.world_force_N) == [6.0, 7.0]
    assert list(held.world_force_point_m) == [0.0, 8.0]
    assert list(held.body_force_N) == [0.0, 0.0]


def test_an_input_that_is_not_finite_is_refused_and_the_state_stays(core):
    plant = core.plant(core.vehicle(VEHICLE), "auto", 0.01, nu_rad_per_s=(0.1, 0.2, 0.3))
    before = plant.row()
    with pytest.raises(Refused) as caught:
        plant.run(core.input({"voltage_V[2]": math.nan}), 5)
    assert (caught.value.field, caught.value.item, plant.steps) == ("voltage_V", 2, 0)
    assert plant.row().tobytes() == before.tobytes()
    samples = np.zeros((3, 3, core.input_length))
    samples[:, :, core.input_offset("voltage_V[2]")] = np.nan
    with pytest.raises(Refused, match="voltage_V"):
        plant.run_sampled(samples)
    assert plant.row().tobytes() == before.tobytes()


@pytest.mark.parametrize("sample", [0, 1, 2])
def test_a_number_that_is_not_finite_in_any_sample_of_a_step_is_named(core, sample):
    plant = core.plant(core.vehicle(VEHICLE), "auto", 0.01)
    rows = np.zeros((4, 3, core.input_length))
    rows[2, sample, core.input_offset("axle_torque_Nm[3]")] = math.inf
    with pytest.raises(Refused) as caught:
        plant.run_sampled(rows)
    assert (caught.value.status, caught.value.field, caught.value.item) == ("not finite", "axle_torque_Nm", 3)
    assert plant.steps == 2


def test_near_the_largest_condition_number_two_digits_of_an_acceleration_are_right(core):
    epsilon = float(np.finfo(core.dtype).eps)
    wheel = {"kind": "roller", "x_m": 0.25, "y_m": -0.125, "axle_rad": 0.75, "roller_rad": 1.25}
    vehicle = {"mass_kg": 1.0, "yaw_inertia_kgm2": 1.0, "wheel_radius_m": 1.0, "wheel": [wheel]}
    with mpmath.workdps(80):
        pull, sine = mpmath.mpf(2), mpmath.sin(1.25)  # axle + roller
        lever = 0.25 * mpmath.sin(pull) + 0.125 * mpmath.cos(pull)
        row = mpmath.matrix([mpmath.cos(pull), mpmath.sin(pull), lever]) / sine
        inertia = float((0.009 / epsilon) ** 2 / (row.T * row)[0])
        matrix = mpmath.eye(3) + float(core.dtype.type(inertia)) * row * row.T
        model = core.prepare(core.vehicle({**vehicle, "wheel_inertia_kgm2": inertia}))
        for push in (row, mpmath.matrix([1, 2, 3])):  # along the largest inertia alone, and anywhere
            wrench = np.array([float(part) for part in push], core.dtype)
            held = core.input({"body_force_N": wrench[:2], "body_moment_Nm": wrench[2]})
            found = core.derivative(model, [0.0] * 3, 0.0, held).nu_rad_per_s2
            exact = mpmath.lu_solve(matrix, mpmath.matrix(wrench.tolist()))
            error = mpmath.matrix(list(found)) - exact
            assert mpmath.sqrt((error.T * matrix * error)[0] / (exact.T * matrix * exact)[0]) < 0.02
    refusal = refused(core, **vehicle, wheel_inertia_kgm2=1.5 * inertia)
    assert refusal.status == "ill-conditioned"
    assert refusal.value == pytest.approx(1.5 * (0.009 / epsilon) ** 2, rel=0.02)
    assert "leaves fewer than two correct digits" in str(refusal)


def test_steps_are_counted_and_do_not_change_what_many_at_once_give(core):
    one, many = (core.plant(core.vehicle(VEHICLE), EXPLICIT, 0.01) for _ in range(2))
    held = core.input({"voltage_V": [1.0, -1.0, 0.5]}, 3)
    for _ in range(100):
        one.run(held)
    many.run(held, 100)
    assert one.steps == many.steps == 100
    assert one.row().tobytes() == many.row().tobytes()


def test_whole_numbers_of_steps():
    core = load("double")
    assert core.steps_in(1000.0, 0.001) == 1_000_000
    with pytest.raises(Refused) as caught:
        core.steps_in(1.0, 0.3)
    assert caught.value.status == "step does not fit"


def test_a_change_of_payload_keeps_velocity_and_pose_of_the_bodys_origin():
    core = load("double")
    plant = core.plant(core.vehicle(VEHICLE), EXPLICIT, 0.01, nu_rad_per_s=(0.5, 1.0, 0.7), heading_rad=0.4)
    plant.run(core.input({}), 50)
    before, rate = plant.pose, plant.body_velocity()[1]
    plant.change(core.vehicle({**VEHICLE, "payload": {"mass_kg": 3.0, "x_m": 0.1, "y_m": -0.1,
                                                      "yaw_inertia_kgm2": 0.02}}))
    after = plant.pose
    assert (after.origin_x_m, after.origin_y_m) == pytest.approx((before.origin_x_m, before.origin_y_m), abs=1e-15)
    assert plant.body_velocity()[1] == pytest.approx(rate, rel=1e-14)
    assert (after.x_m, after.y_m) != (before.x_m, before.y_m)


# ---- What is no input or no vehicle is refused in one line that names it; nothing is written beside it.

@pytest.mark.parametrize("values, message", [
    ({"body_force_N": [1, 2, 3]}, "body_force_N: .* of which there are 2"),
    ({"body_force_N": [1]}, "body_force_N: .* of which there are 2"),
    ({"world_force_N": [1, 2, 3, 4]}, "world_force_N: .* of which there are 2"),
    ({"voltage_V": [1] * 17}, "voltage_V: .* of which there are 16"),
    ({"voltage_V": [[1, 2], [3, 4]]}, "voltage_V: "),
    ({"voltage_V": "5"}, "voltage_V: '5' is no number"),
    ({"voltage_V": None}, "voltage_V: None is no number"),
    ({"voltage_V[17]": 1}, r"voltage_V\[17\]: there is no such item; give 1 to 16"),
    ({"voltage_V[0]": 1}, r"voltage_V\[0\]: there is no such item"),
    ({"voltage_V[01]": 1}, r"voltage_V\[01\]: there is no such item"),  # one spelling each, so that none is given twice
    ({"voltage_V[\u0661]": 1}, r"voltage_V\[\u0661\]: there is no such item"),
    ({"voltage_V[1": 1}, r"voltage_V\[1: there is no such item"),
    ({"voltage_V[1]": [1, 2]}, r"voltage_V\[1\]: .* of which there are 1"),
    ({"body_moment_Nm[2]": 1}, r"body_moment_Nm\[2\]: there is no such item; give body_moment_Nm$"),
    ({"voltag_V": [1]}, "voltag_V: there is no such input; did you mean voltage_V?"),
    (np.zeros(3), r"input: a row has [0-9]+ numbers, this array has the shape \(3,\)")])
@pytest.mark.parametrize("real", ["double", "single"])
def test_what_is_no_input_is_refused_by_its_name(real: str, values: Any, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        load(real).input(values)


BEYOND = r"voltage_V\[3\] does not match the vehicle's 2 wheels; use voltage_V\[1\] to voltage_V\[2\]"
LIST = "does not match the vehicle's 2 wheels; .*, or a list of 2"


@pytest.mark.parametrize("values, message", [
    ({"voltage_V[3]": 3.0}, BEYOND), ({"voltage_V[3]": 0.0}, BEYOND),
    ({"voltage_V": 3.0}, rf"voltage_V: 3.0 {LIST}"), ({"voltage_V": [3.0]}, rf"voltage_V: \[3.0\] {LIST}"),
    ({"axle_torque_Nm": [3.0, 3.0, 9.0]}, rf"axle_torque_Nm: \[3.0, 3.0, 9.0\] {LIST}"),
    ({"voltage_V": [1.0] * 16}, rf"voltage_V: .* {LIST}"), ({"voltage_V": []}, rf"voltage_V: \[\] {LIST}")])
def test_python_refuses_inputs_of_wheels_that_are_not_there_and_lists_that_are_not_whole(
        values: Any, message: str) -> None:
    robot = Vehicle.of(read_scene("turtlebot3_burger"))
    plant = robot.plant()
    entrances = (plant.run, plant.outputs, plant.wheel_torques, plant.sensors().run, plant.sensors().read,
                 lambda held: robot.derivative(inputs=held), lambda held: robot.linearise(inputs=held),
                 lambda held: robot.core.input_row(held, 2), lambda held: robot.core.input(held, 2))
    for entrance in entrances:
        with pytest.raises(BadInput, match=message):
            entrance(values)
    assert plant.steps == 0


def test_a_remedy_names_the_wheels_that_there_are() -> None:
    for spelled in ("voltage_V[01]", "voltage_V[4]", "voltage_V[17]"):
        with pytest.raises(BadInput, match=r"give 1 to 3$|use voltage_V\[1\] to voltage_V\[3\]$"):
            Vehicle.of(read_scene("robotino2")).derivative(inputs={spelled: 1.0})
    one = {"mass_kg": 1.0, "yaw_inertia_kgm2": 0.1, "wheel_radius_m": 0.1, "wheel": [{"kind": "omni", "x_m": 0.1}]}
    text = r"voltage_V: \[1.0, 2.0\] does not match the vehicle's 1 wheel; use voltage_V\[1\], or a list of 1$"
    with pytest.raises(BadInput, match=text):
        Vehicle(one).derivative(inputs={"voltage_V": [1.0, 2.0]})


def test_a_ready_made_input_may_not_act_on_wheels_that_are_not_there() -> None:
    robot = Vehicle.of(read_scene("turtlebot3_burger"))
    plant = robot.plant()
    held = robot.core.input({"voltage_V[3]": 3.0})  # the core alone knows no vehicle
    samples = np.zeros((1, 3, robot.core.input_length))
    samples[0, 2, robot.core.input_offset("voltage_V[3]")] = 1.0
    for entrance in (lambda: plant.run(held), lambda: plant.sensors().run(held),
                     lambda: plant.run_sampled(samples), lambda: plant.sensors().run_sampled(samples)):
        with pytest.raises(BadInput, match=BEYOND):
            entrance()
    with pytest.raises(BadInput, match="voltage_V: has one number for each wheel, and without wheel_count"):
        robot.core.input({"voltage_V": [1.0, 2.0]})


@pytest.mark.parametrize("real", ["double", "single"])
def test_numbers_of_an_input_go_where_their_names_state(real: str) -> None:
    held = load(real).input({"voltage_V": np.array([1, 2, 3]), "axle_torque_Nm[2]": 7, "body_moment_Nm": 4,
                             "body_force_N": (5, 6)}, 3)
    assert list(held.voltage_V)[:4] == [1, 2, 3, 0] and held.body_moment_Nm == 4 and list(held.body_force_N) == [5, 6]
    assert list(held.axle_torque_Nm)[:3] == [0, 7, 0] and not any(held.world_force_N)


@pytest.mark.parametrize("data, message", [
    ({"mas_kg": 1.0}, "vehicle.mas_kg: unknown key; did you mean mass_kg?"),
    ({"wheel": [{"kind": "omnni"}]}, "vehicle.wheel[1].kind: there is no 'omnni'; did you mean omni?")])
def test_what_is_no_vehicle_is_refused_by_its_name(data: Any, message: str) -> None:
    with pytest.raises(BadInput, match=re.escape(message)):
        load("double").vehicle(data)


# ---- An array that a program gives: real numbers of the shape that is asked for, else one line with name, shape,
# unit.

def test_what_fits_is_taken_without_a_copy_and_other_types_are_converted():
    there = np.arange(6.0).reshape(2, 3)
    assert np.shares_memory(real_array("a", there, (2, 3)), there)
    assert real_array("a", [[1, 2, 3]], ("samples", 3)).dtype == float
    assert real_array("a", np.float32([1, 2]), (AtLeast(2),), dtype=np.float64).tolist() == [1.0, 2.0]
    assert real_array("a", there.T, (3, 2)).flags.c_contiguous
    assert real_array("a", 2, ()).shape == ()
    assert real_array("a", [], (0,)).shape == (0,)


@pytest.mark.parametrize("given", [None, "x", [1, None], [1j, 2], [True, False], [[1], [1, 2]], [1], [1, 2, 3], {1: 2},
                                   [Decimal(1), Decimal(2)], [10**400, 1], object()])
def test_what_is_no_such_array_is_refused_by_its_name(given):
    with pytest.raises(BadInput, match=r"^volts: .* does not fit; give real numbers of shape \(2,\) in V$"):
        real_array("volts", given, (2,), "V")


def test_the_first_place_that_is_not_finite_is_named():
    with pytest.raises(BadInput, match=r"^a\[2, 1\]: nan is not finite; give finite numbers in m$"):
        real_array("a", [[1, 2], [np.nan, np.inf]], (2, 2), "m")
    assert np.isnan(real_array("a", [np.nan], (1,), is_finite=False)[0])


def test_a_number_too_large_for_single_precision_becomes_infinite_without_a_warning():
    assert real_array("a", [1e300], (1,), dtype=np.float32)[0] == np.inf
