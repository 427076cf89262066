"""Robots of the FIRST Robotics Competition: WPILib's motors and modules, a physics engine for pyfrc, a bridge.

    import laconic.frc                                        # physics.py of a robot in Python

    PhysicsEngine = laconic.frc.engine("robot.toml")

docs/frc.md shows it at work; `laconic frc` makes the scene, and drives robot programs in Java and C++.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from laconic.frc.drivetrain import Battery as Battery
    from laconic.frc.drivetrain import Drivetrain as Drivetrain
    from laconic.frc.drivetrain import Motion as Motion
    from laconic.frc.new import MODULES as MODULES
    from laconic.frc.new import MOTORS as MOTORS
    from laconic.frc.new import Robot as Robot
    from laconic.frc.new import new_scene as new_scene
    from laconic.frc.physics import Engine as Engine
    from laconic.frc.physics import engine as engine
    from laconic.frc.websocket import Bridge as Bridge

_MODULES = {"Battery": "drivetrain", "Drivetrain": "drivetrain", "Motion": "drivetrain", "Engine": "physics",
            "engine": "physics", "MODULES": "new", "MOTORS": "new", "Robot": "new", "new_scene": "new",
            "Bridge": "websocket"}
__all__ = ["MODULES", "MOTORS", "Battery", "Bridge", "Drivetrain", "Engine", "Motion", "Robot", "engine", "new_scene"]


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name not in _MODULES:
            raise AttributeError(f"module 'laconic.frc' has no attribute {name!r}; its names are {', '.join(__all__)}")
        found = getattr(import_module(f"laconic.frc.{_MODULES[name]}"), name)
        globals()[name] = found
        return found
