"""A scene's sensors over the bus: their settings as parameters, and what a node's frames of them must show."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from laconic.can.rig.hinged import HingedPlant
from laconic.can.rig.parameters import Parameter
from laconic.can.rig.wire import Frame
from laconic.core.encoders import signed
from laconic.core.plant import Plant
from laconic.core.sensors import Sensors, values_of
from laconic.errors import BadInput
from laconic.scene import Scene

WATCHED = ("IMU", "ENCODER")                    # frames for which sensors must see every step
SENSED_FRAMES = ("WHEEL_ANGLE", *WATCHED)
RAW_OF_SENSORS = ("raw_imu", "raw_encoder")
INDEX_TURNS = 2**16                             # of ENCODER.index_count
WHOLE_COUNT = 2**32                             # where an encoder wraps without a setting

Twin = Plant | Sensors | HingedPlant
"""What is stepped beside a node: a plant, the sensors that watch it, or a vehicle with hinges."""


def has_sensors(scene: Scene) -> bool:
    """Whether the scene has an IMU or encoders."""
    return scene.sensors.imu is not None or scene.sensors.encoder is not None


def sensor_parameters(scene: Scene, plant: Plant) -> Iterator[Parameter]:
    """The settings of the scene's sensors; what is 0 is left out."""
    if not has_sensors(scene):
        return
    sensors = scene.sensors_of(plant)  # owns the memory of its settings
    settings = sensors.c.settings
    for field in plant.core.sensor_fields:
        for item, value in enumerate(values_of(field, settings), start=int(field.items > 0)):
            if value != 0:
                yield field.identifier, item, value


def twin_of(scene: Scene, plant: Plant, frames: Iterable[str] = ()) -> Twin:
    """A plant of the scene, with its sensors where it has any or these frames show them."""
    return scene.sensors_of(plant) if has_sensors(scene) or set(WATCHED) & set(frames) else plant


def plant_of(twin: Twin) -> Plant:
    """The plant itself, of a vehicle without hinges."""
    if isinstance(twin, HingedPlant):
        raise TypeError("a vehicle with hinges is stepped by itself")
    return twin.plant if isinstance(twin, Sensors) else twin


def moving(twin: Twin) -> Plant | HingedPlant:
    """What takes the steps."""
    return twin if isinstance(twin, HingedPlant) else plant_of(twin)


def check_frames(scene: Scene, frames: Iterable[str]) -> None:
    """BadInput for frames that never come."""
    if "ENCODER" in frames and scene.sensors.encoder is None:
        raise BadInput(f"{scene.path}: rig.frames: ENCODER is an encoder's, and the scene has none; "
                       "give [sensors.encoder]")
    if "WHEEL_ANGLE" in frames and not scene.wheel_count:
        raise BadInput(f"{scene.path}: rig.frames: WHEEL_ANGLE is of wheels, and the vehicle has none")


def frames_of_sensors(scene: Scene, frames: Iterable[str]) -> int:
    """How many of these frames follow a step."""
    counts = (scene.sensors.encoder or {}).get("counts_per_turn", ())
    each = {"WHEEL_ANGLE": math.ceil(scene.wheel_count / 3), "IMU": 1, "ENCODER": sum(map(bool, counts))}
    return sum(each[name] for name in SENSED_FRAMES if name in frames)


def part_of(frame: Frame, raw: dict[str, int]) -> int:
    """Which part of what takes several frames: a group of wheels, or a wheel."""
    return raw.get("wheel", raw.get("group", 0))


def values_of_frame(twin: Twin, frame: Frame, part: int) -> dict[str, float]:
    """The values of a frame of SENSED_FRAMES, in the units of its signals."""
    plant = plant_of(twin)
    if frame.name == "WHEEL_ANGLE":
        wrapped = plant.core.lib.laconic_angle_wrapped
        return {f"wheel_angle_{k + 1}": wrapped(angle)
                for k, angle in enumerate(plant.wheel_angles()[3 * part : 3 * part + 3])}
    if not isinstance(twin, Sensors):
        raise TypeError(f"{frame.name}: a plant without sensors has none")
    shown = twin.read()
    if frame.name == "IMU":
        along, across = shown.imu_acceleration_m_per_s2
        return {"acceleration_x": along, "acceleration_y": across, "yaw_rate": shown.imu_yaw_rate_rad_per_s}
    turns = plant.core.lib.laconic_encoder_turns(
        plant.core.ffi.addressof(twin.c.encoder[part]), twin.c.settings.encoder[part].counts_per_turn)
    return {"count": int(signed(shown.encoder_count)[part]), "index_count": (turns + 2**15) % INDEX_TURNS - 2**15}


def wrap_of(twin: Twin) -> int:
    """Where the twin's encoders begin again."""
    return (isinstance(twin, Sensors) and int(twin.c.settings.encoder_wrap)) or WHOLE_COUNT


def period_of(frame: Frame, signal: str, wrap: int) -> float | None:
    """Of a signal that begins again, such as an angle, after how many steps of its raw value; None of others. `wrap`:
    where encoders begin again."""
    if signal == "heading" or signal.startswith(("wheel_angle", "hinge_angle")):
        return 2.0 * math.pi / frame.fields[signal].scale
    if signal == "index_count":
        return INDEX_TURNS
    return wrap if signal == "count" else None


def raw_row(sensors: Sensors, held: Any) -> np.ndarray:
    """The numbers of raw_imu and raw_encoder, in their order, after a step with this input."""
    shown = sensors.read(held)
    return np.concatenate([shown.acceleration_body_m_per_s2, shown.imu_acceleration_m_per_s2,
                           [shown.imu_yaw_rate_rad_per_s], signed(shown.encoder_count)]).astype(
                               sensors.plant.core.dtype)
