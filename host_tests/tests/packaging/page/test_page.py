"""The page in a real Chromium: every control does what it says."""

from __future__ import annotations

import json
import subprocess
from itertools import pairwise

import pytest

from laconic.base.paths import build_dir, scene_names
from laconic.scene.methods import EXPLICIT, STIFF_4
from laconic_build.page.browser import Browser

PAGE = build_dir() / "page/laconic.html"
DIRECTIONS = ("forward", "left", "turn")
FRAME_MS = 1000 / 60


def pose(page: Browser) -> list[float]:
    return json.loads(page.js("return document.getElementById('figures').dataset.pose"))


def seconds(page: Browser) -> float:
    return float(page.text("time").removesuffix(" s"))


def step(page: Browser, times: int = 1) -> None:
    """Presses the button that takes 0.1 s."""
    page.js("for (let k = 0; k < arguments[0]; k++) document.getElementById('step').click()", times)


def test_it_opens_from_disk_in_one_file_without_network_and_has_the_native_cores_hash(page):
    native = subprocess.run([build_dir() / "core_c/tests/trajectory_hash_double_shipped"], capture_output=True,
                            text=True, check=True).stdout.split()
    print(f"hash of the native core {native}, in the browser {page.text('hash')}; {PAGE.stat().st_size} bytes")
    assert page.text("hash").split() == native
    assert page.text("hash-verdict") == "Same bits as the native core"
    fetched = page.js("return performance.getEntriesByType('resource').map((each) => each.name)")
    assert [name for name in fetched if not name.startswith(("blob:", "data:"))] == []


@pytest.mark.nightly
def test_every_scene_of_the_project_can_be_chosen_and_runs(page):
    offered = page.js("return [...document.getElementById('robot').options].map((each) => each.value)")
    assert sorted(offered) == sorted([*scene_names(), "own"])
    for name in offered:
        page.choose("robot", name)
        step(page, 3)
        assert seconds(page) == pytest.approx(0.3), name
        assert page.js("return document.getElementById('banner').hidden"), page.text("banner")
        assert all(isinstance(number, float | int) for number in pose(page)), name


@pytest.mark.nightly
def test_play_pause_step_speed_and_restart(page):
    assert page.text("play") == "Play"  # at rest, as people who want less motion asked for
    page.choose("speed", "2")
    page.click("play")
    page.wait("return parseFloat(document.getElementById('time').textContent) > 0.3")
    page.click("play")
    held = page.text("time")
    page.click("step")
    assert seconds(page) == pytest.approx(float(held.removesuffix(" s")) + 0.1, abs=0.011)
    page.click("restart")
    page.wait("return document.getElementById('time').textContent === '0.00 s'")


@pytest.mark.nightly
def test_it_moves_at_once_where_nobody_asked_for_less_motion(window):
    window.open(PAGE)
    assert window.text("play") == "Pause"
    window.wait("return parseFloat(document.getElementById('time').textContent) > 0.1")
    assert window.errors() == []


@pytest.mark.nightly
def test_the_scenes_own_drive_ends_at_its_end_and_begins_anew(page):
    page.choose("robot", "skid_steer")
    step(page, 45)
    assert seconds(page) == pytest.approx(4.0)
    page.click("play")
    page.wait("const t = parseFloat(document.getElementById('time').textContent); return t > 0 && t < 2")
    page.click("play")
    step(page, 45)
    page.choose("robot", "robotino2")  # whose own drive begins
    step(page)
    assert seconds(page) == pytest.approx(0.1)


@pytest.mark.nightly
def test_sliders_drive_in_each_direction_that_the_wheels_allow(page):
    for index, name in enumerate(DIRECTIONS):
        page.choose("robot", "robotino2")
        most = float(page.js("return document.getElementById(arguments[0]).max", name))
        page.choose(name, str(most / 2))
        assert page.js("return document.querySelector('input[name=drive]:checked').value") == "velocity"
        step(page, 15)
        shown = float(page.text(f"now-{name}").replace("−", "-"))
        assert shown == pytest.approx(most / 2, abs=0.01, rel=0.03), name
        others = [float(page.text(f"now-{other}").replace("−", "-")) for other in DIRECTIONS if other != name]
        assert max(map(abs, others)) < 0.02 * (1 + index), name
    page.click("stop")
    assert [float(page.value(name)) for name in DIRECTIONS] == pytest.approx([0, 0, 0])
    page.choose("robot", "turtlebot3_burger")
    assert page.js("return document.getElementById('left').disabled")


