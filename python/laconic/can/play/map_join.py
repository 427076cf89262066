"""A map joined to its DBC, to the model and to a scene; what does not fit is one line that names message and signal."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

from laconic.can.dbc_file import load_dbc
from laconic.can.play.map_dbc import DbcMessage
from laconic.can.play.map_file import REMOTE, Joint, Received, Sent, SignalMap
from laconic.can.play.map_messages import Receiver, Sender
from laconic.can.play.map_signals import DRIVE_OUTPUTS, ENABLE, TARGETS, split
from laconic.scene import Scene
from laconic.scene.sensors import missing_sensors

Key = tuple[int, bool]
Part = TypeVar("Part", Received, Sent)


@dataclass
class Joined:
    """A map whose names are all found in the DBC and the model."""

    given: SignalMap
    receivers: dict[Key, Receiver] = field(default_factory=dict)
    senders: list[Sender] = field(default_factory=list)
    requests: dict[Key, list[Sender]] = field(default_factory=dict)  # what asks for them

    @property
    def inputs(self) -> list[str]:
        """Inputs of the model that a signal sets."""
        return [joint.model for each in self.receivers.values() for joint in each.given.joints]

    @property
    def has_drives(self) -> bool:
        """Whether a signal is the target of a drive, so that drives turn the wheels."""
        return any(split(name)[0] in TARGETS for name in self.inputs)


def join(given: SignalMap, dbc: Path) -> Joined:
    """Joins a map to a DBC; BadInput names map, DBC, message and signal."""
    database, joined = load_dbc(dbc, f"--dbc {dbc}:"), Joined(given)
    for received in given.received:
        where = f"{given.path}: {received.where}"
        message = DbcMessage(dbc, database, where, received.message)
        if message.key in joined.receivers:
            message.fail("message", "is received twice in this map; put all of its signals under one [[receive]]")
        joined.receivers[message.key] = Receiver(located(given, received), message)
    for sent in given.sent:
        message = DbcMessage(dbc, database, f"{given.path}: {sent.where}", sent.message)
        if message.key in joined.receivers:
            message.fail("message", "is received in this map, too; two stations must not send the same message")
        sender = Sender(located(given, sent), message)
        joined.senders.append(sender)
        if sent.on_request:
            asks = message if sent.on_request == REMOTE else DbcMessage(
                dbc, database, f"{given.path}: {sent.where}", sent.on_request, "on_request")
            joined.requests.setdefault(asks.key, []).append(sender)
            if asks is not message and sent.on_request in {each.message for each in given.sent}:
                message.fail("on_request", f"is asked for by {sent.on_request}, which the vehicle sends itself; name a "
                             f'message of the controller, or "{REMOTE}"')
    check_once(joined)
    check_drives(joined)
    check_places(joined)
    return joined


def located(given: SignalMap, part: Part) -> Part:
    """A part of a map whose joints are located by file and key."""
    joints = tuple(replace(joint, where=f"{given.path}: {joint.where}") for joint in part.joints)
    return replace(part, joints=joints)


def check_once(joined: Joined) -> None:
    """BadInput where an input has two signals, or a signal two outputs."""
    seen: dict[str, Joint] = {}
    for receiver in joined.receivers.values():
        for joint in receiver.given.joints:
            if joint.model in seen:
                receiver.message.fail("to", f".{joint.signal} sets {joint.model}, which {seen[joint.model].signal} "
                                      "sets already; keep one of them", joint.where)
            seen[joint.model] = joint
    by_message: dict[Key, set[str]] = {}
    for sender in joined.senders:
        names = by_message.setdefault(sender.message.key, set())
        for joint in sender.given.joints:
            if joint.signal in names:
                sender.message.fail("name", f"gets {joint.signal} twice; keep one of them", joint.where)
            names.add(joint.signal)
    check_pages(joined)


def check_pages(joined: Joined) -> None:
    """BadInput where two parts send the same message, and not different pages of it: each would undo the other."""
    seen: dict[Key, list[Sender]] = {}
    for sender in joined.senders:
        for other in seen.setdefault(sender.message.key, []):
            if set(sender.pages) & set(other.pages):
                sender.message.fail("message", f"is sent twice in this map, here and in {other.sent.where}; put all of "
                                    "its signals under one [[send]]")
        seen[sender.message.key].append(sender)


def check_drives(joined: Joined) -> None:
    """BadInput for what belongs to drives in a map without them, and for voltages in one that has them."""
    for receiver in joined.receivers.values():
        for joint in receiver.given.joints:
            stem = split(joint.model)[0]
            if stem == "voltage_V" and joined.has_drives:
                receiver.message.fail("to", f".{joint.signal} sets {joint.model}, and other signals are targets of "
                                      "drives, which replace the motors; keep one kind", joint.where)
            if stem == ENABLE and not joined.has_drives:
                receiver.message.fail("to", f".{joint.signal} enables drives, and no signal is a target of one; "
                                      f"join one to {TARGETS[0]}[1]", joint.where)
    for sender in joined.senders:
        for joint in sender.given.joints:
            if split(joint.model)[0] in DRIVE_OUTPUTS and not joined.has_drives:
                sender.message.fail("from", f".{joint.signal} is {joint.model} of a drive, and no signal is a target "
                                    "of one; take wheel_angle_rad with gear and counts_per_turn, or "
                                    "wheel_speed_rad_per_s", joint.where)


def check_places(joined: Joined) -> None:
    """BadInput for where a world force acts in a map that sets no such force."""
    if any(split(name)[0] == "world_force_N" for name in joined.inputs):
        return
    for receiver in joined.receivers.values():
        for joint in receiver.given.joints:
            if split(joint.model)[0] == "world_force_point_m":
                receiver.message.fail("to", f".{joint.signal} sets {joint.model}, where a world force acts, and no "
                                      "signal sets one; join one to world_force_N[1], too", joint.where)


ENCODER = "encoder_count"
OR_OF_DRIVE = "; that of the motor's drive is drive_count"


def check_map(scene: Scene, joined: Joined) -> None:
    """BadInput for what the scene cannot do: a voltage without a motor, a sensor that it lacks, periods below
    its step."""
    for receiver in joined.receivers.values():
        for joint in receiver.given.joints:
            stem, index = split(joint.model)
            wheel = scene.vehicle["wheel"][index] if stem == "voltage_V" else None
            common = 1.0 if "motor" in scene.vehicle else scene.vehicle["motor_gain_Nm_per_V"]
            if wheel is not None and (not wheel["driven"] or wheel.get("motor_gain_Nm_per_V", common) == 0.0):
                receiver.message.fail("to", f".{joint.signal} sets {joint.model}, and that wheel has no motor in "
                                      f"{scene.path}; give axle_torque_Nm[{index + 1}] or a target of a drive",
                                      joint.where)
    missing = missing_sensors(scene.sensors, scene.wheel_count)
    for sender in joined.senders:
        for joint in sender.given.joints:
            if joint.model in missing:
                sender.message.fail("from", f".{joint.signal}: {joint.model} {missing[joint.model]}"
                                    f"{OR_OF_DRIVE * joined.has_drives * joint.model.startswith(ENCODER)}", joint.where)
        period_s = sender.sent.period_s
        if period_s is not None and period_s < scene.run.step_s * (1.0 - 1e-9):
            sender.message.fail("period_s", f"is sent every {period_s:g} s, the vehicle steps every "
                                f"{scene.run.step_s:g} s; give at least that, or a shorter --step")
