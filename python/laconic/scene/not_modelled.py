"""What people write in a scene and the model does not have: each with what to do instead."""

from __future__ import annotations

from collections.abc import Mapping

SUPPORT = ("a swivel caster is a table [[vehicle.caster]]; a ball caster carries a normal load, nothing else: give it "
           "as [[vehicle.support]] with its x_m and y_m, and its mass within vehicle.mass_kg")
STEERED = ("a steered wheel is \"fixed\" with steered = \"coordinated\", \"prescribed\" or \"motor\"; a constant angle "
           "is axle_deg")
TRAILER = "a trailer is a table [[vehicle.trailer]], any other body on a hinge a table [[vehicle.body]]"
DRY = ("hinges have damping_Nms, and no dry friction yet; a servo is a \"prescribed\" hinge that follows "
       "steering_angle_rad within its rate_limit_rad_per_s")
SKID = ("skid steering and tracks turn by slip: give \"fixed\" wheels and [ground] friction_coefficient; or on ideal "
        "ground one \"fixed\" wheel a side, at the track width that measured turns show, see docs/scenes.md")
RADIUS = "vehicle.wheel_radius_m is the radius of all wheels but those that give their own radius_m"
MOTOR = ("[vehicle.motor] is the motor of all wheels but those that give their own motor_gain_Nm_per_V and "
         "motor_damping_Nms, or driven = false; inertia_kgm2 of a wheel is about its axle")
IDLER = "a wheel without a motor is one of the kinds \"omni\", \"mecanum\", \"roller\" or \"fixed\" with driven = false"
LEVEL = "a slope is the ground's: give [ground] slope_rad, or slope_deg"
RIGID = "the vehicle is rigid, without suspension; normal loads are those of its mass at rest and in motion"
SLIP = ("wheels slip on ground with [ground] friction_coefficient, which a wheel's own friction_coefficient overrides; "
        "without it they roll without slip, and [vehicle] friction_coefficient shows where they could not")
FIXED = "a wheel that is neither omni nor mecanum is \"fixed\", driven or not"

OF_WHEELS = {
    "caster castor swivel ball": SUPPORT,
    "idler passive undriven": IDLER,
    "steer ackermann": STEERED,
    "trailer hitch hinge": TRAILER,
    "servo dry_": DRY,
    "skid track crawler": SKID,
    "radius diameter": RADIUS,
    "motor gain damping gear resistance inertia": MOTOR,
    "suspension spring stiffness": RIGID,
    "slip tire tyre friction": SLIP,
}
OF_VEHICLES = OF_WHEELS | {"slope incline pitch tilt gravity": LEVEL}
KINDS_OF_WHEELS = OF_WHEELS | {
    "swedish": "Swedish wheels are \"mecanum\" with roller_deg, or \"omni\"",
    "standard driv conventional normal rubber plain wheel": FIXED,
}


def instead_of(word: str, hints: Mapping[str, str]) -> str | None:
    """What to do about a word with one of these stems; None for any other."""
    low = word.lower()
    return next((hint for stems, hint in hints.items() if any(stem in low for stem in stems.split())), None)
