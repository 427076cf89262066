"""The npm package: what it promises, in Node; skipped where the package was not built or Node is not there."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import tarfile
from pathlib import Path

import pytest

from laconic import read_scene
from laconic.base.paths import build_dir
from laconic.core import load

needs_node = pytest.mark.skipif(shutil.which("node") is None, reason="needs node")


SOURCES = Path(__file__).parents[4] / "web/npm"
FOLDER = build_dir() / "npm/laconic"
needs_npm_package = pytest.mark.skipif(not FOLDER.is_dir(),
                                       reason="the npm package was not built: no clang with wasm-ld")
ARCHIVE = next((build_dir() / "npm").glob("*.tgz"), Path("none"))
SAMPLE = SOURCES / "README.md"


def node(script: str, folder: Path) -> str:
    """What a module prints that imports the unpacked archive by the package's name."""
    unpack(folder / "node_modules/laconic-robots")
    (folder / "script.mjs").write_text(script, encoding="utf-8")
    done = subprocess.run(["node", "script.mjs"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def typechecked(text: str, folder: Path) -> str:
    """What the compiler of TypeScript says of a module that uses the package."""
    unpack(folder / "node_modules/laconic-robots")
    (folder / "package.json").write_text('{"type": "module"}', encoding="utf-8")
    (folder / "user.ts").write_text(text, encoding="utf-8")
    done = subprocess.run(["tsc", "--noEmit", "--strict", "--target", "es2022", "--module", "node16",
                           "--moduleResolution", "node16", "--lib", "es2022,dom", "user.ts"],
                          cwd=folder, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


def check_names(types: str, classes: dict[str, tuple[str, ...]], methods: tuple[str, ...]) -> None:
    """The members of each class are in its modules; a method's name is one of the core's."""
    text = (FOLDER / "src" / types).read_text(encoding="utf-8")
    for name, files in classes.items():
        code = "".join((FOLDER / "src" / file).read_text(encoding="utf-8") for file in files)
        body = re.search(rf"export class {name}[^{{]*\{{(.*?)^\}}", text, re.DOTALL | re.MULTILINE)
        assert body is not None
        for member in re.findall(r"^  (?:readonly )?(\w+)(?:\(|:)", body[1], re.MULTILINE):
            assert re.search(rf"\bthis\.{member} =|\b(?:get )?{member}\(", code), member
    offered = re.search(r"export type MethodName =\s*(.*?);", text, re.DOTALL)
    assert offered is not None
    assert tuple(re.findall(r'"([^"]+)"', offered[1])) == methods


def unpack(target: Path) -> None:
    with tarfile.open(ARCHIVE) as tar:
        for member in tar.getmembers():
            file = target / Path(member.name).relative_to("package")
            file.parent.mkdir(parents=True, exist_ok=True)
            content = tar.extractfile(member)
            assert content is not None
            file.write_bytes(content.read())


@needs_npm_package
@needs_node
def test_its_hash_is_that_of_the_native_core(tmp_path):
    native = subprocess.run([build_dir() / "core_c/tests/trajectory_hash_double_shipped"], capture_output=True,
                            text=True, check=True).stdout.split()
    found = node('import { load } from "laconic-robots"; console.log((await load()).hash());', tmp_path).split()
    print(f"hash of the native core {native}, of the npm package {found}")
    assert found == native and len(found) >= 2


@needs_npm_package
@needs_node
def test_the_readmes_example_prints_what_the_readme_says(tmp_path):
    script, output = re.findall(r"```\w+\n(.*?)```", SAMPLE.read_text(encoding="utf-8"), re.DOTALL)[:2]
    assert node(script, tmp_path) == output


WRONG = """
const wrong: number = robot.outputs().heading_rad;
// @ts-expect-error: there is no such kind
laconic.robot({ vehicle: { mass_kg: 1, yaw_inertia_kgm2: 1, wheel_radius_m: 1, wheel: [{ kind: "round" }] } });
// @ts-expect-error: there is no such method
laconic.robot({ vehicle: { mass_kg: 1, yaw_inertia_kgm2: 1, wheel_radius_m: 1, wheel: [] } }, { method: "rk5" });
// @ts-expect-error: the length of a step is a number
robot.run("200");
"""


@pytest.mark.nightly
@needs_npm_package
@needs_node
@pytest.mark.skipif(shutil.which("tsc") is None, reason="needs tsc (Debian: node-typescript)")
def test_its_types_take_the_readmes_example_and_refuse_what_is_wrong(tmp_path):
    example = re.findall(r"```js\n(.*?)```", SAMPLE.read_text(encoding="utf-8"), re.DOTALL)[0]
    assert typechecked(example + WRONG, tmp_path) == ""


RUN = """
import { readFileSync } from "node:fs";
import { load } from "laconic-robots";
const laconic = await load();
for (const { scene, input, steps } of JSON.parse(readFileSync("runs.json", "utf8"))) {
  const robot = laconic.robot(scene, { method: "auto", step_s: 0.001 });
  robot.setInput(input);
  robot.run(steps);
  const { x_m, y_m, heading_rad, energy_J } = robot.outputs();
  console.log(JSON.stringify([x_m, y_m, heading_rad, energy_J]));
}
"""
SCENES = ("robotino2", "kuka_youbot", "skid_steer", "example_two_wheel_sizes", "paper_caster", "paper_three_wheel_free")


@needs_npm_package
@needs_node
def test_scenes_have_the_bits_of_the_native_core(tmp_path):
    from laconic_build.page.page import plain_scene
    runs, expected = [], []
    for name in SCENES:
        scene = read_scene(name)
        core = load("double")
        plant = scene.with_run(method="auto", step_s=0.001).plant(core)
        voltages = [2.0 - k for k in range(scene.wheel_count)]
        plant.run({"voltage_V": voltages}, 700)
        pose = plant.pose
        expected.append([pose.x_m, pose.y_m, pose.heading_rad, plant.energy_J()])
        plain = {key: value for key, value in plain_scene(scene.path).items() if key != "id"}
        runs.append({"scene": plain, "input": {"voltage_V": voltages}, "steps": 700})
    (tmp_path / "runs.json").write_text(json.dumps(runs), encoding="utf-8")
    assert [json.loads(line) for line in node(RUN, tmp_path).splitlines()] == expected


REFUSE = """
import { load, Refused } from "laconic-robots";
const laconic = await load();
const wheel = { kind: "fixed", x_m: 0, y_m: 0.1, axle_rad: -1.5 };
const vehicle = { mass_kg: 1, yaw_inertia_kgm2: 0.1, wheel_radius_m: 0.1, wheel_inertia_kgm2: 0, wheel: [wheel] };
for (const change of CHANGES)
  try {
    laconic.robot({ vehicle: { ...vehicle, ...change } });
    console.log("taken");
  } catch (refused) {
    console.log(refused instanceof Refused ? refused.message : `no refusal: ${refused}`);
  }
"""


@needs_npm_package
@needs_node
def test_what_the_core_refuses_is_one_line_that_names_the_field(tmp_path):
    changes = """[{ mass_kg: 0 }, { mass_kg: NaN }, { mas_kg: 1 }, { mass_kg: "1" },
        { wheel: [{ ...wheel, x_m: Infinity }] }, { wheel: [{ ...wheel, kind: "round" }] },
        { wheel: [{ ...wheel, radius_m: 0 }] }, { wheel: Array(17).fill(wheel) }]"""
    lines = node(REFUSE.replace("CHANGES", changes), tmp_path).splitlines()
    starts = ["vehicle.mass_kg: 0 is not positive", "vehicle.mass_kg: NaN is not a finite",
              "vehicle.mas_kg: unknown key", 'vehicle.mass_kg: "1" is no number',
              "vehicle.wheel[1].x_m: infinity is not a finite",
              'vehicle.wheel[1].kind: there is no "round"', "vehicle.wheel[1].radius_m: 0 is not positive",
              "vehicle.wheel: 17 wheels, but"]
    assert len(lines) == len(starts)
    for line, start in zip(lines, starts, strict=True):
        assert line.startswith(start), line


ASKED = """
import { load, Refused } from "laconic-robots";
const laconic = await load();
const wheel = { kind: "fixed", x_m: 0, y_m: 0.1, axle_rad: -1.5 };
const scene = { vehicle: { mass_kg: 1, yaw_inertia_kgm2: 0.1, wheel_radius_m: 0.1, wheel: [wheel] } };
const robot = laconic.robot(scene), freed = laconic.robot(scene);
freed.free();
freed.free();
const other = laconic.robot(scene);
const calls = [() => robot.voltagesFor(1), () => robot.torquesFor(NaN, 0, 0), () => robot.voltagesFor(0, 0, Infinity),
  () => freed.outputs(), () => freed.run(1), () => freed.setInput({}), () => other.outputs()];
for (const call of calls)
  try {
    call();
    console.log("taken");
  } catch (refused) {
    console.log(refused instanceof Refused ? refused.message : `no refusal: ${refused}`);
  }
"""


@needs_npm_package
@needs_node
def test_velocities_that_are_no_numbers_and_freed_robots_are_refused(tmp_path):
    was_freed = "robot: was freed; make another by robot()"
    assert node(ASKED, tmp_path).splitlines() == [
        "left: undefined is no number; give forward, left and turn",
        "forward: NaN is not a finite number; give forward, left and turn",
        "turn: Infinity is not a finite number; give forward, left and turn", was_freed, was_freed, was_freed, "taken"]


@needs_npm_package
@needs_node
def test_memory_of_freed_robots_is_used_again(tmp_path):
    script = """import { load } from "laconic-robots";
        const laconic = await load();
        const vehicle = { mass_kg: 1, yaw_inertia_kgm2: 1, wheel_radius_m: 1, wheel: [] };
        const sizes = new Set();
        for (let i = 0; i < 200; i++) {
          laconic.robot({ vehicle }).free();
          sizes.add(laconic.module.c.memory.buffer.byteLength);
        }
        console.log(sizes.size);"""
    assert node(script, tmp_path).strip() == "1"


@needs_npm_package
@needs_node
def test_its_types_and_its_modules_have_the_same_names():
    from laconic.scene.methods import METHODS
    classes = {"Robot": ("robot.js", "handle.js"), "Laconic": ("index.js",), "Refused": ("refused.js",)}
    check_names("index.d.ts", classes, METHODS)


@needs_npm_package
@needs_node
def test_it_lists_the_methods_of_the_core_with_their_orders(tmp_path):
    from laconic.scene.methods import ROWS
    script = 'import { load } from "laconic-robots"; console.log(JSON.stringify((await load()).methods));'
    assert json.loads(node(script, tmp_path)) == [{"name": row.name, "order": row.order} for row in ROWS]


@needs_npm_package
@needs_node
def test_it_tells_of_itself_what_all_packages_tell():
    manifest = json.loads((FOLDER / "package.json").read_text(encoding="utf-8"))
    facts = json.loads((SOURCES.parents[1] / "packaging" / "facts.json").read_text(encoding="utf-8"))
    assert manifest["description"] == facts["sentence"]
    assert ".example" not in json.dumps(manifest)
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest["version"]) and manifest["license"] == "MIT"


@pytest.mark.nightly
@needs_npm_package
@needs_node
def test_packing_twice_gives_the_same_bytes_and_every_file_that_npm_would_pack(tmp_path):
    from laconic_build.page.npm import packed
    assert hashlib.sha256(packed(FOLDER)).hexdigest() == hashlib.sha256(ARCHIVE.read_bytes()).hexdigest()
    if shutil.which("npm") is None:
        pytest.skip("needs npm")
    listed = subprocess.run(["npm", "pack", "--dry-run", "--json", "--offline"], cwd=FOLDER, capture_output=True,
                            text=True, check=True, env=os.environ | {"HOME": str(tmp_path)}).stdout
    with tarfile.open(ARCHIVE) as tar:
        ours = {name.removeprefix("package/") for name in tar.getnames()}
    assert ours == {file["path"] for file in json.loads(listed)[0]["files"]}


# ---- The npm package in careless hands: each thing that is wrong is one line that names the field and the remedy.

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
