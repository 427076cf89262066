"""Scenes with ground friction, drives with limits and slopes: what they show, and what is refused in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
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


ROLLERS = ('kind = "fixed"', 'kind = "omni"')
FIRST = "x_m = 0.15\ny_m = 0.2\naxle_deg = -90"  # of the first wheel
ON_IDEAL = ("friction_coefficient = 0.6\naxle_friction_Nm = 0.2", "slope_deg = 1")
REFUSED = {
    "drag above 1": (ROLLERS, ("axle_friction_Nm = 0.2", "roller_drag = 1.2"), ("ground.roller_drag: 1.2 is above 1",)),
    "negative drag": (ROLLERS, ("axle_friction_Nm = 0.2", "roller_drag = -0.2"),
                      ("ground.roller_drag: -0.2", "negative")),
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
    "another method": (("step_s = 0.001", f"step_s = 0.001\nmethod = \"{EXPLICIT}\""), ("run.method", "use auto")),
    "wheels without inertia": (("wheel_inertia_kgm2 = 0.01", "wheel_inertia_kgm2 = 0"),
                               ("vehicle.wheel_inertia_kgm2: 0 is not positive",)),
    "no such circuit": (("y_m = 0.2\naxle_deg = -90", "y_m = 0.2\naxle_deg = -90\nmotor_circuit = \"off\""),
                        ("vehicle.wheel[1].motor_circuit", "open")),
    "steep": (("axle_friction_Nm = 0.2", "slope_deg = 89.9"),
              ("ground.slope_deg: 89.9 is above 85.943; give 85.943 or less",)),
    "steep in rad": (("axle_friction_Nm = 0.2", "slope_rad = 1.56"),
                     ("ground.slope_rad: 1.56 is above 1.5; give 1.5",)),
    "uphill of nothing": (("axle_friction_Nm = 0.2", "slope_heading_deg = 30"),
                          ("ground.slope_heading_deg: has no effect on level ground; give slope_deg, too",)),
    "own friction on ideal ground": (
        ON_IDEAL, (FIRST, f"{FIRST}\nfriction_coefficient = 0.3"),
        ("vehicle.wheel[1].friction_coefficient: 0.3 has no effect on ideal ground; give ground.friction",)),
    "a wheel without friction": ((FIRST, f"{FIRST}\nfriction_coefficient = 0.0"),
                                 ("wheel[1].friction_coefficient: is 0; give a value above 0 (1e-6 is ice), or",)),
    "an empty ground": (("friction_coefficient = 0.6\naxle_friction_Nm = 0.2\n", ""),
                        ("ground: is empty; give friction_coefficient or slope_deg",)),
    "drag where no wheel has rollers": (("axle_friction_Nm = 0.2", "roller_drag = 0.2"),
                                        ("ground.roller_drag: has no effect, as no wheel has rollers",)),
    "drag of a fixed wheel": ((FIRST, f"{FIRST}\nroller_drag = 0.2"), ("wheel[1].roller_drag", "fixed wheel")),
    "voltage of an open motor": ((FIRST, f'{FIRST}\nmotor_circuit = "open"'),
                                 ("input[1].signal", "would do nothing, the motor of wheel 1 is open")),
    "voltage of a shorted motor": ((FIRST, f'{FIRST}\nmotor_circuit = "shorted"'),
                                   ("input[1].signal", "would do nothing, the motor of wheel 1 is shorted")),
    "circuit of no motor": ((FIRST, f'{FIRST}\ndriven = false\nmotor_circuit = "open"'),
                            ("vehicle.wheel[1].motor_circuit", "without a motor")),
    "axle friction of a locked wheel": ((FIRST, f"{FIRST}\nlocked = true\naxle_friction_Nm = 1.0"),
                                        ("vehicle.wheel[1].axle_friction_Nm", "locked wheel")),
    "speed of a locked wheel": (
        (FIRST, f"{FIRST}\nlocked = true"),
        ("[run]", "[initial]\nwheel_speed_rad_per_s = [5.0, 0.0, 0.0, 0.0]\n[run]"),
        ("initial.wheel_speed_rad_per_s: gives wheel 1 5 rad/s, which is locked; give 0 for it",)),
    "no supply": (("supply_V = 24.0", "supply_V = 0"), ("supply_V: is 0; give a value above 0, or take it out",)),
    "negative supply": (("supply_V = 24.0", "supply_V = -5"), ("supply_V: is -5; give a value above 0, or take it",)),
    "negative current": (("current_limit_A = 10.0", "current_limit_A = -5"),
                         ("current_limit_A: is -5; give a value above 0, or take it out for no limit",)),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_in_one_line(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    *changes, words = REFUSED[case]
    assert run(["simulate", str(scene_with(tmp_path, *changes))]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    for word in words:
        assert word in line


def test_the_voltage_of_a_locked_motor_draws_a_current(tmp_path: Path) -> None:
    locked = read_scene(scene_with(tmp_path, (FIRST, f"{FIRST}\nlocked = true")))
    found = simulate(locked.with_run(duration_s=0.1), ("motor_current_A[1]", "wheel_speed_rad_per_s[1]")).columns
    assert found["motor_current_A[1]"][-1] > 1.0
    assert not found["wheel_speed_rad_per_s[1]"].any()


def test_a_wheel_on_ice_keeps_the_others_on_the_ground(tmp_path: Path) -> None:
    on_ice = scene_with(tmp_path, (FIRST, f"{FIRST}\nfriction_coefficient = 1e-6"))
    signals = ("contact_state", "wheel_reaction_N")
    found = simulate(read_scene(on_ice).with_run(duration_s=0.5), signals).columns
    assert np.abs(found["wheel_reaction_N[1]"]).max() < 1e-3
    assert np.abs(found["wheel_reaction_N[2]"]).max() > 10.0


def test_a_slope_pulls_downhill_on_ideal_ground(tmp_path: Path) -> None:
    text = read_scene("s1").path.read_text(encoding="utf-8")
    (tmp_path / "s.toml").write_text(text + "\n[ground]\nslope_deg = 3\nslope_heading_deg = 90\n", encoding="utf-8")
    level, sloped = simulate(read_scene("s1")), simulate(read_scene(tmp_path / "s.toml"))
    assert sloped.columns["y_m"][-1] < level.columns["y_m"][-1]
    assert sloped.method == level.method
