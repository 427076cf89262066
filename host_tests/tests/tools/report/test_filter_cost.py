"""The Kalman filter on an emulated Cortex-M4F: its bits are this machine's, and what a cycle costs is printed."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.report import filter_cost
from laconic.tools.report.workshop import M4F, Workshop

pytestmark = pytest.mark.nightly

MOST = {"predict": 27_000, "encoders": 7_000, "yaw_rate": 3_500}  # instructions, of three wheels, explicit
MOST_STACK, MOST_FLASH, MOST_RAM = 3_000, 30_000, 2_048           # bytes, of one method
MOST_WHOLE = 115_000                                              # of all methods


@pytest.mark.skipif(not M4F.present, reason="no cross compiler or no qemu-system-arm")
def test_the_filter_has_this_machine_s_bits_on_a_cortex_m4f_and_its_cost_is_printed(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = read_scene("robotino2").with_run(method=EXPLICIT, step_s=filter_cost.STEP_S)
    cost = filter_cost.cost_of(Workshop(tmp_path), scene)
    with capsys.disabled():
        parts = ", ".join(f"{filter_cost.PARTS[part]} {count:.0f}" for part, count in cost.instructions.items())
        print(f"\n  Kalman filter on a Cortex-M4F, instructions: {parts}; stack {cost.stack_bytes} B, flash "
              f"{cost.flash_bytes} B (all methods: {cost.whole_flash_bytes} B), RAM {cost.filter_bytes} B")
    assert cost.same_bits
    assert all(1_000 < count < MOST[part] for part, count in cost.instructions.items())
    assert cost.stack_bytes < MOST_STACK and cost.flash_bytes < MOST_FLASH and cost.filter_bytes < MOST_RAM
    assert 3 * cost.flash_bytes < cost.whole_flash_bytes < MOST_WHOLE


def test_another_reading_gives_other_bits(tmp_path: Path) -> None:
    scene = read_scene("robotino2").with_run(method=EXPLICIT, step_s=filter_cost.STEP_S)
    recording = filter_cost.recorded(scene, "single")
    before = recording.estimate(scene)
    recording.turned_rad[50, 1] += 1e-4
    assert recording.estimate(scene) != before
