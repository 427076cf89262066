"""The EDS file of a CANopen drive (CiA 306), made from the dictionary of the C code that answers its SDOs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from laconic.can.play.settings import drive_settings
from laconic.can.rig.node_library import node_library
from laconic.errors import BadInput
from laconic.scene import Scene

READ, WRITE, SENT, RECEIVED = 16, 32, 64, 128  # laconic_canopen_object.access
VARIABLE = 7                                   # object type of CiA 301
DUMMIES = range(1, 8)                          # data types that a received PDO can skip
MANDATORY = (0x1000, 0x1001, 0x1018)
BIT_RATES_kbit = (10, 20, 50, 125, 250, 500, 800, 1000)
PDO_COUNT = 4
RELATIVE_TO = (1, 2)  # node ids by which a value that contains one is recognised


@dataclass(frozen=True)
class EdsDrive:
    """The settings of a drive that its dictionary shows."""

    encoder_counts: int = 4096
    torque_constant_Nm_per_A: float = 0.05
    current_limit_A: float = 10.0
    supply_V: float = 0.0


@dataclass(frozen=True)
class EdsObject:
    """One sub-index of the dictionary."""

    index: int
    sub: int
    type: int
    access: int
    group: int              # 0: the index is a variable
    name: str
    group_name: str
    value: int | None       # after power-up; None: none, or it changes by itself
    limits: tuple[int, int] | None
    is_relative: bool       # the value contains the node id

    @property
    def access_text(self) -> str:
        """As CiA 306 has it; rww: written by PDOs, too."""
        if self.access & WRITE:
            return "rww" if self.access & RECEIVED else "rw"
        return "ro" if self.access & SENT or self.value is None else "const"


def eds_text(node_id: int | None = None, drive: EdsDrive | None = None) -> str:
    """The EDS of one drive; with a node id it names the node in a section that configurators read."""
    of_drive = drive or EdsDrive()
    described = list(dictionary(of_drive))
    lines = [*file_info(), *device_info()]
    if node_id is not None:
        lines += ["[DeviceComissioning]", f"NodeID=0x{node_id:02X}", f"NodeName=Wheel drive {node_id}",  # (sic)
                  "Baudrate=1000", ""]
    lines += ["[DummyUsage]", *(f"Dummy{each:04d}={int(each > 1)}" for each in DUMMIES), ""]
    indices = sorted({each.index for each in described})
    lines += object_list("MandatoryObjects", [each for each in indices if each in MANDATORY])
    lines += object_list("OptionalObjects", [each for each in indices if each not in MANDATORY])
    lines += object_list("ManufacturerObjects", [])
    for index in indices:
        lines += index_sections([each for each in described if each.index == index])
    return "\n".join(lines)


def eds_of_scene(scene: Scene, protocol: str | None = None) -> str:
    """The EDS of a scene's drives: of the first, where their encoders and currents differ."""
    settings = drive_settings(scene, protocol)
    if settings.protocol.name != "canopen":
        raise BadInput(f"--eds: describes CANopen drives, and those of {scene.path} speak {settings.protocol.name}; "
                       "give --drives canopen")
    numbers = settings.of_wheel(settings.driven.index(True))
    return eds_text(drive=EdsDrive(int(numbers["encoder_counts"]), numbers["torque_constant_Nm_per_A"],
                                   numbers["current_limit_A"], numbers["supply_V"]))


def dictionary(drive: EdsDrive) -> Iterator[EdsObject]:
    """All objects that an SDO reaches, in the order of the dictionary."""
    for one, other in zip(_described(RELATIVE_TO[0], drive), _described(RELATIVE_TO[1], drive), strict=True):
        if not one.access & (READ | WRITE):
            continue
        changes = bool(one.access & SENT) and not one.access & WRITE
        known = bool(one.has_value) and not changes
        relative = known and int(other.value) != int(one.value)
        yield EdsObject(
            index=one.index, sub=one.sub, type=one.type, access=one.access, group=one.group, name=name_of(one),
            group_name=_text(one.group_name) + number_text(one.index) if one.group else "",
            value=int(one.value) - RELATIVE_TO[0] * relative if known else None,
            limits=(int(one.low), int(one.high)) if one.has_limits else None, is_relative=relative)


