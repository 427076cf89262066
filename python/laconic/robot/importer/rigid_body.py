"""Masses and inertias of links added up, by the parallel axis theorem."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from laconic.robot.importer.placement import Array
from laconic.robot.importer.robot_tree import Link


@dataclass(frozen=True, eq=False)
class RigidBody:
    """A mass, its centre, and the inertia about the centre (3 × 3), in axes of the base."""

    mass_kg: float
    com_m: Array
    inertia_kgm2: Array


def add_up(links: Iterable[Link]) -> RigidBody:
    """All links as one rigid body; its centre is the origin where there is no mass."""
    each = list(links)
    mass = sum(link.mass_kg for link in each)
    if mass <= 0.0:
        return RigidBody(0.0, np.zeros(3), np.zeros((3, 3)))
    com = sum((link.mass_kg * link.com_m for link in each), np.zeros(3)) / mass
    inertia = sum((inertia_about(link, com) for link in each), np.zeros((3, 3)))
    return RigidBody(mass, com, inertia)


def inertia_about(link: Link, point: Array) -> Array:
    """The inertia of a link about another point: I + m (d² 1 − d dᵀ)."""
    off = link.com_m - point
    return np.asarray(link.inertia_kgm2 + link.mass_kg * (off @ off * np.eye(3) - np.outer(off, off)))


def inertia_about_axis(links: Sequence[Link], point: Array, axis: Array) -> float:
    """The moment about a line through `point` along the unit vector `axis`."""
    return float(sum(axis @ inertia_about(link, point) @ axis for link in links))
