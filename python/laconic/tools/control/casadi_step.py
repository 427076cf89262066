"""A step of the core as a function of CasADi, with its exact derivatives: for plans by its optimisers.

    step = casadi_step(robot.plant("auto", step_s=0.1))
    after = step(state, volts)                                  # numbers, or symbols of MX
    step = casadi_step(plant, parameters=["payload.mass_kg"])   # step(state, volts, [1.5])

It calls the core from Python (a Callback of CasADi): nothing is generated or compiled, and the bits are the core's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi
import numpy as np

from laconic.core.derivatives import check_smooth
from laconic.core.given import name_list, shown
from laconic.core.given_array import check_finite
from laconic.core.plant import Plant
from laconic.errors import BadInput
from laconic.tools.control.course import STATES, moved, place, step_from

NAMES, UNITS = ("s", "u", "p"), ("rad/s, rad/s, rad/s, m, m, rad", "V", "the units of their names")
_KEPT: list[Any] = []  # CasADi calls what Python made without holding a reference to it


def casadi_step(plant: Plant, parameters: Sequence[str] = (), name: str = "laconic_step") -> casadi.Function:
    """s⁺ = F(s, u): s = (ν1, ν2, ν3, x, y, θ), u the N voltages, by the plant's method and step. The plant is copied.

    With `parameters`, numbers of the vehicle named as for StepDerivatives.tangent, it is F(s, u, p) with their values
    p. The Jacobian is the core's. There is no second derivative: an optimiser that asks for one is to approximate it
    ({"ipopt.hessian_approximation": "limited-memory"}). BadInput for a vehicle with friction and for parameters that
    are not there; called with numbers, for what are none and for steps that the core refuses. Within an expression a
    refused step ends the evaluation with an exception of CasADi.
    """
    check_smooth(plant)
    wanted = name_list("parameters", parameters)
    if twice := next((each for place, each in enumerate(wanted) if each in wanted[:place]), ""):
        raise BadInput(f"parameters: {twice} is named twice; keep one of them")
    if not isinstance(name, str) or not casadi.Function.check_name(name):
        raise BadInput(f"name: {shown(name)} is no name of a CasADi function; give letters, digits and single "
                       "underscores, a letter first")
    copied = Plant(plant.core, plant.core.ffi.new("laconic_plant *", plant.c[0]))
    copied.step_derivatives().model_change(dict.fromkeys(wanted, 0.0))  # BadInput
    step = _Step(copied, tuple(wanted))
    step.construct(name, {})
    _KEPT.append(step)
    return step


class _Callback(casadi.Callback):
    """The inputs s, u and, where there are parameters, p."""

    def __init__(self, plant: Plant, parameters: tuple[str, ...]):
        casadi.Callback.__init__(self)
        self.plant, self.parameters = plant, parameters
        self.sizes = [STATES, plant.wheel_count, *([len(parameters)] if parameters else [])]

    def get_n_in(self) -> int:
        return len(self.sizes)

    def get_sparsity_in(self, i: int) -> casadi.Sparsity:
        return casadi.Sparsity.dense(self.sizes[i], 1) if i < len(self.sizes) else casadi.Sparsity.dense(STATES, 1)

    def numbers(self, arguments: Any) -> list[np.ndarray]:
        return [each.full().ravel() for each in arguments[: len(self.sizes)]]

    def plant_with(self, values: Sequence[np.ndarray]) -> Plant:
        """The plant, where there are parameters one with their values."""
        if not values:
            return self.plant
        core, own = self.plant.core, self.plant.c
        vehicle = core.ffi.new("laconic_vehicle *", own.vehicle)
        self.plant.step_derivatives().set_numbers(vehicle, dict(zip(self.parameters, values[0], strict=True)))
        return core.plant(vehicle, core.text(own.integrator.method.name), self.plant.step_s)


class _Step(_Callback):
    """The state after a step."""

    def get_n_out(self) -> int:
        return 1

    def get_name_in(self, i: int) -> str:
        return NAMES[i]

    def get_name_out(self, i: int) -> str:
        return "s_after"

    def get_sparsity_out(self, i: int) -> casadi.Sparsity:
        return casadi.Sparsity.dense(STATES, 1)

    def eval(self, arg: Any) -> list[np.ndarray]:
        return [self._after(self.numbers(arg))]

    def _after(self, arguments: Sequence[np.ndarray]) -> np.ndarray:
        state, volts, *values = arguments
        return moved(self.plant_with(values), state, volts)

    def __call__(self, *args: Any, **named: Any) -> Any:
        """As casadi.Function; numbers for one step go to the core at once, so that its words reach the caller."""
        known, given = NAMES[: len(self.sizes)], {**dict(zip(NAMES, args, strict=False)), **named}
        if sorted(given) != sorted(known) or len(args) + len(named) != len(known):
            raise BadInput(f"arguments: there are {len(args)}{''.join(f', {name}' for name in named)}; give "
                           f"{', '.join(known)}")
        found = {name: self._checked(name, given[name]) for name in known}
        if all(isinstance(found[name], np.ndarray) and found[name].size == size for name, size in
               zip(known, self.sizes, strict=True)):
            after = casadi.DM(self._after([each.ravel() for each in found.values()]))
            return {"s_after": after} if named else after
        return super().__call__(**found) if named else super().__call__(*found.values())

    def _checked(self, name: str, given: Any) -> Any:
        """Symbols of MX as they are; numbers as an array, a column for each step; BadInput for what is neither."""
        if isinstance(given, casadi.MX):
            return given
        place = NAMES.index(name)
        size = self.sizes[place]
        try:
            found = given.full() if isinstance(given, casadi.DM) else np.asarray(given)
        except (TypeError, ValueError, NotImplementedError):  # ragged lists, symbols of SX
            found = np.empty(0, object)
        fits = found.shape in ((), (size,), (1, size)) or (found.ndim == 2 and found.shape[0] == size)
        if found.dtype.kind not in "fiu" or not fits:
            raise BadInput(f"{name}: {shown(given)} does not fit; give real numbers of shape ({size},) in "
                           f"{UNITS[place]}, or symbols of MX")
        check_finite(name, found, UNITS[place])
        return np.asarray(found, float)

    def has_jacobian(self) -> bool:
        return True

    def get_jacobian(self, name: str, inames: Any, onames: Any, opts: Any) -> casadi.Function:
        jacobian = _Jacobian(self.plant, self.parameters, list(inames), list(onames))
        jacobian.construct(name, opts)
        _KEPT.append(jacobian)
        return jacobian


class _Jacobian(_Callback):
    """Blocks by s, u and p; its inputs are those of the step and the step's result, which it does not need."""

    def __init__(self, plant: Plant, parameters: tuple[str, ...], inames: list[str], onames: list[str]):
        self.inames, self.onames = inames, onames
        _Callback.__init__(self, plant, parameters)

    def get_n_in(self) -> int:
        return len(self.sizes) + 1

    def get_n_out(self) -> int:
        return len(self.sizes)

    def get_name_in(self, i: int) -> str:
        return self.inames[i]

    def get_name_out(self, i: int) -> str:
        return self.onames[i]

    def get_sparsity_out(self, i: int) -> casadi.Sparsity:
        return casadi.Sparsity.dense(STATES, self.sizes[i])

    def eval(self, arg: Any) -> list[np.ndarray]:
        state, volts, *values = self.numbers(arg)
        plant = self.plant_with(values)
        _, by_state, by_voltage = step_from(plant, state, volts)
        if not values:
            return [by_state, by_voltage]
        place(plant, state)
        step = plant.step_derivatives({"voltage_V": list(volts)})
        by_vehicle = [step.tangent(vehicle={name: 1.0})[:STATES] for name in self.parameters]
        return [by_state, by_voltage, np.transpose(by_vehicle)]
