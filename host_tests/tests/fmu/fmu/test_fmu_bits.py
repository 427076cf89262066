"""FMUs give the same bits as the core, for every scene, in both FMI versions, with arrays and without."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmu_importer import OK, Importer

from laconic.core import load
from laconic.fmu import make_fmu
from laconic.scene import read_scene, rigid_scene_names

VARIANTS = {"fmi2": (2, False), "fmi3": (3, False), "fmi3-scalar": (3, True)}
STEPS, EVERY = 10_000, 100
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
@pytest.mark.parametrize("scene_name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.nightly)
                                        for name in rigid_scene_names()])
def test_ten_thousand_steps_give_the_same_bits_as_the_core(scene_name: str, variant: str, tmp_path: Path) -> None:
    version, scalar = VARIANTS[variant]
    scene = read_scene(scene_name).with_run(real="double")
    fmu = make_fmu(scene, tmp_path / "scene.fmu", version=version, scalar=scalar)
    core = load("double")
    plant, step_s = scene.plant(core), scene.run.step_s
    with Importer(fmu) as importer:
        importer.initialize()
        for k, inputs in enumerate(random_inputs(STEPS // EVERY, scene.wheel_count)):
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
