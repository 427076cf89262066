"""XCP on CAN: the A2L file, calibration and measurement by a small master and by pyxcp, in every kind of node."""

from __future__ import annotations

import json
import re
import struct
import sys
import threading
import time
import zlib
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import can
import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.can.rig.a2l import EACH, OUTPUTS, PARAMETERS, SEGMENT, a2l_text, outputs, parameters
from laconic.can.rig.boards import own_node, why_no_emulation
from laconic.can.rig.buses import NodeOnBus, VirtualClock, connected, node_process
from laconic.can.rig.client import NodeClient
from laconic.can.rig.free_judge import judge_free_run
from laconic.can.rig.link import Link
from laconic.can.rig.lockstep import load_scene
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.wire import ID_BASE, wire
from laconic.cli.main import run
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT
from play_support import next_channel

SCENE = read_scene("s1").with_run(step_s=0.001, method=EXPLICIT)
COMMAND, RESPONSE = (ID_BASE + wire().xcp[name].offset for name in ("XCP_COMMAND", "XCP_RESPONSE"))
VOLTS = 5.0
BOARD = "an386-xcp"
NOT_ON_THE_BOARD = ("error_", "encoder_", "imu_", "origin_", "axle_torque_")  # its image leaves these outputs out
NODES = ("virtual", "process", pytest.param(BOARD, marks=[
    pytest.mark.nightly, pytest.mark.skipif(why_no_emulation() is not None, reason=why_no_emulation() or "")]))


def addresses(scene: Scene) -> dict[str, int]:
    """Name → address, as a tool reads them from the file."""
    text = a2l_text(scene)
    found = re.findall(r"/begin CHARACTERISTIC (\w+) .*\n +VALUE (0x\w+)", text)
    found += re.findall(r"/begin MEASUREMENT (\w+) .*\n .*ECU_ADDRESS (0x\w+)", text)
    return {name: int(address, 16) for name, address in found}


class Refused(Exception):
    """An error of the slave: its code, and the bytes behind it."""

    def __init__(self, answer: bytes):
        self.code, self.more = answer[1], answer[2:]
        super().__init__(f"0x{self.code:02X} {self.more.hex()}")


class Master:
    """A master without any code of Laconic but the rig's bus, which it shares."""

    def __init__(self, node: NodeClient):
        self.node, self.answers, self.samples, self.events = node, deque[bytes](), deque[bytes](), deque[bytes]()
        node.link.listeners.append(self.hear)

    def hear(self, message: can.Message) -> None:
        if message.arbitration_id != RESPONSE or message.is_extended_id:
            return
        kind = self.answers if message.data[0] >= 0xFE else self.events if message.data[0] >= 0xFC else self.samples
        kind.append(bytes(message.data))

    def wait(self, what: deque[bytes], seconds: float = 5.0) -> bytes | None:
        """The next packet of a kind; None when none comes in time."""
        end = time.monotonic() + seconds
        while not what and time.monotonic() < end:
            self.node.link.receive(0.001)
        return what.popleft() if what else None

    def ask(self, *command: int) -> bytes:
        """One command; what its answer has behind 0xFF."""
        self.node.link.send_message(can.Message(arbitration_id=COMMAND, data=bytes(command), is_extended_id=False))
        answer = self.wait(self.answers)
        assert answer is not None, bytes(command).hex()
        if answer[0] == 0xFE:
            raise Refused(answer)
        return answer[1:]

    def read(self, address: int, kind: str = "<f") -> Any:
        """One number."""
        return struct.unpack(kind, self.ask(0xF4, 4, 0, 0, *struct.pack("<I", address)))[0]

    def write(self, address: int, value: float) -> None:
        """One number of the working page."""
        self.ask(0xF6, 0, 0, 0, *struct.pack("<I", address))
        self.ask(0xF0, 4, *struct.pack("<f", value))

    def measure(self, named: list[int], event: int) -> None:
        """Starts one list: the stamp in the first frame, then one number a frame."""
        self.ask(0xD6)
        self.ask(0xD5, 0, 1, 0)
        self.ask(0xD4, 0, 0, 0, 1 + len(named))
        for frame in range(1, 1 + len(named)):
            self.ask(0xD3, 0, 0, 0, frame, 1)
        for frame, address in enumerate(named, 1):
            self.ask(0xE2, 0, 0, 0, frame, 0)
            self.ask(0xE1, 0xFF, 4, 0, *struct.pack("<I", address))
        self.ask(0xE0, 0x10, 0, 0, event, 0, 1, 0)
        self.ask(0xDE, 1, 0, 0)