@pytest.mark.nightly
@pytest.mark.parametrize(("robot", "unit", "shown"), [
    ("robotino2", "V", "now-turn"), ("canopen_agv", "N·m", "now-forward")])
def test_each_wheel_has_a_slider_of_voltage_or_without_motors_of_torque(page, robot, unit, shown):
    page.choose("robot", robot)
    page.click("[name=drive][value=wheels]")
    wheels = page.js("return document.querySelectorAll('#wheel-sliders input').length")
    for wheel in range(wheels):
        page.choose(f"wheel-{wheel}", str(float(page.js("return document.getElementById(arguments[0]).max",
                                                         f"wheel-{wheel}")) / 2))
        assert page.js(f"return document.querySelector('#wheel-{wheel} + output').textContent").endswith(unit)
    step(page, 5)
    assert float(page.text(shown).replace("−", "-")) > 0.05
    page.click("stop")
    assert [float(page.value(f"wheel-{wheel}")) for wheel in range(wheels)] == pytest.approx([0] * wheels)


KEYS = {"w": (0, 1), "s": (0, -1), "a": (1, 1), "d": (1, -1), "q": (2, 1), "e": (2, -1), "Up": (0, 1), "Down": (0, -1),
        "Left": (2, 1), "Right": (2, -1)}


def test_keys_drive_while_they_are_held(page):
    page.click("stage")
    for key, (direction, sign) in KEYS.items():
        page.key(("keyDown", key))
        values = [float(page.value(name)) for name in DIRECTIONS]
        page.key(("keyUp", key))
        assert sign * values[direction] > 0, key
        assert [value for k, value in enumerate(values) if k != direction] == pytest.approx([0, 0]), key
        assert [float(page.value(name)) for name in DIRECTIONS] == pytest.approx([0, 0, 0]), key
    page.choose("robot", "turtlebot3_burger")
    page.click("stage")
    page.key(("keyDown", "a"))
    assert float(page.value("turn")) > 0  # no way to the side: it turns
    page.key(("keyUp", "a"))


@pytest.mark.nightly
@pytest.mark.parametrize("clicked", ["play", "restart", "zoom-in", "friction", "stop"])
def test_keys_drive_after_a_click_on_what_needs_none_of_them(page, clicked):
    page.click(clicked)
    for key in ("w", "Up"):
        page.key(("keyDown", key))
        assert float(page.value("forward")) > 0, key
        page.key(("keyUp", key))
        assert float(page.value("forward")) == 0, key


@pytest.mark.nightly
def test_letters_drive_after_a_click_on_a_slider_whose_arrows_stay_its_own(page):
    page.click("[name=drive][value=velocity]")
    page.click("turn")
    page.key(("keyDown", "w"))
    assert float(page.value("forward")) > 0
    page.key(("keyUp", "w"))
    before = float(page.value("turn"))
    page.press("Up")
    assert float(page.value("turn")) > before
    assert float(page.value("forward")) == 0


@pytest.mark.nightly
@pytest.mark.parametrize("field", ["field-vehicle.mass_kg", "speed"])
def test_keys_leave_fields_alone(page, field):
    page.js("document.getElementById(arguments[0]).focus()", field)
    page.press("w", "d")
    assert [float(page.value(name)) for name in DIRECTIONS] == pytest.approx([0, 0, 0])


@pytest.mark.nightly
def test_a_gamepads_sticks_drive_and_let_go(page):
    page.js("window.axes = [0, -1, -0.5, 0]; navigator.getGamepads = () => [{ axes: window.axes }]")
    page.wait("return Number(document.getElementById('forward').value) > 0")
    assert not page.js("return document.getElementById('gamepad').hidden")
    assert float(page.value("turn")) == pytest.approx(float(page.js("return document.getElementById('turn').max")) / 2,
                                                      rel=0.02)
    page.js("window.axes = [0, 0.05, 0, 0]")
    page.wait("return Math.abs(Number(document.getElementById('forward').value)) < 1e-9")


