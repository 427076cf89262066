"""The A2L file of a node that speaks XCP: numbers of the vehicle, outputs and the interface, for calibration tools.

Names, numbers and kinds come from the core's list of fields, identifiers and outputs from laconic.dbc. Addresses are
virtual; laconic_node/node.h describes them.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass

from laconic.base.paths import SOURCE_DIR
from laconic.can.rig.client import is_estimated
from laconic.can.rig.wire import ID_BASE, wire
from laconic.core.fields import WHEEL, Field
from laconic.core.plant import PLACED_BY
from laconic.scene import Scene
from laconic.scene.reference import unit_of

PARAMETERS, OUTPUTS, EACH, SEGMENT = 0x10000, 0x20000, 128, 0x2000
WORDS = SOURCE_DIR / "modelDescription.xml"
ASCII = str.maketrans({"²": "^2", "·": "*", "√": "sqrt ", "Ω": "Ohm", "ν": "nu", "ξ": "xi", "η": "eta", "−": "-",
                       "–": "-", "…": "...", '"': "'", "\\": "/"})
LARGEST = 3.4e38  # of single precision
LIMITS = {"POSITIVE": (0.0, LARGEST), "NOT_NEGATIVE": (0.0, LARGEST), "SHARE": (0.0, 1.0), "INCLINE": (0.0, 1.5)}
INTEGERS = {"WHEEL_KIND": (1.0, 2.0), "FLAG": (0.0, 1.0), "ABSENCE": (0.0, 1.0), "INTEGER": (0.0, 2147483647.0)}
OF_STEPS = (("steps", "steps since the start", ""), ("state", "state of the node, as in HEARTBEAT", "state"))
PRESENT = {"wheel_undriven": "Whether the wheel has a motor; without one, its gain and damping are 0"}  # is driven
WORDS_OF = {"WHEEL_KIND": {1: "roller", 2: "fixed"}, "YES_NO": {0: "no", 1: "yes"},  # texts that tools show
            "MOTOR_CIRCUIT": {0: "controller", 1: "open", 2: "shorted"}}

# Signal of SELECT → frame and signals that have the same numbers; a stem that ends in _ is of each wheel or hinge.
OF_WHEELS = {"take_voltage": ("VOLTAGE", "voltage_", "Voltage"),
             "raw_wheel_speed": ("WHEEL_SPEED", "wheel_speed_", "Speed"),
             "raw_wheel_angle": ("WHEEL_ANGLE", "wheel_angle_", "Angle"),
             "raw_encoder": ("ENCODER", "count", "Count of the encoder")}
OF_HINGES = {"raw_hinge_angle": ("HINGE_ANGLE", "hinge_angle_", "Angle"),
             "raw_hinge_rate": ("HINGE_RATE", "hinge_rate_", "Rate")}
SINGLE = {"raw_nu": ("NU", ("nu_1", "nu_2", "nu_3")), "raw_pose": ("POSE", ("x", "y", "heading")),
          "raw_velocity": ("VELOCITY", ("ahead", "left", "yaw_rate"))}
IMU = ("acceleration_x", "acceleration_y", "yaw_rate")
ESTIMATES = tuple(f"{largest}{name}" for largest in ("", "largest_")
                  for name in ("nu", "place", "heading", "wheel_angle"))

COMMANDS = {
    "GET_COMM_MODE_INFO": 0xFB, "GET_ID": 0xFA, "SET_MTA": 0xF6, "UPLOAD": 0xF5, "SHORT_UPLOAD": 0xF4,
    "BUILD_CHECKSUM": 0xF3, "DOWNLOAD": 0xF0, "SET_CAL_PAGE": 0xEB, "GET_CAL_PAGE": 0xEA, "COPY_CAL_PAGE": 0xE4,
    "SET_DAQ_PTR": 0xE2, "WRITE_DAQ": 0xE1, "SET_DAQ_LIST_MODE": 0xE0, "START_STOP_DAQ_LIST": 0xDE,
    "START_STOP_SYNCH": 0xDD, "GET_DAQ_CLOCK": 0xDC, "GET_DAQ_PROCESSOR_INFO": 0xDA, "GET_DAQ_RESOLUTION_INFO": 0xD9,
    "GET_DAQ_EVENT_INFO": 0xD7, "FREE_DAQ": 0xD6, "ALLOC_DAQ": 0xD5, "ALLOC_ODT": 0xD4, "ALLOC_ODT_ENTRY": 0xD3}
LISTS, EVENTS = 8, (("step", 0), ("10 ms", 10_000_000), ("100 ms", 100_000_000))  # nanoseconds; 0: the scene's step

INTERFACE = """\
    /begin A2ML
      block "IF_DATA" taggedunion if_data {
        "XCP" struct {
          taggedstruct {
            block "PROTOCOL_LAYER" struct {
              uint; uint; uint; uint; uint; uint; uint; uint; uchar; uint;
              enum { "BYTE_ORDER_MSB_LAST" = 0, "BYTE_ORDER_MSB_FIRST" = 1 };
              enum { "ADDRESS_GRANULARITY_BYTE" = 1, "ADDRESS_GRANULARITY_WORD" = 2, "ADDRESS_GRANULARITY_DWORD" = 4 };
              taggedstruct { ("OPTIONAL_CMD" enum { %s })*; };
            };
            block "SEGMENT" struct {
              uchar; uchar; uchar; uchar; uchar;
              taggedstruct {
                block "CHECKSUM" struct {
                  enum { "XCP_CRC_32" = 9 };
                  taggedstruct { "MAX_BLOCK_SIZE" ulong; };
                };
                (block "PAGE" struct {
                  uchar;
                  enum { "ECU_ACCESS_DONT_CARE" = 3 };
                  enum { "XCP_READ_ACCESS_DONT_CARE" = 3 };
                  enum { "XCP_WRITE_ACCESS_NOT_ALLOWED" = 0, "XCP_WRITE_ACCESS_DONT_CARE" = 3 };
                  taggedstruct { "INIT_SEGMENT" uchar; };
                })*;
              };
            };
            block "DAQ" struct {
              enum { "STATIC" = 0, "DYNAMIC" = 1 };
              uint; uint; uchar;
              enum { "OPTIMISATION_TYPE_DEFAULT" = 0 };
              enum { "ADDRESS_EXTENSION_FREE" = 0 };
              enum { "IDENTIFICATION_FIELD_TYPE_ABSOLUTE" = 0 };
              enum { "GRANULARITY_ODT_ENTRY_SIZE_DAQ_BYTE" = 1 };
              uchar;
              enum { "NO_OVERLOAD_INDICATION" = 0, "OVERLOAD_INDICATION_PID" = 1, "OVERLOAD_INDICATION_EVENT" = 2 };
              taggedstruct {
                "PRESCALER_SUPPORTED";
                block "TIMESTAMP_SUPPORTED" struct {
                  uint;
                  enum { "SIZE_DWORD" = 4 };
                  enum { "UNIT_1US" = 3 };
                  taggedstruct { "TIMESTAMP_FIXED"; };
                };
                (block "EVENT" struct {
                  char[101]; char[9]; uint;
                  enum { "DAQ" = 1 };
                  uchar; uchar; uchar; uchar;
                })*;
              };
            };
            block "PAG" struct { uchar; taggedstruct { "FREEZE_SUPPORTED"; }; };
          };
          taggedstruct {
            block "XCP_ON_CAN" struct {
              uint;
              taggedstruct { "CAN_ID_MASTER" ulong; "CAN_ID_SLAVE" ulong; "BAUDRATE" ulong; };
            };
          };
        };
      };
    /end A2ML
