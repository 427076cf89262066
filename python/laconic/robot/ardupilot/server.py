"""The simulator's end of ArduPilot's JSON interface: servo packets in by UDP, one line of JSON out for each.

Lockstep: a packet with the next frame count moves the vehicle by 1/frame_rate. The same count again, which ArduPilot
sends when no answer came, is answered without a step. A count that goes back, or another sender, is an autopilot that
has restarted: the vehicle is put back to its start.
"""

from __future__ import annotations

import json
import math
import select
import socket
import struct
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from laconic.can.rig.errors import Interrupted, Interruption
from laconic.can.rig.verdict import Judgement, Verdict
from laconic.errors import BadInput, Refused, reason_of
from laconic.robot.ardupilot.vehicle import (
    Outputs,
    Robot,
    Seen,
    check_level,
    robot_of,
    specific_force,
    usual_or_given,
)
from laconic.scene import Scene

USUAL_PORT = 9002
ADDRESS = "127.0.0.1"
CHANNELS = {18458: 16, 29569: 32}   # pulses behind the magic number of a packet
HEADER = struct.Struct("<HHI")      # magic number, frame rate, frame count
LARGEST_PACKET = 2048
COUNTS = 2**32
MOST_LINES = 10                     # on restarts and silences
SILENT_S = 5.0                      # then a line says that the vehicle waits
WAIT_S = 0.1                        # between looks at signals
STEP_ROUNDING = 1e-9
UNTESTED = "protocol tested, autopilot not: this was never run with ArduPilot itself"
Peer = tuple[str, int]


@dataclass(frozen=True)
class Frame:
    """What a packet holds."""

    rate_Hz: int  # noqa: N815
    count: int
    pulses_us: tuple[int, ...]


class Dropped(Exception):
    """A packet that is dropped, with the reason in words that are the same for all of its kind."""

    def __init__(self, kind: str, text: str = ""):
        super().__init__(kind, text)
        self.kind, self.text = kind, text


def read_packet(data: bytes) -> Frame:
    """A servo packet; Dropped for anything else."""
    if len(data) < HEADER.size:
        raise Dropped("too short", f"a packet has {len(data)} bytes, too few for ArduPilot's servo packet")
    magic, rate, count = HEADER.unpack_from(data)
    if magic not in CHANNELS:
        raise Dropped("wrong magic number", f"a packet begins with {magic}, and ArduPilot's with 18458 or 29569; is "
                      "this the port of another program?")
    pulses = struct.Struct(f"<{CHANNELS[magic]}H")
    if len(data) != HEADER.size + pulses.size:
        raise Dropped("wrong length", f"a packet of {CHANNELS[magic]} outputs has {len(data)} bytes instead of "
                      f"{HEADER.size + pulses.size}")
    if rate == 0:
        raise Dropped("frame rate 0", "a packet has the frame rate 0, which is no step; set SIM_RATE_HZ")
    return Frame(rate, count, pulses.unpack_from(data, HEADER.size))


