"""Controllers that others wrote in front of drives on a board: PyPI's canopen (BaseNode402), PyPI's odrive-can, and a
client of our own for C620 speed controllers, by their public manual.

The node names the torques of its drives in each step; a plant of the core that is fed with them must have the same
wheel motion after every step, bit for bit, and the drives must follow the controller."""

from __future__ import annotations

import importlib
import importlib.util
import time
from collections.abc import Callable
from typing import Any

from laconic.errors import BadInput, LaconicError, ResultFails, nearest_of
from laconic.rig.boards import why_no_emulation
from laconic.rig.choices import BOARDS, KINDS
from laconic.soak import StoppedEarly
from laconic.soak._controllers.bench import bench
from laconic.soak._controllers.cycles import Cycles

CONTROLLERS = {"canopen": "by_canopen", "odrive": "by_odrive", "robomaster": "by_c620"}
MODULES = {"canopen": "canopen", "odrive": "odrive_can"}  # in the build's environment, in no extra of the wheel
EMULATED = "an386"  # Cortex-M4F, single precision, every protocol
USUAL_BOARDS = ("process", EMULATED)
STEP_S = 0.005
OPTIONS = ("board", "protocol", "cycles", "step_s")


def soak(minutes: float, seed: int, advance: Callable[[float], None], board: str | None = None,
         protocol: str | None = None, cycles: int = 10_000, step_s: float = STEP_S) -> dict[str, Any]:
    """Each controller on each board, or one of them; neither time nor seed has an effect."""
    boards, protocols = chosen(board, protocol, step_s)
    found: dict[str, Any] = {"passed": True}
    try:
        for where in boards:
            for name in protocols:
                found[f"{name} on {where}"] = said = run(name, where, cycles, step_s, advance)
                found["passed"] &= said.startswith("passed")
    except KeyboardInterrupt as stopped:
        raise StoppedEarly(found) from stopped
    return found


def length(board: str | None = None, protocol: str | None = None, cycles: int = 10_000, step_s: float = STEP_S
           ) -> float:
    """How far `advance` will have come at the end."""
    boards, protocols = chosen(board, protocol, step_s)
    return float(len(boards) * len(protocols) * cycles)


def chosen(board: str | None, protocol: str | None, step_s: float) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Boards and protocols; BadInput for those that there are not."""
    if not 0.0 < step_s < 1.0:
        raise BadInput(f"--step {step_s:g}: is not usable; give seconds above 0 and below 1, such as 0.005")
    where = EMULATED if board == "emulated" else board
    if where is not None and where not in KINDS:
        raise BadInput(f"--board {board}: there is no such board; {nearest_of(where, ('emulated', *KINDS))}")
    if protocol is not None and protocol not in CONTROLLERS:
        raise BadInput(f"--protocol {protocol}: there is no controller of it here; {nearest_of(protocol, CONTROLLERS)}")
    if where in BOARDS and (reason := why_no_emulation()):
        raise BadInput(f"--board {board}: {reason}")
    boards = USUAL_BOARDS[: 1 if why_no_emulation() else 2] if where is None else (where,)
    protocols = tuple(CONTROLLERS) if protocol is None else (protocol,)
    for name in protocols:
        module = MODULES.get(name)
        if module is not None and importlib.util.find_spec(module) is None:
            wanted = module.replace("_", "-")
            raise BadInput(f"--protocol {name}: its controller is PyPI's {wanted}, which is not installed; pip install "
                           f"{wanted}, or choose another --protocol")
    return boards, protocols


def run(protocol: str, board: str, cycles: int, step_s: float, advance: Callable[[float], None]) -> str:
    """One controller on one board; the verdict in a line."""
    controller = importlib.import_module(f"laconic.soak._controllers.{CONTROLLERS[protocol]}")
    counted, began = Cycles(cycles, step_s, advance), time.perf_counter()
    try:
        with bench(controller.SCENE, protocol, board, step_s) as it:
            controller.control(it, counted)
        if not it.truth.most_torque_Nm > 0.0 or not it.truth.most_speed_rad_per_s > 1.0:
            raise ResultFails("the wheels did not move")
    except BadInput:
        raise
    except LaconicError as error:
        return f"failed after {counted.done} cycles: {error}"
    late = it.vehicle.lateness
    return (f"passed: {counted.done} cycles in {time.perf_counter() - began:.1f} s, {it.traffic.frames_in} frames to "
            f"the drives, {it.traffic.frames_out} from them; all {it.truth.steps} steps have the core's bits; slowest "
            f"cycle {1000.0 * counted.slowest_s:.1f} ms; {late.late_periods} periods late, by "
            f"{late.worst_us / 1000.0:.1f} ms at most")
