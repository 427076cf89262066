"""The wire contract as a page to read, from the DBC.

document_wire.py laconic.dbc OUTPUT.md
"""

from __future__ import annotations

import sys
from pathlib import Path

import cantools.database
from cantools.database.can import Database, Message, Signal

HEAD = """# The wire contract

Made from `firmware_stub/laconic.dbc`; edit that. Identifiers are those of a node at ID base 0x680; other
nodes use the same offsets from their own base, a multiple of 32.

Classic frames are protected by AUTOSAR E2E profile 22 (bytes 0 and half of 1), CAN FD frames by profile 5 (bytes 0 to
2). All numbers are little-endian. A value out of range saturates and sets its frame's `overrange`.

| identifier | frame | from | bytes | cycle | timeout | DataID |
| --- | --- | --- | --- | --- | --- | --- |
"""


def attribute(message: Message, database: Database, name: str) -> str:
    """The message's attribute, or the default."""
    found = message.dbc.attributes.get(name)
    return str(found.value if found else database.dbc.attribute_definitions[name].default_value)


def time_text(milliseconds: str) -> str:
    """"10 ms", or a dash for none."""
    return f"{milliseconds} ms" if milliseconds != "0" else "–"


def overview(message: Message, database: Database) -> str:
    """One row of the list of frames."""
    kind = f"{message.length} FD" if message.is_fd else str(message.length)
    cells = (f"0x{message.frame_id:X}", f"[{message.name}](#{message.name.lower()})", message.senders[0].lower(), kind,
             time_text(attribute(message, database, "GenMsgCycleTime")),
             time_text(attribute(message, database, "GenMsgTimeout")),
             f"`{attribute(message, database, 'E2EDataID')}`")
    return "| " + " | ".join(cells) + " |\n"


def signal_row(signal: Signal) -> str:
    """One row of a frame's table."""
    sign = "signed" if signal.is_signed else "unsigned"
    page = f" (page {signal.multiplexer_ids[0]})" if signal.multiplexer_ids else ""
    scaled = float(signal.scale) != 1.0
    limits = f"{float(signal.minimum):g} … {float(signal.maximum):g}" if scaled else ""
    choices = ", ".join(f"{number} {text}" for number, text in sorted((signal.choices or {}).items()))
    notes = ". ".join(text.rstrip(".") for text in (signal.comment or "", choices) if text)
    return (f"| {signal.name}{page} | {signal.start} | {signal.length} {sign} | {float(signal.scale):g} "
            f"{signal.unit or ''} | {limits} | {notes} |\n")


def section(message: Message) -> str:
    """One frame."""
    head = f"\n## {message.name}\n\n{message.comment}\n\n"
    head += "| signal | first bit | bits | one step | range | notes |\n| --- | --- | --- | --- | --- | --- |\n"
    return head + "".join(signal_row(signal) for signal in message.signals)


def main(dbc: str, output: str) -> None:
    """Reads the DBC and writes the page."""
    database = cantools.database.load_file(dbc)
    messages = sorted(database.messages, key=lambda message: message.frame_id)
    text = HEAD + "".join(overview(message, database) for message in messages)
    text += "".join(section(message) for message in messages)
    Path(output).parent.mkdir(parents=True, exist_ok=True)
    Path(output).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
