"""PyPI's canopen as the controller: BaseNode402, configured by SDO, driven by SYNC and PDOs."""

from __future__ import annotations

import logging
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import canopen
from canopen.profiles.p402 import BaseNode402

from controllers.bench import Bench
from controllers.cycles import Cycles
from laconic.can.play.canopen_eds import eds_of_scene
from laconic.errors import ResultFails

NODE: Any = BaseNode402
SCENE = "robotino2"
CYCLIC_SYNCHRONOUS_VELOCITY = 9
MOST_COUNTS_PER_S = 20_000
NEAR_COUNTS_PER_S = 600
SILENCE_S = 5.0
ATTEMPTS = 3


class Answers:
    """Counts the answers of all nodes to a SYNC."""

    def __init__(self, nodes: list[Any]):
        self._changed, self._seen, self._nodes = threading.Condition(), set[int](), nodes
        for node in nodes:
            node.tpdo[2].add_callback(lambda _, node_id=node.id: self._take(node_id))

    def _take(self, node_id: int) -> None:
        with self._changed:
            self._seen.add(node_id)
            self._changed.notify()

    def wait(self) -> bool:
        """Whether all have answered in time; the next wait is for new answers."""
        with self._changed:
            came = self._changed.wait_for(lambda: len(self._seen) == len(self._nodes), SILENCE_S)
            self._seen.clear()
        return came


@contextmanager
def network_of(bench: Bench) -> Iterator[tuple[canopen.Network, list[Any]]]:
    """A network of the client with its nodes."""
    with tempfile.TemporaryDirectory() as folder:
        eds = Path(folder, "drive.eds")
        eds.write_text(eds_of_scene(bench.scene, "canopen"), encoding="ascii")
        logging.getLogger("canopen").setLevel(logging.ERROR)  # it would prefer the mode in a PDO
        network = canopen.Network(bus=bench.bus())
        network.connect()
        nodes: list[Any] = []
        try:
            for node_id in bench.settings.node_ids:
                nodes.append(network.add_node(NODE(node_id, str(eds))))
                nodes[-1].sdo.RESPONSE_TIMEOUT = SILENCE_S  # of a machine that is busy
            yield network, nodes
        finally:
            network.disconnect()


def enable(node: Any, mode: int = CYCLIC_SYNCHRONOUS_VELOCITY) -> None:
    """As an application brings a node into operation."""
    node.nmt.state = "PRE-OPERATIONAL"
    node.setup_402_state_machine()
    node.sdo["Modes of operation"].raw = mode
    node.rpdo[2].trans_type = 1  # target velocity, at the next SYNC
    node.rpdo[2].save()
    node.nmt.state = "OPERATIONAL"
    for attempt in range(ATTEMPTS):
        try:
            node.state = "OPERATION ENABLED"
            return
        except RuntimeError:  # the client waits less than a second
            if attempt == ATTEMPTS - 1:
                raise


def speed_of(node: Any) -> int:
    """By the last PDO."""
    return int(node.tpdo[2]["Velocity actual value"].raw)


def control(bench: Bench, cycles: Cycles) -> None:
    """Drives the vehicle; ResultFails where the drives do not follow."""
    with network_of(bench) as (network, nodes):
        for node in nodes:
            enable(node)
        answers = Answers(nodes)
        targets = [0] * len(nodes)

        def arrived() -> bool:
            return all(abs(speed_of(node) - target) <= NEAR_COUNTS_PER_S
                       for node, target in zip(nodes, targets, strict=True))

        while cycles.go_on(arrived):
            for number, node in enumerate(nodes):
                targets[number] = round(MOST_COUNTS_PER_S * cycles.share(number))
                node.rpdo[2]["Target velocity"].raw = targets[number]
                node.rpdo[2].transmit()
            network.sync.transmit()
            if not answers.wait():
                bench.check()
                raise ResultFails(f"no answer to SYNC for {SILENCE_S:g} s after {cycles.done} cycles")
            cycles.end()
            time.sleep(cycles.pause_s())
        if not arrived():
            raise ResultFails(f"the drives turn with {list(map(speed_of, nodes))} counts/s where {targets} were wanted")
