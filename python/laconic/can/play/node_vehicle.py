"""The vehicle in a node, whose C code speaks the protocol of the drives: in another process, on a board,
or a node that is on the controller's bus already.

The node's own frames are the channel by which play loads, starts and watches it; the controller hears nothing of them
but where the node itself is on its bus.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import can

from laconic.can.play.faults import DriveFault
from laconic.can.play.loop import Lateness
from laconic.can.play.orders import Orders
from laconic.can.play.protocols import ERROR_FRAMES, ORDERS
from laconic.can.play.senders import Senders
from laconic.can.play.settings import DriveSettings, drive_parameters
from laconic.can.play.stopping import Pose
from laconic.can.play.vehicle import played, without_sensors
from laconic.can.rig.client import RUNNING, NodeClient, come_to_rest, stop_running
from laconic.can.rig.errors import BusDied, NodeRefused, NodeSilent
from laconic.can.rig.faults import error_frame
from laconic.can.rig.hinged import HingedTwin, load_hinged
from laconic.can.rig.link import receive_on, send_on
from laconic.can.rig.lockstep import load_scene
from laconic.can.rig.wire import ID_STRIDE, Frame, wire
from laconic.errors import BadInput, LaconicError, ResultFails
from laconic.scene import Scene

POLL_US = 500                 # a node behind a serial line is asked so often
LOOK_US = 10_000              # drives in this process are looked at so often
PATIENCE_S = 0.5              # for the figures at the end
MOTION = ("NU", "VELOCITY")   # frames that tell it, of vehicles without and with hinges
SOME_DRIVE = "a drive heard no controller in time"  # all that HEARTBEAT tells
FAULT_WATCHDOG = 32           # LACONIC_DRIVE_FAULT_WATCHDOG


class NodeVehicle:
    """A node that plays. `client` is the way to it; `watched` are frames of its own that come while it plays."""

    watched: tuple[str, ...] = ("COUNTERS",)  # and with any of them HEARTBEAT

    def __init__(self, client: NodeClient, scene: Scene, settings: DriveSettings):
        self.client, self.scene, self.settings = client, scene, settings
        self.lateness = Lateness()
        self._late_before = 0
        self._last_nu: tuple[Frame, bytes] | None = None
        self._pose: Pose | None = None
        self._own = range(client.link.id_base, client.link.id_base + ID_STRIDE)
        self._fired: set[str] = set()
        self._ending: LaconicError | None = None
        self._notes: list[str] = []
        self._model: Any = None
        self._orders = Orders(client)
        self._ordered: dict[int, int] = {}   # faults by order, by wheel
        self._disturbed: set[int] = set()    # node ids whose frames meet errors
        self._senders = Senders(settings)
        self._early: list[can.Message] = []  # what the drives said before the loop began, such as a boot-up message

    def start(self) -> None:
        """Loads vehicle and drives, and starts them."""
        found = stop_running(self.client)
        if found in RUNNING:
            self._notes.append(f"the node was found in state {found} and has been stopped before")
        self.client.link.listeners.append(self._hear_early)
        try:
            self._load(without_sensors(played(self.scene, self.settings.driven)))
            self._count_before()
            self.choose_frames(*self.watched)
            self.client.start_drives()
        except NodeRefused as refused:
            raise BadInput(f"{self.scene.path}: rig.drives: {refused}; {remedy(refused, self.scene)}") from None
        finally:
            self.client.link.listeners.remove(self._hear_early)

    def _load(self, scene: Scene) -> None:
        if scene.has_hinges:
            load_hinged(self.client, HingedTwin(scene), drive_parameters(self.settings))
        else:
            load_scene(self.client, scene, drive_parameters(self.settings))

    def _hear_early(self, message: can.Message) -> None:
        if not self.is_own(message):
            self._early.append(message)

    def _take_early(self) -> list[can.Message]:
        early, self._early = self._early, []
        return early

    def _count_before(self) -> None:
        """Late periods of earlier runs, which the node's counter includes; one that was empty has had none."""
        if self.client.found != "empty":
            self.choose_frames("COUNTERS")
            self._late_before = self.client.counter("late_periods")

    def choose_frames(self, *names: str) -> None:
        """The frames of the node that come from now on; none: it is silent."""
        self.client.select(**{f"send_{name.lower()}": 1 for name in names})

    def is_own(self, message: can.Message) -> bool:
        """Whether a frame is one of the node's own, not of its drives."""
        return message.arbitration_id in self._own and not message.is_extended_id

    def take_own(self, message: can.Message) -> None:
        """A frame of the node itself."""
        received = self.client.link.take(message)
        if received is not None:
            self._look_at(*received)

    def _look_at(self, frame: Frame, data: bytes) -> None:
        """HEARTBEAT tells the state, and by `deaf` whether a watchdog of the drives has ever fired; NU the motion."""
        if frame.name in MOTION:
            self._last_nu = (frame, data)
        if frame.name == "RESULT":
            self._orders.take(frame.unpack(data))
        if frame.name != "HEARTBEAT":
            return
        values = frame.unpack(data)
        if values["deaf"]:
            self._note_unheard()
        state = wire().choice("HEARTBEAT", "state", values["state"])
        if state not in ("drives", "ready"):
            self._ending = ResultFails(f"the node went into state {state} after {values['steps']} steps")

    def is_private(self, message: can.Message) -> bool:
        """Never, where play and controller have a bus each."""
        return False

    def has_sent(self, message: can.Message) -> bool:
        """Never, where play and controller have a bus each."""
        return False

    def _note_unheard(self) -> None:
        """A watchdog of some drive has fired."""
        self._fired.add(SOME_DRIVE)

    def ending(self) -> LaconicError | None:
        """A step that the core refused, or a fault that could not be ordered."""
        return self._ending or self._orders.failure

    def break_drive(self, fault: DriveFault, *, is_broken: bool) -> None:
        """A fault of a drive begins, or ends."""
        if fault.kind == ERROR_FRAMES:
            node_id = self.settings.node_ids[fault.wheel - 1]
            (self._disturbed.add if is_broken else self._disturbed.discard)(node_id)
            return
        bit, now = ORDERS[fault.kind], self._ordered.get(fault.wheel, 0)
        self._ordered[fault.wheel] = now | bit if is_broken else now & ~bit
        self.order(fault.wheel, self._ordered[fault.wheel])

    def order(self, wheel: int, faults: int) -> None:
        """All faults by order of a wheel's drive from now on."""
        self._orders.give(wheel, faults)

    def disturbed(self, message: can.Message) -> Iterator[can.Message]:
        """A frame of a drive as the controller hears it."""
        if self._disturbed and self._senders.node_of(message) in self._disturbed:
            yield error_frame()
        yield message

    @property
    def tells_motion(self) -> bool:
        """Whether NU comes while it plays."""
        return bool({*MOTION} & {*self.watched})

    def pose(self) -> Pose | None:
        """At the end, by POSE: to a millimetre, within what that frame can tell."""
        return self._pose

    def speed(self) -> tuple[float, float]:
        """Of the centre of mass and in yaw, from the node's own NU; 0 before the first one."""
        if self._last_nu is None:
            return 0.0, 0.0
        frame, data = self._last_nu
        if frame.name == "VELOCITY":
            values = frame.physical(data)
            return math.hypot(values["ahead"], values["left"]), abs(values["yaw_rate"])
        raw = frame.unpack(data)
        ahead, sideways, turning = (raw[f"nu_{k}"] * frame.fields[f"nu_{k}"].scale for k in (1, 2, 3))
        if self._model is None:
            self._model = self.scene.model(self.scene.core())
        return self._model.wheel_radius_m * math.hypot(ahead, sideways), abs(turning / self._model.yaw_scale)

    def watchdogs(self) -> list[str]:
        """Drives whose controller was silent."""
        return sorted(self._fired - {SOME_DRIVE} or self._fired)

    def notes(self) -> list[str]:
        """What else there is to say."""
        return self._notes

    def finish(self) -> None:
        """Stops the node, then asks for its figures: while it waited for them, it would play on without frames of the
        controller, and a watchdog of the drives would fire. Its pose comes with a step, so it is asked for before."""
        with suppress(NodeSilent, NodeRefused, BusDied):
            self._read_pose()
        if (failure := come_to_rest(self.client)) is not None:
            self._notes.append(f"the node could not be stopped: {failure}")
        with suppress(NodeSilent, NodeRefused, BusDied):
            self._read_figures()

    def _read_pose(self) -> None:
        link = self.client.link
        self.choose_frames("COUNTERS", "POSE")
        deadline_us = link.deadline_us(PATIENCE_S)
        while (received := link.receive_until(deadline_us)) is not None:
            frame, data = received
            self._look_at(*received)
            if frame.name == "POSE":
                values = frame.unpack(data)
                self._pose = None if values["overrange"] else pose_of(frame, values)
                return

    def _read_figures(self) -> None:
        link, wanted = self.client.link, {"HEARTBEAT", "COUNTERS"}
        self.choose_frames("COUNTERS")
        deadline_us = link.deadline_us(PATIENCE_S)
        while wanted and (received := link.receive_until(deadline_us)) is not None:
            frame, data = received
            values = frame.unpack(data)
            self._look_at(*received)
            if frame.name == "HEARTBEAT":
                self.lateness.periods, self.lateness.worst_us = values["steps"], values["worst_lateness"]
                wanted.discard(frame.name)
            elif frame.name == "COUNTERS" and "late_periods" in values:
                self.lateness.late_periods = values["late_periods"] - self._late_before
                wanted.discard(frame.name)


