"""Robots with hinges on the page: every scene of them, driven as each allows, to the bits of package and command."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
import tomllib
from conftest import PAGE

from laconic import read_scene, simulate
from laconic.base.paths import SOURCE_DIR, build_dir, scene_names, scene_path
from laconic.scene.hinges import file_has_hinges
from laconic_build.page.browser import Browser
from laconic_build.page.page import make_page

SHOTS = PAGE.parent
HINGED = [name for name in scene_names() if file_has_hinges(scene_path(name))]
LIMITED = ("frc_swerve_mk4i", "f1tenth", "pr2_base", "tugger_train", "swerve_module_off", "trailer_on_ice")
CUT_OFF = """return [...document.querySelectorAll('button, select, label, output, h1, h2, summary, dd, #hinges span')]
    .filter((each) => each.checkVisibility() && each.offsetWidth > 4 && !each.closest('.segments'))
    .filter((each) => each.scrollWidth > each.clientWidth + 1 && each.clientWidth > 0 && each.tagName !== 'SELECT')
    .map((each) => each.outerHTML.slice(0, 100));"""


def pose(page: Browser) -> list[float]:
    """Place of the centre of mass and heading, all digits."""
    return json.loads(page.js("return document.getElementById('figures').dataset.pose"))


def step(page: Browser, times: int) -> None:
    """Presses the button that takes 0.1 s."""
    page.js("for (let k = 0; k < arguments[0]; k++) document.getElementById('step').click()", times)


def most(page: Browser, slider: str) -> float:
    return float(page.js("return document.getElementById(arguments[0]).max", slider))


def shown(page: Browser, name: str) -> float:
    return float(page.text(name).replace("−", "-"))


def angles(page: Browser) -> list[str]:
    """What the panel tells of each hinge."""
    rows = "[...document.querySelectorAll('#hinges .value')]"
    found: list[str] = page.js(f"return {rows}.map((each) => each.textContent)")
    return found


def exported(page: Browser, folder: Path) -> Path:
    """The scene with what was driven so far."""
    page.js("document.getElementById('export-toml').click()")
    (folder / "robot.toml").write_text(page.value("export-text"), encoding="utf-8")
    page.js("document.getElementById('export-close').click()")
    return folder / "robot.toml"


def choose(page: Browser, robot: str) -> None:
    """A robot that stands still, driven by its sliders."""
    page.choose("robot", robot)
    page.js("document.querySelector('[name=drive][value=velocity]').click()")
    page.js("const play = document.getElementById('play'); if (play.textContent === 'Pause') play.click()")
    page.click("restart")


def drive(page: Browser) -> None:
    """Ahead, to the left, and to the right."""
    page.choose("forward", str(0.6 * most(page, "forward")))
    page.choose("turn", str(0.3 * most(page, "turn")))
    step(page, 6)
    page.choose("turn", str(-0.5 * most(page, "turn")))
    step(page, 6)


def simulated(file: Path) -> list[float]:
    """The pose at the end, as laconic simulate has it."""
    columns = simulate(read_scene(file)).columns
    return [float(columns[name][-1]) for name in ("x_m", "y_m", "heading_rad")]


BY_PACKAGE = """
import { readFileSync } from "node:fs";
import { load } from "BINDING/hinges.js";
const scene = JSON.parse(readFileSync("scene.json", "utf8")), laconic = await load();
const robot = laconic.robot(scene), step = scene.run.step_s, end = Math.round(scene.run.duration_s / step);
const all = scene.input.flatMap(({ t_s }) => t_s.map((t) => Math.round(t / step)));
const ticks = [...new Set(all)].sort((a, b) => a - b);
const at = ({ t_s, value }, tick) => value[t_s.findLastIndex((t) => Math.round(t / step) <= tick)] ?? 0;
for (const tick of [0, ...ticks.filter((each) => each > 0), end]) {
  robot.run(tick - robot.steps);
  const input = {}, wheels = robot.wheelCount;
  for (const each of scene.input) {
    const [name, item] = each.signal.split(/[[\\]]/), value = at(each, tick);
    if (item === undefined) input[name] = value;
    else if (isNaN(item)) (input[name] ??= {})[item] = value;
    else (input[name] ??= new Array(name === "steering_twist" ? 3 : wheels).fill(0))[item - 1] = value;
  }
  robot.setInput(input);
}
const { x_m, y_m, heading_rad } = robot.outputs();
console.log(JSON.stringify([x_m, y_m, heading_rad]));
"""


def by_package(file: Path) -> list[float]:
    """The pose at the end, by the npm package with the scene's inputs, which are steps."""
    folder = file.parent
    (folder / "scene.json").write_text(json.dumps(tomllib.loads(file.read_text(encoding="utf-8"))), encoding="utf-8")
    binding = (build_dir() / "npm/laconic/src").as_uri()
    (folder / "script.mjs").write_text(BY_PACKAGE.replace("BINDING", binding), encoding="utf-8")
    done = subprocess.run(["node", "script.mjs"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.skipif(shutil.which("node") is None, reason="needs node")
def test_a_car_that_is_driven_ends_where_package_and_command_bring_it_bit_by_bit(page, tmp_path):
    choose(page, "f1tenth")
    drive(page)
    file = exported(page, tmp_path)
    assert pose(page)[0] > 0.2
    assert by_package(file) == pose(page)
    assert simulated(file) == pose(page)


@pytest.mark.parametrize(("robot", "lost"), [("swerve_module_off", "wheels 1, 2 slip"),
                                             pytest.param("trailer_on_ice", "wheels 1, 2, 3, 4, 5, 6 slip",
                                                          marks=pytest.mark.nightly)])
def test_wheels_that_slip_on_hinges_are_shown_and_end_where_the_command_brings_them_bit_by_bit(page, robot, lost,
                                                                                               tmp_path):
    page.choose("robot", robot)
    step(page, 20 if robot == "swerve_module_off" else 44)
    assert page.text("grip-note") == lost and page.text("margin").endswith(" J")
    rows: list[str] = page.js("return [...document.querySelectorAll('#grip .lost .value')].map((e) => e.textContent)")
    assert len(rows) == lost.count(",") + 1 and all(re.fullmatch(r"slip \d+\.\d\d m/s, 100 %", row) for row in rows)
    assert ("trailer folds beyond 90°" in page.text("hinges-note")) == (robot == "trailer_on_ice")
    assert simulated(exported(page, tmp_path)) == pose(page)  # its own drive
    choose(page, robot)
    drive(page)
    assert page.text("banner") == ""
    assert simulated(exported(page, tmp_path)) == pose(page)


@pytest.mark.nightly
def test_a_start_that_the_robot_without_slip_refuses_ends_that_one_alone(page):
    choose(page, "trailer_on_ice")
    page.choose("turn", str(most(page, "turn")))
    step(page, 2)
    assert page.text("banner") == "" and page.text("ideal-note").startswith("initial.velocity_body_m_per_s: this start")


# ---- hinges that turn by themselves, which no built-in scene has

SERVO = """steered = "servo"
servo_gain_Nm_per_rad = 20.0
servo_damping_Nms = 0.5
servo_limit_Nm = 5.0
"""
TURNED_BY = {"servo": SERVO, "prescribed": 'steered = "prescribed"\nrate_limit_rad_per_s = 12.0\n',
             "rates": 'steered = "prescribed"\n',
             "motor": 'steered = "motor"\nsteering_gain_Nm_per_V = 0.5\nsteering_damping_Nms = 0.3\n'}


def without_inputs(text: str) -> str:
    return re.sub(r"(?ms)^\[\[input\]\].*?(?=^\[(?!\[input))", "", text)


@pytest.fixture(scope="module")
def own_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page with swerves whose modules turn by themselves, and a car with two servos."""
    if not PAGE.exists():
        pytest.skip("the page was not built: no clang with wasm-ld")
    folder = tmp_path_factory.mktemp("own_page")
    scenes = folder / "scenes"
    scenes.mkdir()
    shutil.copy(scene_path("robotino2"), scenes)
    swerve = without_inputs(scene_path("swerve_module_off").read_text()).replace("axle_deg = -84.0", "axle_deg = -90.0")
    swerve = re.sub(r"(?m)^(rate_limit_rad_per_s = 12.0)\n", "", swerve)
    for name, keys in TURNED_BY.items():
        (scenes / f"{name}.toml").write_text(swerve.replace('steered = "coordinated"\n', keys))
    front, _, rear = swerve.partition('name = "rear_left"')
    car = f"{front}name = \"rear_left\"{rear}".replace('steered = "coordinated"\n', SERVO, 2)
    car = re.sub(r'steered = "coordinated"\nname = "\w+"\n(.*\n.*\n)mass_kg = 1.0\nyaw_inertia_kgm2 = 0.002\n',
                 r"\1axle_deg = -90.0\n", car)
    (scenes / "car.toml").write_text(car)
    make_page(SOURCE_DIR / "web/page", build_dir() / "npm/laconic/src", scenes, build_dir() / "page/native_hash.txt",
              folder / "laconic.html")
    return folder


@pytest.mark.parametrize("robot", [name if name == "servo" else pytest.param(name, marks=pytest.mark.nightly)
                                   for name in TURNED_BY])
def test_velocity_drives_a_swerve_whose_modules_turn_by_themselves(window, own_page, robot, tmp_path):
    window.open(own_page / "laconic.html", prefers_reduced_motion="reduce")
    choose(window, robot)
    assert window.js("return document.getElementById('left').checkVisibility()")
    label = window.js("return document.getElementById('turn').previousElementSibling.textContent")
    assert label == "Turn"
    for slider, part in (("left", 0.3), ("left", -0.3)):
        window.choose(slider, str(part * most(window, slider)))
        step(window, 20)
        assert shown(window, "now-left") == pytest.approx(part * most(window, slider), rel=0.03)
        assert abs(shown(window, "now-forward")) < 0.03 and abs(shown(window, "now-turn")) < 0.03
        turned = [float(each.partition("°")[0].replace("−", "-")) for each in angles(window)]
        assert [abs(each) for each in turned] == pytest.approx([90.0] * 4, abs=1.5)
    window.choose("left", "0")
    window.choose("turn", str(0.3 * most(window, "turn")))
    step(window, 20)
    assert shown(window, "now-turn") == pytest.approx(0.3 * most(window, "turn"), rel=0.03)
    assert window.text("banner") == "" and window.errors() == []
    assert simulated(exported(window, tmp_path)) == pytest.approx(pose(window), rel=1e-12, abs=1e-12)


@pytest.mark.nightly
def test_a_car_with_a_servo_for_each_wheel_steers_both_along_one_circle(window, own_page):
    window.open(own_page / "laconic.html", prefers_reduced_motion="reduce")
    choose(window, "car")
    label = window.js("return document.getElementById('turn').previousElementSibling.textContent")
    assert label == "Steer" and not window.js("return document.getElementById('left').checkVisibility()")
    window.choose("forward", str(0.3 * most(window, "forward")))
    window.choose("turn", str(0.3 * most(window, "turn")))
    step(window, 20)
    left, right = (math.radians(float(each.partition("°")[0])) for each in angles(window))
    assert 1 / math.tan(right) - 1 / math.tan(left) == pytest.approx(0.4 / 0.4, rel=0.02)  # track over wheelbase
    assert shown(window, "now-turn") > 0.05 and window.errors() == []


@pytest.mark.nightly
def test_each_module_that_turns_by_itself_has_a_slider_of_its_angle(window, own_page):
    window.open(own_page / "laconic.html", prefers_reduced_motion="reduce")
    choose(window, "servo")
    window.click("[name=drive][value=wheels]")
    offered = window.js("return [...document.querySelectorAll('#wheel-sliders input')].map((each) => each.id)")
    names = ("front_left", "front_right", "rear_left", "rear_right")
    assert offered == [*(f"wheel-{k}" for k in range(4)), *(f"hinge-{name}" for name in names)]
    window.choose("hinge-rear_left", "0.5")
    step(window, 10)
    assert [round(float(each.partition("°")[0])) for each in angles(window)] == [0, 0, 29, 0]


@pytest.mark.nightly
def test_one_module_that_is_straightened_lets_all_wheels_hold(page, tmp_path):
    page.choose("robot", "swerve_module_off")
    step(page, 20)
    text = exported(page, tmp_path).read_text(encoding="utf-8")
    assert text.count("axle_deg = -84.0") == 1
    (tmp_path / "robot.toml").write_text(text.replace("axle_deg = -84.0", "axle_deg = -90.0"), encoding="utf-8")
    straight = simulate(read_scene(tmp_path / "robot.toml")).columns
    assert abs(float(straight["heading_rad"][-1])) < 1e-6 < abs(pose(page)[2])


@pytest.mark.nightly
@pytest.mark.parametrize("robot", HINGED)
def test_every_scene_with_hinges_is_offered_driven_and_exported_to_the_same_motion(page, robot, tmp_path):
    page.choose("robot", robot)
    own, again = read_scene(robot), read_scene(exported(page, tmp_path))
    assert (again.vehicle, again.hinges, again.initial) == (own.vehicle, own.hinges, own.initial)
    assert (again.inputs, again.run) == (own.inputs, own.run)
    step(page, 30)
    assert page.text("banner") == ""
    assert simulated(exported(page, tmp_path)) == pose(page)  # its own drive
    choose(page, robot)
    drive(page)
    assert page.text("banner") == ""
    assert simulated(exported(page, tmp_path)) == pytest.approx(pose(page), rel=1e-12, abs=1e-12)
    assert ("limit of its rate" in page.text("hinges-note")) == (robot in LIMITED)


@pytest.mark.nightly
@pytest.mark.parametrize(("robot", "turns"), [("f1tenth", True), ("tugger_train", True), ("wheel_loader", True),
                                              ("tricycle_agv", True), ("mir_like", False), ("frc_swerve_mk4i", False)])
def test_sliders_give_the_speed_and_turn_to_the_left(page, robot, turns):
    choose(page, robot)
    page.choose("forward", str(0.5 * most(page, "forward")))
    step(page, 150 if robot == "wheel_loader" else 60)
    assert shown(page, "now-forward") == pytest.approx(0.5 * most(page, "forward"), rel=0.05)
    assert abs(shown(page, "now-turn")) < 0.01
    page.choose("turn", str(0.4 * most(page, "turn")))
    step(page, 30)
    assert shown(page, "now-turn") > 0.05
    label = page.js("return document.getElementById('turn').previousElementSibling.textContent")
    assert label == ("Steer" if turns else "Turn")
    assert page.js("return document.getElementById('left').checkVisibility()") == (robot == "frc_swerve_mk4i")


@pytest.mark.nightly
def test_a_swerve_goes_aside_and_back_without_turning_its_wheels_by_a_half_turn(page):
    choose(page, "frc_swerve_mk4i")
    page.choose("left", str(0.5 * most(page, "left")))
    step(page, 20)
    assert shown(page, "now-left") == pytest.approx(0.5 * most(page, "left"), rel=0.02)
    before = angles(page)
    page.choose("left", str(-0.5 * most(page, "left")))
    step(page, 20)
    assert shown(page, "now-left") == pytest.approx(-0.5 * most(page, "left"), rel=0.02)
    assert angles(page) == before


@pytest.mark.nightly
def test_keys_drive_and_steer_while_they_are_held(page):
    choose(page, "tugger_train")
    page.click("stage")
    parts = """return ['forward', 'turn'].map((id) => document.getElementById(id))
        .map((each) => Math.round(10 * each.value / each.max))"""
    for key, found in (("w", [7, 0]), ("s", [-7, 0]), ("a", [0, 7]), ("d", [0, -7]), ("Left", [0, 7]), ("e", [0, -7])):
        page.key(("keyDown", key))
        held = page.js(parts)
        page.key(("keyUp", key))
        assert (held, page.js(parts)) == (found, [0, 0]), key


@pytest.mark.nightly
@pytest.mark.parametrize(("robot", "knobs"), [
    ("f1tenth", {"wheel-0": " V", "wheel-1": " V", "steering": " °"}),
    ("tricycle_agv", {"wheel-0": " V", "hinge-front": " V"}),
    ("tugger_train", {"wheel-0": " V", "wheel-1": " V", "hinge-front": " °"}),
    ("wheel_loader", {**{f"wheel-{k}": " V" for k in range(4)}, "hinge-rear": " °/s"}),
    ("frc_swerve_mk4i", {**{f"wheel-{k}": " V" for k in range(4)}, **{f"twist-{k}": " " for k in range(3)}})])
def test_each_wheel_and_each_hinge_has_a_slider_of_what_it_takes(page, robot, knobs):
    choose(page, robot)
    page.click("[name=drive][value=wheels]")
    offered = page.js("return [...document.querySelectorAll('#wheel-sliders input')].map((each) => each.id)")
    assert offered == list(knobs)
    for knob, unit in knobs.items():
        page.choose(knob, str(0.3 * most(page, knob)))
        assert page.js("return document.querySelector(`#${arguments[0]} + output`).textContent", knob).endswith(unit)
    step(page, 4)
    assert page.text("banner") == ""
    assert any(set(text) & set("123456789") for text in angles(page))


@pytest.mark.nightly
def test_a_hinge_at_its_stop_is_told_in_one_line_and_another_command_goes_on(page, tmp_path):
    choose(page, "tricycle_agv")
    page.click("[name=drive][value=wheels]")
    page.choose("hinge-front", str(0.1 * most(page, "hinge-front")))  # slowly, so that it can turn back at once
    step(page, 240)
    told, stopped = page.text("banner"), page.text("time")
    assert told.startswith("vehicle.wheel[1] (front): comes to its stop at 1.57") and "\n" not in told
    step(page, 1)
    assert page.text("time") == stopped
    page.choose("hinge-front", str(-most(page, "hinge-front")))
    step(page, 2)
    assert page.js("return document.getElementById('banner').hidden")
    assert simulated(exported(page, tmp_path)) == pose(page)


@pytest.mark.nightly
def test_a_twist_without_a_direction_is_refused_and_not_recorded(page, tmp_path):
    choose(page, "frc_swerve_mk4i")
    page.click("[name=drive][value=wheels]")
    page.choose("wheel-0", "2")
    step(page, 2)
    page.choose("twist-0", "0")
    step(page, 1)
    assert "the twist gives this steered" in page.text("banner")
    page.choose("twist-1", "1")
    step(page, 2)
    assert page.js("return document.getElementById('banner').hidden")
    assert simulated(exported(page, tmp_path)) == pytest.approx(pose(page), abs=1e-12)


@pytest.mark.nightly
def test_trailers_leave_paths_and_one_that_folds_is_told(page):
    choose(page, "tugger_train")
    page.choose("forward", str(most(page, "forward")))
    step(page, 20)
    assert page.text("legend-trails") == "first, second, third"
    page.choose("turn", str(most(page, "turn")))
    step(page, 60)
    assert "first folds beyond 90° since" in page.text("hinges-note")
    names = page.js("return [...document.querySelectorAll('#hinges .name')].map((each) => each.textContent)")
    assert names == ["front", "first", "second", "third"]
    assert page.text("energy").endswith(" J")


@pytest.mark.nightly
def test_what_robots_with_hinges_do_not_have_is_out_of_the_way_and_comes_back(page):
    hidden = """return ['grip-panel', 'friction-row', 'error-line', 'hinges-panel'].map((id) =>
        document.getElementById(id).hidden)"""
    disabled = "return ['draw-view', 'export-c'].map((id) => document.getElementById(id).disabled)"
    page.click("[name=view][value=draw]")
    page.choose("robot", "mir_like")
    assert not page.js("return document.getElementById('stage').hidden")
    assert (page.js(hidden), page.js(disabled)) == ([True, True, True, False], [True, True])
    assert "moebius-4" in page.js("return [...document.getElementById('method').options].map((each) => each.value)")
    page.choose("robot", "robotino2")
    assert (page.js(hidden), page.js(disabled)) == ([False, False, False, True], [False, False])
    assert "taylor-8" in page.js("return [...document.getElementById('method').options].map((each) => each.value)")


@pytest.mark.nightly
def test_numbers_methods_and_steps_take_the_same_drive_again(page):
    choose(page, "wheelchair")
    drive(page)
    seen: list[Any] = [pose(page)]
    page.choose("step-size", "0.01")
    seen.append(pose(page))
    page.choose("method", "moebius-4")
    seen.append(pose(page))
    page.type("field-vehicle.mass_kg", "80")
    seen.append(pose(page))
    page.type("field-ground.slope_rad", "4")
    seen.append(pose(page))
    assert page.text("banner") == "" and len({tuple(each) for each in seen}) == len(seen)
    page.type("field-vehicle.mass_kg", "0")
    assert page.text("field-vehicle.mass_kg-error") == "0 is not positive; give a value above 0"
    page.type("field-vehicle.mass_kg", "60")
    page.click("fleet")
    step(page, 2)
    assert page.text("figures").startswith("21 vehicles")


@pytest.mark.nightly
@pytest.mark.parametrize(("width", "height"), [(390, 844), (1400, 900)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_cut_off_narrow_or_wide_light_or_dark(window, width, height, scheme):
    window.open(PAGE, width, height, prefers_color_scheme=scheme, prefers_reduced_motion="reduce")
    for robot in ("tugger_train", "pr2_base"):
        choose(window, robot)
        drive(window)
        window.shot(SHOTS / f"page_{robot}_{width}_{scheme}.png", whole=width < 600)
        assert window.js("return document.documentElement.scrollWidth") <= width
        assert window.js(CUT_OFF) == []
    assert window.errors() == []


@pytest.mark.nightly
def test_twenty_more_trains_move_within_a_frame_of_the_display(page):
    page.choose("robot", "tugger_train")
    page.click("fleet")
    page.click("play")
    page.wait("return parseFloat(document.getElementById('time').textContent) > 1.5")
    cost = float(page.js("return document.getElementById('figures').dataset.cost_ms"))
    print(f"21 trains: {cost:.2f} ms of computing and drawing a frame")
    assert page.text("figures").startswith("21 vehicles") and cost < 1000 / 60
