"""Derivatives of a plant's next step: how the state after it changes with state, input and vehicle before it.

    step = plant.step_derivatives({"voltage_V": [6.0, -6.0, 0.0]})
    jacobian = step.jacobian()                    # A and B of the step, as Kalman filters and controllers take them
    change = step.tangent(vehicle={"mass_kg": 1.0, "wheel[2].x_m": 0.0})

States are (ν1, ν2, ν3, x, y, θ, χ1 … χN), inputs (voltage_V, axle_torque_Nm, body_force_N, body_moment_Nm,
world_force_N, world_force_point_m), all in SI units and rad.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from laconic.core.copies import OwnMemory
from laconic.core.fields import Field
from laconic.core.given import by_names, finite_number, finite_numbers, flag, name_list, shown
from laconic.core.inputs import check_finite_input
from laconic.errors import BadInput, nearest_of

if TYPE_CHECKING:
    from laconic.core.plant import Plant

SINGLE_INPUTS = ("body_force_N", "body_moment_Nm", "world_force_N", "world_force_point_m")


def check_smooth(plant: Plant) -> None:
    """BadInput for what is no plant, and for a vehicle with friction, whose step has no derivative."""
    from laconic.core.plant import Plant
    if not isinstance(plant, Plant):
        raise BadInput(f"plant: {shown(plant)} is no plant; make one with vehicle.plant(method, step_s=…)")
    if plant.has_friction:
        raise BadInput("plant: has ground friction or limits of its drive, and such a step is not smooth; take the "
                       "vehicle without ground.friction_coefficient and drive")


@dataclass(frozen=True)
class StepJacobian:
    """δs⁺ = by_state δs + by_input δu for a vehicle with N wheels, s and u as in this file's head."""

    by_state: np.ndarray  # (6 + N, 6 + N)
    by_input: np.ndarray  # (6 + N, 2 N + 7)
    state_names: tuple[str, ...]
    input_names: tuple[str, ...]


