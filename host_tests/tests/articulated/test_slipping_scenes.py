"""Scenes with hinges on ground with friction: what people give and what a run shows.

`laconic verify` of references of vehicles with hinges on ground with friction.
"""

from __future__ import annotations

import copy
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from hinge_scenes import CASTER, HINGED, WHEEL, held, tables_of, two_wheels

from laconic import SlippingVehicle, Trajectory, build_scene, plot, simulate
from laconic.cli.commands.verify import command
from laconic.cli.main import run
from laconic.core.slipping import SlipWatch
from laconic.errors import BadInput, Refused

GROUND = {"friction_coefficient": 0.7}
SERVO = {"servo_gain_Nm_per_rad": 60.0, "servo_damping_Nms": 1.5, "servo_limit_Nm": 3.0}
STEERED = {**WHEEL, "x_m": 0.5, "y_m": 0.0, "steered": "servo", "name": "front", "driven": False, "mass_kg": 1.0,
           "yaw_inertia_kgm2": 0.01, **SERVO}
HEAVY_CASTER = {**CASTER, "wheel_inertia_kgm2": 5e-5, "mass_kg": 0.4, "yaw_inertia_kgm2": 4e-4, "name": "front"}


def shortened(tables: dict[str, Any], duration_s: float = 3.0) -> dict[str, Any]:
    """Tables of a shorter run, without what lies beyond its end."""
    inputs = []
    for each in tables.get("input", []):
        count = sum(t <= duration_s for t in each.get("t_s", [0.0]))
        kept = count + (each["kind"] == "table")
        if count:
            inputs.append({key: value[:kept] if key in ("t_s", "value") else value for key, value in each.items()})
    return tables | {"input": inputs, "run": {"duration_s": duration_s, "step_s": 0.005}}


def slipping(name: str, duration_s: float = 3.0) -> dict[str, Any]:
    """A scene of the project on ground with friction."""
    tables = tables_of(name)
    friction = tables["vehicle"].pop("friction_coefficient", 0.8)
    return shortened(tables, duration_s) | {"ground": {"friction_coefficient": friction}}


def carriage(**vehicle: Any) -> dict[str, Any]:
    """Two wheels with inertia, without which a wheel that slips has no speed of its own."""
    return two_wheels(wheel_inertia_kgm2=0.01, **vehicle)