"""


@dataclass(frozen=True)
class Number:
    """One number of the node's virtual memory."""

    name: str
    text: str
    unit: str
    address: int
    type: str = "FLOAT32_IEEE"
    low: float = -LARGEST
    high: float = LARGEST
    stays: bool = False  # the node does not let a master write it
    words: str = ""      # the table of its texts


def identification() -> str:
    """What GET_ID returns; the file's name in tools that look for one."""
    return f"laconic_{wire().database.version}"


def a2l_text(scene: Scene, id_base: int = ID_BASE) -> str:
    """The file for the vehicle of a scene."""
    numbers, measured = list(parameters(scene)), list(outputs(scene))
    units = sorted({each.unit.translate(ASCII) for each in (*numbers, *measured)})
    name = identification()
    lines = ["ASAP2_VERSION 1 61", f'/begin PROJECT laconic {quoted(scene.name)}', f"  /begin MODULE {name} \"\"",
             *interface(scene, id_base), '    /begin MOD_COMMON ""', "      BYTE_ORDER MSB_LAST", "    /end MOD_COMMON",
             *(line for unit in units for line in method(unit)), *layouts(),
             *(line for table, words in tables().items() for line in texts(table, words))]
    for each in numbers:
        lines += characteristic(each, scene.has_hinges or each.stays)
    for each in measured:
        lines += measurement(each)
    return "\n".join([*lines, "  /end MODULE", "/end PROJECT", ""])


