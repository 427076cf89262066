"""Makes the scene of an FRC robot from what its team knows: modules, gearing, motors, mass, bumpers.

Motors have the names and the published data of WPILib's DCMotor: torque and current at stall, current and speed without
load, at 12 V. What nobody measured is an assumption: the scene and `New.assumed` state it.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from laconic.errors import BadInput, nearest_of

KINDS = ("swerve", "mecanum", "differential")
INCH_M, POUND_KG = 0.0254, 0.45359237
SUPPLY_V = 12.0
WHEEL_KG = 0.4                   # of one wheel, as an even disc
ROTOR_KGM2 = 4e-5                # of one motor
COM_Z_M = 0.2
FRICTION = 1.1                   # tread on carpet
MOST_KG, MOST_M = 100.0, 3.0     # the rules allow about 72 kg with bumpers and battery, and less than 2 m
MOST_RADIUS_M = 0.3


@dataclass(frozen=True)
class Motor:
    """One motor at 12 V."""

    name: str
    stall_Nm: float      # noqa: N815
    stall_A: float       # noqa: N815
    free_A: float        # noqa: N815
    free_rpm: float

    @property
    def resistance_ohm(self) -> float:
        """Of the winding."""
        return SUPPLY_V / self.stall_A

    @property
    def torque_constant_Nm_per_A(self) -> float:  # noqa: N802
        """Kt."""
        return self.stall_Nm / self.stall_A

    @property
    def free_rad_per_s(self) -> float:
        """Speed without load."""
        return self.free_rpm * math.pi / 30.0

    @property
    def back_emf_Vs_per_rad(self) -> float:  # noqa: N802
        """1/Kv."""
        return (SUPPLY_V - self.resistance_ohm * self.free_A) / self.free_rad_per_s

    @property
    def viscous_friction_Nms(self) -> float:  # noqa: N802
        """What holds the current without load."""
        return self.free_A * self.torque_constant_Nm_per_A / self.free_rad_per_s


MOTORS = {each.name: each for each in (
    Motor("CIM", 2.42, 133.0, 2.7, 5310.0), Motor("miniCIM", 1.41, 89.0, 3.0, 5840.0),
    Motor("bag", 0.43, 53.0, 1.8, 13180.0), Motor("vex775Pro", 0.71, 134.0, 0.7, 18730.0),
    Motor("RS775_125", 0.28, 18.0, 1.6, 5800.0), Motor("banebotsRS775", 0.72, 97.0, 2.7, 13050.0),
    Motor("andymark9015", 0.36, 71.0, 3.7, 14270.0), Motor("banebotsRS550", 0.38, 84.0, 0.4, 19000.0),
    Motor("NEO", 2.6, 105.0, 1.8, 5676.0), Motor("NEO550", 0.97, 100.0, 1.4, 11000.0),
    Motor("neoVortex", 3.6, 211.0, 3.615, 6784.0), Motor("falcon500", 4.69, 257.0, 1.5, 6380.0),
    Motor("falcon500FOC", 5.84, 304.0, 1.5, 6080.0), Motor("krakenX60", 7.09, 366.0, 2.0, 6000.0),
    Motor("krakenX60FOC", 9.37, 483.0, 2.0, 5800.0), Motor("krakenX44", 4.11, 279.0, 2.0, 7758.0),
    Motor("krakenX44FOC", 5.01, 329.0, 2.0, 7368.0), Motor("minion", 3.17, 211.0, 2.0, 7704.0))}
"""WPILib's DCMotor, by its names."""


@dataclass(frozen=True)
class Module:
    """A swerve module."""

    drive: Mapping[str, float]   # gearings of its variants
    steering: float
    radius_m: float
    inertia_kgm2: float          # about the steering axis, of all that turns


MODULES = {
    "mk4": Module({"l1": 8.14, "l2": 6.75, "l3": 6.12, "l4": 5.14}, 12.8, 2 * INCH_M, 0.03),
    "mk4i": Module({"l1": 8.14, "l2": 6.75, "l3": 6.12}, 150 / 7, 2 * INCH_M, 0.03),
    "mk4n": Module({"l1": 7.13, "l2": 5.9, "l3": 5.36}, 18.75, 2 * INCH_M, 0.03),
    "maxswerve": Module({"low": 5.5, "medium": 5.08, "high": 4.71}, 9424 / 203, 1.5 * INCH_M, 0.02),
    "swervex": Module({"x1-10t": 7.85, "x1-11t": 7.13, "x1-12t": 6.54, "x2-10t": 6.56, "x2-11t": 5.96, "x2-12t": 5.46,
                       "x3-12t": 5.14, "x3-13t": 4.75, "x3-14t": 4.41}, 11.3142, 2 * INCH_M, 0.03),
    "thrifty": Module({"1": 6.75, "2": 6.23, "3": 5.79}, 25.0, 2 * INCH_M, 0.03)}