def tricycle(steered: dict[str, Any] | None = None, **tables: Any) -> dict[str, Any]:
    entries = carriage() | {"ground": dict(GROUND)} | tables
    entries["vehicle"] |= {"motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.3, "com_x_m": 0.15, "com_z_m": 0.1}
    entries["vehicle"]["wheel"].append({**STEERED, **(steered or {})})
    return entries


def ran(tables: dict[str, Any]) -> Trajectory:
    return simulate(build_scene(copy.deepcopy(tables)))


def last(run: Trajectory, name: str) -> float:
    return float(run.columns[name][-1])


def fails(tables: dict[str, Any], *words: str) -> None:
    with pytest.raises((BadInput, Refused)) as why:
        ran(tables)
    text = str(why.value)
    assert "\n" not in text
    for word in words:
        assert word in text, text


@pytest.mark.parametrize("name", HINGED)
def test_each_robot_of_the_project_moves_as_on_ideal_ground_where_it_grips(name: str) -> None:
    gone, there = ran(shortened(tables_of(name))), ran(slipping(name))
    for key in ("x_m", "y_m"):
        assert abs(last(gone, key) - last(there, key)) <= 0.03


@pytest.mark.parametrize("name", ["frc_swerve_mk4i", "tugger_train", "tricycle_agv"])
def test_the_book_of_energy_closes_at_every_row(name: str) -> None:
    found = ran(slipping(name)).columns
    came = sum(found[key] for key in ("supply_energy_J", "outer_work_J", "servo_work_J"))
    gone = sum(column for key, column in found.items() if key.endswith("_loss_J"))
    book = found["energy_J"] + found["spring_energy_J"] - came + gone
    assert np.ptp(book) <= 1e-7 * max(1.0, float(np.abs(came).max()))


def test_a_servo_turns_a_wheel_to_the_commanded_angle_and_no_further_than_its_torque_allows() -> None:
    command = {"input": held(steering_angle_rad__front=0.3), "run": {"duration_s": 2.0, "step_s": 1e-3}}
    strong, weak = (ran(tricycle({"servo_limit_Nm": limit, "dry_friction_Nm": 0.5}, **command))
                    for limit in (3.0, 0.4))
    assert abs(last(strong, "hinge_angle_rad[front]") - 0.3) < 0.02
    assert last(weak, "hinge_angle_rad[front]") < 0.1
    assert np.abs(weak.columns["hinge_reaction_Nm[front]"]).max() <= 0.4 + 1e-12


def test_a_rate_limit_holds_a_servos_command_back_and_is_reported() -> None:
    run = ran(tricycle({"rate_limit_rad_per_s": 0.2}, input=held(steering_angle_rad__front=0.3)))
    assert run.limited and run.limited[0].limit == "rate"
    assert last(run, "hinge_angle_rad[front]") < 0.11


def test_a_prescribed_wheel_follows_its_angle() -> None:
    keys = {"steered": "prescribed", "rate_limit_rad_per_s": 1.0, "at_limit": "saturate"}
    tables = tricycle(keys, input=held(steering_angle_rad__front=0.2), run={"duration_s": 1.0, "step_s": 1e-3})
    for key in SERVO:
        del tables["vehicle"]["wheel"][2][key]
    assert abs(last(ran(tables), "hinge_angle_rad[front]") - 0.2) < 1e-9


def test_a_stop_holds_a_caster_that_would_turn_past_it() -> None:
    tables = carriage(caster=[{**HEAVY_CASTER, "start_angle_rad": 0.1, "stop_low_rad": -0.5, "stop_high_rad": 0.5}])
    tables |= {"ground": GROUND, "initial": {"velocity_body_m_per_s": [-0.8, 0.0]}}
    angles = ran(tables).columns["hinge_angle_rad[front]"]
    assert angles.max() == pytest.approx(0.5, abs=1e-6)


def test_a_trailer_jackknifes_in_reverse_only_where_nothing_holds_it() -> None:
    trailer = {"name": "cart", "hitch_x_m": -0.3, "length_m": 0.8, "track_m": 0.4, "radius_m": 0.1,
               "wheel_inertia_kgm2": 0.01, "mass_kg": 10.0, "yaw_inertia_kgm2": 0.5, "start_angle_rad": 0.05}
    tables = carriage(trailer=[trailer]) | {"ground": GROUND, "run": {"duration_s": 3.0, "step_s": 1e-3}}
    tables["initial"] = {"velocity_body_m_per_s": [-1.0, 0.0]}
    assert abs(last(ran(tables), "hinge_angle_rad[cart]")) > 0.5  # from 0.05
    tables["vehicle"]["trailer"][0]["dry_friction_Nm"] = 200.0
    held_run = ran(tables)
    assert abs(last(held_run, "hinge_angle_rad[cart]")) < 0.1 and held_run.folded == ()
    tables["vehicle"]["trailer"][0] |= {"dry_friction_Nm": 0.0, "start_angle_rad": 1.5}
    assert [fold.hinge for fold in ran(tables).folded] == ["cart"]


def test_creep_widens_a_turn() -> None:
    command = {"input": held(steering_angle_rad__front=0.3), "run": {"duration_s": 1.0, "step_s": 1e-3}}
    stiff, soft = (abs(last(ran(tricycle({"creep": creep}, **command)), "heading_rad")) for creep in (0.0, 0.3))
    assert soft < 0.97 * stiff


def test_a_position_loop_samples_at_its_own_period() -> None:
    motor = {"steered": "motor", "steering_gain_Nm_per_V": 0.5, "steering_damping_Nms": 0.2, "loop_V_per_rad": 40.0,
             "loop_Vs_per_rad": 2.0, "control_period_s": 0.01}
    tables = tricycle(motor, input=held(steering_angle_rad__front=0.2), run={"duration_s": 2.0, "step_s": 1e-3})
    for key in SERVO:
        del tables["vehicle"]["wheel"][2][key]
    assert abs(last(ran(tables), "hinge_angle_rad[front]") - 0.2) < 0.01
    tables["vehicle"]["wheel"][2]["control_period_s"] = 0.0015
    fails(tables, "vehicle.wheel[3].control_period_s", "no whole number of steps")


def test_the_supply_limits_motors_of_wheels_and_of_steering() -> None:
    tables = slipping("tricycle_agv", 10.0)
    tables["vehicle"]["drive"] = {"supply_V": 6.0, "supply_resistance_ohm": 0.05}
    tables["outputs"] = {"signals": ["supply_voltage_V", "drive_limit", "hinge_current_A", "hinge_drive_limit"]}
    found = ran(tables).columns
    assert found["drive_limit[1]"].max() == 1.0 and found["supply_voltage_V"][1:].min() < 6.0


def test_the_ground_pushes_to_the_left_in_a_left_turn_with_friction_as_on_ideal_ground() -> None:
    turns = held(**{"voltage_V[1]": 2.0, "voltage_V[2]": 2.0})
    tables = tricycle({"steered": "prescribed", "start_angle_rad": 0.2}, input=turns,
                      run={"duration_s": 2.0, "step_s": 0.002}, outputs={"signals": ["wheel_lateral_N"]})
    for key in SERVO:
        tables["vehicle"]["wheel"][2].pop(key)
    tables.pop("initial", None)
    ideal = {key: value for key, value in tables.items() if key != "ground"}
    grips, holds = ran(tables | {"ground": {"friction_coefficient": 3.0}}), ran(ideal)
    sums = [sum(last(each, f"wheel_lateral_N[{i}]") for i in (1, 2, 3)) for each in (grips, holds)]
    assert sums[1] < -0.1
    assert sums[0] == pytest.approx(sums[1], rel=0.02)


@pytest.mark.parametrize("name", ["swerve_module_off", "f1tenth"])
def test_forces_along_and_lateral_against_the_slips_take_the_energy_that_slip_loses(name: str) -> None:
    tables = shortened(tables_of(name), 1.0) if "ground" in tables_of(name) else slipping(name, 1.0)
    tables["ground"]["friction_coefficient"] = 0.2
    tables["outputs"] = {"signals": ["wheel_reaction_N", "wheel_lateral_N", "slip_along_m_per_s",
                                     "slip_across_m_per_s", "slip_loss_J"]}
    found = ran(tables)
    along, right, slip, slip_left = (found.columns_of(each) for each in tables["outputs"]["signals"][:4])
    taken_J = found.scene.run.step_s * np.sum(right * slip_left - along * slip)
    assert last(found, "slip_loss_J") > 0.01
    assert taken_J == pytest.approx(last(found, "slip_loss_J"), rel=1e-3)


def test_a_run_names_the_wheels_that_slipped(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["simulate", "swerve_module_off"]) == 0
    told = capsys.readouterr().out
    both = r"\(when: contact_state, slip_along_m_per_s, slip_across_m_per_s in \[outputs\]\)"
    assert re.search(rf"J, wheels 1 and 2 slipped \([\d.]+ J, [\d.]+ J\) {both}", told)
    assert run(["simulate", "skid_steer"]) == 0
    assert re.search(rf"J, wheels 1, 2, 3 and 4 slipped \((?:[\d.]+ J, ){{3}}[\d.]+ J\) {both}",
                     capsys.readouterr().out)


@pytest.mark.parametrize("name", ["swerve_module_off", "trailer_on_ice", "skid_steer", "robotino_grey"])
def test_the_wheels_that_slip_are_listed_for_programs_with_the_energy_of_each(
        name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["simulate", name, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["no_slip"]
    assert found["holds"] is None and bool(found["slipping_wheels"]) == (name != "robotino_grey")
    each_J = found["wheel_slip_loss_J"]
    least_J = max(1e-6, 1e-3 * found["slip_loss_J"])
    assert found["slipping_wheels"] == [i + 1 for i, loss_J in enumerate(each_J) if loss_J > least_J]
    assert sum(each_J) == pytest.approx(found["slip_loss_J"], rel=1e-6, abs=1e-9)


def test_a_picture_shows_slip_loads_and_energy(tmp_path: Path) -> None:
    picture = plot(ran(tricycle()), tmp_path / "run.png")
    titles = " ".join(axes.get_title(loc="left") for axes in picture.axes)
    assert "Slip of each wheel" in titles and "Normal loads" in titles and "Energy" in titles


@pytest.mark.parametrize(("tables", "words"), [
    (tricycle({"servo_gain_Nm_per_rad": 0.0}), ("wheel[3].servo", "servo_gain_Nm_per_rad")),
    (tricycle({"loop_V_per_rad": 1.0}), ("wheel[3].loop_V_per_rad", "loop")),
    (tricycle({"scrub_fade_m": 0.1}), ("wheel[3].scrub_fade_m", "scrub_radius_m")),
    (tricycle({"creep": -0.1}), ("wheel[3].creep", "0 or more")),
    (tricycle({"load_N": 10.0}), ("wheel[1].load_N", "above 0")),
    (tricycle({"steered": "motor", "steering_gain_Nm_per_V": 1.0}), ("servo_gain_Nm_per_rad", "servo")),
    (tricycle(run={"duration_s": 0.1, "step_s": 1e-3, "method": "circle"}), ("run.method", "auto")),
    (tricycle(outputs={"signals": ["no_slip_margin_N"]}), ("no_slip_margin_N", "friction_coefficient")),
    (tricycle() | {"ground": {"slope_rad": 0.0}}, ("wheel[3].", "ground.friction_coefficient")),
    (tricycle(outputs={"signals": ["hinge_force_along_N"]}), ("hinge_force_along_N", "ideal ground")),
    (carriage(caster=[{**CASTER, "wheel_inertia_kgm2": 1e-4}]) | {"ground": GROUND}, ("caster[1]", "mass_kg")),
    (carriage(caster=[CASTER]) | {"ground": GROUND}, ("caster[1].wheel_inertia_kgm2", "above 0")),
    (carriage(caster=[{**HEAVY_CASTER, "servo_gain_Nm_per_rad": 1.0}]) | {"ground": GROUND}, ("caster[1].servo",)),
    (carriage(caster=[{**HEAVY_CASTER, "dry_friction_Nm": 1.0}]), ("caster[1].dry_friction_Nm", "ground.friction"))])
def test_what_contradicts_is_one_line_with_field_and_remedy(tables: dict[str, Any], words: tuple[str, ...]) -> None:
    fails(tables, *words)


def test_a_hinge_without_inertia_is_not_sent_to_a_trail_where_its_wheel_may_slip() -> None:
    bare = carriage(caster=[{**CASTER, "wheel_inertia_kgm2": 1e-4}]) | {"ground": GROUND}
    with pytest.raises(Refused) as caught:
        ran(bare)
    assert "trail" not in str(caught.value) and "yaw_inertia_kgm2" in str(caught.value)
    for key in ("mass_kg", "yaw_inertia_kgm2"):  # each of them is a remedy
        bare["vehicle"]["caster"][0] = {**CASTER, "wheel_inertia_kgm2": 1e-4, key: 0.1}
        assert ran(bare | {"run": {"duration_s": 0.01, "step_s": 0.005}}).refused is None


def test_wheels_without_hinges_refuse_scrub_and_creep() -> None:
    tables = carriage() | {"ground": GROUND}
    tables["vehicle"]["wheel"][0]["creep"] = 0.1
    fails(tables, "vehicle.wheel[1].creep", "hinges")


def test_python_reaches_the_vehicle_of_a_scene_and_a_copy_moves_by_itself() -> None:
    plant = SlippingVehicle.of(build_scene(tricycle())).plant(step_s=1e-3, velocity_m_per_s=[0.5, 0.0])
    other = copy.copy(plant)
    plant.run({"steering_angle_rad[front]": 0.2, "voltage_V[1]": 3.0}, steps=200)
    assert (plant.steps, other.steps) == (200, 0) and other.motion().x_m == 0.0
    saved, found = plant.save(), plant.outputs()
    plant.run(None, steps=50)
    plant.restore(saved, 200)
    assert plant.outputs().motion.x_m == found.motion.x_m
    assert found.normal_N.sum() == pytest.approx(21.0 * 9.80665, rel=1e-3) and math.isfinite(found.slip_loss_J)
    with pytest.raises(BadInput, match="steering_angle_rad"):
        plant.run({"steering_angle_rad[rear]": 0.1})


REFERENCE = Path(__file__).parents[1] / "data" / "articulated_friction_reference.json"
CASES: list[dict[str, Any]] = json.loads(REFERENCE.read_text(encoding="utf-8"))


def verified(path: Path, *options: str) -> dict[str, dict[str, Any]]:
    """The results by name."""
    result = CliRunner().invoke(command, [str(path), "--json", *options], standalone_mode=False)
    if result.exception:
        raise result.exception
    return {each["name"]: each for each in json.loads(result.stdout)["cases"]}


def errors(found: dict[str, Any]) -> list[float]:
    return [found["error_pose"], found["error_nu"], found["error_wheel"]]


def test_trajectories_are_within_twice_the_listed_errors_and_halve_with_the_step() -> None:
    coarse, fine = verified(REFERENCE, "--step", "0.001"), verified(REFERENCE, "--step", "0.0005")
    for case in (each for each in CASES if "segments" in each):
        listed = case["prototype_error_by_step_s"]["0.001"]
        assert coarse[case["name"]]["prototype_error"] == listed
        for found, halved, limit in zip(errors(coarse[case["name"]]), errors(fine[case["name"]]), listed, strict=True):
            assert found <= 2.0 * limit and 1.7 <= found / halved <= 2.3


def test_single_steps_keep_their_own_size_and_reach_their_bars() -> None:
    found = verified(REFERENCE, "--step", "0.02")["one_step"]
    assert found["error_energy_norm"] <= 1e-9 and found["error_hinge_rate"] <= 1e-8 and found["error_pose"] is None


def test_a_tolerance_decides_the_exit_status_and_single_precision_runs() -> None:
    run = CliRunner()
    for tolerance, status in (("1", 0), ("1e-6", 1)):
        given = [str(REFERENCE), "--tolerance", tolerance, "--real", "single"]
        assert run.invoke(command, given, standalone_mode=False).return_value == status


def broken(**changes: Any) -> list[dict[str, Any]]:
    case = copy.deepcopy(CASES[0])
    for path, value in changes.items():
        *above, key = path.split("__")
        target: Any = case
        for name in above:
            target = target[int(name)] if name.isdecimal() else target[name]
        target[key] = value
    return [case]


@pytest.mark.parametrize(("cases", "words"), [
    (broken(vehicle__bodies__1__parent=3), ("bodies[2].parent", "is 3")),
    (broken(vehicle__bodies__1__mass_kg="x"), ("bodies[2].mass_kg",)),
    (broken(vehicle__wheels__0__body=9), ("wheels[1].body", "is 9")),
    (broken(vehicle__wheels=[]), ("vehicle.wheels", "none")),
    (broken(start__z=[0.0]), ("start.z",)),
    (broken(segments__0__duration_s=-1.0), ("segments[1].duration_s", "above 0")),
    (broken(segments__0__voltage_V=[1.0]), ("segments[1].voltage_V",)),
    (broken(expected__x_m=None), ("expected.x_m",)),
    ([{**CASES[-1], "steps": [{"vehicle": "nothing"}]}], ("nothing",)), ([], ("cases",))])
def test_a_broken_file_is_one_line_with_its_field(tmp_path: Path, cases: list[dict[str, Any]], words: tuple[str, ...]
                                                  ) -> None:
    path = tmp_path / "broken.json"
    path.write_text(json.dumps(cases), encoding="utf-8")
    with pytest.raises(BadInput) as why:
        verified(path)
    assert "\n" not in str(why.value) and all(word in str(why.value) for word in (str(path), *words)), why.value


def test_a_method_of_ideal_ground_is_refused() -> None:
    with pytest.raises(BadInput, match="circle does not step"):
        verified(REFERENCE, "--method", "circle")


@pytest.mark.parametrize("name", ["tricycle_agv", "swerve_module_off"])
def test_the_origin_lies_beside_the_centre_of_mass(name: str) -> None:
    tables = tables_of(name)
    tables["vehicle"] |= {"com_x_m": 0.05, "com_y_m": 0.03}
    tables["initial"] = {"heading_deg": 40.0}
    run = simulate(build_scene(shortened(tables, 1.0)), ["x_m", "y_m", "heading_rad", "origin_x_m", "origin_y_m"])
    of = run.columns
    origin = of["x_m"] + 1j * of["y_m"] - np.exp(1j * of["heading_rad"]) * (0.05 + 0.03j)
    assert of["origin_x_m"] + 1j * of["origin_y_m"] == pytest.approx(origin, abs=1e-12)


def test_coordinated_wheels_turn_on_where_their_direction_comes_round() -> None:
    tables = tables_of("swerve_module_off")
    turn = {"steering_twist[1]": [0.5, 0.0, -0.5, 0.0, 0.5], "steering_twist[2]": [0.0, 0.5, 0.0, -0.5, 0.0]}
    tables |= {"input": [{"signal": signal, "kind": "table", "t_s": [0.0, 1.0, 2.0, 3.0, 4.0], "value": value}
                         for signal, value in turn.items()], "run": {"duration_s": 4.0, "step_s": 0.01}}
    angles = simulate(build_scene(tables), ["hinge_angle_rad"]).columns_of("hinge_angle_rad")
    assert np.abs(np.diff(angles, axis=0)).max() < 0.2
    assert angles[-1] - angles[0] == pytest.approx(2.0 * math.pi, abs=0.1)


def test_losses_of_wheels_are_those_of_the_book_though_the_step_changes() -> None:
    scene = build_scene(slipping("trailer_on_ice"))
    vehicle = SlippingVehicle.of(scene)
    plant = vehicle.plant(scene.run.method, 0.004, velocity_m_per_s=(3.0, 1.0), yaw_rate_rad_per_s=1.5)
    watch, rows = SlipWatch(plant), np.zeros((60, vehicle.input_row().size))
    for step_s in (0.004, 0.001):
        plant.set_step(step_s)
        plant.follow(rows, watch)
    found = plant.outputs()
    assert watch.loss_J.sum() == pytest.approx(found.slip_loss_J + found.scrub_loss_J, rel=1e-9)
    assert watch.loss_J.sum() > 1.0
