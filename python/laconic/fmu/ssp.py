"""A vehicle and its wheel-speed controller as one system: two FMUs connected in an SSP 1.0 archive.

Names are identifiers, which SSP does not require but OMSimulator does; only the FMUs' own variables keep their names.
The FMUs are of FMI 2, the only version of SSP 1.0.
"""

from __future__ import annotations

import re
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laconic.base.outputs import whole_file
from laconic.base.paths import SOURCE_DIR, built
from laconic.errors import BadInput
from laconic.fmu import DESCRIPTION, content_of, hinges, make_fmu
from laconic.scene import Scene
from laconic_fmu.archive import Variant, pack, scene_fmu
from laconic_fmu.description import Description, read

CONTROLLER = SOURCE_DIR / "fmu" / "controller" / "modelDescription.xml"
SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
POSE = ("x_m", "y_m", "heading_rad")


@dataclass(frozen=True)
class Wire:
    """A connection of a variable between two elements; "" is the system itself."""

    variable: str
    start: str
    end: str
    per_wheel: bool = True

    def wheels(self, count: int) -> Iterable[int]:
        """Their numbers from 1; 0 for what is not per wheel."""
        return range(1, count + 1) if self.per_wheel else (0,)


WIRES = (Wire("setpoint_rad_per_s", "", "controller"), Wire("voltage_V", "controller", "vehicle"),
         Wire("wheel_speed_rad_per_s", "vehicle", "controller"), Wire("wheel_speed_rad_per_s", "vehicle", ""),
         *(Wire(name, "vehicle", "", per_wheel=False) for name in POSE))


def make_controller(scene: Scene, out: Path, *, version: int, scalar: bool = False, sources: bool = True,
                    enumerations: bool = True) -> Path:
    """The controller's FMU with as many loops as the scene has wheels."""
    text = read(CONTROLLER).root.get("description", "")
    content = content_of(scene, f"Wheel-speed controller for {scene.name}", text, {"wheel_count": [scene.wheel_count]})
    scene_fmu(built(f"fmu/LaconicController_fmi{version}.fmu"), CONTROLLER, content, out,
              Variant(version, scalar, enumerations, sources), None)
    return out


def identifier(text: str) -> str:
    """Letters, digits and underscores; the first no digit."""
    plain = re.sub(r"\W", "_", text, flags=re.ASCII)
    return plain if re.match(r"[A-Za-z]", plain) else f"scene_{plain}"


def connector_name(variable: str, wheel: int, element: str) -> str:
    """An FMU's connectors are its variables; the system's own have identifiers."""
    if not wheel:
        return variable
    return f"{variable}[{wheel}]" if element else f"{variable}_{wheel}"


def _ends(wires: Iterable[Wire], element: str, wheels: int) -> Iterator[tuple[str, str, str]]:
    """Connectors of an element: name, kind, variable. Inside the system its input connector is a source."""
    seen = set()
    for wire in wires:
        starts, ends = (wire.start, "output" if wire.start else "input"), (wire.end, "input" if wire.end else "output")
        for owner, kind in (starts, ends):
            for wheel in wire.wheels(wheels):
                name = connector_name(wire.variable, wheel, element)
                if owner == element and name not in seen:
                    seen.add(name)
                    yield name, kind, wire.variable


def _connectors(parent: ET.Element, element: str, wheels: int, units: dict[str, str]) -> None:
    group = ET.SubElement(parent, f"{{{SSD}}}Connectors")
    for name, kind, variable in _ends(WIRES, element, wheels):
        connector = ET.SubElement(group, f"{{{SSD}}}Connector", {"name": name, "kind": kind})
        ET.SubElement(connector, f"{{{SSC}}}Real", {"unit": units[variable]})


