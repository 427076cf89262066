"""One motion of one robot in every importer at hand: docs/fmu-importers.md is compared with what happens here.

    python importer_trials.py IMPORTER F.fmu    tries one alone, for importers that end the process where they fail
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
from fmpy import simulate_fmu

STEP_S, STEPS = 0.01, 300
VOLTAGE_V = (6.0, -4.0, 3.0)
NAMES = ("nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]", "x_m", "y_m", "heading_rad")
METHOD = 1
"""An explicit one, set by the importer where it can; the FMU has it already."""


@dataclass(frozen=True)
class Outcome:
    """How a trial ended."""

    ends: list[float]
    """Values of NAMES after the last step."""
    sets_method: bool = True
    """False: the importer does not know the variable `method`, an enumeration."""


@dataclass(frozen=True)
class Trial:
    """An importer as the page names it, and what brings it."""

    title: str
    package: str
    run: Callable[[Path], Outcome]
    ends_process: bool = False

    @property
    def label(self) -> str:
        """With its version; without one where it is not installed."""
        try:
            return f"{self.title.partition(',')[0]} {version(self.package)}{''.join(self.title.partition(',')[1:])}"
        except PackageNotFoundError:
            return self.title


def is_array(fmu: Path) -> bool:
    """Whether the FMU has arrays."""
    variables = fmpy.read_model_description(str(fmu), validate=False).modelVariables
    return any(variable.name == "voltage_V" for variable in variables)


def start_values(fmu: Path) -> dict[str, object]:
    """For FMPy."""
    voltage = {"voltage_V": list(VOLTAGE_V)} if is_array(fmu) else {
        f"voltage_V[{i + 1}]": value for i, value in enumerate(VOLTAGE_V)}
    return voltage | {"method": METHOD}


def last_row(result: np.ndarray) -> list[float]:
    """The last row of FMPy's result."""
    if "nu_rad_per_s" in result.dtype.names:
        return [*result["nu_rad_per_s"][-1].tolist(), *(float(result[name][-1]) for name in NAMES[3:])]
    return [float(result[name][-1]) for name in NAMES]


def in_fmpy(fmu: Path) -> Outcome:
    """Co-Simulation."""
    return Outcome(last_row(simulate_fmu(
        str(fmu), fmi_type="CoSimulation", stop_time=STEPS * STEP_S, step_size=STEP_S, output_interval=STEP_S,
        start_values=start_values(fmu))))


def in_cvode(fmu: Path) -> Outcome:
    """Model Exchange with FMPy's CVode."""
    return Outcome(last_row(simulate_fmu(
        str(fmu), fmi_type="ModelExchange", solver="CVode", stop_time=STEPS * STEP_S, output_interval=0.1,
        relative_tolerance=1e-8, start_values=start_values(fmu))))


def casadi_right_side(folder: Path) -> tuple[object, np.ndarray]:
    """f(x, u) → (ẋ, y) of an FMU that was unpacked, and the inputs."""
    import casadi
    dae = casadi.DaeBuilder("vehicle", str(folder), {})
    inputs = [VOLTAGE_V[int(name[10]) - 1] if name.startswith("voltage") else 0.0 for name in dae.u()]
    return dae.create("f", ["x", "u"], ["ode", "y"]), np.array(inputs)


def in_casadi(fmu: Path) -> Outcome:
    """Its right-hand side in a Runge-Kutta method of ours."""
    with TemporaryDirectory() as folder:
        fmpy.extract(str(fmu), unzipdir=folder)
        right_side, inputs = casadi_right_side(Path(folder))
        state = np.zeros(9)
        for _ in range(STEPS):
            k1 = right_side(state, inputs)[0]
            k2 = right_side(state + STEP_S / 2 * k1, inputs)[0]
            k3 = right_side(state + STEP_S / 2 * k2, inputs)[0]
            k4 = right_side(state + STEP_S * k3, inputs)[0]
            state = state + STEP_S / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return Outcome(np.array(state).ravel()[:6].tolist())