@contextmanager
def driven(kind: str) -> Iterator[tuple[NodeClient, Master, Scene]]:
    """A node with the scene in lockstep, voltages on its wheels, and a master that has connected."""
    scene = SCENE.with_run(real="single" if kind == BOARD else "double")
    with own_node(kind, scene.run.real) as node:
        load_scene(node, scene)
        node.select()
        node.start_lockstep()
        master = Master(node)
        assert master.ask(0xFF, 0) == bytes((0x05, 0x80, 8, 8, 0, 1, 1))
        raw = round(VOLTS / 0.002)
        node.link.send(wire()["VOLTAGE"], wire()["VOLTAGE"].pack(voltage_1=raw, voltage_2=-raw, voltage_3=raw))
        yield node, master, scene


def sync(node: NodeClient, steps: int) -> None:
    node.link.send(wire()["SYNC"], wire()["SYNC"].pack(step_count=steps))


HELD = {"voltage_V": [VOLTS, -VOLTS, VOLTS]}


# ---- the file


@pytest.mark.parametrize("name", ["s1", "kuka_youbot", "turtlebot3_burger", "tricycle_agv"])
def test_the_file_names_each_number_once_at_the_address_of_its_field(name: str) -> None:
    scene = read_scene(name)
    text, where = a2l_text(scene), addresses(scene)
    numbers = {field: number for number, field in wire()["PARAMETER"].fields["field"].choices.items()}
    names = re.findall(r"/begin (?:CHARACTERISTIC|MEASUREMENT) (\w+)", text)
    assert len(set(names)) == len(names) > 40 and len(set(where.values())) == len(names)
    assert where["mass_kg"] == PARAMETERS + EACH * numbers["MASS"]
    assert where["wheel_x_m_2"] == PARAMETERS + EACH * numbers["WHEEL_X"] + 4
    assert where["heading"] == OUTPUTS + EACH * wire()["SELECT"].fields["raw_pose"].start + 8
    assert where["voltage_2"] == OUTPUTS + EACH * wire()["SELECT"].fields["take_voltage"].start + 4
    assert text.isascii() and "?" not in text and max(map(len, re.findall('"[^"]*"', text))) <= 256
    assert all(PARAMETERS <= each.address < PARAMETERS + SEGMENT for each in parameters(scene))
    assert name != "s1" or '/begin MEASUREMENT heading "Pose of the centre of mass"' in text  # a whole phrase
    mass = text.partition("CHARACTERISTIC mass_kg")[2].partition("/end")[0]
    assert ("READ_ONLY" in mass) == scene.has_hinges  # which the node does not calibrate


def test_the_command_writes_the_file_and_drives_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "laconic_2.a2l"
    assert run(["rig", "s1", "--a2l", str(path), "--id-base", "0x6A0"]) == 0
    assert "CAN_ID_MASTER 0x6BF" in path.read_text() and "CAN_ID_SLAVE 0x6BE" in path.read_text()
    assert run(["rig", "s1", "--a2l", str(path), "--free-run"]) == 2
    assert "--free-run: has no meaning beside --a2l" in capsys.readouterr().err


def test_numbers_that_name_a_choice_have_texts_and_limits() -> None:
    text = a2l_text(SCENE)
    for name, table, low, high in (("wheel_kind_1", "WHEEL_KIND", 1, 2), ("wheel_locked_2", "YES_NO", 0, 1),
                                   ("wheel_driven_3", "YES_NO", 0, 1), ("motor_circuit_1", "MOTOR_CIRCUIT", 0, 2)):
        entry = re.findall(rf"CHARACTERISTIC {name} .*\n +VALUE 0x\w+ of_ULONG 0 (\w+) (\d+) (\d+)", text)
        assert entry == [(f"text_{table}", str(low), str(high))]
    state = re.findall(r"MEASUREMENT state .*\n +ULONG (\w+) 0 0 0 (\d+)", text)
    assert state == [("text_state", str(max(wire()["HEARTBEAT"].fields["state"].choices)))]
    assert 'texts_MOTOR_CIRCUIT "" TAB_VERB 3 0 "controller" 1 "open" 2 "shorted"' in text
    used, made = (set(re.findall(rf"{what} texts_(\w+)", text)) for what in ("COMPU_TAB_REF", "begin COMPU_VTAB"))
    assert used == made and set(re.findall(r" text_(\w+) ", text)) == used


