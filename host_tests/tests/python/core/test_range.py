"""A result beyond the range of numbers is refused, as a step is, and a saved state that holds none is not restored."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import laconic
from laconic.core import Vehicle
from laconic.core.saved import check_saved
from laconic.scene.methods import EXPLICIT
from laconic.scene.signals import SUPPORT_LOAD, WHEEL_LOAD

HUGE = {"voltage_V": [1e308] * 3}
TORQUES = {"axle_torque_Nm": [1.7e308] * 3, "voltage_V": [1.7e308] * 3}
KNOWN = {"position_std_m": 0.1, "encoder_std_rad": 0.1, "nu_std_rad_per_s": 0.1}


def robot(name: str = "robotino2", real: str = "double") -> laconic.Vehicle:
    return laconic.Vehicle(laconic.read_scene(name).vehicle, real)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("ask, what", [
    (lambda: robot().derivative([1e200] * 3), "derivative"),
    (lambda: robot().derivative(inputs=HUGE), "derivative"),
    (lambda: robot().linearise([1.7e308] * 3, 0.3), "linearise"),
    (lambda: robot().plant().body_acceleration(HUGE), "body_acceleration"),
    (lambda: robot().plant().wheel_torques(TORQUES), "wheel_torques"),
    (lambda: robot().plant().reactions(HUGE), "reactions"),
    (lambda: robot().plant().outputs(HUGE), "reactions"),
    (lambda: robot().plant().outputs(TORQUES), "outputs"),
    (lambda: robot().plant().sensors().read(HUGE), "acceleration_body_m_per_s2"),
    (lambda: robot().plant().step_derivatives().tangent([1e308] * 9), "tangent"),
    (lambda: robot().plant(step_s=0.1, nu_rad_per_s=(5, 9, 2)).step_derivatives().adjoint([1.797e308] * 9), "adjoint"),
    (lambda: robot().plant(step_s=0.01, nu_rad_per_s=(5, 9, 2)).step_derivatives({"voltage_V": [9, 8, 7]})
     .vehicle_gradient([1e308] * 9, ["wheel_radius_m"]), "vehicle_gradient")])
def test_a_result_beyond_all_numbers_is_refused_and_never_nan(ask: Callable[[], Any], what: str) -> None:
    with pytest.raises(laconic.Refused) as refused:
        ask()
    assert str(refused.value) == f"{what}: a result leaves the range of double precision; check inputs and units"
    assert refused.value.status == "overflow"


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("name", ["robotino2", "skid_steer"])
@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_a_saved_state_that_was_spoilt_is_not_restored(bad: float, name: str, real: str) -> None:
    plant = robot(name, real).plant(step_s=0.01)
    plant.run({}, 3)
    saved, before = plant.save(), plant.row().tolist()
    state = saved.state if plant.has_friction else saved
    state.x_m.value = bad
    where = "plant.state.x_m.value" if plant.has_friction else "state.x_m.value"
    with pytest.raises(laconic.BadInput, match=f"^{where}: {bad} is not finite; give what save"):
        plant.restore(saved, 5)
    assert (plant.row().tolist(), plant.steps) == (before, 3)
    state.x_m.value = 0.25
    plant.restore(saved, 5)
    assert (plant.pose.x_m, plant.steps) == (0.25, 5)


def test_spoilt_wheels_sensors_and_filters_are_not_restored() -> None:
    skids = robot("skid_steer").plant()
    saved = skids.save()
    saved.slip.wheel_angle_rad[1].value = float("nan")
    with pytest.raises(laconic.BadInput, match=r"^plant.slip.wheel_angle_rad\[2\].value: nan is not finite"):
        skids.restore(saved, 0)
    sensors = robot().plant().sensors()
    shown = sensors.save()
    shown.sample[0].yaw_rate_rad_per_s = float("inf")
    with pytest.raises(laconic.BadInput, match=r"^sensors.sample\[1\].yaw_rate_rad_per_s: inf is not finite"):
        sensors.restore(shown)
    ours = laconic.Filter(robot().plant(), KNOWN)
    kept = ours.save()
    kept[1].state.heading.rest = float("nan")
    with pytest.raises(laconic.BadInput, match=r"^saved.state.heading.rest: nan is not finite"):
        ours.restore(kept)
    for parts in ((None, kept[2]), (kept[1], None)):
        with pytest.raises(laconic.BadInput, match=r"^saved: .* is not of this filter; give what its save\(\) gave"):
            ours.restore((kept[0], *parts))


CART, OMNI = "turtlebot3_burger", "robotino2"


@pytest.mark.parametrize("real", ["double", "single"])
def test_a_state_with_a_motion_that_the_wheels_forbid_is_not_restored(real: str) -> None:
    cart, omni = robot(CART, real).plant(step_s=0.01), robot(OMNI, real).plant(step_s=0.01)
    cart.run({"voltage_V": [3, 4]}, 5)
    omni.run({"voltage_V": [3, -1, 2]}, 5)
    before = cart.row().tolist()
    with pytest.raises(laconic.BadInput, match=r"^state.zeta\[3\].value: .* is a motion that the wheels of this robot"):
        cart.restore(omni.save(), 5)
    way = omni.save()
    way.zeta[2].value = 0.0
    with pytest.raises(laconic.BadInput, match=r"^state.travel\[3\].value: .* forbid; give what save\(\) of this"):
        cart.restore(way, 5)
    more = cart.save()
    more.wheel_angle_set_rad[2] = 0.5
    with pytest.raises(laconic.BadInput, match=r"^state.wheel_angle_set_rad\[3\]: is 0.5, and this robot has 2 wheels"):
        cart.restore(more, 5)
    assert (cart.row().tolist(), cart.steps) == (before, 5)
    cart.restore(cart.save(), 3)
    assert (cart.row().tolist(), cart.steps) == (before, 3)


def test_a_saved_plant_of_another_number_of_wheels_or_without_friction_is_not_restored() -> None:
    skids, three = robot("skid_steer").plant(), robot("robotino_grey").plant()
    with pytest.raises(laconic.BadInput, match="^plant: is of a robot with 3 wheels, and this has 4; give what save"):
        skids.restore(three.save(), 0)
    with pytest.raises(laconic.BadInput, match="^plant: is of a robot without friction; give what save"):
        skids.restore(robot().plant().c, 0)


def test_a_state_of_a_batch_of_the_robot_is_restored() -> None:
    cart = robot(CART)
    batch = laconic.Batch(cart, 3, EXPLICIT, 0.001)
    batch.voltage_V = np.array([[1.0, 2, 3], [3, 2, 1]])
    batch.run(20)
    plant = cart.plant(EXPLICIT, 0.001)
    plant.restore(batch.state(2), 20)
    assert plant.pose.x_m == batch.x_m[2] != 0.0


def test_every_real_number_of_a_saved_state_is_looked_at() -> None:
    plant = robot().plant()
    core, words = plant.core, plant.core.ffi.sizeof("laconic_state") // 8
    passed = []
    for word in range(words):
        saved = plant.save()
        np.frombuffer(core.ffi.buffer(saved))[word] = np.nan
        try:
            check_saved(core, "state", saved[0])
        except laconic.BadInput:
            continue
        passed.append(word)
    heading = core.ffi.offsetof("laconic_state", "heading") // 8
    assert passed == [heading, heading + 1]  # turns and fraction, which are whole numbers


# ---- No run gains energy without input: what a caller of the package sees, and the campaign on a few of its
# vehicles.

CAMPAIGN = Path(__file__).parents[3] / "assurance/energy.py"
KEPT = {"double": 1e-9, "single": 1e-4}
KEEPERS = ("auto", "exact-flow", "exact-flow-4")


def spun_up(real: str) -> Vehicle:
    """Seven fixed wheels on one axle line, the centre of mass beside it."""
    places = (-0.0397, 0.0018, -0.2922, -0.1425, -0.4584, 0.184, 0.0723)
    wheels = [{"kind": "fixed", "x_m": 0.0, "y_m": y, "axle_rad": np.pi / 2} for y in places]
    return Vehicle({"mass_kg": 0.2546, "yaw_inertia_kgm2": 1.76e-10, "wheel_radius_m": 1.693e-5,
                    "wheel_inertia_kgm2": 2.242e-15, "motor_gain_Nm_per_V": 6.297e-7, "com_x_m": -0.101,
                    "com_y_m": -0.2306, "wheel": wheels}, real)


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("method", KEEPERS)
def test_a_cart_that_was_spun_up_keeps_its_energy(method: str, real: str):
    plant = spun_up(real).plant(method, step_s=0.0109)
    plant.run({"voltage_V": [20.6, 38.7, 22.6, -15.6, 48.1, -20.5, -63.6]}, steps=1000)
    energy_J = plant.energy_J()
    for _ in range(10):
        plant.run(steps=2000)
        assert abs(plant.energy_J() / energy_J - 1) < KEPT[real] + 4 * np.finfo(plant.core.dtype).eps


@pytest.mark.parametrize("step_s", [0.05, 0.2])
@pytest.mark.parametrize("method", KEEPERS)
def test_a_plain_cart_keeps_its_energy(method: str, step_s: float):
    wheels = [{"kind": "fixed", "y_m": y, "axle_rad": -np.pi / 2} for y in (-0.3, 0.3)]
    cart = Vehicle({"mass_kg": 30.0, "yaw_inertia_kgm2": 2.0, "wheel_radius_m": 0.1, "wheel_inertia_kgm2": 0.01,
                    "com_x_m": 0.2, "wheel": wheels})
    for yaw_rate in (0.5, 3.0, 20.0):
        nu = (15 / 0.1, 0.2 * yaw_rate / 0.1, yaw_rate * cart.model.yaw_scale)
        plant = cart.plant(method, step_s, nu_rad_per_s=nu)
        energy_J = plant.energy_J()
        plant.run(steps=2000)
        assert abs(plant.energy_J() / energy_J - 1) < 1e-9


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("damped", [[], ["--damped"]])
def test_every_method_stays_within_the_bound_that_its_page_states(real: str, damped: list[str]):
    # among them vehicles 44 and 53, which auto made faster, and six with which exponential-kahan-4 did so
    run = subprocess.run([sys.executable, CAMPAIGN, "--first", "44", "--vehicles", "16", "--steps", "2000", "--real",
                          real, *damped], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stdout.count("of its bound") == 8


# ---- Normal loads of wheels and supports: they carry the weight, balance the ground's forces, and every way shows
# them.

GRAVITY_M_PER_S2 = 9.81
STEPS = 30
SUPPORTED, SLIPPING, ROLLING = "canopen_agv", "skid_steer", "kuka_youbot"


def driven(name: str, real: str = "double") -> tuple[laconic.Scene, laconic.Plant, dict[str, Any]]:
    """A robot that speeds up straight ahead, and its input."""
    scene = laconic.read_scene(name).with_run(real=real)
    plant = laconic.Vehicle.of(scene).plant("auto", scene.run.step_s)
    turns = np.sign(plant.core.matrices(laconic.Vehicle.of(scene)).wheel_rows[:, 0])
    return scene, plant, {"axle_torque_Nm": (0.5 * turns).tolist()}


def places_of(plant: laconic.Plant) -> np.ndarray:
    """Of wheels and then supports in the body frame, (points, 2)."""
    vehicle = plant.c.vehicle
    return np.array([(each.x_m, each.y_m) for each in (*list(vehicle.wheel)[: vehicle.wheel_count],
                                                       *list(vehicle.support)[: vehicle.support_count])])


@pytest.mark.parametrize("name", [SUPPORTED, ROLLING])
def test_the_loads_carry_the_weight_and_balance_the_force_that_speeds_the_robot_up(name: str) -> None:
    scene, plant, held = driven(name)
    loads = np.concatenate([plant.wheel_loads(held), plant.support_loads(held)])
    mass_kg, com_z_m = scene.vehicle["mass_kg"], scene.vehicle["com_z_m"]
    assert len(loads) == scene.wheel_count + len(scene.vehicle["support"]) and com_z_m > 0
    assert loads.sum() == pytest.approx(mass_kg * GRAVITY_M_PER_S2, rel=1e-3)
    force_N = mass_kg * plant.body_acceleration(held)
    lever = places_of(plant) - (scene.vehicle["com_x_m"], scene.vehicle["com_y_m"])
    assert abs(force_N[0]) > 1.0
    assert loads @ lever == pytest.approx(-com_z_m * force_N, abs=1e-9)


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("name", [SUPPORTED, SLIPPING, ROLLING])
def test_a_runs_columns_are_the_loads_of_the_plant(name: str, real: str) -> None:
    scene = laconic.read_scene(name).with_run(real=real)
    scene = scene.with_run(duration_s=STEPS * scene.run.step_s)
    scene = replace(scene, outputs=replace(scene.outputs, every_s=None))
    signals = [WHEEL_LOAD, *([SUPPORT_LOAD] if scene.vehicle["support"] else [])]
    run = laconic.simulate(scene, signals)
    plant, inputs = scene.plant(scene.core()), scene.inputs_on_grid()
    for step in range(STEPS + 1):
        held = plant.core.input(inputs.held_at(step))
        expected = [*plant.wheel_loads(held), *plant.support_loads(held)]
        assert [run.columns[each][step] for each in run.columns] == expected
        if step < STEPS:
            samples = plant.core.input_row(inputs.held_at(step), plant.wheel_count)
            plant.run(plant.core.input(samples))


def test_on_ground_with_friction_they_carry_the_weight() -> None:
    scene = laconic.read_scene(SLIPPING).with_run(duration_s=1.0)
    run = laconic.simulate(scene, [WHEEL_LOAD])
    weight_N = scene.vehicle["mass_kg"] * GRAVITY_M_PER_S2
    assert run.columns_of(WHEEL_LOAD).sum(axis=1) == pytest.approx(weight_N, rel=1e-3)


def test_a_robot_that_stops_hard_lifts_a_wheel_and_the_load_says_so() -> None:
    tables = {"mass_kg": 10.0, "yaw_inertia_kgm2": 1.0, "com_z_m": 0.5, "wheel_radius_m": 0.05,
              "wheel_inertia_kgm2": 0.01, "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.02,
              "wheel": [{"kind": "mecanum", "x_m": x, "y_m": y, "axle_deg": -90, "roller_deg": 45 * np.sign(x * y)}
                        for x in (0.2, -0.2) for y in (0.2, -0.2)]}
    plant = laconic.Vehicle(tables).plant(step_s=0.01)
    ahead, behind = plant.wheel_loads({"voltage_V": [12.0] * 4}).reshape(2, 2)
    assert (ahead < 0).all() and (behind > 0).all()
    assert plant.support_loads().shape == (0,)


@pytest.mark.parametrize("change, signal, message", [
    ({"com_z_m": 0.0, "friction_coefficient": 0.0, "support": []}, SUPPORT_LOAD,
     "support_load_N is a support's, and the scene has none; give [[vehicle.support]]"),
    ({"com_z_m": 0.0, "friction_coefficient": 0.0}, WHEEL_LOAD,
     "wheel_load_N depends on the height of the centre of mass, which the scene does not give; give vehicle.com_z_m"),
    ({"com_z_m": 0.0, "friction_coefficient": 0.0}, f"{SUPPORT_LOAD}[2]", "support_load_N[2] depends on the height of"),
    ({"wheel": [], "friction_coefficient": 0.0}, WHEEL_LOAD, "wheel_load_N is of a vehicle on wheels, and the scene"),
    ({}, f"{SUPPORT_LOAD}[3]", "there is no signal 'support_load_N[3]'; did you mean support_load_N[")])
def test_a_scene_that_has_no_such_loads_is_told_what_to_give(change: dict[str, Any], signal: str, message: str,
                                                             ) -> None:
    scene = laconic.read_scene(SUPPORTED)
    scene = replace(scene, vehicle=scene.vehicle | change, inputs=())
    with pytest.raises(laconic.BadInput) as refused:
        laconic.simulate(scene, [signal])
    assert message in str(refused.value)


@pytest.mark.parametrize("change", [{"com_z_m": 0.0}, {"friction_coefficient": 0.0}])
def test_the_height_or_the_friction_is_enough(change: dict[str, Any]) -> None:
    scene = laconic.read_scene(SUPPORTED).with_run(duration_s=0.1)
    run = laconic.simulate(replace(scene, vehicle=scene.vehicle | change), [WHEEL_LOAD, SUPPORT_LOAD])
    assert [*run.columns] == [f"{WHEEL_LOAD}[1]", f"{WHEEL_LOAD}[2]", f"{SUPPORT_LOAD}[1]", f"{SUPPORT_LOAD}[2]"]


def test_the_loads_are_written_with_the_other_columns(tmp_path: Path) -> None:
    from laconic.cli.main import run

    scene = tmp_path / "agv.toml"
    text = laconic.read_scene(SUPPORTED).path.read_text(encoding="utf-8")
    scene.write_text(f'{text.partition("[outputs]")[0]}[outputs]\nsignals = ["wheel_load_N", "support_load_N[2]"]\n'
                     "every_s = 0.5\n", encoding="utf-8")
    assert run(["simulate", str(scene), "--out", str(tmp_path / "run.csv")]) == 0
    heading, _ = (tmp_path / "run.csv").read_text().split("\n", 1)
    assert heading == "time_s,wheel_load_N[1],wheel_load_N[2],support_load_N[2]"
