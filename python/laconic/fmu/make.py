"""FMUs for scenes: the generic one of the build with the scene's vehicle as start values.

    make_fmu(read_scene("robotino2"), Path("robotino2.fmu"), version=3)
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.outputs import check_ending, check_file, whole_file
from laconic.base.paths import SOURCE_DIR, as_path, built
from laconic.core import load
from laconic.core.given import flag
from laconic.core.sensors import settings_of, values_of
from laconic.errors import BadInput, shown
from laconic.fmu import hinges
from laconic.scene import METHODS, Scene, check_scene
from laconic_fmu.archive import Content, Variant, scene_fmu
from laconic_fmu.page import vehicle_parts

DESCRIPTION = SOURCE_DIR / "modelDescription.xml"
VERSIONS = (2, 3)  # of FMI


def generic_fmu(version: int, derivatives: bool = False, estimate: bool = False, hinged: str = "") -> Path:
    """The FMU that the build made; `hinged` is "Articulated" or "Slipping" for a vehicle with hinges."""
    variant = "Derivatives" if derivatives else "Estimate" if estimate else hinged
    return built(f"fmu/Laconic{variant}_fmi{version}.fmu")


def start_values(scene: Scene) -> dict[str, list[float]]:
    """The scene's vehicle, start, sensors, method and step by the names of the FMI variables."""
    core = load("double")
    roots = {"vehicle": scene.c_vehicle(core), "initial": scene.c_start(core)}
    values: dict[str, list[float]] = {}
    for field in core.fields:
        root = field.root
        if root in roots and field.table != "vehicle.motor":
            of_wheels = field.items == core.max_wheels
            values[field.name] = field.values(roots[root])[:scene.wheel_count if of_wheels else None]
    values |= sensor_values(scene)
    return values | {"method": [METHODS.index(scene.run.method)], "step_s": [scene.run.step_s]}


def sensor_values(scene: Scene) -> dict[str, list[float]]:
    """The settings of the scene's sensors by the names of the FMI variables."""
    core = load("double")
    settings = settings_of(core, scene.sensors.settings(scene.delay_steps(core)), scene.wheel_count)
    values: dict[str, list[float]] = {"has_imu": [scene.sensors.imu is not None]}
    for field in core.sensor_fields:
        of_wheels = field.items == core.max_wheels
        values[field.name] = values_of(field, settings)[:scene.wheel_count if of_wheels else None]
    return values


def content_of(scene: Scene, name: str, text: str, values: dict[str, Any]) -> Content:
    """Content of an FMU of the scene, with the scene's duration and step."""
    return Content(name, text, values, scene.run.duration_s, scene.run.step_s)


def make_fmu(scene: Scene, out: str | Path, *, version: int, scalar: bool = False, sources: bool = True,
             enumerations: bool = True, derivatives: bool = False, estimate: bool = False) -> Path:
    """Writes the scene's FMU; BadInput when the scene has no such FMU.

    `version` of FMI, 2 or 3, is what the importing tool reads: there is no default, as each tool reads one or both.
    `derivatives`: for Co-Simulation alone, whose directional and adjoint derivatives are those of its steps.
    `estimate`: for Co-Simulation alone, with outputs of how far the run is from the true motion.
    A scene with hinges gives another FMU, which has no such variants and no limits of hinges (`hinges.left_out`); on
    ground with friction one for Co-Simulation alone.
    """
    check_scene(scene)
    scalar, sources = flag("scalar", scalar), flag("sources", sources)
    enumerations, derivatives = flag("enumerations", enumerations), flag("derivatives", derivatives)
    estimate = flag("estimate", estimate)
    if estimate and derivatives:
        raise BadInput("estimate, derivatives: no FMU has both; leave one of them out")
    if not isinstance(version, int | np.integer) or version not in VERSIONS:
        raise BadInput(f"version: there is no FMI {shown(version)}; give {' or '.join(map(str, VERSIONS))}")
    path = as_path("out", out)
    check_ending("out", path, (".fmu",))
    check_file("out", path)
    hinges.check(scene, derivatives=derivatives, estimate=estimate)
    if derivatives:
        _check_smooth(scene)
    if scene.wheel_count == 0 and version == 3 and not scalar:
        raise BadInput(f"{scene.path}: vehicle.wheel: a vehicle without wheels has no arrays; use --scalar or --fmi 2")
    values = _values_of(scene, estimate)
    content = content_of(scene, scene.name, f"Dynamics of a wheeled robot; its numbers: {scene.source}", values)
    hinged = "Slipping" if scene.slips_on_hinges else "Articulated" if scene.has_hinges else ""
    generic = generic_fmu(version, derivatives, estimate, hinged)
    source = hinges.DESCRIPTION if scene.has_hinges else DESCRIPTION
    with whole_file(path) as fresh:
        scene_fmu(generic, source, content, fresh, Variant(version, scalar, enumerations, sources, derivatives,
                                                           scene.slips_on_hinges), vehicle_parts)
    return path


def _values_of(scene: Scene, estimate: bool) -> dict[str, list[float]]:
    """Start values of a scene that can start; else it is refused, naming the field."""
    if scene.has_hinges:
        return hinges.start_values(scene)
    scene.sensors_of(scene.plant(load("double")))
    return start_values(scene) | ({"estimate_error": [1.0]} if estimate else {})


def _check_smooth(scene: Scene) -> None:
    if scene.plant(load("double")).has_friction:
        raise BadInput(f"{scene.path}: --derivatives: the scene has friction in [ground] or limits in [vehicle.drive], "
                       "and such steps are not smooth; take these out, or leave the option out")
