"""Drives on steering axes of a played vehicle: CiA 402 by PyPI's canopen, ODrive positions, and what is refused."""

from __future__ import annotations

import copy
import math
import struct
from pathlib import Path
from typing import Any

import can
import numpy as np
import pytest
from canopen.profiles.p402 import BaseNode402
from canopen_bus import Played, played_on_canopen

from laconic import build_scene
from laconic.can.play.options import PlayOptions
from laconic.can.play.places import place_of
from laconic.can.play.protocols import ORDERS, STALL
from laconic.can.play.settings import drive_settings
from laconic.can.play.vehicle import played as without_motors
from laconic.can.rig.boards import why_no_emulation
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.pictures.views.recorded import Recorded
from laconic.scene import Scene, read_scene
from laconic.scene.scene_tables import scene_tables
from play_support import played

TURN = 2.0 * math.pi
AGV_COUNTS = 4096 * 100  # of the steering axis of tricycle_agv for one turn of the wheel


def tables_of(name: str, **changes: Any) -> dict[str, Any]:
    return copy.deepcopy(scene_tables(name).entries) | changes


@pytest.mark.parametrize("real", ["double", "single"])
def test_profile_position_steers_a_tricycle_by_the_canopen_package(real: str, tmp_path: Path) -> None:
    angle_rad, shaft_rad_per_s = 0.4, 60.0
    with played_on_canopen(read_scene("tricycle_agv").with_run(real=real), tmp_path) as vehicle:
        nodes = {node_id: vehicle.node(node_id, BaseNode402) for node_id in (1, 2)}
        for node, mode in zip(nodes.values(), (3, 1), strict=True):
            node.sdo["Modes of operation"].raw = mode
            node.nmt.state = "PRE-OPERATIONAL"
            node.setup_402_state_machine()
            node.nmt.state = "OPERATIONAL"
            node.state = "OPERATION ENABLED"
        nodes[2].sdo["Profile velocity"].raw = round(2.0 / TURN * AGV_COUNTS)
        for ramp in ("Profile acceleration", "Profile deceleration"):
            nodes[2].sdo[ramp].raw = round(10.0 / TURN * AGV_COUNTS)
        nodes[2].sdo["Target position"].raw = round(angle_rad / TURN * AGV_COUNTS)
        nodes[2].controlword = 0x3F  # a new set-point, at once
        nodes[1].sdo["Target velocity"].raw = round(shaft_rad_per_s / TURN * 4096)
        vehicle.step(2400)
        steering, traction = vehicle.drive(1), vehicle.drive(0)
        assert (steering.wheel, traction.wheel) == (3, 0)  # behind three wheels
        assert steering.wheel_angle_rad == pytest.approx(angle_rad, abs=1e-3)
        assert nodes[2].sdo["Position actual value"].raw == pytest.approx(angle_rad / TURN * AGV_COUNTS, abs=80)
        now = vehicle.vehicle.node.motion()
        rolls = shaft_rad_per_s / 20.0 * 0.115
        assert now.yaw_rate_rad_per_s == pytest.approx(rolls * math.sin(angle_rad) / 1.4, rel=2e-3)


