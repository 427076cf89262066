"""Sensors of a vehicle from Python: the core's IMU and encoders (laconic_sensors), beside the plant that they watch.

    sensors = plant.sensors({"imu": {"x_m": 0.1, "seed": 7}, "encoder": {"counts_per_turn": 4096}})
    sensors.run({"voltage_V": [2.0, -2.0]}, steps=1000)
    sensors.read().imu_yaw_rate_rad_per_s
"""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.copies import OwnMemory
from laconic.core.encoders import (
    GEAR,
    KEYS,
    LEAST_INTEGER,
    MOST_INTEGER,
    WRAP,
    core_wrap,
    failing,
    is_unsigned,
    read_encoders,
    unsigned,
)
from laconic.core.fields import ITEM, Field
from laconic.core.given import c_object, is_real, number, several, shown, step_count
from laconic.core.inputs import sampled_rows
from laconic.core.saved import check_saved
from laconic.core.spelling import with_radians
from laconic.errors import BadInput, nearest_of

if TYPE_CHECKING:
    from laconic.core import Core
    from laconic.core.plant import Plant

IMU, ENCODER = "sensors.imu", "sensors.encoder"  # the tables of a scene


@dataclass(frozen=True)
class Readings:
    """What the sensors of a vehicle with N wheels show at one moment."""

    acceleration_body_m_per_s2: np.ndarray
    """(2,), along ξ and η [m/s²]: the true acceleration of the body's origin, no sensor's."""
    imu_acceleration_m_per_s2: np.ndarray
    """(2,), along the IMU's x and y axis [m/s²]: specific force, so a slope shows at rest."""
    imu_yaw_rate_rad_per_s: float
    encoder_count: np.ndarray
    """(N,), whole numbers; 0 for a wheel without an encoder."""


class Sensors(OwnMemory):
    """IMU and encoders of one plant; `c` is the laconic_sensors itself. Step the plant by `run` from now on, as the
    sensors must see each step. A copy watches a plant of its own: `plant` of the copy."""

    def __init__(self, plant: Plant, settings: Any, is_unsigned: bool = False):
        """Sensors as after power-up, beside a plant that stands where it is; `settings`: a laconic_sensor_settings.
        `is_unsigned`: encoders without a wrap show numbers from 0 to 2³² − 1.

        Refused names the field that the core refuses.
        """
        self.is_unsigned = is_unsigned
        self.plant, core = plant, plant.core
        self.c: Any = core.ffi.new("laconic_sensors *")
        why = core.why()
        core.check(core.lib.laconic_sensors_start(self.c, settings, plant.c, why), why)

    def run(self, held: Any = None, steps: int = 1) -> None:
        """Steps of plant and sensors with the input held, given as Plant.run takes it; the plant's bits are the same.

        Refused leaves both as before the refused step; only "overflow" of a sensor, which has left its range, comes
        after its step.
        """
        core, why = self.plant.core, self.plant.core.why()
        held, steps = self.plant.input_of(held), step_count("steps", steps)
        core.check(core.lib.laconic_sensors_run(self.c, self.plant.c, held, steps, why), why)

    def run_sampled(self, samples: np.ndarray) -> None:
        """One step per samples[k], as Plant.run_sampled: (steps, 3, numbers of an input)."""
        core, why = self.plant.core, self.plant.core.why()
        three = core.ffi.new("laconic_input[3]")
        for each in sampled_rows(core, samples, self.plant.wheel_count):
            core.ffi.memmove(three, each.tobytes(), core.ffi.sizeof("laconic_input[3]"))
            core.check(core.lib.laconic_sensors_run_sampled(self.c, self.plant.c, three, why), why)

    def read(self, held: Any = None) -> Readings:
        """What the sensors show now. `held`: the input that acts from now on, on which only acceleration_body_m_per_s2
        depends; None: none. Refused where that leaves the range of numbers."""
        core, plant = self.plant.core, self.plant
        shown_now = core.ffi.new("laconic_sensor_outputs *")
        core.lib.laconic_sensors_read(shown_now, self.c, plant.c, plant.input_of(held))
        acceleration = core.numbers(shown_now.acceleration_body_m_per_s2)
        core.check_range("acceleration_body_m_per_s2", acceleration)
        counts = core.numbers(shown_now.encoder_count)[: plant.wheel_count].astype(np.int64)
        return Readings(acceleration,
                        core.numbers(shown_now.imu_acceleration_m_per_s2), float(shown_now.imu_yaw_rate_rad_per_s),
                        unsigned(counts) if self.is_unsigned else counts)

    def save(self) -> Any:
        """A copy of the sensors' state, with the samples that are on their way; save the plant with it."""
        return self.plant.core.ffi.new("laconic_sensors *", self.c[0])

    def restore(self, saved: Any) -> None:
        """Back to what `save` gave; BadInput for what sensors with other settings gave."""
        found, core = c_object(self.plant.core, "sensors", saved), self.plant.core
        check_saved(core, "sensors", found[0])
        for field in core.sensor_fields:
            if values_of(field, found.settings) != values_of(field, self.c.settings):
                raise BadInput(f"sensors: were saved with another {field.path.removesuffix(ITEM)}; give what the "
                               "save() of these gave")
        self.c[0] = found[0]


