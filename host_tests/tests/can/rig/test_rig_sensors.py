"""Sensors over a bus: the node's IMU and encoders are the core's, bit for bit, and in scaled frames to half a step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.can.rig.boards import own_node
from laconic.can.rig.buses import virtual_node
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.free_judge import judge_free_run
from laconic.can.rig.judge import judge_same_bits, judge_scaled
from laconic.can.rig.lockstep import run_lockstep, twin_states
from laconic.core import REALS
from laconic.errors import BadInput
from laconic.scene import Scene, read_scene

SENSORS = """
[sensors.imu]
x_m = 0.05
y_m = -0.02
heading_deg = 30
acceleration_bias_m_per_s2 = [0.05, -0.02]
acceleration_scale_error = 0.01
acceleration_noise_m_per_s2_per_sqrt_Hz = 2e-3
yaw_rate_noise_rad_per_s_per_sqrt_Hz = 1e-3
yaw_rate_range_rad_per_s = 1.5
delay_s = 0.02
seed = 5

[sensors.encoder]
counts_per_turn = 1024
gear_ratio = -30.5
wrap = 4096
"""
FRAMES = ("NU", "WHEEL_ANGLE", "IMU", "ENCODER")


def scene_with_sensors(folder: Path, name: str, real: str = "double", sensors: str = SENSORS) -> Scene:
    """One of the project's scenes, with sensors on it."""
    path = folder / f"{name}.toml"
    path.write_text((SOURCE_DIR / "scenes" / f"{name}.toml").read_text(encoding="utf-8") + sensors, encoding="utf-8")
    return read_scene(path).with_run(real=real)


@pytest.mark.parametrize("every", [1, 10])
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("name", ["turtlebot3_burger", "skid_steer"])
def test_the_nodes_sensors_have_the_bits_of_the_core(tmp_path: Path, name: str, real: str, every: int) -> None:
    scene = scene_with_sensors(tmp_path, name, real)
    every = every if scene.inputs_on_grid().is_held else 1
    with virtual_node(real) as node:
        run = run_lockstep(node, scene, 500, every=every, fd=True)
    theirs, wheels = twin_states(scene, run), scene.wheel_count
    shown = run.states[:, 6 + 2 * wheels :]
    assert shown.shape[1] == 5 + wheels and (shown.std(axis=0) > 0.0).all() and np.isfinite(shown).all()
    assert run.states.tobytes() == theirs.tobytes()


def test_a_node_has_the_bits_of_an_encoder_of_32_bits_without_sign(tmp_path: Path) -> None:
    sensors = SENSORS.replace("wrap = 4096", f"wrap = {2**32}")
    scene = scene_with_sensors(tmp_path, "turtlebot3_burger", sensors=sensors)
    with virtual_node() as node:
        run = run_lockstep(node, scene, 100, every=1, fd=True)
    assert run.states.tobytes() == twin_states(scene, run).tobytes() and run.states[-1, -2:].min() < 0.0
    scaled = replace(scene, rig=replace(scene.rig, frames=FRAMES))
    with virtual_node() as node:
        assert judge_scaled(node, scaled, 100, {}).passed
    with own_node("virtual", "double") as node:
        assert judge_free_run(node, scaled, 0.5, 100, 0, {}).passed


def test_the_judge_compares_every_number_of_the_sensors(tmp_path: Path) -> None:
    with virtual_node() as node:
        judgement = judge_same_bits(node, scene_with_sensors(tmp_path, "turtlebot3_burger"), 50)
    assert judgement.passed, judgement.verdicts
    assert {"acceleration_body", "imu", "encoder_count"} <= {each.name for each in judgement.verdicts}


@pytest.mark.parametrize("real", REALS)
def test_scaled_frames_of_sensors_agree_to_half_a_step(tmp_path: Path, real: str) -> None:
    scene = scene_with_sensors(tmp_path, "turtlebot3_burger", real)
    scene = replace(scene, rig=replace(scene.rig, frames=FRAMES))
    with virtual_node(real) as node:
        judgement = judge_scaled(node, scene, 400, {})
    assert judgement.passed, judgement.verdicts
    names = {each.name for each in judgement.verdicts}
    assert {"IMU.acceleration_x", "IMU.yaw_rate", "WHEEL_ANGLE.wheel_angle_2", "ENCODER.count_1",
            "ENCODER.index_count_2"} <= names


def test_a_free_run_is_judged_by_its_sensors_too(tmp_path: Path) -> None:
    scene = scene_with_sensors(tmp_path, "turtlebot3_burger")
    scene = replace(scene, rig=replace(scene.rig, frames=FRAMES))
    with own_node("virtual", "double") as node:
        judgement = judge_free_run(node, scene, 2.0, 100, 0, {})
    assert judgement.passed, judgement.verdicts
    assert {"IMU.acceleration_y", "ENCODER.count"} <= {each.name for each in judgement.verdicts}


def test_an_imu_can_be_read_of_a_scene_without_one_and_is_ideal(tmp_path: Path) -> None:
    scene = read_scene("turtlebot3_burger")
    scene = replace(scene, rig=replace(scene.rig, frames=("NU", "IMU")))
    with virtual_node() as node:
        judgement = judge_scaled(node, scene, 100, {})
    assert judgement.passed and "IMU.acceleration_x" in {each.name for each in judgement.verdicts}


@pytest.mark.parametrize("frames, said", [(("ENCODER",), "give [sensors.encoder]"), (("IMUS",), "known are")])
def test_frames_that_never_come_are_refused(tmp_path: Path, frames: tuple[str, ...], said: str) -> None:
    scene = read_scene("turtlebot3_burger")
    with virtual_node() as node, pytest.raises(BadInput) as refused:
        judge_scaled(node, replace(scene, rig=replace(scene.rig, frames=frames)), 10, {})
    assert "rig.frames" in str(refused.value) and said in str(refused.value)


def test_the_node_names_the_setting_that_it_refuses(tmp_path: Path) -> None:
    scene = scene_with_sensors(tmp_path, "turtlebot3_burger")
    with virtual_node() as node:
        node.open()
        twin, start = scene.plant(scene.core()), scene.c_start(scene.core())
        with pytest.raises(NodeRefused, match="negative, wheel encoder wrap"):
            node.load(twin, start, [("WHEEL_ENCODER_WRAP", 0, -1)])
        with pytest.raises(NodeRefused, match="above limit, imu delay"):
            node.load(twin, start, [("IMU_DELAY", 0, 1000)])