def test_the_core_takes_the_same_steps_with_the_torques_of_the_drives(tmp_path: Path) -> None:
    scene = read_scene("tricycle_agv")
    bare = without_motors(scene).articulated_vehicle(scene.core())
    plant, row = bare.plant("auto", scene.run.step_s), bare.input_row()
    slots = [bare.slot(name) for name in ("axle_torque_Nm[1]", "hinge_torque_Nm[front]")]
    with played_on_canopen(scene, tmp_path) as vehicle:
        for node_id, target in ((1, 4000), (2, 30000)):
            node = vehicle.node(node_id, BaseNode402)
            node.sdo["Modes of operation"].raw = 3
            node.nmt.state = "PRE-OPERATIONAL"
            node.setup_402_state_machine()
            node.nmt.state = "OPERATIONAL"
            node.state = "OPERATION ENABLED"
            node.sdo["Target velocity"].raw = target
        for _ in range(400):
            vehicle.step()
            row[slots] = [vehicle.drive(number).axle_torque_Nm for number in (0, 1)]
            plant.follow(np.array([[row, row]]))
            now, wanted = vehicle.vehicle.node.motion(), plant.motion()
            assert (now.x_m, now.y_m, now.yaw_rate_rad_per_s) == (wanted.x_m, wanted.y_m, wanted.yaw_rate_rad_per_s)
            assert vehicle.drive(1).wheel_angle_rad == wanted.hinge_angle_rad[0]
    assert abs(wanted.hinge_angle_rad[0]) > 0.01 and wanted.x_m > 0.01


# ---- ODrive


def cansimple(node_id: int, command: int, layout: str, *values: float) -> can.Message:
    """A frame of ODrive's CANSimple, from its documentation."""
    return can.Message(arbitration_id=node_id << 5 | command, is_extended_id=False, data=struct.pack(layout, *values))


SET_AXIS_STATE, SET_CONTROLLER_MODE, SET_INPUT_POS, SET_INPUT_VEL, ENCODER_ESTIMATES = 0x07, 0x0B, 0x0C, 0x0D, 0x09
CLOSED_LOOP, BY_VELOCITY, BY_POSITION, PASSTHROUGH = 8, 2, 3, 1


@pytest.mark.parametrize("real", ["double", "single"])
def test_odrive_positions_steer_a_tugger_whose_axis_follows_commands(real: str) -> None:
    """Nodes 1 and 2 turn the rear wheels, node 3 the prescribed steering axis, by turns of its shaft."""
    drives = {"protocol": "odrive", "node_ids": [1, 2, 3], "gear_ratio": [20.0, 20.0, 50.0]}
    scene, angle_rad = build_scene(tables_of("tugger_train", rig={"drives": drives})).with_run(real=real), 0.3

    modes = [(1, BY_VELOCITY), (2, BY_VELOCITY), (3, BY_POSITION)]

    def commands(now_s: float) -> list[can.Message]:
        if modes:
            chosen = list(modes)
            modes.clear()
            return [message for node_id, control in chosen
                    for message in (cansimple(node_id, SET_CONTROLLER_MODE, "<II", control, PASSTHROUGH),
                                    cansimple(node_id, SET_AXIS_STATE, "<I", CLOSED_LOOP))]
        speed = min(now_s, 2.0) * 5.0 / TURN
        return [*(cansimple(node_id, SET_INPUT_VEL, "<ff", speed, 0.0) for node_id in (1, 2)),
                cansimple(3, SET_INPUT_POS, "<fhh", angle_rad / TURN * 50.0, 0, 0)]

    judgement, controller = played(scene, 4.0, commands)
    assert judgement.passed, judgement.verdicts
    place, speed = struct.unpack("<ff", controller.of(3 << 5 | ENCODER_ESTIMATES)[-1][1].data)
    assert place / 50.0 * TURN == pytest.approx(angle_rad, abs=1e-4) and abs(speed) < 1e-3
    assert judgement.figures["end_heading_rad"] > 0.02


# ---- ground with friction

SERVO = {"servo_gain_Nm_per_rad": 20.0, "servo_damping_Nms": 0.5, "servo_limit_Nm": 5.0}
MODULE = {"kind": "fixed", "mass_kg": 1.0, "yaw_inertia_kgm2": 0.002}
PLACES = {"front_left": (0.2, 0.2), "front_right": (0.2, -0.2), "rear_left": (-0.2, 0.2), "rear_right": (-0.2, -0.2)}
VEHICLE = {"mass_kg": 20.0, "yaw_inertia_kgm2": 1.0, "com_z_m": 0.12, "wheel_radius_m": 0.05,
           "wheel_inertia_kgm2": 6e-4, "motor_gain_Nm_per_V": 0.35, "motor_damping_Nms": 0.2}


