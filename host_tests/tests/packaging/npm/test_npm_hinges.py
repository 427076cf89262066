"""The npm package for vehicles with hinges: the core's bits, the command's scenes and limits, refusals, types."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomllib
from test_npm_package import FOLDER, SAMPLE, check_names, node, typechecked

from laconic import Scene, build_scene, read_scene, simulate
from laconic.base.paths import scene_path
from laconic.core import load
from laconic.core.articulated import method_names
from laconic.simulation.steering import angle_of, tangent_of

pytestmark = pytest.mark.skipif(shutil.which("node") is None or not FOLDER.is_dir(),
                                reason="needs node, and clang with wasm-ld for the package")

STEPS = 150
COMMANDS: dict[str, list[dict[str, Any]]] = {
    "f1tenth": [{"steering_angle_rad": 0.2}, {"steering_curvature_per_m": -0.9}],
    "frc_swerve_mk4i": [{"steering_twist": [1, 0.3, 0]}, {"steering_twist": [0, 1, 0.8]}],
    "mir_like": [{}, {"body_force_N": [3, 20]}],
    "pr2_base": [{"steering_twist": [1, 0, 0.5]}, {"steering_twist": [1, 1, 0]}],
    "tricycle_agv": [{"hinge_voltage_V": {"front": 5}}, {"hinge_torque_Nm": {"front": -4}}],
    "tugger_train": [{"steering_angle_rad": {"front": 0.4}}, {"steering_rate_rad_per_s": {"front": -0.2}}],
    "wheel_loader": [{"steering_rate_rad_per_s": {"rear": 0.9}}, {"steering_angle_rad": {"rear": 0.05}}],
    "wheelchair": [{}, {"world_force_N": [0, 30]}]}
"""Two inputs besides voltages, one after the other; those of cars, swerves and loaders meet limits."""

RUN = """
import { readFileSync } from "node:fs";
import { load } from "laconic-robots/hinges";
const laconic = await load();
const flat = ({ x_m, y_m, heading_rad, energy_J, velocity_body_m_per_s, yaw_rate_rad_per_s, hinge_angle_rad,
  hinge_rate_rad_per_s, body_x_m, body_y_m, body_heading_rad, wheel_speed_rad_per_s, wheel_angle_rad }) =>
  [[x_m, y_m, heading_rad, energy_J], velocity_body_m_per_s, [yaw_rate_rad_per_s], ...[hinge_angle_rad,
    hinge_rate_rad_per_s, body_x_m, body_y_m, body_heading_rad].map(Object.values), wheel_speed_rad_per_s,
    wheel_angle_rad].flat();
for (const { scene, inputs, steps } of JSON.parse(readFileSync("runs.json", "utf8"))) {
  const [one, many] = [0, 1].map(() => laconic.robot(scene, { step_s: 0.01 }));
  const made = [];
  for (const input of inputs) {
    for (const robot of [one, many]) robot.setInput(input);
    made.push([one.commands, []]);
    for (let k = 0; k < steps; k++) {
      one.run(1);
      made.at(-1)[1].push(one.commands);
    }
    many.run(steps);
  }
  const at = [one, many].map((robot) => flat(robot.outputs()));
  const { along_N, lateral_N, hinge_reaction_Nm } = one.reactions();
  console.log(JSON.stringify({ made, at, limited: one.limited, bodies: one.bodies,
    forces: [along_N, lateral_N, Object.values(hinge_reaction_Nm)] }));
}
"""


def plain(name: str) -> dict[str, Any]:
    """A scene's file, as a program reads it."""
    return tomllib.loads(scene_path(name).read_text(encoding="utf-8"))


def ran(runs: list[dict[str, Any]], folder: Path) -> list[dict[str, Any]]:
    (folder / "runs.json").write_text(json.dumps(runs), encoding="utf-8")
    return [json.loads(line) for line in node(RUN, folder).splitlines()]


def inputs_of(scene: Scene, given: list[dict[str, Any]]) -> list[dict[str, Any]]:
    volts = [(2.0 - 0.3 * k if wheel["driven"] else 0.0) * (10.0 if "hinge_x_m" in wheel else 1.0)
             for k, wheel in enumerate(scene.vehicle["wheel"])]
    return [{"voltage_V": volts, **each} for each in given]


