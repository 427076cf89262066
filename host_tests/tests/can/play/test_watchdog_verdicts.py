"""The verdict on watchdogs: of a controller that once spoke, for as long as the run lasts, and for good."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import can
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.can.play.node_in_process import InProcess
from laconic.can.play.node_vehicle import NodeVehicle
from laconic.can.play.settings import drive_settings
from laconic.can.rig.buses import VirtualClock, node_in_process
from laconic.can.rig.verdict import Judgement
from laconic.scene import read_scene
from play_support import currents, played

WATCHDOG_S = 0.05


@pytest.fixture
def watched(tmp_path: Path) -> Path:
    """robomaster_mecanum with a watchdog shorter than the period of HEARTBEAT, by which play reads the figures."""
    path = tmp_path / "scene.toml"
    text = (SOURCE_DIR / "scenes" / "robomaster_mecanum.toml").read_text(encoding="utf-8")
    path.write_text(f"{text}watchdog_s = {WATCHDOG_S}\n", encoding="utf-8")
    return path


def commands_in(*spans: tuple[float, float]) -> Callable[[float], list[can.Message]]:
    """A command every 10 ms in these spans of time."""
    def commands(time_s: float) -> list[can.Message]:
        return [currents(0.5)] if any(begin <= time_s < end for begin, end in spans) else []
    return commands


def fired(judgement: Judgement) -> bool:
    """Whether a watchdog has, by the verdict."""
    verdict, = [each for each in judgement.verdicts if each.name == "watchdog"]
    return not verdict.passed


@pytest.mark.parametrize("spans, has_fired", [
    ((), False),                           # nobody ever came
    (((0.3, 9.0),), False),                # a controller that came late
    (((0.0, 9.0),), False),                # ... or that never paused, until play itself ended
    (((0.0, 0.2), (0.3, 9.0)), True)])     # silence, and a command that switches on again
def test_a_watchdog_watches_from_the_first_command_to_the_end_of_the_run(
        spans: tuple[tuple[float, float], ...], has_fired: bool, watched: Path) -> None:
    judgement, _ = played(watched, 0.6, commands_in(*spans), drives="robomaster")
    assert fired(judgement) == has_fired, judgement.verdicts


def test_a_node_tells_at_the_end_of_a_watchdog_that_fired_long_ago_and_plays_no_longer_while_it_tells(
        watched: Path) -> None:
    """As a node in another process does, whose drives cannot be looked at: HEARTBEAT alone tells."""
    for pause_s, has_fired in ((0.03, False), (0.07, True)):
        scene, clock = read_scene(watched), VirtualClock()
        with node_in_process("double", clock=clock) as (client, end):
            vehicle = InProcess(client, end, scene, drive_settings(scene, "robomaster"))
            vehicle._note_unheard = NodeVehicle._note_unheard.__get__(vehicle)  # type: ignore[method-assign]
            vehicle._look_at_drives = lambda: None  # type: ignore[method-assign]
            vehicle.start()
            for wait_s in (0.01, pause_s, 0.01):
                vehicle.on_message(currents(0.5), clock.now_us())
                for _ in range(round(wait_s / scene.run.step_s)):
                    clock.time_us += round(1e6 * scene.run.step_s)
                    list(vehicle.advance(clock.now_us()))
            vehicle.on_message(currents(0.5), clock.now_us())
            vehicle.finish()
            assert vehicle.lateness.periods > 0
        assert bool(vehicle.watchdogs()) == has_fired, pause_s
