"""Whose fault it is when a free run goes wrong: the node's, the line's or the rig's own. All in virtual time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import can
import pytest

from laconic.can.rig.boards import own_node
from laconic.can.rig.client import NodeClient
from laconic.can.rig.faulty import FaultyBus
from laconic.can.rig.free_judge import judge_free_run
from laconic.can.rig.punctuality import timeout_us
from laconic.can.rig.verdict import Judgement
from laconic.can.rig.wire import wire
from laconic.scene import read_scene

SCENE = read_scene("s1").with_run(step_s=0.001)
DISTURBED_AT = 20  # calls of `moved`: 0.2 s


def disturbed(disturb: Callable[[NodeClient], None], seconds: float = 60.0, watchdog_ms: int = 100) -> Judgement:
    """A free run that is disturbed once."""
    calls = 0
    with own_node("virtual", "double") as node:

        def moved(_: float) -> None:
            nonlocal calls
            calls += 1
            if calls == DISTURBED_AT:
                disturb(node)

        return judge_free_run(node, SCENE, seconds, 1000, watchdog_ms, {}, moved=moved)


def stall(node: NodeClient) -> None:
    """The PC does something else for 0.3 s, while the node goes on."""
    end = node.link.clock.time_us + 300_000
    while node.link.clock.time_us < end:
        node.link.pump()


def verdicts(judgement: Judgement) -> dict[str, Any]:
    """By name."""
    return {each.name: each for each in judgement.verdicts}


def test_a_stalled_pc_that_trips_the_watchdog_is_named_and_not_the_node() -> None:
    judgement = disturbed(stall)
    found = verdicts(judgement)
    assert "watchdog" in found["run"].detail and "this PC has stalled, not the node" in found["run"].detail
    assert not found["rig"].passed and "PC has stalled" in found["rig"].detail
    assert found["timeouts"].passed and found["NU.nu_1"].passed
    assert judgement.figures["rig_longest_pause_us"] >= 300_000


def late_run(node: NodeClient, seconds: float, stalls_us: int) -> Judgement:
    """A free run whose node is not served for so long, once."""
    calls = 0

    def moved(_: float) -> None:
        nonlocal calls
        calls += 1
        if calls == DISTURBED_AT:
            node.link.clock.time_us += stalls_us

    return judge_free_run(node, SCENE, seconds, 1000, 0, {}, moved=moved)


def test_late_periods_are_those_of_this_run_and_not_of_earlier_ones() -> None:
    with own_node("virtual", "double") as node:
        assert late_run(node, 0.6, 30_000).figures["late_periods"] > 10
        assert late_run(node, 0.6, 0).figures["late_periods"] == 0
        assert 0 < late_run(node, 0.6, 5_000).figures["late_periods"] < 10


def test_a_stalled_pc_without_watchdog_fails_the_verdict_about_the_rig_alone() -> None:
    judgement = disturbed(stall, seconds=1.0, watchdog_ms=0)
    assert [each.name for each in judgement.verdicts if not each.passed] == ["rig"]
    assert judgement.figures["rig_left_out_cycles"] >= 29


def test_a_node_that_no_longer_follows_after_lost_voltages_is_noticed_even_without_watchdog() -> None:
    def lose_ten(node: NodeClient) -> None:
        send, voltage, lost = node.link.bus.send, node.link.id_base + wire()["VOLTAGE"].offset, []

        def lossy(message: can.Message, timeout: float | None = None) -> None:
            if message.arbitration_id == voltage and len(lost) < 10:
                lost.append(message)
            else:
                send(message)

        node.link.bus.send = lossy

    judgement = disturbed(lose_ten, watchdog_ms=0)
    found = verdicts(judgement)
    assert "refuses the rig's voltages" in found["run"].detail and found["rig"].passed and found["NU.nu_1"].passed
    assert judgement.figures["last_step"] < 600


def test_voltages_that_are_lost_on_the_way_are_not_the_rigs_lateness() -> None:
    def cut(node: NodeClient) -> None:
        send, voltage = node.link.bus.send, node.link.id_base + wire()["VOLTAGE"].offset
        node.link.bus.send = lambda message, timeout=None: (
            None if message.arbitration_id == voltage else send(message, timeout))

    judgement = disturbed(cut)
    found = verdicts(judgement)
    assert "they did not arrive" in found["run"].detail and found["rig"].passed
    assert judgement.figures["last_step"] < 600


def test_a_node_that_falls_silent_ends_the_run_within_the_timeout_of_its_heartbeat() -> None:
    def die(node: NodeClient) -> None:
        clock = node.link.clock

        def nothing() -> bool:
            clock.time_us += 1000
            return False

        node.link.pump = nothing

    judgement = disturbed(die)
    found = verdicts(judgement)
    assert "no NU, " in found["run"].detail and "HEARTBEAT" in found["run"].detail
    assert 189 <= judgement.figures["last_step"] <= 200 and judgement.figures["seconds"] < 0.55
    assert not found["timeouts"].passed and found["rig"].passed and found["NU.nu_1"].passed
    assert judgement.exit_status == 1


@pytest.mark.parametrize("name, period_s, expected_us", [
    ("NU", 0.001, 50_000), ("NU", 0.01, 50_000), ("POSE", 0.1, 500_000), ("HEARTBEAT", 1.0, 300_000)])
def test_timeouts_are_the_contracts_own_and_grow_with_a_period_beyond_its_cycle(name: str, period_s: float,
                                                                               expected_us: int) -> None:
    assert timeout_us(name, period_s) == expected_us


def test_a_frame_of_each_kind_that_stays_away_fails_the_verdict_about_timeouts() -> None:
    def drop_one_kind(node: NodeClient) -> None:
        take, pose = node.link.take, node.link.id_base + wire()["POSE"].offset
        until = node.link.clock.time_us + 80_000

        def filtered(message: can.Message) -> Any:
            gone = message.arbitration_id == pose and node.link.clock.time_us < until
            return None if gone else take(message)

        node.link.take = filtered

    found = verdicts(disturbed(drop_one_kind, seconds=0.5))
    assert not found["timeouts"].passed and "POSE missing for 8" in found["timeouts"].detail and "run" not in found


@pytest.mark.parametrize("corruption", [
    pytest.param("0.03", marks=pytest.mark.nightly), "0.2"])  # 0.2: more in a row than the profile bridges
def test_spoilt_answers_fail_the_verdict_about_frames_and_not_the_one_about_the_clock(corruption: str) -> None:
    with own_node("virtual", "double") as node:
        clock = node.link.clock
        node.link.bus = FaultyBus(inner=node.link.bus, clock=lambda: clock.now_us() / 1e6, corruption=corruption,
                                  direction="in", only_id=str(node.link.id_base + wire()["NU"].offset), seed="1")
        found = verdicts(judge_free_run(node, SCENE, 1.0, 1000, 100, {}))
    assert not found["frames"].passed and "× error" in found["frames"].detail
    assert [name for name, each in found.items() if not each.passed] == ["frames"]
    assert abs(found["clock"].worst) < 0.002


def test_a_free_run_without_fault_reports_that_all_frames_were_right() -> None:
    with own_node("virtual", "double") as node:
        found = verdicts(judge_free_run(node, SCENE, 0.2, 1000, 100, {}))
    assert all(each.passed for each in found.values()) and found["frames"].detail.endswith("all right")
