"""Which reader a file needs: by its ending, else by the element it begins with."""

from __future__ import annotations

from pathlib import Path

from laconic.errors import BadInput
from laconic.robot.importer.answers import Answers
from laconic.robot.importer.mjcf import read_mjcf
from laconic.robot.importer.robot_tree import Robot
from laconic.robot.importer.sdf import read_sdf
from laconic.robot.importer.urdf import read_urdf, read_xacro
from laconic.robot.importer.xml_file import bytes_of, xml_root

BY_ROOT = {"robot": "urdf", "mujoco": "mjcf", "sdf": "sdf"}
ENDINGS = {".urdf": "urdf", ".xacro": "xacro", ".mjcf": "mjcf", ".sdf": "sdf", ".world": "sdf"}


def read_robot(path: Path, answers: Answers) -> Robot:
    """The tree of the file; BadInput, with the file's name, for one that cannot be used."""
    bytes_of(path)  # refuses what is no file, whoever reads it then
    form = ENDINGS.get(path.suffix.lower()) or _by_content(path)
    if answers.model is not None and form not in ("mjcf", "sdf"):
        raise BadInput(f"--model: {path} is a {form}, which has one robot; leave it out")
    if form == "xacro" or (form == "urdf" and _has_macros(path)):
        return read_xacro(path, answers.xacro_arguments, answers.packages)
    if answers.xacro_arguments:
        raise BadInput(f"--set: {path} is no xacro file, so it takes no arguments; leave it out")
    if form == "urdf":
        return read_urdf(path, answers.packages)
    if form == "mjcf":
        return read_mjcf(path, answers.packages, answers.model)
    return read_sdf(path, answers.packages, answers.model)


def _by_content(path: Path) -> str:
    root = xml_root(path, "is no XML; give a URDF, xacro, MJCF or SDF file")
    if root.tag not in BY_ROOT:
        raise BadInput(f"{path}: begins with <{root.tag}>; a robot begins with <robot> (URDF, xacro), <mujoco> or "
                       "<sdf>")
    return BY_ROOT[root.tag]


def _has_macros(path: Path) -> bool:
    """A URDF by its ending that is a xacro by its content."""
    return b"xacro:" in bytes_of(path)
