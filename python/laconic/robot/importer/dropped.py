"""What a file tells of its wheels and a scene does not take: gears, limits, friction of surfaces; and who drives."""

from __future__ import annotations

from collections.abc import Iterable

from laconic.robot.importer.answers import Answers
from laconic.robot.importer.gravity import listed
from laconic.robot.importer.robot_tree import Joint
from laconic.robot.importer.surfaces import grips_along
from laconic.robot.importer.wheels import FoundWheel, Ground


def idle_of(ground: Ground) -> list[Joint]:
    """The wheels that the file does not drive, though it drives others."""
    if not any(wheel.joint.commands for wheel in (*ground.wheels, *ground.casters)):
        return []
    return [wheel.joint for wheel in ground.wheels if not wheel.joint.commands]


def drives_elsewhere(ground: Ground) -> list[str]:
    """The driven wheels that are not modelled as wheels."""
    return [wheel.name for wheel in ground.casters if wheel.joint.commands]


def dropped_of(ground: Ground, answers: Answers) -> list[str]:
    """A line for each kind."""
    wheels = ground.wheels
    told = [*_armatures(wheels), *_gears((*wheels, *ground.casters)), *_limits(wheels)]
    if answers.friction_coefficient is None:
        told += _surfaces(wheels)
    if (idle := idle_of(ground)) and (drives := drives_elsewhere(ground)):
        told.append(f"{' and '.join(drives)} drives the robot and is not modelled as a wheel, as it is steered or "
                    "slides: a support carries its load, its steering is held straight, and a force on the body takes "
                    f"the place of its drive; {listed([each.name for each in idle])} only roll")
    return told


def _armatures(wheels: Iterable[FoundWheel]) -> list[str]:
    each = [f"{wheel.name} {wheel.joint.armature_kgm2:g} kg·m²" for wheel in wheels if wheel.joint.armature_kgm2]
    return [f"armature of joints counts as inertia of the wheels: {', '.join(each)}"] if each else []


def _gears(wheels: Iterable[FoundWheel]) -> list[str]:
    each = [f"{wheel.name} {command.gear:g} ({command.what})" for wheel in wheels for command in wheel.joint.commands
            if command.gear]
    return [f"gear ratios are left out: {', '.join(each)}; the inputs are torques at the axles, and [vehicle.motor] "
            "takes gear_ratio"] if each else []


def _limits(wheels: Iterable[FoundWheel]) -> list[str]:
    by_words: dict[str, list[str]] = {}
    for wheel in wheels:
        if wheel.joint.left_out:
            by_words.setdefault(" and ".join(wheel.joint.left_out), []).append(wheel.name)
    each = [f"{words} ({listed(names)})" for words, names in by_words.items()]
    return [f"left out of joints: {'; '.join(each)}"] if each else []


def _surfaces(wheels: Iterable[FoundWheel]) -> list[str]:
    by_value: dict[float, list[str]] = {}
    for wheel in wheels:
        if wheel.surface and grips_along(wheel.surface) is None:
            by_value.setdefault(max(wheel.surface.along, wheel.surface.across), []).append(wheel.name)
    each = [f"{value:g} ({listed(names)})" for value, names in by_value.items()]
    return [f"friction of surfaces is left out: {'; '.join(each)}; --friction MU takes one for the ground"
            ] if each else []
