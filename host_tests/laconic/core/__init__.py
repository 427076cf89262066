"""The shipping C core from Python; physics is only on its side."""

from laconic.core.binding import REALS, Core, Matrices, load
from laconic.core.fields import Field

__all__ = ["REALS", "Core", "Field", "Matrices", "load"]
