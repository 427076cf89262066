"""Scenes with hinges for tests: those of the project with other inputs, and small ones."""

from __future__ import annotations

import copy
from typing import Any

from laconic import Scene, build_scene
from laconic.scene.scene_tables import scene_tables

HINGED = ("f1tenth", "tricycle_agv", "frc_swerve_mk4i", "mir_like", "pr2_base", "tugger_train", "wheel_loader",
          "wheelchair")
SLIDING = ("swerve_module_off", "trailer_on_ice")  # whose ground has friction
WHEEL = {"kind": "fixed", "axle_deg": -90.0}
CASTER: dict[str, Any] = {"x_m": 0.3, "y_m": 0.0, "trail_m": 0.05, "radius_m": 0.04}


def tables_of(name: str, **tables: Any) -> dict[str, Any]:
    """The tables of a scene of the project with some replaced; its outputs are the usual ones."""
    entries = copy.deepcopy(scene_tables(name).entries)
    entries.pop("outputs", None)
    return entries | tables


def held(**signals: float) -> list[dict[str, Any]]:
    """Inputs that hold a value from the start; `__` in a name opens its bracket: voltage_V__1."""
    return [{"signal": f"{name}[{item}]" if item else name, "kind": "steps", "t_s": [0.0], "value": [value]}
            for name, _, item, value in ((*each.partition("__"), value) for each, value in signals.items())]


def two_wheels(**vehicle: Any) -> dict[str, Any]:
    """Tables of a carriage on two undriven wheels, 0.4 m apart, that starts at 0.8 m/s; `run` is 0.5 s."""
    return {"vehicle": {"mass_kg": 20.0, "yaw_inertia_kgm2": 0.8, "wheel_radius_m": 0.08, "wheel_inertia_kgm2": 0.0,
                        "wheel": [{**WHEEL, "x_m": 0.0, "y_m": y} for y in (0.2, -0.2)], **vehicle},
            "initial": {"velocity_body_m_per_s": [0.8, 0.0]}, "run": {"duration_s": 0.5, "step_s": 0.01}}


def scene_with(tables: dict[str, Any], **changes: Any) -> Scene:
    """The scene of tables with some replaced."""
    return build_scene(tables | changes)
