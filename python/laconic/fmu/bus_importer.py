"""A small importer of network FMUs by FMI-LS-BUS, on FMPy: bus terminals that are connected pairwise, with triggered or
countdown clocks.

    with Network([Path("vehicle.fmu"), Path("bus.fmu")], [(0, "CAN", 1, "Node1")]) as network:
        network.start()
        network.run(until_s=1.0, step_s=0.001)
        network.fmus[0].get("x_m")
"""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from ctypes import c_double, c_int, c_uint
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave

from laconic.errors import BadInput, ResultFails

KIND = "org.fmi-ls-bus.network-terminal"
CHANGED = 2         # fmi3IntervalQualifier: the interval is a new one
INSTANT_S = 1e-9   # times that differ by less are one
MOST_ITERATIONS = 100

Link = tuple[int, str, int, str]
"""Number of an FMU and name of its terminal, twice."""
Operations = Callable[[float, int, str, bytes], None]
"""Is called with the time, the FMU's number, the terminal and the bytes that it sends."""


class Terminal:
    """A bus terminal of an instance: its four value references, and when its countdown ends."""

    def __init__(self, references: Mapping[str, int], *, is_countdown: bool):
        self.rx_clock, self.rx_data = references["Rx_Clock"], references["Rx_Data"]
        self.tx_clock, self.tx_data = references["Tx_Clock"], references["Tx_Data"]
        self.is_countdown = is_countdown
        self.ticks_at_s: float | None = None


class NetworkFmu:
    """One instance of an FMU with bus terminals."""

    def __init__(self, path: Path):
        self.path, self._folder = path, tempfile.TemporaryDirectory()
        fmpy.extract(str(path), unzipdir=self._folder.name)
        description = fmpy.read_model_description(self._folder.name, validate=False)
        self.variables = {each.name: each for each in description.modelVariables}
        self.terminals = {name: self._terminal(members) for name, members in terminals_in(self._folder.name).items()}
        if not self.terminals:
            raise BadInput(f"{path}: has no terminal of the kind {KIND}; make it with laconic fmu --bus can")
        self.log: list[str] = []
        self.slave = FMU3Slave(
            guid=description.instantiationToken, unzipDirectory=self._folder.name, instanceName=path.stem,
            modelIdentifier=description.coSimulation.modelIdentifier)
        self.slave.instantiate(loggingOn=False, eventModeUsed=True, logMessage=self._take_line)

    def _take_line(self, *line: Any) -> None:
        text = line[-1]
        self.log.append(text.decode("utf-8") if isinstance(text, bytes) else str(text))

    def _terminal(self, members: Mapping[str, str]) -> Terminal:
        found = {member: self.variables[name].valueReference for member, name in members.items()}
        return Terminal(found, is_countdown=self.variables[members["Tx_Clock"]].causality == "input")

    def reference(self, name: str) -> int:
        """The value reference of a variable."""
        if name not in self.variables:
            raise BadInput(f"{self.path}: has no variable {name}")
        return int(self.variables[name].valueReference)

    def get(self, name: str) -> float:
        """A value by its name."""
        reference = [self.reference(name)]
        kind = self.variables[name].type
        return getattr(self.slave, f"get{kind}")(reference)[0]

    def set(self, name: str, value: float) -> None:
        """Sets a value by its name."""
        kind = self.variables[name].type
        getattr(self.slave, f"set{kind}")([self.reference(name)], [bool(value) if kind == "Boolean" else value])

    def receive(self, terminal: Terminal, data: bytes) -> None:
        """Operations come to a terminal."""
        self.slave.setClock([terminal.rx_clock], [True])
        if data:
            self.slave.setBinary([terminal.rx_data], [data])

    def ticks(self, terminal: Terminal, time_s: float) -> bool:
        """Whether a terminal's Tx_Clock ticks in this event iteration; a countdown is told that it does."""
        if not terminal.is_countdown:
            return bool(self.slave.getClock([terminal.tx_clock])[0])
        if terminal.ticks_at_s is None or terminal.ticks_at_s > time_s + INSTANT_S:
            return False
        self.slave.setClock([terminal.tx_clock], [True])
        terminal.ticks_at_s = None
        return True

    def sent(self, terminal: Terminal) -> bytes:
        """What a terminal sends whose Tx_Clock ticks."""
        return self.slave.getBinary([terminal.tx_data])[0] or b""

    def announce(self, time_s: float) -> None:
        """Asks countdown clocks when they want to tick."""
        for terminal in self.terminals.values():
            if terminal.is_countdown:
                interval, qualifier = (c_double * 1)(), (c_int * 1)()
                self.slave.getIntervalDecimal((c_uint * 1)(terminal.tx_clock), interval, qualifier)
                if qualifier[0] == CHANGED:
                    terminal.ticks_at_s = time_s + interval[0]

    def close(self) -> None:
        """Ends the instance."""
        with suppress(FMICallException):  # one that has failed, or was never initialized
            self.slave.terminate()
        self.slave.freeInstance()
        self._folder.cleanup()


