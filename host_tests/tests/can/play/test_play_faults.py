"""Drives and buses that fail in front of a controller, and the verdict on whether the vehicle stopped."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import can
import pytest

from laconic.can.play.can_fail import drives_can_fail
from laconic.can.play.faults import DriveFault, Saboteur, read_faults
from laconic.can.play.options import PlayOptions
from laconic.can.play.protocols import KINDS
from laconic.can.play.settings import drive_settings
from laconic.can.rig.verdict import Judgement
from laconic.cli.main import run
from laconic.scene import read_scene
from play_support import DBC, PLAY, Codec, played, sdo

HEARTBEAT_S = 0.05
LEFT, RIGHT = 4, 5  # node ids of canopen_agv


class AgvMaster:
    """Drives both wheels of canopen_agv in profile velocity. A careful one commands 0 when a heartbeat is missing."""

    def __init__(self, *, is_careful: bool):
        self.is_careful = is_careful
        self.heard_s: dict[int, float] = {}
        self.has_stopped = False
        self._script = [can.Message(arbitration_id=0, is_extended_id=False, data=[1, 0])]
        for node_id, speed in ((LEFT, -300), (RIGHT, 300)):
            self._script += [sdo(node_id, 0x1017, round(1000 * HEARTBEAT_S), 2), sdo(node_id, 0x6060, 3, 1),
                             *(sdo(node_id, 0x6040, word, 2) for word in (6, 7, 15)), sdo(node_id, 0x60FF, speed, 4)]

    def __call__(self, time_s: float) -> list[can.Message]:
        if self._script:
            return [self._script.pop(0)]
        late = [each for each in self.heard_s.values() if time_s - each > 3 * HEARTBEAT_S]
        if self.is_careful and late and not self.has_stopped:
            self.has_stopped = True
            return [sdo(LEFT, 0x60FF, 0, 4), sdo(RIGHT, 0x60FF, 0, 4)]
        return []

    def listen(self, time_s: float, message: can.Message) -> None:
        """Remembers when each drive was last alive."""
        if message.arbitration_id in (0x700 + LEFT, 0x700 + RIGHT):
            self.heard_s[message.arbitration_id - 0x700] = time_s


def judged(master: AgvMaster, **options: object):
    """The judgement of 4 s with a master that hears."""
    seen = 0

    def commands(time_s: float) -> list[can.Message]:
        nonlocal seen
        heard = holder[0].heard if holder else []
        for at_s, message in heard[seen:]:
            master.listen(at_s, message)
        seen = len(heard)
        return master(time_s)

    holder: list = []
    judgement, _ = played("canopen_agv", 4.0, commands, made=holder.append, **options)
    return judgement


@pytest.mark.parametrize("is_careful", [True, False])
def test_a_controller_that_minds_a_silent_drive_stops_the_vehicle_in_time_and_another_fails(is_careful: bool) -> None:
    judgement = judged(AgvMaster(is_careful=is_careful), faults=("silent:1@2",), stop_within_s=1.5, stop_distance_m=0.6)
    assert judgement.exit_status == (0 if is_careful else 1), judgement
    verdict, = [each for each in judgement.verdicts if each.name == "stopped"]
    assert ("still moving" in verdict.detail) != is_careful
    assert "fault: silent:1@2" in judgement.notes


def test_a_stop_that_takes_too_long_or_too_far_fails() -> None:
    for limits in ({"stop_within_s": 0.05}, {"stop_distance_m": 0.01}):
        judgement = judged(AgvMaster(is_careful=True), faults=("silent:1@2",), **limits)
        assert judgement.exit_status == 1 and "after the first fault at 2" in judgement.verdicts[-1].detail


def test_a_bus_that_loses_every_frame_counts_as_a_fault_and_its_first_frame_is_the_mark() -> None:
    judgement = judged(AgvMaster(is_careful=True), bus_faults=("loss=1", "from_s=2"), stop_within_s=1.0)
    verdict, = [each for each in judgement.verdicts if each.name == "stopped"]
    assert not verdict.passed and "still moving at the end" in verdict.detail  # the command to stop is lost, too


def test_silence_of_the_controller_is_the_mark_where_nothing_fails() -> None:
    codec = Codec()

    def commands(time_s: float) -> list[can.Message]:
        return [codec.command(6.0, -6.0)] if time_s < 0.5 else []

    judgement, _ = played("turtlebot3_burger", 2.0, commands, dbc=DBC, map_path=PLAY / "transporter.toml",
                          stop_within_s=1.0)
    verdict, = [each for each in judgement.verdicts if each.name == "stopped"]
    assert verdict.passed and "controller's last frame at 0.4" in verdict.detail, verdict
    assert judgement.exit_status == 0 and any("watchdog" in note for note in judgement.notes)


def test_a_vehicle_that_never_moved_has_not_stopped() -> None:
    codec = Codec()
    judgement, _ = played("turtlebot3_burger", 0.5, lambda _: [codec.command(0.0, 0.0)], dbc=DBC,
                          map_path=PLAY / "transporter.toml", stop_within_s=1.0)
    verdict, = [each for each in judgement.verdicts if each.name == "stopped"]
    assert not verdict.passed and "never moved" in verdict.detail


def test_a_drive_off_the_bus_is_not_heard_and_hears_nothing_until_it_is_back() -> None:
    command = can.Message(arbitration_id=0x200, is_extended_id=False, data=struct.pack(">4h", 200, 200, 200, 0))
    _, controller = played("robotino2", 1.0, lambda t: [command], drives="robomaster", faults=("bus-off:2@0.3+0.4",))
    times = [t for t, _ in controller.of(0x202)]
    assert not [t for t in times if times[0] + 0.305 < t < times[0] + 0.695]
    assert max(times) > times[0] + 0.9 and len(controller.of(0x201)) == 999


@pytest.mark.parametrize("kind", ["stall", "encoder", "temperature"])
def test_a_drive_that_fails_no_longer_turns_as_the_others_do(kind: str) -> None:
    command = can.Message(arbitration_id=0x200, is_extended_id=False, data=struct.pack(">4h", 400, 400, 400, 0))
    _, controller = played("robotino2", 1.0, lambda t: [command], drives="robomaster", faults=(f"{kind}:1@0.5",))
    _, last = controller.of(0x201)[-1]
    _, other = controller.of(0x202)[-1]
    rpm, current = struct.unpack(">hh", last.data[2:6])
    if kind == "stall":
        assert abs(rpm) < abs(struct.unpack(">h", other.data[2:4])[0]) / 10
    else:
        assert current == 0 and struct.unpack(">hh", other.data[2:6])[1] != 0


def test_random_faults_follow_from_the_seed_and_can_be_repeated_by_script() -> None:
    can_fail = drives_can_fail(drive_settings(read_scene("canopen_agv"), None), PlayOptions(listen=0))
    found = [read_faults(("random",), can_fail, 10.0, seed)[0] for seed in range(40)]
    assert found == [read_faults(("random",), can_fail, 10.0, seed)[0] for seed in range(40)]
    assert {each.kind for each in found} == set(KINDS) and {each.wheel for each in found} == {1, 2}
    assert all(2.5 <= each.at_s <= 7.5 for each in found)
    again = read_faults([str(each) for each in found], can_fail, 10.0, 1)
    assert list(again) == found
    assert str(DriveFault("encoder", 2, 1.5, 0.5)) == "encoder:2@1.5+0.5"


@pytest.mark.parametrize("arguments, words", [
    (["--fault", "stal:1@2"], ("--fault stal:1@2", "did you mean stall?")),
    (["--fault", "stall"], ("--fault stall", "KIND:WHEEL@SECONDS")),
    (["--fault", "stall:3@2"], ("wheel 3 has no drive", "1, 2")),
    (["--fault", "stall:1@soon"], ("soon is no time",)),
    (["--fault", "stall:1@2+-1"], ("-1 is no time",)),
    (["--fault", "stall:1@9"], ("would come after the end",)),
    (["--fault", "error-frames:1@1", "--board", "process"], ("--fault error-frames:1@1", "do not pass through this")),
    (["--bus-fault", "error_frames=1", "--board", "process"], ("--bus-fault", "leave --board out")),
    (["--fault", "silent:1@1", "--drives", "moteus"], ("moteus has no sign of life",)),
    (["--bus-fault", "los=1"], ("--bus-fault los=1", "did you mean loss?")),
    (["--bus-fault", "loss=2"], ("--bus-fault loss=2", "from 0 to 1")),
    (["--bus-fault", "loss=1", "--board", "process"], ("--bus-fault", "leave --board out")),
    (["--stop-within", "0"], ("--stop-within 0", "above 0"))])
def test_faults_that_cannot_be_are_refused_in_one_line(arguments: list[str], words: tuple[str, ...],
                                                      capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "canopen_agv", "--listen", "0", "--duration", "5", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and all(word in error for word in words), error


MATRIX = {
    "loss": ("loss=0.2",), "duplication": ("duplication=0.2",), "reordering": ("reordering=0.2",),
    "delay": ("delay_s=0.004",), "jitter": ("jitter_s=0.01",), "corruption": ("corruption=0.2", "corrupted_bits=3"),
    "stuck": ("stuck=0.01",), "wrong length": ("wrong_length=0.2",), "foreign": ("foreign=0.3",),
    "babble": ("babble_per_s=2000",), "bus-off": ("bus_off_after=50", "bus_off_s=0.1"),
    "bus-off for ever": ("bus_off_after=50",), "stale queue": ("bus_off_after=50", "bus_off_s=0.1", "keep_queue=true"),
    "slow wire": ("bitrate=125000",), "error frames": ("error_frames=0.2",)}


Heard = list[tuple[float, int, bytes]]


def commanded(**options: Any) -> tuple[Judgement, Heard]:
    """A run with one command all the time, and the vehicle's frames."""
    command = can.Message(arbitration_id=0x200, is_extended_id=False, data=struct.pack(">4h", 300, 300, 300, 0))
    judgement, controller = played("robotino2", 0.3, lambda t: [command], drives="robomaster", **options)
    return judgement, [(at_s, message.arbitration_id, bytes(message.data)) for at_s, message in controller.heard]


