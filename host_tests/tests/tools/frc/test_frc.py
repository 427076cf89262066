"""FRC robots: generator, drivetrain, bridge; with robotpy also the robots of docs/frc.md, and WPILib's own models."""

from __future__ import annotations

import asyncio
import json
import math
import os
import re
import shutil
import subprocess
import sys
import time
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.frc import MOTORS, Bridge, Drivetrain, Robot, new_scene
from laconic.frc.drivetrain import Axis, Battery
from laconic.frc.new import box, mass, module_of, motor_of
from laconic.frc.physics import Engine
from laconic.scene import read_scene
from laconic.scene.base import FrcTable

PAGE = SOURCE_DIR / "docs/frc.md"
SWERVE = Robot("swerve", 52.0, (0.85, 0.85), 0.52, module="mk4i-l2", steering_motor="NEO")
MECANUM = Robot("mecanum", 52.0, (0.85, 0.75), 0.56, 0.5, motor="CIM", gearing=10.71, wheel_radius_m=0.0762)
TANK = Robot("differential", 52.0, (0.85, 0.75), 0.56, motor="CIM", motors=2, gearing=10.71, wheel_radius_m=0.0762)
needs_robotpy = pytest.mark.skipif(not (find_spec("wpilib") and find_spec("pyfrc")), reason="needs robotpy and pyfrc")


def with_keys(text: str, **values: object) -> str:
    """The scene with other values of keys, wherever they are."""
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
        assert count, key
    return text


def scene_of(folder: Path, robot: Robot, **values: object) -> Path:
    path = folder / "robot.toml"
    path.write_text(with_keys(new_scene(robot).text, **values), encoding="utf-8")
    return path


def ideal_swerve() -> Robot:
    return Robot("swerve", 52.0, (0.85, 0.85), 0.52, module="mk4i-l2", is_ideal=True)


# ---- the generator


def test_motors_have_the_constants_that_follow_from_their_published_data() -> None:
    for name, constants in {"NEO": (0.02476, 0.1143, 50.40), "krakenX60": (0.01937, 0.03279, 52.65),
                            "krakenX60FOC": (0.01940, 0.02484, 50.83)}.items():
        motor = motor_of(name)
        found = (motor.torque_constant_Nm_per_A, motor.resistance_ohm, 1.0 / motor.back_emf_Vs_per_rad)
        assert found == pytest.approx(constants, rel=3e-4)
    assert motor_of("Kraken X60").name == "krakenX60"
    assert motor_of("falcon").name == "falcon500"


@pytest.mark.parametrize("robot, of_modules", [(SWERVE, 4 * 0.03), (MECANUM, 0.0), (TANK, 0.0)])
def test_inertias_that_are_said_are_those_of_the_scene(robot: Robot, of_modules: float, tmp_path: Path) -> None:
    made = new_scene(robot)
    said = {name: text for line in made.assumed for name, text in re.findall(r"^(.*?) ([\d.e-]+) kg m²", line)}
    written = read_scene(scene_of(tmp_path, robot)).vehicle
    length_m, width_m = robot.bumpers_m
    assert written["yaw_inertia_kgm2"] == float(said["yaw inertia"]) == pytest.approx(
        52.0 * (length_m**2 + width_m**2) / 12.0 - of_modules, rel=1e-3)
    assert written["wheel_inertia_kgm2"] == float(said["inertia of a wheel"])


def test_quantities_take_the_units_of_teams() -> None:
    assert mass("--mass", "115lb") == pytest.approx(52.1631, abs=1e-4)
    assert box("--bumpers", "33inx0.8") == pytest.approx((0.8382, 0.8))
    assert module_of("MK4i L2")[1:] == (6.75, "mk4i-l2")


@pytest.mark.parametrize("robot", [SWERVE, ideal_swerve(), MECANUM, TANK, Robot(
    "differential", 52.0, (0.85, 0.75), 0.56, 0.6, "NEO", 2, 8.45, 0.0762, wheels=6, friction=1.1)],
    ids=["swerve", "ideal swerve", "mecanum", "differential", "six wheels"])
def test_every_new_robot_drives_straight_ahead(robot: Robot, tmp_path: Path) -> None:
    drive = Drivetrain(scene_of(tmp_path, robot))
    for _ in range(50):
        drive.run(0.02, [0.5] * drive.wheel_count, [0.0] * drive.steered_count)
    motion = drive.motion()
    assert motion.x_m > 1.0
    assert abs(motion.y_m) < 1e-6
    assert drive.events == {}


