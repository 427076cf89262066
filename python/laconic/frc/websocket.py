"""The robot behind WPILib's simulation WebSocket, for robot programs in Java, C++ or Python.

The program runs with WPILib's WebSocket server (halsim_ws_server). This is its client, the hardware: it hears outputs
as they change, moves the robot in real time in cycles of 20 ms, and sends encoders, gyro and battery. Names of messages
and data are those of WPILib's specification of that protocol.
"""

from __future__ import annotations

import asyncio
import json
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

from laconic.errors import BadInput, words_of
from laconic.frc.drivetrain import Drivetrain, Motion
from laconic.scene.base import Device

URL = "ws://127.0.0.1:3300/wpilibws"
PERIOD_S = 0.02
MODES = ("auto", "teleop", "test")
TURN = 2.0 * math.pi
NEVER_S = 1e30            # between two counts of an encoder that stands
FULL_SCALE_V = 5.0
SPELLED = ("SimDevice", "CANMotor", "CANEncoder", "CANDutyCycle", "CANGyro", "DutyCycle", "Gyro")
CONNECT_S = 0.25          # between two tries to connect
CLOSE_S = 1.0             # for a program that no longer listens
Message = tuple[str, str, dict[str, Any]]  # type, device, data
Place = tuple[str, str, str]               # type, device, name of a value without its direction


@dataclass
class Figures:
    """What a run leaves."""

    cycles: int = 0
    late_cycles: int = 0             # a period or more behind
    heard: int = 0
    unusable: int = 0                # of what was heard: no message of the protocol, or an output that is no number
    sent: int = 0
    ended_by: str = "user"           # or time, or program
    least_battery_V: float = math.inf  # noqa: N815
    cycle_s: list[float] = field(default_factory=list)


def place_of(device: Device) -> Place:
    """Where an output stands."""
    value = {"PWM": "speed", "CANMotor": "percentOutput"}.get(device.kind, device.value)
    return device.kind, device.name, value