def by_the_core(scene: Scene, inputs: list[dict[str, Any]], found: dict[str, Any]) -> tuple[list[float], list[Any]]:
    """Motion and forces of the core's vehicle under what the package's commands were, step by step."""
    robot = scene.articulated_vehicle(load("double"))
    twist = robot.slot("steering_twist")

    def row(given: dict[str, Any], commands: dict[str, Any]) -> np.ndarray:
        values: dict[str, Any] = {}
        for name, value in given.items():
            if name.startswith("hinge_"):
                values |= {f"{name}[{hinge}]": each for hinge, each in value.items()}
            elif not name.startswith("steering_"):
                values[name] = value
        values |= {f"steering_rate_rad_per_s[{hinge}]": each
                   for hinge, each in commands["steering_rate_rad_per_s"].items()}
        return robot.input_row(values | {"steering_twist": commands.get("steering_twist", [0.0, 0.0, 0.0])})

    start = row(inputs[0], found["made"][0][0])
    plant = robot.plant("auto", 0.01, inputs=start, hinge_angle_rad=[each.start_angle_rad for each in scene.hinges])
    acting = start
    for given, (_, steps) in zip(inputs, found["made"], strict=True):
        for commands in steps:
            first, acting = row(given, commands), row(given, commands)
            first[twist : twist + 3] = start[twist : twist + 3]
            plant.follow(np.array([[first, acting]]))
            start = acting
    m, forces = plant.motion(), plant.reactions(acting)
    motion = [m.x_m, m.y_m, m.heading_rad, m.energy_J, *m.velocity_m_per_s, m.yaw_rate_rad_per_s, *m.hinge_angle_rad,
              *m.hinge_rate_rad_per_s, *m.body_x_m, *m.body_y_m, *m.body_heading_rad, *m.wheel_speed_rad_per_s,
              *m.wheel_angle_rad]
    return [float(each) for each in motion], [[float(each) for each in some] for some in (
        forces.along_N, forces.lateral_N, forces.hinge_torque_Nm)]


def test_all_eight_scenes_have_the_bits_of_the_core_also_at_limits_of_their_commands(tmp_path):
    scenes = {name: read_scene(name) for name in COMMANDS}
    inputs = {name: inputs_of(scene, COMMANDS[name]) for name, scene in scenes.items()}
    found = ran([{"scene": plain(name), "inputs": inputs[name], "steps": STEPS} for name in scenes], tmp_path)
    for (name, scene), each in zip(scenes.items(), found, strict=True):
        motion, forces = by_the_core(scene, inputs[name], each)
        assert each["at"] == [motion, motion], name  # step by step, and many at once
        assert each["forces"] == forces, name
        assert each["bodies"] == [hinge.name for hinge in scene.hinges]
        assert (name in ("f1tenth", "frc_swerve_mk4i", "pr2_base", "tugger_train", "wheel_loader")) == bool(
            each["limited"]), name


WHEEL = {"kind": "fixed", "axle_deg": -90.0}
EVERY_FORM: dict[str, Any] = {"vehicle": {
    "mass_kg": 60.0, "yaw_inertia_kgm2": 4.0, "com_x_m": 0.1, "wheel_radius_m": 0.1, "wheel_inertia_kgm2": 0.004,
    "motor_gain_Nm_per_V": 0.8, "motor_damping_Nms": 0.5,
    "payload": {"mass_kg": 10.0, "x_m": 0.2, "y_m": 0.1, "yaw_inertia_kgm2": 0.3},
    "wheel": [{**WHEEL, "x_m": 0.0, "y_m": 0.3}, {**WHEEL, "x_m": 0.0, "y_m": -0.3, "radius_m": 0.1},
              {**WHEEL, "x_m": -0.5, "y_m": 0.0, "body": "tail", "driven": False}],
    "caster": [{"x_m": 0.5, "y_m": 0.2, "trail_m": 0.06, "radius_m": 0.05, "offset_m": 0.01, "twin_m": 0.03,
                "mass_kg": 1.0, "yaw_inertia_kgm2": 0.002, "wheel_inertia_kgm2": 1e-3, "damping_Nms": 0.02,
                "start_angle_deg": 150.0},
               {"name": "under", "parent": "late", "x_m": -0.3, "y_m": 0.1, "trail_m": 0.05, "radius_m": 0.04,
                "com_x_m": -0.02, "mass_kg": 0.5, "yaw_inertia_kgm2": 0.001, "driven": True}],
    "trailer": [{"name": "late", "parent": "tail", "hitch_x_m": -0.9, "length_m": 0.8, "track_m": 0.5,
                 "radius_m": 0.08, "mass_kg": 15.0, "yaw_inertia_kgm2": 1.0}],
    "body": [{"name": "arm", "hinge": "motor", "hinge_x_m": 0.1, "mass_kg": 4.0, "yaw_inertia_kgm2": 0.2,
              "com_x_m": 0.3, "stiffness_Nm": 2.0, "rest_deg": 20.0, "motor": {
                  "resistance_ohm": 0.5, "torque_constant_Nm_per_A": 0.05, "back_emf_Vs_per_rad": 0.05,
                  "gear_ratio": 20.0, "viscous_friction_Nms": 1e-4, "rotor_inertia_kgm2": 1e-5}},
             {"name": "tail", "hinge": "free", "hinge_x_m": -0.3, "mass_kg": 8.0, "yaw_inertia_kgm2": 0.6,
              "com_x_m": -0.4, "com_y_m": 0.02, "damping_Nms": 0.1}]},
    "ground": {"slope_deg": 3.0, "slope_heading_deg": 40.0},
    "initial": {"velocity_body_m_per_s": [0.4, 0.0], "x_m": 1.0, "y_m": -2.0, "heading_rad": 0.3},
    "run": {"duration_s": 1.0, "step_s": 0.01}}
