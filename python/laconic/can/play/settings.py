"""The settings of each drive: what `[rig.drives]` gives, else the vehicle's motor, else the protocol's usual value, and
loop gains from the inertia that a wheel turns.

The settings of drives as PARAMETER numbers of a node.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from laconic.can.play.protocols import OF_MAP, PROTOCOLS, DriveProtocol
from laconic.can.play.vehicle import moved_inertia
from laconic.can.rig.options import in_hex, read_id_base
from laconic.can.rig.parameters import Parameter
from laconic.can.rig.wire import ID_STRIDE
from laconic.errors import BadInput, nearest_of
from laconic.scene import Scene
from laconic.scene.drives import DRIVE_PROTOCOLS, NUMBERS, Drives, axes_with_motors

SPEED_BANDWIDTH_RAD_PER_S = 30.0
STEPS_PER_RADIAN = 10.0            # the speed loop's bandwidth is at most the step rate over this
INTEGRAL_SHARE, POSITION_SHARE = 0.25, 0.25  # of that bandwidth: a double pole, and a loop around it that stays calm

OF_MOTOR = {"gear_ratio": "gear_ratio", "torque_constant_Nm_per_A": "torque_constant_Nm_per_A",
            "back_emf_Vs_per_rad": "back_emf_Vs_per_rad", "winding_resistance_ohm": "resistance_ohm"}
OF_DRIVE = ("supply_V", "current_limit_A")
MAY_BE_ZERO = {"speed_limit_rad_per_s": "none", "supply_V": "no limit", "winding_resistance_ohm": "no limit",
               "current_bandwidth_rad_per_s": "follows at once",
               "stall_time_s": "no fault"}

Origin = tuple[tuple[float, ...], str]


@dataclass(frozen=True)
class DriveSettings:
    """The settings of all drives of one vehicle; each tuple has one entry for each wheel, then for each hinge, 0 where
    there is no drive."""

    protocol: DriveProtocol
    driven: tuple[bool, ...]
    node_ids: tuple[int, ...]
    watchdog_s: float | None           # None: the protocol's own
    numbers: dict[str, tuple[float, ...]]
    origins: dict[str, str] = field(default_factory=dict)  # where each number comes from, for people
    hinges: tuple[str, ...] = ()       # names of the axes behind the wheels

    def of_wheel(self, wheel: int) -> dict[str, float]:
        """The numbers of one wheel's drive, counted from 0."""
        return {key: values[wheel] for key, values in self.numbers.items()}

    def rows(self) -> Iterator[tuple[str, str, str]]:
        """Key, value or values, and origin, for a table."""
        ids = [str(each) for each, has_drive in zip(self.node_ids, self.driven, strict=True) if has_drive]
        yield "node_ids", " ".join(ids), self.origins["node_ids"]
        if self.hinges:
            wheels = len(self.driven) - len(self.hinges)
            names = [*map(str, range(1, wheels + 1)), *self.hinges]
            yield "of", " ".join(name for name, has_drive in zip(names, self.driven, strict=True) if has_drive), \
                "wheels by number, hinges by name"
        for key, values in self.numbers.items():
            used = [f"{value:.6g}" for value, has_drive in zip(values, self.driven, strict=True) if has_drive]
            yield key, used[0] if len(set(used)) == 1 else " ".join(used), self.origins[key]
        if self.watchdog_s is not None:
            yield "watchdog_s", f"{self.watchdog_s:g}", self.origins["watchdog_s"]


def drive_settings(scene: Scene, protocol: str | None, id_base: str | None = None) -> DriveSettings:
    """The drives of a scene; `protocol` and `id_base` are those of the command line. BadInput names the key that nobody
    gives."""
    given = scene.rig.drives or Drives(driven=tuple(
        axes_with_motors(scene.vehicle["wheel"], scene.hinges, scene.slips_on_hinges)))
    chosen = OF_MAP if protocol == OF_MAP.name else PROTOCOLS[protocol_of(scene, given, protocol)]
    if not any(given.driven):
        raise BadInput(f"{scene.path}: vehicle.wheel: none is driven, so there is nothing that a drive could turn; "
                       "take driven = false out of one")
    if given.watchdog_s and chosen.why_no_watchdog:
        raise BadInput(f"{scene.path}: rig.drives.watchdog_s: has no effect with {chosen.name}, "
                       f"{chosen.why_no_watchdog}; take it out")
    ids, ids_origin = node_ids(scene, given, chosen)
    check_identifiers(scene, chosen, ids, given.driven, id_base)
    numbers: dict[str, tuple[float, ...]] = {}
    origins = {"node_ids": ids_origin, "watchdog_s": "rig.drives"}
    for key in NUMBERS:
        values, origins[key] = origin_of(scene, given, chosen, key, numbers)
        numbers[key] = tuple(value if has_drive else 0.0 for value, has_drive in
                             zip(values, given.driven, strict=True))
    return DriveSettings(chosen, given.driven, ids, given.watchdog_s, numbers, origins,
                         tuple(hinge.name for hinge in scene.hinges))


