"""Scenes with ground friction, drives with limits and slopes: what they show, and what is refused in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.paths import scene_path
from laconic.scene import read_scene
from laconic.simulation import simulate

LOSSES = ("slip_loss_J", "axle_loss_J", "motor_loss_J", "supply_loss_J", "numerical_loss_J")
SKID = scene_path("skid_steer")


def scene_with(tmp_path: Path, *changes: tuple[str, str]) -> Path:
    text = read_scene(SKID).path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    return tmp_path / "scene.toml"


def test_four_fixed_wheels_turn_by_slipping_and_then_rest_exactly() -> None:
    found = simulate(read_scene(SKID), ("heading_rad", "yaw_rate_rad_per_s", "contact_state", "energy_J"))
    assert abs(found.columns["heading_rad"][-1]) > 0.3
    assert found.columns["contact_state[1]"].max() == 1.0
    assert found.columns["energy_J"][-1] == 0.0


def test_the_energy_drawn_from_the_supply_balances() -> None:
    found = simulate(read_scene(SKID), ("energy_J", "supply_energy_J", "outer_work_J", *LOSSES)).columns
    lost = np.sum([found[name] for name in LOSSES], axis=0)
    assert found["supply_energy_J"][-1] > 10.0
    off = found["energy_J"] - found["supply_energy_J"] - found["outer_work_J"] + lost
    assert np.abs(off).max() < 1e-9 * found["supply_energy_J"].max()


REFUSED = {
    "drag above 1": (("axle_friction_Nm = 0.2", "roller_drag = 1.2"), ("ground.roller_drag: 1.2 is above 1",)),
    "negative drag": (("axle_friction_Nm = 0.2", "roller_drag = -0.2"), ("ground.roller_drag: -0.2", "negative")),
    "no friction": (("friction_coefficient = 0.6", "friction_coefficient = 0"),
                    ("ground.friction_coefficient: is 0", "above 0")),
    "negative axle friction": (("axle_friction_Nm = 0.2", "axle_friction_Nm = -1"), ("ground.axle_friction_Nm: -1",)),
    "both frictions": (("mass_kg = 30.0", "mass_kg = 30.0\nfriction_coefficient = 0.5"),
                       ("vehicle.friction_coefficient", "ground.friction_coefficient")),
    "drag without friction": (("friction_coefficient = 0.6\n", ""), ("ground.axle_friction_Nm", "ideal ground")),
    "drive without motor": (
        ("[vehicle.motor]\nresistance_ohm = 0.6\ntorque_constant_Nm_per_A = 0.04\nback_emf_Vs_per_rad = 0.04\n"
         "gear_ratio = 40.0\nviscous_friction_Nms = 2e-5\n", "motor_gain_Nm_per_V = 1\nmotor_damping_Nms = 1\n"),
        ("vehicle.drive", "[vehicle.motor]")),
    "another method": (("step_s = 0.001", "step_s = 0.001\nmethod = \"rk4\""), ("run.method", "use auto")),
    "wheels without inertia": (("wheel_inertia_kgm2 = 0.01", "wheel_inertia_kgm2 = 0"),
                               ("vehicle.wheel_inertia_kgm2: 0 is not positive",)),
    "no such circuit": (("y_m = 0.2\naxle_deg = -90", "y_m = 0.2\naxle_deg = -90\nmotor_circuit = \"off\""),
                        ("vehicle.wheel[1].motor_circuit", "open")),
    "steep": (("axle_friction_Nm = 0.2", "slope_deg = 89"), ("ground.slope_deg",)),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_in_one_line(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    change, words = REFUSED[case]
    assert run(["simulate", str(scene_with(tmp_path, change))]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    for word in words:
        assert word in line


def test_a_slope_pulls_downhill_on_ideal_ground(tmp_path: Path) -> None:
    text = read_scene("s1").path.read_text(encoding="utf-8")
    (tmp_path / "s.toml").write_text(text + "\n[ground]\nslope_deg = 3\nslope_heading_deg = 90\n", encoding="utf-8")
    level, sloped = simulate(read_scene("s1")), simulate(read_scene(tmp_path / "s.toml"))
    assert sloped.columns["y_m"][-1] < level.columns["y_m"][-1]
    assert sloped.method == level.method
