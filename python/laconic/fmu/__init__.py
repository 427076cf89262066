"""FMUs for scenes, alone and connected with their controller."""

from laconic.fmu.make import DESCRIPTION, content_of, make_fmu, start_values

__all__ = ["DESCRIPTION", "content_of", "make_fmu", "start_values"]