def protocol_of(scene: Scene, given: Drives, protocol: str | None) -> str:
    """The name of the protocol: the command line's, else the scene's."""
    name = protocol or given.protocol
    if name is None:
        raise BadInput(f"{scene.path}: rig.drives.protocol: is missing; give it, or --drives with one of "
                       f"{', '.join(DRIVE_PROTOCOLS)}, or --dbc and --map")
    if name not in PROTOCOLS:
        raise BadInput(f"--drives {name}: there is no such protocol; {nearest_of(name, DRIVE_PROTOCOLS)}")
    return name


def node_ids(scene: Scene, given: Drives, protocol: DriveProtocol) -> tuple[tuple[int, ...], str]:
    """One for each drive, all different and such as the protocol has; 0 for a wheel without a drive."""
    if given.node_ids is None:
        count = iter(range(protocol.first_id, protocol.first_id + len(given.driven)))
        ids, origin = tuple(next(count) if has_drive else 0 for has_drive in given.driven), "counted up"
    else:
        ids, origin = given.node_ids, "rig.drives"
    used = [node_id for node_id, has_drive in zip(ids, given.driven, strict=True) if has_drive]
    for number, node_id in enumerate(used):
        where = f"{scene.path}: rig.drives.node_ids"
        if not protocol.smallest_id <= node_id <= protocol.largest_id:
            raise BadInput(f"{where}: {node_id} is no node id of {protocol.name}; give numbers from "
                           f"{protocol.smallest_id} to {protocol.largest_id}")
        if node_id in used[:number]:
            raise BadInput(f"{where}: {node_id} is given twice; give each drive its own")
    return ids, origin


def check_identifiers(scene: Scene, protocol: DriveProtocol, ids: tuple[int, ...], driven: tuple[bool, ...],
                      id_base: str | None) -> None:
    """BadInput where a drive and the node's own frames would use the same identifier."""
    base = read_id_base(id_base, scene)
    own = range(base, base + ID_STRIDE)
    for node_id, has_drive in zip(ids, driven, strict=True):
        if has_drive and (both := [each for each in protocol.identifiers(node_id) if each in own]):
            raise BadInput(f"{scene.path}: rig.drives.node_ids: drive {node_id} of {protocol.name} uses "
                           f"{in_hex(min(both))}, which is one of the node's own from {in_hex(base)}; give another "
                           "node id, --id-base or [rig] id_base")


def origin_of(scene: Scene, given: Drives, protocol: DriveProtocol, key: str,
              before: dict[str, tuple[float, ...]]) -> Origin:
    """The values of one key and where they come from; `before` are those of the keys before it."""
    count = len(given.driven)
    motor, limits = scene.vehicle.get("motor", {}), scene.vehicle.get("drive", {})
    steered = [dict(hinge.motor) for hinge in scene.hinges]
    if key in given.numbers:
        return given.numbers[key], "rig.drives"
    if key in DERIVED:
        return DERIVED[key](scene, given, before), DERIVED_TEXT[key]
    if key in OF_MOTOR and (has_own(motor, key) or any(has_own(each, key) for each in steered)):
        return of_motors(scene, given, protocol, key, [*[motor] * scene.wheel_count, *steered], before)
    if key in OF_DRIVE and limits.get(key):
        return (limits[key],) * count, f"vehicle.drive.{key}"
    if key in protocol.usual and not (motor and key == "winding_resistance_ohm"):
        return (float(protocol.usual[key]),) * count, protocol.why_usual or f"usual with {protocol.name}"
    if key == "back_emf_Vs_per_rad":
        return before["torque_constant_Nm_per_A"], "as the torque constant"
    if key in MAY_BE_ZERO:
        return (0.0,) * count, MAY_BE_ZERO[key]
    where = " or [vehicle.motor]" if key in OF_MOTOR else " or [vehicle.drive]" if key in OF_DRIVE else ""
    raise BadInput(f"{scene.path}: rig.drives.{key}: is missing, and {protocol.name} has no usual one; give it{where}")


