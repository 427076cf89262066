"""The live view on a terminal of 80 columns and 24 lines."""

from __future__ import annotations

import io

import can
import pytest
from rich.console import Console

from laconic.can.rig.boards import own_node
from laconic.can.rig.free_judge import judge_free_run
from laconic.can.rig.live import View
from laconic.can.rig.wire import wire
from laconic.scene import read_scene


def drawn(view: View) -> list[str]:
    """Its lines on a small terminal."""
    out = io.StringIO()
    console = Console(file=out, width=80, height=24, force_terminal=True, color_system=None)
    console.print(view)
    return out.getvalue().rstrip("\n").split("\n")


def row(lines: list[str], name: str) -> str:
    """The first line of a frame."""
    return next(line for line in lines if name in line)


@pytest.fixture
def view() -> View:
    """A view of a free run of a vehicle with four wheels, in virtual time."""
    with own_node("virtual", "double") as node:
        seen = View(node.link, "kuka_youbot", 300)
        node.link.listeners.append(seen.take)
        judge_free_run(node, read_scene("kuka_youbot"), 0.3, 1000, 100, {}, moved=seen.moved)
    return seen


def test_a_free_run_is_shown_with_counts_and_names_within_80_by_24(view: View) -> None:
    lines = drawn(view)
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert "state free run" in row(lines, "HEARTBEAT") and "command stop" in row(lines, "RESULT")
    assert int(row(lines, "NU ").split("│")[2]) in range(290, 301)
    assert "crc_errors 0" in "\n".join(lines) and "late_periods 0" in "\n".join(lines)


def test_each_group_of_wheels_has_a_line_with_the_wheels_numbers(view: View) -> None:
    lines = [line for line in drawn(view) if "VOLTAGE" in line]
    assert len(lines) == 2 and "voltage_1" in lines[0] and "voltage_4" in lines[1]


def test_more_kinds_of_frames_than_lines_leave_out_the_oldest_and_show_how_many(view: View) -> None:
    for k in range(40):
        view.take(can.Message(arbitration_id=0x700 + k, is_extended_id=False, data=b"\1"))
    for frame in (wire()["NU"], wire()["HEARTBEAT"]):
        view.take(can.Message(arbitration_id=view.link.id_base + frame.offset, is_extended_id=False, data=bytes(8)))
    lines = drawn(view)
    assert len(lines) <= 24 and "more kinds of frames" in lines[-1]
    assert row(lines, "NU ") and "state empty" in row(lines, "HEARTBEAT")
