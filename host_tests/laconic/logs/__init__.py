"""Recorded logs of real robots: text or CAN, brought to the wheels, to SI units and to the scene's frames by a map."""

from laconic.logs.log import Log
from laconic.logs.recognise import gather_logs

__all__ = ["Log", "gather_logs"]
