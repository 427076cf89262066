"""What the core does not know of a scene's keys: kind, rule, default and words of each, beside the check by its rule.

Reading and the scene reference (laconic.scene.reference) take both from here. A key that is a field of the core has
kind, rule and need there and its words in modelDescription.xml; of it stands here only what a file has otherwise.
`[#]` is one of several tables.

The one thing that the core does not know of a scene file: which angles it gives in degrees. Tables and keys are the
core's own (laconic_field_path).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

from laconic.core.fields import ABOVE_0
from laconic.errors import Refused
from laconic.scene.table import NO_HINTS, REQUIRED, Table


@dataclass(frozen=True)
class Rule:
    """What a number must satisfy; `words` go on after "give", `range` stands in the reference."""

    words: str
    range: str
    holds: Callable[[float], bool]


POSITIVE = Rule("a value above 0", "above 0", lambda value: value > 0.0)
FRICTION = Rule("a value above 0 (1e-6 is ice)", "above 0", lambda value: value > 0.0)
NOT_NEGATIVE = Rule("a value of 0 or more", "0 or more", lambda value: value >= 0.0)
SECONDS = Rule("seconds, 0 for none", "0 or more", lambda value: value >= 0.0)
SWINGS = Rule("another value, or take this input out, which would do nothing", "not 0", lambda value: value != 0.0)
NOT_ZERO = Rule("another value, below 0 for a shaft that turns the other way", "not 0", lambda value: value != 0.0)


@dataclass(frozen=True)
class Key:
    """One key; empty words are those of the core's field."""

    path: str
    kind: str = ""              # what its value is
    meaning: str = ""
    default: Any = REQUIRED     # its value where it is left out; None: `usual` tells what holds then
    usual: str = ""
    rule: Rule | None = None
    range: str = ""             # in words, where no rule has it
    choices: Mapping[str, str] | None = None  # words that it may be, and what each means

    def check(self, table: Table, value: float) -> None:
        """Fails for a number that breaks the rule."""
        if self.rule is not None and not self.rule.holds(value):
            instead = f", or take it out for {self.usual}" if self.usual else ""
            table.fail(self.path.rpartition(".")[2], f"is {value:g}; give {self.rule.words}{instead}")


A_NUMBER, A_LIST, TEXT = "number", "list of numbers", "text"
LIST_OF_TEXTS = "list of texts"
OF_DRIVES = "number, or list with one for each drive"
PLAY = "see [play](play.md#the-drives)"

WHEEL_KINDS = {
    "omni": "rollers across the axle", "mecanum": "rollers at an angle, usually 45°", "roller": "rollers at any angle",
    "fixed": "an ordinary wheel, not steered"}
INPUT_KINDS = {
    "steps": "holds each value from its instant on, 0 before the first",
    "table": "linear between the instants, constant outside",
    "sine": "amplitude · sin(2π · frequency · t + phase)"}
MOTOR_CIRCUITS = {  # laconic_motor_circuit
    "driven": "its controller sets the voltage", "open": "switched off, only viscous friction is left",
    "shorted": "brakes by its back-EMF"}
PROTOCOLS = {  # of drives, numbered from 1 on the wire
    "canopen": "CiA 301 and 402", "odrive": "ODrive CANSimple", "robomaster": "C620", "moteus": "moteus, CAN FD",
    "robomaster-c610": "C610"}
STEERING = {
    "coordinated": "all such wheels point along one commanded motion of the vehicle, `steering_twist`",
    "prescribed": "its rate or angle is an input, whatever torque that takes",
    "motor": "a motor with a voltage turns it",
    "servo": "a servo of finite torque turns it towards `steering_angle_rad[name]`; where wheels may slip"}
HINGES = {
    "free": "turns freely, with damping and a spring, or by a servo", "motor": "the same, and a motor with a voltage",
    "prescribed": STEERING["prescribed"], "coordinated": STEERING["coordinated"]}
AT_LIMITS = {
    "saturate": "the command is followed as far as the limit allows, and the run reports when and for how long",
    "refuse": "the run ends there"}
REALS = {"double": "64 bits", "single": "32 bits, as on a microcontroller"}

