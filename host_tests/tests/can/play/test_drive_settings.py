"""[rig.drives]: its keys are checked as all keys are, and what is not given is derived."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from laconic.base.paths import SCENE_DIR
from laconic.can.play.drives import POSITION, DriveGroup
from laconic.can.play.settings import DriveSettings, drive_settings
from laconic.can.play.vehicle import played
from laconic.errors import BadInput
from laconic.scene import read_scene

HEAD = "\n[rig.drives]\n"


def scene_with(tmp_path: Path, keys: str, name: str = "robotino2"):
    """A scene of the project with these keys of drives."""
    path = tmp_path / "scene.toml"
    path.write_text((SCENE_DIR / f"{name}.toml").read_text(encoding="utf-8") + HEAD + keys, encoding="utf-8")
    return read_scene(path)


def settings_of(tmp_path: Path, keys: str, name: str = "robotino2", protocol: str | None = None) -> DriveSettings:
    return drive_settings(scene_with(tmp_path, keys, name), protocol)


@pytest.mark.parametrize("keys, words", [
    ('protocol = "canopn"', ("rig.drives.protocol", "did you mean canopen?")),
    ("gear_ratio = 5e-324", ("rig.drives.gear_ratio", "1e-06")),
    ("watchdog_s = 2000", ("rig.drives.watchdog_s", "1000")),
    ("torque_constant_Nm_per_A = 5e-324", ("rig.drives.torque_constant_Nm_per_A", "1e-09")),
    (f"gear_ratio = {'9' * 5000}", ("scene.toml", "digits")),
    ("node_ids = 1", ("rig.drives.node_ids", "list")),
    ("node_ids = [1, 2]", ("node_ids", "2 entries", "3 wheels")),
    ("node_ids = [1, 2, true]", ("node_ids", "holds true")),
    ("node_ids = [1, 2, 2.5]", ("node_ids", "holds 2.5")),
    ("node_ids = [false, false, false]", ("node_ids", "at least one")),
    ('protocol = "canopen"\nnode_ids = [1, 2, 128]', ("node_ids", "128", "1 to 127")),
    ('protocol = "odrive"\nnode_ids = [1, 2, 1]', ("node_ids", "1 is given twice")),
    ('protocol = "odrive"\nnode_ids = [50, 51, 52]', ("node_ids", "drive 52 of odrive", "0x680")),
    ("encoder_counts = 0", ("encoder_counts", "above 0")),
    ("encoder_counts = 1000.5", ("encoder_counts", "whole number")),
    ("gear_ratio = 0", ("gear_ratio", "is 0")),
    ("gear_ratio = [1, 2]", ("gear_ratio", "2 entries", "3, one for each drive")),
    ('gear_ratio = "16"', ("gear_ratio", "a number, or a list")),
    ("torque_constant_Nm_per_A = -1", ("torque_constant_Nm_per_A", "above 0")),
    ("current_limit_A = inf", ("current_limit_A", "finite")),
    ("supply_V = -24", ("supply_V", "0 or more")),
    ("watchdog_s = -1", ("watchdog_s", "0 for none")),
    ('protocol = "canopen"\nwatchdog_s = 0.5', ("watchdog_s", "1016h", "take it out")),
    ("gear = 3", ("rig.drives.gear", "no known key"))])
def test_a_wrong_key_of_the_drives_is_refused_in_one_line(keys: str, words: tuple[str, ...], tmp_path: Path) -> None:
    with pytest.raises(BadInput) as refused:
        settings_of(tmp_path, keys + "\n", protocol=None if "protocol" in keys else "canopen")
    assert all(word in str(refused.value) for word in words), refused.value
    assert "\n" not in str(refused.value)


def test_a_drive_takes_its_motor_from_the_vehicle_and_the_rest_from_its_protocol(tmp_path: Path) -> None:
    found = settings_of(tmp_path, 'protocol = "robomaster"\n')
    assert found.node_ids == (1, 2, 3) and found.driven == (True, True, True)
    assert found.numbers["gear_ratio"] == (16.0,) * 3 and found.origins["gear_ratio"] == "vehicle.motor.gear_ratio"
    assert found.numbers["encoder_counts"] == (8192.0,) * 3 and "C620" in found.origins["encoder_counts"]
    assert found.numbers["winding_resistance_ohm"] == (5.95,) * 3


def test_a_list_is_for_each_wheel_and_a_wheel_without_a_motor_has_no_drive(tmp_path: Path) -> None:
    keys = "node_ids = [5, 6, false, false]\ngear_ratio = [25, -25]\nencoder_counts = 1000\n"
    found = settings_of(tmp_path, keys, "example_two_wheel_sizes", "canopen")
    assert found.driven == (True, True, False, False) and found.node_ids == (5, 6, 0, 0)
    assert found.numbers["gear_ratio"] == (25.0, -25.0, 0.0, 0.0)
    assert found.numbers["encoder_counts"] == (1000.0, 1000.0, 0.0, 0.0)
    short = settings_of(tmp_path, "node_ids = [5, 6]\n", "example_two_wheel_sizes", "canopen")
    assert short.node_ids == (5, 6, 0, 0)


def test_gains_follow_from_the_inertia_that_a_wheel_turns_and_the_bandwidth_from_the_step(tmp_path: Path) -> None:
    scene = scene_with(tmp_path, 'protocol = "canopen"\n')
    found = drive_settings(scene, None)
    inertia = 0.0019 + 16.0**2 * 1.044843950562466e-5 + 8.0 * 0.04**2 / 3
    assert found.numbers["speed_gain_As"][0] == pytest.approx(30.0 * inertia / (16.0**2 * 0.0514))
    assert found.numbers["speed_integral_gain_A"][0] == pytest.approx(7.5 * found.numbers["speed_gain_As"][0])
    slow = drive_settings(scene.with_run(step_s=0.01), None)
    assert slow.numbers["speed_gain_As"][0] == pytest.approx(found.numbers["speed_gain_As"][0] / 3)


def test_a_place_that_no_shaft_reaches_is_taken_as_the_farthest_that_an_encoder_counts() -> None:
    scene = read_scene("canopen_agv")
    drive = DriveGroup(drive_settings(scene, "canopen"), "double", 0.001).drives[0]
    towards = math.copysign(1.0, drive.gear_ratio)
    for place_rad in (1e30, -1e300):
        drive.aim(POSITION, place_rad)
        assert math.copysign(1.0, drive.act(0.001)) == math.copysign(towards, place_rad * towards)


def test_a_played_vehicle_keeps_rotor_and_viscous_friction_of_its_motor_alone() -> None:
    scene = read_scene("kuka_youbot")
    alone, before = played(scene).c_vehicle(scene.core()), scene.c_vehicle(scene.core())
    assert alone.motor_gain_Nm_per_V == 0.0 and alone.wheel_inertia_kgm2 == before.wheel_inertia_kgm2
    motor = scene.vehicle["motor"]
    viscous = motor["viscous_friction_Nms"] * motor["gear_ratio"] ** 2
    assert alone.motor_damping_Nms == pytest.approx(viscous) and before.motor_damping_Nms > viscous