EVERY_STEERING: dict[str, Any] = {"vehicle": {
    "mass_kg": 90.0, "yaw_inertia_kgm2": 9.0, "wheel_radius_m": 0.12, "wheel_inertia_kgm2": 0.01,
    "motor_gain_Nm_per_V": 2.0, "motor_damping_Nms": 3.0,
    "wheel": [{**WHEEL, "x_m": 0.0, "y_m": 0.3}, {**WHEEL, "x_m": 0.0, "y_m": -0.3, "driven": False},
              {"kind": "fixed", "steered": "motor", "distance_m": 0.9, "bearing_deg": 5.0, "scrub_m": 0.02,
               "mass_kg": 3.0, "yaw_inertia_kgm2": 0.05, "steering_motor": {
                   "resistance_ohm": 0.6, "torque_constant_Nm_per_A": 0.07, "back_emf_Vs_per_rad": 0.07,
                   "gear_ratio": 60.0, "rotor_inertia_kgm2": 5e-5}, "start_angle_rad": 0.2}]},
    "run": {"duration_s": 1.0, "step_s": 0.01}}


def test_every_form_of_a_body_is_understood_as_the_command_understands_it(tmp_path):
    given = {"rolling": (EVERY_FORM, [{"hinge_voltage_V": {"arm": 3.0}, "hinge_torque_Nm": {"late": 0.5}}]),
             "steered": (EVERY_STEERING, [{"hinge_voltage_V": {"wheel_3": 4.0}}])}
    scenes = {name: build_scene(tables) for name, (tables, _) in given.items()}
    inputs = {name: inputs_of(scenes[name], each) for name, (_, each) in given.items()}
    found = ran([{"scene": given[name][0], "inputs": inputs[name], "steps": 100} for name in given], tmp_path)
    for (name, scene), each in zip(scenes.items(), found, strict=True):
        run = scene_with_inputs(given[name][0], inputs[name], 1.0)
        last = {key: column[-1] for key, column in simulate(run).columns.items()}
        x, y, heading, energy = each["at"][0][:4]
        assert [last["x_m"], last["y_m"], last["heading_rad"], last["energy_J"]] == [x, y, heading, energy], name
        assert each["bodies"] == [hinge.name for hinge in scene.hinges]


SLIDING: dict[str, Any] = {**EVERY_FORM, "ground": {"friction_coefficient": 0.3, "slope_deg": 2.0}}
SLIDING["vehicle"] = {
    **EVERY_FORM["vehicle"], "com_z_m": 0.2,
    "wheel": [*EVERY_FORM["vehicle"]["wheel"],
              {"kind": "fixed", "steered": "servo", "name": "front", "x_m": 0.6, "y_m": -0.2, "driven": False,
               "mass_kg": 1.0, "yaw_inertia_kgm2": 0.02, "servo_gain_Nm_per_rad": 40.0, "servo_damping_Nms": 1.0,
               "servo_limit_Nm": 8.0, "rate_limit_rad_per_s": 1.5, "start_angle_deg": 20.0, "stop_high_deg": 40.0,
               "control_period_s": 0.02, "scrub_radius_m": 0.01, "scrub_fade_m": 0.02, "creep": 0.05},
              {"kind": "fixed", "steered": "prescribed", "name": "side", "x_m": -0.4, "y_m": 0.4, "mass_kg": 1.0,
               "yaw_inertia_kgm2": 0.02, "rate_limit_rad_per_s": 2.0, "axle_deg": -84.0},
              {"kind": "fixed", "steered": "coordinated", "name": "twisted", "x_m": 0.5, "y_m": 0.4, "mass_kg": 1.0,
               "yaw_inertia_kgm2": 0.02}],
    "caster": [{**EVERY_FORM["vehicle"]["caster"][0], "com_z_m": 0.1, "dry_friction_Nm": 0.02}],
    "trailer": [{**EVERY_FORM["vehicle"]["trailer"][0], "wheel_inertia_kgm2": 1e-3, "stop_low_deg": -40.0}],
    "body": [{**EVERY_FORM["vehicle"]["body"][0], "com_z_m": 0.4, "loop_V_per_rad": 20.0, "loop_Vs_per_rad": 1.0},
             EVERY_FORM["vehicle"]["body"][1]]}
