"""A node's life seen from the rig: identify, load a vehicle, choose frames, start, stop, reset."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.plant import Plant
from laconic.rig.errors import CannotReach, NodeRefused, NodeSilent
from laconic.rig.link import Link
from laconic.rig.wire import Frame, wire

Parameter = tuple[str, int, float | int]  # field (name in the value table), item, value
RESYNC = 3                                # frames that a receiver needs to accept a new counter


@dataclass(frozen=True)
class Identity:
    """Who answered."""

    version: str
    real: str
    max_wheels: int
    methods: int
    can_fd: bool
    protocol: int


class NodeClient:
    """Requests and their answers. Every other frame that comes meanwhile goes to `others`."""

    def __init__(self, link: Link, timeout_s: float = 1.0):
        self.link, self.timeout_s = link, timeout_s
        self.wire = wire()
        self.identity: Identity | None = None
        self.next_session = 1
        self.state = "empty"
        self.others: list[tuple[Frame, bytes]] = []
        self._request = 0

    # ---- requests

    def identify(self) -> Identity:
        """Finds the node; CannotReach when nobody answers."""
        for _ in range(RESYNC + 1):
            self._send_control("IDENTIFY")
            # RESULT has the lower identifier, so it comes first
            if self._wait_for("RESULT", self.timeout_s / 2) is None:
                continue
            if (found := self._wait_for("IDENTITY", self.timeout_s / 2)) is not None:
                self.identity = identity_of(found)
                return self.identity
        raise CannotReach(f"no node answers at ID base 0x{self.link.id_base:X}: check that it runs, its ID base, "
                          "the bit rate and the wiring")

    def control(self, command: str, *, session: int = 0, rate: int = 0, watchdog: int = 0) -> dict[str, int]:
        """One CONTROL and its RESULT; NodeRefused when it is a refusal."""
        self._send_control(command, session=session, rate=rate, watchdog=watchdog)
        return self.answer(command)

    def _send_control(self, command: str, **fields: int) -> None:
        self._request = (self._request + 1) & 15
        number = self.wire.number("CONTROL", "command", command)
        frame = self.wire["CONTROL"]
        self.link.send(frame, frame.pack(request=self._request, command=number, **fields))

    def answer(self, command: str) -> dict[str, int]:
        """The RESULT of the last request."""
        while True:
            result = self._wait_for("RESULT", self.timeout_s)
            if result is None:
                raise NodeSilent(f"the node does not answer {command.lower().replace('_', ' ')} "
                                 f"within {self.timeout_s:g} s")
            self.check(result)
            if result["request"] == self._request:
                return result

    def check(self, result: dict[str, int]) -> None:
        """Remembers state and session; raises the refusal."""
        self.next_session = result["session"]
        self.state = self.wire.choice("RESULT", "state", result["state"])
        if result["status"]:
            raise NodeRefused(self.wire.choice("RESULT", "command", result["command"]),
                              self.wire.choice("RESULT", "status", result["status"]),
                              self.wire.choice("RESULT", "field", result["field"]), result["item"], self.state)

    def _wait_for(self, name: str, timeout_s: float) -> dict[str, int] | None:
        deadline_us = self.link.deadline_us(timeout_s)
        while (received := self.link.receive_until(deadline_us)) is not None:
            frame, data = received
            if frame.name == name:
                values = frame.unpack(data)
                if name == "RESULT":
                    self.next_session = values["session"]
                    self.state = self.wire.choice("RESULT", "state", values["state"])
                return values
            self.others.append(received)
            del self.others[:-100]
        return None

    # ---- vehicle

    def load(self, plant: Plant, start: Any) -> None:
        """Sends a plant's vehicle, method and step, and a laconic_start; the node adopts them or refuses."""
        self.load_parameters(parameters_of(plant, start), plant.core.dtype)

    def load_parameters(self, parameters: Iterable[Parameter], dtype: np.dtype) -> None:
        """BEGIN, PARAMETER …, COMMIT."""
        self.control("BEGIN")
        frame, checksum, count = self.wire["PARAMETER"], 0, 0
        for upper, field, item, bits in parameter_words(parameters, dtype):
            data = frame.pack(upper_half=upper, field=field, item=item, value=bits)
            checksum = zlib.crc32(bytes([data[1] & 0xF0]) + bytes(data[2:]), checksum)
            self.link.send(frame, data)
            count += 1
        self._request = (self._request + 1) & 15
        commit = self.wire["COMMIT"]
        self.link.send(commit, commit.pack(request=self._request, frame_count=count, checksum=checksum))
        self.answer("COMMIT")

    # ---- running

    def select(self, **bits: int) -> None:
        """Chooses frames and raw numbers: the one-bit signals of SELECT by name; what is not named is off."""
        self._request = (self._request + 1) & 15
        frame = self.wire["SELECT"]
        self.link.send(frame, frame.pack(request=self._request, **bits))
        self.answer("SELECT")

    def start_lockstep(self) -> None:
        """From now on the node steps at every SYNC."""
        session = self.next_session
        self.control("START_LOCKSTEP", session=session)
        self.link.session = session

    def start_free_run(self, rate_Hz: int = 0, watchdog_ms: int = 100) -> None:
        """From now on the node steps by its own clock."""
        session = self.next_session
        self.control("START_FREE_RUN", session=session, rate=rate_Hz, watchdog=watchdog_ms)
        self.link.session = session

    def stop(self) -> None:
        """Stands still, voltages zero."""
        self.control("STOP")

    def reset(self) -> None:
        """Back to the start of the loaded vehicle."""
        self.control("RESET")


