"""A log judged afterwards: the commands of the log drive the twin, the answers of the log are compared with it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import can
import numpy as np

from laconic.can.rig.buses import paired_buses
from laconic.can.rig.client import NodeClient
from laconic.can.rig.hinged import HINGED_FRAMES, HingedPlant, HingedTwin, NodeInputs, follow, signals_of_page
from laconic.can.rig.judge import link_verdict, signal_verdicts
from laconic.can.rig.link import Link
from laconic.can.rig.logs import was_closed
from laconic.can.rig.scaled import Comparison
from laconic.can.rig.session import Effect, Follower
from laconic.can.rig.verdict import Judgement, Verdict
from laconic.can.rig.wire import wire
from laconic.core.plant import Plant
from laconic.errors import BadInput
from laconic.robot.logs.formats.can_frames import LoggedFrame, read_frames
from laconic.scene import Scene

COMPARED = ("NU", "POSE", "WHEEL_SPEED", "STATE_FD", *HINGED_FRAMES)


class LogPlayer:
    """Follows a log frame by frame."""

    def __init__(self, scene: Scene, id_base: int, link: Link):
        self.scene, self.id_base, self.link = scene, id_base, link
        hinged = HingedTwin(scene) if scene.has_hinges else None
        self.plant: Plant | HingedPlant = hinged.plant if hinged else scene.plant(scene.core())
        self.inputs = NodeInputs(hinged) if hinged else None
        self.row = np.zeros(self.plant.core.input_length, self.plant.core.dtype)
        self.comparison = Comparison(scene.wheel_count)
        self.wrong_commands = 0
        self.running = False
        self.odd: Counter[str] = Counter()   # frames with the identifier of a message and another length or format
        self._follower = Follower(link.library)

    def take(self, message: can.Message) -> None:
        """One frame of the log."""
        frame = wire().by_offset.get(message.arbitration_id - self.id_base)
        if frame is None:
            return
        if len(message.data) != frame.length or message.is_fd != frame.fd:
            self.odd[frame.name] += 1
            return
        if not frame.from_rig:
            received = self.link.take(message)
            if received is not None and frame.name == "CHALLENGE":
                self._follower.challenge(message.data)
            if received is not None and self.running and frame.name in COMPARED:
                self.comparison.take(*received, self.plant)
            return
        effect = self._follower.effect_of(frame, bytearray(message.data))
        self.wrong_commands += effect is Effect.WRONG
        if effect is Effect.ACTS:
            self._command(frame.name, frame.unpack(message.data))

    def end(self) -> None:
        """Adds the frames of the rig that are missing by its counts to the link's faults: the twin lacks them, too."""
        for name, count in self._follower.missing.items():
            self.link.faults[f"{name} missing"] += count

    def _command(self, name: str, raw: dict[str, int]) -> None:
        if name == "CONTROL":
            command = wire().choice("CONTROL", "command", raw["command"])
            if command.startswith("start"):
                self.running = command == "start lockstep"
            elif command in ("stop", "reset"):
                self.running = False
        elif name == "VOLTAGE" and self.running:
            self._voltages(raw)
        elif name == "STEERING" and self.running and self.inputs:
            self.inputs.set_page(raw["page"], [raw[signal.name] for signal in signals_of_page(raw["page"])])
            if raw["sync"]:
                self._step(1)
        elif name == "SYNC" and self.running:
            self._step(raw["step_count"])

    def _step(self, steps: int) -> None:
        if isinstance(self.plant, HingedPlant):
            assert self.inputs is not None
            rows = self.inputs.stepped()
            follow(self.plant, rows)
            self.plant.run(rows[1], steps - 1)
        else:
            self.plant.run(self.plant.core.input(self.row), steps)

    def _voltages(self, raw: dict[str, int]) -> None:
        start, dtype = self.plant.core.input_fields["voltage_V"][0], self.plant.core.dtype.type
        per_unit = dtype(round(1 / wire()["VOLTAGE"].fields["voltage_1"].scale))
        for k in range(3):
            wheel = 3 * raw["group"] + k
            if wheel < self.scene.wheel_count:
                self.row[start + wheel] = dtype(raw[f"voltage_{k + 1}"]) / per_unit
        if self.inputs:
            self.inputs.set_base(self.row)
        if raw["sync"]:
            self._step(1)


def frames_of_node(path: Path, frames: Sequence[LoggedFrame], id_base: int, channel: str | None) -> list[LoggedFrame]:
    """The frames of a log that a node or its rig may have sent: data frames with 11 bits on one channel. BadInput where
    these come on several channels and none is given, or not on the one that is."""
    found = [frame for frame in frames if not (frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame)
             and frame.arbitration_id - id_base in wire().by_offset]
    channels = sorted({str(frame.channel) for frame in found})
    if channel is None and len(channels) > 1:
        raise BadInput(f"--replay {path}: frames at ID base 0x{id_base:X} come on the channels "
                       f"{', '.join(channels[:-1])} and {channels[-1]}; give --channel {channels[0]}, or another one")
    if channel is not None and channels and channel not in channels:
        raise BadInput(f"--channel {channel}: {path} has the node's frames on {' and '.join(channels)}; give it")
    return [frame for frame in found if channel in (None, str(frame.channel))]


def judge_log(path: Path, scene: Scene, id_base: int, tolerances: dict[str, float],
              channel: str | None = None) -> Judgement:
    """The verdicts of a recorded lockstep run with scaled frames; `channel`: of the bus in the log, None: the one."""
    recorded = read_frames(path)
    messages = frames_of_node(path, recorded.frames, id_base, channel)
    with paired_buses() as (nowhere, _):
        link = Link(nowhere, id_base)
        player = LogPlayer(scene, id_base, link)
        for message in messages:
            player.take(message)
        player.end()
        if not player.comparison.signals:
            raise BadInput(f"--replay {path}: holds no answer of a scaled lockstep run at ID base 0x{id_base:X}; "
                           "record one with --lockstep --log")
        judgement = Judgement(scene.name, f"replay of {path.name}")
        judgement.add(*signal_verdicts(player.comparison, tolerances), link_verdict(NodeClient(link)))
        judgement.add(Verdict("commands", player.wrong_commands == 0, f"{player.wrong_commands} with a wrong CRC"))
        if not was_closed(path):
            judgement.add(Verdict("log", False, "was never closed: frames may be missing at its end"))
        judgement.notes += [*recorded.remarks, *(f"{count} frames of {name} left out: of another length or format"
                                                 for name, count in player.odd.items())]
        judgement.figures |= {"frames": len(recorded.frames), "steps": player.plant.steps}
    return judgement
