"""What a run of play tells at its end: watchdogs, where the robot went, programs on the port."""

from __future__ import annotations

import math
import re
import time
from pathlib import Path
from xml.etree import ElementTree

import can
import pytest

from laconic.base.paths import SCENE_DIR, SOURCE_DIR
from laconic.can.play.checksums import CHECKSUMS
from laconic.can.play.map_file import AT_TIMEOUT, read_map
from laconic.can.play.map_signals import BODY_OUTPUTS, DRIVE_OUTPUTS, OF_DRIVES, WHEEL_OUTPUTS
from laconic.can.play.node_vehicle import remedy
from laconic.can.play.options import PlayOptions
from laconic.can.play.protocols import KINDS
from laconic.can.play.session import play
from laconic.can.play.settings import drive_settings
from laconic.can.play.vehicle import coasts_for_ever
from laconic.can.rig import lockstep
from laconic.can.rig.buses import VirtualClock, node_process, open_bus
from laconic.can.rig.client import Identity
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.lockstep import check_run
from laconic.can.rig.logs import read_log
from laconic.can.rig.wire import ID_BASE
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.drives import DRIVE_PROTOCOLS, NUMBERS
from laconic.scene.methods import EXPLICIT, EXPLICIT_8
from laconic.scene.signals import LENGTHS, PER_WHEEL
from play_support import DBC, PLAY, Codec, currents, played

WATCHED = '\n[rig.drives]\nprotocol = "robomaster"\nwatchdog_s = 0.1\n'


@pytest.mark.parametrize("trouble", [{}, {"faults": ("stall:1@0.5",)}, {"bus_faults": ("loss=0.1",)}])
def test_a_watchdog_that_fires_fails_the_run_with_faults_as_without(trouble: dict[str, tuple[str, ...]],
                                                                   tmp_path: Path) -> None:
    path = tmp_path / "watched.toml"
    path.write_text(Path(read_scene("robotino2").path).read_text(encoding="utf-8") + WATCHED, encoding="utf-8")
    judgement, _ = played(path, 0.8, lambda t: [currents(0.2, 0.2, 0.2)] if t < 0.3 else [], **trouble)
    verdict, = [each for each in judgement.verdicts if each.name == "watchdog"]
    assert judgement.exit_status == 1 and not verdict.passed and "drive 1 heard no controller in time" in verdict.detail
    assert "a drive heard" not in verdict.detail  # each is named


def test_the_end_of_a_run_tells_where_the_robot_is_and_how_far_it_went() -> None:
    """A mecanum chassis under equal currents goes straight ahead: the way is the distance."""
    judgement, _ = played("robomaster_mecanum", 1.0, lambda t: [currents(1.0, 1.0, 1.0, 1.0)])
    found = judgement.figures
    assert found["end_x_m"] > 0.1 and abs(found["end_y_m"]) < 0.01
    distance_m = math.hypot(found["end_x_m"], found["end_y_m"])
    assert found["way_m"] == pytest.approx(distance_m, rel=0.05)  # it is looked at every 10 ms
    codec = Codec()
    judgement, _ = played("turtlebot3_burger", 1.0, lambda _: [codec.command(6.0, 6.0)], dbc=DBC,
                          map_path=PLAY / "transporter.toml")
    assert {"end_x_m", "end_y_m", "end_heading_rad", "way_m"} <= judgement.figures.keys()
    assert judgement.figures["end_heading_rad"] != 0.0


def test_a_node_in_another_process_tells_where_it_ended() -> None:
    with can.Bus(interface="virtual", channel="end-pose"):
        options = PlayOptions(interface="virtual", channel="end-pose", board="process", drives="robomaster",
                              duration_s=0.2)
        judgement = play(read_scene("robotino2"), options)
    assert [judgement.figures[name] for name in ("end_x_m", "end_y_m", "end_heading_rad")] == [0.0, 0.0, 0.0]
    assert "way_m" not in judgement.figures  # nobody has asked the node for its speed


def test_results_for_ci_have_the_figures_and_say_that_nobody_connected(tmp_path: Path) -> None:
    junit = tmp_path / "r.xml"
    assert run(["play", "canopen_agv", "--listen", "0", "--duration", "0.05", "--junit", str(junit)]) == 0
    suite = ElementTree.parse(junit).getroot()
    assert "no controller ever connected to port" in (suite.findtext("system-out") or "")
    named = {each.get("name"): each.get("value") for each in suite.iter("property")}
    assert named["end_x_m"] == "0" and float(named["periods"] or 0) > 0


