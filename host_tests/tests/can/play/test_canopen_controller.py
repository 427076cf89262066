"""PyPI's canopen, which others wrote and use with real drives, drives three-wheeled vehicles unchanged."""

from __future__ import annotations

from configparser import ConfigParser
from dataclasses import replace
from pathlib import Path

import canopen
import numpy as np
import pytest
from canopen.objectdictionary import ODVariable
from canopen.profiles.p402 import BaseNode402
from canopen_bus import Played, download, played_on_canopen

from laconic.base.paths import SCENE_DIR
from laconic.can.play.canopen_eds import EdsDrive, eds_of_scene, eds_text
from laconic.can.play.vehicle import played as without_motors
from laconic.cli.main import run
from laconic.scene import read_scene

NODE_IDS = (1, 2, 3)


@pytest.fixture
def vehicle(tmp_path):
    with played_on_canopen(read_scene(SCENE_DIR / "robotino2.toml"), tmp_path) as found:
        yield found


def begin(node: BaseNode402) -> None:
    """Reads the node's mapping while it is pre-operational, so that its first frame is heard."""
    node.nmt.state = "PRE-OPERATIONAL"
    node.setup_402_state_machine()


def enabled(played: Played, mode: int, *, cyclic: bool = False) -> list[BaseNode402]:
    """All nodes in operation enabled, as an application brings them there."""
    nodes = [played.node(node_id, BaseNode402) for node_id in NODE_IDS]
    for node in nodes:
        node.sdo["Modes of operation"].raw = mode
        begin(node)
        if cyclic:
            node.rpdo[2].trans_type = 1  # target velocity, at the next SYNC
            node.rpdo[2].save()
        node.nmt.state = "OPERATIONAL"
        node.state = "OPERATION ENABLED"
        assert node.state == "OPERATION ENABLED" and node.sdo["Modes of operation display"].raw == mode
    return nodes


@pytest.mark.parametrize("real, cycles", [
    pytest.param("double", 10_000, marks=pytest.mark.nightly), ("double", 1000), ("single", 500)])
def test_ten_thousand_cycles_by_sync_move_the_wheels_as_the_torques_do(real: str, cycles: int, tmp_path: Path) -> None:
    """Cyclic synchronous velocity; a plant that is fed with the torques of the drives takes the same steps, bit for
    bit."""
    with played_on_canopen(read_scene(SCENE_DIR / "robotino2.toml").with_run(real=real), tmp_path) as vehicle:
        check_cycles(vehicle, cycles)


def check_cycles(vehicle: Played, cycles: int) -> None:
    """Drives so many cycles and compares them with the core alone."""
    nodes = enabled(vehicle, 9, cyclic=True)
    torques, speeds, angles = (np.zeros((cycles, 3)) for _ in range(3))
    first = vehicle.vehicle.node.inspect()["steps"]
    reference = Reference(vehicle, first)
    heard = 0
    for cycle in range(cycles):
        for k, node in enumerate(nodes):
            node.rpdo[2]["Target velocity"].raw = round(20000 * np.sin(2e-3 * cycle + 2 * k))
            node.rpdo[2].transmit()
        vehicle.network.sync.transmit()
        vehicle.step()
        for k in range(3):
            seen = vehicle.drive(k)
            torques[cycle, k], speeds[cycle, k] = seen.axle_torque_Nm, seen.wheel_speed_rad_per_s
            angles[cycle, k] = seen.wheel_angle_rad
        heard += nodes[1].tpdo[2]["Velocity actual value"].raw != 0
    wanted_speeds, wanted_angles = reference.follow(torques)
    assert np.array_equal(speeds, wanted_speeds) and np.array_equal(angles, wanted_angles)
    assert np.ptp(speeds) > 1.0 and np.abs(torques).max() > 0.1
    assert heard > 0.98 * cycles


