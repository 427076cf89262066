"""A vehicle and its wheel-speed controller as one system: two FMUs connected in an SSP 1.0 archive."""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

from laconic.fmu import make_fmu
from laconic.outputs import whole_file
from laconic.paths import SOURCE_DIR, built
from laconic.scene import Scene
from laconic_fmu.archive import scene_fmu
from laconic_fmu.description import read
from laconic_fmu.package import pack

CONTROLLER = SOURCE_DIR / "fmu" / "controller" / "modelDescription.xml"
SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"


def make_controller(scene: Scene, out: Path, *, version: int, scalar: bool = False, sources: bool = True) -> Path:
    """The controller's FMU with as many loops as the scene has wheels."""
    text = read(CONTROLLER).root.get("description", "")
    scene_fmu(built(f"fmu/LaconicController_fmi{version}.fmu"), CONTROLLER, {"wheel_count": [scene.wheel_count]},
              f"Wheel-speed controller for {scene.name}", text, out, version=version, scalar=scalar,
              stop_s=scene.run.duration_s, step_s=scene.run.step_s, sources=sources)
    return out


def _connectors(parent: ET.Element, kinds: dict[str, str], wheels: int) -> None:
    group = ET.SubElement(parent, f"{{{SSD}}}Connectors")
    for name, kind in kinds.items():
        for i in range(1, wheels + 1):
            connector = ET.SubElement(group, f"{{{SSD}}}Connector", {"name": f"{name}[{i}]", "kind": kind})
            ET.SubElement(connector, f"{{{SSC}}}Real")


def structure(scene: Scene) -> str:
    """SystemStructure.ssd: set points in, wheel speeds out, the loop closed inside."""
    ET.register_namespace("ssd", SSD)
    ET.register_namespace("ssc", SSC)
    wheels = scene.wheel_count
    root = ET.Element(f"{{{SSD}}}SystemStructureDescription", {"version": "1.0", "name": scene.name})
    system = ET.SubElement(root, f"{{{SSD}}}System", {"name": "vehicle_with_controller"})
    _connectors(system, {"setpoint_rad_per_s": "input", "wheel_speed_rad_per_s": "output"}, wheels)
    elements = ET.SubElement(system, f"{{{SSD}}}Elements")
    for name, kinds in (("controller", {"setpoint_rad_per_s": "input", "wheel_speed_rad_per_s": "input",
                                        "voltage_V": "output"}),
                        ("vehicle", {"voltage_V": "input", "wheel_speed_rad_per_s": "output"})):
        component = ET.SubElement(elements, f"{{{SSD}}}Component", {
            "name": name, "type": "application/x-fmu-sharedlibrary", "source": f"resources/{name}.fmu"})
        _connectors(component, kinds, wheels)
    connections = ET.SubElement(system, f"{{{SSD}}}Connections")
    for i in range(1, wheels + 1):
        for start, end, name in (("", "controller", "setpoint_rad_per_s"), ("controller", "vehicle", "voltage_V"),
                                 ("vehicle", "controller", "wheel_speed_rad_per_s"),
                                 ("vehicle", "", "wheel_speed_rad_per_s")):
            ends = {"startConnector": f"{name}[{i}]", "endConnector": f"{name}[{i}]"}
            ends |= {"startElement": start} if start else {}
            ends |= {"endElement": end} if end else {}
            ET.SubElement(connections, f"{{{SSD}}}Connection", ends)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def make_ssp(scene: Scene, out: Path, *, version: int = 2, scalar: bool = False, sources: bool = True) -> Path:
    """Writes the archive: both FMUs and how they are connected."""
    with tempfile.TemporaryDirectory() as folder:
        vehicle = make_fmu(scene, Path(folder) / "vehicle.fmu", version=version, scalar=scalar, sources=sources)
        controller = make_controller(scene, Path(folder) / "controller.fmu", version=version, scalar=scalar,
                                     sources=sources)
        with whole_file(out) as fresh:
            pack(fresh, {"SystemStructure.ssd": structure(scene).encode("utf-8"),
                         "resources/vehicle.fmu": vehicle.read_bytes(),
                         "resources/controller.fmu": controller.read_bytes()})
    return out
