"""One motion in every importer that is installed, compared with the core's own.

FMPy, ecospy and libcosimpy come with the project's environment; CasADi with requirements-peers.txt.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmu_importer import Importer

from laconic.core import load
from laconic.fmu import make_fmu
from laconic.paths import SOURCE_DIR
from laconic.scene import Scene, read_scene

STEP_S, STEPS = 0.01, 300
VOLTAGE_V = (6.0, -4.0, 3.0)
NAMES = ("nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]", "x_m", "y_m", "heading_rad")


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Robotino, driven by constant voltages."""
    return read_scene("robotino2").with_run(method="rk4", step_s=STEP_S)


@pytest.fixture(scope="module")
def expected(scene: Scene) -> np.ndarray:
    """Where the core's own run ends."""
    core = load("double")
    plant = scene.plant(core)
    plant.run(core.input({f"voltage_V[{i + 1}]": value for i, value in enumerate(VOLTAGE_V)}), STEPS)
    return np.array([*plant.nu, plant.pose.x_m, plant.pose.y_m, plant.pose.heading_rad])


@pytest.fixture(scope="module")
def fmus(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The scene's FMU in all variants."""
    folder = tmp_path_factory.mktemp("importers")
    return {name: make_fmu(scene, folder / f"{name}.fmu", version=version, scalar=scalar)
            for name, version, scalar in (("fmi2", 2, False), ("fmi3", 3, False), ("fmi3s", 3, True))}


def voltages(variant: str) -> dict[str, object]:
    """Start values for FMPy."""
    if variant == "fmi3":
        return {"voltage_V": list(VOLTAGE_V)}
    return {f"voltage_V[{i + 1}]": value for i, value in enumerate(VOLTAGE_V)}


def last_row(result: np.ndarray, variant: str) -> np.ndarray:
    """The last row of FMPy's result."""
    if variant == "fmi3":
        return np.array([*result["nu_rad_per_s"][-1], result["x_m"][-1], result["y_m"][-1], result["heading_rad"][-1]])
    return np.array([result[name][-1] for name in NAMES])


@pytest.mark.parametrize("variant", ["fmi2", "fmi3", "fmi3s"])
def test_fmpy_co_simulation_ends_with_the_same_bits(fmus: dict[str, Path], variant: str, expected: np.ndarray) -> None:
    result = simulate_fmu(str(fmus[variant]), fmi_type="CoSimulation", stop_time=STEPS * STEP_S, step_size=STEP_S,
                          output_interval=STEP_S, start_values=voltages(variant))
    assert last_row(result, variant).tolist() == expected.tolist()


@pytest.mark.parametrize("variant", ["fmi2", "fmi3", "fmi3s"])
def test_fmpy_model_exchange_with_cvode(fmus: dict[str, Path], variant: str, expected: np.ndarray) -> None:
    result = simulate_fmu(str(fmus[variant]), fmi_type="ModelExchange", solver="CVode", stop_time=STEPS * STEP_S,
                          output_interval=0.1, relative_tolerance=1e-8, start_values=voltages(variant))
    np.testing.assert_allclose(last_row(result, variant), expected, rtol=2e-5, atol=2e-5)


@pytest.mark.parametrize("variant", ["fmi2", "fmi3s"])
def test_casadi_model_exchange_and_its_jacobian(fmus: dict[str, Path], variant: str, expected: np.ndarray,
                                                tmp_path: Path) -> None:
    casadi = pytest.importorskip("casadi", reason="CasADi is in requirements-peers.txt")
    import fmpy
    fmpy.extract(str(fmus[variant]), unzipdir=str(tmp_path))
    dae = casadi.DaeBuilder("vehicle", str(tmp_path), {})
    right_side = dae.create("f", ["x", "u"], ["ode", "y"])
    inputs = np.array([VOLTAGE_V[int(name[10]) - 1] if name.startswith("voltage") else 0.0 for name in dae.u()])
    state = np.zeros(9)
    for _ in range(STEPS):
        k1 = right_side(state, inputs)[0]
        k2 = right_side(state + STEP_S / 2 * k1, inputs)[0]
        k3 = right_side(state + STEP_S / 2 * k2, inputs)[0]
        k4 = right_side(state + STEP_S * k3, inputs)[0]
        state = state + STEP_S / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    np.testing.assert_allclose(np.array(state).ravel()[:6], expected, rtol=1e-6, atol=1e-6)
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


@pytest.mark.parametrize("variant", ["fmi2", "fmi3s"])
def test_ecospy_co_simulation(fmus: dict[str, Path], variant: str, expected: np.ndarray) -> None:
    try:
        import ecospy
    except (ImportError, OSError) as error:
        pytest.skip(f"ecospy is not usable here: {error}")
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("vehicle", str(fmus[variant]))
        structure.add_parameter_set("drive", {f"vehicle::voltage_V[{i + 1}]": v for i, v in enumerate(VOLTAGE_V)})
        with ecospy.EcosSimulation(structure=structure, step_size=STEP_S) as simulation:
            simulation.init(parameter_set="drive")
            simulation.step(STEPS)
            ends = [simulation.get_real(f"vehicle::{name}") for name in NAMES]
            simulation.terminate()
    assert ends == expected.tolist()


def test_libcosim_co_simulation(fmus: dict[str, Path], expected: np.ndarray) -> None:
    pytest.importorskip("libcosimpy")
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave
    execution = CosimExecution.from_step_size(step_size=int(STEP_S * 1e9))
    slave = execution.add_local_slave(CosimLocalSlave(fmu_path=str(fmus["fmi2"]), instance_name="vehicle"))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    variables = {each.name.decode(): each for each in execution.slave_variables(slave)}
    for i, value in enumerate(VOLTAGE_V):
        assert execution.real_initial_value(slave, variables[f"voltage_V[{i + 1}]"].reference, value)
    execution.step(STEPS)
    references = [variables[name].reference for name in NAMES]
    assert CosimVariableType(variables["x_m"].type) == CosimVariableType.REAL
    assert list(observer.last_real_values(slave, references)) == expected.tolist()


def code_of(page: str) -> list[str]:
    """The Python blocks of a documentation page."""
    text = (SOURCE_DIR / "docs" / page).read_text(encoding="utf-8")
    return re.findall(r"```python\n(.*?)```", text, re.DOTALL)


@pytest.mark.parametrize(("page", "variant"), [("fmu-fmpy.md", "fmi3"), ("fmu-casadi.md", "fmi2")])
def test_the_examples_of_the_documentation_run(page: str, variant: str, fmus: dict[str, Path], tmp_path: Path,
                                               monkeypatch: pytest.MonkeyPatch) -> None:
    if "casadi" in page:
        pytest.importorskip("casadi", reason="CasADi is in requirements-peers.txt")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robotino2.fmu").write_bytes(fmus[variant].read_bytes())
    names: dict[str, object] = {}
    for block in code_of(page):
        exec(compile(block, page, "exec"), names)
    assert names
