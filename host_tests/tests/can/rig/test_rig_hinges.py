"""Vehicles with hinges over a bus: the bits of `laconic simulate`, scaled frames, refusals, the reference client."""

from __future__ import annotations

import copy
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import can
import numpy as np
import pytest

import reference_client
from laconic import ArticulatedVehicle, Scene, build_scene
from laconic.base.paths import scene_names
from laconic.can.rig.boards import emulated_node, why_no_emulation
from laconic.can.rig.buses import node_process, process_node, virtual_node
from laconic.can.rig.choices import BOARDS
from laconic.can.rig.free_judge import Free, judge_free_run
from laconic.can.rig.hinged import HingedTwin, load_hinged
from laconic.can.rig.judge import judge_same_bits, judge_scaled
from laconic.can.rig.lockstep import LockstepRun, run_lockstep
from laconic.can.rig.wire import wire
from laconic.cli.main import run as laconic
from laconic.core import REALS
from laconic.errors import BadInput
from laconic.scene import read_scene, rigid_scene_names
from laconic.scene.ground import slips
from laconic.scene.scene_tables import scene_tables
from laconic.simulation import simulate

RIGID = rigid_scene_names()
WITH_HINGES = [name for name in scene_names() if name not in RIGID]
ON_FRICTION = tuple(name for name in WITH_HINGES if slips(read_scene(name).vehicle))
HINGED = tuple(name for name in WITH_HINGES if name not in ON_FRICTION)
SELDOM = pytest.mark.nightly
# by day: these three are told to steer only from step 300 on; pr2_base and tricycle_agv from 800 on, at night alone
DAY_STEPS = dict.fromkeys(HINGED, 200) | {"f1tenth": 400, "frc_swerve_mk4i": 350, "tugger_train": 700}


def each_once(names: tuple[str, ...]) -> list[Any]:
    """Every scene in both scalar types; in the ordinary run each in one, by turns."""
    return [pytest.param(name, real, marks=[SELDOM] if k != number % 2 else [])
            for number, name in enumerate(names) for k, real in enumerate(REALS)]


SIGNALS = {"pose": ("x_m", "y_m", "heading_rad"), "velocity": ("velocity_body_m_per_s", "yaw_rate_rad_per_s"),
           "wheel_speed": ("wheel_speed_rad_per_s",), "wheel_angle": ("wheel_angle_rad",),
           "hinge_angle": ("hinge_angle_rad",), "hinge_rate": ("hinge_rate_rad_per_s",)}


def tables_of(name: str, **changes: Any) -> dict[str, Any]:
    return copy.deepcopy(scene_tables(name).entries) | changes


def shortened(name: str, real: str, steps: int) -> Scene:
    """The scene's first steps, with every step among its outputs."""
    scene = read_scene(name).with_run(real=real)
    scene = scene.with_run(duration_s=steps * scene.run.step_s)
    return replace(scene, outputs=replace(scene.outputs, every_s=scene.run.step_s, signals=()))


def slipping(name: str, real: str, steps: int, friction: float = 0.4) -> Scene:
    """The same on ground with friction."""
    tables = tables_of(name, ground={"friction_coefficient": friction})
    tables["vehicle"].pop("friction_coefficient", None)
    scene = build_scene(tables).with_run(real=real)
    scene = scene.with_run(duration_s=steps * scene.run.step_s)
    return replace(scene, outputs=replace(scene.outputs, every_s=scene.run.step_s, signals=()))


def of_simulate(scene: Scene) -> dict[str, np.ndarray]:
    """The columns of `laconic simulate` after each step, by the parts of a raw row."""
    columns = simulate(scene).columns
    found = {}
    for part, names in SIGNALS.items():
        chosen = [values for signal, values in columns.items() if signal.partition("[")[0] in names]
        found[part] = np.array(chosen).T[1:]
    return found


def assert_bits_of_simulate(run: LockstepRun, scene: Scene) -> None:
    assert run.hinged is not None and run.steps == scene.steps()
    parts = run.hinged.parts()
    for part, wanted in of_simulate(scene).items():
        answered = run.states[:, parts[part]]
        assert answered.dtype == scene.core().dtype
        assert answered.astype(float).tobytes() == wanted.tobytes(), part


def test_the_project_has_the_eight_scenes() -> None:
    assert len(HINGED) == 8


@pytest.mark.parametrize("name, real", each_once(HINGED + ON_FRICTION))
def test_the_node_gives_the_bits_of_simulate_where_wheels_slip(name: str, real: str) -> None:
    scene = shortened(name, real, 150) if name in ON_FRICTION else slipping(name, real, 150)
    with virtual_node(real) as node:
        assert_bits_of_simulate(run_lockstep(node, scene, fd=True), scene)


