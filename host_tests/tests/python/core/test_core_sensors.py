"""Sensors from Python (`Plant.sensors`): what they show, how they are saved, and what is refused by its name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import laconic
from laconic.scene import read_scene

SETTINGS = {"imu": {"x_m": 0.1, "acceleration_bias_m_per_s2": [0.5, 0.0], "delay_steps": 3, "seed": 4,
                    "yaw_rate_noise_rad_per_s_per_sqrt_Hz": 1e-3},
            "encoder": {"counts_per_turn": 4096, "gear_ratio": [1.0, -2.0, 1.0], "wrap": 65536}}
HELD = {"voltage_V": [5.0, -2.0, 1.0]}


def sensed(settings: Any = None, real: str = "double") -> laconic.Sensors:
    """Sensors on a Robotino at rest."""
    return read_scene("robotino2").plant(laconic.load_core(real)).sensors(settings)


@pytest.mark.parametrize("real", ["double", "single"])
def test_readings_have_the_shapes_and_types_that_they_state(real: str) -> None:
    sensors = sensed(SETTINGS, real)
    sensors.run(HELD, 50)
    found = sensors.read(HELD)
    assert isinstance(found, laconic.Readings)
    assert found.acceleration_body_m_per_s2.shape == found.imu_acceleration_m_per_s2.shape == (2,)
    assert isinstance(found.imu_yaw_rate_rad_per_s, float)
    assert found.encoder_count.shape == (3,) and found.encoder_count.dtype == np.int64
    assert found.acceleration_body_m_per_s2.tolist() == sensors.plant.body_acceleration(HELD).tolist()


def test_steps_at_once_and_one_by_one_show_the_same_and_move_as_without_sensors() -> None:
    many, single, bare = sensed(SETTINGS), sensed(SETTINGS), sensed().plant
    many.run(HELD, 200)
    bare.run(HELD, 200)
    for _ in range(200):
        single.run(HELD)
    assert many.plant.row().tolist() == single.plant.row().tolist() == bare.row().tolist()
    assert repr(many.read()) == repr(single.read())


def test_an_encoder_of_32_bits_without_sign_shows_numbers_from_0_on() -> None:
    found = []
    for wrap in ({}, {"wrap": 2**32}):
        sensors = sensed({"encoder": {"counts_per_turn": 4096, "gear_ratio": -1.0} | wrap})
        sensors.run(HELD, 200)
        found.append(sensors.read().encoder_count)
        sensors.restore(sensors.save())
        assert (sensors.read().encoder_count == found[-1]).all()
    assert found[0].min() < 0 <= found[1].min() and (found[0] % 2**32 == found[1]).all()


def test_saved_sensors_continue_as_they_would_have() -> None:
    sensors = sensed(SETTINGS)
    sensors.run(HELD, 20)
    saved, state, steps = sensors.save(), sensors.plant.save(), sensors.plant.steps
    sensors.run(HELD, 30)
    once = repr(sensors.read())
    sensors.restore(saved)
    sensors.plant.restore(state, steps)
    assert repr(sensors.read()) != once
    sensors.run(HELD, 30)
    assert repr(sensors.read()) == once
    with pytest.raises(laconic.BadInput, match=r"sensors: .* make it with sensors\.save\(\)"):
        sensors.restore(state)


REFUSED = {
    "no table": ({"imu": 3}, "sensors.imu: 3 is no table"),
    "unknown sensor": ({"gyro": {}}, "sensors.gyro: unknown key"),
    "unknown key": ({"imu": {"delay_s": 0.1}}, "sensors.imu.delay_s: unknown key; did you mean delay_steps?"),
    "no number": ({"imu": {"x_m": "front"}}, "sensors.imu.x_m: 'front' is no number"),
    "not finite": ({"imu": {"y_m": float("nan")}}, "sensors.imu.y_m: NaN is not a finite number"),
    "one of two": ({"imu": {"acceleration_bias_m_per_s2": [1.0]}}, "acceleration_bias_m_per_s2: has 1 entries"),
    "second not finite": ({"imu": {"acceleration_scale_error": [0.0, np.inf]}},
                          "acceleration_scale_error[2]: infinity"),
    "delay in halves": ({"imu": {"delay_steps": 1.5}}, "sensors.imu.delay_steps: 1.5 is no whole number"),
    "delay too long": ({"imu": {"delay_steps": 65}}, "sensors.imu.delay_steps: 65 is above 64"),
    "seed too large": ({"imu": {"seed": 2**31}}, "sensors.imu.seed: 2147483648 has more than 32 bits"),
    "counts of two wheels": ({"encoder": {"counts_per_turn": [4, 4]}},
                             "counts_per_turn: has 2 entries; give one number"),
    "negative counts": ({"encoder": {"counts_per_turn": [4, 4, -4]}},
                        "sensors.encoder.counts_per_turn: is -4; give a number above 0, false for none"),
    "no counts": ({"encoder": {"wrap": 65536}}, "sensors.encoder.counts_per_turn: is missing; give it as a whole"),
    "counts of 0": ({"encoder": {"counts_per_turn": 0}}, "sensors.encoder.counts_per_turn: is 0; give a number above"),
    "no encoder": ({"encoder": {"counts_per_turn": [False] * 3}}, "gives no wheel an encoder; leave the encoders out"),
    "no gear": ({"encoder": {"counts_per_turn": 4, "gear_ratio": 0}},
                "sensors.encoder.gear_ratio: is 0; give another number, below 0 for an encoder that counts backwards"),
    "no gear in a list": ({"encoder": {"counts_per_turn": 4, "gear_ratio": [1, -0.0, 1]}}, "gear_ratio: is 0; give"),
    "gear not finite": ({"encoder": {"counts_per_turn": 4, "gear_ratio": np.nan}}, "gear_ratio: nan is no finite"),
    "no wrap": ({"encoder": {"counts_per_turn": 4, "wrap": 0}},
                "sensors.encoder.wrap: is 0; give the number of values that the counter has, such as 65536"),
    "wrap between": ({"encoder": {"counts_per_turn": 4, "wrap": 2**31}},
                     "sensors.encoder.wrap: is 2147483648; give a whole number of at most 32 bits"),
    "wrap beyond": ({"encoder": {"counts_per_turn": 4, "wrap": 2**33}}, "2147483647, or 4294967296"),
    "counts of 32 bits": ({"encoder": {"counts_per_turn": 2**32}}, "counts_per_turn: is 4294967296; give"),
    "wrap of one": ({"encoder": {"counts_per_turn": 4, "wrap": 1}}, "sensors.encoder.wrap: is 1; give the number"),
    "wrap in halves": ({"encoder": {"counts_per_turn": 4, "wrap": 2.5}}, "wrap: is 2.5, not a whole number"),
    "negative wrap": ({"encoder": {"counts_per_turn": 4, "wrap": -1}}, "sensors.encoder.wrap: is -1; give the number"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_wrong_settings_are_one_line_that_names_the_field(name: str) -> None:
    settings, text = REFUSED[name]
    with pytest.raises(laconic.BadInput) as refused:
        sensed(settings)
    assert text in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_gear_that_single_precision_takes_for_none_is_refused_there_alone() -> None:
    encoder = {"encoder": {"counts_per_turn": 4, "gear_ratio": 1e-60}}
    sensed(encoder)
    with pytest.raises(laconic.BadInput, match=r"sensors\.encoder\.gear_ratio: 1e-60 is beyond the range of this prec"):
        sensed(encoder, "single")


def test_a_wheel_without_an_encoder_is_said_as_in_a_scene() -> None:
    gears = np.array([1.0, -2.0])
    sensors = sensed({"encoder": {"counts_per_turn": [4096, False, np.int64(360)], "gear_ratio": gears}})
    sensors.run(HELD, 100)
    assert sensors.read().encoder_count[1] == 0
    assert sensors.c.settings.encoder[2].gear_ratio == -2.0


def test_an_encoder_that_turns_too_far_in_a_step_is_refused_by_its_wheel() -> None:
    sensors = sensed({"encoder": {"counts_per_turn": 2**31 - 1, "gear_ratio": 1e6}})
    with pytest.raises(laconic.Refused) as refused:
        sensors.run({"axle_torque_Nm": [0.0, 50.0, 0.0]}, 10)
    assert refused.value.status == "overflow"
    assert "sensors.encoder.counts_per_turn[" in str(refused.value)


def test_a_vehicle_with_friction_has_its_acceleration_by_sensors_alone() -> None:
    plant = read_scene("skid_steer").plant(laconic.load_core("double"))
    with pytest.raises(laconic.BadInput, match="plant.sensors"):
        plant.body_acceleration()
    sensors = plant.sensors()
    sensors.run({"voltage_V": [5.0] * plant.wheel_count}, 5)
    assert abs(sensors.read().acceleration_body_m_per_s2[0]) > 0.01