TABLES = {
    "": "At the top of the file.",
    "vehicle": "Totals of the robot with its wheels, without payload, about its centre of mass. Must be given. Once "
               "there are bodies on hinges (steered wheels, casters, trailers), mass, inertia, centre of mass and the "
               "start's place are those of the carriage alone, with the wheels that are fastened to it.",
    "vehicle.motor": "The motor at its shaft, before the gear; instead of `motor_gain_Nm_per_V` and "
                     "`motor_damping_Nms`.",
    "vehicle.drive": "Limits of these motors and their supply; needs `[vehicle.motor]`.",
    "vehicle.wheel[#]": "One for each wheel, numbered from 1. Without any, the vehicle is a sliding puck.",
    "vehicle.wheel[#].steering_motor": "The motor that steers a wheel with `steered = \"motor\"`, at its shaft; "
                                       "instead of `steering_gain_Nm_per_V` and `steering_damping_Nms`.",
    "vehicle.caster[#]": "One for each swivel caster. Its wheels are numbered after those of `[[vehicle.wheel]]`.",
    "vehicle.trailer[#]": "One for each trailer with one axle of two wheels, which are numbered after those of the "
                          "casters: left, right.",
    "vehicle.body[#]": "One for each other body on a vertical hinge; its wheels are `[[vehicle.wheel]]` with its name "
                       "as `body`. Its frame has its origin at the hinge and lies along the parent's at the hinge "
                       "angle 0.",
    "vehicle.body[#].motor": "The motor of a hinge with `hinge = \"motor\"`, at its shaft; instead of "
                             "`gain_Nm_per_V` and `damping_Nms`.",
    "vehicle.support[#]": "One for each ball caster: it carries a normal load, nothing else.",
    "vehicle.payload": "A mass fastened to the body.",
    "ground": "Friction or a slope; without it the ground is level and holds every wheel.",
    "initial": "Start of the motion; without it at rest at the world's origin.",
    "input[#]": "What acts on the vehicle. Several inputs of one signal add up.",
    "run": "How long, in what steps, by which method. Must be given.",
    "outputs": "What `--out` writes.",
    "sensors": "See [sensors](sensors.md).",
    "sensors.imu": "An inertial measurement unit on the body.",
    "sensors.encoder": "An encoder at each wheel.",
    "speed_controller": "What turned set speeds of the wheels into currents on a recorded robot; for "
                        "`laconic replay --inputs set-speeds` alone. Needs `[vehicle.motor]`.",
    "base": "Controller, limits and beliefs of a mobile base; for [`laconic ros2`](ros2.md) alone.",
    "frc": "Battery and devices of an FRC robot, by WPILib's names; for [`laconic frc`](frc.md) alone.",
    "ardupilot": "Outputs of an autopilot; for [`laconic play --ardupilot`](play.md#ardupilot) alone.",
    "ardupilot.channel[#]": "One output, instead of the usual ones of this kind of vehicle.",
    "rig": "What a CAN bus needs to know; for `laconic rig` and `laconic play`.",
    "rig.drives": f"The motor drives between a controller's bus and the wheels; {PLAY}."}
"""Every table of a scene, in the order of the reference."""


def _drive(name: str, rule: Rule, meaning: str, usual: str = "the protocol's") -> Key:
    return Key(f"rig.drives.{name}", OF_DRIVES, meaning, None, usual, rule)


DRIVE_NUMBERS = (
    _drive("encoder_counts", POSITIVE, "Counts of one turn of the motor's shaft, a whole number"),
    _drive("gear_ratio", NOT_ZERO, "Turns of the shaft for one of the wheel; below 0: mounted the other way",
           "the motor's"),
    _drive("torque_constant_Nm_per_A", POSITIVE, "Torque of the shaft per ampere", "the motor's"),
    _drive("back_emf_Vs_per_rad", NOT_NEGATIVE, "Voltage per speed of the shaft", "the motor's"),
    _drive("current_limit_A", POSITIVE, "Largest current", "that of `[vehicle.drive]`"),
    _drive("speed_limit_rad_per_s", NOT_NEGATIVE, "Of the set value of speed and position control; 0: none"),
    _drive("supply_V", NOT_NEGATIVE, "Limits, with the winding, the current that the back-EMF leaves; 0: no limit",
           "that of `[vehicle.drive]`"),
    _drive("winding_resistance_ohm", NOT_NEGATIVE, "0: no limit of the current by the supply", "the motor's"),
    _drive("current_bandwidth_rad_per_s", NOT_NEGATIVE, "Lag of the current; 0: it follows at once"),
    _drive("position_gain_per_s", NOT_NEGATIVE, "Set speed for an error of the shaft's angle",
           "from the inertia that a wheel turns"),
    _drive("speed_gain_As", NOT_NEGATIVE, "Current for an error of the shaft's speed",
           "from the inertia that a wheel turns"),
    _drive("speed_integral_gain_A", NOT_NEGATIVE, "Current for the integral of that error",
           "from the inertia that a wheel turns"),
    _drive("stall_time_s", NOT_NEGATIVE, "So long at the current limit without motion is a fault; 0: none"))
