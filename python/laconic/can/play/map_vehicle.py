"""The vehicle at the end of a bus whose frames a DBC and a map describe."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator

import can
import numpy as np

from laconic.can.play.faults import DriveFault
from laconic.can.play.loop import Lateness
from laconic.can.play.map_file import REMOTE
from laconic.can.play.map_join import Joined, Key
from laconic.can.play.map_messages import Sender
from laconic.can.play.map_plant import MapPlant
from laconic.can.play.map_signals import reader_of
from laconic.can.play.protocols import BUS_OFF, ERROR_FRAMES, ORDERS, STALL
from laconic.can.play.settings import DriveSettings
from laconic.can.play.stopping import Pose
from laconic.can.rig.faults import error_frame
from laconic.errors import LaconicError, Refused, ResultFails
from laconic.scene import Scene

MOST_STEPS_AT_ONCE = 64  # then frames are read again


class MapVehicle:
    """Takes the controller's messages, steps the plant by the clock and sends the vehicle's messages."""

    def __init__(self, scene: Scene, settings: DriveSettings | None, joined: Joined):
        self.scene, self.joined = scene, joined
        self.plant = MapPlant(scene, settings, joined.inputs)
        self.lateness = Lateness()
        self.refused: Counter[str] = Counter()   # frames of the controller, by "MESSAGE: reason"
        self.timeouts: Counter[str] = Counter()  # by message
        self._ending: LaconicError | None = None
        self._faults: set[str] = set()  # of the vehicle as a station of the bus
        self._period_us = 1e6 * self.plant.plant.step_s
        self._start_us, self._periods = 0, 1
        self._heard_us: dict[Key, int] = {}
        self._silent: set[Key] = set()
        self._asked: list[Sender] = []
        self._due_s = [each.sent.first_s for each in joined.senders]
        self._readers: dict[str, Callable[[MapPlant], float]] = {}

    def begin(self, now_us: int) -> None:
        """The first period ends one step from now."""
        self._start_us = now_us

    # ---- in

    def on_message(self, message: can.Message, now_us: int) -> None:
        """A frame of the bus."""
        if BUS_OFF in self._faults:
            return
        key = (message.arbitration_id, message.is_extended_id)
        for sender in self.joined.requests.get(key, ()):
            if message.is_remote_frame == (sender.sent.on_request == REMOTE):
                self._asked.append(sender)
        receiver = self.joined.receivers.get(key)
        if receiver is None or message.is_remote_frame:
            return
        name = receiver.message.c.name
        if message.is_fd != receiver.message.c.is_fd:
            self.refused[f"{name}: {'CAN FD' if message.is_fd else 'classic CAN'}"] += 1
            return
        values, reason = receiver.take(bytes(message.data))
        if reason is not None:
            self.refused[f"{name}: {reason}"] += 1
            return
        self._heard_us[key] = now_us
        self._silent.discard(key)
        self.plant.set(values)

    def _watch(self, now_us: int) -> None:
        """What the vehicle does when a message has not come for too long; its first one starts the watch."""
        for key, heard_us in self._heard_us.items():
            receiver = self.joined.receivers[key]
            timeout_s, what = receiver.received.timeout_s, receiver.received.at_timeout
            if timeout_s is None or key in self._silent or now_us - heard_us <= 1e6 * timeout_s:
                continue
            self._silent.add(key)
            self.timeouts[receiver.message.c.name] += what != "hold"
            if what == "end":
                self._ending = ResultFails(f"{receiver.message.c.name} has not come for {timeout_s:g} s")
            elif what != "hold":
                self.plant.clear((joint.model for joint in receiver.given.joints), off=what == "off")

    # ---- out

    def idle_us(self, now_us: int) -> int:
        """Microseconds to the next step; none while an answer waits."""
        return 0 if self._asked else max(0, self._next_us() - now_us)

    def _next_us(self) -> int:
        return self._start_us + round(self._periods * self._period_us)

    def is_private(self, message: can.Message) -> bool:
        """Never."""
        return False

    def ending(self) -> LaconicError | None:
        """A watchdog that ends the run, or a step that the core refused."""
        return self._ending

    def has_sent(self, message: can.Message) -> bool:
        """Never: what comes from the bus is the controller's."""
        return False

    def advance(self, now_us: int) -> Iterator[can.Message]:
        """What comes of the frames of the steps that are due, past the faults of the vehicle's station."""
        for message in self._frames(now_us):
            if not self._faults:
                yield message
            elif self._faults == {ERROR_FRAMES}:
                yield from (error_frame(), message)

    def _frames(self, now_us: int) -> Iterator[can.Message]:
        """Steps that are due with the cyclic messages at the end of each, then answers."""
        for _ in range(MOST_STEPS_AT_ONCE):
            late_us = now_us - self._next_us()
            if late_us < 0 or self._ending is not None:
                break
            self._watch(now_us)
            self.lateness.begins(late_us, self._period_us)
            self._periods += 1
            if self._step():
                yield from self._cyclic()
        asked, self._asked = self._asked, []
        for sender in asked:
            yield from self._messages(sender)

    def _step(self) -> bool:
        try:
            self.plant.step()
        except Refused as refused:
            when = f"at t = {self.plant.plant.steps * self.plant.plant.step_s:g} s"
            self._ending = ResultFails(str(self.scene.refusal_in_file(refused, when)))
        return self._ending is None

    def _cyclic(self) -> Iterator[can.Message]:
        time_s, half = self.plant.plant.steps * self.plant.plant.step_s, 0.5 * self.plant.plant.step_s
        for number, sender in enumerate(self.joined.senders):
            if sender.sent.period_s is not None and time_s + half > self._due_s[number]:
                self._due_s[number] += sender.sent.period_s
                yield from self._messages(sender)

    def _messages(self, sender: Sender) -> Iterator[can.Message]:
        message = sender.message.c
        for payload in sender.payloads(self.read):
            yield can.Message(arbitration_id=message.frame_id, is_extended_id=message.is_extended_frame, data=payload,
                              is_fd=message.is_fd, bitrate_switch=message.is_fd)

    def read(self, name: str) -> float:
        """An output of the model now."""
        if name not in self._readers:
            self._readers[name] = reader_of(name)
        return self._readers[name](self.plant)

    tells_motion = True

    def pose(self) -> Pose:
        """Now."""
        now = self.plant.pose()
        return float(now.x_m), float(now.y_m), float(now.heading_rad)

    def speed(self) -> tuple[float, float]:
        """Of the centre of mass and in yaw."""
        velocity, yaw_rate = self.plant.plant.body_velocity()
        return float(np.hypot(*velocity)), abs(float(yaw_rate))

    def signals(self) -> dict[str, float]:
        """Pose, velocities and wheels, by the names of a run's signals."""
        plant, now = self.plant, self.plant.pose()
        (ahead, left), yaw_rate = plant.plant.body_velocity()
        wheels = {f"{name}[{number}]": float(value) for name, values in (
            ("wheel_angle_rad", plant.wheel_angles()), ("wheel_speed_rad_per_s", plant.wheel_speeds()))
            for number, value in enumerate(values, start=1)}
        return {"x_m": float(now.x_m), "y_m": float(now.y_m), "heading_rad": float(now.heading_rad),
                "velocity_body_m_per_s[1]": float(ahead), "velocity_body_m_per_s[2]": float(left),
                "yaw_rate_rad_per_s": float(yaw_rate), **wheels}

    def break_drive(self, fault: DriveFault, *, is_broken: bool) -> None:
        """A fault of a drive, or of the station, begins, or ends."""
        if fault.wheel == 0:
            (self._faults.add if is_broken else self._faults.discard)(fault.kind)
        elif self.plant.drives is not None:
            drive = self.plant.drives.drives[fault.wheel - 1]
            if fault.kind == STALL:
                drive.hold(is_held=is_broken)
            else:
                drive.break_down(ORDERS[fault.kind], is_broken=is_broken)

    def watchdogs(self) -> list[str]:
        """Messages that did not come in time."""
        return [f"{name} did not come in time" + (f", {count} times" if count > 1 else "")
                for name, count in self.timeouts.items()]

    def notes(self) -> list[str]:
        """What happened to frames that were not as they should be."""
        found = [f"{count} frames refused, {what}" for what, count in self.refused.items()]
        found += [f"{each.cut.count} values of {each.message.c.name} were cut to their signal's range"
                  for each in self.joined.senders if each.cut.count]
        return found
