"""FRC robots with wrong inputs, devices or robot programs; the page's commands; a drive against its equations."""

from __future__ import annotations

import asyncio
import json
import math
import re
import sys
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from importlib import import_module
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import laconic.frc
from laconic.base.paths import SOURCE_DIR
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.frc import Bridge, Drivetrain, Robot, new_scene
from laconic.frc.physics import Engine
from laconic.frc.websocket import checked

PAGE = SOURCE_DIR / "docs/frc.md"
SWERVE = Robot("swerve", 52.0, (0.85, 0.85), 0.52, module="mk4i-l2", steering_motor="NEO")
TANK = Robot("differential", 52.0, (0.85, 0.75), 0.56, motor="CIM", motors=2, gearing=10.71, wheel_radius_m=0.0762)
ENABLED = ("DriverStation", "", {">enabled": True})
PROGRAM = [("PWM", "0", {"<init": True, "<speed": 0.4}), ("PWM", "1", {"<init": True, "<speed": -0.4}),
           ("Encoder", "0", {"<init": True, "<channel_a": 0}), ("Encoder", "1", {"<init": True, "<channel_a": 2}),
           ("Gyro", "ADXRS450[0]", {"<>angle_x": 0.0}), ENABLED]
Program = Callable[[Any], Awaitable[None]]


def scene_of(folder: Path, robot: Robot, **values: object) -> Path:
    text = new_scene(robot).text
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
        assert count, key
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return path


def text_of(kind: str, device: str, data: dict[str, Any]) -> str:
    return json.dumps({"type": kind, "device": device, "data": data})


# ---- the page's commands


def commands_of_the_page() -> list[list[str]]:
    text = PAGE.read_text(encoding="utf-8").replace("\\\n", " ")
    return [line.split()[1:] for line in text.splitlines() if line.startswith("laconic frc ")]


@pytest.mark.parametrize("words", [each for each in commands_of_the_page() if "--new" in each],
                         ids=lambda words: words[2])
