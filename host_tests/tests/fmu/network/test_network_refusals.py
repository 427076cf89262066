"""What network FMUs refuse with a line in the log: times that no node counts, and identifiers that drives have."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fmpy.fmi1 import FMICallException

from laconic.base.paths import built
from laconic.fmu.bus_importer import NetworkFmu
from laconic.fmu.network import make_network_fmu
from laconic.scene import read_scene


@pytest.fixture(scope="module")
def chassis(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A vehicle with four RoboMaster drives."""
    return make_network_fmu(read_scene("robomaster_mecanum"), tmp_path_factory.mktemp("fmu") / "x.fmu",
                            drives="robomaster")


@pytest.fixture(params=["vehicle", "CanBus", "CanController"])
def fmu(request: pytest.FixtureRequest, chassis: Path) -> Iterator[NetworkFmu]:
    """Each kind of network FMU, instantiated."""
    path = chassis if request.param == "vehicle" else built(f"fmu/Laconic{request.param}_fmi3.fmu")
    opened = NetworkFmu(path)
    try:
        yield opened
    finally:
        opened.close()


def start(fmu: NetworkFmu, time_s: float = 0.0) -> None:
    """Through initialization and the first event into step mode."""
    fmu.slave.enterInitializationMode(startTime=time_s)
    fmu.slave.exitInitializationMode()
    while fmu.slave.updateDiscreteStates()[0]:
        pass
    fmu.slave.enterStepMode()


@pytest.mark.parametrize("time_s", [1e300, -1e300, 1e12])
def test_a_start_time_at_which_no_microsecond_is_told_is_refused_by_a_line(fmu: NetworkFmu, time_s: float) -> None:
    with pytest.raises(FMICallException):
        start(fmu, time_s)
    line, = fmu.log
    assert "the start time" in line and "give one from -4e+09 s to 4e+09 s" in line


@pytest.mark.parametrize("step_s", [1e300, 1e20, 1e10])
def test_a_step_of_centuries_is_refused_by_a_line_and_moves_nothing(fmu: NetworkFmu, step_s: float) -> None:
    start(fmu)
    fmu.slave.doStep(0.0, 0.001)
    with pytest.raises(FMICallException):
        fmu.slave.doStep(0.001, step_s)
    assert "give 1e+06 s or less" in fmu.log[-1]
    assert fmu.get("time") == 0.001


def test_identifiers_of_drives_are_refused_as_the_nodes_own(chassis: Path) -> None:
    for base, is_free in ((480, False), (512, False), (544, True)):  # commands 0x1FF, 0x200; feedback to 0x204
        fmu = NetworkFmu(chassis)
        try:
            fmu.set("id_base", base)
            if is_free:
                start(fmu)
                continue
            with pytest.raises(FMICallException):
                start(fmu)
            assert f"id_base: the drives use identifiers from {base} to {base + 31}" in fmu.log[-1]
        finally:
            fmu.close()
