"""The vehicle of a map: a plant of the core, its inputs by name, and drives where the map asks for them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from laconic.can.play.drives import OFF, DriveGroup
from laconic.can.play.map_signals import ENABLE, OF_DRIVES, TARGETS, split
from laconic.can.play.settings import DriveSettings
from laconic.core.plant import Plant
from laconic.core.sensors import Readings
from laconic.scene import Scene

ON = 0.5  # enabled from here on: a truth value may come scaled


class MapPlant:
    """Steps with the inputs as they stand. `inputs` are values by name; what nobody has set is 0."""

    def __init__(self, scene: Scene, settings: DriveSettings | None, joined: Iterable[str]):
        self.scene, self.core = scene, scene.core()
        self.plant: Plant = scene.plant(self.core)
        self.sensors = scene.sensors_of(self.plant)
        self.drives = DriveGroup(settings, scene.run.real, self.plant.step_s) if settings is not None else None
        self.inputs: dict[str, float] = {}
        self._joined = {name for name in joined if split(name)[0] in OF_DRIVES}
        self._row = np.zeros(self.core.input_length, self.core.dtype)
        self._held = self.core.input(self._row)
        self._angles = self.plant.wheel_angles()
        self._were_on: set[int] = set()
        self._turned: dict[int, float] = {}  # of each drive's shaft since the start
        self.is_off = False   # a timeout has switched the drives off

    # ---- inputs

    def set(self, values: Mapping[str, float]) -> None:
        """Inputs that a frame brought."""
        self.inputs.update(values)
        self.is_off = False

    def clear(self, names: Iterable[str], *, off: bool) -> None:
        """Inputs whose commands have ceased become 0; `off`: drives coast instead of holding speed 0."""
        for name in names:
            if name in self.inputs and split(name)[0] != ENABLE:
                self.inputs[name] = 0.0
        self.is_off = self.is_off or off

    def _aim(self, drives: DriveGroup) -> None:
        for wheel in drives.drives:
            on = self._is_on(wheel)
            if not on:
                drives.drives[wheel].aim(OFF)
                self._were_on.discard(wheel)
                continue
            if wheel not in self._were_on:
                drives.drives[wheel].clear()
                self._were_on.add(wheel)
            drives.aim(wheel, self._targets(wheel))

    def _targets(self, wheel: int) -> dict[str, float]:
        names = ((stem, f"{stem}[{wheel + 1}]") for stem in TARGETS)
        return {stem: self.inputs[name] for stem, name in names if name in self.inputs}

    def _is_on(self, wheel: int) -> bool:
        """Whether a drive has a target and is enabled, by its own signal or that of all drives, where there is one."""
        if self.is_off or not self._targets(wheel):
            return False
        switches = [name for name in (ENABLE, f"{ENABLE}[{wheel + 1}]") if name in self._joined]
        return all(self.inputs.get(name, 0.0) >= ON for name in switches)

    # ---- a step

    def step(self) -> None:
        """One step of the core; Refused leaves the state before it."""
        row = self._row
        row[:] = 0.0
        for name, value in self.inputs.items():
            stem, index = split(name)
            if stem not in OF_DRIVES:
                row[self.core.input_fields[stem][0] + index] = value
        if self.drives is not None:
            self._aim(self.drives)
            start = self.core.input_fields["axle_torque_Nm"][0]
            for wheel, torque_Nm in self.drives.torques().items():
                row[start + wheel] += torque_Nm
            for wheel, torque_Nm in self.drives.brakes(self.plant).items():
                row[start + wheel] += torque_Nm
        self._held = self.core.input(row)
        self.sensors.run(self._held)
        if self.drives is not None:
            self._measure(self.drives)

    def _measure(self, drives: DriveGroup) -> None:
        before, self._angles = self._angles, self.plant.wheel_angles()
        turned = self._angles - before
        drives.measure(turned, self.plant.wheel_speeds())
        for wheel, drive in drives.drives.items():
            self._turned[wheel] = self._turned.get(wheel, 0.0) + float(turned[wheel]) * drive.gear_ratio

    # ---- outputs

    def drive(self, wheel: int) -> Any:
        """What the drive of a wheel measured: a laconic_library_measured."""
        return self.drives.drives[wheel].seen if self.drives is not None else None

    def drive_angle_rad(self, wheel: int) -> float:
        """How far the motor's shaft has turned."""
        return self._turned.get(wheel, 0.0)

    def pose(self) -> Any:
        """The laconic_pose."""
        return self.plant.pose

    def sensed(self) -> Readings:
        """What the sensors show."""
        return self.sensors.read(self._held)

    def wheel_speeds(self) -> np.ndarray:
        """χ' [rad/s]."""
        return self.plant.wheel_speeds()

    def wheel_angles(self) -> np.ndarray:
        """χ [rad]."""
        return self.plant.wheel_angles()

    def wheel_torques(self) -> np.ndarray:
        """Torque on each axle [N·m] in the step just taken."""
        return self.plant.wheel_torques(self._held)
