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

SOURCES = Path(__file__).parents[4] / "web/npm"
FOLDER = build_dir() / "npm/laconic"
ARCHIVE = next((build_dir() / "npm").glob("*.tgz"), Path("none"))
SAMPLE = SOURCES / "README.md"

pytestmark = [
    pytest.mark.skipif(not FOLDER.is_dir(), reason="the npm package was not built: no clang with wasm-ld"),
    pytest.mark.skipif(shutil.which("node") is None, reason="needs node")]


def node(script: str, folder: Path) -> str:
    """What a module prints that imports the unpacked archive by the package's name."""
    unpack(folder / "node_modules/laconic-robots")
    (folder / "script.mjs").write_text(script, encoding="utf-8")
    done = subprocess.run(["node", "script.mjs"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def unpack(target: Path) -> None:
    with tarfile.open(ARCHIVE) as tar:
        for member in tar.getmembers():
            file = target / Path(member.name).relative_to("package")
            file.parent.mkdir(parents=True, exist_ok=True)
            content = tar.extractfile(member)
            assert content is not None
            file.write_bytes(content.read())


def test_its_hash_is_that_of_the_native_core(tmp_path):
    native = subprocess.run([build_dir() / "core_c/tests/trajectory_hash_double_shipped"], capture_output=True,
                            text=True, check=True).stdout.split()
    found = node('import { load } from "laconic-robots"; console.log((await load()).hash());', tmp_path).split()
    print(f"hash of the native core {native}, of the npm package {found}")
    assert found == native and len(found) >= 2


def test_the_readmes_example_prints_what_the_readme_says(tmp_path):
    script, output = re.findall(r"```\w+\n(.*?)```", SAMPLE.read_text(encoding="utf-8"), re.DOTALL)
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


@pytest.mark.skipif(shutil.which("tsc") is None, reason="needs tsc (Debian: node-typescript)")
def test_its_types_take_the_readmes_example_and_refuse_what_is_wrong(tmp_path):
    unpack(tmp_path / "node_modules/laconic-robots")
    (tmp_path / "package.json").write_text('{"type": "module"}', encoding="utf-8")
    example = re.findall(r"```js\n(.*?)```", SAMPLE.read_text(encoding="utf-8"), re.DOTALL)[0]
    (tmp_path / "user.ts").write_text(example + WRONG, encoding="utf-8")
    done = subprocess.run(["tsc", "--noEmit", "--strict", "--target", "es2022", "--module", "node16",
                           "--moduleResolution", "node16", "--lib", "es2022,dom", "user.ts"],
                          cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "")


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


def test_scenes_have_the_bits_of_the_native_core(tmp_path):
    from laconic_build.page.scenes import plain_scene
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


def test_velocities_that_are_no_numbers_and_freed_robots_are_refused(tmp_path):
    was_freed = "robot: was freed; make another by robot()"
    assert node(ASKED, tmp_path).splitlines() == [
        "left: undefined is no number; give forward, left and turn",
        "forward: NaN is not a finite number; give forward, left and turn",
        "turn: Infinity is not a finite number; give forward, left and turn", was_freed, was_freed, was_freed, "taken"]


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


def test_its_types_and_its_modules_have_the_same_names():
    types = (FOLDER / "src/index.d.ts").read_text(encoding="utf-8")
    code = {path.name: path.read_text(encoding="utf-8") for path in (FOLDER / "src").glob("*.js")}
    for name, file in (("Robot", "robot.js"), ("Laconic", "index.js"), ("Refused", "refused.js")):
        body = re.search(rf"export class {name}[^{{]*\{{(.*?)^\}}", types, re.DOTALL | re.MULTILINE)
        assert body is not None
        for member in re.findall(r"^  (?:readonly )?(\w+)(?:\(|:)", body[1], re.MULTILINE):
            assert re.search(rf"\bthis\.{member} =|\b(?:get )?{member}\(", code[file]) or member == "message", member
    offered = re.search(r'export type MethodName =\s*(.*?);', types, re.DOTALL)
    assert offered is not None
    from laconic.scene.methods import METHODS
    assert tuple(re.findall(r'"([^"]+)"', offered[1])) == METHODS


def test_it_lists_the_methods_of_the_core_with_their_orders(tmp_path):
    from laconic.scene.methods import ROWS
    script = 'import { load } from "laconic-robots"; console.log(JSON.stringify((await load()).methods));'
    assert json.loads(node(script, tmp_path)) == [{"name": row.name, "order": row.order} for row in ROWS]


def test_it_tells_of_itself_what_all_packages_tell():
    manifest = json.loads((FOLDER / "package.json").read_text(encoding="utf-8"))
    facts = json.loads((SOURCES.parents[1] / "packaging" / "facts.json").read_text(encoding="utf-8"))
    assert manifest["description"] == facts["sentence"]
    assert ".example" not in json.dumps(manifest)
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest["version"]) and manifest["license"] == "MIT"


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