def of_motors(scene: Scene, given: Drives, protocol: DriveProtocol, key: str, motors: Sequence[dict[str, float]],
              before: dict[str, tuple[float, ...]]) -> Origin:
    """Of the motors that have the number; of other axes the protocol's usual one."""
    values = []
    for axis, (motor, has_drive) in enumerate(zip(motors, given.driven, strict=True)):
        if has_own(motor, key):
            values.append(motor[OF_MOTOR[key]])
        elif key in protocol.usual:
            values.append(float(protocol.usual[key]))
        elif key == "back_emf_Vs_per_rad":
            values.append(before["torque_constant_Nm_per_A"][axis])
        elif not has_drive or key in MAY_BE_ZERO:
            values.append(0.0)
        else:
            raise BadInput(f"{scene.path}: rig.drives.{key}: is missing for axis {axis + 1}, and {protocol.name} has "
                           "no usual one; give a list with one for each wheel and then for each hinge")
    of_axes = ", and of steering motors" if any(has_own(motor, key) for motor in motors[scene.wheel_count :]) else ""
    return tuple(values), f"vehicle.motor.{OF_MOTOR[key]}{of_axes}"


def has_own(motor: dict[str, float], key: str) -> bool:
    """Whether [vehicle.motor] has a value that a drive can have; only a gear may be below 0."""
    value = motor.get(OF_MOTOR[key], 0.0)
    return value > 0.0 or (key == "gear_ratio" and value != 0.0)


# ---- gains

def bandwidth_rad_per_s(scene: Scene) -> float:
    """Of the speed loop that the usual gains give."""
    return min(SPEED_BANDWIDTH_RAD_PER_S, 1.0 / (STEPS_PER_RADIAN * scene.run.step_s))


def _speed_gain(scene: Scene, given: Drives, before: dict[str, tuple[float, ...]]) -> tuple[float, ...]:
    """Current for an error of the shaft's speed: bandwidth · inertia at the shaft / torque constant."""
    bandwidth, inertias = bandwidth_rad_per_s(scene), moved_inertia(scene, given.driven)
    rows = zip(given.driven, inertias, before["gear_ratio"], before["torque_constant_Nm_per_A"], strict=True)
    return tuple(bandwidth * inertia / (gear * gear * constant) if has_drive else 0.0
                 for has_drive, inertia, gear, constant in rows)


def _integral_gain(scene: Scene, given: Drives, before: dict[str, tuple[float, ...]]) -> tuple[float, ...]:
    return tuple(INTEGRAL_SHARE * bandwidth_rad_per_s(scene) * gain for gain in before["speed_gain_As"])


def _position_gain(scene: Scene, given: Drives, before: dict[str, tuple[float, ...]]) -> tuple[float, ...]:
    return (POSITION_SHARE * bandwidth_rad_per_s(scene),) * len(given.driven)


Derivation = Callable[[Scene, Drives, dict[str, tuple[float, ...]]], tuple[float, ...]]
DERIVED: dict[str, Derivation] = {"position_gain_per_s": _position_gain, "speed_gain_As": _speed_gain,
                                  "speed_integral_gain_A": _integral_gain}
DERIVED_TEXT = {"position_gain_per_s": "a quarter of the speed loop's bandwidth",
                "speed_gain_As": "from the inertia that the wheel turns",
                "speed_integral_gain_A": "from the speed gain"}


def as_values(settings: DriveSettings) -> dict[str, Any]:
    """For JSON."""
    return {"protocol": settings.protocol.name, "node_ids": [
        node_id if has_drive else None for node_id, has_drive in zip(settings.node_ids, settings.driven, strict=True)],
        "watchdog_s": settings.watchdog_s, **{key: list(values) for key, values in settings.numbers.items()}}


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
