"""Vehicles with hinges from Python: steered wheels, swivel casters, trailers, loaders (articulated.h).

    robot = ArticulatedVehicle({"mass_kg": 30.0, …, "wheel": [{"kind": "fixed", "body": "fork", …}, …],
                                "body": [{"name": "fork", "hinge": "prescribed", "hinge_x_m": 1.2, …}]})
    plant = robot.plant(step_s=0.01)
    plant.run({"voltage_V[1]": 6.0, "steering_rate_rad_per_s[fork]": 0.3}, steps=100)
    plant.motion().hinge_angle_rad

Body 0 is the carriage: mass, inertia and centre of mass of the table are those of body 0 alone with its own wheels. The
places of a wheel are in the frame of its body, whose origin is its hinge.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, fields
from functools import cache
from itertools import count, takewhile
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.articulated_input import by_signal, input_slots, row_length, row_of_hinges
from laconic.core.binding import Core, load
from laconic.core.copies import OwnMemory
from laconic.core.given import finite_number, finite_numbers, items, number, one_of, shown, step_count
from laconic.core.recording import Structs
from laconic.core.spelling import with_radians
from laconic.errors import BadInput, nearest_of

if TYPE_CHECKING:
    from laconic.scene import Scene

HINGES = ("free", "motor", "prescribed", "coordinated")
"""Kinds of hinges; their numbers in the core begin with 1."""
CARRIAGE = "carriage"
"""The name of body 0."""
NOT_NUMBERS = ("name", "parent", "hinge")
NOTHING: Mapping[str, str] = {}
MOTION, REACTIONS = "laconic_articulated_motion", "laconic_articulated_reactions"
OF_HINGES = ("hinge", "body", "friction_torque", "stop_torque")  # how members begin that have one item for each hinge
ALWAYS = ("hinge", "hinge_x_m", "hinge_y_m", "mass_kg", "yaw_inertia_kgm2")
NAME = re.compile(r"[^\W\d][\w-]*")  # of a body: it stands in brackets behind a signal


@cache
def method_names() -> tuple[str, ...]:
    """The methods that step vehicles with hinges: auto, rk4, circle, moebius-4."""
    core = load("double")
    named = (core.text(core.lib.laconic_articulated_method_name(n)) for n in count())
    return tuple(takewhile(bool, named))


@cache
def body_members(core: Core) -> tuple[str, ...]:
    """The numbers of a laconic_body, which are the keys of a body besides NOT_NUMBERS."""
    return tuple(name for name, _ in core.ffi.typeof("laconic_body").fields if name not in NOT_NUMBERS)


@cache
def max_bodies(core: Core) -> int:
    """How many bodies on hinges this build has room for."""
    return int(dict(core.ffi.typeof("laconic_articulated_vehicle").fields)["body"].type.length)


@dataclass(frozen=True)
class ArticulatedMotion:
    """What follows from the state, for H hinges and N wheels. Lists of bodies begin with body 1."""

    velocity_m_per_s: np.ndarray       # (2,)  of the centre of mass of body 0, body axes
    yaw_rate_rad_per_s: float
    x_m: float                         # of that point
    y_m: float
    heading_rad: float                 # not wrapped
    hinge_angle_rad: np.ndarray        # (H,)  not wrapped
    hinge_rate_rad_per_s: np.ndarray   # (H,)
    body_x_m: np.ndarray               # (H,)  of the body's hinge, in the world
    body_y_m: np.ndarray               # (H,)
    body_heading_rad: np.ndarray       # (H,)  in (−π, π]
    wheel_speed_rad_per_s: np.ndarray  # (N,)
    wheel_angle_rad: np.ndarray        # (N,)
    energy_J: float                    # kinetic, of all bodies and wheels


@dataclass(frozen=True)
class ArticulatedReactions:
    """Forces that ground and hinges must deliver, for H hinges and N wheels."""

    wheel_torque_Nm: np.ndarray  # (N,)  of motor and input, on the axle
    along_N: np.ndarray          # (N,)  along the roller's axis; of a fixed wheel in rolling direction
    lateral_N: np.ndarray        # (N,)  of fixed wheels, along the axle
    brake_Nm: np.ndarray         # (N,)  of locked wheels
    hinge_torque_Nm: np.ndarray  # (H,)  on the body, the opposite on its parent
    hinge_force_N: np.ndarray    # (H, 2)  of the parent on the body, in the body's axes
    balance: float               # what is left at body 0, over the largest force there: rounding
    largest_N: float             # the largest reaction of a wheel
    no_slip_margin_N: float      # the least of friction limit − reaction; 0 where no loads are given


@cache
def lengths_of(kind: type, wheels: int, hinges: int) -> Mapping[str, int | None]:
    """How many items each member of a dataclass of outputs has; None: it is one number."""
    return {each.name: None if each.type != "np.ndarray" else 2 if each.name == "velocity_m_per_s"
            else hinges if each.name.startswith(OF_HINGES) else wheels for each in fields(kind)}


def members_of(rows: Any, lengths: Mapping[str, int | None]) -> dict[str, Any]:
    """Members of a struct, an item of `Structs.table`, or of several, cut to the items that there are.

    Arrays of one struct are copies, so that who keeps one does not keep the others; of several they are views."""
    if rows.ndim:
        return {name: rows[name].astype(float) if length is None else rows[name][:, :length]
                for name, length in lengths.items()}
    return {name: float(rows[name]) if length is None else rows[name][:length].copy()
            for name, length in lengths.items()}


NEEDS_OF_HINGES = {"hinge_voltage_V": "a motor", "hinge_torque_Nm": 'a hinge that is "free" or "motor"',
                   "steering_rate_rad_per_s": 'a hinge that is "prescribed"'}


class ArticulatedVehicle(OwnMemory):
    """A checked vehicle with hinges in one scalar type; `plant` makes one that moves.

    `table` has the keys of laconic.Vehicle's, and "body": a list of tables with name, parent (a name; the carriage
    where it is left out), hinge ("free", "motor", "prescribed" or "coordinated"), hinge_x_m, hinge_y_m, mass_kg,
    yaw_inertia_kgm2 and, optional, com_x_m, com_y_m, damping_Nms, stiffness_Nm, rest_rad, gain_Nm_per_V. A parent
    comes before its bodies. A wheel has its body's name as "body". Raises BadInput for a key that is unknown, missing
    or no number, Refused for numbers that make no vehicle; both name the field.
    """

    def __init__(self, table: Mapping[str, Any], real: str = "double"):
        self._build(load(real), table)
        self.model, why = self.core.ffi.new("laconic_articulated_model *"), self.core.why()
        self.core.check(self.core.lib.laconic_articulated_prepare(self.model, self.c, why), why)

    def _build(self, core: Core, table: Mapping[str, Any], more: Mapping[str, str] = NOTHING) -> list[dict[str, Any]]:
        """Fills `c` from a table; `more`: further keys of bodies, and what each is. Returns all bodies."""
        if not isinstance(table, Mapping):
            raise BadInput(f"vehicle: {shown(table)} is no table; give a mapping from keys to numbers")
        bodies = [_body(core, name, each, more) for name, each in items("vehicle.body", table.get("body", ()))]
        self.core, self.names = core, tuple(str(body["name"]) for body in bodies)
        _check_names(self.names)
        wheels = [dict(each) if isinstance(each, Mapping) else each
                  for _, each in items("vehicle.wheel", table.get("wheel", ()))]
        of_wheel = [self._number(f"vehicle.wheel[{i}].body", wheel.pop("body", CARRIAGE), len(bodies))
                    if isinstance(wheel, dict) else 0 for i, wheel in enumerate(wheels, 1)]
        base = core.vehicle({key: value for key, value in table.items() if key not in ("body", "wheel")}
                            | {"wheel": wheels})
        self.c = core.ffi.new("laconic_articulated_vehicle *", {"base": base[0], "body_count": len(bodies)})
        for at, of_body in enumerate(of_wheel[: core.max_wheels]):
            self.c.wheel_body[at] = of_body
        for at, body in enumerate(bodies[: max_bodies(core)]):
            self._set_body(at, body)
        return bodies

    @classmethod
    def of(cls, scene: Scene) -> ArticulatedVehicle:
        """That of a scene with hinges, in the scene's scalar type; BadInput for any other."""
        from laconic.scene import check_scene  # which is above this room

        if not check_scene(scene).has_hinges:
            raise BadInput(f"{scene.path}: has no bodies on hinges; make a laconic.Vehicle of it")
        return scene.articulated_vehicle(scene.core())

    def _set_body(self, at: int, body: Mapping[str, Any]) -> None:
        target = self.c.body[at]
        target.parent = self._number(f"vehicle.body[{at + 1}].parent", body.get("parent", CARRIAGE), at)
        target.hinge = HINGES.index(body["hinge"]) + 1
        for key in body_members(self.core):
            setattr(target, key, body.get(key, 0.0))

    def _number(self, name: str, given: Any, known: int) -> int:
        """The number of a body by its name; one of those before the first `known`."""
        if given == CARRIAGE:
            return 0
        names = self.names[:known]
        if given in self.names and given not in names:
            raise BadInput(f"{name}: {shown(given)} comes later; give a parent before its bodies")
        return names.index(one_of(name, given, (CARRIAGE, *names))) + 1

    @property
    def wheel_count(self) -> int:
        """N."""
        return int(self.model.wheel_count)

    @property
    def body_count(self) -> int:
        """H: the bodies besides the carriage, each with one hinge."""
        return int(self.model.body_count)

    def motion_of(self, rows: Any) -> ArticulatedMotion:
        """A laconic_articulated_motion, an item of `Structs.table`; of many rows with arrays whose first axis they are.
        """
        return ArticulatedMotion(**members_of(rows, self._lengths(ArticulatedMotion)))

    def reactions_of(self, rows: Any) -> ArticulatedReactions:
        """The same of a laconic_articulated_reactions."""
        return ArticulatedReactions(**members_of(rows, self._lengths(ArticulatedReactions)))

    def _lengths(self, kind: type) -> Mapping[str, int | None]:
        return lengths_of(kind, self.wheel_count, self.body_count)

    @property
    def is_coordinated(self) -> bool:
        """Whether a twist coordinates hinges, so that the carriage moves along the twist alone."""
        return bool(self.model.coordinated)

    def input_row(self, values: Mapping[str, float | Sequence[float]] | None = None) -> np.ndarray:
        """A row of input numbers from names: those of every vehicle, and hinge_voltage_V, hinge_torque_Nm and
        steering_rate_rad_per_s (a list with one number for each hinge, or one for a name: hinge_torque_Nm[fork]), and
        steering_twist (3 numbers). BadInput for what is no signal, no number or no hinge."""
        row = row_of_hinges(self.core, self.names, self.wheel_count, {} if values is None else values)
        self._check_idle(row)
        return row

    def _check_idle(self, row: np.ndarray) -> None:
        """BadInput for a number of a row that this vehicle does not read."""
        for at in self._given(row, "voltage_V[1]", self.wheel_count):
            if not self.model.wheel[at].gain_Nm_per_V:
                raise BadInput(f"voltage_V[{at + 1}]: would do nothing, wheel {at + 1} has no motor; give 0, or drive "
                               f"it by axle_torque_Nm[{at + 1}]")
        prescribed, coordinated = (self.core.lib.LACONIC_MOTION_PRESCRIBED, self.core.lib.LACONIC_MOTION_COORDINATED)
        for signal, needs in NEEDS_OF_HINGES.items():
            for at in self._given(row, signal, self.body_count):
                link = self.model.link[at]
                is_commanded = link.motion in (prescribed, coordinated)
                is_read = (link.motion == prescribed if signal == "steering_rate_rad_per_s"
                           else not is_commanded and (signal != "hinge_voltage_V" or bool(link.gain_Nm_per_V)))
                if not is_read:
                    raise BadInput(f"{signal}[{self.names[at]}]: would do nothing, as it needs {needs}; give 0")

    def _given(self, row: np.ndarray, first: str, count: int) -> list[int]:
        """The items of a signal that are not 0."""
        if not count:
            return []
        start = self.slot(first)
        return np.flatnonzero(row[start : start + count]).tolist()

    def row_of(self, inputs: Mapping[str, float | Sequence[float]] | np.ndarray | None) -> np.ndarray:
        """A row as it is; of names a new one."""
        return inputs if isinstance(inputs, np.ndarray) else self.input_row(inputs)

    def slot(self, signal: str) -> int:
        """Where a signal such as voltage_V[2] or hinge_torque_Nm[fork] stands in a row of input numbers."""
        return self.slots(signal).start

    def slots(self, signal: str) -> range:
        """The same of a signal with several numbers, such as voltage_V."""
        return input_slots(self.core, self.names, signal)

    def plant(self, method: str = "auto", step_s: float = 1e-3, *,
              velocity_m_per_s: Sequence[float] = (0.0, 0.0), yaw_rate_rad_per_s: float = 0.0, x_m: float = 0.0,
              y_m: float = 0.0, heading_rad: float = 0.0, hinge_angle_rad: Sequence[float] | None = None,
              hinge_rate_rad_per_s: Sequence[float] | None = None,
              inputs: Mapping[str, float | Sequence[float]] | np.ndarray | None = None) -> ArticulatedPlant:
        """The vehicle at a start, ready to step by a method of `method_names()`.

        Velocity and yaw rate of the centre of mass of body 0, in body axes; angles and rates of the hinges, one for
        each. The motion becomes the nearest in kinetic energy that the wheels and the commands of `inputs` allow:
        `plant.changed_m_per_s` is the size of the change. Raises Refused for a start or step that cannot be taken.
        """
        hinges = self.body_count
        zeros = [0.0] * hinges
        start = self.core.ffi.new("laconic_articulated_start *", {
            "velocity_m_per_s": finite_numbers("velocity_m_per_s", velocity_m_per_s, 2),
            "yaw_rate_rad_per_s": finite_number("yaw_rate_rad_per_s", yaw_rate_rad_per_s),
            "x_m": finite_number("x_m", x_m), "y_m": finite_number("y_m", y_m),
            "heading_rad": finite_number("heading_rad", heading_rad),
            "hinge_angle_rad": finite_numbers("hinge_angle_rad", hinge_angle_rad or zeros, hinges),
            "hinge_rate_rad_per_s": finite_numbers("hinge_rate_rad_per_s", hinge_rate_rad_per_s or zeros, hinges)})
        return ArticulatedPlant(self, method, step_s, start, self.row_of(inputs))