def in_ecos(fmu: Path) -> Outcome:
    """Co-Simulation."""
    import ecospy
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("vehicle", str(fmu))
        structure.add_parameter_set("drive", {f"vehicle::voltage_V[{i + 1}]": v for i, v in enumerate(VOLTAGE_V)})
        with ecospy.EcosSimulation(structure=structure, step_size=STEP_S) as simulation:
            simulation.init(parameter_set="drive")
            simulation.step(STEPS)
            try:
                sets_method = simulation.get_integer("vehicle::method") == METHOD
            except Exception:  # its own kind of error: no such property
                sets_method = False
            ends = [simulation.get_real(f"vehicle::{name}") for name in NAMES]
            simulation.terminate()
    return Outcome(ends, sets_method)


def in_libcosim(fmu: Path) -> Outcome:
    """Co-Simulation."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave
    execution = CosimExecution.from_step_size(step_size=int(STEP_S * 1e9))
    slave = execution.add_local_slave(CosimLocalSlave(fmu_path=str(fmu), instance_name="vehicle"))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    reference = {each.name.decode(): each.reference for each in execution.slave_variables(slave)}
    for i, value in enumerate(VOLTAGE_V):
        assert execution.real_initial_value(slave, reference[f"voltage_V[{i + 1}]"], value)
    if "method" in reference:
        assert execution.integer_initial_value(slave, reference["method"], METHOD)
    execution.step(STEPS)
    ends = list(observer.last_real_values(slave, [reference[name] for name in NAMES]))
    return Outcome(ends, "method" in reference)


def container_of(folder: Path, fmus: list[Path], links: list[list[str]]) -> Path:
    """A container by the FMU toolbox; CalledProcessError where it refuses."""
    description = {"name": "container.fmu", "fmu": [str(fmu) for fmu in fmus], "step_size": STEP_S, "link": links}
    (folder / "container.json").write_text(json.dumps(description), encoding="utf-8")
    tool = Path(sys.executable).parent / "fmucontainer"
    subprocess.run([str(tool), "-container", "container.json", "-fmu-directory", str(folder)], cwd=folder, check=True,
                   capture_output=True)
    return folder / "container.fmu"


def in_container(fmu: Path) -> Outcome:
    """The FMU toolbox's container around the vehicle, run by FMPy."""
    with TemporaryDirectory() as folder:
        container = container_of(Path(folder), [fmu], [])
        values = {f"voltage_V[{i + 1}]": value for i, value in enumerate(VOLTAGE_V)}
        return Outcome(last_row(simulate_fmu(
            str(container), stop_time=STEPS * STEP_S, step_size=STEP_S, output_interval=STEP_S, validate=False,
            start_values=values)))


TRIALS = (Trial("FMPy, Co-Simulation", "fmpy", in_fmpy), Trial("FMPy, Model Exchange with CVode", "fmpy", in_cvode),
          Trial("CasADi, Model Exchange", "casadi", in_casadi), Trial("ecospy", "ecospy", in_ecos),
          Trial("libcosimpy", "libcosimpy", in_libcosim, ends_process=True),
          Trial("FMU toolbox, container", "fmu-manipulation-toolbox", in_container))


def alone(trial: Trial, fmu: Path) -> Outcome:
    """The trial in a process of its own."""
    done = subprocess.run([sys.executable, __file__, trial.title, str(fmu)], capture_output=True, text=True, check=True)
    ends, sets_method = json.loads(done.stdout.splitlines()[-1])
    return Outcome(ends, sets_method)


def verdict(trial: Trial, fmu: Path, expected: list[float]) -> str:
    """The sentence of the page about it."""
    try:
        outcome = alone(trial, fmu) if trial.ends_process and not fmu.stem.startswith("fmi2") else trial.run(fmu)
    except Exception:  # whatever the importer's way of refusing
        return "no"
    off = np.abs(np.array(outcome.ends) - expected).max()
    if not off < 1e-4:
        return "no"
    close = "same bits" if outcome.ends == expected else "within 1e-4"
    return close if outcome.sets_method else f"{close}, no `method`"


if __name__ == "__main__":
    found = next(trial for trial in TRIALS if trial.title == sys.argv[1]).run(Path(sys.argv[2]))
    print(json.dumps([found.ends, found.sets_method]))
