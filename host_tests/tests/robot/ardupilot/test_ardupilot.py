"""`laconic play --ardupilot`: the simulator's end of ArduPilot's JSON interface, with a stand-in for ArduPilot in C."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from laconic import BadInput, Scene, build_scene, read_scene, simulate
from laconic.base.paths import SOURCE_DIR
from laconic.robot.ardupilot.server import (
    Dropped,
    Frame,
    Player,
    Server,
    introduction,
    play_ardupilot,
    read_packet,
)
from laconic.robot.ardupilot.vehicle import Outputs
from laconic.scene.drives import ArduPilotTable
from laconic.scene.inputs import Input

STAND_IN = Path(__file__).with_name("stand_in.c")
RATE, FRAMES, EVERY = 400, 4000, 100
STEP_S = 1.0 / RATE
ME = ("127.0.0.1", 4242)


class Stopped(Exception):
    """Ends a server's loop."""


@pytest.fixture(scope="module")
def stand_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program that stands in for ArduPilot."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("needs a C compiler")
    made = tmp_path_factory.mktemp("ardupilot") / "stand_in"
    subprocess.run([compiler, "-std=c99", "-D_POSIX_C_SOURCE=200809L", "-Wall", "-Wextra", "-Werror", "-O1", STAND_IN,
                    "-lm", "-o", made], check=True)
    return made


@contextmanager
def served(scene: Scene, silent_s: float = 60.0) -> Iterator[tuple[Server, list[str]]]:
    """A server in a thread, and what it says."""
    lines: list[str] = []
    stop = threading.Event()

    def check() -> None:
        if stop.is_set():
            raise Stopped

    def serve() -> None:
        with suppress(Stopped):
            server.serve(float("inf"), check)

    server = Server(Player(scene, lines.append), 0, silent_s)
    thread = threading.Thread(target=serve)
    thread.start()
    try:
        yield server, lines
    finally:
        stop.set()
        thread.join(10.0)
        server.close()