def equipped(real: str, steps: int) -> Scene:
    """A tricycle whose front wheel has a servo and whose trailer a hitch: every further number of ground with friction
    but those of a motor's loop, which the second body has."""
    wheel = {"kind": "fixed", "axle_deg": -90.0, "driven": False}
    front = wheel | {"x_m": 0.5, "y_m": 0.0, "steered": "servo", "name": "front", "mass_kg": 1.0,
                     "yaw_inertia_kgm2": 0.01, "servo_gain_Nm_per_rad": 60.0, "servo_damping_Nms": 1.5,
                     "servo_limit_Nm": 3.0, "stop_low_rad": -0.2, "stop_high_rad": 0.3, "dry_friction_Nm": 0.05,
                     "control_period_s": 0.01, "scrub_radius_m": 0.01, "scrub_fade_m": 0.1, "creep": 0.1}
    arm = {"name": "arm", "hinge": "motor", "hinge_x_m": -0.4, "hinge_y_m": 0.0, "mass_kg": 2.0,
           "yaw_inertia_kgm2": 0.05, "com_x_m": -0.2, "com_y_m": 0.0, "com_z_m": 0.1,
           "motor": {"resistance_ohm": 0.5, "torque_constant_Nm_per_A": 0.05, "back_emf_Vs_per_rad": 0.05,
                     "gear_ratio": 5.0, "viscous_friction_Nms": 0.002, "current_limit_A": 3.0},
           "loop_V_per_rad": 8.0, "loop_Vs_per_rad": 0.5, "hitch": True}
    vehicle = {"mass_kg": 20.0, "yaw_inertia_kgm2": 1.0, "com_z_m": 0.1, "com_x_m": 0.1, "wheel_radius_m": 0.1,
               "wheel_inertia_kgm2": 0.01, "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.3,
               "wheel": [wheel | {"x_m": 0.0, "y_m": 0.2, "driven": True},
                         wheel | {"x_m": 0.0, "y_m": -0.2, "driven": True}, front,
                         wheel | {"x_m": -0.4, "y_m": 0.0, "body": "arm"}], "body": [arm]}
    tables = {"vehicle": vehicle, "ground": {"friction_coefficient": 0.4},
              "initial": {"velocity_body_m_per_s": [0.5, 0]},
              "run": {"step_s": 0.005, "duration_s": 1.0, "real": real},
              "input": [{"signal": "voltage_V[1]", "kind": "steps", "t_s": [0.0], "value": [9.0]},
                        {"signal": "voltage_V[2]", "kind": "steps", "t_s": [0.0], "value": [3.0]},
                        {"signal": "steering_angle_rad[front]", "kind": "steps", "t_s": [0.0], "value": [0.6]},
                        {"signal": "steering_angle_rad[arm]", "kind": "steps", "t_s": [0.0], "value": [-0.5]}]}
    scene = build_scene(tables)
    scene = scene.with_run(duration_s=steps * scene.run.step_s)
    return replace(scene, outputs=replace(scene.outputs, every_s=scene.run.step_s, signals=()))


@pytest.mark.parametrize("real", REALS)
def test_servos_loops_stops_hitches_scrub_and_creep_have_the_bits_of_simulate(real: str) -> None:
    scene = equipped(real, 400)
    with virtual_node(real) as node:
        run = run_lockstep(node, scene, fd=True)
        assert_bits_of_simulate(run, scene)
        assert judge_scaled(node, scene, scene.steps(), {}).passed


@pytest.mark.parametrize("steps", [None, pytest.param(900, marks=SELDOM)], ids=["by day", "900"])
@pytest.mark.parametrize("name, real", each_once(HINGED))
def test_the_node_gives_the_bits_of_simulate(name: str, real: str, steps: int | None) -> None:
    scene = shortened(name, real, steps or DAY_STEPS[name])
    with virtual_node(real) as node:
        assert_bits_of_simulate(run_lockstep(node, scene, fd=True), scene)


@pytest.mark.parametrize("name", ["tugger_train", "frc_swerve_mk4i"])
def test_the_node_process_gives_them_on_classic_can(name: str) -> None:
    scene = shortened(name, "double", 60)
    with process_node("double") as node:
        assert_bits_of_simulate(run_lockstep(node, scene), scene)


