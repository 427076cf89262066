"""The core's extended Kalman filter (laconic_filter) from Python; the header laconic/filter.h is the manual.

    filter = laconic.Filter(plant, {"voltage_noise_V_per_sqrt_Hz": 0.05, "encoder_std_rad": 1e-3,
                                    "yaw_rate_std_rad_per_s": 0.01, "nu_std_rad_per_s": 0.1})
    filter.predict({"voltage_V": [6.0, -6.0, 0.0]})      # one step
    filter.encoders(turned_rad); filter.yaw_rate(shown)   # readings at its end
    filter.pose, filter.covariance
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from laconic.core.copies import OwnMemory
from laconic.core.derivatives import check_smooth
from laconic.core.encoders import is_unsigned, signed
from laconic.core.given import finite_number, number, numbers, several, shown, step_count
from laconic.core.given_array import real_array
from laconic.core.plant import Plant, Pose
from laconic.core.saved import check_saved
from laconic.core.sensors import ENCODER, put_encoders, values_of
from laconic.errors import BadInput, Refused, nearest_of

STATE_NAMES = ("nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]", "x_m", "y_m", "heading_rad", "bias_rad_per_s")
"""Rows and columns of a covariance."""


class Innovation(NamedTuple):
    """How far a reading was from what the filter expected."""

    numbers: int   # of the reading
    square: float  # rᵀS⁻¹r: χ²-distributed with `numbers` degrees of freedom where the filter's settings are right


class Filter(OwnMemory):
    """Estimates ν, pose and the gyro's bias of a vehicle like `plant`, from where the plant is now.

    `settings`: members of laconic_filter_settings by name; of nu_std_rad_per_s and encoder_std_rad one number for all
    or a list. `encoder`: counts_per_turn, gear_ratio and wrap of the encoders, where `counts` is to be used;
    `start_count` is what they show now. The plant is copied: what happens to it later has no effect.

    Raises BadInput for what is unknown, no number or not usable, and for a vehicle with friction.
    """

    RENEWED: ClassVar[dict[str, Any]] = {"_model": None, "_integrator": None}

    def __init__(self, plant: Plant, settings: Mapping[str, Any], *, encoder: Mapping[str, Any] | None = None,
                 start_count: ArrayLike | None = None):
        check_smooth(plant)
        self.core, self.wheel_count = plant.core, plant.wheel_count
        ffi = self.core.ffi
        self._plant = copy.copy(plant)
        self._look_into_plant()
        self.c: Any = ffi.new("laconic_filter *")
        self._innovation = ffi.new("laconic_innovation *")
        self._sensors = None if encoder is None else self._encoders(encoder)
        self._is_unsigned = encoder is not None and is_unsigned(encoder)
        self._is_of = self._what_it_is_of()
        if start_count is not None and encoder is None:
            raise BadInput("start_count: has no effect without `encoder`; give that, too, or leave it out")
        self._count = self._counts([0] * self.wheel_count if start_count is None else start_count)
        self._check(self.core.lib.laconic_filter_start(
            self.c, self._model, self._settings(settings), ffi.addressof(self._plant.c, "state")), "settings")

    def _look_into_plant(self) -> None:
        at = self.core.ffi.addressof
        self._model, self._integrator = (at(self._plant.c, name) for name in ("model", "integrator"))

    def __getstate__(self) -> dict[str, Any]:
        return super().__getstate__() | {"_count": list(self._count)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._count = self.core.ffi.new("int32_t[]", state["_count"])
        self._look_into_plant()

    # ---- prediction and readings

    def predict(self, held: Any = None, steps: int = 1) -> None:
        """So many steps with the input held, given as Plant.run takes it. Refused leaves the estimate before the step.

        The step is the plant's; where readings come less often, so many steps lie between them.
        """
        held = self._plant.input_of(held)
        for _ in range(step_count("steps", steps)):
            status = self.core.lib.laconic_filter_predict(self.c, self._model, self._integrator, held)
            if status != self.core.lib.LACONIC_OK:
                raise self._refused_step(status, held)

    def encoders(self, turned_rad: ArrayLike) -> Innovation:
        """The angles (N,) by which the wheels turned since the last reading."""
        turned = real_array("turned_rad", turned_rad, (self.wheel_count,), "rad")
        room = self.core.ffi.new("laconic_real[]", turned.tolist() or [0.0])
        return self._read(self.core.lib.laconic_filter_encoders, room, "turned_rad", "encoder_std_rad")

    def counts(self, count: ArrayLike) -> Innovation:
        """What the encoders (N,) show now; needs `encoder`."""
        if self._sensors is None:
            raise BadInput("encoder: was not given to the filter; give {\"counts_per_turn\": 4096}, or use encoders()")
        now, turned = self._counts(count), self.core.ffi.new("laconic_real[]", max(self.wheel_count, 1))
        self.core.lib.laconic_filter_turned(turned, self._sensors, self._count, now, self.wheel_count)
        found = self._read(self.core.lib.laconic_filter_encoders, turned, "count", "encoder_std_rad")
        self._count = now
        return found

    def yaw_rate(self, shown_rad_per_s: float) -> Innovation:
        """What the gyro shows."""
        value = finite_number("shown_rad_per_s", shown_rad_per_s)
        return self._read(self.core.lib.laconic_filter_yaw_rate, value, "shown_rad_per_s", "yaw_rate_std_rad_per_s")

    def fix(self, x_m: float = 0.0, y_m: float = 0.0, heading_rad: float = 0.0, *, std_m: float = 0.0,
            heading_std_rad: float = 0.0, place_m: Sequence[float] = (0.0, 0.0)) -> Innovation:
        """Where a place of the body (in its frame) was seen and where the body points; a std of 0: was not seen."""
        place = real_array("place_m", place_m, (2,), "m")
        given = {"x_m": x_m, "y_m": y_m, "heading_rad": heading_rad, "std_m": std_m, "heading_std_rad": heading_std_rad}
        fix = self.core.ffi.new("laconic_pose_fix *", {
            **{name: finite_number(name, value) for name, value in given.items()},
            "place_x_m": place[0], "place_y_m": place[1]})
        return self._read(self.core.lib.laconic_filter_fix, fix, "fix", "std_m or heading_std_rad")

    # ---- the estimate

    @property
    def step_s(self) -> float:
        """Of a prediction."""
        return self._plant.step_s

    @property
    def centre_of_mass_m(self) -> tuple[float, float]:
        """Of the robot with its payload, in the body frame: what x_m and y_m are of, as a place for `fix`."""
        return float(self._plant.c.model.com_x_m), float(self._plant.c.model.com_y_m)

    @property
    def nu(self) -> np.ndarray:
        """ν1, ν2, ν3 [rad/s], shape (3,)."""
        return self.as_plant().nu

    @property
    def pose(self) -> Pose:
        """Where the vehicle is."""
        return self.as_plant().pose

    @property
    def bias_rad_per_s(self) -> float:
        """By which the gyro shows too much; 0 where it is not estimated."""
        return float(self.c.bias_rad_per_s)

    @property
    def covariance(self) -> np.ndarray:
        """Of (ν1, ν2, ν3, x, y, θ, bias), shape (7, 7), in the units of STATE_NAMES; rows of no bias are 0."""
        room = self.core.ffi.new("laconic_real[]", len(STATE_NAMES) ** 2)
        self.core.lib.laconic_filter_covariance(room, self.c, self._model)
        return self.core.numbers(room, len(STATE_NAMES), len(STATE_NAMES))

    @property
    def state(self) -> np.ndarray:
        """(ν1, ν2, ν3, x, y, θ, bias), shape (7,)."""
        pose = self.pose
        return np.array([*self.nu, pose.x_m, pose.y_m, pose.heading_rad, self.bias_rad_per_s], self.core.dtype)

    def as_plant(self) -> Plant:
        """The estimate as a plant: its outputs, and its `step_derivatives` for a controller. Asked for again, it is the
        same plant, moved to where the estimate is then."""
        self._plant.c.state = self.c.state
        return self._plant

    def save(self) -> Any:
        """A copy of all that the filter knows."""
        return self._is_of, self.core.ffi.new("laconic_filter *", self.c[0]), tuple(self._count)[: self.wheel_count]

    def restore(self, saved: Any) -> None:
        """Back to what `save` gave; BadInput for what the filter of another robot, step, precision or encoder gave."""
        if not (isinstance(saved, tuple) and len(saved) == 3 and isinstance(saved[0], dict)):
            raise BadInput(f"saved: {shown(saved)} is not of this filter; give what its save() gave")
        is_of, state, count = saved
        ffi = self.core.ffi
        is_state = isinstance(state, ffi.CData) and ffi.typeof(state) is ffi.typeof(self.c)
        if not (isinstance(state, ffi.CData) and isinstance(count, tuple)):
            raise BadInput(f"saved: {shown(saved)} is not of this filter; give what its save() gave")
        for name, ours in self._is_of.items():
            if is_of.get(name) != ours:
                raise BadInput(f"saved: is not of this filter, whose {name} is another; give what its save() gave")
        if not is_state:
            raise BadInput(f"saved: {shown(state)} is not of this filter; give what its save() gave")
        check_saved(self.core, "saved", state[0])
        self.c[0], self._count = state[0], self._counts(count)

    # ---- between numpy and C

    def _what_it_is_of(self) -> dict[str, Any]:
        """What a saved state has in common with the filter that takes it."""
        vehicle, fields = self._plant.c.vehicle, self.core.fields
        own = [field for field in fields if field.root == "vehicle" and field.table != "vehicle.motor"]
        numbers = [field.values(vehicle) for field in own]
        encoders = self._sensors and [values_of(field, self._sensors) for field in self.core.fields_of(ENCODER)]
        return {"precision": self.core.real, "step_s": self.step_s, "vehicle": numbers, "encoder": encoders}

    def _encoders(self, given: Mapping[str, Any]) -> Any:
        """The laconic_sensor_settings; `counts` reads every wheel, so each has an encoder."""
        settings = self.core.ffi.new("laconic_sensor_settings *")
        put_encoders(self.core, settings, "encoder", given, self.wheel_count)
        for wheel, each in enumerate(list(settings.encoder)[: self.wheel_count], start=1):
            if each.counts_per_turn == 0:
                raise BadInput(f"encoder.counts_per_turn: wheel {wheel} has none; give a number above 0 for each "
                               "wheel, or leave `encoder` out and read by encoders()")
        return settings

    def _settings(self, given: Mapping[str, Any]) -> Any:
        if not isinstance(given, Mapping):
            raise BadInput(f"settings: {shown(given)} is no table; give a mapping from names to numbers")
        made = self.core.ffi.new("laconic_filter_settings *")
        counts = {"nu_std_rad_per_s": 3, "encoder_std_rad": self.wheel_count}
        known = [name for name, _ in self.core.ffi.typeof("laconic_filter_settings").fields]
        for name, value in given.items():
            if name not in known:
                raise BadInput(f"settings.{name}: unknown key; {nearest_of(str(name), known)}")
            if name in counts:
                many = several(value)
                value = [value] * counts[name] if many is None else many
                setattr(made, name, [_usable(f"{name}[{k + 1}]", each, self.core.dtype) for k, each in
                                     enumerate(numbers(f"settings.{name}", value, counts[name]))])
            else:
                setattr(made, name, _usable(name, number(f"settings.{name}", value), self.core.dtype))
        return made

    def _counts(self, given: ArrayLike) -> Any:
        values = real_array("count", given, (self.wheel_count,), "counts")
        if self._is_unsigned:
            values = signed(values)
        if not np.all((-2**31 <= values) & (values < 2**31) & (values == np.floor(values))):
            raise BadInput(f"count: {shown(values.tolist())} are no counts; give whole numbers of 32 bits, one for "
                           "each wheel")
        wrap = self._sensors.encoder_wrap if self._sensors else 0
        if wrap and not np.all((0 <= values) & (values < wrap)):
            raise BadInput(f"count: {shown(values.tolist())} are not what a counter that wraps shows; give 0 to "
                           f"{wrap - 1}")
        return self.core.ffi.new("int32_t[]", [int(value) for value in values] or [0])

    def _read(self, function: Any, reading: Any, name: str, needs: str) -> Innovation:
        self._check(function(self.c, self._model, reading, self._innovation), name, needs)
        return Innovation(int(self._innovation.count), float(self._innovation.square))

    def _check(self, status: int, name: str, needs: str = "") -> None:
        lib = self.core.lib
        if status == lib.LACONIC_OK:
            return
        if status == lib.LACONIC_NOT_POSITIVE:
            raise BadInput(f"{name}: the filter was not told how well this is read; give {needs} above 0")
        text = {lib.LACONIC_NOT_FINITE: "is not finite; give numbers", lib.LACONIC_NEGATIVE: "has a standard deviation "
                "below 0; give one above it"}.get(status, "takes the estimate out of the range; check it and its units")
        raise BadInput(f"{name}: {text}")

    def _refused_step(self, status: int, held: Any) -> Refused:
        why, state = self.core.why(), self.core.ffi.addressof(self.c, "state")
        self.core.lib.laconic_step_refusal(why, status, self._model, self._integrator, state, held, 1)
        return self.core.refusal(why)


def _usable(name: str, value: float, dtype: Any) -> float:
    if not 0 <= value < np.sqrt(np.finfo(dtype).max):
        raise BadInput(f"settings.{name}: {value:g} is no standard deviation; give 0 or a number above it")
    return value
