"""The wire contract as a page to read, from the DBC, the text beside this file, and the reference client.

    python -m laconic_build.wire.document_wire          writes docs/wire.md
"""

from __future__ import annotations

import runpy
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

from cantools.database.can import Database, Message, Signal

from laconic.scene import METHODS

from .contract import attribute, choices, is_protected, limits, load
from .wire_parameters import PARAMETERS

HERE = Path(__file__).resolve().parent
FIRMWARE = HERE.parents[2] / "firmware_stub"
PAGE = HERE.parents[2] / "docs" / "wire.md"

if TYPE_CHECKING:
    import reference_client as reference
else:  # people copy this file, so it is not part of a package and cannot be imported from here
    reference = SimpleNamespace(**runpy.run_path(str(FIRMWARE / "reference_client.py")))

NONCE, SESSION, STARTS = 0x0123ABCD, 0xC0FFEE11, 9
PROTOCOLS = "1 canopen, 2 odrive, 3 robomaster (C620), 4 moteus, 5 robomaster-c610"
ENUMERATED = ("command", "state", "status", "field")  # have a chapter of their own
STATUSES = {
    "OK": "done", "NOT_FINITE": "a number is infinite or NaN", "NOT_POSITIVE": "must be above zero",
    "NEGATIVE": "must not be below zero", "ROLLER_ALONG_AXLE": "rollers along the axle transmit no force",
    "WHEEL_NOT_SET": "WHEEL_KIND is 0", "WHEEL_KIND_UNKNOWN": "no such kind",
    "TOO_MANY_WHEELS": "more than IDENTITY.max_wheels", "TOO_MANY_SUPPORTS": "more than this build takes",
    "NOTHING_MOVES": "fixed and locked wheels prevent every motion",
    "ILL_CONDITIONED": "too few correct digits would be left",
    "START_AGAINST_CONSTRAINTS": "the start makes a fixed or locked wheel slide",
    "METHOD_UNKNOWN": "the node does not contain it",
    "STEP_DOES_NOT_FIT": "the interval is no whole number of steps",
    "STEP_BEYOND_DAMPING_LIMIT": "the step is too long for an explicit method",
    "STEP_BEYOND_GYROSCOPIC_LIMIT": "the yaw rate is too high for that step and method",
    "STEP_GAINS_ENERGY": "the step would add energy that no input supplies",
    "STEP_SINGULAR": "the step has no finite result", "OVERFLOW": "a result leaves the range of numbers",
    "ABOVE_LIMIT": "a value is above its largest", "MOTOR_CIRCUIT_UNKNOWN": "MOTOR_CIRCUIT is none of 0, 1, 2",
    "FRICTION_TWICE": "FRICTION_COEFFICIENT besides the ground's",
    "FRICTION_MISSING": "drag or axle friction without a friction coefficient of the ground",
    "METHOD_WITHOUT_FRICTION": "with friction or a drive the method must be auto",
    "STEP_UNSOLVED": "the contact forces of the step were not found",
    "STRAIGHT_ONLY": "fixed wheels on parallel axle lines need friction of the ground",
    "ZERO": "a number that may be above or below 0 is 0",
    "TOO_MANY_BODIES": "more bodies on hinges than this build takes",
    "BODY_UNKNOWN": "no such body, or a parent after its body",
    "HINGE_NOT_SET": "a hinge's kind is 0",
    "HINGE_KIND_UNKNOWN": "no such kind of hinge",
    "COORDINATED_ON_BODY": "a coordinated hinge is not on the carriage",
    "COORDINATED_WHEEL": "a coordinated wheel does not roll along its body",
    "COORDINATED_TOO_FEW": "too few wheels hold the carriage to the twist",
    "MASSLESS_HINGE": "a hinge turns without inertia",
    "STEERED_TOO_OFTEN": "freely steered wheels hold the carriage",
    "FRICTION_WITH_HINGES": "this build has no friction on vehicles with hinges",
    "TWIST_ZERO": "the twist gives a wheel no direction",
    "TWIST_JUMPS": "the twist turns a wheel too far at once",
    "TWIST_AGAINST_WHEELS": "the twist makes fixed wheels slide",
    "WHEELS_DISAGREE": "wheels ask for different turning centres",
    "STEP_BEYOND_TRAIL_LIMIT": "wheels turn a body on a hinge too fast for the step",
    "BELOW_LIMIT": "below the smallest value", "COORDINATED_SLIPS": "coordinated hinges need ideal ground",
    "NO_EFFECT_ON_HINGE": "a number does nothing on a hinge of this kind",
    "UNKNOWN_COMMAND": "no such CONTROL.command", "WRONG_STATE": "not in this state",
    "CHECKSUM_MISMATCH": "COMMIT: frames were lost or another number was sent",
    "INPUT_INCOMPLETE": "raw inputs or half a double are missing", "PARAMETER_UNKNOWN": "no such field or item",
    "OUT_OF_RANGE": "value, rate or step_count", "NOT_SUPPORTED": "reserved field, or CAN FD on a classic node",
    "BUSY": "the last SYNC still runs", "PARAMETER_MISSING": "a required number has not come",
    "MEMORY_CHANGED": "the node's memory is not as it was left; `item` says where, section 3"}


def time_text(milliseconds: str) -> str:
    """"10 ms", or a dash for none."""
    return f"{milliseconds} ms" if milliseconds != "0" else "–"