@pytest.mark.parametrize("words, field", [
    ("--new swerve --bumpers 1x1 --track 0.5 -o a.toml", "--mass: is missing"),
    ("--new swerve --mass 52 --bumpers 1 --track 0.5 -o a.toml", "--bumpers 1"),
    ("--new swerve --mass 52 --bumpers 1x1 --track 2 --module mk4i-l2 -o a.toml", "track: 2 m"),
    ("--new swerve --mass 52 --bumpers 1x1 --track 0.5 --module mk4i-l9 -o a.toml", "mk4i-l1"),
    ("--new swerve --mass 52 --bumpers 1x1 --track 0.5 --module mk4i-l2 --motor krakn -o a.toml", "there is no motor"),
    ("--new mecanum --mass 52 --bumpers 1x1 --track 0.5 --gearing 8 -o a.toml", "wheel radius: is missing"),
    ("--new differential --mass 52 --bumpers 1x1 --track 0.5 --gearing 8 --wheel-radius 3in --wheels 6 -o a.toml",
     "friction of the ground"),
    ("--new swerve --mass=-3 --bumpers 1x1 --track 0.5 -o a.toml", "--mass -3"),
    ("--new mecanum --mass 52 --url ws://x --bumpers 1x1 --track 0.5 -o a.toml", "--url"),
    ("", "SCENE: is missing"), ("s1 --url http://x", "WebSocket")])
def test_wrong_options_are_refused_by_name(words: str, field: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                           capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["frc", *words.split()]) == 2
    error = capsys.readouterr().err
    assert field in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("key, value, words", [
    ("drive", '["PWM[0]"]', "names 1 devices for 4 wheels"), ("gyro", '"PWM[0]"', "not a device for this"),
    ("gyro", '"ADXRS450"', "is not the name of a device"),
    ("drive", '["PWM[0]", "PWM[1]", "PWM[2]", "PWM[77]"]', "0 to"),
    ("battery_V", "-1", "frc.battery_V"), ("steering_encoder", '["SimDevice:a", "Encoder[0]", "Encoder[2]", '
                                           '"Encoder[4]"]', "SimDevice:NAME/VALUE")])
def test_wrong_devices_are_refused_by_key(key: str, value: str, words: str, tmp_path: Path) -> None:
    path = scene_of(tmp_path, SWERVE, **{key: value})
    with pytest.raises(BadInput, match=re.escape(words)):
        Drivetrain(path)


# ---- the drivetrain


def test_battery_and_motors_hold_at_the_same_time() -> None:
    axes = [Axis(0.0328, 0.128, math.inf), Axis(0.0328, 0.128, 60.0), Axis(0.1143, 0.425, 40.0)]
    battery = Battery(FrcTable(), axes)
    outputs, speeds = [1.0, 0.9, -0.7], [5.0, 20.0, -3.0]
    volts = battery.volts(outputs, speeds)
    drawn = [current * volt / battery.voltage_V for current, volt in zip(battery.motor_current_A, volts, strict=True)]
    assert battery.voltage_V == pytest.approx(12.0 - 0.02 * sum(drawn), abs=1e-9)
    for axis, volt, speed, current in zip(axes, volts, speeds, battery.motor_current_A, strict=True):
        assert volt - axis.back_emf_Vs * speed == pytest.approx(axis.resistance_ohm * current, abs=1e-9)
        assert abs(current) <= axis.limit_A
    assert abs(battery.motor_current_A[1]) == 60.0


def states_of(drive: Drivetrain) -> list[tuple[float, float]]:
    motion, radius = drive.motion(), drive.scene.vehicle["wheel_radius_m"]
    return [(radius * speed, angle) for speed, angle in
            zip(motion.wheel_speed_rad_per_s, motion.steering_angle_rad, strict=True)]


def steer_along(drive: Drivetrain, twist: tuple[float, float, float], cycles: int, output: float) -> None:
    """Turns the modules towards a motion, and drives."""
    places = [complex(each["hinge_x_m"], each["hinge_y_m"]) for each in drive.scene.vehicle["body"]]
    for _ in range(cycles):
        wanted = [complex(*twist[:2]) + 1j * twist[2] * place for place in places]
        steering = [max(-1.0, min(1.0, 1.5 * math.remainder(np.angle(w) - a, 2 * math.pi)))
                    for w, a in zip(wanted, drive.motion().steering_angle_rad, strict=True)]
        drive.run(0.02, [output] * 4, steering)


