"""FMUs for scenes, alone and connected with their controller."""

from laconic.fmu.make import DESCRIPTION, PLAIN, content_of, make_fmu, start_values

__all__ = ["DESCRIPTION", "PLAIN", "content_of", "make_fmu", "start_values"]
