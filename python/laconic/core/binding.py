"""The shipping C core from Python: loads the shared library and gives numpy arrays; all physics is in the library.

    core = load("double")
    vehicle = core.vehicle({"mass_kg": 10.0, "wheel": [{"kind": "omni", "x_m": 0.1}], …})
    plant = core.plant(vehicle, "auto", 1e-3)
    plant.run({"voltage_V": [2.0, -2.0]}, steps=1000)
    plant.nu, plant.pose, plant.wheel_speeds()

What the core refuses is raised as `Refused`, with its status, field, item and message.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from laconic.base.paths import declarations, library
from laconic.core.copies import register
from laconic.core.fields import ABOVE_0, OF_GROUND, Field, fields_from, set_own_zeros
from laconic.core.given import c_object, check_there, items, number, numbers, one_of, several, table
from laconic.core.inputs import input_fields, row_of, slots_of
from laconic.core.plant import Plant
from laconic.core.spelling import wheel_in_core_terms
from laconic.errors import BadInput, Refused

REALS = ("double", "single")
WHEEL_KINDS = {"omni": "ROLLER", "mecanum": "ROLLER", "roller": "ROLLER", "fixed": "FIXED"}
OMNI_ROLLER_RAD = math.pi / 2
NEEDS_ROLLER = ("mecanum", "roller")  # kinds whose rollers have no usual angle
BESIDE_MOTOR = ("motor_gain_Nm_per_V", "motor_damping_Nms")  # of a vehicle, which its motor determines


@dataclass(frozen=True)
class Matrices:
    """The matrices of the paper for one vehicle."""

    wheel_rows: np.ndarray        # (N, 3)  Ξ
    inertia: np.ndarray           # (3, 3)  A
    inverse_inertia: np.ndarray   # (3, 3)  A⁻¹; with constraints G Gᵀ
    constraint_rows: np.ndarray   # (constraints, 3)  C
    lambda_yaw: float             # Λ
    lambda_wheel: float           # λ


def load(real: str = "double") -> Core:
    """The core in one scalar type, loaded once."""
    return _loaded(one_of("real", real, REALS))


@cache
def _loaded(real: str) -> Core:
    ffi = declarations(f"laconic_cdef_{real}")
    core = Core(real, ffi, ffi.dlopen(str(library(f"laconic_{real}"))))
    register(core)
    return core


class Core:
    """The C functions of one scalar type, with Python's types and exceptions."""

    def __init__(self, real: str, ffi: Any, lib: Any):
        self.real, self.ffi, self.lib = real, ffi, lib
        self.dtype: np.dtype[Any] = np.dtype(np.float64 if ffi.sizeof("laconic_real") == 8 else np.float32)
        fields = dict(ffi.typeof("laconic_vehicle").fields)
        self.max_wheels: int = fields["wheel"].type.length
        self.max_supports: int = fields["support"].type.length
        samples = dict(ffi.typeof("laconic_sensors").fields)["sample"].type.length
        self.most_delay_steps: int = samples - 1
        self.fields = fields_from(ffi, lib)
        self.sensor_fields = fields_from(ffi, lib, "sensor_")
        self._of_table: dict[str, list[Field]] = {}  # asked for whenever a vehicle is made
        self.method_names = self._method_names()
        self.input_fields = input_fields(self)
        self.input_length = ffi.sizeof("laconic_input") // self.dtype.itemsize

    def __reduce__(self) -> tuple[Any, ...]:
        """There is one core of each scalar type in a process."""
        return load, (self.real,)

    def _method_names(self) -> tuple[str, ...]:
        methods = (self.lib.laconic_method_by_number(n) for n in range(self.lib.LACONIC_METHOD_COUNT))
        return tuple(self.text(m.name) for m in methods if m != self.ffi.NULL)

    def fields_of(self, table: str) -> list[Field]:
        """The fields that are keys of a scene's table: "vehicle", "vehicle.wheel[#]", "sensors.imu" …"""
        if table not in self._of_table:
            every = (*self.fields, *self.sensor_fields)
            self._of_table[table] = [field for field in every if field.table == table and not field.counts]
        return self._of_table[table]

    def own_fields(self, stem: str = "") -> list[Field]:
        """The values that a wheel may have of its own, whose keys begin with `stem`."""
        return [field for field in self.fields_of("vehicle.wheel[#]") if field.is_own and field.key.startswith(stem)]

    def text(self, chars: Any) -> str:
        """A C string."""
        return self.ffi.string(chars).decode()

    def check(self, status: int, why: Any) -> None:
        """Raises Refused unless the status is OK."""
        if status != self.lib.LACONIC_OK:
            raise self.refusal(why)

    def refusal(self, why: Any) -> Refused:
        """A laconic_refusal as an exception."""
        size = 400
        text = self.ffi.new("char[]", size)
        self.lib.laconic_message(why, text, size)
        return Refused(
            self.text(self.lib.laconic_status_name(why.status)), self.text(self.lib.laconic_field_name(why.field)),
            int(why.item), self.text(text), value=float(why.value), limit=float(why.limit))

    def why(self) -> Any:
        """Room for a refusal."""
        return self.ffi.new("laconic_refusal *")

    # ---- vehicle and model

    def vehicle(self, data: Mapping[str, Any]) -> Any:
        """A laconic_vehicle from a mapping with the keys of `[vehicle]`, spelled as in a scene; `motor` is fitted.

        What 0 is no value of must be there; all else that is left out is 0. Values are not checked. Wheels beyond the
        core's array are only counted, so that the check refuses them.
        """
        if isinstance(data, Mapping) and data.get("body"):
            raise BadInput("vehicle.body: this does not take vehicles with hinges yet; make a "
                           "laconic.ArticulatedVehicle, or use laconic simulate")
        parts = ("wheel", "support", "motor", "payload", "ground", "drive")
        plain: dict[str, Any] = table(self, "vehicle", "vehicle", data, parts)
        for part, path in (("payload", "vehicle.payload"), ("ground", "ground"), ("drive", "vehicle.drive")):
            if part in data:
                plain[part] = table(self, path, path, data[part])
        vehicle = self.ffi.new("laconic_vehicle *", plain)
        wheels = [(name, wheel_in_core_terms(self, name, wheel))
                  for name, wheel in items("vehicle.wheel", data.get("wheel", ()))]
        supports = list(items("vehicle.support", data.get("support", ())))
        vehicle.wheel_count, vehicle.support_count = len(wheels), len(supports)
        for target, (name, wheel) in zip(vehicle.wheel, wheels, strict=False):
            self._set_wheel(target, name, wheel)
        for target, (name, support) in zip(vehicle.support, supports, strict=False):
            self._set_support(target, name, support)
        given = [wheel for _, wheel in wheels]
        set_own_zeros(vehicle, given, self.own_fields("inertia_"))  # before the rotor's is added
        if "motor" in data:
            self._fit_motor(vehicle, table(self, "vehicle.motor", "vehicle.motor", data["motor"]))
            if beside := [key for key in BESIDE_MOTOR if plain.get(key)]:
                raise BadInput(f"vehicle.{beside[0]}: is given besides vehicle.motor, from which it follows; keep one")
        else:
            _check_windings(plain.get("drive", {}))
        for stem in ("motor_", *OF_GROUND):
            set_own_zeros(vehicle, given, self.own_fields(stem))
        check_there(self, "vehicle", "vehicle", plain, "ALWAYS")
        return vehicle

    def _set_wheel(self, target: Any, name: str, wheel: Mapping[str, Any]) -> None:
        read = table(self, "vehicle.wheel[#]", name, wheel, ("kind",))
        given = {"roller_rad": OMNI_ROLLER_RAD, **read}
        if "kind" not in wheel:
            raise BadInput(f"{name}.kind: is missing; give one of {', '.join(sorted(WHEEL_KINDS))}")
        kind = one_of(f"{name}.kind", wheel.get("kind"), WHEEL_KINDS)
        if kind in NEEDS_ROLLER and "roller_rad" not in read:
            raise BadInput(f"{name}.roller_rad: is missing; give the angle between axle and rollers, such as "
                           f"{math.pi / 4:g} (45°)")
        target.kind = getattr(self.lib, f"LACONIC_WHEEL_{WHEEL_KINDS[kind]}")
        fields = {field.key: field for field in self.fields_of("vehicle.wheel[#]")}
        for key, value in given.items():
            setattr(target, fields[key].member, not value if fields[key].kind == "ABSENCE" else value)
        for key, whose in ABOVE_0.items():
            if key in given and getattr(target, fields[key].member) <= 0:  # there it would mean the vehicle's
                raise BadInput(f"{name}.{key}: {given[key]:g} is not positive; give a value above 0, or take it out "
                               f"for {whose}")

    def _set_support(self, target: Any, name: str, support: Mapping[str, Any]) -> None:
        given = table(self, "vehicle.support[#]", name, support)
        check_there(self, "vehicle.support[#]", name, given, "EACH_SUPPORT")
        for key, value in given.items():
            setattr(target, key, value)

    def _fit_motor(self, vehicle: Any, motor: Mapping[str, float]) -> None:
        why = self.why()
        check_there(self, "vehicle.motor", "vehicle.motor", motor, "ALWAYS")
        self.check(self.lib.laconic_motor_fit(vehicle, self.ffi.new("laconic_motor *", dict(motor)), why), why)

    def check_vehicle(self, vehicle: Any) -> None:
        """Raises Refused unless every number of the vehicle is usable."""
        why = self.why()
        self.check(self.lib.laconic_vehicle_check(c_object(self, "vehicle", vehicle), why), why)

    def prepare(self, vehicle: Any) -> Any:
        """The prepared laconic_model."""
        model, why = self.ffi.new("laconic_model *"), self.why()
        self.check(self.lib.laconic_prepare(model, c_object(self, "vehicle", vehicle), why), why)
        return model

    def matrices(self, vehicle: Any) -> Matrices:
        """Ξ, A, A⁻¹, C, Λ, λ."""
        found, why, vehicle = self.ffi.new("laconic_matrices *"), self.why(), c_object(self, "vehicle", vehicle)
        self.check(self.lib.laconic_matrices_of(found, vehicle, why), why)
        return Matrices(
            self.numbers(found.wheel_rows, self.max_wheels, 3)[: vehicle.wheel_count],
            self.numbers(found.inertia, 3, 3), self.numbers(found.inverse_inertia, 3, 3),
            self.numbers(found.constraint_rows, 2 * self.max_wheels, 3)[: found.constraint_count],
            float(found.lambda_yaw), float(found.lambda_wheel))

    def numbers(self, array: Any, *shape: int) -> np.ndarray:
        """A C array as a numpy array of its own."""
        return np.frombuffer(self.ffi.buffer(array), self.dtype).reshape(shape or -1).copy()

    def check_range(self, what: str, *found: Any) -> None:
        """Refused, as a step would be, where a result is infinite or NaN though all that was given is finite."""
        if not all(np.isfinite(each).all() for each in found):
            raise self.out_of_range(what)

    def out_of_range(self, what: str) -> Refused:
        """That a result is infinite or NaN."""
        return Refused("overflow", what, 0, f"{what}: a result leaves the range of {self.real} precision; check inputs "
                       "and units")

    # ---- input

    def input_offset(self, signal: str) -> int:
        """Where a signal such as voltage_V[2] stands in a row of input numbers."""
        return slots_of(self, signal).start

    def input_row(self, values: Mapping[str, float | Sequence[float]], wheel_count: int | None = None) -> np.ndarray:
        """A row of input numbers from {"voltage_V": [1, 2], "axle_torque_Nm[2]": 3, "body_moment_Nm": 4 …}.

        A list for the wheels needs their number, wheel_count, and has that many items. BadInput for what is no signal,
        no number, for a wheel that is not there, or not as many numbers as the signal has.
        """
        return row_of(self, values, wheel_count)

    def input(self, values: Mapping[str, float | Sequence[float]] | np.ndarray | None = None,
              wheel_count: int | None = None) -> Any:
        """A laconic_input; from names, as input_row takes them, or from a row of input numbers."""
        row = values if isinstance(values, np.ndarray) else row_of(self, {} if values is None else values, wheel_count)
        if row.shape != (self.input_length,):
            raise BadInput(f"input: a row has {self.input_length} numbers, this array has the shape {row.shape}")
        held = self.ffi.new("laconic_input *")
        self.ffi.memmove(held, row.astype(self.dtype).tobytes(), self.ffi.sizeof("laconic_input"))
        return held

    # ---- method and plant

    def method(self, name: str) -> Any:
        """The laconic_method of that name."""
        return self.lib.laconic_method_by_name(one_of("method", name, self.method_names).encode())

    def plant(self, vehicle: Any, method: str, step_s: float, *, nu_rad_per_s: Sequence[float] = (0.0, 0.0, 0.0),
              x_m: float = 0.0, y_m: float = 0.0, heading_rad: float = 0.0,
              wheel_speed_rad_per_s: Sequence[float] = ()) -> Plant:
        """A vehicle that stands at its start, ready to step."""
        vehicle = c_object(self, "vehicle", vehicle)
        speeds = self._wheel_speeds(vehicle, wheel_speed_rad_per_s)
        start = self.ffi.new("laconic_start *", {
            "nu_rad_per_s": numbers("nu_rad_per_s", nu_rad_per_s, 3), "x_m": number("x_m", x_m),
            "y_m": number("y_m", y_m), "heading_rad": number("heading_rad", heading_rad),
            "wheel_speed_rad_per_s": speeds})
        plant, why = self.ffi.new("laconic_plant *"), self.why()
        self.check(self.lib.laconic_plant_start(
            plant, vehicle, self.method(method), number("step_s", step_s), start, why), why)
        return Plant(self, plant)

    def _wheel_speeds(self, vehicle: Any, given: Any) -> list[float]:
        """Those that a start gives; BadInput where wheels roll and have none of their own."""
        many = several(given)
        if many == []:
            return []
        speeds = numbers("wheel_speed_rad_per_s", given if many is None else many, int(vehicle.wheel_count))
        if not self.lib.laconic_vehicle_has_friction(vehicle):
            raise BadInput("wheel_speed_rad_per_s: has no effect on ideal ground, where wheels roll as the vehicle "
                           "moves; give the vehicle a ground with friction_coefficient, or leave it out")
        return speeds

    def steps_in(self, interval_s: float, step_s: float) -> int:
        """The whole number of steps in an interval; Refused when it is none."""
        steps, why = self.ffi.new("uint64_t *"), self.why()
        interval_s, step_s = number("interval_s", interval_s), number("step_s", step_s)
        self.check(self.lib.laconic_steps_in(interval_s, step_s, steps, why), why)
        return int(steps[0])

    def derivative(self, model: Any, nu_rad_per_s: Sequence[float] | np.ndarray, heading_rad: float, held: Any) -> Any:
        """The laconic_rates of (4.7) for Model Exchange and tests."""
        rates = self.ffi.new("laconic_rates *")
        nu = self.ffi.new("laconic_real[3]", numbers("nu_rad_per_s", nu_rad_per_s, 3))
        self.lib.laconic_derivative(rates, c_object(self, "model", model), nu, number("heading_rad", heading_rad),
                                    c_object(self, "input", held))
        return rates


def _check_windings(drive: Mapping[str, Any]) -> None:
    """BadInput for limits of a drive whose motors' windings are not known; the core has them by a motor alone."""
    limits = [key for key in ("supply_V", "current_limit_A") if drive.get(key, 0.0) > 0.0]
    if limits and "winding_resistance_ohm" not in drive:
        raise BadInput(f"vehicle.drive.{limits[0]}: limits a current through windings, and nothing gives their "
                       "resistance; give vehicle.motor with its resistance_ohm, or take vehicle.drive out")
