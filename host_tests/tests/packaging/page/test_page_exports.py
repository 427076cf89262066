"""What the page exports gives the same bits: the scene in `laconic simulate`, the example in C from a compiler."""

from __future__ import annotations

import base64
import csv
import gzip
import hashlib
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import PAGE

from laconic import read_scene
from laconic.base.paths import SCENE_DIR, SOURCE_DIR, build_dir
from laconic.core import load
from laconic_build.page import page
from laconic_build.page.browser import BROWSER, DRIVER, Browser
from laconic_build.page.bundle import BadBundle, bundle, without_types
from laconic_build.page.figures import figures_of, page_figures, text_of
from laconic_build.page.page import TooLarge, make_page, scenes_in


def pose(page: Browser) -> list[float]:
    """Place of the centre of mass and heading, all digits."""
    return json.loads(page.js("return document.getElementById('figures').dataset.pose"))


def exported(page: Browser, name: str) -> str:
    page.click(f"export-{name}")
    text = page.value("export-text")
    page.click("export-close")
    return text


def step(page: Browser, times: int) -> None:
    page.js("for (let k = 0; k < arguments[0]; k++) document.getElementById('step').click()", times)


def drive(page: Browser) -> None:
    """Some of the scene's own drive, a change of wanted velocity, a wheel by hand; a slider's touch takes over."""
    step(page, 2)
    page.choose("forward", "0.2")
    step(page, 3)
    page.choose("turn", "-0.8")
    step(page, 3)
    page.click("[name=drive][value=wheels]")
    page.choose("wheel-0", "2")
    step(page, 4)


def simulated(scene_file: Path) -> list[float]:
    """The pose at the end of the run, by the host's own plant."""
    scene = read_scene(scene_file)
    core = load(scene.run.real)
    plant = scene.plant(core)
    for segment in scene.inputs_on_grid().segments():
        values: dict[str, list[float]] = {}
        for signal, value in segment.values.items():
            name, item = re.fullmatch(r"(\w+)\[(\d+)\]", signal).groups()
            values.setdefault(name, [0.0] * scene.wheel_count)[int(item) - 1] = value
        plant.run(values, segment.steps)
    return [plant.pose.x_m, plant.pose.y_m, plant.pose.heading_rad]


ROBOTS = ("robotino2", "skid_steer", "example_two_wheel_sizes", "canopen_agv", "own")


@pytest.mark.nightly
@pytest.mark.parametrize("robot", ROBOTS)
def test_the_exported_scene_runs_to_the_same_bits_and_so_does_the_example_in_c(page, robot, tmp_path):
    page.choose("robot", robot)
    if robot == "own":
        page.click("[name=view][value=drive]")
    drive(page)
    (tmp_path / "robot.toml").write_text(exported(page, "toml"), encoding="utf-8")
    assert simulated(tmp_path / "robot.toml") == pose(page)
    assert compiled(exported(page, "c"), tmp_path) == pose(page)


