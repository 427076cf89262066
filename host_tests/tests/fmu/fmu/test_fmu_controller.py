"""A vehicle with its wheel-speed controller: two FMUs of one glue in one process, by hand and as SSP."""

from __future__ import annotations

import re
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.validation import validate_fmu
from fmu_importer import OK, Importer
from lxml import etree

from laconic.cli.main import run
from laconic.fmu import make_fmu
from laconic.fmu.ssp import SSC, SSD, identifier, make_controller, make_ssp, structure
from laconic.scene import Scene, read_scene, rigid_scene_names

SETPOINT = (12.0, 10.0, 12.0, 10.0)
STEP_S, STEPS = 0.01, 400


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A youBot."""
    return read_scene("kuka_youbot").with_run(method="auto", step_s=STEP_S)


@pytest.mark.parametrize(("version", "scalar"), [(2, False), (3, False), (3, True)])
def test_the_controller_is_a_valid_fmu_too(scene: Scene, version: int, scalar: bool, tmp_path: Path) -> None:
    assert validate_fmu(str(make_controller(scene, tmp_path / "c.fmu", version=version, scalar=scalar))) == []


@pytest.mark.parametrize("version", [2, 3])
def test_the_wheels_reach_their_set_points(scene: Scene, version: int, tmp_path: Path) -> None:
    vehicle_fmu = make_fmu(scene, tmp_path / "v.fmu", version=version)
    controller_fmu = make_controller(scene, tmp_path / "c.fmu", version=version)
    with Importer(vehicle_fmu) as vehicle, Importer(controller_fmu) as controller:
        vehicle.initialize()
        controller.initialize()
        assert controller.set("setpoint_rad_per_s", *SETPOINT) == OK
        for k in range(STEPS):
            assert controller.set("wheel_speed_rad_per_s", *vehicle.get("wheel_speed_rad_per_s")) == OK
            assert controller.step(k * STEP_S, STEP_S) == OK
            assert vehicle.set("voltage_V", *controller.get("voltage_V")) == OK
            assert vehicle.step(k * STEP_S, STEP_S) == OK
        speeds = np.array(vehicle.get("wheel_speed_rad_per_s"))
        assert np.abs(controller.get("voltage_V")).max() <= 24.0
    np.testing.assert_allclose(speeds, SETPOINT, atol=0.2)


def test_voltage_is_limited_and_the_integral_does_not_wind_up(scene: Scene, tmp_path: Path) -> None:
    with Importer(make_controller(scene, tmp_path / "c.fmu", version=3)) as controller:
        controller.initialize()
        assert controller.set("setpoint_rad_per_s", 1000.0, -1000.0, 0.0, 0.0) == OK
        for k in range(100):
            assert controller.step(k * STEP_S, STEP_S) == OK
        assert controller.get("voltage_V") == [24.0, -24.0, 0.0, 0.0]
        assert controller.get("angle_error_rad") == [0.0] * 4


def test_the_ssp_runs_in_fmpy_and_the_wheels_reach_their_set_points(scene: Scene, tmp_path: Path) -> None:
    ssp = make_ssp(scene, tmp_path / "vehicle.ssp")
    wanted = {f"setpoint_rad_per_s_{i + 1}": lambda _, value=value: value for i, value in enumerate(SETPOINT)}
    result = simulate_ssp(str(ssp), stop_time=STEPS * STEP_S, step_size=STEP_S, input=wanted)
    np.testing.assert_allclose([result[f"wheel_speed_rad_per_s_{i + 1}"][-1] for i in range(4)], SETPOINT, atol=0.2)
    for name in ("x_m", "y_m", "heading_rad"):  # the system's own outputs, one step behind the vehicle's
        assert result[name][-1] == result[f"vehicle.{name}"][-1] != 0.0


@pytest.mark.parametrize("name", rigid_scene_names())
def test_the_ssp_is_valid_and_its_names_are_identifiers_with_units(name: str) -> None:
    text = structure(read_scene(name)).encode("utf-8")
    folder = Path(fmpy.__file__).parent / "ssp" / "schema"
    etree.XMLSchema(file=str(folder / "SystemStructureDescription.xsd")).assertValid(root := etree.fromstring(text))
    spaces = {"ssd": SSD, "ssc": SSC}
    named = [root, *root.iterfind(".//ssd:System", spaces), *root.iterfind(".//ssd:Component", spaces),
             *root.iterfind("ssd:System/ssd:Connectors/ssd:Connector", spaces)]
    for element in named:
        assert re.fullmatch(r"[A-Za-z]\w*", element.get("name"), re.ASCII), element.get("name")
    outputs = {each.get("name"): each for each in root.iterfind("ssd:System/ssd:Connectors/ssd:Connector", spaces)
               if each.get("kind") == "output"}
    assert {"x_m", "y_m", "heading_rad", "wheel_speed_rad_per_s_1"} <= set(outputs)
    units = {unit.get("name") for unit in root.iterfind("ssd:Units/ssc:Unit", spaces)}
    for connector in root.iterfind(".//ssd:Connector", spaces):
        assert connector.find("ssc:Real", spaces).get("unit") in units
    assert outputs["heading_rad"].find("ssc:Real", spaces).get("unit") == "rad"
    experiment = root.find("ssd:DefaultExperiment", spaces)
    assert float(experiment.get("stopTime")) == read_scene(name).run.duration_s


@pytest.mark.parametrize(("text", "name"), [("robotino2", "robotino2"), ("my robot-2", "my_robot_2"),
                                            ("3wd", "scene_3wd"), ("übung", "scene__bung")])
def test_every_scene_name_becomes_an_identifier(text: str, name: str) -> None:
    assert identifier(text) == name


@pytest.mark.parametrize("scalar", [False, True])
def test_an_ssp_of_fmi_3_is_refused_with_one_line(scalar: bool, tmp_path: Path, capsys) -> None:
    words = ["fmu", "robotino2", "--fmi", "3", "--ssp", "-o", str(tmp_path / "x.ssp")]
    assert run([*words, "--scalar"] if scalar else words) == 2
    assert capsys.readouterr().err.splitlines() == ["laconic: --ssp: SSP 1.0 has no FMUs of FMI 3; use --fmi 2"]
    assert not (tmp_path / "x.ssp").exists()