@pytest.mark.parametrize("twist", [(1.0, 0.5, 0.0), (1.0, 0.2, 1.5), (0.1, 0.0, 2.0)])
def test_without_slip_the_modules_make_the_chassis_speed(twist: tuple[float, float, float], tmp_path: Path) -> None:
    drive = Drivetrain(scene_of(tmp_path, ideal_swerve()))
    steer_along(drive, twist, 100, 0.4)
    motion = drive.motion()
    places = [complex(each["hinge_x_m"], each["hinge_y_m"]) for each in drive.scene.vehicle["body"]]
    rows = [row for p in places for row in ((1.0, 0.0, -p.imag), (0.0, 1.0, p.real))]
    right = [part for speed, angle in states_of(drive) for part in (speed * math.cos(angle), speed * math.sin(angle))]
    found = np.linalg.lstsq(np.array(rows), np.array(right), None)[0]
    assert (motion.ahead_m_per_s, motion.left_m_per_s, motion.yaw_rate_rad_per_s) == pytest.approx(
        tuple(found), abs=1e-6)
    assert math.hypot(*found[:2]) + abs(found[2]) > 0.5


def test_crossed_modules_brake_the_ideal_robot_and_are_reported(tmp_path: Path) -> None:
    drive = Drivetrain(scene_of(tmp_path, ideal_swerve()))
    turn = [1.0, -1.0, -1.0, 1.0]
    for _ in range(3):
        drive.run(0.02, [0.5] * 4, turn)
    for _ in range(150):
        drive.run(0.02, [0.5] * 4, [0.0] * 4)
    assert math.hypot(drive.motion().ahead_m_per_s, drive.motion().left_m_per_s) < 0.2
    assert any("no common motion" in event for event in drive.events)


def test_a_mecanum_robot_goes_sideways(tmp_path: Path) -> None:
    drive = Drivetrain(scene_of(tmp_path, MECANUM))
    for _ in range(50):
        drive.run(0.02, [-0.5, 0.5, 0.5, -0.5])
    assert drive.motion().y_m > 0.5
    assert abs(drive.motion().x_m) < 1e-9


# ---- the bridge, with a stand-in of the robot program


async def stand_in(socket: Any, heard: list[dict[str, Any]], cycles: int) -> None:
    """A robot program that drives ahead: it says what it has, then listens."""
    messages: list[tuple[str, str, dict[str, Any]]] = [
        *(("PWM", str(port), {"<init": True, "<speed": 0.4 if port == 0 else -0.4}) for port in (0, 1)),
        ("Encoder", "5", {"<init": True, "<channel_a": 0, "<channel_b": 1}),
        ("Encoder", "6", {"<init": True, "<channel_a": 2, "<channel_b": 3}),
        ("Gyro", "ADXRS450[0]", {"<>angle_x": 0.0}), ("DriverStation", "", {">enabled": True})]
    for kind, device, data in messages:
        await socket.send(json.dumps({"type": kind, "device": device, "data": data}))
    for noise in ("[]", "{", '{"type": 3}', '{"type": "PWM", "device": "0", "data": {"<speed": "x"}}'):
        await socket.send(noise)
    counted = 0
    async for text in socket:
        heard.append(json.loads(text))
        counted += heard[-1]["type"] == "RoboRIO"
        if counted == cycles:
            return


def test_the_bridge_is_the_hardware_of_a_robot_program(tmp_path: Path) -> None:
    heard, said = list[dict[str, Any]](), list[str]()

    async def both() -> Drivetrain:
        from websockets.asyncio.server import serve

        async with serve(lambda socket: stand_in(socket, heard, 12), "127.0.0.1", 0) as server:
            port = next(iter(server.sockets)).getsockname()[1]
            drive = Drivetrain(scene_of(tmp_path, TANK))
            await Bridge(drive, f"ws://127.0.0.1:{port}/wpilibws", say=said.append).run(5.0)
            return drive

    drive = asyncio.run(both())
    assert drive.motion().x_m > 0.01
    encoders = {each["device"]: each["data"] for each in heard if each["type"] == "Encoder"}
    assert encoders.keys() == {"5", "6"}
    assert encoders["5"][">count"] > 0
    assert [each["data"].keys() for each in heard if each["type"] == "Gyro"][-1] >= {"<>angle_x"}
    assert [each["data"][">vin_voltage"] for each in heard if each["type"] == "RoboRIO"][-1] < 12.0
    assert re.fullmatch(r"the robot program ended the connection after 0\.\d\d s; start it, then this again", said[0])
    assert said[1:] == ["4 of 10 messages were not of WPILib's protocol, or had an output that is no number; they "
                        "changed nothing"]


