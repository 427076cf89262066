"""Many vehicles as the core prepared them: their numbers as arrays with one row for each vehicle.

Measures of a model work on a `Group`, whose vehicles have the same number of wheels and degrees of freedom. Vehicles
that the core refuses are in no group, and their measures are NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from laconic.batch.population import struct_dtype
from laconic.core import Core
from laconic.errors import BadInput


@dataclass(frozen=True)
class Group:
    """L vehicles with N wheels and m degrees of freedom each; `models` and `vehicles` are the core's, as records."""

    core: Core
    vehicles: np.ndarray  # (L,) records of laconic_vehicle
    models: np.ndarray    # (L,) records of laconic_model
    pointers: list[tuple[Any, Any]]  # to laconic_vehicle and laconic_model, L of them
    inputs: list[dict[str, float]]   # of each at the run's start, signal → value
    wheels: int           # N
    dof: int              # m

    def of_wheels(self, name: str) -> np.ndarray:
        """A member of the model that has a value for each wheel: motor_gain_Nm_per_V …; (L, N)."""
        return self.models[name][:, : self.wheels]

    @cached_property
    def positions_m(self) -> np.ndarray:
        """Wheel centres in the body frame, (L, N, 2)."""
        wheels = self.vehicles["wheel"][:, : self.wheels]
        return np.stack([wheels["x_m"], wheels["y_m"]], axis=-1)

    @cached_property
    def radii_m(self) -> np.ndarray:
        """R_i, (L, N)."""
        own = self.vehicles["wheel"]["own_radius_m"][:, : self.wheels]
        return np.where(own > 0.0, own, self.vehicles["wheel_radius_m"][:, None])

    @cached_property
    def motion_of_zeta(self) -> np.ndarray:
        """(v_ξ [m/s], v_η [m/s], θ' [rad/s]) of the centre of mass = motion_of_zeta · ζ, (L, 3, m)."""
        rows = [self.models["velocity_of_zeta"], self.models["yaw_rate_of_zeta"][:, None, :]]
        return np.concatenate(rows, axis=1)[:, :, : self.dof]

    @cached_property
    def wheel_of_zeta(self) -> np.ndarray:
        """χ' = Ξ G ζ, (L, N, m)."""
        return self.models["wheel_of_zeta"][:, : self.wheels, : self.dof]

    @cached_property
    def decay_per_s(self) -> np.ndarray:
        """Damping rates r, (L, m)."""
        return self.models["decay_per_s"][:, : self.dof]

    @cached_property
    def zeta_rate_of_torque(self) -> np.ndarray:
        """ζ' per N·m on each axle, (L, m, N): GᵀΞᵀ/(M R²)."""
        return np.swapaxes(self.wheel_of_zeta, 1, 2) * self.models["torque_scale"][:, None, None]

    @cached_property
    def zeta_rate_of_voltage(self) -> np.ndarray:
        """ζ' per volt of each motor, (L, m, N)."""
        return np.swapaxes(self.wheel_of_zeta, 1, 2) * self.of_wheels("voltage_scale")[:, None, :]


class Prepared:
    """Vehicles and their models; `refused[i]` says why vehicle i has none.

    `vehicles`: a laconic_vehicle[L] of the core, or pointers to as many. `inputs`: what is held at the run's start, for
    each vehicle, or one for all; none where no measure asks for it.
    """

    def __init__(self, core: Core, vehicles: Any, inputs: Sequence[dict[str, float]] = ({},)):
        ffi, count = core.ffi, len(vehicles)
        self.inputs = list(inputs) * (count if len(inputs) == 1 else 1)
        self.core, self.count = core, count
        self._vehicles = self._array_of(vehicles)
        self._models = ffi.new("laconic_model[]", count)
        self.refused: list[BadInput | None] = [None] * count
        why, prepare, good = core.why(), core.lib.laconic_prepare, core.lib.LACONIC_OK
        for lane in range(count):
            if prepare(self._models + lane, self._vehicles + lane, why) != good:
                self.refused[lane] = core.refusal(why)
        self.vehicles = records(core, "laconic_vehicle", self._vehicles)
        self.models = records(core, "laconic_model", self._models)

    def _array_of(self, vehicles: Any) -> Any:
        if isinstance(vehicles, self.core.ffi.CData):
            return vehicles
        array = self.core.ffi.new("laconic_vehicle[]", len(vehicles))
        for lane, vehicle in enumerate(vehicles):
            array[lane] = vehicle[0]
        return array

    def refuse(self, lane: int, why: BadInput) -> None:
        """Counts a vehicle as refused, before anything is measured."""
        self.refused[lane] = why

    @cached_property
    def groups(self) -> list[tuple[np.ndarray, Group]]:
        """Lanes that have one number of wheels and degrees of freedom, with their group."""
        return list(self._grouped())

    def _grouped(self) -> Iterator[tuple[np.ndarray, Group]]:
        holds = np.array([why is None for why in self.refused])
        kinds = np.column_stack([self.models["wheel_count"], self.models["dof"]])
        for wheels, dof in sorted({(int(n), int(m)) for n, m in kinds[holds]}):
            lanes = np.flatnonzero(holds & (kinds == (wheels, dof)).all(axis=1))
            pointers = [(self._vehicles + int(lane), self._models + int(lane)) for lane in lanes]
            yield lanes, Group(self.core, self.vehicles[lanes], self.models[lanes], pointers,
                               [self.inputs[lane] for lane in lanes], wheels, dof)

    def measured(self, measure: Callable[[Group], np.ndarray]) -> np.ndarray:
        """A measure of all vehicles, (count,); NaN where the core refused one."""
        found = np.full(self.count, np.nan)
        for lanes, group in self.groups:
            found[lanes] = measure(group)
        return found


def records(core: Core, struct: str, array: Any) -> np.ndarray:
    """A C array of structs as numpy records that are views of it; its members have their names."""
    view = np.frombuffer(core.ffi.buffer(array), struct_dtype(core, struct))
    view.flags.writeable = False
    return view
