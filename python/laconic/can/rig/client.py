"""A client of a node: opens a session, loads a vehicle, selects frames, starts, stops and resets.

What a node tells of its error at the end of a run: all pages of one ERROR_ESTIMATE.

Bringing a node to rest, however a run has ended, and finding one that runs.
"""

from __future__ import annotations

import secrets
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.can.rig.errors import BusDied, CannotReach, NodeRefused, NodeSilent
from laconic.can.rig.link import Link, Received
from laconic.can.rig.parameters import Parameter, parameter_words, parameters_of
from laconic.can.rig.wire import Frame, wire
from laconic.core.plant import Plant
from laconic.scene import Scene

REPEAT_S = 0.1  # wait for an answer before the same frame is sent again


@dataclass(frozen=True)
class Identity:
    """What IDENTITY states about a node."""

    version: str
    real: str
    max_wheels: int
    methods: int
    can_fd: bool
    protocol: int
    hinges: bool = False  # vehicles with hinges
    slip: bool = False    # also on ground with friction


class NodeClient:
    """Commands and their answers, one at a time: a command is sent again until it is answered, and the node acts on it
    once. Every other frame that comes meanwhile goes to `others`. `random_bits` chooses the session numbers: by
    default those of `secrets`, which nobody foretells."""

    def __init__(self, link: Link, timeout_s: float = 1.0, *, random_bits: Callable[[int], int] | None = None):
        self.link, self.timeout_s, self._random_bits = link, timeout_s, random_bits or secrets.randbits
        self.wire = wire()
        self.identity: Identity | None = None
        self.state = self.found = "empty"  # now; as the last session found it
        self.others: list[Received] = []
        self._greetings = 0
        self._heartbeat: dict[str, int] | None = None  # the last that came during a run

    # ---- handshake

    def open(self) -> Identity:
        """Waits for a sign of life, then opens a session: a node that runs stops, its vehicle stays. CannotReach when
        nobody answers."""
        self.link.session.is_open = False
        self.identity = None
        self.link.forget_counters()
        self._wait_for_life()
        deadline_us = self.link.deadline_us(self.timeout_s)
        while True:
            nonce = self._greet(deadline_us)
            number = self._random_bits(32)
            opened = self._wait_for("RESULT", self._open_message(number, nonce), deadline_us, tries=3,
                                    command=self.wire.number("RESULT", "command", "OPEN"), request=self._greetings & 15)
            if opened and self.identity:
                self.link.session.open(number, nonce)
                return self.identity
            if self.link.clock.now_us() >= deadline_us:
                raise self._unreachable("a node answers HELLO, but not OPEN,")

    identify = open

    def _wait_for_life(self) -> None:
        """Waits for a frame of the node: what is sent while a board starts is lost, perhaps also the command that
        opened the serial channel. HEARTBEAT gives the node's state."""
        deadline_us, alive = self.link.deadline_us(self.timeout_s), False
        while True:
            until_us = min(self.link.deadline_us(3 * REPEAT_S), deadline_us)
            while (received := self.link.receive_until(until_us)) is not None:
                alive = True
                if received[0].name == "HEARTBEAT":
                    self.found = self.wire.choice("HEARTBEAT", "state", received[0].unpack(received[1])["state"])
                    return
            if alive:
                return
            if self.link.clock.now_us() >= deadline_us:
                raise self._unreachable("no frame of a node comes")
            self.link.reopen_channel()

    def _greet(self, deadline_us: int) -> int:
        """Repeats HELLO until CHALLENGE comes; returns its nonce."""
        while True:
            self._greetings += 1
            data = self.wire["HELLO"].pack()
            self.link.library.protect_plain(self.wire["HELLO"].offset, data, self._greetings & 15)
            found = self._wait_for("CHALLENGE", self.link.message(self.wire["HELLO"], data), deadline_us, tries=1,
                                   request=self._greetings & 15)
            if found and self._is_identified(deadline_us):
                return found["nonce"]
            if self.link.clock.now_us() >= deadline_us:
                raise self._unreachable("no node answers")

    def _is_identified(self, deadline_us: int) -> bool:
        """Whether IDENTITY has come. It precedes CHALLENGE; where it was lost, the next one is awaited."""
        until_us = min(self.link.deadline_us(REPEAT_S), deadline_us)
        while self.identity is None and (received := self.link.receive_until(until_us)) is not None:
            self._take(received)
        return self.identity is not None

    def _open_message(self, number: int, nonce: int) -> Any:
        frame = self.wire["OPEN"]
        data = frame.pack(nonce_echo=nonce & 0xFFFF, session=number)
        self.link.library.protect_keyed(frame.offset, data, nonce, self._greetings & 15)
        return self.link.message(frame, data)

    def _unreachable(self, what: str) -> CannotReach:
        return CannotReach(f"{what} at ID base 0x{self.link.id_base:X} within {self.timeout_s:g} s: check that the "
                           "node runs, its ID base, the bit rate and the wiring")

    # ---- commands

    def control(self, command: str, *, rate: int = 0, watchdog: int = 0) -> dict[str, int]:
        """One CONTROL and its RESULT; NodeRefused when it is a refusal."""
        number = self.wire.number("CONTROL", "command", command)
        return self.command("CONTROL", number, command=number, rate=rate, watchdog=watchdog)

    def command(self, name: str, number: int | None = None, **fields: int) -> dict[str, int]:
        """One command and its RESULT, in a session that is opened where there is none; NodeRefused when it is a
        refusal. `number`: the number of the command in RESULT, where the frame's name does not give it."""
        if not self.link.session.is_open:
            self.open()
        frame = self.wire[name]
        data = frame.pack(**fields)
        count = self.link.session.protect(frame, data)
        result = self._wait_for("RESULT", self.link.message(frame, data), self.link.deadline_us(self.timeout_s),
                                command=self.wire.number("RESULT", "command", name) if number is None else number,
                                request=count & 15)
        if result is None:
            self.link.session.is_open = False  # the node may or may not have acted: the next command opens a session
            raise NodeSilent(f"the node does not answer {self._name_of(name, number)} within {self.timeout_s:g} s; "
                             f"faults seen: {dict(self.link.faults) or 'none'}")
        self.check(result)
        return result

    def _name_of(self, name: str, number: int | None) -> str:
        return name.lower() if number is None else self.wire.choice("CONTROL", "command", number)

    def check(self, result: dict[str, int]) -> None:
        """Remembers the state; raises the refusal, except that of numbers that an XCP master sent."""
        self.state = self.wire.choice("RESULT", "state", result["state"])
        if result["status"] and result["command"] != self.wire.number("RESULT", "command", "CALIBRATE"):
            raise NodeRefused(self.wire.choice("RESULT", "command", result["command"]),
                              self.wire.choice("RESULT", "status", result["status"]),
                              self.wire.choice("RESULT", "field", result["field"]), result["item"], self.state)

    def notice(self, frame: Frame, data: bytes) -> None:
        """A frame that came while a lockstep answer was due: raises a refusal, keeps the last HEARTBEAT."""
        if frame.name == "RESULT":
            self.check(frame.unpack(data))
        elif frame.name == "HEARTBEAT":
            self._heartbeat = frame.unpack(data)

    def likely_cause(self) -> str:
        """Why a lockstep answer may be missing, from the last HEARTBEAT and the link's faults. (HEARTBEAT may itself be
        late, so it does not shorten the wait.)"""
        heartbeat, faults = self._heartbeat, f"faults seen: {dict(self.link.faults) or 'none'}"
        if heartbeat is None:
            return f"no HEARTBEAT came either; {faults}"
        state = self.wire.choice("HEARTBEAT", "state", heartbeat["state"])
        if state != "lockstep":
            return f"the node is in state {state}" + (": it has restarted" if state == "empty" else "")
        deaf = "a frame on its way to the node was lost or spoilt, and it is deaf until STOP and START; "
        return (deaf if heartbeat["deaf"] else "") + faults

    def _wait_for(self, name: str, message: Any, deadline_us: int, tries: int = 0, **wanted: int
                  ) -> dict[str, int] | None:
        """Sends a message until an answer with the wanted values comes; None: not in time, or not after `tries`."""
        sent = 0
        while not (tries and sent == tries) and (sent == 0 or self.link.clock.now_us() < deadline_us):
            self.link.send_message(message)
            sent += 1
            until_us = min(self.link.deadline_us(REPEAT_S), deadline_us)
            while (received := self.link.receive_until(until_us)) is not None:
                values = self._take(received)
                if received[0].name == name and all(values[key] == value for key, value in wanted.items()):
                    return values
                self.others.append(received)
                del self.others[:-100]
        return None

    def _take(self, received: Received) -> dict[str, int]:
        frame, data = received
        values = frame.unpack(data)
        if frame.name == "RESULT":
            self.state = self.wire.choice("RESULT", "state", values["state"])
        elif frame.name == "IDENTITY":
            self.identity = identity_of(values)
        return values

    # ---- vehicle

    def load(self, plant: Plant, start: Any, more: Iterable[Parameter] = ()) -> None:
        """Sends a plant's vehicle, method and step, a laconic_start, and more where there is more; the node adopts them
        or refuses."""
        self.load_parameters((*parameters_of(plant, start), *more), plant.core.dtype)

    def load_parameters(self, parameters: Iterable[Parameter], dtype: np.dtype) -> None:
        """BEGIN, PARAMETER …, COMMIT."""
        self.control("BEGIN")
        frame, checksum, count = self.wire["PARAMETER"], 0, 0
        for upper, field, item, bits in parameter_words(parameters, dtype):
            values = {"upper_half": upper, "field": field, "item": item, "value": bits}
            data = frame.pack(**values)
            checksum = zlib.crc32(bytes([data[1] & 0xF0]) + bytes(data[2:]), checksum)
            self.command("PARAMETER", **values)
            count += 1
        self.command("COMMIT", frame_count=count, checksum=checksum)

    # ---- running

    def select(self, **bits: int) -> None:
        """Chooses frames and raw numbers: the one-bit signals of SELECT by name; what is not named is off."""
        self.command("SELECT", **bits)

    def counter(self, name: str) -> int:
        """A number of COUNTERS, which must be selected: its pages come in turn, one each 100 ms. 0 where it does not
        come in time."""
        deadline_us = self.link.deadline_us(self.timeout_s)
        while (received := self.link.receive_until(deadline_us)) is not None:
            values = self._take(received)
            if received[0].name == "COUNTERS" and name in values:
                return values[name]
        return 0

    def start_lockstep(self) -> None:
        """From now on the node steps at every SYNC."""
        self._heartbeat = None
        self.control("START_LOCKSTEP")
        self.link.session.begin_run()

    def start_free_run(self, rate_Hz: int = 0, watchdog_ms: int = 100) -> None:
        """From now on the node steps by its own clock."""
        self.control("START_FREE_RUN", rate=rate_Hz, watchdog=watchdog_ms)
        self.link.session.begin_run()

    def start_drives(self) -> None:
        """From now on the node steps by its own clock, for a controller that speaks the protocol of its drives."""
        self.control("START_DRIVES")

    def stop(self) -> None:
        """Stops the node and sets its voltages to zero; where STOP is not answered, by opening a new session."""
        try:
            if self.link.session.is_open:
                self.control("STOP")
                return
        except NodeSilent:
            pass
        try:
            self.open()
        except CannotReach as unreachable:
            raise NodeSilent(f"the node cannot be stopped: {unreachable}") from None

    def reset(self) -> None:
        """Back to the start of the loaded vehicle."""
        self.control("RESET")


