"""The CAN controller of a network FMU and the bus between two: bit rate, arbitration, errors, notifications.

The demo of docs/fmu-importers.md: vehicle, bus and controller in the FMU toolbox's container, and joined by FMPy.

What network FMUs refuse with a line in the log: times that no node counts, and identifiers that drives have.
"""

from __future__ import annotations

import json
import random
import re
import struct
from collections.abc import Iterator
from pathlib import Path

import pytest
from bus_operations import (
    CONFIGURATION,
    CONFIRM,
    ERROR,
    LOST,
    STATUS,
    TRANSMIT,
    ByHand,
    Operation,
    bus_error,
    fd_frame,
    frame,
    frames_in,
    of_id,
    operation,
    operations,
)
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from fmu_manipulation_toolbox.assembly import Assembly

from laconic.base.paths import SOURCE_DIR, built
from laconic.fmu.bus_demo import SETPOINT_RAD_PER_S, demo, main
from laconic.fmu.bus_importer import Network, NetworkFmu
from laconic.fmu.network import make_network_fmu
from laconic.scene import read_scene

NOTIFICATIONS = "org.fmi_standard.fmi_ls_bus.Can_BusNotifications"
BUS, CONTROLLER = built("fmu/LaconicCanBus_fmi3.fmu"), built("fmu/LaconicCanController_fmi3.fmu")
AT_ONE_MBIT = operation(CONFIGURATION, b"\x01" + struct.pack("<I", 1_000_000))
DISCARD = operation(CONFIGURATION, b"\x04\x02")
LINKS = [(0, "CAN", 1, "Node1"), (2, "CAN", 1, "Node2")]
SPEEDS = {f"setpoint_rad_per_s[{wheel}]": 5.0 for wheel in (1, 2, 3, 4)}


@pytest.fixture(scope="module")
def vehicle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four mecanum wheels on RoboMaster's motor controllers."""
    return make_network_fmu(read_scene("robomaster_mecanum"), tmp_path_factory.mktemp("fmu") / "vehicle.fmu",
                            drives="robomaster")


@pytest.fixture
def bus() -> Iterator[ByHand]:
    """The bus alone, at 1 Mbit/s."""
    with ByHand(BUS) as by_hand:
        by_hand.step(0.0, Node1=AT_ONE_MBIT, Node2=AT_ONE_MBIT)
        yield by_hand


def arrivals(bus: ByHand, until_us: int, terminal: str, code: int = TRANSMIT) -> list[tuple[int, Operation]]:
    """What comes at a terminal, with the microsecond."""
    found = []
    first_us = round(bus.time_s * 1e6)
    for now_us in range(first_us + 1, until_us + 1):
        found += [(now_us, each) for each in bus.step(now_us * 1e-6)[terminal] if each[0] == code]
    return found


def test_a_frame_takes_the_time_of_its_bits(bus: ByHand) -> None:
    """47 bits and eight for each byte, 67 with an extended identifier."""
    bus.step(0.0, Node1=frame(0x123, b"12345678") + frame(0x124, b"") + frame(0x18DAF110, b"1", extended=True))
    came = arrivals(bus, 300, "Node2")
    assert [now_us for now_us, _ in came] == [111, 111 + 47, 111 + 47 + 75]
    assert [arguments[:4] for _, (_, arguments) in came] == [
        struct.pack("<I", each) for each in (0x123, 0x124, 0x18DAF110)]


