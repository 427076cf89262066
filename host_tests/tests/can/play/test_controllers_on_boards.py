"""Controllers that others wrote, unchanged, in front of drives on other boards than this process: the same bits as the
core's, and faults by order that they notice."""

from __future__ import annotations

import re
import threading
from types import SimpleNamespace
from typing import Any

import can
import numpy as np
import pytest
from canopen.nmt import NmtError

from controllers import CONTROLLERS, by_canopen, run
from controllers.bench import Bench, bench
from controllers.truth import Truth
from laconic.can.play.vehicle import played
from laconic.can.rig.boards import why_no_emulation
from laconic.can.rig.wire import ID_BASE, wire
from laconic.scene import read_scene

emulated = pytest.mark.skipif(why_no_emulation() is not None, reason="no emulated boards")
STEP_S = 0.005
PATIENCE_S = 10.0


@pytest.mark.parametrize("cycles", [80, pytest.param(200, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("protocol", CONTROLLERS)
def test_controllers_drive_a_process_and_its_wheels_move_as_the_core_with_its_torques(
        protocol: str, cycles: int) -> None:
    if protocol == "odrive":
        pytest.importorskip("odrive_can", reason="odrive-can needs Python 3.11")
    verdict = run(protocol, "process", cycles, STEP_S)
    passed = re.match(r"passed: (\d+) cycles", verdict)  # a busy machine takes more to see all steps
    assert passed and int(passed[1]) >= cycles, verdict


class Told:
    """Rows of raw numbers, as a node with drives tells them, for a Truth."""

    def __init__(self) -> None:
        link = SimpleNamespace(id_base=ID_BASE, listeners=[])
        scene = played(read_scene("turtlebot3_burger"))
        self.truth, self._plant = Truth(scene, link), scene.plant(scene.core())  # type: ignore[arg-type]
        self._held = self._plant.core.ffi.new("laconic_input *")

    def row(self, torque_Nm: float, *, flip: int | None = None, lose: int | None = None) -> None:
        """One step; the lowest bit of a number may be wrong, a frame may be missing."""
        self._held.axle_torque_Nm[0] = torque_Nm
        self._plant.run(self._held)
        numbers = np.concatenate([self._plant.wheel_speeds(), self._plant.wheel_angles(), [torque_Nm, 0.0]])
        if flip is not None:
            numbers.view(np.uint64)[flip] ^= 1
        data = numbers.tobytes()
        for part, at in enumerate(range(0, len(data), 6)):
            if part != lose:
                self.truth.hear(can.Message(arbitration_id=ID_BASE + wire()["RAW_OUTPUT"].offset, is_extended_id=False,
                                            data=bytes([0, part << 4]) + data[at:at + 6].ljust(6, b"\0")))


def test_one_wrong_bit_in_a_wheels_motion_or_a_torque_is_found() -> None:
    for wrong, complaint in ((None, None), (1, "speeds after step 2"), (2, "angles after step 2"),
                             (4, "speeds after step 2")):
        told = Told()
        told.row(0.1)
        told.row(0.2, flip=wrong)
        told.row(0.3)
        found = told.truth.complaint(3)
        assert (found is None) == (complaint is None) and (complaint or "") in (found or "")


@pytest.mark.parametrize("lose", [0, 3, 7])
def test_a_missing_frame_or_step_is_no_equal_run(lose: int) -> None:
    told = Told()
    told.row(0.1)
    told.row(0.2, lose=lose)
    told.row(0.3)
    assert "were not seen" in str(told.truth.complaint(3))
    whole = Told()
    whole.row(0.1)
    assert "1 of the node's 2 steps were not seen" in str(whole.truth.complaint(2))


class Faults:
    """EMCYs of a node, from the beginning on."""

    def __init__(self, node: Any):
        self._came, self._codes = threading.Condition(), list[int]()
        node.emcy.add_callback(self._take)

    def _take(self, emcy: Any) -> None:
        with self._came:
            self._codes.append(emcy.code)
            self._came.notify()

    def has(self, code: int) -> bool:
        """Whether it comes in time."""
        with self._came:
            return self._came.wait_for(lambda: code in self._codes, PATIENCE_S)


def sign_of_life(node: Any, wait_s: float) -> bool:
    """Whether a heartbeat comes."""
    try:
        node.nmt.wait_for_heartbeat(wait_s)
    except NmtError:
        return False
    return True


def check_faults(it: Bench, nodes: list[Any]) -> None:
    """Over-temperature, lost encoder, stall, and a heartbeat that ceases, one drive each."""
    hot, lost, held = nodes
    faults = [Faults(node) for node in nodes]
    for node in nodes:
        by_canopen.enable(node, mode=3)
        node.sdo["Producer heartbeat time"].raw = 50
        node.sdo["Target velocity"].raw = 20_000
    for wheel, kind, code in ((1, "temperature", 0x4310), (2, "encoder", 0x7305), (3, "stall", 0x7121)):
        it.break_drive(kind, wheel)
        assert faults[wheel - 1].has(code), kind
    assert [node.sdo["Statusword"].raw & 0x4F for node in (hot, lost, held)] == [0x08] * 3  # FAULT
    assert sign_of_life(lost, PATIENCE_S)
    it.break_drive("silent", 2)
    while sign_of_life(lost, 1.0):
        pass
    assert lost.sdo["Statusword"].raw & 0x4F == 0x08  # it still answers
    it.break_drive("temperature", 1, is_broken=False)
    it.break_drive("silent", 2, is_broken=False)
    assert sign_of_life(lost, PATIENCE_S)
    hot.sdo["Controlword"].raw = 0x80
    assert hot.sdo["Statusword"].raw & 0x4F == 0x40 and faults[0].has(0)


@pytest.mark.parametrize("board", [pytest.param("an386", marks=[emulated, pytest.mark.nightly]), "virtual"])
def test_faults_by_order_of_a_boards_drives_reach_an_unchanged_canopen_client(board: str) -> None:
    with bench(by_canopen.SCENE, "canopen", board, STEP_S, stall_time_s=0.1, current_limit_A=1.0) as it, \
            by_canopen.network_of(it) as (_, nodes):
        check_faults(it, nodes)