def swerve(kind: str = "servo", rig: dict[str, Any] | None = None, real: str = "double", **hinge: Any) -> Scene:
    """Four modules on ground with friction; `kind` and `hinge`: what turns each."""
    own = hinge or {"servo": SERVO, "coordinated": {"rate_limit_rad_per_s": 12.0}}.get(kind, {})
    wheels = [{**MODULE, "steered": kind, "name": name, "x_m": x, "y_m": y, **own} for name, (x, y) in PLACES.items()]
    return build_scene({"vehicle": {**VEHICLE, "wheel": wheels}, "ground": {"friction_coefficient": 0.7},
                        "rig": rig or {}, "run": {"duration_s": 1.0, "step_s": 0.002, "real": real}})


def enabled(vehicle: Played, node_id: int, mode: int) -> Any:
    """A drive that follows targets from now on."""
    node = vehicle.node(node_id, BaseNode402)
    node.sdo["Modes of operation"].raw = mode
    node.nmt.state = "PRE-OPERATIONAL"
    node.setup_402_state_machine()
    node.nmt.state = "OPERATIONAL"
    node.state = "OPERATION ENABLED"
    return node


@pytest.mark.parametrize("real", ["double", "single"])
def test_slipping_wheels_and_axes_take_the_steps_of_the_core_with_the_torques_of_the_drives(real: str,
                                                                                           tmp_path: Path) -> None:
    scene = swerve(real=real)
    bare = without_motors(scene).slipping_vehicle(scene.core())
    plant, row = bare.plant(step_s=scene.run.step_s), bare.input_row()
    names = [*(f"axle_torque_Nm[{wheel}]" for wheel in range(1, 5)), *(f"hinge_torque_Nm[{name}]" for name in PLACES)]
    slots = [bare.slot(name) for name in names]
    with played_on_canopen(scene, tmp_path) as vehicle:
        targets = (20000, 4000, 4000, 4000, 1500, 500, -500, 300)  # of which the first wheel spins
        for node_id, target in enumerate(targets, start=1):
            enabled(vehicle, node_id, 3).sdo["Target velocity"].raw = target
        plant.run(row, vehicle.vehicle.node.inspect()["steps"])
        for _ in range(300):
            vehicle.step()
            row[slots] = [vehicle.drive(number).axle_torque_Nm for number in range(8)]
            plant.follow(row[None])
            now, wanted = vehicle.vehicle.node.motion(), plant.motion()
            assert (now.x_m, now.y_m, now.yaw_rate_rad_per_s) == (wanted.x_m, wanted.y_m, wanted.yaw_rate_rad_per_s)
            angles = [*wanted.wheel_angle_rad, *wanted.hinge_angle_rad]
            assert [vehicle.drive(number).wheel_angle_rad for number in range(8)] == angles
    assert plant.outputs().contact_state.any() and abs(wanted.hinge_angle_rad[0]) > 0.01 and wanted.x_m > 0.01


@pytest.mark.parametrize("kind, hinge", [
    ("servo", {}), ("coordinated", SERVO), *(pytest.param(*each, marks=pytest.mark.nightly) for each in (
        ("coordinated", {}), ("prescribed", {}),
        ("motor", {"steering_gain_Nm_per_V": 0.5, "steering_damping_Nms": 0.1}))),
    ("motor", {"steering_gain_Nm_per_V": 0.5, "loop_V_per_rad": 30.0, "loop_Vs_per_rad": 1.0})])