SLIDES = [{"voltage_V": [6.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0],
           "steering_angle_rad": {"front": 0.9, "arm": 0.5}, "steering_rate_rad_per_s": {"side": 0.7},
           "steering_twist": [1.0, 0.2, 0.0]},
          {"voltage_V": [24.0, -6.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 0.0, 0.0],
           "steering_angle_rad": {"front": -0.4, "arm": -0.2}, "steering_rate_rad_per_s": {"side": -1.0},
           "steering_twist": [-0.5, -1.0, 0.1], "body_force_N": [0.0, 90.0]},
          {"voltage_V": [0.0] * 10, "steering_twist": [1.0, 1.0, 1.0], "hinge_torque_Nm": {"late": 3.0}}]
"""Servo, loop, prescribed and coordinated hinges; the last two turn the coordinated one past a half turn."""
SLIDE = """
import { readFileSync } from "node:fs";
import { load } from "laconic-robots/hinges";
const { scene, inputs } = JSON.parse(readFileSync("slide.json", "utf8")), laconic = await load();
const [one, many] = [0, 1].map(() => laconic.robot(scene));
for (const input of inputs) {
  for (const robot of [one, many]) robot.setInput(input);
  for (let k = 0; k < 100; k++) one.run(1);
  many.run(100);
}
console.log(JSON.stringify([one, many].map((robot) => [robot.outputs(), robot.limited])));
"""
OF_COMMAND = {"lateral_N": "wheel_lateral_N", "along_N": "wheel_reaction_N", "normal_N": "wheel_load_N",
              "scrub_Nm": "scrub_torque_Nm"}


def test_wheels_that_slip_on_every_kind_of_hinge_end_with_the_bits_of_the_command(tmp_path):
    (tmp_path / "slide.json").write_text(json.dumps({"scene": SLIDING, "inputs": SLIDES}), encoding="utf-8")
    (one, limited), again = json.loads(node(SLIDE, tmp_path))
    assert again == [one, limited]  # step by step, and many at once
    scene = scene_with_inputs(SLIDING | {"outputs": {"signals": [
        "x_m", "heading_rad", "hinge_angle_rad", "slip_across_m_per_s", "contact_state", *OF_COMMAND.values(),
        "hinge_stop_Nm", "slip_loss_J", "servo_work_J", "spring_energy_J"]}}, SLIDES, 1.0)
    run = simulate(scene)
    last = {name: float(column[-1]) for name, column in run.columns.items()}
    lists = {name: [value for key, value in last.items() if key.partition("[")[0] == name] for name in (
        "hinge_angle_rad", "slip_across_m_per_s", "contact_state", "hinge_stop_Nm", *OF_COMMAND.values())}
    for name in ("x_m", "heading_rad", "slip_loss_J", "servo_work_J", "spring_energy_J"):
        assert one[name] == last[name], name
    assert list(one["hinge_angle_rad"].values()) == lists["hinge_angle_rad"]
    assert list(one["stop_torque_Nm"].values()) == lists["hinge_stop_Nm"]
    for name, of_command in {**OF_COMMAND, "contact_state": "contact_state",
                             "slip_across_m_per_s": "slip_across_m_per_s"}.items():
        assert one[name] == lists[of_command], name
    assert one["slip_loss_J"] > 1.0
    assert {(each["hinge"], each["limit"], each["steps"]) for each in limited} == {
        (each.hinge, each.limit, each.steps) for each in run.limited} != set()


def scene_with_inputs(tables: dict[str, Any], given: list[dict[str, Any]], each_s: float) -> Scene:
    """The scene with inputs that are held one after the other."""
    held: dict[str, list[float]] = {}
    for at, (name, value) in ((at, pair) for at, inputs in enumerate(given) for pair in inputs.items()):
        listed = dict(enumerate(value, 1)) if isinstance(value, list) else value
        for item, number in (listed if isinstance(listed, dict) else {"": listed}).items():
            held.setdefault(f"{name}[{item}]" if item else name, [0.0] * len(given))[at] = number
    inputs = [{"signal": signal, "kind": "steps", "t_s": [each_s * at for at in range(len(given))], "value": values}
              for signal, values in held.items() if any(values)]
    rest = {key: value for key, value in tables.items() if key not in ("input", "run")}
    return build_scene(rest | {"input": inputs, "run": {"duration_s": each_s * len(given), "step_s": 0.01}})