"""Numbers of each drive at the motor's shaft, as laconic_drive_settings has them."""

OWN, CASTER, TRAILER, BODY = "vehicle.wheel[#]", "vehicle.caster[#]", "vehicle.trailer[#]", "vehicle.body[#]"
CARRIAGE = "the carriage"


def _limits(table: str, whose: str) -> tuple[Key, ...]:
    """Of each hinge: where it ends, and what happens there."""
    return (
        Key(f"{table}.stop_low_rad", A_NUMBER, f"Least angle of {whose}", None, "no limit"),
        Key(f"{table}.stop_high_rad", A_NUMBER, f"Largest angle of {whose}", None, "no limit"),
        Key(f"{table}.start_angle_rad", A_NUMBER, f"Angle of {whose} at the start; of a coordinated hinge only its "
            "whole turns count", 0.0),
        Key(f"{table}.start_rate_rad_per_s", A_NUMBER, f"Rate of {whose} at the start, where no wheel or input sets it",
            0.0))


def _commanded(table: str) -> tuple[Key, ...]:
    """Of a hinge that follows a command."""
    return (
        Key(f"{table}.rate_limit_rad_per_s", A_NUMBER, "Largest rate of a prescribed or coordinated hinge; needed to "
            "follow `steering_angle_rad`", None, "no limit", POSITIVE),
        Key(f"{table}.at_limit", TEXT, "What a limit of angle or rate does; on ideal ground a free or motor hinge at "
            "its stop always ends the run", None, "`saturate` for a hinge that is commanded", choices=AT_LIMITS))


def _shaft(table: str) -> tuple[Key, ...]:
    """A motor of a hinge at its shaft."""
    return (
        Key(f"{table}.resistance_ohm", A_NUMBER, "Of the winding", rule=POSITIVE),
        Key(f"{table}.torque_constant_Nm_per_A", A_NUMBER, "Torque of the shaft per ampere", rule=POSITIVE),
        Key(f"{table}.back_emf_Vs_per_rad", A_NUMBER, "Voltage per speed of the shaft", rule=NOT_NEGATIVE),
        Key(f"{table}.gear_ratio", A_NUMBER, "Turns of the shaft for one of the hinge; below 0: mounted the other way",
            rule=NOT_ZERO),
        Key(f"{table}.viscous_friction_Nms", A_NUMBER, "Torque per speed of the shaft", 0.0, rule=NOT_NEGATIVE),
        Key(f"{table}.rotor_inertia_kgm2", A_NUMBER, "Of the rotor; added, times the square of the gear ratio, to the "
            "yaw inertia of what it turns", 0.0, rule=NOT_NEGATIVE),
        Key(f"{table}.current_limit_A", A_NUMBER, f"Largest current; {SLIPS}", None, "no limit", POSITIVE))


SLIPS = "where wheels may slip (`ground.friction_coefficient`)"


def _yields(table: str, contacts: bool, turned: bool) -> tuple[Key, ...]:
    """Of a hinge and its wheels on ground with friction; `turned`: it may have a servo or a motor's loop."""
    def each(key: str, meaning: str, usual: str = "") -> Key:
        return Key(f"{table}.{key}", A_NUMBER, f"{meaning}; {SLIPS}", None if usual else 0.0, usual, NOT_NEGATIVE)

    found: tuple[Key, ...] = (each("com_z_m", "Height of its centre of mass, for loads"),
                              each("dry_friction_Nm", "Least torque that turns the hinge"))
    if turned:
        found += (each("servo_gain_Nm_per_rad", "Of a servo: torque = gain · (angle that is commanded − ψ) − damping · "
                       "ψ'. Without it a coordinated hinge has what torque it needs", "no servo"),
                  each("servo_damping_Nms", "Of the servo"), each("servo_limit_Nm", "Its largest torque", "no limit"),
                  Key(f"{table}.loop_V_per_rad", A_NUMBER, "Of a motor's position loop: voltage per angle that is "
                      f"missing; {SLIPS}", 0.0),
                  Key(f"{table}.loop_Vs_per_rad", A_NUMBER, "The same per rate; alone it is a speed loop, which "
                      f"follows `steering_rate_rad_per_s[name]`; {SLIPS}", 0.0),
                  each("control_period_s", "How often servo or loop looks, a whole number of steps; between it holds "
                       "its torque or voltage", "always"))
    return found + (_contacts(table) if contacts else ())


