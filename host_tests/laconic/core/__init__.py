"""The shipping C core from Python; physics is only on its side."""

from laconic.core.binding import REALS, Core, Matrices, load

__all__ = ["REALS", "Core", "Matrices", "load"]
