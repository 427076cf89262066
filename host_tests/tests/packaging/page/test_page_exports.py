"""What the page exports gives the same bits: the scene in `laconic simulate`, the example in C from a compiler."""

from __future__ import annotations

import csv
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from laconic import read_scene
from laconic.base.paths import SOURCE_DIR, build_dir
from laconic.core import load
from laconic_build.page.browser import Browser

pytestmark = pytest.mark.nightly


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


def test_before_anything_was_driven_the_scenes_own_drive_is_exported(page, tmp_path):
    (tmp_path / "robot.toml").write_text(exported(page, "toml"), encoding="utf-8")
    own, again = read_scene("robotino2"), read_scene(tmp_path / "robot.toml")
    assert again.vehicle == own.vehicle and again.run == own.run
    assert [(each.signal, each.t_s, each.value) for each in again.inputs] == [
        (each.signal, each.t_s, each.value) for each in own.inputs]
    step(page, 100)
    whole = pose(page)
    assert compiled(exported(page, "c"), tmp_path) == whole


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