@pytest.mark.skipif(why_no_emulation() is not None, reason=why_no_emulation() or "")
@pytest.mark.parametrize("board, names", [
    ("an386-hinges", ("frc_swerve_mk4i", "tricycle_agv", "wheelchair")), *(
        pytest.param(board, HINGED, marks=SELDOM) for board in ("an386-hinges", "an500-hinges"))],
    ids=["an386-hinges, three", "an386-hinges", "an500-hinges"])
def test_an_emulated_board_gives_them(board: str, names: tuple[str, ...]) -> None:
    real = BOARDS[board].real
    with emulated_node(board) as node:
        for name in names:
            scene = shortened(name, real, 12)
            assert_bits_of_simulate(run_lockstep(node, scene), scene)


@pytest.mark.skipif(why_no_emulation() is not None, reason=str(why_no_emulation()))
@pytest.mark.parametrize("names", [(), pytest.param(HINGED[:2], marks=SELDOM)], ids=["one", "three"])
def test_an_emulated_board_gives_them_where_wheels_slip(names: tuple[str, ...]) -> None:
    with emulated_node("an386-slip") as node:
        assert_bits_of_simulate(run_lockstep(node, equipped("single", 60)), equipped("single", 60))
        for name in names:
            scene = slipping(name, "single", 20)
            assert_bits_of_simulate(run_lockstep(node, scene), scene)


@pytest.mark.parametrize("steps", [None, pytest.param(900, marks=SELDOM)], ids=["by day", "900"])
@pytest.mark.parametrize("name, real", each_once(HINGED))
def test_scaled_frames_agree_to_half_a_last_place(name: str, real: str, steps: int | None) -> None:
    scene = read_scene(name).with_run(real=real)
    with virtual_node(real) as node:
        judgement = judge_scaled(node, scene, steps or DAY_STEPS[name], {})
    assert judgement.passed, judgement.verdicts
    assert {"VELOCITY.ahead", "HINGE_ANGLE.hinge_angle_1"} <= {verdict.name for verdict in judgement.verdicts}


def test_every_frame_of_a_vehicle_with_hinges_is_judged() -> None:
    frames = ["VELOCITY", "POSE", "WHEEL_SPEED", "WHEEL_ANGLE", "HINGE_ANGLE", "HINGE_RATE"]
    scene = build_scene(tables_of("tugger_train", rig={"frames": frames}))
    with virtual_node() as node:
        judgement = judge_scaled(node, scene, 700, {})
    assert judgement.passed, judgement.verdicts
    assert {verdict.name.partition(".")[0] for verdict in judgement.verdicts} == {*frames, "frames", "range"}
    assert {"HINGE_ANGLE.hinge_angle_4", "HINGE_RATE.hinge_rate_4"} <= {each.name for each in judgement.verdicts}


def test_the_command_judges_them_like_every_scene(capsys: pytest.CaptureFixture[str]) -> None:
    assert laconic(["rig", "wheel_loader", "--same-bits", "--steps", "40"]) == 0
    assert "same bits in 40 answers" in capsys.readouterr().out


@pytest.mark.parametrize("name, steps", [("f1tenth", 400), *(pytest.param(each, 900, marks=SELDOM) for each in (
    "f1tenth", "tricycle_agv", "tugger_train", "wheelchair"))])
