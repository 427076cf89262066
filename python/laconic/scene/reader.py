"""The keys of a scene file, table by table. What only the core can judge (masses, angles …) is left to the core."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from laconic.core import Field, load
from laconic.core.articulated import CARRIAGE, method_names
from laconic.core.inputs import no_such_wheel
from laconic.core.spelling import PLAIN, place_by_bearing
from laconic.errors import LONGEST_NAME, nearest_of, shown
from laconic.scene.base import read_base, read_frc
from laconic.scene.drives import read_ardupilot, read_drives, read_speed_controller
from laconic.scene.effects import check_ground, check_input, check_places, check_start, check_wheel
from laconic.scene.ground import check_friction, read_circuit, read_drive, read_ground, slips
from laconic.scene.hinge_friction import read_contact
from laconic.scene.hinge_signals import (
    check_commands,
    check_hinge_signal,
    input_signals,
    output_signals_of,
    read_hinge_signals,
)
from laconic.scene.hinges import ROLLS_FORWARD_RAD, SHORT_FORMS, Hinge, Hung, check_not_steered, has_hinges, read_hinges
from laconic.scene.inputs import Input
from laconic.scene.keys import key_of, read_choice, read_number
from laconic.scene.not_modelled import KINDS_OF_WHEELS, OF_VEHICLES, OF_WHEELS
from laconic.scene.sensors import NO_SENSORS, SensorTables, read_sensors
from laconic.scene.signals import LENGTHS, PER_WHEEL, missing_outputs, output_signals, signal_names
from laconic.scene.step_choice import AUTO, LARGEST_TOLERANCE
from laconic.scene.table import Table, read_field


def read_parts(top: Table, methods: Sequence[str], reals: Sequence[str]) -> dict[str, Any]:
    """Everything a scene consists of, as plain values."""
    source = top.text("source", key_of(top, "source").default, allowed="\t\n")
    parts: dict[str, Any] = {"name": top.text("name", top.path.stem), "source": source}
    if not parts["name"].strip():
        top.fail("name", "is empty; give a name, or take it out for the file's own")
    if len(parts["name"]) > LONGEST_NAME:
        top.fail("name", f"has {len(parts['name'])} letters; give at most {LONGEST_NAME}, and what else there is to "
                 "say as source")
    ground = top.peek("ground")
    slipping = isinstance(ground, Mapping) and "friction_coefficient" in ground
    parts["vehicle"], hung = read_vehicle(top.table("vehicle", required=True), slipping)
    if top.has("ground"):
        parts["vehicle"]["ground"] = read_ground(top.table("ground"))
    check_friction(top, parts["vehicle"])
    check_ground(top, parts["vehicle"])
    parts["speed_controller"] = read_speed_controller(top, parts["vehicle"])
    wheel_count = len(parts["vehicle"]["wheel"])
    parts["initial"] = read_initial(top.table("initial"), wheel_count)
    check_start(top, parts["initial"], parts["vehicle"])
    if hung is not None:
        return read_parts_with_hinges(top, parts, hung, reals)
    parts["inputs"] = [read_input(each, wheel_count) for each in top.tables("input")]
    parts["run"] = read_run(top.table("run", required=True), methods, reals)
    check_places(top, parts["inputs"])
    for each in parts["inputs"]:
        check_input(top, each, parts["vehicle"], parts["run"]["duration_s"])
    parts["sensors"] = read_sensors(top.table("sensors"), wheel_count) if top.has("sensors") else NO_SENSORS
    parts["outputs"] = read_outputs(top.table("outputs"), parts["vehicle"], parts["sensors"],
                                    parts["run"]["duration_s"])
    parts["base"] = read_base(top.table("base"), parts["vehicle"]) if top.has("base") else None
    parts["frc"] = read_frc(top.table("frc"), parts["vehicle"]) if top.has("frc") else None
    parts["ardupilot"] = read_ardupilot(top.table("ardupilot"), wheel_count, list(signal_names(
        LENGTHS, PER_WHEEL, wheel_count))) if top.has("ardupilot") else None
    parts["hinges"], parts["wheel_places"] = (), ()
    parts["rig"] = read_rig(top.table("rig"), parts["vehicle"]["wheel"])
    top.done()
    parts["in_degrees"] = frozenset(top.in_degrees)
    return parts


def read_parts_with_hinges(top: Table, parts: dict[str, Any], hung: Hung, reals: Sequence[str]) -> dict[str, Any]:
    """The rest of a scene whose vehicle has bodies on hinges: other signals, other methods, no sensors."""
    vehicle, hinges = parts["vehicle"], hung.hinges
    check_ideal(top, vehicle, hung.wheel_places)
    known = {signal: name for name, of_name in input_signals(vehicle, hinges).items() for signal in of_name}
    parts["inputs"] = [read_input(each, len(vehicle["wheel"]), known, hinges) for each in top.tables("input")]
    parts["run"] = read_run(top.table("run", required=True), methods_with_hinges(vehicle), reals)
    if parts["run"].get("tolerance") is not None and slips(vehicle):
        top.fail("run.step_s", '"auto" is not found for hinges on ground with friction yet; give a step in seconds, '
                 "such as 0.001")
    check_places(top, parts["inputs"])
    for each in parts["inputs"]:
        check_input(top, each, vehicle, parts["run"]["duration_s"])
    check_commands(top, parts["inputs"], hinges)
    check_start_with_hinges(top, parts["initial"], slips(vehicle))
    if top.has("sensors"):
        top.fail("sensors", "are not simulated for vehicles with hinges yet; take the table out")
    outputs = top.table("outputs")
    signals = read_hinge_signals(outputs, output_signals_of(vehicle, hinges))
    parts["outputs"] = read_interval(outputs, signals, parts["run"]["duration_s"])
    parts["base"] = read_base(top.table("base"), vehicle) if top.has("base") else None
    parts["frc"] = read_frc(top.table("frc"), vehicle) if top.has("frc") else None
    parts["ardupilot"] = read_ardupilot(
        top.table("ardupilot"), len(vehicle["wheel"]), list(known)) if top.has("ardupilot") else None
    parts["sensors"] = NO_SENSORS
    parts["rig"] = read_rig(top.table("rig"), vehicle["wheel"], hinges, slips(vehicle))
    top.done()
    return parts | {"in_degrees": frozenset(top.in_degrees), "hinges": hinges, "wheel_places": hung.wheel_places}


def check_ideal(top: Table, vehicle: Mapping[str, Any], wheel_places: Sequence[str]) -> None:
    """Fails for limits of drives on ideal ground, where they do not act on vehicles with hinges."""
    if slips(vehicle):
        return
    remedy = "needs wheels that may slip, as the vehicle has hinges; give ground.friction_coefficient, or take it"
    if "drive" in vehicle:
        top.fail("vehicle.drive", f"{remedy} out")
    for place, wheel in zip(wheel_places, vehicle["wheel"], strict=True):
        if wheel.get("motor_circuit"):
            top.fail(f"{place}.motor_circuit", f"{remedy} out")


def methods_with_hinges(vehicle: Mapping[str, Any]) -> tuple[str, ...]:
    """The methods that step a vehicle with hinges: on ground with friction there is one."""
    return ("auto",) if slips(vehicle) else method_names()


def check_start_with_hinges(top: Table, initial: Mapping[str, Any], slipping: bool) -> None:
    """Fails for starts in numbers that a vehicle with hinges does not have."""
    if "nu_rad_per_s" in initial:
        top.fail("initial.nu_rad_per_s", "is not a start of a vehicle with hinges; give velocity_body_m_per_s and "
                 "yaw_rate_rad_per_s")
    if "wheel_speed_rad_per_s" in initial and not slipping:
        top.fail("initial.wheel_speed_rad_per_s", "follows from the motion, as wheels roll without slip on "
                 "hinges; take it out")


def read_vehicle(table: Table, slipping: bool) -> tuple[dict[str, Any], Hung | None]:
    """`[vehicle]` with the keys of laconic_vehicle; `motor` stays apart for laconic_motor_fit. With bodies on hinges
    also those, and what the core does not know of them."""
    fields = load().fields_of("vehicle")
    table.expect(field.key for field in fields)
    vehicle: dict[str, Any] = {field.key: read_field(table, field) for field in fields if field.need == "ALWAYS"}
    vehicle |= {field.key: read_field(table, field, 0.0) for field in fields if field.need == "NEVER"}
    if table.has("friction_coefficient"):
        key_of(table, "friction_coefficient").check(table, vehicle["friction_coefficient"])
    is_hung = has_hinges({key: table.peek(key) for key in ("wheel", *SHORT_FORMS)})
    wheels = [(each, read_wheel(each, slipping, is_hung)) for each in table.tables("wheel")]
    vehicle["wheel"] = [wheel for _, wheel in wheels]
    needed = ... if vehicle["wheel"] else 0.0
    hung = read_hinges(table, wheels, slipping) if is_hung else None
    if hung is not None:
        vehicle |= {"wheel": hung.wheels, "body": hung.bodies}
    vehicle |= {field.key: read_field(table, field, needed) for field in fields if field.need == "WITH_WHEELS"}
    vehicle |= read_motor(table, [field for field in fields if field.need == "WITH_MOTOR"])
    if table.has("drive"):
        vehicle["drive"] = read_drive(table)
    vehicle["support"] = [read_point(each) for each in table.tables("support")]
    if table.has("payload"):
        vehicle["payload"] = read_all(table.table("payload"), load().fields_of("vehicle.payload"))
    for form in SHORT_FORMS:
        table.has(form)
    table.done(OF_VEHICLES)
    return vehicle, hung


def read_motor(table: Table, direct: Sequence[Field]) -> dict[str, Any]:
    """Gain and damping at the wheel, or a motor at its shaft, or neither."""
    given = [field.key for field in direct if table.has(field.key)]
    if not table.has("motor"):
        return {field.key: read_field(table, field, ... if given else 0.0) for field in direct}
    if given:
        second = f", and so is {given[1]}" if given[1:] else ""
        which = ", the motor or these two" if second else ""
        table.fail(given[0], f"is given besides [vehicle.motor]{second}; keep one of them{which}")
    motor = table.table("motor")
    motor.expect(field.key for field in load().fields_of("vehicle.motor"))
    values = {field.key: read_field(motor, field, 0.0 if field.need == "NEVER" else ...)
              for field in load().fields_of("vehicle.motor")}
    motor.done()
    return {"motor": values}


def read_wheel(table: Table, slipping: bool = False, is_hung: bool = False) -> dict[str, Any]:
    """One `[[vehicle.wheel]]`: an omni wheel's roller angle is π/2 unless it is given."""
    kind = read_choice(table, "kind", hints=KINDS_OF_WHEELS)
    wheel: dict[str, Any] = {"kind": kind, **read_position(table)}
    steered, body = read_choice(table, "steered"), table.text("body", None)
    if not steered:
        check_not_steered(table)
    fields = {field.key: field for field in load().fields_of("vehicle.wheel[#]") if field.key not in wheel}
    roller = fields.pop("roller_rad")
    straight = {"axle_rad": ROLLS_FORWARD_RAD} if steered else {}
    wheel |= {key: read_field(table, field, straight.get(key, ...)) for key, field in fields.items()
              if field.need == "EACH_WHEEL"}
    if kind != "fixed":
        wheel["roller_rad"] = read_field(table, roller, math.pi / 2 if kind == "omni" else ...)
    usual = {"locked": False, "driven": True}
    wheel |= {key: read_field(table, fields[key], default) for key, default in usual.items()}
    wheel["motor_circuit"] = read_circuit(table)
    wheel |= read_own(table, [field for field in fields.values() if field.is_own])
    check_wheel(table, wheel)
    wheel |= read_contact(table, slipping, is_hung)
    wheel |= {"steered": steered} if steered else {}
    wheel |= {"body": body} if body not in (None, CARRIAGE) else {}
    if not steered:
        table.done(OF_WHEELS)
    return wheel


