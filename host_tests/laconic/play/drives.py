"""The drives' C code (laconic_drives/drive.h) in this process, for maps: what a protocol would ask of a drive, a DBC's
signals ask."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from laconic.play.settings import DriveSettings
from laconic.rig.node_library import node_library

OFF, CURRENT, SPEED, POSITION = range(4)  # laconic_drive_mode
WHOLE = ("encoder_counts",)


class DriveGroup:
    """One laconic_wheel_drive for each wheel that has one."""

    def __init__(self, settings: DriveSettings, real: str, step_s: float):
        self.settings, self.step_s = settings, step_s
        self._library = node_library(real)
        self._lib = self._library.lib
        self.drives: dict[int, Any] = {}
        for wheel, has_drive in enumerate(settings.driven):
            if has_drive:
                self.drives[wheel] = self._started(wheel)

    def _started(self, wheel: int) -> Any:
        ffi = self._library.ffi
        numbers = {key: int(value) if key in WHOLE else value for key, value in self.settings.of_wheel(wheel).items()}
        given = ffi.new("laconic_drive_settings *", {"node_id": self.settings.node_ids[wheel], **numbers})
        drive = ffi.new("laconic_wheel_drive *")
        self._lib.laconic_drive_start(drive, given)
        return drive

    def aim(self, wheel: int, targets: Mapping[str, float]) -> None:
        """What one drive shall do: position before speed before current, each with the others fed forward."""
        drive = self.drives[wheel]
        target = drive.target
        target.speed_rad_per_s = targets.get("drive_speed_rad_per_s", 0.0)
        target.current_A = targets.get("drive_current_A", 0.0)
        if "drive_position_rad" in targets:
            exact = targets["drive_position_rad"] * float(drive.settings.encoder_counts) / (2.0 * math.pi)
            target.position_count = math.floor(exact)
            target.position_rest = exact - math.floor(exact)
            target.mode = POSITION
        else:
            target.mode = SPEED if "drive_speed_rad_per_s" in targets else CURRENT

    def switch_off(self, wheel: int) -> None:
        """No current: the wheel coasts."""
        self.drives[wheel].target.mode = OFF

    def clear(self, wheel: int) -> None:
        """Clears the faults whose cause has gone."""
        self._lib.laconic_drive_clear(self.drives[wheel])

    def torques(self) -> dict[int, float]:
        """At each wheel's axle, for the next step."""
        return {wheel: float(self._lib.laconic_drive_act(drive, self.step_s)) for wheel, drive in self.drives.items()}

    def measure(self, turned_rad: Any, speeds_rad_per_s: Any) -> None:
        """What the wheels did in the step just taken."""
        for wheel, drive in self.drives.items():
            self._lib.laconic_drive_measure(drive, float(turned_rad[wheel]), float(speeds_rad_per_s[wheel]))
