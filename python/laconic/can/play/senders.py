"""Which drive has sent a frame, where frames of controller and drives come over one bus: what each protocol says."""

from __future__ import annotations

from collections.abc import Callable

import can

from laconic.can.play.settings import DriveSettings

ODRIVE_SAYS = (0x00, 0x01, 0x03, 0x06, 0x09, 0x14, 0x15, 0x17, 0x1C, 0x1D)  # its messages; the others are commands
SDO, TPDOS, FIRST_TPDO_OBJECT = 0x600, (0x180, 0x280, 0x380, 0x480), 0x1800
EMCY, SDO_ANSWER, HEARTBEAT = 0x080, 0x580, 0x700


class Senders:
    """Frames of one bus in their order; `node_of` tells the node id of the drive that sent one, None: nobody's."""

    def __init__(self, settings: DriveSettings):
        self._ids = {each for each, has_drive in zip(settings.node_ids, settings.driven, strict=True) if has_drive}
        name = settings.protocol.name
        self._pdos = {base + each: (each, number) for each in self._ids for number, base in enumerate(TPDOS)}
        rules: dict[str, Callable[[can.Message], int | None]] = {
            "canopen": self._canopen, "odrive": self._odrive, "moteus": self._moteus}
        self._rule = rules.get(name, self._robomaster)

    def node_of(self, message: can.Message) -> int | None:
        """The drive that sent it."""
        return None if message.is_error_frame else self._rule(message)

    def _known(self, node_id: int) -> int | None:
        return node_id if node_id in self._ids else None

    def _canopen(self, message: can.Message) -> int | None:
        """The predefined connection set; a TPDO that the controller has moved is followed."""
        if message.is_extended_id or message.is_remote_frame:
            return None
        self._follow_moved(message)
        if message.arbitration_id in self._pdos:
            return self._pdos[message.arbitration_id][0]
        node_id, base = message.arbitration_id & 0x7F, message.arbitration_id & ~0x7F
        return self._known(node_id) if base in (EMCY, SDO_ANSWER, HEARTBEAT) else None

    def _follow_moved(self, message: can.Message) -> None:
        """An expedited download of 0x1800:01 to 0x1803:01."""
        node_id, data = message.arbitration_id - SDO, bytes(message.data)
        if node_id not in self._ids or len(data) != 8 or data[0] & 0xE3 != 0x23 or data[3] != 1:
            return
        number = int.from_bytes(data[1:3], "little") - FIRST_TPDO_OBJECT
        if 0 <= number < len(TPDOS):
            self._pdos = {key: value for key, value in self._pdos.items() if value != (node_id, number)}
            self._pdos[int.from_bytes(data[4:8], "little") & 0x7FF] = (node_id, number)

    def _odrive(self, message: can.Message) -> int | None:
        """A drive's identifier can be changed, so any that says what an ODrive says is one."""
        is_said = not message.is_remote_frame and message.arbitration_id & 0x1F in ODRIVE_SAYS
        return message.arbitration_id >> 5 if is_said and not message.is_extended_id else None

    def _robomaster(self, message: can.Message) -> int | None:
        return None if message.is_extended_id else self._known(message.arbitration_id - 0x200)

    def _moteus(self, message: can.Message) -> int | None:
        """Identifiers hold the source."""
        return self._known(message.arbitration_id >> 8 & 0x7F)
