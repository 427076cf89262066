"""What is no input or no vehicle is refused in one line that names it; nothing is written beside it."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from laconic.core import Vehicle, load
from laconic.errors import BadInput
from laconic.scene import read_scene


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