LIMITED: dict[str, list[dict[str, Any]]] = {
    "f1tenth": [{"steering_angle_rad": 0.5}, {"steering_angle_rad": 0.0}, {"steering_angle_rad": 0.5}],
    "frc_swerve_mk4i": [{"steering_twist": [1, 0.2, 0]}, {"steering_twist": [-0.1, 1, 0.8]}],
    "pr2_base": [{"steering_twist": [1, 0.4, 0]}, {"steering_twist": [-1, 2, 5]}],
    "tugger_train": [{"steering_angle_rad": {"front": 1.6}}, {"steering_angle_rad": {"front": -0.3}}],
    "wheel_loader": [{"steering_angle_rad": {"rear": -0.9}}, {"steering_angle_rad": {"rear": 0.2}}]}


def without_rates(tables: dict[str, Any]) -> dict[str, Any]:
    """A car whose wheels have stops, but no limit of rate."""
    wheels = [{key: value for key, value in wheel.items() if key != "rate_limit_rad_per_s"}
              for wheel in tables["vehicle"]["wheel"]]
    return tables | {"vehicle": tables["vehicle"] | {"wheel": wheels}, "input": []}


def test_limits_hold_commands_back_as_in_a_run_of_the_command_and_are_reported(tmp_path):
    stops = [{"steering_curvature_per_m": value} for value in (2.0, 0.0, 2.0)]
    tables = {name: plain(name) for name in LIMITED} | {"stops alone": without_rates(plain("f1tenth"))}
    commands = {**LIMITED, "stops alone": stops}
    runs = [{"scene": tables[name], "inputs": inputs_of(build_scene(tables[name]), commands[name]), "steps": 100}
            for name in tables]
    for name, run, found in zip(tables, runs, ran(runs, tmp_path), strict=True):
        result = simulate(scene_with_inputs(run["scene"], run["inputs"], 1.0))
        last = {key: column[-1] for key, column in result.columns.items()}
        assert found["at"][0][:3] == [last["x_m"], last["y_m"], last["heading_rad"]], name  # bit by bit
        assert found["limited"], name
        assert {(each["hinge"], each["limit"]): each["steps"] for each in found["limited"]} == {
            (each.hinge, each.limit): each.steps for each in result.limited}, name


ANGLES = """
import { readFileSync } from "node:fs";
import { angleOf, tangentOf } from "./node_modules/laconic-robots/src/hinge_commands.js";
const { vectors, angles } = JSON.parse(readFileSync("given.json", "utf8"));
console.log(JSON.stringify([vectors.map(([x, y]) => angleOf(x, y)), angles.map(tangentOf)]));
"""


def test_directions_and_tangents_have_the_bits_of_the_command_and_are_right(tmp_path):
    random = np.random.default_rng(3)
    vectors = np.concatenate([random.normal(size=(500, 2)), [[1, 0], [-1, 0], [0, 1], [0, -2], [-1, -1e-9], [0, 0]]])
    angles = np.concatenate([random.uniform(-1.5, 1.5, 500), [0.0, 1e-9]])
    given = {"vectors": vectors.tolist(), "angles": angles.tolist()}
    (tmp_path / "given.json").write_text(json.dumps(given), encoding="utf-8")
    found = json.loads(node(ANGLES, tmp_path))
    assert found == [angle_of(*vectors.T).tolist(), tangent_of(angles).tolist()]
    assert found[0] == pytest.approx(np.arctan2(*vectors.T[::-1]).tolist(), rel=2e-15)
    assert found[1] == pytest.approx(np.tan(angles).tolist(), rel=1e-13)