def read_own(table: Table, fields: Sequence[Field]) -> dict[str, float]:
    """Values that the wheel has instead of the vehicle's: only those that are given, as 0 is a value, too."""
    return {field.key: read_field(table, field) for field in fields if table.has(field.key)}


def read_position(table: Table) -> dict[str, float]:
    """x_m and y_m, or distance_m and a bearing from the ξ axis."""
    place = place_by_bearing(table)
    if place is None:
        return {key: table.number(key, finite=False) for key in PLAIN}
    return dict(zip(PLAIN, place, strict=True))


def read_point(table: Table) -> dict[str, float]:
    """One `[[vehicle.support]]`."""
    return read_all(table, load().fields_of("vehicle.support[#]"))


def read_all(table: Table, fields: Sequence[Field]) -> dict[str, float]:
    """A table of these numbers and nothing else."""
    table.expect(field.key for field in fields)
    found = {field.key: read_field(table, field) for field in fields}
    table.done()
    return found


def read_initial(table: Table, wheel_count: int) -> dict[str, Any]:
    """`[initial]`: ν, or velocity and yaw rate; by default at rest at the world's origin."""
    start: dict[str, Any] = {}
    velocity = [key for key in ("velocity_body_m_per_s", "yaw_rate_rad_per_s") if table.has(key)]
    if table.has("nu_rad_per_s"):
        if velocity:
            table.fail(velocity[0], "is given besides nu_rad_per_s; keep one of them")
        start["nu_rad_per_s"] = table.numbers("nu_rad_per_s", 3)
    if "velocity_body_m_per_s" in velocity:
        start["velocity_body_m_per_s"] = table.numbers("velocity_body_m_per_s", 2)
    start["yaw_rate_rad_per_s"] = read_number(table, "yaw_rate_rad_per_s")
    if table.has("wheel_speed_rad_per_s"):
        start["wheel_speed_rad_per_s"] = table.numbers("wheel_speed_rad_per_s", wheel_count)
    single = [field for field in load().fields_of("initial") if field.items == 0]
    start |= {field.key: read_field(table, field, 0.0, finite=True) for field in single}
    table.done()
    return start


