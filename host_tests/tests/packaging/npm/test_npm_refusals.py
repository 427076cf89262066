"""The npm package in careless hands: each thing that is wrong is one line that names the field and the remedy."""

from __future__ import annotations

import re

import pytest
from test_npm_package import node, pytestmark  # noqa: F401  # skips where the package was not built

ASK = """
import { Laconic, Refused, Robot, load } from "laconic-robots";
const laconic = await load();
const wheel = (y_m) => ({ kind: "fixed", x_m: 0, y_m, axle_rad: -Math.PI / 2 });
const vehicle = { mass_kg: 1, yaw_inertia_kgm2: 0.1, wheel_radius_m: 0.1, wheel_inertia_kgm2: 0.001,
  motor_gain_Nm_per_V: 0.1, motor_damping_Nms: 0.1, wheel: [wheel(0.1), wheel(-0.1)] };
const robot = laconic.robot({ vehicle });
const made = (change, scene = {}, run) => laconic.robot({ vehicle: { ...vehicle, ...change }, ...scene }, run);
const one = (change) => made({ wheel: [{ ...wheel(0.1), ...change }, wheel(-0.1)] });
const circle = {};
circle.circle = circle;
const calls = { CALLS };
for (const [name, call] of Object.entries(calls))
  try {
    call();
    console.log(name, "taken");
  } catch (error) {
    console.log(name, error instanceof Refused ? error.message.replaceAll("\\n", "<newline>") : `raw ${error}`);
  }
const odd = { undefined, null: null, text: "1", empty: "", NaN, Infinity, true: true, bigint: 1n, symbol: Symbol("s"),
  function: () => 1, object: {}, none: [], short: [1], long: [1, 2, 3, 4], circle, negative: -1, fraction: 1.5 };
const asked = {
  robot: (x) => laconic.robot(x), options: (x) => made({}, {}, x), vehicle: (x) => laconic.robot({ vehicle: x }),
  step: (x) => made({}, {}, { step_s: x }), method: (x) => made({}, {}, { method: x }),
  mass: (x) => made({ mass_kg: x }),
  wheels: (x) => made({ wheel: x }), wheel: (x) => made({ wheel: [x] }), motor: (x) => made({ motor: x }),
  support: (x) => made({ support: x }), ground: (x) => made({}, { ground: x }),
  initial: (x) => made({}, { initial: x }), nu: (x) => made({}, { initial: { nu_rad_per_s: x } }),
  locked: (x) => one({ locked: x }), driven: (x) => one({ driven: x }), circuit: (x) => one({ motor_circuit: x }),
  name: (x) => made({}, { name: x }), sensors: (x) => made({}, { sensors: x }), inputs: (x) => made({}, { input: x }),
  setInput: (x) => robot.setInput(x), force: (x) => robot.setInput({ body_force_N: x }),
  voltages: (x) => robot.setInput({ voltage_V: x }),
  voltage: (x) => robot.setInput({ voltage_V: [0, x] }), moment: (x) => robot.setInput({ body_moment_Nm: x }),
  run: (x) => robot.run(x), gain: (x) => robot.motorGain(x),
  voltagesFor: (x) => robot.voltagesFor(x, 0, 0), torquesFor: (x) => robot.torquesFor(0, x, 0),
  allowed: (x) => robot.allowed(0, 0, x), Robot: (x) => new Robot(x), Laconic: (x) => new Laconic(x) };
for (const [name, call] of Object.entries(asked)) {
  const taken = [];
  for (const [label, given] of Object.entries(odd))
    try {
      call(given);
      taken.push(label);
    } catch (error) {
      if (!(error instanceof Refused) || error.message.includes("\\n")) taken.push(`${label}: ${error}`);
    }
  if (taken.length) console.log(name, taken.join(" "));
}
"""
NUMBERS, FLAGS = "negative fraction", "true"
TAKEN = {"options": "undefined object", "step": "undefined fraction", "method": "undefined", "mass": "fraction",
         "wheels": "undefined none", "support": "undefined none", "ground": "undefined object",
         "initial": "undefined object", "locked": FLAGS, "motor": "undefined", "driven": "undefined true",
         "circuit": "undefined", "name": "undefined text empty", "sensors": "undefined object circle",
         "inputs": "undefined none short long", "setInput": "object",
         "voltage": NUMBERS, "moment": NUMBERS, "voltagesFor": NUMBERS, "torquesFor": NUMBERS,
         "allowed": NUMBERS}