# ------------------------------------------------------------------------------------------------------------ numbers


def parameters(scene: Scene) -> Iterator[Number]:
    """The numbers of the vehicle that a master may write, and its counts."""
    there, words = of_items(scene), descriptions()
    for field in scene.core().fields:
        if field.root != "vehicle" or field.table == "vehicle.motor" or EACH * field.number >= SEGMENT:
            continue
        for k in range(there.get(field.table, max(1, field.items))):
            name = f"{field.name}_{k + 1}" if field.items else field.name
            low, high = LIMITS.get(field.rule, (-LARGEST, LARGEST))
            kind = "FLOAT32_IEEE"
            if field.kind != "REAL":
                kind, (low, high) = "ULONG", INTEGERS[field.kind]
            table = table_of(field)
            if table:
                low, high = min(WORDS_OF[table]), max(WORDS_OF[table])
            name = name.replace("undriven", "driven")
            text = PRESENT.get(field.name) or words.get(field.name, field.name)
            yield Number(name, text, unit_of(field.name), PARAMETERS + EACH * field.number + 4 * k, kind, low, high,
                         field.counts or (field.table == WHEEL and field.key in PLACED_BY), table)


def table_of(field: Field) -> str:
    """The name of the table of a field's texts; empty where it is a plain number."""
    if field.kind in ("FLAG", "ABSENCE"):
        return "YES_NO"
    return next((each for each in (field.kind, field.identifier) if each in WORDS_OF), "")


def tables() -> dict[str, dict[int, str]]:
    """The texts of numbers that name a choice."""
    return {**WORDS_OF, "state": dict(wire()["HEARTBEAT"].fields["state"].choices)}


def of_items(scene: Scene) -> dict[str, int]:
    """Table of the vehicle → how many of it there are."""
    return {f"vehicle.{table}[#]": len(scene.vehicle[table]) for table in ("wheel", "support")}


def outputs(scene: Scene) -> Iterator[Number]:
    """What a master can measure, named as in laconic.dbc."""
    select = wire()["SELECT"].fields
    for k, (name, text, table) in enumerate(OF_STEPS):
        high = max(tables()[table]) if table else 4294967295.0
        yield Number(name, text, "", OUTPUTS + 4 * k, "ULONG", 0.0, high, words=table)
    for signal, names in named_outputs(scene).items():
        for k, (name, text, unit) in enumerate(names):
            yield Number(name, text, unit, OUTPUTS + EACH * select[signal].start + 4 * k)