def identity_of(values: dict[str, int]) -> Identity:
    """IDENTITY in plain terms."""
    version = ".".join(str(values[f"version_{part}"]) for part in ("major", "minor", "patch"))
    real = {4: "single", 8: "double"}.get(values["scalar_bytes"], f"{values['scalar_bytes']} bytes")
    return Identity(version, real, values["max_wheels"], values["methods"], bool(values["can_fd"]), values["protocol"])


VEHICLE = {
    "mass_kg": "MASS", "yaw_inertia_kgm2": "YAW_INERTIA", "com_x_m": "COM_X", "com_y_m": "COM_Y", "com_z_m": "COM_Z",
    "wheel_radius_m": "WHEEL_RADIUS", "wheel_inertia_kgm2": "WHEEL_INERTIA", "motor_gain_Nm_per_V": "MOTOR_GAIN",
    "motor_damping_Nms": "MOTOR_DAMPING", "friction_coefficient": "FRICTION_COEFFICIENT"}
PAYLOAD = {"mass_kg": "PAYLOAD_MASS", "x_m": "PAYLOAD_X", "y_m": "PAYLOAD_Y", "yaw_inertia_kgm2": "PAYLOAD_YAW_INERTIA"}
WHEEL = {"x_m": "WHEEL_X", "y_m": "WHEEL_Y", "axle_rad": "AXLE", "roller_rad": "ROLLER"}


def parameters_of(plant: Plant, start: Any) -> Iterator[Parameter]:
    """Everything a node needs to play this plant, zeros left out."""
    vehicle, core = plant.c.vehicle, plant.core
    given = [(field, 0, getattr(vehicle, name)) for name, field in VEHICLE.items()]
    given += [(field, 0, getattr(vehicle.payload, name)) for name, field in PAYLOAD.items()]
    given += [("WHEEL_COUNT", 0, int(vehicle.wheel_count)), ("SUPPORT_COUNT", 0, int(vehicle.support_count))]
    for i in range(vehicle.wheel_count):
        wheel = vehicle.wheel[i]
        given += [(field, i + 1, getattr(wheel, name)) for name, field in WHEEL.items()]
        given += [("WHEEL_KIND", i + 1, int(wheel.kind)), ("WHEEL_LOCKED", i + 1, int(wheel.locked))]
    for i in range(vehicle.support_count):
        support = vehicle.support[i]
        given += [("SUPPORT_X", i + 1, support.x_m), ("SUPPORT_Y", i + 1, support.y_m)]
    given += [("START_NU", k + 1, start.nu_rad_per_s[k]) for k in range(3)]
    given += [("START_X", 0, start.x_m), ("START_Y", 0, start.y_m), ("START_HEADING", 0, start.heading_rad)]
    given += [("METHOD", 0, method_number(core, plant.c.integrator.method)), ("STEP", 0, plant.step_s)]
    return ((field, item, value) for field, item, value in given if value != 0 or field == "METHOD")


def method_number(core: Any, method: Any) -> int:
    """The number of a laconic_method."""
    return next(n for n in range(len(core.method_names)) if core.lib.laconic_method_by_number(n) == method)


def parameter_words(parameters: Iterable[Parameter], dtype: np.dtype) -> Iterator[tuple[int, int, int, int]]:
    """(upper half?, field, item, 32 bits) of every PARAMETER frame."""
    numbers = {text: number for number, text in wire()["PARAMETER"].fields["field"].choices.items()}
    for field, item, value in parameters:
        number = numbers[field]
        if isinstance(value, int):
            yield 0, number, item, value & 0xFFFFFFFF
            continue
        words = np.frombuffer(np.array(value, dtype).tobytes(), "<u4")
        for upper, bits in enumerate(words):
            yield upper, number, item, int(bits)