class StepDerivatives(OwnMemory):
    """The derivatives of the step that `plant` takes next with the input held, which is given as for `Plant.run`.

    Derivatives of the method's own formulas, exact but for rounding. The plant stays as it is. Raises Refused where the
    step would be refused, BadInput for a vehicle with friction, whose step is not smooth.
    """

    RENEWED: ClassVar[dict[str, Any]] = {"_step": ()}

    def __init__(self, plant: Plant, held: Any = None):
        check_smooth(plant)
        self.plant, self.core, self.wheels = plant, plant.core, plant.wheel_count
        self.held = plant.input_of(held)
        self._step = self._step_of_plant()

    def _step_of_plant(self) -> tuple[Any, ...]:
        at, c = self.core.ffi.addressof, self.plant.c
        return at(c, "model"), at(c, "integrator"), at(c, "state"), self.held

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._step = self._step_of_plant()

    @property
    def state_names(self) -> tuple[str, ...]:
        """The names of rows, in their order."""
        head = tuple(f"nu_rad_per_s[{k}]" for k in (1, 2, 3))
        return (*head, "x_m", "y_m", "heading_rad", *(f"wheel_angle_rad[{i + 1}]" for i in range(self.wheels)))

    @property
    def input_names(self) -> tuple[str, ...]:
        """The names of columns by the input, in their order."""
        each = tuple(f"{name}[{i + 1}]" for name in ("voltage_V", "axle_torque_Nm") for i in range(self.wheels))
        return (*each, "body_force_N[1]", "body_force_N[2]", "body_moment_Nm",
                *(f"{name}[{k}]" for name in ("world_force_N", "world_force_point_m") for k in (1, 2)))

    def jacobian(self, world_force: bool = False) -> StepJacobian:
        """All columns; those by a world force are 0 unless one acts, or `world_force` asks for them."""
        ffi, lib, size = self.core.ffi, self.core.lib, 6 + self.wheels
        found = ffi.new("laconic_step_jacobian *")
        self._check(lib.laconic_step_jacobian_of(found, *self._step, flag("world_force", world_force)))
        by_state = np.zeros((size, size), self.core.dtype)
        by_input = np.zeros((size, 2 * self.wheels + 7), self.core.dtype)
        lib.laconic_jacobian_by_state(self._numbers(by_state), found, self._step[0])
        lib.laconic_jacobian_by_input(self._numbers(by_input), found, self._step[0])
        return StepJacobian(by_state, by_input, self.state_names, self.input_names)

    def tangent(self, state: ArrayLike | None = None, held: Mapping[str, float | Sequence[float]] | None = None,
                vehicle: Mapping[str, float] | None = None) -> np.ndarray:
        """δs⁺, shape (6 + N,), along changes of the state (6 + N,), the input and the vehicle.

        `vehicle` names numbers of the scene's [vehicle] with their changes: {"mass_kg": 1.0, "wheel[2].x_m": 0.01,
        "payload.mass_kg": 1.0, "ground.slope_rad": 0.1}. A wheel's number may be varied where the wheel has its own.
        """
        ffi, after = self.core.ffi, self.core.ffi.new("laconic_state_change *")
        varied = ffi.NULL if held is None else self._input_change(held)
        model = ffi.NULL if vehicle is None else self.model_change(vehicle)
        before = self._change([0.0] * (6 + self.wheels) if state is None else state)
        self._check(self.core.lib.laconic_step_tangent(after, *self._step, before, varied, model))
        return self._in_range("tangent", self._row(after))

    def adjoint(self, gradient: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Gradients by state (6 + N,) and input (2 N + 7,) before the step, from that by the state after it."""
        found, held = self.core.ffi.new("laconic_state_change *"), self.core.ffi.new("laconic_input *")
        self._check(self.core.lib.laconic_step_adjoint(
            found, held, self.core.ffi.NULL, *self._step, self._change(gradient)))
        return self._in_range("adjoint", self._row(found)), self._in_range("adjoint", self._input_row(held))

    def vehicle_gradient(self, gradient: ArrayLike, names: Sequence[str]) -> np.ndarray:
        """Gradients by numbers of the vehicle, named as for `tangent`, from that by the state after the step."""
        ffi, lib, wanted = self.core.ffi, self.core.lib, name_list("names", names)
        before, by_model = ffi.new("laconic_state_change *"), ffi.new("laconic_model_change *")
        self._check(lib.laconic_step_adjoint(before, ffi.NULL, by_model, *self._step, self._change(gradient)))
        weights = self._flat(by_model)
        with np.errstate(over="ignore", invalid="ignore"):  # which is refused
            found = np.array([weights @ self._flat(self.model_change({name: 1.0})) for name in wanted])
        return self._in_range("vehicle_gradient", found)

    def model_change(self, vehicle: Mapping[str, float]) -> Any:
        """The laconic_model_change along changes of numbers of the vehicle."""
        by, change = self.core.ffi.new("laconic_vehicle *"), self.core.ffi.new("laconic_model_change *")
        self.set_numbers(by, vehicle)
        self._check(self.core.lib.laconic_model_tangent(
            change, self._step[0], self.core.ffi.addressof(self.plant.c, "vehicle"), by))
        return change

    def set_numbers(self, vehicle: Any, values: Mapping[str, float]) -> None:
        """Sets numbers of a laconic_vehicle, named as for `tangent`."""
        for name, value in by_names("vehicle", values).items():
            self._vary(vehicle, name, finite_number(name, value))

    # ---- between numpy and C

    def _check(self, status: int) -> None:
        if status == self.core.lib.LACONIC_OK:
            return
        why = self.core.why()
        self.core.lib.laconic_step_refusal(why, status, *self._step, 1)
        raise self.core.refusal(why)

    def _in_range(self, what: str, found: np.ndarray) -> np.ndarray:
        self.core.check_range(what, found)
        return found

    def _numbers(self, array: np.ndarray) -> Any:
        return self.core.ffi.cast("laconic_real *", array.ctypes.data)

    def _change(self, values: ArrayLike) -> Any:
        row = finite_numbers("change of the state", values, 6 + self.wheels)
        return self.core.ffi.new("laconic_state_change *", {
            "nu_rad_per_s": row[:3], "x_m": row[3], "y_m": row[4], "heading_rad": row[5], "wheel_angle_rad": row[6:]})

    def _input_change(self, held: Any) -> Any:
        return check_finite_input(self.core, self.plant.input_of(held), "change of the input: ")

    def _flat(self, struct: Any) -> np.ndarray:
        return np.frombuffer(self.core.ffi.buffer(struct), self.core.dtype).copy()

    def _row(self, change: Any) -> np.ndarray:
        return self._flat(change)[: 6 + self.wheels]

    def _input_row(self, held: Any) -> np.ndarray:
        flat, row = self._flat(held), []
        for name in ("voltage_V", "axle_torque_Nm"):
            start = self.core.input_offset(name)
            row.append(flat[start : start + self.wheels])
        start = self.core.input_offset(SINGLE_INPUTS[0])
        return np.concatenate([*row, flat[start : start + 7]])

    def _vary(self, by: Any, name: str, value: float) -> None:
        head, _, key = name.rpartition(".")
        if not isinstance(name, str):
            raise BadInput(f"vehicle: {shown(name)} is no name of a number; give one such as \"mass_kg\"")
        item = re.fullmatch(r"wheel\[(\d{1,4})\]", head)
        if item and not 1 <= int(item[1]) <= self.wheels:
            raise BadInput(f"{name}: there is no such wheel; give 1 to {self.wheels}")
        tables = {"": ("vehicle", by), "payload": ("vehicle.payload", by.payload), "ground": ("ground", by.ground)}
        if item:
            table, target = "vehicle.wheel[#]", by.wheel[int(item[1]) - 1]
        elif head in tables:
            table, target = tables[head]
        else:
            raise BadInput(f"{name}: there is no table {head}; "
                           f"{nearest_of(head, [each for each in (*tables, 'wheel[1]') if each])}")
        fields = self._fields(table)
        if key not in fields:
            near = difflib.get_close_matches(key, fields, n=1, cutoff=0.8)
            meant = f"did you mean {head}{head and '.'}{near[0]}?" if near else \
                f"known are {', '.join(sorted(self._known(head)))}"
            raise BadInput(f"{name}: there is no such number; {meant}")
        setattr(target, fields[key].member, value)

    def _fields(self, table: str) -> dict[str, Field]:
        """The numbers of a table by their keys."""
        return {field.key: field for field in self.core.fields_of(table) if field.kind == "REAL"}

    def _known(self, head: str) -> list[str]:
        """The names of all numbers; those of a wheel for the wheel that was meant, or the first."""
        wheel = head if head.startswith("wheel[") else "wheel[1]"
        tables = {"": "vehicle", "payload.": "vehicle.payload", "ground.": "ground"}
        if self.wheels:
            tables[f"{wheel}."] = "vehicle.wheel[#]"
        return [f"{before}{key}" for before, table in tables.items() for key in self._fields(table)]