def settings_of(core: Core, given: Mapping[str, Any], wheel_count: int) -> Any:
    """The laconic_sensor_settings of {"imu": {…}, "encoder": {…}}, whose keys are those of the core's list of fields.

    What has several items, an axis or a wheel each, is one number for all of them or a list. BadInput names a key that
    is unknown, no number, or of another length, and encoders that are none; what the numbers of an IMU must be the core
    checks.
    """
    settings = core.ffi.new("laconic_sensor_settings *")
    top = _mapping("sensors", given, ("imu", "encoder"))
    fields = {field.key: field for field in core.fields_of(IMU)}
    imu = top.get("imu", {})
    for key, value in _mapping(IMU, with_radians(IMU, imu, fields) if isinstance(imu, Mapping) else imu,
                               fields).items():
        _put(settings, fields[key], _values(f"{IMU}.{key}", fields[key], value))
    if "encoder" in top:
        put_encoders(core, settings, ENCODER, top["encoder"], wheel_count)
    return settings


def shows_unsigned(given: Mapping[str, Any]) -> bool:
    """Whether the encoders of {"encoder": {…}} show numbers from 0 to 2³² − 1."""
    return isinstance(encoder := given.get("encoder", {}), Mapping) and is_unsigned(encoder)


def put_encoders(core: Core, settings: Any, name: str, given: Any, wheel_count: int) -> None:
    """The encoders that the table of this name gives, into a laconic_sensor_settings; BadInput names what is none."""
    fail, fields = failing(name), {field.key: field for field in core.fields_of(ENCODER)}
    found = read_encoders(_mapping(name, given, KEYS), wheel_count, fail)
    for key, value in found.items():
        value = core_wrap(value) if key == WRAP else value
        _put(settings, fields[key], value if isinstance(value, tuple) else (value,))
    for gear in found.get(GEAR, ()):
        with np.errstate(over="ignore", under="ignore"):
            rounded = core.dtype.type(gear)
        if rounded == 0 or not np.isfinite(rounded):  # the core would take 0 for 1
            fail(GEAR, f"{gear:g} is beyond the range of this precision; give a number nearer to 1")


def values_of(field: Field, settings: Any) -> list[float]:
    """The numbers of one field of a laconic_sensor_settings; of all items that there is room for."""
    if field.table == IMU:
        found = getattr(settings.imu, field.key)
        values = list(found) if field.items else [found]
    else:
        values = [getattr(each, field.key) for each in settings.encoder] if field.items else [settings.encoder_wrap]
    return [float(each) if field.kind == "REAL" else int(each) for each in values]


def _mapping(name: str, given: Any, known: Sequence[str] | Mapping[str, Any]) -> Mapping[str, Any]:
    if not isinstance(given, Mapping):
        raise BadInput(f"{name}: {shown(given)} is no table; give a mapping from keys to numbers")
    for key in given:
        if key not in known:
            raise BadInput(f"{name}.{key}: unknown key; {nearest_of(str(key), known)}")
    return given


def _values(name: str, field: Field, given: Any) -> list[float]:
    """Of an IMU: a number, or one for each axis."""
    count = field.items
    many = several(given)
    if many is not None and (not count or len(many) != count):
        raise BadInput(f"{name}: has {len(many)} entries; give one number{f', or {count}' if count else ''}")
    values = [given] * max(count, 1) if many is None else many
    return [_whole(name, each) if field.kind == "INTEGER" else number(name, each) for each in values]


def _whole(name: str, value: Any) -> int:
    try:
        found = operator.index(value)
    except TypeError:
        found = None
    if found is None or not is_real(value):
        raise BadInput(f"{name}: {shown(value)} is no whole number (int); give one")
    if not LEAST_INTEGER <= found <= MOST_INTEGER:
        raise BadInput(f"{name}: {shown(found)} has more than 32 bits; give {LEAST_INTEGER} to {MOST_INTEGER}")
    return found


def _put(settings: Any, field: Field, values: Sequence[float]) -> None:
    if field.table == IMU and not field.items:
        setattr(settings.imu, field.key, values[0])
    elif not field.items:
        settings.encoder_wrap = values[0]
    else:
        for item, value in enumerate(values):
            if field.table == IMU:
                getattr(settings.imu, field.key)[item] = value
            else:
                setattr(settings.encoder[item], field.key, value)
