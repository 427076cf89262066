"""Elements of which a robot's file may have one at a place: of two a reader would take either and drop the other."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from laconic.errors import BadInput
from laconic.robot.importer.xml_file import Element

SHAPES = ("box", "cylinder", "capsule", "sphere", "mesh")  # of one <geometry>
ONCE = frozenset({"inertial", "mass", "inertia", "origin", "pose", "geometry", "parent", "child", "axis", "xyz",
                  "limit", "dynamics", "damping", "friction", "mimic", "lower", "upper", "radius", "length", "size",
                  "ixx", "ixy", "ixz", "iyy", "iyz", "izz", *SHAPES})


FOREIGN = ("gazebo", "sensor", "plugin", "visual")  # what others read, or what is left out where it is doubled


def refuse_doubled(path: Path, part: Element) -> None:
    """BadInput with the name of a link or joint in which one of these stands twice."""
    if doubled := what_is_doubled(part):
        raise BadInput(f"{path}: {part.tag} {part.get('name', '')}: {doubled}")


def what_is_doubled(part: Element) -> str:
    """What stands twice in an element, and what to do; empty where nothing does."""
    waiting = [part]
    while waiting:
        element = waiting.pop()
        tags = Counter(child.tag for child in element)
        for tag, count in tags.items():
            if count > 1 and tag in ONCE:
                return f"<{element.tag}> has {count} <{tag}>; keep the one that holds"
        shapes = [tag for tag in tags if tag in SHAPES] if element.tag == "geometry" else []
        if len(shapes) > 1:
            return (f"one <geometry> has <{shapes[0]}> and <{shapes[1]}>; give each shape a <collision> or <visual> of "
                    "its own")
        waiting += [child for child in element if child.tag not in FOREIGN]
    return ""