@pytest.mark.parametrize("name", ["s1", "kuka_youbot", "tricycle_agv"])
def test_descriptions_tell_what_a_number_is_and_not_how_frames_hold_it(name: str) -> None:
    told = {each.name: each.text for each in (*parameters(read_scene(name)), *outputs(read_scene(name)))}
    assert told["wheel_driven_1"].startswith("Whether the wheel has a motor")  # 1 is driven
    assert told["wheel_speed_2"] == "Speed of wheel 2"
    assert not [text for text in told.values() if "group" in text or "has no motor" in text]


def test_estimates_are_in_the_file_only_where_the_scene_asks_the_node_for_them() -> None:
    assert not [each for each in addresses(SCENE) if each.startswith("error_")]
    asking = replace(SCENE, rig=replace(SCENE.rig, frames=("NU", "ERROR_ESTIMATE")))
    assert len([each for each in addresses(asking) if each.startswith("error_")]) == 8


def test_pya2l_reads_the_file() -> None:
    parser = pytest.importorskip("pya2l.parser")
    with parser.A2lParser() as reader:
        module = reader.tree_from_a2l(a2l_text(SCENE).encode()).PROJECT.MODULE[0]
    where = addresses(SCENE)
    read = {each.Name.Value: int(each.Address.Value) for each in module.CHARACTERISTIC}
    read |= {each.Name.Value: int(each.ECU_ADDRESS.Address.Value) for each in module.MEASUREMENT}
    assert read == where and module.Name.Value == "laconic_2"


# ---- a small master


