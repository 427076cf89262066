"""A robot as all formats describe it: links with mass and shape, joints between them, in the frame of the base.

All joints are in their zero position. Vectors are in axes of the base link: x ahead, y to the left, z up (REP 103).

Masses and inertias of links added up, by the parallel axis theorem.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from laconic.errors import BadInput, cut, nearest_of
from laconic.robot.importer.placement import Array, point_of

HINGE, SLIDE, FIXED, BALL = "hinge", "slide", "fixed", "ball"
TURNS_ROUND_RAD = 4.0 * np.pi  # a hinge with a wider range than this counts as one without limits
LONGEST_SHOWN = 60  # of a name in a message
MOST_LINKS = 5000  # ten times the largest robots, with every roller of their wheels a link
ALIGNED = np.cos(np.radians(1.0))  # what is less is rounding in a file, such as 1.57 for a right angle
TILT = np.sin(np.radians(0.2))  # the same of a face on the ground
CORNERS = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T


@dataclass(frozen=True, eq=False)
class Surface:
    """Friction of a shape: along `direction` (unit vector in the frame of the base; None where the file gives none) and
    across it."""

    along: float
    across: float
    direction: Array | None = None


@dataclass(frozen=True)
class Command:
    """What moves a joint, in words; `gear` is how often its motor turns while the joint turns once."""

    what: str
    gear: float | None = None


@dataclass(frozen=True, eq=False)
class Shape:
    """A solid of a link; `placed` is its frame in that of the base.

    `size` is (radius, half length along its z) of a cylinder, (radius,) of a sphere; a mesh or a box has its `points`
    (N × 3, in the frame of the base) instead.
    """

    kind: str
    placed: Array
    size: tuple[float, ...] = ()
    points: Array | None = None
    collides: bool = True
    surface: Surface | None = None

    @classmethod
    def box(cls, placed: Array, half: Array, collides: bool, surface: Surface | None = None) -> Shape:
        """A box with these half lengths of its edges."""
        return cls("box", placed, points=point_of(placed, half * CORNERS), collides=collides, surface=surface)

    def radius_about(self, point: Array, axis: Array) -> float:
        """The largest distance of its surface from a line through `point` along the unit vector `axis`."""
        if self.kind == "sphere":
            return float(_distances(self.placed[None, :3, 3], point, axis)[0] + self.size[0])
        if self.kind == "cylinder" and abs(self.placed[:3, 2] @ axis) > ALIGNED:
            return float(_distances(self.placed[None, :3, 3], point, axis)[0] + self.size[0])
        return float(_distances(self.outline(), point, axis).max())

    def lowest(self) -> Array:
        """Its lowest point, in the middle of those that are equally low but for rounding of its tilt."""
        if self.kind == "sphere":
            return np.asarray(self.placed[:3, 3] - [0.0, 0.0, self.size[0]])
        low = self._low()
        x, y, _ = (low.min(axis=0) + low.max(axis=0)) / 2.0
        return np.array([x, y, low[:, 2].min()])

    def flat_m(self) -> float:
        """The shorter edge of the face that it has on the ground: 0 for one that touches it in a point or a line."""
        return 0.0 if self.kind == "sphere" else float(np.ptp(self._low()[:, :2], axis=0).min())

    def _low(self) -> Array:
        points = self.outline()
        tilt_m = TILT * float(np.ptp(points[:, :2], axis=0).max())
        return np.asarray(points[points[:, 2] <= points[:, 2].min() + 1e-6 + tilt_m])

    def across(self, point: Array, axis: Array) -> Array:
        """N × 2 points of its outline, seen along the unit vector `axis` from `point`; of a sphere that of its largest
        circle."""
        one, other = square_to(axis)
        if self.kind != "sphere":
            return np.asarray((self.outline() - point) @ np.column_stack([one, other]))
        centre = (self.placed[:3, 3] - point) @ np.column_stack([one, other])
        turn = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
        return np.asarray(centre + self.size[0] * np.column_stack([np.cos(turn), np.sin(turn)]))

    def thinnest(self) -> float:
        """Its smallest extent along an axis of its own; of a mesh along an axis of the base."""
        if self.kind == "sphere":
            return 2.0 * self.size[0]
        if self.kind == "cylinder":
            return 2.0 * min(self.size)
        points = self.outline() @ self.placed[:3, :3] if self.kind == "box" else self.outline()
        return float(np.ptp(points, axis=0).min())

    def outline(self) -> Array:
        """Points of its surface: corners, or the rims of a cylinder."""
        if self.points is not None:
            return self.points
        turn = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
        rim = np.column_stack([self.size[0] * np.cos(turn), self.size[0] * np.sin(turn), np.zeros(len(turn))])
        half = np.array([0.0, 0.0, self.size[1] if len(self.size) > 1 else 0.0])
        return np.vstack([rim - half, rim + half]) @ self.placed[:3, :3].T + self.placed[:3, 3]


def square_to(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors that are square to a unit vector and to each other."""
    least = np.eye(3)[int(np.argmin(np.abs(axis)))]
    one = np.cross(axis, least)
    one = one / np.linalg.norm(one)
    return one, np.asarray(np.cross(axis, one))