def test_the_data_of_a_can_fd_frame_have_the_faster_rate(bus: ByHand) -> None:
    """30 bits at 1 Mbit/s; 64 bytes and 37 bits at 8 Mbit/s."""
    bus.step(0.0, Node1=operation(CONFIGURATION, b"\x02" + struct.pack("<I", 8_000_000)) + fd_frame(1, b"x" * 64))
    (now_us, _), = arrivals(bus, 200, "Node2", 0x11)
    assert now_us == 30 + -(-(64 * 8 + 37) // 8)


def test_the_lower_identifier_goes_first_and_the_other_one_follows(bus: ByHand) -> None:
    bus.step(0.0, Node1=frame(0x200, b"12345678"), Node2=frame(0x1FF, b"12345678"))
    confirmed = []
    for now_us in range(1, 250):
        sent = bus.step(now_us * 1e-6)
        confirmed += [(now_us, name) for name in ("Node1", "Node2") if CONFIRM in [code for code, _ in sent[name]]]
    assert confirmed == [(111, "Node2"), (222, "Node1")]
    assert bus.fmu.get("lost_arbitrations") == 1


def test_a_standard_frame_wins_over_an_extended_one_with_the_same_first_bits(bus: ByHand) -> None:
    bus.step(0.0, Node1=frame(0x123 << 18, b"", extended=True), Node2=frame(0x123, b"1"))
    (now_us, _), = arrivals(bus, 56, "Node1")
    assert now_us == 55


def test_a_node_that_asks_for_it_is_told_that_it_lost(bus: ByHand) -> None:
    bus.step(0.0, Node1=DISCARD + frame(0x200, b""), Node2=frame(0x100, b""))
    assert [arguments for _, (_, arguments) in arrivals(bus, 100, "Node1", LOST)] == [struct.pack("<I", 0x200)]
    assert bus.fmu.get("frames_carried") == 1


def test_nodes_with_different_bit_rates_hear_nothing_of_each_other() -> None:
    with ByHand(BUS) as bus:
        slower = operation(CONFIGURATION, b"\x01" + struct.pack("<I", 500_000))
        bus.step(0.0, Node1=AT_ONE_MBIT, Node2=slower + frame(1, b""))
        assert bus.step(1.0) == {"Node1": [], "Node2": []}
        assert bus.fmu.log == ["Node1 works at 1000000 bit/s, Node2 at 500000: the bus carries nothing"]


def test_with_notifications_a_node_sends_one_frame_at_a_time_and_repeats_what_failed(vehicle: Path) -> None:
    with ByHand(vehicle, **{NOTIFICATIONS: True}) as node:
        assert [identifier for identifier, _ in frames_in(node.step(0.001)["CAN"])] == [0x201]
        assert node.step(0.0015)["CAN"] == []  # it waits
        node.step(0.0016, CAN=bus_error(0x201, is_sender=True))
        again, = frames_in(node.step(0.0017)["CAN"])
        assert again[0] == 0x201
        assert node.fmu.get("transmit_errors") == 8
        node.step(0.0018, CAN=of_id(LOST, 0x201))
        assert frames_in(node.step(0.0019)["CAN"]) == [again]
        node.step(0.00195, CAN=of_id(CONFIRM, 0x201))
        assert [identifier for identifier, _ in frames_in(node.step(0.00196)["CAN"])] == [0x202]
        assert node.fmu.get("transmit_errors") == 7


def test_a_frame_that_lost_arbitration_is_let_go_where_the_user_says_so(vehicle: Path) -> None:
    with ByHand(vehicle, discard_on_lost_arbitration=True, drop_lost_frames=True, **{NOTIFICATIONS: True}) as node:
        assert (CONFIGURATION, b"\x04\x02") in node.first["CAN"]
        node.step(0.001, CAN=b"")
        node.step(0.0011, CAN=of_id(LOST, 0x201))
        assert [identifier for identifier, _ in frames_in(node.step(0.0012)["CAN"])] == [0x202]
        assert node.fmu.get("frames_lost") == 1


def test_a_node_with_too_many_errors_goes_bus_off_says_so_and_returns(vehicle: Path) -> None:
    with ByHand(vehicle, **{NOTIFICATIONS: True}) as node:
        node.step(0.001)
        states, now_s = [], 0.001
        for _ in range(32):
            now_s += 1e-5
            node.step(now_s, CAN=bus_error(0x201, is_sender=True))
            now_s += 1e-5
            states += [arguments[0] for code, arguments in node.step(now_s)["CAN"] if code == STATUS]
        assert states == [2, 3]  # passive, off
        assert node.fmu.get("bus_status") == 3
        assert frames_in(node.step(now_s + 1.3e-3, CAN=frame(0x200, b"\x40\0" * 4))["CAN"]) == []
        sent = node.step(now_s + 1.5e-3)["CAN"]  # 1408 bits at 1 Mbit/s later
        assert sent[0] == (STATUS, b"\x01")
        assert [identifier for identifier, _ in frames_in(sent)] == [0x201]
        assert node.fmu.get("frames_heard") == 0


def test_without_notifications_a_node_passes_over_those_that_come(vehicle: Path) -> None:
    with ByHand(vehicle) as node:
        node.step(0.001, CAN=bus_error(0x201, is_sender=True) + of_id(LOST, 0x202) + of_id(CONFIRM, 0x203))
        assert [identifier for identifier, _ in frames_in(node.step(0.002)["CAN"])] == [0x201, 0x202, 0x203, 0x204]
        assert node.fmu.get("transmit_errors") == 0


def test_a_controller_drives_the_vehicle_over_a_bus_on_which_each_tenth_frame_fails(vehicle: Path) -> None:
    """Every frame that failed is sent again, so that the controller hears all motors."""
    with Network([vehicle, BUS, CONTROLLER], LINKS) as network:
        network.start([{NOTIFICATIONS: True}, {"error_every": 10}, {NOTIFICATIONS: True, **SPEEDS}])
        network.run(0.1, 5e-5)
        node, bus, controller = network.fmus
        carried, failed = bus.get("frames_carried"), bus.get("frames_failed")
        assert failed == (carried + failed) // 10
        assert failed > 30
        assert 0 <= node.get("frames_sent") + controller.get("frames_sent") - carried <= 2  # on their way
        assert node.get("wheel_speed_rad_per_s[1]") > 1.0
        for wheel in (1, 2, 3, 4):
            assert controller.get(f"measured_rad_per_s[{wheel}]") == pytest.approx(
                node.get(f"wheel_speed_rad_per_s[{wheel}]"), abs=0.3)


@pytest.mark.parametrize("drives", ["robomaster", None])
def test_a_countdown_clock_ticks_at_the_nodes_own_instants(drives: str | None, tmp_path: Path) -> None:
    """A step of the importer of 0.21 s: what a drive sends each millisecond still comes then, on the microsecond."""
    node = make_network_fmu(read_scene("robomaster_mecanum"), tmp_path / "node.fmu", drives=drives,
                            tx_clock="countdown")
    times = []
    with Network([node], [], lambda time_s, _number, _name, data: times.append(round(time_s * 1e6))
                 if frames_in(operations(data)) else None) as network:
        network.start()
        network.run(0.21, 0.21)
    assert times == ([*range(1000, 210_001, 1000)] if drives else [100_000, 200_000])


def test_long_steps_lose_no_frame_and_a_full_buffer_says_so(vehicle: Path) -> None:
    with ByHand(vehicle) as node:
        sent = frames_in(node.step(0.3)["CAN"])
        assert [identifier for identifier, _ in sent] == [0x201, 0x202, 0x203, 0x204] * 300
        assert node.fmu.log == []
        node.step(2.3)
        assert len(node.fmu.log) == 1
        assert "take shorter communication steps" in node.fmu.log[0]


def test_the_state_of_a_network_fmu_is_kept_and_restored_with_its_bus(vehicle: Path) -> None:
    command = frame(0x200, struct.pack(">4h", 3000, 3000, 3000, 3000))
    with ByHand(vehicle) as node:
        node.step(0.001, CAN=command)
        kept = node.fmu.slave.getFMUState()
        first = [node.step(0.001 * k)["CAN"] for k in range(2, 50)]
        node.fmu.slave.setFMUState(kept)
        node.time_s = 0.001
        assert [node.step(0.001 * k)["CAN"] for k in range(2, 50)] == first
        assert node.fmu.get("x_m") > 0.0


def test_random_operations_change_no_more_than_their_counters(vehicle: Path) -> None:
    numbers = random.Random(5)
    with ByHand(vehicle) as node, ByHand(BUS) as bus:
        for k in range(1, 600):
            size = numbers.choice((0, 1, 7, 8, 12, 16, 24, 81, 300))
            noise = bytearray(numbers.randbytes(size))
            if size >= 8 and numbers.random() < 0.8:
                noise[:8] = struct.pack("<II", numbers.choice((1, 16, 17, 18, 32, 48, 49, 64, 65, 66, 9)), size)
            assert {code for code, _ in node.step(0.001 * k, CAN=bytes(noise))["CAN"]} <= {TRANSMIT, 1}
            sent = bus.step(0.001 * k, Node1=bytes(noise), Node2=bytes(noise))
            assert {code for code, _ in sent["Node1"]} <= {TRANSMIT, 0x11, CONFIRM, LOST, ERROR, 1}
        assert node.fmu.get("node_state") == 6
        assert node.fmu.get("wrong_operations") > 200


PAGE = (SOURCE_DIR / "docs" / "fmu-importers.md").read_text(encoding="utf-8")
UNTIL_S = 0.2


def test_the_toolboxs_container_and_fmpy_move_the_vehicle_by_the_same_bits(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    by_fmpy = demo(tmp_path, UNTIL_S)
    assembly = Assembly("demo.json", fmu_directory=tmp_path)
    assembly.make_fmu(fmi_version=3)
    speeds = {f"setpoint_rad_per_s[{wheel}]": SETPOINT_RAD_PER_S for wheel in (1, 2, 3, 4)}
    rows = simulate_fmu("demo.fmu", stop_time=UNTIL_S, step_size=0.001, output_interval=0.001, start_values=speeds,
                        relative_tolerance=1e-9, validate=False)
    in_container = {name: float(rows[-1][name]) for name in by_fmpy if name in rows.dtype.names}
    assert in_container == by_fmpy
    assert by_fmpy["x_m"] > 0.01


def test_the_demo_prints_the_figures_of_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert printed.strip() in PAGE
    assert set(json.loads((tmp_path / "demo.json").read_text())["fmu"]) == {
        "bus.fmu", "vehicle.fmu", "controller.fmu"}
    assert re.search(r"x_m +0\.\d+", printed)


@pytest.fixture(scope="module")
def chassis(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A vehicle with four RoboMaster drives."""
    return make_network_fmu(read_scene("robomaster_mecanum"), tmp_path_factory.mktemp("fmu") / "x.fmu",
                            drives="robomaster")


@pytest.fixture(params=["vehicle", "CanBus", "CanController"])
def fmu(request: pytest.FixtureRequest, chassis: Path) -> Iterator[NetworkFmu]:
    """Each kind of network FMU, instantiated."""
    path = chassis if request.param == "vehicle" else built(f"fmu/Laconic{request.param}_fmi3.fmu")
    opened = NetworkFmu(path)
    try:
        yield opened
    finally:
        opened.close()


def start(fmu: NetworkFmu, time_s: float = 0.0) -> None:
    """Through initialization and the first event into step mode."""
    fmu.slave.enterInitializationMode(startTime=time_s)
    fmu.slave.exitInitializationMode()
    while fmu.slave.updateDiscreteStates()[0]:
        pass
    fmu.slave.enterStepMode()


@pytest.mark.parametrize("time_s", [1e300, -1e300, 1e12])
def test_a_start_time_at_which_no_microsecond_is_told_is_refused_by_a_line(fmu: NetworkFmu, time_s: float) -> None:
    with pytest.raises(FMICallException):
        start(fmu, time_s)
    line, = fmu.log
    assert "the start time" in line and "give one from -4e+09 s to 4e+09 s" in line


@pytest.mark.parametrize("step_s", [1e300, 1e20, 1e10])
def test_a_step_of_centuries_is_refused_by_a_line_and_moves_nothing(fmu: NetworkFmu, step_s: float) -> None:
    start(fmu)
    fmu.slave.doStep(0.0, 0.001)
    with pytest.raises(FMICallException):
        fmu.slave.doStep(0.001, step_s)
    assert "give 1e+06 s or less" in fmu.log[-1]
    assert fmu.get("time") == 0.001


def test_identifiers_of_drives_are_refused_as_the_nodes_own(chassis: Path) -> None:
    for base, is_free in ((480, False), (512, False), (544, True)):  # commands 0x1FF, 0x200; feedback to 0x204
        fmu = NetworkFmu(chassis)
        try:
            fmu.set("id_base", base)
            if is_free:
                start(fmu)
                continue
            with pytest.raises(FMICallException):
                start(fmu)
            assert f"id_base: the drives use identifiers from {base} to {base + 31}" in fmu.log[-1]
        finally:
            fmu.close()
