"""Numbers of a file that no robot has: they are counted as they are given, and told."""

from __future__ import annotations

import numpy as np

from laconic.robot.importer.answers import Answers, answer
from laconic.robot.importer.axle_lines import lines_of
from laconic.robot.importer.robot_tree import Link, RigidBody, Robot
from laconic.robot.importer.wheels import Ground
from laconic.scene.axle_lines import grouped

THIN = 1e-3        # more than a flat body's largest moment: rounding in a file
NOTHING = 1e-6     # of the largest moment: what is less is 0
UNEQUAL = 5e-3     # of a radius: more than rounding in a file
AIR_KG_PER_M3 = 1.2
FAR = 10.0         # times the way to the farthest wheel's rim, beyond which no robot has its mass
COUNTED = "counted as it is given"


def doubts_of(robot: Robot, ground: Ground, whole: RigidBody, answers: Answers) -> list[str]:
    """A line for each number, or pair of them, that no robot has."""
    return [*moments_of_no_body(robot), *radii_of_one_axle(ground, answers), *inertias_of_no_wheel(ground, answers),
            *lighter_than_air(ground, whole), *farther_than_the_robot(ground, whole)]


def moments_of_no_body(robot: Robot) -> list[str]:
    """A principal moment is ∫ (b² + c²) dm, so it is neither below 0 nor above the sum of the other two."""
    found = []
    for link in robot.links.values():
        least, middle, most = np.linalg.eigvalsh(link.inertia_kgm2)
        if least < -1e-9 * abs(most):
            found.append(f"link {link.name} has a principal moment of {least:.3g} kg·m², which no body has; it is "
                         f"{COUNTED}")
        elif link.mass_kg > 0.0 and least < NOTHING * most:
            found.append(f"link {link.name} has a principal moment of {max(least, 0.0):.3g} kg·m² next to {most:.3g} "
                         f"kg·m², as only a line has ({_zeros(link)}); it is {COUNTED}; correct it in the file")
        elif most > (1.0 + THIN) * (least + middle):
            found.append(f"link {link.name} has a principal moment of {most:.3g} kg·m², more than its other two "
                         f"together, which no body has; it is {COUNTED}")
    return found


def _zeros(link: Link) -> str:
    """Which of its moments the file leaves 0."""
    names = [name for name, value in zip(("ixx", "iyy", "izz"), np.diag(link.inertia_kgm2), strict=True)
             if abs(value) < NOTHING * float(np.abs(link.inertia_kgm2).max())]
    return f"{', '.join(names)} = 0" if names else "about an axis between the file's own"


def radii_of_one_axle(ground: Ground, answers: Answers) -> list[str]:
    """Two wheels of one axle that differ in size: a robot so made leans, and drives circles when they turn alike."""
    found = []
    for group, _ in grouped(lines_of(ground.wheels)):
        wheels = [ground.wheels[index] for index in group]
        plain = [wheel for wheel in wheels if answer(answers.radius_m, wheel.name) is None]
        least, most = (pick(wheels, key=lambda wheel: wheel.radius_m) for pick in (min, max))
        if len(wheels) > 1 and plain and most.radius_m > (1.0 + UNEQUAL) * least.radius_m:
            found.append(f"wheels {least.name} and {most.name} are on one axle, and their radii are "
                         f"{least.radius_m:.4g} m and {most.radius_m:.4g} m; if they are equal, --radius "
                         f"{most.name}=METRES says so")
    return found


def inertias_of_no_wheel(ground: Ground, answers: Answers) -> list[str]:
    """All of a wheel's mass lies within its radius, so its moment about the axle is m r² at most."""
    found = []
    for wheel in ground.wheels:
        own, most = wheel.inertia_kgm2 - wheel.joint.armature_kgm2, wheel.mass_kg * wheel.radius_m**2
        if answer(answers.inertia_kgm2, wheel.name) is None and own > (1.0 + THIN) * most:
            found.append(f"wheel {wheel.name} has an inertia of {own:.3g} kg·m² about its axle, more than m r² = "
                         f"{most:.3g} kg·m² of {wheel.mass_kg:.3g} kg within a radius of {wheel.radius_m:.3g} m, which "
                         f"no wheel has; it is {COUNTED}; --wheel-inertia {wheel.name}=KGM2 says another")
    return found


def lighter_than_air(ground: Ground, whole: RigidBody) -> list[str]:
    """Lengths in millimetres beside a mass in kg: then the air in a wheel's place weighs more than the robot."""
    radius_m = max(wheel.radius_m for wheel in ground.wheels)
    if whole.mass_kg > AIR_KG_PER_M3 * radius_m**3:
        return []
    return [f"a wheel's radius is {radius_m:.3g} m, and the whole robot has {whole.mass_kg:.3g} kg, less than so much "
            "air; if the file is in millimetres, give it in metres"]


def farther_than_the_robot(ground: Ground, whole: RigidBody) -> list[str]:
    """An inertia in kg·mm² or in other units: then its mass would lie far outside of what stands on the wheels."""
    reach_m = max(float(np.linalg.norm(wheel.hub_m - whole.com_m)) + wheel.radius_m for wheel in ground.wheels)
    gyration_m = float(np.sqrt(max(whole.inertia_kgm2[2, 2], 0.0) / whole.mass_kg))
    if gyration_m <= FAR * reach_m:
        return []
    return [f"the yaw inertia of all links is {whole.inertia_kgm2[2, 2]:.3g} kg·m², as of their mass at "
            f"{gyration_m:.3g} m, and the wheels lie within {reach_m:.3g} m; if an inertia is not in kg·m², correct it"]
