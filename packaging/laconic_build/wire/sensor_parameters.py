"""The meaning of each PARAMETER of sensors, from the rows of their list (laconic/sensors.h)."""

from __future__ import annotations

import re

from laconic.base.paths import SOURCE_DIR

from .drive_parameters import unit_of

LIST = SOURCE_DIR / "core_c" / "include" / "laconic" / "sensors.h"
GROUP = re.compile(r"#define LACONIC_(\w+)_FIELDS\(X, of\)((?:.*\\\n)*.*)")
ROW = re.compile(r"X\(of, +\d+, (\w+), +(\w+),[\s\\]+\w+,[\s\\]+(\w+),[\s\\]+\w+,[\s\\]+\w+\)")
TABLES = {"IMU": ("imu", "0"), "IMU_ARRAY": ("imu", "1, 2"), "ENCODER": ("encoder", "0"),
          "WHEEL_ENCODER": ("encoder", "wheel")}
NOTES = {"IMU_ACCELERATION_RANGE": ": 0: none", "IMU_YAW_RATE_RANGE": ": 0: none",
         "IMU_DELAY": ": in a scene delay_s", "WHEEL_ENCODER_COUNTS": ": 0 or not sent: the wheel has no encoder",
         "WHEEL_ENCODER_GEAR_RATIO": ": turns of the encoder for one of the wheel, below 0: reversed; 0: 1",
         "WHEEL_ENCODER_WRAP": ": it shows 0 to one less; 0: 32 bits with sign"}


def sensor_parameters() -> dict[str, tuple[str, str, str, str]]:
    """Field in the DBC → key in a scene, unit, item, when it is required."""
    found = {}
    for group, rows in GROUP.findall(LIST.read_text(encoding="utf-8")):
        table, item = TABLES[group]
        for identifier, member, kind in ROW.findall(rows):
            found[identifier] = (f"sensors.{table}.{member}{NOTES.get(identifier, '')}", unit_of(member, kind), item,
                                 "")
    return found