@contextmanager
def client(server: Server) -> Iterator[socket.socket]:
    """A socket that is connected to a server."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
        made.settimeout(5.0)
        made.connect(("127.0.0.1", server.port))
        yield made


def packet(count: int, pulses: Sequence[int] = (), rate: int = RATE, magic: int = 18458, channels: int = 16) -> bytes:
    """A servo packet; outputs that are not given are in the middle."""
    every = [*pulses, *[1500] * (channels - len(pulses))]
    return struct.pack(f"<HHI{channels}H", magic, rate, count, *every)


def frame(count: int, pulses: Sequence[int] = (), rate: int = RATE) -> Frame:
    """What a packet holds."""
    return read_packet(packet(count, pulses, rate))


def state_of(player: Player) -> dict[str, list[float]]:
    """The answer."""
    found: dict[str, list[float]] = json.loads(player.answer())
    return found


def as_inputs(scene: Scene, schedule: Mapping[int, Sequence[int]], frames: int) -> Scene:
    """The scene with the inputs that the pulses of a schedule make in so many frames, for `simulate`."""
    made = []
    for channel in Outputs(scene).channels:
        values = [channel.full * ((pulses[channel.number - 1] - 1500) / 500) for pulses in schedule.values()]
        made += [Input(signal, "steps", f"input[{signal}]", t_s=tuple(at * STEP_S for at in schedule),
                       value=tuple(values)) for signal in channel.signals]
    outputs = replace(scene.outputs, every_s=EVERY * STEP_S)
    return replace(scene.with_run(duration_s=frames * STEP_S), inputs=tuple(made), outputs=outputs)


SKID = {0: (1500, 1500, 1500, 1500), 100: (1580, 1500, 1640, 1500), 1500: (1640, 1500, 1400, 1500),
        2600: (1400, 1500, 1430, 1500), 3600: (1500, 1500, 1500, 1500)}
MECANUM = {0: (1520, 1520, 1520, 1520), 1000: (1480, 1520, 1480, 1520), 2500: (1535, 1510, 1490, 1500),
           3500: (1500, 1500, 1500, 1500)}
CAR = {0: (1500, 1500, 1500, 1500), 100: (1500, 1500, 1650, 1500), 800: (1700, 1500, 1650, 1500),
       2000: (1250, 1500, 1580, 1500), 3500: (1500, 1500, 1500, 1500)}


@pytest.mark.parametrize(("name", "schedule", "frames"), [
    ("skid_steer", SKID, FRAMES), ("robomaster_mecanum", MECANUM, FRAMES), ("f1tenth", CAR, 1600),
    pytest.param("f1tenth", CAR, FRAMES, marks=pytest.mark.nightly)])
def test_frames_in_lockstep_are_the_run_of_the_same_inputs(stand_in: Path, name: str,
                                                           schedule: dict[int, tuple[int, ...]], frames: int) -> None:
    scene = read_scene(name).with_run(step_s=STEP_S)
    text = "".join(f"{at} {' '.join(map(str, pulses))}\n" for at, pulses in schedule.items())
    with served(scene) as (server, lines):
        done = subprocess.run([stand_in, str(server.port), str(RATE), str(frames), str(EVERY), "17"], input=text,
                              capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    assert (lines, server.player.frames, server.player.repeated) == ([], frames, len(range(0, frames, 17)))
    rows = np.array([[float(each) for each in line.split()] for line in done.stdout.splitlines()])
    signals = ("origin_x_m", "origin_y_m", "heading_wrapped_rad", "yaw_rate_rad_per_s")
    run = simulate(as_inputs(scene, schedule, frames), signals)
    ours = np.column_stack(list(run.columns.values()))[1:]
    assert np.array_equal(rows[:, [1, 2, 3, 6]], ours * [1, -1, -1, -1])
    assert np.abs(ours[:, :3]).max(axis=0).min() > 0.3  # it went somewhere


@pytest.mark.parametrize(("name", "left", "right"), [("turtlebot3_burger", 1, 3), ("skid_steer", 1, 3)])
def test_more_on_the_left_turns_a_skid_steered_rover_to_the_right(name: str, left: int, right: int) -> None:
    player = Player(read_scene(name), print)
    pulses = [1500] * 4
    pulses[left - 1], pulses[right - 1] = 1650, 1550
    for count in range(200):
        player.take(frame(count, pulses), ME)
    state = state_of(player)
    assert state["position"][0] > 0.01 and state["position"][1] > 0.0
    assert state["attitude"][2] > 0.01 and state["imu"]["gyro"][2] > 0.01  # type: ignore[call-overload]


@pytest.mark.parametrize("name", ["robomaster_mecanum", "optiodom_omni3"])
def test_an_omni_rover_follows_the_mix_of_its_frame(name: str) -> None:
    scene = read_scene(name)
    given = replace(scene, ardupilot=ArduPilotTable(full_V=12.0))
    mixes = {3: ((1, -1, -1), (0, -1, 1), (1, 1, 1)), 4: ((1, -1, -1), (1, -1, 1), (1, 1, -1), (1, 1, 1))}
    mix = mixes[scene.wheel_count]
    for number, of_state in enumerate(("ahead", "turn", "right")):
        player = Player(given, print)
        for count in range(40):
            player.take(frame(count, [1500 + 20 * each[number] for each in mix]), ME)
        state = state_of(player)
        north, east, yaw = state["velocity"][0], state["velocity"][1], state["imu"]["gyro"][2]  # type: ignore
        sizes = {"ahead": north, "right": east, "turn": yaw}
        others = max(abs(size) for key, size in sizes.items() if key != of_state)
        assert sizes[of_state] > (3.0 * others if scene.wheel_count == 4 else 0.01), of_state  # Omni3 mixes roughly


def test_an_omni_rover_with_a_wheel_at_each_side_follows_the_mix_of_its_frame() -> None:
    wheels = [{"kind": "omni", "distance_m": 0.2, "bearing_deg": bearing, "axle_deg": bearing + 180.0}
              for bearing in (0.0, 270.0, 180.0, 90.0)]  # front, right, back, left: motors 1 to 4
    own = {"mass_kg": 8.0, "yaw_inertia_kgm2": 0.15, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 1e-3,
           "motor_gain_Nm_per_V": 0.2, "motor_damping_Nms": 0.2, "wheel": wheels}
    scene = build_scene({"vehicle": own, "run": {"duration_s": 1.0, "step_s": 0.001}})
    scene = replace(scene, ardupilot=ArduPilotTable(full_V=12.0))
    mix = ((0, 1, 1), (1, 0, 0), (0, -1, 1), (1, 0, 0))
    for number, of_state in enumerate(("ahead", "turn", "right")):
        player = Player(scene, print)
        for count in range(40):
            player.take(frame(count, [1500 + 20 * each[number] for each in mix]), ME)
        state = state_of(player)
        sizes = {"ahead": state["velocity"][0], "right": state["velocity"][1], "turn": state["imu"]["gyro"][2]}
        assert sizes[of_state] > 3.0 * max(abs(size) for key, size in sizes.items() if key != of_state), of_state


def test_a_car_steers_to_the_right_by_a_long_pulse() -> None:
    player = Player(read_scene("f1tenth"), print)
    for count in range(600):
        player.take(frame(count, (1700, 1500, 1600)), ME)
    state = state_of(player)
    assert state["velocity"][0] > 0.1 and state["attitude"][2] > 0.05 and state["position"][1] > 0.0


def test_the_velocity_is_that_of_the_origin_whose_place_is_sent() -> None:
    player = Player(read_scene("f1tenth"), print)
    for count in range(600):
        player.take(frame(count, (1700, 1500, 1600)), ME)
    before = state_of(player)
    player.take(frame(600, (1700, 1500, 1600)), ME)
    now = state_of(player)
    for axis in (0, 1):
        mean = 0.5 * (before["velocity"][axis] + now["velocity"][axis])
        assert (now["position"][axis] - before["position"][axis]) * RATE == pytest.approx(mean, abs=1e-5)


def test_specific_force_adds_up_to_the_velocity_and_shows_gravity() -> None:
    player = Player(read_scene("f1tenth"), print)
    velocity, yaw = 0j, 0.0
    for count in range(800):
        player.take(frame(count, (1800, 1500, 1650), rate=300), ME)
        state = state_of(player)
        force = state["imu"]["accel_body"]  # type: ignore[call-overload]
        middle = 0.5 * (yaw + state["attitude"][2])
        velocity += complex(force[0], force[1]) * complex(np.cos(middle), np.sin(middle)) / 300
        yaw = state["attitude"][2]
    assert force[2] == -9.80665
    assert abs(velocity - complex(*state["velocity"][:2])) < 1e-12 * 800


def test_the_step_follows_the_frame_rate_and_the_scene_bounds_it() -> None:
    player = Player(read_scene("skid_steer"), print)  # steps of 1 ms
    for count, rate in enumerate((400, 401, 402, 50, 2000, 2000)):
        player.take(frame(count, (1550, 1500, 1550), rate), ME)
    assert player.time_s == pytest.approx(1 / 400 + 1 / 401 + 1 / 402 + 1 / 50 + 2 / 2000, abs=1e-15)
    assert player.steps == 3 + 3 + 3 + 20 + 1 + 1


def test_what_is_not_a_servo_packet_is_dropped_with_one_line_a_kind() -> None:
    wrong = {b"": "too short", b"abc": "too short", packet(0, magic=18459): "wrong magic number",
             packet(0)[:-1]: "wrong length", packet(0)[:8]: "wrong length", packet(0, magic=29569): "wrong length",
             packet(0) + b"\0": "wrong length", packet(0, rate=0): "frame rate 0", bytes(1500): "wrong magic number"}
    for data, kind in wrong.items():
        with pytest.raises(Dropped) as caught:
            read_packet(data)
        assert caught.value.kind == kind
    assert read_packet(packet(7, magic=29569, channels=32)).pulses_us == (1500,) * 32
    with served(read_scene("turtlebot3_burger")) as (server, lines), client(server) as autopilot:
        for _ in range(3):
            for data in wrong:
                autopilot.send(data)
        autopilot.send(packet(0, (1600, 1500, 1600)))
        assert json.loads(autopilot.recv(4096))["timestamp"] == STEP_S
    assert [line.count("\n") for line in lines] == [0] * 4
    assert sum(server.player.said.values()) == 3 * len(wrong) and server.player.frames == 1


def test_a_count_that_goes_back_restarts_the_vehicle_and_the_same_count_is_answered_again() -> None:
    lines: list[str] = []
    player = Player(read_scene("turtlebot3_burger"), lines.append)
    for count in range(100):
        assert player.take(frame(count, (1700, 1500, 1700)), ME)
    moved = player.answer()
    assert not player.take(frame(99, (2000, 1500, 2000)), ME) and player.answer() == moved
    assert player.take(frame(0), ME) and state_of(player)["timestamp"] == STEP_S
    assert state_of(player)["position"] == [0.0, 0.0, 0.0]
    assert player.take(frame(1), ME) and player.take(frame(2), ("127.0.0.1", 4243))  # another program
    assert player.restarts == 2 and state_of(player)["timestamp"] == STEP_S
    assert lines == 2 * ["the autopilot has restarted: the vehicle is back at its start"]
    for count in range(100, 0, -1):
        player.take(frame(count), ME)
    assert player.restarts == 102 and len(lines) == 10


def test_missing_frames_are_reported_and_the_count_may_begin_anew_at_its_end() -> None:
    lines: list[str] = []
    player = Player(read_scene("turtlebot3_burger"), lines.append)
    for count in (2**32 - 2, 2**32 - 1, 0, 1, 5):
        player.take(frame(count), ME)
    assert (player.restarts, player.missed, player.frames) == (0, 3, 5)
    assert len(lines) == 1 and lines[0].startswith("3 frames are missing before frame 5")


def test_each_stall_is_reported_once_and_the_vehicle_goes_on_after_it() -> None:
    with served(read_scene("turtlebot3_burger"), silent_s=0.0) as (server, lines), client(server) as autopilot:
        for count in range(2):
            autopilot.send(packet(count))
            assert json.loads(autopilot.recv(4096))["timestamp"] == pytest.approx((count + 1) * STEP_S)
            while server.player.said["silence"] <= count:
                pass
    assert lines == 2 * ["the autopilot has been silent for 0 s: the vehicle waits for it"]


def test_pulses_beyond_the_range_are_cut_with_a_line_and_no_pulse_is_neutral() -> None:
    lines: list[str] = []
    player = Player(read_scene("turtlebot3_burger"), lines.append)
    for count, pulses in enumerate(((0, 0, 0), (65535, 65535, 1), (65535, 0, 2001))):
        player.take(frame(count, pulses), ME)
        assert np.isfinite(state_of(player)["position"]).all()
    assert [line.split(" has")[0] for line in lines] == ["SERVO1", "SERVO3"]
    assert player.outputs.shares((0, 1000, 1250, 2000, 9999))[0] == [0.0, -1.0, -0.5, 1.0, 1.0]


def test_a_throttle_that_sets_speeds_reaches_them() -> None:
    scene = read_scene("turtlebot3_burger")
    assert scene.ardupilot is not None
    given = replace(scene, ardupilot=replace(scene.ardupilot, full_V=None, full_speed_rad_per_s=8.0))
    player = Player(given, print)
    for count in range(800):
        player.take(frame(count, (1750, 1500, 1625)), ME)
    assert player.robot.speeds() == pytest.approx([4.0, 2.0], rel=1e-3)


def with_table(tmp_path: Path, name: str, table: str) -> Path:
    """A scene of the project with another [ardupilot]."""
    text = read_scene(name).path.read_text(encoding="utf-8")
    before, _, after = text.partition("[ardupilot]")
    rest = after.partition("\n[")[2]
    path = tmp_path / "scene.toml"
    path.write_text(f"{before}\n{table}\n" + (f"[{rest}" if rest else ""), encoding="utf-8")
    return path


def snippets(language: str, start: str) -> list[str]:
    """Those of the page that begin so."""
    page = (SOURCE_DIR / "docs/play.md").read_text(encoding="utf-8")
    return [start + each.partition("```")[0] for each in page.split(f"```{language}\n{start}")[1:]]


def test_the_table_of_the_page_sets_throttle_and_steering(tmp_path: Path) -> None:
    outputs = Outputs(read_scene(with_table(tmp_path, "f1tenth", snippets("toml", "[ardupilot]")[0])))
    shares, _ = outputs.shares((1900, 1500, 1300))
    assert dict(zip(outputs.signals, outputs.values(shares).tolist(), strict=True)) == {
        "steering_angle_rad": -0.35, "voltage_V[1]": -6.0, "voltage_V[2]": -6.0}


def test_the_program_of_the_page_drives_to_the_north_east(capsys: pytest.CaptureFixture[str]) -> None:
    with served(read_scene("f1tenth")) as (server, lines):
        exec(snippets("python", "import json")[0].replace("9002", str(server.port)), {})
    place, attitude = (json.loads(f"[{each}]") for each in re.findall(r"\[(.*?)\]", capsys.readouterr().out))
    assert place[0] > 1.0 and place[1] > 0.3 and attitude[2] > 0.3 and (lines, server.player.frames) == ([], 800)


def test_a_table_of_channels_replaces_the_usual_ones(tmp_path: Path) -> None:
    table = snippets("toml", "[ardupilot]")[1].removeprefix("[ardupilot]")
    outputs = Outputs(read_scene(with_table(tmp_path, "turtlebot3_burger", f"""[ardupilot]{table}
