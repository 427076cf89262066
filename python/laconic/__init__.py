"""Wheeled robots from Python: scenes, runs of them through the C core, and FMUs; docs/python.md shows them at work.

    run = laconic.simulate(laconic.read_scene("robotino2"))
    run.time_s, run.columns["x_m"]

The names in `__all__` are the public interface; everything else may change. Each is loaded when it is first used, so
that `import laconic` costs next to nothing. Lengths are in m, angles in rad, times in s; what a user gave and cannot be
used is raised as BadInput, in one line that names the field and the remedy.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # for type checkers and editors; the table below is what runs
    from laconic.base.paths import scene_names as scene_names
    from laconic.batch import ArticulatedBatch as ArticulatedBatch
    from laconic.batch import Batch as Batch
    from laconic.core import Core as Core
    from laconic.core import Linearisation as Linearisation
    from laconic.core import Matrices as Matrices
    from laconic.core import Rates as Rates
    from laconic.core import Vehicle as Vehicle
    from laconic.core import load as load_core
    from laconic.core.articulated import ArticulatedMotion as ArticulatedMotion
    from laconic.core.articulated import ArticulatedPlant as ArticulatedPlant
    from laconic.core.articulated import ArticulatedReactions as ArticulatedReactions
    from laconic.core.articulated import ArticulatedVehicle as ArticulatedVehicle
    from laconic.core.derivatives import StepDerivatives as StepDerivatives
    from laconic.core.derivatives import StepJacobian as StepJacobian
    from laconic.core.estimate import Errors as Errors
    from laconic.core.estimate import Estimate as Estimate
    from laconic.core.plant import Plant as Plant
    from laconic.core.plant import Pose as Pose
    from laconic.core.sensors import Readings as Readings
    from laconic.core.sensors import Sensors as Sensors
    from laconic.core.slipping import SlippingOutputs as SlippingOutputs
    from laconic.core.slipping import SlippingPlant as SlippingPlant
    from laconic.core.slipping import SlippingVehicle as SlippingVehicle
    from laconic.errors import BadInput as BadInput
    from laconic.errors import Refused as Refused
    from laconic.fmu import make_fmu as make_fmu
    from laconic.pictures.plotting import plot as plot
    from laconic.scene import METHODS as METHODS
    from laconic.scene import Scene as Scene
    from laconic.scene import build_scene as build_scene
    from laconic.scene import read_scene as read_scene
    from laconic.simulation import RunRefused as RunRefused
    from laconic.simulation import Trajectory as Trajectory
    from laconic.simulation import simulate as simulate
    from laconic.tools.analyse.analyse import analyse as analyse
    from laconic.tools.analyse.findings import Study as Study
    from laconic.tools.control.filter import Filter as Filter

__all__ = ["METHODS", "ArticulatedBatch", "ArticulatedMotion", "ArticulatedPlant", "ArticulatedReactions",
           "ArticulatedVehicle", "BadInput", "Batch", "Core", "Errors", "Estimate", "Filter", "Linearisation",
           "Matrices", "Plant", "Pose", "Rates", "Readings", "Refused", "RunRefused", "Scene", "Sensors",
           "SlippingOutputs", "SlippingPlant", "SlippingVehicle", "StepDerivatives", "StepJacobian", "Study",
           "Trajectory", "Vehicle", "analyse", "build_scene", "load_core", "make_fmu", "plot", "read_scene",
           "scene_names", "simulate"]

_MODULES = {  # name → where it is, and as what if not by the same name
    "METHODS": "scene", **dict.fromkeys(("ArticulatedMotion", "ArticulatedPlant", "ArticulatedReactions",
                                         "ArticulatedVehicle"), "core.articulated"),
    "ArticulatedBatch": "batch", "BadInput": "errors", "Batch": "batch", "Core": "core", "Linearisation": "core",
    "Errors": "core.estimate", "Estimate": "core.estimate", "Filter": "tools.control.filter", "Matrices": "core",
    "Plant": "core.plant", "Pose": "core.plant", "Rates": "core",
    "Readings": "core.sensors", "Refused": "errors", "RunRefused": "simulation", "Scene": "scene",
    "Sensors": "core.sensors",
    **dict.fromkeys(("SlippingOutputs", "SlippingPlant", "SlippingVehicle"), "core.slipping"),
    "StepDerivatives": "core.derivatives", "StepJacobian": "core.derivatives",
    "Study": "tools.analyse.findings", "Trajectory": "simulation", "Vehicle": "core",
    "analyse": "tools.analyse.analyse", "build_scene": "scene", "load_core": "core:load", "make_fmu": "fmu",
    "plot": "pictures.plotting", "read_scene": "scene", "scene_names": "base.paths", "simulate": "simulation"}


if not TYPE_CHECKING:  # a type checker would take every name for one that this function knows

    def __getattr__(name: str) -> Any:
        if name not in _MODULES:
            raise AttributeError(f"module 'laconic' has no attribute {name!r}; its names are {', '.join(__all__)}")
        module, _, inside = _MODULES[name].partition(":")
        try:
            room = import_module(f"laconic.{module}")
        except ModuleNotFoundError as error:
            from laconic.base.extras import missing_module
            raise missing_module(error) from None
        found = globals()[name] = getattr(room, inside or name)
        return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