def test_frames_that_a_program_on_the_port_does_not_read_are_told_at_the_end() -> None:
    """It joins and then does nothing, while four drives report a thousand times a second: virtual time, real port."""
    clients: list[can.BusABC] = []

    def say(line: str) -> None:
        if "socket://" in line:
            clients.append(open_bus("slcan", "socket://" + line.partition("socket://")[2]))

    options = PlayOptions(listen=0, duration_s=5.0)
    judgement = play(read_scene("robomaster_mecanum"), options, clock=VirtualClock(), say=say)
    clients[0].shutdown()
    note, = judgement.notes
    assert f"{judgement.figures['frames_not_taken']} frames were lost to a program on the port" in note
    assert judgement.figures["frames_not_taken"] + 9000 > judgement.figures["frames_out"] > 19_000


def test_a_stop_that_fails_because_nothing_brakes_the_vehicle_says_so() -> None:
    judgement, _ = played("robomaster_mecanum", 1.0, lambda t: [currents(1.0, 1.0, 1.0, 1.0)] if t < 0.8 else [],
                          faults=("temperature:1@0.5",), stop_within_s=0.2)
    verdict, = [each for each in judgement.verdicts if each.name == "stopped"]
    assert not verdict.passed and "still moving at the end" in verdict.detail
    assert "[vehicle.motor] viscous_friction_Nms" in verdict.detail and coasts_for_ever(read_scene("canopen_agv"))


@pytest.mark.parametrize("table, coasts", [
    ("[ground]\nfriction_coefficient = 0.7\n", True),
    ("[ground]\nfriction_coefficient = 0.7\naxle_friction_Nm = 0.5\n", False)])
def test_only_friction_of_a_wheel_that_rolls_brakes_it(table: str, coasts: bool, tmp_path: Path) -> None:
    path = tmp_path / "agv.toml"
    lines = Path(read_scene("canopen_agv").path).read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([*(each for each in lines if not each.startswith("friction_coefficient")), table]),
                    encoding="utf-8")
    assert coasts_for_ever(read_scene(path)) == coasts


def test_sensors_that_no_protocol_of_drives_carries_are_named(tmp_path: Path) -> None:
    path = tmp_path / "sensors.toml"
    path.write_text(Path(read_scene("robotino2").path).read_text(encoding="utf-8")
                    + "\n[sensors.imu]\n\n[sensors.encoder]\ncounts_per_turn = 4096\n", encoding="utf-8")
    judgement, _ = played(path, 0.1, lambda _: [], drives="robomaster")
    note, = [each for each in judgement.notes if "sensors" in each]
    assert note.startswith("sensors.imu and sensors.encoder: not played") and "--map" in note
    judgement, _ = played("robotino2", 0.1, lambda _: [], drives="robomaster")
    assert not [each for each in judgement.notes if "sensors" in each]


def test_a_log_has_the_time_of_day(tmp_path: Path) -> None:
    before_s = time.time()
    assert run(["play", "canopen_agv", "--listen", "0", "--duration", "0.05", "--log", str(tmp_path / "run.blf")]) == 0
    assert all(before_s - 1.0 < each.timestamp < time.time() + 1.0 for each in read_log(tmp_path / "run.blf"))


def test_drives_of_a_map_are_no_stations_of_a_protocol() -> None:
    said: list[str] = []
    options = PlayOptions(interface="virtual", channel="map-words", duration_s=0.01, dbc=DBC,
                          map_path=PLAY / "transporter_drives.toml")
    play(read_scene("turtlebot3_burger"), options, clock=VirtualClock(), say=said.append)
    assert said[0].startswith("drives: of the map") and "node_ids" not in said[0] and "CANopen" not in said[0]
    assert said[-1] == "on virtual map-words"


def test_nothing_is_said_about_a_port_before_the_scene_has_been_taken(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "robotino2", "--drives", "robomaster", "--listen", "0", "--step", "0.0007"]) == 2
    printed = capsys.readouterr()
    assert "listening" not in printed.out and "give another --step" in printed.err


