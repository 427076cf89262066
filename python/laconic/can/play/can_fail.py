"""What can go wrong on purpose with a vehicle, by where it runs and what it speaks; and why the rest cannot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from laconic.can.play.options import PlayOptions
from laconic.can.play.protocols import BUS_OFF, ERROR_FRAMES, KINDS, OF_WHEEL, SILENT, STALL
from laconic.can.play.settings import DriveSettings
from laconic.scene import Scene

CARRY_ERROR_FRAMES = ("virtual", "udp_multicast")


@dataclass(frozen=True)
class CanFail:
    """Kinds of faults of single wheels, which count from 1, and of the whole vehicle as one station of the bus."""

    wheels: tuple[int, ...]
    of_wheel: tuple[str, ...]
    of_whole: tuple[str, ...] = ()
    why_not: Mapping[str, str] = field(default_factory=dict)

    @property
    def kinds(self) -> tuple[str, ...]:
        """All that are possible."""
        return self.of_wheel + self.of_whole


def drives_can_fail(settings: DriveSettings, options: PlayOptions, *, rolls_on_hinges: bool = False) -> CanFail:
    """Drives of a protocol, each a station of its own. `rolls_on_hinges`: the vehicle has hinges, on ideal ground."""
    why_not = {STALL: "no brake holds a vehicle with hinges on ideal ground; give ground.friction_coefficient"} \
        if rolls_on_hinges else {}
    if not settings.protocol.has_sign_of_life:
        why_not[SILENT] = f"{settings.protocol.name} has no sign of life: its drives speak when they are asked"
    if (why := why_no_error_frames(options)) is not None:
        why_not[ERROR_FRAMES] = why
    wheels = tuple(wheel for wheel, has_drive in enumerate(settings.driven, start=1) if has_drive)
    return CanFail(wheels, tuple(kind for kind in KINDS if kind not in why_not), (), why_not)


def map_can_fail(scene: Scene, settings: DriveSettings | None, options: PlayOptions) -> CanFail:
    """A map's vehicle is one station: what concerns the bus has no wheel."""
    why_not = dict.fromkeys(OF_WHEEL, "this map has no drives; its inputs are forces, torques or voltages")
    of_wheel: tuple[str, ...] = ()
    wheels: tuple[int, ...] = ()
    if settings is not None:
        why_not, of_wheel = {}, OF_WHEEL
        wheels = tuple(wheel for wheel, has_drive in enumerate(settings.driven, start=1) if has_drive)
    of_whole = [BUS_OFF, SILENT, ERROR_FRAMES]
    if (why := why_no_error_frames(options)) is not None:
        why_not[ERROR_FRAMES] = why
        of_whole.remove(ERROR_FRAMES)
    return CanFail(wheels, of_wheel, tuple(of_whole), why_not)


def why_no_error_frames(options: PlayOptions) -> str | None:
    """Why the controller's bus cannot carry error frames that a program makes; None: it can."""
    if options.is_served:
        return f"with --board {options.board} frames do not pass through this process"
    if options.listen is not None:
        return None  # as status flags, all that SLCAN has
    interface = next((each.partition("=")[2] for each in options.bus_options if each.startswith("under=")), "virtual") \
        if options.interface == "faulty" else options.interface
    if interface in CARRY_ERROR_FRAMES:
        return None
    return (f"--interface {interface} cannot send them, since a CAN controller makes them itself; give --bus-fault "
            "loss=0.01, or --listen or --interface virtual")