class Player:
    """The vehicle, frame by frame. `say` gets lines for people."""

    def __init__(self, scene: Scene, say: Callable[[str], None]):
        check_level(scene)
        self.scene, self.say, self.outputs = scene, say, Outputs(scene)
        self.said: Counter[str] = Counter()  # kinds of lines, of which the first is printed
        self.restarts = self.frames = self.repeated = self.steps = self.missed = 0
        self._last: tuple[Peer, int] | None = None
        self._restart(scene.run.step_s)

    def _restart(self, step_s: float) -> None:
        self.outputs.restart()
        self.robot: Robot = robot_of(self.scene.with_step(step_s), self.outputs.signals)
        self._step_s, self._base_s, self._rate, self._frames = step_s, 0.0, 0, 0
        self.seen: Seen = self.robot.look()
        self._force = specific_force(self.seen, self.seen, 1.0)

    @property
    def time_s(self) -> float:
        """Of the vehicle since its start."""
        return self._base_s + (self._frames / self._rate if self._rate else 0.0)

    def tell(self, kind: str, text: str, most: int = 1) -> None:
        """Prints the first lines of a kind, and counts all of them."""
        self.said[kind] += 1
        if self.said[kind] <= most:
            self.say(text)

    # ---- a frame

    def take(self, frame: Frame, peer: Peer) -> bool:
        """Moves the vehicle, unless the frame is one that was taken before: then False."""
        if self._last is not None:
            way = (frame.count - self._last[1]) % COUNTS
            if peer == self._last[0] and way == 0:
                self.repeated += 1
                return False
            if peer != self._last[0] or way >= COUNTS // 2:
                self.restarts += 1
                self._restart(self.scene.run.step_s)
                self.tell("restart", "the autopilot has restarted: the vehicle is back at its start",
                          MOST_LINES)
            elif way > 1:
                self.missed += way - 1
                self.tell("missed", f"{way - 1} frames are missing before frame {frame.count}; the vehicle takes one "
                          "step, as nothing is known of them")
        self._last = peer, frame.count
        self._move(frame)
        return True

    def _move(self, frame: Frame) -> None:
        parts = max(1, math.ceil(1.0 / (frame.rate_Hz * self.scene.run.step_s) - STEP_ROUNDING))
        step_s = 1.0 / (frame.rate_Hz * parts)
        if step_s != self._step_s:
            self._step_s = step_s
            self.robot.set_step(step_s)
        shares, cut = self.outputs.shares(frame.pulses_us)
        for number in cut:
            low, _, high = self.outputs.table.pwm_us
            self.tell(f"SERVO{number}", f"SERVO{number} has a pulse of {frame.pulses_us[number - 1]} µs, which is cut "
                      f"to {low:g} to {high:g} µs; ardupilot.pwm_us of the scene sets the range")
        self._step(self.outputs.values(shares), parts)
        self.frames += 1
        self.steps += parts
        if frame.rate_Hz != self._rate:
            self._base_s, self._rate, self._frames = self.time_s, frame.rate_Hz, 0
        self._frames += 1
        before, self.seen = self.seen, self.robot.look()
        self._force = specific_force(before, self.seen, 1.0 / frame.rate_Hz)

    def _step(self, values: np.ndarray, parts: int) -> None:
        if not self.outputs.has_controllers:
            self.robot.step(values, parts)
            return
        for _ in range(parts):
            self.robot.step(self.outputs.controlled(values, self.robot.speeds(), self._step_s), 1)

    # ---- an answer

    def answer(self) -> bytes:
        """The state as ArduPilot reads it: it searches for keys in the text, so that none is part of an earlier one."""
        seen, (ahead, right, down) = self.seen, self._force
        yaw_rate = seen.yaw_rate_rad_per_s
        if seen.imu is not None:
            ahead, right, yaw_rate = seen.imu[0], -seen.imu[1], seen.imu[2]
        state = {
            "timestamp": self.time_s, "imu": {"gyro": [0.0, 0.0, -yaw_rate], "accel_body": [ahead, right, down]},
            "position": [seen.place.real, -seen.place.imag, 0.0],
            "attitude": [0.0, 0.0, -seen.wrapped_rad],
            "velocity": [seen.velocity.real, -seen.velocity.imag, 0.0]}
        if seen.supply is not None:
            state["battery"] = {"voltage": seen.supply[0], "current": seen.supply[1]}
        return f"\n{json.dumps(state, separators=(',', ':'), allow_nan=False)}\n".encode()


class Server:
    """A UDP port of this machine behind which a vehicle moves."""

    def __init__(self, player: Player, port: int, silent_s: float = SILENT_S):
        self.player, self.silent_s = player, silent_s
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self.socket.bind((ADDRESS, port))
        except OSError as error:
            self.socket.close()
            raise BadInput(f"--listen {port}: cannot be opened ({reason_of(error)}); end the other simulator, or give "
                           "--listen another port, and ArduPilot --sim-port-out the same") from None
        except OverflowError:
            self.socket.close()
            raise BadInput(f"--listen {port}: is not a port; give 1 to 65535, or 0 for any free one") from None

    @property
    def port(self) -> int:
        """That autopilots send to."""
        return int(self.socket.getsockname()[1])

    def serve(self, until_s: float, may_go_on: Callable[[], None]) -> None:
        """Answers packets until the time comes; `may_go_on` raises what ends it. Refused ends it with the vehicle as
        before the refused step."""
        heard_s, is_silent = math.inf, False
        while (now_s := time.monotonic()) < until_s:
            may_go_on()
            if not select.select([self.socket], [], [], min(WAIT_S, until_s - now_s))[0]:
                if not is_silent and now_s - heard_s > self.silent_s:
                    is_silent = True
                    self.player.tell("silence", f"the autopilot has been silent for {self.silent_s:g} s: the vehicle "
                                     "waits for it", MOST_LINES)
                continue
            if self._one():
                heard_s, is_silent = now_s, False

    def _one(self) -> bool:
        """Takes a packet and answers it; whether it was a frame."""
        try:
            data, peer = self.socket.recvfrom(LARGEST_PACKET)
            frame = read_packet(data)
        except Dropped as dropped:
            self.player.tell(f"dropped, {dropped.kind}", f"{dropped.text}; it is dropped")
            return False
        except OSError:  # an answer that nobody was there to take, on some systems
            return False
        is_new = self.player.take(frame, peer)
        if is_new or not select.select([self.socket], [], [], 0.0)[0]:  # of a repeated frame a newer one has the answer
            try:
                self.socket.sendto(self.player.answer(), peer)
            except OSError as error:
                self.player.tell("not answered", f"an answer could not be sent ({reason_of(error)})")
        return True

    def close(self) -> None:
        """Frees the port."""
        self.socket.close()