def _contacts(table: str) -> tuple[Key, ...]:
    return (
        Key(f"{table}.load_N", A_NUMBER, f"A measured normal load, which stays; of all wheels or of none; {SLIPS}",
            None, "by statics", NOT_NEGATIVE),
        Key(f"{table}.scrub_radius_m", A_NUMBER, "A standing wheel resists turning about the vertical with μN times "
            f"this; with bodies on hinges, {SLIPS}", 0.0, rule=NOT_NEGATIVE),
        Key(f"{table}.scrub_fade_m", A_NUMBER, "A rolling wheel resists with less, by this over the radius of its path "
            "or 1", None, "as when standing", NOT_NEGATIVE),
        Key(f"{table}.creep", A_NUMBER, "Of a tyre: slip over rolled way at which its force reaches μN; below it force "
            f"and slip are in proportion; with bodies on hinges, {SLIPS}", 0.0, rule=NOT_NEGATIVE))


def _spelled(table: str, what: str, mass: str, com: str) -> tuple[Key, ...]:
    """Name, parent, mass and inertia of a caster or trailer."""
    return (
        Key(f"{table}.name", TEXT, "In the names of signals: `hinge_angle_rad[name]`", None,
            f"`{what}_1`, counted up"),
        Key(f"{table}.parent", TEXT, "Name of the body that it hangs on", None, CARRIAGE),
        Key(f"{table}.mass_kg", A_NUMBER, mass, 0.0, rule=NOT_NEGATIVE),
        Key(f"{table}.yaw_inertia_kgm2", A_NUMBER, "About the vertical through its own centre of mass", 0.0,
            rule=NOT_NEGATIVE),
        Key(f"{table}.com_x_m", A_NUMBER, com, None, "over its axle"),
        Key(f"{table}.radius_m", A_NUMBER, "Of its wheels", rule=POSITIVE),
        Key(f"{table}.wheel_inertia_kgm2", A_NUMBER, "Of each wheel about its axle", 0.0, rule=NOT_NEGATIVE),
        Key(f"{table}.damping_Nms", A_NUMBER, "Of its hinge: torque per rate", 0.0, rule=NOT_NEGATIVE))