REFUSE = """
import { load, Refused } from "laconic-robots/hinges";
import { load as loadOthers } from "laconic-robots";
const laconic = await load(), others = await loadOthers();
const wheel = (y_m, more = {}) => ({ kind: "fixed", x_m: 0, y_m, axle_rad: -Math.PI / 2, ...more });
const caster = { x_m: 0.3, y_m: 0, trail_m: 0.05, radius_m: 0.04, mass_kg: 1, yaw_inertia_kgm2: 1e-3 };
const plain = { mass_kg: 10, yaw_inertia_kgm2: 1, wheel_radius_m: 0.1, wheel_inertia_kgm2: 0,
  motor_gain_Nm_per_V: 1, motor_damping_Nms: 1, wheel: [wheel(0.2), wheel(-0.2)] };
const made = (change, scene = {}, run) => laconic.robot({ vehicle: { ...plain, ...change }, ...scene }, run);
const on = (change) => made({ caster: [{ ...caster, ...change }] });
const front = (change) => made({ wheel: [...plain.wheel, { kind: "fixed", x_m: 1, y_m: 0, ...change }] });
const slid = (change, run) => made({ wheel_inertia_kgm2: 1, wheel: [...plain.wheel, { kind: "fixed", x_m: 1, y_m: 0,
  ...change }] }, { ground: { friction_coefficient: 0.5 } }, run);
const robot = on({}), turned = front({ steered: "prescribed", name: "front", stop_high_rad: 0.1, at_limit: "refuse" });
const stopped = made({ body: [{ name: "arm", hinge: "free", hinge_x_m: 0, mass_kg: 1, yaw_inertia_kgm2: 1,
  stop_low_rad: -0.2 }] });
const swerve = (more) => made({ wheel: [1, -1].flatMap((x_m) => [1, -1].map((y_m, k) => ({ kind: "fixed", x_m, y_m,
  steered: "coordinated", ...more })) ) });
const freed = on({});
freed.free();
freed.free();
const calls = { CALLS };
for (const [name, call] of Object.entries(calls))
  try {
    call();
    console.log(name, "taken");
  } catch (error) {
    console.log(name, error instanceof Refused ? error.message.replaceAll("\\n", "<newline>") : `raw ${error}`);
  }
"""
CASES = {
    "laconic.robot({ vehicle: plain })": "vehicle: has no bodies on hinges; take robot() of what load() of \"laconic-",
    "others.robot({ vehicle: { ...plain, caster: [caster] } })": "vehicle.caster: bodies on hinges are for robot() of",
    "others.robot({ vehicle: { ...plain, wheel: [wheel(0, { steered: 'motor' })] } })": "vehicle.wheel[1].steered: bod",
    "made({ caster: {} })": "vehicle: has no bodies on hinges",
    "made({ caster: [3] })": "vehicle.caster[1]: 3 is no object; give",
    "made({ body: [{}] })": "vehicle.body[1].name: is missing; give a text",
    "on({ trail_m: 0 })": "vehicle.caster[1].trail_m: 0 is not positive; give a value above 0",
    "on({ trail_m: '5' })": 'vehicle.caster[1].trail_m: "5" is no number; give one',
    "on({ trial_m: 1 })": "vehicle.caster[1].trial_m: unknown key; take it out, or correct it: the keys are name,",
    "on({ name: '1a' })": 'vehicle.caster[1].name: is "1a"; use letters, digits, _ and -',
    "on({ name: 'carriage' })": 'vehicle.caster[1].name: is "carriage", the name of body 0; give another one',
    "on({ parent: 'x' })": 'vehicle.caster[1].parent: there is no body "x"; use carriage, caster_1',
    "on({ parent: 'caster_1' })": 'vehicle.caster[1].parent: hangs on "caster_1", which in the end hangs on this body',
    "on({ stop_low_rad: 1, stop_high_rad: 0 })": "vehicle.caster[1].stop_high_rad: is 0, which is not above",
    "on({ start_angle_rad: 1, start_angle_deg: 1 })": "vehicle.caster[1].start_angle_deg: is given in degrees and in",
    "on({ mass_kg: 0, yaw_inertia_kgm2: -1 })": "vehicle.caster[1].yaw_inertia_kgm2: -1 is negative; give 0 or more",
    "front({ steered: 'free' })": 'vehicle.wheel[3].steered: there is no "free"; use coordinated, prescribed, motor',
    "front({ steered: 'motor' })": "vehicle.wheel[3].steering_gain_Nm_per_V: is missing; give it, or a table",
    "front({ steered: 'motor', steering_gain_Nm_per_V: 1, rate_limit_rad_per_s: 1 })":
        'vehicle.wheel[3].rate_limit_rad_per_s: has no effect on a hinge that is "motor"',
    "made({ caster: [caster], wheel: [wheel(0, { scrub_m: 1 })] })": "vehicle.wheel[1].scrub_m: has a meaning for a s",
    "made({ caster: [caster, { ...caster, name: 'caster_1' }] })": 'vehicle.caster[2].name: is "caster_1", as of',
    "made({ caster: [caster] }, { ground: { roller_drag: 0.1 } })": "ground.roller_drag: acts on ground with friction",
    "made({ caster: [caster] }, { ground: { friction_coefficient: 1 } })": "vehicle.caster[1].wheel_inertia_kgm2: is 0",
    "made({ caster: [{ ...caster, wheel_inertia_kgm2: 1 }], wheel_inertia_kgm2: 1 }, { ground: { friction_coefficient: "
    "-1 } })": "ground.friction_coefficient: -1 is ",
    "on({ dry_friction_Nm: 1 })": "vehicle.caster[1].dry_friction_Nm: acts on ground with friction alone; give ground.",
    "front({ steered: 'servo' })": 'vehicle.wheel[3].steered: "servo" gives way, which needs ground.friction_coeffic',
    "slid({ steered: 'servo' })": "vehicle.wheel[3].servo_gain_Nm_per_rad: is missing; give the torque of the servo",
    "slid({ steered: 'prescribed', servo_gain_Nm_per_rad: 1 })": "vehicle.wheel[3].servo_gain_Nm_per_rad: is of a serv",
    "slid({ steered: 'coordinated', loop_V_per_rad: 1 })": "vehicle.wheel[3].loop_V_per_rad: is of a loop of a motor",
    "slid({ steered: 'coordinated', scrub_fade_m: 1 })": "vehicle.wheel[3].scrub_fade_m: has no effect without scrub_",
    "slid({ steered: 'coordinated', yaw_inertia_kgm2: 1 }).setInput({ steering_twist: [0, 0, 0] })":
        "steering_twist: is 0, which gives coordinated wheels no direction",
    "slid({ steered: 'coordinated', yaw_inertia_kgm2: 1 }).reactions()": "reactions: are those of ideal ground",
    "slid({ steered: 'coordinated', yaw_inertia_kgm2: 1 }, { method: 'rk4' })": "run.method: rk4 does not step",
    "made({ caster: [caster], wheel: [wheel(0, { axle_rad: NaN })] })": "vehicle.wheel[1].axle_rad: NaN is not a",
    "made({ caster: Array(9).fill(0).map((_, k) => ({ ...caster, name: `c${k}` })) })": "vehicle.body: 9 of them, but",
    "made({ caster: [caster] }, { initial: { nu_rad_per_s: [1, 0, 0] } })": "initial.nu_rad_per_s: unknown key",
    "made({ caster: [caster] }, { initial: { velocity_body_m_per_s: [0, 1] } })":
        "initial.velocity_body_m_per_s: this start makes a fixed wheel slide; the nearest motion",
    "made({ caster: [caster] }, {}, { method: 'kahan' })": "run.method: ",
    "made({ caster: [caster] }, {}, { step_s: -1 })": "run.step_s: -1 is not positive",
    "robot.setInput({ hinge_voltage_V: { caster_1: 1 } })": "hinge_voltage_V.caster_1: needs a hinge that is motor; ",
    "robot.setInput({ hinge_torque_Nm: { x: 1 } })": "hinge_torque_Nm.x: needs a hinge that is free or motor; give",
    "robot.setInput({ hinge_torque_Nm: { caster_1: NaN } })": "hinge_torque_Nm.caster_1: NaN is not a finite number",
    "robot.setInput({ hinge_torque_Nm: 1 })": "hinge_torque_Nm: 1 is no object; give numbers for caster_1",
    "robot.setInput({ steering_twist: [1, 0, 0] })": "steering_twist: needs hinges that are coordinated; this vehicle",
    "robot.setInput({ voltage_V: [1] })": "voltage_V: a list of 1; give 3, one for each wheel",
    "robot.setInput({ voltage: 1 })": "voltage: unknown key; take it out",
    "robot.run(0.5)": "steps: 0.5 is no whole number of steps; give 0 or more",
    "turned.setInput({ steering_angle_rad: { front: 1 } })": "vehicle.wheel[3].rate_limit_rad_per_s: is missing; steer",
    "(turned.setInput({ steering_rate_rad_per_s: { front: 1 } }), turned.run(200))":
        "vehicle.wheel[3] (front): at t = 0.1 s the command asks for 0.10",
    "(stopped.setInput({ hinge_torque_Nm: { arm: -3 } }), stopped.run(5000))": "vehicle.body[1] (arm): comes to its",
    "swerve({}).setInput({ steering_twist: [0, 0, 0] })": "vehicle.wheel[1] (wheel_1): the twist gives this steered",
    "swerve({}).setInput({ steering_twist: [1, 0, 0], steering_curvature_per_m: 1 })": "steering_twist: is given",
    "swerve({}).setInput({ steering_angle_rad: 0.1 })": "vehicle.wheel[1].rate_limit_rad_per_s: is missing; steering_",
    "swerve({ rate_limit_rad_per_s: 1 }).setInput({ steering_angle_rad: 0.1 })": "steering_angle_rad: is that of",
    "freed.outputs()": "robot: was freed; make another by robot()", "freed.run(1)": "robot: was freed",
    "new robot.constructor()": "a robot is made by robot() of what load() gives"}


