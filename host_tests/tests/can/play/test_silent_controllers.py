"""A controller goes silent: the vehicle does what the protocol of its drives promises, row by row of docs/play.md."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import can
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.can.play.node_in_process import InProcess
from laconic.can.play.node_vehicle import NodeVehicle
from laconic.can.play.settings import drive_settings
from laconic.can.rig.buses import VirtualClock, node_in_process
from laconic.can.rig.verdict import Judgement, Verdict
from laconic.scene import read_scene
from play_support import currents, played, sdo

SILENT_S = 1.0       # from here on nobody commands
MASTER = 0x7F
NODES = {4: -300, 5: 300}  # of canopen_agv, with speeds that drive it ahead

Commands = Callable[[float], list[can.Message]]


def frame(identifier: int, data: bytes = b"", **flags: bool) -> can.Message:
    """Any frame."""
    return can.Message(arbitration_id=identifier, is_extended_id=identifier > 0x7FF, data=data, **flags)


def stop(scene: str | Path, commands: Commands, **options: object) -> tuple[Verdict, list[str]]:
    """The verdict on the vehicle's stop after the controller's last frame, and what play notes."""
    judgement, _ = played(scene, 3.0, lambda t: commands(t) if t < SILENT_S else [], stop_within_s=1.5, **options)
    verdict, = [each for each in judgement.verdicts if each.name == "stopped"]
    return verdict, judgement.notes


def canopen(*settings: tuple[int, int, int, int]) -> Commands:
    """A master with a heartbeat that enables both drives; `settings`: index, value, bytes and sub-index of objects."""
    script = [frame(0, bytes((1, 0)))]
    for node_id, speed in NODES.items():
        script += [sdo(node_id, *each) for each in settings]
        script += [sdo(node_id, 0x6060, 3, 1), *(sdo(node_id, 0x6040, word, 2) for word in (6, 7, 15)),
                   sdo(node_id, 0x60FF, speed, 4)]

    def commands(_: float) -> list[can.Message]:
        pdos = [frame(0x200 + node_id, b"\x0f\x00\x03") for node_id in NODES] if not script else []
        return [frame(0x700 + MASTER, b"\x05"), *pdos, *([script.pop(0)] if script else [])]

    return commands


HEARTBEAT = (0x1016, MASTER << 16 | 50, 4, 1)
DEADLINE = (0x1400, 50, 2, 5)
CANOPEN = {
    "consumer of heartbeats": ((HEARTBEAT,), True), "deadline of a PDO": ((DEADLINE,), True),
    "heartbeat with quick stop": ((HEARTBEAT, (0x6007, 3, 2, 0)), True), "nothing asked for": ((), False),
    "heartbeat that tells alone": ((HEARTBEAT, (0x6007, 0, 2, 0)), False)}


@pytest.mark.parametrize("name", CANOPEN)
def test_canopen_drives_brake_where_the_controller_asked_them_to_watch_it_and_go_on_where_not(name: str) -> None:
    settings, stops = CANOPEN[name]
    verdict, notes = stop("canopen_agv", canopen(*settings))
    assert verdict.passed == stops and ("still moving" in verdict.detail) != stops, verdict
    assert any("watchdog" in note for note in notes) == bool(settings)


def with_friction(tmp_path: Path, watchdog_s: float | None) -> Path:
    """robomaster_mecanum with so much viscous friction that it coasts to rest in about a second."""
    text = (SOURCE_DIR / "scenes" / "robomaster_mecanum.toml").read_text(encoding="utf-8")
    head, found, rest = text.partition("viscous_friction_Nms = 0.0")
    drives, name, more = rest.partition("[rig.drives]")
    assert found and name
    watchdog = f"\nwatchdog_s = {watchdog_s}" if watchdog_s is not None else ""
    path = tmp_path / "scene.toml"
    path.write_text(f"{head}viscous_friction_Nms = 2e-4{drives}{name}{watchdog}{more}", encoding="utf-8")
    assert read_scene(path)
    return path


def robomaster(_: float) -> list[can.Message]:
    """A current for each wheel: those of the right are mounted the other way."""
    return [currents(1.0, 1.0, 1.0, 1.0)]


def odrive(_: float) -> list[can.Message]:
    """Velocity control, closed loop, 5 turns a second."""
    modes, state = struct.pack("<II", 2, 1), struct.pack("<I", 8)
    return [frame(axis << 5 | command, data) for axis in range(1, 5) for command, data in (
        (0x0B, modes), (0x07, state), (0x0D, struct.pack("<ff", 5.0, 0.0)))]


def moteus(*, timeout_s: float | None = None) -> Commands:
    """Position mode without a position, 5 turns a second; the command's own time-out, where one is given."""
    data = struct.pack("<BBBBBfBBf", 1, 0, 10, 0x0D, 0x20, float("nan"), 0x0D, 0x21, 5.0)
    data += struct.pack("<BBf", 0x0D, 0x27, timeout_s) if timeout_s is not None else b""
    padded = data.ljust(16 if len(data) <= 16 else 24, b"\x50")
    return lambda _: [can.Message(arbitration_id=number, is_extended_id=False, is_fd=True, data=padded)
                      for number in range(1, 5)]


