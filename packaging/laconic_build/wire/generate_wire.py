"""C table of the wire contract, from the DBC: offsets, lengths, protection, scales, value tables.

    python -m laconic_build.wire.generate_wire laconic.dbc OUTPUT_DIRECTORY

writes laconic_wire.h and laconic_wire.c, which add to cantools' packers what these lack: protection and saturation.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from cantools.database.can import Database, Message, Signal

from .contract import attribute, limits, load, protected

ID_BASE = 1664
ID_STRIDE = 32
NOTE = "/* Generated from laconic.dbc. */\n"
OPTIONAL = {"WHEEL_ANGLE": "SENSORS", "IMU": "SENSORS", "ENCODER": "SENSORS", "ERROR_ESTIMATE": "ESTIMATE",
            "STEERING": "HINGES", "VELOCITY": "HINGES", "HINGE_ANGLE": "HINGES", "HINGE_RATE": "HINGES"}
"""The last frames of the DBC, which images leave out that are built without LACONIC_NODE_WITH_…"""
PARTS = tuple(dict.fromkeys(OPTIONAL.values()))
DEFAULTS = {"SENSORS": "1 /* 0: neither sensors nor their frames, for small images */",
            "ESTIMATE": "0 /* 1: an error estimate and its frame; links the core's */",
            "HINGES": "0 /* 1: vehicles with hinges and their frames; links the core's articulated */",
            "XCP": "0 /* 1: a slave of XCP, whose frames have no row in the tables */"}
MADE_AT = re.compile(r"^( \* @brief .* by cantools version [\w.]+) .*\.$", re.MULTILINE)
KEYS = ("none", "nonce", "session", "run")  # what keys a frame's protection


def data_ids(message: Message) -> list[int]:
    """The DataID list (profile 22), or the DataID's two bytes, low byte first (profile 5)."""
    text = attribute(message, "E2EDataID")
    if message.is_fd:
        number = int(text, 16)
        return [number & 255, number >> 8]
    ids = [int(part, 16) for part in text.split()]
    if message.length != 8:
        raise SystemExit(f"laconic.dbc: {message.name}: a classic frame has 8 bytes, this one {message.length}")
    if len(ids) != 16:
        raise SystemExit(f"laconic.dbc: {message.name}: E2EDataID needs 16 bytes, has {len(ids)}")
    return ids


def constants(database: Database) -> list[str]:
    """Macros for offsets, value tables, scales and limits."""
    lines = [f"#define LACONIC_WIRE_VERSION {int(database.version or 0)}", f"#define LACONIC_WIRE_ID_BASE {ID_BASE}"]
    for message in database.messages:
        lines.append(f"#define LACONIC_WIRE_{message.name} {message.frame_id - ID_BASE}")
    check_identifiers(database)
    messages = protected(database)
    always = [message for message in messages if message.name not in OPTIONAL]
    rig, node = ([m.frame_id - ID_BASE for m in always if side in m.senders] for side in ("RIG", "NODE"))
    if max(rig) >= min(node):
        raise SystemExit("laconic.dbc: identifiers of the rig's frames must all lie below those of the node's")
    lines += [f"#define LACONIC_WIRE_RIG_OFFSETS {max(rig) + 1}", f"#define LACONIC_WIRE_NODE_FIRST {min(node)}"]
    if [m.name for m in messages[-len(OPTIONAL):]] != list(OPTIONAL):
        raise SystemExit(f"laconic.dbc: {', '.join(OPTIONAL)} must be the last frames")
    for part, default in DEFAULTS.items():
        lines += [f"#ifndef LACONIC_NODE_WITH_{part}", f"#define LACONIC_NODE_WITH_{part} {default}", "#endif"]
    last, classic = max(m.frame_id - ID_BASE for m in always), sum(not m.is_fd for m in always)
    lengths = ["#else", *counts(min(node), last, classic)]
    for part in PARTS:  # a part's frames are behind those of the parts before
        more = list(OPTIONAL.values()).count(part)
        last, classic = last + more, classic + more
        lengths = [f"#elif LACONIC_NODE_WITH_{part}", *counts(min(node), last, classic), *lengths]
    lines += [lengths[0].replace("#elif", "#if"), *lengths[1:], "#endif"]
    moving = [m.frame_id - ID_BASE for m in always if attribute(m, "E2EKey") == "run"]
    if sorted(moving) != list(range(min(moving), max(moving) + 1)):
        raise SystemExit("laconic.dbc: identifiers of the frames with E2EKey run must follow one another")
    lines += [f"#define LACONIC_WIRE_RUN_FIRST {min(moving)}", f"#define LACONIC_WIRE_RUN_OFFSETS {len(moving)}"]
    choices: dict[str, int] = {}
    for message in messages:
        for signal in message.signals:
            for number, text in (signal.choices or {}).items():
                if signal.name in ("command", "state") or (signal.name == "status" and number >= 64):
                    choices[f"LACONIC_WIRE_{signal.name}_{text}".upper()] = number
                if (message.name, signal.name) == ("PARAMETER", "field"):
                    choices[f"LACONIC_WIRE_FIELD_{text}"] = number
            lines += scale(message, signal)
    lines += [f"#define LACONIC_WIRE_KEY_{key.upper()} {number}" for number, key in enumerate(KEYS)]
    return lines + [f"#define {name} {number}" for name, number in choices.items()]


