"""Wheels that differ, from a scene or a mapping to the core, against 40 digits of the paper's equation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import eigh

from laconic.cli.main import run
from laconic.core import Field, load
from laconic.core.fields import COUNTED
from laconic.core.sensors import values_of
from laconic.errors import BadInput
from laconic.fmu import DESCRIPTION, start_values
from laconic.scene import read_scene
from laconic.scene.methods import EXACT_4, EXPLICIT, EXPLICIT_8, STIFF_4
from laconic.scene.signals import LENGTHS, PER_WHEEL
from laconic.tools.analyse.from_core import nu_rates, subject_of
from laconic.tools.analyse.geometry import diagnose
from laconic.tools.verify.reference import reference_states
from laconic_fmu.description import read

SCENE = "example_two_wheel_sizes"
COMMON = {"mass_kg": 11.0, "yaw_inertia_kgm2": 0.31, "com_x_m": 0.013, "com_y_m": -0.021, "wheel_radius_m": 0.06,
          "wheel_inertia_kgm2": 0.007, "motor_gain_Nm_per_V": 0.4, "motor_damping_Nms": 0.03}
PLACES = ((0.2, 0.15, -1.5, 0.8), (0.2, -0.15, -1.6, -0.8), (-0.2, 0.1, -1.4, -0.7), (-0.1, -0.15, -1.7, 0.9))
OWN: tuple[dict[str, Any], ...] = (
    {"radius_m": 0.05, "inertia_kgm2": 0.002, "motor_damping_Nms": 0.09}, {"driven": False},
    {"radius_m": 0.075, "motor_gain_Nm_per_V": -0.7}, {"inertia_kgm2": 0.011})
VEHICLE = {**COMMON, "wheel": [
    {"kind": "roller", "x_m": x, "y_m": y, "axle_rad": axle, "roller_rad": roller, **own}
    for (x, y, axle, roller), own in zip(PLACES, OWN, strict=True)]}
MOTOR = {"resistance_ohm": 2.0, "torque_constant_Nm_per_A": 0.1, "back_emf_Vs_per_rad": 0.12, "gear_ratio": 5.0,
         "viscous_friction_Nms": 0.001, "rotor_inertia_kgm2": 2e-4}  # c1 = 0.25, c2 = 0.175, rotor 0.005


class Exact:
    """PHYSICS in 40 digits: each wheel's row by its rim speed, A and damping as sums over the wheels."""

    def __init__(self) -> None:
        mp.mp.dps = 40
        m, radius = mp.mpf(COMMON["mass_kg"]), mp.mpf(COMMON["wheel_radius_m"])
        self.scale = 1 / (m * radius**2)
        self.yaw_scale = mp.sqrt(mp.mpf(COMMON["yaw_inertia_kgm2"]) * self.scale)
        self.rows, self.values = mp.matrix(4, 3), []
        for i, wheel in enumerate(VEHICLE["wheel"]):
            own = mp.mpf(wheel.get("radius_m", COMMON["wheel_radius_m"]))
            axle, roller = mp.mpf(wheel["axle_rad"]), mp.mpf(wheel["roller_rad"])
            arm = [mp.mpf(wheel["x_m"]) - mp.mpf(COMMON["com_x_m"]), mp.mpf(wheel["y_m"]) - mp.mpf(COMMON["com_y_m"])]
            along = [mp.cos(axle + roller), mp.sin(axle + roller)]
            for k, hub in enumerate(([radius, 0], [0, radius], [-arm[1] / self.yaw_scale, arm[0] / self.yaw_scale])):
                rim = hub[0] * along[0] + hub[1] * along[1]  # velocity of the hub along the roller = R_i sin γ χ'
                self.rows[i, k] = rim / (own * mp.sin(roller))
            driven = wheel.get("driven", True)
            self.values.append([mp.mpf(wheel.get("inertia_kgm2", COMMON["wheel_inertia_kgm2"]))] + [
                mp.mpf(wheel.get(key, COMMON[key])) if driven else mp.mpf(0)
                for key in ("motor_gain_Nm_per_V", "motor_damping_Nms")])
        self.inertia, self.damping = mp.eye(3) + self.form(0), self.form(2)

    def form(self, which: int) -> Any:
        weights = mp.diag([self.scale * value[which] for value in self.values])
        return self.rows.T * weights * self.rows

    def rates(self, nu: np.ndarray, voltage: np.ndarray, torque: np.ndarray) -> list[float]:
        n = mp.matrix([mp.mpf(float(v)) for v in nu])
        drive = mp.matrix([self.values[i][1] * mp.mpf(float(voltage[i])) + mp.mpf(float(torque[i])) for i in range(4)])
        gyroscopic = mp.matrix([n[1] * n[2], -n[0] * n[2], 0]) / self.yaw_scale
        right = gyroscopic + self.scale * (self.rows.T * drive) - self.damping * n
        return [float(v) for v in mp.lu_solve(self.inertia, right)]