class Bridge:
    """One robot of a scene and one robot program; `run` lasts until the program or the time ends."""

    def __init__(self, robot: Drivetrain, url: str = URL, mode: str | None = None,
                 say: Callable[[str], None] = lambda text: None):
        self.robot, self.url, self.mode, self._say = robot, checked(url), mode, say
        table, path = robot.table, robot.scene.path
        for name, devices in (("drive", table.drive), ("steering", table.steering)):
            if not devices and (name == "drive" or robot.steered_count):
                raise BadInput(f'{path}: frc.{name}: is missing; name the output of each motor, such as "PWM[0]"')
        if table.gyro and table.gyro.kind == "AnalogGyro":
            raise BadInput(f'{path}: frc.gyro: WPILib sends no AnalogGyro through its WebSocket; take "ADXRS450[0]" '
                           "or the SimDevice of your gyro, here and in the program")
        self._outputs: dict[Place, float] = {place_of(device): 0.0 for device in (*table.drive, *table.steering)}
        self._encoders: dict[int, str] = {}   # number of the message by channel A
        self._keys: dict[Place, str] = {}     # as the program spells those of SimDevices, with the direction
        self._is_on, self._seen = False, set[tuple[str, str]]()
        self.figures = Figures()
        self.watch: Callable[[float, Motion], None] = lambda time_s, motion: None

    # ---- what the program sends

    def hear(self, text: str | bytes) -> None:
        """Takes a message; what is not of the protocol changes nothing, as it demands, and is counted."""
        self.figures.heard += 1
        message = message_of(text)
        if message is None:
            self.figures.unusable += 1
            return
        kind, device, data = message
        for key, value in data.items():
            name = key.lstrip("<>")
            if kind in SPELLED:
                self._keys[kind, device, name.lower()] = key
            if (kind, device, name) in self._outputs:
                self._take((kind, device, name), value)
        if data.get("<init", kind in SPELLED):
            self._seen.add((kind, device))
        if kind == "Encoder" and (channel := number_of(data.get("<channel_a"))) is not None:
            self._encoders[int(channel)] = device
        if kind == "DriverStation" and isinstance(on := data.get(">enabled"), bool):
            self._is_on = on

    def _take(self, place: Place, value: object) -> None:
        """An output; one that is no number leaves what was there."""
        if (number := number_of(value)) is None:
            self.figures.unusable += 1
        else:
            self._outputs[place] = number

    def _of(self, devices: tuple[Device, ...]) -> list[float]:
        return [device.sign * self._outputs[place_of(device)] if self._is_on else 0.0 for device in devices]

    # ---- what it reads

    def messages(self, motion: Motion) -> list[Message]:
        """Encoders, gyro and battery of this moment."""
        table, found = self.robot.table, list[Message]()
        for devices, counts, angles, rates in (
                (table.drive_encoder, table.drive_counts, motion.wheel_angle_rad, motion.wheel_speed_rad_per_s),
                (table.steering_encoder, table.steering_counts, motion.steering_angle_rad,
                 motion.steering_rate_rad_per_s)):
            for device, angle, rate in zip(devices, angles, rates, strict=False):
                found += self._encoder(device, counts, device.sign * angle, device.sign * rate)
        if table.gyro:
            found.append(self._spelled(*gyro_values(table.gyro, motion)))
        battery = self.robot.battery
        found.append(("RoboRIO", "", {">vin_voltage": battery.voltage_V, ">vin_current": battery.current_A}))
        if self.mode:
            found.append(("DriverStation", "", {
                ">ds": True, ">enabled": True, ">autonomous": self.mode == "auto", ">test": self.mode == "test",
                ">new_data": True}))
        return found

    def _encoder(self, device: Device, counts: float, angle: float, rate: float) -> list[Message]:
        if device.kind == "Encoder":
            number = self._encoders.get(int(device.name))
            speed = rate * counts / TURN
            return [("Encoder", number, {">count": math.floor(angle * counts / TURN),
                                         ">period": 1.0 / speed if speed else NEVER_S})] if number is not None else []
        place, share = place_in_messages(device), (angle / TURN) % 1.0
        if device.kind == "AnalogInput":
            return [(*place, {">voltage": FULL_SCALE_V * share})]
        values = {"DutyCycleEncoder": {"Position": share}, "AnalogEncoder": {"Position": share},
                  "CANEncoder": {"position": angle / TURN, "velocity": rate / TURN},
                  "CANDutyCycle": {"position": share}, "SimDevice": {device.value: angle / TURN}}[device.kind]
        return [self._spelled(*place, values)]

    def _spelled(self, kind: str, device: str, values: Mapping[str, float]) -> Message:
        """Values with the directions that the program gave them, > where it did not send them yet."""
        return kind, device, {self._keys.get((kind, device, name.lower()), f">{name}"): value
                              for name, value in values.items()}

    # ---- the run

    async def run(self, duration_s: float = math.inf, connect_s: float = 10.0) -> None:
        """Connects and plays; BadInput where no program answers in time."""
        from websockets.exceptions import ConnectionClosed

        socket = await self._connect(connect_s)
        listener = asyncio.create_task(self._listen(socket))
        try:
            await self._play(socket, listener, duration_s)
        except ConnectionClosed:
            self._tell_end()
        finally:
            listener.cancel()
            await asyncio.gather(listener, return_exceptions=True)
            await socket.close()
        if missing := self._missing():
            self._say(f"heard nothing of {', '.join(missing)}; compare [frc] with the program's ports")
        if self.figures.unusable:
            self._say(f"{self.figures.unusable} of {self.figures.heard} messages were not of WPILib's protocol, or had "
                      "an output that is no number; they changed nothing")

    def _tell_end(self) -> None:
        self.figures.ended_by = "program"
        self._say(f"the robot program ended the connection after {self.figures.cycles * PERIOD_S:.2f} s; start it, "
                  "then this again")

    def _missing(self) -> list[str]:
        """Devices of [frc] that the program did not speak of."""
        table = self.robot.table
        found = [device.text.lstrip("-") for device in (
            *table.drive, *table.steering, *table.drive_encoder, *table.steering_encoder,
            *((table.gyro,) if table.gyro else ())) if not self._is_heard(device)]
        return list(dict.fromkeys(found))

    def _is_heard(self, device: Device) -> bool:
        if device.kind == "Encoder":
            return int(device.name) in self._encoders
        return place_in_messages(device) in self._seen

    async def _connect(self, connect_s: float) -> Any:
        from websockets.asyncio.client import connect
        from websockets.exceptions import InvalidHandshake, InvalidURI

        ends, reason = time.monotonic() + connect_s, "it does not answer"
        while True:
            try:
                return await connect(self.url, open_timeout=max(connect_s, 1.0), close_timeout=CLOSE_S, proxy=None)
            except (InvalidURI, ValueError):  # ValueError: a host that no name can be
                raise BadInput(f"--url {self.url}: is not the address of a WebSocket; give one such as {URL}") from None
            except InvalidHandshake:
                raise BadInput(f"--url {self.url}: what answers there refused the connection; WPILib's server has the "
                               "path /wpilibws, and takes one client") from None
            except (OSError, TimeoutError) as error:
                reason = words_of(error, reason)
            if time.monotonic() > ends:
                raise BadInput(f"--url {self.url}: no robot program answers there; start it in simulation with the "
                               "WebSocket server, such as robotpy sim --nogui --ws-server")
            await asyncio.sleep(CONNECT_S)

    async def _listen(self, socket: Any) -> None:
        async for text in socket:
            self.hear(text)

    async def _play(self, socket: Any, listener: asyncio.Task[None], duration_s: float) -> None:
        due = time.monotonic()
        while self.figures.cycles * PERIOD_S < duration_s - 1e-9 and not listener.done():
            cycle = time.perf_counter()
            self.robot.run(PERIOD_S, self._of(self.robot.table.drive), self._of(self.robot.table.steering))
            motion = self.robot.motion()
            messages = self.messages(motion)
            self.figures.cycle_s.append(time.perf_counter() - cycle)
            for kind, device, data in messages:
                await socket.send(json.dumps({"type": kind, "device": device, "data": data}))
            self.figures.sent += len(messages)
            self.figures.cycles += 1
            self.figures.least_battery_V = min(self.figures.least_battery_V, self.robot.battery_V)
            self.watch(self.figures.cycles * PERIOD_S, motion)
            due += PERIOD_S
            wait = due - time.monotonic()
            if wait < -PERIOD_S:
                self.figures.late_cycles += 1
                due = time.monotonic()
            await asyncio.sleep(max(wait, 0.0))
        if listener.done():
            self._tell_end()
        else:
            self.figures.ended_by = "time"