def named_outputs(scene: Scene) -> dict[str, list[tuple[str, str, str]]]:
    """Signal of SELECT → names, texts and units of its numbers."""
    wheels = scene.wheel_count
    found = {signal: [of_frame(frame, each) for each in signals] for signal, (frame, signals) in SINGLE.items()}
    for signal, (frame, stem, what) in OF_WHEELS.items():
        found[signal] = [of_item(frame, stem, f"{what} of wheel", k) for k in range(wheels)]
    found["raw_energy"] = [("energy", "Kinetic energy", "J")]
    found["raw_axle_torque"] = [(f"axle_torque_{k + 1}", f"Torque on the axle of wheel {k + 1} besides the motor's",
                                 "N*m")
                                for k in range(wheels)]
    if scene.has_hinges:
        for signal, (frame, stem, what) in OF_HINGES.items():
            found[signal] = [of_item(frame, stem, f"{what} of hinge", k) for k in range(len(scene.hinges))]
        return {signal: names for signal, names in found.items() if signal not in ("raw_nu", "raw_encoder")}
    del found["raw_velocity"]
    origin = [(f"origin_acceleration_{axis}", "Acceleration of the body's origin", "m/s^2") for axis in ("x", "y")]
    found["raw_imu"] = origin + [(f"imu_{each}", *of_frame("IMU", each)[1:]) for each in IMU]
    if is_estimated(scene):  # without it the node refuses these
        found["send_error_estimate"] = [(f"error_{each}", *of_frame("ERROR_ESTIMATE", each)[1:]) for each in ESTIMATES]
    return found


def of_frame(frame: str, signal: str) -> tuple[str, str, str]:
    """Name, text and unit of a signal."""
    message = wire().database.get_message_by_name(frame)
    found = next(each for each in message.signals if each.name == signal)
    return signal, re.split(r"[.:,;]| \(", message.comment or frame)[0], found.unit or ""


def of_item(frame: str, stem: str, what: str, k: int) -> tuple[str, str, str]:
    """The same of wheel or hinge `k`, by the first signal that begins with the stem."""
    unit = of_frame(frame, stem + ("1" if stem.endswith("_") else ""))[2]
    return f"{'encoder_' if stem == 'count' else stem}{k + 1}", f"{what} {k + 1}", unit


def descriptions() -> dict[str, str]:
    """Variable → its words in modelDescription.xml."""
    variables = ET.parse(WORDS).getroot().find("ModelVariables")
    return {each.get("name", ""): each.get("description", "") for each in variables} if variables is not None else {}


# --------------------------------------------------------------------------------------------------------------- text


def quoted(text: str) -> str:
    """A string of A2L, in ASCII."""
    return '"' + text.translate(ASCII).encode("ascii", "replace").decode() + '"'


def compu_method(unit: str) -> str:
    """The name of the method that only adds a unit."""
    plain = unit.translate(ASCII)
    return "unit_" + ("".join(letter if letter.isalnum() else "_" for letter in plain) or "1")


def method(unit: str) -> Iterator[str]:
    """Numbers as they are, with their unit."""
    yield f'    /begin COMPU_METHOD {compu_method(unit)} "" IDENTICAL "%.7" {quoted(unit)} /end COMPU_METHOD'


def texts(table: str, words: dict[int, str]) -> Iterator[str]:
    """A number shown as one of several texts."""
    pairs = " ".join(f"{number} {quoted(text)}" for number, text in sorted(words.items()))
    yield f'    /begin COMPU_METHOD text_{table} "" TAB_VERB "%1.0" "" COMPU_TAB_REF texts_{table} /end COMPU_METHOD'
    yield f'    /begin COMPU_VTAB texts_{table} "" TAB_VERB {len(words)} {pairs} /end COMPU_VTAB'


def layouts() -> Iterator[str]:
    """The two types of numbers."""
    for name in ("FLOAT32_IEEE", "ULONG"):
        yield f"    /begin RECORD_LAYOUT of_{name} FNC_VALUES 1 {name} COLUMN_DIR DIRECT /end RECORD_LAYOUT"


def method_of(each: Number) -> str:
    """The name of a number's method."""
    return f"text_{each.words}" if each.words else compu_method(each.unit)


def characteristic(each: Number, fixed: bool) -> Iterator[str]:
    """A number that can be calibrated, or only read."""
    yield f"    /begin CHARACTERISTIC {each.name} {quoted(each.text)}"
    yield (f"      VALUE 0x{each.address:X} of_{each.type} 0 {method_of(each)} {each.low:.9g} {each.high:.9g}"
           + (" READ_ONLY" if fixed else ""))
    yield "    /end CHARACTERISTIC"


