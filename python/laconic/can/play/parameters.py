"""The settings of drives as PARAMETER numbers of a node."""

from __future__ import annotations

from collections.abc import Iterator

from laconic.can.play.settings import DriveSettings
from laconic.can.rig.parameters import Parameter

FIELDS = {
    "encoder_counts": "ENCODER_COUNTS", "gear_ratio": "DRIVE_GEAR_RATIO",
    "torque_constant_Nm_per_A": "DRIVE_TORQUE_CONSTANT", "back_emf_Vs_per_rad": "DRIVE_BACK_EMF",
    "current_limit_A": "DRIVE_CURRENT_LIMIT", "speed_limit_rad_per_s": "DRIVE_SPEED_LIMIT", "supply_V": "DRIVE_SUPPLY",
    "winding_resistance_ohm": "DRIVE_WINDING_RESISTANCE", "current_bandwidth_rad_per_s": "DRIVE_CURRENT_BANDWIDTH",
    "position_gain_per_s": "DRIVE_POSITION_GAIN", "speed_gain_As": "DRIVE_SPEED_GAIN",
    "speed_integral_gain_A": "DRIVE_SPEED_INTEGRAL_GAIN", "stall_time_s": "DRIVE_STALL_TIME"}
WHOLE = ("encoder_counts",)


def drive_parameters(settings: DriveSettings) -> Iterator[Parameter]:
    """The protocol, its watchdog, and the numbers of each wheel that has a drive, counted from 1."""
    yield "DRIVE_PROTOCOL", 0, settings.protocol.number
    if settings.watchdog_s is not None:
        yield "DRIVE_WATCHDOG", 0, settings.watchdog_s
    for wheel, has_drive in enumerate(settings.driven):
        if not has_drive:
            continue
        yield "DRIVE_NODE_ID", wheel + 1, settings.node_ids[wheel]
        for key, value in settings.of_wheel(wheel).items():
            yield FIELDS[key], wheel + 1, int(value) if key in WHOLE else value
