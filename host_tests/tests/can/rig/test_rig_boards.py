"""Emulated Cortex-M boards: the same bits as the host's core, in lockstep, fast enough."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from typing import Any

import pytest

from assurance.boards import busy_cores, start
from laconic.can.rig.boards import emulated_node, why_no_emulation
from laconic.can.rig.choices import BOARDS
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.judge import judge_scaled
from laconic.can.rig.lockstep import load_scene, run_lockstep, twin_states
from laconic.can.rig.wire import wire
from laconic.errors import BadInput, Refused
from laconic.scene import Scene, read_scene, rigid_scene_names
from laconic.scene.ground import has_friction
from laconic.scene.methods import EXACT, EXPLICIT
from laconic.tools.trim import needs_of
from node_sizes import cost_of

pytestmark = pytest.mark.skipif(why_no_emulation() is not None, reason=why_no_emulation() or "")
FULL = [name for name in BOARDS if "-" not in name]
WITH_ONE_PROTOCOL = ("an386-drives", "an386-odrive", "an386-canopen", "an386-moteus")
STEPS = {"an385": 4000, "microbit": 2000}  # without floating-point hardware; the others take 10,000
STEPS_PER_SYNC = 500
# by day: axle torques, unlike wheels, voltages, a force in the world, friction
SOME = ["canopen_agv", "example_two_wheel_sizes", "kuka_youbot", "paper_caster", "skid_steer"]
SELDOM = ("an385", "an500", "an500-hinges", "an386-xcp", "an386-odrive", "an386-canopen",
          "an386-moteus")  # whose images the ordinary build leaves out
MASS = wire().number("PARAMETER", "field", "MASS")
# what a whole load of nothing but masses is refused for; a board in double misses the upper halves first
UNFIT = dict.fromkeys(FULL, "parameter missing") | {"an500": "input incomplete"}


def each(names: Iterable[str], by_day: Iterable[str] = frozenset(BOARDS) - frozenset(SELDOM)) -> list[Any]:
    return [name if name in by_day else pytest.param(name, marks=pytest.mark.nightly) for name in names]


def fits_small_image(scene: Scene) -> bool:
    """At most four wheels, all alike, on level ideal ground; one support; voltages only."""
    if scene.wheel_count > 4 or len(scene.vehicle["support"]) > 1 or has_friction(scene.vehicle):
        return False
    needs = needs_of(scene)
    return not (needs.own_wheels or needs.slope or needs.axle_torque or needs.body_wrench or needs.world_force)


def rk4_can(scene: Scene) -> bool:
    """Not too stiff for the one method."""
    try:
        scene.plant(scene.core())
    except Refused:
        return False
    return True


@pytest.mark.parametrize("share, names", [
    (25, SOME), pytest.param(1, rigid_scene_names(), marks=pytest.mark.nightly)],
    ids=["one step in 25 of five scenes", "all steps of all scenes"])
@pytest.mark.parametrize("name", each(FULL))
def test_scenes_give_the_bits_of_the_host_core_on_an_emulated_board(
        name: str, share: int, names: list[str]) -> None:
    with emulated_node(name) as node:
        for scene_name in names:
            scene = read_scene(scene_name).with_run(real=BOARDS[name].real)
            if name == "microbit" and has_friction(scene.vehicle):  # left out of that image
                continue
            steps = STEPS.get(name, 10_000) if scene.inputs_on_grid().is_held else 300  # sampled: a SYNC for each step
            run = run_lockstep(node, scene, steps // share, every=STEPS_PER_SYNC // share)
            assert run.states.tobytes() == twin_states(scene, run).tobytes(), scene_name
            node.stop()


@pytest.mark.parametrize("busy", [0, pytest.param(2, marks=pytest.mark.nightly)], ids=["idle", "busy"])
@pytest.mark.parametrize("name", each(BOARDS, by_day=("an386", "microbit")))
def test_a_board_that_has_just_been_started_loads_a_vehicle_at_once(name: str, busy: int) -> None:
    with busy_cores(busy):
        assert start(name, "kuka_youbot") is None


@pytest.mark.parametrize("name", each(FULL, by_day=("an386", "microbit")))
def test_bytes_that_come_faster_than_the_processor_reads_are_not_overwritten(name: str) -> None:
    """A long SYNC keeps it busy while twelve times its ring arrives at once; the checksum counts what it has read."""
    with emulated_node(name) as node:
        load_scene(node, read_scene("s1").with_run(real=BOARDS[name].real, method=EXPLICIT))
        node.start_lockstep()
        lines, link = [], node.link
        link.send_message = lambda m: lines.append(f"t{m.arbitration_id:03X}8{bytes(m.data).hex()}\r")
        link.send(wire()["SYNC"], wire()["SYNC"].pack(step_count=640))
        checksum = 0
        for command in ("STOP", "BEGIN"):
            link.send(wire()["CONTROL"], wire()["CONTROL"].pack(command=wire().number("CONTROL", "command", command)))
        for value in range(140):
            data = wire()["PARAMETER"].pack(field=MASS, value=value)
            checksum = zlib.crc32(bytes([data[1] & 0xF0]) + bytes(data[2:]), checksum)
            link.send(wire()["PARAMETER"], data)
        count = link.send(wire()["COMMIT"], wire()["COMMIT"].pack(frame_count=140, checksum=checksum)) & 15
        link.bus.serialPortOrig.write("".join(lines).encode())
        command = wire().number("RESULT", "command", "COMMIT")
        while (received := link.receive(5.0)) is not None:
            values = received[0].unpack(received[1])
            if received[0].name == "RESULT" and (values["command"], values["request"]) == (command, count):
                break
        assert received is not None and wire().choice("RESULT", "status", values["status"]) == UNFIT[name]


def test_the_small_image_gives_the_bits_of_the_host_core_with_its_one_method() -> None:
    with emulated_node("an386-small") as node:
        scenes = [read_scene(n).with_run(real="single", method=EXPLICIT) for n in rigid_scene_names()]
        scenes = [scene for scene in scenes if fits_small_image(scene) and rk4_can(scene)]
        assert len(scenes) >= 3
        for scene in scenes:
            run = run_lockstep(node, scene, 500, every=250)
            assert run.states.tobytes() == twin_states(scene, run).tobytes(), scene.name


@pytest.mark.nightly
def test_one_command_and_one_answer_a_step_run_at_150_steps_a_second_or_more() -> None:
    scene = read_scene("turtlebot3_burger").with_run(real="single")
    scene = Scene(**{**vars(scene), "rig": type(scene.rig)(frames=("NU",))})
    with emulated_node("an386") as node:
        judgement = judge_scaled(node, scene, 300, {})
    assert judgement.passed, judgement.verdicts
    assert judgement.figures["frames_out_per_exchange"] < 1.1 and judgement.figures["frames_in_per_exchange"] < 1.1
    assert judgement.figures["steps_per_s"] >= 150


def test_a_board_without_the_scenes_method_names_the_remedy() -> None:
    scene = read_scene("kuka_youbot").with_run(real="single", method=EXACT)
    remedy = f"has {EXPLICIT}; give --method {EXPLICIT}"
    with emulated_node("an386-small") as node, pytest.raises(BadInput, match=remedy):
        run_lockstep(node, scene, 10)


@pytest.mark.nightly
def test_flash_ram_stack_and_instructions_are_printed_and_the_small_image_is_small(
        capsys: pytest.CaptureFixture[str]) -> None:
    costs = [cost_of(name) for name in BOARDS]
    with capsys.disabled():
        print(f"\n  {'board':12s} {'flash':>6s} {'RAM':>6s} {'stack':>6s}  instructions")
        for cost in costs:
            counted = "  ".join(f"{name} {number}" for name, number in cost.instructions.items())
            print(f"  {cost.board:12s} {cost.flash:6d} {cost.static_ram:6d} {cost.stack:6d}  {counted}")
    of = {cost.board: cost for cost in costs}
    assert of["an386-small"].flash < 16 * 1024 and of["an386-small"].static_ram + of["an386-small"].stack < 4 * 1024
    for name in WITH_ONE_PROTOCOL:
        assert of[name].flash < 25 * 1024 and of[name].static_ram + of[name].stack < 6 * 1024, name
    assert all(of[name].instructions["on_tick_with_step"] > 300 for name in FULL)
    assert of["an386"].instructions["on_tick_with_step"] < 850  # without sensors nobody looks for them


@pytest.mark.parametrize("name", each(name for name, board in BOARDS.items() if board.plays_only))
def test_an_image_that_only_plays_drives_says_that_it_has_no_lockstep(name: str) -> None:
    with emulated_node(name) as node, pytest.raises(NodeRefused, match="not supported"):
        run_lockstep(node, read_scene("kuka_youbot").with_run(real="single", method=EXPLICIT), 10)