@pytest.mark.nightly
def test_the_view_comes_closer_and_goes_farther(page):
    def picture() -> str:
        page.call("/execute/async", {"args": [], "script": """const done = arguments[0];
            requestAnimationFrame(() => requestAnimationFrame(done));"""})
        return str(page.js("return document.getElementById('stage').toDataURL()"))
    first = picture()
    page.click("zoom-in")
    closer = picture()
    page.click("zoom-out")
    page.click("zoom-out")
    assert len({first, closer, picture()}) == 3


@pytest.mark.nightly
def test_methods_and_steps_take_the_same_drive_with_their_own_error(page):
    step(page)
    page.choose("forward", "0.3")
    page.choose("turn", "1")
    step(page, 9)
    page.choose("method", STIFF_4)
    errors = {}
    for step_s in ("0.001", "0.01", "0.05", "0.1"):
        page.choose("step-size", step_s)
        assert seconds(page) == pytest.approx(1.0)
        errors[step_s] = page.text("error-now")
    assert len(set(errors.values())) == len(errors)
    assert errors["0.001"] == "< 0.1 nm" and errors["0.1"].endswith("µm")
    page.choose("step-size", "0.002")
    for method in page.js("return [...document.getElementById('method').options].map((each) => each.value)"):
        page.choose("method", method)
        assert page.text("method-error") == ""
        assert seconds(page) == pytest.approx(1.0), method


@pytest.mark.nightly
def test_what_a_method_cannot_take_is_told_beside_it_in_the_cores_words(page):
    page.choose("robot", "turtlebot3_burger")
    page.choose("method", EXPLICIT)
    page.choose("step-size", "0.1")
    assert page.text("method-error").startswith("0.1 s is unstable with this method because the motors damp too fast")
    page.choose("step-size", "0.001")
    assert page.text("method-error") == ""
    page.click("friction")
    assert "knows neither ground friction" in page.text("method-error")


@pytest.mark.nightly
def test_error_over_cost_is_measured_for_every_method(page):
    page.js("for (const each of document.querySelectorAll('.inner')) each.open = true")
    page.wait("return document.getElementById('accuracy-note').textContent.startsWith('Error of the place')")
    rows = page.js("""return [...document.querySelectorAll('#accuracy-rows tr')].map((row) =>
        [...row.children].map((cell) => cell.textContent))""")
    methods = page.js("return [...document.getElementById('method').options].map((each) => each.value)")
    assert {row[0] for row in rows} == set(methods)
    steps = [row[1] for row in rows if row[0] == "auto"]
    assert steps == ["100 ms", "50 ms", "20 ms", "10 ms", "5 ms", "2 ms", "1 ms"]
    costs = [float(row[3].split()[0]) for row in rows if row[0] == "auto" and "·" not in row[3]]
    assert min(costs) > 0
    of_auto = (f"{row[1]}: {row[2]}, {row[3]};" for row in rows if row[0] == "auto")
    print("auto, error and cost for a simulated second:", *of_auto)
    page.choose("forward", "0.2")
    step(page)
    page.click("study")
    page.wait("return document.getElementById('accuracy-note').textContent === 'Measuring …'")


@pytest.mark.nightly
def test_the_ground_can_have_friction_and_the_robot_without_slip_goes_beside(page):
    page.choose("robot", "robotino2")
    page.click("friction")
    assert not page.js("return document.getElementById('legend-ideal').hidden")
    page.type("field-ground.friction_coefficient", "0.01")
    step(page, 10)
    assert "slip" in page.text("grip-note")
    with_ideal = page.text("figures")
    page.click("ideal")
    assert page.js("return document.getElementById('legend-ideal').hidden")
    assert with_ideal.startswith("2 vehicles") and page.text("figures").startswith("1 vehicle,")
    for field in ("roller_drag", "axle_friction_Nm"):
        before = pose(page)
        page.type(f"field-ground.{field}", "0.05")
        assert pose(page) != before, field
    page.click("friction")
    assert page.js("return document.getElementById('ideal-row').hidden")
    assert page.value("field-vehicle.friction_coefficient") == "0.01"  # the margin goes on being judged by it
    page.choose("robot", "skid_steer")
    page.click("ideal")
    assert "fixed wheels on parallel axle lines only drive straight" in page.text("ideal-note")