def test_what_is_wrong_is_one_line_that_names_table_and_remedy(tmp_path):
    calls = ", ".join(f"{number}: () => {call}" for number, call in enumerate(CASES))
    told = node(REFUSE.replace("CALLS", calls), tmp_path).splitlines()
    assert len(told) == len(CASES)
    for (call, line), found in zip(CASES.items(), told, strict=True):
        assert re.sub(r"^\d+ ", "", found).startswith(line), (call, found)


def test_a_refused_step_or_input_leaves_all_as_it_was(tmp_path):
    script = REFUSE.split("const calls")[0] + """
        const rate = { steering_rate_rad_per_s: { front: 1 } }, held = JSON.stringify;
        turned.setInput(rate);
        try { turned.run(200); } catch {}
        const at = held([turned.outputs(), turned.commands, turned.limited]), steps = turned.steps;
        for (let k = 0; k < 3; k++) try { turned.run(1); } catch {}
        try { turned.setInput({ steering_rate_rad_per_s: { front: "x" } }); } catch {}
        console.log(steps, steps === turned.steps && at === held([turned.outputs(), turned.commands, turned.limited]));
        turned.setInput({ steering_rate_rad_per_s: { front: -1 } });
        turned.run(50);
        console.log(turned.steps, turned.outputs().hinge_angle_rad.front.toFixed(6));"""
    assert node(script, tmp_path).split() == ["100", "true", "150", "0.050000"]


