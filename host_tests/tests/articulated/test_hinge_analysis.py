"""`laconic analyse` of vehicles with hinges: turns, limits and growth rates that a hand calculation gives, too."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hinge_scenes import CASTER, HINGED, scene_with, tables_of, two_wheels

import laconic
from laconic.cli.main import run
from laconic.core.articulated import ArticulatedPlant
from laconic.errors import BadInput
from laconic.tools.analyse.hinged import HingedStudy, study_hinges

TRAILER = {"name": "cart", "hitch_x_m": -0.3, "length_m": 0.9, "track_m": 0.4, "radius_m": 0.08}


def study(vehicle: dict[str, Any], **options: Any) -> HingedStudy:
    return study_hinges(scene_with(two_wheels(**vehicle)), **options)


def body(found: HingedStudy, name: str, turn: int = 0) -> Any:
    names = [limb.hinge.name for limb in found.tree.limbs]
    return found.turns[turn].circles[names.index(name)]


@pytest.mark.parametrize("name", HINGED)
def test_each_robot_with_hinges_has_turns_and_growth_rates_that_the_core_confirms(name: str) -> None:
    found = study_hinges(laconic.read_scene(name))
    assert found.failures == [] and found.turns[0].confirmed
    assert [each.speed_m_per_s for each in found.straight] == [1.0, -1.0]
    assert all(each.eigenvalues_per_s and each.agrees for each in found.straight)


def test_a_small_angle_of_a_caster_decays_at_speed_over_trail_and_grows_so_in_reverse() -> None:
    ahead, back = study({"caster": [CASTER]}, speeds_m_per_s=(0.8, -0.8)).straight
    assert ahead.growth_per_s == pytest.approx((-16.0,)) and back.growth_per_s == pytest.approx((16.0,))
    assert ahead.core_growth_per_s == pytest.approx((-16.0,), rel=1e-9)
    assert any(abs(z + 16.0) < 1e-6 for z in ahead.eigenvalues_per_s)  # massless: the carriage does not feel it
    assert back.eigenvalues_per_s[0] == pytest.approx(16.0, abs=1e-6)


def test_trailers_grow_in_reverse_at_speed_over_length_whatever_their_hitch_even_several_alike() -> None:
    found = study_hinges(laconic.read_scene("tugger_train"), speeds_m_per_s=(1.3, -1.3))
    assert found.straight[0].growth_per_s[1:] == pytest.approx((-1.0, -1.0, -1.0))
    assert found.straight[1].eigenvalues_per_s[:3] == pytest.approx([1.0, 1.0, 1.0], abs=1e-6)


def test_the_largest_eigenvalue_is_the_growth_of_a_simulation_with_a_heavy_caster() -> None:
    heavy = {**CASTER, "mass_kg": 6.0, "yaw_inertia_kgm2": 0.02}
    back = study({"caster": [heavy]}, speeds_m_per_s=(-0.8,)).straight[0]
    assert back.eigenvalues_per_s[0].real < 15.5  # not that of the held carriage
    run_ = laconic.simulate(scene_with(two_wheels(caster=[{**heavy, "start_angle_rad": 1e-8}]), run={
        "duration_s": 0.8, "step_s": 0.001}, initial={"velocity_body_m_per_s": [-0.8, 0.0]}))
    angles = run_.columns["hinge_angle_rad[caster_1]"]
    growth = math.log(angles[800] / angles[600]) / 0.2
    assert back.eigenvalues_per_s[0].real == pytest.approx(growth, rel=1e-3)


def test_motors_are_held_at_their_speed_and_what_holds_them_is_reported() -> None:
    chair = study_hinges(laconic.read_scene("wheelchair"), speeds_m_per_s=(1.0,)).straight[0]
    damping = 32.0**2 * (0.06**2 / 0.2 + 3e-4)
    assert chair.held_by == pytest.approx((2 * damping / 0.159**2, 0.0, 0.0), abs=1e-6)


def test_a_trailer_runs_on_the_circle_of_its_length_and_hitch() -> None:
    found = study({"trailer": [TRAILER]}, curvatures_per_m=(0.5, -0.25))
    radius = math.sqrt(2.0**2 + 0.3**2 - 0.9**2)
    assert body(found, "cart").radius_m == pytest.approx(radius)
    assert body(found, "cart").angle_rad == pytest.approx(-(math.atan(0.3 / 2.0) + math.atan(0.9 / radius)))
    assert body(found, "cart", 1).radius_m == pytest.approx(math.sqrt(4.0**2 + 0.3**2 - 0.9**2))
    assert body(found, "cart", 1).angle_rad > 0.0 and [turn.confirmed for turn in found.turns] == [True, True]


def test_a_trailer_folds_where_its_circle_has_no_radius_left() -> None:
    found = study({"trailer": [{**TRAILER, "hitch_x_m": 0.0}]}, curvatures_per_m=(1.0, 1.2))
    assert found.limits["left"][0] == found.limits["right"][0] == pytest.approx(1.0 / 0.9)
    assert "cart folds" in found.limits["left"][1]
    assert found.turns[0].confirmed and found.turns[1].confirmed is None
    assert "no steady turn: cart folds" in found.words["turns"][1]
    train = study_hinges(laconic.read_scene("tugger_train"))
    assert 1.0 / train.limits["left"][0] == pytest.approx(math.sqrt(3.0 * (1.3**2 - 0.5**2)))


def test_a_caster_in_a_turn_decays_slower_and_near_the_centre_it_turns_for_ever() -> None:
    found = study({"caster": [CASTER, {**CASTER, "name": "near", "x_m": 0.03}]}, curvatures_per_m=(1.0, math.inf))
    q = math.hypot(1.0, 0.3)
    assert body(found, "caster_1").growth == pytest.approx(-math.sqrt((q / 0.05)**2 - 1.0))
    assert body(found, "near", 1).period == pytest.approx(2.0 * math.pi / math.sqrt(1.0 - (0.03 / 0.05)**2))
    assert math.isinf(found.limits["left"][0])  # which does not end the turn
    assert "near turns for ever, once in 7.854 s at 1 rad/s" in found.words["turns"][1]


def test_the_car_is_limited_by_its_inner_wheel_and_steered_wheels_share_one_centre() -> None:
    found = study_hinges(laconic.read_scene("f1tenth"), curvatures_per_m=(math.tan(0.3) / 0.3302,))
    assert 1.0 / found.limits["left"][0] == pytest.approx(0.3302 / math.tan(0.4189) + 0.118)
    assert "front_left comes to its stop" in found.limits["left"][1] and "front_right" in found.limits["right"][1]
    left, right = body(found, "front_left").angle_rad, body(found, "front_right").angle_rad
    assert 1.0 / math.tan(right) - 1.0 / math.tan(left) == pytest.approx(0.236 / 0.3302)


@pytest.mark.parametrize(("scene", "name", "angle", "radius"), [
    ("tricycle_agv", "front", 0.4, 1.4 / math.tan(0.4)), ("tugger_train", "front", -0.3, 1.1 / math.tan(0.3)),
    ("wheel_loader", "rear", -0.6, 1.15 * (1.0 + math.cos(0.6)) / math.sin(0.6))])
def test_a_steering_angle_gives_the_circle_of_the_carriage(scene: str, name: str, angle: float, radius: float) -> None:
    turn = study_hinges(laconic.read_scene(scene), steering=((name, angle),)).turns[0]
    assert turn.radius_m == pytest.approx(radius) and turn.confirmed
    assert (turn.curvature_per_m > 0.0) == (angle > 0.0 if scene != "wheel_loader" else angle < 0.0)


def test_a_wheel_turned_by_more_than_a_right_angle_is_said_to_roll_as_one_that_is_not() -> None:
    asked = study_hinges(laconic.read_scene("f1tenth"), steering=(("front_left", 0.3), ("front_left", 0.3 + math.pi)))
    first, second = asked.turns
    assert first.asked == "front_left at 17.19°"
    assert second.asked == "front_left at 197.2°, where it rolls as at 17.19°"
    assert second.radius_m == pytest.approx(first.radius_m)


def test_a_carriage_on_wheels_off_the_first_axis_goes_straight_along_them() -> None:
    tables = two_wheels(caster=[CASTER])
    for wheel in tables["vehicle"]["wheel"]:
        wheel |= {"axle_deg": 0.0, "x_m": wheel["y_m"], "y_m": 0.0}  # rolls to its left
    found = study_hinges(scene_with(tables, initial={}), speeds_m_per_s=(0.8,))
    assert found.tree.straight == 1j and found.straight[0].growth_per_s == pytest.approx((-16.0,))
    assert np.isfinite(found.straight[0].eigenvalues_per_s).all() and found.failures == []


def test_a_law_that_the_core_does_not_confirm_is_a_failure(monkeypatch: pytest.MonkeyPatch,
                                                           capsys: pytest.CaptureFixture[str]) -> None:
    from laconic.tools.analyse import hinged

    straight = hinged.straight_motion
    monkeypatch.setattr(hinged, "straight_motion", lambda *given: replace(straight(*given), growth_per_s=(-1.0,) * 2))
    assert run(["analyse", "wheelchair", "--speed", "2"]) == 1
    out, why = capsys.readouterr()
    assert "## Not confirmed" in out and "straight motion at 2 m/s" in why


def test_the_command_prints_text_and_numbers_and_writes_both(tmp_path: Path, capsys: pytest.CaptureFixture[str]
                                                             ) -> None:
    assert run(["analyse", "tugger_train", "--curvature", "0.25", "--speed", "-2", "-o", str(tmp_path), "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    assert numbers == json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert numbers["straight"][0]["growth_per_s"]["first"] == pytest.approx(2.0 / 1.3)
    assert numbers["turns"][0]["bodies"]["first"]["radius_m"] == pytest.approx(math.sqrt(16.0 + 0.25 - 1.69))
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "radius 4 m to the left" in text and "first grows at 1.5385/s" in text


@pytest.mark.parametrize(("arguments", "words"), [
    (["tugger_train", "--only", "steady"], "--only: has no meaning beside a scene with hinges; leave it out"),
    (["tugger_train", "--at", "1"], "--at: has no meaning beside a scene with hinges; leave it out"),
    (["s1", "--speed", "1"], "for vehicles with hinges"),
    (["tugger_train", "--steering", "fron", "0.1"], "did you mean front?"),
    (["tugger_train", "--steering", "first", "0.1"], "does not steer the carriage"),
    (["tugger_train", "--speed", "0"], "--speed: is 0"), (["tugger_train", "--speed", "nan"], "--speed"),
    (["tugger_train", "--curvature", "nan"], "--curvature")])
def test_options_that_make_no_sense_are_refused_in_one_line(arguments: list[str], words: str,
                                                           capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["analyse", *arguments]) == 2
    out, why = capsys.readouterr()
    assert out == "" and words in why and why.count("\n") == 1


def test_vehicles_that_have_no_such_motions_are_refused_with_the_remedy() -> None:
    with pytest.raises(BadInput, match=r"laconic\.analyse"):
        study_hinges(laconic.read_scene("s1"))
    held = two_wheels(caster=[CASTER])
    held["vehicle"]["wheel"][0]["locked"] = True
    with pytest.raises(BadInput, match=r"wheel\[1\].*locked"):
        study_hinges(scene_with(held, initial={}))


@pytest.mark.parametrize("kg", [0.0, 1.0])
@pytest.mark.parametrize("trail_m", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("turned_deg", [0.0, 40.0])
def test_a_short_trail_grows_by_its_law_and_leaves_the_carriage_its_neutral_motions(
        trail_m: float, kg: float, turned_deg: float) -> None:
    caster = {**CASTER, "trail_m": trail_m, "start_angle_deg": turned_deg} | ({"mass_kg": kg} if kg else {})
    found = study_hinges(scene_with(two_wheels(caster=[caster])), speeds_m_per_s=(1.0,))
    assert found.failures == []
    assert sorted(z.real for z in found.straight[0].eigenvalues_per_s) == pytest.approx([-1.0 / trail_m, 0.0, 0.0])


def test_a_motion_that_nothing_holds_is_refused_by_what_keeps_no_angle(monkeypatch: pytest.MonkeyPatch) -> None:
    rates = ArticulatedPlant.rates

    def swinging(plant: ArticulatedPlant, inputs: Any) -> Any:
        twist, twist_rate = rates(plant, inputs)
        return twist, twist_rate + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1e20]])

    monkeypatch.setattr(ArticulatedPlant, "rates", swinging)
    with pytest.raises(BadInput) as why:
        study_hinges(scene_with(two_wheels(caster=[{**CASTER, "trail_m": 1e-4}])), speeds_m_per_s=(1.0,))
    assert "vehicle.caster[1] (caster_1), whose wheels lie 0.0001 m from it, keeps no angle" in str(why.value)
    assert "longer trail" in str(why.value) and "--speed" not in str(why.value)


def test_a_slope_is_left_out_and_the_words_say_so() -> None:
    found = study_hinges(scene_with(tables_of("wheelchair"), ground={"slope_deg": 5.0}), speeds_m_per_s=(1.0,))
    assert "slope" in found.words["straight"][0]
    assert found.straight[0].held_by == study_hinges(laconic.read_scene("wheelchair"),
                                                     speeds_m_per_s=(1.0,)).straight[0].held_by


TURNED = {"yaw_inertia_kgm2": 0.01, "steering_gain_Nm_per_V": 1.0, "steering_damping_Nms": 1.0}
ARM = {"name": "arm", "hinge": "free", "hinge_x_m": 0.1, "mass_kg": 1.0, "yaw_inertia_kgm2": 0.1, "com_x_m": 0.2}


def steered(kind: str, name: str, x: float, y: float, **more: Any) -> dict[str, Any]:
    return {"kind": "fixed", "steered": kind, "name": name, "x_m": x, "y_m": y, **more}


@pytest.mark.parametrize("vehicle", [
    {"wheel": [steered("motor", "f", 0.3, 0.0, **TURNED), steered("motor", "r", -0.3, 0.0, **TURNED)]},
    {"wheel": [{"kind": "omni", "distance_m": 0.2, "bearing_deg": b, "axle_deg": b} for b in (0, 120, 240)],
     "trailer": [TRAILER], "caster": [{**CASTER, "mass_kg": 1.0}]},
    {"wheel": [], "trailer": [{**TRAILER, "mass_kg": 3.0}, {**TRAILER, "name": "ahead", "hitch_x_m": 0.3}]},
    {"wheel": [steered("coordinated", f"c{n}", x, y) for n, (x, y) in enumerate(
        ((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2)))], "trailer": [TRAILER], "caster": [CASTER]},
    {"body": [{**ARM, "hinge": "prescribed"}], "trailer": [{**TRAILER, "parent": "arm"}]},
    {"body": [ARM], "trailer": [{**TRAILER, "parent": "arm"}]},
    {"trailer": [TRAILER], "caster": [{**CASTER, "parent": "cart", "x_m": -0.2}]}],
    ids=["two motors", "omni", "no wheels", "swerve", "prescribed arm", "free arm", "caster on a trailer"])
def test_every_kind_of_tree_has_turns_and_growth_rates_that_the_core_confirms(vehicle: dict[str, Any]) -> None:
    found = study(vehicle, curvatures_per_m=(0.3, -0.3, math.inf, -math.inf))
    assert found.failures == [] and all(each.agrees for each in found.straight)
    assert json.loads(json.dumps(found.words)) == found.words
    unknown = [limb.hinge.name for limb in found.tree.limbs if body(found, limb.hinge.name).angle_rad is None]
    assert unknown == (["arm", "cart"] if vehicle.get("body") == [ARM] else [])
    assert found.turns[0].confirmed is (None if unknown else True)


def test_a_car_with_its_centre_of_mass_over_its_axle_turns_on_the_spot() -> None:
    wheels = [*two_wheels()["vehicle"]["wheel"], steered("coordinated", "l", 0.5, 0.2),
              steered("coordinated", "r", 0.5, -0.2)]
    turn = study({"wheel": wheels}, curvatures_per_m=(math.inf,)).turns[0]
    assert turn.confirmed and turn.circles[0].angle_rad == pytest.approx(math.atan2(0.5, -0.2))


def test_an_arm_on_a_spring_swings_as_fast_as_its_spring_and_inertia_say() -> None:
    tables = two_wheels(body=[{**ARM, "hinge_x_m": 0.0, "stiffness_Nm": 3.0}])
    tables["vehicle"] |= {"yaw_inertia_kgm2": 1e6, "mass_kg": 1e6}  # so that nothing but the arm moves
    found = study_hinges(scene_with(tables), speeds_m_per_s=(0.5,))
    swing = math.sqrt(3.0 / (0.1 + 1.0 * 0.2**2))
    assert found.straight[0].eigenvalues_per_s[0] == pytest.approx(complex(0.0, swing), abs=1e-4)


@pytest.mark.parametrize(("name", "curvature"), [("f1tenth", 0.5), ("tricycle_agv", 0.3), ("tugger_train", 0.2),
                                                 ("mir_like", 0.4), ("frc_swerve_mk4i", 0.5), ("pr2_base", 1.0)])
def test_the_voltages_of_a_turn_hold_its_speed_for_ten_seconds(name: str, curvature: float) -> None:
    scene = laconic.read_scene(name)
    turn = study_hinges(scene, curvatures_per_m=[curvature], speeds_m_per_s=[]).turns[0]
    assert turn.confirmed and turn.held_by_V
    vehicle = laconic.ArticulatedVehicle.of(scene)
    tree = study_hinges(scene, speeds_m_per_s=[]).tree
    velocity, omega = tree.twist(curvature)
    there = velocity + 1j * omega * tree.centre
    commands = {"steering_twist": [velocity.real, velocity.imag, omega]} if vehicle.is_coordinated else {}
    plant = vehicle.plant(velocity_m_per_s=(there.real, there.imag), yaw_rate_rad_per_s=omega, step_s=0.01,
                          hinge_angle_rad=[each.angle_rad for each in turn.circles], inputs=commands)
    before = plant.motion()
    plant.run({**commands, **turn.held_by_V}, steps=1000)
    after = plant.motion()
    assert after.velocity_m_per_s == pytest.approx(before.velocity_m_per_s, abs=1e-9)
    assert after.hinge_angle_rad == pytest.approx(before.hinge_angle_rad, abs=1e-9)
    assert abs(after.heading_rad - 10.0 * omega) < 1e-9
    assert f"voltage_V[{1 if 'voltage_V[1]' in turn.held_by_V else 3}] = " in " ".join(
        study_hinges(scene, curvatures_per_m=[curvature], speeds_m_per_s=[]).words["turns"])
