"""Friction that a simulator's file gives to surfaces: a direction without friction across it is that of rollers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from laconic.robot.importer.checked import read_number, read_numbers
from laconic.robot.importer.placement import Array
from laconic.robot.importer.robot_tree import Surface
from laconic.robot.importer.xml_file import Element

USUAL = 1.0  # where a file gives one of two
SLIPPERY = 0.05  # of the other coefficient, or as a coefficient: as good as no friction
FRAME = "expressed_in"


def surface_of(parent: Element | None, names: tuple[str, str], turned: Callable[[str | None], Array | None]
               ) -> Surface | None:
    """Of an element with these coefficients and <fdir1>; None where it has none. `turned`: the axes of a frame by its
    name, None for the shape's own."""
    if parent is None:
        return None
    along, across = (read_number(_text(parent, name)) for name in names)
    if along is None and across is None:
        return None
    direction = _direction(parent.find("fdir1"), turned)
    return Surface(USUAL if along is None else along, USUAL if across is None else across, direction)


def _text(parent: Element, name: str) -> Any:
    element = parent.find(name)
    return None if element is None else element.get("value") or element.text


def _direction(element: Element | None, turned: Callable[[str | None], Array | None]) -> Array | None:
    if element is None:
        return None
    xyz = read_numbers(element.get("value") or element.text, 3)
    frame = next((value for key, value in element.attrib.items() if key.endswith(FRAME)), None)
    axes = turned(frame)
    if xyz is None or axes is None or not (size := float(np.linalg.norm(xyz))) > 0.0:
        return None
    return np.asarray(axes @ (np.array(xyz) / size))


def is_frictionless(surface: Surface) -> bool:
    """Whether it slides in every direction."""
    return max(surface.along, surface.across) <= SLIPPERY


def grips_along(surface: Surface) -> bool | None:
    """Whether friction acts along its direction alone, as that of rollers does: True along it, False across it, None
    where it acts both ways."""
    if is_frictionless(surface):
        return None
    if surface.across <= SLIPPERY * surface.along:
        return True
    return False if surface.along <= SLIPPERY * surface.across else None
