"""FMUs give the same bits as the core, for every scene, in both FMI versions, with arrays and without.

What the calls of an FMU cost beside the core's step, in instructions: the same on every run.

FMUs show the normal loads of wheels and supports, with the bits and the derivatives of the core.
"""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from fmu_importer import OK, Importer

import laconic
from laconic.base.paths import built
from laconic.core import load
from laconic.fmu import make_fmu
from laconic.scene import read_scene, rigid_scene_names
from laconic.tools.report.counting import cachegrind_present, instructions_of

VARIANTS = {"fmi2": (2, False), "fmi3": (3, False), "fmi3-scalar": (3, True)}
STEPS, QUICK_STEPS, EVERY = 10_000, 2_000, 100
QUICK = {"s1", "skid_steer", "kuka_youbot", "paper_caster", "robotino_grey", "canopen_agv"}


def signal_name(name: str, values: list[float], index: int) -> str:
    """What the core calls one number of an input: with its index where the input has several, or one per wheel."""
    return f"{name}[{index + 1}]" if len(values) > 1 or name.endswith(("_V", "axle_torque_Nm")) else name


def outputs_of(plant: object, held: object) -> list[float]:
    """The outputs of the core, in the order of fmu_row."""
    pose, reactions = plant.pose, plant.reactions(held)
    velocity, yaw_rate = plant.body_velocity()
    n = plant.wheel_count
    return [*plant.nu, pose.x_m, pose.y_m, pose.heading_rad, pose.heading_wrapped_rad, pose.origin_x_m, pose.origin_y_m,
            *velocity, yaw_rate, *plant.wheel_speeds(), *plant.wheel_angles(), *plant.wheel_torques(held),
            *list(reactions.along_N)[:n], *list(reactions.lateral_N)[:n], reactions.no_slip_margin_N, plant.energy_J()]


NAMES = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "heading_wrapped_rad", "origin_x_m", "origin_y_m",
         "velocity_body_m_per_s", "yaw_rate_rad_per_s", "wheel_speed_rad_per_s", "wheel_angle_rad", "wheel_torque_Nm",
         "wheel_reaction_N", "wheel_lateral_N", "no_slip_margin_N", "energy_J")


def random_inputs(count: int, wheels: int) -> list[dict[str, list[float]]]:
    """A set of inputs for every stretch; small forces, so that nothing runs away."""
    random = np.random.default_rng(7)
    sizes = {"voltage_V": wheels, "axle_torque_Nm": wheels, "body_force_N": 2, "body_moment_Nm": 1,
             "world_force_N": 2, "world_force_point_m": 2}
    scale = {"voltage_V": 2.0, "axle_torque_Nm": 0.01, "body_force_N": 0.3, "body_moment_Nm": 0.01,
             "world_force_N": 0.3, "world_force_point_m": 0.1}
    return [{name: (scale[name] * random.uniform(-1, 1, size)).tolist() for name, size in sizes.items()}
            for _ in range(count)]


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("scene_name, steps", [
    *((name, QUICK_STEPS) for name in rigid_scene_names() if name in QUICK),
    *(pytest.param(name, STEPS, marks=pytest.mark.nightly) for name in rigid_scene_names())])
def test_thousands_of_steps_give_the_same_bits_as_the_core(scene_name: str, steps: int, variant: str,
                                                           tmp_path: Path) -> None:
    version, scalar = VARIANTS[variant]
    scene = read_scene(scene_name).with_run(real="double")
    fmu = make_fmu(scene, tmp_path / "scene.fmu", version=version, scalar=scalar)
    core = load("double")
    plant, step_s = scene.plant(core), scene.run.step_s
    with Importer(fmu) as importer:
        importer.initialize()
        for k, inputs in enumerate(random_inputs(steps // EVERY, scene.wheel_count)):
            for name, values in inputs.items():
                assert importer.set(name, *values) == OK
            held = core.input({signal_name(name, values, i): value for name, values in inputs.items()
                               for i, value in enumerate(values)})
            for tick in range(k * EVERY, (k + 1) * EVERY):
                assert importer.step(tick * step_s, step_s) == OK
            plant.run(held, EVERY)
            got = [value for name in NAMES for value in importer.get(name)]
            assert got == outputs_of(plant, held), f"after {(k + 1) * EVERY} steps"
            if not plant.has_friction:
                assert importer.get("acceleration_body_m_per_s2") == plant.body_acceleration(held).tolist()


COUNTED_STEPS = 2000
MOST = 560  # instructions to set four voltages, take the step, and get ν, position and heading, without the core's step


def instructions_a_step(loop: str) -> float:
    """I(2n) − I(n) over n: loading and start cancel."""
    program = [str(built(f"fmu/{name}")) for name in (
        "laconic_fmu_overhead", "Laconic/fmi2/Laconic.so", "Laconic/fmi3/Laconic.so", "liblaconic_fmu_minimal.so")]
    once, twice = (instructions_of([*program, "--count", loop, str(steps)])
                   for steps in (COUNTED_STEPS, 2 * COUNTED_STEPS))
    return (twice - once) / COUNTED_STEPS


@pytest.mark.nightly
@pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")
def test_the_calls_of_a_step_cost_less_than_the_step(capsys: pytest.CaptureFixture[str]):
    core, least = instructions_a_step("core"), instructions_a_step("minimal")
    for version in (2, 3):
        glue = instructions_a_step(f"fmi{version}") - core
        with capsys.disabled():
            print(f"\nFMI {version}: {glue:.0f} instructions beyond the core's {core:.0f}; a minimal FMU: {least:.0f}")
        assert least < glue < MOST


STEPS_WITH_LOADS = 20


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["canopen_agv", "kuka_youbot", "skid_steer"])
def test_the_loads_have_the_cores_bits(name: str, version: int, tmp_path: Path) -> None:
    scene = laconic.read_scene(name)
    step_s, supports = scene.run.step_s, len(scene.vehicle["support"])
    volts = [2.0 + wheel for wheel in range(scene.wheel_count)]
    plant = laconic.Vehicle.of(scene).plant(scene.run.method, step_s)
    with Importer(make_fmu(scene, tmp_path / "robot.fmu", version=version)) as fmu:
        fmu.initialize()
        for step in range(STEPS_WITH_LOADS):
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
