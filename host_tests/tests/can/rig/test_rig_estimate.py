"""The error estimate over a bus: a node's pages are the core's numbers, its bits are those without, and it is shown."""

from __future__ import annotations

import json
from dataclasses import astuple, replace

import can
import numpy as np
import pytest

from laconic.can.rig.boards import emulated_node, own_node, why_no_emulation
from laconic.can.rig.buses import virtual_node
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.estimated import read_estimate
from laconic.can.rig.judge import judge_scaled
from laconic.can.rig.live import View
from laconic.can.rig.lockstep import load_scene, run_lockstep, twin_states
from laconic.can.rig.wire import wire
from laconic.cli.main import run as run_command
from laconic.core import REALS
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXACT, EXPLICIT

STEPS = 300


def estimated_scene(real: str = "double", name: str = "robotino2") -> Scene:
    """One whose errors are far from rounding, with the estimate among its frames."""
    scene = read_scene(name).with_run(real=real, method=EXACT, step_s=0.02)
    return replace(scene, rig=replace(scene.rig, frames=("NU", "ERROR_ESTIMATE")))


def expected(scene: Scene) -> list[float]:
    """What the core's estimate says after the same inputs, in the frame's single precision: now, then the largest."""
    plant, inputs = scene.plant(scene.core()), scene.inputs_on_grid()
    estimate = plant.estimate()
    for tick in range(STEPS):
        estimate.run(plant.core.input(plant.core.input_row(inputs.held_at(tick))))
    errors = estimate.read()
    return [float(np.float32(value)) for value in (*astuple(errors.now), *astuple(errors.largest))]


@pytest.mark.parametrize("real", REALS)
def test_after_a_run_all_pages_are_the_cores_numbers(real: str) -> None:
    scene = estimated_scene(real)
    with virtual_node(real) as node:
        run = run_lockstep(node, scene, STEPS, every=7)
        figures = read_estimate(node)
    assert run.states.tobytes() == twin_states(scene, run).tobytes()
    assert list(figures.values()) == [*expected(scene), 0.0]
    assert min(expected(scene)) > 0.0
    assert list(figures)[:2] == ["estimated_error_nu_rad_per_s", "estimated_error_place_m"]


def test_the_command_shows_it_in_every_mode(tmp_path, capsys) -> None:
    path, text = tmp_path / "s.toml", read_scene("robotino2").path.read_text(encoding="utf-8")
    rig = 'frames = ["NU", "POSE", "ERROR_ESTIMATE"]\n'
    path.write_text(text.replace("[rig]\n", "[rig]\n" + rig) if "[rig]" in text else text + "\n[rig]\n" + rig,
                    encoding="utf-8")
    for mode in ("--lockstep", "--same-bits", "--free-run"):
        assert run_command(["rig", str(path), mode, "--steps", "200", "--json"]) == 0
        figures = json.loads(capsys.readouterr().out)["figures"]
        assert 0.0 < figures["estimated_error_place_m"] <= figures["largest_estimated_error_place_m"] < 1e-3
        assert figures["estimate_unknown_windows"] == 0.0


def test_unless_a_scene_asks_for_it_no_page_comes() -> None:
    scene = read_scene("robotino2")
    with virtual_node("double") as node:
        seen: list[int] = []
        node.link.listeners.append(lambda message: seen.append(message.arbitration_id))
        judgement = judge_scaled(node, scene, 50, {})
        assert read_estimate(node) == {}
    assert judgement.passed
    assert node.link.id_base + wire()["ERROR_ESTIMATE"].offset not in seen


def test_pages_of_two_instants_are_not_mixed() -> None:
    scene = estimated_scene()
    with virtual_node("double") as node:
        run_lockstep(node, scene, STEPS, every=7)
        taken, receive = [], node.link.receive_until

        def loses_a_page(deadline_us: int):
            """The fourth page of the first instant."""
            received = receive(deadline_us)
            if received is not None and received[0].name == "ERROR_ESTIMATE":
                taken.append(received[0].unpack(received[1])["page"])
                if len(taken) == 4:
                    return receive(deadline_us)
            return received

        node.link.receive_until = loses_a_page
        assert list(read_estimate(node).values()) == [*expected(scene), 0.0]
    assert len(taken) > 8


def test_the_live_view_shows_the_numbers_in_their_units() -> None:
    frame = wire()["ERROR_ESTIMATE"]
    data = frame.pack(page=1, unknown=2)
    data[2:6] = np.float32(1.5e-9).tobytes()
    assert frame.physical(data) == {"crc": 0.0, "counter": 0.0, "page": 1.0, "place": pytest.approx(1.5e-9, rel=1e-7),
                                    "unknown": 2.0}
    with virtual_node("double") as node:
        view = View(node.link, "s", 10)
        identifier = node.link.id_base + frame.offset
        view.take(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))
        assert view.text_of((frame.offset, 1)) == "place 1.5e-09  unknown 2"


def test_a_node_of_another_process_sends_it() -> None:
    with own_node("process", "double", 0x680) as node:
        run_lockstep(node, estimated_scene(), 50)
        assert read_estimate(node)["estimated_error_place_m"] > 0.0


@pytest.mark.skipif(why_no_emulation() is not None, reason=why_no_emulation() or "")
def test_an_image_that_has_none_refuses_it() -> None:
    with emulated_node("an386-small") as node:
        load_scene(node, read_scene("robotino2").with_run(real="single", method=EXPLICIT))
        with pytest.raises(NodeRefused) as refused:
            node.select(send_nu=1, send_error_estimate=1)
        assert (refused.value.command, refused.value.status) == ("select", "not supported")
