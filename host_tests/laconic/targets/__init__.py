"""One hash on every target: core_c's trajectory_hash.c and check_double.c, compiled for a processor and run by it or by
an emulator of it."""

from laconic.targets.boards import board_lines
from laconic.targets.table import TARGETS, Bits, HashTarget

__all__ = ["TARGETS", "Bits", "HashTarget", "board_lines"]