def check_identifiers(database: Database) -> None:
    """Ends with a message where two frames have one identifier, or one is not among those of a node."""
    offsets = [message.frame_id - ID_BASE for message in database.messages]
    for message, offset in zip(database.messages, offsets, strict=True):
        if offsets.count(offset) > 1 or not 0 <= offset < ID_STRIDE:
            raise SystemExit(f"laconic.dbc: {message.name}: identifier {message.frame_id} is used twice or is not one "
                             f"of the {ID_STRIDE} from {ID_BASE} on")


def counts(first: int, last: int, classic: int) -> list[str]:
    """Macros for the lengths of tables: the node's identifiers reach from `first` to `last`."""
    return [f"#define LACONIC_WIRE_NODE_OFFSETS {last + 1 - first}", f"#define LACONIC_WIRE_OFFSETS {last + 1}",
            f"#define LACONIC_WIRE_CLASSIC {classic}"]


def guarded(lines: list[str]) -> list[str]:
    """Lines of a table, of which the last ones are those that images may leave out."""
    found, numbers = lines[:-len(OPTIONAL)], list(OPTIONAL.values())
    for at, part in enumerate(PARTS):
        condition = " || ".join(f"LACONIC_NODE_WITH_{each}" for each in PARTS[at:])
        of_part = [line for line, each in zip(lines[-len(OPTIONAL):], numbers, strict=True) if each == part]
        found += [f"#if {condition}", *of_part, "#endif"]
    return found


def scale(message: Message, signal: Signal) -> list[str]:
    """Steps per unit and the largest raw value of a scaled signal."""
    if float(signal.scale) == 1.0:
        return []
    name = f"LACONIC_WIRE_{message.name}_{signal.name}".upper()
    largest = round(limits(signal)[1] / float(signal.scale))
    return [f"#define {name}_PER_UNIT {round(1 / float(signal.scale))}", f"#define {name}_LARGEST {largest}"]


def rows(database: Database) -> list[str]:
    """One initializer per identifier offset; unused offsets have length 0."""
    by_offset = {message.frame_id - ID_BASE: message for message in protected(database)}
    lists = [offset for offset, message in by_offset.items() if not message.is_fd]
    lines = []
    for offset in sorted(by_offset):
        message = by_offset[offset]
        key = KEYS.index(attribute(message, "E2EKey"))
        row = (message.length, int(message.is_fd), int("RIG" in message.senders), key,
               attribute(message, "E2EMaxDeltaCounter"), 0 if message.is_fd else lists.index(offset))
        lines.append(f"    [{offset}] = {{{', '.join(map(str, row))}}}, /* {message.name} */")
    return guarded(lines)


