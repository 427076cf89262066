"""The key and the count that protect a frame of the rig: kept by the sender, or reconstructed from a log.

The rig's side of `firmware_stub/secure`: behind each frame that commands goes a code that needs the key.
"""

from __future__ import annotations

import re
from collections import Counter
from enum import Enum
from pathlib import Path

import can

from laconic.can.rig.node_library import NodeLibrary, node_library
from laconic.can.rig.wire import Frame, FrameBox, wire
from laconic.errors import BadInput, ResultFails, reason_of

RUN_FRAMES = tuple(frame.offset for frame in wire().frames.values() if frame.key == "run")


class Session:
    """The rig's end: keys, and how many frames of each kind have been sent since OPEN or START."""

    def __init__(self, library: NodeLibrary):
        self.library = library
        self.is_open = False
        self.key = self.run_key = 0
        self.counts: Counter[int] = Counter()

    def open(self, number: int, nonce: int) -> None:
        """After an OPEN that was answered."""
        self.is_open = True
        self.key = self.library.lib.laconic_mix(number, nonce)
        self.run_key = self.library.lib.laconic_run_key(self.key, 0)
        self.counts.clear()

    def begin_run(self) -> None:
        """After a START that was answered: it is the last CONTROL."""
        self.run_key = self.library.lib.laconic_run_key(self.key, self.counts[wire()["CONTROL"].offset])
        for offset in RUN_FRAMES:
            self.counts[offset] = 0

    def protect(self, frame: Frame, data: bytearray) -> int:
        """Writes counter and CRC of the next frame of its kind; returns its count."""
        self.counts[frame.offset] = count = self.counts[frame.offset] + 1
        key = self.run_key if frame.key == "run" else self.key
        self.library.protect_keyed(frame.offset, data, key, count)
        return count


class Effect(Enum):
    """The effect of a frame of the rig on the node."""

    WRONG = "wrong"  # CRC, key or count
    NONE = "none"    # right, but repeated, or a motion frame that only serves the receiver as reference
    ACTS = "acts"


class Follower:
    """A listener: derives the keys from the frames on the bus and finds the effect of each frame of the rig."""

    def __init__(self, library: NodeLibrary):
        self.library, self.session = library, Session(library)
        self.missing: Counter[str] = Counter()  # frames of the rig by name, from gaps in its counts
        self._nonces: list[int] = []
        self._armed: set[int] = set()

    def challenge(self, data: bytes) -> None:
        """A CHALLENGE of the node; a rig may still answer the one before it."""
        self._nonces = [*self._nonces[-1:], wire()["CHALLENGE"].unpack(data)["nonce"]]

    def effect_of(self, frame: Frame, data: bytearray) -> Effect:
        """The effect of one frame of the rig, which the listener takes note of."""
        if frame.key == "none":
            return Effect.ACTS if self.library.plain_is_right(frame.offset, data) else Effect.WRONG
        if frame.key == "nonce":
            return self._open(frame, data)
        return self._moves(frame, data) if frame.key == "run" else self._commands(frame, data)

    def _open(self, frame: Frame, data: bytearray) -> Effect:
        for nonce in self._nonces:
            if self.library.keyed_is_right(frame.offset, data, nonce, frame.counter_of(data)):
                number = frame.unpack(data)["session"]
                repeated = self.session.is_open and self.session.key == self.library.lib.laconic_mix(number, nonce)
                if not repeated:
                    self.session.open(number, nonce)
                return Effect.NONE if repeated else Effect.ACTS
        return Effect.WRONG

    def _ahead(self, frame: Frame, data: bytearray, key: int) -> int:
        """Counts since the last frame of its kind, which this frame becomes; -1: the frame is wrong."""
        session, last = self.session, self.session.counts[frame.offset]
        ahead = (frame.counter_of(data) - last) & (255 if frame.fd else 15)
        if not session.is_open or not self.library.keyed_is_right(frame.offset, data, key, last + ahead):
            return -1
        session.counts[frame.offset] = last + ahead
        self.missing[frame.name] += max(0, ahead - 1)
        return ahead

    def _commands(self, frame: Frame, data: bytearray) -> Effect:
        ahead = self._ahead(frame, data, self.session.key)
        if ahead < 1:
            return Effect.WRONG if ahead < 0 else Effect.NONE
        if frame.name == "CONTROL" and wire().choice("CONTROL", "command", data[2]).startswith("start"):
            self.session.begin_run()
            self._armed.clear()
        return Effect.ACTS

    def _moves(self, frame: Frame, data: bytearray) -> Effect:
        ahead = self._ahead(frame, data, self.session.run_key)
        if ahead < 0:
            self._armed.discard(frame.offset)
            return Effect.WRONG
        acts = ahead == 1 and frame.offset in self._armed
        self._armed.add(frame.offset)
        return Effect.ACTS if acts else Effect.NONE


KEY_DIGITS = 32


def read_key(path: Path) -> bytes:
    """The key of AES-128 in a file of 32 hexadecimal digits."""
    try:
        text = path.read_text(encoding="ascii").strip()
    except OSError as error:
        raise BadInput(f"--key {path}: cannot be read ({reason_of(error)}); name a file with {KEY_DIGITS} hexadecimal "
                       "digits") from None
    except ValueError:
        raise BadInput(f"--key {path}: holds no key; give {KEY_DIGITS} hexadecimal digits") from None
    if not re.fullmatch(rf"[0-9a-fA-F]{{{KEY_DIGITS}}}", text):
        raise BadInput(f"--key {path}: holds no key; give {KEY_DIGITS} hexadecimal digits")
    return bytes.fromhex(text)


class Codes:
    """Makes the codes, with a freshness that a CHALLENGE of the node begins."""

    def __init__(self, key: bytes, id_base: int):
        library = node_library("double")
        self._lib, ffi = library.lib, library.ffi
        self._gate = ffi.new("laconic_gate *")
        self._frame, self._code = FrameBox(ffi), FrameBox(ffi)
        self._lib.laconic_gate_init(self._gate, id_base, key)

    def heard(self, message: can.Message) -> None:
        """A frame from the bus."""
        self._lib.laconic_gate_sent(self._gate, self._frame.put(message))

    def behind(self, message: can.Message) -> can.Message | None:
        """The frame that must follow one of the rig; None where none must. Refuses where no code is left."""
        frame = self._frame.put(message)
        if self._lib.laconic_gate_is_spent(self._gate, frame):
            raise ResultFails("the codes of this session are used up after 4294967295 frames; connect again")
        made = self._lib.laconic_gate_seal(self._gate, frame, self._code.c)
        return self._code.message() if made else None