def test_drives_steer_a_swerve_that_slips_whatever_turned_its_modules(kind: str, hinge: dict[str, Any],
                                                                    tmp_path: Path) -> None:
    angle_rad, per_turn = 0.4, 4096
    with played_on_canopen(swerve(kind, **hinge), tmp_path) as vehicle:
        for node_id in range(1, 9):
            node = enabled(vehicle, node_id, 3 if node_id < 5 else 1)
            if node_id < 5:
                node.sdo["Target velocity"].raw = round(5.0 / TURN * per_turn)
                continue
            node.sdo["Profile velocity"].raw = round(4.0 / TURN * per_turn)
            for ramp in ("Profile acceleration", "Profile deceleration"):
                node.sdo[ramp].raw = round(20.0 / TURN * per_turn)
            node.sdo["Target position"].raw = round(angle_rad / TURN * per_turn)
            node.controlword = 0x3F
        vehicle.step(600)
        now = vehicle.vehicle.node.motion()
        for number in range(4, 8):
            assert vehicle.drive(number).wheel_angle_rad == pytest.approx(angle_rad, abs=3e-3)
        assert math.hypot(*now.velocity_m_per_s) == pytest.approx(5.0 * 0.05, rel=0.02)
        assert math.atan2(now.velocity_m_per_s[1], now.velocity_m_per_s[0]) == pytest.approx(angle_rad, abs=0.01)


def test_a_servo_without_a_drive_keeps_its_start_angle_and_one_with_a_drive_does_not(tmp_path: Path) -> None:
    scene = swerve(rig={"drives": {"node_ids": [1, 2, 3, 4, 5, False, False, False]}}, start_angle_rad=0.3, **SERVO)
    behind = without_motors(scene, drive_settings(scene, "canopen").driven)
    assert [hinge.kind for hinge in behind.hinges] == ["motor", "servo", "servo", "servo"]
    bare = behind.slipping_vehicle(behind.core())
    plant = bare.plant(step_s=scene.run.step_s, hinge_angle_rad=[0.3] * 4)
    row = bare.input_row({"steering_angle_rad": [0.3] * 4})
    with played_on_canopen(scene, tmp_path) as vehicle:
        enabled(vehicle, 5, 3).sdo["Target velocity"].raw = -2000
        for _ in range(200):
            vehicle.step()
            row[bare.slot("hinge_torque_Nm[front_left]")] = vehicle.drive(4).axle_torque_Nm
            plant.follow(row[None])
        now, wanted = vehicle.vehicle.node.motion(), plant.motion()
        assert (now.x_m, now.y_m, now.yaw_rate_rad_per_s) == (wanted.x_m, wanted.y_m, wanted.yaw_rate_rad_per_s)
    assert wanted.hinge_angle_rad[0] < 0.2 and wanted.hinge_angle_rad[1:] == pytest.approx([0.3] * 3, abs=0.02)


@pytest.mark.parametrize("drive, axis", [(0, "wheel"), (5, "hinge")])
def test_a_brake_by_order_stalls_the_drive_of_a_wheel_or_axis_that_may_slip(drive: int, axis: str,
                                                                          tmp_path: Path) -> None:
    scene = swerve(rig={"drives": {"stall_time_s": 0.1, "current_limit_A": 2.0}})
    with played_on_canopen(scene, tmp_path) as vehicle:
        node = enabled(vehicle, drive + 1, 3)
        vehicle.vehicle.order(drive + 1, ORDERS[STALL])
        before = vehicle.drive(drive).wheel_angle_rad
        node.sdo["Target velocity"].raw = 4000
        vehicle.step(150)
        assert vehicle.drive(drive).wheel_angle_rad == pytest.approx(before, abs=1e-6), axis
        assert node.sdo[0x603F].raw == 0x7121  # stalled
        vehicle.vehicle.order(drive + 1, 0)
        node.controlword = 0x80
        enabled(vehicle, drive + 1, 3).sdo["Target velocity"].raw = 4000
        vehicle.step(150)
        assert abs(vehicle.drive(drive).wheel_angle_rad - before) > 0.05