def test_derivative_agrees_with_forty_digits_of_the_papers_equation() -> None:
    core, exact, random = load("double"), Exact(), np.random.default_rng(5)
    model = core.prepare(core.vehicle(VEHICLE))
    for _ in range(100):
        nu, voltage, torque = random.normal(0, 5, 3), random.normal(0, 5, 4), random.normal(0, 0.5, 4)
        found = nu_rates(core, model, nu, 0.0, core.input({"voltage_V": voltage, "axle_torque_Nm": torque}, 4))
        expected = np.array(exact.rates(nu, voltage, torque))
        assert np.abs(found - expected).max() <= 2e-14 * max(1.0, np.abs(expected).max())


def test_the_damping_rates_are_the_eigenvalues_of_damping_against_inertia() -> None:
    core, exact = load("double"), Exact()
    model = core.prepare(core.vehicle(VEHICLE))
    as_array = [np.array(each.tolist(), dtype=float) for each in (exact.damping, exact.inertia)]
    expected = eigh(*as_array, eigvals_only=True)
    np.testing.assert_allclose(np.sort(core.numbers(model.decay_per_s)), expected, rtol=1e-13)
    np.testing.assert_allclose(core.matrices(core.vehicle(VEHICLE)).inertia, as_array[1], rtol=1e-14)


def test_a_run_agrees_with_the_independent_reference_in_every_method() -> None:
    scene = read_scene(SCENE)
    expected = reference_states(scene, np.array([scene.run.duration_s]))[0]
    for method in (EXPLICIT, STIFF_4, EXACT_4, EXPLICIT_8, "auto"):
        plant = scene.with_run(method=method, step_s=0.001).plant(load("double"))
        inputs = scene.with_run(step_s=0.001).inputs_on_grid()
        for segment in inputs.segments():
            plant.run(plant.core.input(segment.values), segment.steps)
        np.testing.assert_allclose(plant.nu, expected[:3], atol=1e-8)
        np.testing.assert_allclose([plant.pose.x_m, plant.pose.y_m], expected[3:5], atol=1e-8)
        np.testing.assert_allclose(plant.wheel_angles(), expected[6:], atol=1e-6)


# ---- what a 0 means


def fitted(wheels: list[dict[str, Any]], **more: Any) -> Any:
    core = load("double")
    places = [{"kind": "fixed", "x_m": 0.0, "y_m": y, "axle_rad": -1.5707963267948966} for y in (0.1, -0.1, 0.3)]
    vehicle = core.vehicle({**COMMON, **more, "wheel": [p | w for p, w in zip(places, wheels, strict=True)]})
    model = core.prepare(vehicle)
    names = ("wheel_inertia_kgm2", "motor_gain_Nm_per_V", "motor_damping_Nms")
    return {name: core.numbers(getattr(model, name))[:3].tolist() for name in names}


