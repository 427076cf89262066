"""FMUs show the normal loads of wheels and supports, with the bits and the derivatives of the core."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from fmu_importer import OK, Importer

import laconic
from laconic.fmu import make_fmu

STEPS = 20


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["canopen_agv", "kuka_youbot", "skid_steer"])
def test_the_loads_have_the_cores_bits(name: str, version: int, tmp_path: Path) -> None:
    scene = laconic.read_scene(name)
    step_s, supports = scene.run.step_s, len(scene.vehicle["support"])
    volts = [2.0 + wheel for wheel in range(scene.wheel_count)]
    plant = laconic.Vehicle.of(scene).plant(scene.run.method, step_s)
    with Importer(make_fmu(scene, tmp_path / "robot.fmu", version=version)) as fmu:
        fmu.initialize()
        for step in range(STEPS):
            assert fmu.set("voltage_V", *volts) == OK
            held = plant.input_of({"voltage_V": volts})
            if step == 0:
                assert fmu.get("wheel_load_N") == pytest.approx(plant.wheel_loads(held).tolist(), rel=1e-15)
            assert fmu.step(step * step_s, step_s) == OK, fmu.log
            plant.run(held)
        assert fmu.get("wheel_load_N") == plant.wheel_loads(held).tolist()
        if supports:
            assert fmu.get("support_load_N")[:supports] == plant.support_loads(held).tolist()
            assert not any(fmu.get("support_load_N")[supports:])


def names_of(fmu: Path) -> set[str]:
    with zipfile.ZipFile(fmu) as archive:
        variables = ElementTree.fromstring(archive.read("modelDescription.xml")).find("ModelVariables")
    return {str(each.get("name")) for each in variables or ()}


def test_a_robot_without_supports_has_no_loads_of_them(tmp_path: Path) -> None:
    found: dict[str, Any] = {name: names_of(make_fmu(laconic.read_scene(name), tmp_path / f"{name}.fmu", version=3))
                             for name in ("canopen_agv", "kuka_youbot")}
    assert "support_load_N" in found["canopen_agv"] and "support_load_N" not in found["kuka_youbot"]
    assert all("wheel_load_N" in each for each in found.values())
