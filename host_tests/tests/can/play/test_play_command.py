"""laconic play from the outside: exit status, results, the live view, and what ends it."""

from __future__ import annotations

import json
import signal
import struct
import subprocess
import sys
import threading
from io import StringIO
from pathlib import Path
from xml.etree import ElementTree

import can
import pytest
from rich.console import Console

from laconic.base.paths import built
from laconic.can.play.live import TrafficView
from laconic.can.play.options import PlayOptions
from laconic.can.play.session import play
from laconic.can.rig.buses import VirtualClock
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.scene import read_scene
from play_support import DBC, PLAY, Codec, played

AGV = ["play", "canopen_agv", "--listen", "0"]


def test_a_run_prints_drives_port_and_lateness_and_writes_its_results(tmp_path: Path,
                                                                     capsys: pytest.CaptureFixture[str]) -> None:
    junit, log = tmp_path / "r.xml", tmp_path / "run.blf"
    assert run([*AGV, "--duration", "0.15", "--junit", str(junit), "--log", str(log)]) == 0
    text = capsys.readouterr().out
    for word in ("drives: canopen", "gear_ratio", "-14 14", "(rig.drives)", "the drives are the motors",
                 "channel socket://127.0.0.1:", "late_periods", "worst_lateness_ms", "no controller ever connected"):
        assert word in text, word
    suite = ElementTree.parse(junit).getroot()
    assert suite.get("name") == "laconic play ez-Wheel SWD Starter Kit canopen" and suite.get("failures") == "0"
    with can.LogReader(log) as reader:
        assert {0x704, 0x705} <= {message.arbitration_id for message in reader}  # the boot-up messages


def test_a_seed_without_anything_random_is_refused_with_the_remedy(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*AGV, "--duration", "0.05", "--seed", "7"]) == 2
    assert "--seed 7: nothing here is random; give --fault random or a --bus-fault" in capsys.readouterr().err


def test_a_node_that_is_not_built_names_its_target(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LACONIC_BUILD_DIR", str(tmp_path))
    with pytest.raises(BadInput, match="not built yet; run `.*--build build --target laconic_node`"):
        built("lib/liblaconic_node_double.so")
    with pytest.raises(BadInput, match="--target laconic_firmware`"):
        built("firmware/laconic-node-an386.elf")


def test_json_goes_to_stdout_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*AGV, "--duration", "0.05", "--json"]) == 0
    captured = capsys.readouterr()
    found = json.loads(captured.out)
    assert found["mode"] == "canopen" and found["passed"] and found["figures"]["periods"] >= 40
    assert found["drives"]["protocol"] == "canopen" and found["drives"]["gear_ratio"] == [-14.0, 14.0]
    assert "socket://127.0.0.1:" in captured.err


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.nightly)])
def test_a_user_who_stops_it_gets_exit_status_0_and_the_figures(number: signal.Signals) -> None:
    command = [sys.executable, "-m", "laconic", *AGV]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if "listening" in line:
                break
        threading.Timer(0.2, process.send_signal, [number]).start()
        out, err = process.communicate(timeout=30.0)
    assert (process.returncode, err) == (0, "")
    assert "stopped by the user" in out and "late_periods" in out


def test_a_bus_that_dies_ends_the_run_with_exit_status_1() -> None:
    class Dying(can.BusABC):
        """Works for a while."""

        left = 50

        def __init__(self) -> None:
            super().__init__(channel="dying")
            self.channel_info = "dying"

        def send(self, msg: can.Message, timeout: float | None = None) -> None:
            self.left -= 1
            if self.left < 0:
                raise can.CanOperationError("the adapter was unplugged")

        def _recv_internal(self, timeout: float | None) -> tuple[None, bool]:
            return None, False

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("laconic.can.play.options.open_bus", lambda *_, **__: Dying())
        options = PlayOptions(interface="virtual", channel="x", drives="robomaster", duration_s=1.0)
        judgement = play(read_scene("robotino2"), options, clock=VirtualClock())
    assert judgement.exit_status == 1
    assert "the bus died while sending: the adapter was unplugged" in judgement.verdicts[0].detail


def test_a_drive_whose_watchdog_fires_makes_the_exit_status_1_and_the_run_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "watched.toml"
    path.write_text(Path(read_scene("robotino2").path).read_text(encoding="utf-8")
                    + '\n[rig.drives]\nprotocol = "robomaster"\nwatchdog_s = 0.1\n', encoding="utf-8")
    command = can.Message(arbitration_id=0x200, is_extended_id=False, data=struct.pack(">4h", 200, 200, 200, 0))
    judgement, controller = played(path, 1.0, lambda t: [command] if t < 0.4 else [])
    assert judgement.exit_status == 1
    verdict, = [each for each in judgement.verdicts if not each.passed]
    assert verdict.name == "watchdog" and "drive 1 heard no controller in time" in verdict.detail
    assert struct.unpack(">h", controller.of(0x201)[-1][1].data[4:6])[0] == 0  # no current any more
    assert len(controller.of(0x201)) == 999


def test_a_message_whose_end_ends_the_run_does_so(tmp_path: Path) -> None:
    text = (PLAY / "transporter.toml").read_text(encoding="utf-8").replace('"zero"', '"end"')
    path = tmp_path / "end.toml"
    path.write_text(text, encoding="utf-8")
    codec = Codec()
    judgement, controller = played("turtlebot3_burger", 5.0, lambda t: [codec.command(6.0, -6.0)] if t < 0.5 else [],
                                   dbc=DBC, map_path=path)
    assert judgement.exit_status == 1 and controller.heard[-1][0] < 0.7
    assert any("WHEEL_COMMAND has not come for 0.1 s" in each.detail for each in judgement.verdicts)


def test_the_live_view_shows_each_identifier_with_its_last_frame() -> None:
    view, out = TrafficView("a robot"), StringIO()
    for count in range(3):
        view.take(can.Message(arbitration_id=0x123, is_extended_id=False, data=[count]))
    view.take(can.Message(arbitration_id=0x18FF50E5, is_extended_id=True, is_remote_frame=True))
    view.moved(1.5)
    Console(file=out, width=80, height=24).print(view)
    text = out.getvalue()
    assert "a robot, 1.5 s" in text and "123" in text and "18FF50E5" in text and "remote" in text
    assert [line for line in text.splitlines() if "123" in line][0].split()[1:-1] == ["123", "│", "3", "│", "02"]


def test_a_node_on_the_bus_and_a_port_exclude_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*AGV, "--board", "bus"]) == 2
    assert "--board bus: the node is a station of the controller's bus" in capsys.readouterr().err