def test_a_wheels_own_zero_is_a_zero() -> None:
    zero = {"inertia_kgm2": 0.0, "motor_gain_Nm_per_V": 0.0, "motor_damping_Nms": 0.0}
    found = fitted([{}, zero, {"motor_damping_Nms": 0.01}])
    assert found["wheel_inertia_kgm2"] == [0.007, 0.0, 0.007]
    assert found["motor_gain_Nm_per_V"] == [0.4, 0.0, 0.4]
    assert found["motor_damping_Nms"] == [0.03, 0.0, 0.01]


def test_the_rotor_of_the_motor_is_added_to_the_driven_wheels_only_and_an_own_zero_stays() -> None:
    bare = {key: value for key, value in COMMON.items() if not key.startswith("motor_")}
    vehicle = {**dict.fromkeys(("motor_gain_Nm_per_V", "motor_damping_Nms"), 0.0), **bare, "motor": MOTOR}
    found = fitted([{"inertia_kgm2": 0.001, "motor_damping_Nms": 0.0}, {"driven": False}, {"inertia_kgm2": 0.0}],
                   **vehicle)
    assert found["wheel_inertia_kgm2"] == pytest.approx([0.006, 0.007, 0.005])
    assert found["motor_gain_Nm_per_V"] == pytest.approx([0.25, 0.0, 0.25])
    assert found["motor_damping_Nms"] == pytest.approx([0.0, 0.0, 0.175])


def test_a_zero_that_single_precision_makes_of_a_tiny_value_is_a_zero_and_no_radius() -> None:
    core = load("single")
    wheel = VEHICLE["wheel"][1] | {"driven": True}
    vehicle = core.vehicle({**VEHICLE, "wheel": [wheel | {"inertia_kgm2": 1e-60}, wheel]})
    assert core.numbers(core.prepare(vehicle).wheel_inertia_kgm2)[:2].tolist() == [0.0, np.float32(0.007)]
    with pytest.raises(BadInput, match=r"vehicle.wheel\[2\].radius_m: 1e-60 is not positive"):
        core.vehicle({**VEHICLE, "wheel": [wheel, wheel | {"radius_m": 1e-60}]})


# ---- what is refused, and what the tools say


BAD = {
    "negative radius": ("radius_m = 0.099", "radius_m = -1.0", "vehicle.wheel[2].radius_m: is -1; give a value"),
    "no radius": ("radius_m = 0.099", "radius_m = 0", "vehicle.wheel[2].radius_m: is 0; give a value above 0"),
    "infinite radius": ("radius_m = 0.099", "radius_m = inf", "vehicle.wheel[2].radius_m"),
    "negative inertia": ("radius_m = 0.099", "inertia_kgm2 = -1", "vehicle.wheel[2].inertia_kgm2: -1 is negative"),
    "negative damping": ("radius_m = 0.099", "motor_damping_Nms = -1", "vehicle.wheel[2].motor_damping_Nms: -1 is neg"),
    "gain that is no number": ("radius_m = 0.099", "motor_gain_Nm_per_V = nan", "wheel[2].motor_gain_Nm_per_V"),
    "driven by a word": ("driven = false", 'driven = "no"', "vehicle.wheel[3].driven"),
    "motor of a wheel without one": ("driven = false", "driven = false\nmotor_gain_Nm_per_V = 1",
                                     "vehicle.wheel[3].motor_gain_Nm_per_V: is given for a wheel without a motor"),
    "voltage of a wheel without a motor": ('"voltage_V[2]"', '"voltage_V[3]"', "wheel 3 has no motor"),
}


@pytest.mark.parametrize(("old", "new", "words"), BAD.values(), ids=BAD.keys())
def test_a_bad_value_of_a_wheel_is_one_line_with_its_key(old: str, new: str, words: str, tmp_path: Path,
                                                         capsys: pytest.CaptureFixture[str]) -> None:
    text = read_scene(SCENE).path.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "scene.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert run(["simulate", str(path)]) == 2
    line = capsys.readouterr().err
    assert words in line and line.count("\n") == 1


