"""What people see of vehicles with hinges on the command line, and that no other command ignores the hinges."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from hinge_scenes import CASTER, HINGED, held, scene_with, tables_of, two_wheels

import laconic
from laconic.base.paths import SCENE_DIR, SOURCE_DIR
from laconic.cli.main import run
from laconic.core.articulated_input import row_length
from laconic.errors import BadInput
from laconic.fmu.hinges import left_out
from laconic.robot.bags.messages import store
from laconic.scene.base import BaseTable, joint_names
from laconic.scene.scene_text import lines_of
from laconic.simulation.articulated import Parts

REFERENCE = Path(__file__).parents[1] / "data" / "articulated_reference.json"
DOES_NOT = "does not take vehicles with hinges"


def told(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    capsys.readouterr()
    status = run(arguments)
    return status, *capsys.readouterr()


def test_simulate_writes_columns_of_hinges_and_a_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, picture = tmp_path / "run.csv", tmp_path / "run.png"
    status, text, warnings = told(["simulate", "tugger_train", "-o", str(out), "--plot", str(picture), "--inputs",
                                   "--json"], capsys)
    assert status == 0 and warnings == ""
    with out.open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert {"hinge_angle_rad[front]", "hinge_rate_rad_per_s[third]", "wheel_speed_rad_per_s[9]",
            "steering_angle_rad[front]", "voltage_V[1]"} <= {*rows[0]}
    assert len(rows) == 302 and all(len(row) == len(rows[0]) for row in rows)
    assert picture.stat().st_size > 20_000
    summary = json.loads(text)
    assert summary["chosen"] == "auto" and summary["limited"] == [] and summary["no_slip"]["holds"]
    assert summary["final"]["hinge_angle_rad[front]"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("name", ["tugger_train", "f1tenth"])
def test_a_film_moves_every_body_and_turns_every_wheel(name: str, tmp_path: Path,
                                                       capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.svg"
    assert told(["simulate", name, "--film", str(path)], capsys)[0] == 0
    film, scene = path.read_text(encoding="utf-8"), laconic.read_scene(name)
    ElementTree.fromstring(film)
    for number in range(1, len(scene.hinges) + 1):
        assert f"@keyframes b{number} " in film and film.count(f'class="m b{number}"') == 1
    for number in range(1, scene.wheel_count + 1):
        assert film.count(f'class="m w{number}"') == 1
    end = laconic.simulate(scene, ["body_x_m", "body_y_m"])
    x, y = (float(end.columns[f"{axis}[{scene.hinges[0].name}]"][-1]) for axis in ("body_x_m", "body_y_m"))
    assert f"animation-name: b1; transform: translate({x:.4f}px, {y:.4f}px)" in film


def test_every_output_of_a_scene_with_hinges_can_be_asked_for(tmp_path: Path) -> None:
    from laconic.scene.hinge_signals import HINGE_OUTPUTS, PAIRS, PLAIN_OUTPUTS, WHEEL_OUTPUTS

    scene = laconic.read_scene("wheelchair").with_run(duration_s=1.0)
    run_ = laconic.simulate(scene, [*PAIRS, *PLAIN_OUTPUTS, *WHEEL_OUTPUTS, *HINGE_OUTPUTS])
    assert len(run_.columns) == 2 * 2 + 9 + 5 * 4 + 8 * 2
    speed, x = run_.columns_of("velocity_body_m_per_s")[:, 0], run_.columns["x_m"]
    assert np.abs(np.gradient(x, run_.time_s) - speed)[5:-5].max() < 0.01
    acceleration = run_.columns_of("acceleration_body_m_per_s2")[:, 0]
    assert np.abs(np.gradient(speed, run_.time_s) - acceleration)[5:-5].max() < 0.01
    for signal in ("slip_along_m_per_s", "wheel_load_N", "hinge_stop_Nm[front]", "servo_work_J"):
        with pytest.raises(BadInput, match=r"wheels may slip; give ground.friction_coefficient, or take"):
            laconic.simulate(scene, [signal])


@pytest.mark.parametrize("wheel", [1, 2])
def test_the_warning_of_slip_names_the_wheel_that_lacks_most(wheel: int, tmp_path: Path,
                                                             capsys: pytest.CaptureFixture[str]) -> None:
    tables = two_wheels(friction_coefficient=0.05, motor_gain_Nm_per_V=0.5, motor_damping_Nms=0.5, caster=[CASTER])
    tables |= {"initial": {}, "input": held(**{f"voltage_V__{wheel}": 12.0})}
    scene = tmp_path / "robot.toml"
    scene.write_text("\n".join(lines_of(tables, {})), encoding="utf-8")
    _, out, err = told(["simulate", str(scene), "--json"], capsys)
    assert f"where wheel {wheel} would slip, by" in err
    assert json.loads(out)["no_slip"]["wheel"] == wheel


def grip_of(point: dict[str, Any], friction: float, tmp_path: Path,
            capsys: pytest.CaptureFixture[str]) -> tuple[dict[str, Any], str]:
    """The verdict on a robot whose third point is a support or a caster, as it starts under a step of its voltages."""
    tables = two_wheels(wheel_inertia_kgm2=1e-3, friction_coefficient=friction, com_z_m=0.15, com_x_m=0.05,
                        motor_gain_Nm_per_V=0.5, motor_damping_Nms=0.5, **point)
    tables |= {"initial": {}, "input": held(voltage_V__1=10.0, voltage_V__2=8.0)}
    scene = tmp_path / "robot.toml"
    scene.write_text("\n".join(lines_of(tables, {})), encoding="utf-8")
    status, out, err = told(["simulate", str(scene), "--json"], capsys)
    assert status == 0, err
    return json.loads(out), err


def test_a_support_and_a_caster_have_the_same_verdict_on_grip(tmp_path: Path,
                                                             capsys: pytest.CaptureFixture[str]) -> None:
    caster = {**CASTER, "x_m": 0.3, "trail_m": 1e-3, "start_angle_deg": 0.0}
    found = [(grip_of({"support": [{"x_m": 0.299, "y_m": 0.0}]}, friction, tmp_path, capsys),
              grip_of({"caster": [caster]}, friction, tmp_path, capsys)) for friction in (0.2, 3.0)]
    (support, told_of_support), (hung, told_of_caster) = found[0]
    assert support["no_slip"]["holds"] is False and hung["no_slip"]["holds"] is False
    assert support["no_slip"]["slipping_wheels"] == hung["no_slip"]["slipping_wheels"] == [1, 2]
    worst = support["no_slip"]["worst_slip"]
    assert hung["no_slip"]["least_margin_N"] == pytest.approx(worst["margin_N"], rel=1e-3)
    remedy = told_of_support.strip().rpartition("; ramp the inputs")[2]
    assert remedy and told_of_caster.splitlines()[0].endswith(remedy)
    assert "wheels 1 and 2 would slip, worst at 0 s" in told_of_caster
    (support, _), (hung, _) = found[1]
    assert not support["no_slip"]["slipping"] and hung["no_slip"]["holds"]


@pytest.mark.parametrize("method", ["auto", "rk4", "circle", "moebius-4"])
def test_simulate_takes_each_method_of_these_vehicles(method: str, capsys: pytest.CaptureFixture[str]) -> None:
    status, text, _ = told(["simulate", "f1tenth", "--method", method, "--json"], capsys)
    assert status == 0
    found = json.loads(text)
    assert found["chosen"] == method and found["final"]["x_m"] == pytest.approx(7.9009, abs=1e-3)


@pytest.mark.parametrize("method", ["exact-flow", "taylor-8", "exponential-kahan"])
def test_other_methods_are_refused_with_the_list_of_those(method: str, capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["simulate", "f1tenth", "--method", method], ["verify", str(REFERENCE), "--method", method]):
        status, _, why = told(arguments, capsys)
        assert status == 2 and why.count("\n") == 1
        assert all(name in why for name in ("auto", "rk4", "circle", "moebius-4"))
    status, _, why = told(["simulate", "s1", "--method", "circle"], capsys)
    assert status == 2 and "exact-flow" in why


@pytest.mark.parametrize(("step_s", "limit"), [("0.001", 1e-9), ("0.01", 1e-5)])
def test_verify_reads_the_references_and_gives_five_errors(step_s: str, limit: float,
                                                           capsys: pytest.CaptureFixture[str]) -> None:
    status, text, _ = told(["verify", str(REFERENCE), "--step", step_s, "--tolerance", str(limit), "--json"], capsys)
    assert status == 0
    cases = json.loads(text)["cases"]
    kinds = ("velocity", "hinge_rate", "hinge_angle", "pose", "wheel")
    assert len(cases) == 8
    for case in cases:
        assert case["status"] == "ok" and all(0.0 <= case[f"error_{kind}"] <= limit for kind in kinds), case["name"]


def test_verify_fails_for_a_reference_that_is_off_and_for_a_tolerance(tmp_path: Path,
                                                                      capsys: pytest.CaptureFixture[str]) -> None:
    assert told(["verify", str(REFERENCE), "--tolerance", "1e-15"], capsys)[0] == 1
    content = json.loads(REFERENCE.read_text(encoding="utf-8"))
    content["cases"] = content["cases"][:1]
    content["cases"][0]["states"][3]["psi"][0] = "0.5"
    path = tmp_path / "off.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    status, text, _ = told(["verify", str(path), "--json"], capsys)
    assert status == 0 and json.loads(text)["cases"][0]["error_hinge_angle"] > 1e-2


@pytest.mark.parametrize(("change", "words"), [
    (lambda case: case["vehicle"]["bodies"][1].update(parent=4), "bodies[2].parent: is 4"),
    (lambda case: case["vehicle"]["bodies"][1]["joint"].update(kind="ball"), "joint.kind: there is no 'ball'"),
    (lambda case: case["vehicle"]["wheels"][0].update(body=7), "wheels[1].body: is 7"),
    (lambda case: case["initial"].pop("psi"), "initial.psi: is missing"),
    (lambda case: case["states"].pop(), "states: are"),
    (lambda case: case["segments"][0].update(hinge_rate={"5": [1]}), "hinge_rate: names the body 5"),
    (lambda case: case["segments"][0].update(twist=[[1]]), "twist: has 1 lists"),
    (lambda case: case["states"][1].update(pose=["a", "0", "0"]), "pose: holds 'a'")])
def test_a_reference_that_cannot_be_read_is_one_line(change, words: str, tmp_path: Path,  # type: ignore[no-untyped-def]
                                                     capsys: pytest.CaptureFixture[str]) -> None:
    content = json.loads(REFERENCE.read_text(encoding="utf-8"))
    change(content["cases"][0])
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    status, _, why = told(["verify", str(path)], capsys)
    assert status == 2 and words in why and why.count("\n") == 1


ELSEWHERE = {  # every other command that takes a scene, with what it needs in addition
    "optimise": "SCENE --free vehicle.mass_kg=1:2 --goal min:speed",
    "sweep": "SCENE --vary vehicle.mass_kg=1:2:3 -o FOLDER/sweep", "report": "--scene SCENE", "demo": "SCENE"}


def test_the_list_above_has_every_command_that_takes_a_scene() -> None:
    texts = {path.stem: path.read_text(encoding="utf-8")
             for path in (SOURCE_DIR / "python/laconic/cli/commands").glob("*.py")}
    takes = {name for name, text in texts.items() if "SceneName(" in text}
    with_hinges = {name for name, text in texts.items() if "SceneName(hinges=True)" in text}
    assert with_hinges == {"simulate", "fmu", "analyse", "derive", "trim", "ros2", "rig", "play", "replay",
                           "identify", "audit", "logs", "frc"}
    assert takes - with_hinges == {*ELSEWHERE}


@pytest.mark.parametrize("command", ELSEWHERE)
@pytest.mark.parametrize("name", ["f1tenth", "mir_like", "tugger_train", "wheel_loader"])
def test_a_command_that_knows_no_hinges_refuses_them_in_one_line(command: str, name: str, tmp_path: Path,
                                                                capsys: pytest.CaptureFixture[str]) -> None:
    scene = SCENE_DIR / f"{name}.toml"
    log = tmp_path / "log.csv"
    log.write_text("t_s,x_m,y_m\n0,0,0\n1,1,0\n", encoding="utf-8")
    names = {"SCENE": scene, "LOG": log, "FOLDER": tmp_path}
    arguments = re.sub("|".join(names), lambda name: str(names[name[0]]), ELSEWHERE[command]).split()
    status, text, why = told([command, *arguments], capsys)
    assert status == 2 and text == "" and why.count("\n") == 1
    assert f"laconic {command} {DOES_NOT}" in why and "use laconic simulate" in why and str(scene) in why
    assert "[[vehicle.support]]" in why and "laconic import --no-hinges" in why


def test_simulate_refuses_to_enclose_hinges_and_names_the_estimate(capsys: pytest.CaptureFixture[str]) -> None:
    status, _, why = told(["simulate", "f1tenth", "--enclose"], capsys)
    assert status == 2 and f"--enclose {DOES_NOT}" in why and "--errors" in why


OF_KINDS = {"velocity_m_per_s": "velocity_body_m_per_s", "yaw_rate_rad_per_s": "yaw_rate_rad_per_s",
            "hinge_rate_rad_per_s": "hinge_rate_rad_per_s", "heading_rad": "heading_rad",
            "hinge_angle_rad": "hinge_angle_rad", "wheel_angle_rad": "wheel_angle_rad"}


@pytest.mark.parametrize(("name", "step_s", "method"), [
    ("mir_like", 0.01, "auto"), ("mir_like", 0.025, "auto"), ("tugger_train", 0.02, "moebius-4"),
    ("wheelchair", 0.01, "circle"), ("tricycle_agv", 0.02, "auto")])
def test_the_estimated_error_is_above_the_true_one_and_near_it(name: str, step_s: float, method: str) -> None:
    """Inputs that are held over steps of each size, so that a finer run is the same motion."""
    scene = laconic.read_scene(name).with_run(duration_s=2.0, step_s=step_s, method=method)
    held_inputs = tuple(replace(each, kind="steps", t_s=(0.0,), value=(4.0 + k,)) for k, each in
                        enumerate(each for each in scene.inputs if each.signal.startswith("voltage_V")))
    scene = replace(scene, inputs=held_inputs, outputs=replace(scene.outputs, every_s=None))
    kept = tuple(OF_KINDS.values())
    run_ = laconic.simulate(scene, kept, estimated=True)
    fine = laconic.simulate(scene.with_run(step_s=step_s / 20, method="auto"), kept)
    every = 20 if len(fine.time_s) > len(run_.time_s) else 1
    assert not run_.errors.unknown and run_.errors.largest.place_m > 1e-12
    for kind, signal in OF_KINDS.items():
        off = np.abs(run_.columns_of(signal) - fine.columns_of(signal)[::every]).max(axis=1)
        estimated = run_.error_columns[f"estimated_error_{kind}"]
        rounding = 1e-11 * max(1.0, float(np.abs(run_.columns_of(signal)).max()))
        assert np.all(off <= 1.01 * estimated + rounding), kind
        assert off.max() >= estimated.max() / 30 - rounding, kind


def test_errors_are_unknown_from_a_refused_part_on() -> None:
    scene = laconic.read_scene("wheelchair")
    plant = scene.articulated_vehicle(scene.core()).plant(step_s=0.01)
    parts, rows = Parts(plant), np.zeros((3, 2, row_length(plant.core)))
    for given in (rows, np.full_like(rows, np.nan), rows):
        parts.follow(given)
        parts.take()
    assert np.isfinite(parts.table()[0]).all() and np.isinf(parts.table()[1:]).all()
    assert parts.read().unknown == 6 and parts.read().now.place_m == np.inf


def test_simulate_writes_columns_of_estimated_errors_and_prints_them(tmp_path: Path,
                                                                     capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "run.csv"
    status, text, _ = told(["simulate", "f1tenth", "--errors", "-o", str(out)], capsys)
    assert status == 0 and "estimated error: velocity" in text and "largest of the rows" in text
    header, *rows = csv.reader(out.open(encoding="utf-8"))
    at = header.index("estimated_error_hinge_angle_rad")
    assert header[-7:] == [f"estimated_error_{kind}" for kind in (
        "velocity_m_per_s", "yaw_rate_rad_per_s", "hinge_rate_rad_per_s", "place_m", "heading_rad", "hinge_angle_rad",
        "wheel_angle_rad")]
    assert all(0.0 <= float(row[at]) < 1e-9 for row in rows)
    status, text, _ = told(["simulate", "f1tenth", "--errors", "-o", str(out), "--json"], capsys)
    assert json.loads(text)["estimated_error"]["now"]["place_m"] < 1e-8


@pytest.mark.parametrize(("tolerance", "longest"), [(1e-4, 0.5), (1e-7, 0.02)])
def test_auto_finds_a_step_that_keeps_the_tolerance_with_hinges(tolerance: float, longest: float) -> None:
    tables = two_wheels(caster=[{**CASTER, "start_angle_rad": 1.0}])
    tables["run"] = {"duration_s": 0.5, "step_s": "auto", "tolerance": tolerance}
    scene = scene_with(tables)
    assert 1e-4 <= scene.run.step_s <= longest and scene.run.tolerance == tolerance
    end = laconic.simulate(scene).columns["hinge_angle_rad[caster_1]"][-1]
    assert abs(end - 2.0 * np.arctan(np.tan(0.5) * np.exp(-0.8 * 0.5 / 0.05))) <= tolerance
    tables["run"]["tolerance"] = 1e-30
    with pytest.raises(BadInput, match=r"run.tolerance: 1e-30 is kept by no step"):
        scene_with(tables)


def test_a_bag_of_a_run_with_hinges_has_their_joints_and_odometry_of_the_carriages_wheels(tmp_path: Path) -> None:
    rosbags = pytest.importorskip("rosbags.highlevel")
    for name, has_odometry in (("f1tenth", True), ("frc_swerve_mk4i", False)):
        folder = tmp_path / name
        assert run(["simulate", name, "--bag", str(folder)]) == 0
        scene = laconic.read_scene(name)
        end = laconic.simulate(scene, ["hinge_angle_rad", "hinge_rate_rad_per_s", "origin_x_m"])
        with rosbags.AnyReader([folder], default_typestore=store()) as bag:
            topics = {each.topic for each in bag.connections}
            last = {connection.topic: bag.deserialize(raw, connection.msgtype)
                    for connection, _, raw in bag.messages()}
        assert ("/odom" in topics) == has_odometry
        joints, count = last["/joint_states"], scene.wheel_count
        assert list(joints.name[count:]) == [f"{hinge.name}_hinge_joint" for hinge in scene.hinges]
        assert np.array_equal(joints.position[count:], end.columns_of("hinge_angle_rad")[-1])
        assert np.array_equal(joints.velocity[count:], end.columns_of("hinge_rate_rad_per_s")[-1])
        if has_odometry:
            assert last["/odom"].pose.pose.position.x == pytest.approx(end.columns["origin_x_m"][-1], abs=1e-3)


def test_joints_of_hinges_have_one_name_in_bags_and_on_ros_2_and_the_base_of_the_scene_may_give_others() -> None:
    assert joint_names(None, 1, ["fork"]) == ["wheel_1_joint", "fork_hinge_joint"]
    for given, found in ((("left",), ["left", "fork_hinge_joint"]), (("left", "swivel"), ["left", "swivel"])):
        assert joint_names(BaseTable(joint_names=given), 1, ["fork"]) == found


def test_verify_of_a_scene_and_enclosures_refuse_hinges(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["verify", "f1tenth", "--enclose"], ["verify", str(REFERENCE), "--enclose"]):
        status, _, why = told(arguments, capsys)
        assert status == 2 and ("hinges" in why) and why.count("\n") == 1


@pytest.mark.parametrize("name", HINGED)
def test_functions_of_the_package_that_know_no_hinges_refuse_them(name: str) -> None:
    from laconic.scene.ground import check_ideal_ground
    from laconic.scene.standing import standing_of
    from laconic.tools.enclosure.readings import check_enclosable
    from laconic.tools.verify.reference import Reference

    scene = laconic.read_scene(name)
    calls = (lambda: laconic.Vehicle.of(scene), lambda: laconic.Vehicle(scene.vehicle), lambda: laconic.analyse(scene),
             lambda: scene.plant(scene.core()),
             lambda: scene.model(scene.core()), lambda: scene.c_start(scene.core()), lambda: standing_of(scene),
             lambda: Reference(scene.vehicle), lambda: check_enclosable(scene),
             lambda: check_ideal_ground(scene, "derive"))
    for call in calls:
        with pytest.raises(BadInput, match="hinges"):
            call()


def test_limits_that_held_a_command_back_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    turn = {"signal": "steering_angle_rad", "kind": "steps", "t_s": [1.0], "value": [0.6]}
    tables = tables_of("f1tenth", input=[*held(voltage_V__1=2.0, voltage_V__2=2.0), turn])
    path = tmp_path / "car.toml"
    path.write_text("\n".join(lines_of(tables, {})), encoding="utf-8")
    status, _, warning = told(["simulate", str(path)], capsys)
    assert status == 0 and "front_left: the limit of its angle held the command back" in warning
    assert "front_left: the limit of its rate held the command back for" in warning


def test_a_trailer_that_folds_is_an_event_of_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "folds.toml"
    scene.write_text("""[vehicle]