@pytest.mark.nightly
def test_a_slope_pulls_the_robot_down(page):
    page.choose("robot", "own")
    page.click("[name=view][value=drive]")
    page.type("field-ground.slope_rad", "10")
    page.type("field-ground.slope_heading_rad", "180")
    step(page, 3)
    assert pose(page)[0] > 0.01


NUMBERS = ("vehicle.mass_kg", "vehicle.yaw_inertia_kgm2", "vehicle.wheel_radius_m", "vehicle.wheel_inertia_kgm2",
           "vehicle.com_x_m", "vehicle.com_y_m", "vehicle.motor.resistance_ohm",
           "vehicle.motor.torque_constant_Nm_per_A", "vehicle.motor.back_emf_Vs_per_rad", "vehicle.motor.gear_ratio",
           "vehicle.motor.viscous_friction_Nms", "vehicle.motor.rotor_inertia_kgm2", "vehicle.drive.supply_V",
           "vehicle.drive.current_limit_A", "vehicle.payload.mass_kg")
SOME = {"vehicle.com_x_m": "0.03", "vehicle.com_y_m": "0.02", "vehicle.motor.viscous_friction_Nms": "1e-4",
        "vehicle.drive.supply_V": "4", "vehicle.drive.current_limit_A": "0.1", "vehicle.payload.mass_kg": "5"}


@pytest.mark.nightly
def test_every_number_of_the_robot_changes_how_the_same_drive_ends(page):
    page.js("for (const each of document.querySelectorAll('aside details')) each.open = true")
    step(page, 4)
    for path in NUMBERS:
        before = pose(page)
        text = SOME.get(path) or str(1.3 * float(page.value(f"field-{path}")))
        page.choose(f"field-{path}", text)
        assert seconds(page) == pytest.approx(0.4), path
        assert pose(page) != before, path


@pytest.mark.nightly
@pytest.mark.parametrize(("path", "text", "told"), [
    ("vehicle.mass_kg", "0", "0 is not positive; give a value above 0"),
    ("vehicle.yaw_inertia_kgm2", "-1", "-1 is not positive; give a value above 0"),
    ("vehicle.wheel_radius_m", "one", "“one” is no number; give one"),
    ("vehicle.mass_kg", "1,500", "“1,500” is 1500 or 1.500; give one of them"),
    ("vehicle.wheel_inertia_kgm2", "", "a number is missing; give one"),
    ("ground.slope_rad", "95", "give"),
])
def test_a_number_that_the_core_refuses_is_told_under_its_field_and_stops_the_robot(page, path, text, told):
    page.type(f"field-{path}", text)
    told_there = page.text(f"field-{path}-error")
    assert told in told_there
    assert page.text("banner") == f"{path}: {told_there}"
    assert page.js("return document.getElementById(arguments[0]).ariaInvalid", f"field-{path}") == "true"
    step(page)
    assert page.text("time") == "0.00 s"
    page.choose("robot", "robotino2")
    assert page.text(f"field-{path}-error") == ""


@pytest.mark.nightly
def test_twenty_more_vehicles_move_within_a_frame_of_the_display(page):
    page.choose("robot", "kuka_youbot")
    page.click("fleet")
    page.click("play")
    page.wait("return Number(document.getElementById('figures').dataset.vehicles) === 21")
    begin = page.js("return [Number(document.getElementById('figures').dataset.frames), performance.now()]")
    page.wait("return parseFloat(document.getElementById('time').textContent) > 1.5")
    end = page.js("return [Number(document.getElementById('figures').dataset.frames), performance.now()]")
    rate = 1000 * (end[0] - begin[0]) / (end[1] - begin[1])
    cost = float(page.js("return document.getElementById('figures').dataset.cost_ms"))
    print(f"21 vehicles: {cost:.2f} ms of computing and drawing a frame, {rate:.0f} frames a second")
    assert cost < FRAME_MS


@pytest.mark.nightly
def test_times_and_places_only_grow_while_it_plays(page):
    page.click("play")
    times = [page.wait(f"const t = parseFloat(document.getElementById('time').textContent); return t > {limit} && t")
             for limit in (0.1, 0.3, 0.5)]
    assert all(later > earlier for earlier, later in pairwise(times))