CASES = {
    "laconic.robot()": "scene: undefined is no object; give an object with the keys of a scene, vehicle among them",
    "laconic.robot({})": "vehicle: undefined is no object; give an object with mass_kg and the vehicle's other keys",
    "made({ wheel: {} })": "vehicle.wheel: an object is no list; give one of objects",
    "made({ wheel: [null] })": "vehicle.wheel[1]: null is no object; give an object with kind, x_m, y_m and axle_rad",
    "one({ kind: 'constructor' })": 'vehicle.wheel[1].kind: there is no "constructor"; use omni, mecanum, roller or',
    "made({ wheel: [{ kind: 'fixed', y_m: 1, axle_rad: 0 }] })": "vehicle.wheel[1].x_m: is missing; give a number",
    "one({ kind: 'mecanum' })": "vehicle.wheel[1].roller_rad: is missing; give a number",
    "one({ distance_m: 1 })": "vehicle.wheel[1].x_m: is given besides distance_m and bearing_rad; keep one place",
    "made({ wheel: [{ ...wheel(0), x_deg: '9' }] })": 'vehicle.wheel[1].x_deg: "9" is no number; give one',
    "one({ axle_deg: 90 })": "vehicle.wheel[1].axle_deg: is given in degrees and in radians; keep one",
    "one({ locked: 'yes' })": 'vehicle.wheel[1].locked: "yes" is neither true nor false; give one of them',
    "one({ motor_circuit: 'short' })": 'vehicle.wheel[1].motor_circuit: there is no "short"; use driven, open, shorted',
    "one({ motor_circuit: 0 })": "vehicle.wheel[1].motor_circuit: there is no 0; use driven, open, shorted",
    "one({ driven: 0 })": "vehicle.wheel[1].driven: 0 is neither true nor false; give one of them",
    "one({ roller_rad: 1 })": "vehicle.wheel[1].roller_rad: a fixed wheel has no rollers; take it out, or give",
    "one({ roller_deg: 45 })": "vehicle.wheel[1].roller_deg: a fixed wheel has no rollers; take it out, or give",
    "made({ drive: { supply_V: 24 } })": "vehicle.drive: limits the currents of motors, which need vehicle.motor; give",
    "made({}, { name: Symbol() })": "name: Symbol() is no text; give one in quotes, or take it out",
    "made({}, { sensors: NaN })": "sensors: NaN is no object; give an object with keys",
    "made({}, { input: {} })": "input: an object is no list; give one of objects",
    "made({ mass_kg: circle })": "vehicle.mass_kg: an object is no number; give one",
    "made({ payload: { mass_kg: 1 } })": "vehicle.payload.x_m: is missing; give a number",
    "made({}, { vehicel: {} })": "vehicel: unknown key; take it out, or correct it: the keys are name, source, vehicle",
    "made({}, { initial: { x: 1 } })": "initial.x: unknown key; take it out, or correct it: the keys are nu_rad_per_s",
    "made({}, { initial: { nu_rad_per_s: [1] } })": "initial.nu_rad_per_s: a list of 1; give 3, ν1, ν2 and ν3",
    "made({}, {}, { stepS: 1 })": "run.stepS: unknown key; take it out, or correct it: the keys are method, step_s",
    "made({}, {}, { step_s: '0.01' })": 'run.step_s: "0.01" is no number; give one',
    "made({}, { run: { step_s: '0.01' } })": 'run.step_s: "0.01" is no number; give one',
    "robot.setInput(null)": "input: null is no object; give an object with any of voltage_V, axle_torque_Nm",
    "robot.setInput({ voltage: [1, 2] })": "voltage: unknown key; take it out, or correct it: the keys are voltage_V",
    "robot.setInput({ voltage_V: [1] })": "voltage_V: a list of 1; give 2, one for each wheel",
    "robot.setInput({ voltage_V: [1, 2, 3] })": "voltage_V: a list of 3; give 2, one for each wheel",
    "robot.setInput({ voltage_V: '12' })": 'voltage_V: "12" is no list of numbers; give 2, one for each wheel',
    "robot.setInput({ voltage_V: ['1', 2] })": 'voltage_V[1]: "1" is no number; give one',
    "robot.setInput({ world_force_N: [1] })": "world_force_N: a list of 1; give 2, along x and along y",
    "robot.setInput({ voltage_V: new Float32Array(2) })": "taken",
    "robot.run('200')": 'steps: "200" is no whole number of steps; give 0 or more',
    "robot.motorGain(2)": "wheel: 2 is no wheel of this robot; give 0 to 1",
    "robot.voltagesFor(1e308, 0, 0)": "forward: 1e+308 leads beyond the range of double precision; give less",
    "robot.allowed(0, 0, 1e308)": "turn: 1e+308 leads beyond the range of double precision; give less",
    "robot.voltagesFor(1, 0)": "turn: undefined is no number; give forward, left and turn",
    "new Robot()": "a robot is made by robot() of what load() gives",
}


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    calls = ", ".join(f"{number}: () => {call}" for number, call in enumerate(CASES))
    return node(ASK.replace("CALLS", calls), tmp_path_factory.mktemp("careless")).splitlines()


def test_what_is_wrong_is_one_line_that_names_field_and_remedy(told):
    for number, (call, line) in enumerate(CASES.items()):
        assert re.sub(r"^\d+ ", "", told[number]).startswith(line), (call, told[number])


def test_no_exported_function_takes_what_it_cannot_use_or_fails_with_an_error_of_the_language(told):
    assert dict(line.split(" ", 1) for line in told[len(CASES):]) == TAKEN


def test_an_input_that_is_refused_leaves_the_one_before(tmp_path):
    script = ASK.split("const circle")[0] + """
        robot.setInput({ voltage_V: [1, 2] });
        try { robot.setInput({ voltage_V: [5, "x"] }); } catch {}
        const other = laconic.robot({ vehicle });
        other.setInput({ voltage_V: [1, 2] });
        for (const each of [robot, other]) each.run(100);
        console.log(robot.outputs().x_m === other.outputs().x_m && robot.outputs().x_m > 0);"""
    assert node(script, tmp_path).strip() == "true"