def test_a_program_that_does_not_answer_is_one_line(tmp_path: Path) -> None:
    bridge = Bridge(Drivetrain(scene_of(tmp_path, TANK)), "ws://127.0.0.1:9/wpilibws")
    with pytest.raises(BadInput, match="no robot program answers"):
        asyncio.run(bridge.run(1.0, connect_s=0.0))


# ---- with robotpy


def snippets() -> list[tuple[str, str]]:
    """Language and text of the page's blocks."""
    return re.findall(r"```(\w+)\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def project(folder: Path, command: str, robot: str) -> None:
    """A robot project as the page has it."""
    words = command.replace("\\\n", " ").split()[1:]
    words[words.index("-o") + 1] = str(folder / "robot.toml")
    assert run(words) == 0
    (folder / "robot.py").write_text(robot, encoding="utf-8")
    (folder / "physics.py").write_text(next(text for kind, text in snippets() if text.startswith("import laconic.frc")),
                                       encoding="utf-8")
    from importlib.metadata import version
    (folder / "pyproject.toml").write_text(f'[tool.robotpy]\nrobotpy_version = "{version("robotpy")}"\n',
                                           encoding="utf-8")


def of_page(kind: str, containing: str) -> str:
    return next(text for language, text in snippets() if language == kind and containing in text)


def robotpy(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join([str(Path(sys.executable).parent), str(os.environ["PATH"])])
    return subprocess.run([sys.executable, "-m", "robotpy", *words], cwd=folder, capture_output=True, text=True,
                          check=False, timeout=120, env={**os.environ, "PATH": path})


TESTS = {"mecanum": """
def test_autonomous(control, robot):
    with control.run_robot():
        seen = []
        control.step_timing(seconds=0.1, autonomous=True, enabled=False)
        for _ in range(4):
            control.step_timing(seconds=1.0, autonomous=True, enabled=True)
            seen.append(robot.physics.drivetrain.motion())
        assert seen[0].x_m > 0.5 and abs(seen[0].y_m) < 0.2
        assert seen[1].y_m < -0.3
        assert seen[2].heading_rad < -0.5
        assert abs(robot.gyro.getAngle() * 3.14159265358979 / 180 + seen[3].heading_rad) < 1e-6
        robot.gyro.reset()
        robot.encoders[0].reset()
        control.step_timing(seconds=0.2, autonomous=True, enabled=True)
        assert abs(robot.gyro.getAngle()) < 0.1 and abs(robot.encoders[0].get()) < 10
""", "differential": """
def test_autonomous(control, robot):
    with control.run_robot():
        control.step_timing(seconds=0.1, autonomous=True, enabled=False)
        control.step_timing(seconds=0.6, autonomous=True, enabled=True)
        ahead = robot.physics.drivetrain.motion()  # PWM pulses are whole, so that the sides differ a little
        assert ahead.x_m > 0.3 and abs(ahead.y_m) < 0.01 and robot.encoders[0].get() > 500
        control.step_timing(seconds=2.0, autonomous=True, enabled=True)
        assert robot.physics.drivetrain.motion().heading_rad > 0.5
        assert robot.gyro.getAngle() < -30
"""}


@needs_robotpy
@pytest.mark.nightly
@pytest.mark.parametrize("drive", ["swerve", "mecanum", "differential"])
def test_the_robots_of_the_page_pass_robotpy_test(drive: str, tmp_path: Path) -> None:
    command = of_page("sh", f"--new {drive}")
    command = command[command.index("laconic frc"):]
    project(tmp_path, command, of_page("python", {
        "swerve": "SwerveDrive4", "mecanum": "MecanumDrive", "differential": "DifferentialDrive"}[drive]))
    test = of_page("python", "def test_autonomous") if drive == "swerve" else TESTS[drive]
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests/robot_test.py").write_text(test, encoding="utf-8")
    done = robotpy(tmp_path, "test", "--", "-s")
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "1 passed" in done.stdout
    printed = re.findall(r"^x .*$", done.stdout, re.M)
    print(*printed)
    if drive == "swerve":
        numbers = [[float(each) for each in re.findall(r"-?\d+\.\d+", text)]
                   for text in (printed[0], of_page("text", "odometry"))]
        assert numbers[0] == pytest.approx(numbers[1], abs=0.002)


@needs_robotpy
@pytest.mark.nightly
def test_the_differential_drive_is_wpilibs_at_its_assumptions(tmp_path: Path) -> None:
    from wpilib import simulation
    from wpimath.system.plant import DCMotor

    mass_kg, inertia, radius, track, gearing = 52.0, 5.0, 0.0762, 0.56, 10.71
    motor = DCMotor.CIM(2)
    path = scene_of(tmp_path, TANK, yaw_inertia_kgm2=inertia, wheel_inertia_kgm2=1e-12, viscous_friction_Nms=0.0,
                    rotor_inertia_kgm2=0.0, battery_resistance_ohm=0.0)
    drive = Drivetrain(path)
    simulation.RoboRioSim.setVInVoltage(12.0)
    theirs = simulation.DifferentialDrivetrainSim(motor, gearing, inertia, mass_kg, radius, track)
    worst = 0.0
    for cycle in range(300):
        t = 0.02 * cycle
        volts = (8.0, 8.0) if t < 1 else (10.0, 6.0) if t < 2 else (-6.0, 6.0) if t < 3 else (
            12.0 * math.sin(9 * t), 9.0 * math.cos(7 * t)) if t < 5 else (0.0, 0.0)
        theirs.setInputs(*volts)
        theirs.update(0.02)
        drive.run(0.02, [each / 12.0 for each in volts])
        pose, motion = theirs.getPose(), drive.motion()
        worst = max(worst, math.hypot(motion.x_m - pose.X(), motion.y_m - pose.Y()))
    print(f"{1e3 * worst:.2g} mm")
    assert 1e3 * worst < 1e-4


@needs_robotpy
@pytest.mark.nightly
def test_motors_and_modules_are_those_of_wpimath(tmp_path: Path) -> None:
    from wpimath.geometry import Rotation2d, Translation2d
    from wpimath.kinematics import SwerveDrive4Kinematics, SwerveModuleState
    from wpimath.system.plant import DCMotor

    for name, motor in MOTORS.items():
        theirs = getattr(DCMotor, name)(1)
        assert (motor.torque_constant_Nm_per_A, motor.resistance_ohm, 1.0 / motor.back_emf_Vs_per_rad) == pytest.approx(
            (theirs.Kt, theirs.R, theirs.Kv), rel=1e-9), name
    drive = Drivetrain(scene_of(tmp_path, ideal_swerve()))
    kinematics = SwerveDrive4Kinematics(*(Translation2d(x, y) for x in (0.26, -0.26) for y in (0.26, -0.26)))
    for twist in ((1.0, 0.5, 0.0), (1.0, 0.2, 1.5), (0.1, 0.0, 2.0)):
        steer_along(drive, twist, 100, 0.4)
        speeds = kinematics.toChassisSpeeds(tuple(
            SwerveModuleState(speed, Rotation2d(angle)) for speed, angle in states_of(drive)))
        motion = drive.motion()
        assert (motion.ahead_m_per_s, motion.left_m_per_s, motion.yaw_rate_rad_per_s) == pytest.approx(
            (speeds.vx, speeds.vy, speeds.omega), abs=1e-6)


@needs_robotpy
@pytest.mark.nightly
def test_a_robot_program_of_its_own_is_driven_through_wpilibs_websocket(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = of_page("sh", "--new swerve")
    project(tmp_path, command[command.index("laconic frc"):], of_page("python", "SwerveDrive4"))
    (tmp_path / "physics.py").unlink()
    program = subprocess.Popen([sys.executable, "-m", "robotpy", "sim", "--nogui", "--ws-server"], cwd=tmp_path,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        capsys.readouterr()
        assert run(["frc", str(tmp_path / "robot.toml"), "--enable", "auto", "--duration", "4", "--json"]) == 0
        output, told = capsys.readouterr()
    finally:
        program.terminate()
        program.wait(20)
    final = json.loads(output)["final"]
    assert final["x_m"] > 1.0 and final["y_m"] > 1.0
    assert "heard nothing" not in told and json.loads(output)["unusable"] == 0


@pytest.mark.parametrize(("keys", "words"), [
    ({"drive_encoder": '["Encoder[0]", "Encoder[2]", "Encoder[4]", "DutyCycleEncoder[9]"]'},
     'frc.steering_encoder: names "DutyCycleEncoder[9]" for steered wheel 2, which drive_encoder names for wheel 4; a '
     "device is on one shaft: give the one that turns with the steering"),
    ({"steering": '["PWM[4]", "PWM[5]", "-PWM[1]", "PWM[7]"]'},
     'frc.steering: names "-PWM[1]" for steered wheel 3, which drive names for wheel 2; a device is on one shaft')])
def test_one_device_for_wheel_and_steering_is_refused(keys: dict[str, str], words: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=re.escape(words)):
        read_scene(scene_of(tmp_path, SWERVE, **keys))


@pytest.fixture(scope="module")
def motors() -> list[Any]:
    """Of one robot program: WPILib gives a port once."""
    import wpilib

    return [wpilib.PWMSparkMax(port) for port in (0, 1)]


@needs_robotpy
@pytest.mark.nightly
@pytest.mark.parametrize("key, device", [
    ("drive", "PWM[11]"), ("drive_encoder", "Encoder[22]"), ("drive_encoder", "AnalogInput[5]"),
    ("drive_encoder", "DutyCycleEncoder[20]"), ("drive_encoder", "AnalogEncoder[6]"), ("gyro", "ADXRS450[4]"),
    ("gyro", "AnalogGyro[1]"), ("gyro", "CANGyro:pigeon"), ("drive", "CANMotor:talon"),
    ("gyro", "SimDevice:navX/yaw")])
def test_a_device_that_the_program_lacks_is_refused_by_name(key: str, device: str, motors: list[Any],
                                                            tmp_path: Path) -> None:
    value = f'"{device}"' if key == "gyro" else f'["{device}", "{device}"]'
    others = {"drive": "[]", "drive_encoder": "[]"} | {key: value}
    path = scene_of(tmp_path, TANK, **{"gyro": '"ADXRS450[0]"', **others})
    path.write_text(re.sub(r'(?m)^gyro = "ADXRS450\[0\]"$', "", path.read_text(encoding="utf-8")), encoding="utf-8")

    class OfTest(Engine):
        scene = path
        devices = staticmethod(lambda robot: {} if key == "drive" else {"drive": motors})

    with pytest.raises(BadInput, match=rf"the robot program has no .*{re.escape(device.partition(':')[2] or device)}"):
        OfTest(None, motors)


class State:
    """What the objects of vendors' simulations have in common here: numbers that are set."""

    motor_voltage = 6.0

    def __init__(self, *names: str):
        self.set_to: dict[str, float] = {}
        for name in names:
            setattr(self, name, partial(self.set_to.__setitem__, name))


def of_vendor(*names: str) -> Any:
    return SimpleNamespace(sim_state=State(*names))


class SparkMax:
    """Stands for REV's."""

    def __init__(self) -> None:
        self.configAccessor = SimpleNamespace(encoder=SimpleNamespace(getVelocityConversionFactor=lambda: 1.0))
        self.turns = self.current_A = 0.0


class SparkMaxSim:
    """Stands for REV's: its encoder adds up speed over time."""

    def __init__(self, motor: SparkMax, gearbox: object):
        self._motor = motor

    def getAppliedOutput(self) -> float:
        return 0.25

    def iterate(self, rpm: float, bus_V: float, seconds: float) -> None:
        self._motor.turns += rpm / 60.0 * seconds

    def setMotorCurrent(self, current_A: float) -> None:
        self._motor.current_A = current_A


@needs_robotpy
@pytest.mark.nightly
def test_objects_of_vendors_drive_and_read_the_robot_as_the_page_gives_them(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from wpilib.simulation import DriverStationSim

    monkeypatch.setattr(SparkMax, "__module__", "rev")
    monkeypatch.setitem(sys.modules, "rev", SimpleNamespace(SparkFlex=int, SparkMaxSim=SparkMaxSim))
    path = scene_of(tmp_path, SWERVE)
    names: dict[str, Any] = {}
    text = "import laconic.frc\n" + of_page("python", "robot.pigeon")
    exec(compile(text, str(path.with_name("physics.py")), "exec"), names)
    robot = SimpleNamespace(pigeon=of_vendor("set_raw_yaw", "set_angular_velocity_z"), modules=[SimpleNamespace(
        talon=of_vendor("set_supply_voltage", "set_raw_rotor_position", "set_rotor_velocity"), spark=SparkMax(),
        cancoder=of_vendor("set_raw_position", "set_velocity")) for _ in range(4)])
    engine = names["PhysicsEngine"](None, robot)
    DriverStationSim.setEnabled(True)
    DriverStationSim.notifyNewData()
    for _ in range(25):
        engine.update_sim(0.0, 0.02)
    motion = engine.drivetrain.motion()
    assert math.hypot(motion.x_m, motion.y_m) > 0.1 and abs(motion.steering_angle_rad[0]) > 0.1
    for at, module in enumerate(robot.modules):
        drive, coder = module.talon.sim_state.set_to, module.cancoder.sim_state.set_to
        assert drive["set_raw_rotor_position"] == pytest.approx(6.75 * motion.wheel_angle_rad[at] / (2 * math.pi))
        assert drive["set_supply_voltage"] == pytest.approx(engine.drivetrain.battery_V)
        assert coder["set_raw_position"] == pytest.approx(motion.steering_angle_rad[at] / (2 * math.pi))
        assert module.spark.turns == pytest.approx(150 / 7 * motion.steering_angle_rad[at] / (2 * math.pi))
        assert module.spark.current_A == engine.drivetrain.battery.motor_current_A[4 + at]
    yaw = robot.pigeon.sim_state.set_to
    assert yaw["set_raw_yaw"] == pytest.approx(math.degrees(motion.heading_rad))


CPP = """
#include <frc/TimedRobot.h>
#include <frc/Timer.h>
#include <frc/motorcontrol/PWMSparkMax.h>
class Robot : public frc::TimedRobot {
public:
    void AutonomousInit() override { timer.Restart(); }
    void AutonomousPeriodic() override {
        const double ahead = timer.Get() < 1_s ? 0.5 : 0.0;
        left.Set(ahead);
        right.Set(-ahead);
    }
    frc::PWMSparkMax left{0}, right{1};
    frc::Timer timer;
};
int main() { return frc::StartRobot<Robot>(); }
"""


@needs_robotpy
@pytest.mark.nightly
@pytest.mark.skipif(not shutil.which("g++"), reason="needs g++")
def test_a_robot_program_in_cpp_is_driven_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import wpilib

    packages = Path(wpilib.__file__).parents[1]
    native, server = packages / "native", packages / "halsim_ws/server/lib"
    parts = ("ntcore", "wpihal", "wpilib", "wpimath", "wpinet", "wpiutil")
    (tmp_path / "robot.cpp").write_text(CPP, encoding="utf-8")
    subprocess.run(["g++", "-std=c++20", *(f"-I{native}/{each}/include" for each in parts), "robot.cpp", "-o", "robot",
                    *(f"-L{native}/{each}/lib" for each in parts), "-lwpilibc", "-lwpimath", "-lwpiHal", "-lntcore",
                    "-lwpinet", "-lwpiutil"], cwd=tmp_path, check=True)
    libraries = os.pathsep.join([*(f"{native}/{each}/lib" for each in parts), str(server)])
    path = scene_of(tmp_path, TANK)
    program = subprocess.Popen(["./robot"], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={
        **os.environ, "LD_LIBRARY_PATH": libraries, "HALSIM_EXTENSIONS": str(server / "libhalsim_ws_server.so")})
    try:
        assert run(["frc", str(path), "--enable", "auto", "--duration", "3", "--json"]) == 0
        final = json.loads(capsys.readouterr().out)["final"]
    finally:
        program.terminate()
        program.wait(20)
    assert final["x_m"] > 1.0


@pytest.mark.nightly
def test_the_cost_of_a_cycle_is_printed(tmp_path: Path) -> None:
    for name, robot in (("swerve", SWERVE), ("ideal swerve", ideal_swerve()), ("mecanum", MECANUM), ("tank", TANK)):
        drive, costs = Drivetrain(scene_of(tmp_path, robot)), []
        for cycle in range(150):
            begun = time.perf_counter()
            drive.run(0.02, [0.5] * drive.wheel_count, [0.2 * math.sin(0.1 * cycle)] * drive.steered_count)
            drive.motion()
            costs.append(time.perf_counter() - begun)
        print(f"{name}: {1e3 * float(np.median(costs)):.2f} ms a cycle of 20 ms")
        assert len(costs) == 150