def check_signal(table: Table, key: str, signal: str, lengths: dict[str, int], per_wheel: Sequence[str],
                 wheel_count: int) -> None:
    """Fails with the reason: index beyond the wheels, or no such name."""
    known = list(signal_names(lengths, per_wheel, wheel_count))
    if signal in known:
        return
    name = signal.partition("[")[0]
    if name in per_wheel:
        table.fail(key, no_such_wheel(signal, name, wheel_count))
    table.fail(key, f"there is no signal {shown(signal)}; {nearest_of(signal, known)}")


def read_input(table: Table, wheel_count: int, known: Mapping[str, str] | None = None,
               hinges: Sequence[Hinge] = ()) -> Input:
    """One `[[input]]`; `known`: the signals of a vehicle with these hinges."""
    signal, kind = table.text("signal"), read_choice(table, "kind")
    if known is None:
        check_signal(table, "signal", signal, LENGTHS, PER_WHEEL, wheel_count)
    else:
        check_hinge_signal(table, "signal", signal, known, hinges)
    if kind == "sine":
        phase = table.angle("phase", 0.0)
        found = Input(signal, kind, table.location, amplitude=read_number(table, "amplitude"),
                      frequency_Hz=read_number(table, "frequency_Hz"), phase_rad=phase)
        if found.frequency_Hz < 0:
            table.fail("frequency_Hz", f"is {found.frequency_Hz:g}; give 0 or more, and a sine's sign by its amplitude")
    else:
        t_s = table.numbers("t_s")
        found = Input(signal, kind, table.location, t_s=t_s, value=table.numbers("value", len(t_s)))
        check_instants(table, t_s)
    table.done()
    return found