class Reference:
    """The core alone, without drives, from the state in which a run begins."""

    def __init__(self, played: Played, steps: int):
        assert steps <= 1  # it stood still until now
        self.scene = without_motors(played.vehicle.scene)
        self.plant = self.scene.plant(self.scene.core())

    def follow(self, torques: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Wheel speeds and angles after each step."""
        core = self.plant.core
        first = core.input_fields["axle_torque_Nm"][0]
        speeds, angles = np.zeros_like(torques), np.zeros_like(torques)
        for k, row in enumerate(torques):
            held = np.zeros(core.input_length)
            held[first:first + 3] = row
            self.plant.run(core.input(held))
            speeds[k], angles[k] = self.plant.wheel_speeds(), self.plant.wheel_angles()
        return speeds, angles


def test_profile_velocity_by_sdo_alone_turns_the_vehicle_on_the_spot(vehicle: Played) -> None:
    nodes = enabled(vehicle, 3)
    for node in nodes:
        node.sdo["Target velocity"].raw = 5000
    vehicle.step(1500)
    for node in nodes:
        assert abs(node.sdo["Velocity actual value"].raw - 5000) < 100
        assert node.sdo["Statusword"].raw & 1 << 10  # target reached
    view = vehicle.drive(0)
    assert view.count == pytest.approx(nodes[0].sdo["Position actual value"].raw)
    for node in nodes:
        node.state = "QUICK STOP ACTIVE"
    vehicle.step(1500)
    assert {node.sdo["Statusword"].raw & 0x4F for node in nodes} == {0x40}
    assert abs(nodes[0].sdo["Velocity actual value"].raw) <= 100


def test_cyclic_position_and_profile_position_arrive(vehicle: Played) -> None:
    nodes = enabled(vehicle, 8)
    for cycle in range(1, 1001):
        for node in nodes:
            node.rpdo[3]["Target position"].raw = 4 * cycle
            node.rpdo[3].transmit()
        vehicle.step()
    vehicle.step(1500)
    assert [node.sdo["Position actual value"].raw for node in nodes] == pytest.approx([4000] * 3, abs=20)
    for node in nodes:
        node.op_mode = "PROFILED POSITION"
        node.sdo["Target position"].raw = 9000
        node.controlword = 0x1F
    vehicle.step(3000)
    assert [node.sdo["Position actual value"].raw for node in nodes] == pytest.approx([9000] * 3, abs=20)
    assert all(node.sdo["Statusword"].raw & 1 << 10 for node in nodes)


def test_the_client_walks_through_every_state_that_it_knows(vehicle: Played) -> None:
    node = vehicle.node(1, BaseNode402)
    begin(node)
    node.nmt.state = "OPERATIONAL"
    node.sdo["Quick stop option code"].raw = 6
    node.sdo["Disable operation option code"].raw = 0
    node.op_mode = "CYCLIC SYNCHRONOUS VELOCITY"
    for state in ("READY TO SWITCH ON", "SWITCHED ON", "OPERATION ENABLED", "SWITCHED ON", "READY TO SWITCH ON",
                  "OPERATION ENABLED", "QUICK STOP ACTIVE", "OPERATION ENABLED", "SWITCH ON DISABLED",
                  "OPERATION ENABLED", "READY TO SWITCH ON", "SWITCH ON DISABLED", "SWITCHED ON",
                  "SWITCH ON DISABLED"):
        node.state = state
        assert node.state == state


def test_homing_is_refused_and_the_mode_stays(vehicle: Played) -> None:
    node = vehicle.node(1, BaseNode402)
    begin(node)
    node.nmt.state = "OPERATIONAL"
    node.op_mode = "PROFILED VELOCITY"
    with pytest.raises(TypeError, match="HOMING"):
        node.op_mode = "HOMING"
    with pytest.raises(canopen.SdoAbortedError, match="0x06090030"):
        download(node, 0x6060, 0, b"\x06")
    assert node.op_mode == "PROFILED VELOCITY"


def test_a_fault_by_order_reaches_the_client_as_emcy_and_is_reset_by_it(vehicle: Played) -> None:
    nodes = enabled(vehicle, 9)
    node, lib = vehicle.vehicle.node, vehicle.vehicle.node.library.lib
    lib.laconic_library_drive_fail(node.c, 1, 1)  # the encoder
    vehicle.step()
    assert [each.emcy.active[0].code if each.emcy.active else 0 for each in nodes] == [0, 0x7305, 0]
    assert [each.state for each in nodes] == ["OPERATION ENABLED", "FAULT", "OPERATION ENABLED"]
    nodes[1].controlword = 0x80
    assert nodes[1].state == "SWITCH ON DISABLED" and not nodes[1].emcy.active


def test_a_client_that_goes_silent_stops_the_vehicle(vehicle: Played) -> None:
    nodes = enabled(vehicle, 3)
    for node in nodes:
        node.sdo["Consumer heartbeat time"][1].raw = 127 << 16 | 100
        node.sdo["Target velocity"].raw = 20000
    for _ in range(10):
        vehicle.network.send_message(0x700 + 127, [5])
        vehicle.step(90)
    assert abs(vehicle.drive(0).wheel_speed_rad_per_s) > 0.1
    vehicle.step(11)
    assert {node.emcy.active[0].code for node in nodes} == {0x8130}
    vehicle.step(1500)
    assert {node.sdo["Statusword"].raw & 0x4F for node in nodes} == {0x08}
    assert abs(nodes[0].sdo["Velocity actual value"].raw) < 500


def test_four_wheels_are_four_nodes(tmp_path) -> None:
    scene = read_scene(SCENE_DIR / "kuka_youbot.toml")
    with played_on_canopen(replace(scene, run=replace(scene.run, step_s=0.001)), tmp_path) as played:
        nodes = [played.node(node_id, BaseNode402) for node_id in (1, 2, 3, 4)]
        for node in nodes:
            node.sdo["Modes of operation"].raw = 3
            node.sdo["Controlword"].raw = 6
            node.sdo["Controlword"].raw = 15
            node.sdo["Target velocity"].raw = 10000
        played.step(2000)
        assert [node.sdo["Velocity actual value"].raw for node in nodes] == pytest.approx([10000] * 4, abs=200)


def test_a_client_that_wants_blocks_is_told_and_falls_back_to_segments(vehicle: Played) -> None:
    """The abort of a server without block transfer (CiA 301), after which its segments carry the same bytes."""
    node = vehicle.node(1)
    name = node.sdo["Manufacturer device name"].raw
    assert len(name) > 4  # more than an expedited transfer holds

    def read(*, block: bool) -> bytes:
        with node.sdo["Manufacturer device name"].open("rb", buffering=0, block_transfer=block) as stream:
            return bytes(stream.read())

    with pytest.raises(canopen.SdoAbortedError, match="0x05040001"):
        read(block=True)
    assert read(block=False) == name.encode("ascii")
    with pytest.raises(canopen.SdoAbortedError, match="0x05040001"):
        node.sdo["Target velocity"].open("wb", size=4, block_transfer=True)
    node.sdo["Target velocity"].raw = 7
    assert node.sdo["Target velocity"].raw == 7


# ---- The EDS file says what the drive answers: both come from one table.

SIZES = {2: 1, 3: 2, 4: 4, 5: 1, 6: 2, 7: 4}
STRING = 9
TOO_LONG, TOO_SHORT, READ_ONLY, TOO_HIGH, TOO_LOW = 0x06070012, 0x06070013, 0x06010002, 0x06090031, 0x06090032


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    with played_on_canopen(read_scene(SCENE_DIR / "robotino2.toml"), tmp_path_factory.mktemp("eds")) as found:
        yield found


def variables(od: canopen.ObjectDictionary) -> list[ODVariable]:
    """Every sub-index that an SDO reaches."""
    found = [each for entry in od.values() for each in
             ([entry] if isinstance(entry, ODVariable) else entry.values())]
    return [each for each in found if each.index >= 0x1000]


def abort_code(action) -> int:
    with pytest.raises(canopen.SdoAbortedError) as refused:
        action()
    return refused.value.code


def test_the_dictionary_of_the_file_is_that_of_the_drive(played: Played) -> None:
    node = played.node(1)
    listed = variables(node.object_dictionary)
    assert len(listed) > 120
    for each in listed:
        if not each.readable or (each.index, each.subindex > 0) == (0x1003, True):  # a history that is empty
            continue
        data = node.sdo.upload(each.index, each.subindex)
        if each.data_type == STRING:
            assert data.decode("ascii").isprintable() and len(data) > 4
            continue
        assert len(data) == SIZES[each.data_type], each
        if each.default is not None:
            assert each.decode_raw(data) == each.default, each


def test_an_object_that_the_file_does_not_list_is_not_there(played: Played) -> None:
    node = played.node(2)
    listed = {(each.index, each.subindex) for each in variables(node.object_dictionary)}
    for index in (*range(0x1000, 0x1030), *(base + k for base in range(0x1400, 0x1C00, 0x200) for k in range(6)),
                  *range(0x6000, 0x6100), 0x2000, 0x6502, 0x6503, 0x9FFF):
        for sub in (0, 1, 3, 6):
            if (index, sub) not in listed:
                assert abort_code(lambda at=(index, sub): node.sdo.upload(*at)) in (0x06020000, 0x06090011)


def test_lengths_and_access_are_those_of_the_file(played: Played) -> None:
    node = played.node(3)
    for each in variables(node.object_dictionary):
        at = each.index, each.subindex
        if not each.writable:
            assert abort_code(lambda at=at: download(node, *at, bytes(4))) == READ_ONLY
        else:
            size = SIZES[each.data_type]
            assert abort_code(lambda at=at, size=size: download(node, *at, bytes(size + 1))) == TOO_LONG
            if size > 1:
                assert abort_code(lambda at=at, size=size: download(node, *at, bytes(size - 1))) == TOO_SHORT


def test_limits_are_those_of_the_file(played: Played) -> None:
    node = played.node(3)
    limited = [each for each in variables(node.object_dictionary) if each.min is not None]
    assert len(limited) > 10
    for each in limited:
        at = each.index, each.subindex
        for value in (each.min, each.max):
            download(node, *at, each.encode_raw(value))
        size, signed = SIZES[each.data_type], each.data_type <= 4
        least, most = (-(1 << 8 * size - 1), (1 << 8 * size - 1) - 1) if signed else (0, (1 << 8 * size) - 1)
        for beyond, code in ((each.max + 1, TOO_HIGH), (each.min - 1, TOO_LOW)):
            if least <= beyond <= most:
                data = beyond.to_bytes(size, "little", signed=signed)
                assert abort_code(lambda at=at, data=data: download(node, *at, data)) == code, each


def test_cob_ids_of_the_file_follow_the_node_id(tmp_path: Path) -> None:
    path = tmp_path / "drive.eds"
    path.write_text(eds_text(7, EdsDrive(encoder_counts=10000)), encoding="ascii")
    od = canopen.import_od(str(path))
    assert od.node_id == 7 and od[0x1400][1].default == 0x207 and od[0x1801][1].default == 0x40000287
    assert od[0x1014].default == 0x87 and od[0x608F][1].default == 10000
    other = canopen.import_od(str(path), node_id=9)
    assert other[0x1A03][1].default == 0x60F40020 and other[0x1803][1].default == 0xC0000489


def test_play_writes_the_file_for_the_drives_of_a_scene_and_refuses_other_protocols(tmp_path: Path, capsys) -> None:
    path = tmp_path / "own.eds"
    assert run(["play", "canopen_agv", "--eds", str(path)]) == 0
    assert canopen.import_od(str(path), node_id=4)[0x608F][1].default == 30
    assert run(["play", "robomaster_mecanum", "--eds", str(path)]) == 2
    assert "--drives canopen" in capsys.readouterr().err


def test_windows_of_a_coarse_encoder_are_a_small_part_of_its_speed_range() -> None:
    """Thirty counts a turn: the usual 500 counts/s would be the whole range of the drive."""
    eds = ConfigParser()
    eds.read_string(eds_of_scene(read_scene("canopen_agv"), "canopen"))
    found = {index: int(eds[index]["DefaultValue"], 0) for index in ("6067", "606D", "606F")}
    assert found == {"6067": 1, "606D": 4, "606F": 1}
