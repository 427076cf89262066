"""One motion in every importer at hand, compared with the core's own and with docs/fmu-importers.md.

FMPy, ecospy, libcosimpy, CasADi and the FMU toolbox come with the project's environment.
"""

from __future__ import annotations

import re
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import casadi
import fmpy
import numpy as np
import pytest
from fmpy import simulate_fmu
from fmu_importer import Importer
from importer_trials import STEP_S, STEPS, TRIALS, VOLTAGE_V, Trial, casadi_right_side, container_of, verdict

from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.fmu import make_fmu
from laconic.fmu.ssp import make_controller
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT

PAGE = (SOURCE_DIR / "docs" / "fmu-importers.md").read_text(encoding="utf-8")
VARIANTS = {"`--fmi 2`": ("fmi2", {"version": 2}),
            "`--fmi 2 --no-enumerations`": ("fmi2n", {"version": 2, "enumerations": False}),
            "`--fmi 3`": ("fmi3", {"version": 3}), "`--fmi 3 --scalar`": ("fmi3s", {"version": 3, "scalar": True})}


def table_of(page: str) -> dict[str, dict[str, str]]:
    """The table of importers and variants: row, column, cell."""
    first = next(part for part in page.split("\n\n") if part.startswith("| importer | `--fmi 2`"))
    rows = [line.strip("| ").split("|") for line in first.splitlines()]
    lines = [[cell.strip() for cell in row] for row in rows]
    return {row[0]: dict(zip(lines[0][1:], row[1:], strict=True)) for row in lines[2:]}


@cache
def is_here(trial: Trial) -> bool:
    """Whether the importer is installed, with the system's libraries that it needs."""
    if find_spec(name := trial.package.replace("-", "_")) is None:
        return False
    tried = subprocess.run([sys.executable, "-c", f"import {name}"], capture_output=True, check=False)
    return tried.returncode == 0


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Robotino, driven by constant voltages."""
    return read_scene("robotino2").with_run(method=EXPLICIT, step_s=STEP_S)


@pytest.fixture(scope="module")
def expected(scene: Scene) -> list[float]:
    """Where the core's own run ends."""
    core = load("double")
    plant = scene.plant(core)
    plant.run(core.input({f"voltage_V[{i + 1}]": value for i, value in enumerate(VOLTAGE_V)}), STEPS)
    return [*plant.nu, plant.pose.x_m, plant.pose.y_m, plant.pose.heading_rad]


@pytest.fixture(scope="module")
def fmus(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The scene's FMU in all variants."""
    folder = tmp_path_factory.mktemp("importers")
    return {name: make_fmu(scene, folder / f"{name}.fmu", **options) for name, options in VARIANTS.values()}


def test_the_page_has_a_row_for_every_importer_and_a_column_for_every_variant() -> None:
    table = table_of(PAGE)
    assert {trial.label for trial in TRIALS if is_here(trial)} <= set(table)
    assert len(table) == len(TRIALS)
    assert all(set(row) == set(VARIANTS) for row in table.values())


@pytest.mark.parametrize("column", VARIANTS)
@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: trial.title)
def test_the_importer_does_with_the_fmu_what_the_page_states(
        trial: Trial, column: str, fmus: dict[str, Path], expected: list[float]) -> None:
    if not is_here(trial):
        pytest.skip(f"{trial.package} cannot be imported here")
    assert verdict(trial, fmus[VARIANTS[column][0]], expected) == table_of(PAGE)[trial.label][column]


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`(test_\w+)`", PAGE))))
def test_every_test_that_the_page_names_exists(name: str) -> None:
    files = (SOURCE_DIR / "host_tests" / "tests" / "fmu" / "fmu").glob("test_fmu_*.py")
    assert any(f"def {name}(" in path.read_text(encoding="utf-8") for path in files)


def test_the_toolbox_connects_whole_arrays_of_two_fmus_in_a_container(tmp_path: Path) -> None:
    robot, setpoint = read_scene("kuka_youbot").with_run(method="auto", step_s=STEP_S), (12.0, 10.0, 12.0, 10.0)
    made = [make_controller(robot, tmp_path / "controller.fmu", version=2),
            make_fmu(robot, tmp_path / "vehicle.fmu", version=2)]
    links = [[str(made[0]), "voltage_V", str(made[1]), "voltage_V"],
             [str(made[1]), "wheel_speed_rad_per_s", str(made[0]), "wheel_speed_rad_per_s"]]
    container = container_of(tmp_path, made, links)
    result = simulate_fmu(str(container), stop_time=4.0, step_size=STEP_S, output_interval=STEP_S, validate=False,
                          start_values={f"setpoint_rad_per_s[{i + 1}]": v for i, v in enumerate(setpoint)})
    forward = np.mean(setpoint) * robot.vehicle["wheel_radius_m"]
    assert result["velocity_body_m_per_s[1]"][-1] == pytest.approx(forward, rel=0.01)


@pytest.mark.parametrize("variant", ["fmi2", "fmi3s"])
def test_casadi_takes_the_fmus_own_jacobian(fmus: dict[str, Path], variant: str, tmp_path: Path) -> None:
    fmpy.extract(str(fmus[variant]), unzipdir=str(tmp_path))
    right_side, inputs = casadi_right_side(tmp_path)
    point, jacobian = np.linspace(-1, 1, 9), right_side.jacobian()
    blocks = jacobian(point, inputs, *[casadi.DM(*right_side.size_out(k)) for k in range(2)])
    theirs = np.array(blocks[0])
    with Importer(fmus[variant], "ModelExchange") as importer:
        importer.initialize()
        importer.must("EnterContinuousTimeMode")
        importer.must("SetContinuousStates", importer.ffi.new("double[]", list(point)), 9)
        importer.set("voltage_V", *VOLTAGE_V)
        np.testing.assert_allclose(theirs, states_jacobian(importer), rtol=1e-12, atol=1e-12)


def states_jacobian(importer: Importer) -> np.ndarray:
    """∂ẋ/∂x by the FMU's own directional derivatives."""
    names = [e for base in ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "wheel_angle_rad")
             for e in importer.elements(base)[0]]
    count, columns = len(names), []
    rates, states = importer.references(*(f"der({name})" for name in names)), importer.references(*names)
    for seed in np.eye(count):
        result = importer.ffi.new("double[]", count)
        arguments = (importer.ffi.new("double[]", list(seed)), result)
        if importer.version == 3:
            arguments = (arguments[0], count, result, count)
        importer.must("GetDirectionalDerivative", rates, count, states, count, *arguments)
        columns.append(list(result))
    return np.array(columns).T


def code_of(heading: str) -> list[str]:
    """The Python blocks of a part of the page."""
    part = PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    return re.findall(r"```python\n(.*?)```", part, re.DOTALL)


@pytest.mark.parametrize(("heading", "variant"), [("CasADi", "fmi2")])
def test_the_example_of_the_documentation_runs(heading: str, variant: str, fmus: dict[str, Path], tmp_path: Path,
                                               monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robotino2.fmu").write_bytes(fmus[variant].read_bytes())
    names: dict[str, object] = {}
    for block in code_of(heading):
        exec(compile(block, heading, "exec"), names)
    assert names