def tables(database: Database) -> list[str]:
    """DataID lists of the classic frames and DataIDs of the FD frames."""
    classic = [m for m in protected(database) if not m.is_fd]
    lists = []
    for message in classic:
        ids = ", ".join(f"0x{number:02X}" for number in data_ids(message))
        lists.append(f"    {{{ids}}}, /* {message.name} */")
    lines = ["const uint8_t laconic_wire_data_ids[LACONIC_WIRE_CLASSIC][16] = {", *guarded(lists)]
    lines += ["};", "", "uint16_t laconic_wire_data_id(uint8_t offset) {", "    switch (offset) {"]
    for message in protected(database):
        if message.is_fd:
            low, high = data_ids(message)
            lines.append(f"    case {message.frame_id - ID_BASE}: return 0x{high:02X}{low:02X}U;")
    return lines + ["    default: return 0;", "    }", "}"]


HEADER = """#ifndef LACONIC_WIRE_H
#define LACONIC_WIRE_H

#include <stdbool.h>
#include <stdint.h>

{constants}

typedef struct laconic_wire_row {{
    uint8_t length;    /* 0: no such frame */
    uint8_t fd;
    uint8_t from_rig;
    uint8_t key;       /* LACONIC_WIRE_KEY_…: what the protection depends on */
    uint8_t max_delta;
    uint8_t list;      /* classic: which DataID list */
}} laconic_wire_row;

extern const laconic_wire_row laconic_wire[LACONIC_WIRE_OFFSETS];
extern const uint8_t laconic_wire_data_ids[LACONIC_WIRE_CLASSIC][16]; /* profile 22 */
uint16_t laconic_wire_data_id(uint8_t offset);         /* profile 5  */

/* Whether the rig sends the frame with that offset: to a node with hinges also STEERING, among the node's. */
#define LACONIC_WIRE_FROM_RIG(offset) \\
    ((offset) < LACONIC_WIRE_RIG_OFFSETS || (LACONIC_NODE_WITH_HINGES && (offset) == LACONIC_WIRE_STEERING))

/* The lengths of these tables are in the name of an empty function, so that a node with others does not link. */
#if LACONIC_NODE_WITH_HINGES
#define LACONIC_WIRE_BUILT laconic_wire_built_with_LACONIC_NODE_WITH_HINGES_1
#elif LACONIC_NODE_WITH_ESTIMATE
#define LACONIC_WIRE_BUILT laconic_wire_built_with_LACONIC_NODE_WITH_ESTIMATE_1
#elif LACONIC_NODE_WITH_SENSORS
#define LACONIC_WIRE_BUILT laconic_wire_built_with_LACONIC_NODE_WITH_ESTIMATE_0_and_LACONIC_NODE_WITH_SENSORS_1
#else
#define LACONIC_WIRE_BUILT laconic_wire_built_with_LACONIC_NODE_WITH_ESTIMATE_0_and_LACONIC_NODE_WITH_SENSORS_0
#endif
void LACONIC_WIRE_BUILT(void);

#endif
"""


def without_time(out: Path) -> None:
    """Takes out of cantools' files when they were made: the same DBC is the same bytes, in the sources of FMUs, too."""
    for path in out.glob("laconic_dbc.[ch]"):
        text = path.read_text(encoding="utf-8")
        path.write_text(MADE_AT.sub(r"\1.", text, count=1), encoding="utf-8")


def main(dbc: str, directory: str) -> None:
    """Reads the DBC and writes the two files; those of cantools lie beside them."""
    database = load(Path(dbc))
    out = Path(directory)
    header = HEADER.format(constants="\n".join(constants(database)))
    out.joinpath("laconic_wire.h").write_text(NOTE + header, encoding="utf-8")
    body = ['#include "laconic_wire.h"', "", "const laconic_wire_row laconic_wire[LACONIC_WIRE_OFFSETS] = {"]
    body += [*rows(database), "};", "", *tables(database), "", "void LACONIC_WIRE_BUILT(void) {}", ""]
    out.joinpath("laconic_wire.c").write_text(NOTE + "\n".join(body), encoding="utf-8")
    without_time(out)


if __name__ == "__main__":
    main(*sys.argv[1:])