"""Gearings by their makers, and steering inertias, as maple-sim lists them."""


@dataclass(frozen=True)
class Robot:
    """What a team knows. None: not given."""

    kind: str
    mass_kg: float
    bumpers_m: tuple[float, float]            # outer length and width
    track_m: float                            # between left and right wheels
    wheelbase_m: float | None = None          # between front and rear wheels; as the track
    motor: str = "krakenX60"
    motors: int = 1                           # on one gearbox: a module, or one wheel; differential: one side
    gearing: float | None = None
    wheel_radius_m: float | None = None
    module: str | None = None                 # swerve: name and variant, such as mk4i-l2
    steering_motor: str | None = None         # as the driving motor
    steering_gearing: float | None = None
    wheels: int = 2                           # differential: 2, 4 or 6
    friction: float | None = None             # of the ground; swerve: 1.1
    is_ideal: bool = False                    # swerve on ground without friction
    current_limit_A: float | None = None      # noqa: N815  of one motor
    name: str | None = None


@dataclass
class New:
    """The text of a scene, and what it assumes."""

    text: str
    assumed: list[str] = field(default_factory=list)


def motor_of(name: str, option: str = "motor") -> Motor:
    """A motor by WPILib's name, in any spelling: "Kraken X60", "kraken_x60", "krakenX60"."""
    by_letters = {letters(each): each for each in MOTORS} | {"kraken": "krakenX60", "falcon": "falcon500",
                                                            "vortex": "neoVortex", "775pro": "vex775Pro"}
    if (found := by_letters.get(letters(name))) is None:
        raise BadInput(f'{option}: there is no motor "{name}"; {nearest_of(name, MOTORS)}')
    return MOTORS[found]


def letters(name: str) -> str:
    """A name without what spellings differ in."""
    return re.sub(r"[\W_]", "", name).lower()


def module_of(name: str) -> tuple[Module, float, str]:
    """A module by name and variant, its gearing, and its name in full."""
    given = name.lower().replace("_", "-").replace(" ", "-")
    stem = max((each for each in MODULES if given.startswith(each)), key=len, default="")
    if not stem:
        raise BadInput(f'module: there is no module "{name}"; known are {", ".join(MODULES)}, or give gearing, '
                       "steering gearing and wheel radius instead")
    module = MODULES[stem]
    variant = given[len(stem):].strip("-")
    if variant not in module.drive:
        raise BadInput(f'module: {stem} has no variant "{variant}"; give one of '
                       f'{", ".join(f"{stem}-{each}" for each in module.drive)}')
    return module, module.drive[variant], f"{stem}-{variant}"