HINGE_KEYS = (
    Key(f"{OWN}.body", TEXT, "Name of the body that carries the wheel; its place is then in that body's frame", None,
        CARRIAGE),
    Key(f"{OWN}.steered", TEXT, "What turns the wheel about a vertical axis, whose place is then `x_m` and `y_m`; such "
        'a wheel is "fixed", and at the angle 0 it rolls forward if `axle_rad` is not given', None, "not steered",
        choices=STEERING),
    Key(f"{OWN}.name", TEXT, "Of a steered wheel, in the names of signals: `hinge_angle_rad[name]`", None,
        "`wheel_1`, by its number"),
    Key(f"{OWN}.scrub_m", A_NUMBER, "Distance of a steered wheel to the left of its steering axis", 0.0),
    Key(f"{OWN}.mass_kg", A_NUMBER, "Of all that turns about the steering axis; its centre of mass lies on the axis",
        0.0, rule=NOT_NEGATIVE),
    Key(f"{OWN}.yaw_inertia_kgm2", A_NUMBER, "Of all that turns about the steering axis", 0.0, rule=NOT_NEGATIVE),
    Key(f"{OWN}.steering_gain_Nm_per_V", A_NUMBER, "Torque about the steering axis per volt of its motor", 0.0),
    Key(f"{OWN}.steering_damping_Nms", A_NUMBER, "Torque about the steering axis per rate", 0.0, rule=NOT_NEGATIVE),
    *_limits(OWN, "a steered wheel"), *_commanded(OWN), *_shaft(f"{OWN}.steering_motor"), *_yields(OWN, True, True),
    *_spelled(CASTER, "caster", "Of fork and wheels", "Its centre of mass ahead of the swivel axis"),
    Key(f"{CASTER}.x_m", A_NUMBER, "Of the swivel axis, in the parent's frame"),
    Key(f"{CASTER}.y_m", A_NUMBER, "Of the swivel axis, in the parent's frame"),
    Key(f"{CASTER}.trail_m", A_NUMBER, "How far the wheel's axle lies behind the swivel axis", rule=POSITIVE),
    Key(f"{CASTER}.offset_m", A_NUMBER, "Distance of the wheel, or the middle of two, to the left of the swivel axis",
        0.0),
    Key(f"{CASTER}.twin_m", A_NUMBER, "Distance of two twin wheels from each other", None, "one wheel", POSITIVE),
    Key(f"{CASTER}.driven", "true or false", "Whether its wheels have the vehicle's motor", None, "false"),
    *_limits(CASTER, "the swivel"), *_yields(CASTER, True, False),
    *_spelled(TRAILER, "trailer", "Of the trailer with its wheels", "Its centre of mass ahead of the hitch"),
    Key(f"{TRAILER}.hitch_x_m", A_NUMBER, "Of the hitch, in the parent's frame: for a parent that is a trailer, from "
        "its own hitch"),
    Key(f"{TRAILER}.hitch_y_m", A_NUMBER, "Of the hitch, in the parent's frame", 0.0),
    Key(f"{TRAILER}.length_m", A_NUMBER, "From the hitch back to the axle", rule=POSITIVE),
    Key(f"{TRAILER}.track_m", A_NUMBER, "Distance of its two wheels", rule=POSITIVE),
    *_limits(TRAILER, "the trailer against its parent"), *_yields(TRAILER, True, False),
    Key(f"{BODY}.name", TEXT, "In the names of signals, and for `body` and `parent`"),
    Key(f"{BODY}.parent", TEXT, "Name of the body that it hangs on", None, CARRIAGE),
    Key(f"{BODY}.hinge", TEXT, "What turns it", choices=HINGES),
    Key(f"{BODY}.hinge_x_m", A_NUMBER, "Of the hinge, in the parent's frame"),
    Key(f"{BODY}.hinge_y_m", A_NUMBER, "Of the hinge, in the parent's frame", 0.0),
    Key(f"{BODY}.mass_kg", A_NUMBER, "Of the body with its wheels", rule=NOT_NEGATIVE),
    Key(f"{BODY}.yaw_inertia_kgm2", A_NUMBER, "About the vertical through its own centre of mass", rule=NOT_NEGATIVE),
    Key(f"{BODY}.com_x_m", A_NUMBER, "Centre of mass, in the body's frame", 0.0),
    Key(f"{BODY}.com_y_m", A_NUMBER, "Centre of mass, in the body's frame", 0.0),
    Key(f"{BODY}.damping_Nms", A_NUMBER, "Of a free or motor hinge: torque per rate", 0.0, rule=NOT_NEGATIVE),
    Key(f"{BODY}.stiffness_Nm", A_NUMBER, "Of a free or motor hinge: torque per radian", 0.0, rule=NOT_NEGATIVE),
    Key(f"{BODY}.rest_rad", A_NUMBER, "Angle at which that spring is relaxed", 0.0),
    Key(f"{BODY}.gain_Nm_per_V", A_NUMBER, "Torque of a motor hinge per volt", 0.0),
    *_limits(BODY, "the hinge"), *_commanded(BODY), *_shaft(f"{BODY}.motor"), *_yields(BODY, False, True),
    Key(f"{BODY}.hitch", "true or false", f"Whether the hinge carries no pitch and roll, as of a trailer; {SLIPS}",
        None, "false"))
"""Keys of bodies on hinges, which the core's list of scene fields does not have."""