def measurement(each: Number) -> Iterator[str]:
    """A number that can be measured."""
    yield f"    /begin MEASUREMENT {each.name} {quoted(each.text)}"
    yield (f"      {each.type} {method_of(each)} 0 0 {each.low:.9g} {each.high:.9g} "
           f"ECU_ADDRESS 0x{each.address:X}")
    yield "    /end MEASUREMENT"


def interface(scene: Scene, id_base: int) -> Iterator[str]:
    """The calibration segment, and what a master must know of the slave."""
    codes = ", ".join(f'"{name}" = {code}' for name, code in COMMANDS.items())
    yield INTERFACE.rstrip("\n") % codes
    yield from ('    /begin MOD_PAR ""', '      /begin MEMORY_SEGMENT parameters "numbers of the vehicle"',
                f"        DATA RAM INTERN 0x{PARAMETERS:X} 0x{SEGMENT:X} -1 -1 -1 -1 -1",
                "        /begin IF_DATA XCP", "          /begin SEGMENT 0 2 0 0 0",
                f"            /begin CHECKSUM XCP_CRC_32 MAX_BLOCK_SIZE 0x{SEGMENT:X} /end CHECKSUM",
                "            /begin PAGE 0 ECU_ACCESS_DONT_CARE XCP_READ_ACCESS_DONT_CARE XCP_WRITE_ACCESS_DONT_CARE",
                "              INIT_SEGMENT 0 /end PAGE",
                "            /begin PAGE 1 ECU_ACCESS_DONT_CARE XCP_READ_ACCESS_DONT_CARE XCP_WRITE_ACCESS_NOT_ALLOWED",
                "              INIT_SEGMENT 0 /end PAGE", "          /end SEGMENT", "        /end IF_DATA",
                "      /end MEMORY_SEGMENT", "    /end MOD_PAR", "    /begin IF_DATA XCP",
                "      /begin PROTOCOL_LAYER",
                "        0x0101 1000 200 0 0 0 0 0 8 8 BYTE_ORDER_MSB_LAST ADDRESS_GRANULARITY_BYTE")
    yield from (f"        OPTIONAL_CMD {name}" for name in COMMANDS)
    yield from ("      /end PROTOCOL_LAYER", "      /begin DAQ",
                f"        DYNAMIC {LISTS} {len(EVENTS)} 0 OPTIMISATION_TYPE_DEFAULT ADDRESS_EXTENSION_FREE",
                "        IDENTIFICATION_FIELD_TYPE_ABSOLUTE GRANULARITY_ODT_ENTRY_SIZE_DAQ_BYTE 7",
                "        OVERLOAD_INDICATION_EVENT", "        PRESCALER_SUPPORTED",
                "        /begin TIMESTAMP_SUPPORTED 1 SIZE_DWORD UNIT_1US /end TIMESTAMP_SUPPORTED")
    for number, (name, period_ns) in enumerate(EVENTS):
        cycle, unit = cycle_of(period_ns or round(1e9 * scene.run.step_s))
        yield f'        /begin EVENT "{name}" "{name}" {number} DAQ {LISTS} {cycle} {unit} 0 /end EVENT'
    yield from ("      /end DAQ", "      /begin PAG 1 /end PAG", "      /begin XCP_ON_CAN 0x0101",
                f"        CAN_ID_MASTER 0x{id_base + wire().xcp['XCP_COMMAND'].offset:X}",
                f"        CAN_ID_SLAVE 0x{id_base + wire().xcp['XCP_RESPONSE'].offset:X}",
                "      /end XCP_ON_CAN", "    /end IF_DATA")


def cycle_of(nanoseconds: int) -> tuple[int, int]:
    """A number below 256 and its power of ten nanoseconds; (0, 0) where there is none such, as the node answers."""
    unit = 0
    while nanoseconds > 255 and nanoseconds % 10 == 0:
        nanoseconds, unit = nanoseconds // 10, unit + 1
    return (nanoseconds, unit) if nanoseconds <= 255 else (0, 0)
