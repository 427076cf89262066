"""FMUs for scenes, alone and connected with their controller."""

from laconic.fmu.make import DESCRIPTION, content_of, make_fmu, start_values
from laconic.fmu.network import make_network_fmu

__all__ = ["DESCRIPTION", "content_of", "make_fmu", "make_network_fmu", "start_values"]