def message_of(text: str | bytes) -> tuple[str, str, dict[str, Any]] | None:
    """Type, device and data of a message; None for what is none."""
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(message, dict):
        return None
    kind, device, data = message.get("type"), message.get("device"), message.get("data")
    if isinstance(kind, str) and isinstance(device, str) and isinstance(data, dict):
        return kind, device, data
    return None


def number_of(value: object) -> float | None:
    """A finite number; None for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def place_in_messages(device: Device) -> tuple[str, str]:
    """Type and device of messages about it."""
    if device.kind in ("ADXRS450", "AnalogGyro"):
        return "Gyro", f"{device.kind}[{device.name}]"
    return {"AnalogInput": ("AI", device.name),
            "DutyCycleEncoder": ("DutyCycle", f"DutyCycleEncoder[{device.name}]"),
            "AnalogEncoder": ("SimDevice", f"AnalogEncoder[{device.name}]")}.get(
                device.kind, (device.kind, device.name))


def gyro_values(device: Device, motion: Motion) -> tuple[str, str, dict[str, float]]:
    """A gyro of one axis counts clockwise; one on CAN about z, counter-clockwise."""
    angle = device.sign * math.degrees(motion.heading_rad)
    rate = device.sign * math.degrees(motion.yaw_rate_rad_per_s)
    kind, name = place_in_messages(device)
    if device.kind == "CANGyro":
        return kind, name, {"angle_z": angle, "rate_z": rate}
    if device.kind == "SimDevice":
        return kind, name, {device.value: -angle}
    return kind, name, {"angle_x": -angle, "rate_x": -rate}


def checked(url: str) -> str:
    """The address, or BadInput for one that is not of a WebSocket."""
    try:
        parts = urlsplit(url)
        is_address = parts.scheme in ("ws", "wss") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        is_address = False
    if not is_address:
        raise BadInput(f"--url {url}: is not the address of a WebSocket; give one such as {URL}")
    return url


def figures_of(bridge: Bridge) -> Mapping[str, Any]:
    """The run in numbers."""
    motion, figures = bridge.robot.motion(), bridge.figures
    cycles = sorted(figures.cycle_s) or [0.0]
    return {"cycles": figures.cycles, "late_cycles": figures.late_cycles, "heard": figures.heard,
            "unusable": figures.unusable, "ended_by": figures.ended_by, "sent": figures.sent,
            "cycle_median_ms": 1e3 * cycles[len(cycles) // 2],
            "least_battery_V": figures.least_battery_V if figures.cycles else None,
            "events": dict(bridge.robot.events),
            "final": {"x_m": motion.x_m, "y_m": motion.y_m, "heading_rad": motion.heading_rad}}