KEYS: Mapping[str, Key] = {key.path: key for key in (
    Key("name", TEXT, "Of the scene, in pictures and tables", None, "the file's name"),
    Key("source", TEXT, "Where its numbers come from", ""),
    Key(f"{OWN}.kind", TEXT, "What the wheel is", choices=WHEEL_KINDS),
    Key(f"{OWN}.x_m", usual="or `distance_m` and `bearing_rad`"),
    Key(f"{OWN}.y_m", usual="or `distance_m` and `bearing_rad`"),
    Key(f"{OWN}.distance_m", A_NUMBER, "Of the wheel's centre from the body frame's origin", None,
        "or `x_m` and `y_m`", range="0 or more"),
    Key(f"{OWN}.bearing_rad", A_NUMBER, "Direction of the wheel's centre from the body frame's origin, from the ξ axis",
        None, "or `x_m` and `y_m`"),
    Key(f"{OWN}.roller_rad", usual="90° for `omni`; else must be given; not for `fixed`", range="not along the axle"),
    Key(f"{OWN}.locked", usual="false"),
    Key(f"{OWN}.driven", meaning="Whether the wheel has a motor", usual="true"),
    Key(f"{OWN}.motor_circuit", TEXT, "What its motor is connected to", "driven", choices=MOTOR_CIRCUITS),
    *(Key(f"{OWN}.{key}", rule=FRICTION if key == "friction_coefficient" else POSITIVE, usual=whose)
      for key, whose in ABOVE_0.items()),
    Key("vehicle.motor.resistance_ohm", meaning="Of the winding, R_a"),
    Key("vehicle.motor.torque_constant_Nm_per_A", meaning="Torque of the shaft per ampere, k_t"),
    Key("vehicle.motor.back_emf_Vs_per_rad", meaning="Voltage per speed of the shaft, k_e; in SI as large as k_t"),
    Key("vehicle.motor.gear_ratio", meaning="Turns of the motor's shaft for one of the wheel, n; below 0: the shaft "
                                            "turns against the wheel, so a voltage above 0 turns that backwards"),
    Key("vehicle.motor.viscous_friction_Nms", meaning="Torque per speed of the shaft, d"),
    Key("vehicle.motor.rotor_inertia_kgm2", meaning="Of the rotor; added, times n², to `wheel_inertia_kgm2`"),
    Key("vehicle.drive.supply_V", rule=POSITIVE, usual="no limit"),
    Key("vehicle.drive.current_limit_A", rule=POSITIVE, usual="no limit"),
    Key("vehicle.friction_coefficient", rule=FRICTION, usual="a run in which slip is not judged"),
    Key("ground.friction_coefficient", rule=POSITIVE, usual="ideal ground"),
    Key("initial.nu_rad_per_s", usual="at rest; or velocity and yaw rate"),
    Key("initial.velocity_body_m_per_s", "list of 2 numbers", "Of the centre of mass, in body axes", (0.0, 0.0)),
    Key("initial.yaw_rate_rad_per_s", A_NUMBER, "How fast the body turns, to the left", 0.0),
    Key("initial.wheel_speed_rad_per_s", usual="as the wheels roll"),
    Key("input[#].signal", TEXT, "One of [the inputs](signals.md#inputs)"),
    Key("input[#].kind", TEXT, "Its course over time", choices=INPUT_KINDS),
    Key("input[#].t_s", A_LIST, "Instants; those of `steps` fall on steps of the run",
        usual="must be given, of a `sine` not", range="ascending, from 0"),
    Key("input[#].value", A_LIST, "At each instant, in the signal's unit", usual="must be given, of a `sine` not"),
    Key("input[#].amplitude", A_NUMBER, "Of a `sine`, in the signal's unit", usual="must be given for a `sine`",
        rule=SWINGS),
    Key("input[#].frequency_Hz", A_NUMBER, "Of a `sine`; four steps a period at least",
        usual="must be given for a `sine`", range="0 or more; above 0 where the phase is 0"),
    Key("input[#].phase_rad", A_NUMBER, "Of a `sine`", 0.0),
    Key("run.duration_s", A_NUMBER, "Length of the run, a whole number of steps", rule=POSITIVE),
    Key("run.step_s", A_NUMBER, 'Internal step, or "auto" with `tolerance`: [found before the run]'
        "(accuracy.md#a-step-for-a-tolerance)", rule=POSITIVE),
    Key("run.tolerance", A_NUMBER, 'For step_s = "auto": the largest estimated error that ν, place, heading and wheel '
        "angles may have in the run, in rad/s, m and rad", None, "a step that is given", POSITIVE),
    Key("run.method", TEXT, "See [which method](performance.md#which-method)", "auto"),
    Key("run.real", TEXT, "Scalar type of the core", "double", choices=REALS),
    Key("outputs.signals", "list of texts", "[Outputs](signals.md#outputs), with an index or without for all of them",
        None, "the usual ones"),
    Key("outputs.every_s", A_NUMBER, "Interval of the rows, a whole number of steps", None, "each step", POSITIVE),
    Key("sensors.imu.delay_s", A_NUMBER, "How late it shows a sample: a whole number of steps, at most 64", 0.0,
        rule=SECONDS),
    Key("sensors.imu.seed", meaning="Of the noise; refused without noise", range="32 bits"),
    Key("sensors.imu.acceleration_scale_error", "number, or list of 2"),
    Key("sensors.imu.acceleration_bias_m_per_s2", "number, or list of 2"),
    Key("sensors.imu.acceleration_range_m_per_s2", usual="no limit"),
    Key("sensors.imu.yaw_rate_range_rad_per_s", usual="no limit"),
    Key("sensors.encoder.counts_per_turn", "whole number, or list with one for each wheel, `false` for none",
        "Counts of one turn of the encoder's shaft, all edges counted", usual="must be given", range="above 0"),
    Key("sensors.encoder.gear_ratio", "number, or list with one for each encoder", usual="1", range="not 0"),
    Key("sensors.encoder.wrap", meaning="How many values the counter has: 65536 shows 0 to 65535",
        usual="32 bits with sign", range="2 to 2³¹ − 1, or 2³²"),
    Key("speed_controller.gain_As_per_rad", A_NUMBER, "P of the motors' current P (set − s) + I ∫(set − s) dt, with "
                                                      "speeds s of the wheels", rule=POSITIVE),
    Key("speed_controller.integral_gain_A_per_rad", A_NUMBER, "I of it", 0.0, rule=NOT_NEGATIVE),
    Key("speed_controller.dead_time_s", A_NUMBER, "From the set speed to the current", 0.0, rule=NOT_NEGATIVE),
    Key("base.gain_Vs_per_rad", A_NUMBER, "P of a wheel's voltage P (set − s) + I ∫(set − s) dt, with its speed s",
        None, "from the inertia that a wheel turns", POSITIVE),
    Key("base.integral_gain_V_per_rad", A_NUMBER, "I of it", None, "from P and the motor's damping", NOT_NEGATIVE),
    Key("base.voltage_limit_V", A_NUMBER, "Largest voltage of a motor", None, "`vehicle.drive.supply_V`, else none",
        POSITIVE),
    Key("base.gain_Nms_per_rad", A_NUMBER, "The same for a vehicle without motors, which torques drive", None,
        "from the inertia that a wheel turns", POSITIVE),
    Key("base.integral_gain_Nm_per_rad", A_NUMBER, "I of it", None, "from P", NOT_NEGATIVE),
    Key("base.torque_limit_Nm", A_NUMBER, "Largest torque at an axle", None, "none", POSITIVE),
    Key("base.speed_limit_m_per_s", A_NUMBER, "Largest speed that a command sets", None, "none", POSITIVE),
    Key("base.yaw_rate_limit_rad_per_s", A_NUMBER, "Largest yaw rate that a command sets", None, "none", POSITIVE),
    Key("base.acceleration_limit_m_per_s2", A_NUMBER, "How fast the set velocity changes", None, "at once", POSITIVE),
    Key("base.yaw_acceleration_limit_rad_per_s2", A_NUMBER, "How fast the set yaw rate changes", None, "at once",
        POSITIVE),
    Key("base.steering_rate_limit_rad_per_s", A_NUMBER, "How fast the base turns a hinge that it steers", None,
        "10, and what the hinge allows", POSITIVE),
    Key("base.steering_voltage_limit_V", A_NUMBER, "Largest voltage of a motor that steers", None, "none", POSITIVE),
    Key("base.watchdog_s", A_NUMBER, "The base stops after so long without a command", 0.5, rule=POSITIVE),
    Key("base.believed_size", A_NUMBER, "Distances of the wheels as the base believes them, over the true ones", 1.0,
        rule=POSITIVE),
    Key("base.believed_radius_m", "number, or list with one for each wheel",
        "Wheel radii as the base believes them, for its set speeds and its odometry", None, "the true ones", POSITIVE),
    Key("base.joint_names", "list of texts", "Of the wheels, and then of the hinges or not, as in the robot's URDF", (),
        "wheel_1_joint …, and the name of a hinge with _hinge_joint"),
    Key("frc.battery_V", A_NUMBER, "Voltage of the battery without load", 12.0, rule=POSITIVE),
    Key("frc.battery_resistance_ohm", A_NUMBER, "Of battery and wires; 0: the voltage does not sag", 0.02,
        rule=NOT_NEGATIVE),
    Key("frc.current_limit_A", A_NUMBER, "Largest current of all motors of a wheel together", None, "none", POSITIVE),
    Key("frc.steering_current_limit_A", A_NUMBER, "The same of a motor that steers", None, "none", POSITIVE),
    Key("frc.drive", LIST_OF_TEXTS, "Output of each wheel: `PWM[0]`, `CANMotor:NAME`; with `-` before it where it "
        "turns the wheel backwards", (), "none"),
    Key("frc.drive_encoder", LIST_OF_TEXTS, "Of each wheel: `Encoder[0]` has its channel A on DIO 0; "
        "`CANEncoder:NAME` …", (), "none"),
    Key("frc.drive_counts", A_NUMBER, "Counts of an `Encoder` in a turn of the wheel", 2048.0, rule=POSITIVE),
    Key("frc.steering", LIST_OF_TEXTS, "Output of each motor that steers, in the order of the wheels", (), "none"),
    Key("frc.steering_encoder", LIST_OF_TEXTS, "`DutyCycleEncoder[0]`, `AnalogEncoder[0]`, `Encoder[0]` …", (), "none"),
    Key("frc.steering_counts", A_NUMBER, "Counts of an `Encoder` in a turn of the module", 4096.0, rule=POSITIVE),
    Key("frc.gyro", TEXT, "`ADXRS450[0]`, `AnalogGyro[0]`, `CANGyro:NAME` or `SimDevice:NAME/VALUE`", None, "none"),
    Key("ardupilot.full_V", A_NUMBER, "Voltage of the motors at full throttle", None,
        "`vehicle.drive.supply_V`, else `rig.drives.supply_V`", POSITIVE),
    Key("ardupilot.full_speed_rad_per_s", A_NUMBER, "Instead: full throttle sets this speed, and a controller with the "
        "gains of `[base]` turns each wheel", None, "throttle is a voltage", POSITIVE),
    Key("ardupilot.full_steering_rad", A_NUMBER, "Angle at full steering", None, "the least stop of a steered wheel",
        POSITIVE),
    Key("ardupilot.pwm_us", "list of 3 numbers", "Pulses for −1, 0 and 1: SERVOn_MIN, TRIM, MAX",
        (1000.0, 1500.0, 2000.0)),
    Key("ardupilot.channel[#].number", "whole number", "SERVO1 is 1", range="1 to 32"),
    Key("ardupilot.channel[#].signals", "list of texts", "Inputs that the output sets; `wheel_speed_rad_per_s[i]` is "
        "the set speed of a controller. Outputs of one signal add up"),
    Key("ardupilot.channel[#].full", A_NUMBER, "Their value at the longest pulse; below 0: reversed", rule=NOT_ZERO),
    Key("rig.id_base", "whole number", "First CAN identifier of the node", None, "the node's own", range="0 to 0x7FF"),
    Key("rig.frames", "list of texts", "Frames of [the wire](wire.md) that the node sends", (), "the usual ones"),
    Key("rig.drives.protocol", TEXT, "What the drives speak", None, "that of `--drives`", choices=PROTOCOLS),
    Key("rig.drives.node_ids", "list of whole numbers", "One for each wheel, `false` for a wheel without a drive", None,
        "counted up"),
    *DRIVE_NUMBERS, *HINGE_KEYS,
    Key("rig.drives.watchdog_s", A_NUMBER, "Off after so long a silence; not with CANopen", None, "the protocol's",
        SECONDS))}


