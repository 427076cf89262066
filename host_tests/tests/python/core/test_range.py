"""A result beyond the range of numbers is refused, as a step is, and a saved state that holds none is not restored."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import laconic
from laconic.core.saved import check_saved
from laconic.scene.methods import EXPLICIT

HUGE = {"voltage_V": [1e308] * 3}
TORQUES = {"axle_torque_Nm": [1.7e308] * 3, "voltage_V": [1.7e308] * 3}
KNOWN = {"position_std_m": 0.1, "encoder_std_rad": 0.1, "nu_std_rad_per_s": 0.1}


def robot(name: str = "robotino2", real: str = "double") -> laconic.Vehicle:
    return laconic.Vehicle(laconic.read_scene(name).vehicle, real)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("ask, what", [
    (lambda: robot().derivative([1e200] * 3), "derivative"),
    (lambda: robot().derivative(inputs=HUGE), "derivative"),
    (lambda: robot().linearise([1.7e308] * 3, 0.3), "linearise"),
    (lambda: robot().plant().body_acceleration(HUGE), "body_acceleration"),
    (lambda: robot().plant().wheel_torques(TORQUES), "wheel_torques"),
    (lambda: robot().plant().reactions(HUGE), "reactions"),
    (lambda: robot().plant().outputs(HUGE), "reactions"),
    (lambda: robot().plant().outputs(TORQUES), "outputs"),
    (lambda: robot().plant().sensors().read(HUGE), "acceleration_body_m_per_s2"),
    (lambda: robot().plant().step_derivatives().tangent([1e308] * 9), "tangent"),
    (lambda: robot().plant(step_s=0.1, nu_rad_per_s=(5, 9, 2)).step_derivatives().adjoint([1.797e308] * 9), "adjoint"),
    (lambda: robot().plant(step_s=0.01, nu_rad_per_s=(5, 9, 2)).step_derivatives({"voltage_V": [9, 8, 7]})
     .vehicle_gradient([1e308] * 9, ["wheel_radius_m"]), "vehicle_gradient")])
def test_a_result_beyond_all_numbers_is_refused_and_never_nan(ask: Callable[[], Any], what: str) -> None:
    with pytest.raises(laconic.Refused) as refused:
        ask()
    assert str(refused.value) == f"{what}: a result leaves the range of double precision; check inputs and units"
    assert refused.value.status == "overflow"


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("name", ["robotino2", "skid_steer"])
@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_a_saved_state_that_was_spoilt_is_not_restored(bad: float, name: str, real: str) -> None:
    plant = robot(name, real).plant(step_s=0.01)
    plant.run({}, 3)
    saved, before = plant.save(), plant.row().tolist()
    state = saved.state if plant.has_friction else saved
    state.x_m.value = bad
    where = "plant.state.x_m.value" if plant.has_friction else "state.x_m.value"
    with pytest.raises(laconic.BadInput, match=f"^{where}: {bad} is not finite; give what save"):
        plant.restore(saved, 5)
    assert (plant.row().tolist(), plant.steps) == (before, 3)
    state.x_m.value = 0.25
    plant.restore(saved, 5)
    assert (plant.pose.x_m, plant.steps) == (0.25, 5)


def test_spoilt_wheels_sensors_and_filters_are_not_restored() -> None:
    skids = robot("skid_steer").plant()
    saved = skids.save()
    saved.slip.wheel_angle_rad[1].value = float("nan")
    with pytest.raises(laconic.BadInput, match=r"^plant.slip.wheel_angle_rad\[2\].value: nan is not finite"):
        skids.restore(saved, 0)
    sensors = robot().plant().sensors()
    shown = sensors.save()
    shown.sample[0].yaw_rate_rad_per_s = float("inf")
    with pytest.raises(laconic.BadInput, match=r"^sensors.sample\[1\].yaw_rate_rad_per_s: inf is not finite"):
        sensors.restore(shown)
    ours = laconic.Filter(robot().plant(), KNOWN)
    kept = ours.save()
    kept[1].state.heading.rest = float("nan")
    with pytest.raises(laconic.BadInput, match=r"^saved.state.heading.rest: nan is not finite"):
        ours.restore(kept)
    for parts in ((None, kept[2]), (kept[1], None)):
        with pytest.raises(laconic.BadInput, match=r"^saved: .* is not of this filter; give what its save\(\) gave"):
            ours.restore((kept[0], *parts))


CART, OMNI = "turtlebot3_burger", "robotino2"


@pytest.mark.parametrize("real", ["double", "single"])
def test_a_state_with_a_motion_that_the_wheels_forbid_is_not_restored(real: str) -> None:
    cart, omni = robot(CART, real).plant(step_s=0.01), robot(OMNI, real).plant(step_s=0.01)
    cart.run({"voltage_V": [3, 4]}, 5)
    omni.run({"voltage_V": [3, -1, 2]}, 5)
    before = cart.row().tolist()
    with pytest.raises(laconic.BadInput, match=r"^state.zeta\[3\].value: .* is a motion that the wheels of this robot"):
        cart.restore(omni.save(), 5)
    way = omni.save()
    way.zeta[2].value = 0.0
    with pytest.raises(laconic.BadInput, match=r"^state.travel\[3\].value: .* forbid; give what save\(\) of this"):
        cart.restore(way, 5)
    more = cart.save()
    more.wheel_angle_set_rad[2] = 0.5
    with pytest.raises(laconic.BadInput, match=r"^state.wheel_angle_set_rad\[3\]: is 0.5, and this robot has 2 wheels"):
        cart.restore(more, 5)
    assert (cart.row().tolist(), cart.steps) == (before, 5)
    cart.restore(cart.save(), 3)
    assert (cart.row().tolist(), cart.steps) == (before, 3)


def test_a_saved_plant_of_another_number_of_wheels_or_without_friction_is_not_restored() -> None:
    skids, three = robot("skid_steer").plant(), robot("robotino_grey").plant()
    with pytest.raises(laconic.BadInput, match="^plant: is of a robot with 3 wheels, and this has 4; give what save"):
        skids.restore(three.save(), 0)
    with pytest.raises(laconic.BadInput, match="^plant: is of a robot without friction; give what save"):
        skids.restore(robot().plant().c, 0)


def test_a_state_of_a_batch_of_the_robot_is_restored() -> None:
    cart = robot(CART)
    batch = laconic.Batch(cart, 3, EXPLICIT, 0.001)
    batch.voltage_V = np.array([[1.0, 2, 3], [3, 2, 1]])
    batch.run(20)
    plant = cart.plant(EXPLICIT, 0.001)
    plant.restore(batch.state(2), 20)
    assert plant.pose.x_m == batch.x_m[2] != 0.0


def test_every_real_number_of_a_saved_state_is_looked_at() -> None:
    plant = robot().plant()
    core, words = plant.core, plant.core.ffi.sizeof("laconic_state") // 8
    passed = []
    for word in range(words):
        saved = plant.save()
        np.frombuffer(core.ffi.buffer(saved))[word] = np.nan
        try:
            check_saved(core, "state", saved[0])
        except laconic.BadInput:
            continue
        passed.append(word)
    heading = core.ffi.offsetof("laconic_state", "heading") // 8
    assert passed == [heading, heading + 1]  # turns and fraction, which are whole numbers