def quantity(option: str, text: str, units: Mapping[str, float], example: str) -> float:
    """A number above 0 with a unit or in SI."""
    match = re.fullmatch(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*([a-zA-Z\"]*)\s*", text)
    try:
        value = float(match[1]) * units[match[2].lower()] if match else math.nan
    except (ValueError, KeyError):
        value = math.nan
    if not 0.0 < value < math.inf:
        raise BadInput(f"{option} {text}: is not a number above 0 with a unit; give it as {example}")
    return value


LENGTHS = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001, "in": INCH_M, '"': INCH_M}
MASSES = {"": 1.0, "kg": 1.0, "lb": POUND_KG, "lbs": POUND_KG}


def length(option: str, text: str) -> float:
    """Metres, from 0.0508, 2in, 50.8mm."""
    return quantity(option, text, LENGTHS, "0.1 (metres) or 4in")


def mass(option: str, text: str) -> float:
    """Kilograms, from 52, 115lb."""
    return quantity(option, text, MASSES, "52 (kilograms) or 115lb")


def box(option: str, text: str) -> tuple[float, float]:
    """Length and width, from 0.85x0.8 or 33inx32in."""
    parts = re.split(r"\s*[xX×]\s*", text)
    if len(parts) != 2:
        raise BadInput(f"{option} {text}: is not length and width; give them as 0.85x0.8 or 33inx32in")
    return length(option, parts[0]), length(option, parts[1])


def new_scene(robot: Robot) -> New:
    """The scene of a robot, with devices on the usual ports."""
    return {"swerve": _swerve, "mecanum": _mecanum, "differential": _differential}[robot.kind](_checked(robot))


def _checked(robot: Robot) -> Robot:
    if robot.kind not in KINDS:
        raise BadInput(f"kind: {robot.kind} is not a drive; give one of {', '.join(KINDS)}")
    _check_units(robot)
    longest, widest = robot.bumpers_m
    for option, value, most in (("track", robot.track_m, widest), ("wheelbase", robot.wheelbase_m, longest)):
        if value is not None and value >= most:
            raise BadInput(f"{option}: {value:g} m is wider than the bumpers, {most:g} m; give the distance between "
                           "wheels, or the outer size of the bumpers")
    swerve = robot.kind == "swerve"
    for option, given in (("module", robot.module), ("steering motor", robot.steering_motor),
                          ("steering gearing", robot.steering_gearing), ("ideal", robot.is_ideal or None)):
        if given is not None and not swerve:
            raise BadInput(f"{option}: has no effect on a {robot.kind} drive; leave it out")
    if robot.module and robot.gearing:
        raise BadInput("gearing: the module has one; leave module or gearing out")
    if not robot.module and (robot.gearing is None or robot.wheel_radius_m is None
                             or swerve and robot.steering_gearing is None):
        missing = [name for name, given in (
            ("gearing", robot.gearing), ("wheel radius", robot.wheel_radius_m),
            ("steering gearing", robot.steering_gearing if swerve else 1.0)) if given is None]
        raise BadInput(f"{missing[0]}: is missing; give it" + (", or a module such as mk4i-l2" if swerve else ""))
    if robot.is_ideal and robot.friction is not None:
        raise BadInput("friction: ideal ground has none; leave ideal or friction out")
    if robot.wheels not in (2, 4, 6) or robot.wheels != 2 and robot.kind != "differential":
        raise BadInput(f"wheels: {robot.wheels} is not possible for a {robot.kind} drive; leave it out, or give 2, 4 "
                       "or 6 wheels of a differential drive")
    if robot.wheels > 2 and robot.friction is None:
        raise BadInput(f"wheels: {robot.wheels} wheels of a differential drive slip sideways when it turns; give the "
                       "friction of the ground, such as 1.1")
    if robot.name is not None and not robot.name.isprintable():
        raise BadInput("name: holds a character that cannot be printed; give plain text")
    if robot.motors < 1:
        raise BadInput(f"motors: {robot.motors} is not a number of motors; give 1 or more")
    return robot


def _check_units(robot: Robot) -> None:
    """BadInput for a number above 0 that fits no robot, but does in inches or pounds."""
    for option, value, most, unit, example in (
            ("mass", robot.mass_kg, MOST_KG, "kg", "115lb"),
            ("bumpers", max(robot.bumpers_m), MOST_M, "m", "33inx32in"),
            ("track", robot.track_m, MOST_M, "m", "20.5in"),
            ("wheelbase", robot.wheelbase_m, MOST_M, "m", "20.5in"),
            ("wheel radius", robot.wheel_radius_m, MOST_RADIUS_M, "m", "2in")):
        if value is not None and not 0.0 < value <= most:
            raise BadInput(f"{option}: {value:g} {unit} is not of an FRC robot, which has at most {most:g} {unit}; "
                           f"give another unit, such as {example}, or correct the number")
    for option, value in (("gearing", robot.gearing), ("steering gearing", robot.steering_gearing),
                          ("friction", robot.friction), ("current limit", robot.current_limit_A)):
        if value is not None and not 0.0 < value < math.inf:
            raise BadInput(f"{option}: {value:g} is not usable; give a number above 0")


def entry(key: str, value: object, note: str = "") -> str:
    """A line of a scene."""
    left = f"{key} = {value:.8g}" if isinstance(value, int | float) else f"{key} = {value}"
    return f"{left:38}# {note}" if note else left


def _head(robot: Robot, title: str) -> list[str]:
    longest, widest = robot.bumpers_m
    return [f"# {title}", f"# {robot.mass_kg:.4g} kg, bumpers {longest:.4g} m × {widest:.4g} m. Made by laconic frc "
            "--new; change what you know better.", f"name = {json.dumps(robot.name or title, ensure_ascii=False)}", ""]


def _yaw_inertia(robot: Robot, assumed: list[str], of_modules: float = 0.0) -> float:
    """Of the block less that of its swerve modules, which turn by themselves; the value that the scene gets."""
    longest, widest = robot.bumpers_m
    found = float(f"{robot.mass_kg * (longest**2 + widest**2) / 12.0 - of_modules:.4g}")
    assumed.append(f"yaw inertia {found:g} kg m²: an even block as large as the bumpers, {longest:.3g} m × "
                   f"{widest:.3g} m, of {robot.mass_kg:.4g} kg"
                   + (f", less {of_modules:g} kg m² of the modules" if of_modules else ""))
    return found


def _vehicle(robot: Robot, yaw: float, radius: float, assumed: list[str], friction: float | None) -> list[str]:
    wheel = float(f"{0.5 * WHEEL_KG * radius**2:.3g}")
    assumed += [f"inertia of a wheel {wheel:g} kg m²: an even disc of {WHEEL_KG:g} kg",
                f"inertia of a motor's rotor {ROTOR_KGM2:g} kg m²"]
    block = "assumption: an even block as large as the bumpers"
    lines = ["[vehicle]", entry("mass_kg", robot.mass_kg, "with bumpers and battery"),
             entry("yaw_inertia_kgm2", yaw, block + (", less the modules" if robot.kind == "swerve" else "")),
             entry("wheel_radius_m", radius),
             entry("wheel_inertia_kgm2", wheel, f"assumption: an even disc of {WHEEL_KG:g} kg")]
    if friction is not None:
        assumed.append(f"centre of mass {COM_Z_M:g} m above the ground, in the middle")
        lines.append(entry("com_z_m", COM_Z_M, "assumption"))
    return lines


def _motor(motor: Motor, count: float, gearing: float, table: str) -> list[str]:
    """A table of `count` motors on one gearbox; a part of a motor where several wheels share it."""
    return [table, entry("resistance_ohm", motor.resistance_ohm / count,
                         f"{count:.3g} × {motor.name}, by its published data"),
            entry("torque_constant_Nm_per_A", motor.torque_constant_Nm_per_A),
            entry("back_emf_Vs_per_rad", motor.back_emf_Vs_per_rad),
            entry("gear_ratio", gearing),
            entry("viscous_friction_Nms", float(f"{motor.viscous_friction_Nms * count:.4g}"), "current without load"),
            entry("rotor_inertia_kgm2", float(f"{ROTOR_KGM2 * count:.4g}"), "assumption")]


def _texts(kind: str, numbers: Sequence[int], reversed_from: int | None = None) -> str:
    each = [f'"{"-" if reversed_from is not None and at >= reversed_from else ""}{kind}[{number}]"'
            for at, number in enumerate(numbers)]
    return f"[{', '.join(each)}]"


def _wheel(kind: str, x: float, y: float, *more: str) -> list[str]:
    return ["", "[[vehicle.wheel]]", f'kind = "{kind}"', entry("x_m", x), entry("y_m", y), *more]


def _frc(robot: Robot, count: float, drive: str, encoders: str, *steering: str) -> list[str]:
    lines = ["", f"{'[frc]':38}# devices of the robot program",
             "# A - before a name: this output turns its wheel backwards.", entry("drive", drive),
             entry("drive_encoder", encoders), entry("drive_counts", 2048, "in a turn of the wheel"), *steering,
             entry("gyro", '"ADXRS450[0]"'), entry("battery_V", "12.0", "without load"),
             entry("battery_resistance_ohm", 0.02, "as WPILib's BatterySim has it")]
    if robot.current_limit_A:
        lines.append(entry("current_limit_A", robot.current_limit_A * count, "of all motors of a wheel"))
    return lines


def _end(robot: Robot, friction: float | None, assumed: list[str], step_s: float) -> list[str]:
    """Ground and run."""
    lines = []
    if friction is not None:
        if robot.friction is None:
            assumed.append(f"friction coefficient of tread on carpet {friction:g}")
        note = "assumption: tread on carpet" if robot.friction is None else ""
        lines = ["", "[ground]", entry("friction_coefficient", friction, note)]
    return [*lines, "", "[run]", entry("duration_s", "15.0", "of laconic simulate"), entry("step_s", step_s), ""]


def _swerve(robot: Robot) -> New:
    assumed: list[str] = []
    module, gearing, title = module_of(robot.module) if robot.module else (None, robot.gearing or 0.0, "own modules")
    steering_gearing = robot.steering_gearing or (module.steering if module else 0.0)
    radius = robot.wheel_radius_m or (module.radius_m if module else 0.0)
    inertia = module.inertia_kgm2 if module else 0.03
    motor, turner = motor_of(robot.motor), motor_of(robot.steering_motor or robot.motor, "steering motor")
    friction = None if robot.is_ideal else robot.friction or FRICTION
    yaw = _yaw_inertia(robot, assumed, 4 * inertia)
    if yaw <= 0.0:
        raise BadInput("bumpers: a block of this size and mass has less yaw inertia than its four modules; correct "
                       "mass and bumpers")
    assumed.append(f"inertia of a module about its steering axis {inertia:g} kg m²")
    lines = [*_head(robot, f"FRC swerve robot: {title}, {motor.name}, steered by {turner.name}"),
             *_vehicle(robot, yaw, radius, assumed, friction), "",
             *_motor(motor, robot.motors, gearing, "[vehicle.motor]")]
    half_x, half_y = 0.5 * (robot.wheelbase_m or robot.track_m), 0.5 * robot.track_m
    for name, x, y in (("front_left", half_x, half_y), ("front_right", half_x, -half_y),
                       ("rear_left", -half_x, half_y), ("rear_right", -half_x, -half_y)):
        steered = "coordinated" if friction is None else "motor"
        lines += _wheel("fixed", x, y, f'steered = "{steered}"', f'name = "{name}"',
                        entry("yaw_inertia_kgm2", inertia, "assumption: of what turns about the steering axis"))
        if friction is not None:
            lines += _motor(turner, 1, steering_gearing, "[vehicle.wheel.steering_motor]")
        else:
            lines.append(entry("rate_limit_rad_per_s", turner.free_rad_per_s / steering_gearing,
                               f"{turner.name} at 12 V, {steering_gearing:.4g}:1"))
    lines += _frc(robot, robot.motors, _texts("PWM", range(4)), _texts("Encoder", range(0, 8, 2)),
                  entry("steering", _texts("PWM", range(4, 8))),
                  entry("steering_encoder", _texts("DutyCycleEncoder", range(8, 12))))
    return New("\n".join(lines + _end(robot, friction, assumed, 0.01 if friction is None else 0.002)), assumed)


def _mecanum(robot: Robot) -> New:
    assumed: list[str] = []
    motor = motor_of(robot.motor)
    lines = [*_head(robot, f"FRC mecanum robot, {motor.name}"), "# Wheels: front left, rear left, front right, rear "
             "right. The program inverts the right motors.",
             *_vehicle(robot, _yaw_inertia(robot, assumed), robot.wheel_radius_m or 0.0, assumed, robot.friction), "",
             *_motor(motor, robot.motors, robot.gearing or 0.0, "[vehicle.motor]")]
    half_x, half_y = 0.5 * (robot.wheelbase_m or robot.track_m), 0.5 * robot.track_m
    for x, y, roller in ((half_x, half_y, 45), (-half_x, half_y, -45), (half_x, -half_y, -45), (-half_x, -half_y, 45)):
        lines += _wheel("mecanum", x, y, "axle_deg = -90", f"roller_deg = {roller}")
    lines += _frc(robot, robot.motors, _texts("PWM", range(4), 2), _texts("Encoder", range(0, 8, 2)))
    return New("\n".join(lines + _end(robot, robot.friction, assumed, 0.005)), assumed)


def _differential(robot: Robot) -> New:
    assumed: list[str] = []
    motor, per_side = motor_of(robot.motor), robot.wheels // 2
    lines = [*_head(robot, f"FRC differential drive, {robot.motors} × {motor.name} a side"),
             "# Wheels: left, then right. The program inverts the right motors.",
             *_vehicle(robot, _yaw_inertia(robot, assumed), robot.wheel_radius_m or 0.0, assumed, robot.friction), "",
             *_motor(motor, robot.motors / per_side, robot.gearing or 0.0, "[vehicle.motor]")]
    base = robot.wheelbase_m or robot.track_m
    places = [0.0] if per_side == 1 else [base * (0.5 - at / (per_side - 1)) for at in range(per_side)]
    for side in (0.5, -0.5):
        for x in places:
            lines += _wheel("fixed", x, side * robot.track_m, "axle_deg = -90")
    if per_side == 1 and robot.friction is not None:
        for x in (0.5 * base, -0.5 * base):
            lines += ["", "[[vehicle.support]]", entry("x_m", x, "slides, so that the robot does not tip"), "y_m = 0.0"]
    sides = [0] * per_side + [1] * per_side
    lines += _frc(robot, robot.motors / per_side, _texts("PWM", sides, per_side),
                  _texts("Encoder", [2 * side for side in sides]))
    return New("\n".join(lines + _end(robot, robot.friction, assumed, 0.005)), assumed)
