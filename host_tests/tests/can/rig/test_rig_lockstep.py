"""Lockstep over a bus: the node is the core, bit for bit, and the scaled frames agree to half of their resolution."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.can.rig.buses import process_node, virtual_node
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.judge import judge_same_bits, judge_scaled
from laconic.can.rig.lockstep import run_lockstep, twin_states
from laconic.can.rig.wire import wire
from laconic.core import REALS
from laconic.scene import read_scene, rigid_scene_names


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("name", rigid_scene_names())
def test_every_scene_gives_the_bits_of_the_core_over_ten_thousand_steps(name: str, real: str) -> None:
    scene = read_scene(name).with_run(real=real)
    every = 1 if not scene.inputs_on_grid().is_held else 10  # sampled inputs go over the wire step by step
    with virtual_node(real) as node:
        run = run_lockstep(node, scene, 10_000, every=every, fd=True)
    assert run.steps == 10_000 and np.isfinite(run.states).all()
    assert run.states.tobytes() == twin_states(scene, run).tobytes()


@pytest.mark.parametrize("fd", [False, True])
@pytest.mark.parametrize("real", REALS)
def test_one_answer_a_step_gives_the_same_bits_on_classic_can_and_can_fd(real: str, fd: bool) -> None:
    with virtual_node(real) as node:
        assert judge_same_bits(node, read_scene("robotino2").with_run(real=real), 300, fd=fd).passed


def test_the_node_process_gives_the_bits_of_the_core() -> None:
    with process_node("double") as node:
        judgement = judge_same_bits(node, read_scene("turtlebot3_burger"), 1000)
    assert judgement.passed, judgement.verdicts


@pytest.mark.parametrize("name", ["s1", "turtlebot3_burger", "kuka_youbot"])
def test_scaled_frames_agree_with_the_twin_to_half_a_last_place(name: str) -> None:
    scene = read_scene(name)
    if not all(each.signal.startswith("voltage_V") for each in scene.inputs):
        pytest.skip("this scene has inputs without scaled frames")
    with virtual_node(scene.run.real) as node:
        judgement = judge_scaled(node, scene, 400, {})
    assert judgement.passed, judgement.verdicts


def test_a_refused_vehicle_names_status_field_and_wheel_and_the_old_one_stays() -> None:
    scene = read_scene("s1")
    with virtual_node() as node:
        run_lockstep(node, scene, 10)
        bad = [("MASS", 0, 1.0), ("YAW_INERTIA", 0, 1.0), ("WHEEL_RADIUS", 0, 0.1), ("WHEEL_COUNT", 0, 2),
               ("WHEEL_INERTIA", 0, 0.0), ("STEP", 0, 0.01), ("METHOD", 0, 1)]
        bad += [(field, wheel, 0.1) for wheel in (1, 2) for field in ("WHEEL_X", "WHEEL_Y", "AXLE")]
        bad += [("WHEEL_KIND", 1, 2), ("WHEEL_KIND", 2, 0)]
        with pytest.raises(NodeRefused) as refusal:
            node.load_parameters(bad, np.dtype(np.float64))
        assert (refusal.value.status, refusal.value.field, refusal.value.item) == ("wheel not set", "wheel kind", 2)
        node.start_lockstep()  # with the vehicle of before


def test_a_wrong_checksum_and_an_unknown_parameter_are_refused() -> None:
    with virtual_node() as node:
        with pytest.raises(NodeRefused, match="not supported, resistance"):
            node.load_parameters([("RESISTANCE", 0, 1.0)], np.dtype(np.float64))
        with pytest.raises(NodeRefused, match="parameter unknown, voltage"):
            node.load_parameters([("VOLTAGE", 0, 1.0)], np.dtype(np.float64))
        node.control("BEGIN")
        with pytest.raises(NodeRefused, match="checksum mismatch"):
            node.command("COMMIT", frame_count=0, checksum=123)


def test_the_packers_made_from_the_dbc_agree_with_cantools() -> None:
    source = np.random.default_rng(7)
    for frame in wire().frames.values():
        values = {name: int(source.integers(-field.largest if field.signed else 0, field.largest, endpoint=True))
                  for name, field in frame.fields.items() if field.largest <= field.mask}
        if frame.name == "COUNTERS":
            values = {name: values[name] for name in ("crc", "counter", "crc_errors", "sequence_errors", "repeated")}
            values["page"] = 0
        theirs: dict[str, float] = dict(values)
        if frame.name == "ERROR_ESTIMATE":
            values |= {"page": 2, "heading": int(np.float32(1.5e-9).view(np.uint32))}
            theirs = {**values, "heading": float(np.float32(1.5e-9))}
            assert frame.physical(bytes(frame.pack(**values)))["heading"] == theirs["heading"]
        message = wire().database.get_message_by_name(frame.name)
        assert bytes(frame.pack(**values)) == message.encode(theirs, scaling=False, strict=False), frame.name


def test_value_tables_of_the_dbc_are_the_enumerations_of_the_core() -> None:
    core = read_scene("s1").core()
    for number, text in wire()["RESULT"].fields["status"].choices.items():
        if number < 64:
            assert getattr(core.lib, f"LACONIC_{text}") == number
    fields = wire()["PARAMETER"].fields["field"].choices
    assert fields == wire()["RESULT"].fields["field"].choices
    for field in core.fields:  # others are reserved for what the core will learn
        assert fields.get(field.number) == field.identifier, (
            f'laconic.dbc: give VAL_ 1672 field and VAL_ 1675 field {field.number} "{field.identifier}"')
    assert core.lib.LACONIC_STATUS_COUNT == sum(n < 64 for n in wire()["RESULT"].fields["status"].choices)
