"""FMUs of a vehicle whose wheels differ: a motor that changes during a run, saved states, Model Exchange."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmu_importer import ERROR, OK, Importer, generic
from test_fmu_state import deserialize, serialize

from laconic.core import load
from laconic.fmu import make_fmu
from laconic.scene import read_scene
from laconic.tools.analyse.from_core import nu_rates

SCENE = "example_two_wheel_sizes"
VERSIONS = pytest.mark.parametrize("version", [2, 3])
VOLTAGE_V = [3.0, 2.0, 0.0, 0.0]
DAMPING_NMS = [0.4, 0.0, 0.0, 0.0]  # of the first wheel; 0: the vehicle's


def motion(importer: Importer) -> list[float]:
    return [value for name in ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "wheel_angle_rad", "wheel_torque_Nm")
            for value in importer.get(name)]


@VERSIONS
def test_a_wheels_motor_that_changes_during_a_run_gives_the_cores_bits(version: int, tmp_path: Path) -> None:
    scene, core = read_scene(SCENE), load("double")
    plant, held = scene.plant(core), core.input({"voltage_V": VOLTAGE_V}, len(VOLTAGE_V))
    with Importer(make_fmu(scene, tmp_path / "scene.fmu", version=version)) as importer:
        importer.initialize()
        assert importer.set("voltage_V", *VOLTAGE_V) == OK
        for tick in range(200):
            if tick == 100:
                assert importer.set("own_motor_damping_Nms", *DAMPING_NMS) == OK
                vehicle = core.ffi.new("laconic_vehicle *", plant.c.vehicle)
                vehicle.wheel[0].own_motor_damping_Nms = DAMPING_NMS[0]
                plant.change(vehicle)
            assert importer.step(tick * scene.run.step_s, scene.run.step_s) == OK
            plant.run(held, 1)
        pose = plant.pose
        expected = [*plant.nu, pose.x_m, pose.y_m, pose.heading_rad, *plant.wheel_angles(), *plant.wheel_torques(held)]
        assert motion(importer) == expected


@VERSIONS
def test_a_saved_state_has_the_values_of_each_wheel(version: int, tmp_path: Path) -> None:
    scene = read_scene(SCENE)
    fmu = make_fmu(scene, tmp_path / "scene.fmu", version=version)
    with Importer(fmu) as first, Importer(fmu) as second:
        assert second.set("own_radius_m", 0.0, 0.0, 0.0, 0.0) == OK
        assert second.set("wheel_undriven", False, False, False, False) == OK
        first.initialize()
        assert first.set("voltage_V", *VOLTAGE_V) == OK
        assert first.step(0.0, scene.run.step_s) == OK
        second.initialize()
        assert deserialize(second, serialize(first)) == OK
        assert second.get("own_radius_m") == [0.0, 0.099, 0.05, 0.05]
        assert second.get("wheel_undriven") == [False, False, True, True]
        for importer in (first, second):
            assert importer.step(scene.run.step_s, scene.run.step_s) == OK
        assert motion(first) == motion(second)


@VERSIONS
def test_model_exchange_has_the_cores_derivative(version: int, tmp_path: Path) -> None:
    scene, core = read_scene(SCENE), load("double")
    model, start = scene.model(core), [1.5, 0.0, 0.0]
    with Importer(make_fmu(scene, tmp_path / "scene.fmu", version=version), "ModelExchange") as importer:
        assert importer.set("start_nu_rad_per_s", *start) == OK
        importer.initialize()
        assert importer.set("voltage_V", *VOLTAGE_V) == OK
        expected = nu_rates(core, model, np.array(start), 0.0, core.input({"voltage_V": VOLTAGE_V}, len(VOLTAGE_V)))
        assert importer.get("der(nu_rad_per_s)") == expected.tolist()


@VERSIONS
@pytest.mark.parametrize("name", ["own_radius_m", "own_inertia_kgm2", "own_motor_damping_Nms"])
def test_a_negative_own_value_is_refused_by_the_name_of_the_variable(version: int, name: str) -> None:
    with Importer(generic(version)) as importer:
        assert importer.set(name, 0.0, -1.0, 0.0, 0.0) == ERROR
        assert name in importer.log[-1][2]
        assert "outside its range: at least 0" in importer.log[-1][2]


def idle_lines(importer: Importer) -> list[str]:
    return [text for _, category, text in importer.log if category == "logStatusWarning" and "no motor" in text]


@VERSIONS
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_voltage_of_a_wheel_without_motor_is_logged_once_with_the_wheel(version: int, kind: str, tmp_path: Path
                                                                          ) -> None:
    scene = read_scene(SCENE)
    with Importer(make_fmu(scene, tmp_path / "scene.fmu", version=version), kind) as importer:
        importer.initialize()
        assert importer.set("voltage_V", *VOLTAGE_V) == OK
        assert idle_lines(importer) == []
        for volts in (5.0, 6.0):
            assert importer.set("voltage_V", 3.0, 2.0, 0.0, volts) == OK
        assert len(idle_lines(importer)) == 1
        assert "voltage_V[4]: 5 V has no effect: wheel 4 has no motor" in idle_lines(importer)[0]


@VERSIONS
def test_a_voltage_without_motor_before_the_start_is_logged_when_the_vehicle_is_prepared(version: int, tmp_path: Path
                                                                                         ) -> None:
    with Importer(make_fmu(read_scene(SCENE), tmp_path / "scene.fmu", version=version)) as importer:
        assert importer.set("voltage_V", 3.0, 2.0, 1.0, 0.0) == OK
        assert idle_lines(importer) == []
        importer.initialize()
        assert "voltage_V[3]: 1 V" in idle_lines(importer)[0]


def test_the_page_names_the_vehicles_variables_that_no_wheel_follows(tmp_path: Path) -> None:
    with zipfile.ZipFile(make_fmu(read_scene(SCENE), tmp_path / "scene.fmu", version=3)) as archive:
        page = archive.read("documentation/index.html").decode()
    sentence = page.split("Every wheel has a value of its own")[1].split("</p>")[0]
    assert "wheel_inertia_kgm2" in sentence and "motor_damping_Nms" not in sentence
    with zipfile.ZipFile(make_fmu(read_scene("s1"), tmp_path / "s1.fmu", version=3)) as archive:
        assert b"Every wheel has a value of its own" not in archive.read("documentation/index.html")
