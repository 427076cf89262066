"""Control with a step's derivatives: a Kalman filter, a predictive controller, a step for CasADi; docs/control.md.

The names in `__all__` are this room's interface, each loaded when it is first used: the predictive controller needs
osqp, the step for CasADi needs casadi (extra `control`).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from laconic.tools.control.casadi_step import casadi_step as casadi_step
    from laconic.tools.control.course import Course as Course
    from laconic.tools.control.filter import Filter as Filter
    from laconic.tools.control.filter import Innovation as Innovation
    from laconic.tools.control.node_loop import Camera as Camera
    from laconic.tools.control.node_loop import Drive as Drive
    from laconic.tools.control.node_loop import drive as drive
    from laconic.tools.control.picture import plot_drive as plot_drive
    from laconic.tools.control.predictive import PredictiveController as PredictiveController

__all__ = ["Camera", "Course", "Drive", "Filter", "Innovation", "PredictiveController", "casadi_step", "drive",
           "plot_drive"]

_ROOMS = {"Camera": "node_loop", "Course": "course", "Drive": "node_loop", "Filter": "filter", "Innovation": "filter",
          "PredictiveController": "predictive", "casadi_step": "casadi_step", "drive": "node_loop",
          "plot_drive": "picture"}

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name not in _ROOMS:
            raise AttributeError(f"module 'laconic.tools.control' has no attribute {name!r}; its names are "
                                 f"{', '.join(__all__)}")
        try:
            room = import_module(f"laconic.tools.control.{_ROOMS[name]}")
        except ModuleNotFoundError as error:
            from laconic.base.extras import missing_module
            raise missing_module(error) from None
        found = globals()[name] = getattr(room, name)
        return found
