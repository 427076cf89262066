"""What is no input or no vehicle is refused in one line that names it; nothing is written beside it."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from laconic.core import load
from laconic.errors import BadInput


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
    ({"voltage_V[1]": [1, 2]}, r"voltage_V\[1\]: .* of which there are 1"),
    ({"voltag_V": [1]}, "voltag_V: there is no such input; did you mean voltage_V?"),
    (np.zeros(3), r"input: a row has [0-9]+ numbers, this array has the shape \(3,\)")])
@pytest.mark.parametrize("real", ["double", "single"])
def test_what_is_no_input_is_refused_by_its_name(real: str, values: Any, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        load(real).input(values)


@pytest.mark.parametrize("real", ["double", "single"])
def test_numbers_of_an_input_go_where_their_names_state(real: str) -> None:
    held = load(real).input({"voltage_V": np.array([1, 2]), "voltage_V[3]": 3, "body_moment_Nm": 4,
                             "body_force_N": (5, 6)})
    assert list(held.voltage_V)[:4] == [1, 2, 3, 0] and held.body_moment_Nm == 4 and list(held.body_force_N) == [5, 6]
    assert not any(held.axle_torque_Nm) and not any(held.world_force_N)


@pytest.mark.parametrize("data, message", [
    ({"mas_kg": 1.0}, "vehicle.mas_kg: unknown key; did you mean mass_kg?"),
    ({"wheel": [{"kind": "omnni"}]}, "vehicle.wheel[1].kind: there is no 'omnni'; did you mean omni?")])
def test_what_is_no_vehicle_is_refused_by_its_name(data: Any, message: str) -> None:
    with pytest.raises(BadInput, match=re.escape(message)):
        load("double").vehicle(data)
