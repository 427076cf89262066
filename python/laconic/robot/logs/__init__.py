"""Recorded logs of real robots: text or CAN, brought to the wheels, to SI units and to the scene's frames by a map."""

from laconic.robot.logs.log import Log
from laconic.robot.logs.recognise import gather_logs

__all__ = ["Log", "gather_logs"]