def check_instants(table: Table, t_s: Sequence[float]) -> None:
    """Fails unless there is at least one instant, none negative, each after the one before."""
    if not t_s:
        table.fail("t_s", "is empty; give at least one instant")
    if t_s[0] < 0:
        table.fail("t_s", f"begins at {t_s[0]:g} s; the run begins at 0")
    for before, after in pairwise(t_s):
        if after <= before:
            table.fail("t_s", f"goes from {before:g} to {after:g} s; give instants in ascending order")


def read_step(table: Table) -> dict[str, Any]:
    """A step, or "auto" (as 0, until it is found) with the tolerance that it must keep."""
    given = table.peek("step_s")
    if not isinstance(given, str) or given != AUTO:
        if table.has("tolerance"):
            table.fail("tolerance", f'has a meaning with step_s = "{AUTO}" alone; take one of them out')
        return {"step_s": read_number(table, "step_s")}
    table.has("step_s")
    tolerance = read_number(table, "tolerance")
    if tolerance is None:
        table.fail("tolerance", f'is missing; step_s = "{AUTO}" needs the largest error that the run may have, such as '
                   "1e-9 (rad/s, m, rad)")
    if tolerance > LARGEST_TOLERANCE:
        table.fail("tolerance", f"is {tolerance:g}; give {LARGEST_TOLERANCE:g} (rad/s, m, rad) or less")
    return {"step_s": 0.0, "tolerance": tolerance}


