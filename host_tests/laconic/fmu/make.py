"""FMUs for scenes: the generic one of the build with the scene's vehicle as start values.

    make_fmu(read_scene("robotino2"), Path("robotino2.fmu"), version=3)
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from laconic.core import load
from laconic.errors import BadInput
from laconic.outputs import whole_file
from laconic.paths import SOURCE_DIR, built
from laconic.scene import METHODS, Scene
from laconic_fmu.archive import Content, Variant, scene_fmu
from laconic_fmu.page import vehicle_parts

DESCRIPTION = SOURCE_DIR / "modelDescription.xml"

PLAIN = ("mass_kg", "yaw_inertia_kgm2", "com_x_m", "com_y_m", "com_z_m", "wheel_radius_m", "wheel_inertia_kgm2",
         "motor_gain_Nm_per_V", "motor_damping_Nms", "friction_coefficient")
PAYLOAD = ("mass_kg", "x_m", "y_m", "yaw_inertia_kgm2")
WHEEL = {"wheel_kind": "kind", "wheel_x_m": "x_m", "wheel_y_m": "y_m", "axle_rad": "axle_rad",
         "roller_rad": "roller_rad", "wheel_locked": "locked"}


def generic_fmu(version: int) -> Path:
    """The FMU that the build made."""
    return built(f"fmu/Laconic_fmi{version}.fmu")


def start_values(scene: Scene) -> dict[str, list[float]]:
    """The scene's vehicle, start, method and step by the names of the FMI variables."""
    core = load("double")
    vehicle, start = scene.c_vehicle(core), scene.initial
    wheels = [vehicle.wheel[i] for i in range(vehicle.wheel_count)]
    supports = [vehicle.support[i] for i in range(core.max_supports)]
    values: dict[str, list[float]] = {"wheel_count": [vehicle.wheel_count]}
    values |= {name: [getattr(vehicle, name)] for name in PLAIN}
    values |= {f"payload_{name}": [getattr(vehicle.payload, name)] for name in PAYLOAD}
    values |= {name: [float(getattr(wheel, key)) for wheel in wheels] for name, key in WHEEL.items()}
    values |= {"support_count": [vehicle.support_count], "support_x_m": [each.x_m for each in supports],
               "support_y_m": [each.y_m for each in supports]}
    values |= {"start_nu_rad_per_s": [float(nu) for nu in start.nu(scene.model(core))], "start_x_m": [start.x_m],
               "start_y_m": [start.y_m], "start_heading_rad": [start.heading_rad]}
    return values | {"method": [METHODS.index(scene.run.method)], "step_s": [scene.run.step_s]}


def content_of(scene: Scene, name: str, text: str, values: dict[str, Any]) -> Content:
    """What an FMU of the scene says, with the scene's own duration and step."""
    return Content(name, text, values, scene.run.duration_s, scene.run.step_s)


def make_fmu(scene: Scene, out: Path, *, version: int, scalar: bool = False, sources: bool = True,
             enumerations: bool = True) -> Path:
    """Writes the scene's FMU; BadInput when the scene cannot be one."""
    if scene.wheel_count == 0 and version == 3 and not scalar:
        raise BadInput(f"{scene.path}: vehicle.wheel: a vehicle without wheels has no arrays; use --scalar or --fmi 2")
    scene.plant(load("double"))  # what cannot start is refused here, with the field's name
    content = content_of(scene, scene.name, f"Dynamics of a wheeled robot; its numbers: {scene.source}",
                         start_values(scene))
    with whole_file(out) as fresh:
        scene_fmu(generic_fmu(version), DESCRIPTION, content, fresh,
                  Variant(version, scalar, enumerations, sources), vehicle_parts)
    return out