def test_the_command_plays_a_swerve_that_slips_and_breaks_its_steering(capsys: pytest.CaptureFixture[str],
                                                                      tmp_path: Path) -> None:
    arguments = ["--drives", "odrive", "--listen", "0", "--duration", "0.3", "--fault", "stall:6@0.1"]
    assert run(["play", "swerve_module_off", *arguments]) == 0
    assert "never fired" in capsys.readouterr().out
    assert run(["play", "swerve_module_off", "--board", "process", *arguments]) == 0


@pytest.mark.nightly
@pytest.mark.skipif(why_no_emulation() is not None, reason="no emulated boards")
def test_an_emulated_board_plays_a_swerve_that_slips(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--real", "single", "--step", "0.01", "--drives", "odrive", "--listen", "0", "--duration", "0.5"]
    assert run(["play", "swerve_module_off", "--board", "an386-slip", *arguments]) == 0
    assert "never fired" in capsys.readouterr().out


# ---- settings and refusals


def test_a_steering_motor_gives_its_drive_gear_and_constants() -> None:
    found = drive_settings(read_scene("tricycle_agv"), "canopen")
    assert found.driven == (True, False, False, True) and found.node_ids[0] == 1 and found.node_ids[3] == 2
    assert found.numbers["gear_ratio"] == (20.0, 0.0, 0.0, 100.0)
    assert ("of", "1 front", "wheels by number, hinges by name") in [*found.rows()]
    assert found.numbers["torque_constant_Nm_per_A"] == (0.09, 0.0, 0.0, 0.07)


def test_the_drive_of_a_steering_motor_replaces_it_but_for_its_friction() -> None:
    body, = without_motors(read_scene("tricycle_agv")).vehicle["body"]
    assert (body["gain_Nm_per_V"], body["damping_Nms"]) == (0.0, pytest.approx(100.0**2 * 1e-4))


@pytest.mark.parametrize("name, drives, message", [
    ("mir_like", {"node_ids": [1, 2, False, False, False, False, 3, False, False, False]},
     "gives hinge 1 a drive, and it is neither a motor nor prescribed"),
    ("tricycle_agv", {"node_ids": [1, False, False]},
     "has 3 entries; give one for each of the 3 wheels, then of the 1 hinges"),
    ("tricycle_agv", {"node_ids": [1, 1]}, "1 is given twice")])
def test_a_list_of_drives_counts_wheels_and_then_hinges(name: str, drives: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        drive_settings(build_scene(tables_of(name, rig={"drives": {"protocol": "canopen", **drives}})), None)


@pytest.mark.parametrize("arguments, message", [
    (["f1tenth", "--drives", "odrive"], "coordinated ones turn together"),
    (["tricycle_agv", "--drives", "canopen", "--fault", "stall:1@1"],
     "no brake holds a vehicle with hinges on ideal ground"),
    (["tricycle_agv", "--drives", "canopen", "--bag", "out.mcap"], "--bag does not take vehicles with hinges yet")])
def test_what_cannot_be_played_is_refused_in_one_line(arguments: list[str], message: str,
                                                      capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", *arguments, "--listen", "0", "--duration", "1"]) == 2
    told = capsys.readouterr().err
    assert message in told and told.count("\n") == 1


@pytest.mark.parametrize("option", ["bag", "foxglove", "rerun"])
def test_recordings_of_hinges_are_refused_before_a_bus_is_opened(option: str) -> None:
    options = PlayOptions(listen=0, drives="canopen", recorded=Recorded(**{option: Path("out.mcap")}))
    with pytest.raises(BadInput, match=f"--{option} does not take vehicles with hinges yet"):
        place_of(read_scene("tricycle_agv"), options)


def test_a_node_process_plays_a_vehicle_with_hinges(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "tricycle_agv", "--drives", "canopen", "--board", "process", "--listen", "0",
                "--duration", "0.3"]) == 0
    assert "never fired" in capsys.readouterr().out