def read_run(table: Table, methods: Sequence[str], reals: Sequence[str]) -> dict[str, Any]:
    """`[run]`."""
    run: dict[str, Any] = {"duration_s": read_number(table, "duration_s"), **read_step(table)}
    run["method"] = table.choice("method", methods, key_of(table, "method").default)
    run["real"] = table.choice("real", reals, key_of(table, "real").default)
    table.done()
    return run


def read_outputs(table: Table, vehicle: dict[str, Any], sensors: SensorTables, duration_s: float) -> dict[str, Any]:
    """`[outputs]`: a signal without its index stands for all of them."""
    wheel_count = len(vehicle["wheel"])
    signals = read_signals(table, *output_signals(vehicle), wheel_count, missing_outputs(vehicle, sensors))
    return read_interval(table, signals, duration_s)


def read_interval(table: Table, signals: tuple[str, ...], duration_s: float) -> dict[str, Any]:
    """The rest of `[outputs]`, whose `signals` were read."""
    every = read_number(table, "every_s")
    if every is not None and every > duration_s * (1.0 + 1e-12):
        table.fail("every_s", f"{every:g} s is longer than the run of {duration_s:g} s; give that or less")
    if table.has("signals") and not signals:
        table.fail("signals", "is empty; name some, or take it out for the usual ones")
    table.done()
    return {"signals": signals, "every_s": every}


def read_signals(table: Table, lengths: dict[str, int], per_wheel: Sequence[str], wheel_count: int,
                 missing: Mapping[str, str]) -> tuple[str, ...]:
    """The list `signals`; none is named twice. `missing`: those that the scene lacks, and why."""
    signals: list[str] = []
    for signal in table.texts("signals", ()):
        if signal in missing:
            table.fail("signals", f"{signal} {missing[signal]}, or take the signal out")
        length = wheel_count if signal in per_wheel else lengths.get(signal, 0)
        if length:
            every = [f"{signal}[{i}]" for i in range(1, length + 1)]
            signals += [each for each in every if each not in missing]
        elif signal not in per_wheel:
            check_signal(table, "signals", signal, lengths, per_wheel, wheel_count)
            signals.append(signal)
    for number, signal in enumerate(signals):
        if signal in signals[:number]:
            table.fail("signals", f"names {signal} twice; keep one of them")
    return tuple(signals)


def read_rig(table: Table, wheels: Sequence[dict[str, Any]], hinges: Sequence[Hinge] = (),
             slips: bool = False) -> dict[str, Any]:
    """`[rig]`: the first CAN identifier, the frames to use, and the drives of a vehicle that is played."""
    id_base = table.whole("id_base", None)
    if id_base is not None and not 0 <= id_base <= 0x7FF:
        table.fail("id_base", f"is {id_base}; give an 11-bit identifier, 0 to 0x7FF")
    frames = table.texts("frames", ())
    drives = read_drives(table.table("drives"), wheels, hinges, slips) if table.has("drives") else None
    table.done()
    return {"id_base": id_base, "frames": frames, "drives": drives}