def test_a_node_with_another_scalar_type_and_one_method_names_all_that_it_needs() -> None:
    scene = read_scene("robotino2").with_run(method=EXPLICIT_8)
    node = Identity("0.1.0", "single", 4, 1 << 1, False, 2)
    with pytest.raises(BadInput, match=rf"the node computes in single; its method is {EXPLICIT_8}, the node has "
                                       rf"{EXPLICIT}; give --real single --method {EXPLICIT}"):
        check_run(node, scene, scene.plant(scene.core()))


def test_a_method_that_has_no_bit_in_the_identity_is_left_to_the_node(monkeypatch: pytest.MonkeyPatch) -> None:
    """IDENTITY.methods has eight bits; COMMIT refuses a later method that the node does not have."""
    scene = read_scene("robotino2")
    plant = scene.plant(scene.core())
    monkeypatch.setattr(lockstep, "method_number", lambda core, method: 8)
    check_run(Identity("0.1.0", "double", 4, 1 << 1, False, 2), scene, plant)


def test_what_an_image_leaves_out_is_named_by_its_field() -> None:
    refused = NodeRefused("PARAMETER", "not supported", "FRICTION_COEFFICIENT", 0, "ready")
    assert "leaves FRICTION_COEFFICIENT out; choose another --board" in remedy(refused, read_scene("robotino2"))
    refused = NodeRefused("PARAMETER", "not supported", "DRIVE_PROTOCOL", 0, "ready")
    assert "does not speak that protocol" in remedy(refused, read_scene("robotino2"))


def test_a_process_that_serves_its_port_tells_who_came_and_what_was_not_read() -> None:
    """Another program sends as fast as the port takes it, and asks for the version behind: by then all is passed on."""
    words: list[str] = []
    frames, a_second = 14_000, 9_000
    with node_process("double", ID_BASE, "--shared", last_words=words) as port, \
            open_bus("slcan", f"socket://127.0.0.1:{port}") as one, \
            open_bus("slcan", f"socket://127.0.0.1:{port}") as deaf:
        assert deaf is not one
        one.serialPortOrig.write(b"t20180000000000000000\r" * frames + b"V\r")
        while b"V" not in one.serialPortOrig.read(4096):
            pass
    found = re.fullmatch(r"clients 2, frames not taken (\d+)\n", words[0])
    assert found is not None and frames > int(found[1]) > frames - a_second


def test_nobody_at_the_port_of_a_process_is_told() -> None:
    judgement = play(read_scene("robotino2"), PlayOptions(listen=0, board="process", drives="robomaster",
                                                          duration_s=0.05))
    assert any("no controller ever connected to port" in each for each in judgement.notes)


# ---- docs/play.md is true: its maps and keys are read, and what it lists is all there is.

PAGE = (SOURCE_DIR / "docs" / "play.md").read_text(encoding="utf-8")
TABLES = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)


def test_the_map_of_the_page_is_one_that_is_read(tmp_path: Path) -> None:
    path = tmp_path / "page.toml"
    path.write_text("\n".join(text for text in TABLES if "[[receive" in text or "[[send" in text), encoding="utf-8")
    found = read_map(path, 4)
    assert [each.message for each in found.received] == ["WHEEL_COMMAND"] and len(found.sent[0].joints) == 2


def test_the_drives_of_the_page_are_ones_that_are_read_with_every_key(tmp_path: Path) -> None:
    drives, = (text for text in TABLES if "[rig.drives]" in text)
    path = tmp_path / "page.toml"
    text = (SCENE_DIR / "example_two_wheel_sizes.toml").read_text(encoding="utf-8")
    path.write_text(text + "\n" + drives.replace('"canopen"', '"odrive"'), encoding="utf-8")
    found = drive_settings(read_scene(path), None)
    assert found.driven == (True, True, False, False) and set(found.numbers) == set(NUMBERS)
    assert set(found.origins.values()) == {"rig.drives"}


def test_every_name_that_a_map_or_an_option_may_have_stands_on_the_page() -> None:
    names = {*CHECKSUMS, *KINDS, *AT_TIMEOUT, *BODY_OUTPUTS, *DRIVE_OUTPUTS, *WHEEL_OUTPUTS, *OF_DRIVES, *LENGTHS,
             *PER_WHEEL, *DRIVE_PROTOCOLS, *NUMBERS}
    assert {name for name in names if name not in PAGE} == set()