def identity_of(values: dict[str, int]) -> Identity:
    """Identity from the raw values of IDENTITY."""
    version = ".".join(str(values[f"version_{part}"]) for part in ("major", "minor", "patch"))
    real = {4: "single", 8: "double"}.get(values["scalar_bytes"], f"{values['scalar_bytes']} bytes")
    return Identity(version, real, values["max_wheels"], values["methods"], bool(values["can_fd"]), values["protocol"],
                    bool(values["hinges"]), bool(values["slip"]))


FRAME = "ERROR_ESTIMATE"
UNITS = {"nu": "nu_rad_per_s", "place": "place_m", "heading": "heading_rad", "wheel_angle": "wheel_angle_rad"}
LARGEST = "largest_"
PAGES = 2 * len(UNITS)
ROUNDS = 5  # of its cycle, in which all pages of one instant must come


def is_estimated(scene: Scene) -> bool:
    """Whether the scene's [rig] frames ask for it."""
    return FRAME in scene.rig.frames


def read_estimate(node: NodeClient) -> dict[str, float]:
    """The figures by the names of `laconic simulate`, of an instant from now on; none where pages do not come in time.
    A node at rest goes on to send them."""
    frame, found = wire()[FRAME], dict[int, dict[str, float]]()
    deadline_us = node.link.deadline_us(ROUNDS * float(frame.attributes["GenMsgCycleTime"]) / 1e3)
    while len(found) < PAGES and (received := node.link.receive_until(deadline_us)) is not None:
        if received[0].name == FRAME:
            values = frame.physical(received[1])
            if values["page"] == 0:
                found.clear()
            if values["page"] == len(found):  # the next of the same instant
                found[len(found)] = values
    return figures_of(found) if len(found) == PAGES else {}


