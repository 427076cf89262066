"""What the options of `laconic rig` and `laconic play` choose from; it needs nothing that the extras bring, so that
--help explains them without."""

from __future__ import annotations

from dataclasses import dataclass

LOGS = (".blf", ".asc", ".log", ".trc", ".mf4")


@dataclass(frozen=True)
class Board:
    """An emulated board."""

    name: str
    machine: str
    real: str
    text: str
    plays_only: bool = False  # drives: it has neither lockstep nor free run


BOARDS = {board.name: board for board in (
    Board("an385", "mps2-an385", "single", "Arm MPS2, Cortex-M3"),
    Board("an386", "mps2-an386", "single", "Arm MPS2, Cortex-M4F"),
    Board("an500", "mps2-an500", "double", "Arm MPS2, Cortex-M7"),
    Board("microbit", "microbit", "single", "BBC micro:bit, Cortex-M0"),
    Board("an386-hinges", "mps2-an386", "single", "Cortex-M4F, for vehicles with hinges"),
    Board("an386-slip", "mps2-an386", "single", "the same on ground with friction"),
    Board("an500-hinges", "mps2-an500", "double", "Cortex-M7, for vehicles with hinges"),
    Board("an386-small", "mps2-an386", "single", "Cortex-M4F, one method, four wheels"),
    Board("an386-xcp", "mps2-an386", "single", "the same with XCP"),
    Board("an386-drives", "mps2-an386", "single", "the small one with RoboMaster drives"),
    Board("an386-odrive", "mps2-an386", "single", "the same with ODrives"),
    Board("an386-canopen", "mps2-an386", "single", "the same with CANopen drives", plays_only=True),
    Board("an386-moteus", "mps2-an386", "single", "the same with moteus controllers", plays_only=True))}
KINDS = ("virtual", "process", *BOARDS)
ON_BUS = "bus"  # the node is on the controller's bus already
