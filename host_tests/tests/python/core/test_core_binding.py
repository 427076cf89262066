"""The core from Python: names, shapes and refusals arrive as they are on the other side."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from laconic.core import REALS, load
from laconic.errors import BadInput, Refused
from laconic.scene import METHODS
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
