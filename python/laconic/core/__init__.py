"""The shipping C core from Python; physics is only on its side."""

from laconic.core.binding import REALS, Core, Matrices, load
from laconic.core.fields import Field
from laconic.core.vehicle import Linearisation, Rates, Vehicle

__all__ = ["REALS", "Core", "Field", "Linearisation", "Matrices", "Rates", "Vehicle", "load"]