@pytest.mark.parametrize("kind", NODES)
def test_every_number_of_the_file_is_the_vehicle_s(kind: str) -> None:
    with driven(kind) as (_, master, scene):
        core = scene.core()
        vehicle, fields = scene.c_vehicle(core), {field.number: field for field in core.fields}
        for each in parameters(scene):
            field = fields[(each.address - PARAMETERS) // EACH]
            value: Any = field.values(vehicle)[each.address % EACH // 4]
            expected = np.float32(value) if field.kind == "REAL" else 1 - value if field.kind == "ABSENCE" else value
            read = master.read(each.address, "<f" if field.kind == "REAL" else "<I")
            assert read == expected or (kind == BOARD and field.identifier == "DRIVEN"), each.name
        for each in outputs(scene):
            if not each.name.startswith(NOT_ON_THE_BOARD if kind == BOARD else "error_"):
                master.ask(0xF4, 4, 0, 0, *struct.pack("<I", each.address))


@pytest.mark.parametrize("kind", NODES)
def test_calibrated_numbers_act_from_the_next_step_on_as_in_the_core(kind: str) -> None:
    with driven(kind) as (node, master, scene):
        where, twin = addresses(scene), scene.plant(scene.core())
        sync(node, 100)
        while master.read(where["steps"], "<I") < 100:
            pass
        twin.run(HELD, 100)
        changed = scene.c_vehicle(scene.core())
        for name, value in (("mass_kg", 12.5), ("motor_damping_Nms", 0.03)):
            master.write(where[name], value)
            setattr(changed, name, float(np.float32(value)))
            twin.change(changed)
        sync(node, 100)
        while master.read(where["steps"], "<I") < 200:
            pass
        twin.run(HELD, 100)
        expected = [twin.pose.x_m, twin.pose.y_m, twin.pose.heading_rad, *twin.nu]
        assert [master.read(where[name]) for name in ("x", "y", "heading", "nu_1", "nu_2", "nu_3")] == [
            np.float32(value) for value in expected]
        with pytest.raises(Refused, match="0x22 02") as refused:  # NOT_POSITIVE
            master.write(where["mass_kg"], 0.0)
        assert refused.value.more[1:3] == bytes((1, 0)) and master.read(where["mass_kg"]) == 12.5
        results = [wire()["RESULT"].unpack(data) for frame, data in node.others if frame.name == "RESULT"]
        assert results == [] or results[-1]["command"] != 0


@pytest.mark.parametrize("kind", NODES)
def test_the_checksum_of_the_segment_is_that_of_its_bytes(kind: str) -> None:
    with driven(kind) as (_, master, scene):
        page = bytearray(SEGMENT)
        master.ask(0xF6, 0, 0, 0, *struct.pack("<I", PARAMETERS))
        for at in range(0, SEGMENT // 16, 4):
            page[at : at + 4] = master.ask(0xF5, 4)
        master.ask(0xF6, 0, 0, 0, *struct.pack("<I", PARAMETERS))
        assert master.ask(0xF3, 0, 0, 0, *struct.pack("<I", SEGMENT // 16)) == b"\x09\0\0" + struct.pack(
            "<I", zlib.crc32(page[: SEGMENT // 16]))
        master.write(addresses(scene)["mass_kg"], 11.0)
        page[EACH : EACH + 4] = struct.pack("<f", 11.0)
        master.ask(0xF6, 0, 0, 0, *struct.pack("<I", PARAMETERS))
        assert master.ask(0xF3, 0, 0, 0, *struct.pack("<I", SEGMENT // 16))[3:] == struct.pack(
            "<I", zlib.crc32(page[: SEGMENT // 16]))


@pytest.mark.parametrize(("kind", "seconds"), [
    ("virtual", 60), ("process", 5), pytest.param("process", 60, marks=pytest.mark.nightly),
    pytest.param(BOARD, 60, marks=NODES[2].marks)])  # type: ignore[union-attr]
def test_measurement_each_10_ms_loses_nothing_and_has_the_time_of_its_step(kind: str, seconds: int) -> None:
    with driven(kind) as (node, master, scene):
        where, twin = addresses(scene), scene.plant(scene.core())
        names = ("x", "y", "heading")
        master.measure([where[name] for name in names], 1)
        for number in range(1, 100 * seconds + 1):
            if number % 100 == 1:
                sync(node, 1000)
            twin.run(HELD, 10)
            pose = twin.pose
            frames = [master.wait(master.samples) for _ in range(4)]
            assert frames[0] == b"\0" + struct.pack("<I", 10_000 * number)
            assert frames[1:] == [bytes((k,)) + struct.pack("<f", value) for k, value in enumerate(
                (pose.x_m, pose.y_m, pose.heading_rad), 1)], number
        assert not master.samples and not master.events
        master.ask(0xDD, 0)
        assert struct.unpack("<I", master.ask(0xDC)[3:])[0] == 1_000_000 * seconds


WRONG = """
FC=00 F9=20 ED=20 C7=20 00=20 FA=21 F6000000800001=21 F5=21 F4040000=21 F00401=21 EB0300=21 E1FF=21 FF02=22
F600000180000100=22 F404000180000100=22 F500=22 F508=22 F00000=22 F404000000000000=24 F404000000200100=24
F404000008000200=24 F40400008C0C0200=24 F404000040000300=24 EB000000=27 EB080000=27 EB030100=28 EB030002=26 EA0300=27
EA0101=28 E401010000=28 E400020000=26 E400000001=23 F300000000000000=22 F300000001200000=22 D5000100=29 D400000001=29
E1FF0400800C0200=29 D700030=22 DD03=27 DE010000=22 E00000000000010=22 E2000000000=22""".split()


@pytest.mark.parametrize("kind", NODES)
def test_wrong_requests_are_answered_by_their_codes(kind: str) -> None:
    assert len(WRONG) >= 40
    with driven(kind) as (_, master, _):
        for text in WRONG:
            command, code = text.split("=")
            with pytest.raises(Refused) as refused:
                master.ask(*bytes.fromhex(command if len(command) % 2 == 0 else command + "0"))
            assert refused.value.code == int(code, 16), text


def test_a_node_with_a_key_has_no_slave(tmp_path: Path) -> None:
    key = tmp_path / "robot.key"
    key.write_text("00112233445566778899aabbccddeeff")
    with node_process("double", ID_BASE, "--key", str(key)) as port, \
            connected("slcan", f"socket://127.0.0.1:{port}") as node:
        master = Master(node)
        node.link.send_message(can.Message(arbitration_id=COMMAND, data=bytes((0xFF, 0)), is_extended_id=False))
        assert master.wait(master.answers, 0.3) is None


def test_a_run_of_the_rig_goes_on_while_a_master_is_refused() -> None:
    with driven("virtual") as (node, master, scene):
        with pytest.raises(Refused):
            master.write(addresses(scene)["yaw_inertia_kgm2"], -1.0)
        sync(node, 10)
        result = {"status": 2, "field": 2, "item": 0, "state": 2, "command": 21, "request": 0}
        node.check(result)  # as the rig's loops do with every RESULT
        assert master.read(addresses(scene)["steps"], "<I") == 10


@pytest.mark.parametrize(("mass_kg", "is_told"), [(14.0, True), (0.0, False)])
def test_the_rig_tells_that_numbers_were_changed_by_xcp_if_the_node_took_them(mass_kg: float, is_told: bool) -> None:
    commands = [b"\xff\0", b"\xf6\0\0\0" + struct.pack("<I", addresses(SCENE)["mass_kg"]),
                b"\xf0\x04" + struct.pack("<f", mass_kg)]
    with own_node("virtual", "double") as node:

        def moved(_: float) -> None:  # one command in each cycle: a master waits for each answer
            if commands:
                node.link.send_message(can.Message(arbitration_id=COMMAND, data=commands.pop(0), is_extended_id=False))

        judgement = judge_free_run(node, SCENE, 0.5, 1000, 100, {}, moved=moved)
    assert len([note for note in judgement.notes if "changed by XCP" in note]) == is_told


# ---- pyxcp


@pytest.fixture(autouse=True)
def _no_arguments(monkeypatch: pytest.MonkeyPatch) -> None:
    """pyxcp reads the options of the program that imports it."""
    monkeypatch.setattr(sys, "argv", sys.argv[:1])


def px_master(interface: str, channel: str, policy: Any) -> Any:
    """A configured pyxcp.master.Master."""
    config = pytest.importorskip("pyxcp.config")
    from pyxcp.master import Master as Of

    app = config.create_application_from_config({})
    app.transport.layer, app.transport.timeout = "CAN", 5.0
    app.transport.can.interface, app.transport.can.channel = interface, channel
    app.transport.can.can_id_master, app.transport.can.can_id_slave = COMMAND, RESPONSE
    config.set_application(app)
    return Of("can", config=app, policy=policy)


def calibrate_and_measure(interface: str, channel: str, samples: int) -> list[tuple[Any, ...]]:
    """What a user of pyxcp does; returns (stamp in ns, x, y, heading) of each sample."""
    daq = pytest.importorskip("pyxcp.daq_stim")
    where = addresses(SCENE)
    rows: list[tuple[Any, ...]] = []

    class Policy(daq.DaqOnlinePolicy):  # type: ignore[misc]
        def on_daq_list(self, _: int, __: int, stamp_ns: int, payload: list[Any]) -> None:
            rows.append((stamp_ns, *payload))

    numbers = [(name, where[name], 0, "F32") for name in ("x", "y", "heading")]
    policy = Policy([daq.DaqList(name="motion", event_num=1, stim=False, enable_timestamps=True, priority=0,
                                 prescaler=1, measurements=numbers)])
    with px_master(interface, channel, policy) as master:
        master.connect()
        assert master.identifier(1) == "laconic_2"
        assert master.shortUpload(4, where["mass_kg"]) == struct.pack("<f", 10.0)
        master.setMta(where["mass_kg"])
        master.download(struct.pack("<f", 12.5))
        master.setMta(where["mass_kg"])
        assert master.buildChecksum(4).checksum == zlib.crc32(struct.pack("<f", 12.5))
        policy.setup()
        policy.start()
        end = time.monotonic() + 60.0
        while len(rows) < samples and time.monotonic() < end:
            time.sleep(0.01)
        policy.stop()
        master.disconnect()
    return rows


def check_samples(rows: list[tuple[Any, ...]], samples: int) -> None:
    assert len(rows) >= samples
    assert {later[0] - earlier[0] for earlier, later in zip(rows, rows[1:], strict=False)} == {10_000_000}


def test_pyxcp_calibrates_and_measures_60_s_on_the_virtual_bus() -> None:
    pytest.importorskip("pyxcp")
    channel, clock, ended = next_channel(), VirtualClock(), threading.Event()
    with can.Bus(interface="virtual", channel=channel) as ours, can.Bus(interface="virtual", channel=channel) as its:
        end = NodeOnBus(LibraryNode("double"), its, clock)
        node = NodeClient(Link(ours, clock=clock, pump=end.pump))
        load_scene(node, SCENE)
        node.start_free_run(watchdog_ms=0)
        pump = threading.Thread(target=pump_until, args=(ended, node, end))
        pump.start()
        try:
            check_samples(calibrate_and_measure("virtual", channel, 6000), 6000)
        finally:
            ended.set()
            pump.join()


def pump_until(ended: threading.Event, node: NodeClient, end: NodeOnBus) -> None:
    """Virtual time, as fast as it runs; the rig's end of the bus is emptied."""
    while not ended.is_set():
        end.pump()
        while node.link.bus.recv(0) is not None:
            pass


def program_of_page(start: str) -> str:
    page = (SOURCE_DIR / "docs/rig-ports.md").read_text(encoding="utf-8")
    return start + page.partition(f"```python\n{start}")[2].partition("```")[0]


def test_the_rig_of_docs_rig_ports_md_drives_a_shared_node_whose_master_was_there_first(
        capsys: pytest.CaptureFixture[str]) -> None:
    page = (SOURCE_DIR / "docs/rig-ports.md").read_text(encoding="utf-8")
    command = re.findall(r"^laconic (rig s1 .*:4000 --free-run --steps) 60000$", page, re.M)[0]
    with node_process("double", ID_BASE, "--shared") as port, \
            connected("slcan", f"socket://127.0.0.1:{port}") as node:
        master = Master(node)
        assert master.ask(0xFF, 0)
        run([*command.replace(":4000", f":{port}").split(), "300", "--json"])
        verdicts = json.loads(capsys.readouterr().out)["verdicts"]
        failed = {each["name"] for each in verdicts if not each["passed"]}
        assert len(verdicts) > 8 and failed <= {"clock"}  # three tenths of a second of a busy machine tell no clock
        assert master.read(addresses(SCENE)["steps"], "<I") > 200


@pytest.mark.parametrize(("start", "needs", "sample"), [
    ("import struct\nfrom pyxcp", "pyxcp", r"^\d\.\d\d s( -?\d+\.\d{4}){3}$"),
    ("import struct\nimport time\n\nimport can", "can", r"^00( [0-9a-f]{2}){4}\n01( [0-9a-f]{2}){4}\n02")])
def test_the_programs_of_docs_rig_ports_md_calibrate_and_measure(start: str, needs: str, sample: str,
                                                                 capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip(needs)
    with node_process("double", ID_BASE, "--shared") as port, \
            connected("slcan", f"socket://127.0.0.1:{port}") as node:
        load_scene(node, read_scene("s1"))
        node.start_free_run(watchdog_ms=0)
        exec(program_of_page(start).replace(":4000", f":{port}"), {})
        out = capsys.readouterr().out
        assert needs != "pyxcp" or hex(zlib.crc32(struct.pack("<f", 12.5))) in out
        assert "laconic_2" in out and len(re.findall(sample, out, re.M)) >= 5
        master = Master(node)
        master.wait(deque(), 0.2)  # what the program has heard on the same bus
        master.answers.clear()
        master.ask(0xFF, 0)
        assert master.read(addresses(SCENE)["mass_kg"]) == 12.5


def test_the_python_can_program_of_docs_rig_ports_md_ends_where_only_heartbeats_come(tmp_path: Path) -> None:
    key = tmp_path / "robot.key"
    key.write_text("00112233445566778899aabbccddeeff")  # with it a node has no slave
    program = program_of_page("import struct\nimport time\n\nimport can").replace(" + 2.0  ", " + 0.5  ")
    with node_process("double", ID_BASE, "--key", str(key)) as port:
        begun = time.monotonic()
        with pytest.raises(SystemExit, match="no answer"):
            exec(program.replace(":4000", f":{port}"), {})
        assert time.monotonic() - begun < 5.0


def test_pya2l_reads_the_file_as_the_page_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                               capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pya2l.parser")
    monkeypatch.chdir(tmp_path)
    Path("laconic_2.a2l").write_text(a2l_text(SCENE), encoding="ascii")
    exec(program_of_page("from pya2l"), {})
    assert capsys.readouterr().out == "0x10080 0x20c80\n"


def test_pyxcp_calibrates_and_measures_a_node_process() -> None:
    pytest.importorskip("pyxcp")
    with node_process() as port:
        channel = f"socket://127.0.0.1:{port}"
        with connected("slcan", channel) as node:
            load_scene(node, SCENE)
            node.start_free_run(watchdog_ms=0)
        check_samples(calibrate_and_measure("slcan", channel, 50), 50)