def _distances(points: Array, point: Array, axis: Array) -> Array:
    off = points - point
    return np.linalg.norm(off - np.outer(off @ axis, axis), axis=1)


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid part: mass, centre of mass, inertia about it (3 × 3, axes of the base), shapes."""

    name: str
    mass_kg: float = 0.0
    com_m: Array = field(default_factory=lambda: np.zeros(3))
    inertia_kgm2: Array = field(default_factory=lambda: np.zeros((3, 3)))
    shapes: tuple[Shape, ...] = ()
    has_inertia: bool = True
    unread: tuple[str, ...] = ()  # meshes that could not be had, and why
    unread_collides: bool = False  # whether one of them collides


@dataclass(frozen=True, eq=False)
class Joint:
    """Joins `child` to `parent`; a hinge turns about `axis` (unit vector) through `point_m`."""

    name: str
    kind: str
    parent: str
    child: str
    point_m: Array
    axis: Array
    is_limited: bool = False
    damping_Nms: float = 0.0
    friction_Nm: float = 0.0  # dry
    range_rad: float = np.inf  # between its limits
    armature_kgm2: float = 0.0  # of what turns with it and is no link, such as a rotor behind its gear
    commands: tuple[Command, ...] = ()
    left_out: tuple[str, ...] = ()  # numbers of the file that no scene has, in words
    low_rad: float = -np.inf  # limits, from the zero position; infinite where it has none
    high_rad: float = np.inf
    speed_limit_rad_per_s: float = np.inf


@dataclass(frozen=True, eq=False)
class Robot:
    """The tree; `remarks` are what its reader wants to be known."""

    name: str
    path: Path
    format: str
    base: str
    links: dict[str, Link]
    joints: dict[str, Joint]
    remarks: tuple[str, ...] = ()

    def check(self) -> Robot:
        """Itself, if it is a tree: each link but the base hangs on one joint."""
        hangs: set[str] = set()
        for joint in self.joints.values():
            for link in (joint.parent, joint.child):
                if link not in self.links:
                    raise BadInput(f"{self.path}: joint {joint.name}: there is no link {link}; name one that is there")
            if joint.child in hangs or joint.child == self.base:
                raise BadInput(f"{self.path}: joint {joint.name}: link {joint.child} already hangs on another joint "
                               "or is the "
                               "base; a robot is a tree")
            hangs.add(joint.child)
        reached = {self.base, *(link.name for joint in self.joints_of.get(self.base, ())
                                for link in self.below(joint, rigid=False))}
        for link in self.links:
            if link != self.base and link not in hangs:
                raise BadInput(f"{self.path}: link {link} is not joined to {self.base}; give it a joint, or take it "
                               "out")
            if link not in reached:
                raise BadInput(f"{self.path}: joint {self.joint_above[link].name} is part of a loop; a robot is a tree")
        return self

    @cached_property
    def joint_above(self) -> dict[str, Joint]:
        """The joint that each link but the base hangs on."""
        return {joint.child: joint for joint in self.joints.values()}

    @cached_property
    def joints_of(self) -> dict[str, list[Joint]]:
        """The joints that hang on each link that has some."""
        found: dict[str, list[Joint]] = {}
        for joint in self.joints.values():
            found.setdefault(joint.parent, []).append(joint)
        return found

    def chain(self, joint: Joint) -> Iterator[Joint]:
        """The joints between `joint` and the base, without itself, from below."""
        while joint.parent != self.base:
            joint = self.joint_above[joint.parent]
            yield joint

    def below(self, joint: Joint, *, rigid: bool) -> list[Link]:
        """The links that move with `joint`; only those fixed to its child where `rigid`."""
        found = [joint.child]
        for name in found:  # which grows meanwhile
            found += [each.child for each in self.joints_of.get(name, ()) if each.kind == FIXED or not rigid]
        return [self.links[name] for name in found]


def check_count(path: Path, count: int) -> None:
    """BadInput for more links than any robot has, before they are read."""
    if count > MOST_LINKS:
        raise BadInput(f"{path}: has {count} links, more than the {MOST_LINKS} that are read; take out those that are "
                       "not the robot's")


def base_of(path: Path, links: Iterable[str], children: Iterable[str]) -> str:
    """The only link that is no joint's child; BadInput where there is none or several."""
    hanging = set(children)
    roots = [name for name in links if name not in hanging]
    if len(roots) != 1:
        names = ", ".join(cut(each) for each in roots[:4])
        raise BadInput(f"{path}: has {len(roots)} links that hang on no joint ({names or 'a loop'}); a robot has one, "
                       "its base")
    return roots[0]


def mimics(path: Path, masters: Mapping[str, str], joints: Mapping[str, Joint]) -> list[str]:
    """What is left out of wheels that one motor turns, by the joint that each joint mimics; BadInput where that is not
    there or is the joint itself, also by way of others."""
    remarks = []
    for name, master in masters.items():
        if master not in joints:
            raise BadInput(f"{path}: joint {name}: mimics joint {master}, which is not there; "
                           f"{nearest_of(master, joints)}")
        chain = [name]
        while (above := masters.get(chain[-1])) is not None and above not in chain:
            chain.append(above)
        if above == name:
            way = f", by way of {', '.join(chain[1:])}" if chain[1:] else ""
            raise BadInput(f"{path}: joint {name}: mimics itself{way}; name another joint, or take the mimic out")
        if joints[name].kind == HINGE and not joints[name].is_limited:
            remarks.append(f"joint {name} mimics {master}, which is not taken over: each wheel turns on its own")
    return remarks


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
