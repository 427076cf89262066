"""A run of a sweep has the bits of `laconic simulate` with the numbers set by hand; what no lane takes goes alone."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.errors import BadInput
from laconic.scene.methods import EXPLICIT, STIFF_4
from laconic.scene.scene_tables import scene_tables
from laconic.simulation import simulate
from laconic.tools.measures import measures_of
from laconic.tools.sweep import chunk
from laconic.tools.sweep.chunk import nominal_course, run_chunk
from laconic.tools.sweep.plan import make_plan

SHORT = {"run.duration_s": 3.0, "run.step_s": 0.01}
ENDS = ("end_x_m", "end_y_m", "end_heading_rad")
IN_LANES = [
    ("robotino2", ("vehicle.mass_kg=6:10:3", "vehicle.wheel[1].distance_m~normal(0.125,0.001)",
                   "vehicle.wheel[2].bearing_deg~normal(180,1)")),
    ("robotino2", ("vehicle.motor.resistance_ohm=5,7", "vehicle.motor.rotor_inertia_kgm2=1e-5:2e-5:2",
                   "vehicle.wheel[1].inertia_kgm2=0.001,0.002")),
    ("robotino2", ("vehicle.wheel[2].x_m=-0.13:-0.11:4", f"run.method=auto,{EXPLICIT},{STIFF_4}",
                   "run.real=double,single", "ground.slope_deg=0,3")),
    ("robotino2", ("initial.velocity_body_m_per_s[1]=0:1:2", "initial.yaw_rate_rad_per_s=0,1",
                   "initial.heading_deg=0,30")),
    ("robotino2", ("input[1].value[2]=1:3:3", "input[*].value[1]=-1,1", "vehicle.wheel[*].axle_deg=0,1")),
    ("turtlebot3_burger", ("vehicle.mass_kg=0.5,1.5", "vehicle.wheel[1].radius_m=0.03:0.034:2",
                           "vehicle.com_x_m=-0.02,0.02")),
    ("kuka_youbot", ("vehicle.mass_kg=20:30:4", "vehicle.wheel[*].roller_deg=40,45"))]


def of(scene, vary, measures=ENDS, samples=3):
    tables = scene_tables("robotino2" if scene == "sensors" else scene)
    if scene == "sensors":
        tables.entries["sensors"] = {"imu": {"delay_s": 0.03}}
        scene = "robotino2"
    is_random = any("~" in each for each in vary)
    plan = make_plan(shortened(tables) if scene == "robotino2" else tables, vary, measures,
                     samples=samples if is_random else None)
    return plan, plan.values(0, plan.runs)


def shortened(tables):
    """Three seconds, with the first change of the voltages alone."""
    entries = tables.with_values(SHORT).entries
    for each in entries["input"]:
        each["t_s"], each["value"] = each["t_s"][:2], each["value"][:2]
    entries["outputs"]["every_s"] = 0.1
    return type(tables)(tables.path, entries)


@pytest.mark.parametrize(("scene", "vary"), IN_LANES)
def test_runs_side_by_side_have_the_bits_of_simulate(monkeypatch, scene, vary):
    plan, values = of(scene, vary)
    monkeypatch.setattr(chunk, "run_alone", lambda *_: pytest.fail("this run must go in a lane"))
    rows = run_chunk(plan, None, values)
    for place in range(0, plan.runs, max(1, plan.runs // 5)):
        run = simulate(plan.tables.with_values(plan.of_run(place)).scene(), ("x_m", "y_m", "heading_rad"))
        end = [run.columns[name][-1] for name in ("x_m", "y_m", "heading_rad")]
        assert rows.measures[:, place].tolist() == end


def test_every_measure_has_the_same_bits_in_a_lane_and_alone(monkeypatch):
    names = tuple(name for name, measure in measures_of("run").items() if measure.needs != "supply")
    plan, values = of("robotino2", ("vehicle.mass_kg=6:10:3", "vehicle.motor.resistance_ohm=5,7"), names)
    nominal = nominal_course(plan)
    in_lanes = run_chunk(plan, nominal, values)
    monkeypatch.setattr(chunk, "FEWEST_LANES", 10**9)
    alone = run_chunk(plan, nominal, values)
    assert in_lanes.measures.tobytes() == alone.measures.tobytes()
    assert np.isfinite(in_lanes.measures[:, 0]).sum() >= len(names) - 1


def why_not(plan, place) -> str:
    """The words in which `laconic simulate` refuses a run; empty where it takes it."""
    try:
        simulate(plan.tables.with_values(plan.of_run(place)).scene(), ("x_m",))
    except BadInput as refused:
        return str(refused)
    return ""


@pytest.mark.parametrize(("scene", "vary"), [
    ("paper_caster", ("vehicle.mass_kg=-1,0,2,3,4,5",)),                          # refused by the core
    ("robotino2", ("vehicle.wheel[1].radius_m=-0.01,0,0.03,0.035,0.04,0.045",)),  # refused by the reader
    ("robotino2", ("run.step_s=0.01,0.03", "vehicle.mass_kg=6,7,8,9")),           # too long for the changes of inputs
    ("robotino2", ("vehicle.motor.gear_ratio=0,8,9,10,12",)),
    ("sensors", ("vehicle.mass_kg=6,7,8,9", "run.step_s=0.01,0.02"))])  # of which the IMU's delay is no whole number
def test_a_run_that_is_refused_says_why_as_simulate_does_and_the_others_go_on(scene, vary):
    plan, values = of(scene, vary)
    rows = run_chunk(plan, None, values)
    for place in range(plan.runs):
        why = why_not(plan, place)
        assert np.isnan(rows.measures[:, place]).tolist() == [bool(why)] * 3
        assert rows.reasons[place].reason in why if why else place not in rows.reasons
    assert 0 < len(rows.reasons) < plan.runs


def test_a_step_that_is_refused_on_the_way_says_when():
    tables = scene_tables("paper_caster").with_values({"run.method": EXPLICIT})
    plan = make_plan(tables, ("initial.velocity_body_m_per_s[1]=1e155,1e200,1,2,3,1e306",), ())
    rows = run_chunk(plan, None, plan.values(0, plan.runs))
    late = [reason for reason in rows.reasons.values() if reason.at_s is not None]
    assert rows.reasons
    assert all("at t = " in reason.reason for reason in late)
    assert np.isfinite(rows.measures[:, 2:5]).all()


def test_ground_friction_and_sampled_inputs_go_alone_with_the_same_results(monkeypatch):
    tables = shortened(scene_tables("robotino2"))
    del tables.entries["vehicle"]["friction_coefficient"]
    plan = make_plan(tables, ("ground.friction_coefficient=0.02:0.4:3", "vehicle.mass_kg=6,8"), ENDS)
    rows = run_chunk(plan, None, plan.values(0, plan.runs))
    run = simulate(plan.tables.with_values(plan.of_run(3)).scene(), ("x_m",))
    assert rows.measures[0, 3] == run.columns["x_m"][-1]
    assert np.isfinite(rows.measures).all()
    tables.entries["input"].append({"signal": "body_moment_Nm", "kind": "sine", "amplitude": 0.1, "frequency_Hz": 1.0})
    plan = make_plan(tables, ("vehicle.mass_kg=6:8:4", "input[4].amplitude=0,0.2"), ENDS)
    rows = run_chunk(plan, None, plan.values(0, plan.runs))
    run = simulate(plan.tables.with_values(plan.of_run(5)).scene(), ("y_m",))
    assert rows.measures[1, 5] == run.columns["y_m"][-1]