def pose_of(frame: Frame, values: dict[str, int]) -> Pose:
    """The numbers of POSE."""
    x_m, y_m, heading_rad = (values[name] * frame.fields[name].scale for name in ("x", "y", "heading"))
    return x_m, y_m, heading_rad


def remedy(refused: NodeRefused, scene: Scene) -> str:
    """What to do about a refusal of drives."""
    if refused.status == "not supported":
        if refused.field == "DRIVE_PROTOCOL":
            return "this build of the node does not speak that protocol; choose another --drives or --board"
        return f"this build of the node leaves {refused.field} out; choose another --board, or a scene without it"
    if refused.status == "out of range":
        return (f"drives step once a period, so 1 / step must be a whole number from 1 to 10000, and run.step_s is "
                f"{scene.run.step_s:g}; give another --step")
    return "correct that key, see docs/play.md"


class Bridged(NodeVehicle):
    """A node behind a line of its own, such as SLCAN to a process or an emulated board: frames are passed on."""

    def on_message(self, message: can.Message, now_us: int) -> None:
        """To the node."""
        if not self.is_own(message):
            send_on(self.client.link.bus, message)

    def advance(self, now_us: int) -> Iterator[can.Message]:
        """What the node has sent."""
        self._orders.go_on(now_us)
        yield from self._take_early()
        bus = self.client.link.bus
        while (message := receive_on(bus, 0.0)) is not None:
            if self.is_own(message):
                self.take_own(message)
            else:
                yield from self.disturbed(message)

    def idle_us(self, now_us: int) -> int:
        """The node has its own clock; it is asked in short intervals."""
        return POLL_US


