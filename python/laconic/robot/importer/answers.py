"""What the user says of a robot because its file cannot: its wheels, their rollers, radii, inertias, and the grip."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from laconic.errors import BadInput
from laconic.robot.importer.checked import finite

Value = TypeVar("Value")
ROLLERS = ("none", "omni", "mecanum")


@dataclass(frozen=True)
class Answers:
    """Options of `laconic import`; a key "" means every wheel."""

    wheels: tuple[str, ...] = ()
    rollers: Mapping[str, str | float] = field(default_factory=dict)
    radius_m: Mapping[str, float] = field(default_factory=dict)
    inertia_kgm2: Mapping[str, float] = field(default_factory=dict)
    friction_coefficient: float | None = None
    model: str | None = None
    xacro_arguments: Mapping[str, str] = field(default_factory=dict)
    packages: Mapping[str, Path] = field(default_factory=dict)
    hinges: bool | None = None  # None: unless wheels are named

    @property
    def with_hinges(self) -> bool:
        """Whether steered wheels, casters and trailers turn on hinges, and are not held or replaced."""
        return not self.wheels if self.hinges is None else self.hinges

    def check(self, joints: Sequence[str]) -> None:
        """BadInput for an answer about a joint that is no wheel."""
        for option, given in (("--rollers", self.rollers), ("--radius", self.radius_m),
                              ("--wheel-inertia", self.inertia_kgm2)):
            for name in given:
                if name and name not in joints:
                    raise BadInput(f"{option} {name}=…: is no wheel; wheels are {', '.join(joints)}, --wheel JOINT "
                                   "adds one")


def answer(given: Mapping[str, Value], joint: str) -> Value | None:
    """For this joint, or for all."""
    return given.get(joint, given.get(""))


def by_joint(option: str, texts: Sequence[str], read: Callable[[str, str], Value]) -> dict[str, Value]:
    """`VALUE` or `JOINT=VALUE`, each once; `read(where, text)` makes the value."""
    found: dict[str, Value] = {}
    for text in texts:
        joint, _, value = text.rpartition("=")
        if joint in found:
            raise BadInput(f"{option} {text}: is given twice; give it once for all wheels, or once for each joint")
        found[joint] = read(f"{option} {text}", value)
    return found


def positive(where: str, text: str) -> float:
    """A number above 0."""
    value = finite(where, [text], 1)[0]
    if not value > 0.0:
        raise BadInput(f"{where}: must be above 0")
    return value


def rollers(where: str, text: str) -> str | float:
    """`none`, `omni`, `mecanum`, or an angle in degrees."""
    if text in ROLLERS:
        return text
    try:
        return finite(where, [text], 1)[0]
    except BadInput:
        raise BadInput(f"{where}: give {', '.join(ROLLERS)}, or the angle of the rollers to the axle in "
                       "degrees") from None
