"""The node steps vehicles with friction, limits of motors and slopes as the core does, and refuses what it lacks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from friction_scenes import SCENES, skid_steering, slipping
from laconic.can.rig.boards import emulated_node, why_no_emulation
from laconic.can.rig.buses import process_node, virtual_node
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.judge import judge_same_bits, judge_scaled
from laconic.can.rig.lockstep import RawStream, load_scene, run_lockstep, start_of, twin_states
from laconic.can.rig.parameters import parameters_of
from laconic.core import REALS
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.methods import EXPLICIT


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("made", SCENES, ids=lambda made: made.__name__)
def test_a_node_gives_the_bits_of_the_core_over_a_thousand_steps_with_friction(
        made: Callable[[Path], Scene], real: str, tmp_path: Path) -> None:
    scene = made(tmp_path).with_run(real=real)
    with virtual_node(real) as node:
        run = run_lockstep(node, scene, 1000, every=1 if not scene.inputs_on_grid().is_held else 10, fd=True)
    assert run.steps == 1000 and np.isfinite(run.states).all()
    assert np.abs(run.states[:, 6 : 6 + scene.wheel_count]).max() > 0.5  # wheel speeds are the plant's, not a row's
    assert run.states.tobytes() == twin_states(scene, run).tobytes()


def test_the_node_process_gives_the_bits_of_the_core_with_friction(tmp_path: Path) -> None:
    scene = slipping(tmp_path)
    with process_node("double") as node:
        judgement = judge_same_bits(node, scene, 1000, every=10)
    assert judgement.passed, judgement.verdicts


def test_scaled_frames_show_the_wheels_that_slip(tmp_path: Path) -> None:
    with virtual_node("double") as node:
        judgement = judge_scaled(node, slipping(tmp_path), 300, {})
    assert judgement.passed, judgement.verdicts


def test_reset_puts_wheels_that_slip_back_to_their_start(tmp_path: Path) -> None:
    scene = slipping(tmp_path)
    with virtual_node("double") as node:
        first = run_lockstep(node, scene, 40, every=10)
        node.control("RESET")
        node.start_lockstep()
        stream = RawStream(node, scene)
        again = []
        for _, count, row in stream.exchanges(40, 10):
            if row is not None:
                stream.send_inputs(row)
            stream.sync(count)
            again.append(stream.receive_state())
    assert np.array(again).tobytes() == first.states.tobytes()


@pytest.mark.parametrize(("change", "status", "field"), [
    (("GROUND_ROLLER_DRAG", 0, 1.5), "above limit", "ground roller drag"),
    (("WHEEL_ROLLER_DRAG", 2, -0.5), "negative", "wheel roller drag"),
    (("WINDING_RESISTANCE", 0, 0.0), "not positive", "winding resistance"),
    (("MOTOR_CIRCUIT", 1, 3), "motor circuit unknown", "motor circuit"),
    (("FRICTION_COEFFICIENT", 0, 0.2), "friction twice", "friction coefficient"),
    (("START_WHEEL_SPEED", 1, float("nan")), "not finite", "start wheel speed"),
    (("METHOD", 0, 1), "method without friction", "method")])
def test_a_node_refuses_by_name_what_ground_and_drive_cannot_be(
        change: tuple[str, int, float], status: str, field: str, tmp_path: Path) -> None:
    scene = slipping(tmp_path)
    with virtual_node("double") as node:
        twin = load_scene(node, scene)
        sent = [each for each in parameters_of(twin, start_of(scene)) if each[:2] != change[:2]] + [change]
        with pytest.raises(NodeRefused) as refusal:
            node.load_parameters(sent, twin.core.dtype)
    assert (refusal.value.status, refusal.value.field) == (status, field)


@pytest.mark.skipif(why_no_emulation() is not None, reason=why_no_emulation() or "")
@pytest.mark.parametrize(("board", "words"), [
    ("an386-small", f"ground friction or a drive's limits need auto, the node has {EXPLICIT} alone; use another node"),
    ("microbit", "not supported, ground friction")])
def test_an_image_without_friction_refuses_it_by_name(board: str, words: str, tmp_path: Path) -> None:
    scene = skid_steering(tmp_path).with_run(real="single")
    with emulated_node(board) as node, pytest.raises((BadInput, NodeRefused), match=words):
        load_scene(node, scene)