def overview(message: Message) -> str:
    """One row of the list of frames."""
    key = attribute(message, "E2EKey")
    cells = (f"0x{message.frame_id:X}", f"[{message.name}](#{message.name.lower()})", message.senders[0].lower(),
             f"{message.length} FD" if message.is_fd else f"{'' if is_protected(message) else '1 to '}{message.length}",
             time_text(attribute(message, "GenMsgCycleTime")), time_text(attribute(message, "GenMsgTimeout")),
             *(("plain" if key == "none" else key, attribute(message, "E2EMaxDeltaCounter"))
               if is_protected(message) else ("no CRC", "–")))
    return "| " + " | ".join(cells) + " |"


def choices_text(signal: Signal) -> str:
    """"0 EMPTY, 1 READY …"."""
    return ", ".join(f"{number} {text}" for number, text in choices(signal).items())


def signal_row(signal: Signal) -> str:
    """One row of a frame's table."""
    sign = "IEEE" if signal.is_float else "signed" if signal.is_signed else "unsigned"
    page = f" (page {signal.multiplexer_ids[0]})" if signal.multiplexer_ids else ""
    least, largest = limits(signal)
    shown = "" if least == 0 and largest + 1 == 2.0**signal.length else f"{least:.10g} … {largest:.10g}"
    notes = (signal.comment or "").rstrip(".")
    if signal.choices and signal.name not in ENUMERATED:
        notes = choices_text(signal)
    return (f"| {signal.name}{page} | {signal.start} | {signal.length} {sign} | {float(signal.scale):g} "
            f"{signal.unit or ''} | {shown} | {notes} |")


def section(message: Message) -> str:
    """One frame."""
    rows = "\n".join(signal_row(signal) for signal in message.signals)
    return (f"\n### {message.name}\n\n{message.comment}\n\n| signal | first bit | bits | one step | range | notes |\n"
            f"| --- | --- | --- | --- | --- | --- |\n{rows}\n")


def parameter_rows(database: Database) -> str:
    """The numbers of a vehicle."""
    numbers = {text: number for number, text in field_choices(database).items()}
    rows = []
    for field, (key, unit, item, required) in sorted(PARAMETERS.items(), key=lambda each: numbers[each[0]]):
        rows.append(f"| {numbers[field]} | {field} | {unit} | {item} | {required or 'no'} | {key} |")
    return "\n".join(rows)


def field_choices(database: Database) -> dict[int, str]:
    """PARAMETER.field."""
    return choices(database.get_message_by_name("PARAMETER").get_signal_by_name("field"))


def spaced(data: bytes) -> str:
    """For reading."""
    return data.hex(" ").upper()


def example(client: reference.Client, name: str, count: int, key: int | None, title: str, **signals: object) -> str:
    """One frame in hex, with what leads to it."""
    frame = client.frame(name, count, key, **signals)
    text = f"* {title}: "
    if key is not None:
        chosen = reference.mix(reference.mix(key, frame.arbitration_id - reference.BASE), count)
        text += f"count {count}, hash 0x{chosen:08X}: "
    return text + f"`{spaced(frame.data)}`"


def examples(client: reference.Client) -> str:
    """One of each profile and key."""
    key = reference.mix(SESSION, NONCE)
    run = reference.mix(key, STARTS + 32)
    lines = [f"* stir(1) = 0x{reference.stir(1):08X}, mix(0, 0) = 0x{reference.mix(0, 0):08X}, mix(1, 2) = "
             f"0x{reference.mix(1, 2):08X}",
             f"* session key = mix(session, nonce) = 0x{key:08X}; run key = mix(session key, {STARTS} + 32) = "
             f"0x{run:08X}",
             example(client, "HELLO", 1, None, "HELLO, plain, counter 1"),
             example(client, "OPEN", 1, NONCE, "OPEN, keyed by the nonce", nonce_echo=NONCE & 0xFFFF, session=SESSION),
             example(client, "CONTROL", STARTS, key, "CONTROL START_LOCKSTEP, keyed by the session",
                     command="START_LOCKSTEP"),
             example(client, "VOLTAGE", 18, run, "VOLTAGE, group 0, 5.5 V and 10 V, sync, keyed by the run", sync=1,
                     voltage_1=5.5, voltage_2=10.0),
             example(client, "VOLTAGE_FD", 18, run, "VOLTAGE_FD, the same, profile 5", sync=1, voltage_1=5.5,
                     voltage_2=10.0),
             example(client, "NU", 7, None, "NU of a node, plain, counter 7, ν = (1, −1, 0.5) rad/s", nu_1=1.0,
                     nu_2=-1.0, nu_3=0.5)]
    return "\n".join(lines)


def page() -> str:
    """The whole text."""
    client = reference.Client(bus=None)
    database = load(FIRMWARE / "laconic.dbc")
    messages = sorted(database.messages, key=lambda message: message.frame_id)
    result, fields = database.get_message_by_name("RESULT"), field_choices(database)
    status = choices(result.get_signal_by_name("status"))
    parts = {
        "version": str(database.version), "frames": "\n".join(map(overview, messages)), "examples": examples(client),
        "data_ids": "\n".join(f"| {m.name} | `{attribute(m, 'E2EDataID')}` |" for m in messages
                                if is_protected(m)),
        "parameters": parameter_rows(database),
        "methods": ", ".join(f"{number} {name}" for number, name in enumerate(METHODS)),
        "protocols": PROTOCOLS,
        "states": choices_text(result.get_signal_by_name("state")),
        "control": choices_text(database.get_message_by_name("CONTROL").get_signal_by_name("command")),
        "results": choices_text(result.get_signal_by_name("command")),
        "statuses": "\n".join(f"| {number} | {text} | {STATUSES[text]} |"
                              for number, text in status.items()),
        "other_fields": ", ".join(f"{number} {text}" for number, text in fields.items()
                                  if number and text not in PARAMETERS),
        "details": "".join(map(section, messages))}
    text = (HERE / "wire_page.md").read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace("{{" + name + "}}", part)
    return text


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