def introduction(player: Player, port: int) -> list[str]:
    """The outputs, and how to start an autopilot."""
    low, middle, high = player.outputs.table.pwm_us
    lines = [f"outputs, {usual_or_given(player.scene)}; pulses {low:g}, {middle:g}, {high:g} µs for -1, 0, 1:"]
    by_number: dict[int, list[str]] = {}
    tables = Counter(channel.number for channel in player.scene.ardupilot.channels) if player.scene.ardupilot else {}
    for channel in player.outputs.channels:
        by_number.setdefault(channel.number, []).extend(f"{signal} = {channel.full:g}" for signal in channel.signals)
    for number, texts in sorted(by_number.items()):
        joined = f" ({tables[number]} tables have this number)" if tables.get(number, 0) > 1 else ""
        lines.append(f"  SERVO{number}: {', '.join(texts)} at 1{joined}")
    more = "" if port == USUAL_PORT else f" --sim-port-out {port}"
    return [*lines, f"listens on {ADDRESS}, UDP port {port}: sim_vehicle.py -v Rover --model JSON:{ADDRESS}"
            + (f" -A \"{more.strip()}\"" if more else ""), UNTESTED]


def play_ardupilot(scene: Scene, *, port: int = USUAL_PORT, duration_s: float | None = None,
                   say: Callable[[str], None] = lambda _: None, silent_s: float = SILENT_S) -> Judgement:
    """Plays the vehicle for an autopilot until it is stopped or the time is over."""
    if duration_s is not None and not 0.0 < duration_s < 1e9:
        raise BadInput(f"--duration {duration_s:g}: give seconds above 0 and below 1e9, or leave it out to play until "
                       "Ctrl-C")
    player = Player(scene, say)
    server, judgement = Server(player, port, silent_s), Judgement(scene.name, "ardupilot")
    began_s = time.monotonic()
    try:
        for line in introduction(player, server.port):
            say(line)
        with Interruption() as signals:
            server.serve(began_s + (math.inf if duration_s is None else duration_s), signals.check)
    except Interrupted:
        judgement.notes.append("stopped by the user")
    except Refused as refused:
        text = str(refused) if str(scene.path) in str(refused) else str(
            scene.refusal_in_file(refused, f"at t = {player.time_s:g} s"))
        judgement.add(Verdict("vehicle", False, text))
    finally:
        server.close()
    return judged(judgement, player, time.monotonic() - began_s)


def judged(judgement: Judgement, player: Player, seconds: float) -> Judgement:
    """Verdict, figures and notes of a run."""
    heard = f"{player.frames} frames taken, {player.repeated} answered again"
    judgement.add(Verdict("autopilot", bool(player.frames), heard if player.frames else
                          "no frame was ever taken; start the autopilot with the port of the line \"listens on\""))
    seen = player.seen
    judgement.figures |= {
        "seconds": seconds, "frames": player.frames, "repeated_frames": player.repeated, "restarts": player.restarts,
        "missed_frames": player.missed, "steps": player.steps, "end_time_s": player.time_s, "end_x_m": seen.place.real,
        "end_y_m": seen.place.imag, "end_heading_rad": seen.heading_rad}
    dropped: Sequence[tuple[str, int]] = sorted(player.said.items())
    judgement.notes += [f"{kind}: {count} times" for kind, count in dropped if count > 1]
    judgement.notes.append(UNTESTED)
    return judgement