@pytest.mark.parametrize("protocol, commands", [("robomaster", robomaster), ("odrive", odrive)])
@pytest.mark.parametrize("watchdog_s", [None, 0.1])
def test_odrive_and_robomaster_drives_let_the_vehicle_coast_by_their_watchdog_and_keep_the_last_command_without(
        protocol: str, commands: Commands, watchdog_s: float | None, tmp_path: Path) -> None:
    verdict, notes = stop(with_friction(tmp_path, watchdog_s), commands, drives=protocol)
    assert ("still moving" in verdict.detail) == (watchdog_s is None), verdict
    assert any("watchdog" in note for note in notes) == (watchdog_s is not None)


@pytest.mark.parametrize("timeout_s, stops", [(None, True), (0.3, True), (float("nan"), False)])
def test_moteus_drives_damp_the_vehicle_to_rest_after_the_time_out_of_their_command(
        timeout_s: float | None, stops: bool) -> None:
    verdict, notes = stop("robomaster_mecanum", moteus(timeout_s=timeout_s), drives="moteus")
    assert verdict.passed == stops and ("still moving" in verdict.detail) != stops, verdict
    assert any("watchdog" in note for note in notes) == stops


# ---- The verdict on watchdogs: of a controller that once spoke, for as long as the run lasts, and for good.

WATCHDOG_S = 0.05


@pytest.fixture
def watched(tmp_path: Path) -> Path:
    """robomaster_mecanum with a watchdog shorter than the period of HEARTBEAT, by which play reads the figures."""
    path = tmp_path / "scene.toml"
    text = (SOURCE_DIR / "scenes" / "robomaster_mecanum.toml").read_text(encoding="utf-8")
    path.write_text(f"{text}watchdog_s = {WATCHDOG_S}\n", encoding="utf-8")
    return path


def commands_in(*spans: tuple[float, float]) -> Callable[[float], list[can.Message]]:
    """A command every 10 ms in these spans of time."""
    def commands(time_s: float) -> list[can.Message]:
        return [currents(0.5)] if any(begin <= time_s < end for begin, end in spans) else []
    return commands


def fired(judgement: Judgement) -> bool:
    """Whether a watchdog has, by the verdict."""
    verdict, = [each for each in judgement.verdicts if each.name == "watchdog"]
    return not verdict.passed


@pytest.mark.parametrize("spans, has_fired", [
    ((), False),                           # nobody ever came
    (((0.3, 9.0),), False),                # a controller that came late
    (((0.0, 9.0),), False),                # ... or that never paused, until play itself ended
    (((0.0, 0.2), (0.3, 9.0)), True)])     # silence, and a command that switches on again
def test_a_watchdog_watches_from_the_first_command_to_the_end_of_the_run(
        spans: tuple[tuple[float, float], ...], has_fired: bool, watched: Path) -> None:
    judgement, _ = played(watched, 0.6, commands_in(*spans), drives="robomaster")
    assert fired(judgement) == has_fired, judgement.verdicts


def test_a_node_tells_at_the_end_of_a_watchdog_that_fired_long_ago_and_plays_no_longer_while_it_tells(
        watched: Path) -> None:
    """As a node in another process does, whose drives cannot be looked at: HEARTBEAT alone tells."""
    for pause_s, has_fired in ((0.03, False), (0.07, True)):
        scene, clock = read_scene(watched), VirtualClock()
        with node_in_process("double", clock=clock) as (client, end):
            vehicle = InProcess(client, end, scene, drive_settings(scene, "robomaster"))
            vehicle._note_unheard = NodeVehicle._note_unheard.__get__(vehicle)  # type: ignore[method-assign]
            vehicle._look_at_drives = lambda: None  # type: ignore[method-assign]
            vehicle.start()
            for wait_s in (0.01, pause_s, 0.01):
                vehicle.on_message(currents(0.5), clock.now_us())
                for _ in range(round(wait_s / scene.run.step_s)):
                    clock.time_us += round(1e6 * scene.run.step_s)
                    list(vehicle.advance(clock.now_us()))
            vehicle.on_message(currents(0.5), clock.now_us())
            vehicle.finish()
            assert vehicle.lateness.periods > 0
        assert bool(vehicle.watchdogs()) == has_fired, pause_s