def compiled(text: str, folder: Path) -> list[float]:
    """What the example in C prints, linked with the core."""
    compiler = shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("needs a C compiler")
    assert re.search(r"^// cc .* robot\.c laconic/laconic\.c$", text, re.MULTILINE)  # how it is compiled
    (folder / "robot.c").write_text(text, encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-I", str(SOURCE_DIR / "core_c/include")]
    library = build_dir() / "core_c/liblaconic.a"
    done = subprocess.run([compiler, *flags, "robot.c", library, "-o", "robot"], cwd=folder, capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0, done.stderr
    printed = subprocess.run([folder / "robot"], capture_output=True, text=True, check=True).stdout
    return [float(number) for number in re.findall(r"-?\d[\d.e+-]*", printed)]


@pytest.mark.nightly
def test_laconic_simulate_takes_the_exported_scene(page, tmp_path):
    drive(page)
    file, table = tmp_path / "robot.toml", tmp_path / "robot.csv"
    file.write_text(exported(page, "toml"), encoding="utf-8")
    subprocess.run([sys.executable, "-m", "laconic", "simulate", str(file), "--out", str(table)], check=True,
                   capture_output=True)
    *_, last = csv.DictReader(table.read_text(encoding="utf-8").splitlines())
    found = [float(last[name]) for name in ("x_m", "y_m", "heading_rad")]
    print(f"at the end of the drive: page {pose(page)}, laconic simulate {found}")
    assert found == pose(page)


@pytest.mark.nightly
def test_before_anything_was_driven_the_scenes_own_drive_is_exported(page, tmp_path):
    (tmp_path / "robot.toml").write_text(exported(page, "toml"), encoding="utf-8")
    own, again = read_scene("robotino2"), read_scene(tmp_path / "robot.toml")
    assert again.vehicle == own.vehicle and again.run == own.run
    assert [(each.signal, each.t_s, each.value) for each in again.inputs] == [
        (each.signal, each.t_s, each.value) for each in own.inputs]
    step(page, 100)
    whole = pose(page)
    assert compiled(exported(page, "c"), tmp_path) == whole


@pytest.mark.nightly
def test_every_scene_is_exported_as_one_that_is_read_again(page, tmp_path):
    for name in page.js("return [...document.getElementById('robot').options].map((each) => each.value)"):
        page.choose("robot", name)
        page.js("document.getElementById('export-toml').click()")
        (tmp_path / f"{name}.toml").write_text(page.value("export-text"), encoding="utf-8")
        page.js("document.getElementById('export-close').click()")
        again = read_scene(tmp_path / f"{name}.toml")
        if name != "own":
            assert again.vehicle == read_scene(name).vehicle, name
            assert again.initial == read_scene(name).initial, name


@pytest.mark.nightly
def test_an_export_is_saved_and_copied(page, tmp_path):
    page.chromium("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path), eventsEnabled=True)
    page.click("export-c")
    text = page.value("export-text")
    page.click("export-copy")
    assert page.wait("return document.getElementById('export-copy').textContent === 'Copied'")
    page.click("export-save")
    page.call("/execute/async", {"args": [], "script": "const done = arguments[0]; setTimeout(done, 300);"})
    page.click("export-close")
    assert (tmp_path / "robot.c").read_text(encoding="utf-8") == text


# ---- Numbers in the editor that were typed by mistake: the page goes on answering, and the robot comes back.

SET = """const field = document.getElementById(arguments[0]);
field.value = arguments[1];
for (const type of ['input', 'change']) field.dispatchEvent(new Event(type, {bubbles: true}));
window.drawn = false;
requestAnimationFrame(() => requestAnimationFrame(() => { window.drawn = true; }));"""


@pytest.mark.nightly
@pytest.mark.parametrize(("field", "number"), [
    ("field-vehicle.wheel_radius_m", "1e6"), ("field-vehicle.com_x_m", "1e6"), ("field-vehicle.com_y_m", "1e308")])
def test_a_length_typed_by_mistake_does_not_stop_the_page(window, field, number):
    window.open(PAGE, prefers_reduced_motion="reduce")
    window.js("document.querySelector('input[name=view][value=draw]').click()")
    before = window.js("return document.getElementById(arguments[0]).value", field)
    for value in (number, before):
        window.js(SET, field, value)
        window.wait("return window.drawn")
    assert window.value(field) == before
    assert window.errors() == []


@pytest.mark.nightly
@pytest.mark.parametrize("mass, where", [("1e308", "vehicle.mass_kg: "), ("1e-300", "")], ids=["1e308", "1e-300"])
def test_a_mass_out_of_reason_is_refused_below_its_field_in_the_cores_words(window, mass, where):
    window.open(PAGE, prefers_reduced_motion="reduce")
    window.type("field-vehicle.mass_kg", mass)
    told = "a result leaves the range of double precision; check inputs and units"
    assert (window.text("field-vehicle.mass_kg-error"), window.text("banner")) == (told, where + told)
    window.js("document.getElementById('step').click()")
    assert window.text("time") == "0.00 s"
    assert "NaN" not in window.js("return document.body.innerText") and window.errors() == []


# ---- The command that prints what the page costs counts frames as they were, and the page has time to spare.

FRAME_MS = 1000.0 / 60.0


@pytest.mark.nightly
def test_frames_that_the_display_showed_without_the_page_are_counted():
    at_rest = [FRAME_MS * k for k in range(120)]
    shown = [k for k in range(300) if k not in (50, 100, 101)]
    found = figures_of(390, 21, at_rest, [FRAME_MS * k for k in shown], [2.0] * 290 + [30.0] * 7, 1.5)
    assert (found.left_out, found.frames) == (3, len(shown) - 1)
    assert found.worst_interval_ms == pytest.approx(3.0 * FRAME_MS)
    assert found.rate_Hz == pytest.approx(60.0) and found.display_ms == pytest.approx(FRAME_MS)
    assert (found.frame_ms, found.frame_99_ms, found.worst_frame_ms) == (2.0, 30.0, 30.0)
    assert found.main_thread_ms == pytest.approx(1500.0 / len(shown))
    assert "60.0 frames/s" in text_of(found) and "3 of 299 frames left out" in text_of(found)


@pytest.mark.nightly
def test_a_busy_machine_does_not_slow_the_display_down():
    late = [FRAME_MS * k for k in range(120) if k % 3]  # a third of the frames at rest came late
    assert figures_of(390, 21, late, late, [1.0] * 80, 0.1).display_ms == pytest.approx(FRAME_MS)


@pytest.mark.nightly
@pytest.mark.skipif(not (PAGE.exists() and BROWSER and DRIVER), reason="needs the page, chromium and chromedriver")
def test_the_page_needs_less_than_a_frame_of_the_processor_at_both_widths(capsys):
    page_figures(PAGE, 1.0, "kuka_youbot", as_json=True)
    found = json.loads(capsys.readouterr().out)
    assert (found["bytes"], found["sha256"]) == (PAGE.stat().st_size, hashlib.sha256(PAGE.read_bytes()).hexdigest())
    assert found["bits"].startswith("Same bits as the native core")
    assert [(row["width"], row["vehicles"]) for row in found["widths"]] == [(390, 21), (1400, 21)]
    for row in found["widths"]:
        assert row["frames"] > 5
        assert row["main_thread_ms"] < FRAME_MS  # of processor time, whatever else the machine does


# ---- How the page is made: the same bytes at every run, and modules that the bundler cannot join are told.

SOURCES = SOURCE_DIR / "web" / "page"
BINDING = build_dir() / "npm/laconic/src"
built = pytest.mark.skipif(not PAGE.exists(), reason="the page was not built: no clang with wasm-ld")


def make(out: Path) -> bytes:
    make_page(SOURCES, BINDING, SCENE_DIR, PAGE.parent / "native_hash.txt", out)
    return out.read_bytes()


@built
def test_making_it_again_gives_the_same_bytes(tmp_path):
    assert make(tmp_path / "again.html") == PAGE.read_bytes()


@built
def test_a_page_that_grows_beyond_its_promise_is_not_made(tmp_path, monkeypatch):
    monkeypatch.setattr(page, "MOST_BYTES", 1000)
    with pytest.raises(TooLarge, match=r"page\.html has \d+ bytes, 1000 at most"):
        make(tmp_path / "page.html")
    assert not (tmp_path / "page.html").exists()


@built
def test_it_names_no_other_address_than_its_own_data():
    assert set(re.findall(r"\b(?:https?|wss?|ftp)://[\w.]+", PAGE.read_text(encoding="utf-8"))) == set()


def bundled(folder: Path, **modules: str) -> str:
    for name, text in modules.items():
        (folder / f"{name}.js").write_text(text, encoding="utf-8")
    return bundle(folder / "main.js", {"other": folder / "there.js"})


def test_modules_are_joined_in_the_order_of_their_imports(tmp_path):
    text = bundled(tmp_path, main='// a\nimport { b } from "./b.js";\nimport { t } from "other";\nb(t);\n',
                   b='import { t } from "other";\nexport function b() {}\n', there="export const t = 1;\n")
    assert text.split("\n") == ["const t = 1;", "", "function b() {}", "", "// a", "b(t);", ""]


def test_a_module_that_is_imported_under_another_name_has_a_scope_of_its_own(tmp_path):
    text = bundled(tmp_path, main='import { a } from "./a.js";\nimport { a as b } from "./b.js";\na(b);\n',
                   a="export const a = 1;\n", b="const c = 2;\nexport const a = c;\nexport { c };\n")
    assert text.split("\n") == ["const a = 1;", "", "const { a: b } = (() => {", "const c = 2;", "const a = c;",
                                "return { a };", "})();", "", "a(b);", ""]


def test_comments_of_types_are_left_out_and_others_stay():
    text = "// one\n/** @type {any} */\nlet a = /** @type {number} */ (b);\n/**\n * @param {any} c\n */\nf(1);\n"
    assert without_types(text) == "// one\nlet a = (b);\nf(1);\n"


@built
def test_its_scenes_and_its_cores_are_those_of_the_project_when_unpacked():
    text = PAGE.read_text(encoding="utf-8")
    packed = re.findall(r'(?:const wasm =\s*"|id="facts">)([A-Za-z0-9+/=]+)', text)
    facts, *cores = (gzip.decompress(base64.b64decode(each)) for each in packed)
    wasm = {(build_dir() / f"wasm/{name}.wasm").read_bytes() for name in ("laconic", "laconic_hinged")}
    assert set(cores) == wasm and len(cores) == 2
    assert json.loads(facts)["scenes"] == json.loads(json.dumps(scenes_in(SCENE_DIR)))


@pytest.mark.parametrize(("modules", "told"), [
    ({"main": 'import { b, a as c } from "./a.js";\n', "a": "export const a = 1;\n"},
     "main.js: imports a.js by its own and by other names; use one kind"),
    ({"main": 'import { a as c } from "./a.js";\nimport { d } from "./b.js";\n', "a": "export const a = 1;\n",
      "b": 'import { a } from "./a.js";\nexport const d = a;\n'},
     "b.js: imports a.js by other names than another module; use the same"),
    ({"main": 'import { a } from "./a.js";\nconst a1 = a;\n', "a": "export const a = 1;\nconst a1 = 2;\n"},
     "main.js: a1 is a name of a.js, too; rename one of them"),
    ({"main": 'import { a } from "./a.js";\n', "a": 'import { m } from "./main.js";\nexport const a = 1;\n'},
     "main.js: imports itself by way of a.js"),
    ({"main": 'import a from "./a.js";\n'}, "main.js: 'import a from \"./a.js\";' is no import or export that"),
    ({"main": 'export default 1;\n'}, "main.js: 'export default 1;' is no import or export that"),
    ({"main": 'const end = "</script>";\n'}, "main.js: holds the end of a script element"),
])
def test_what_the_bundler_cannot_join_is_one_line(tmp_path, modules, told):
    with pytest.raises(BadBundle, match=re.escape(told)):
        bundled(tmp_path, **modules)
