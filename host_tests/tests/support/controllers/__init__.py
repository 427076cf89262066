"""Controllers that others wrote in front of drives on a board: PyPI's canopen (BaseNode402), PyPI's odrive-can, and a
client of our own for C620 speed controllers, by their public manual.

The node names the torques of its drives in each step. A plant of the core that is fed with them must have the same
wheel motion after every step, bit for bit, and the drives must follow the controller."""

from __future__ import annotations

import importlib
import time

from controllers.bench import bench
from controllers.cycles import Cycles
from laconic.errors import BadInput, LaconicError, ResultFails

CONTROLLERS = {"canopen": "by_canopen", "odrive": "by_odrive", "robomaster": "by_c620"}
STEP_S = 0.005


def run(protocol: str, board: str, cycles: int, step_s: float = STEP_S) -> str:
    """One controller on one board; the verdict in a line."""
    controller = importlib.import_module(f"controllers.{CONTROLLERS[protocol]}")
    counted, began = Cycles(cycles, step_s), time.perf_counter()
    try:
        with bench(controller.SCENE, protocol, board, step_s) as it:
            controller.control(it, counted)
        if not it.truth.most_torque_Nm > 0.0 or not it.truth.most_speed_rad_per_s > 1.0:
            raise ResultFails("the wheels did not move")
    except BadInput:
        raise
    except LaconicError as error:
        return f"failed after {counted.done} cycles: {error}"
    return (f"passed: {counted.done} cycles in {time.perf_counter() - began:.1f} s, {it.traffic.frames_in} frames to "
            f"the drives, {it.traffic.frames_out} from them; all {it.truth.steps} steps have the core's bits; slowest "
            f"cycle {1000.0 * counted.slowest_s:.1f} ms; {it.vehicle.lateness.late_periods} periods late")
