"""Scenes: TOML files that say a vehicle, its start, what acts on it and how it is run."""

from laconic.scene.scene import METHODS, MOST_STEPS, Outputs, Scene, read_scene

__all__ = ["METHODS", "MOST_STEPS", "Outputs", "Scene", "read_scene"]