@pytest.fixture(scope="module")
def undisturbed() -> Heard:
    return commanded()[1]


@pytest.mark.parametrize("kind", MATRIX)
def test_every_fault_of_the_matrix_stands_between_vehicle_and_controller_and_the_run_goes_on(
        kind: str, undisturbed: Heard) -> None:
    """Twice: what a seed does to a run is the same each time."""
    runs = []
    for _ in range(2):
        judgement, heard = commanded(bus_faults=MATRIX[kind], seed=3)
        assert judgement.exit_status == 0 and judgement.figures["late_periods"] == 0, judgement
        runs.append(heard)
    assert runs[0] == runs[1]
    assert runs[0] != undisturbed and len(runs[0]) > 0


def test_wheels_without_a_drive_are_passed_over_and_a_fault_finds_its_wheel(tmp_path: Path) -> None:
    path = tmp_path / "two.toml"
    path.write_text(Path(read_scene("robotino2").path).read_text(encoding="utf-8")
                    + '\n[rig.drives]\nprotocol = "robomaster"\nnode_ids = [false, 5, 6]\n', encoding="utf-8")
    command = can.Message(arbitration_id=0x1FF, is_extended_id=False, data=struct.pack(">4h", 300, 300, 0, 0))
    judgement, controller = played(path, 0.4, lambda t: [command], faults=("temperature:3@0.2",))
    assert judgement.exit_status == 0
    assert {message.arbitration_id for _, message in controller.heard} == {0x205, 0x206}
    current = {number: struct.unpack(">h", controller.of(number)[-1][1].data[4:6])[0] for number in (0x205, 0x206)}
    assert current[0x205] != 0 and current[0x206] == 0


