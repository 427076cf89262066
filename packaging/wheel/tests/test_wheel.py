"""The wheel of this machine in an empty environment: it does what the build tree does, bit for bit, without it."""

from __future__ import annotations

import contextlib
import io
import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fresh_environment import PROJECT, Environment, fresh_environment

from laconic.base.paths import build_dir
from laconic.cli.main import run

SCENE = "robotino2"
USER_PROGRAM = """\
import laconic
import numpy as np

scene = laconic.read_scene("s1")
run = laconic.simulate(scene, ("x_m",))
last: float = float(run.columns["x_m"][-1])
robot = laconic.Vehicle.of(scene)
plant: laconic.Plant = robot.plant(step_s=0.01)
plant.run({"voltage_V": [1.0] * robot.wheel_count}, steps=10)
nu: np.ndarray = plant.nu
change: np.ndarray = robot.linearise(nu, inputs={"voltage_V[1]": 1.0}).state_matrix
laconic.plot(run_of := laconic.simulate(scene), "picture.svg")
laconic.make_fmu(run_of.scene, "robot.fmu", version=3)
try:
    laconic.build_scene({"name": "empty"})
except laconic.BadInput as why:
    print(why)
print(repr(last), nu.shape)
"""


def run_here(*arguments: str) -> None:
    """The command of the build tree; what it prints is not what this gate shows."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        assert run(list(arguments)) == 0


@pytest.fixture(scope="session")
def wheel() -> Path:
    found = list((build_dir() / "wheel").glob("laconic-*.whl"))
    assert len(found) == 1, "build the target laconic_wheel into an empty build/wheel"
    return found[0]


@pytest.fixture(scope="session")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Environment:
    return fresh_environment(tmp_path_factory.mktemp("empty"), wheel, ("rig",))


def test_a_run_has_the_bits_of_the_build_tree_and_a_picture(installed: Environment, tmp_path: Path) -> None:
    installed.run("laconic", "simulate", SCENE, "--out", "run.csv", "--plot", "path.png")
    run_here("simulate", SCENE, "--out", str(tmp_path / "run.csv"))
    assert (installed.folder / "run.csv").read_bytes() == (tmp_path / "run.csv").read_bytes()
    assert (installed.folder / "path.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("version", ["2", "3"])
def test_an_fmu_has_the_bytes_of_the_build_tree(installed: Environment, tmp_path: Path, version: str) -> None:
    installed.run("laconic", "fmu", SCENE, "--fmi", version, "-o", f"robot{version}.fmu")
    run_here("fmu", SCENE, "--fmi", version, "-o", str(tmp_path / "robot.fmu"))
    assert (installed.folder / f"robot{version}.fmu").read_bytes() == (tmp_path / "robot.fmu").read_bytes()


def test_the_fmu_runs_in_fmpy_to_where_the_wheels_own_run_ends(installed: Environment) -> None:
    from fmpy import simulate_fmu

    installed.run("laconic", "fmu", "paper_three_wheel_free", "--fmi", "2", "-o", "free.fmu")
    found = json.loads(installed.run("laconic", "simulate", "paper_three_wheel_free", "--json").stdout)
    result = simulate_fmu(str(installed.folder / "free.fmu"), output=["x_m", "heading_rad"])
    assert [result[-1]["x_m"], result[-1]["heading_rad"]] == [found["final"][name] for name in ("x_m", "heading_rad")]


@pytest.mark.parametrize("board", ["virtual", "process"])
def test_a_node_is_driven_over_the_virtual_bus_and_as_a_process(installed: Environment, board: str) -> None:
    answer = json.loads(installed.run("laconic", "rig", "s1", "--board", board, "--steps", "200", "--json").stdout)
    assert all(each["passed"] for each in answer["verdicts"])


def test_a_command_whose_extra_is_missing_names_the_extra_in_one_line(installed: Environment) -> None:
    done = installed.run("laconic", "analyse", SCENE, status=2)
    assert done.stderr == 'laconic: this needs scipy, which is not installed; pip install "laconic[analysis]"\n'


def test_the_remedy_keeps_the_wheel_and_asks_for_what_the_extra_brings_alone(installed: Environment) -> None:
    """Without an index pip gets no further; with one that lacks laconic it would come so far, too."""
    remedy = ("install", "--disable-pip-version-check", "--no-index", "laconic[analysis]")
    done = installed.run("pip", *remedy, status=1)
    assert "No matching distribution found for scipy" in done.stderr


def test_a_command_that_needs_a_build_tree_states_so_in_one_line(installed: Environment) -> None:
    done = installed.run("laconic", "rig", "s1", "--board", "an386", status=2)
    assert done.stderr.count("\n") == 1
    assert "get the project's sources, run `cmake --workflow --preset demo`" in done.stderr


def test_the_core_comes_as_two_files_and_is_prepared_for_one_scene_without_a_build(installed: Environment) -> None:
    installed.run("laconic", "core")
    for name in ("laconic.h", "laconic.c"):
        made = (installed.folder / "laconic" / name).read_bytes()
        assert made == (build_dir() / "amalgamation" / name).read_bytes()
    assert "laconic_scene_model.c" in installed.run("laconic", "trim", SCENE).stdout


def test_the_help_comes_at_once(installed: Environment) -> None:
    done = installed.run("python", "-X", "importtime", "-m", "laconic", "--help")
    assert "simulate" in done.stdout
    loaded = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert not loaded & {"numpy", "cffi", "matplotlib", "rich", "can"}


def test_a_program_with_types_passes_the_strict_check_and_runs(installed: Environment) -> None:
    (installed.folder / "program.py").write_text(USER_PROGRAM, encoding="utf-8")
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--config-file", os.devnull, "--cache-dir", os.devnull,
         "--python-executable", str(installed.bin / "python"), "program.py"],
        cwd=installed.folder, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout
    assert installed.run("python", "program.py").stdout.endswith("(3,)\n")


def test_the_wheel_holds_no_path_of_the_machine_that_made_it(wheel: Path) -> None:
    here = [str(PROJECT).encode(), str(build_dir()).encode(), sys.prefix.encode()]
    with zipfile.ZipFile(wheel) as archive:
        assert [name for name in archive.namelist() if any(path in archive.read(name) for path in here)] == []


def test_the_wheel_holds_licences_of_all_that_was_compiled_into_it(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        texts = {Path(name).name: archive.read(name).decode() for name in archive.namelist() if "/licenses/" in name}
    assert set(texts) == {"LICENSE", "LICENSE-fmi-headers.txt", "LICENSE-cantools.txt"}
    assert all("copyright" in text.lower() for text in texts.values())


def test_two_builds_give_the_same_bytes(wheel: Path, tmp_path: Path) -> None:
    build = build_dir()
    subprocess.run([sys.executable, "-m", "laconic_build.wheel", "native", "--project", str(PROJECT), "--build",
                    str(build), "--version", wheel.name.split("-")[1], "--wire", str(build / "firmware_stub" / "wire"),
                    "--fmi-headers", str(build / "parts" / "fmi"), "--out", str(tmp_path)], check=True)
    assert (tmp_path / wheel.name).read_bytes() == wheel.read_bytes()
