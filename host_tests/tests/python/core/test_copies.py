"""A copy, deep or not, and what pickle makes of an object with C memory, goes its own way with the same bits."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import laconic
from laconic.batch.population import Kinds, copies_of
from laconic.can.play.vehicle import moved_inertia
from laconic.can.rig.sensed import sensor_parameters
from laconic.core import copies
from laconic.core.schedule import Schedule
from laconic.ros2.base import loop_of
from laconic.scene import Scene
from laconic.scene.base import BaseTable
from laconic.scene.scene_tables import scene_tables

VOLTS = {"voltage_V": [6.0, -3.0, 2.0]}
WAYS: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy, "deepcopy": copy.deepcopy, "pickle": lambda each: pickle.loads(pickle.dumps(each))}


@pytest.fixture(params=WAYS.values(), ids=WAYS)
def way(request: pytest.FixtureRequest) -> Callable[[Any], Any]:
    return request.param


def robot(real: str = "double", scene: str = "robotino2") -> laconic.Vehicle:
    return laconic.Vehicle.of(laconic.read_scene(scene).with_run(real=real))


def moving(real: str = "double", method: str = "auto") -> laconic.Plant:
    plant = robot(real).plant(method, step_s=0.01)
    plant.run(VOLTS, 7)
    return plant


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("method", laconic.METHODS)
def test_a_copied_plant_leaves_the_original_where_it_is(way: Any, method: str, real: str) -> None:
    plant = moving(real, method)
    before = plant.row().tolist()
    other = way(plant)
    assert (other.core, other.chosen_method, other.steps) == (plant.core, plant.chosen_method, 7)
    other.run(VOLTS, 5)
    assert plant.row().tolist() == before and (plant.steps, other.steps) == (7, 12)
    plant.run(VOLTS, 5)
    assert plant.row().tolist() == other.row().tolist()
    assert (other.reactions(VOLTS).no_slip_margin_N, other.contact) != (None, plant.contact)


def test_a_copied_plant_on_ground_with_friction_slips_by_itself(way: Any) -> None:
    plant = laconic.Vehicle.of(laconic.read_scene("skid_steer")).plant(step_s=0.001)
    plant.run({"voltage_V": [12.0, 12.0, -12.0, -12.0]}, 50)
    other = way(plant)
    other.run(None, 50)
    assert plant.steps == 50
    plant.run(None, 50)
    assert plant.row().tolist() == other.row().tolist() and plant.energy_J() == other.energy_J()


def test_a_copied_vehicle_makes_the_same_plant(way: Any) -> None:
    vehicle = robot()
    other = way(vehicle)
    assert other.c != vehicle.c and other.model != vehicle.model
    assert other.matrices().inertia.tolist() == vehicle.matrices().inertia.tolist()
    other.c.mass_kg = 1.0
    assert vehicle.c.mass_kg != 1.0


def test_a_saved_state_is_pickled_and_restored(way: Any) -> None:
    plant = moving()
    state, row = way(plant.save()), plant.row().tolist()
    plant.run(VOLTS, 3)
    plant.restore(state, 7)
    assert plant.row().tolist() == row


@pytest.mark.parametrize("real", ["double", "single"])
def test_a_copied_batch_has_its_own_lanes(way: Any, real: str) -> None:
    heavy = laconic.Vehicle(laconic.read_scene("robotino2").vehicle | {"mass_kg": 50.0}, real)
    batch = laconic.Batch([robot(real), heavy], kind_of=[k % 2 for k in range(37)], step_s=0.01)
    batch.voltage_V[:] = np.linspace(-9.0, 9.0, 37)
    batch.voltage_V[0, 5] = np.nan
    batch.body_force_N[0] = np.linspace(0.0, 3.0, 37)
    assert batch.run(11) == 1
    other = way(batch)
    assert not other.status.flags.writeable and not other.x_m.flags.writeable
    assert str(other.refusal(5)) == str(batch.refusal(5)) and other.missed.tolist() == batch.missed.tolist()
    before = batch.x_m.tolist()
    other.run(5)
    assert batch.x_m.tolist() == before
    batch.run(5)
    for name in ("x_m", "y_m", "heading_rad", "nu_rad_per_s", "voltage_V", "status", "missed"):
        assert np.array_equal(getattr(batch, name), getattr(other, name), equal_nan=True), name
    other.voltage_V = 0.0
    assert batch.voltage_V[1].any()


def test_a_pickled_batch_runs_on_a_processor_without_its_registers() -> None:
    batch = laconic.Batch(robot(), 9, step_s=0.01)
    batch.voltage_V[:] = np.linspace(-9.0, 9.0, 9)
    batch.run(5)
    state = batch.__getstate__() | {"width_bytes": 1 << 20}
    other = laconic.Batch.__new__(laconic.Batch)
    other.__setstate__(state)
    batch.run(5), other.run(5)
    assert other.x_m.tolist() == batch.x_m.tolist() and other.width_bytes == batch.width_bytes


def test_a_copied_batch_changes_its_own_kinds(way: Any) -> None:
    light, heavy = robot(), laconic.Vehicle(laconic.read_scene("robotino2").vehicle | {"mass_kg": 50.0})
    batch = laconic.Batch([light, light], step_s=0.01)
    other = way(batch)
    other.change(1, other.prepared(heavy))
    for each in (batch, other):
        each.voltage_V[:] = 3.0
        each.run(10)
    assert batch.x_m[0] == batch.x_m[1] == other.x_m[0] != other.x_m[1]


def test_copied_kinds_of_a_population_step_as_the_originals(way: Any) -> None:
    core = laconic.load_core()
    vehicles = copies_of(core, "laconic_vehicle", robot().c, 5)
    vehicles["mass_kg"] = np.linspace(10.0, 30.0, 5)
    kinds = Kinds.of(core, vehicles, "auto", 0.01)
    found = []
    for each in (kinds, way(kinds)):
        batch = laconic.Batch.of_kinds(each)
        batch.voltage_V[:] = 2.0
        batch.run(10)
        found.append(batch.x_m.tolist())
    assert found[0] == found[1]


def test_copied_sensors_watch_a_plant_of_their_own(way: Any) -> None:
    plant = moving()
    sensors = plant.sensors({"imu": {"seed": 3, "yaw_rate_noise_rad_per_s_per_sqrt_Hz": 0.01},
                             "encoder": {"counts_per_turn": 1000}})
    sensors.run(VOLTS, 4)
    other = way(sensors)
    other.run(VOLTS, 4)
    assert plant.steps == 11 and other.plant.steps == 15
    sensors.run(VOLTS, 4)
    one, two = sensors.read(), other.read()
    assert one.imu_yaw_rate_rad_per_s == two.imu_yaw_rate_rad_per_s
    assert one.encoder_count.tolist() == two.encoder_count.tolist()


def test_a_plant_and_its_sensors_stay_together_in_one_copy() -> None:
    plant = moving()
    pair = copy.deepcopy((plant, plant.sensors()))
    assert pair[1].plant is pair[0] is not plant


def test_a_copied_estimate_goes_on_by_itself(way: Any) -> None:
    plant = moving()
    estimate = plant.estimate()
    estimate.run(VOLTS, 20)
    other = way(estimate)
    other.run(VOLTS, 20)
    assert plant.steps == 27
    estimate.run(VOLTS, 20)
    assert estimate.read() == other.read()


def test_a_copied_filter_goes_on_by_itself(way: Any) -> None:
    kept = laconic.Filter(moving(), {"encoder_std_rad": 1e-3, "yaw_rate_std_rad_per_s": 0.01, "nu_std_rad_per_s": 0.1},
                          encoder={"counts_per_turn": 4096, "wrap": 65536}, start_count=[5, 65535, 7])
    kept.predict(VOLTS, 3)
    other, before = way(kept), kept.covariance.tolist()
    other.predict(VOLTS, 3)
    other.counts([60, 3, 50])
    assert kept.covariance.tolist() == before
    kept.predict(VOLTS, 3)
    kept.counts([60, 3, 50])
    assert kept.covariance.tolist() == other.covariance.tolist() and kept.state.tolist() == other.state.tolist()
    other.restore(way(kept.save()))
    assert other.state.tolist() == kept.state.tolist()


def test_copied_derivatives_are_of_a_plant_of_their_own(way: Any) -> None:
    plant = moving()
    step = plant.step_derivatives(VOLTS)
    other, before = way(step), step.jacobian().by_state.tolist()
    assert other.jacobian().by_state.tolist() == before
    other.plant.run(VOLTS, 30)
    assert step.jacobian().by_state.tolist() == before != other.jacobian().by_state.tolist()


def test_a_copied_controller_plans_as_the_original(way: Any) -> None:
    control = pytest.importorskip("laconic.tools.control.predictive")
    from laconic.tools.control import Course

    course = Course(robot().plant(step_s=0.05), lambda t: (0.1 * t, 0.0, 0.0), 1.0)
    controller = control.PredictiveController(course, 12.0, horizon=5)
    other, state = way(controller), course.states[0]
    assert other.course.plant is not course.plant
    assert other.voltages(0, state) == pytest.approx(controller.voltages(0, state), abs=1e-4)


def test_a_copied_environment_does_what_the_original_does(way: Any) -> None:
    pytest.importorskip("gymnasium")
    from laconic.tools.learn.environments import DriveToPose, DriveToPoseVector

    for made in (DriveToPose(), DriveToPoseVector(4)):
        made.reset(seed=3)
        other, action = way(made), np.full(made.action_space.shape, 0.5, np.float32)
        first, second = made.step(action), other.step(action)
        assert np.array_equal(first[0], second[0]) and np.array_equal(first[1], second[1])


def test_a_core_is_the_one_of_its_process(way: Any) -> None:
    core = laconic.load_core("single")
    assert way(core) is core


@pytest.mark.parametrize("way_of", [copy.copy, copy.deepcopy, pickle.dumps])
def test_what_no_copy_can_stand_for_says_what_to_do(way_of: Any) -> None:
    core = laconic.load_core()
    schedule = Schedule(core, [0], np.zeros((1, 1)), [5])
    with pytest.raises(TypeError, match="^a Schedule cannot be copied or pickled; make another one of the same values"):
        way_of(schedule)
    with pytest.raises(TypeError, match="^a laconic_batch cannot be copied or pickled: it holds addresses; copy what"):
        way_of(laconic.Batch(robot()).c)


def test_memory_of_other_libraries_is_copied_as_before() -> None:
    from cffi import FFI

    laconic.load_core()
    for each in (FFI().new("int[3]"), laconic.load_core().ffi.new("double[2]")):
        with pytest.raises(TypeError, match="cannot pickle"):
            pickle.dumps(each)


def test_a_pickle_of_another_build_is_refused_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    data = pickle.dumps(moving())
    monkeypatch.setattr(copies, "build_of", lambda core: "another")
    with pytest.raises(laconic.BadInput, match="pickle: holds a laconic_plant of another build of laconic; make it "):
        pickle.loads(data)


def test_a_plant_goes_to_another_process_where_the_library_is_elsewhere(tmp_path: Path) -> None:
    plant = moving()
    (tmp_path / "plant").write_bytes(pickle.dumps(plant))
    code = ("import pickle, sys\nplant = pickle.load(open(sys.argv[1], 'rb'))\n"
            "plant.run({'voltage_V': [6.0, -3.0, 2.0]}, 5)\nprint(plant.row().tolist(), plant.chosen_method)")
    found = subprocess.run([sys.executable, "-c", code, str(tmp_path / "plant")], capture_output=True, text=True,
                           check=True).stdout
    plant.run(VOLTS, 5)
    assert found.strip() == f"{plant.row().tolist()} {plant.chosen_method}"


def stepped(plant: laconic.Plant) -> laconic.Plant:
    plant.run(VOLTS, 5)
    return plant


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="this system cannot fork")
def test_a_pool_gives_plants_and_takes_them() -> None:
    plant = moving()
    with multiprocessing.get_context("fork").Pool(1) as pool:
        found = pool.map_async(stepped, [plant]).get(60)[0]
    assert plant.steps == 7 and found.row().tolist() == stepped(plant).row().tolist()


# ---- memory that goes with its owner

def in_passing_memory(core: laconic.Core, pointer: Any) -> Any:
    """A copy of a structure, whose numbers are NaN once nothing owns it."""
    blocks: dict[Any, Any] = {}

    def take(size: int) -> Any:
        block = core.ffi.new("char[]", size)
        blocks[core.ffi.cast("void *", block)] = block
        return core.ffi.cast("void *", block)

    def give_back(address: Any) -> None:
        core.ffi.memmove(address, b"\xff" * len(blocks[address]), len(blocks[address]))

    kind = core.ffi.typeof(pointer).item
    return core.ffi.new_allocator(take, give_back)(core.ffi.getctype(kind, "*"), pointer[0])


@pytest.mark.parametrize("scene, maker, read", [
    ("tricycle_agv", "articulated_vehicle", lambda scene: moved_inertia(scene, [True] * 4)),
    ("tricycle_agv", "articulated_vehicle", lambda scene: loop_of(scene, BaseTable()).gain.tolist()),
    ("turtlebot3_burger", "sensors_of", lambda scene: [*sensor_parameters(scene, scene.plant(scene.core()))])],
    ids=["inertia", "gains", "sensors"])
def test_what_is_read_of_a_structure_is_read_while_it_is_owned(scene: str, maker: str, read: Callable[[Scene], Any],
                                                               monkeypatch: pytest.MonkeyPatch) -> None:
    tables = scene_tables(scene).entries
    sensors = {} if maker == "articulated_vehicle" else {"sensors": {"encoder": {"counts_per_turn": 60}}}
    given = laconic.build_scene(tables | sensors)
    wanted, make = read(given), getattr(Scene, maker)
    assert wanted

    def passing(*words: Any) -> Any:
        made = make(*words)
        made.c = in_passing_memory(given.core(), made.c)
        return made

    monkeypatch.setattr(Scene, maker, passing)
    assert read(given) == wanted
