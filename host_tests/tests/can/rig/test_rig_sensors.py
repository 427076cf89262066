"""Sensors over a bus: the node's IMU and encoders are the core's, bit for bit, and in scaled frames to half a step."""

from __future__ import annotations

import json
from dataclasses import astuple, replace
from pathlib import Path

import can
import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.can.rig.boards import emulated_node, own_node, why_no_emulation
from laconic.can.rig.buses import virtual_node
from laconic.can.rig.client import read_estimate
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.free_judge import judge_free_run
from laconic.can.rig.judge import judge_same_bits, judge_scaled
from laconic.can.rig.live import View
from laconic.can.rig.lockstep import load_scene, run_lockstep, twin_states
from laconic.can.rig.wire import wire
from laconic.cli.main import run as run_command
from laconic.core import REALS
from laconic.errors import BadInput
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXACT, EXPLICIT

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


# ---- The error estimate over a bus: a node's pages are the core's numbers, its bits are those without, and it is
# shown.

STEPS = 300


def estimated_scene(real: str = "double", name: str = "robotino2") -> Scene:
    """One whose errors are far from rounding, with the estimate among its frames."""
    scene = read_scene(name).with_run(real=real, method=EXACT, step_s=0.02)
    return replace(scene, rig=replace(scene.rig, frames=("NU", "ERROR_ESTIMATE")))


def expected(scene: Scene) -> list[float]:
    """What the core's estimate says after the same inputs, in the frame's single precision: now, then the largest."""
    plant, inputs = scene.plant(scene.core()), scene.inputs_on_grid()
    estimate = plant.estimate()
    for tick in range(STEPS):
        estimate.run(plant.core.input(plant.core.input_row(inputs.held_at(tick))))
    errors = estimate.read()
    return [float(np.float32(value)) for value in (*astuple(errors.now), *astuple(errors.largest))]


@pytest.mark.parametrize("real", REALS)
def test_after_a_run_all_pages_are_the_cores_numbers(real: str) -> None:
    scene = estimated_scene(real)
    with virtual_node(real) as node:
        run = run_lockstep(node, scene, STEPS, every=7)
        figures = read_estimate(node)
    assert run.states.tobytes() == twin_states(scene, run).tobytes()
    assert list(figures.values()) == [*expected(scene), 0.0]
    assert min(expected(scene)) > 0.0
    assert list(figures)[:2] == ["estimated_error_nu_rad_per_s", "estimated_error_place_m"]


def test_the_command_shows_it_in_every_mode(tmp_path, capsys) -> None:
    path, text = tmp_path / "s.toml", read_scene("robotino2").path.read_text(encoding="utf-8")
    rig = 'frames = ["NU", "POSE", "ERROR_ESTIMATE"]\n'
    path.write_text(text.replace("[rig]\n", "[rig]\n" + rig) if "[rig]" in text else text + "\n[rig]\n" + rig,
                    encoding="utf-8")
    for mode in ("--lockstep", "--same-bits", "--free-run"):
        assert run_command(["rig", str(path), mode, "--steps", "200", "--json"]) == 0
        figures = json.loads(capsys.readouterr().out)["figures"]
        assert 0.0 < figures["estimated_error_place_m"] <= figures["largest_estimated_error_place_m"] < 1e-3
        assert figures["estimate_unknown_windows"] == 0.0


def test_unless_a_scene_asks_for_it_no_page_comes() -> None:
    scene = read_scene("robotino2")
    with virtual_node("double") as node:
        seen: list[int] = []
        node.link.listeners.append(lambda message: seen.append(message.arbitration_id))
        judgement = judge_scaled(node, scene, 50, {})
        assert read_estimate(node) == {}
    assert judgement.passed
    assert node.link.id_base + wire()["ERROR_ESTIMATE"].offset not in seen


def test_pages_of_two_instants_are_not_mixed() -> None:
    scene = estimated_scene()
    with virtual_node("double") as node:
        run_lockstep(node, scene, STEPS, every=7)
        taken, receive = [], node.link.receive_until

        def loses_a_page(deadline_us: int):
            """The fourth page of the first instant."""
            received = receive(deadline_us)
            if received is not None and received[0].name == "ERROR_ESTIMATE":
                taken.append(received[0].unpack(received[1])["page"])
                if len(taken) == 4:
                    return receive(deadline_us)
            return received

        node.link.receive_until = loses_a_page
        assert list(read_estimate(node).values()) == [*expected(scene), 0.0]
    assert len(taken) > 8


def test_the_live_view_shows_the_numbers_in_their_units() -> None:
    frame = wire()["ERROR_ESTIMATE"]
    data = frame.pack(page=1, unknown=2)
    data[2:6] = np.float32(1.5e-9).tobytes()
    assert frame.physical(data) == {"crc": 0.0, "counter": 0.0, "page": 1.0, "place": pytest.approx(1.5e-9, rel=1e-7),
                                    "unknown": 2.0}
    with virtual_node("double") as node:
        view = View(node.link, "s", 10)
        identifier = node.link.id_base + frame.offset
        view.take(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))
        assert view.text_of((frame.offset, 1)) == "place 1.5e-09  unknown 2"


def test_a_node_of_another_process_sends_it() -> None:
    with own_node("process", "double", 0x680) as node:
        run_lockstep(node, estimated_scene(), 50)
        assert read_estimate(node)["estimated_error_place_m"] > 0.0


@pytest.mark.skipif(why_no_emulation() is not None, reason=why_no_emulation() or "")
def test_an_image_that_has_none_refuses_it() -> None:
    with emulated_node("an386-small") as node:
        load_scene(node, read_scene("robotino2").with_run(real="single", method=EXPLICIT))
        with pytest.raises(NodeRefused) as refused:
            node.select(send_nu=1, send_error_estimate=1)
        assert (refused.value.command, refused.value.status) == ("select", "not supported")
