"""A log judged afterwards: the commands of the log drive the twin, the answers of the log are compared with it."""

from __future__ import annotations

from pathlib import Path

import can
import numpy as np

from laconic.can.rig.buses import next_channel
from laconic.can.rig.client import NodeClient
from laconic.can.rig.judge import link_verdict, signal_verdicts
from laconic.can.rig.link import Link
from laconic.can.rig.logs import read_log, was_closed
from laconic.can.rig.scaled import Comparison
from laconic.can.rig.session import Effect, Follower
from laconic.can.rig.verdict import Judgement, Verdict
from laconic.can.rig.wire import wire
from laconic.core.plant import Plant
from laconic.errors import BadInput
from laconic.scene import Scene


class LogPlayer:
    """Follows a log frame by frame."""

    def __init__(self, scene: Scene, id_base: int, link: Link):
        self.scene, self.id_base, self.link = scene, id_base, link
        self.plant: Plant = scene.plant(scene.core())
        self.row = np.zeros(self.plant.core.input_length, self.plant.core.dtype)
        self.comparison = Comparison(scene.wheel_count)
        self.wrong_commands = 0
        self.running = False
        self._follower = Follower(link.library)

    def take(self, message: can.Message) -> None:
        """One frame of the log."""
        frame = wire().by_offset.get(message.arbitration_id - self.id_base)
        if frame is None or len(message.data) != frame.length:
            return
        if not frame.from_rig:
            received = self.link.take(message)
            if received is not None and frame.name == "CHALLENGE":
                self._follower.challenge(message.data)
            if received is not None and self.running and frame.name in ("NU", "POSE", "WHEEL_SPEED", "STATE_FD"):
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
        elif name == "SYNC" and self.running:
            self.plant.run(self.plant.core.input(self.row), raw["step_count"])

    def _voltages(self, raw: dict[str, int]) -> None:
        start, dtype = self.plant.core.input_fields["voltage_V"][0], self.plant.core.dtype.type
        per_unit = dtype(round(1 / wire()["VOLTAGE"].fields["voltage_1"].scale))
        for k in range(3):
            wheel = 3 * raw["group"] + k
            if wheel < self.scene.wheel_count:
                self.row[start + wheel] = dtype(raw[f"voltage_{k + 1}"]) / per_unit
        if raw["sync"]:
            self.plant.run(self.plant.core.input(self.row), 1)


def judge_log(path: Path, scene: Scene, id_base: int, tolerances: dict[str, float]) -> Judgement:
    """The verdicts of a recorded lockstep run with scaled frames."""
    messages = read_log(path)
    with can.Bus(interface="virtual", channel=next_channel()) as nowhere:
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
        judgement.figures |= {"frames": len(messages), "steps": player.plant.steps}
    return judgement