class ArticulatedPlant(OwnMemory):
    """Steps and outputs of one vehicle with hinges. A copy moves by itself from where this is."""

    def __init__(self, vehicle: ArticulatedVehicle, method: str, step_s: float, start: Any, row: np.ndarray):
        self.core, self.vehicle, self.steps = vehicle.core, vehicle, 0
        ffi = self.core.ffi
        number_of = {name: at for at, name in enumerate(method_names())}
        self._method = number_of[one_of("method", method, number_of)]
        self.c = ffi.new("laconic_articulated_state *")
        self.integrator = ffi.new("laconic_articulated_integrator *")
        self.set_step(step_s)
        changed, why = ffi.new("laconic_real *"), self.core.why()
        self.core.check(self.core.lib.laconic_articulated_state_set(
            self.c, changed, vehicle.model, start, self._input(row), why), why)
        self.changed_m_per_s = float(changed[0])

    # ---- motion

    @property
    def step_s(self) -> float:
        """The step, as the core's scalar type has it."""
        return float(self.integrator.step_s)

    @property
    def method(self) -> str:
        """The method's name."""
        return method_names()[self._method]

    def set_step(self, step_s: float) -> None:
        """Another step size from here on; Refused for one that the method cannot take."""
        why = self.core.why()
        self.core.check(self.core.lib.laconic_articulated_integrator_prepare(
            self.integrator, self._method, self.vehicle.model, number("step_s", step_s), why), why)

    def run(self, inputs: Mapping[str, float | Sequence[float]] | np.ndarray | None = None, steps: int = 1) -> None:
        """Steps with the inputs held: names as `ArticulatedVehicle.input_row` has them, or a row that it made.

        Refused leaves the state before the refused step. Rates and twist that jump keep the momenta that the wheels
        allow."""
        held = self._input(self.vehicle.row_of(inputs))
        step, model, why = self.core.lib.laconic_articulated_step, self.vehicle.model, self.core.why()
        for _ in range(step_count("steps", steps)):
            if step(model, self.integrator, self.c, held, held, why) != 0:
                raise by_signal(self.core.refusal(why), self.vehicle.names)
            self.steps += 1

    def step(self, start: Any, end: Any) -> None:
        """One step along inputs that are linear from `start` to `end`, each given as for `run`."""
        self.follow(np.array([[self.vehicle.row_of(each) for each in (start, end)]]))

    def follow(self, rows: np.ndarray, ramped: bool = True, before_each: Callable[[], None] = lambda: None) -> None:
        """One step for each of `rows`, shape (steps, 2, numbers of a row): inputs at its start and end, linear in
        between; not `ramped`: rates and twists have their derivatives in the rows, for a cubic. `before_each`: is
        called before each step. Refused leaves the state before the refused step."""
        lib, ffi, model, why = self.core.lib, self.core.ffi, self.vehicle.model, self.core.why()
        size = row_length(self.core)
        table = np.ascontiguousarray(rows, self.core.dtype)
        if table.ndim != 3 or table.shape[1:] != (2, size):
            raise BadInput(f"rows: has the shape {table.shape}, not (steps, 2, {size}); give the start and the end of "
                           "each step")
        pairs = ffi.from_buffer("laconic_articulated_input[]", table, require_writable=True)
        ramp, step, h = lib.laconic_articulated_ramp, lib.laconic_articulated_step, self.integrator.step_s
        for at in range(0, 2 * len(table), 2):
            before_each()
            start, end = pairs + at, pairs + at + 1
            if ramped:
                ramp(start, end, h)
            if step(model, self.integrator, self.c, start, end, why) != 0:
                raise by_signal(self.core.refusal(why), self.vehicle.names)
            self.steps += 1

    def twin(self, step_s: float) -> ArticulatedPlant:
        """The same vehicle at this moment, in steps of another size; Refused for one that the method cannot take."""
        found = copy(self)
        found.c, found.steps = self.save(), 0
        found.integrator = self.core.ffi.new("laconic_articulated_integrator *")
        found.set_step(step_s)
        return found

    def save(self) -> Any:
        """A copy of the state, for `restore`."""
        return self.core.ffi.new("laconic_articulated_state *", self.c[0])

    def restore(self, state: Any, steps: int) -> None:
        """Back to a state that `save` of a plant of this vehicle gave."""
        ffi = self.core.ffi
        if not isinstance(state, ffi.CData) or ffi.typeof(state) is not ffi.typeof("laconic_articulated_state *"):
            raise BadInput(f"state: {shown(state)} is not a saved state of this core; give what plant.save() returned")
        self.c[0], self.steps = state[0], step_count("steps", steps)

    def _input(self, row: np.ndarray) -> Any:
        held, data = self.core.ffi.new("laconic_articulated_input *"), row.astype(self.core.dtype).tobytes()
        if row.size != (size := row_length(self.core)):
            raise BadInput(f"inputs: a row has {size} numbers, this one {row.size}; make it with input_row")
        self.core.ffi.memmove(held, data, len(data))
        return held

    # ---- outputs

    def motion(self) -> ArticulatedMotion:
        """Velocities, pose, hinges, poses of bodies, wheels and energy of this moment."""
        found = Structs(self.core, MOTION, 1)
        self.see_motion(found.c)
        return self.vehicle.motion_of(found.table[0])

    def see_motion(self, found: Any) -> None:
        """The same into a laconic_articulated_motion, which `ArticulatedVehicle.motion_of` reads."""
        self.core.lib.laconic_articulated_motion_of(found, self.vehicle.model, self.c)

    def c_motion(self) -> Any:
        """The same as a laconic_articulated_motion, for callers that read a few of its members in every step."""
        found = self.core.ffi.new(f"{MOTION} *")
        self.see_motion(found)
        return found

    def hinge_angles(self) -> list[float]:
        """The angles of `motion` alone."""
        return list(self.core.ffi.unpack(self.c_motion().hinge_angle_rad, self.vehicle.body_count))

    def reactions(self, inputs: Any = None, normal_N: Sequence[float] | np.ndarray | None = None
                  ) -> ArticulatedReactions:
        """What ground and hinges must deliver at this moment with these inputs, given as for `run`.

        `normal_N`: a load for each wheel, for the margin alone. Refused where wheels or twist do not allow a motion."""
        row = self.vehicle.row_of(inputs)
        loads = self.core.ffi.NULL if normal_N is None else self.core.ffi.new(
            "laconic_real[]", finite_numbers("normal_N", np.asarray(normal_N), self.vehicle.wheel_count) or [0.0])
        found = Structs(self.core, REACTIONS, 1)
        self.see_reactions(found.c, row, loads)
        return self.vehicle.reactions_of(found.table[0])

    def see_reactions(self, found: Any, row: np.ndarray, loads: Any = None) -> None:
        """The same into a laconic_articulated_reactions, which `ArticulatedVehicle.reactions_of` reads."""
        why = self.core.why()
        self.core.check(self.core.lib.laconic_articulated_reactions_of(
            found, self.vehicle.model, self.c, self._input(row), self.core.ffi.NULL if loads is None else loads, why),
            why)

    def rates(self, inputs: Any = None) -> tuple[np.ndarray, np.ndarray]:
        """Twists of all bodies and their rates of change, each (H + 1, 3), with inputs as for `run`.

        A row has the velocity of the body's origin in its own axes and its yaw rate; the carriage's origin, in the
        first row, is its centre of mass."""
        rates = self._rates(inputs)
        bodies = range(self.vehicle.body_count + 1)
        twist, rate = (np.array([[each[b].x, each[b].y, each[b].z] for b in bodies])
                       for each in (rates.twist, rates.twist_rate))
        return twist, rate

    def acceleration(self, inputs: Any = None) -> np.ndarray:
        """Acceleration of the centre of mass of body 0 in body axes, shape (2,) [m/s²], with inputs as for `run`."""
        rates = self._rates(inputs)
        twist, rate = rates.twist[0], rates.twist_rate[0]
        return np.array([rate.x - twist.z * twist.y, rate.y + twist.z * twist.x])

    def _rates(self, inputs: Any) -> Any:
        row = self.vehicle.row_of(inputs)
        rates, why = self.core.ffi.new("laconic_articulated_rates *"), self.core.why()
        self.core.check(self.core.lib.laconic_articulated_rates_of(
            rates, self.vehicle.model, self.c, self._input(row), why), why)
        return rates


