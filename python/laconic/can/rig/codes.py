"""The rig's side of `firmware_stub/secure`: behind each frame that commands goes a code that needs the key."""

from __future__ import annotations

import re
from pathlib import Path

import can

from laconic.can.rig.frames import FrameBox
from laconic.can.rig.node_library import node_library
from laconic.errors import BadInput, ResultFails, reason_of

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