def test_rim_speeds_do_not_depend_on_which_key_gives_the_radius(tmp_path: Path) -> None:
    text = read_scene("turtlebot3_burger").path.read_text(encoding="utf-8")
    radius = read_scene("turtlebot3_burger").vehicle["wheel_radius_m"]
    path = tmp_path / "own.toml"
    path.write_text(text.replace(f"wheel_radius_m = {radius}", "wheel_radius_m = 1.0").replace(
        'kind = "fixed"', f'kind = "fixed"\nradius_m = {radius}'), encoding="utf-8")
    found = [diagnose(subject_of(read_scene(each))).yaw_authority for each in ("turtlebot3_burger", path)]
    assert found[0] == pytest.approx(found[1], rel=1e-12)


def test_derive_shows_what_each_wheel_has(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["derive", SCENE]) == 0
    text = capsys.readouterr().out
    assert "lambda_1 = " in text and "c1_1 = 1.875" in text and "c1_3 = 0 N m/V,  c2_3 = 0 N m s" in text
    assert subject_of(read_scene(SCENE)).wheels_differ


# ---- Each field of a vehicle is described once (vehicle.h): nothing is left out of the list, and the rest follows
# it.

STRUCTS = {"vehicle": "laconic_vehicle", "vehicle.payload": "laconic_payload", "vehicle.wheel[#]": "laconic_wheel",
           "vehicle.support[#]": "laconic_support", "ground": "laconic_ground", "vehicle.drive": "laconic_drive",
           "vehicle.motor": "laconic_motor", "initial": "laconic_start",
           "": "laconic_input"}
"""Table of a scene → struct of the core."""


def parameters() -> list[Field]:
    return [field for field in load().fields if field.table and field.table != "vehicle.motor"]


@pytest.mark.parametrize("table", STRUCTS)
def test_every_member_of_a_struct_has_its_row_in_the_list(table: str) -> None:
    core = load()
    members = {name for name, _ in core.ffi.typeof(STRUCTS[table]).fields}
    counted = {*COUNTED, *(f"{name}_count" for name in COUNTED)}
    inner = {"payload", "ground", "drive", *counted} if table == "vehicle" else set()
    assert {field.member for field in core.fields_of(table)} == members - inner, "vehicle.h: member without a row"


def test_every_setting_of_a_sensor_has_its_row_and_its_key() -> None:
    core = load()
    structs = {"sensors.imu": "laconic_imu_settings", "sensors.encoder": "laconic_encoder_settings"}
    for path, struct in structs.items():
        members = {name for name, _ in core.ffi.typeof(struct).fields}
        assert {field.key for field in core.fields_of(path)} - {"wrap"} == members, "sensors.h: member without a row"
    settings = core.ffi.new("laconic_sensor_settings *")
    assert all(len(values_of(field, settings)) == max(field.items, 1) for field in core.sensor_fields)


def test_a_list_has_room_for_as_many_items_as_its_struct() -> None:
    vehicle, start = load().ffi.new("laconic_vehicle *"), load().ffi.new("laconic_start *")
    for field in parameters():
        if field.table != "run":
            assert len(field.values(vehicle if field.table != "initial" else start)) == max(field.items, 1), field


def test_inputs_of_scenes_are_those_of_the_list() -> None:
    known = {field.name: field.items for field in load().fields if not field.table}
    assert known == {**dict.fromkeys(PER_WHEEL, load().max_wheels), **LENGTHS}


def test_every_parameter_is_a_variable_of_the_fmus_and_has_its_start_value_there() -> None:
    variables = {variable.name: variable for variable in read(DESCRIPTION).variables}
    given = start_values(read_scene("s1"))
    for field in parameters():
        assert field.name in variables, f"modelDescription.xml: there is no variable {field.name}"
        assert field.name in given
        assert (variables[field.name].size is None) == (field.items == 0), field.name
    assert not [field.name for field in load().sensor_fields if field.name not in variables or field.name not in given]