def key_of(table: Table, name: str) -> Key:
    """The key of a table, by where the table stands."""
    return KEYS[re.sub(r"\[\d+\]", "[#]", table.name(name))]


def read_number(table: Table, name: str) -> Any:
    """A finite number that its rule allows, or its default."""
    key = key_of(table, name)
    value = table.number(name, key.default)
    if value is not None:
        key.check(table, value)
    return value


def read_choice(table: Table, name: str, *, hints: Mapping[str, str] = NO_HINTS) -> str:
    """One of the words that a key may be, or its default; hints as in laconic.scene.not_modelled."""
    key = key_of(table, name)
    return table.choice(name, tuple(key.choices or ()), key.default, hints=hints)


DEGREES = {"pi/2": "90", "pi/4": "45"}


def in_file(refused: Refused, in_degrees: Collection[str]) -> Refused:
    """A refusal of the core by the key, and in the unit, that the file has."""
    key, _, text = refused.message.partition(": ")
    if key not in in_degrees:
        return refused
    text = in_degrees_of(text, refused)
    for radians, degrees in DEGREES.items():
        text = text.replace(radians, degrees)
    text = f"{key.removesuffix('_rad')}_deg: {text}"
    return Refused(refused.status, refused.field, refused.item, text, value=refused.value, limit=refused.limit)


def in_degrees_of(text: str, refused: Refused) -> str:
    """A text whose numbers are the refusal's value and limit, in degrees; the limit rounded so that it is within."""
    value, limit = (f"{number:.6g}" for number in (refused.value, refused.limit))
    if text.startswith(f"with {value} rad"):
        return text.replace(f"{value} rad", f"{math.degrees(refused.value):.6g} degrees", 1)
    if not text.startswith(f"{value} is"):
        return text
    verdict = text.removeprefix(value)
    if refused.limit:
        verdict = verdict.replace(limit, f"{math.floor(1e3 * math.degrees(refused.limit)) / 1e3:.6g}")
    return f"{math.degrees(refused.value):.6g}{verdict}"