def name_of(described: Any) -> str:
    """The name, with a number where one row of the dictionary stands for several sub-indices."""
    return _text(described.name) + (f" {described.sub}" if described.is_one_of_many else "")


def number_text(index: int) -> str:
    """PDOs are numbered from 1."""
    return f" {index % PDO_COUNT + 1}" if 0x1400 <= index < 0x1C00 else ""


def _described(node_id: int, drive: EdsDrive) -> Iterator[Any]:
    library = node_library()
    of = library.ffi.new("laconic_canopen_drive *", {
        "node_id": node_id, "encoder_counts": drive.encoder_counts, "supply_V": drive.supply_V,
        "torque_constant_Nm_per_A": drive.torque_constant_Nm_per_A, "current_limit_A": drive.current_limit_A})
    number = 0
    while True:
        found = library.ffi.new("laconic_canopen_object *")
        if not library.lib.laconic_canopen_describe(number, of, found):
            return
        yield found
        number += 1


def _text(name: Any) -> str:
    return str(node_library().ffi.string(name).decode("ascii"))


def file_info() -> Iterator[str]:
    """Without a date, so that the same drive gives the same file."""
    yield from ("[FileInfo]", "FileName=laconic_drive.eds", "FileVersion=1", "FileRevision=0", "EDSVersion=4.0",
                "Description=A simulated CiA 402 drive of one wheel", "CreatedBy=laconic", "CreationDate=01-01-2026",
                "CreationTime=12:00AM", "ModifiedBy=laconic", "ModificationDate=01-01-2026",
                "ModificationTime=12:00AM", "")


def device_info() -> Iterator[str]:
    """Any bit rate: a simulated drive speaks that of its bus."""
    yield from ("[DeviceInfo]", "VendorName=Laconic", "VendorNumber=0x00000000", "ProductName=Laconic drive",
                "ProductNumber=0x00000192", "RevisionNumber=0x00000001", "OrderCode=none")
    yield from (f"BaudRate_{rate}=1" for rate in BIT_RATES_kbit)
    yield from ("SimpleBootUpMaster=0", "SimpleBootUpSlave=1", "Granularity=8", "DynamicChannelsSupported=0",
                "GroupMessaging=0", f"NrOfRXPDO={PDO_COUNT}", f"NrOfTXPDO={PDO_COUNT}", "LSS_Supported=0", "")


def object_list(section: str, indices: list[int]) -> Iterator[str]:
    """A numbered list of indices."""
    yield f"[{section}]"
    yield f"SupportedObjects={len(indices)}"
    yield from (f"{number}=0x{index:04X}" for number, index in enumerate(indices, 1))
    yield ""


def index_sections(objects: list[EdsObject]) -> Iterator[str]:
    """The section of a variable, or those of an array or a record."""
    first = objects[0]
    if not first.group:
        yield from variable_section(f"{first.index:04X}", first)
        return
    yield from (f"[{first.index:04X}]", f"ParameterName={first.group_name}", f"ObjectType=0x{first.group:X}",
                f"SubNumber={len(objects)}", "")
    for each in objects:
        yield from variable_section(f"{each.index:04X}sub{each.sub:X}", each)


def variable_section(section: str, each: EdsObject) -> Iterator[str]:
    """Type, access, limits and the value after power-up of one sub-index."""
    yield from (f"[{section}]", f"ParameterName={each.name}", f"ObjectType=0x{VARIABLE:X}",
                f"DataType=0x{each.type:04X}", f"AccessType={each.access_text}")
    if each.limits is not None:
        yield from (f"LowLimit={each.limits[0]}", f"HighLimit={each.limits[1]}")
    if each.value is not None:
        yield f"DefaultValue={value_text(each)}"
    yield f"PDOMapping={int(bool(each.access & (SENT | RECEIVED)))}"
    yield ""


def value_text(each: EdsObject) -> str:
    """COB-IDs contain the node id by name."""
    return f"$NODEID+0x{each.value:X}" if each.is_relative else str(each.value)