class OnBus(NodeVehicle):
    """A node that is a station of the controller's own bus: play only watches."""

    def __init__(self, client: NodeClient, scene: Scene, settings: DriveSettings, *, hears_alone: bool = False):
        super().__init__(client, scene, settings)
        self._hears_alone = hears_alone
        if not hears_alone:
            self.watched = ()  # they would come to the controller, too

    def is_private(self, message: can.Message) -> bool:
        """Frames of the node itself, on a port that gives them to play alone."""
        return self._hears_alone and self.is_own(message)

    def on_message(self, message: can.Message, now_us: int) -> None:
        """A frame of anybody."""
        if self.is_own(message):
            self.take_own(message)

    def has_sent(self, message: can.Message) -> bool:
        """Frames of the drives and of the node, by what their identifiers tell."""
        return self.is_own(message) or self._senders.node_of(message) is not None

    def advance(self, now_us: int) -> Iterator[can.Message]:
        """Nothing: the node sends for itself."""
        self._orders.go_on(now_us)
        return iter(())

    def idle_us(self, now_us: int) -> int:
        """Nothing is ever due."""
        return LOOK_US


@contextmanager
def running(vehicle: NodeVehicle) -> Iterator[NodeVehicle]:
    """A node that plays, and is at rest at the end."""
    vehicle.start()
    try:
        yield vehicle
    finally:
        vehicle.finish()
