"""Vehicles with hinges in a batch: the bits of single runs, refusals by lane and by vehicle (docs/batch.md)."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import laconic
from laconic import ArticulatedBatch, ArticulatedVehicle, SlippingVehicle
from laconic.errors import BadInput, Refused
from laconic.scene.scene_tables import scene_tables

NAMES = ("tugger_train", "mir_like", "wheelchair", "f1tenth")


def vehicle(name: str) -> ArticulatedVehicle:
    return ArticulatedVehicle.of(laconic.read_scene(name))


def driven(made: ArticulatedVehicle, volt: float) -> dict[str, float]:
    """A voltage on each wheel that has a motor, a different one on each; straight ahead where a twist is needed."""
    found = {f"voltage_V[{n + 1}]": volt * (n + 1) for n in range(made.wheel_count)
             if made.model.wheel[n].gain_Nm_per_V}
    return found | ({"steering_twist[1]": 1.0} if made.is_coordinated else {})


def bits(state: object, core: laconic.Core) -> bytes:
    return bytes(core.ffi.buffer(state, core.ffi.sizeof("laconic_articulated_state")))


@pytest.mark.parametrize("threads", [1, 3])
def test_each_lane_has_the_bits_of_its_vehicle_alone(threads: int) -> None:
    vehicles = [made for made in map(vehicle, NAMES) if not made.is_coordinated]
    kind_of = [lane % len(vehicles) for lane in range(7)]
    batch = ArticulatedBatch(vehicles, method="auto", step_s=0.005, kind_of=kind_of)
    plants = [vehicles[kind].plant("auto", 0.005) for kind in kind_of]
    for lane, (kind, plant) in enumerate(zip(kind_of, plants, strict=True)):
        inputs = driven(vehicles[kind], 0.5 + lane)
        for signal, value in inputs.items():
            batch.of(signal)[lane] = value
        plant.run(inputs, 40)
    assert batch.run(40, threads) == 0
    for lane, plant in enumerate(plants):
        assert bits(batch.state(lane), batch.core) == bits(plant.c, batch.core)
        assert batch.motion["x_m"][lane] == plant.motion().x_m != 0.0
        assert np.array_equal(batch.motion["hinge_angle_rad"][lane][: plant.vehicle.body_count],
                              plant.motion().hinge_angle_rad)


def slipping(name: str, friction: float = 0.3) -> SlippingVehicle:
    """The vehicle of a scene on slippery ground."""
    tables = copy.deepcopy(scene_tables(name).entries)
    tables["vehicle"].pop("friction_coefficient", None)
    return SlippingVehicle.of(laconic.build_scene(tables | {"ground": {"friction_coefficient": friction}}))


@pytest.mark.parametrize("threads", [1, 3])
def test_each_lane_that_slips_has_the_bits_of_its_vehicle_alone(threads: int) -> None:
    vehicles = [slipping("mir_like"), slipping("f1tenth"), slipping("mir_like", 0.05)]
    kind_of = [0, 1, 2, 1, 0]
    batch = ArticulatedBatch(vehicles, step_s=0.005, kind_of=kind_of)
    plants = [vehicles[kind].plant(step_s=0.005) for kind in kind_of]
    for lane, plant in enumerate(plants):
        volts = [2.0 + 3 * lane + n for n in range(plant.vehicle.wheel_count)]
        angles = [0.1 * lane] * plant.vehicle.body_count
        batch.of("voltage_V")[: len(volts), lane] = volts
        batch.of("steering_angle_rad")[: len(angles), lane] = angles
        plant.run({"voltage_V": volts, "steering_angle_rad": angles}, 40)
    assert batch.run(40, threads) == 0
    for lane, plant in enumerate(plants):
        assert tree_bits(batch.state(lane), batch.core) == tree_bits(plant.c, batch.core)
        found, wanted = batch.outputs[lane], plant.outputs()
        assert batch.motion["x_m"][lane] == wanted.motion.x_m != 0.0
        assert not batch.motion["hinge_angle_rad"][lane][plant.vehicle.body_count :].any()
        assert not batch.motion["wheel_angle_rad"][lane][plant.vehicle.wheel_count :].any()
        assert found["slip_loss_J"] == wanted.slip_loss_J
        assert np.array_equal(found["slip_along_m_per_s"][: plant.vehicle.wheel_count], wanted.slip_along_m_per_s)
    assert batch.outputs["slip_loss_J"].min() > 0.0


def tree_bits(state: object, core: laconic.Core) -> bytes:
    return bytes(core.ffi.buffer(state, core.ffi.sizeof("laconic_tree_state")))


def test_a_lane_that_slips_is_refused_copied_and_loaded_as_others_are() -> None:
    batch = ArticulatedBatch(slipping("mir_like"), 3, step_s=0.005)
    batch.of("voltage_V")[:] = 4.0
    batch.of("voltage_V[1]")[1] = np.nan
    assert batch.run(5) == 1 and batch.missed.tolist() == [0, 5, 0]
    why = batch.refusal(1)
    assert why is not None and why.message.startswith("lane 1: voltage_V[1]")
    batch.of("voltage_V[1]")[1] = 4.0
    batch.load(1, batch.state(0))
    others = [copy.copy(batch), pickle.loads(pickle.dumps(batch))]
    assert [each.run(3) for each in (batch, *others)] == [0, 0, 0]
    assert all(tree_bits(each.state(1), batch.core) == tree_bits(batch.state(0), batch.core) for each in others)


def test_a_batch_is_on_one_ground_and_says_what_ideal_ground_lacks() -> None:
    with pytest.raises(BadInput, match=r"^vehicles\[2\]: is on ground with friction.*one batch for each ground$"):
        ArticulatedBatch([vehicle("mir_like"), slipping("mir_like")])
    with pytest.raises(BadInput, match=r"^vehicles\[1\]: method: .*auto"):
        ArticulatedBatch(slipping("mir_like"), method="rk4")
    with pytest.raises(BadInput, match="^outputs: .*SlippingVehicle"):
        _ = ArticulatedBatch(vehicle("mir_like")).outputs


def test_a_refused_lane_stays_and_the_others_continue() -> None:
    batch = ArticulatedBatch(vehicle("mir_like"), 3, step_s=0.005)
    batch.of("voltage_V")[:] = 1.0
    batch.of("voltage_V[1]")[1] = np.nan
    before = bits(batch.state(1), batch.core)
    assert batch.run(5) == 1
    assert batch.status.astype(bool).tolist() == [False, True, False]
    assert batch.missed.tolist() == [0, 5, 0]
    assert bits(batch.state(1), batch.core) == before
    why = batch.refusal(1)
    assert batch.refusal(0) is None and why is not None and why.message.startswith("lane 1: voltage_V[1]")


def test_a_vehicle_that_the_method_cannot_step_is_named_by_its_number() -> None:
    with pytest.raises(Refused, match=r"^vehicles\[2\]: "):
        ArticulatedBatch([slow(), vehicle("mir_like")], method="rk4", step_s=50.0)


def slow() -> ArticulatedVehicle:
    """Without motors and damping: any step is short enough."""
    return ArticulatedVehicle({"mass_kg": 1.0, "yaw_inertia_kgm2": 1.0, "wheel_radius_m": 0.1,
                               "wheel_inertia_kgm2": 0.0, "wheel": [], "body": [
        {"name": "arm", "hinge": "free", "hinge_x_m": 0.1, "hinge_y_m": 0.0, "mass_kg": 1.0,
         "yaw_inertia_kgm2": 0.1}]})


def test_each_batch_names_the_other_for_a_vehicle_of_the_other_kind() -> None:
    flat = laconic.Vehicle.of(laconic.read_scene("robotino2"))
    with pytest.raises(BadInput, match=r"vehicles\[1\]: .*ArticulatedBatch"):
        laconic.Batch(vehicle("mir_like"), 2)  # type: ignore[arg-type]
    with pytest.raises(BadInput, match=r"vehicles\[2\]: .*laconic\.Batch"):
        ArticulatedBatch([vehicle("mir_like"), flat])  # type: ignore[list-item]


def test_inputs_of_another_shape_or_wheel_are_refused() -> None:
    batch = ArticulatedBatch(vehicle("mir_like"), 3)
    with pytest.raises(BadInput, match="voltage_V"):
        batch.set("voltage_V", [1.0, 2.0])
    with pytest.raises(BadInput, match=r"voltage_V\[20\]"):
        batch.of("voltage_V[20]")


def test_a_copy_and_a_pickle_move_by_themselves_with_the_same_bits() -> None:
    batch = ArticulatedBatch(vehicle("tugger_train"), 2, step_s=0.01)
    batch.of("voltage_V")[:] = [[3.0, 4.0]]
    batch.run(3)
    others = [copy.copy(batch), pickle.loads(pickle.dumps(batch))]
    before = bits(batch.state(1), batch.core)
    for other in others:
        other.run(3)
    assert bits(batch.state(1), batch.core) == before
    batch.run(3)
    assert all(bits(other.state(1), other.core) == bits(batch.state(1), batch.core) != before for other in others)