def test_a_step_that_a_stop_refuses_leaves_the_twist_that_acted(tmp_path):
    script = REFUSE.split("const calls")[0] + """
        const torque = { hinge_torque_Nm: { arm: -3 } };
        const back = { hinge_torque_Nm: { arm: 3000 }, steering_twist: [1, 1, 0] };
        const made_ = () => made({ wheel: [1, -1].flatMap((x_m) => [1, -1].map((y_m) => ({ ...wheel(y_m), x_m,
            steered: "coordinated" }))), body: [{ name: "arm", hinge: "free", hinge_x_m: 0, mass_kg: 1,
            yaw_inertia_kgm2: 1, stop_low_rad: -0.2 }] }, { initial: { velocity_body_m_per_s: [1, 0] } });
        const [tried, other] = [made_(), made_()];
        tried.setInput(torque);
        try { tried.run(5000); } catch {}
        tried.setInput({ ...torque, steering_twist: [1, 0.5, 0] });
        try { tried.run(1); } catch { console.log("refused"); }
        other.setInput(torque);
        other.run(tried.steps);
        for (const robot of [tried, other]) {
          robot.setInput(back);
          robot.run(3);
        }
        console.log(JSON.stringify(tried.outputs()) === JSON.stringify(other.outputs()));"""
    assert node(script, tmp_path).split() == ["refused", "true"]


WRONG = """
const wrong: string = robot.outputs().hinge_angle_rad.front;
// @ts-expect-error: a caster has a trail
laconic.robot({ vehicle: { mass_kg: 1, yaw_inertia_kgm2: 1, wheel_radius_m: 1, caster: [{ x_m: 0, y_m: 0 }] } });
"""


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("tsc") is None, reason="needs tsc (Debian: node-typescript)")
def test_its_types_take_the_readmes_example_and_refuse_what_is_wrong(tmp_path):
    example = re.findall(r"```js\n(.*?)```", SAMPLE.read_text(encoding="utf-8"), re.DOTALL)[1]
    wrong = WRONG.replace("const wrong", "// @ts-expect-error: a number\nconst wrong")
    assert typechecked(example + wrong, tmp_path) == ""


def test_the_readmes_example_of_hinges_prints_what_the_readme_says(tmp_path):
    blocks = re.findall(r"```\w+\n(.*?)```", SAMPLE.read_text(encoding="utf-8"), re.DOTALL)
    assert node(blocks[2], tmp_path) == blocks[3]


def test_its_types_and_its_modules_have_the_same_names():
    check_names("hinges.d.ts", {"HingedRobot": ("hinged_robot.js", "handle.js"), "LaconicHinges": ("hinges.js",)},
                method_names())
