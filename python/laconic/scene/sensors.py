"""`[sensors]`: an inertial measurement unit (IMU) on the body, and encoders at the wheels; the core checks numbers.

A value for each axis of the IMU, or for each encoder, is one number for all of them or a list.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from laconic.core import Field, load
from laconic.core.encoders import A_COUNT, COUNTS, GEAR, NO_ENCODER, WRAP, read_encoders
from laconic.core.sensors import IMU
from laconic.scene.keys import read_number
from laconic.scene.table import Table, read_field

OF_IMU = {"imu_acceleration_m_per_s2": 2, "imu_yaw_rate_rad_per_s": 0}
OF_ENCODERS = ("encoder_count",)
"""Outputs of scenes with these sensors alone, as OUTPUT_LENGTHS and OUTPUTS_PER_WHEEL have the others."""

DELAY, DELAY_S = "delay_steps", "delay_s"  # in the core, and in a scene, whose step may change
NOISES = ("acceleration_noise_m_per_s2_per_sqrt_Hz", "yaw_rate_noise_rad_per_s_per_sqrt_Hz")


@dataclass(frozen=True)
class SensorTables:
    """What `[sensors]` gives, by the keys of the core's list of fields; None: there is no such sensor.

    `imu` has delay_s instead of the core's delay_steps; lists of `encoder` have an entry for each wheel.
    """

    imu: dict[str, Any] | None = None
    encoder: dict[str, Any] | None = None

    def has_encoder(self, wheel: int) -> bool:
        """Whether a wheel, counted from 1, has an encoder."""
        return self.encoder is not None and self.encoder["counts_per_turn"][wheel - 1] > 0

    def settings(self, delay_steps: int) -> dict[str, Any]:
        """The same for Plant.sensors, with the delay in steps."""
        imu = {key: value for key, value in (self.imu or {}).items() if key != DELAY_S}
        settings: dict[str, Any] = {"imu": imu | {DELAY: delay_steps}}
        if self.encoder is not None:
            counts = [each or NO_ENCODER for each in self.encoder[COUNTS]]
            settings["encoder"] = self.encoder | {COUNTS: counts}
        return settings


NO_SENSORS = SensorTables()


def read_sensors(table: Table, wheel_count: int) -> SensorTables:
    """`[sensors]` of a vehicle with so many wheels."""
    has_imu, has_encoder = table.has("imu"), table.has("encoder")
    imu = read_imu(table.table("imu")) if has_imu else None
    encoder = read_encoder(table.table("encoder"), wheel_count) if has_encoder else None
    table.done()
    if not (has_imu or has_encoder):
        table.fail("imu", "is missing, and encoder, too; give one of them, or take [sensors] out")
    return SensorTables(imu, encoder)


def read_imu(table: Table) -> dict[str, Any]:
    """`[sensors.imu]`; all of it may be left out: an ideal one at the body's origin."""
    fields = {field.key: field for field in load().fields_of(IMU) if field.key != DELAY}
    angles = [key for key in fields if key.endswith("_rad")]
    imu: dict[str, Any] = {key: _of_axes(table, field) if field.items else _one(table, field)
           for key, field in fields.items()
           if table.has(key) or (key in angles and table.has(f"{key.removesuffix('_rad')}_deg"))}
    imu[DELAY_S] = read_number(table, DELAY_S)
    table.done()
    if "seed" in imu and not any(imu.get(key) for key in NOISES):
        table.fail("seed", f"has no effect without noise; take it out, or give {' or '.join(NOISES)}")
    return imu


def _one(table: Table, field: Field) -> Any:
    return _whole(table, field.key, table.whole(field.key)) if field.kind == "INTEGER" else read_field(table, field)


def _of_axes(table: Table, field: Field) -> tuple[float, ...]:
    """One number for both axes, or a list with that of x and that of y."""
    given = table.value(field.key, ..., (int, float, list), f"a number, or a list of {field.items}")
    many = isinstance(given, list)
    return table.numbers(field.key, field.items) if many else (table.number(field.key),) * field.items


def _whole(table: Table, key: str, value: int) -> int:
    """A whole number that the core has room for."""
    if not -(2**31) <= value < 2**31:
        table.fail(key, f"is {value}; give a whole number of at most 32 bits, {-(2**31)} to {2**31 - 1}")
    return value


def read_encoder(table: Table, wheel_count: int) -> dict[str, Any]:
    """`[sensors.encoder]`: an encoder at each wheel, or at those that the list of counts names."""
    given = {COUNTS: table.value(COUNTS, ..., (object,), A_COUNT)} if wheel_count else {}
    given |= {key: table.value(key, ..., (object,), "") for key in (GEAR, WRAP) if table.has(key)}
    encoder = read_encoders(given, wheel_count, table.fail)
    table.done()
    return encoder


def missing_sensors(sensors: SensorTables, wheel_count: int) -> Mapping[str, str]:
    """Signals that this scene does not have, and what to do about it, by their names with and without an index."""
    missing: dict[str, str] = {}
    if sensors.imu is None:
        for name, length in OF_IMU.items():
            signals = [name, *(f"{name}[{i}]" for i in range(1, length + 1))]
            missing |= dict.fromkeys(signals, "is an IMU's, and the scene has none; give [sensors.imu]")
    for name in OF_ENCODERS:
        if sensors.encoder is None:
            missing[name] = "is an encoder's, and the scene has none; give [sensors.encoder]"
        for i in range(1, wheel_count + 1):
            if not sensors.has_encoder(i):
                missing[f"{name}[{i}]"] = missing.get(name) or (
                    f"is an encoder's, and wheel {i} has none; give it counts in sensors.encoder.counts_per_turn")
    return missing
