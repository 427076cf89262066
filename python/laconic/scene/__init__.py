"""Scenes: TOML files that describe a vehicle, its start, its inputs and its run."""

from laconic.scene.hinges import rigid_scene_names
from laconic.scene.methods import METHODS
from laconic.scene.scene import MOST_STEPS, Outputs, Scene, build_scene, check_scene, read_scene, scene_of

__all__ = ["METHODS", "MOST_STEPS", "Outputs", "Scene", "build_scene", "check_scene", "read_scene",
           "rigid_scene_names", "scene_of"]