def test_a_new_robot_of_the_page_is_a_scene_that_drives(words: list[str], tmp_path: Path,
                                                       monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(words) == 0
    drive = Drivetrain("robot.toml")
    for _ in range(10):
        drive.run(0.02, [0.5] * drive.wheel_count, [0.0] * drive.steered_count)
    assert drive.motion().x_m > 0.01
    assert drive.battery_V < 12.0


def test_the_bridge_of_the_page_drives_a_program_and_writes_its_log(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    scene_of(tmp_path, TANK)
    words = next(each for each in commands_of_the_page() if "--log" in each)
    words[words.index("--duration") + 1] = "0.3"
    with served(PROGRAM) as (url, heard):
        assert run([*words, "--url", url, "--json"]) == 0
    output, told = capsys.readouterr()
    rows = np.genfromtxt("run.csv", delimiter=",", names=True)
    assert len(rows) == json.loads(output)["cycles"] == 15
    assert json.loads(output)["ended_by"] == "time"
    assert json.loads(output)["final"]["x_m"] == pytest.approx(rows["x_m"][-1]) and rows["x_m"][-1] > 0.01
    assert "heard nothing" not in told
    station = next(each["data"] for each in heard if each["type"] == "DriverStation")
    assert station[">enabled"] and station[">autonomous"] and not station[">test"]


# ---- what a team gives


@pytest.mark.parametrize("words, field, remedy", [
    ("--mass 115 --bumpers 33inx33in", "mass: 115 kg", "115lb"), ("--mass 52 --bumpers 33x33", "bumpers: 33 m", "33in"),
    ("--mass 52 --bumpers 33inx33", "bumpers: 33 m", "33in"),
    ("--mass 52 --bumpers 1x1 --wheel-radius 2", "wheel radius: 2 m", "2in"),
    ("--mass 52 --bumpers 1x1 --gearing nan", "gearing: nan", "above 0"),
    ("--mass nan --bumpers 1x1", "--mass nan", "115lb"), ("--mass 115stone --bumpers 1x1", "--mass 115stone", "115lb"),
    ("--mass 52 --bumpers 1x1 --friction -1", "friction: -1", "above 0"),
    ("--mass 52 --bumpers 1x1 --current-limit inf", "current-limit inf", "60 or 60A"),
    ("--mass 52 --bumpers 1x1 --current-limit 60V", "current-limit 60V", "60 or 60A"),
    ("--mass 52 --bumpers 1x1 --motor krakenX6", "krakenX6", "did you mean krakenX60"),
    ("--mass 52 --bumpers 1x1 --module mk9-l1", "module: there is no module", "known are mk4"),
    ("--mass 52 --bumpers 1x1 --name a\x01b", "name: holds", "plain text"),
    ("--mass 115 lb --bumpers 1x1", "lb: has no meaning", "115lb")])
def test_units_and_names_that_fit_no_robot_are_refused_with_the_remedy(
        words: str, field: str, remedy: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    module = [] if "--module" in words or "gearing" in words else ["--module", "mk4i-l2"]
    assert run(["frc", "--new", "swerve", *words.split(" "), "--track", "0.5", *module, "-o", "robot.toml"]) == 2
    error = capsys.readouterr().err
    assert field in error and remedy in error
    assert error.count("\n") == 1
    assert not Path("robot.toml").exists()


def test_a_name_with_quotes_stays_the_name_of_the_scene(tmp_path: Path) -> None:
    name = 'Team "1\\2" – Ü'
    made = new_scene(Robot("swerve", 52.0, (0.85, 0.85), 0.52, module="mk4i-l2", name=name))
    (tmp_path / "robot.toml").write_text(made.text, encoding="utf-8")
    assert Drivetrain(tmp_path / "robot.toml").scene.name == name


@pytest.mark.parametrize("key, value", [
    ("battery_V", "nan"), ("battery_V", "1e300"), ("battery_V", "0"), ("battery_V", '"12V"'),
    ("battery_resistance_ohm", "1e300"), ("battery_resistance_ohm", "-1"), ("drive_counts", "0"),
    ("drive_counts", "1e300"), ("drive", '"PWM[0]"'), ("drive", '["PWM[-1]", "PWM[0]", "PWM[1]", "PWM[2]"]'),
    ("steering", '["TalonFX[0]", "PWM[0]", "PWM[1]", "PWM[2]"]'), ("gyro", "3")])
def test_a_wrong_value_of_frc_is_refused_by_its_key(key: str, value: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=rf"robot\.toml: frc\.{key}: "):
        Drivetrain(scene_of(tmp_path, SWERVE, **{key: value}))


def test_a_scene_without_outputs_is_refused_by_the_key_that_misses(tmp_path: Path) -> None:
    path = tmp_path / "robot.toml"
    path.write_text(re.sub(r"(?m)^steering = .*$", "", new_scene(SWERVE).text), encoding="utf-8")
    with pytest.raises(BadInput, match="frc.steering: is missing; name the output"):
        Bridge(Drivetrain(path))


# ---- a device of several wheels


class FakeEncoder:
    """WPILib's EncoderSim without WPILib."""

    def __init__(self) -> None:
        self.count = 0

    def getInitialized(self) -> bool:  # noqa: N802
        return True

    def getCount(self) -> int:  # noqa: N802
        return self.count

    def setCount(self, count: int) -> None:  # noqa: N802
        self.count = count

    def setPeriod(self, seconds: float) -> None:  # noqa: N802
        assert seconds


def faked_wpilib(monkeypatch: pytest.MonkeyPatch) -> dict[int, FakeEncoder]:
    """WPILib's simulation where a differential drive's two outputs go ahead; its encoders by channel."""
    made: dict[int, FakeEncoder] = {}
    value = SimpleNamespace(get=lambda: 0.0, set=lambda _: None)
    simulation = ModuleType("wpilib.simulation")
    vars(simulation).update(
        EncoderSim=SimpleNamespace(createForChannel=lambda channel: made.setdefault(channel, FakeEncoder())),
        PWMSim=lambda channel: SimpleNamespace(getInitialized=lambda: True, getSpeed=lambda: -0.5 if channel else 0.5),
        SimDeviceSim=lambda _: SimpleNamespace(getDouble=lambda _: value),
        DriverStationSim=SimpleNamespace(getEnabled=lambda: True),
        RoboRioSim=SimpleNamespace(setVInVoltage=lambda _: None),
        PowerDistributionSim=lambda _: SimpleNamespace(getInitialized=lambda: False))
    package = ModuleType("wpilib")
    vars(package)["simulation"] = simulation
    monkeypatch.setitem(sys.modules, "wpilib", package)
    monkeypatch.setitem(sys.modules, "wpilib.simulation", simulation)
    return made


@pytest.mark.parametrize("wheels", [2, 4, 6])
def test_an_encoder_that_wheels_share_counts_the_turns_of_one(wheels: int, tmp_path: Path,
                                                              monkeypatch: pytest.MonkeyPatch) -> None:
    made = faked_wpilib(monkeypatch)
    robot = Robot("differential", 52.0, (0.85, 0.75), 0.56, 0.5, motor="CIM", motors=2, gearing=10.71,
                  wheel_radius_m=0.0762, wheels=wheels, friction=1.1)
    engine = laconic.frc.engine(scene_of(tmp_path, robot))(None, SimpleNamespace())
    for _ in range(50):
        engine.update_sim(0.0, 0.02)
    turns = [angle / (2.0 * math.pi) for angle in engine.drivetrain.motion().wheel_angle_rad]
    counts = engine.drivetrain.table.drive_counts
    assert min(turns) > 1.0 and len(made) == 2
    for each in made.values():           # wheels of one side slip, so that their angles differ
        assert min(abs(each.count / counts - turn) for turn in turns) < 2.0 / counts
    for _ in range(2):
        made[0].count = 0                # a reset by the program
        engine.update_sim(0.0, 0.02)
        assert 0 < made[0].count < 0.2 * made[2].count


# ---- the drivetrain


def test_a_differential_drive_follows_its_equations_within_1e_4_mm(tmp_path: Path) -> None:
    mass_kg, inertia, radius, track, gearing = 52.0, 5.0, 0.0762, 0.56, 10.71
    drive = Drivetrain(scene_of(tmp_path, TANK, yaw_inertia_kgm2=inertia, wheel_inertia_kgm2=1e-12,
                                viscous_friction_Nms=0.0, rotor_inertia_kgm2=0.0, battery_resistance_ohm=0.0))
    resistance, torque = 12.0 / 133.0 / 2.0, 2.42 / 133.0
    emf = (12.0 - 2.7 * 12.0 / 133.0) / (5310.0 * math.pi / 30.0)

    def derivative(state: np.ndarray, volts: np.ndarray) -> np.ndarray:
        _, _, heading, left, right = state
        speeds = np.array([left, right])
        forces = gearing * torque * (volts - gearing * emf * speeds / radius) / resistance / radius
        ahead, turn = forces.sum() / mass_kg, (forces[1] - forces[0]) * 0.5 * track / inertia
        mean = 0.5 * (left + right)
        return np.array([mean * math.cos(heading), mean * math.sin(heading), (right - left) / track,
                         ahead - 0.5 * track * turn, ahead + 0.5 * track * turn])

    state, worst, step = np.zeros(5), 0.0, 0.001
    for cycle in range(200):
        t = 0.02 * cycle
        volts = np.array([8.0, 8.0] if t < 1 else [10.0, 6.0] if t < 2 else [-6.0, 6.0] if t < 3 else [0.0, 0.0])
        for _ in range(20):
            a = derivative(state, volts)
            b = derivative(state + 0.5 * step * a, volts)
            c = derivative(state + 0.5 * step * b, volts)
            state = state + step / 6.0 * (a + 2.0 * b + 2.0 * c + derivative(state + step * c, volts))
        drive.run(0.02, (volts / 12.0).tolist())
        worst = max(worst, math.hypot(drive.motion().x_m - state[0], drive.motion().y_m - state[1]))
    assert math.hypot(*state[:2]) > 2.0
    assert 1e3 * worst < 1e-4


def test_a_robot_started_again_repeats_its_bits(tmp_path: Path) -> None:
    drive, runs = Drivetrain(scene_of(tmp_path, SWERVE)), []
    for _ in range(2):
        for cycle in range(20):
            drive.run(0.0207, [0.8] * 4, [0.3 * math.sin(0.2 * cycle)] * 4)
        runs.append((drive.motion(), drive.battery_V))
        drive.restart()
        assert drive.battery_V == 12.0
    assert runs[0] == runs[1]


def test_what_is_less_than_a_step_is_kept_for_the_next_cycle(tmp_path: Path) -> None:
    coarse, fine = (Drivetrain(scene_of(tmp_path, TANK)) for _ in range(2))  # steps of 5 ms
    coarse.run(0.021, [0.5, 0.5])
    coarse.run(0.019, [0.5, 0.5])
    for _ in range(40):
        fine.run(0.001, [0.5, 0.5])
    assert coarse.motion() == fine.motion()


@pytest.mark.parametrize("given, field", [
    ((0.02, [math.nan, 0.0]), "drive"), ((0.02, [0.5]), "drive"), ((0.02, [0.5, 0.5], [1.0]), "steering"),
    ((0.02, ["a", 0.0]), "drive"), ((math.inf, [0.0, 0.0]), "duration_s"), ((-1.0, [0.0, 0.0]), "duration_s")])
def test_outputs_that_are_no_numbers_are_refused_by_name(given: tuple[Any, ...], field: str, tmp_path: Path) -> None:
    drive = Drivetrain(scene_of(tmp_path, TANK))
    with pytest.raises(BadInput, match=field):
        drive.run(*given)


def test_an_output_beyond_the_battery_is_cut_and_told(tmp_path: Path) -> None:
    cut, full = (Drivetrain(scene_of(tmp_path, TANK)) for _ in range(2))
    cut.run(0.1, [3.0, 1.0])
    full.run(0.1, [1.0, 1.0])
    assert cut.motion() == full.motion()
    assert [("drive" in event, count) for event, count in cut.events.items()] == [(True, 1)] and not full.events


@pytest.mark.parametrize("given, words", [
    (lambda robot: None, "gave None"), (lambda robot: {"drives": []}, "frc.drives: there is no such list"),
    (lambda robot: {"drive": [1]}, "has 1 devices for 2 axes")])
def test_a_wrong_function_of_devices_is_refused_by_its_list(given: Any, words: str, tmp_path: Path) -> None:
    class OfTest(Engine):
        scene = scene_of(tmp_path, TANK)
        devices = staticmethod(given)

    with pytest.raises(BadInput, match=words):
        OfTest(None, object())


def test_engine_is_the_function_whatever_was_imported_before() -> None:
    for name in sorted(each.stem for each in Path(laconic.frc.__file__).parent.glob("[a-z]*.py")):
        import_module(f"laconic.frc.{name}")
    assert all(callable(getattr(laconic.frc, name)) or isinstance(getattr(laconic.frc, name), dict)
               for name in laconic.frc.__all__)


# ---- the bridge


@asynccontextmanager
async def server_of(program: Program) -> AsyncIterator[str]:
    from websockets.asyncio.server import serve

    async with serve(program, "127.0.0.1", 0) as server:
        yield f"ws://127.0.0.1:{next(iter(server.sockets)).getsockname()[1]}/wpilibws"


@contextmanager
def served(messages: list[tuple[str, str, dict[str, Any]]]) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """A robot program in a thread: its address, and what it hears."""
    heard, ready, address = list[dict[str, Any]](), threading.Event(), list[Any]()

    async def program(socket: Any) -> None:
        for each in messages:
            await socket.send(text_of(*each))
        async for text in socket:
            heard.append(json.loads(text))

    async def serve_until_told() -> None:
        end = asyncio.Event()
        async with server_of(program) as url:
            address.extend((url, asyncio.get_running_loop(), end))
            ready.set()
            await end.wait()

    thread = threading.Thread(target=lambda: asyncio.run(serve_until_told()))
    thread.start()
    assert ready.wait(10.0)
    try:
        yield address[0], heard
    finally:
        address[1].call_soon_threadsafe(address[2].set)
        thread.join(10.0)


async def drained(socket: Any) -> None:
    """A program that listens until the bridge leaves."""
    async for _ in socket:
        pass


async def talk_and_listen(socket: Any) -> None:
    for each in PROGRAM:
        await socket.send(text_of(*each))
    await drained(socket)


def played(folder: Path, program: Program, duration_s: float = 0.1, runs: int = 1) -> tuple[Bridge, list[str]]:
    """A bridge after its run with a program, and what it said."""
    said = list[str]()

    async def both() -> Bridge:
        async with server_of(program) as url:
            for _ in range(runs):
                bridge = Bridge(Drivetrain(scene_of(folder, TANK)), url, say=said.append)
                await bridge.run(duration_s)
            return bridge

    return asyncio.run(asyncio.wait_for(both(), 20.0)), said


UNUSABLE = {"no JSON": "{", "no object": "[]", "no type": '{"device": "0", "data": {}}', "bytes": b"\xff\xfe{",
            "data is a list": '{"type": "PWM", "device": "0", "data": [1]}', "deep": "[" * 100_000,
            **{f"output {value[:9]}": f'{{"type": "PWM", "device": "0", "data": {{"<speed": {value}}}}}' for value in (
                "NaN", "Infinity", "true", "null", '"full"', "[1]", "1" + "0" * 400, "1" + "0" * 5000)}}


@pytest.mark.parametrize("text", UNUSABLE.values(), ids=UNUSABLE)
def test_a_message_that_is_none_changes_nothing_and_is_counted(text: str | bytes, tmp_path: Path) -> None:
    bridge, twin = (Bridge(Drivetrain(scene_of(tmp_path, TANK))) for _ in range(2))
    for each in PROGRAM:
        bridge.hear(text_of(*each))
        twin.hear(text_of(*each))
    bridge.hear(text)
    for each in (bridge, twin):
        each.robot.run(0.02, each._of(each.robot.table.drive), [])
    assert bridge.robot.motion() == twin.robot.motion() and bridge.robot.motion().x_m > 0.0
    assert (bridge.figures.unusable, twin.figures.unusable) == (1, 0)


def test_the_bridge_hears_on_after_messages_that_are_none_and_tells_of_them(tmp_path: Path) -> None:
    async def program(socket: Any) -> None:
        for text in UNUSABLE.values():
            await socket.send(text)
        for each in PROGRAM:
            await socket.send(text_of(*each))
        await drained(socket)

    bridge, said = played(tmp_path, program)
    assert bridge.robot.motion().x_m > 0.0
    count = len(UNUSABLE)
    assert len(said) == 1 and said[0].startswith(f"{count} of {count + len(PROGRAM)} messages were not of WPILib's")


@pytest.mark.parametrize("how", ["closed", "cut"])
def test_a_program_that_ends_is_told_in_a_line_and_ends_the_run(how: str, tmp_path: Path) -> None:
    async def program(socket: Any) -> None:
        for each in PROGRAM:
            await socket.send(text_of(*each))
        await socket.recv()
        if how == "cut":
            socket.transport.abort()

    bridge, said = played(tmp_path, program, math.inf)
    assert len(said) == 1 and re.match(r"the robot program ended the connection after \d\.\d\d s; start it", said[0])
    assert bridge.figures.cycles < 50
    assert bridge.figures.ended_by == "program"


def test_a_program_started_again_finds_a_robot_at_its_start(tmp_path: Path) -> None:
    bridge, said = played(tmp_path, talk_and_listen, runs=2)
    assert said == []
    assert bridge.figures.cycles == 5 and 0.0 < bridge.robot.motion().x_m < 0.1


def test_a_program_that_starts_late_is_waited_for(tmp_path: Path) -> None:
    said = list[str]()

    async def both() -> Bridge:
        from websockets.asyncio.server import serve

        async with server_of(talk_and_listen) as url:
            port = int(url.split(":")[2].split("/")[0])
        bridge = Bridge(Drivetrain(scene_of(tmp_path, TANK)), url, say=said.append)
        running = asyncio.create_task(bridge.run(0.06))
        await asyncio.sleep(0)
        async with serve(talk_and_listen, "127.0.0.1", port):
            await running
        return bridge

    assert asyncio.run(asyncio.wait_for(both(), 20.0)).figures.cycles == 3
    assert said == []


def test_devices_that_the_program_lacks_are_named(tmp_path: Path) -> None:
    async def program(socket: Any) -> None:
        for each in (PROGRAM[0], PROGRAM[3], ENABLED):
            await socket.send(text_of(*each))
        await drained(socket)

    assert played(tmp_path, program)[1] == [
        "heard nothing of PWM[1], Encoder[0], ADXRS450[0]; compare [frc] with the program's ports"]


def test_a_robot_stands_until_it_is_enabled(tmp_path: Path) -> None:
    bridge = Bridge(Drivetrain(scene_of(tmp_path, TANK)))
    for each in PROGRAM[:-1]:
        bridge.hear(text_of(*each))
    assert bridge._of(bridge.robot.table.drive) == [0.0, 0.0]
    bridge.hear(text_of(*ENABLED))
    assert bridge._of(bridge.robot.table.drive) == [0.4, 0.4]


@pytest.mark.parametrize("url", ["ws://", "http://127.0.0.1:3300/wpilibws", "ws://127.0.0.1:99999/x", "ws://:3/",
                                 "ws://127.0.0.1:33x/", "ws://[::1/", "127.0.0.1:3300", ""])
def test_an_address_that_is_none_is_refused_before_the_run(url: str) -> None:
    with pytest.raises(BadInput, match="is not the address of a WebSocket; give one such as ws://127"):
        checked(url)


@pytest.mark.parametrize("answer", [b"HTTP/1.1 404 no\r\n\r\n", b"\xff\xfe\n\n"], ids=["404", "no HTTP"])
def test_another_server_at_the_address_is_told_in_a_line(answer: bytes, tmp_path: Path) -> None:
    async def both() -> None:
        async def other(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            await reader.readline()
            writer.write(answer)
            writer.close()

        async with await asyncio.start_server(other, "127.0.0.1", 0) as server:
            port = server.sockets[0].getsockname()[1]
            await Bridge(Drivetrain(scene_of(tmp_path, TANK)), f"ws://127.0.0.1:{port}/wpilibws").run(1.0)

    with pytest.raises(BadInput, match="refused the connection; WPILib's server has the path /wpilibws"):
        asyncio.run(asyncio.wait_for(both(), 20.0))