[[ardupilot.channel]]
number = 8
signals = ["voltage_V[2]"]
full = 1.0
""")))
    assert outputs.signals == ("voltage_V[1]", "voltage_V[2]")
    shares, _ = outputs.shares((1300, 1500, 1500, 1500, 1500, 1500, 1500, 1900))
    assert outputs.values(shares).tolist() == [6.0, 7.0]


def test_an_output_with_two_tables_says_so_before_it_starts(tmp_path: Path) -> None:
    scene = read_scene(with_table(tmp_path, "turtlebot3_burger", """[[ardupilot.channel]]
number = 2
signals = ["voltage_V[1]"]
full = 6.0
[[ardupilot.channel]]
number = 2
signals = ["voltage_V[2]"]
full = -6.0
"""))
    told = introduction(Player(scene, print), 9002)
    assert "  SERVO2: voltage_V[1] = 6, voltage_V[2] = -6 at 1 (2 tables have this number)" in told


@pytest.mark.parametrize(("table", "words"), [
    ("[ardupilot]\nfull_V = 0", "ardupilot.full_V: is 0; give a value above 0"),
    ("[ardupilot]\nfull_V = 1\nfull_speed_rad_per_s = 1", "full_V: is given besides full_speed_rad_per_s"),
    ("[ardupilot]\npwm_us = [1500, 1000, 2000]", "ardupilot.pwm_us: must rise"),
    ("[ardupilot]\npwm_us = [1500, 1000]", "ardupilot.pwm_us: has 2 entries, not 3"),
    ("[ardupilot]\nvolts = 1", "ardupilot.volts: is no known key here"),
    ("[[ardupilot.channel]]\nnumber = 33\nsignals = ['voltage_V[1]']\nfull = 1", "channel[1].number: is 33; give"),
    ("[[ardupilot.channel]]\nnumber = 1\nsignals = []\nfull = 1", "channel[1].signals: is empty"),
    ("[[ardupilot.channel]]\nnumber = 1\nsignals = ['voltage_V[3]']\nfull = 1", "there is no input voltage_V[3]"),
    ("[[ardupilot.channel]]\nnumber = 1\nsignals = ['wheel_speed_rad_per_s[3]']\nfull = 1", "wheel_speed_rad_per_s[3]"),
    ("[[ardupilot.channel]]\nnumber = 1\nsignals = ['voltage_V[1]']\nfull = 0", "channel[1].full: is 0; give"),
    ("[ardupilot]\nfull_V = 3\n[[ardupilot.channel]]\nnumber = 1\nsignals = ['voltage_V[1]']\nfull = 1",
     "ardupilot.full_V: has no effect besides [[ardupilot.channel]]"),
    ("[[ardupilot.channel]]\nnumber = 2\nsignals = ['voltage_V[1]']\nfull = 1\n"
     "[[ardupilot.channel]]\nnumber = 2\nsignals = ['voltage_V[2]']\nfull = 1",
     "channel[2].number: is 2, as of channel[1] with the same full; name all of this output's inputs in the signals of "
     "one table, or correct the number"),
    ("[[ardupilot.channel]]\nnumber = 2\nsignals = ['voltage_V[1]']\nfull = 1\n"
     "[[ardupilot.channel]]\nnumber = 2\nsignals = ['voltage_V[1]']\nfull = 2",
     "channel[2].signals: sets voltage_V[1] by output 2, as channel[1] does; keep one of them")])
def test_a_wrong_table_is_refused_in_one_line(tmp_path: Path, table: str, words: str) -> None:
    with pytest.raises(BadInput) as caught:
        read_scene(with_table(tmp_path, "turtlebot3_burger", table))
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(("name", "words"), [
    ("paper_differential_drive", "ardupilot.full_V: is missing"),
    ("tricycle_agv", "ardupilot"), ("frc_swerve_mk4i", "ardupilot"), ("optiodom_omni4", "ardupilot.full_V")])
def test_vehicles_without_usual_outputs_are_refused_with_the_remedy(name: str, words: str) -> None:
    with pytest.raises(BadInput) as caught:
        Player(read_scene(name), print)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_refused_step_ends_the_run_with_a_failed_verdict(tmp_path: Path) -> None:
    text = read_scene("f1tenth").path.read_text(encoding="utf-8")
    path = tmp_path / "car.toml"
    path.write_text(text.replace('steered = "coordinated"', 'steered = "coordinated"\nat_limit = "refuse"'),
                    encoding="utf-8")
    sent: list[socket.socket] = []

    def say(line: str) -> None:
        if "UDP port" in line:  # before the server reads: packets wait for it
            autopilot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            autopilot.connect(("127.0.0.1", int(line.split("port ")[1].split(":")[0])))
            sent.append(autopilot)
            for count in range(3):
                autopilot.send(packet(count, (2000 if count == 2 else 1500,)))

    judgement = play_ardupilot(read_scene(path), port=0, duration_s=30.0, say=say)
    sent[0].close()
    failed = [each for each in judgement.verdicts if not each.passed]
    assert judgement.exit_status == 1 and judgement.figures["frames"] == 2 and [each.name for each in failed] == \
        ["vehicle"]
    assert "the command asks for" in failed[0].detail and "\n" not in failed[0].detail


def test_a_run_that_no_autopilot_joined_does_not_pass() -> None:
    judgement = play_ardupilot(read_scene("turtlebot3_burger"), port=0, duration_s=0.01, say=lambda line: None)
    (verdict,) = judgement.verdicts
    assert not verdict.passed and "start the autopilot" in verdict.detail and judgement.exit_status == 1


def test_ctrl_c_ends_the_command_with_status_0_and_its_figures() -> None:
    command = [sys.executable, "-m", "laconic", "play", "turtlebot3_burger", "--ardupilot", "--listen", "0", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env=dict(os.environ)) as run:
        assert run.stderr is not None and run.stdout is not None
        port = next(int(line.split("port ")[1].split(":")[0]) for line in run.stderr if "UDP port" in line)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as autopilot:
            autopilot.settimeout(10.0)
            for count in range(3):
                autopilot.sendto(packet(count), ("127.0.0.1", port))
                autopilot.recv(4096)
        run.send_signal(signal.SIGINT)
        found = json.loads(run.stdout.read())
        assert run.wait(10.0) == 0
    assert found["figures"]["frames"] == 3 and "stopped by the user" in found["notes"]
    assert any("autopilot not" in note for note in found["notes"])


def test_options_of_a_bus_and_a_port_in_use_are_refused_in_one_line() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(BadInput, match="--listen .*cannot be opened"):
            Server(Player(read_scene("turtlebot3_burger"), print), taken.getsockname()[1])
    with pytest.raises(BadInput, match="--listen 70000: is not a port"):
        Server(Player(read_scene("turtlebot3_burger"), print), 70000)
    done = subprocess.run([sys.executable, "-m", "laconic", "play", "f1tenth", "--ardupilot", "--channel", "can0"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "--channel: has no meaning beside --ardupilot" in done.stderr