def _body(core: Core, name: str, given: Any, more: Mapping[str, str]) -> dict[str, Any]:
    """One table of a body: its keys are known and there, and its numbers are numbers."""
    if not isinstance(given, Mapping):
        raise BadInput(f"{name}: {shown(given)} is no table; give a mapping from keys to numbers")
    members = (*body_members(core), *(key for key, kind in more.items() if kind == "number"))
    plain = with_radians(name, given, members)
    known = (*NOT_NUMBERS, *body_members(core), *more)
    if unknown := [key for key in plain if key not in known]:
        raise BadInput(f"{name}.{unknown[0]}: unknown key; {nearest_of(str(unknown[0]), known)}")
    for key in ALWAYS:
        if key not in plain:
            raise BadInput(f"{name}.{key}: is missing; give "
                           + (f"one of {', '.join(HINGES)}" if key == "hinge" else "a number"))
    one_of(f"{name}.hinge", plain["hinge"], HINGES)
    own = {"name": name.replace("vehicle.body[", "body_").rstrip("]"), **plain}
    return own | {key: number(f"{name}.{key}", plain[key]) for key in members if key in plain}


def _check_names(names: Sequence[str]) -> None:
    for at, name in enumerate(names):
        if not NAME.fullmatch(name):
            raise BadInput(f"vehicle.body[{at + 1}].name: {shown(name)} is not usable in the name of a signal; use "
                           "letters, digits, _ and -, with a letter first")
        if name in (CARRIAGE, *names[:at]):
            raise BadInput(f"vehicle.body[{at + 1}].name: {shown(name)} is taken; give each body another name")