mass_kg = 20.0
yaw_inertia_kgm2 = 0.8
wheel_radius_m = 0.08
wheel_inertia_kgm2 = 0.0
[[vehicle.wheel]]
kind = "fixed"
x_m = 0.0
y_m = 0.2
axle_deg = -90.0
[[vehicle.trailer]]
name = "cart"
hitch_x_m = -0.3
length_m = 0.8
track_m = 0.4
radius_m = 0.1
start_angle_deg = 20.0
[initial]
velocity_body_m_per_s = [-0.8, 0.0]
[run]
duration_s = 5.0
step_s = 0.01
""", encoding="utf-8")
    status, _, why = told(["simulate", str(scene)], capsys)
    assert status == 0 and "cart folds: its hinge angle is beyond 90° from t = " in why and "stop_low_deg" in why
    status, text, _ = told(["simulate", str(scene), "--json"], capsys)
    (fold,) = json.loads(text)["folded"]
    assert fold["hinge"] == "cart" and 1.7 < fold["first_s"] < 1.8 and fold["most_rad"] > 3.0
    ahead = scene.read_text(encoding="utf-8").replace("[-0.8, 0.0]", "[0.8, 0.0]")
    scene.write_text(ahead, encoding="utf-8")
    assert "folds" not in told(["simulate", str(scene)], capsys)[2]


def test_commands_that_the_fmu_of_hinges_does_not_take_are_named_with_those_that_it_takes() -> None:
    assert "in place of steering_curvature_per_m give steering_twist" in left_out(
        laconic.build_scene(tables_of("f1tenth", input=held(steering_curvature_per_m=0.2))))
    tables = two_wheels()
    tables["vehicle"]["wheel"].append({"kind": "fixed", "x_m": 0.5, "y_m": 0.0, "steered": "prescribed",
                                       "name": "front", "driven": False, "rate_limit_rad_per_s": 1.0})
    told_of = left_out(laconic.build_scene(tables | {"input": held(steering_angle_rad__front=0.2)}))
    assert "the FMU does not limit angle and rate of front; do so in your controller" in told_of
    assert "in place of steering_angle_rad[front] give" in told_of
    assert "give steering_rate_rad_per_s of prescribed hinges" in told_of


def test_the_line_about_an_fmu_of_a_car_is_short_and_names_only_inputs_that_it_has() -> None:
    line = left_out(laconic.read_scene("f1tenth"))
    assert "in place of steering_angle_rad give steering_twist and steering_twist_rate" in line
    assert "prescribed" not in line and len(line.partition(": ")[2]) <= 200


def test_a_run_that_is_refused_on_the_way_keeps_what_was_before(tmp_path: Path) -> None:
    tables = two_wheels(caster=[{**CASTER, "start_angle_rad": 0.01, "stop_low_rad": -1.0, "stop_high_rad": 1.0}])
    scene = scene_with(tables, initial={"velocity_body_m_per_s": [-0.8, 0.0]})
    with pytest.raises(laconic.RunRefused, match=r"caster\[1\] \(caster_1\): comes to its stop at 1 rad") as why:
        laconic.simulate(scene)
    run_ = why.value.run
    assert 0.2 < run_.time_s[-1] < 0.4 and run_.columns["hinge_angle_rad[caster_1]"][-1] <= 1.0
