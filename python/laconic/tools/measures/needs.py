"""What a measure is about and a scene may lack."""

from __future__ import annotations

from laconic.scene import Scene
from laconic.tools.measures.measure import Measure


def lacks(measure: Measure, scene: Scene) -> str:
    """What the measure needs and the scene has not, in words; empty where it has all."""
    vehicle = scene.vehicle
    ground = vehicle.get("ground", {})
    has = {"": True, "motor": "motor" in vehicle, "wheels": bool(vehicle["wheel"]),
           "supply": bool(vehicle.get("drive", {}).get("supply_V")),
           "friction coefficient": bool(vehicle["friction_coefficient"] or ground.get("friction_coefficient"))}
    words = {"motor": "[vehicle.motor]", "wheels": "wheels", "supply": "vehicle.drive.supply_V",
             "friction coefficient": "vehicle.friction_coefficient"}
    return "" if has[measure.needs] else words[measure.needs]