def _connections(parent: ET.Element, wheels: int) -> None:
    group = ET.SubElement(parent, f"{{{SSD}}}Connections")
    for wire, wheel in [(each, wheel) for each in WIRES for wheel in each.wheels(wheels)]:
        ends = {"startConnector": connector_name(wire.variable, wheel, wire.start),
                "endConnector": connector_name(wire.variable, wheel, wire.end)}
        ends |= {"startElement": wire.start} if wire.start else {}
        ends |= {"endElement": wire.end} if wire.end else {}
        ET.SubElement(group, f"{{{SSD}}}Connection", ends)


def _units_of(descriptions: Iterable[Description]) -> tuple[dict[str, str], dict[str, ET.Element]]:
    """Of each variable its unit, and of each unit its exponents."""
    by_variable: dict[str, str] = {}
    exponents: dict[str, ET.Element] = {}
    for description in descriptions:
        types = {kind.get("name"): kind.get("unit", "") for kind in description.root.iter("Float64Type")}
        by_variable |= {v.name: types.get(v.attributes.get("declaredType"), "") for v in description.variables}
        exponents |= {unit.get("name", ""): unit for unit in description.root.iter("Unit")}
    return by_variable, exponents


def _units(parent: ET.Element, used: Iterable[str], exponents: dict[str, ET.Element]) -> None:
    group = ET.SubElement(parent, f"{{{SSD}}}Units")
    for name in sorted(set(used)):
        unit = ET.SubElement(group, f"{{{SSC}}}Unit", {"name": name})
        base = exponents[name].find("BaseUnit")
        ET.SubElement(unit, f"{{{SSC}}}BaseUnit", dict(base.attrib) if base is not None else {})


def structure(scene: Scene) -> str:
    """SystemStructure.ssd: set points in, wheel speeds and pose out, the control loop closed inside."""
    ET.register_namespace("ssd", SSD)
    ET.register_namespace("ssc", SSC)
    wheels, (units, exponents) = scene.wheel_count, _units_of((read(CONTROLLER), read(DESCRIPTION)))
    root = ET.Element(f"{{{SSD}}}SystemStructureDescription", {
        "version": "1.0", "name": identifier(scene.path.stem), "description": scene.name, "generationTool": "Laconic"})
    system = ET.SubElement(root, f"{{{SSD}}}System", {"name": "vehicle_with_controller"})
    _connectors(system, "", wheels, units)
    elements = ET.SubElement(system, f"{{{SSD}}}Elements")
    for name in ("controller", "vehicle"):
        component = ET.SubElement(elements, f"{{{SSD}}}Component", {
            "name": name, "type": "application/x-fmu-sharedlibrary", "source": f"resources/{name}.fmu"})
        _connectors(component, name, wheels, units)
    _connections(system, wheels)
    _units(root, (units[wire.variable] for wire in WIRES), exponents)
    ET.SubElement(root, f"{{{SSD}}}DefaultExperiment", {"startTime": "0.0", "stopTime": repr(scene.run.duration_s)})
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def make_ssp(scene: Scene, out: Path, *, version: int = 2, sources: bool = True, enumerations: bool = True) -> Path:
    """Writes the archive: both FMUs and how they are connected; BadInput where there can be none."""
    if version != 2:
        raise BadInput("--ssp: SSP 1.0 has no FMUs of FMI 3; use --fmi 2")
    hinges.check(scene, ssp=True)
    if scene.wheel_count == 0:
        raise BadInput(f"{scene.path}: vehicle.wheel: there is nothing to control without wheels; leave out --ssp")
    options: dict[str, Any] = {"version": version, "sources": sources, "enumerations": enumerations}
    with tempfile.TemporaryDirectory() as folder:
        vehicle = make_fmu(scene, Path(folder) / "vehicle.fmu", **options)
        controller = make_controller(scene, Path(folder) / "controller.fmu", **options)
        with whole_file(out) as fresh:
            pack(fresh, {"SystemStructure.ssd": structure(scene).encode("utf-8"),
                         "resources/vehicle.fmu": vehicle.read_bytes(),
                         "resources/controller.fmu": controller.read_bytes()})
    return out
