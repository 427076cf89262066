"""A scene's FMU driven by FMPy: one doStep per exchange, inputs set where they change, a row of outputs after each."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click
import fmpy
import numpy as np
from fmpy import fmi2
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from laconic.scene import Scene
from laconic.scene.inputs import InputsOnGrid
from laconic.scene.signals import LENGTHS, PER_WHEEL
from laconic.tools.demo.rows import Rows, exchanges, row_names

FMI_ERROR = 3  # and fatal, 4, in FMI 2 and FMI 3
OUTPUTS = ("nu_rad_per_s", "x_m", "y_m", "heading_rad")
OUTPUTS_PER_WHEEL = ("wheel_speed_rad_per_s", "wheel_angle_rad")  # absent in an FMU without wheels


def elements(name: str, length: int) -> list[str]:
    """name[1] … name[length]; the name itself for a length of 0."""
    return [f"{name}[{i}]" for i in range(1, length + 1)] if length else [name]


def input_arrays(inputs: InputsOnGrid, tick: int, wheel_count: int) -> dict[str, list[float]]:
    """All elements of every input that the scene uses, at the start of a step."""
    values = inputs.held_at(tick)
    bases = dict.fromkeys(signal.partition("[")[0] for signal in inputs.signals)
    lengths = {base: wheel_count if base in PER_WHEEL else LENGTHS[base] for base in bases}
    return {base: [values.get(name, 0.0) for name in elements(base, length)] for base, length in lengths.items()}


class Log:
    """The log of an FMU: all lines are kept, errors go to stderr as well. FMPy would print them to stdout."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def take(self, status: int, text: bytes) -> None:
        """Keeps one message."""
        self.lines.append(text.decode(errors="replace"))
        if status >= FMI_ERROR:
            click.echo(f"laconic: FMU: {self.lines[-1]}", err=True)

    def fmi2_callbacks(self) -> fmi2.fmi2CallbackFunctions:
        """Callbacks of FMI 2. FMPy's proxy for messages with arguments is not used: it keeps one logger per process and
        calls it for later FMUs, when it no longer exists. These FMUs send whole messages."""
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda environment, instance, status, category, text: self.take(status, text))
        callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        return callbacks


class Slave2:
    """FMI 2: scalars."""

    def __init__(self, slave: FMU2Slave, references: dict[str, int], wheel_count: int):
        self.slave, self.references, self.log = slave, references, Log()
        self.outputs = [references[name] for name in row_names(wheel_count)]

    def start(self, end_s: float) -> None:
        """Initializes up to step mode."""
        self.slave.instantiate(callbacks=self.log.fmi2_callbacks())
        self.slave.setupExperiment(startTime=0.0, stopTime=end_s)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, base: str, values: list[float]) -> None:
        """Sets one input with all its elements."""
        names = elements(base, LENGTHS.get(base, len(values)))
        self.slave.setReal([self.references[name] for name in names], values)

    def get(self) -> list[float]:
        """A row of outputs."""
        return self.slave.getReal(self.outputs)


class Slave3:
    """FMI 3: arrays."""

    def __init__(self, slave: FMU3Slave, references: dict[str, int], wheel_count: int):
        self.slave, self.references, self.log = slave, references, Log()
        self.outputs = [references[name] for name in (*OUTPUTS, *(OUTPUTS_PER_WHEEL if wheel_count else ()))]
        self.count = 6 + 2 * wheel_count

    def start(self, end_s: float) -> None:
        """Initializes up to step mode."""
        self.slave.instantiate(logMessage=lambda _, status, category, text: self.log.take(status, text))
        self.slave.enterInitializationMode(startTime=0.0, stopTime=end_s)
        self.slave.exitInitializationMode()

    def set(self, base: str, values: list[float]) -> None:
        """Sets one input with all its elements."""
        self.slave.setFloat64([self.references[base]], values)

    def get(self) -> list[float]:
        """A row of outputs."""
        return self.slave.getFloat64(self.outputs, nValues=self.count)


def fmu_rows(scene: Scene, fmu: Path, steps: int, every: int = 1,
             moved: Callable[[int], None] = lambda _: None) -> Rows:
    """Rows of a scene's FMU. Inputs are held over each communication step, which is one step where they vary."""
    description = fmpy.read_model_description(str(fmu), validate=False)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    kind, ours = (FMU2Slave, Slave2) if description.fmiVersion == "2.0" else (FMU3Slave, Slave3)
    with TemporaryDirectory() as folder:
        fmpy.extract(str(fmu), unzipdir=folder)
        slave = kind(guid=description.guid if ours is Slave2 else description.instantiationToken,
                     unzipDirectory=folder, instanceName=scene.path.stem,
                     modelIdentifier=description.coSimulation.modelIdentifier)
        try:
            return run(ours(slave, references, scene.wheel_count), scene, steps, every, moved)
        finally:
            # It closes the library, too. Closed twice, the loader would count down in memory that is others' by now.
            slave.freeInstance()


def run(slave: Any, scene: Scene, steps: int, every: int, moved: Callable[[int], None]) -> Rows:
    """From start to end; time is the number of steps times the step, without accumulated rounding."""
    inputs, step_s = scene.inputs_on_grid(), scene.run.step_s
    slave.start(steps * step_s)
    changes, ticks, rows, began = set(inputs.changes), [], [], time.perf_counter()
    for first, count in exchanges(inputs, steps, every if inputs.is_held else 1):
        if first in changes or not inputs.is_held:
            for base, values in input_arrays(inputs, first, scene.wheel_count).items():
                slave.set(base, values)
        slave.slave.doStep(first * step_s, count * step_s)
        rows.append(slave.get())
        ticks.append(first + count)
        moved(count)
    seconds = time.perf_counter() - began
    slave.slave.terminate()
    version = "FMI 2" if isinstance(slave, Slave2) else "FMI 3"
    return Rows(version, np.array(ticks), np.array(rows, dtype=float), seconds, tuple(slave.log.lines))