@pytest.mark.parametrize("given, broken_s", [
    (("encoder:1@0.5", "encoder:1@1+0.5"), [0.5]), (("encoder:1@0.5+3", "encoder:1@1+0.5"), [0.5, 3.5]),
    (("encoder:1@1+0.5", "encoder:1@1.2+0.5"), [1.0, 1.7]), (("encoder:1@1", "encoder:2@1.2+0.5"), [1.0, 1.2, 1.7])])
def test_faults_that_overlap_last_as_long_as_each_is_given(given: tuple[str, ...], broken_s: list[float]) -> None:
    """Instants at which a drive breaks, is mended, and so on."""
    now: dict[int, bool] = {}
    changes: list[float] = []

    class Vehicle:
        def break_drive(self, fault: DriveFault, *, is_broken: bool) -> None:
            if now.get(fault.wheel, False) != is_broken:
                changes.append(time_s)
            now[fault.wheel] = is_broken

    can_fail = drives_can_fail(drive_settings(read_scene("canopen_agv"), None), PlayOptions(listen=0))
    saboteur = Saboteur(Vehicle(), read_faults(given, can_fail, 4.0, 1))
    for step in range(401):
        time_s = step / 100.0
        saboteur(10_000 * step)
    assert changes == broken_s


def test_the_value_of_a_bus_fault_is_refused_before_a_port_is_open(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "canopen_agv", "--listen", "0", "--bus-fault", "loss=2"]) == 2
    printed = capsys.readouterr()
    assert "--bus-fault" in printed.err and "loss" in printed.err and "listening" not in printed.out


def test_the_folder_of_an_eds_file_is_made(tmp_path: Path) -> None:
    assert run(["play", "canopen_agv", "--eds", str(tmp_path / "new" / "drive.eds")]) == 0
    assert (tmp_path / "new" / "drive.eds").read_text(encoding="ascii").startswith("[FileInfo]")
