"""The drives' C code (laconic_drives/drive.h) in this process, for maps: what a protocol would ask of a drive, a DBC's
signals ask."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from laconic.can.play.settings import DriveSettings
from laconic.can.rig.node_library import node_library
from laconic.core.plant import Plant
from laconic.errors import BadInput

OFF, CURRENT, SPEED, POSITION = range(4)  # laconic_drive_mode
WHOLE = ("encoder_counts",)
MOST_COUNTS = 2.0**62  # a place beyond is taken as this one: the encoder's 64 bits count no further


class WheelDrive:
    """One laconic_wheel_drive; `seen` is what it measured at the end of the last step."""

    def __init__(self, lib: Any, ffi: Any, numbers: Mapping[str, float], node_id: int):
        self._lib, self.encoder_counts = lib, int(numbers["encoder_counts"])
        self.gear_ratio = numbers["gear_ratio"]
        self.is_held = False
        self._memory = ffi.new("uint64_t[]", (lib.laconic_library_wheel_drive_size() + 7) // 8)
        self.c = ffi.cast("struct laconic_wheel_drive *", self._memory)
        whole = {key: int(value) if key in WHOLE else value for key, value in numbers.items()}
        lib.laconic_library_wheel_drive_start(
            self.c, ffi.new("laconic_library_drive_settings *", {"node_id": node_id, **whole}))
        self.seen: Any = ffi.new("laconic_library_measured *")
        self._look()

    def _look(self) -> None:
        self._lib.laconic_library_wheel_drive_measured(self.c, self.seen)

    def aim(self, mode: int, position_rad: float = 0.0, speed_rad_per_s: float = 0.0, current_A: float = 0.0) -> None:
        """Its target, at the motor's shaft."""
        exact = min(max(position_rad * self.encoder_counts / (2.0 * math.pi), -MOST_COUNTS), MOST_COUNTS)
        count = math.floor(exact)
        self._lib.laconic_library_wheel_drive_aim(self.c, mode, count, exact - count, speed_rad_per_s, current_A)

    def clear(self) -> None:
        """Clears the faults whose cause has gone."""
        self._lib.laconic_library_wheel_drive_clear(self.c)

    def break_down(self, faults: int, *, is_broken: bool) -> None:
        """Faults begin that nobody clears, or end."""
        lib = self._lib
        change = lib.laconic_library_wheel_drive_break if is_broken else lib.laconic_library_wheel_drive_mend
        change(self.c, faults)

    def hold(self, *, is_held: bool) -> None:
        """A brake holds the wheel from now on, or lets it go."""
        self._lib.laconic_library_wheel_drive_hold(self.c, is_held)
        self.is_held = is_held

    def brake(self, plant: Any, wheel: int, speed_rad_per_s: float, share: float) -> float:
        """The torque of the brake at the axle for the next step, after `act`; `plant`: the address of its plant."""
        return float(self._lib.laconic_library_wheel_drive_brake(self.c, plant, wheel, speed_rad_per_s, share))

    def act(self, step_s: float) -> float:
        """The torque at the wheel's axle for the next step."""
        return float(self._lib.laconic_library_wheel_drive_act(self.c, step_s))

    def measure(self, turned_rad: float, speed_rad_per_s: float) -> None:
        """What its wheel did in the step just taken."""
        self._lib.laconic_library_wheel_drive_measure(self.c, turned_rad, speed_rad_per_s)
        self._look()


class DriveGroup:
    """One drive for each wheel that has one, by the wheel's number from 0."""

    def __init__(self, settings: DriveSettings, real: str, step_s: float):
        self.step_s, library = step_s, node_library(real)
        if not hasattr(library.lib, "laconic_library_wheel_drive_start"):
            raise BadInput("drives: this build of the node has none; build it with LACONIC_NODE_WITH_DRIVES=1")
        self._library = library
        self.drives = {
            wheel: WheelDrive(library.lib, library.ffi, settings.of_wheel(wheel), settings.node_ids[wheel])
            for wheel, has_drive in enumerate(settings.driven) if has_drive}

    def aim(self, wheel: int, targets: Mapping[str, float]) -> None:
        """What one drive shall do: position before speed before current, each with the others fed forward."""
        mode = POSITION if "drive_position_rad" in targets else SPEED if "drive_speed_rad_per_s" in targets else CURRENT
        self.drives[wheel].aim(mode, targets.get("drive_position_rad", 0.0), targets.get("drive_speed_rad_per_s", 0.0),
                               targets.get("drive_current_A", 0.0))

    def torques(self) -> dict[int, float]:
        """At each wheel's axle, for the next step."""
        return {wheel: drive.act(self.step_s) for wheel, drive in self.drives.items()}

    def brakes(self, plant: Plant) -> dict[int, float]:
        """Torques of the brakes that hold a wheel, for the next step."""
        held = [wheel for wheel, drive in self.drives.items() if drive.is_held]
        if not held:
            return {}
        core_ffi, ffi, speeds = plant.core.ffi, self._library.ffi, plant.wheel_speeds()
        assert core_ffi.sizeof("laconic_plant") == self._library.lib.laconic_library_plant_size()
        address = ffi.cast("void *", int(core_ffi.cast("uintptr_t", plant.c)))
        return {wheel: self.drives[wheel].brake(address, wheel, float(speeds[wheel]), 1.0 / len(held))
                for wheel in held}

    def measure(self, turned_rad: Any, speeds_rad_per_s: Any) -> None:
        """What the wheels did in the step just taken."""
        for wheel, drive in self.drives.items():
            drive.measure(float(turned_rad[wheel]), float(speeds_rad_per_s[wheel]))