def test_a_log_is_judged_again(name: str, steps: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "run.blf"
    first = json.loads(shown(capsys, ["rig", name, "--steps", str(steps), "--log", str(log), "--json"]))
    again = json.loads(shown(capsys, ["rig", name, "--replay", str(log), "--json"]))
    worst = {each["name"]: each["worst"] for each in first["verdicts"]}
    assert again["passed"] and all(worst[each["name"]] == each["worst"] for each in again["verdicts"]
                                   if "." in each["name"])
    assert again["figures"]["steps"] == steps


def shown(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> str:
    capsys.readouterr()
    assert laconic(arguments) == 0
    return capsys.readouterr().out


def test_a_car_whose_origin_is_off_its_axle_is_steered_by_whole_numbers() -> None:
    """Rounded, its twist would make the rear wheels slide: the node takes the nearest that lets them roll."""
    tables = tables_of("f1tenth")
    for wheel in tables["vehicle"]["wheel"]:
        wheel["x_m"] -= 0.1
    for real in REALS:
        scene = build_scene(tables).with_run(real=real)
        with virtual_node(real) as node:
            judgement = judge_scaled(node, scene, 400, {})
        assert judgement.passed, judgement.verdicts


@pytest.mark.parametrize("name, real, duration_s", [
    ("f1tenth", "double", 2.5), ("tricycle_agv", "single", 2.0), *(pytest.param(*each, marks=SELDOM) for each in (
        ("f1tenth", "double", 4.0), ("tricycle_agv", "single", 4.0), ("mir_like", "double", 4.0),
        ("tugger_train", "double", 9.0)))])
def test_a_free_run_lies_between_vehicles_with_every_possible_delay(name: str, real: str, duration_s: float) -> None:
    scene = read_scene(name).with_run(real=real)
    with virtual_node(real) as node:
        judgement = judge_free_run(node, scene, duration_s, 0, 100, {})
    assert judgement.passed, judgement.verdicts
    assert {"VELOCITY.ahead", "HINGE_ANGLE.hinge_angle_1"} <= {verdict.name for verdict in judgement.verdicts}


def test_a_free_run_that_steers_otherwise_is_found_out() -> None:
    """The judge is no yes-man: a vehicle that is told other rates than the frames carry fails."""
    scene = read_scene("tugger_train")
    with virtual_node() as node:
        trial = Free(node, scene, 9.0, 0, 100, {})
        trial.drive()
    for at, (seen, rows) in enumerate(trial.run.commands):
        trial.run.commands[at] = (seen, rows * 1.1)
    assert not trial.judge().passed


# ---- what ends a run or is refused


def test_a_limit_that_refuses_ends_the_run_where_simulate_does() -> None:
    tables = tables_of("tugger_train")
    tables["vehicle"]["wheel"][2] |= {"at_limit": "refuse", "rate_limit_rad_per_s": 0.4}
    with virtual_node() as node:
        judgement = judge_same_bits(node, build_scene(tables), None)
        assert node.state == "lockstep"  # the command brings it to rest
    assert not judgement.passed and judgement.verdicts[0].name == "run"
    assert "the command asks for 0.5 rad/s, the limit of its rate is 0.4" in judgement.verdicts[0].detail
    assert all(verdict.passed for verdict in judgement.verdicts[1:]) and judgement.figures["last_step"] == 600


def test_a_step_that_the_core_refuses_is_refused_by_the_node_too() -> None:
    twist = [{"signal": f"steering_twist[{k}]", "kind": "table", "t_s": [0.0, 0.1], "value": [float(k == 1), 0.0]}
             for k in (1, 2, 3)]
    with virtual_node() as node:
        judgement = judge_same_bits(node, build_scene(tables_of("frc_swerve_mk4i", input=twist)), 60)
    assert "the node refuses sync: twist zero" in judgement.verdicts[0].detail


def test_a_node_without_slip_names_the_remedy() -> None:
    with virtual_node("double") as node:
        twin = HingedTwin(slipping("mir_like", "double", 5))
        node.open()
        assert node.identity and node.identity.slip
        node.identity = replace(node.identity, slip=False)
        with pytest.raises(BadInput, match="ground.friction_coefficient: .*--board an386-slip, or take it out$"):
            load_hinged(node, twin)


def test_a_node_without_hinges_names_the_remedy() -> None:
    with virtual_node() as node:
        node.open()
        assert node.identity and node.identity.hinges
        node.identity = replace(node.identity, hinges=False)
        with pytest.raises(BadInput, match="LACONIC_NODE_WITH_HINGES=1, such as --board an386-hinges"):
            load_hinged(node, HingedTwin(read_scene("wheelchair")))


@pytest.mark.parametrize("name, frames, message", [
    ("f1tenth", ["NU"], "rig.frames: NU is not of vehicles with hinges; give some of VELOCITY"),
    ("f1tenth", ["POSE", "IMU"], "rig.frames: IMU is not of vehicles with hinges"),
    ("s1", ["NU", "HINGE_RATE"], "rig.frames: HINGE_RATE is of vehicles with hinges, and this one has none")])
def test_frames_that_never_come_are_refused(name: str, frames: list[str], message: str) -> None:
    with virtual_node() as node, pytest.raises(BadInput, match=message):
        judge_scaled(node, build_scene(tables_of(name, rig={"frames": frames})), 5, {})


def test_a_torque_on_a_hinge_has_no_scaled_frame() -> None:
    torque = [{"signal": "hinge_torque_Nm[front]", "kind": "steps", "t_s": [0.0], "value": [3.0]}]
    scene = build_scene(tables_of("tricycle_agv", input=torque))
    with virtual_node() as node, pytest.raises(BadInput, match=r"hinge_torque_Nm\[front\] has no scaled frame"):
        judge_scaled(node, scene, 5, {})
    with virtual_node() as node:
        assert judge_same_bits(node, scene, 100).passed


def test_what_does_not_take_hinges_yet_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert laconic(["rig", "f1tenth", "--bag", "out.mcap"]) == 2
    assert "does not take vehicles with hinges yet" in capsys.readouterr().err


# ---- the reference client: the page's contract alone

RIGHT = -math.pi / 2
TRICYCLE = {"MASS": 20.0, "YAW_INERTIA": 2.0, "WHEEL_RADIUS": 0.1, "WHEEL_INERTIA": 0.01, "MOTOR_GAIN": 0.5,
            "MOTOR_DAMPING": 1.0, "STEP": 0.01, "WHEEL_COUNT": 3, "WHEEL_KIND": [2, 2, 2], "WHEEL_X": [0.0, 0.0, 0.0],
            "WHEEL_Y": [0.2, -0.2, 0.0], "AXLE": [RIGHT, RIGHT, RIGHT], "BODY_COUNT": 1, "WHEEL_BODY": [0, 0, 1],
            "BODY_HINGE": [3], "BODY_HINGE_X": [1.0], "BODY_HINGE_Y": [0.0], "BODY_MASS": [1.0],
            "BODY_YAW_INERTIA": [0.1]}
AS_TABLE = {"mass_kg": 20.0, "yaw_inertia_kgm2": 2.0, "wheel_radius_m": 0.1, "wheel_inertia_kgm2": 0.01,
            "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 1.0,
            "body": [{"name": "fork", "hinge": "prescribed", "hinge_x_m": 1.0, "hinge_y_m": 0.0, "mass_kg": 1.0,
                      "yaw_inertia_kgm2": 0.1}],
            "wheel": [{"kind": "fixed", "x_m": 0.0, "y_m": y, "axle_rad": RIGHT, **more}
                      for y, more in ((0.2, {}), (-0.2, {}), (0.0, {"body": "fork"}))]}
RATES = [0.5 * math.sin(0.1 * k) for k in range(1, 31)]


def test_the_reference_client_steers_a_tricycle() -> None:
    """Frames of a steered vehicle by python-can and cantools alone, against the core stepped with the same numbers."""
    plant = ArticulatedVehicle(AS_TABLE).plant("auto", 0.01)
    before = {"voltage_V": [0.0, 0.0, 5.0], "steering_rate_rad_per_s[fork]": 0.0}
    with node_process("double") as port, can.Bus(interface="slcan", channel=f"socket://127.0.0.1:{port}") as bus:
        client = reference_client.Client(bus)
        client.open()
        assert client.last["IDENTITY"]["hinges"] == 1
        client.load(TRICYCLE)
        client.command("SELECT", send_velocity=1, send_hinge_angle=1, send_hinge_rate=1)
        client.start("START_LOCKSTEP")
        for rate in RATES:
            sent = round(rate / 0.0005) * 0.0005
            client.move("VOLTAGE", voltage_3=5.0)
            client.move("STEERING", page=0, hinge_rate_1=sent, sync=1)
            answers = {name: client.await_frame(name) for name in ("VELOCITY", "HINGE_ANGLE", "HINGE_RATE")}
            after = before | {"steering_rate_rad_per_s[fork]": sent}
            plant.step(before, after)
            before, now = after, plant.motion()
            assert answers["VELOCITY"]["ahead"] == pytest.approx(now.velocity_m_per_s[0], abs=0.000251)
            assert answers["VELOCITY"]["yaw_rate"] == pytest.approx(now.yaw_rate_rad_per_s, abs=0.000251)
            assert answers["HINGE_ANGLE"]["hinge_angle_1"] == pytest.approx(now.hinge_angle_rad[0], abs=0.000051)
            assert answers["HINGE_RATE"]["hinge_rate_1"] == pytest.approx(now.hinge_rate_rad_per_s[0], abs=0.00051)
        client.command("CONTROL", command="STOP")
    assert abs(now.hinge_angle_rad[0]) > 0.005 and now.velocity_m_per_s[0] > 0.02


def test_every_signal_of_steering_has_its_page() -> None:
    frame = wire()["STEERING"]
    for page, names in enumerate([*([f"hinge_rate_{3 * k + i}" for i in (1, 2, 3)] for k in range(3)),
                                  *([f"hinge_voltage_{3 * k + i}" for i in (1, 2, 3)] for k in range(3)),
                                  ["twist_1", "twist_2", "twist_3"]]):
        shown = frame.unpack(bytes(frame.pack(page=page)))
        assert [name for name in shown if name not in ("crc", "counter", "sync", "page")] == names
