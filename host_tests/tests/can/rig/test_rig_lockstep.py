"""Lockstep over a bus: the node is the core, bit for bit, and the scaled frames agree to half of their resolution."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from friction_scenes import SCENES, skid_steering, slipping
from laconic.can.rig.boards import emulated_node, own_node, why_no_emulation
from laconic.can.rig.buses import process_node, virtual_node
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.judge import judge_same_bits, judge_scaled
from laconic.can.rig.lockstep import RawStream, load_scene, run_lockstep, start_of, twin_states
from laconic.can.rig.parameters import parameters_of
from laconic.can.rig.scaled import rounding_limit
from laconic.can.rig.wire import wire
from laconic.core import REALS
from laconic.errors import BadInput
from laconic.scene import Scene, read_scene, rigid_scene_names
from laconic.scene.methods import EXPLICIT


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("name", rigid_scene_names())
def test_every_scene_gives_the_bits_of_the_core_over_ten_thousand_steps(name: str, real: str) -> None:
    scene = read_scene(name).with_run(real=real)
    every = 1 if not scene.inputs_on_grid().is_held else 50  # sampled inputs go over the wire step by step
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
        if frame.name == "STEERING":
            values = {name: values[name] for name in ("crc", "counter", "sync", "twist_1", "twist_2", "twist_3")}
            values["page"] = 6
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


# ---- A node that rounds as its own numbers do is right, in double and in single precision.

def as_the_node_rounds(value: np.ndarray, per_unit: int) -> np.ndarray:
    """node_pack.c: scaled and rounded half away from zero in the scalar type."""
    raw = value * value.dtype.type(per_unit)
    return np.trunc(raw + np.copysign(value.dtype.type(0.5), raw)).astype(np.int64)


@pytest.mark.parametrize("real", ["float32", "float64"])
@pytest.mark.parametrize(("per_unit", "largest"), [(200, 163.0), (1000, 32.0), (10000, 3.14)])
def test_whatever_the_node_rounds_is_within_the_rounding_limit(real: str, per_unit: int, largest: float) -> None:
    values = np.random.default_rng(7).uniform(-largest, largest, 400_000).astype(real)
    exact = values.astype(float) * per_unit
    off = np.abs(as_the_node_rounds(values, per_unit) - exact)
    assert np.all(off <= rounding_limit(exact, np.dtype(real)))
    assert np.max(off) > 0.499  # a limit below 0.5 would be too small


def test_the_rounding_limit_stays_half_where_numbers_are_fine() -> None:
    assert rounding_limit(32767.0, np.dtype("float64")) < 0.50001
    assert rounding_limit(32767.0, np.dtype("float32")) < 0.505


def test_a_long_run_of_a_node_in_single_precision_passes() -> None:
    scene = read_scene("turtlebot3_burger").with_run(real="single")
    with own_node("virtual", "single") as node:
        assert judge_scaled(node, scene, 6100, {}).passed  # its heading was "wrong" at step 6037


# ---- The node steps vehicles with friction, limits of motors and slopes as the core does, and refuses what it
# lacks.

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