def terminals_in(folder: str) -> dict[str, dict[str, str]]:
    """The bus terminals of an unpacked FMU: the variables of their members."""
    path = Path(folder) / "terminalsAndIcons" / "terminalsAndIcons.xml"
    if not path.is_file():
        return {}
    return {terminal.get("name", ""): {member.get("memberName", ""): member.get("variableName", "")
                                       for member in terminal.findall("TerminalMemberVariable")}
            for terminal in ET.parse(path).getroot().iter("Terminal") if terminal.get("terminalKind") == KIND}


class Network:
    """Network FMUs and their connections."""

    def __init__(self, paths: Iterable[Path], links: Sequence[Link], heard: Operations | None = None):
        self.fmus: list[NetworkFmu] = []
        self.time_s, self._heard = 0.0, heard
        for path in paths:
            self.fmus.append(NetworkFmu(path))
        ends = {(one, a): (two, b) for one, a, two, b in links}
        self._other_end = ends | {far: near for near, far in ends.items()}

    def __enter__(self) -> Network:
        return self

    def __exit__(self, *_: object) -> None:
        for fmu in self.fmus:
            fmu.close()

    def start(self, values: Sequence[Mapping[str, float]] = ()) -> None:
        """Initializes all FMUs; `values` are parameters of each by their names."""
        for fmu, own in zip(self.fmus, [*values, *[{}] * (len(self.fmus) - len(values))], strict=True):
            for name, value in own.items():
                fmu.set(name, value)
            fmu.slave.enterInitializationMode(startTime=0.0)
            fmu.slave.exitInitializationMode()
        self._handle_events()

    def run(self, until_s: float, step_s: float, before_step: Callable[[float], None] = lambda _: None) -> None:
        """Communication points each `step_s`, and wherever a countdown ends."""
        first = self.time_s
        number = 1
        while self.time_s < until_s - INSTANT_S:
            regular_s = min(first + number * step_s, until_s)
            next_s = min([regular_s, *self._countdowns()])
            before_step(self.time_s)
            for fmu in self.fmus:
                fmu.slave.doStep(self.time_s, next_s - self.time_s)
            self.time_s = next_s
            number += next_s >= regular_s - INSTANT_S
            for fmu in self.fmus:
                fmu.slave.enterEventMode()
            self._handle_events()

    def _countdowns(self) -> list[float]:
        return [terminal.ticks_at_s for fmu in self.fmus for terminal in fmu.terminals.values()
                if terminal.ticks_at_s is not None]

    def _handle_events(self) -> None:
        """All FMUs are in event mode: iterations, in each of which what is sent is received."""
        for _ in range(MOST_ITERATIONS):
            self._exchange()
            asking = [fmu for fmu in self.fmus if fmu.slave.updateDiscreteStates()[0]]
            for fmu in self.fmus:
                fmu.announce(self.time_s)
            if not asking:
                break
        else:
            raise ResultFails(f"{asking[0].path}: asks for event iterations at {self.time_s:g} s without end")
        for fmu in self.fmus:
            fmu.slave.enterStepMode()

    def _exchange(self) -> None:
        """Countdowns come last: what is sent by them may depend on what comes at the same instant."""
        ends = [(number, fmu, name, terminal) for number, fmu in enumerate(self.fmus)
                for name, terminal in fmu.terminals.items()]
        for is_countdown in (False, True):
            ticking = [end for end in ends if end[3].is_countdown == is_countdown and end[1].ticks(end[3], self.time_s)]
            for number, fmu, name, terminal in ticking:
                self._deliver(number, name, fmu.sent(terminal))

    def _deliver(self, number: int, name: str, data: bytes) -> None:
        if self._heard is not None:
            self._heard(self.time_s, number, name, data)
        if (number, name) in self._other_end:
            other, far = self._other_end[number, name]
            self.fmus[other].receive(self.fmus[other].terminals[far], data)