def figures_of(pages: dict[int, dict[str, float]]) -> dict[str, float]:
    """Of all pages."""
    values = {name: value for page in pages.values() for name, value in page.items()}
    named = {f"{which}estimated_error_{unit}": values[which + name] for which in ("", LARGEST)
             for name, unit in UNITS.items()}
    return named | {"estimate_unknown_windows": values["unknown"]}


ATTEMPTS = 4
PATIENCE_S = 0.25  # wait for one answer: a run that ends must not take long
RUNNING = ("lockstep", "free run", "timeout", "drives")


def come_to_rest(node: NodeClient) -> str | None:
    """Sends STOP until it is answered; returns None, or the last error where no answer came."""
    patience_s, node.timeout_s = node.timeout_s, min(node.timeout_s, PATIENCE_S)
    why = "no attempt was made"
    try:
        for _ in range(ATTEMPTS):
            try:
                node.stop()
                return None
            except (NodeSilent, NodeRefused) as error:  # a refusal may be the late answer to another frame
                why = str(error)
            except BusDied as error:
                return str(error)
    finally:
        node.timeout_s = patience_s
    return why


def stop_running(node: NodeClient) -> str:
    """Opens a session, which stops a node that runs; the state in which it was found. CannotReach when no
    node answers on the bus."""
    try:
        node.open()
    except (BusDied, NodeSilent, NodeRefused) as error:
        raise CannotReach(f"no node could be reached: {error}") from None
    return node.found


def stop_and_reset(node: NodeClient, with_reset: bool) -> dict[str, str]:
    """What --stop and --reset do: the states in which the node was found and left."""
    found = stop_running(node)
    if with_reset and node.state != "empty":  # without a vehicle there is no start to return to
        node.reset()
    return {"found": found, "state": node.state}
